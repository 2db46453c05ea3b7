!> Errors as values: library code fills an `error_t`, only the program prints it and exits.
!!
!! A procedure that may fail takes `type(error_t), allocatable, intent(out) :: error`; the caller
!! goes on when it is not allocated. The `code` is the exit status of the program.
module mpm_errors
  implicit none
  private
  public :: error_t, raise
  public :: err_usage, err_input, err_simulation, err_io

  !> Wrong command line.
  integer, parameter :: err_usage = 1
  !> Bad config, points file or mesh.
  integer, parameter :: err_input = 2
  !> The simulation went bad: a NaN, a point with non-positive volume, a point faster than the grid.
  integer, parameter :: err_simulation = 3
  !> Reading or writing failed.
  integer, parameter :: err_io = 4

  !> What went wrong, where, and the way out.
  type :: error_t
    !> Exit status of the program, one of the `err_*` constants.
    integer :: code = err_input
    !> What is wrong, one line without a full stop.
    character(:), allocatable :: message
    !> The way out, one line; empty when the message says it all.
    character(:), allocatable :: hint
    !> File in which the cause stands; empty when there is none.
    character(:), allocatable :: file
    !> Line of the cause in `file`, from 1; 0 when it is the file as a whole.
    integer :: line = 0
  contains
    !> The error as printed: `file:line: error: message`, and the hint on a line of its own.
    procedure :: text => error_text
  end type error_t

contains

  !> Allocate and fill an error.
  pure subroutine raise(error, code, message, file, line, hint)
    !> The error to fill; an earlier one is replaced.
    type(error_t), allocatable, intent(inout) :: error
    !> Exit status, one of the `err_*` constants.
    integer, intent(in) :: code
    !> What is wrong.
    character(*), intent(in) :: message
    !> File of the cause.
    character(*), intent(in), optional :: file
    !> Line of the cause, from 1.
    integer, intent(in), optional :: line
    !> The way out.
    character(*), intent(in), optional :: hint

    if (allocated(error)) deallocate (error)
    allocate (error)
    error%code = code
    error%message = message
    error%hint = ''
    error%file = ''
    if (present(hint)) error%hint = hint
    if (present(file)) error%file = file
    if (present(line)) error%line = line
  end subroutine raise

  !> The error as printed.
  pure function error_text(self) result(text)
    !> The error.
    class(error_t), intent(in) :: self
    !> One or two lines, without a newline at the end.
    character(:), allocatable :: text
    character(12) :: number

    text = ''
    if (len(self%file) > 0) then
      text = self%file//':'
      if (self%line > 0) then
        write (number, '(i0)') self%line
        text = text//trim(number)//':'
      end if
      text = text//' '
    end if
    text = text//'error: '//self%message
    if (len(self%hint) > 0) text = text//new_line('a')//'  '//self%hint
  end function error_text

end module mpm_errors
