!> The program: reads the command line, runs a job, turns errors into messages and exit codes.
program mpm3d
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mpm_build_info, only: build_type, compiler, revision, version
  use mpm_colours, only: coloured
  use mpm_command_line, only: command_line_t, read_command_line, usage
  use mpm_console, only: finish_output, put_line
  use mpm_configurator, only: configure
  use mpm_describe_text, only: describe_text, list_line, missing_lines
  use mpm_description, only: description_t
  use mpm_errors, only: err_usage, error_t, raise
  use mpm_job, only: job_t
  use mpm_job_report, only: report_job
  use mpm_monitor, only: monitor_t, quiet, verbose
  use mpm_original_classes, only: missing_reason
  use mpm_phase_clock, only: phase_clock_t, phase_setup
  use mpm_registry, only: describe_classes, role_names
  use mpm_restart, only: restart
  use mpm_run_estimate, only: estimate_run
  use mpm_run_file, only: describe_run
  use mpm_signals, only: ignore_file_limit, watch_signals
  use mpm_strings, only: append_text, excerpt, nearest_name, string_t
  implicit none

  interface
    !> POSIX `_exit`: end the program with a status that is not known at compile time.
    !!
    !! Not `exit`: the HDF5 library crashes at the end of a program that could not close a file.
    subroutine c_exit(status) bind(c, name='_exit')
      import :: c_int
      implicit none
      !> Exit status.
      integer(c_int), intent(in), value :: status
    end subroutine c_exit
  end interface

  !> File descriptor of the standard error.
  integer, parameter :: standard_error = 2
  type(command_line_t) :: command
  type(error_t), allocatable :: error, lost

  call read_command_line(command, error)
  if (.not. allocated(error)) call act(command, error)
  call finish_output(lost)
  if (allocated(lost) .and. .not. allocated(error)) call move_alloc(lost, error)
  if (allocated(error)) then
    write (error_unit, '(a)') coloured(error%text(), standard_error)
    flush (error_unit)
    call c_exit(int(error%code, c_int))
  end if

contains

  !> Do what the command line asks for.
  subroutine act(command, error)
    !> The command line.
    type(command_line_t), intent(in) :: command
    !> What went wrong.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text

    select case (command%action)
    case ('help')
      call put_line(usage())
    case ('version')
      call put_line('mpm3d '//version//' ('//revision//', '//compiler//', '//build_type//')')
    case ('list')
      call list_classes(command%subject, error)
    case ('describe')
      call describe_class(command%subject, error)
    case ('describe-run')
      call describe_run(command%subject, text, error)
      if (.not. allocated(error)) call put_line(text)
    case default
      call run_job(command, error)
    end select
  end subroutine act

  !> Run or check a config.
  subroutine run_job(command, error)
    !> The command line.
    type(command_line_t), intent(in) :: command
    !> Bad input, a simulation that went bad, or failed output.
    type(error_t), allocatable, intent(out) :: error
    type(job_t), allocatable :: job
    type(monitor_t) :: monitor
    type(phase_clock_t) :: clock

    allocate (job)
    if (command%verbosity >= verbose) call clock%start(phase_setup)
    monitor%verbosity = command%verbosity
    if (len(command%checkpoint) > 0) then
      call restart(command%checkpoint, command%overrides, command%threads, command%memory_limit, &
                   job, monitor, error)
      if (allocated(error)) return
      job%model%clock = clock
    else
      call configure(command%config, command%overrides, job, error, &
                     memory_limit=command%memory_limit)
      if (allocated(error)) return
      job%model%clock = clock
      if (command%threads > 0) job%model%threads = command%threads
      call job%start(error)
      if (allocated(error)) return
    end if
    if (command%verbosity > quiet) call report_job(job)
    if (command%action == 'check') return
    if (command%action == 'estimate') then
      call estimate_run(job, error)
      return
    end if
    call ignore_file_limit()
    call watch_signals()
    call job%run(monitor, error)
  end subroutine run_job

  !> Print the classes of a role, or of all roles.
  subroutine list_classes(role, error)
    !> Role in singular or plural; '' for all.
    character(*), intent(in) :: role
    !> No such role.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: roles(:)
    type(description_t), allocatable :: descriptions(:)
    character(:), allocatable :: rest
    integer :: i, j

    if (len(role) > 0) then
      allocate (roles(1))
      roles(1)%text = role
    else
      call role_names(roles)
    end if
    rest = ''
    do i = 1, size(roles)
      call describe_classes(roles(i)%text, descriptions, error)
      if (allocated(error)) then
        error%code = err_usage
        return
      end if
      call put_line(roles(i)%text)
      do j = 1, size(descriptions)
        call put_line(list_line(descriptions(j)))
      end do
      rest = missing_lines(descriptions)
      if (len(rest) > 0) call put_line(rest)
    end do
  end subroutine list_classes

  !> Print what a class says of itself.
  subroutine describe_class(name, error)
    !> Class name.
    character(*), intent(in) :: name
    !> No such class.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: roles(:), known(:)
    type(description_t), allocatable :: descriptions(:)
    character(:), allocatable :: hint, why
    integer :: i, j

    call role_names(roles)
    allocate (known(0))
    do i = 1, size(roles)
      call describe_classes(roles(i)%text, descriptions, error)
      if (allocated(error)) return
      do j = 1, size(descriptions)
        if (descriptions(j)%name == name) then
          call put_line(describe_text(descriptions(j)))
          return
        end if
        call append_text(known, descriptions(j)%name)
      end do
    end do
    do i = 1, size(roles)
      why = missing_reason(roles(i)%text, name)
      if (len(why) == 0) cycle
      call raise(error, err_usage, 'the class "'//name//'" of mpm_3d is not available', hint=why)
      return
    end do
    hint = nearest_name(name, known)
    if (len(hint) > 0) hint = 'did you mean "'//hint//'"?   '
    call raise(error, err_usage, 'there is no class "'//excerpt(name)//'"', &
               hint=hint//'(mpm3d --list)')
  end subroutine describe_class

end program mpm3d
