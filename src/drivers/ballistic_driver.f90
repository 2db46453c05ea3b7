!> A projectile that waits for t = 0.
module mpm_ballistic_driver
  use mpm_body_list, only: find_body
  use mpm_default_driver, only: default_driver_t
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: ballistic_driver_t

  !> Standard gravity; one body is launched at t = 0.
  type, extends(default_driver_t) :: ballistic_driver_t
    !> Velocity at launch. [m/s]
    real(wp) :: launch_velocity(3) = 0.0_wp
    !> Position of the projectile in the model's list.
    integer :: projectile = 0
    !> The properties, until the bodies exist.
    type(properties_t), private :: properties
  contains
    procedure, nopass :: describe => ballistic_driver_describe
    procedure :: init => ballistic_driver_init
    procedure :: prepare => ballistic_driver_prepare
    procedure :: before_step => ballistic_driver_before_step
  end type ballistic_driver_t

contains

  !> Purpose and properties of the class.
  subroutine ballistic_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'BallisticDriver', &
                          'As DefaultDriver; one body, the projectile, is launched at t = 0. A &
                          &negative start time lets the target settle before that.', &
                          'Dunatunga and Kamrin, J. Mech. Phys. Solids 100 (2017) 45-60', &
                          'driver'//nl//'{'//nl//'    class = "BallisticDriver"'//nl// &
                          '    properties = {0.5, 0.0, -10.0}   # t_stop, vx, vy'//nl// &
                          '    str-properties = {"projectile"}'//nl//'}')
    call description%add_real('t_stop', 's', 'stop time')
    call description%add_real('vx', 'm/s', 'velocity at launch along x (TYPE 4: r)')
    call description%add_real('vy', 'm/s', 'velocity at launch along y (TYPE 4: z)', &
                              types=types_with_dim(2))
    call description%add_real('vz', 'm/s', 'velocity at launch along z', types=types_with_dim(3))
    call description%add_integer('id', 'the projectile by its number, from 0, when no name is &
                                 &given', default=-1, lower=0)
    call description%add_string('projectile', 'name of the projectile', default='')
    call description%add_note('Until it is launched the projectile maps nothing, moves nothing and &
                              &touches nothing; its frames hold positions only.')
  end subroutine ballistic_driver_describe

  !> Set up from the properties.
  subroutine ballistic_driver_init(self, properties, error)
    !> The driver.
    class(ballistic_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    call self%default_driver_t%init(properties, error)
    self%launch_velocity = [properties%real('vx'), properties%real('vy'), properties%real('vz')]
    self%properties = properties
  end subroutine ballistic_driver_init

  !> Find the projectile, give it its velocity and hold it back.
  subroutine ballistic_driver_prepare(self, model, error)
    !> The driver.
    class(ballistic_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> There is no such body.
    type(error_t), allocatable, intent(out) :: error
    integer :: d

    call find_body(model%bodies, self%properties, 'projectile', 'id', self%projectile, error)
    if (allocated(error)) return
    associate (body => model%bodies(self%projectile)%body)
      body%points%velocity = 0.0_wp
      do d = 1, model%kin%dim
        body%points%velocity(d, :) = self%launch_velocity(d)
      end do
      body%active = due(model)
    end associate
  end subroutine ballistic_driver_prepare

  !> Launch the projectile before the first step with t >= 0.
  subroutine ballistic_driver_before_step(self, model)
    !> The driver.
    class(ballistic_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(inout) :: model

    if (due(model)) model%bodies(self%projectile)%body%active = .true.
  end subroutine ballistic_driver_before_step

  !> Whether the time has come: t >= 0, which t_start + n dt may miss by a rounding error.
  pure function due(model)
    !> The model.
    type(model_t), intent(in) :: model
    !> Whether the projectile is launched.
    logical :: due

    due = model%time >= -1.0e-6_wp*model%dt
  end function due

end module mpm_ballistic_driver
