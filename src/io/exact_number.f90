!> Reals as the shortest common text that gives the same number back.
module mpm_exact_number
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_kinds, only: lp, wp
  use mpm_number_parser, only: parse_real
  use mpm_strings, only: to_text
  implicit none
  private
  public :: exact_text

contains

  !> A real with as many digits as it takes to read the same number back.
  pure function exact_text(number) result(text)
    !> The number; `nan` and `inf` as they are.
    real(wp), intent(in) :: number
    !> At most 17 significant digits.
    character(:), allocatable :: text
    real(wp) :: back
    integer :: digits, status

    do digits = 15, 17
      text = to_text(number, digits)
      if (.not. ieee_is_finite(number)) return
      call parse_real(text, 1_lp, len(text, lp), back, status)
      if (.not. abs(back - number) > 0.0_wp) return
    end do
  end function exact_text

end module mpm_exact_number
