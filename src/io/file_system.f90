!> What the operating system does with files beyond reading and writing them.
module mpm_file_system
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_funptr, c_int, &
                                         c_long, c_null_char, c_null_funptr, c_ptr, c_size_t
  use mpm_errors, only: err_io, error_t, raise
  use mpm_files, only: delete_file, directory_of, is_directory, join_path, process_id, &
                       reason_against, rename_file
  use mpm_kinds, only: lp
  use mpm_strings, only: append_text, string_t, to_text
  implicit none
  private
  public :: copy_file, delete_leftovers, exchange_files, file_size, matching_files
  public :: reserve_space, set_environment, sync_file, truncate_file

  !> `glob_t` of Linux, for the C libraries that there are; other systems have other ones.
  type, bind(c) :: glob_result_t
    !> Number of paths.
    integer(c_size_t) :: count = 0
    !> The paths.
    type(c_ptr) :: paths
    !> What the procedures keep for themselves.
    integer(c_size_t) :: rest(16) = 0
  end type glob_result_t

  !> Not as a literal: LLVM's preprocessor doubles it there.
  character(1), parameter :: backslash = achar(92)

  interface
    !> C `fopen`: open a file, or for reading a folder.
    function c_fopen(path, mode) bind(c, name='fopen') result(stream)
      import :: c_char, c_ptr
      implicit none
      !> The path, ended by a null character.
      character(kind=c_char), intent(in) :: path(*)
      !> How, ended by a null character.
      character(kind=c_char), intent(in) :: mode(*)
      !> The stream, null upon failure.
      type(c_ptr) :: stream
    end function c_fopen

    !> C `fclose`.
    function c_fclose(stream) bind(c, name='fclose') result(status)
      import :: c_int, c_ptr
      implicit none
      !> The stream.
      type(c_ptr), intent(in), value :: stream
      !> 0 when done.
      integer(c_int) :: status
    end function c_fclose

    !> POSIX `fileno`: descriptor of a stream.
    function c_fileno(stream) bind(c, name='fileno') result(descriptor)
      import :: c_int, c_ptr
      implicit none
      !> The stream.
      type(c_ptr), intent(in), value :: stream
      !> Its descriptor.
      integer(c_int) :: descriptor
    end function c_fileno

    !> POSIX `fsync`: wait until all data are on the disk.
    function c_fsync(descriptor) bind(c, name='fsync') result(status)
      import :: c_int
      implicit none
      !> Descriptor of a file or folder.
      integer(c_int), intent(in), value :: descriptor
      !> 0 when done.
      integer(c_int) :: status
    end function c_fsync

    !> POSIX `truncate`: cut a file.
    function c_truncate(path, length) bind(c, name='truncate') result(status)
      import :: c_char, c_int, c_long
      implicit none
      !> The path, ended by a null character.
      character(kind=c_char), intent(in) :: path(*)
      !> Bytes to keep.
      integer(c_long), intent(in), value :: length
      !> 0 when done.
      integer(c_int) :: status
    end function c_truncate

    !> POSIX `link`: give a file a second name.
    function c_link(path, name) bind(c, name='link') result(status)
      import :: c_char, c_int
      implicit none
      !> The path, ended by a null character.
      character(kind=c_char), intent(in) :: path(*)
      !> The second name, ended by a null character.
      character(kind=c_char), intent(in) :: name(*)
      !> 0 when done.
      integer(c_int) :: status
    end function c_link

    !> POSIX `posix_fallocate`: see that a part of a file has room on the disk.
    function c_fallocate(descriptor, first, length) bind(c, name='posix_fallocate') result(status)
      import :: c_int, c_long
      implicit none
      !> Descriptor of the file.
      integer(c_int), intent(in), value :: descriptor
      !> Bytes in front of the part.
      integer(c_long), intent(in), value :: first
      !> Bytes of the part.
      integer(c_long), intent(in), value :: length
      !> 0 when done.
      integer(c_int) :: status
    end function c_fallocate

    !> POSIX `glob`: paths that match a pattern.
    function c_glob(pattern, flags, on_error, found) bind(c, name='glob') result(status)
      import :: c_char, c_funptr, c_int, glob_result_t
      implicit none
      !> The pattern, ended by a null character.
      character(kind=c_char), intent(in) :: pattern(*)
      !> 0: sorted, special characters quoted by `\`.
      integer(c_int), intent(in), value :: flags
      !> Null.
      type(c_funptr), intent(in), value :: on_error
      !> What was found.
      type(glob_result_t), intent(out) :: found
      !> 0 when anything was found.
      integer(c_int) :: status
    end function c_glob

    !> POSIX `globfree`: give back the memory of a result.
    subroutine c_globfree(found) bind(c, name='globfree')
      import :: glob_result_t
      implicit none
      !> The result.
      type(glob_result_t), intent(inout) :: found
    end subroutine c_globfree

    !> C `strlen`.
    pure function c_strlen(text) bind(c, name='strlen') result(length)
      import :: c_ptr, c_size_t
      implicit none
      !> Address of a text ended by a null character.
      type(c_ptr), intent(in), value :: text
      !> Bytes in front of it.
      integer(c_size_t) :: length
    end function c_strlen

    !> POSIX `setenv`.
    function c_setenv(name, value, overwrite) bind(c, name='setenv') result(status)
      import :: c_char, c_int
      implicit none
      !> The name, ended by a null character.
      character(kind=c_char), intent(in) :: name(*)
      !> The value, ended by a null character.
      character(kind=c_char), intent(in) :: value(*)
      !> 0 to leave a value that is there.
      integer(c_int), intent(in), value :: overwrite
      !> 0 when done.
      integer(c_int) :: status
    end function c_setenv
  end interface

contains

  !> Give a variable of the environment a value unless it has one.
  subroutine set_environment(name, value)
    !> Its name.
    character(*), intent(in) :: name
    !> The value.
    character(*), intent(in) :: value
    integer(c_int) :: ignored

    ignored = c_setenv(name//c_null_char, value//c_null_char, 0_c_int)
  end subroutine set_environment

  !> Wait until a file and its entry in its folder are on the disk.
  subroutine sync_file(path, error)
    !> The file.
    character(*), intent(in) :: path
    !> `err_io` when the data did not arrive.
    type(error_t), allocatable, intent(out) :: error
    integer :: status

    call sync(path, 'r+b', status)
    if (status /= 0) then
      call raise(error, err_io, 'writing failed: the data did not reach the disk', file=path)
      return
    end if
    ! Not every file system can do this with folders; the file itself is safe.
    call sync(directory_of(path), 'rb', status)
  end subroutine sync_file

  !> Wait until the data of a file or folder are on the disk.
  subroutine sync(path, mode, status)
    !> Its path.
    character(*), intent(in) :: path
    !> How to open it.
    character(*), intent(in) :: mode
    !> 0 when done.
    integer, intent(out) :: status
    type(c_ptr) :: stream
    integer(c_int) :: closed

    status = 1
    stream = c_fopen(trim(path)//c_null_char, mode//c_null_char)
    if (.not. c_associated(stream)) return
    status = int(c_fsync(c_fileno(stream)))
    closed = c_fclose(stream)
    if (status == 0) status = int(closed)
  end subroutine sync

  !> Bytes of a file.
  function file_size(path) result(n_bytes)
    !> The file.
    character(*), intent(in) :: path
    !> 0 when there is none.
    integer(lp) :: n_bytes
    logical :: there

    n_bytes = 0
    inquire (file=path, exist=there)
    if (there) inquire (file=path, size=n_bytes)
    n_bytes = max(0_lp, n_bytes)
  end function file_size

  !> See that a file can grow; its content stays, with zeros behind it.
  subroutine reserve_space(path, n_bytes, error)
    !> The file.
    character(*), intent(in) :: path
    !> Bytes behind its end.
    integer(lp), intent(in) :: n_bytes
    !> `err_io` when there is no room; the file is as it was.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    type(c_ptr) :: stream
    integer(lp) :: length
    integer(c_int) :: status, closed

    length = file_size(path)
    stream = c_fopen(trim(path)//c_null_char, 'r+b'//c_null_char)
    if (.not. c_associated(stream)) then
      call raise(error, err_io, 'writing failed: '//reason_against(path, .true.), file=path)
      return
    end if
    status = c_fallocate(c_fileno(stream), int(length, c_long), int(n_bytes, c_long))
    closed = c_fclose(stream)
    if (status == 0) return
    call truncate_file(path, length, ignored)
    call raise(error, err_io, 'writing failed: no room for '//to_text(n_bytes)//' bytes more', &
               file=path)
  end subroutine reserve_space

  !> Copy a file over any of the other name.
  subroutine copy_file(path, copy, error)
    !> The file.
    character(*), intent(in) :: path
    !> The copy.
    character(*), intent(in) :: copy
    !> `err_io` when it can't be read or written.
    type(error_t), allocatable, intent(out) :: error
    integer, parameter :: most = 1048576
    character(:), allocatable :: bytes
    integer(lp) :: rest
    integer :: from, to, status, closed, n
    logical :: is_open

    rest = file_size(path)
    open (newunit=from, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status == 0) then
      open (newunit=to, file=copy, access='stream', form='unformatted', status='replace', &
            action='write', iostat=status)
      is_open = status == 0
      allocate (character(most) :: bytes)
      do while (rest > 0 .and. is_open)
        n = int(min(rest, int(most, lp)))
        read (from, iostat=status) bytes(:n)
        if (status /= 0) exit
        write (to, iostat=status) bytes(:n)
        if (status /= 0) exit
        rest = rest - n
      end do
      closed = 0
      if (is_open) close (to, iostat=closed)
      if (closed /= 0) status = closed
      close (from)
    end if
    ! What the run-time library still held may have been lost without a word.
    rest = file_size(path) - file_size(copy)
    if (status == 0 .and. rest == 0) return
    call raise(error, err_io, 'writing failed: '//reason_against(copy, .true.), file=copy)
  end subroutine copy_file

  !> Exchange the names of two files; at each instant there is a whole one of the first name.
  subroutine exchange_files(path, other, error)
    !> The name that always leads to a file.
    character(*), intent(in) :: path
    !> The other name, in the same folder.
    character(*), intent(in) :: other
    !> `err_io` when a name can't be changed.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: third

    third = other//'.tmp'//to_text(process_id())
    call delete_file(third, error)
    if (allocated(error)) return
    if (c_link(trim(path)//c_null_char, third//c_null_char) == 0) then
      call rename_file(other, path, error)
      if (.not. allocated(error)) call rename_file(third, other, error)
    else
      ! A file system without second names.
      call copy_file(path, third, error)
      if (.not. allocated(error)) call rename_file(other, path, error)
      if (.not. allocated(error)) call rename_file(third, other, error)
    end if
  end subroutine exchange_files

  !> Cut a file; one that is no longer than that stays.
  subroutine truncate_file(path, n_bytes, error)
    !> The file.
    character(*), intent(in) :: path
    !> Bytes to keep.
    integer(lp), intent(in) :: n_bytes
    !> `err_io` with the file.
    type(error_t), allocatable, intent(out) :: error

    if (file_size(path) <= n_bytes) return
    if (c_truncate(trim(path)//c_null_char, int(n_bytes, c_long)) == 0) return
    call raise(error, err_io, 'the file cannot be shortened', file=path)
  end subroutine truncate_file

  !> Files of a folder whose names have a start and an end, in the order of their names.
  !!
  !! None on systems other than Linux.
  subroutine matching_files(folder, start, end, paths)
    !> The folder.
    character(*), intent(in) :: folder
    !> Start of the names.
    character(*), intent(in) :: start
    !> End of the names.
    character(*), intent(in) :: end
    !> Paths with the folder in front.
    type(string_t), allocatable, intent(out) :: paths(:)
    type(glob_result_t) :: found
    type(c_ptr), pointer :: addresses(:)
    character(kind=c_char), pointer :: letters(:)
    character(:), allocatable :: path
    integer :: i, k

    allocate (paths(0))
    if (.not. is_directory('/proc/self')) return
    if (c_glob(join_path(quoted(folder), quoted(start)//'*'//quoted(end))//c_null_char, 0_c_int, &
               c_null_funptr, found) /= 0) return
    call c_f_pointer(found%paths, addresses, [found%count])
    do i = 1, size(addresses)
      call c_f_pointer(addresses(i), letters, [c_strlen(addresses(i))])
      allocate (character(size(letters)) :: path)
      do k = 1, size(letters)
        path(k:k) = letters(k)
      end do
      call append_text(paths, path)
      deallocate (path)
    end do
    call c_globfree(found)
  end subroutine matching_files

  !> A text as part of a pattern that matches just itself.
  pure function quoted(text) result(pattern)
    !> The text.
    character(*), intent(in) :: text
    !> The same with a `\` in front of special characters.
    character(:), allocatable :: pattern
    integer :: i

    pattern = ''
    do i = 1, len_trim(text)
      if (scan(text(i:i), '*?['//backslash) > 0) pattern = pattern//backslash
      pattern = pattern//text(i:i)
    end do
  end function quoted

  !> Delete the unfinished files that runs which are no longer there left in a folder.
  subroutine delete_leftovers(folder, start)
    !> The folder.
    character(*), intent(in) :: folder
    !> Start of the names of files that may be unfinished.
    character(*), intent(in) :: start
    type(string_t), allocatable :: paths(:)
    type(error_t), allocatable :: ignored
    character(:), allocatable :: number
    integer :: i, k

    call matching_files(folder, start, '', paths)
    do i = 1, size(paths)
      associate (path => paths(i)%text)
        k = index(path, '.tmp', back=.true.)
        if (k == 0) cycle
        number = path(k + 4:)
        if (len(number) == 0 .or. verify(number, '0123456789') > 0) cycle
        if (is_directory('/proc/'//number)) cycle
        call delete_file(path, ignored)
      end associate
    end do
  end subroutine delete_leftovers

end module mpm_file_system
