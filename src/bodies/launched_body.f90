!> A body that starts with a velocity given by speed and angle.
module mpm_launched_body
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_1d
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: launched_body_t

  !> A body that is thrown.
  type, extends(body_t) :: launched_body_t
  contains
    procedure, nopass :: describe => launched_body_describe
    procedure :: init => launched_body_init
  end type launched_body_t

contains

  !> Purpose and properties of the class.
  subroutine launched_body_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('body', 'LaunchedBody', &
                          'A body that starts with a speed in a direction; other components of &
                          &the velocity are as in the points file.', &
                          'elementary', &
                          'body'//nl//'{'//nl//'    class = "LaunchedBody"'//nl// &
                          '    name = "block_0"'//nl// &
                          '    properties = {10, 45}   # speed, angle'//nl// &
                          '    point-file = "block_0.points"'//nl// &
                          '    point-class = "DefaultPoints"'//nl// &
                          '    node-class = "DefaultNodes"'//nl//'}')
    call description%add_real('speed', 'm/s', 'speed', lower=0.0_wp)
    call description%add_real('angle', 'degrees', 'angle from the x axis (TYPE 4: r) towards the &
                              &last direction of the grid')
    call description%add_note('TYPE 1: the velocity is speed cos(angle) (mpm_3d: speed &
                              &sin(angle)).')
  end subroutine launched_body_describe

  !> Give all points their velocity.
  subroutine launched_body_init(self, grid, properties, error)
    !> The body.
    class(launched_body_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error
    real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
    real(wp) :: speed, angle

    speed = properties%real('speed')
    angle = degree*properties%real('angle')
    self%points%velocity(1, :) = speed*cos(angle)
    if (grid%kin%sim_type == type_1d) return
    self%points%velocity(grid%kin%dim, :) = speed*sin(angle)
  end subroutine launched_body_init

end module mpm_launched_body
