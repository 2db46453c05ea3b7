!> Files with a header that tells whether they are whole.
!!
!! The first `header_size` bytes are text: what the file is, its size, and a digest of all that
!! follows. A reader that goes by them meets no damaged data.
module mpm_sealed_file
  use, intrinsic :: iso_fortran_env, only: int32
  use mpm_digest, only: digest_t
  use mpm_errors, only: err_input, err_io, error_t, raise
  use mpm_file_system, only: file_size
  use mpm_files, only: file_exists, is_directory
  use mpm_kinds, only: lp
  use mpm_strings, only: to_text
  implicit none
  private
  public :: check_seal, header_size, seal_file

  !> Bytes of the header.
  integer, parameter :: header_size = 512
  !> Words of 32 bits that are read at once.
  integer, parameter :: part_size = 262144
  !> Start of every header; the number of the format follows.
  character(*), parameter :: start = 'mpm3d checkpoint format '
  !> End of a line.
  character(*), parameter :: nl = new_line('a')

contains

  !> Write the header of a file that is otherwise complete.
  subroutine seal_file(path, format, error)
    !> The file; its first `header_size` bytes are free.
    character(*), intent(in) :: path
    !> Number of the format.
    integer, intent(in) :: format
    !> `err_io` when it can't be written.
    type(error_t), allocatable, intent(out) :: error
    character(header_size) :: header
    character(16) :: digest
    character(200) :: reason
    integer :: unit, status, closed

    call digest_of(path, digest, error)
    if (allocated(error)) then
      error%code = err_io
      return
    end if
    header = start//to_text(format)//nl//'bytes '//to_text(file_size(path))//nl//'digest '// &
             digest//nl
    header(header_size:) = nl
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='readwrite', iostat=status, iomsg=reason)
    if (status == 0) then
      write (unit, pos=1, iostat=status, iomsg=reason) header
      close (unit, iostat=closed)
      if (status == 0 .and. closed /= 0) then
        status = closed
        reason = 'the disk may be full'
      end if
    end if
    if (status /= 0) call raise(error, err_io, 'writing failed: '//trim(reason), file=path)
  end subroutine seal_file

  !> Whether a file is whole, and of a format that is known.
  subroutine check_seal(path, newest, error)
    !> The file.
    character(*), intent(in) :: path
    !> Number of the newest format that is known.
    integer, intent(in) :: newest
    !> `err_input` that says what is wrong with it.
    type(error_t), allocatable, intent(out) :: error
    character(header_size) :: header
    character(16) :: digest, expected
    integer(lp) :: n_bytes
    integer :: unit, status, format

    if (.not. file_exists(path)) then
      call raise(error, err_input, 'there is no such checkpoint', file=path)
      return
    else if (is_directory(path)) then
      call raise(error, err_input, 'a folder is no checkpoint', file=path, &
                 hint='name one of the files in it')
      return
    end if
    header = ''
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status /= 0) then
      call raise(error, err_input, 'no permission to read the checkpoint', file=path)
      return
    end if
    read (unit, iostat=status) header
    if (status /= 0) header = ''
    close (unit)
    format = 0
    n_bytes = -1
    if (index(header, start) == 1) then
      read (header(len(start) + 1:), *, iostat=status) format
      if (status == 0 .and. format > newest) then
        call raise(error, err_input, 'the checkpoint is of format '//to_text(format)// &
                   ', this program reads '//to_text(newest), file=path, &
                   hint='a newer mpm3d has written it, which can go on from it')
        return
      end if
      call read_header(header, n_bytes, expected)
    end if
    if (format < 1 .or. n_bytes < 0) then
      call raise(error, err_input, 'this is no checkpoint of mpm3d', file=path)
      return
    end if
    if (n_bytes /= file_size(path)) then
      call raise(error, err_input, 'the checkpoint is damaged: it has '// &
                 to_text(file_size(path))//' bytes in place of '//to_text(n_bytes), file=path, &
                 hint=way_out())
      return
    end if
    call digest_of(path, digest, error)
    if (allocated(error)) return
    if (digest /= expected) then
      call raise(error, err_input, 'the checkpoint is damaged: its digest is '//digest// &
                 ' in place of '//expected, file=path, hint=way_out())
    end if
  end subroutine check_seal

  !> What to do about a damaged file.
  pure function way_out() result(hint)
    !> One line.
    character(:), allocatable :: hint

    hint = 'the one before it may be whole: two are kept'
  end function way_out

  !> Size and digest as a header has them.
  pure subroutine read_header(header, n_bytes, digest)
    !> The header.
    character(*), intent(in) :: header
    !> Size of the file; negative when it is not there.
    integer(lp), intent(out) :: n_bytes
    !> The digest.
    character(16), intent(out) :: digest
    integer :: i, status

    n_bytes = -1
    digest = ''
    i = index(header, nl//'digest ')
    if (i > 0 .and. i + 23 <= len(header)) digest = header(i + 8:i + 23)
    i = index(header, nl//'bytes ')
    if (i == 0 .or. digest == '') return
    read (header(i + 7:), *, iostat=status) n_bytes
    if (status /= 0) n_bytes = -1
  end subroutine read_header

  !> Digest of all that follows the header.
  subroutine digest_of(path, digest, error)
    !> The file.
    character(*), intent(in) :: path
    !> The digest.
    character(16), intent(out) :: digest
    !> `err_input` when it can't be read.
    type(error_t), allocatable, intent(out) :: error
    type(digest_t) :: sums
    integer(int32), allocatable :: words(:)
    integer(int32) :: last
    character(4) :: bytes
    integer(lp) :: rest
    integer :: unit, status, n

    digest = ''
    rest = file_size(path) - header_size
    allocate (words(part_size))
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status == 0) then
      if (rest > 0) read (unit, pos=header_size, iostat=status) bytes(:1)
      do while (rest >= 4 .and. status == 0)
        n = int(min(int(part_size, lp), rest/4))
        read (unit, iostat=status) words(:n)
        call sums%add_words(words(:n))
        rest = rest - 4*n
      end do
      if (rest > 0 .and. status == 0) then
        bytes = repeat(achar(0), 4)
        read (unit, iostat=status) bytes(:rest)
        last = transfer(bytes, last)
        call sums%add_words([last])
      end if
      close (unit)
    end if
    digest = sums%text()
    if (status /= 0) call raise(error, err_input, 'the file cannot be read', file=path)
  end subroutine digest_of

end module mpm_sealed_file
