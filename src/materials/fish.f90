!> A swimming body: an elastic solid whose muscles change their length.
module mpm_fish
  use mpm_deformation, only: advance_deformations, deformation_size, determinant, &
                             expand_deformation, identity, store_deformation, turn_deformation
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t
  implicit none
  private
  public :: fish_t

  !> Elastic solid with prescribed stretches along x in six regions and none in a seventh.
  !!
  !! The memory of a point is F, the number of its region (0 to 5, or -1) and the time.
  type, extends(material_t) :: fish_t
    !> Shear modulus. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Bulk modulus. [Pa]
    real(wp) :: bulk = 0.0_wp
    !> Logarithms of the largest stretches of head, abdomen, tail.
    real(wp) :: amplitude(3) = 0.0_wp
    !> Angular frequencies. [1/s]
    real(wp) :: frequency(3) = 0.0_wp
    !> Phases.
    real(wp) :: phase(3) = 0.0_wp
    !> Where the tail's passive end, the tail and the abdomen end and the passive head begins, over
    !> the length.
    real(wp) :: ends(4) = [-1.0_wp, 0.4_wp, 0.75_wp, 2.0_wp]
    !> Components of F.
    integer :: n_f = 9
  contains
    procedure, nopass :: describe => fish_describe
    procedure :: init => fish_init
    procedure :: start => fish_start
    procedure :: update_stress => fish_update_stress
    procedure :: assign_stress => fish_assign_stress
    procedure :: turn_history => fish_turn_history
    procedure :: wave_speed => fish_wave_speed
    procedure :: strain_energy => fish_strain_energy
    procedure :: write_fields => fish_write_fields
  end type fish_t

contains

  !> Purpose and properties of the class.
  subroutine fish_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    character(*), parameter :: parts(3) = [character(7) :: 'head', 'abdomen', 'tail']
    character(*), parameter :: names(3) = ['h', 'a', 't']
    integer :: i

    call description%init('material', 'Fish', &
                          'Elastic body that swims: muscles along x on both sides change their &
                          &length, one side against the other.', &
                          'Multiplicative split of growth: Rodriguez, Hoger and McCulloch, &
                          &J. Biomech. 27 (1994) 455-467', &
                          '    material-class = "Fish"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3, alpha_h = 0.02, alpha_a = &
                          &0.05, alpha_t = 0.1,'//nl// &
                          '                      beta_h = 6.28, beta_a = 6.28, beta_t = 6.28,'// &
                          nl//'                      gamma_h = 0, gamma_a = 0.5, gamma_t = 1}')
    call description%add_real('E', 'Pa', 'Young''s modulus', above=0.0_wp, types=types_with_dim(2))
    call description%add_real('nu', '-', 'Poisson ratio', above=-1.0_wp, below=0.5_wp, &
                              types=types_with_dim(2))
    do i = 1, 3
      call description%add_real('alpha_'//names(i), '-', 'logarithm of the largest stretch: '// &
                                trim(parts(i)), types=types_with_dim(2))
    end do
    do i = 1, 3
      call description%add_real('beta_'//names(i), '1/s', 'angular frequency: '//trim(parts(i)), &
                                types=types_with_dim(2))
    end do
    do i = 1, 3
      call description%add_real('gamma_'//names(i), '-', 'phase: '//trim(parts(i)), &
                                types=types_with_dim(2))
    end do
    call description%add_string('flags', '"USE_RIGID_TAIL": the end of the tail is passive; &
                                &"USE_RIGID_HEAD": the head is passive', is_list=.true.)
    call description%add_note('The stress follows from an energy, T = G/J dev(B J^(-2/3)) + &
                              &K ln(J)/J I; mpm_3d leaves out both powers of J, a difference of &
                              &second order in the strain.')
    call description%add_note('The time of the muscles is that of the end of a step, from 0 at the &
                              &start of the run; a phase other than 0 starts with a jump.')
    call description%add_note('A stress can''t be assigned to it.')
  end subroutine fish_describe

  !> Set the constants from the properties.
  subroutine fish_init(self, kin, properties, error)
    !> The material.
    class(fish_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> TYPE 1, or an unknown flag.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    logical :: head, tail
    integer :: i

    self%kin = kin
    self%n_f = deformation_size(kin)
    self%n_history = self%n_f + 2
    head = .false.
    tail = .false.
    call properties%strings('flags', flags)
    if (kin%dim < 2) then
      call properties%reject('flags', 'a fish needs two sides', error, 'TYPE 2 to 5')
      return
    end if
    associate (young => properties%real('E'), poisson => properties%real('nu'))
      self%shear = young/(2.0_wp*(1.0_wp + poisson))
      self%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    end associate
    self%amplitude = [properties%real('alpha_h'), properties%real('alpha_a'), &
                      properties%real('alpha_t')]
    self%frequency = [properties%real('beta_h'), properties%real('beta_a'), &
                      properties%real('beta_t')]
    self%phase = [properties%real('gamma_h'), properties%real('gamma_a'), &
                  properties%real('gamma_t')]
    do i = 1, size(flags)
      select case (flags(i)%text)
      case ('USE_RIGID_HEAD')
        head = .true.
      case ('USE_RIGID_TAIL')
        tail = .true.
      case default
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               '"USE_RIGID_TAIL", "USE_RIGID_HEAD"   (mpm3d --describe Fish)')
        return
      end select
    end do
    if (head .and. tail) then
      call properties%reject('flags', 'USE_RIGID_HEAD and USE_RIGID_TAIL exclude each other', &
                             error, 'mpm_3d ignores USE_RIGID_TAIL then: leave it out')
      return
    end if
    self%ends = [-1.0_wp, 0.4_wp, 0.75_wp, 2.0_wp]
    if (tail) self%ends(1) = 0.15_wp
    if (head) self%ends = [-1.0_wp, 0.2_wp, 0.45_wp, 0.8_wp]
  end subroutine fish_init

  !> Points begin without strain, in the region of their place in the body.
  pure subroutine fish_start(self, n, x, mass, volume, history)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> F, region, time. (n_history, n)
    real(wp), intent(out) :: history(self%n_history, n)
    real(wp) :: stored(9), first, length, middle, s
    integer :: p, region

    associate (unused => volume)
    end associate
    stored = store_deformation(self%kin, identity)
    if (n == 0) return
    first = minval(x(1, :))
    length = max(maxval(x(1, :)) - first, tiny(1.0_wp))
    middle = dot_product(mass, x(2, :))/sum(mass)
    do p = 1, n
      s = (x(1, p) - first)/length
      region = 2
      if (s > self%ends(2)) region = 1
      if (s > self%ends(3)) region = 0
      if (x(2, p) > middle) region = region + 3
      if (s < self%ends(1) .or. s > self%ends(4)) region = -1
      history(:self%n_f, p) = stored(:self%n_f)
      history(self%n_f + 1, p) = real(region, wp)
      history(self%n_f + 2, p) = 0.0_wp
    end do
  end subroutine fish_start

  !> Stretch of the muscles of a point.
  pure function muscle(self, region, time) result(stretch)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Its region.
    real(wp), intent(in) :: region
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Stretch along x.
    real(wp) :: stretch
    integer :: k

    stretch = 1.0_wp
    if (nint(region) < 0) return
    k = mod(nint(region), 3) + 1
    stretch = exp(self%amplitude(k)*sin(self%frequency(k)*time + self%phase(k)))
    if (nint(region) < 3) stretch = 1.0_wp/stretch
  end function muscle

  !> Elastic part of the deformation of a point.
  pure subroutine elastic_part(self, memory, fe, growth)
    !> The material.
    class(fish_t), intent(in) :: self
    !> F, region, time. (n_history)
    real(wp), intent(in) :: memory(:)
    !> Elastic deformation gradient.
    real(wp), intent(out) :: fe(3, 3)
    !> Volume ratio of the muscles.
    real(wp), intent(out) :: growth

    fe = expand_deformation(self%kin, memory(:self%n_f))
    growth = muscle(self, memory(self%n_f + 1), memory(self%n_f + 2))
    fe(:, 1) = fe(:, 1)/growth
  end subroutine elastic_part

  !> Advance the stress of a block of points over one step.
  pure subroutine fish_update_stress(self, n, dt, gradient, mass, volume, stress, history, &
                                     first_bad)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes at the end of the step. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> F, region, time. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that is turned inside out or out of all bounds; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: all_f(n, 3, 3), all_j(n), f(3, 3), j, growth, six(6)
    integer :: p

    associate (unused => mass, unused_volume => volume)
    end associate
    call advance_deformations(self%kin, n, dt, gradient, history, all_f, all_j, first_bad)
    if (first_bad > 0) return
    do p = 1, n
      f = all_f(p, :, :)
      j = all_j(p)
      history(self%n_f + 2, p) = history(self%n_f + 2, p) + dt
      growth = muscle(self, history(self%n_f + 1, p), history(self%n_f + 2, p))
      f(:, 1) = f(:, 1)/growth
      j = j/growth
      ! The components of F transpose(F); `matmul` would be a call of the run-time library.
      six = [sum(f(1, :)**2), sum(f(2, :)**2), sum(f(3, :)**2), sum(f(1, :)*f(2, :)), &
             sum(f(2, :)*f(3, :)), sum(f(3, :)*f(1, :))]
      six(1:3) = six(1:3) - (six(1) + six(2) + six(3))/3.0_wp
      six = (self%shear*j**(-5.0_wp/3.0_wp))*six
      six(1:3) = six(1:3) + self%bulk*log(j)/j
      stress(:, p) = six(:self%kin%nstress)
    end do
  end subroutine fish_update_stress

  !> A stress can't be assigned.
  pure subroutine fish_assign_stress(self, n, target, mass, volume, stress, history, first_bad)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses that are asked for. [Pa] (nstress, n)
    real(wp), intent(in) :: target(self%kin%nstress, n)
    !> Masses. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> F, region, time. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> The first point.
    integer, intent(out) :: first_bad

    associate (unused => target, unused_mass => mass, unused_volume => volume, &
               unused_stress => stress, unused_history => history)
    end associate
    first_bad = min(n, 1)
  end subroutine fish_assign_stress

  !> TYPE 4: express F in the basis of the moved points.
  pure subroutine fish_turn_history(self, n, dt, gradient, history)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> F, region, time. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    real(wp) :: f(9, n)

    if (self%n_f < 9) return
    f = history(:9, :)
    call turn_deformation(self%kin, n, dt, gradient, f)
    history(:9, :) = f
  end subroutine fish_turn_history

  !> Largest speed of a longitudinal wave, over all directions at most.
  pure function fish_wave_speed(self, n, mass, volume, stress, history) result(speed)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> F, region, time. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of a wave. [m/s]
    real(wp) :: speed
    real(wp) :: f(3, 3), j, growth, across
    integer :: p

    associate (unused => stress)
    end associate
    speed = 0.0_wp
    do p = 1, n
      call elastic_part(self, history(:, p), f, growth)
      j = determinant(f)
      across = self%shear*maxval(sum(abs(matmul(f, transpose(f))), dim=1))*j**(-5.0_wp/3.0_wp)
      speed = max(speed, (4.0_wp*across/3.0_wp + self%bulk*(1.0_wp + abs(log(j)))/j) &
                  *volume(p)/mass(p))
    end do
    speed = sqrt(speed)
  end function fish_wave_speed

  !> Sum of V/J (G/2 (tr B J**(-2/3) - 3) + K/2 (ln J)**2).
  pure function fish_strain_energy(self, n, mass, volume, stress, history) result(energy)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> F, region, time. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    real(wp) :: f(3, 3), j, growth
    integer :: p

    associate (unused => stress, unused_mass => mass)
    end associate
    energy = 0.0_wp
    do p = 1, n
      call elastic_part(self, history(:, p), f, growth)
      j = determinant(f)
      energy = energy + 0.5_wp*volume(p)/j*(self%shear*(sum(f**2)*j**(-2.0_wp/3.0_wp) - 3.0_wp) &
                                            + self%bulk*log(j)**2)
    end do
  end function fish_strain_energy

  !> Send the regions, the stretches of the muscles and the elastic B.
  subroutine fish_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(fish_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> F, region, time. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp) :: f(3, 3), b(6, n), stretch(n)
    integer :: p

    associate (unused => mass, unused_volume => volume, unused_stress => stress)
    end associate
    do p = 1, n
      call elastic_part(self, history(:, p), f, stretch(p))
      f = matmul(f, transpose(f))
      b(:, p) = [f(1, 1), f(2, 2), f(3, 3), f(1, 2), f(2, 3), f(3, 1)]
    end do
    call writer%scalar('fish_label', (history(self%n_f + 1, :)))
    call writer%scalar('muscle_stretch', stretch)
    call writer%symmetric_tensor('B_e', (b(:self%kin%nstress, :)))
  end subroutine fish_write_fields

end module mpm_fish
