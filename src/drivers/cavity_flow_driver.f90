!> A lid that slides over a cavity.
module mpm_cavity_flow_driver
  use mpm_description, only: description_t
  use mpm_driver, only: driver_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_plane_strain
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: cavity_flow_driver_t

  !> No gravity; points in the uppermost cells have the velocity of the lid.
  type, extends(driver_t) :: cavity_flow_driver_t
    !> Velocity of the lid along x. [m/s]
    real(wp) :: lid_velocity = 0.0_wp
    !> Height above which points belong to the lid. [m]
    real(wp) :: lid_height = 0.0_wp
  contains
    procedure, nopass :: describe => cavity_flow_driver_describe
    procedure :: init => cavity_flow_driver_init
    procedure :: body_force => cavity_flow_driver_body_force
    procedure :: prepare => cavity_flow_driver_prepare
    procedure :: before_step => cavity_flow_driver_before_step
  end type cavity_flow_driver_t

contains

  !> Purpose and properties of the class.
  subroutine cavity_flow_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'CavityFlowDriver', &
                          'Flow in a cavity under a sliding lid: before each step all points in &
                          &the uppermost row of cells get the velocity U along x. No gravity. &
                          &TYPE 2.', &
                          'Ghia, Ghia and Shin, J. Comput. Phys. 48 (1982) 387-411', &
                          'driver'//nl//'{'//nl//'    class = "CavityFlowDriver"'//nl// &
                          '    properties = {10, 1}   # t_stop, U'//nl//'}')
    call description%add_real('t_stop', 's', 'stop time')
    call description%add_real('U', 'm/s', 'velocity of the lid along x')
  end subroutine cavity_flow_driver_describe

  !> Set up from the properties.
  subroutine cavity_flow_driver_init(self, properties, error)
    !> The driver.
    class(cavity_flow_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    self%t_stop = properties%real('t_stop')
    self%lid_velocity = properties%real('U')
  end subroutine cavity_flow_driver_init

  !> None.
  pure function cavity_flow_driver_body_force(self, kin) result(b)
    !> The driver.
    class(cavity_flow_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    associate (unused => self, unused_kin => kin)
    end associate
    b = 0.0_wp
  end function cavity_flow_driver_body_force

  !> Find the height of the lid.
  subroutine cavity_flow_driver_prepare(self, model, error)
    !> The driver.
    class(cavity_flow_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Another TYPE than 2.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: lower(3), upper(3), h(3)

    if (model%kin%sim_type /= type_plane_strain) then
      call raise(error, err_input, 'CavityFlowDriver is for TYPE 2', &
                 hint='set TYPE = 2, or take another driver')
      return
    end if
    call model%grid%bounds(lower, upper)
    h = model%grid%spacing()
    self%lid_height = upper(2) - h(2)
  end subroutine cavity_flow_driver_prepare

  !> Give the points at the lid its velocity.
  subroutine cavity_flow_driver_before_step(self, model)
    !> The driver.
    class(cavity_flow_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(inout) :: model
    integer :: i

    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        associate (points => body%points, n => body%points%n_inside)
          where (points%x(2, :n) > self%lid_height) points%velocity(1, :n) = self%lid_velocity
        end associate
      end associate
    end do
  end subroutine cavity_flow_driver_before_step

end module mpm_cavity_flow_driver
