!> How long a run will take, from a few timed steps of it.
module mpm_run_estimate
  use mpm_console, only: put_line
  use mpm_errors, only: error_t
  use mpm_job, only: job_t
  use mpm_kinds, only: lp, wp
  use mpm_strings, only: counted, duration_text, to_text
  implicit none
  private
  public :: estimate_run

  !> Steps that are made before time is taken, and the fewest and most that are timed.
  integer, parameter :: warm_up = 2, fewest = 3, most = 1000
  !> Seconds of timed steps that are enough.
  real(wp), parameter :: enough = 2.0_wp

contains

  !> Make a few steps without output, and tell how long all of them would take.
  subroutine estimate_run(job, error)
    !> The job, started.
    type(job_t), intent(inout) :: job
    !> A step went wrong.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: steps, left, began, now, rate
    real(wp) :: dt, t_next, seconds
    integer :: timed
    logical :: exact

    call job%driver%plan(job%model, job%solver, steps, exact)
    left = max(0_lp, steps - job%model%step)
    seconds = 0.0_wp
    timed = -warm_up
    began = 0
    do while (timed < most .and. (timed < fewest .or. seconds < enough))
      ! The end of a run is no step, and drivers may write there.
      if (exact .and. job%model%step >= job%driver%step_count(job%model)) exit
      call job%driver%next_step(job%model, job%solver, job%serializer, dt, t_next, error)
      if (allocated(error)) return
      if (.not. dt > 0.0_wp) exit
      call job%driver%before_step(job%model)
      if (timed <= 0) call system_clock(began)
      call job%solver%step(job%model, dt, .false., error)
      if (allocated(error)) return
      call system_clock(now, rate)
      job%model%step = job%model%step + 1
      job%model%time = t_next
      job%model%last_dt = dt
      timed = timed + 1
      if (timed > 0) seconds = real(now - began, wp)/real(rate, wp)
    end do
    call tell(timed, seconds, left, exact, job%model%threads)
  end subroutine estimate_run

  !> Print the estimate.
  subroutine tell(timed, seconds, left, exact, threads)
    !> Steps that were timed.
    integer, intent(in) :: timed
    !> Their time. [s]
    real(wp), intent(in) :: seconds
    !> Steps of the run.
    integer(lp), intent(in) :: left
    !> Whether their number is no estimate.
    logical, intent(in) :: exact
    !> Threads that share the work.
    integer, intent(in) :: threads
    character(:), allocatable :: steps

    if (timed < 1) then
      call put_line('estimate: the run has too few steps to time some of them')
      return
    end if
    steps = counted(left, 'step')
    if (.not. exact) steps = 'about '//steps
    call put_line('estimate: '//duration_text(real(left, wp)*seconds/real(timed, wp))//' for '// &
                  steps//' on '//counted(threads, 'thread')//', frames not counted ('// &
                  counted(timed, 'step')//' took '//to_text(seconds, 3)//' s)')
  end subroutine tell

end module mpm_run_estimate
