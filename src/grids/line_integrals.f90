!> Integrals of the 1D functions of Cartesian bases over their line of cells.
!!
!! All bases are hats smoothed by an even kernel, with the node behind a wall folded in. Smoothing a
!! kink of unit strength adds half the variance of the kernel, k, to the integral: k is 0 for hats,
!! lambda**2/6 for hats averaged over a box, and 1/12 for cubic B-splines. Next to a wall the
!! functions go on as hats, without a kink at the wall.
module mpm_line_integrals
  use mpm_kinds, only: wp
  use mpm_stencil, only: basis_box, basis_cubic
  implicit none
  private
  public :: line_integral, line_moment, smoothing

contains

  !> Half the variance of the kernel that turns hats into a basis.
  elemental function smoothing(kind, lambda) result(k)
    !> One of the `basis_*`.
    integer, intent(in) :: kind
    !> Half width of the box in cells.
    real(wp), intent(in) :: lambda
    !> Half the variance, in cells squared.
    real(wp) :: k

    select case (kind)
    case (basis_box)
      k = lambda**2/6.0_wp
    case (basis_cubic)
      k = 1.0_wp/12.0_wp
    case default
      k = 0.0_wp
    end select
  end function smoothing

  !> Integral of the function of a node.
  elemental function line_integral(node, n_cells, k, periodic) result(integral)
    !> Index of the node, from 0.
    integer, intent(in) :: node
    !> Cells of the line.
    integer, intent(in) :: n_cells
    !> Half the variance of the kernel.
    real(wp), intent(in) :: k
    !> Whether the line is periodic.
    logical, intent(in) :: periodic
    !> The integral, in cells.
    real(wp) :: integral

    integral = 1.0_wp
    if (periodic) return
    select case (min(node, n_cells - node))
    case (0)
      integral = 0.5_wp + k
    case (1)
      integral = 1.0_wp - k
    case default
      return
    end select
  end function line_integral

  !> Integral of the function of a node times the distance from the node.
  elemental function line_moment(node, n_cells, k, periodic) result(moment)
    !> Index of the node, from 0.
    integer, intent(in) :: node
    !> Cells of the line.
    integer, intent(in) :: n_cells
    !> Half the variance of the kernel.
    real(wp), intent(in) :: k
    !> Whether the line is periodic.
    logical, intent(in) :: periodic
    !> The moment, in cells squared.
    real(wp) :: moment

    moment = 0.0_wp
    if (periodic) return
    select case (min(node, n_cells - node))
    case (0)
      moment = 1.0_wp/6.0_wp + k
    case (1)
      moment = k
    case default
      return
    end select
    if (node > n_cells - node) moment = -moment
  end function line_moment

end module mpm_line_integrals
