!> `assertEqual` of pFUnit for numbers and strings.
!!
!! The arguments are the same in every version: `expected`, `found`, a `message` in the test's own
!! words, the `location` of the assertion, and for reals the `tolerance` (default 0) up to which
!! each element found may differ. Arrays have the same shape, or `expected` is a scalar that stands
!! for each element.
module pf_assert_equal
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int64, real64
  use pf_context, only: fail, SourceLocation
  implicit none
  private
  public :: assertEqual

  !> Fail unless what was found is what was expected.
  interface assertEqual
    module procedure equal_integer_0
    module procedure equal_integer_1
    module procedure equal_integer_2
    module procedure equal_integer_0_1
    module procedure equal_integer_0_2
    module procedure equal_long_0
    module procedure equal_long_1
    module procedure equal_long_2
    module procedure equal_long_0_1
    module procedure equal_long_0_2
    module procedure equal_real_0
    module procedure equal_real_1
    module procedure equal_real_2
    module procedure equal_real_0_1
    module procedure equal_real_0_2
    module procedure equal_string
  end interface assertEqual

contains

  subroutine equal_integer_0(expected, found, message, location)
    integer, intent(in) :: expected
    integer, intent(in) :: found
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers([int(expected, int64)], [int(found, int64)], &
                        shape(expected), shape(found), message, location)
  end subroutine equal_integer_0

  subroutine equal_integer_1(expected, found, message, location)
    integer, intent(in) :: expected(:)
    integer, intent(in) :: found(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers([int(expected, int64)], [int(found, int64)], &
                        shape(expected), shape(found), message, location)
  end subroutine equal_integer_1

  subroutine equal_integer_2(expected, found, message, location)
    integer, intent(in) :: expected(:, :)
    integer, intent(in) :: found(:, :)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers([int(expected, int64)], [int(found, int64)], &
                        shape(expected), shape(found), message, location)
  end subroutine equal_integer_2

  subroutine equal_integer_0_1(expected, found, message, location)
    integer, intent(in) :: expected
    integer, intent(in) :: found(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers(spread(int(expected, int64), 1, size(found)), [int(found, int64)], &
                        shape(found), shape(found), message, location)
  end subroutine equal_integer_0_1

  subroutine equal_integer_0_2(expected, found, message, location)
    integer, intent(in) :: expected
    integer, intent(in) :: found(:, :)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers(spread(int(expected, int64), 1, size(found)), [int(found, int64)], &
                        shape(found), shape(found), message, location)
  end subroutine equal_integer_0_2

  subroutine equal_long_0(expected, found, message, location)
    integer(int64), intent(in) :: expected
    integer(int64), intent(in) :: found
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers([expected], [found], &
                        shape(expected), shape(found), message, location)
  end subroutine equal_long_0

  subroutine equal_long_1(expected, found, message, location)
    integer(int64), intent(in) :: expected(:)
    integer(int64), intent(in) :: found(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers([expected], [found], &
                        shape(expected), shape(found), message, location)
  end subroutine equal_long_1

  subroutine equal_long_2(expected, found, message, location)
    integer(int64), intent(in) :: expected(:, :)
    integer(int64), intent(in) :: found(:, :)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers([expected], [found], &
                        shape(expected), shape(found), message, location)
  end subroutine equal_long_2

  subroutine equal_long_0_1(expected, found, message, location)
    integer(int64), intent(in) :: expected
    integer(int64), intent(in) :: found(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers(spread(expected, 1, size(found)), [found], &
                        shape(found), shape(found), message, location)
  end subroutine equal_long_0_1

  subroutine equal_long_0_2(expected, found, message, location)
    integer(int64), intent(in) :: expected
    integer(int64), intent(in) :: found(:, :)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    call check_integers(spread(expected, 1, size(found)), [found], &
                        shape(found), shape(found), message, location)
  end subroutine equal_long_0_2

  subroutine equal_real_0(expected, found, message, tolerance, location)
    real(real64), intent(in) :: expected
    real(real64), intent(in) :: found
    character(*), intent(in), optional :: message
    real(real64), intent(in), optional :: tolerance
    type(SourceLocation), intent(in) :: location

    call check_reals([expected], [found], shape(expected), shape(found), &
                     message, tolerance, location)
  end subroutine equal_real_0

  subroutine equal_real_1(expected, found, message, tolerance, location)
    real(real64), intent(in) :: expected(:)
    real(real64), intent(in) :: found(:)
    character(*), intent(in), optional :: message
    real(real64), intent(in), optional :: tolerance
    type(SourceLocation), intent(in) :: location

    call check_reals([expected], [found], shape(expected), shape(found), &
                     message, tolerance, location)
  end subroutine equal_real_1

  subroutine equal_real_2(expected, found, message, tolerance, location)
    real(real64), intent(in) :: expected(:, :)
    real(real64), intent(in) :: found(:, :)
    character(*), intent(in), optional :: message
    real(real64), intent(in), optional :: tolerance
    type(SourceLocation), intent(in) :: location

    call check_reals([expected], [found], shape(expected), shape(found), &
                     message, tolerance, location)
  end subroutine equal_real_2

  subroutine equal_real_0_1(expected, found, message, tolerance, location)
    real(real64), intent(in) :: expected
    real(real64), intent(in) :: found(:)
    character(*), intent(in), optional :: message
    real(real64), intent(in), optional :: tolerance
    type(SourceLocation), intent(in) :: location

    call check_reals(spread(expected, 1, size(found)), [found], shape(found), shape(found), &
                     message, tolerance, location)
  end subroutine equal_real_0_1

  subroutine equal_real_0_2(expected, found, message, tolerance, location)
    real(real64), intent(in) :: expected
    real(real64), intent(in) :: found(:, :)
    character(*), intent(in), optional :: message
    real(real64), intent(in), optional :: tolerance
    type(SourceLocation), intent(in) :: location

    call check_reals(spread(expected, 1, size(found)), [found], shape(found), shape(found), &
                     message, tolerance, location)
  end subroutine equal_real_0_2

  subroutine equal_string(expected, found, message, location)
    character(*), intent(in) :: expected
    character(*), intent(in) :: found
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location

    if (len(expected) == len(found)) then
      if (expected == found) return
    end if
    call fail('expected "'//expected//'", found "'//found//'"', message, location)
  end subroutine equal_string

  !> Compare flattened integers.
  subroutine check_integers(expected, found, expected_shape, found_shape, message, location)
    integer(int64), intent(in) :: expected(:)
    integer(int64), intent(in) :: found(:)
    !> Shapes before flattening; empty for a scalar.
    integer, intent(in) :: expected_shape(:), found_shape(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    character(24) :: text(2)
    integer :: i

    if (.not. same_shape(expected_shape, found_shape, message, location)) return
    do i = 1, size(expected)
      if (expected(i) == found(i)) cycle
      write (text, '(i0)') expected(i), found(i)
      call fail('expected '//trim(text(1))//', found '//trim(text(2))//place(i, found_shape), &
                message, location)
      return
    end do
  end subroutine check_integers

  !> Compare flattened reals.
  subroutine check_reals(expected, found, expected_shape, found_shape, message, tolerance, location)
    real(real64), intent(in) :: expected(:)
    real(real64), intent(in) :: found(:)
    !> Shapes before flattening; empty for a scalar.
    integer, intent(in) :: expected_shape(:), found_shape(:)
    character(*), intent(in), optional :: message
    real(real64), intent(in), optional :: tolerance
    type(SourceLocation), intent(in) :: location
    character(24) :: text(3)
    real(real64) :: allowed
    integer :: i

    if (.not. same_shape(expected_shape, found_shape, message, location)) return
    allowed = 0.0_real64
    if (present(tolerance)) allowed = tolerance
    do i = 1, size(expected)
      if (near(expected(i), found(i), allowed)) cycle
      write (text, '(es24.16e3)') expected(i), found(i), allowed
      call fail('expected '//trim(adjustl(text(1)))//', found '//trim(adjustl(text(2)))// &
                place(i, found_shape)//', tolerance '//trim(adjustl(text(3))), message, location)
      return
    end do
  end subroutine check_reals

  !> Whether |expected - found| <= tolerance; a NaN is near nothing.
  pure logical function near(expected, found, tolerance)
    real(real64), intent(in) :: expected, found, tolerance

    ! NaN and equal infinities are told apart first: an ordered comparison of a NaN, or their
    ! difference, would trap where floating point exceptions do.
    near = .false.
    if (ieee_is_nan(expected) .or. ieee_is_nan(found) .or. ieee_is_nan(tolerance)) return
    near = .not. (expected < found .or. expected > found)
    if (near) return
    if (abs(expected) > huge(expected) .or. abs(found) > huge(found)) return
    near = abs(expected - found) <= tolerance
  end function near

  !> Whether the shapes agree; the test fails if not.
  logical function same_shape(expected_shape, found_shape, message, location)
    integer, intent(in) :: expected_shape(:), found_shape(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in) :: location
    character(24) :: text(2)

    ! The ranks are equal by the choice of the specific procedure.
    same_shape = all(expected_shape == found_shape)
    if (same_shape) return
    write (text(1), '(*(i0, :, " x "))') expected_shape
    write (text(2), '(*(i0, :, " x "))') found_shape
    call fail('expected shape '//trim(text(1))//', found shape '//trim(text(2)), message, location)
  end function same_shape

  !> Text that names the element of that flat index.
  pure function place(i, found_shape) result(text)
    !> Index in the flattened array, from 1.
    integer, intent(in) :: i
    !> Shape before flattening.
    integer, intent(in) :: found_shape(:)
    !> ` at (3)`, ` at (1, 2)`; empty for a scalar.
    character(:), allocatable :: text
    character(32) :: buffer

    select case (size(found_shape))
    case (0)
      buffer = ''
    case (1)
      write (buffer, '(" at (", i0, ")")') i
    case default
      write (buffer, '(" at (", i0, ", ", i0, ")")') mod(i - 1, found_shape(1)) + 1, &
        (i - 1)/found_shape(1) + 1
    end select
    text = trim(buffer)
  end function place

end module pf_assert_equal
