!> A ball: a segment, a disc or a ball, by the dimensions of the grid.
module mpm_ball
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_part, only: part_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: ball_t

  !> Directions in the names of properties.
  character(1), parameter :: axes(3) = ['x', 'y', 'z']

  !> The positions with |x - centre| <= radius.
  type, extends(part_t) :: ball_t
    !> Centre, unused components 0. [m]
    real(wp) :: centre(3) = 0.0_wp
    !> Radius. [m]
    real(wp) :: radius = 0.0_wp
  contains
    procedure, nopass :: describe => ball_describe
    procedure :: init => ball_init
    procedure :: contains => ball_contains
    procedure :: bounds => ball_bounds
  end type ball_t

contains

  !> Purpose and properties of the class.
  subroutine ball_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    integer :: d

    call description%init('part', 'Ball', &
                          'A ball (TYPE 3), a disc (2, 5), a segment (1), or what a disc sweeps &
                          &around the axis (4): |x - centre| <= radius.', &
                          'The generator texts of mpm_3d v3', &
                          'part'//nl//'{'//nl//'    class = "Ball"'//nl// &
                          '    properties = {0.5, 0.5, 0.2}   # centre_x, centre_y, radius'// &
                          nl//'}')
    do d = 1, 3
      call description%add_real('centre_'//axes(d), 'm', 'centre along '//axes(d), &
                                types=types_with_dim(d))
    end do
    call description%add_real('radius', 'm', 'radius of the ball', above=0.0_wp)
  end subroutine ball_describe

  !> Set the shape from its properties.
  subroutine ball_init(self, kin, properties, error)
    !> The part.
    class(ball_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error
    integer :: d

    do d = 1, kin%dim
      self%centre(d) = properties%real('centre_'//axes(d))
    end do
    self%radius = properties%real('radius')
  end subroutine ball_init

  !> Whether a position is in the ball or on its surface.
  pure function ball_contains(self, x) result(inside)
    !> The part.
    class(ball_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is inside.
    logical :: inside

    inside = norm2(x - self%centre(:size(x))) <= self%radius
  end function ball_contains

  !> A box around the ball.
  pure subroutine ball_bounds(self, lower, upper)
    !> The part.
    class(ball_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    ! Halves do not overflow.
    lower = 2.0_wp*max(-0.5_wp*huge(1.0_wp), 0.5_wp*self%centre - 0.5_wp*self%radius)
    upper = 2.0_wp*min(0.5_wp*huge(1.0_wp), 0.5_wp*self%centre + 0.5_wp*self%radius)
  end subroutine ball_bounds

end module mpm_ball
