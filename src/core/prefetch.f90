!> Prefetching of rows of large arrays.
!!
!! Points that are visited block by block are read from memory in bursts, and the time of a burst
!! is not hidden behind the arithmetic. Rows that are asked for a few at a time, between some points
!! and the next, come while the processor computes.
!!
!! Fortran has no statement for it. The compiler puts prefetch instructions into the loop here, for
!! numbers some 3 KB behind those that it reads (`-fprefetch-loop-arrays`, see CMakeLists.txt);
!! what it reads is of no use but for that. Without the flag a step takes longer, and its results
!! are the same bits.
module mpm_prefetch
  use, intrinsic :: iso_fortran_env, only: lp => int64
  use mpm_kinds, only: wp
  implicit none
  private
  public :: prefetch_batch, prefetch_rows

  !> Points between two requests for rows of further ones, in two and three dimensions; in one they
  !! cost more than they gain.
  integer, parameter :: prefetch_batch(2:3) = [32, 16]
  !> Numbers in a line of a cache.
  integer, parameter :: line = 8

contains

  !> Ask for what follows rows of an array, as much as they have.
  pure subroutine prefetch_rows(width, n, rows, seen)
    !> Numbers in a row.
    integer, intent(in) :: width
    !> Rows; none when not above 0.
    integer, intent(in) :: n
    !> Their numbers. (width n)
    real(wp), intent(in) :: rows(width*n)
    !> Takes up bits of the numbers, so that the compiler has to read them.
    integer(lp), intent(inout) :: seen
    integer :: i

    !GCC$ novector
    !GCC$ unroll 1
    do i = 1, width*n, line
      seen = ieor(seen, transfer(rows(i), seen))
    end do
  end subroutine prefetch_rows

end module mpm_prefetch
