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
  public :: courant_limit

  !> Limits of quadratic B-splines for 1, 2, 3, 4 and more points in a cell, rounded down.
  real(wp), parameter :: quadratic_limit(5) = [0.707_wp, 1.032_wp, 1.145_wp, 1.189_wp, 1.209_wp]
  !> Limits of cubic B-splines for one point in a cell and for more, in 3D, rounded down.
  real(wp), parameter :: cubic_limit(2) = [1.370_wp, 1.480_wp]
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
  !! grow with n. Averaging over corners makes no limit smaller.
  pure function courant_limit(stencil, per_cell) result(limit)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Points along the smallest spacing, at least 1.
    real(wp), intent(in) :: per_cell
    !> The Courant number.
    real(wp) :: limit
    logical :: kinked
    integer :: n

    n = int(min(per_cell, 8.0_wp) + rounding)
    associate (lambda => stencil%lambda(:stencil%dim))
      if (stencil%kind == basis_cubic) then
        limit = cubic_limit(min(n, 2))
      else if (stencil%kind == basis_box .and. all(lambda >= 0.5_wp)) then
        limit = quadratic_limit(min(n, 5))
      else
        limit = 1.0_wp/sqrt(5.0_wp/3.0_wp + 1.0_wp/(3.0_wp*per_cell**2))
        kinked = .not. stencil%averaged
        if (stencil%kind == basis_box) kinked = kinked .and. any(lambda < wide_box)
        if (n < 2 .and. kinked) limit = single_point_limit(stencil%dim)
      end if
    end associate
  end function courant_limit

end module mpm_stability
