!> Manufactured solution with displacements along the axes.
module mpm_axis_aligned_driver
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_load_driver, only: add_load_properties, exact_state_t, load_driver_t, &
                             read_load_properties
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: axis_aligned_driver_t

  !> Half a turn.
  real(wp), parameter :: pi = acos(-1.0_wp)

  !> Standing waves along each axis, u_i = A sin(k X_i) sin(omega t + phi_i).
  !!
  !! Nothing rotates, hence the Jaumann rate integrates to the logarithmic law
  !! T_ii = lambda ln J + 2 G ln F_ii with F_ii = 1 + A k cos(k X_i) sin(omega t + phi_i). The body
  !! force is b_i = d2u_i/dt2 - DIV P_i/rho, where P_ii = J T_ii/F_ii; J/F_ii does not depend on
  !! X_i, so that b_i = u_i ((lambda + 2 G)/rho k**2 J/F_ii**2 - omega**2).
  type, extends(load_driver_t) :: axis_aligned_driver_t
    !> Amplitude A. [m]
    real(wp) :: amplitude = 0.0_wp
    !> Wave number k. [1/m]
    real(wp) :: wave_number = pi
    !> Angular frequency. [1/s]
    real(wp) :: omega = 0.0_wp
    !> Phases. [rad]
    real(wp) :: phase(3) = 0.0_wp
    !> Density in the reference configuration. [kg/m3]
    real(wp) :: density = 1.0_wp
    !> First Lame constant. [Pa]
    real(wp) :: lambda = 0.0_wp
    !> Shear modulus. [Pa]
    real(wp) :: shear = 0.0_wp
  contains
    procedure, nopass :: describe => axis_aligned_driver_describe
    procedure :: init => axis_aligned_driver_init
    procedure :: acceleration => axis_aligned_driver_acceleration
    procedure :: exact => axis_aligned_driver_exact
    !> Phase factors and stretches of a point.
    procedure, private :: motion => axis_aligned_driver_motion
  end type axis_aligned_driver_t

contains

  !> Purpose and properties of the class.
  subroutine axis_aligned_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'AxisAlignedDriver', &
                          'Manufactured solution for IsotropicLinearElasticity in a box with &
                          &rollers: u_i = A sin(pi X_i/length) sin(omega t + phi_i) along each &
                          &axis of the grid.', &
                          'Wallstedt and Guilkey, J. Comput. Phys. 227 (2008) 9628-9642; stress &
                          &and body force derived for the Jaumann rate', &
                          'driver'//nl//'{'//nl//'    class = "AxisAlignedDriver"'//nl// &
                          '    properties = {t_stop = 0.02, amplitude = 1e-4, length = 1, &
                          &density = 1000, E = 1e7, nu = 0}'//nl//'}')
    call add_load_properties(description)
    call description%add_real('amplitude', 'm', 'amplitude A; pi |A|/length is below 1')
    call description%add_real('length', 'm', 'side of the box, half a wave length', above=0.0_wp)
    call description%add_real('density', 'kg/m3', 'density of the undeformed body', above=0.0_wp)
    call description%add_real('E', 'Pa', 'Young''s modulus, that of the material', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio, that of the material', above=-1.0_wp, &
                              below=0.5_wp)
    call description%add_real('omega', '1/s', 'angular frequency; 0: that of a free wave of small &
                              &amplitude, pi sqrt((lambda + 2 G)/density)/length', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_real('phi_x', 'rad', 'phase along x', default=0.0_wp)
    call description%add_real('phi_y', 'rad', 'phase along y', default=0.0_wp, &
                              types=types_with_dim(2))
    call description%add_real('phi_z', 'rad', 'phase along z', default=0.0_wp, &
                              types=types_with_dim(3))
    call description%add_note('The points file holds the reference positions and volumes. Not in &
                              &TYPE 4; out-of-plane components are 0 in TYPE 5.')
  end subroutine axis_aligned_driver_describe

  !> Set up from the properties.
  subroutine axis_aligned_driver_init(self, properties, error)
    !> The driver.
    class(axis_aligned_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An amplitude that turns the body inside out.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: young, poisson

    call read_load_properties(self, properties)
    self%types(type_axisymmetric) = .false.
    young = properties%real('E')
    poisson = properties%real('nu')
    self%lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    self%shear = young/(2.0_wp*(1.0_wp + poisson))
    self%density = properties%real('density')
    self%amplitude = properties%real('amplitude')
    self%wave_number = pi/properties%real('length')
    self%omega = properties%real('omega')
    if (.not. self%omega > 0.0_wp) then
      self%omega = self%wave_number*sqrt((self%lambda + 2.0_wp*self%shear)/self%density)
    end if
    self%phase = [properties%real('phi_x'), properties%real('phi_y'), properties%real('phi_z')]
    if (abs(self%amplitude)*self%wave_number < 1.0_wp) return
    call properties%reject('amplitude', 'the amplitude turns the body inside out', error, &
                           hint='keep pi |amplitude|/length below 1')
  end subroutine axis_aligned_driver_init

  !> Body force of the manufactured solution.
  pure function axis_aligned_driver_acceleration(self, kin, reference, x, velocity, time) result(b)
    !> The driver.
    class(axis_aligned_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Position. [m]
    real(wp), intent(in) :: x(3)
    !> Velocity. [m/s]
    real(wp), intent(in) :: velocity(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Acceleration. [m/s2]
    real(wp) :: b(3)
    real(wp) :: factor(3), stretch(3), speed_squared

    associate (unused => x, unused_velocity => velocity)
    end associate
    call self%motion(kin, reference, time, factor, stretch)
    speed_squared = (self%lambda + 2.0_wp*self%shear)/self%density
    b = self%amplitude*sin(self%wave_number*reference)*factor &
        *(speed_squared*self%wave_number**2*product(stretch)/stretch**2 - self%omega**2)
  end function axis_aligned_driver_acceleration

  !> Exact state of a point.
  pure subroutine axis_aligned_driver_exact(self, kin, reference, time, state)
    !> The driver.
    class(axis_aligned_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> The state.
    type(exact_state_t), intent(out) :: state
    real(wp) :: factor(3), stretch(3)
    integer :: d

    call self%motion(kin, reference, time, factor, stretch)
    do d = 1, kin%dim
      state%displacement(d) = self%amplitude*sin(self%wave_number*reference(d))*factor(d)
      state%velocity(d) = self%amplitude*sin(self%wave_number*reference(d))*self%omega &
                          *cos(self%omega*time + self%phase(d))
    end do
    state%jacobian = product(stretch)
    state%stress(:3) = self%lambda*log(state%jacobian) + 2.0_wp*self%shear*log(stretch)
  end subroutine axis_aligned_driver_exact

  !> Phase factors and stretches of a point: 0 and 1 along directions without motion.
  pure subroutine axis_aligned_driver_motion(self, kin, reference, time, factor, stretch)
    !> The driver.
    class(axis_aligned_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> sin(omega t + phi_i).
    real(wp), intent(out) :: factor(3)
    !> F_ii.
    real(wp), intent(out) :: stretch(3)

    factor = 0.0_wp
    factor(:kin%dim) = sin(self%omega*time + self%phase(:kin%dim))
    stretch = 1.0_wp + self%amplitude*self%wave_number*cos(self%wave_number*reference)*factor
  end subroutine axis_aligned_driver_motion

end module mpm_axis_aligned_driver
