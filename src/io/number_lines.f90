!> Many numbers to text, in lines: what `append_real` and `append_integer` make of each, many at a
!! time.
!!
!! Eight to 15 digits of reals come from loops without branches, which become vector instructions: a
!! number is scaled to an integer and cut in two parts of eight digits, each of which is spread to
!! eight bytes in three steps. What is left to do one by one is to put the bytes in their place, in
!! pieces of fixed length.
module mpm_number_lines
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use mpm_kinds, only: wp
  use mpm_number_parser, only: exact_power
  use mpm_number_text, only: append_integer, append_real, pairs
  implicit none
  private
  public :: append_integer_lines, append_real_lines, low_byte_first, max_entry_length

  !> Most characters that a number and what ends it take, and as many as are written over behind.
  integer, parameter :: max_entry_length = 48
  !> Numbers that are done together.
  integer, parameter :: width = 64
  !> Digits that are found so.
  integer, parameter :: least_digits = 8, most_digits = 15
  !> Places that the decimal point is moved to the right, at least and at most.
  integer, parameter :: least_places = -21, most_places = 44
  !> Whether this machine stores the lowest byte of a number first; eight digits are written so.
  logical, parameter :: low_byte_first = iachar(transfer(1_int32, 'a')) == 1
  !> The largest integer of eight digits.
  integer, parameter :: most_in_eight = 99999999
  !> The digit 0 eight times, and what a point is less than it.
  integer(int64), parameter :: zero = int(z'3030303030303030', int64)
  integer(int64), parameter :: less = iachar('0') - iachar('.')
  !> `0.000` and `-0.000`.
  character(8), parameter :: signs(0:1) = ['0.000   ', '-0.000  ']
  !> Where a point is that no digit is in front of: behind all that there are.
  integer, parameter :: no_point = 16
  integer :: k

  !> Powers of ten, some of them rounded: numbers so near to one are left to `append_real`.
  real(wp), parameter :: ten_to(-31:28) = &
    [(1.0_wp/exact_power(22)/exact_power(-k - 22), k=-31, -23), &
     (1.0_wp/exact_power(-k), k=-22, -1), (exact_power(k), k=0, 22), &
     (exact_power(22)*exact_power(k - 22), k=23, 28)]
  !> A number times a power of ten is it times `first` times `second`, or over `below`, with the
  !! same roundings as step by step.
  real(wp), parameter :: first(least_places:most_places) = &
    [(1.0_wp, k=least_places, 22), (exact_power(22), k=23, most_places)]
  real(wp), parameter :: second(least_places:most_places) = &
    [(1.0_wp, k=least_places, -1), (exact_power(k), k=0, 22), &
     (exact_power(k - 22), k=23, most_places)]
  real(wp), parameter :: below(least_places:most_places) = &
    [(exact_power(-k), k=least_places, -1), (1.0_wp, k=0, most_places)]

  !> Text of some reals, in parts.
  type :: parts_t
    !> Sixteen digits, as bytes of which the lowest is the first, with a point between them. (n, 2)
    integer(int64) :: digits(width, 2)
    !> Whether the number is negative: 1, or else 0.
    integer :: minus(width)
    !> Characters in front of the digits.
    integer :: start(width)
    !> Characters of the digits, without zeros at the end.
    integer :: length(width)
    !> Power of ten of the first digit.
    integer :: power(width)
    !> Whether the number is of a common size, and not 0.
    logical :: common(width)
    !> 0 where the digits were found.
    real(wp) :: missed(width)
  end type parts_t

contains

  !> Write reals behind the text in a buffer, blanks between them, some on each line.
  pure subroutine append_real_lines(buffer, length, numbers, digits, per_line, per_group)
    !> The text; at least `max_entry_length` characters a number are free.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The numbers; the last line is ended, too.
    real(wp), intent(in) :: numbers(:)
    !> Significant digits, 1 to 17.
    integer, intent(in) :: digits
    !> Numbers on a line, at least 1.
    integer, intent(in) :: per_line
    !> Numbers, of whole lines, behind which there is an empty line.
    integer, intent(in) :: per_group
    type(parts_t) :: known
    real(wp) :: block(width)
    integer :: start, n, i, last, on_line, in_group

    last = length
    on_line = 0
    in_group = 0
    do start = 0, size(numbers) - 1, width
      n = min(width, size(numbers) - start)
      block(:n) = numbers(start + 1:start + n)
      if (low_byte_first .and. digits >= least_digits .and. digits <= most_digits) then
        call find_digits(n, block, digits, known)
      else
        known%common(:n) = .false.
        known%missed(:n) = 0.0_wp
      end if
      do i = 1, n
        if (known%common(i) .and. .not. abs(known%missed(i)) > 0.0_wp) then
          ! In pieces of fixed length, longer than needed: what is too much is written over.
          buffer(last + 1:last + 8) = signs(known%minus(i))
          last = last + known%start(i)
          buffer(last + 1:last + 8) = transfer(known%digits(i, 1), buffer(1:8))
          buffer(last + 9:last + 16) = transfer(known%digits(i, 2), buffer(1:8))
          last = last + known%length(i)
          associate (power => known%power(i))
            if (power < -4 .or. power >= 10) then
              buffer(last + 1:last + 2) = merge('e-', 'e+', power < 0)
              buffer(last + 3:last + 4) = pairs(2*abs(power) + 1:2*abs(power) + 2)
              last = last + 4
            end if
          end associate
        else
          call append_real(buffer, last, block(i), digits)
        end if
        last = last + 1
        on_line = on_line + 1
        if (on_line < per_line .and. start + i < size(numbers)) then
          buffer(last:last) = ' '
          cycle
        end if
        buffer(last:last) = new_line('a')
        in_group = in_group + on_line
        on_line = 0
        if (in_group < per_group) cycle
        last = last + 1
        buffer(last:last) = new_line('a')
        in_group = 0
      end do
    end do
    length = last
  end subroutine append_real_lines

  !> Write integers behind the text in a buffer, blanks between them, some on each line.
  pure subroutine append_integer_lines(buffer, length, numbers, per_line)
    !> The text; at least `max_entry_length` characters a number are free.
    character(*), intent(inout) :: buffer
    !> Characters in use.
    integer, intent(inout) :: length
    !> The numbers; the last line is ended, too.
    integer, intent(in) :: numbers(:)
    !> Numbers on a line, at least 1.
    integer, intent(in) :: per_line
    integer(int64) :: eight(width)
    integer :: block(width), start, n, i, last, on_line, unused

    last = length
    on_line = 0
    do start = 0, size(numbers) - 1, width
      n = min(width, size(numbers) - start)
      block(:n) = numbers(start + 1:start + n)
      eight(:n) = bytes_of(int(min(max(block(:n), 0), most_in_eight), int32))
      do i = 1, n
        if (low_byte_first .and. block(i) >= 0 .and. block(i) <= most_in_eight) then
          unused = min(trailz(eight(i))/8, 7)
          buffer(last + 1:last + 8) = transfer(shiftr(eight(i) + zero, 8*unused), buffer(1:8))
          last = last + 8 - unused
        else
          call append_integer(buffer, last, block(i))
        end if
        last = last + 1
        on_line = on_line + 1
        buffer(last:last) = ' '
        if (on_line < per_line .and. start + i < size(numbers)) cycle
        buffer(last:last) = new_line('a')
        on_line = 0
      end do
    end do
    length = last
  end subroutine append_integer_lines

  !> The digits of some reals.
  pure subroutine find_digits(n, numbers, digits, known)
    !> How many numbers.
    integer, intent(in) :: n
    !> The numbers.
    real(wp), intent(in) :: numbers(width)
    !> Significant digits, `least_digits` to `most_digits`.
    integer, intent(in) :: digits
    !> Their digits.
    type(parts_t), intent(inout) :: known
    real(wp) :: size_of(width), scaled(width), top, bottom, unit, next, y, head, tail
    integer(int64) :: bits, inside, least, most
    integer :: places(width), twos, power, i

    ! More than 12 digits of smaller numbers come from all their bits, which `append_real` forms.
    least = transfer(merge(1.0e-30_wp, 1.0e-25_wp, digits <= 12), least)
    most = transfer(1.0e27_wp, most)
    top = exact_power(digits) - 1.0_wp
    bottom = exact_power(digits - 1)
    unit = exact_power(digits - least_digits)
    next = exact_power(2*least_digits - digits)
    do i = 1, n
      ! Positive reals are in the order of their bits.
      bits = iand(transfer(numbers(i), bits), huge(bits))
      inside = min(max(bits, least), most)
      known%common(i) = bits == inside
      size_of(i) = transfer(inside, y)
      ! log10(2) = 78913/2**18: the power of the first digit or one less.
      twos = int(shiftr(inside, 52)) - 1023
      known%power(i) = shifta(twos*78913, 18)
    end do
    do i = 1, n
      power = known%power(i)
      power = power + int(0.5_wp + sign(0.5_wp, size_of(i) - ten_to(power + 1)))
      known%power(i) = power
      places(i) = digits - 1 - power
    end do
    do i = 1, n
      scaled(i) = size_of(i)*first(places(i))*second(places(i))
    end do
    if (any(places(:n) < 0)) scaled(:n) = scaled(:n)/below(places(:n))
    do i = 1, n
      y = floor_of(scaled(i) + 0.5_wp)
      scaled(i) = min(max(y, bottom), top)
      known%missed(i) = y - scaled(i)
    end do
    y = 1.0_wp/unit
    do i = 1, n
      ! A half is more than what is rounded, and less than what is missing to the next one.
      head = real(int((scaled(i) + 0.5_wp)*y, int32), wp)
      tail = (scaled(i) - head*unit)*next
      known%digits(i, 1) = bytes_of(int(head, int32))
      known%digits(i, 2) = bytes_of(int(tail, int32))
    end do
    call place(n, numbers, known)
  end subroutine find_digits

  !> Put points between digits, and find lengths.
  pure subroutine place(n, numbers, known)
    !> How many numbers.
    integer, intent(in) :: n
    !> The numbers.
    real(wp), intent(in) :: numbers(width)
    !> Their digits, 0 to 9 each; then their text.
    type(parts_t), intent(inout) :: known
    integer(int64) :: a, b, before, bit
    integer :: whole(width), power, digits, i

    do i = 1, n
      power = known%power(i)
      whole(i) = merge(power + 1, 1, power >= 0 .and. power < 10)
      whole(i) = merge(no_point, whole(i), power >= -4 .and. power < 0)
      known%minus(i) = int(shiftr(transfer(numbers(i), bit), 63))
      known%start(i) = known%minus(i) + merge(1 - power, 0, power >= -4 .and. power < 0)
    end do
    do i = 1, n
      a = known%digits(i, 1)
      b = known%digits(i, 2)
      digits = merge(16 - leadz(b)/8, 8 - leadz(a)/8, b /= 0)
      known%length(i) = merge(digits, merge(digits + 1, whole(i), digits > whole(i)), &
                              whole(i) == no_point)
    end do
    do i = 1, n
      a = known%digits(i, 1)
      b = known%digits(i, 2)
      bit = shiftl(1_int64, 8*min(whole(i), 8))
      before = iand(a, bit - 1)
      known%digits(i, 1) = before + shiftl(a - before, 8) + (zero - less*bit)
      bit = shiftl(1_int64, 8*min(max(whole(i) - 8, 0), 8))
      before = iand(b, bit - 1)
      known%digits(i, 2) = before + shiftl(b - before, 8) + zero &
                           + merge(shiftr(a, 56), -less*bit, whole(i) < 8)
    end do
  end subroutine place

  !> The largest whole number that is not above a number below 2**51: without a call on any machine.
  elemental function floor_of(x) result(y)
    !> The number, not negative.
    real(wp), intent(in) :: x
    !> The whole number.
    real(wp) :: y
    !> What is added to it is rounded to a whole number.
    real(wp), parameter :: large = 2.0_wp**52

    y = (x + large) - large
    y = y + (sign(0.5_wp, x - y) - 0.5_wp)
  end function floor_of

  !> The eight digits of an integer below 10**8 as bytes, the first one in the lowest.
  !!
  !! Four, two and one digit at a time, side by side in one integer; the products are those of
  !! 1/100 and 1/10, right for so few digits.
  elemental function bytes_of(number) result(bytes)
    !> The integer.
    integer(int32), intent(in) :: number
    !> The digits, 0 to 9 each.
    integer(int64) :: bytes
    integer(int64) :: tens

    tens = int(number/10000_int32, int64)
    bytes = ior(tens, shiftl(int(number, int64) - 10000_int64*tens, 32))
    tens = iand(shiftr(bytes*10486_int64, 20), int(z'0000007F0000007F', int64))
    bytes = ior(tens, shiftl(bytes - 100_int64*tens, 16))
    tens = iand(shiftr(bytes*103_int64, 10), int(z'000F000F000F000F', int64))
    bytes = ior(tens, shiftl(bytes - 10_int64*tens, 8))
  end function bytes_of

end module mpm_number_lines
