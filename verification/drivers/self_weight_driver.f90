!> A column under its own weight.
module mpm_self_weight_driver
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_1d, type_3d
  use mpm_load_driver, only: add_load_properties, exact_state_t, load_driver_t, &
                             read_load_properties
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: self_weight_driver_t

  !> Half a turn.
  real(wp), parameter :: pi = acos(-1.0_wp)

  !> A column on a fixed base between rollers, along the vertical axis of the TYPE.
  !!
  !! With Y the height above the base in the reference configuration, the vertical stress in
  !! equilibrium is -rho g (l0 - Y) whatever the material, rho the reference density. In uniaxial
  !! strain IsotropicLinearElasticity integrates to T = (lambda + 2 G) ln(dy/dY), hence with
  !! a = rho g/(lambda + 2 G)   dy/dY = exp(-a (l0 - Y)),   y = exp(-a l0) (exp(a Y) - 1)/a.
  type, extends(load_driver_t) :: self_weight_driver_t
    !> Magnitude of gravity. [m/s2]
    real(wp) :: gravity = 9.81_wp
    !> Height of the unstressed column. [m]
    real(wp) :: height = 1.0_wp
    !> Coordinate of the base. [m]
    real(wp) :: base = 0.0_wp
    !> Density of the unstressed column. [kg/m3]
    real(wp) :: density = 1.0_wp
    !> First Lame constant. [Pa]
    real(wp) :: lambda = 0.0_wp
    !> Shear modulus. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Time at which gravity is full. [s]
    real(wp) :: t_ramp = 0.0_wp
    !> Damping proportional to mass. [1/s]
    real(wp) :: damping = 0.0_wp
  contains
    procedure, nopass :: describe => self_weight_driver_describe
    procedure :: init => self_weight_driver_init
    procedure :: acceleration => self_weight_driver_acceleration
    procedure :: exact => self_weight_driver_exact
  end type self_weight_driver_t

contains

  !> Purpose and properties of the class.
  subroutine self_weight_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'SelfWeightDriver', &
                          'A column of IsotropicLinearElasticity under its own weight, on a fixed &
                          &base between rollers, along x (TYPE 1), y (TYPE 2, 5), z (TYPE 3) or &
                          &the axis z (TYPE 4).', &
                          'Equilibrium in uniaxial strain', &
                          'driver'//nl//'{'//nl//'    class = "SelfWeightDriver"'//nl// &
                          '    properties = {t_stop = 1, gravity = 10, height = 50, &
                          &density = 80, E = 1e6, nu = 0}'//nl//'}')
    call add_load_properties(description)
    call description%add_real('gravity', 'm/s2', 'gravity, downwards', above=0.0_wp)
    call description%add_real('height', 'm', 'height of the unstressed column', above=0.0_wp)
    call description%add_real('base', 'm', 'coordinate of the fixed base', default=0.0_wp)
    call description%add_real('density', 'kg/m3', 'density of the unstressed column', above=0.0_wp)
    call description%add_real('E', 'Pa', 'Young''s modulus, that of the material', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio, that of the material', above=-1.0_wp, &
                              below=0.5_wp)
    call description%add_real('t_ramp', 's', 'exact_start = 0: gravity rises from 0 at t = 0 to &
                              &its full value at this time', default=0.0_wp, lower=0.0_wp)
    call description%add_real('damping', '1/s', 'acceleration against the velocity, over it', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_integer('exact_start', '1: begin in equilibrium; 0: begin with the &
                                 &points as they are', default=1, lower=0, upper=1)
    call description%add_note('The points file holds the reference positions and volumes.')
  end subroutine self_weight_driver_describe

  !> Set up from the properties.
  subroutine self_weight_driver_init(self, properties, error)
    !> The driver.
    class(self_weight_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: young, poisson

    call read_load_properties(self, properties)
    young = properties%real('E')
    poisson = properties%real('nu')
    self%lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    self%shear = young/(2.0_wp*(1.0_wp + poisson))
    self%gravity = properties%real('gravity')
    self%height = properties%real('height')
    self%density = properties%real('density')
    self%base = properties%real('base')
    self%t_ramp = properties%real('t_ramp')
    self%damping = properties%real('damping')
    self%exact_start = properties%integer('exact_start') == 1
  end subroutine self_weight_driver_init

  !> Gravity, which may rise along half a cosine, and damping.
  pure function self_weight_driver_acceleration(self, kin, reference, x, velocity, time) result(b)
    !> The driver.
    class(self_weight_driver_t), intent(in) :: self
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
    real(wp) :: share
    integer :: up

    associate (unused => reference, unused_x => x)
    end associate
    share = 1.0_wp
    if (.not. self%exact_start .and. time < self%t_ramp) then
      share = 0.5_wp*(1.0_wp - cos(pi*max(0.0_wp, time/self%t_ramp)))
    end if
    up = vertical(kin)
    b = -self%damping*velocity
    b(up) = b(up) - share*self%gravity
  end function self_weight_driver_acceleration

  !> The equilibrium under full gravity, at any time.
  pure subroutine self_weight_driver_exact(self, kin, reference, time, state)
    !> The driver.
    class(self_weight_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> The state.
    type(exact_state_t), intent(out) :: state
    real(wp) :: modulus, a, y
    integer :: up

    associate (unused => time)
    end associate
    up = vertical(kin)
    modulus = self%lambda + 2.0_wp*self%shear
    a = self%density*self%gravity/modulus
    y = reference(up) - self%base
    ! (exp(a Y) - 1)/a loses its digits where a Y is small; sinh does not.
    state%displacement(up) = 2.0_wp*exp(a*(0.5_wp*y - self%height))*sinh(0.5_wp*a*y)/a - y
    state%jacobian = exp(-a*(self%height - y))
    state%stress(:3) = -self%density*self%gravity*(self%height - y)*self%lambda/modulus
    state%stress(up) = -self%density*self%gravity*(self%height - y)
  end subroutine self_weight_driver_exact

  !> Component along which the column stands.
  pure function vertical(kin) result(up)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> 1 to 3.
    integer :: up

    select case (kin%sim_type)
    case (type_1d)
      up = 1
    case (type_3d)
      up = 3
    case default
      up = 2
    end select
  end function vertical

end module mpm_self_weight_driver
