!> Text to numbers, strictly: the whole of a given part of a text must be a number.
!!
!! A real is `[+-]digits[.digits][e[+-]digits]` with at least one digit in front of the exponent.
!! Every result is the real number nearest to the text.
module mpm_number_parser
  use, intrinsic :: ieee_arithmetic, only: ieee_negative_inf, ieee_positive_inf, ieee_quiet_nan, &
                                           ieee_value
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: parse_integer, parse_real, parse_special
  public :: exact_power, multiply_exactly, number_malformed, number_ok, number_too_large

  !> The text is a number.
  integer, parameter :: number_ok = 0
  !> The text is not a number.
  integer, parameter :: number_malformed = 1
  !> The text is a number beyond the largest one that can be stored.
  integer, parameter :: number_too_large = 2

  !> Powers of ten that are exact.
  real(wp), parameter :: exact_power(0:22) = &
    [1.0_wp, 1.0e1_wp, 1.0e2_wp, 1.0e3_wp, 1.0e4_wp, 1.0e5_wp, 1.0e6_wp, 1.0e7_wp, 1.0e8_wp, &
     1.0e9_wp, 1.0e10_wp, 1.0e11_wp, 1.0e12_wp, 1.0e13_wp, 1.0e14_wp, 1.0e15_wp, 1.0e16_wp, &
     1.0e17_wp, 1.0e18_wp, 1.0e19_wp, 1.0e20_wp, 1.0e21_wp, 1.0e22_wp]
  !> Integers up to this one are exact as reals.
  integer(lp), parameter :: max_exact_integer = 2_lp**min(53, digits(1.0_wp))
  !> Digits of a mantissa that always fit a long integer.
  integer, parameter :: max_digits = 18
  !> Exponents beyond this are all alike, and none overflows an integer.
  integer, parameter :: max_exponent = 1000000

  !> A decimal number: `mantissa * 10**exponent`.
  type :: decimal_t
    !> The leading significant digits, at most `max_digits`.
    integer(lp) :: mantissa = 0
    !> Power of ten of the mantissa's last digit.
    integer(lp) :: exponent = 0
    !> Number of digits in the mantissa, without leading zeros.
    integer :: n_digits = 0
    !> Whether digits other than 0 were left out.
    logical :: truncated = .false.
    !> Whether the number has a minus sign.
    logical :: negative = .false.
  end type decimal_t

contains

  !> The real number in `text(first:last)`.
  pure subroutine parse_real(text, first, last, number, status)
    !> Any text.
    character(*), intent(in) :: text
    !> Position of the first character of the number.
    integer(lp), intent(in) :: first
    !> Position of its last character.
    integer(lp), intent(in) :: last
    !> The number; 0 unless the status is `number_ok`.
    real(wp), intent(out) :: number
    !> `number_ok`, `number_malformed` or `number_too_large`.
    integer, intent(out) :: status
    type(decimal_t) :: decimal
    logical :: is_certain

    number = 0.0_wp
    call scan_decimal(text, first, last, decimal, status)
    if (status /= number_ok) return
    if (decimal%mantissa <= max_exact_integer .and. abs(decimal%exponent) <= 22 &
        .and. .not. decimal%truncated) then
      ! both factors are exact, so that the one rounding is the right one
      if (decimal%exponent < 0) then
        number = real(decimal%mantissa, wp)/exact_power(-decimal%exponent)
      else
        number = real(decimal%mantissa, wp)*exact_power(decimal%exponent)
      end if
      if (decimal%negative) number = -number
      return
    end if
    if (decimal%mantissa == 0) then
      if (decimal%negative) number = -number
      return
    end if
    call scale_in_two_parts(decimal, number, is_certain)
    if (.not. is_certain) call read_exactly(text(first:last), decimal, number, status)
  end subroutine parse_real

  !> Check the syntax of a number and gather its digits.
  pure subroutine scan_decimal(text, first, last, decimal, status)
    !> Any text.
    character(*), intent(in) :: text
    !> Position of the first character of the number.
    integer(lp), intent(in) :: first
    !> Position of its last character.
    integer(lp), intent(in) :: last
    !> The number.
    type(decimal_t), intent(out) :: decimal
    !> `number_ok` or `number_malformed`.
    integer, intent(out) :: status
    integer(lp) :: i, n_before
    integer :: digit
    logical :: has_point

    status = number_malformed
    if (last < first) return
    i = first
    decimal%negative = text(i:i) == '-'
    if (decimal%negative .or. text(i:i) == '+') i = i + 1
    has_point = .false.
    n_before = i
    do while (i <= last)
      digit = ichar(text(i:i)) - ichar('0')
      if (digit >= 0 .and. digit <= 9) then
        if (decimal%n_digits < max_digits) then
          decimal%mantissa = 10*decimal%mantissa + digit
          if (decimal%mantissa > 0) decimal%n_digits = decimal%n_digits + 1
          if (has_point) decimal%exponent = decimal%exponent - 1
        else
          if (digit > 0) decimal%truncated = .true.
          if (.not. has_point) decimal%exponent = decimal%exponent + 1
        end if
      else if (text(i:i) == '.' .and. .not. has_point) then
        has_point = .true.
        n_before = n_before + 1
      else
        exit
      end if
      i = i + 1
    end do
    if (i == n_before) return
    if (i <= last) then
      call scan_exponent(text, i, last, decimal, status)
    else
      status = number_ok
    end if
  end subroutine scan_decimal

  !> Read `e[+-]digits` and add it to the exponent of a number.
  pure subroutine scan_exponent(text, first, last, decimal, status)
    !> Any text.
    character(*), intent(in) :: text
    !> Position of the letter e.
    integer(lp), intent(in) :: first
    !> Position of the last digit.
    integer(lp), intent(in) :: last
    !> The number.
    type(decimal_t), intent(inout) :: decimal
    !> `number_ok` or `number_malformed`.
    integer, intent(out) :: status
    integer(lp) :: i
    integer :: digit, exponent
    logical :: negative

    status = number_malformed
    if (text(first:first) /= 'e' .and. text(first:first) /= 'E') return
    i = first + 1
    if (i > last) return
    negative = text(i:i) == '-'
    if (negative .or. text(i:i) == '+') i = i + 1
    if (i > last) return
    exponent = 0
    do i = i, last
      digit = ichar(text(i:i)) - ichar('0')
      if (digit < 0 .or. digit > 9) return
      exponent = min(10*exponent + digit, max_exponent)
    end do
    if (negative) exponent = -exponent
    decimal%exponent = decimal%exponent + exponent
    status = number_ok
  end subroutine scan_exponent

  !> Scale the mantissa in about twice the working precision.
  !!
  !! The number is held as an unevaluated sum of two reals, after Dekker (Numer. Math. 18, 1971).
  !! The result is certain unless the sum lies too near to the middle of two reals.
  pure subroutine scale_in_two_parts(decimal, number, is_certain)
    !> The number in decimal.
    type(decimal_t), intent(in) :: decimal
    !> The nearest real when that is certain.
    real(wp), intent(inout) :: number
    !> Whether `number` is the nearest real.
    logical, intent(out) :: is_certain
    real(wp) :: high, low, power, product, product_error, rest, doubt
    integer :: left, step

    is_certain = .false.
    if (digits(1.0_wp) /= 53) return
    if (decimal%truncated .or. abs(decimal%exponent) > 88) return
    high = real(decimal%mantissa, wp)
    low = real(decimal%mantissa - int(high, lp), wp)
    left = int(abs(decimal%exponent))
    do while (left > 0)
      step = min(left, 22)
      left = left - step
      power = exact_power(step)
      if (decimal%exponent > 0) then
        call multiply_exactly(high, power, product, product_error)
        high = product
        rest = product_error + low*power
      else
        rest = high
        high = high/power
        call multiply_exactly(high, power, product, product_error)
        rest = (((rest - product) - product_error) + low)/power
      end if
      product = high
      high = product + rest
      low = rest - (high - product)
    end do
    ! four steps err by less than 2**-40 of the spacing; below a power of two the spacing halves
    doubt = spacing(high)*2.0_wp**(-30)
    is_certain = abs(abs(low) - 0.5_wp*spacing(high)) > doubt &
                 .and. abs(abs(low) - 0.25_wp*spacing(high)) > doubt
    if (is_certain) number = sign(high, merge(-1.0_wp, 1.0_wp, decimal%negative))
  end subroutine scale_in_two_parts

  !> The product of two reals as `high + low`, exact to 2**-106 of its size.
  !!
  !! Dekker splits with a multiplication, which is wrong when a compiler fuses it with the
  !! subtraction behind it. Here all partial products are exact, so that fusing does no harm.
  pure subroutine multiply_exactly(a, b, high, low)
    !> First factor.
    real(wp), intent(in) :: a
    !> Second factor.
    real(wp), intent(in) :: b
    !> The rounded product.
    real(wp), intent(out) :: high
    !> What rounding took away.
    real(wp), intent(out) :: low
    real(wp) :: a_high, a_low, b_high, b_low

    a_high = upper_half(a)
    a_low = a - a_high
    b_high = upper_half(b)
    b_low = b - b_high
    high = a*b
    low = ((a_high*b_high - high) + a_high*b_low + a_low*b_high) + a_low*b_low
  end subroutine multiply_exactly

  !> A real with the lower 27 of its 53 bits set to zero.
  pure function upper_half(a) result(half)
    !> The real.
    real(wp), intent(in) :: a
    !> The same, cut towards zero.
    real(wp) :: half

    half = transfer(iand(transfer(a, 0_lp), not(2_lp**27 - 1)), a)
  end function upper_half

  !> Read a number of any length and size; slow.
  pure subroutine read_exactly(text, decimal, number, status)
    !> The number, with correct syntax.
    character(*), intent(in) :: text
    !> Its leading digits and size.
    type(decimal_t), intent(in) :: decimal
    !> The nearest real; 0 when it is too large.
    real(wp), intent(inout) :: number
    !> `number_ok` or `number_too_large`.
    integer, intent(out) :: status
    integer(lp), parameter :: largest_mantissa = 179769313486231580_lp
    integer(lp) :: power

    status = number_too_large
    power = decimal%exponent + decimal%n_digits
    if (power > 309) return
    if (power == 309) then
      ! decided here: an overflow inside the read would stop a program that traps it
      if (decimal%mantissa*10_lp**(max_digits - decimal%n_digits) >= largest_mantissa) return
    end if
    status = number_ok
    if (power < -330) return
    read (text, *, iostat=status) number
    if (status /= 0) status = number_malformed
  end subroutine read_exactly

  !> The integer in `text(first:last)`: `[+-]digits`.
  pure subroutine parse_integer(text, first, last, number, status)
    !> Any text.
    character(*), intent(in) :: text
    !> Position of the first character of the number.
    integer(lp), intent(in) :: first
    !> Position of its last character.
    integer(lp), intent(in) :: last
    !> The number; 0 unless the status is `number_ok`.
    integer(lp), intent(out) :: number
    !> `number_ok`, `number_malformed` or `number_too_large`.
    integer, intent(out) :: status
    integer(lp) :: i, total
    integer :: digit
    logical :: negative, too_large

    number = 0
    status = number_malformed
    if (last < first) return
    i = first
    negative = text(i:i) == '-'
    if (negative .or. text(i:i) == '+') i = i + 1
    if (i > last) return
    total = 0
    too_large = .false.
    do i = i, last
      digit = ichar(text(i:i)) - ichar('0')
      if (digit < 0 .or. digit > 9) return
      too_large = too_large .or. total > (huge(total) - digit)/10
      if (.not. too_large) total = 10*total + digit
    end do
    status = merge(number_too_large, number_ok, too_large)
    if (too_large) return
    number = merge(-total, total, negative)
  end subroutine parse_integer

  !> The values that are no numbers in the strict sense: `nan`, `inf` and `infinity`, any case.
  pure subroutine parse_special(text, number, is_special)
    !> Any text.
    character(*), intent(in) :: text
    !> NaN or an infinity when special, else 0.
    real(wp), intent(out) :: number
    !> Whether the text is one of them, perhaps with a sign.
    logical, intent(out) :: is_special
    character(8) :: word
    integer :: first, i
    logical :: negative

    number = 0.0_wp
    is_special = .false.
    if (len(text) < 3 .or. len(text) > 9) return
    negative = text(1:1) == '-'
    first = 1
    if (negative .or. text(1:1) == '+') first = 2
    if (len(text) - first + 1 > len(word)) return
    word = text(first:)
    do i = 1, len(word)
      if (word(i:i) >= 'A' .and. word(i:i) <= 'Z') word(i:i) = achar(iachar(word(i:i)) + 32)
    end do
    is_special = word == 'nan' .or. word == 'inf' .or. word == 'infinity'
    if (.not. is_special) return
    if (word == 'nan') then
      number = ieee_value(number, ieee_quiet_nan)
    else if (negative) then
      number = ieee_value(number, ieee_negative_inf)
    else
      number = ieee_value(number, ieee_positive_inf)
    end if
  end subroutine parse_special

end module mpm_number_parser
