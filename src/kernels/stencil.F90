!> One-dimensional stencils of tensor-product bases on Cartesian grids.
!!
!! Every basis on a Cartesian grid is a product of 1D functions. Per point and direction a stencil
!! gives the first node and the values and derivatives of the functions of `width` nodes; the
!! kernels multiply them. Two bases exist:
!!
!! - linear (hat functions), width 2;
!! - corner-averaged (`cpdi` flag 1 of mpm_3d): the mean of the hats at x + a and x - a, and their
!!   difference over 2a as derivative, with a = half of the point's half side. Width 3 while
!!   a <= h/2, 4 while a <= h. When any corner of the point's box lies outside the grid, the point
!!   uses the hats at its own position.
!!
!! A point on a node line belongs to the cell above it, a point on the upper face to the last cell,
!! so that the one-sided derivative of one cell is used everywhere. The far node of that cell, whose
!! function vanishes at the point but whose derivative does not, is given a weight of a few
!! roundings, so that it has a velocity also when no other point reaches it.
module mpm_stencil
  use mpm_kinds, only: wp
  implicit none
  private
  public :: stencil_t
  public :: axis_fraction, block_size, decode_keys, outside, stencil_keys, stencil_weights

  !> Points treated together by the kernels; their scratch fits the first-level cache.
  integer, parameter :: block_size = 128
  !> TYPE 4: below this fraction of the spacing from the axis, 1/r is replaced by its limit there.
  real(wp), parameter :: axis_fraction = 1.0e-3_wp
  !> Key of a point outside the grid.
  integer, parameter :: outside = -1

  !> What the kernels need to know of grid and basis.
  type :: stencil_t
    !> Dimensions of the grid.
    integer :: dim = 3
    !> Nodes per direction: 2, 3 or 4.
    integer :: width = 2
    !> Corner-averaged instead of plain hats.
    logical :: averaged = .false.
    !> Slopes of the best affine fit in place of the functions' derivatives.
    logical :: fitted = .false.
    !> Lower corner of the grid. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Spacing of the nodes. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Cells in each direction; 0 in unused ones.
    integer :: n_cells(3) = 0
  end type stencil_t

contains

  !> Keys of points: the flattened grid index of the first node of the stencil, or `outside`.
  pure subroutine stencil_keys(stencil, n, x, extent, key)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(stencil%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> b_x + (N_x + 1) (b_y + (N_y + 1) b_z). (n)
    integer, intent(out) :: key(n)
    real(wp) :: inverse_h(3), top(3), s(3), a(3)
    integer :: last(3), stride(3), p, d, b
    logical :: inside, averaged

    inverse_h = 1.0_wp/stencil%h
    top = real(stencil%n_cells, wp)
    last = max(0, stencil%n_cells + 1 - stencil%width)
    stride = [1, stencil%n_cells(1) + 1, (stencil%n_cells(1) + 1)*(stencil%n_cells(2) + 1)]
    do p = 1, n
      inside = .true.
      averaged = stencil%averaged
      do d = 1, stencil%dim
        s(d) = (x(d, p) - stencil%lower(d))*inverse_h(d)
        inside = inside .and. s(d) >= 0.0_wp .and. s(d) <= top(d)
        if (stencil%averaged) then
          a(d) = 0.5_wp*extent(p)*inverse_h(d)
          averaged = averaged .and. s(d) - a(d) >= 0.0_wp .and. s(d) + a(d) <= top(d)
        end if
      end do
      if (.not. inside) then
        key(p) = outside
        cycle
      end if
      key(p) = 0
      do d = 1, stencil%dim
        if (averaged) then
          b = int(s(d) - a(d))
        else
          b = int(s(d))
        end if
        key(p) = key(p) + stride(d)*min(b, last(d))
      end do
    end do
  end subroutine stencil_keys

  !> First nodes of the stencils of points from their keys.
  pure subroutine decode_keys(stencil, n, key, base)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Keys, none of them `outside`. (n)
    integer, intent(in) :: key(n)
    !> Grid indices of the first node, from 0; unused directions are 0. (3, n)
    integer, intent(out) :: base(3, n)
    integer :: p, row, previous, b(3)

    previous = outside
    b = 0
    do p = 1, n
      if (key(p) /= previous) then
        previous = key(p)
        row = previous/(stencil%n_cells(1) + 1)
        b(1) = previous - row*(stencil%n_cells(1) + 1)
        b(3) = row/(stencil%n_cells(2) + 1)
        b(2) = row - b(3)*(stencil%n_cells(2) + 1)
      end if
      base(:, p) = b
    end do
  end subroutine decode_keys

  !> Values and derivatives of the 1D functions at points.
  pure subroutine stencil_weights(stencil, n, x, extent, base, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(*)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> First nodes, as of `decode_keys`. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (width, dim, n)
    real(wp), intent(inout) :: w(*)
    !> Derivatives. [1/m] (width, dim, n)
    real(wp), intent(inout) :: dw(*)

    select case (10*stencil%dim + stencil%width)
    case (12)
      call weights_1d_2(stencil, n, x, base, w, dw)
    case (13)
      call weights_1d_3(stencil, n, x, extent, base, w, dw)
    case (14)
      call weights_1d_4(stencil, n, x, extent, base, w, dw)
    case (22)
      call weights_2d_2(stencil, n, x, base, w, dw)
    case (23)
      call weights_2d_3(stencil, n, x, extent, base, w, dw)
    case (24)
      call weights_2d_4(stencil, n, x, extent, base, w, dw)
    case (32)
      call weights_3d_2(stencil, n, x, base, w, dw)
    case (33)
      call weights_3d_3(stencil, n, x, extent, base, w, dw)
    case (34)
      call weights_3d_4(stencil, n, x, extent, base, w, dw)
    end select
    if (stencil%fitted .and. stencil%width > 2) then
      call fitted_slopes(stencil, stencil%width, stencil%dim, n, x, base, w, dw)
    end if
  end subroutine stencil_weights

  !> Replace derivatives by the weights of the best affine fit, w r/sum(w r**2) in each direction.
  !!
  !! r is the distance of a node from the weighted mean of the nodes, which is the point itself for
  !! functions that reproduce positions. Of hats the fit is the derivative, which stays where the
  !! point is so close to a node that the quotient is of roundings.
  pure subroutine fitted_slopes(stencil, width, dim, n, x, base, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(dim, n)
    !> First nodes. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (width, dim, n)
    real(wp), intent(in) :: w(width, dim, n)
    !> Derivatives, then slopes of the fit. [1/m] (width, dim, n)
    real(wp), intent(inout) :: dw(width, dim, n)
    real(wp), parameter :: least = 1.0e-3_wp
    real(wp) :: r(width), spread
    integer :: p, d, j

    do p = 1, n
      do d = 1, dim
        r = [(real(base(d, p) + j - 1, wp), j=1, width)] - (x(d, p) - stencil%lower(d))/stencil%h(d)
        r = r - sum(w(:, d, p)*r)
        spread = sum(w(:, d, p)*r**2)
        if (spread > least) dw(:, d, p) = w(:, d, p)*r/(spread*stencil%h(d))
      end do
    end do
  end subroutine fitted_slopes

  !> Keep a local coordinate of a cell a few roundings away from both its nodes.
  elemental function off_node(xi) result(inside)
    !> Coordinate in the cell, 0 to 1.
    real(wp), intent(in) :: xi
    !> The coordinate, but neither 0 nor 1.
    real(wp) :: inside
    real(wp), parameter :: few = 4.0_wp*epsilon(1.0_wp)

    inside = max(few, min(1.0_wp - few, xi))
  end function off_node

  !> Hat functions of the point's cell, placed in a wider stencil.
  pure subroutine cell_weights(width, dim, s, base, n_cells, inverse_h, w, dw)
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Position in cells.
    real(wp), intent(in) :: s(3)
    !> First node.
    integer, intent(in) :: base(3)
    !> Cells of the grid.
    integer, intent(in) :: n_cells(3)
    !> One over the spacing. [1/m]
    real(wp), intent(in) :: inverse_h(3)
    !> Values. (width, dim)
    real(wp), intent(out) :: w(width, dim)
    !> Derivatives. [1/m] (width, dim)
    real(wp), intent(out) :: dw(width, dim)
    real(wp) :: xi
    integer :: d, cell, j

    w = 0.0_wp
    dw = 0.0_wp
    do d = 1, dim
      cell = min(int(s(d)), n_cells(d) - 1)
      xi = off_node(s(d) - real(cell, wp))
      j = cell - base(d) + 1
      w(j, d) = 1.0_wp - xi
      w(j + 1, d) = xi
      dw(j, d) = -inverse_h(d)
      dw(j + 1, d) = inverse_h(d)
    end do
  end subroutine cell_weights

#define DIM 1
#define NAME weights_1d_2
#define WIDTH 2
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_1d_3
#define WIDTH 3
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_1d_4
#define WIDTH 4
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#define DIM 2
#define NAME weights_2d_2
#define WIDTH 2
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_2d_3
#define WIDTH 3
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_2d_4
#define WIDTH 4
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#define DIM 3
#define NAME weights_3d_2
#define WIDTH 2
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_3d_3
#define WIDTH 3
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_3d_4
#define WIDTH 4
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#undef DIM

end module mpm_stencil
