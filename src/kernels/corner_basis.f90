!> The functions of a Cartesian grid at the corners of points' domains, as entries of node lists.
!!
!! The corners may lie beyond the seam of a periodic grid; their nodes are then those of the cells
!! in which they come out. First nodes are not brought back into the grid before nodes are listed,
!! so that the nodes of one domain make a box.
module mpm_corner_basis
  use mpm_kinds, only: wp
  use mpm_seam, only: wrap_points
  use mpm_stencil, only: block_size, decode_keys, natural_width, stencil_keys, stencil_t, &
                         stencil_weights
  use mpm_window, only: window_t
  implicit none
  private
  public :: add_box, add_corners, add_plain, corner_functions, keep_inside, list_nodes, reaches_out
  public :: value_at_corner

  !> Distance in cells by which a corner may lie behind a wall and counts as on it. Steps of finite
  !! length let the corners of points at a wall drift out, by far less than this in a usual run.
  real(wp), parameter :: slack = 1.0e-3_wp
  !> Most nodes in one direction of a box of nodes: those of eight corners over four by four.
  integer, parameter :: most = 32

contains

  !> Whether a box around a point reaches out of the grid; NaN does.
  pure function reaches_out(stencil, x, low, high) result(out)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Position. [m]
    real(wp), intent(in) :: x(stencil%dim)
    !> Lower corner of the box, from the position. [m]
    real(wp), intent(in) :: low(stencil%dim)
    !> Upper corner of the box, from the position. [m]
    real(wp), intent(in) :: high(stencil%dim)
    !> Whether it does.
    logical :: out
    real(wp) :: length
    integer :: d

    out = .false.
    do d = 1, stencil%dim
      length = real(stencil%n_cells(d), wp)*stencil%h(d)
      if (stencil%periodic(d)) then
        out = out .or. .not. high(d) - low(d) <= huge(1.0_wp)
      else
        out = out .or. .not. (x(d) + low(d) - stencil%lower(d) >= -slack*stencil%h(d) .and. &
                              x(d) + high(d) - stencil%lower(d) <= length + slack*stencil%h(d))
      end if
    end do
  end function reaches_out

  !> Put positions a little behind walls onto them.
  pure subroutine keep_inside(stencil, n, y)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of positions.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(inout) :: y(stencil%dim, n)
    real(wp) :: length, top
    integer :: d

    do d = 1, stencil%dim
      if (stencil%periodic(d)) cycle
      length = real(stencil%n_cells(d), wp)*stencil%h(d)
      ! A few roundings below the wall: the cell is found by a division.
      top = stencil%lower(d) + length - 4.0_wp*epsilon(1.0_wp)*(abs(stencil%lower(d)) + length)
      y(d, :) = max(stencil%lower(d), min(top, y(d, :)))
    end do
  end subroutine keep_inside

  !> First nodes of the functions at positions, and their values and derivatives when asked for.
  pure subroutine corner_functions(stencil, n, y, first, w, dw)
    !> Basis, not averaged.
    type(stencil_t), intent(in) :: stencil
    !> Number of positions, at most `block_size`.
    integer, intent(in) :: n
    !> Positions, inside walls; anywhere in periodic directions. [m]
    real(wp), intent(in) :: y(stencil%dim, n)
    !> First nodes, not brought back at seams; 0 in unused directions.
    integer, intent(out) :: first(3, n)
    !> Values. (width, dim, n)
    real(wp), intent(inout), optional :: w(*)
    !> Derivatives. [1/m] (width, dim, n)
    real(wp), intent(inout), optional :: dw(*)
    real(wp) :: inside(3*block_size), sizes(block_size), reach, s
    integer :: key(block_size), d, p

    ! Arrays of constant size need no allocation.
    do p = 1, n
      inside((p - 1)*stencil%dim + 1:p*stencil%dim) = y(:, p)
    end do
    sizes(:n) = 0.0_wp
    if (any(stencil%periodic)) call wrap_points(stencil, n, inside)
    call stencil_keys(stencil, n, inside, sizes, key)
    call decode_keys(stencil, n, key, first)
    if (present(w)) call stencil_weights(stencil, n, inside, sizes, first, w, dw)
    if (.not. any(stencil%periodic)) return
    ! The first node lies `reach` to `reach` + 1 cells below the position, up to periods.
    reach = 0.5_wp*real(natural_width(stencil%kind) - 2, wp)
    do d = 1, stencil%dim
      if (.not. stencil%periodic(d)) cycle
      do p = 1, n
        s = (y(d, p) - stencil%lower(d))/stencil%h(d) - (reach + 0.5_wp + real(first(d, p), wp))
        first(d, p) = first(d, p) + stencil%n_cells(d)*nint(s/real(stencil%n_cells(d), wp))
      end do
    end do
  end subroutine corner_functions

  !> Positions in the node arrays of a box of nodes, x fastest.
  pure subroutine list_nodes(stencil, window, first, counts, node)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays.
    type(window_t), intent(in) :: window
    !> First node, not brought back at seams.
    integer, intent(in) :: first(3)
    !> Nodes in each direction; 1 in unused ones.
    integer, intent(in) :: counts(3)
    !> Positions, from 1. (product of counts)
    integer, intent(out) :: node(*)
    integer :: i, j, k, e, y, z

    e = 0
    if (.not. any(stencil%periodic)) then
      z = window%index(first) - 1
      do k = 0, counts(3) - 1
        do j = 0, counts(2) - 1
          y = z + window%n(1)*(j + window%n(2)*k)
          do i = 1, counts(1)
            node(e + i) = y + i
          end do
          e = e + counts(1)
        end do
      end do
      return
    end if
    do k = 0, counts(3) - 1
      z = window%n(1)*window%n(2)*(image(3, first(3) + k) - window%lo(3))
      do j = 0, counts(2) - 1
        y = z + window%n(1)*(image(2, first(2) + j) - window%lo(2)) - window%lo(1) + 1
        do i = 0, counts(1) - 1
          node(e + i + 1) = y + image(1, first(1) + i)
        end do
        e = e + counts(1)
      end do
    end do

  contains

    !> The node for which one behind a seam stands.
    pure function image(d, index)
      !> Direction.
      integer, intent(in) :: d
      !> Index of a node.
      integer, intent(in) :: index
      !> Index in the grid.
      integer :: image

      image = index
      if (stencil%periodic(d)) image = modulo(index, stencil%n_cells(d))
    end function image

  end subroutine list_nodes

  !> Functions at one position.
  pure subroutine add_plain(width, dim, w, dw, basis)
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Values of the 1D functions.
    real(wp), intent(in) :: w(width, dim)
    !> Their derivatives. [1/m]
    real(wp), intent(in) :: dw(width, dim)
    !> Entries of the position's nodes, x fastest. (0:dim, width**dim)
    real(wp), intent(out) :: basis(0:dim, width**dim)
    integer :: e, d, c, rest, local(dim)

    do e = 1, width**dim
      rest = e - 1
      do d = 1, dim
        local(d) = mod(rest, width) + 1
        rest = rest/width
      end do
      basis(:, e) = 1.0_wp
      do d = 1, dim
        do c = 0, dim
          if (c == d) then
            basis(c, e) = basis(c, e)*dw(local(d), d)
          else
            basis(c, e) = basis(c, e)*w(local(d), d)
          end if
        end do
      end do
    end do
  end subroutine add_plain

  !> Interpolate a nodal field to one position.
  pure subroutine value_at_corner(width, dim, components, w, node, field, value)
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Components of the field.
    integer, intent(in) :: components
    !> Values of the 1D functions.
    real(wp), intent(in) :: w(width, dim)
    !> The nodes, x fastest. (width**dim)
    integer, intent(in) :: node(*)
    !> The field. (components, nn)
    real(wp), intent(in) :: field(components, *)
    !> The first components at the position.
    real(wp), intent(out) :: value(dim)
    real(wp) :: z, yz
    integer :: i, j, k, e

    value = 0.0_wp
    e = 0
    z = 1.0_wp
    do k = 1, merge(width, 1, dim > 2)
      if (dim > 2) z = w(k, dim)
      do j = 1, merge(width, 1, dim > 1)
        yz = z
        if (dim > 1) yz = z*w(j, 2)
        do i = 1, width
          e = e + 1
          value = value + (w(i, 1)*yz)*field(:dim, node(e))
        end do
      end do
    end do
  end subroutine value_at_corner

  !> Means over the corners of a box along the axes, which are products of 1D means.
  !!
  !! S = [N(x + a) + N(x - a)]/2 and [N(x + a) - N(x - a)]/2a in each direction.
  pure subroutine add_box(width, dim, counts, behind, w, half, basis)
    !> Nodes per direction of one corner.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Nodes of the box in each direction.
    integer, intent(in) :: counts(3)
    !> Nodes of the box before those of its upper corner; those of the lower one come first.
    integer, intent(in) :: behind(dim)
    !> Values of the 1D functions at the lower and the upper corner.
    real(wp), intent(in) :: w(width, dim, 2)
    !> Half sides a. [m]
    real(wp), intent(in) :: half(dim)
    !> Entries of the nodes of the box, x fastest.
    real(wp), intent(out) :: basis(0:dim, counts(1)*counts(2)*counts(3))
    real(wp) :: s(most, 3), g(most, 3), sz, gz, ss, gs, sg
    integer :: d, i, j, k, e

    do d = 1, dim
      s(width + 1:counts(d), d) = 0.0_wp
      g(width + 1:counts(d), d) = 0.0_wp
      s(:width, d) = 0.5_wp*w(:, d, 1)
      g(:width, d) = -(0.5_wp/half(d))*w(:, d, 1)
      associate (b => behind(d))
        s(b + 1:b + width, d) = s(b + 1:b + width, d) + 0.5_wp*w(:, d, 2)
        g(b + 1:b + width, d) = g(b + 1:b + width, d) + (0.5_wp/half(d))*w(:, d, 2)
      end associate
    end do
    s(1, dim + 1:) = 1.0_wp
    g(1, dim + 1:) = 0.0_wp
    e = 0
    do k = 1, counts(3)
      sz = s(k, 3)
      gz = g(k, 3)
      do j = 1, counts(2)
        ss = s(j, 2)*sz
        gs = g(j, 2)*sz
        sg = s(j, 2)*gz
        if (dim == 3) then
          do i = 1, counts(1)
            e = e + 1
            basis(0, e) = s(i, 1)*ss
            basis(1, e) = g(i, 1)*ss
            basis(2, e) = s(i, 1)*gs
            basis(dim, e) = s(i, 1)*sg
          end do
        else if (dim == 2) then
          do i = 1, counts(1)
            e = e + 1
            basis(0, e) = s(i, 1)*ss
            basis(1, e) = g(i, 1)*ss
            basis(dim, e) = s(i, 1)*gs
          end do
        else
          basis(0, :) = s(:counts(1), 1)
          basis(1, :) = g(:counts(1), 1)
        end if
      end do
    end do
  end subroutine add_box

  !> Weighted sums over corners, on the box of all their nodes.
  pure subroutine add_corners(width, dim, corners, counts, first, w, weight, slope, basis)
    !> Nodes per direction of one corner.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Number of corners.
    integer, intent(in) :: corners
    !> Nodes of the box in each direction; 1 in unused ones.
    integer, intent(in) :: counts(3)
    !> First nodes of the corners, from that of the box.
    integer, intent(in) :: first(3, corners)
    !> Values of the 1D functions at the corners.
    real(wp), intent(in) :: w(width, dim, corners)
    !> Weights of the corners.
    real(wp), intent(in) :: weight(corners)
    !> Gradients of the corners. [1/m]
    real(wp), intent(in) :: slope(dim, corners)
    !> Entries of the nodes of the box, x fastest.
    real(wp), intent(out) :: basis(0:dim, 0:counts(1)*counts(2)*counts(3) - 1)
    real(wp) :: value, z, yz
    integer :: c, i, j, k, e, row, rows, layers

    basis = 0.0_wp
    rows = merge(width, 1, dim > 1)
    layers = merge(width, 1, dim > 2)
    do c = 1, corners
      do k = 1, layers
        z = 1.0_wp
        if (dim > 2) z = w(k, dim, c)
        do j = 1, rows
          yz = z
          if (dim > 1) yz = z*w(j, 2, c)
          row = first(1, c) + counts(1)*(first(2, c) + j - 1 + counts(2)*(first(3, c) + k - 1))
          do i = 1, width
            e = row + i - 1
            value = w(i, 1, c)*yz
            basis(0, e) = basis(0, e) + weight(c)*value
            basis(1, e) = basis(1, e) + slope(1, c)*value
            if (dim > 1) basis(2, e) = basis(2, e) + slope(2, c)*value
            if (dim > 2) basis(3, e) = basis(3, e) + slope(3, c)*value
          end do
        end do
      end do
    end do
  end subroutine add_corners

end module mpm_corner_basis
