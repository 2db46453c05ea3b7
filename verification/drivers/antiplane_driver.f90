!> Shear out of the plane of the grid.
module mpm_antiplane_driver
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_out_of_plane
  use mpm_load_driver, only: add_load_properties, exact_state_t, load_driver_t, &
                             read_load_properties
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: antiplane_driver_t

  !> Half a turn.
  real(wp), parameter :: pi = acos(-1.0_wp)

  !> Displacement u_z = g(t) f(X), g = A sin(omega t), f = sin(k X)**2, k = pi/length.
  !!
  !! The deformation is the simple shear c = g f', L_zx = dc/dt all there is of the velocity
  !! gradient. From S = 0 the Jaumann rate gives S_zx = G sin c and S_zz = -S_xx = G (1 - cos c):
  !! with W_zx = -W_xz = (dc/dt)/2 it says dS_zx/dt = (dc/dt) (G - S_zz), dS_zz/dt = (dc/dt) S_zx.
  !! Places and volumes do not change, so that DIV P = div S has the components
  !! dS_xx/dX = -G sin(c) c' and dS_zx/dX = G cos(c) c', c' = g f''. The in-plane body force is
  !! what holds the points in their place: b_x = (G/rho) sin(c) c'.
  type, extends(load_driver_t) :: antiplane_driver_t
    !> Largest displacement A. [m]
    real(wp) :: amplitude = 0.0_wp
    !> Wave number k. [1/m]
    real(wp) :: wave_number = pi
    !> G/rho. [m2/s2]
    real(wp) :: speed_squared = 0.0_wp
    !> Shear modulus G. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Angular frequency. [1/s]
    real(wp) :: omega = 0.0_wp
    !> Where X is 0. [m]
    real(wp) :: origin = 0.0_wp
  contains
    procedure, nopass :: describe => antiplane_driver_describe
    procedure :: init => antiplane_driver_init
    procedure :: acceleration => antiplane_driver_acceleration
    procedure :: exact => antiplane_driver_exact
  end type antiplane_driver_t

contains

  !> Purpose and properties of the class.
  subroutine antiplane_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'AntiplaneDriver', &
                          'Manufactured solution: out-of-plane displacement A sin(omega t) &
                          &sin(pi X/length)^2 of the block 0 < X < length, whose faces are free.', &
                          'Simple shear with the Jaumann rate: Dienes, Acta Mechanica 32 (1979) &
                          &217-232', &
                          'driver'//nl//'{'//nl//'    class = "AntiplaneDriver"'//nl// &
                          '    properties = {t_stop = 2, amplitude = 0.1, length = 1, '// &
                          'density = 1, E = 2.6, nu = 0.3}'//nl//'}')
    call add_load_properties(description)
    call description%add_real('amplitude', 'm', 'largest displacement A', above=0.0_wp)
    call description%add_real('length', 'm', 'length of the block', above=0.0_wp)
    call description%add_real('density', 'kg/m3', 'density in the reference configuration', &
                              above=0.0_wp)
    call description%add_real('E', 'Pa', 'Young''s modulus of the material', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio of the material', above=-1.0_wp, &
                              below=0.5_wp)
    call description%add_real('omega', '1/s', 'angular frequency; 0: pi c/length with c = &
                              &sqrt(G/density)', default=0.0_wp, lower=0.0_wp)
    call description%add_real('origin_x', 'm', 'where X is 0', default=0.0_wp)
    call description%add_note('For TYPE 5; uniform along y. Displacement and traction vanish at &
                              &X = 0 and X = length, tractions on faces along x vanish anywhere.')
    call description%add_note('For IsotropicLinearElasticity. The shear, pi A/length at most, must &
                              &stay below pi/2, where its modulus G cos c is 0 and the equations &
                              &of motion are no longer elliptic.')
    call description%add_note('The second-order stresses S_zz = -S_xx need a body force in the &
                              &plane, without which the points move along x.')
  end subroutine antiplane_driver_describe

  !> Set up from the properties.
  subroutine antiplane_driver_init(self, properties, error)
    !> The driver.
    class(antiplane_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Too large a shear.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: length

    call read_load_properties(self, properties)
    self%types = .false.
    self%types(type_out_of_plane) = .true.
    self%amplitude = properties%real('amplitude')
    length = properties%real('length')
    self%wave_number = pi/length
    self%shear = properties%real('E')/(2.0_wp*(1.0_wp + properties%real('nu')))
    self%speed_squared = self%shear/properties%real('density')
    self%omega = properties%real('omega')
    if (.not. self%omega > 0.0_wp) self%omega = self%wave_number*sqrt(self%speed_squared)
    self%origin = properties%real('origin_x')
    if (self%amplitude < 0.5_wp*length) return
    call properties%reject('amplitude', 'the shear would reach '// &
                           to_text(self%wave_number*self%amplitude, 3)//', not below pi/2', &
                           error, 'use an amplitude below half the length')
  end subroutine antiplane_driver_init

  !> Body force per unit mass.
  pure function antiplane_driver_acceleration(self, kin, reference, x, velocity, time) result(b)
    !> The driver.
    class(antiplane_driver_t), intent(in) :: self
    !> Component counts; not used.
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
    real(wp) :: angle, g, shear, shear_gradient

    associate (unused => kin, unused_x => x, unused_velocity => velocity)
    end associate
    angle = self%wave_number*(reference(1) - self%origin)
    g = self%amplitude*sin(self%omega*time)
    shear = g*self%wave_number*sin(2.0_wp*angle)
    shear_gradient = 2.0_wp*g*self%wave_number**2*cos(2.0_wp*angle)
    b(1) = self%speed_squared*sin(shear)*shear_gradient
    b(2) = 0.0_wp
    b(3) = -self%omega**2*g*sin(angle)**2 - self%speed_squared*cos(shear)*shear_gradient
  end function antiplane_driver_acceleration

  !> The exact state of a point.
  pure subroutine antiplane_driver_exact(self, kin, reference, time, state)
    !> The driver.
    class(antiplane_driver_t), intent(in) :: self
    !> Component counts; not used.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> State.
    type(exact_state_t), intent(out) :: state
    real(wp) :: angle, g, shear

    associate (unused => kin)
    end associate
    angle = self%wave_number*(reference(1) - self%origin)
    g = self%amplitude*sin(self%omega*time)
    shear = g*self%wave_number*sin(2.0_wp*angle)
    state%displacement(3) = g*sin(angle)**2
    state%velocity(3) = self%amplitude*self%omega*cos(self%omega*time)*sin(angle)**2
    state%stress(3) = 2.0_wp*self%shear*sin(0.5_wp*shear)**2
    state%stress(1) = -state%stress(3)
    state%stress(6) = self%shear*sin(shear)
  end subroutine antiplane_driver_exact

end module mpm_antiplane_driver
