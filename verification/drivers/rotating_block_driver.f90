!> A free block that vibrates along its edges while it rotates.
module mpm_rotating_block_driver
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_load_driver, only: add_load_properties, exact_state_t, load_driver_t, &
                             read_load_properties
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: rotating_block_driver_t

  !> The TYPEs that have the solution.
  logical, parameter :: solved(5) = [.false., .true., .true., .false., .true.]
  !> Half a turn.
  real(wp), parameter :: pi = acos(-1.0_wp)
  !> Largest strain: principal stretches then differ by less than a factor e.
  real(wp), parameter :: largest_strain = tanh(0.5_wp)

  !> Motion x = c + Q (y(X, t) - c), Q the rotation about z by the angle spin t.
  !!
  !! y_i = X_i + A sin(k X_i)**2 sin(omega t), k = pi/length and X counted from the corner of the
  !! block, is free of rotation: F_ii = 1 + A k sin(2 k X_i) sin(omega t), and with nu = 0 the
  !! Jaumann rate integrates to the stress E log F_ii. It is 0 on the faces with the normal i,
  !! which nu /= 0 would spoil. The rotation is rigid, the same for all points, and laid over a
  !! motion without spin: it adds to W alone, so that S = Q diag(E log F_ii) Q^T obeys
  !! dS/dt = W S - S W + E D. (A spin in y would spoil the logarithms; a Q that differs from point
  !! to point would add to D.) With s the spin
  !! b = Q [d2y/dt2 + 2 s e_z x dy/dt - s**2 (y - c)_xy - DIV P_y/rho], where
  !! (DIV P_y)_i = E J/F_ii**2 dF_ii/dX_i, since J/F_ii does not depend on X_i.
  type, extends(load_driver_t) :: rotating_block_driver_t
    !> Largest displacement A in the rotating frame. [m]
    real(wp) :: amplitude = 0.0_wp
    !> Wave number k. [1/m]
    real(wp) :: wave_number = pi
    !> E/rho. [m2/s2]
    real(wp) :: speed_squared = 0.0_wp
    !> Young's modulus E. [Pa]
    real(wp) :: young = 0.0_wp
    !> Angular frequency of the vibration. [1/s]
    real(wp) :: omega = 0.0_wp
    !> Angular velocity of the rotation about z. [1/s]
    real(wp) :: spin = 0.0_wp
    !> Corner of the block with the smallest coordinates. [m]
    real(wp) :: corner(3) = 0.0_wp
    !> Middle of the block. [m]
    real(wp) :: center(3) = 0.0_wp
  contains
    procedure, nopass :: describe => rotating_block_driver_describe
    procedure :: init => rotating_block_driver_init
    procedure :: acceleration => rotating_block_driver_acceleration
    procedure :: exact => rotating_block_driver_exact
    !> Motion of a point in the rotating frame.
    procedure, private :: vibration => rotating_block_driver_vibration
  end type rotating_block_driver_t

contains

  !> Purpose and properties of the class.
  subroutine rotating_block_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'RotatingBlockDriver', &
                          'Manufactured solution: a free block vibrates by A sin(pi X_i/length)^2 &
                          &sin(omega t) along each of its edges while it rotates about the z &
                          &direction through its middle.', &
                          'Wallstedt and Guilkey, J. Comput. Phys. 227 (2008) 9628-9642, with free &
                          &faces and a superposed rigid rotation', &
                          'driver'//nl//'{'//nl//'    class = "RotatingBlockDriver"'//nl// &
                          '    properties = {t_stop = 1, amplitude = 0.05, length = 1, '// &
                          'density = 1, E = 1, spin = 6.28,'//nl// &
                          '                  origin_x = 0.5, origin_y = 0.5}'//nl//'}')
    call add_load_properties(description)
    call description%add_real('amplitude', 'm', 'largest displacement A by the vibration; 0: a &
                              &rigid rotation, without stress', lower=0.0_wp)
    call description%add_real('length', 'm', 'side of the block', above=0.0_wp)
    call description%add_real('density', 'kg/m3', 'density in the reference configuration', &
                              above=0.0_wp)
    call description%add_real('E', 'Pa', 'Young''s modulus of the material', above=0.0_wp)
    call description%add_real('spin', '1/s', 'angular velocity of the rotation')
    call description%add_real('omega', '1/s', 'angular frequency of the vibration; 0: pi c/length &
                              &with c = sqrt(E/density)', default=0.0_wp, lower=0.0_wp)
    call description%add_real('origin_x', 'm', 'corner of the block with the smallest &
                              &coordinates', default=0.0_wp)
    call description%add_real('origin_y', 'm', 'the same', default=0.0_wp)
    call description%add_real('origin_z', 'm', 'the same', default=0.0_wp, types=types_with_dim(3))
    call description%add_note('For TYPE 2, 3 and 5; TYPE 2 and 5 have no motion along z.')
    call description%add_note('For IsotropicLinearElasticity with nu = 0: any other Poisson ratio &
                              &puts tractions on the faces, which have no place in a body force.')
    call description%add_note('The strain of the vibration, pi A/length at most, must stay below &
                              &tanh(1/2) = 0.46: beyond, principal stresses can differ by more &
                              &than 2 G and the equations of motion are no longer elliptic.')
  end subroutine rotating_block_driver_describe

  !> Set up from the properties.
  subroutine rotating_block_driver_init(self, properties, error)
    !> The driver.
    class(rotating_block_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Too large a strain.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: length

    call read_load_properties(self, properties)
    self%types = solved
    self%amplitude = properties%real('amplitude')
    length = properties%real('length')
    self%wave_number = pi/length
    self%young = properties%real('E')
    self%speed_squared = self%young/properties%real('density')
    self%omega = properties%real('omega')
    if (.not. self%omega > 0.0_wp) self%omega = self%wave_number*sqrt(self%speed_squared)
    self%spin = properties%real('spin')
    self%corner = [properties%real('origin_x'), properties%real('origin_y'), &
                   properties%real('origin_z')]
    self%center = self%corner + 0.5_wp*length
    if (self%wave_number*self%amplitude < largest_strain) return
    call properties%reject('amplitude', 'the strain would reach '// &
                           to_text(self%wave_number*self%amplitude, 3)//', not below 0.46', &
                           error, 'use an amplitude of at most '// &
                           to_text(0.99_wp*largest_strain/self%wave_number, 3))
  end subroutine rotating_block_driver_init

  !> Motion of a point in the rotating frame.
  pure subroutine rotating_block_driver_vibration(self, kin, reference, time, u, v, stretch)
    !> The driver.
    class(rotating_block_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Displacement. [m]
    real(wp), intent(out) :: u(3)
    !> Velocity. [m/s]
    real(wp), intent(out) :: v(3)
    !> F_ii.
    real(wp), intent(out) :: stretch(3)
    real(wp) :: angle(3), sine

    angle = 0.0_wp
    angle(:kin%dim) = self%wave_number*(reference(:kin%dim) - self%corner(:kin%dim))
    sine = sin(self%omega*time)
    u = self%amplitude*sin(angle)**2*sine
    v = self%amplitude*sin(angle)**2*cos(self%omega*time)*self%omega
    stretch = 1.0_wp + self%amplitude*self%wave_number*sin(2.0_wp*angle)*sine
  end subroutine rotating_block_driver_vibration

  !> Body force per unit mass.
  pure function rotating_block_driver_acceleration(self, kin, reference, x, velocity, time) &
    result(b)
    !> The driver.
    class(rotating_block_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Position; not used. [m]
    real(wp), intent(in) :: x(3)
    !> Velocity; not used. [m/s]
    real(wp), intent(in) :: velocity(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Acceleration, components beyond nvel 0. [m/s2]
    real(wp) :: b(3)
    real(wp) :: arm(3), bend(3), stretch(3), u(3), v(3)

    associate (unused => x, unused_velocity => velocity)
    end associate
    call self%vibration(kin, reference, time, u, v, stretch)
    ! dF_ii/dX_i = 2 k**2 (A sin(omega t) - 2 u_i), for cos(2 a) = 1 - 2 sin(a)**2.
    bend = 0.0_wp
    bend(:kin%dim) = self%amplitude*sin(self%omega*time) - 2.0_wp*u(:kin%dim)
    bend = 2.0_wp*self%wave_number**2*bend
    arm = reference - self%center + u
    b = -self%omega**2*u - self%speed_squared*product(stretch)/stretch**2*bend
    b(:2) = b(:2) + 2.0_wp*self%spin*[-v(2), v(1)] - self%spin**2*arm(:2)
    b(:2) = turned(self%spin*time, b(:2))
  end function rotating_block_driver_acceleration

  !> The exact state of a point.
  pure subroutine rotating_block_driver_exact(self, kin, reference, time, state)
    !> The driver.
    class(rotating_block_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> State.
    type(exact_state_t), intent(out) :: state
    real(wp) :: arm(2), e(2), stretch(3), t(3), u(3), v(3)

    call self%vibration(kin, reference, time, u, v, stretch)
    arm = reference(:2) - self%center(:2) + u(:2)
    state%displacement = u
    state%displacement(:2) = turned(self%spin*time, arm) - (reference(:2) - self%center(:2))
    state%velocity = v
    state%velocity(:2) = turned(self%spin*time, v(:2) + self%spin*[-arm(2), arm(1)])
    state%jacobian = product(stretch)
    t = self%young*log(stretch)
    e = turned(self%spin*time, [1.0_wp, 0.0_wp])
    state%stress(1) = t(1)*e(1)**2 + t(2)*e(2)**2
    state%stress(2) = t(1)*e(2)**2 + t(2)*e(1)**2
    state%stress(3) = t(3)
    state%stress(4) = (t(1) - t(2))*e(1)*e(2)
  end subroutine rotating_block_driver_exact

  !> A vector turned about z.
  pure function turned(angle, vector) result(turn)
    !> Angle.
    real(wp), intent(in) :: angle
    !> Components x, y.
    real(wp), intent(in) :: vector(2)
    !> Its components after the turn.
    real(wp) :: turn(2)

    turn = cos(angle)*vector + sin(angle)*[-vector(2), vector(1)]
  end function turned

end module mpm_rotating_block_driver
