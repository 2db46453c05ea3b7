!> `assertTrue`, `assertFalse` and the orderings `assertLessThan` ... of pFUnit.
!!
!! The arguments are the same everywhere: what is compared, a `message` in the test's own words, and
!! the `location` of the assertion. With a NaN every ordering fails.
module pf_assert_true
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64, real64
  use pf_context, only: fail, SourceLocation
  implicit none
  private
  public :: assertFalse, assertTrue
  public :: assertGreaterThan, assertGreaterThanOrEqual, assertLessThan, assertLessThanOrEqual

  !> Fail unless a < b.
  interface assertLessThan
    module procedure less_integer
    module procedure less_long
    module procedure less_real
  end interface assertLessThan

  !> Fail unless a <= b.
  interface assertLessThanOrEqual
    module procedure less_equal_integer
    module procedure less_equal_long
    module procedure less_equal_real
  end interface assertLessThanOrEqual

  !> Fail unless a > b.
  interface assertGreaterThan
    module procedure greater_integer
    module procedure greater_long
    module procedure greater_real
  end interface assertGreaterThan

  !> Fail unless a >= b.
  interface assertGreaterThanOrEqual
    module procedure greater_equal_integer
    module procedure greater_equal_long
    module procedure greater_equal_real
  end interface assertGreaterThanOrEqual

contains

  !> Fail unless the condition holds.
  subroutine assertTrue(condition, message, location)
    logical, intent(in) :: condition
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    if (.not. condition) call fail('expected true, found false', message, location)
  end subroutine assertTrue

  !> Fail if the condition holds.
  subroutine assertFalse(condition, message, location)
    logical, intent(in) :: condition
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    if (condition) call fail('expected false, found true', message, location)
  end subroutine assertFalse

  subroutine less_integer(a, b, message, location)
    integer, intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('<', int(a, int64), int(b, int64), message, location)
  end subroutine less_integer

  subroutine less_long(a, b, message, location)
    integer(int64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('<', a, b, message, location)
  end subroutine less_long

  subroutine less_real(a, b, message, location)
    real(real64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_reals('<', a, b, message, location)
  end subroutine less_real

  subroutine less_equal_integer(a, b, message, location)
    integer, intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('<=', int(a, int64), int(b, int64), message, location)
  end subroutine less_equal_integer

  subroutine less_equal_long(a, b, message, location)
    integer(int64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('<=', a, b, message, location)
  end subroutine less_equal_long

  subroutine less_equal_real(a, b, message, location)
    real(real64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_reals('<=', a, b, message, location)
  end subroutine less_equal_real

  subroutine greater_integer(a, b, message, location)
    integer, intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('>', int(a, int64), int(b, int64), message, location)
  end subroutine greater_integer

  subroutine greater_long(a, b, message, location)
    integer(int64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('>', a, b, message, location)
  end subroutine greater_long

  subroutine greater_real(a, b, message, location)
    real(real64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_reals('>', a, b, message, location)
  end subroutine greater_real

  subroutine greater_equal_integer(a, b, message, location)
    integer, intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('>=', int(a, int64), int(b, int64), message, location)
  end subroutine greater_equal_integer

  subroutine greater_equal_long(a, b, message, location)
    integer(int64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers('>=', a, b, message, location)
  end subroutine greater_equal_long

  subroutine greater_equal_real(a, b, message, location)
    real(real64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_reals('>=', a, b, message, location)
  end subroutine greater_equal_real

  !> Fail unless the ordering holds.
  subroutine check_integers(ordering, a, b, message, location)
    !> One of `<`, `<=`, `>`; `>=` otherwise.
    character(*), intent(in) :: ordering
    integer(int64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    character(24) :: text(2)
    logical :: holds

    holds = .false.
    select case (ordering)
    case ('<')
      holds = a < b
    case ('<=')
      holds = a <= b
    case ('>')
      holds = a > b
    case default
      holds = a >= b
    end select
    if (holds) return
    write (text, '(i0)') a, b
    call fail('expected '//trim(adjustl(text(1)))//' '//ordering//' '//trim(adjustl(text(2))), &
              message, location)
  end subroutine check_integers

  !> Fail unless the ordering holds.
  subroutine check_reals(ordering, a, b, message, location)
    !> One of `<`, `<=`, `>`; `>=` otherwise.
    character(*), intent(in) :: ordering
    real(real64), intent(in) :: a, b
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    character(24) :: text(2)
    logical :: holds

    holds = .false.
    ! An ordered comparison of a NaN would trap where floating point exceptions do.
    if (.not. (ieee_is_nan(a) .or. ieee_is_nan(b))) then
      select case (ordering)
      case ('<')
        holds = a < b
      case ('<=')
        holds = a <= b
      case ('>')
        holds = a > b
      case default
        holds = a >= b
      end select
    end if
    if (holds) return
    write (text, '(es24.16e3)') a, b
    call fail('expected '//trim(adjustl(text(1)))//' '//ordering//' '//trim(adjustl(text(2))), &
              message, location)
  end subroutine check_reals

end module pf_assert_true
