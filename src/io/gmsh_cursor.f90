!> A place in a Gmsh file, from which numbers are read as text or as bytes.
module mpm_gmsh_cursor
  use, intrinsic :: iso_fortran_env, only: real64
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: ip, lp, wp
  use mpm_number_parser, only: number_ok, parse_integer, parse_real
  use mpm_strings, only: excerpt, to_text
  use mpm_text_file, only: read_whole_file
  implicit none
  private
  public :: gmsh_cursor_t, short_integer, long_integer

  !> Bytes of the integers of a binary file.
  integer, parameter :: short_integer = 4, long_integer = 8
  !> Largest magnitude of a coordinate, so that volumes can be stored. [m]
  real(wp), parameter :: largest = 1.0e75_wp
  !> Most nodes or elements.
  integer(lp), parameter :: most_counted = 2_lp**28

  !> A file that is being read.
  type :: gmsh_cursor_t
    !> The file, for messages.
    character(:), allocatable :: path
    !> All its bytes.
    character(:), allocatable :: text
    !> The next byte, from 1.
    integer(lp) :: at = 1
    !> Line of the next byte, from 1; without meaning in a binary file.
    integer :: line = 1
    !> Numbers are bytes.
    logical :: binary = .false.
    !> Bytes are in the other order than those of this machine.
    logical :: swapped = .false.
  contains
    !> Read the file.
    procedure :: open => cursor_open
    !> Go to the next word and return where it begins and ends.
    procedure :: next_word => cursor_next_word
    !> The rest of the line, from the next word on.
    procedure :: rest_of_line => cursor_rest_of_line
    !> Go behind the end of the line.
    procedure :: end_line => cursor_end_line
    !> Read an integer.
    procedure :: get_integer => cursor_get_integer
    !> Read a real.
    procedure :: get_real => cursor_get_real
    !> Read a count and compare it with what is left of the file.
    procedure :: get_count => cursor_get_count
    !> Pass over an integer or more.
    procedure :: skip_integers => cursor_skip_integers
    !> Go behind a text.
    procedure :: go_behind => cursor_go_behind
    !> The place, for other messages: line or byte.
    procedure :: place => cursor_place
    !> Raise an input error at the cursor, or at a place.
    procedure :: fail => cursor_fail
    procedure, private :: get_bytes
  end type gmsh_cursor_t

contains

  !> Read the file.
  subroutine cursor_open(self, path, error)
    !> The cursor, at the start afterwards.
    class(gmsh_cursor_t), intent(inout) :: self
    !> The file.
    character(*), intent(in) :: path
    !> It can't be read.
    type(error_t), allocatable, intent(out) :: error

    self%path = trim(path)
    self%at = 1
    self%line = 1
    self%binary = .false.
    self%swapped = .false.
    call read_whole_file(path, self%text, error)
  end subroutine cursor_open

  !> Go to the next word and return where it begins and ends.
  pure subroutine cursor_next_word(self, first, last)
    !> The cursor, behind the word afterwards.
    class(gmsh_cursor_t), intent(inout) :: self
    !> First byte.
    integer(lp), intent(out) :: first
    !> Last byte; before the first one at the end of the file.
    integer(lp), intent(out) :: last

    do while (self%at <= len(self%text, lp))
      if (.not. is_blank(self%text(self%at:self%at))) exit
      if (self%text(self%at:self%at) == new_line('a')) self%line = self%line + 1
      self%at = self%at + 1
    end do
    first = self%at
    do while (self%at <= len(self%text, lp))
      if (is_blank(self%text(self%at:self%at))) exit
      self%at = self%at + 1
    end do
    last = self%at - 1
  end subroutine cursor_next_word

  !> Whether a character parts words.
  elemental function is_blank(c)
    !> The character.
    character(1), intent(in) :: c
    !> True for blank, tab, carriage return and the end of a line.
    logical :: is_blank

    ! By their codes: the compiler compares with a blank by a call that trims.
    is_blank = any(iachar(c) == [iachar(' '), 10, 9, 13])
  end function is_blank

  !> The rest of the line, from the next word on, without blanks at its end.
  pure function cursor_rest_of_line(self) result(rest)
    !> The cursor, in front of the rest.
    class(gmsh_cursor_t), intent(in) :: self
    !> The text.
    character(:), allocatable :: rest
    integer(lp) :: last

    last = index(self%text(self%at:), new_line('a'), kind=lp)
    last = merge(self%at + last - 2, len(self%text, lp), last > 0)
    rest = self%text(self%at:last)
    if (len(rest) > 0) then
      if (rest(len(rest):) == achar(13)) rest = rest(:len(rest) - 1)
    end if
    rest = trim(adjustl(rest))
  end function cursor_rest_of_line

  !> Go behind the end of the line.
  pure subroutine cursor_end_line(self)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self

    do while (self%at <= len(self%text, lp))
      self%at = self%at + 1
      if (self%text(self%at - 1:self%at - 1) /= new_line('a')) cycle
      self%line = self%line + 1
      return
    end do
  end subroutine cursor_end_line

  !> Read an integer.
  subroutine cursor_get_integer(self, bytes, number, error, as_text)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self
    !> `short_integer` or `long_integer`: its length in a binary file.
    integer, intent(in) :: bytes
    !> The number.
    integer(lp), intent(out) :: number
    !> It is none, or the file ends.
    type(error_t), allocatable, intent(inout) :: error
    !> It is text in a binary file too; it is not when left out.
    logical, intent(in), optional :: as_text
    integer(lp) :: first, last
    integer :: status
    character(8) :: word
    logical :: by_bytes

    number = 0
    by_bytes = self%binary
    if (present(as_text)) by_bytes = by_bytes .and. .not. as_text
    if (by_bytes) then
      call self%get_bytes(bytes, word, error)
      if (allocated(error)) return
      if (bytes == short_integer) then
        number = int(transfer(word(:4), 0_ip), lp)
      else
        number = transfer(word, 0_lp)
      end if
      return
    end if
    call self%next_word(first, last)
    if (first > last) then
      call self%fail('the file ends where a number should be', error)
      return
    end if
    call parse_integer(self%text, first, last, number, status)
    if (status == number_ok) return
    call self%fail('"'//excerpt(self%text(first:last))//'" is no integer', error)
  end subroutine cursor_get_integer

  !> Read a real of a magnitude that can be calculated with.
  subroutine cursor_get_real(self, number, error)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self
    !> The number.
    real(wp), intent(out) :: number
    !> It is none, too large or not finite, or the file ends.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: first, last, bits
    integer :: status
    character(8) :: word

    number = 0.0_wp
    if (self%binary) then
      call self%get_bytes(8, word, error)
      if (allocated(error)) return
      ! All bits of the exponent are set in what is not finite.
      bits = transfer(word, 0_lp)
      if (ibits(bits, 52, 11) /= 2047_lp) then
        number = real(transfer(word, 0.0_real64), wp)
        if (abs(number) <= largest) return
      end if
      call self%fail('a coordinate is not finite or above '//to_text(largest), error)
      return
    end if
    call self%next_word(first, last)
    if (first > last) then
      call self%fail('the file ends where a number should be', error)
      return
    end if
    call parse_real(self%text, first, last, number, status)
    if (status /= number_ok) then
      call self%fail('"'//excerpt(self%text(first:last))//'" is no number', error)
    else if (abs(number) > largest) then
      call self%fail('a coordinate is above '//to_text(largest), error)
    end if
  end subroutine cursor_get_real

  !> Take the bytes of one number, in the order of this machine.
  subroutine get_bytes(self, n, word, error)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self
    !> How many, at most 8.
    integer, intent(in) :: n
    !> The bytes.
    character(8), intent(out) :: word
    !> The file ends.
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    word = ''
    if (n > len(self%text, lp) - self%at + 1) then
      self%at = len(self%text, lp) + 1
      call self%fail('the file ends where a number should be', error)
      return
    end if
    do i = 1, n
      word(i:i) = self%text(self%at + i - 1:self%at + i - 1)
    end do
    if (self%swapped) then
      do i = 1, n
        word(i:i) = self%text(self%at + n - i:self%at + n - i)
      end do
    end if
    self%at = self%at + n
  end subroutine get_bytes

  !> Read a count and compare it with what is left of the file, before memory is asked for.
  subroutine cursor_get_count(self, bytes, what, least_bytes, n, error, as_text)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self
    !> `short_integer` or `long_integer`.
    integer, intent(in) :: bytes
    !> What is counted.
    character(*), intent(in) :: what
    !> Least bytes that one of them takes in this file.
    integer, intent(in) :: least_bytes
    !> The count.
    integer, intent(out) :: n
    !> It is negative, or more than the file can have.
    type(error_t), allocatable, intent(inout) :: error
    !> It is text in a binary file too; it is not when left out.
    logical, intent(in), optional :: as_text
    integer(lp) :: number

    n = 0
    call self%get_integer(bytes, number, error, as_text)
    if (allocated(error)) return
    if (number < 0) then
      call self%fail(to_text(number)//' is no number of '//what, error)
    else if (number > min(most_counted, (len(self%text, lp) - self%at + 2)/least_bytes)) then
      call self%fail('the file says that it has '//to_text(number)//' '//what// &
                     ', but it is too short for them', error)
    else
      n = int(number)
    end if
  end subroutine cursor_get_count

  !> Pass over an integer or more.
  subroutine cursor_skip_integers(self, bytes, n, error)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self
    !> `short_integer` or `long_integer`.
    integer, intent(in) :: bytes
    !> How many.
    integer, intent(in) :: n
    !> The file ends, or has no integers there.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: unused
    integer :: i

    do i = 1, n
      call self%get_integer(bytes, unused, error)
      if (allocated(error)) return
    end do
  end subroutine cursor_skip_integers

  !> Go behind a text.
  subroutine cursor_go_behind(self, text, error)
    !> The cursor.
    class(gmsh_cursor_t), intent(inout) :: self
    !> The text.
    character(*), intent(in) :: text
    !> It does not follow.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: distance, i

    distance = index(self%text(self%at:), text, kind=lp)
    if (distance == 0) then
      call self%fail('there is no '//text//' behind this', error)
      return
    end if
    do i = self%at, self%at + distance - 2
      if (self%text(i:i) == new_line('a')) self%line = self%line + 1
    end do
    self%at = self%at + distance - 1 + len(text)
  end subroutine cursor_go_behind

  !> The place of the cursor: a line, or a byte of a binary file.
  pure function cursor_place(self) result(place)
    !> The cursor.
    class(gmsh_cursor_t), intent(in) :: self
    !> Line or byte, from 1.
    integer(lp) :: place

    place = int(self%line, lp)
    if (self%binary) place = self%at
  end function cursor_place

  !> Raise an input error at the cursor, or at a place.
  subroutine cursor_fail(self, message, error, place, hint)
    !> The cursor.
    class(gmsh_cursor_t), intent(in) :: self
    !> What is wrong.
    character(*), intent(in) :: message
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    !> As of `place`; that of the cursor when left out.
    integer(lp), intent(in), optional :: place
    !> The way out.
    character(*), intent(in), optional :: hint
    character(:), allocatable :: way_out
    integer(lp) :: here

    here = self%place()
    if (present(place)) here = place
    way_out = 'export the mesh again with Gmsh, as version 2.2 or 4.1, ASCII or binary'
    if (present(hint)) way_out = hint
    if (self%binary) then
      call raise(error, err_input, message//' (byte '//to_text(here)//')', file=self%path, &
                 hint=way_out)
    else
      call raise(error, err_input, message, file=self%path, line=int(here), hint=way_out)
    end if
  end subroutine cursor_fail

end module mpm_gmsh_cursor
