!> Distance of the nodes of a grid to the surface of a cloud of points, negative inside.
!!
!! First each node has its distance to the nearest point less the radius of a point; where it
!! changes sign along an edge of the grid, a point of the surface lies at its linear zero. The
!! distance to the nearest of those, with the sign kept, is the level set.
module mpm_level_set
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_point_cells, only: point_cells_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: far, level_set_t

  !> Distance where there is nothing near.
  real(wp), parameter :: far = 1.0e10_wp

  !> Distances at the nodes around a cloud of points.
  type :: level_set_t
    !> Dimensions.
    integer :: dim = 0
    !> Lower corner of the grid. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Spacing of the nodes. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Cells of the grid.
    integer :: n_cells(3) = 0
    !> The nodes that have a distance; all others are outside, far away.
    type(window_t) :: window
    !> Distances. [m] (nn)
    real(wp), allocatable :: distance(:)
  contains
    !> Take the nodes around points.
    procedure :: init => level_set_init
    !> Find the distances.
    procedure :: measure => level_set_measure
    !> Linear interpolation between the nodes of a cell.
    procedure :: at => level_set_at
    !> Nodes of the cell of a position, and their linear functions there.
    procedure :: hats => level_set_hats
    procedure, private :: position
    procedure, private :: find_surface
  end type level_set_t

contains

  !> Take the nodes around points.
  subroutine level_set_init(self, grid, n, x)
    !> The distances; not measured.
    class(level_set_t), intent(out) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Number of points.
    integer, intent(in) :: n
    !> Their positions in the box of the grid. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    real(wp) :: upper(3)
    integer :: periods(3), d, first, last

    self%dim = grid%kin%dim
    call grid%bounds(self%lower, upper)
    self%h = grid%spacing()
    periods = grid%periods()
    self%window%n = 1
    do d = 1, self%dim
      self%n_cells(d) = nint((upper(d) - self%lower(d))/self%h(d))
      first = 0
      last = self%n_cells(d)
      if (periods(d) == 0 .and. n > 0) then
        ! One node more than those of the points' cells, so that the surface is between nodes.
        first = max(first, int((minval(x(d, :n)) - self%lower(d))/self%h(d)) - 1)
        last = min(last, int((maxval(x(d, :n)) - self%lower(d))/self%h(d)) + 2)
      end if
      self%window%lo(d) = first
      self%window%n(d) = last - first + 1
    end do
    allocate (self%distance(self%window%size()))
    self%distance = far
  end subroutine level_set_init

  !> Find the distances.
  subroutine level_set_measure(self, cells, x, radius)
    !> The distances.
    class(level_set_t), intent(inout) :: self
    !> The points in cells of a side of at least 2 radii.
    type(point_cells_t), intent(in) :: cells
    !> Positions of the points. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    !> Radius of a point. [m]
    real(wp), intent(in) :: radius
    type(point_cells_t) :: surface
    real(wp), allocatable :: on_surface(:, :)
    real(wp) :: nearest
    integer :: i

    ! So many cells that nodes next to the surface see points wherever the faces of cells are.
    do i = 1, size(self%distance)
      nearest = nearest_point(cells, x, self%position(self%window%node(i)))
      if (nearest < far) self%distance(i) = nearest - radius
    end do
    call self%find_surface(on_surface)
    surface = cells
    call surface%fill([(i, i=1, size(on_surface, 2))], on_surface)
    do i = 1, size(self%distance)
      nearest = nearest_point(surface, on_surface, self%position(self%window%node(i)))
      self%distance(i) = sign(nearest, self%distance(i))
    end do
  end subroutine level_set_measure

  !> Distance to the nearest point in the 5**dim cells around a position; `far` when there is none.
  pure function nearest_point(cells, x, position) result(distance)
    !> The points in cells.
    type(point_cells_t), intent(in) :: cells
    !> Their positions. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    !> The position. [m] (dim)
    real(wp), intent(in) :: position(:)
    !> The distance. [m]
    real(wp) :: distance
    integer :: places(125), n_places, i, k

    distance = far
    call cells%around(cells%cell_of(position), 2, places, n_places)
    do i = 1, n_places
      do k = cells%begin(places(i)), cells%begin(places(i) + 1) - 1
        distance = min(distance, norm2(cells%way(position, x(:, cells%point(k)))))
      end do
    end do
  end function nearest_point

  !> Position of a node.
  pure function position(self, node) result(x)
    !> The distances.
    class(level_set_t), intent(in) :: self
    !> Grid indices of the node.
    integer, intent(in) :: node(3)
    !> Its position. [m]
    real(wp) :: x(self%dim)

    x = self%lower(:self%dim) + real(node(:self%dim), wp)*self%h(:self%dim)
  end function position

  !> Points of the surface: linear zeros of the distance along the edges of the grid.
  pure subroutine find_surface(self, x)
    !> The distances to points less their radius.
    class(level_set_t), intent(in) :: self
    !> Positions. [m] (dim, number)
    real(wp), allocatable, intent(out) :: x(:, :)
    real(wp) :: here, there
    integer :: i, d, n, pass, node(3), next(3)

    do pass = 1, 2
      n = 0
      do i = 1, size(self%distance)
        node = self%window%node(i)
        here = self%distance(i)
        do d = 1, self%dim
          next = node
          next(d) = next(d) + 1
          if (.not. self%window%holds(next)) cycle
          there = self%distance(self%window%index(next))
          if ((here > 0.0_wp) .eqv. (there > 0.0_wp)) cycle
          n = n + 1
          if (pass == 1) cycle
          x(:, n) = self%position(node)
          x(d, n) = x(d, n) + self%h(d)*here/(here - there)
        end do
      end do
      if (pass == 1) allocate (x(self%dim, n))
    end do
  end subroutine find_surface

  !> Nodes of the cell of a position, and their linear functions there.
  pure subroutine level_set_hats(self, x, nodes, weights)
    !> The distances.
    class(level_set_t), intent(in) :: self
    !> Position in the box of the grid. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Places in the window, 0 outside of it. (2**dim of them)
    integer, intent(out) :: nodes(8)
    !> Values of the functions. (2**dim of them)
    real(wp), intent(out) :: weights(8)
    real(wp) :: xi(3)
    integer :: cell(3), node(3), c, d

    cell = 0
    xi = 0.0_wp
    do d = 1, self%dim
      xi(d) = (x(d) - self%lower(d))/self%h(d)
      cell(d) = max(0, min(int(xi(d)), self%n_cells(d) - 1))
      xi(d) = xi(d) - real(cell(d), wp)
    end do
    nodes = 0
    weights = 0.0_wp
    do c = 0, 2**self%dim - 1
      node = cell
      weights(c + 1) = 1.0_wp
      do d = 1, self%dim
        if (btest(c, d - 1)) then
          node(d) = node(d) + 1
          weights(c + 1) = weights(c + 1)*xi(d)
        else
          weights(c + 1) = weights(c + 1)*(1.0_wp - xi(d))
        end if
      end do
      if (self%window%holds(node)) nodes(c + 1) = self%window%index(node)
    end do
  end subroutine level_set_hats

  !> Linear interpolation between the nodes of a cell.
  pure function level_set_at(self, x) result(distance)
    !> The distances.
    class(level_set_t), intent(in) :: self
    !> Position in the box of the grid. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Distance to the surface, negative inside. [m]
    real(wp) :: distance
    real(wp) :: weights(8)
    integer :: nodes(8), c

    call self%hats(x, nodes, weights)
    distance = 0.0_wp
    do c = 1, 2**self%dim
      if (nodes(c) > 0) then
        distance = distance + weights(c)*self%distance(nodes(c))
      else
        distance = distance + weights(c)*far
      end if
    end do
  end function level_set_at

end module mpm_level_set
