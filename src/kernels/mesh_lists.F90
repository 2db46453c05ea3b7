!> Lists of the nodes of points on a mesh.
!!
!! A point has the functions of its cell; or, averaged, the means over the 2**dim corners
!! x + a s of its box, a half of its half side, s the signs of a corner:
!! S_i = 2**-dim sum_c N_i(x_c), G_i = 2**-dim sum_c N_i(x_c) s_c/a. These are the functions of the
!! cell again when the cell has all corners, and are taken to be when a corner lies outside of the
!! mesh. Most corners share nodes with others: a point's list has each of its nodes once.
module mpm_mesh_lists
  use mpm_corner_shapes, only: corner_sign
  use mpm_kinds, only: wp
  use mpm_mesh, only: few, mesh_t, off_edge
  use mpm_node_list, only: node_list_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: list_nodes_of_cells

  !> Points that a thread treats together.
  integer, parameter :: block_size = 128

contains

  !> List the nodes of points with the values and gradients of their functions.
  subroutine list_nodes_of_cells(mesh, threads, averaged, n, x, extent, cell, corner_cell, list, &
                                 window)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of threads.
    integer, intent(in) :: threads
    !> Take means over the corners of the points' boxes.
    logical, intent(in) :: averaged
    !> Number of points, at least 1.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), contiguous, intent(in) :: x(:, :)
    !> Half sides of the boxes. [m] (n)
    real(wp), contiguous, intent(in) :: extent(:)
    !> Cells, from 1. (n)
    integer, contiguous, intent(in) :: cell(:)
    !> Cells of the corners, or 0 where a point has the functions of its cell; on entry a guess.
    !! (2**dim, at least n)
    integer, allocatable, intent(inout) :: corner_cell(:, :)
    !> The lists.
    type(node_list_t), intent(inout) :: list
    !> The nodes that the points reach.
    type(window_t), intent(out) :: window
    integer, allocatable :: entries(:)
    integer :: lo, hi, first

    lo = huge(1)
    hi = 0
    do first = 1, n
      lo = min(lo, mesh%span(1, cell(first)))
      hi = max(hi, mesh%span(2, cell(first)))
    end do
    allocate (entries(n), source=mesh%dim + 1)
    if (averaged) then
      call fit_corners(mesh%dim, n, corner_cell)
      call place_corners(mesh, threads, n, x, extent, cell, corner_cell, lo, hi)
      call count_nodes(mesh, threads, n, corner_cell, lo, hi, entries)
    end if
    window%lo = [lo - 1, 0, 0]
    window%n = [hi - lo + 1, 1, 1]
    call list%resize(mesh%dim, window%n(1), entries)
    if (averaged) then
      call fill_averages(mesh, threads, n, x, extent, cell, corner_cell, lo, hi, list)
    else
      call fill(mesh, threads, n, x, cell, lo, list)
    end if
    call list%cut(threads)
  end subroutine list_nodes_of_cells

  !> Give the guesses of the cells of corners room for all points.
  subroutine fit_corners(dim, n, corner_cell)
    !> Dimensions.
    integer, intent(in) :: dim
    !> Number of points.
    integer, intent(in) :: n
    !> Cells of the corners. (2**dim, at least n)
    integer, allocatable, intent(inout) :: corner_cell(:, :)

    if (allocated(corner_cell)) then
      if (size(corner_cell, 2) >= n) return
      deallocate (corner_cell)
    end if
    allocate (corner_cell(2**dim, n), source=0)
  end subroutine fit_corners

  !> Find the cells of the corners of points, as `list_nodes_of_cells` keeps them.
  subroutine place_corners(mesh, threads, n, x, extent, cell, corner_cell, lo, hi)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(in) :: x(mesh%dim, n)
    !> Half sides of the boxes. [m]
    real(wp), intent(in) :: extent(n)
    !> Cells.
    integer, intent(in) :: cell(n)
    !> Guesses; then the cells of the corners, or 0.
    integer, intent(inout) :: corner_cell(2**mesh%dim, n)
    !> Lowest node so far, from 1.
    integer, intent(inout) :: lo
    !> Highest node so far.
    integer, intent(inout) :: hi
    integer :: first, last

    !$omp parallel do default(none) schedule(static) num_threads(threads) private(last) &
    !$omp shared(mesh, n, x, extent, cell, corner_cell) reduction(min:lo) reduction(max:hi)
    do first = 1, n, block_size
      last = min(n, first + block_size - 1)
      select case (mesh%dim)
      case (1)
        call place_1d(mesh, first, last, x, extent, cell, mesh%affine, corner_cell, lo, hi)
      case (2)
        call place_2d(mesh, first, last, x, extent, cell, mesh%affine, corner_cell, lo, hi)
      case default
        call place_3d(mesh, first, last, x, extent, cell, mesh%affine, corner_cell, lo, hi)
      end select
    end do
    !$omp end parallel do
  end subroutine place_corners

  !> Count the nodes of points with means over corners.
  subroutine count_nodes(mesh, threads, n, corner_cell, lo, hi, entries)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points.
    integer, intent(in) :: n
    !> Cells of the corners, or 0.
    integer, intent(in) :: corner_cell(2**mesh%dim, n)
    !> Lowest node of the window, from 1.
    integer, intent(in) :: lo
    !> Highest node of the window.
    integer, intent(in) :: hi
    !> Nodes of each point; kept where the point has the functions of its cell.
    integer, intent(inout) :: entries(n)
    integer, allocatable :: visitor(:)
    integer :: first, last

    !$omp parallel default(none) num_threads(threads) private(last, visitor) &
    !$omp shared(mesh, n, corner_cell, lo, hi, entries)
    allocate (visitor(lo:hi), source=0)
    !$omp do schedule(static)
    do first = 1, n, block_size
      last = min(n, first + block_size - 1)
      select case (mesh%dim)
      case (1)
        call count_1d(first, last, corner_cell, mesh%n_cells, mesh%node, lo, visitor, entries)
      case (2)
        call count_2d(first, last, corner_cell, mesh%n_cells, mesh%node, lo, visitor, entries)
      case default
        call count_3d(first, last, corner_cell, mesh%n_cells, mesh%node, lo, visitor, entries)
      end select
    end do
    !$omp end do
    deallocate (visitor)
    !$omp end parallel
  end subroutine count_nodes

  !> Set the entries of points that have the functions of their cells.
  subroutine fill(mesh, threads, n, x, cell, lo, list)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(in) :: x(mesh%dim, n)
    !> Cells.
    integer, intent(in) :: cell(n)
    !> Lowest node of the window, from 1.
    integer, intent(in) :: lo
    !> The lists, with room.
    type(node_list_t), intent(inout) :: list
    integer :: first, last

    !$omp parallel do default(none) schedule(static) num_threads(threads) private(last) &
    !$omp shared(mesh, n, x, cell, lo, list)
    do first = 1, n, block_size
      last = min(n, first + block_size - 1)
      select case (mesh%dim)
      case (1)
        call fill_1d(first, last, x, cell, mesh%n_cells, mesh%affine, mesh%node, lo, &
                     list%offset, list%node, list%basis)
      case (2)
        call fill_2d(first, last, x, cell, mesh%n_cells, mesh%affine, mesh%node, lo, &
                     list%offset, list%node, list%basis)
      case default
        call fill_3d(first, last, x, cell, mesh%n_cells, mesh%affine, mesh%node, lo, &
                     list%offset, list%node, list%basis)
      end select
    end do
    !$omp end parallel do
  end subroutine fill

  !> Set the entries of points with means over corners.
  subroutine fill_averages(mesh, threads, n, x, extent, cell, corner_cell, lo, hi, list)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(in) :: x(mesh%dim, n)
    !> Half sides of the boxes. [m]
    real(wp), intent(in) :: extent(n)
    !> Cells.
    integer, intent(in) :: cell(n)
    !> Cells of the corners, or 0.
    integer, intent(in) :: corner_cell(2**mesh%dim, n)
    !> Lowest node of the window, from 1.
    integer, intent(in) :: lo
    !> Highest node of the window.
    integer, intent(in) :: hi
    !> The lists, with room.
    type(node_list_t), intent(inout) :: list
    integer, allocatable :: entry_of(:)
    integer :: first, last

    !$omp parallel default(none) num_threads(threads) private(last, entry_of) &
    !$omp shared(mesh, n, x, extent, cell, corner_cell, lo, hi, list)
    allocate (entry_of(lo:hi), source=0)
    !$omp do schedule(static)
    do first = 1, n, block_size
      last = min(n, first + block_size - 1)
      select case (mesh%dim)
      case (1)
        call average_1d(first, last, x, extent, cell, corner_cell, mesh%n_cells, mesh%affine, &
                        mesh%node, lo, list%offset, entry_of, list%node, list%basis)
      case (2)
        call average_2d(first, last, x, extent, cell, corner_cell, mesh%n_cells, mesh%affine, &
                        mesh%node, lo, list%offset, entry_of, list%node, list%basis)
      case default
        call average_3d(first, last, x, extent, cell, corner_cell, mesh%n_cells, mesh%affine, &
                        mesh%node, lo, list%offset, entry_of, list%node, list%basis)
      end select
    end do
    !$omp end do
    deallocate (entry_of)
    !$omp end parallel
  end subroutine fill_averages

#define DIM 1
#define HOLDS holds_box_1d
#define PLACE place_1d
#define COUNT_NODES count_1d
#define FILL fill_1d
#define AVERAGE average_1d
#include "mesh_lists_template.inc"
#undef DIM
#undef HOLDS
#undef PLACE
#undef COUNT_NODES
#undef FILL
#undef AVERAGE
#define DIM 2
#define HOLDS holds_box_2d
#define PLACE place_2d
#define COUNT_NODES count_2d
#define FILL fill_2d
#define AVERAGE average_2d
#include "mesh_lists_template.inc"
#undef DIM
#undef HOLDS
#undef PLACE
#undef COUNT_NODES
#undef FILL
#undef AVERAGE
#define DIM 3
#define HOLDS holds_box_3d
#define PLACE place_3d
#define COUNT_NODES count_3d
#define FILL fill_3d
#define AVERAGE average_3d
#include "mesh_lists_template.inc"
#undef DIM
#undef HOLDS
#undef PLACE
#undef COUNT_NODES
#undef FILL
#undef AVERAGE

end module mpm_mesh_lists
