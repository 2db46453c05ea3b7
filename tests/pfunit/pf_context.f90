!> Runs the tests of one module, keeps and prints what failed.
!!
!! A test has no argument to hand its failures over, so they are kept in this module.
module pf_context
  use, intrinsic :: iso_fortran_env, only: output_unit
  implicit none
  private
  public :: anyExceptions, fail, finish_suite, run_test, SourceLocation

  !> A place in a `.pf` file.
  type :: SourceLocation
    !> Path of the file.
    character(256) :: file
    !> Line, from 1.
    integer :: line
  end type SourceLocation

  abstract interface
    !> A test, or what runs before or after each.
    subroutine test_i()
      implicit none
    end subroutine test_i
  end interface

  !> Tests that ran.
  integer :: n_tests = 0
  !> Tests that failed.
  integer :: n_failed = 0
  !> Whether the running test has failed.
  logical :: failed = .false.

contains

  !> Whether the running test has failed.
  logical function anyExceptions()
    anyExceptions = failed
  end function anyExceptions

  !> Record and print a failure of the running test.
  subroutine fail(text, message, location)
    !> What was expected and found.
    character(*), intent(in) :: text
    !> The test's own words.
    character(*), intent(in), optional :: message
    !> Where the assertion stands.
    type(SourceLocation), intent(in) :: location

    if (.not. failed) write (output_unit, '(a)') 'FAILED'
    failed = .true.
    write (output_unit, '(2x,2a,i0,2a)') trim(location%file), ':', location%line, ': ', text
    if (present(message)) write (output_unit, '(4x,a)') message
  end subroutine fail

  !> Run one test.
  subroutine run_test(name, test, before, after)
    !> Name of the test.
    character(*), intent(in) :: name
    !> The test.
    procedure(test_i) :: test
    !> Runs before it.
    procedure(test_i), optional :: before
    !> Runs after it, unless `before` failed.
    procedure(test_i), optional :: after

    ! The name goes out first, so that it stands there when the test crashes.
    write (output_unit, '(2a)', advance='no') name, ': '
    flush (output_unit)
    failed = .false.
    if (present(before)) call before()
    if (.not. failed) then
      call test()
      if (present(after)) call after()
    end if
    n_tests = n_tests + 1
    if (failed) then
      n_failed = n_failed + 1
    else
      write (output_unit, '(a)') 'ok'
    end if
  end subroutine run_test

  !> Print the summary; end the program with a status that is not 0 upon failure.
  subroutine finish_suite(name)
    !> Name of the test module.
    character(*), intent(in) :: name

    write (output_unit, '(2a,i0,a,i0,a)') name, ': ', n_tests - n_failed, ' passed, ', n_failed, &
      ' failed'
    flush (output_unit)
    if (n_tests == 0) write (output_unit, '(2a)') name, ': no test'
    if (n_tests == 0 .or. n_failed > 0) stop 1
  end subroutine finish_suite

end module pf_context
