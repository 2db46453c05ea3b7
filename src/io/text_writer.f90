!> Text files that are whole or absent: buffered, written under another name, renamed at the end.
!!
!! Numbers can also be put as bytes, the highest first.
module mpm_text_writer
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use mpm_errors, only: err_io, error_t, raise
  use mpm_files, only: delete_file, process_id, reason_against, rename_file
  use mpm_kinds, only: lp, wp
  use mpm_number_lines, only: append_integer_lines, append_real_lines, low_byte_first, &
                              max_entry_length
  use mpm_number_text, only: append_integer, append_real, default_digits, max_number_length
  use mpm_strings, only: to_text
  implicit none
  private
  public :: text_writer_t

  !> Bytes gathered for one write to the file.
  integer, parameter :: buffer_size = 1024*1024
  !> Numbers that are put as text at a time, about.
  integer, parameter :: numbers_at_once = 192
  !> Numbers that are put as bytes at a time.
  integer, parameter :: byte_block = 512

  !> A text file on its way.
  !!
  !! `open`, any number of `put_*`, then `commit` or `discard`. The first failure is kept and
  !! reported by `commit`; what is put after it is dropped.
  type :: text_writer_t
    private
    !> The name that the file gets at the end.
    character(:), allocatable :: path
    !> The name that it has until then, in the same folder.
    character(:), allocatable :: temporary
    !> Text that is not yet in the file.
    character(:), allocatable :: buffer
    !> Characters in use in the buffer.
    integer :: length = 0
    !> Bytes in the file.
    integer(lp) :: n_written = 0
    !> Significant digits of reals.
    integer :: digits = default_digits
    !> Unit of the open file.
    integer :: unit = 0
    !> Whether the file is open.
    logical :: is_open = .false.
    !> The first failure.
    type(error_t), allocatable :: failure
  contains
    !> Start a file.
    procedure :: open => writer_open
    !> Write text.
    procedure :: put_text
    !> Write text and end the line.
    procedure :: put_line
    !> Write a real.
    procedure :: put_real
    !> Write many reals, some on each line.
    procedure :: put_reals
    !> Write reals as 8 bytes each.
    procedure :: put_real_bytes
    !> Write many integers, some on each line.
    procedure :: put_integers
    !> Write integers as 4 bytes each.
    procedure :: put_integer_bytes
    !> Write a default or long integer.
    generic :: put_integer => put_default_integer, put_long_integer
    !> Finish the file and give it its name.
    procedure :: commit
    !> Give up the file.
    procedure :: discard
    procedure, private :: put_default_integer
    procedure, private :: put_long_integer
    procedure, private :: make_room
    procedure, private :: close_file
  end type text_writer_t

contains

  !> Start a file; one that was not finished is given up.
  subroutine writer_open(self, path, error, digits)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The name that the file gets at the end; its folder exists.
    character(*), intent(in) :: path
    !> `err_io` when the folder cannot be written to; `commit` reports it too.
    type(error_t), allocatable, intent(out) :: error
    !> Significant digits of reals, 1 to 17; default 10.
    integer, intent(in), optional :: digits
    integer :: status

    call self%discard()
    self%path = trim(path)
    self%temporary = self%path//'.tmp'//to_text(process_id())
    self%length = 0
    self%n_written = 0
    self%digits = default_digits
    if (present(digits)) self%digits = digits
    if (.not. allocated(self%buffer)) allocate (character(buffer_size) :: self%buffer)
    open (newunit=self%unit, file=self%temporary, access='stream', form='unformatted', &
          status='replace', action='write', iostat=status)
    self%is_open = status == 0
    if (self%is_open) return
    call raise(self%failure, err_io, 'the file cannot be written: '// &
               reason_against(self%path, replaces_file=.true.), file=self%path)
    allocate (error, source=self%failure)
  end subroutine writer_open

  !> Write text.
  subroutine put_text(self, text)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The text, without a line end of its own.
    character(*), intent(in) :: text
    integer :: first, n

    first = 1
    do while (first <= len(text))
      call self%make_room(1)
      n = min(len(text) - first + 1, buffer_size - self%length)
      self%buffer(self%length + 1:self%length + n) = text(first:first + n - 1)
      self%length = self%length + n
      first = first + n
    end do
  end subroutine put_text

  !> Write text and end the line.
  subroutine put_line(self, text)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The text; none just ends the line.
    character(*), intent(in), optional :: text

    if (present(text)) call self%put_text(text)
    call self%put_text(new_line('a'))
  end subroutine put_line

  !> Write a real, without a blank around it.
  subroutine put_real(self, number)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The number.
    real(wp), intent(in) :: number

    call self%make_room(max_number_length)
    call append_real(self%buffer, self%length, number, self%digits)
  end subroutine put_real

  !> Write many reals, blanks between them and some on each line; the last line is ended too.
  subroutine put_reals(self, numbers, per_line, per_group)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The numbers.
    real(wp), intent(in) :: numbers(:)
    !> Numbers on a line, 1 to 64.
    integer, intent(in) :: per_line
    !> Numbers behind which there is an empty line, 1 to 64 and a multiple of those of a line; none
    !> when left out.
    integer, intent(in), optional :: per_group
    integer :: group, first, m, n

    group = huge(group)
    m = per_line
    if (present(per_group)) then
      group = per_group
      m = per_group
    end if
    m = m*(numbers_at_once/m)
    do first = 1, size(numbers), m
      n = min(m, size(numbers) - first + 1)
      call self%make_room(max_entry_length*n)
      call append_real_lines(self%buffer, self%length, numbers(first:first + n - 1), self%digits, &
                             per_line, group)
    end do
  end subroutine put_reals

  !> Write reals as 8 bytes each, the highest first.
  subroutine put_real_bytes(self, numbers)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The numbers.
    real(wp), intent(in) :: numbers(:)
    integer(int64), parameter :: bytes = int(z'00FF00FF00FF00FF', int64)
    integer(int64), parameter :: pairs = int(z'0000FFFF0000FFFF', int64)
    integer(int64) :: bits(byte_block)
    integer :: first, n

    do first = 1, size(numbers), byte_block
      n = min(byte_block, size(numbers) - first + 1)
      bits(:n) = transfer(numbers(first:first + n - 1), bits, n)
      if (low_byte_first) then
        bits(:n) = ior(ishft(iand(bits(:n), bytes), 8), iand(ishft(bits(:n), -8), bytes))
        bits(:n) = ior(ishft(iand(bits(:n), pairs), 16), iand(ishft(bits(:n), -16), pairs))
        bits(:n) = ishftc(bits(:n), 32)
      end if
      call self%make_room(8*n)
      self%buffer(self%length + 1:self%length + 8*n) = &
        transfer(bits(:n), self%buffer(self%length + 1:self%length + 8*n))
      self%length = self%length + 8*n
    end do
  end subroutine put_real_bytes

  !> Write integers, blanks between them and some on each line; the last line is ended too.
  subroutine put_integers(self, numbers, per_line)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The numbers.
    integer, intent(in) :: numbers(:)
    !> Numbers on a line, 1 to 64.
    integer, intent(in) :: per_line
    integer :: first, m, n

    m = per_line*(numbers_at_once/per_line)
    do first = 1, size(numbers), m
      n = min(m, size(numbers) - first + 1)
      call self%make_room(max_entry_length*n)
      call append_integer_lines(self%buffer, self%length, numbers(first:first + n - 1), per_line)
    end do
  end subroutine put_integers

  !> Write integers as 4 bytes each, the highest first.
  subroutine put_integer_bytes(self, numbers)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The numbers.
    integer, intent(in) :: numbers(:)
    integer(int32), parameter :: bytes = int(z'00FF00FF', int32)
    integer(int32) :: bits(byte_block)
    integer :: first, n

    do first = 1, size(numbers), byte_block
      n = min(byte_block, size(numbers) - first + 1)
      bits(:n) = int(numbers(first:first + n - 1), int32)
      if (low_byte_first) then
        bits(:n) = ior(ishft(iand(bits(:n), bytes), 8), iand(ishft(bits(:n), -8), bytes))
        bits(:n) = ishftc(bits(:n), 16)
      end if
      call self%make_room(4*n)
      self%buffer(self%length + 1:self%length + 4*n) = &
        transfer(bits(:n), self%buffer(self%length + 1:self%length + 4*n))
      self%length = self%length + 4*n
    end do
  end subroutine put_integer_bytes

  !> Write an integer, without a blank around it.
  subroutine put_default_integer(self, number)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The number.
    integer, intent(in) :: number

    call self%make_room(max_number_length)
    call append_integer(self%buffer, self%length, number)
  end subroutine put_default_integer

  !> Write a long integer, without a blank around it.
  subroutine put_long_integer(self, number)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> The number.
    integer(lp), intent(in) :: number

    call self%make_room(max_number_length)
    call append_integer(self%buffer, self%length, number)
  end subroutine put_long_integer

  !> Finish the file and give it its name.
  subroutine commit(self, error)
    !> The writer; it may open another file afterwards.
    class(text_writer_t), intent(inout) :: self
    !> `err_io` with the first failure since `open`; then there is no new file.
    type(error_t), allocatable, intent(out) :: error

    if (.not. self%is_open .and. .not. allocated(self%failure)) then
      call raise(error, err_io, 'no file is open for writing')
      return
    end if
    if (self%is_open) then
      call self%make_room(buffer_size)
      call self%close_file()
    end if
    if (.not. allocated(self%failure)) then
      call rename_file(self%temporary, self%path, error)
      if (allocated(error)) call move_alloc(error, self%failure)
    end if
    if (allocated(self%failure)) allocate (error, source=self%failure)
    call self%discard()
  end subroutine commit

  !> Give up the file: nothing is left of it.
  subroutine discard(self)
    !> The writer; it may open another file afterwards.
    class(text_writer_t), intent(inout) :: self
    type(error_t), allocatable :: ignored

    if (self%is_open) call self%close_file()
    if (allocated(self%temporary)) then
      call delete_file(self%temporary, ignored)
      deallocate (self%temporary)
    end if
    if (allocated(self%failure)) deallocate (self%failure)
    self%length = 0
  end subroutine discard

  !> Write the buffer to the file when too little room is left in it.
  subroutine make_room(self, n)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    !> Characters needed, at most the size of the buffer.
    integer, intent(in) :: n
    integer :: status
    character(256) :: reason

    if (self%length + n <= buffer_size) return
    if (self%is_open .and. .not. allocated(self%failure)) then
      write (self%unit, iostat=status, iomsg=reason) self%buffer(:self%length)
      if (status == 0) then
        self%n_written = self%n_written + self%length
      else
        call raise(self%failure, err_io, 'writing failed: '//trim(reason), file=self%path)
      end if
    end if
    self%length = 0
  end subroutine make_room

  !> Close the file, and see that all of it has arrived.
  subroutine close_file(self)
    !> The writer.
    class(text_writer_t), intent(inout) :: self
    integer :: status
    integer(lp) :: size_in_bytes
    character(256) :: reason
    logical :: is_there

    reason = 'the disk may be full'
    close (self%unit, iostat=status, iomsg=reason)
    self%is_open = .false.
    if (allocated(self%failure)) return
    ! what the run-time library still held may have been lost without a word
    inquire (file=self%temporary, size=size_in_bytes, exist=is_there)
    if (.not. is_there) reason = reason_against(self%path, replaces_file=.true.)
    if (status == 0 .and. size_in_bytes == self%n_written) return
    call raise(self%failure, err_io, 'writing failed: '//trim(reason), file=self%path)
  end subroutine close_file

end module mpm_text_writer
