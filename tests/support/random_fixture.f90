!> Random numbers that are the same in every run and with every compiler.
module mpm_random_fixture
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: random_t

  !> A linear congruential generator: state = 16807 state mod (2**31 - 1).
  type :: random_t
    !> State, 1 to 2**31 - 2.
    integer(lp) :: state = 20240229_lp
  contains
    !> The next number in (0, 1).
    procedure :: next => random_next
    !> Fill an array with numbers between two bounds.
    procedure :: fill => random_fill
  end type random_t

contains

  !> The next number in (0, 1).
  subroutine random_next(self, value)
    !> The generator.
    class(random_t), intent(inout) :: self
    !> The number.
    real(wp), intent(out) :: value
    integer(lp), parameter :: factor = 16807_lp, modulus = 2147483647_lp

    self%state = mod(factor*self%state, modulus)
    value = real(self%state, wp)/real(modulus, wp)
  end subroutine random_next

  !> Fill an array with numbers between two bounds.
  subroutine random_fill(self, lower, upper, values)
    !> The generator.
    class(random_t), intent(inout) :: self
    !> Lower bound.
    real(wp), intent(in) :: lower
    !> Upper bound.
    real(wp), intent(in) :: upper
    !> The numbers. (n)
    real(wp), intent(out) :: values(:)
    real(wp) :: r
    integer :: i

    do i = 1, size(values)
      call self%next(r)
      values(i) = lower + (upper - lower)*r
    end do
  end subroutine random_fill

end module mpm_random_fixture
