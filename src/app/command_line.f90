!> The command line of the program.
module mpm_command_line
  use mpm_errors, only: err_usage, error_t, raise
  use mpm_kinds, only: lp
  use mpm_memory, only: parse_size
  use mpm_monitor, only: normal, quiet, verbose
  use mpm_strings, only: append_text, excerpt, nearest_name, string_t
  implicit none
  private
  public :: command_line_t, read_command_line, usage

  !> What the program is asked to do.
  type :: command_line_t
    !> `run`, `check`, `estimate`, `list`, `describe`, `describe-run`, `version` or `help`.
    character(:), allocatable :: action
    !> The config of `run`, `check` and `estimate`.
    character(:), allocatable :: config
    !> The checkpoint to go on from; empty for none.
    character(:), allocatable :: checkpoint
    !> The role of `list`, or '' for all; the class of `describe`; the file of `describe-run`.
    character(:), allocatable :: subject
    !> Texts of `--set`.
    type(string_t), allocatable :: overrides(:)
    !> Number of threads; 0 when not given.
    integer :: threads = 0
    !> Most bytes that points and nodes may take; 0 for what the machine has.
    integer(lp) :: memory_limit = 0
    !> How much is told of the run.
    integer :: verbosity = normal
  end type command_line_t

contains

  !> Text of `--help`.
  pure function usage() result(text)
    !> Several lines.
    character(:), allocatable :: text
    character(*), parameter :: nl = new_line('a')

    text = 'mpm3d: material point method for solids, grains and fluids'//nl//nl// &
           'usage: mpm3d -c FILE [options]     run the scene of a config'//nl// &
           '       mpm3d -r FILE [options]     go on from a checkpoint'//nl// &
           '       mpm3d -c FILE --check       read everything, run nothing, report sizes'//nl// &
           '       mpm3d -c FILE --estimate    time a few steps, tell how long a run takes'//nl// &
           '       mpm3d --list [ROLE]         classes that a config can name'//nl// &
           '       mpm3d --describe CLASS      purpose and properties of a class'//nl// &
           '       mpm3d --describe-run FILE   program, config and points behind an output'//nl// &
           '       mpm3d --version | --help'//nl//nl// &
           'options: --threads N               number of threads'//nl// &
           '         --max-memory SIZE         most memory of points and nodes, such as 8G;'//nl// &
           '                                   unless given, what the machine has'//nl// &
           '         --set SECTION.KEY=VALUE   replace what the config says; may repeat;'//nl// &
           '                                   bodies and contacts: body.NAME.KEY=VALUE'//nl// &
           '         -q, -v                    say less, say more'//nl//nl// &
           'examples: mpm3d -c two_blocks.cfg --check'//nl// &
           '          mpm3d -c two_blocks.cfg --threads 2 --set job.dt=1e-5'//nl// &
           '          mpm3d -r save/two_blocks.000000012000.h5'//nl// &
           '          mpm3d --describe ContactHuang'//nl//nl// &
           'environment: OMP_NUM_THREADS, NO_COLOR'//nl//nl// &
           'exit status: 0 done, 1 wrong usage, 2 bad input, 3 the simulation went bad,'//nl// &
           '             4 output failed, 130 or 143 stopped by SIGINT or SIGTERM'
  end function usage

  !> Read the arguments of the program.
  subroutine read_command_line(command, error)
    !> What to do.
    type(command_line_t), intent(out) :: command
    !> Wrong usage.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: argument, value
    integer :: i

    command%action = ''
    command%config = ''
    command%checkpoint = ''
    command%subject = ''
    allocate (command%overrides(0))
    i = 1
    do while (i <= command_argument_count())
      call get_argument(i, argument)
      select case (argument)
      case ('-c', '--config')
        call next_value(i, argument, 'a config file', command%config, error)
      case ('-r', '--restart')
        call next_value(i, argument, 'a checkpoint', command%checkpoint, error)
      case ('--check')
        call set_action(command, 'check', error)
      case ('--estimate')
        call set_action(command, 'estimate', error)
      case ('--list')
        call set_action(command, 'list', error)
        if (i < command_argument_count()) then
          call get_argument(i + 1, value)
          if (index(value, '-') /= 1) then
            command%subject = value
            i = i + 1
          end if
        end if
      case ('--describe')
        call set_action(command, 'describe', error)
        if (.not. allocated(error)) call next_value(i, argument, 'a class', command%subject, error)
      case ('--describe-run')
        call set_action(command, 'describe-run', error)
        if (.not. allocated(error)) call next_value(i, argument, 'a file', command%subject, error)
      case ('--version')
        call set_action(command, 'version', error)
      case ('-h', '--help')
        call set_action(command, 'help', error)
      case ('-q')
        command%verbosity = quiet
      case ('-v')
        command%verbosity = verbose
      case ('--threads')
        call next_value(i, argument, 'a number', value, error)
        if (.not. allocated(error)) call read_threads(value, command%threads, error)
      case ('--max-memory')
        call next_value(i, argument, 'a size', value, error)
        if (.not. allocated(error)) call read_memory(value, command%memory_limit, error)
      case ('--set')
        call next_value(i, argument, 'section.key=value', value, error)
        if (.not. allocated(error)) call append_text(command%overrides, value)
      case default
        call raise_unknown(argument, error)
      end select
      if (allocated(error)) return
      i = i + 1
    end do
    call complete(command, error)
  end subroutine read_command_line

  !> Every action has what it needs.
  subroutine complete(command, error)
    !> What to do.
    type(command_line_t), intent(inout) :: command
    !> No action, or no config.
    type(error_t), allocatable, intent(inout) :: error

    if (len(command%config) > 0 .and. len(command%checkpoint) > 0) then
      call raise(error, err_usage, '-c and -r exclude each other', hint='a checkpoint has its &
                 &config in it; --set changes it')
      return
    end if
    if (command%action == '' .and. len(command%config//command%checkpoint) > 0) then
      command%action = 'run'
    end if
    select case (command%action)
    case ('')
      call raise(error, err_usage, 'nothing to do', hint='mpm3d -c FILE runs a scene; mpm3d --help &
                 &tells more')
    case ('check', 'estimate')
      if (len(command%config//command%checkpoint) == 0) then
        call raise(error, err_usage, '--'//command%action//' needs a config', &
                   hint='mpm3d -c FILE --'//command%action)
      end if
    case default
      continue
    end select
  end subroutine complete

  !> Take an action, of which there can be one.
  subroutine set_action(command, action, error)
    !> What to do.
    type(command_line_t), intent(inout) :: command
    !> The action.
    character(*), intent(in) :: action
    !> A second action.
    type(error_t), allocatable, intent(inout) :: error

    if (command%action /= '' .and. command%action /= action) then
      call raise(error, err_usage, '--'//command%action//' and --'//action//' exclude each other')
      return
    end if
    command%action = action
  end subroutine set_action

  !> The argument behind an option.
  subroutine next_value(i, option, what, value, error)
    !> Position of the option; that of its value on return.
    integer, intent(inout) :: i
    !> The option.
    character(*), intent(in) :: option
    !> What the option needs.
    character(*), intent(in) :: what
    !> Its value.
    character(:), allocatable, intent(out) :: value
    !> There is none.
    type(error_t), allocatable, intent(inout) :: error

    value = ''
    if (i < command_argument_count()) call get_argument(i + 1, value)
    if (len(value) == 0) then
      call raise(error, err_usage, option//' needs '//what, hint='mpm3d --help')
      return
    end if
    i = i + 1
  end subroutine next_value

  !> An argument in its full length.
  subroutine get_argument(i, argument)
    !> Position, from 1.
    integer, intent(in) :: i
    !> The argument.
    character(:), allocatable, intent(out) :: argument
    integer :: n

    call get_command_argument(i, length=n)
    allocate (character(n) :: argument)
    if (n > 0) call get_command_argument(i, argument)
  end subroutine get_argument

  !> A number of threads.
  subroutine read_threads(text, threads, error)
    !> The argument.
    character(*), intent(in) :: text
    !> The number.
    integer, intent(out) :: threads
    !> Not a number from 1 to 4096.
    type(error_t), allocatable, intent(inout) :: error
    integer :: status

    threads = 0
    status = 1
    if (verify(text, '0123456789') == 0 .and. len(text) < 6) read (text, *, iostat=status) threads
    if (status == 0 .and. threads >= 1 .and. threads <= 4096) return
    call raise(error, err_usage, '--threads '//excerpt(text)//' is not a number from 1 to 4096')
  end subroutine read_threads

  !> A size of memory.
  subroutine read_memory(text, bytes, error)
    !> The argument.
    character(*), intent(in) :: text
    !> The size.
    integer(lp), intent(out) :: bytes
    !> Not a size.
    type(error_t), allocatable, intent(inout) :: error
    logical :: valid

    call parse_size(text, bytes, valid)
    if (valid) return
    call raise(error, err_usage, '--max-memory '//excerpt(text)//' is not a size above 0', &
               hint='a number of bytes, or for example 500M, 8G, 1.5T or 512MiB')
  end subroutine read_memory

  !> An argument that means nothing.
  subroutine raise_unknown(argument, error)
    !> The argument.
    character(*), intent(in) :: argument
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    character(14), parameter :: options(12) = &
      [character(14) :: '--check', '--estimate', '--list', '--describe', '--describe-run', &
       '--version', '--help', '--threads', '--max-memory', '--set', '--config', '--restart']
    type(string_t) :: known(size(options))
    character(:), allocatable :: hint
    integer :: i

    if (index(argument, '-') /= 1) then
      call raise(error, err_usage, 'unexpected argument "'//excerpt(argument)//'"', &
                 hint='a config is given with -c: mpm3d -c '//excerpt(argument))
      return
    end if
    do i = 1, size(options)
      known(i)%text = trim(options(i))
    end do
    hint = nearest_name(argument, known)
    if (len(hint) > 0) hint = 'did you mean '//hint//'?   '
    call raise(error, err_usage, 'unknown option "'//excerpt(argument)//'"', &
               hint=hint//'(mpm3d --help)')
  end subroutine raise_unknown

end module mpm_command_line
