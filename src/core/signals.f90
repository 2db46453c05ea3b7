!> Signals that ask to stop or to save.
!!
!! A signal handler can do no more than set a flag. These flags are the only state of the program
!! that belongs to no object.
module mpm_signals
  use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_null_funptr
  use, intrinsic :: iso_c_binding, only: c_intptr_t
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: ignore_file_limit, save_was_asked, signal_name, stop_signal, watch_signals

  !> Numbers of signals on Linux.
  integer(c_int), parameter :: sigint = 2, sigusr1 = 10, sigterm = 15, sigxfsz = 25

  !> Signals that come within this part of a second are one: `timeout` sends its signal to the
  !> program and to its group, and batch systems to each process of a job.
  real(wp), parameter :: one_request = 0.25_wp

  !> The first signal that asked the program to stop, or 0.
  integer(c_int), volatile :: stop_number = 0
  !> Clock count when it came.
  integer(lp), volatile :: stop_clock = 0
  !> Whether SIGUSR1 came since it was last asked for.
  logical, volatile :: save_asked = .false.

  interface
    !> C `signal`: choose what a signal does.
    function c_signal(number, handler) bind(c, name='signal') result(earlier)
      import :: c_funptr, c_int
      implicit none
      !> The signal.
      integer(c_int), intent(in), value :: number
      !> Address of a procedure; null for what the system does.
      type(c_funptr), intent(in), value :: handler
      !> What it did before.
      type(c_funptr) :: earlier
    end function c_signal
    !> C `raise`: send a signal to the program itself.
    function c_raise(number) bind(c, name='raise') result(status)
      import :: c_int
      implicit none
      !> The signal.
      integer(c_int), intent(in), value :: number
      !> 0 when it was sent.
      integer(c_int) :: status
    end function c_raise
  end interface

contains

  !> From now on SIGINT and SIGTERM ask to stop, SIGUSR1 asks to save.
  subroutine watch_signals()
    type(c_funptr) :: ignored

    stop_number = 0
    save_asked = .false.
    ignored = c_signal(sigint, c_funloc(on_stop))
    ignored = c_signal(sigterm, c_funloc(on_stop))
    ignored = c_signal(sigusr1, c_funloc(on_save))
  end subroutine watch_signals

  !> A file that would become larger than the limit of the shell fails to be written, in place of
  !! ending the program.
  subroutine ignore_file_limit()
    type(c_funptr) :: ignored

    ! SIG_IGN is the address 1.
    ignored = c_signal(sigxfsz, transfer(1_c_intptr_t, c_null_funptr))
  end subroutine ignore_file_limit

  !> The signal that asked the program to stop.
  function stop_signal() result(number)
    !> 0 when there was none.
    integer :: number

    number = int(stop_number)
  end function stop_signal

  !> Whether a checkpoint was asked for; asks no more after that.
  function save_was_asked() result(asked)
    !> Whether SIGUSR1 came since the last call.
    logical :: asked

    asked = save_asked
    if (asked) save_asked = .false.
  end function save_was_asked

  !> Name of a signal that stops the program.
  pure function signal_name(number) result(name)
    !> The signal.
    integer, intent(in) :: number
    !> Its name.
    character(:), allocatable :: name

    name = 'SIGTERM'
    if (number == sigint) name = 'SIGINT'
  end function signal_name

  !> Keep the signal; a later request ends the program at once.
  subroutine on_stop(number) bind(c)
    !> The signal.
    integer(c_int), intent(in), value :: number
    type(c_funptr) :: ignored
    integer(lp) :: now, rate
    integer(c_int) :: status

    ! The clock, `signal` and `raise` are among the few calls that a handler may make.
    call system_clock(now, rate)
    if (stop_number == 0) then
      stop_clock = now
      stop_number = number
    else if (real(now - stop_clock, wp) > one_request*real(rate, wp)) then
      ignored = c_signal(number, c_null_funptr)
      status = c_raise(number)
    end if
  end subroutine on_stop

  !> Keep that a checkpoint is asked for.
  subroutine on_save(number) bind(c)
    !> The signal.
    integer(c_int), intent(in), value :: number

    associate (unused => number)
    end associate
    save_asked = .true.
  end subroutine on_save

end module mpm_signals
