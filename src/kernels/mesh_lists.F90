!> Lists of the nodes of points on a mesh.
!!
!! A point has the functions of its cell; or, averaged, the means over the 2**dim corners
!! x + a s of its box, a half of its half side, s the signs of a corner:
!! S_i = 2**-dim sum_c N_i(x_c), G_i = 2**-dim sum_c N_i(x_c) s_c/a. These are the functions of the
!! cell again when the cell has all corners, and are taken to be when a corner lies outside of the
!! mesh.
module mpm_mesh_lists
  use mpm_kinds, only: wp
  use mpm_mesh, only: mesh_t, off_edge
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
    real(wp), intent(in) :: extent(:)
    !> Cells, from 1. (n)
    integer, intent(in) :: cell(:)
    !> Cells of the corners, or 0 where a point has the functions of its cell; on entry a guess.
    !! (2**dim, n)
    integer, allocatable, intent(inout) :: corner_cell(:, :)
    !> The lists.
    type(node_list_t), intent(inout) :: list
    !> The nodes that the points reach.
    type(window_t), intent(out) :: window
    integer, allocatable :: entries(:)
    integer :: lo, hi, first, last, e

    allocate (entries(n), source=mesh%dim + 1)
    lo = huge(1)
    hi = 0
    if (averaged) then
      call fit_corners(mesh%dim, n, corner_cell)
      !$omp parallel do default(none) schedule(static) num_threads(threads) private(last) &
      !$omp shared(mesh, n, x, extent, cell, corner_cell, entries) &
      !$omp reduction(min:lo) reduction(max:hi)
      do first = 1, n, block_size
        last = min(n, first + block_size - 1)
        call place_corners(mesh, last - first + 1, x(:, first:last), extent(first:last), &
                           cell(first:last), corner_cell(:, first:last), entries(first:last), lo, &
                           hi)
      end do
      !$omp end parallel do
    else
      do first = 1, n
        lo = min(lo, mesh%span(1, cell(first)))
        hi = max(hi, mesh%span(2, cell(first)))
      end do
    end if
    window%lo = [lo - 1, 0, 0]
    window%n = [hi - lo + 1, 1, 1]
    call list%resize(mesh%dim, window%n(1), entries)
    !$omp parallel do default(none) schedule(static) num_threads(threads) private(last, e) &
    !$omp shared(mesh, averaged, n, x, extent, cell, corner_cell, list, lo)
    do first = 1, n, block_size
      last = min(n, first + block_size - 1)
      if (averaged) then
        call fill_averages(mesh, last - first + 1, x(:, first:last), extent(first:last), &
                           cell(first:last), corner_cell(:, first:last), lo, &
                           list%offset(first - 1:last), list%node, list%basis)
      else
        e = list%offset(first - 1) + 1
        call fill(mesh, last - first + 1, x(:, first:last), cell(first:last), lo, list%node(e:), &
                  list%basis(:, e:))
      end if
    end do
    !$omp end parallel do
    call list%cut(threads)
  end subroutine list_nodes_of_cells

  !> Give the guesses of the cells of corners room for all points.
  subroutine fit_corners(dim, n, corner_cell)
    !> Dimensions.
    integer, intent(in) :: dim
    !> Number of points.
    integer, intent(in) :: n
    !> Cells of the corners. (2**dim, n)
    integer, allocatable, intent(inout) :: corner_cell(:, :)

    if (allocated(corner_cell)) then
      if (size(corner_cell, 2) == n) return
      deallocate (corner_cell)
    end if
    allocate (corner_cell(2**dim, n), source=0)
  end subroutine fit_corners

  !> Find the cells of the corners of a block of points.
  subroutine place_corners(mesh, n, x, extent, cell, corner_cell, entries, lo, hi)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(in) :: x(mesh%dim, n)
    !> Half sides of the boxes. [m]
    real(wp), intent(in) :: extent(n)
    !> Cells.
    integer, intent(in) :: cell(n)
    !> Guesses; then the cells of the corners, the first one 0 where the cell of the point counts.
    integer, intent(inout) :: corner_cell(2**mesh%dim, n)
    !> Entries of each point.
    integer, intent(out) :: entries(n)
    !> Lowest node so far, from 1.
    integer, intent(inout) :: lo
    !> Highest node so far.
    integer, intent(inout) :: hi
    real(wp) :: corner(3)
    integer :: p, c, d, distinct, guess

    do p = 1, n
      distinct = 1
      if (holds_box(mesh, cell(p), x(:, p), 0.5_wp*extent(p))) then
        corner_cell(:, p) = 0
      else
        do c = 1, 2**mesh%dim
          do d = 1, mesh%dim
            corner(d) = x(d, p) + 0.5_wp*extent(p)*sign_of(d, c)
          end do
          guess = corner_cell(c, p)
          if (guess <= 0) guess = cell(p)
          corner_cell(c, p) = mesh%find(corner(:mesh%dim), guess)
          if (corner_cell(c, p) < 0) exit
        end do
        if (c > 2**mesh%dim) then
          do c = 2, 2**mesh%dim
            do d = 1, c - 1
              if (corner_cell(d, p) == corner_cell(c, p)) exit
            end do
            if (d == c) distinct = distinct + 1
          end do
          do c = 1, 2**mesh%dim
            lo = min(lo, mesh%span(1, corner_cell(c, p)))
            hi = max(hi, mesh%span(2, corner_cell(c, p)))
          end do
        else
          corner_cell(:, p) = 0
        end if
      end if
      lo = min(lo, mesh%span(1, cell(p)))
      hi = max(hi, mesh%span(2, cell(p)))
      entries(p) = distinct*(mesh%dim + 1)
    end do
  end subroutine place_corners

  !> Whether a cell has all corners of a box.
  pure function holds_box(mesh, cell, x, half)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> The cell.
    integer, intent(in) :: cell
    !> Centre of the box. [m]
    real(wp), intent(in) :: x(mesh%dim)
    !> Half of its side. [m]
    real(wp), intent(in) :: half
    !> Whether it has.
    logical :: holds_box
    real(wp) :: value(0:3), g(3), total
    integer :: k, d

    call mesh%values(cell, x, value)
    g = 0.0_wp
    holds_box = .true.
    do k = 1, mesh%dim
      total = 0.0_wp
      do d = 1, mesh%dim
        total = total + abs(mesh%affine(d, k, cell))
        g(d) = g(d) + mesh%affine(d, k, cell)
      end do
      holds_box = holds_box .and. value(k) >= half*total
    end do
    holds_box = holds_box .and. value(0) >= half*sum(abs(g))
  end function holds_box

  !> Sign of a corner in a direction, x fastest.
  elemental function sign_of(d, corner)
    !> The direction.
    integer, intent(in) :: d
    !> Number of the corner, from 1.
    integer, intent(in) :: corner
    !> -1 or 1.
    real(wp) :: sign_of

    sign_of = merge(1.0_wp, -1.0_wp, btest(corner - 1, d - 1))
  end function sign_of

  !> Set the entries of a block of points that have the functions of their cells.
  pure subroutine fill(mesh, n, x, cell, lo, node, basis)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(in) :: x(mesh%dim, n)
    !> Cells.
    integer, intent(in) :: cell(n)
    !> Lowest node of the window, from 1.
    integer, intent(in) :: lo
    !> Nodes, from 1 in the window.
    integer, contiguous, intent(inout) :: node(:)
    !> Values and gradients. [-, 1/m]
    real(wp), contiguous, intent(inout) :: basis(:, :)

    select case (mesh%dim)
    case (1)
      call fill_1d(n, x, cell, mesh%n_cells, mesh%affine, mesh%node, lo, node, basis)
    case (2)
      call fill_2d(n, x, cell, mesh%n_cells, mesh%affine, mesh%node, lo, node, basis)
    case default
      call fill_3d(n, x, cell, mesh%n_cells, mesh%affine, mesh%node, lo, node, basis)
    end select
  end subroutine fill

  !> Set the entries of a block of points with means over corners.
  subroutine fill_averages(mesh, n, x, extent, cell, corner_cell, lo, offset, node, basis)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
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
    !> Entries before those behind each point.
    integer, intent(in) :: offset(0:n)
    !> Nodes of all entries, from 1 in the window.
    integer, contiguous, intent(inout) :: node(:)
    !> Values and gradients. [-, 1/m] (0:dim, entries)
    real(wp), contiguous, intent(inout) :: basis(:, :)
    integer :: p, e, last

    do p = 1, n
      e = offset(p - 1) + 1
      last = offset(p)
      if (corner_cell(1, p) == 0) then
        call fill(mesh, 1, x(:, p:p), cell(p:p), lo, node(e:last), basis(:, e:last))
      else
        call fill_point(mesh, x(:, p), 0.5_wp*extent(p), corner_cell(:, p), lo, node(e:last), &
                        basis(:, e:last))
      end if
    end do
  end subroutine fill_averages

  !> Set the entries of a point with means over corners.
  pure subroutine fill_point(mesh, x, half, corner_cell, lo, node, basis)
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> Position. [m]
    real(wp), intent(in) :: x(mesh%dim)
    !> Distance of the corners along each direction. [m]
    real(wp), intent(in) :: half
    !> Cells of the corners.
    integer, intent(in) :: corner_cell(2**mesh%dim)
    !> Lowest node of the window, from 1.
    integer, intent(in) :: lo
    !> Nodes, from 1 in the window.
    integer, contiguous, intent(inout) :: node(:)
    !> Values and gradients. [-, 1/m] (1 + dim, entries)
    real(wp), contiguous, intent(inout) :: basis(:, :)
    real(wp) :: value(0:3), s(3), at(3), weight, slope
    integer :: distinct(8), begin(8), known, c, k, e, d

    weight = 0.5_wp**mesh%dim
    slope = weight/half
    known = 0
    basis = 0.0_wp
    do c = 1, 2**mesh%dim
      associate (cell => corner_cell(c))
        do d = 1, mesh%dim
          s(d) = sign_of(d, c)
          at(d) = x(d) + half*s(d)
        end do
        do k = 1, known
          if (distinct(k) == cell) exit
        end do
        if (k > known) then
          known = k
          distinct(k) = cell
          begin(k) = (k - 1)*(mesh%dim + 1)
          node(begin(k) + 1:begin(k) + mesh%dim + 1) = mesh%node(:, cell) - lo + 1
        end if
        e = begin(k)
        call mesh%values(cell, at, value)
        call off_edge(value(:mesh%dim))
        do k = 0, mesh%dim
          basis(1, e + k + 1) = basis(1, e + k + 1) + weight*value(k)
          do d = 1, mesh%dim
            basis(d + 1, e + k + 1) = basis(d + 1, e + k + 1) + slope*value(k)*s(d)
          end do
        end do
      end associate
    end do
  end subroutine fill_point

#define DIM 1
#define FILL fill_1d
#include "mesh_lists_template.inc"
#undef DIM
#undef FILL
#define DIM 2
#define FILL fill_2d
#include "mesh_lists_template.inc"
#undef DIM
#undef FILL
#define DIM 3
#define FILL fill_3d
#include "mesh_lists_template.inc"
#undef DIM
#undef FILL

end module mpm_mesh_lists
