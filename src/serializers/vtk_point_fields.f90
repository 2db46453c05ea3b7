!> The point file of one body and frame.
module mpm_vtk_point_fields
  use mpm_body, only: body_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_points, only: points_t
  use mpm_strings, only: to_text
  use mpm_vtk_fields, only: block_size, vtk_fields_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: vtk_point_fields_t

  !> Points in the order of the points file, as vertex cells.
  type, extends(vtk_fields_t) :: vtk_point_fields_t
    private
    !> Storage slots of the points in the file. (entries)
    integer, allocatable :: slot(:)
    !> Points of the points file for each point in the file.
    integer :: stride = 1
  contains
    !> Start the file and write the positions.
    procedure :: open => vtk_point_fields_open
    procedure :: locate => vtk_point_fields_locate
    procedure :: label => vtk_point_fields_label
    procedure, private :: put_positions
  end type vtk_point_fields_t

contains

  !> Start the file and write the positions.
  subroutine vtk_point_fields_open(self, body, path, title, digits, when, error, &
                                   binary, stride)
    !> The file.
    class(vtk_point_fields_t), intent(inout) :: self
    !> The body; without points the file has none.
    class(body_t), intent(in) :: body
    !> Name of the file.
    character(*), intent(in) :: path
    !> Title line.
    character(*), intent(in) :: title
    !> Significant digits.
    integer, intent(in) :: digits
    !> Frame and time, for messages.
    character(*), intent(in) :: when
    !> The file can't be written.
    type(error_t), allocatable, intent(out) :: error
    !> Numbers as bytes instead of text.
    logical, intent(in) :: binary
    !> One in so many points is written; 1 when left out.
    integer, intent(in), optional :: stride
    integer, allocatable :: slot(:)
    integer :: entry

    call self%file%open(path, title, digits, error, binary)
    if (allocated(error)) return
    self%body = body%name
    self%when = when
    self%whole%n = 0
    if (allocated(body%points)) then
      self%kin = body%points%kin
      if (present(stride)) self%stride = stride
      self%n_values = body%points%n
      self%whole%n = [body%points%n/self%stride, 1, 1]
      slot = body%points%slots()
      self%slot = [(slot(1 + (entry - 1)*self%stride), entry=1, self%whole%n(1))]
    end if
    call self%file%start_points(self%whole%size())
    if (self%whole%size() > 0) call self%put_positions(body%points)
    call self%file%put_vertices(self%whole%size())
    call self%file%start_fields(self%whole%size())
  end subroutine vtk_point_fields_open

  !> Write the positions.
  subroutine put_positions(self, points)
    !> The file.
    class(vtk_point_fields_t), intent(inout) :: self
    !> The points.
    class(points_t), intent(in) :: points
    real(wp) :: x(3, block_size)
    integer :: first, m, i

    x = 0.0_wp
    do first = 1, self%whole%size(), block_size
      m = min(block_size, self%whole%size() - first + 1)
      do i = 1, m
        x(:self%kin%dim, i) = points%x(:, self%slot(first + i - 1))
      end do
      call self%check('position', first, 3, m, x)
      call self%file%put_points(x(:, :m))
    end do
  end subroutine put_positions

  !> Storage slots of a range of points of the points file.
  subroutine vtk_point_fields_locate(self, first, window, source)
    !> The file.
    class(vtk_point_fields_t), intent(in) :: self
    !> First point, from 1.
    integer, intent(in) :: first
    !> All points.
    type(window_t), intent(in) :: window
    !> Slots.
    integer, intent(out) :: source(:)

    associate (unused => window)
    end associate
    source = self%slot(first:first + size(source) - 1)
  end subroutine vtk_point_fields_locate

  !> A point by its position in the points file.
  pure function vtk_point_fields_label(self, entry) result(text)
    !> The file.
    class(vtk_point_fields_t), intent(in) :: self
    !> Point, from 1.
    integer, intent(in) :: entry
    !> Its name.
    character(:), allocatable :: text

    text = 'point '//to_text(1 + (entry - 1)*self%stride)
  end function vtk_point_fields_label

end module mpm_vtk_point_fields
