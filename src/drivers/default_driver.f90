!> Standard gravity until a stop time.
module mpm_default_driver
  use mpm_description, only: description_t
  use mpm_driver, only: driver_t, standard_gravity
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: default_driver_t

  !> Standard gravity, 9.81 m/s2 downwards.
  type, extends(driver_t) :: default_driver_t
  contains
    procedure, nopass :: describe => default_driver_describe
    procedure :: init => default_driver_init
    procedure :: body_force => default_driver_body_force
  end type default_driver_t

contains

  !> Purpose and properties of the class.
  subroutine default_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'DefaultDriver', &
                          'Steps of equal length to the stop time under gravity, 9.81 m/s2 along &
                          &-x (TYPE 1), -y (TYPE 2, 4, 5; the height in TYPE 4) or -z (TYPE 3).', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'driver'//nl//'{'//nl//'    class = "DefaultDriver"'//nl// &
                          '    properties = {1}   # t_stop'//nl//'}')
    call description%add_real('t_stop', 's', 'stop time')
    call description%add_note('The last step is shortened so that the run ends at the stop time; &
                              &frames are labelled with the time of the state that they hold.')
  end subroutine default_driver_describe

  !> Set up from the properties.
  subroutine default_driver_init(self, properties, error)
    !> The driver.
    class(default_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    self%t_stop = properties%real('t_stop')
  end subroutine default_driver_init

  !> Standard gravity.
  pure function default_driver_body_force(self, kin) result(b)
    !> The driver.
    class(default_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    associate (unused => self)
    end associate
    b = standard_gravity(kin)
  end function default_driver_body_force

end module mpm_default_driver
