!> The velocity of a grid at its nodes, where it differs from the velocities of the nodes.
module mpm_grid_velocity
  use mpm_kinds, only: wp
  use mpm_window, only: window_t
  implicit none
  private
  public :: at_nodes

contains

  !> v(x_i) = sum_j N_j(x_i) v_j for functions that reach the next nodes.
  !!
  !! At a node of a wall the function of that node is 1 and all others vanish.
  pure subroutine at_nodes(dim, n_cells, periodic, side, window, velocity, wide, values)
    !> Dimensions.
    integer, intent(in) :: dim
    !> Cells in each direction.
    integer, intent(in) :: n_cells(3)
    !> Directions in which the grid repeats.
    logical, intent(in) :: periodic(3)
    !> Value of a function at the next node, in each direction.
    real(wp), intent(in) :: side(3)
    !> Nodes that have velocities.
    type(window_t), intent(in) :: window
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(in) :: velocity(:, :)
    !> The nodes at which the functions of the window do not vanish.
    type(window_t), intent(out) :: wide
    !> Velocities of the grid there. [m/s] (nvel, nodes)
    real(wp), allocatable, intent(out) :: values(:, :)
    integer :: d, i, j, k, hi(3), node(3), here, there

    wide = window
    if (window%size() > 0) then
      do d = 1, dim
        call widen(n_cells(d), periodic(d), wide%lo(d), wide%n(d))
      end do
    end if
    allocate (values(size(velocity, 1), wide%size()))
    hi = wide%hi()
    do k = wide%lo(3), hi(3)
      do j = wide%lo(2), hi(2)
        do i = wide%lo(1), hi(1)
          node = [i, j, k]
          there = wide%index(node)
          values(:, there) = 0.0_wp
          if (.not. window%holds(node)) cycle
          here = window%index(node)
          values(:, there) = velocity(:, here)
        end do
      end do
    end do
    do d = 1, dim
      call filter(d, n_cells(d), periodic(d), side(d), wide, values)
    end do
  end subroutine at_nodes

  !> The nodes next to a range of nodes; all when the range touches a seam.
  pure subroutine widen(n_cells, periodic, lo, n)
    !> Cells.
    integer, intent(in) :: n_cells
    !> Whether the direction is periodic.
    logical, intent(in) :: periodic
    !> First node.
    integer, intent(inout) :: lo
    !> Number of nodes.
    integer, intent(inout) :: n
    integer :: hi

    hi = lo + n - 1
    if (periodic .and. (lo == 0 .or. hi >= n_cells - 1)) then
      lo = 0
      n = n_cells
    else
      lo = max(0, lo - 1)
      n = min(n_cells, hi + 1) - lo + 1
    end if
  end subroutine widen

  !> Replace velocities by the sums of the functions of three nodes in one direction.
  pure subroutine filter(d, n_cells, periodic, side, window, values)
    !> The direction.
    integer, intent(in) :: d
    !> Cells of the direction.
    integer, intent(in) :: n_cells
    !> Whether it is periodic.
    logical, intent(in) :: periodic
    !> Value of a function at the next node.
    real(wp), intent(in) :: side
    !> The nodes.
    type(window_t), intent(in) :: window
    !> Their values. (nvel, nn)
    real(wp), intent(inout) :: values(:, :)
    real(wp), allocatable :: old(:, :)
    integer :: i, j, k, hi(3), node(3), other(3), here, there, step

    allocate (old, source=values)
    hi = window%hi()
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          if (.not. periodic .and. (node(d) == 0 .or. node(d) == n_cells)) cycle
          here = window%index(node)
          values(:, here) = (1.0_wp - 2.0_wp*side)*old(:, here)
          do step = -1, 1, 2
            other = node
            other(d) = node(d) + step
            if (periodic) other(d) = modulo(other(d), n_cells)
            if (.not. window%holds(other)) cycle
            there = window%index(other)
            values(:, here) = values(:, here) + side*old(:, there)
          end do
        end do
      end do
    end do
  end subroutine filter

end module mpm_grid_velocity
