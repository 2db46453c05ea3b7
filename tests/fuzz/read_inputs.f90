!> Reads inputs that may be bad in any way, as the program does before a run; see README.md.
!!
!! Each line of the standard input is the path of an input, whose ending tells what it is:
!!
!! - `.cfg`: a config;
!! - `.<TYPE>.points`, `.<TYPE>.parts`: a points table, a generator text, for a job of that TYPE;
!! - `.set`: lines of `--set` for the config `base.cfg` of the working directory.
!!
!! For each one line is printed: exit code, CPU time in seconds, and the path.
program read_inputs
  use, intrinsic :: ieee_exceptions, only: ieee_set_halting_mode, ieee_usual
  use mpm_configurator, only: configure
  use mpm_errors, only: err_input, err_usage, error_t
  use mpm_job, only: job_t
  use mpm_kinds, only: lp, wp
  use mpm_strings, only: append_text, string_t
  use mpm_text_file, only: read_whole_file
  implicit none

  !> Most bytes that points and nodes may take: little, so that no valid input takes long.
  integer(lp), parameter :: memory_limit = 16000000
  !> Options `--set` of a command line, at most.
  integer, parameter :: most_overrides = 50
  character(4096) :: line
  real(wp) :: start, end
  integer :: code, status

  ! Numbers may overflow, as they may in a Release build; what comes of it must do no harm.
  call ieee_set_halting_mode(ieee_usual, .false.)
  do
    read (*, '(a)', iostat=status) line
    if (status /= 0) exit
    call cpu_time(start)
    call read_input(trim(line), code)
    call cpu_time(end)
    print '(i0,1x,f0.6,1x,a)', code, end - start, trim(line)
    flush (6)
  end do

contains

  !> Read one input up to the state from which a run would start.
  subroutine read_input(path, code)
    !> The input.
    character(*), intent(in) :: path
    !> 0, or the exit code that the program would have.
    integer, intent(out) :: code
    type(job_t), allocatable :: job
    type(string_t), allocatable :: overrides(:)
    type(error_t), allocatable :: error

    allocate (job, overrides(0))
    if (has_ending(path, '.cfg')) then
      call configure(path, overrides, job, error, memory_limit=memory_limit)
    else if (has_ending(path, '.set')) then
      call read_overrides(path, overrides, error)
      if (.not. allocated(error)) then
        call configure('base.cfg', overrides, job, error, memory_limit=memory_limit)
      end if
    else
      call configure('scene.cfg', overrides, job, error, scene_of(path), memory_limit)
    end if
    if (.not. allocated(error)) then
      if (job%model%threads > 1) job%model%threads = 1
      call job%start(error)
    end if
    code = 0
    if (allocated(error)) code = error%code
    if (code == 0 .or. code == err_usage .or. code == err_input) return
    print '(a)', error%text()
  end subroutine read_input

  !> Whether a path has an ending.
  pure function has_ending(path, ending)
    !> The path.
    character(*), intent(in) :: path
    !> The ending.
    character(*), intent(in) :: ending
    !> True when it has.
    logical :: has_ending

    has_ending = index(path, ending, back=.true.) == len(path) - len(ending) + 1 .and. &
                 len(path) > len(ending)
  end function has_ending

  !> Texts of `--set`, one a line.
  subroutine read_overrides(path, overrides, error)
    !> The input.
    character(*), intent(in) :: path
    !> The texts.
    type(string_t), allocatable, intent(inout) :: overrides(:)
    !> The file can't be read.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text
    integer :: first, n

    call read_whole_file(path, text, error)
    if (allocated(error)) return
    first = 1
    do while (first <= len(text) .and. size(overrides) < most_overrides)
      n = index(text(first:), new_line('a')) - 1
      if (n < 0) n = len(text) - first + 1
      call append_text(overrides, text(first:first + n - 1))
      first = first + n + 1
    end do
  end subroutine read_overrides

  !> A config for a points table or a generator text.
  pure function scene_of(path) result(text)
    !> The input; the digit before its last ending is the TYPE.
    character(*), intent(in) :: path
    !> The config.
    character(:), allocatable :: text
    character(*), parameter :: dims = '12322'
    character(:), allocatable :: lengths, cells, class
    character(1) :: sim_type
    integer :: dot, t

    dot = index(path, '.', back=.true.)
    sim_type = path(dot - 1:dot - 1)
    t = index('12345', sim_type)
    if (t == 0) t = 2
    class = 'DefaultPoints'
    if (path(dot:) == '.parts') class = 'CartesianPoints'
    lengths = repeat('1,', index('123', dims(t:t)))
    cells = repeat('4,', index('123', dims(t:t)))
    text = 'job { dt = 1e-4 TYPE = '//'12345' (t:t)//' threads = 1 }'//new_line('a')// &
           'serializer { class = DefaultVTK properties = {0}'// &
           ' str-properties = {frames, save, a} }'//new_line('a')// &
           'driver { class = DefaultDriver properties = {1} }'//new_line('a')// &
           'solver { class = ExplicitUSL }'//new_line('a')// &
           'grid { class = CartesianLinear properties = {'//lengths//'} int-properties = {'// &
           cells//'} }'//new_line('a')// &
           'body { class = DefaultBody name = a node-class = DefaultNodes'// &
           ' point-class = '//class//' point-file = "'//path//'" }'//new_line('a')
  end function scene_of

end program read_inputs
