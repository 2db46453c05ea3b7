!> Input text: where a file is looked for, reading it at once, quoting it in messages.
module mpm_text_file
  use mpm_errors, only: err_input, error_t, raise
  use mpm_files, only: directory_of, file_exists, is_directory, is_readable, join_path
  use mpm_kinds, only: lp
  use mpm_strings, only: excerpt, to_text
  implicit none
  private
  public :: find_input_file, has_byte_order_mark, read_whole_file

  !> Most bytes read from something without a known size, such as a pipe. [byte]
  integer, parameter :: max_pipe_size = 64*1024*1024

contains

  !> Read a file into one text; an empty file gives an empty text.
  subroutine read_whole_file(path, text, error, most)
    !> The file; a pipe is read to its end.
    character(*), intent(in) :: path
    !> All bytes of the file.
    character(:), allocatable, intent(out) :: text
    !> `err_input`: missing, a folder, unreadable or too large for the memory.
    type(error_t), allocatable, intent(out) :: error
    !> Most bytes that the text may have.
    integer(lp), intent(in), optional :: most
    integer :: unit, status
    integer(lp) :: size_in_bytes
    character(256) :: reason

    call check_readable(path, error)
    if (allocated(error)) return
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status, iomsg=reason)
    if (status /= 0) then
      call raise(error, err_input, 'the file cannot be opened: '//trim(reason), file=path)
      return
    end if
    inquire (file=path, size=size_in_bytes)
    if (is_above(size_in_bytes, most)) then
      call raise(error, err_input, 'the file has '//to_text(size_in_bytes)//' bytes, more than the &
                 &memory that there is ('//to_text(most)//')', file=path)
    else if (size_in_bytes > 0) then
      call read_sized(unit, path, size_in_bytes, text, error)
    else
      call read_unsized(unit, path, text, error)
    end if
    close (unit)
  end subroutine read_whole_file

  !> Whether a size is above a limit, if there is one.
  pure function is_above(size_in_bytes, most)
    !> The size.
    integer(lp), intent(in) :: size_in_bytes
    !> The limit.
    integer(lp), intent(in), optional :: most
    !> True when it is.
    logical :: is_above

    is_above = .false.
    if (present(most)) is_above = size_in_bytes > most
  end function is_above

  !> Say why a file cannot be read, as far as this is known before opening it.
  subroutine check_readable(path, error)
    !> The file.
    character(*), intent(in) :: path
    !> `err_input` when it is missing, a folder or without permission.
    type(error_t), allocatable, intent(out) :: error

    if (len_trim(path) == 0) then
      call raise(error, err_input, 'the name of the file to read is empty')
    else if (is_directory(path)) then
      call raise(error, err_input, 'this is a folder, not a file', file=path)
    else if (.not. file_exists(path)) then
      call raise(error, err_input, 'there is no such file', file=path)
    else if (.not. is_readable(path)) then
      call raise(error, err_input, 'no permission to read the file', file=path)
    end if
  end subroutine check_readable

  !> Read a file of known size with one read.
  subroutine read_sized(unit, path, size_in_bytes, text, error)
    !> The open unit.
    integer, intent(in) :: unit
    !> The file, for messages.
    character(*), intent(in) :: path
    !> Number of bytes, at least one.
    integer(lp), intent(in) :: size_in_bytes
    !> All bytes of the file.
    character(:), allocatable, intent(out) :: text
    !> `err_input` when there is no memory or reading fails.
    type(error_t), allocatable, intent(out) :: error
    integer :: status
    character(256) :: reason

    allocate (character(size_in_bytes) :: text, stat=status)
    if (status /= 0) then
      call raise(error, err_input, 'the file is too large for the memory', file=path)
      return
    end if
    read (unit, iostat=status, iomsg=reason) text
    if (status /= 0) then
      call raise(error, err_input, 'reading the file failed: '//trim(reason), file=path)
    end if
  end subroutine read_sized

  !> Read a pipe, or an empty file, byte by byte up to its end.
  subroutine read_unsized(unit, path, text, error)
    !> The open unit.
    integer, intent(in) :: unit
    !> The file, for messages.
    character(*), intent(in) :: path
    !> All bytes up to the end.
    character(:), allocatable, intent(out) :: text
    !> `err_input` when there is no end within 64 MiB.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: longer
    character(1) :: byte
    integer :: status, n

    allocate (character(4096) :: text)
    n = 0
    do
      read (unit, iostat=status) byte
      if (status /= 0) exit
      if (n == max_pipe_size) then
        call raise(error, err_input, 'more than 64 MiB from something that is not a plain file', &
                   file=path)
        return
      end if
      if (n == len(text)) then
        allocate (character(2*n) :: longer)
        longer(:n) = text
        call move_alloc(longer, text)
      end if
      n = n + 1
      text(n:n) = byte
    end do
    text = text(:n)
  end subroutine read_unsized

  !> Find an input file: a relative path holds from the working directory or, if there is no such
  !! file, from the folder of the config.
  subroutine find_input_file(path, config_path, found, error)
    !> The path as it was written in the config.
    character(*), intent(in) :: path
    !> The config that names it; empty when there is none.
    character(*), intent(in) :: config_path
    !> The path to open.
    character(:), allocatable, intent(out) :: found
    !> `err_input` that names every place looked at.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: beside_config

    found = trim(path)
    if (len(found) == 0) then
      call raise(error, err_input, 'the name of the input file is empty')
      return
    end if
    if (is_plain(found)) return
    beside_config = join_path(directory_of(config_path), found)
    if (is_plain(beside_config)) then
      found = beside_config
    else if (is_directory(found)) then
      call raise(error, err_input, '"'//excerpt(found)//'" is a folder, not a file')
    else if (is_directory(beside_config)) then
      call raise(error, err_input, '"'//excerpt(beside_config)//'" is a folder, not a file')
    else if (beside_config == found) then
      call raise(error, err_input, 'there is no file "'//excerpt(found, 200)//'"')
    else
      call raise(error, err_input, 'there is no file "'//excerpt(found, 200)//'"', &
                 hint='neither in the working directory nor at "'// &
                 excerpt(beside_config, 200)//'"')
    end if
  end subroutine find_input_file

  !> Whether something that is not a folder has this path.
  function is_plain(path)
    !> The path.
    character(*), intent(in) :: path
    !> True for a file, a pipe or a device.
    logical :: is_plain

    is_plain = .not. is_directory(path)
    if (is_plain) is_plain = file_exists(path)
  end function is_plain

  !> Whether a text starts with the mark that some editors put in front of UTF-8.
  pure function has_byte_order_mark(text)
    !> The text.
    character(*), intent(in) :: text
    !> True when the first three bytes are that mark.
    logical :: has_byte_order_mark

    has_byte_order_mark = index(text(:min(3, len(text))), char(239)//char(187)//char(191)) == 1
  end function has_byte_order_mark

end module mpm_text_file
