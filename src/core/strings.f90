!> Text helpers: numbers to text, lists of words, the nearest known name.
module mpm_strings
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: append_text, counted, duration_text, excerpt, nearest_name, string_t, to_text

  !> A text of any length, for lists of texts.
  type :: string_t
    !> The text.
    character(:), allocatable :: text
  end type string_t

  !> A number and what is counted: `1 step`, `3 steps`.
  interface counted
    module procedure counted_integer
    module procedure counted_long
  end interface counted

  !> A number as short text.
  interface to_text
    module procedure integer_to_text
    module procedure long_to_text
    module procedure real_to_text
  end interface to_text

contains

  !> Append a text to a list.
  pure subroutine append_text(list, text)
    !> The list.
    type(string_t), allocatable, intent(inout) :: list(:)
    !> The new last text.
    character(*), intent(in) :: text
    type(string_t), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer))%text = text
    call move_alloc(longer, list)
  end subroutine append_text

  !> Decimal text of an integer.
  pure function integer_to_text(value) result(text)
    !> The number.
    integer, intent(in) :: value
    !> Its digits without blanks.
    character(:), allocatable :: text

    text = long_to_text(int(value, lp))
  end function integer_to_text

  !> Decimal text of a long integer.
  pure function long_to_text(value) result(text)
    !> The number.
    integer(lp), intent(in) :: value
    !> Its digits without blanks.
    character(:), allocatable :: text
    character(24) :: buffer

    write (buffer, '(i0)') value
    text = trim(buffer)
  end function long_to_text

  !> A number and what is counted.
  pure function counted_integer(n, what) result(text)
    !> The number.
    integer, intent(in) :: n
    !> One of them.
    character(*), intent(in) :: what
    !> `1 number` or `3 numbers`.
    character(:), allocatable :: text

    text = counted_long(int(n, lp), what)
  end function counted_integer

  !> A long number and what is counted.
  pure function counted_long(n, what) result(text)
    !> The number.
    integer(lp), intent(in) :: n
    !> One of them.
    character(*), intent(in) :: what
    !> `1 number` or `3 numbers`.
    character(:), allocatable :: text

    text = long_to_text(n)//' '//what
    if (n /= 1) text = text//'s'
  end function counted_long

  !> Short text of a real for messages, `digits` significant digits (default 6).
  pure function real_to_text(value, digits) result(text)
    !> The number.
    real(wp), intent(in) :: value
    !> Significant digits, 1 to 17.
    integer, intent(in), optional :: digits
    !> The number without blanks: `0.25`, `1.5e-05`, `NaN`.
    character(:), allocatable :: text
    character(40) :: buffer
    character(16) :: form
    integer :: n, e, mantissa_end

    n = 6
    if (present(digits)) n = digits
    write (form, '(a,i0,a)') '(es40.', max(n - 1, 0), 'e3)'
    write (buffer, form) value
    buffer = adjustl(buffer)
    e = scan(buffer, 'E')
    if (e == 0) then
      text = trim(buffer)
      return
    end if
    read (buffer(e + 1:), *) n
    if (n >= -4 .and. n <= 6) then
      text = plain_text(buffer(:e - 1), n)
      return
    end if
    mantissa_end = verify(buffer(:e - 1), '0', back=.true.)
    if (buffer(mantissa_end:mantissa_end) == '.') mantissa_end = mantissa_end - 1
    text = buffer(:mantissa_end)//'e'//long_to_text(int(n, lp))
  end function real_to_text

  !> A time span in words.
  pure function duration_text(seconds) result(text)
    !> The span. [s]
    real(wp), intent(in) :: seconds
    !> For example `1 h 2 min` or `3.14 s`.
    character(:), allocatable :: text
    integer :: minutes

    if (seconds < 100.0_wp) then
      text = real_to_text(seconds, 3)//' s'
    else
      minutes = int(min(seconds, 1.0e9_wp)/60.0_wp)
      if (minutes < 60) then
        text = integer_to_text(minutes)//' min '//integer_to_text(int(seconds) - 60*minutes)//' s'
      else
        text = integer_to_text(minutes/60)//' h '//integer_to_text(mod(minutes, 60))//' min'
      end if
    end if
  end function duration_text

  !> Write `d.ddd * 10**exponent` without an exponent and without trailing zeros.
  pure function plain_text(mantissa, exponent) result(text)
    !> One digit, a point and more digits, perhaps signed.
    character(*), intent(in) :: mantissa
    !> Power of ten.
    integer, intent(in) :: exponent
    !> The number in plain notation.
    character(:), allocatable :: text, digits, sign
    integer :: first, last

    first = 1
    sign = ''
    if (mantissa(1:1) == '-') then
      first = 2
      sign = '-'
    end if
    digits = mantissa(first:first)//mantissa(first + 2:)
    if (exponent < 0) then
      text = '0.'//repeat('0', -exponent - 1)//digits
    else
      if (len(digits) < exponent + 1) digits = digits//repeat('0', exponent + 1 - len(digits))
      text = digits(:exponent + 1)//'.'//digits(exponent + 2:)
    end if
    last = verify(text, '0', back=.true.)
    if (text(last:last) == '.') last = last - 1
    text = sign//text(:last)
  end function plain_text

  !> The start of a text for a message: at most `limit` bytes, without control characters.
  pure function excerpt(text, limit) result(short)
    !> Any text.
    character(*), intent(in) :: text
    !> Most bytes to keep, at least 4; default 40.
    integer, intent(in), optional :: limit
    !> The text, or its start and `...`.
    character(:), allocatable :: short
    integer :: i, last

    last = 40
    if (present(limit)) last = limit
    if (len(text) <= last) then
      short = text
    else
      last = last - 3
      ! a character of several bytes is kept whole or left out
      do while (last > 1 .and. is_continuation(text(last + 1:last + 1)))
        last = last - 1
      end do
      short = text(:last)//'...'
    end if
    do i = 1, len(short)
      if (iachar(short(i:i)) < 32 .or. iachar(short(i:i)) == 127) short(i:i) = '?'
    end do
  end function excerpt

  !> Whether a byte is the second or a later one of a UTF-8 character.
  pure function is_continuation(byte)
    !> The byte.
    character(1), intent(in) :: byte
    !> True for 128 to 191.
    logical :: is_continuation

    is_continuation = iand(ichar(byte), 192) == 128
  end function is_continuation

  !> The known name nearest to `name` by edit distance, or '' when none is near.
  pure function nearest_name(name, known) result(nearest)
    !> The name as it was written.
    character(*), intent(in) :: name
    !> Known names.
    type(string_t), intent(in) :: known(:)
    !> The nearest known name; '' when more than about a third of the letters differ.
    character(:), allocatable :: nearest
    integer :: i, distance, best

    nearest = ''
    best = huge(best)
    do i = 1, size(known)
      ! The distance is no less than this; a name of any length must not take long.
      if (abs(len(name) - len(known(i)%text)) > max(1, len(known(i)%text)/3)) cycle
      distance = edit_distance(lower_case(name), lower_case(known(i)%text))
      if (distance < best .and. distance <= max(1, len(known(i)%text)/3)) then
        best = distance
        nearest = known(i)%text
      end if
    end do
  end function nearest_name

  !> Levenshtein distance: the fewest insertions, deletions and substitutions.
  pure function edit_distance(a, b) result(distance)
    !> First text.
    character(*), intent(in) :: a
    !> Second text.
    character(*), intent(in) :: b
    !> Number of edits.
    integer :: distance
    integer :: row(0:len(b)), i, j, diagonal, above

    row = [(j, j=0, len(b))]
    do i = 1, len(a)
      diagonal = row(0)
      row(0) = i
      do j = 1, len(b)
        above = row(j)
        row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
        diagonal = above
      end do
    end do
    distance = row(len(b))
  end function edit_distance

  !> ASCII lower case.
  pure function lower_case(text) result(lower)
    !> Any text.
    character(*), intent(in) :: text
    !> The same with a-z for A-Z.
    character(len(text)) :: lower
    integer :: i, code

    lower = text
    do i = 1, len(text)
      code = iachar(text(i:i))
      if (code >= iachar('A') .and. code <= iachar('Z')) lower(i:i) = achar(code + 32)
    end do
  end function lower_case

end module mpm_strings
