!> Files and folders: paths, tests, making, renaming and deleting.
module mpm_files
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use mpm_errors, only: err_io, error_t, raise
  use mpm_strings, only: to_text
  implicit none
  private
  public :: delete_file, directory_of, file_exists, is_directory, is_readable, is_terminal, &
            is_writable, join_path, make_directories, process_id, reason_against, rename_file

  !> Most bytes in one part of a path, on every common file system.
  integer, parameter :: max_name_length = 255
  !> Modes of `c_access`, from unistd.h.
  integer(c_int), parameter :: mode_exists = 0, mode_write = 2, mode_read = 4

  interface
    !> POSIX `access`: 0 when the path may be used in this way.
    function c_access(path, mode) bind(c, name='access') result(status)
      import :: c_char, c_int
      implicit none
      !> The path, ended by a null character.
      character(kind=c_char), intent(in) :: path(*)
      !> What to ask, one of the modes.
      integer(c_int), intent(in), value :: mode
      !> 0 when allowed.
      integer(c_int) :: status
    end function c_access

    !> POSIX `mkdir`: make one folder.
    function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
      import :: c_char, c_int
      implicit none
      !> The path, ended by a null character.
      character(kind=c_char), intent(in) :: path(*)
      !> Permissions, before the user's mask.
      integer(c_int), intent(in), value :: mode
      !> 0 when done.
      integer(c_int) :: status
    end function c_mkdir

    !> C `rename`: give a file a new name, in place of any file of that name.
    function c_rename(from, to) bind(c, name='rename') result(status)
      import :: c_char, c_int
      implicit none
      !> The old path, ended by a null character.
      character(kind=c_char), intent(in) :: from(*)
      !> The new path, ended by a null character.
      character(kind=c_char), intent(in) :: to(*)
      !> 0 when done.
      integer(c_int) :: status
    end function c_rename

    !> POSIX `unlink`: delete a file.
    function c_unlink(path) bind(c, name='unlink') result(status)
      import :: c_char, c_int
      implicit none
      !> The path, ended by a null character.
      character(kind=c_char), intent(in) :: path(*)
      !> 0 when done.
      integer(c_int) :: status
    end function c_unlink

    !> POSIX `isatty`: whether a file descriptor is a terminal.
    function c_isatty(descriptor) bind(c, name='isatty') result(answer)
      import :: c_int
      implicit none
      !> The file descriptor.
      integer(c_int), intent(in), value :: descriptor
      !> 1 for a terminal.
      integer(c_int) :: answer
    end function c_isatty

    !> POSIX `getpid`: number of this process.
    function c_getpid() bind(c, name='getpid') result(number)
      import :: c_int
      implicit none
      !> The number.
      integer(c_int) :: number
    end function c_getpid
  end interface

contains

  !> Whether a file or folder has this path.
  function file_exists(path) result(exists)
    !> The path.
    character(*), intent(in) :: path
    !> False also when a folder on the way may not be entered.
    logical :: exists

    exists = len_trim(path) > 0
    if (exists) exists = c_access(c_path(path), mode_exists) == 0
  end function file_exists

  !> Whether the path is a folder that may be entered.
  function is_directory(path) result(is_folder)
    !> The path.
    character(*), intent(in) :: path
    !> False also for a folder without permission to enter.
    logical :: is_folder

    is_folder = len_trim(path) > 0
    if (is_folder) is_folder = c_access(c_path(trim(path)//'/.'), mode_exists) == 0
  end function is_directory

  !> Whether the file exists and may be read.
  function is_readable(path) result(readable)
    !> The path.
    character(*), intent(in) :: path
    !> True when it may.
    logical :: readable

    readable = len_trim(path) > 0
    if (readable) readable = c_access(c_path(path), mode_read) == 0
  end function is_readable

  !> Whether the file or folder exists and may be written to.
  function is_writable(path) result(writable)
    !> The path.
    character(*), intent(in) :: path
    !> True when it may.
    logical :: writable

    writable = len_trim(path) > 0
    if (writable) writable = c_access(c_path(path), mode_write) == 0
  end function is_writable

  !> Whether a file descriptor is a terminal.
  function is_terminal(descriptor) result(terminal)
    !> 1 for standard output, 2 for standard error.
    integer, intent(in) :: descriptor
    !> False when the output goes to a file or a pipe.
    logical :: terminal

    terminal = c_isatty(int(descriptor, c_int)) == 1
  end function is_terminal

  !> Number of this process.
  function process_id() result(number)
    !> Unique among the running processes of this machine.
    integer :: number

    number = int(c_getpid())
  end function process_id

  !> Folder part of a path: `a/b` of `a/b/c`, `.` of `c`, `/` of `/c`.
  pure function directory_of(path) result(directory)
    !> The path.
    character(*), intent(in) :: path
    !> The folder, without a slash at its end.
    character(:), allocatable :: directory
    integer :: slash, last

    last = verify(trim(path), '/', back=.true.)
    slash = index(path(:last), '/', back=.true.)
    if (last == 0 .and. len_trim(path) > 0) then
      directory = '/'
    else if (slash == 0) then
      directory = '.'
    else
      directory = path(:max(1, verify(path(:slash), '/', back=.true.)))
    end if
  end function directory_of

  !> A path within a folder; an absolute path stays as it is.
  pure function join_path(directory, path) result(joined)
    !> The folder; empty or `.` for the working directory.
    character(*), intent(in) :: directory
    !> The path, relative to the folder or absolute.
    character(*), intent(in) :: path
    !> Both as one path.
    character(:), allocatable :: joined

    joined = trim(path)
    if (index(joined, '/') == 1) return
    if (len_trim(directory) == 0 .or. directory == '.') return
    if (directory(len_trim(directory):len_trim(directory)) == '/') then
      joined = trim(directory)//joined
    else
      joined = trim(directory)//'/'//joined
    end if
  end function join_path

  !> Make a folder and all folders above it that are missing.
  subroutine make_directories(path, error)
    !> The folder.
    character(*), intent(in) :: path
    !> `err_io` with the folder that could not be made and why.
    type(error_t), allocatable, intent(out) :: error
    integer :: last
    character(:), allocatable :: folder

    if (len_trim(path) == 0) then
      call raise(error, err_io, 'the name of the folder to make is empty')
      return
    end if
    last = 0
    do while (last < len_trim(path))
      last = next_slash(path, last)
      folder = path(:last)
      if (is_directory(folder)) cycle
      if (c_mkdir(c_path(folder), int(o'777', c_int)) == 0) cycle
      ! another process may have made it in the meantime
      if (is_directory(folder)) cycle
      call raise(error, err_io, 'the folder cannot be made: '// &
                 reason_against(folder, replaces_file=.false.), file=folder)
      return
    end do
  end subroutine make_directories

  !> Position in front of the first slash behind a position, or the end of the path.
  pure function next_slash(path, start) result(last)
    !> The path.
    character(*), intent(in) :: path
    !> Last position of the part before, 0 for the first part.
    integer, intent(in) :: start
    !> Last position of the next part.
    integer :: last

    last = start + 1
    do while (last < len_trim(path))
      if (path(last + 1:last + 1) == '/' .and. path(last:last) /= '/') exit
      last = last + 1
    end do
  end function next_slash

  !> Give a file a new name; a file that has this name already is replaced.
  subroutine rename_file(from, to, error)
    !> The old path.
    character(*), intent(in) :: from
    !> The new path, in the same file system.
    character(*), intent(in) :: to
    !> `err_io` with the reason; the old file stays.
    type(error_t), allocatable, intent(out) :: error

    if (c_rename(c_path(from), c_path(to)) == 0) return
    if (.not. file_exists(from)) then
      call raise(error, err_io, 'the file vanished before it got its name "'//trim(to)//'"', &
                 file=trim(from))
    else
      call raise(error, err_io, 'the file cannot be written: '// &
                 reason_against(to, replaces_file=.true.), file=trim(to))
    end if
  end subroutine rename_file

  !> Delete a file; nothing happens when there is none.
  subroutine delete_file(path, error)
    !> The path.
    character(*), intent(in) :: path
    !> `err_io` with the reason.
    type(error_t), allocatable, intent(out) :: error

    if (.not. file_exists(path)) return
    if (c_unlink(c_path(path)) == 0) return
    if (is_directory(path)) then
      call raise(error, err_io, 'the file cannot be deleted: it is a folder', file=trim(path))
    else
      call raise(error, err_io, 'the file cannot be deleted: no permission', file=trim(path))
    end if
  end subroutine delete_file

  !> The likely reason why a file or folder cannot be made.
  function reason_against(path, replaces_file) result(reason)
    !> The path.
    character(*), intent(in) :: path
    !> Whether a file of that name would be replaced.
    logical, intent(in) :: replaces_file
    !> The reason, as the second half of a sentence.
    character(:), allocatable :: reason
    character(:), allocatable :: above
    integer :: slash

    above = directory_of(path)
    slash = index(path, '/', back=.true.)
    if (is_directory(path)) then
      reason = 'a folder of that name is in the way'
    else if (file_exists(path) .and. .not. replaces_file) then
      reason = 'a file of that name is in the way'
    else if (len_trim(path) - slash > max_name_length) then
      reason = 'the name has more than '//to_text(max_name_length)//' characters'
    else if (.not. file_exists(above)) then
      reason = 'there is no folder "'//above//'"'
    else if (.not. is_directory(above)) then
      reason = '"'//above//'" is not a folder'
    else if (.not. is_writable(above)) then
      reason = 'no permission to write in "'//above//'"'
    else
      reason = 'the file system refused, it may be full'
    end if
  end function reason_against

  !> A path as C takes it.
  pure function c_path(path) result(text)
    !> The path.
    character(*), intent(in) :: path
    !> The path without trailing blanks, ended by a null character.
    character(kind=c_char, len=:), allocatable :: text

    text = trim(path)//c_null_char
  end function c_path

end module mpm_files
