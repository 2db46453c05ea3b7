!> Largest stable Courant number of the bases, from the symbols of mapping and force.
!!
!! For points in a row, n in each cell, a mode of wave number k has
!! mu = mean_p |sum_i N_i(x_p) exp(i k x_i)|**2 and K = mean_p |sum_i N_i'(x_p) exp(i k x_i)|**2.
!! FLIP with the stress updated last is stable for c**2 K dt**2 <= 4/(2 - mu). In several dimensions
!! K is the sum over the directions of K_d times the mu of the others, and mu the product of all.
!! The limit of c dt/h, h the smallest spacing, is that of the worst wave and of the worst place of
!! the points with respect to the nodes.
module mpm_stability
  use mpm_kinds, only: wp
  use mpm_stencil, only: basis_box, basis_cubic, stencil_t
  implicit none
  private
  public :: courant_limit, filtered_limit

  !> Limits of quadratic B-splines for 1, 2, 3, 4 and more points in a cell, rounded down.
  real(wp), parameter :: quadratic_limit(5) = [0.707_wp, 1.032_wp, 1.145_wp, 1.189_wp, 1.209_wp]
  !> Limits of cubic B-splines for one point in a cell and for more, in 3D, rounded down.
  real(wp), parameter :: cubic_limit(2) = [1.370_wp, 1.480_wp]
  !> The same where points lie next to walls, whose folded functions are steeper and lighter: the
  !! least of all TYPEs, which is that around an axis.
  real(wp), parameter :: quadratic_wall_limit(5) = [0.707_wp, 1.032_wp, 1.104_wp, 1.170_wp, &
                                                    1.170_wp]
  !> The same for cubic B-splines.
  real(wp), parameter :: cubic_wall_limit(2) = [1.236_wp, 1.305_wp]
  !> One point a cell and hats: its place in the cell counts. The worst is the middle in one
  !! direction, and on node lines in the others, with mu = 1/2 or 3/4 in the first.
  real(wp), parameter :: single_point_limit(3) = [sqrt(0.5_wp), 2.0_wp/3.0_wp, sqrt(0.32_wp)]
  !> Narrowest box, in cells, with which one point in a cell does not need these limits.
  real(wp), parameter :: wide_box = 0.25_wp
  !> Volumes that are sums of rounded numbers give 2 as 1.999...
  real(wp), parameter :: rounding = 1.0e-6_wp

contains

  !> Largest c dt/h.
  !!
  !! Hats: K = 4 s/h**2 and mu = 1 - (2/3 + 1/(3 n**2)) s, s = sin**2(k h/2), wherever the points
  !! are; the worst mode is s = 1, hence 1/sqrt(5/3 + 1/(3 n**2)). From n = 2 on, and with averaged
  !! functions, the worst wave of several dimensions runs along one of them. Hats averaged over a
  !! box have the same worst case when the box is no wider than a point, lambda <= 1/(2 n), and a
  !! larger limit otherwise. The limits of B-splines are computed over all waves and places, and
  !! grow with n; those next to walls by the eigenvalues of the steps of filled boxes of 4 to 6
  !! cells between smooth walls, in every TYPE. Averaging over corners makes no limit smaller.
  pure function courant_limit(stencil, per_cell, at_wall) result(limit)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Points along the smallest spacing, at least 1.
    real(wp), intent(in) :: per_cell
    !> Points lie next to walls; they do not when left out.
    logical, intent(in), optional :: at_wall
    !> The Courant number.
    real(wp) :: limit
    logical :: kinked, folded
    integer :: n

    n = int(min(per_cell, 8.0_wp) + rounding)
    folded = .false.
    if (present(at_wall)) folded = at_wall
    associate (lambda => stencil%lambda(:stencil%dim))
      if (stencil%kind == basis_cubic) then
        limit = cubic_limit(min(n, 2))
        if (folded) limit = cubic_wall_limit(min(n, 2))
      else if (stencil%kind == basis_box .and. all(lambda >= 0.5_wp)) then
        limit = quadratic_limit(min(n, 5))
        if (folded) limit = quadratic_wall_limit(min(n, 5))
      else
        limit = 1.0_wp/sqrt(5.0_wp/3.0_wp + 1.0_wp/(3.0_wp*per_cell**2))
        kinked = .not. stencil%averaged
        if (stencil%kind == basis_box) kinked = kinked .and. any(lambda < wide_box)
        if (n < 2 .and. kinked) limit = single_point_limit(stencil%dim)
      end if
    end associate
  end function courant_limit

  !> Largest c dt sqrt(sum 1/h**2) when the gradient is formed from velocities that went through the
  !! points (MUSL, USF).
  !!
  !! FLIP needs mu c**2 K dt**2 <= 4. Hats have mu = 1 - g s, where g = 4 mean(xi (1 - xi)) is
  !! least, g = 2/3 (1 - 1/n**2), for points on node lines: C**2 = 4 g, or 1/(1 - g) for g < 1/2.
  !! Other transfers need mu c**2 K dt**2 <= 2 (1 + nu), mu <= nu <= 1, or with affine fields
  !! nu c**2 K dt**2 <= 2 (1 + nu), for which C = 1, c**2 K dt**2 <= 4, suffices. In several
  !! dimensions mu is the product over the directions, and the sum over them of K_d mu_d, each with
  !! mu_e**2 of the others, is at most the sum of K_d mu_d.
  !!
  !! This serves all bases: B-splines, uGIMP and averages over corners are means of hats over
  !! places, and their derivatives are means of those of hats; the square of a mean is at most the
  !! mean of the squares, so that no symbol is above mu = 1 - g s and K = 4 s/h**2. A slope of an
  !! affine fit is a mean of the differences between neighbouring nodes, with the same bound of K.
  pure function filtered_limit(per_cell, flip) result(limit)
    !> Points along the smallest spacing, at least 1.
    real(wp), intent(in) :: per_cell
    !> Velocities went through the points by FLIP.
    logical, intent(in) :: flip
    !> The limit.
    real(wp) :: limit
    real(wp) :: g

    limit = 1.0_wp
    if (.not. flip) return
    g = 2.0_wp/3.0_wp*(1.0_wp - 1.0_wp/per_cell**2)
    if (g > 0.5_wp) then
      limit = 2.0_wp*sqrt(g)
    else
      limit = 1.0_wp/sqrt(1.0_wp - g)
    end if
  end function filtered_limit

end module mpm_stability
