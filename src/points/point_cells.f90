!> Points in equal cells of a size of their own, in which neighbours are looked for.
!!
!! The cells divide the box of the grid; only those around the points have memory. Distances are to
!! the nearest image in directions in which the grid repeats.
module mpm_point_cells
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_strings, only: to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: point_cells_t

  !> Cells, and the points in each.
  type :: point_cells_t
    !> Dimensions.
    integer :: dim = 0
    !> Lower corner of the grid. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Lengths of the grid. [m]
    real(wp) :: length(3) = 1.0_wp
    !> Sides of a cell. [m]
    real(wp) :: side(3) = 1.0_wp
    !> Cells of the whole grid in each direction; 1 in unused ones.
    integer :: n(3) = 1
    !> Directions in which the grid repeats.
    logical :: periodic(3) = .false.
    !> The cells that have memory.
    type(window_t) :: window
    !> First place of each cell in `point`. (cells + 1)
    integer, allocatable :: begin(:)
    !> The points, cell by cell.
    integer, allocatable :: point(:)
  contains
    !> Divide the box of a grid.
    procedure :: init => point_cells_init
    !> Sort points into the cells.
    procedure :: fill => point_cells_fill
    !> Cell of a position.
    procedure :: cell_of => point_cells_cell_of
    !> The cells around one.
    procedure :: around => point_cells_around
    !> The way from one position to another.
    procedure :: way => point_cells_way
  end type point_cells_t

contains

  !> Divide the box of a grid into cells of about a side.
  subroutine point_cells_init(self, grid, side, message)
    !> The cells.
    class(point_cells_t), intent(out) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Smallest side of a cell. [m]
    real(wp), intent(in) :: side
    !> Why the box can't be divided; not allocated when it can.
    character(:), allocatable, intent(out) :: message
    real(wp) :: upper(3), most
    integer :: periods(3), d

    self%dim = grid%kin%dim
    call grid%bounds(self%lower, upper)
    periods = grid%periods()
    self%periodic = periods > 0
    do d = 1, self%dim
      self%length(d) = upper(d) - self%lower(d)
      most = self%length(d)/side
      ! With fewer cells in a period, two images of one point would be neighbours.
      if (most < merge(2.0_wp, 1.0_wp, self%periodic(d))) then
        message = 'cells of side '//to_text(side)//' m do not fit into the grid, whose length &
                  &along '//achar(iachar('x') + d - 1)//' is '//to_text(self%length(d))//' m'
        return
      end if
      self%n(d) = int(min(most, 1.0e9_wp))
      self%side(d) = self%length(d)/real(self%n(d), wp)
    end do
  end subroutine point_cells_init

  !> Sort points into the cells; within a cell they stay in the order in which they come.
  subroutine point_cells_fill(self, points, x)
    !> The cells.
    class(point_cells_t), intent(inout) :: self
    !> The points. (n)
    integer, intent(in) :: points(:)
    !> Positions in the box of the grid. [m] (dim, at least the largest of `points`)
    real(wp), intent(in) :: x(:, :)
    integer, allocatable :: cell(:)
    integer :: at(3), hi(3), i, c, before

    if (allocated(self%begin)) deallocate (self%begin, self%point)
    self%window = window_t()
    if (size(points) > 0) then
      self%window%lo = huge(1)
      hi = 0
      do i = 1, size(points)
        at = self%cell_of(x(:, points(i)))
        self%window%lo = min(self%window%lo, at)
        hi = max(hi, at)
      end do
      self%window%n = hi - self%window%lo + 1
    end if
    allocate (self%begin(self%window%size() + 1), self%point(size(points)), cell(size(points)))
    self%begin = 0
    do i = 1, size(points)
      cell(i) = self%window%index(self%cell_of(x(:, points(i))))
      self%begin(cell(i)) = self%begin(cell(i)) + 1
    end do
    before = 1
    do c = 1, size(self%begin)
      i = self%begin(c)
      self%begin(c) = before
      before = before + i
    end do
    do i = 1, size(points)
      self%point(self%begin(cell(i))) = points(i)
      self%begin(cell(i)) = self%begin(cell(i)) + 1
    end do
    do c = size(self%begin), 2, -1
      self%begin(c) = self%begin(c - 1)
    end do
    self%begin(1) = 1
  end subroutine point_cells_fill

  !> Cell of a position in the box of the grid.
  pure function point_cells_cell_of(self, x) result(cell)
    !> The cells.
    class(point_cells_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Indices from 0; 0 in unused directions.
    integer :: cell(3)
    integer :: d

    cell = 0
    do d = 1, self%dim
      cell(d) = int((x(d) - self%lower(d))/self%side(d))
      if (self%periodic(d)) then
        cell(d) = modulo(cell(d), self%n(d))
      else
        cell(d) = max(0, min(cell(d), self%n(d) - 1))
      end if
    end do
  end function point_cells_cell_of

  !> The cells around one, itself included, as places in the window; each once.
  pure subroutine point_cells_around(self, cell, reach, places, count)
    !> The cells.
    class(point_cells_t), intent(in) :: self
    !> Indices of the cell.
    integer, intent(in) :: cell(3)
    !> How many cells to go in each direction, at most 2.
    integer, intent(in) :: reach
    !> Places in the window. (first `count`)
    integer, intent(out) :: places(125)
    !> Number of cells that have memory.
    integer, intent(out) :: count
    integer :: first(3), last(3), at(3), i, j, k, d

    first = 0
    last = 0
    do d = 1, self%dim
      first(d) = -reach
      last(d) = reach
      ! Cells of a short period must not be met twice.
      if (self%periodic(d)) last(d) = min(last(d), first(d) + self%n(d) - 1)
    end do
    count = 0
    do k = first(3), last(3)
      do j = first(2), last(2)
        do i = first(1), last(1)
          at = cell + [i, j, k]
          where (self%periodic) at = modulo(at, self%n)
          if (.not. self%window%holds(at)) cycle
          count = count + 1
          places(count) = self%window%index(at)
        end do
      end do
    end do
  end subroutine point_cells_around

  !> The way from one position to the nearest image of another.
  pure function point_cells_way(self, from, to) result(way)
    !> The cells.
    class(point_cells_t), intent(in) :: self
    !> Start. [m] (dim)
    real(wp), intent(in) :: from(:)
    !> End. [m] (dim)
    real(wp), intent(in) :: to(:)
    !> End less start. [m] (dim)
    real(wp) :: way(size(from))
    integer :: d

    way = to - from
    do d = 1, size(from)
      if (.not. self%periodic(d)) cycle
      if (way(d) > 0.5_wp*self%length(d)) way(d) = way(d) - self%length(d)
      if (way(d) < -0.5_wp*self%length(d)) way(d) = way(d) + self%length(d)
    end do
  end function point_cells_way

end module mpm_point_cells
