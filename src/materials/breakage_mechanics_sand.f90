!> A sand whose grains break.
module mpm_breakage_mechanics_sand
  use mpm_advance, only: turn_stress
  use mpm_breakage, only: breakage_state_t, breakage_t, n_level, n_state, of_breakage, of_c, &
                          of_density, of_ev, of_high, of_porosity, of_s, of_y, width
  use mpm_breakage_flow, only: flow
  use mpm_deformation, only: identity
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_stress, kinematics_t, type_axisymmetric
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  use mpm_push_forward, only: push_forward
  implicit none
  private
  public :: breakage_mechanics_sand_t

  !> Be without strain, components xx yy zz xy yz zx.
  real(wp), parameter :: rest(6) = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]

  !> Breakage mechanics with critical state.
  !!
  !! The memory of a point is B, the porosity, and the elastic left Cauchy-Green tensor as a stress
  !! is stored.
  type, extends(material_t) :: breakage_mechanics_sand_t
    !> The law.
    type(breakage_t) :: law
    !> B and porosity at the start.
    real(wp) :: first(2) = 0.0_wp
  contains
    procedure, nopass :: describe => breakage_mechanics_sand_describe
    procedure :: init => breakage_mechanics_sand_init
    procedure :: grains => breakage_mechanics_sand_grains
    procedure :: start => breakage_mechanics_sand_start
    procedure :: update_stress => breakage_mechanics_sand_update_stress
    procedure :: assign_stress => breakage_mechanics_sand_assign_stress
    procedure :: turn_history => breakage_mechanics_sand_turn_history
    procedure :: wave_speed => breakage_mechanics_sand_wave_speed
    procedure :: strain_energy => breakage_mechanics_sand_strain_energy
    procedure :: write_fields => breakage_mechanics_sand_write_fields
  end type breakage_mechanics_sand_t

contains

  !> Purpose and properties of the class.
  subroutine breakage_mechanics_sand_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'BreakageMechanicsSand', &
                          'Sand whose grains break under load, with a critical state in shear.', &
                          'Einav, JMPS 55 (2007) 1274-1320; Tengattini, Das and Einav, &
                          &Geotechnique 66 (2016) 695-710', &
                          '    material-class = "BreakageMechanicsSand"'//nl// &
                          '    material-props = {p_r = 1e3, K = 12000, G = 9000, E_c = 3.5e4, &
                          &M_0 = 1.2,'//nl// &
                          '                      gamma = 0.9, phi_l = 0.25, phi_u = 0.5, l = 0.2, &
                          &u = 0.1,'//nl// &
                          '                      theta = 0.85, rho_0 = 2650, B_0 = 0, &
                          &phi_0 = 0.4}')
    call description%add_real('p_r', 'Pa', 'reference pressure', above=0.0_wp)
    call description%add_real('K', '-', 'elastic constant of volume', above=0.0_wp)
    call description%add_real('G', '-', 'elastic constant of shear', above=0.0_wp)
    call description%add_real('E_c', 'J/m3', 'critical breakage energy', above=0.0_wp)
    call description%add_real('M_0', '-', 'stress ratio of the critical state', above=0.0_wp, &
                              below=3.0_wp)
    call description%add_real('gamma', '-', 'dilation factor', above=0.0_wp)
    call description%add_real('phi_l', '-', 'lowest porosity without breakage', lower=0.0_wp, &
                              below=1.0_wp)
    call description%add_real('phi_u', '-', 'highest porosity without breakage', above=0.0_wp, &
                              below=1.0_wp)
    call description%add_real('l', '-', 'exponent of the lowest porosity', lower=0.0_wp)
    call description%add_real('u', '-', 'exponent of the highest porosity', lower=0.0_wp)
    call description%add_real('theta', '-', 'grading index', above=0.0_wp, upper=1.0_wp)
    call description%add_real('rho_0', 'kg/m3', 'density of the solid', above=0.0_wp)
    call description%add_real('B_0', '-', 'breakage at the start', lower=0.0_wp, below=1.0_wp)
    call description%add_real('phi_0', '-', 'porosity at the start', lower=0.0_wp, below=1.0_wp)
    call description%add_note('Be <- f Be transpose(f) with f = exp(dt L), which stays positive &
                              &definite; mpm_3d adds dt (L Be + Be transpose(L)).')
    call description%add_note('The plastic step follows the flow in pieces over which B and the &
                              &porosity change by at most 0.02, each with the direction at its &
                              &start, and ends on the yield surface to 1e-11, or to the rounding &
                              &of Be where strains are small. mpm_3d takes one piece and a secant &
                              &search that may fail without a word.')
    call description%add_note('A stress that a body assigns leaves its pressure, without shear; &
                              &too much for the grains, or for a loose packing, is an error.')
    call description%add_note('The speed of waves is at least that under the pressure which &
                              &crushes: without load the sand has none.')
  end subroutine breakage_mechanics_sand_describe

  !> Set the constants from the properties.
  subroutine breakage_mechanics_sand_init(self, kin, properties, error)
    !> The material.
    class(breakage_mechanics_sand_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Porosities in the wrong order.
    type(error_t), allocatable, intent(out) :: error

    self%kin = kin
    self%n_history = 2 + kin%nstress
    self%law%pressure = properties%real('p_r')
    self%law%bulk = properties%real('K')
    self%law%shear = properties%real('G')
    self%law%energy = properties%real('E_c')
    self%law%friction = properties%real('M_0')
    self%law%dilation = properties%real('gamma')
    self%law%limits = [properties%real('phi_l'), properties%real('phi_u')]
    self%law%powers = [properties%real('l'), properties%real('u')]
    self%law%grading = properties%real('theta')
    self%law%density = properties%real('rho_0')
    self%first = [properties%real('B_0'), properties%real('phi_0')]
    if (self%law%limits(1) >= self%law%limits(2)) then
      call properties%reject('phi_u', 'phi_u is not above phi_l', error, 'the highest porosity is &
                             &above the lowest one')
    else if (self%law%powers(1) < self%law%powers(2)) then
      call properties%reject('l', 'l is below u', error, 'the lowest porosity must fall at least &
                             &as fast with B as the highest one')
    end if
  end subroutine breakage_mechanics_sand_init

  !> Density and friction of the grains.
  pure subroutine breakage_mechanics_sand_grains(self, density, friction)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Density of the grains themselves. [kg/m3]
    real(wp), intent(out) :: density
    !> Largest ratio of shear stress to pressure at rest.
    real(wp), intent(out) :: friction

    density = self%law%density
    friction = self%law%friction/sqrt(3.0_wp)
  end subroutine breakage_mechanics_sand_grains

  !> Points begin without elastic strain.
  pure subroutine breakage_mechanics_sand_start(self, n, x, mass, volume, history)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(out) :: history(self%n_history, n)

    associate (unused => x, unused_mass => mass, unused_volume => volume)
    end associate
    history = 0.0_wp
    history(1, :) = self%first(1)
    history(2, :) = self%first(2)
    history(3:5, :) = 1.0_wp
  end subroutine breakage_mechanics_sand_start

  !> State of a point from its memory.
  pure function state_of(history) result(state)
    !> B, porosity, Be. (n_history)
    real(wp), intent(in) :: history(:)
    !> The state.
    type(breakage_state_t) :: state

    state%breakage = history(1)
    state%porosity = history(2)
    state%be = expand_stress(history(3:))
  end function state_of

  !> Memory of a state.
  pure subroutine remember(state, history)
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> B, porosity, Be. (n_history)
    real(wp), intent(out) :: history(:)
    real(wp) :: six(6)

    six = [state%be(1, 1), state%be(2, 2), state%be(3, 3), state%be(1, 2), state%be(2, 3), &
           state%be(3, 1)]
    history(1) = state%breakage
    history(2) = state%porosity
    history(3:) = six(:size(history) - 2)
  end subroutine remember

  !> Advance the stress of a block of points over one step.
  pure subroutine breakage_mechanics_sand_update_stress(self, n, dt, gradient, mass, volume, &
                                                        stress, history, first_bad)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
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
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point without a stress; 0 when there is none.
    integer, intent(out) :: first_bad
    integer :: a, b

    first_bad = 0
    do a = 1, n, width
      b = min(n, a + width - 1)
      call advance(self, b - a + 1, dt, gradient(:, a:b), mass(a:b), volume(a:b), stress(:, a:b), &
                   history(:, a:b), first_bad)
      if (first_bad > 0) first_bad = first_bad + a - 1
      if (first_bad > 0) return
    end do
  end subroutine breakage_mechanics_sand_update_stress

  !> Advance the stress of a few points over one step.
  pure subroutine advance(self, n, dt, gradient, mass, volume, stress, history, first_bad)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Number of points, at most `width`.
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
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point without a stress; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp), parameter :: largest = 1.0e8_wp
    real(wp) :: state(width, n_state), level(width, n_level), t(width, 6), trace(n), size(n)
    logical :: good(n), found(n)
    integer :: c, p

    do c = 1, 6
      state(:n, c) = 0.0_wp
      if (c <= self%kin%nstress) state(:n, c) = history(2 + c, :)
    end do
    state(:n, of_breakage) = history(1, :)
    state(:n, of_porosity) = history(2, :)
    state(:n, of_density) = mass/(volume*self%law%density)
    call push_forward(self%kin, n, dt, gradient, width, state, trace, good)
    size = 0.0_wp
    do c = 1, 6
      size = size + abs(state(:n, c))
    end do
    do p = 1, n
      good(p) = good(p) .and. size(p) <= largest
      if (.not. good(p)) state(p, :6) = rest
    end do
    call self%law%evaluate(n, state, level)
    do p = 1, n
      if (level(p, of_ev) < 0.0_wp .and. state(p, of_porosity) <= level(p, of_high)) cycle
      ! Pulled apart, or looser than any packing whose grains touch.
      state(p, :6) = rest
      if (good(p)) state(p, of_porosity) = 1.0_wp - (1.0_wp - state(p, of_porosity))*exp(-trace(p))
      level(p, of_y) = -1.0_wp
      level(p, of_c) = 0.0_wp
      level(p, of_s) = 0.0_wp
    end do
    call flow(self%law, n, state, level, found)
    call self%law%stresses(n, state, level, t)
    do c = 1, self%kin%nstress
      stress(c, :) = t(:n, c)
      history(2 + c, :) = state(:n, c)
    end do
    history(1, :) = state(:n, of_breakage)
    history(2, :) = state(:n, of_porosity)
    first_bad = findloc(good .and. found .and. abs(history(2, :)) <= largest, .false., dim=1)
  end subroutine advance

  !> Give points the pressure of a stress, without shear.
  pure subroutine breakage_mechanics_sand_assign_stress(self, n, target, mass, volume, stress, &
                                                        history, first_bad)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
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
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that can't have its pressure; 0 when there is none.
    integer, intent(out) :: first_bad
    type(breakage_state_t) :: state
    real(wp) :: wanted, t(3, 3), p, q, rr, low, high, limits(2), y, rates(3)
    integer :: i, k

    first_bad = 0
    do i = 1, n
      wanted = -(target(1, i) + target(2, i) + target(3, i))/3.0_wp
      state = state_of(history(:, i))
      state%be = identity
      t = 0.0_wp
      limits = self%law%porosities(state%breakage)
      if (wanted < 0.0_wp .or. (wanted > 0.0_wp .and. state%porosity > limits(2))) first_bad = i
      if (first_bad > 0) return
      if (wanted > 0.0_wp) then
        rr = mass(i)/(volume(i)*self%law%density)
        ! p grows with the volume strain x until Be is small; bisection to the last bit.
        low = 0.0_wp
        high = 0.3_wp
        do k = 1, 200
          state%be = (1.0_wp - (low + high)/3.0_wp)*identity
          call self%law%respond(state, rr, t, p, q)
          if (p < wanted) then
            low = 0.5_wp*(low + high)
          else
            high = 0.5_wp*(low + high)
          end if
        end do
        call self%law%yield(state, rr, y, rates, t, q)
        if (y > 0.0_wp .or. abs(p - wanted) > 1.0e-9_wp*wanted) then
          first_bad = i
          return
        end if
      end if
      call remember(state, history(:, i))
      stress(:, i) = 0.0_wp
      stress(1:3, i) = t(1, 1)
    end do
  end subroutine breakage_mechanics_sand_assign_stress

  !> TYPE 4: express Be in the basis of the moved points.
  pure subroutine breakage_mechanics_sand_turn_history(self, n, dt, gradient, history)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    real(wp) :: be(6, n)

    if (self%kin%sim_type /= type_axisymmetric) return
    be = history(3:8, :)
    call turn_stress(n, dt, gradient, be)
    history(3:8, :) = be
  end subroutine breakage_mechanics_sand_turn_history

  !> Largest speed of a longitudinal wave, at least that under the pressure which crushes.
  pure function breakage_mechanics_sand_wave_speed(self, n, mass, volume, stress, &
                                                   history) result(speed)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of a wave. [m/s]
    real(wp) :: speed
    real(wp) :: rr
    integer :: p

    associate (unused => stress)
    end associate
    speed = 0.0_wp
    do p = 1, n
      rr = mass(p)/(volume(p)*self%law%density)
      speed = max(speed, self%law%modulus(state_of(history(:, p)), rr)/(rr*self%law%density))
    end do
    speed = sqrt(speed)
  end function breakage_mechanics_sand_wave_speed

  !> Sum of m/rho_0 (1 - theta B) p_r Phi.
  pure function breakage_mechanics_sand_strain_energy(self, n, mass, volume, stress, history) &
    result(energy)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    integer :: p

    associate (unused => stress, unused_volume => volume)
    end associate
    energy = 0.0_wp
    do p = 1, n
      energy = energy + mass(p)/self%law%density*(1.0_wp - self%law%grading*history(1, p)) &
               *self%law%pressure*self%law%stored(expand_stress(history(3:, p)))
    end do
  end function breakage_mechanics_sand_strain_energy

  !> Send B, the porosity, Be, p and q.
  subroutine breakage_mechanics_sand_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(breakage_mechanics_sand_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> B, porosity, Be. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp) :: p(n), q(n)
    integer :: i

    associate (unused => mass, unused_volume => volume)
    end associate
    do i = 1, n
      p(i) = -sum(stress(1:3, i))/3.0_wp
      q(i) = sqrt(1.5_wp*(sum((stress(1:3, i) + p(i))**2) + 2.0_wp*sum(stress(4:, i)**2)))
    end do
    call writer%scalar('p', p)
    call writer%scalar('q', q)
    call writer%scalar('phi', (history(2, :)))
    call writer%scalar('B', (history(1, :)))
    call writer%symmetric_tensor('Be', (history(3:, :)))
  end subroutine breakage_mechanics_sand_write_fields

end module mpm_breakage_mechanics_sand
