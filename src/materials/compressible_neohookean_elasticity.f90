!> A compressible neo-Hookean solid at finite strain.
module mpm_compressible_neohookean_elasticity
  use mpm_deformation, only: advance_deformations, deformation_size, determinant, &
                             expand_deformation, identity, root, store_deformation, &
                             turn_deformation
  use mpm_description, only: description_t
  use mpm_elementary, only: logarithms
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_stress, kinematics_t
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: compressible_neohookean_elasticity_t

  !> Psi = G/2 (tr B - 3) - G ln J + lambda/2 (ln J)**2. The memory of a point is F.
  type, extends(material_t) :: compressible_neohookean_elasticity_t
    !> First Lame constant at small strain. [Pa]
    real(wp) :: lambda = 0.0_wp
    !> Shear modulus at small strain. [Pa]
    real(wp) :: shear = 0.0_wp
  contains
    procedure, nopass :: describe => neohookean_describe
    procedure :: init => neohookean_init
    procedure :: start => neohookean_start
    procedure :: update_stress => neohookean_update_stress
    procedure :: assign_stress => neohookean_assign_stress
    procedure :: turn_history => neohookean_turn_history
    procedure :: wave_speed => neohookean_wave_speed
    procedure :: strain_energy => neohookean_strain_energy
    procedure :: write_fields => neohookean_write_fields
  end type compressible_neohookean_elasticity_t

contains

  !> Purpose and properties of the class.
  subroutine neohookean_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'CompressibleNeohookeanElasticity', &
                          'Compressible neo-Hookean solid at finite strain, &
                          &T = G/J (B - I) + lambda ln(J)/J I.', &
                          'Simo and Pister, CMAME 46 (1984) 201-215; Bonet and Wood, Nonlinear &
                          &Continuum Mechanics for Finite Element Analysis (2008)', &
                          '    material-class = "CompressibleNeohookeanElasticity"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3}')
    call description%add_real('E', 'Pa', 'Young''s modulus at small strain', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio at small strain', above=-1.0_wp, &
                              below=0.5_wp)
    call description%add_note('F <- exp(dt L) F: det F is the volume over that of the start, and a &
                              &rotation leaves no stress. mpm_3d takes F + dt L F and hides &
                              &inversion; here it ends the run.')
    call description%add_note('Stresses that a body assigns are kept: F becomes the stretch that &
                              &has them. mpm_3d has warnings instead.')
  end subroutine neohookean_describe

  !> Set the constants from the properties.
  subroutine neohookean_init(self, kin, properties, error)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    associate (young => properties%real('E'), poisson => properties%real('nu'))
      self%shear = young/(2.0_wp*(1.0_wp + poisson))
      self%lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    end associate
    self%kin = kin
    self%n_history = deformation_size(kin)
    if (allocated(error)) deallocate (error)
  end subroutine neohookean_init

  !> Points begin without strain.
  pure subroutine neohookean_start(self, n, x, mass, volume, history)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Deformation gradients. (n_history, n)
    real(wp), intent(out) :: history(self%n_history, n)
    real(wp) :: stored(9)

    associate (unused => x, unused_mass => mass, unused_volume => volume)
    end associate
    stored = store_deformation(self%kin, identity)
    history = spread(stored(:self%n_history), 2, n)
  end subroutine neohookean_start

  !> Advance the stress of a block of points over one step.
  pure subroutine neohookean_update_stress(self, n, dt, gradient, mass, volume, stress, history, &
                                           first_bad)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
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
    !> Deformation gradients. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that is turned inside out or out of all bounds; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: f(n, 3, 3), j(n), scale(n), pressure(n)
    integer, parameter :: first(6) = [1, 2, 3, 1, 2, 3], second(6) = [1, 2, 3, 2, 3, 1]
    integer :: c

    associate (unused => mass, unused_volume => volume)
    end associate
    call advance_deformations(self%kin, n, dt, gradient, history, f, j, first_bad)
    if (first_bad > 0) return
    scale = self%shear/j
    ! Of a loop with `log` the compiler makes vectors that round otherwise than what is left of it.
    call logarithms(n, j, pressure)
    pressure = scale - self%lambda*pressure/j
    do c = 1, self%kin%nstress
      associate (a => first(c), b => second(c))
        stress(c, :) = scale*(f(:, a, 1)*f(:, b, 1) + f(:, a, 2)*f(:, b, 2) + f(:, a, 3)*f(:, b, 3))
      end associate
      if (c <= 3) stress(c, :) = stress(c, :) - pressure
    end do
  end subroutine neohookean_update_stress

  !> Give points the stretch that has a stress.
  pure subroutine neohookean_assign_stress(self, n, target, mass, volume, stress, history, &
                                           first_bad)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
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
    !> Deformation gradients. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point for which no stretch has the stress; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: b(3, 3), before, stored(9)
    integer :: p
    logical :: good

    associate (unused => volume)
    end associate
    first_bad = 0
    do p = 1, n
      call stretch_of_stress(self%lambda, self%shear, expand_stress(target(:, p)), b, good)
      if (.not. good) then
        first_bad = p
        return
      end if
      before = determinant(expand_deformation(self%kin, history(:, p)))
      stored = store_deformation(self%kin, root(b))
      history(:, p) = stored(:self%n_history)
      ! The point fills the same space with what is compressed into it.
      mass(p) = mass(p)*before/sqrt(determinant(b))
      stress(:, p) = target(:, p)
    end do
  end subroutine neohookean_assign_stress

  !> B = I + (J T - lambda ln(J) I)/G with det B = J**2.
  !!
  !! ln det B - 2 ln J falls with ln J where B is positive definite; elsewhere J is too large.
  pure subroutine stretch_of_stress(lambda, shear, t, b, good)
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Stress. [Pa]
    real(wp), intent(in) :: t(3, 3)
    !> Left Cauchy-Green tensor.
    real(wp), intent(out) :: b(3, 3)
    !> Whether there is one.
    logical, intent(out) :: good
    real(wp), parameter :: farthest = 20.0_wp
    real(wp) :: low, high, middle, step
    integer :: i

    low = 0.0_wp
    high = 0.0_wp
    step = 0.01_wp
    good = .true.
    if (too_large(0.0_wp)) then
      do while (too_large(low))
        good = low > -farthest
        if (.not. good) return
        low = low - step
        step = 2.0_wp*step
      end do
    else
      do while (.not. too_large(high))
        good = high < farthest
        if (.not. good) return
        high = high + step
        step = 2.0_wp*step
      end do
    end if
    do i = 1, 100
      middle = 0.5_wp*(low + high)
      if (too_large(middle)) then
        high = middle
      else
        low = middle
      end if
    end do
    b = left(low)

  contains

    !> B of a volume ratio.
    pure function left(x) result(tensor)
      !> ln J.
      real(wp), intent(in) :: x
      !> B.
      real(wp) :: tensor(3, 3)

      tensor = (exp(x)*t + (shear - lambda*x)*identity)/shear
    end function left

    !> Whether a volume ratio is above that of the stress.
    pure function too_large(x) result(above)
      !> ln J.
      real(wp), intent(in) :: x
      !> Whether it is.
      logical :: above
      real(wp) :: c(3, 3), d

      c = left(x)
      d = determinant(c)
      above = .true.
      if (c(1, 1) <= 0.0_wp .or. d <= 0.0_wp) return
      if (c(1, 1)*c(2, 2) <= c(1, 2)**2) return
      above = log(d) < 2.0_wp*x
    end function too_large

  end subroutine stretch_of_stress

  !> TYPE 4: express F in the basis of the moved points.
  pure subroutine neohookean_turn_history(self, n, dt, gradient, history)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> Deformation gradients. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)

    call turn_deformation(self%kin, n, dt, gradient, history)
  end subroutine neohookean_turn_history

  !> Largest speed of a longitudinal wave, over all directions at most.
  !!
  !! rho c**2 = (lambda (1 - ln J) + G + G n.B n)/J for a direction n of principal stretch; n.B n is
  !! at most the largest sum of a row.
  pure function neohookean_wave_speed(self, n, mass, volume, stress, history) result(speed)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Deformation gradients. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of a wave. [m/s]
    real(wp) :: speed
    real(wp) :: f(3, 3), j, across, along
    integer :: p

    associate (unused => stress)
    end associate
    speed = 0.0_wp
    do p = 1, n
      f = expand_deformation(self%kin, history(:, p))
      j = determinant(f)
      across = self%shear*maxval(sum(abs(matmul(f, transpose(f))), dim=1))
      along = across + max(0.0_wp, self%shear + self%lambda*(1.0_wp - log(j)))
      speed = max(speed, along/j*volume(p)/mass(p))
    end do
    speed = sqrt(speed)
  end function neohookean_wave_speed

  !> Sum of V/J (G/2 (tr B - 3) - G ln J + lambda/2 (ln J)**2).
  pure function neohookean_strain_energy(self, n, mass, volume, stress, history) result(energy)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Deformation gradients. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    real(wp) :: f(3, 3), j, x
    integer :: p

    associate (unused => stress, unused_mass => mass)
    end associate
    energy = 0.0_wp
    do p = 1, n
      f = expand_deformation(self%kin, history(:, p))
      j = determinant(f)
      x = log(j)
      energy = energy + volume(p)/j*(self%shear*(0.5_wp*(sum(f**2) - 3.0_wp) - x) &
                                     + 0.5_wp*self%lambda*x**2)
    end do
  end function neohookean_strain_energy

  !> Send B and J.
  subroutine neohookean_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(compressible_neohookean_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Deformation gradients. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp) :: b(6, n), j(n), f(3, 3), c(3, 3)
    integer :: p

    associate (unused => mass, unused_volume => volume, unused_stress => stress)
    end associate
    do p = 1, n
      f = expand_deformation(self%kin, history(:, p))
      c = matmul(f, transpose(f))
      b(:, p) = [c(1, 1), c(2, 2), c(3, 3), c(1, 2), c(2, 3), c(3, 1)]
      j(p) = determinant(f)
    end do
    call writer%symmetric_tensor('B', (b(:self%kin%nstress, :)))
    call writer%scalar('J', j)
  end subroutine neohookean_write_fields

end module mpm_compressible_neohookean_elasticity
