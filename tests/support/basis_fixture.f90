!> Shape functions and their gradients at all nodes, straight from their definition.
module mpm_basis_fixture
  use mpm_kinds, only: wp
  use mpm_stencil, only: stencil_t
  implicit none
  private
  public :: brute_basis, node_of

contains

  !> Functions of all nodes of the grid at one point.
  !!
  !! Averaged: the mean over the 2**dim corners x + s extent/2, and the mean of N s/(extent/2) as
  !! gradient; the hats at the point itself when any corner lies outside the grid.
  pure subroutine brute_basis(stencil, x, extent, shape, gradient)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Half side of the point's box. [m]
    real(wp), intent(in) :: extent
    !> Values, nodes with x fastest. (nodes)
    real(wp), intent(out) :: shape(:)
    !> Gradients, components beyond dim 0. [1/m] (3, nodes)
    real(wp), intent(out) :: gradient(:, :)
    real(wp) :: corner(stencil%dim), s(stencil%dim), a, value
    integer :: i, c, d, corners

    corners = 2**stencil%dim
    a = 0.5_wp*extent
    shape = 0.0_wp
    gradient = 0.0_wp
    if (stencil%averaged .and. box_inside(stencil, x, a)) then
      do c = 0, corners - 1
        do d = 1, stencil%dim
          s(d) = real(2*iand(c/2**(d - 1), 1) - 1, wp)
        end do
        corner = x + a*s
        do i = 1, size(shape)
          value = product_of_hats(stencil, node_of(stencil, i), corner)/real(corners, wp)
          shape(i) = shape(i) + value
          gradient(:stencil%dim, i) = gradient(:stencil%dim, i) + value*s/a
        end do
      end do
    else
      do i = 1, size(shape)
        shape(i) = product_of_hats(stencil, node_of(stencil, i), x)
        do d = 1, stencil%dim
          gradient(d, i) = product_of_hats(stencil, node_of(stencil, i), x, d)
        end do
      end do
    end if
  end subroutine brute_basis

  !> Grid indices of a node.
  pure function node_of(stencil, position) result(node)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Position among all nodes, from 1, x fastest.
    integer, intent(in) :: position
    !> Grid indices, from 0.
    integer :: node(3)
    integer :: rest, d

    rest = position - 1
    do d = 1, 3
      node(d) = mod(rest, stencil%n_cells(d) + 1)
      rest = rest/(stencil%n_cells(d) + 1)
    end do
  end function node_of

  !> Whether all corners lie inside the closed grid.
  pure function box_inside(stencil, x, a) result(inside)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Centre. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Distance of the corners along each direction. [m]
    real(wp), intent(in) :: a
    !> Whether they do.
    logical :: inside
    integer :: d

    inside = .true.
    do d = 1, stencil%dim
      inside = inside .and. x(d) - a >= stencil%lower(d)
      inside = inside .and. x(d) + a <= stencil%lower(d) + stencil%h(d)*stencil%n_cells(d)
    end do
  end function box_inside

  !> Product over the directions of the hats of a node, one of them differentiated.
  pure function product_of_hats(stencil, node, x, derivative) result(value)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Grid indices.
    integer, intent(in) :: node(3)
    !> Where. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Direction of the derivative; none when left out.
    integer, intent(in), optional :: derivative
    !> The product.
    real(wp) :: value
    real(wp) :: xi
    integer :: d, cell, slope

    value = 1.0_wp
    do d = 1, stencil%dim
      xi = (x(d) - stencil%lower(d))/stencil%h(d)
      cell = max(0, min(floor(xi), stencil%n_cells(d) - 1))
      slope = 0
      if (present(derivative)) then
        if (derivative == d) slope = 1
      end if
      if (node(d) /= cell .and. node(d) /= cell + 1) then
        value = 0.0_wp
      else if (slope == 1) then
        value = value*real(2*(node(d) - cell) - 1, wp)/stencil%h(d)
      else
        value = value*(1.0_wp - abs(xi - real(node(d), wp)))
      end if
    end do
  end function product_of_hats

end module mpm_basis_fixture
