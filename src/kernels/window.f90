!> A box of grid nodes: the part of the grid for which a body has memory.
module mpm_window
  implicit none
  private
  public :: intersect, window_t

  !> The nodes `lo .. lo + n - 1` in each direction; unused directions have lo = 0, n = 1.
  type :: window_t
    !> Lowest node index in each direction, from 0.
    integer :: lo(3) = 0
    !> Number of nodes in each direction; 0 in an empty window.
    integer :: n(3) = 0
  contains
    !> Number of nodes.
    procedure :: size => window_size
    !> Position of a node in the window's arrays.
    procedure :: index => window_index
    !> Node at a position in the window's arrays.
    procedure :: node => window_node
    !> Position before a node in the window's arrays.
    procedure :: start => window_start
    !> Highest node index in each direction.
    procedure :: hi => window_hi
    !> Whether a node is in the window.
    procedure :: holds => window_holds
  end type window_t

contains

  !> Number of nodes.
  pure function window_size(self) result(n)
    !> The window.
    class(window_t), intent(in) :: self
    !> Number of nodes.
    integer :: n

    n = product(self%n)
  end function window_size

  !> Position of a node in the window's arrays, from 1; x varies fastest.
  pure function window_index(self, node) result(position)
    !> The window.
    class(window_t), intent(in) :: self
    !> Grid indices of the node, from 0.
    integer, intent(in) :: node(3)
    !> Position, from 1.
    integer :: position

    position = 1 + node(1) - self%lo(1) &
               + self%n(1)*(node(2) - self%lo(2) + self%n(2)*(node(3) - self%lo(3)))
  end function window_index

  !> Node at a position in the window's arrays.
  pure function window_node(self, position) result(node)
    !> The window.
    class(window_t), intent(in) :: self
    !> Position, from 1.
    integer, intent(in) :: position
    !> Grid indices of the node, from 0.
    integer :: node(3)
    integer :: rest

    rest = position - 1
    node(1) = self%lo(1) + mod(rest, self%n(1))
    rest = rest/self%n(1)
    node(2) = self%lo(2) + mod(rest, self%n(2))
    node(3) = self%lo(3) + rest/self%n(2)
  end function window_node

  !> Position before a node in the window's arrays: that of the node, less one.
  pure function window_start(self, node) result(position)
    !> The window.
    class(window_t), intent(in) :: self
    !> Grid indices of the node, from 0.
    integer, intent(in) :: node(3)
    !> Position, from 0.
    integer :: position

    position = window_index(self, node) - 1
  end function window_start

  !> Highest node index in each direction.
  pure function window_hi(self) result(hi)
    !> The window.
    class(window_t), intent(in) :: self
    !> Highest node index, from 0.
    integer :: hi(3)

    hi = self%lo + self%n - 1
  end function window_hi

  !> Whether a node is in the window.
  pure function window_holds(self, node) result(holds)
    !> The window.
    class(window_t), intent(in) :: self
    !> Grid indices of the node, from 0.
    integer, intent(in) :: node(3)
    !> Whether it is in the window.
    logical :: holds

    holds = all(node >= self%lo .and. node < self%lo + self%n)
  end function window_holds

  !> The nodes that two windows share; empty (n = 0) when there are none.
  pure function intersect(a, b) result(both)
    !> First window.
    type(window_t), intent(in) :: a
    !> Second window.
    type(window_t), intent(in) :: b
    !> Their intersection.
    type(window_t) :: both

    both%lo = max(a%lo, b%lo)
    both%n = max(0, min(a%lo + a%n, b%lo + b%n) - both%lo)
    if (any(both%n == 0)) both%n = 0
  end function intersect

end module mpm_window
