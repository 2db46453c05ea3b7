!> Places of points in triangles and tetrahedra, those of mpm_3d v3.
!!
!! In coordinates along the edges from one node, with each edge cut into n pieces:
!!
!! - triangle: the centres of n**2 equal triangles, (i - 2/3, j - 2/3)/n for i + j <= n + 1 and
!!   (i - 1/3, j - 1/3)/n for i + j <= n, with i, j >= 1;
!! - tetrahedron of volume V: (i - 1/2, j - 1/2, k - 1/2)/n for i, j, k >= 1, i + j + k <= n + 1, of
!!   the volume 2 V/n**3; and (i +- 1/4, j +- 1/4, k +- 1/4)/n where n - i - j - k is odd and
!!   positive, "+" only in directions whose index is 0, of the volume V/n**3.
module mpm_simplex_samples
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: count_samples, simplex_samples

contains

  !> Number of places.
  pure function count_samples(dim, n) result(count)
    !> Dimensions, 2 or 3.
    integer, intent(in) :: dim
    !> Pieces of an edge, at least 1.
    integer, intent(in) :: n
    !> The number; huge when it has no end worth counting.
    integer(lp) :: count
    integer(lp), parameter :: most = 1000
    integer(lp) :: inner

    if (n > most) then
      count = huge(1)
      return
    end if
    count = int(n, lp)**2
    if (dim == 2) return
    ! Volumes sum to n**3, of which the places in the middle of cubes have two each.
    inner = int(n - 1, lp)*n*(n + 1)/6
    count = int(n, lp)**3 - inner
  end function count_samples

  !> The places.
  subroutine simplex_samples(dim, n, place, share)
    !> Dimensions, 2 or 3.
    integer, intent(in) :: dim
    !> Pieces of an edge, at most 1000.
    integer, intent(in) :: n
    !> Coordinates along the edges, parts of their lengths. (dim, count)
    real(wp), allocatable, intent(out) :: place(:, :)
    !> Parts of the volume. (count)
    real(wp), allocatable, intent(out) :: share(:)
    integer :: total

    allocate (place(dim, count_samples(dim, n)), share(count_samples(dim, n)))
    total = 0
    if (dim == 2) then
      call fill_triangle(n, place, share, total)
    else
      call fill_middles(n, place, share, total)
      call fill_quarters(n, place, share, total)
    end if
    place = place/real(n, wp)
    share = share/real(n, wp)**dim
  end subroutine simplex_samples

  !> The centres of the triangles.
  pure subroutine fill_triangle(n, place, share, total)
    !> Pieces of an edge.
    integer, intent(in) :: n
    !> Coordinates, in pieces.
    real(wp), intent(inout) :: place(:, :)
    !> Areas, in small triangles.
    real(wp), intent(inout) :: share(:)
    !> Places so far.
    integer, intent(inout) :: total
    integer :: i, j

    do i = 1, n
      do j = 1, n + 1 - i
        total = total + 1
        place(:, total) = real([i, j], wp) - 2.0_wp/3.0_wp
      end do
    end do
    do i = 1, n - 1
      do j = 1, n - i
        total = total + 1
        place(:, total) = real([i, j], wp) - 1.0_wp/3.0_wp
      end do
    end do
    share = 1.0_wp
  end subroutine fill_triangle

  !> The middles of cubes.
  pure subroutine fill_middles(n, place, share, total)
    !> Pieces of an edge.
    integer, intent(in) :: n
    !> Coordinates, in pieces.
    real(wp), intent(inout) :: place(:, :)
    !> Volumes, in small tetrahedra.
    real(wp), intent(inout) :: share(:)
    !> Places so far.
    integer, intent(inout) :: total
    integer :: i, j, k

    do i = 1, n - 1
      do j = 1, n - i
        do k = 1, n + 1 - i - j
          total = total + 1
          place(:, total) = real([i, j, k], wp) - 0.5_wp
          share(total) = 2.0_wp
        end do
      end do
    end do
  end subroutine fill_middles

  !> The points around every other corner of the lattice.
  pure subroutine fill_quarters(n, place, share, total)
    !> Pieces of an edge.
    integer, intent(in) :: n
    !> Coordinates, in pieces.
    real(wp), intent(inout) :: place(:, :)
    !> Volumes, in small tetrahedra.
    real(wp), intent(inout) :: share(:)
    !> Places so far.
    integer, intent(inout) :: total
    integer :: i, j, k, a, b, c

    do i = 0, n - 1
      do j = 0, n - 1 - i
        do k = 0, n - 1 - i - j
          if (mod(n - i - j - k, 2) == 0) cycle
          do a = merge(1, -1, i == 0), 1, 2
            do b = merge(1, -1, j == 0), 1, 2
              do c = merge(1, -1, k == 0), 1, 2
                total = total + 1
                place(:, total) = real([i, j, k], wp) + 0.25_wp*real([a, b, c], wp)
                share(total) = 1.0_wp
              end do
            end do
          end do
        end do
      end do
    end do
  end subroutine fill_quarters

end module mpm_simplex_samples
