!> A constant body force until a stop time.
module mpm_user_defined_gravity_driver
  use mpm_description, only: description_t, types_with_velocity
  use mpm_driver, only: driver_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: add_gravity_properties, user_defined_gravity_driver_t

  !> A constant body force.
  type, extends(driver_t) :: user_defined_gravity_driver_t
    !> Acceleration. [m/s2]
    real(wp) :: gravity(3) = 0.0_wp
  contains
    procedure, nopass :: describe => user_defined_gravity_driver_describe
    procedure :: init => user_defined_gravity_driver_init
    procedure :: body_force => user_defined_gravity_driver_body_force
  end type user_defined_gravity_driver_t

contains

  !> Purpose and properties of the class.
  subroutine user_defined_gravity_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'UserDefinedGravityDriver', &
                          'Steps of equal length to the stop time under a constant body force.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'driver'//nl//'{'//nl//'    class = "UserDefinedGravityDriver"'//nl// &
                          '    properties = {1, 0, -9.81}   # t_stop, gx, gy'//nl//'}')
    call add_gravity_properties(description)
  end subroutine user_defined_gravity_driver_describe

  !> Declare the properties that `init` reads; to be called before any other is added.
  subroutine add_gravity_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_real('t_stop', 's', 'stop time')
    call description%add_real('gx', 'm/s2', 'acceleration along x (TYPE 4: r)')
    call description%add_real('gy', 'm/s2', 'acceleration along y (TYPE 4: z)', &
                              types=types_with_velocity(2))
    call description%add_real('gz', 'm/s2', 'acceleration along z (TYPE 4: theta)', &
                              types=types_with_velocity(3))
  end subroutine add_gravity_properties

  !> Set up from the properties.
  subroutine user_defined_gravity_driver_init(self, properties, error)
    !> The driver.
    class(user_defined_gravity_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    self%t_stop = properties%real('t_stop')
    self%gravity = [properties%real('gx'), properties%real('gy'), properties%real('gz')]
  end subroutine user_defined_gravity_driver_init

  !> The constant body force.
  pure function user_defined_gravity_driver_body_force(self, kin) result(b)
    !> The driver.
    class(user_defined_gravity_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    b = 0.0_wp
    b(:kin%nvel) = self%gravity(:kin%nvel)
  end function user_defined_gravity_driver_body_force

end module mpm_user_defined_gravity_driver
