!> From a checkpoint to a job that goes on from there.
module mpm_restart
  use mpm_checkpoint_file, only: checkpoint_file_t
  use mpm_configurator, only: configure
  use mpm_document, only: value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_job, only: job_t
  use mpm_kinds, only: lp
  use mpm_monitor, only: monitor_t
  use mpm_override, only: parse_override
  use mpm_state, only: restore_state
  use mpm_strings, only: excerpt, string_t, to_text
  implicit none
  private
  public :: restart

contains

  !> Configure and start a job as it was, and take back the state of the run.
  !!
  !! Nothing is written.
  subroutine restart(path, overrides, threads, memory_limit, job, monitor, error)
    !> The checkpoint.
    character(*), intent(in) :: path
    !> What to change, as texts of `--set`.
    type(string_t), intent(in) :: overrides(:)
    !> Number of threads; 0 for that of the config.
    integer, intent(in) :: threads
    !> Most bytes that points and nodes may take; 0 for what the machine has.
    integer(lp), intent(in) :: memory_limit
    !> The job, started.
    type(job_t), intent(out) :: job
    !> What is told of the run.
    class(monitor_t), intent(inout) :: monitor
    !> A checkpoint or points that are not what they should be.
    type(error_t), allocatable, intent(out) :: error
    type(checkpoint_file_t), allocatable :: file
    character(:), allocatable :: config, text, program
    type(string_t), allocatable :: all(:)
    integer :: n, i

    allocate (file)
    call file%read(path, error)
    if (allocated(error)) return
    n = 0
    call file%get('program', program)
    call file%get('config', config)
    call file%get('text', text)
    call file%get('overrides', n)
    allocate (all(n + size(overrides)))
    do i = 1, n
      call file%get('override_'//to_text(i), all(i)%text)
    end do
    do i = 1, size(overrides)
      all(n + i)%text = overrides(i)%text
      call check_override(overrides(i)%text, error)
      if (allocated(error)) exit
    end do
    if (.not. allocated(file%failure) .and. .not. allocated(error)) then
      call configure(config, all, job, error, text, memory_limit, file)
      if (.not. allocated(error)) then
        if (threads > 0) job%model%threads = threads
        call job%start(error)
      end if
      if (.not. allocated(error)) then
        call restore_state(file, job%model, job%driver, job%solver, job%serializer, monitor)
        job%goes_on = .true.
        call monitor%say('restart: '//path//', saved by '//program)
      end if
    end if
    if (allocated(file%failure)) then
      if (allocated(error)) deallocate (error)
      allocate (error, source=file%failure)
    end if
    call file%close()
  end subroutine restart

  !> Refuse another points file: the points are those of the checkpoint.
  subroutine check_override(text, error)
    !> `section.key=value`.
    character(*), intent(in) :: text
    !> `err_input`.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: selector, key
    type(value_t), allocatable :: values(:)

    call parse_override(text, selector, key, values, error)
    if (allocated(error) .or. key /= 'point-file') return
    call raise(error, err_input, '--set '//excerpt(text, 80)//': the points are those of the &
               &checkpoint', hint='a run with other points starts anew: mpm3d -c FILE')
  end subroutine check_override

end module mpm_restart
