!> A box with faces along the axes.
module mpm_box
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_part, only: part_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: box_t

  !> Directions in the names of properties.
  character(1), parameter :: axes(3) = ['x', 'y', 'z']

  !> The positions with lower <= x <= upper in each direction.
  type, extends(part_t) :: box_t
    !> Lower corner, unused components 0. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Upper corner, unused components 0. [m]
    real(wp) :: upper(3) = 0.0_wp
  contains
    procedure, nopass :: describe => box_describe
    procedure :: init => box_init
    procedure :: contains => box_contains
    procedure :: bounds => box_bounds
  end type box_t

contains

  !> Purpose and properties of the class.
  subroutine box_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    integer :: d

    call description%init('part', 'Box', &
                          'A box with faces along the axes: min <= x <= max in each direction.', &
                          'The generator texts of mpm_3d v3', &
                          'part'//nl//'{'//nl//'    class = "Box"'//nl// &
                          '    properties = {0.2, 0.0, 0.8, 0.4}   # min_x, min_y, max_x, max_y'// &
                          nl//'}')
    do d = 1, 3
      call description%add_real('min_'//axes(d), 'm', 'lower face along '//axes(d), &
                                types=types_with_dim(d))
    end do
    do d = 1, 3
      call description%add_real('max_'//axes(d), 'm', 'upper face along '//axes(d), &
                                types=types_with_dim(d))
    end do
  end subroutine box_describe

  !> Set the shape from its properties.
  subroutine box_init(self, kin, properties, error)
    !> The part.
    class(box_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An upper face that is not above the lower one.
    type(error_t), allocatable, intent(out) :: error
    integer :: d

    do d = 1, kin%dim
      self%lower(d) = properties%real('min_'//axes(d))
      self%upper(d) = properties%real('max_'//axes(d))
      if (self%upper(d) > self%lower(d)) cycle
      call properties%reject('max_'//axes(d), 'max_'//axes(d)//' = '//to_text(self%upper(d))// &
                             ' is not above min_'//axes(d)//' = '//to_text(self%lower(d)), error, &
                             'a box has its lower corner first, then its upper corner')
      return
    end do
  end subroutine box_init

  !> Whether a position is in the box or on a face.
  pure function box_contains(self, x) result(inside)
    !> The part.
    class(box_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is inside.
    logical :: inside

    inside = all(self%lower(:size(x)) <= x .and. x <= self%upper(:size(x)))
  end function box_contains

  !> The box itself.
  pure subroutine box_bounds(self, lower, upper)
    !> The part.
    class(box_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    lower = self%lower
    upper = self%upper
  end subroutine box_bounds

end module mpm_box
