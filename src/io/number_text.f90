!> Numbers to text, fast and short, into a buffer of the caller.
!!
!! Up to 15 significant digits come from integer arithmetic: the number is scaled by exact powers of
!! ten and rounded once. They are right to one unit of the last digit, and a number that was read
!! from a decimal of so many digits gives that decimal back. For 16 and 17 digits the product with
!! the power of ten is formed with all its bits; formatted output serves what is left.
module mpm_number_text
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use mpm_kinds, only: lp, wp
  use mpm_number_parser, only: exact_power, multiply_exactly
  implicit none
  private
  public :: append_integer, append_real, default_digits, max_number_length, pairs

  !> Most characters that one number takes.
  integer, parameter :: max_number_length = 26
  !> Significant digits when none are asked for.
  integer, parameter :: default_digits = 10

  !> Most digits that are right after scaling in working precision.
  integer, parameter :: max_fast_digits = 15
  !> Powers of ten as integers.
  integer(lp), parameter :: integer_power(0:18) = &
    [1_lp, 10_lp, 100_lp, 1000_lp, 10000_lp, 100000_lp, 1000000_lp, 10000000_lp, 100000000_lp, &
     1000000000_lp, 10000000000_lp, 100000000000_lp, 1000000000000_lp, 10000000000000_lp, &
     100000000000000_lp, 1000000000000000_lp, 10000000000000000_lp, 100000000000000000_lp, &
     1000000000000000000_lp]

  !> All pairs of digits, 00 to 99.
  character(*), parameter :: pairs = &
    '00010203040506070809101112131415161718192021222324252627282930313233343536373839&
    &40414243444546474849505152535455565758596061626364656667686970717273747576777879&
    &8081828384858687888990919293949596979899'

  !> An integer at the end of a text.
  interface append_integer
    module procedure append_default_integer
    module procedure append_long_integer
  end interface append_integer

contains

  !> Write a real behind the text in a buffer: `0.25`, `100000`, `1.5e-05`, `nan`, `-inf`.
  !!
  !! Plain from 1e-4 up to below 1e10, with an exponent otherwise; no trailing zeros.
  pure subroutine append_real(buffer, length, number, digits)
    !> The text; at least `max_number_length` characters are free.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The number.
    real(wp), intent(in) :: number
    !> Significant digits, 1 to 17.
    integer, intent(in) :: digits
    integer(lp) :: mantissa
    integer :: n, power
    logical :: certain

    if (.not. ieee_is_finite(number)) then
      call append_special(buffer, length, number)
      return
    end if
    if (sign(1.0_wp, number) < 0.0_wp .and. abs(number) > 0.0_wp) then
      length = length + 1
      buffer(length:length) = '-'
    end if
    if (.not. abs(number) > 0.0_wp) then
      length = length + 1
      buffer(length:length) = '0'
      return
    end if
    n = min(max(digits, 1), 17)
    if (n <= max_fast_digits .and. is_fast_size(abs(number), n)) then
      call scale_to_integer(abs(number), n, mantissa, power)
    else
      call exact_digits(abs(number), n, mantissa, power, certain)
      if (.not. certain) call read_back_digits(abs(number), n, mantissa, power)
    end if
    call drop_trailing_zeros(mantissa, n)
    if (power >= -4 .and. power < 10) then
      call append_plain(buffer, length, mantissa, n, power)
    else
      call append_scientific(buffer, length, mantissa, n, power)
    end if
  end subroutine append_real

  !> Whether scaling errs by less than half a unit of the last digit.
  !!
  !! Each step of 10**22 adds a rounding of up to 0.11 units in 15 digits; two steps are fine.
  pure function is_fast_size(number, n) result(is_fast)
    !> The number, positive.
    real(wp), intent(in) :: number
    !> Significant digits.
    integer, intent(in) :: n
    !> Within 1e-25 to 1e35, or 1e-280 to 1e280 for 12 digits and fewer.
    logical :: is_fast

    if (n <= 12) then
      is_fast = number > 1.0e-280_wp .and. number < 1.0e280_wp
    else
      is_fast = number > 1.0e-25_wp .and. number < 1.0e35_wp
    end if
  end function is_fast_size

  !> The leading digits of a number as an integer: `number = mantissa * 10**(power - n + 1)`.
  pure subroutine scale_to_integer(number, n, mantissa, power)
    !> The number, positive.
    real(wp), intent(in) :: number
    !> Significant digits.
    integer, intent(in) :: n
    !> The digits, from 10**(n - 1) to 10**n - 1.
    integer(lp), intent(out) :: mantissa
    !> Power of ten of the first digit.
    integer, intent(out) :: power

    ! log10(2) = 78913/2**18 is near enough to be wrong by one at most, which is mended below
    power = shifta(binary_exponent(number)*78913, 18)
    mantissa = int(scaled(number, n - 1 - power) + 0.5_wp, lp)
    if (mantissa >= integer_power(n)) then
      power = power + 1
      mantissa = int(scaled(number, n - 1 - power) + 0.5_wp, lp)
    else if (mantissa < integer_power(n - 1)) then
      power = power - 1
      mantissa = int(scaled(number, n - 1 - power) + 0.5_wp, lp)
    end if
    ! 9.99... may round up to 10
    if (mantissa == integer_power(n)) then
      power = power + 1
      mantissa = integer_power(n - 1)
    end if
  end subroutine scale_to_integer

  !> Power of two of the first binary digit of a number: `exponent(number) - 1` without a call.
  pure function binary_exponent(number) result(power)
    !> The number, positive; below the smallest normal number the power is too small.
    real(wp), intent(in) :: number
    !> The power.
    integer :: power

    power = int(shiftr(transfer(number, 0_lp), 52)) - 1023
  end function binary_exponent

  !> A number times a power of ten, with one rounding for each 22 places.
  pure function scaled(number, places) result(product)
    !> The number.
    real(wp), intent(in) :: number
    !> Places to shift the decimal point to the right.
    integer, intent(in) :: places
    !> `number*10**places`.
    real(wp) :: product
    integer :: left

    product = number
    left = abs(places)
    do while (left > 22)
      left = left - 22
      if (places > 0) then
        product = product*exact_power(22)
      else
        product = product/exact_power(22)
      end if
    end do
    if (places > 0) then
      product = product*exact_power(left)
    else
      product = product/exact_power(left)
    end if
  end function scaled

  !> The leading digits of a number, correctly rounded, for numbers of common size.
  pure subroutine exact_digits(number, n, mantissa, power, certain)
    !> The number, positive.
    real(wp), intent(in) :: number
    !> Significant digits, at most 17.
    integer, intent(in) :: n
    !> The digits, from 10**(n - 1) to 10**n - 1.
    integer(lp), intent(out) :: mantissa
    !> Power of ten of the first digit.
    integer, intent(out) :: power
    !> Whether they are found: otherwise the number is too large or small, or almost a tie.
    logical, intent(out) :: certain
    ! The part behind the digits errs by less than this.
    real(wp), parameter :: doubt = 1.0e-6_wp
    real(wp) :: high, low, first, rest
    integer :: places, attempt

    certain = .false.
    mantissa = 0
    power = shifta(binary_exponent(number)*78913, 18)
    do attempt = 1, 2
      places = n - 1 - power
      if (places < 0 .or. places > 44) return
      call multiply_exactly(number, exact_power(min(places, 22)), high, low)
      if (places > 22) then
        first = high
        rest = low*exact_power(places - 22)
        call multiply_exactly(first, exact_power(places - 22), high, low)
        low = low + rest
      end if
      if (high > 9.0e18_wp) return
      mantissa = int(high, lp)
      low = low + (high - real(mantissa, wp))
      mantissa = mantissa + floor(low, lp)
      low = low - aint(low)
      if (low < 0.0_wp) low = low + 1.0_wp
      if (abs(low - 0.5_wp) < doubt .or. min(low, 1.0_wp - low) < doubt .and. low > 0.0_wp) return
      if (low > 0.5_wp) mantissa = mantissa + 1
      if (mantissa >= integer_power(n)) then
        power = power + 1
      else if (mantissa < integer_power(n - 1)) then
        power = power - 1
      else
        certain = .true.
        return
      end if
    end do
  end subroutine exact_digits

  !> The leading digits of a number, correctly rounded, by way of formatted output; slow.
  pure subroutine read_back_digits(number, n, mantissa, power)
    !> The number, positive.
    real(wp), intent(in) :: number
    !> Significant digits.
    integer, intent(in) :: n
    !> The digits, from 10**(n - 1) to 10**n - 1.
    integer(lp), intent(out) :: mantissa
    !> Power of ten of the first digit.
    integer, intent(out) :: power
    character(32) :: text
    character(12) :: form
    integer :: i

    write (form, '(a,i0,a)') '(es32.', n - 1, 'e4)'
    write (text, form) number
    ! the text ends in a letter, a sign and four digits of the exponent
    mantissa = 0
    do i = 1, 26
      if (index('0123456789', text(i:i)) == 0) cycle
      mantissa = 10*mantissa + (iachar(text(i:i)) - iachar('0'))
    end do
    power = 0
    do i = 29, 32
      power = 10*power + (iachar(text(i:i)) - iachar('0'))
    end do
    if (text(28:28) == '-') power = -power
  end subroutine read_back_digits

  !> Take zeros from the end of a mantissa.
  pure subroutine drop_trailing_zeros(mantissa, n)
    !> The digits, not zero.
    integer(lp), intent(inout) :: mantissa
    !> Number of digits.
    integer, intent(inout) :: n

    if (mod(mantissa, 10_lp) /= 0) return
    do while (n > 8)
      if (mod(mantissa, 100000000_lp) /= 0) exit
      mantissa = mantissa/100000000_lp
      n = n - 8
    end do
    do while (n > 1)
      if (mod(mantissa, 10_lp) /= 0) exit
      mantissa = mantissa/10_lp
      n = n - 1
    end do
  end subroutine drop_trailing_zeros

  !> Write digits in plain notation.
  pure subroutine append_plain(buffer, length, mantissa, n, power)
    !> The text.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The digits.
    integer(lp), intent(in) :: mantissa
    !> Number of digits.
    integer, intent(in) :: n
    !> Power of ten of the first digit, -4 to 9.
    integer, intent(in) :: power
    integer :: n_zeros, i

    ! Pieces of fixed length, longer than needed: what is too much is written over.
    if (power < 0) then
      buffer(length + 1:length + 5) = '0.000'
      length = length + 1 - power
      call put_digits(buffer, length, mantissa, n)
    else if (n <= power + 1) then
      call put_digits(buffer, length, mantissa, n)
      n_zeros = power + 1 - n
      buffer(length + 1:length + 9) = '000000000'
      length = length + n_zeros
    else
      ! all digits one place too far to the right, then the whole part moves over
      length = length + 1
      call put_digits(buffer, length, mantissa, n)
      do i = length - n, length - n + power
        buffer(i:i) = buffer(i + 1:i + 1)
      end do
      buffer(i:i) = '.'
    end if
  end subroutine append_plain

  !> Write digits with an exponent of at least two digits.
  pure subroutine append_scientific(buffer, length, mantissa, n, power)
    !> The text.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The digits.
    integer(lp), intent(in) :: mantissa
    !> Number of digits.
    integer, intent(in) :: n
    !> Power of ten of the first digit.
    integer, intent(in) :: power
    integer :: n_exponent

    call append_plain(buffer, length, mantissa, n, 0)
    buffer(length + 1:length + 2) = merge('e-', 'e+', power < 0)
    n_exponent = merge(2, 3, abs(power) < 100)
    length = length + 2
    call put_digits(buffer, length, int(abs(power), lp), n_exponent)
  end subroutine append_scientific

  !> Write what is no number.
  pure subroutine append_special(buffer, length, number)
    !> The text.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> NaN or an infinity.
    real(wp), intent(in) :: number

    if (ieee_is_nan(number)) then
      buffer(length + 1:length + 3) = 'nan'
      length = length + 3
    else if (number > 0.0_wp) then
      buffer(length + 1:length + 3) = 'inf'
      length = length + 3
    else
      buffer(length + 1:length + 4) = '-inf'
      length = length + 4
    end if
  end subroutine append_special

  !> Write an integer behind the text in a buffer.
  pure subroutine append_default_integer(buffer, length, number)
    !> The text; at least `max_number_length` characters are free.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The number.
    integer, intent(in) :: number

    call append_long_integer(buffer, length, int(number, lp))
  end subroutine append_default_integer

  !> Write a long integer behind the text in a buffer.
  pure subroutine append_long_integer(buffer, length, number)
    !> The text; at least `max_number_length` characters are free.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The number.
    integer(lp), intent(in) :: number
    integer :: n

    ! the most negative number has no positive counterpart
    if (number < -huge(number)) then
      write (buffer(length + 1:length + 20), '(i20)') number
      length = length + 20
      return
    end if
    if (number < 0) then
      length = length + 1
      buffer(length:length) = '-'
    end if
    n = 1
    do while (abs(number) >= integer_power(n))
      n = n + 1
      if (n > ubound(integer_power, 1)) exit
    end do
    call put_digits(buffer, length, abs(number), n)
  end subroutine append_long_integer

  !> Write digits of an integer behind the text in a buffer, two at a time.
  pure subroutine put_digits(buffer, length, number, n)
    !> The text.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The integer, not negative.
    integer(lp), intent(in) :: number
    !> Number of digits, at least those that the integer has.
    integer, intent(in) :: n
    integer(lp) :: rest, next
    integer :: last, i, k

    rest = number
    last = length + n
    if (n > 8) then
      ! Two times four digits that do not wait for each other.
      next = rest/100000000
      k = int(rest - 100000000*next)
      call put_four(buffer(last - 7:last - 4), k/10000)
      call put_four(buffer(last - 3:last), k - 10000*(k/10000))
      last = last - 8
      rest = next
    end if
    do i = last, length + 2, -2
      next = rest/100
      k = 2*int(rest - 100*next)
      buffer(i - 1:i) = pairs(k + 1:k + 2)
      rest = next
    end do
    if (mod(n, 2) == 1) buffer(length + 1:length + 1) = achar(int(rest) + iachar('0'))
    length = length + n
  end subroutine put_digits

  !> Write four digits.
  pure subroutine put_four(text, number)
    !> The digits.
    character(4), intent(out) :: text
    !> The number, 0 to 9999.
    integer, intent(in) :: number
    integer :: high, low

    high = number/100
    low = number - 100*high
    text(1:2) = pairs(2*high + 1:2*high + 2)
    text(3:4) = pairs(2*low + 1:2*low + 2)
  end subroutine put_four

end module mpm_number_text
