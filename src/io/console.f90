!> The standard output, by the C library, which tells when writing fails; gfortran's does not.
module mpm_console
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_null_ptr, c_ptr, c_size_t
  use mpm_errors, only: err_io, error_t, raise
  implicit none
  private
  public :: finish_output, put_line, put_now

  !> File descriptor of the standard output.
  integer(c_int), parameter :: standard_output = 1

  interface
    !> C `puts`: write a text and end the line.
    function c_puts(text) bind(c, name='puts') result(status)
      import :: c_char, c_int
      implicit none
      !> The text, ended by a null character.
      character(kind=c_char), intent(in) :: text(*)
      !> Negative upon failure.
      integer(c_int) :: status
    end function c_puts

    !> C `fflush`: write what is held back.
    function c_fflush(stream) bind(c, name='fflush') result(status)
      import :: c_int, c_ptr
      implicit none
      !> The stream; null for all.
      type(c_ptr), intent(in), value :: stream
      !> 0 when done.
      integer(c_int) :: status
    end function c_fflush

    !> POSIX `write`.
    function c_write(descriptor, bytes, n) bind(c, name='write') result(written)
      import :: c_char, c_int, c_size_t
      implicit none
      !> File descriptor.
      integer(c_int), intent(in), value :: descriptor
      !> What to write.
      character(kind=c_char), intent(in) :: bytes(*)
      !> Number of bytes.
      integer(c_size_t), intent(in), value :: n
      !> Number of bytes that were written.
      integer(c_size_t) :: written
    end function c_write
  end interface

contains

  !> Write a line.
  subroutine put_line(text)
    !> The line, without its end; may have line ends within.
    character(*), intent(in) :: text
    integer(c_int) :: ignored

    ! What fails here fails again at the end.
    ignored = c_puts(text//c_null_char)
  end subroutine put_line

  !> Write a text at once, behind all lines so far, and do not end the line.
  subroutine put_now(text)
    !> The text.
    character(*), intent(in) :: text
    integer(c_size_t) :: ignored
    integer(c_int) :: status

    status = c_fflush(c_null_ptr)
    ignored = c_write(standard_output, text, len(text, c_size_t))
  end subroutine put_now

  !> Write what is held back.
  subroutine finish_output(error)
    !> `err_io` when lines were lost.
    type(error_t), allocatable, intent(out) :: error

    if (c_fflush(c_null_ptr) == 0) return
    call raise(error, err_io, 'the standard output cannot be written: the disk may be full')
  end subroutine finish_output

end module mpm_console
