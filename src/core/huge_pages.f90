!> Large arrays in huge pages.
!!
!! A step goes through all arrays of points and nodes. In pages of 4 KiB large ones have more pages
!! than the processor keeps the addresses of; so on Linux they are put into pages of 2 MiB, those
!! with numbers from 6.1 on. Elsewhere, and where there is no room for it, nothing changes.
module mpm_huge_pages
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_loc, c_ptr, c_size_t
  use mpm_kinds, only: wp
  implicit none
  private
  public :: use_huge_pages

  !> Size of a huge page. [B]
  integer(c_intptr_t), parameter :: page = 2097152
  !> Advice to Linux: MADV_HUGEPAGE for pages that will be written, MADV_COLLAPSE for those that
  !> are.
  integer(c_int), parameter :: advice(2) = [14, 25]

  interface
    !> C `madvise`: say how a part of the memory will be used.
    function c_madvise(address, length, advice) bind(c, name='madvise') result(status)
      import :: c_int, c_intptr_t, c_size_t
      implicit none
      !> Its first byte, of a page.
      integer(c_intptr_t), intent(in), value :: address
      !> Its length. [B]
      integer(c_size_t), intent(in), value :: length
      !> The advice.
      integer(c_int), intent(in), value :: advice
      !> 0 when it was taken.
      integer(c_int) :: status
    end function c_madvise
  end interface

  !> Put an array into huge pages, but for the parts of one at its ends; the numbers stay.
  interface use_huge_pages
    module procedure use_for_integers, use_for_reals, use_for_columns
  end interface use_huge_pages

contains

  !> Put whole numbers into huge pages.
  subroutine use_for_integers(values)
    !> The numbers.
    integer, allocatable, target, intent(in) :: values(:)

    if (.not. allocated(values)) return
    if (size(values) == 0) return
    call put(c_loc(values), size(values, kind=c_intptr_t)*(storage_size(values)/8))
  end subroutine use_for_integers

  !> Put numbers into huge pages.
  subroutine use_for_reals(values)
    !> The numbers.
    real(wp), allocatable, target, intent(in) :: values(:)

    if (.not. allocated(values)) return
    if (size(values) == 0) return
    call put(c_loc(values), size(values, kind=c_intptr_t)*(storage_size(values)/8))
  end subroutine use_for_reals

  !> Put columns of numbers into huge pages.
  subroutine use_for_columns(values)
    !> The numbers.
    real(wp), allocatable, target, intent(in) :: values(:, :)

    if (.not. allocated(values)) return
    if (size(values) == 0) return
    call put(c_loc(values), size(values, kind=c_intptr_t)*(storage_size(values)/8))
  end subroutine use_for_columns

  !> Put a part of the memory into the huge pages that lie in it as a whole.
  subroutine put(address, length)
    !> Its first byte.
    type(c_ptr), intent(in) :: address
    !> Its length. [B]
    integer(c_intptr_t), intent(in) :: length
    integer(c_intptr_t) :: first, last
    integer(c_int) :: unused
    integer :: i

    first = transfer(address, first)
    last = ((first + length)/page)*page
    first = ((first + page - 1)/page)*page
    if (last <= first) return
    do i = 1, size(advice)
      unused = c_madvise(first, int(last - first, c_size_t), advice(i))
    end do
  end subroutine put

end module mpm_huge_pages
