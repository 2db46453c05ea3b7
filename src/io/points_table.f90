!> Points files: a count, then as many rows of numbers, all of one width.
module mpm_points_table
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: ip, lp, wp
  use mpm_memory, only: size_text, way_to_more
  use mpm_number_parser, only: number_ok, number_too_large, parse_integer, parse_real, parse_special
  use mpm_strings, only: counted, excerpt, to_text
  use mpm_text_file, only: has_byte_order_mark, read_whole_file
  implicit none
  private
  public :: read_points_table

  !> What separates numbers: blank, tab and carriage return.
  character(*), parameter :: blanks = ' '//achar(9)//achar(13)

  !> A points file on its way: what was read of it.
  type :: reader_t
    !> All of the file.
    character(:), allocatable :: text
    !> The file, for messages.
    character(:), allocatable :: path
    !> First character of the current line.
    integer(lp) :: first = 1
    !> Last character of the current line, its end left out.
    integer(lp) :: last = 0
    !> Number of the current line, from 1; 0 before the first one.
    integer :: line = 0
  contains
    !> Go to the next line that is not blank.
    procedure :: next_line
    !> Raise an input error in the current line.
    procedure :: fail
  end type reader_t

contains

  !> Read a points file.
  !!
  !! The first line holds the number of rows. Numbers are separated by blanks and tabs; blank lines
  !! do not count. There are no comments.
  subroutine read_points_table(path, n_columns_allowed, n_rows, n_columns, table, error, &
                               line_of_row, memory_room, bytes_per_row)
    !> The file.
    character(*), intent(in) :: path
    !> Row widths that make sense.
    integer, intent(in) :: n_columns_allowed(:)
    !> Number of rows, at least 1.
    integer(ip), intent(out) :: n_rows
    !> Numbers in each row, one of those allowed.
    integer, intent(out) :: n_columns
    !> The numbers, all finite. (n_columns, n_rows)
    real(wp), allocatable, intent(out) :: table(:, :)
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(out) :: error
    !> Line of each row in the file, from 1, for messages. (n_rows)
    integer, allocatable, intent(out), optional :: line_of_row(:)
    !> Bytes that there are for the text, the table and what is made of it.
    integer(lp), intent(in), optional :: memory_room
    !> Bytes of what is made of a row.
    integer(lp), intent(in), optional :: bytes_per_row
    type(reader_t) :: reader
    integer, allocatable :: lines(:)
    integer(lp) :: n, room, row_bytes

    n_rows = 0
    n_columns = 0
    room = huge(room)
    if (present(memory_room)) room = memory_room
    row_bytes = 0
    if (present(bytes_per_row)) row_bytes = bytes_per_row
    reader%path = trim(path)
    call read_whole_file(path, reader%text, error, room)
    if (.not. allocated(error)) call read_count(reader, n, error)
    if (.not. allocated(error)) call check_count(reader, n, error)
    if (.not. allocated(error)) call choose_width(reader, n_columns_allowed, n_columns, error)
    if (allocated(error)) return
    call check_room(reader, n, n_columns, room - len(reader%text, lp), row_bytes, error)
    if (allocated(error)) return
    call make_room(reader, n, n_columns, table, lines, error)
    if (allocated(error)) return
    n_rows = int(n, ip)
    call read_rows(reader, table, lines, error)
    if (present(line_of_row)) call move_alloc(lines, line_of_row)
  end subroutine read_points_table

  !> Read the first line.
  subroutine read_count(reader, n, error)
    !> The file, before its first line.
    type(reader_t), intent(inout) :: reader
    !> Number of rows.
    integer(lp), intent(out) :: n
    !> `err_input` when it is not one positive integer.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: first, last
    integer :: status, n_words
    logical :: found

    n = 0
    if (has_byte_order_mark(reader%text)) reader%last = 3
    call reader%next_line(found)
    if (.not. found) then
      call raise(error, err_input, 'the points file is empty', file=reader%path, &
                 hint='its first line is the number of points, then comes a line for each point')
      return
    end if
    n_words = count_words(reader%text, reader%first, reader%last)
    call next_word(reader%text, reader%first, reader%last, first, last)
    call parse_integer(reader%text, first, last, n, status)
    if (n_words == 1 .and. status == number_ok .and. n > 0) return
    if (n_words == 1 .and. status == number_too_large .and. reader%text(first:first) /= '-') then
      n = huge(n)
    else
      last = first - 1 + verify(reader%text(first:reader%last), blanks, back=.true., kind=lp)
      call reader%fail('"'//excerpt(reader%text(first:last))//'" is not a number of points', &
                       error, hint='the first line of a points file is one integer above 0')
    end if
  end subroutine read_count

  !> Take the width of the first row for the whole file.
  subroutine choose_width(reader, n_columns_allowed, n_columns, error)
    !> The file, at its first row.
    type(reader_t), intent(in) :: reader
    !> Row widths that make sense.
    integer, intent(in) :: n_columns_allowed(:)
    !> Numbers in each row.
    integer, intent(out) :: n_columns
    !> `err_input` when the width is not allowed.
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: allowed
    integer :: i

    n_columns = count_words(reader%text, reader%first, reader%last)
    if (any(n_columns_allowed == n_columns)) return
    allowed = to_text(n_columns_allowed(1))
    do i = 2, size(n_columns_allowed)
      allowed = allowed//' or '//to_text(n_columns_allowed(i))
    end do
    call reader%fail('this row has '//counted(n_columns, 'number'), error, &
                     hint='a row has '//allowed//' numbers in this type of simulation, '// &
                     'separated by blanks')
  end subroutine choose_width

  !> Refuse a count of rows that the file cannot hold, before memory is asked for.
  subroutine check_count(reader, n, error)
    !> The file, at its first line; stands at the first row afterwards.
    type(reader_t), intent(inout) :: reader
    !> Number of rows in the first line of the file.
    integer(lp), intent(in) :: n
    !> `err_input` with the number of rows present.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: n_present
    logical :: found

    call reader%next_line(found)
    ! a row takes a digit and a line end at least
    if (found .and. n <= (len(reader%text, lp) - reader%first + 2)/2) return
    n_present = 0
    do while (found)
      n_present = n_present + 1
      call reader%next_line(found)
    end do
    call fail_short(reader, n, n_present, error)
  end subroutine check_count

  !> Raise the error of a file with fewer rows than its first line says.
  subroutine fail_short(reader, n, n_present, error)
    !> The file.
    type(reader_t), intent(in) :: reader
    !> Number of rows in its first line.
    integer(lp), intent(in) :: n
    !> Number of rows present.
    integer(lp), intent(in) :: n_present
    !> The error, at the last line.
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: promised

    promised = to_text(n)
    if (n == huge(n)) promised = 'more than '//promised
    call reader%fail('the file ends after '//to_text(n_present)//' of '//promised//' points', &
                     error, hint='its first line says how many there are')
  end subroutine fail_short

  !> Refuse more rows than the memory can hold.
  subroutine check_room(reader, n, n_columns, room, bytes_per_row, error)
    !> The file, for messages.
    type(reader_t), intent(in) :: reader
    !> Number of rows in the first line of the file.
    integer(lp), intent(in) :: n
    !> Numbers in each row.
    integer, intent(in) :: n_columns
    !> Bytes that there are.
    integer(lp), intent(in) :: room
    !> Bytes of what is made of a row, besides the table.
    integer(lp), intent(in) :: bytes_per_row
    !> `err_input`.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: bytes

    bytes = bytes_per_row + n_columns*(storage_size(1.0_wp)/8) + storage_size(n_columns)/8
    if (n <= room/bytes) return
    call raise(error, err_input, counted(n, 'point')//' need '//size_text(n*bytes)//' of memory, &
               &more than there is ('//size_text(max(0_lp, room))//')', file=reader%path, &
               hint='use fewer points, or '//way_to_more())
  end subroutine check_room

  !> Allocate the table.
  subroutine make_room(reader, n, n_columns, table, lines, error)
    !> The file, for messages.
    type(reader_t), intent(in) :: reader
    !> Number of rows.
    integer(lp), intent(in) :: n
    !> Numbers in each row.
    integer, intent(in) :: n_columns
    !> The table. (n_columns, n)
    real(wp), allocatable, intent(out) :: table(:, :)
    !> Line of each row. (n)
    integer, allocatable, intent(out) :: lines(:)
    !> `err_input` when there is no memory.
    type(error_t), allocatable, intent(inout) :: error
    integer :: status

    status = 1
    if (n <= huge(1_ip)) allocate (table(n_columns, n), stat=status)
    if (status == 0) allocate (lines(n), stat=status)
    if (status == 0) return
    call raise(error, err_input, to_text(n)//' points are too many for the memory', &
               file=reader%path)
  end subroutine make_room

  !> Read all rows.
  subroutine read_rows(reader, table, lines, error)
    !> The file, at its first row.
    type(reader_t), intent(inout) :: reader
    !> The numbers. (n_columns, n_rows)
    real(wp), intent(out) :: table(:, :)
    !> Line of each row. (n_rows)
    integer, intent(out) :: lines(:)
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error
    integer(ip) :: row
    logical :: found

    found = .true.
    do row = 1, size(lines, kind=ip)
      if (.not. found) then
        call fail_short(reader, size(lines, kind=lp), row - 1_lp, error)
        return
      end if
      lines(row) = reader%line
      call read_row(reader, table(:, row), error)
      if (allocated(error)) return
      call reader%next_line(found)
    end do
    if (.not. found) return
    call reader%fail('there are more than the '//to_text(size(lines, kind=lp))//' points that '// &
                     'the first line says', error, hint='correct the number in the first line')
  end subroutine read_rows

  !> Read the current line.
  subroutine read_row(reader, row, error)
    !> The file, at the row.
    type(reader_t), intent(in) :: reader
    !> The numbers. (n_columns)
    real(wp), intent(out) :: row(:)
    !> `err_input` when the line does not hold exactly these numbers.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: first, last
    integer :: i, status

    last = reader%first - 1
    do i = 1, size(row)
      call next_word(reader%text, last + 1, reader%last, first, last)
      if (first > last) exit
      call parse_real(reader%text, first, last, row(i), status)
      if (status /= number_ok) then
        call explain_number(reader, i, reader%text(first:last), status, error)
        return
      end if
    end do
    call next_word(reader%text, last + 1, reader%last, first, last)
    if (i > size(row) .and. first > last) return
    i = count_words(reader%text, reader%first, reader%last)
    call reader%fail('this row has '//counted(i, 'number')//', the first row has '// &
                     to_text(size(row)), error, hint='all rows of a points file have one width')
  end subroutine read_row

  !> Say what is wrong with a number.
  subroutine explain_number(reader, column, word, status, error)
    !> The file, at the row.
    type(reader_t), intent(in) :: reader
    !> Column of the word, from 1.
    integer, intent(in) :: column
    !> The word.
    character(*), intent(in) :: word
    !> What the number parser found.
    integer, intent(in) :: status
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    real(wp) :: number
    logical :: is_special

    call parse_special(word, number, is_special)
    if (is_special) then
      call reader%fail('"'//excerpt(word)//'" in column '//to_text(column)// &
                       ' is not a finite number', error)
    else if (status == number_too_large) then
      call reader%fail('"'//excerpt(word)//'" in column '//to_text(column)//' is too large', error)
    else
      call reader%fail('"'//excerpt(word)//'" in column '//to_text(column)// &
                       ' is not a number', error, &
                       hint='numbers are separated by blanks and written as 2, -0.5 or 1.5e-3')
    end if
  end subroutine explain_number

  !> Go to the next line that is not blank.
  subroutine next_line(self, found)
    !> The file; stands at its last line when there is no other one.
    class(reader_t), intent(inout) :: self
    !> Whether there is one.
    logical, intent(out) :: found
    integer(lp) :: i, end_of_text
    logical :: blank
    integer :: skipped

    end_of_text = len(self%text, lp)
    i = self%last + 1
    if (self%line > 0) i = i + 1
    skipped = 0
    do while (i <= end_of_text)
      skipped = skipped + 1
      self%first = i
      blank = .true.
      do while (i <= end_of_text)
        if (self%text(i:i) == achar(10)) exit
        if (blank) blank = is_blank(self%text(i:i))
        i = i + 1
      end do
      self%last = i - 1
      if (.not. blank) then
        self%line = self%line + skipped
        found = .true.
        return
      end if
      i = i + 1
    end do
    self%first = self%last + 1
    found = .false.
  end subroutine next_line

  !> Raise an input error in the current line.
  subroutine fail(self, message, error, hint)
    !> The file.
    class(reader_t), intent(in) :: self
    !> What is wrong.
    character(*), intent(in) :: message
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    !> The way out.
    character(*), intent(in), optional :: hint

    call raise(error, err_input, message, file=self%path, line=self%line, hint=hint)
  end subroutine fail

  !> The next word in a part of a text; `first` is above `last` when there is none.
  pure subroutine next_word(text, start, end, first, last)
    !> The text.
    character(*), intent(in) :: text
    !> Where to start.
    integer(lp), intent(in) :: start
    !> Where to end.
    integer(lp), intent(in) :: end
    !> First character of the word.
    integer(lp), intent(out) :: first
    !> Last character of the word.
    integer(lp), intent(out) :: last

    first = start
    do while (first <= end)
      if (.not. is_blank(text(first:first))) exit
      first = first + 1
    end do
    last = first - 1
    do while (last < end)
      if (is_blank(text(last + 1:last + 1))) exit
      last = last + 1
    end do
  end subroutine next_word

  !> Number of words in a part of a text.
  pure function count_words(text, start, end) result(n)
    !> The text.
    character(*), intent(in) :: text
    !> Where to start.
    integer(lp), intent(in) :: start
    !> Where to end.
    integer(lp), intent(in) :: end
    !> The number.
    integer :: n
    integer(lp) :: first, last

    n = -1
    last = start - 1
    do
      n = n + 1
      call next_word(text, last + 1, end, first, last)
      if (first > last) exit
    end do
  end function count_words

  !> Whether a character is white space.
  pure function is_blank(c)
    !> The character.
    character(1), intent(in) :: c
    !> True for blank, tab and carriage return.
    logical :: is_blank

    ! By their codes: the compiler compares with a blank by a call that trims.
    is_blank = iachar(c) == iachar(' ') .or. iachar(c) == 9 .or. iachar(c) == 13
  end function is_blank

end module mpm_points_table
