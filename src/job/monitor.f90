!> What the program tells of a run: summaries at its start and end, progress, warnings.
module mpm_monitor
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mpm_colours, only: coloured
  use mpm_console, only: finish_output, put_line, put_now
  use mpm_energy, only: energy_t, measure
  use mpm_errors, only: error_t
  use mpm_files, only: is_terminal
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_phase_clock, only: phase_clock_t, phase_names, phase_setup
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  use mpm_store, only: store_t
  use mpm_strings, only: counted, duration_text, to_text
  implicit none
  private
  public :: monitor_t
  public :: quiet, normal, verbose

  !> Errors and warnings only.
  integer, parameter :: quiet = 0
  !> Summaries, and progress on a terminal.
  integer, parameter :: normal = 1
  !> A line for every frame as well.
  integer, parameter :: verbose = 2
  !> File descriptors of the standard output and the standard error.
  integer, parameter :: standard_output = 1, standard_error = 2
  !> What brings a terminal to the start of its line, and erases the line from there on.
  character(*), parameter :: start_of_line = achar(13), erase_line = achar(27)//'[K'
  !> Seconds between two progress lines.
  real(wp), parameter :: progress_interval = 0.2_wp

  !> Reporter of a run to the standard output; warnings go to the standard error.
  type :: monitor_t
    !> How much is told.
    integer :: verbosity = normal
    !> Momentum and energy at the start.
    type(energy_t), private :: at_start
    !> Clock count at the start of the loop.
    integer(lp), private :: clock_start = 0
    !> Clock count of the last progress line.
    integer(lp), private :: clock_progress = 0
    !> Whether the steps have the configured length, which the stable steps are compared with.
    logical, private :: fixed_step = .true.
    !> Whether progress lines are written.
    logical, private :: shows_progress = .false.
    !> Whether a body has been warned of.
    logical, allocatable, private :: warned(:)
    !> Whether the remark of a body's points has been told.
    logical, allocatable, private :: told(:)
    !> Lost points that have been reported.
    integer, private :: lost_reported = 0
    !> Step of the model at the start of the loop.
    integer(lp), private :: first_step = 0
    !> Its time. [s]
    real(wp), private :: first_time = 0.0_wp
    !> Whether the run goes on from where it was saved.
    logical, private :: goes_on = .false.
    !> Sum over the steps of the points inside the grid.
    real(wp), private :: point_steps = 0.0_wp
  contains
    !> Start of the loop over time.
    procedure :: begin => monitor_begin
    !> Compare the stable steps with dt; report points that left the grid.
    procedure :: check => monitor_check
    !> A frame has been written.
    procedure :: frame => monitor_frame
    !> End of a step.
    procedure :: progress => monitor_progress
    !> End of the run.
    procedure :: finish => monitor_finish
    !> Save what the end of the run tells of its start.
    procedure :: save => monitor_save
    !> Take it back.
    procedure :: restore => monitor_restore
    !> Write the table of the phases.
    procedure, private :: say_phases => monitor_say_phases
    !> Write a line unless quiet.
    procedure :: say => monitor_say
    !> Write a warning.
    procedure :: warn => monitor_warn
    !> Take the progress line off the terminal.
    procedure :: clear_line => monitor_clear_line
    !> Tell the remark of a body's points, once.
    procedure, private :: tell => monitor_tell
    !> Seconds since the start of the loop.
    procedure, private :: elapsed => monitor_elapsed
  end type monitor_t

contains

  !> Start of the loop over time.
  subroutine monitor_begin(self, model, solver, steps, exact)
    !> The monitor.
    class(monitor_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> The solver.
    class(solver_t), intent(in) :: solver
    !> Number of steps.
    integer(lp), intent(in) :: steps
    !> Whether it is no estimate, and dt kept as it is configured.
    logical, intent(in) :: exact
    character(:), allocatable :: planned
    integer :: i

    self%fixed_step = exact
    self%first_step = model%step
    self%first_time = model%time
    if (.not. self%goes_on) call measure(model, self%at_start)
    self%shows_progress = is_terminal(standard_output)
    if (self%verbosity /= normal) self%shows_progress = .false.
    if (.not. allocated(self%warned)) then
      allocate (self%warned(size(model%bodies)))
      self%warned = .false.
    end if
    allocate (self%told(size(model%bodies)))
    self%told = .false.
    do i = 1, size(model%bodies)
      if (model%bodies(i)%body%points%n_inside > 0) cycle
      call self%warn('body "'//model%bodies(i)%body%name//'" has no active point')
    end do
    call self%check(model, solver)
    planned = counted(steps, 'step')
    if (.not. exact) planned = 'about '//planned
    if (self%goes_on) then
      call self%say('going on from step '//to_text(model%step)//', t = '//to_text(model%time)// &
                    ' s, to '//planned//' on '//counted(model%threads, 'thread'))
    else
      call self%say('running '//planned//' on '//counted(model%threads, 'thread'))
    end if
    call system_clock(self%clock_start)
    self%clock_progress = self%clock_start
  end subroutine monitor_begin

  !> Compare the stable steps with dt; report points that left the grid.
  subroutine monitor_check(self, model, solver)
    !> The monitor.
    class(monitor_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The solver.
    class(solver_t), intent(in) :: solver
    real(wp) :: speed, limit
    integer :: i, lost

    lost = 0
    do i = 1, size(model%bodies)
      lost = lost + model%bodies(i)%body%points%n_lost
      call self%tell(model, i)
      if (self%warned(i) .or. .not. self%fixed_step) cycle
      call solver%stable_step(model, i, speed, limit)
      if (model%dt <= limit) cycle
      self%warned(i) = .true.
      call self%warn('dt = '//to_text(model%dt)//' s is above the stable step of body "'// &
                     model%bodies(i)%body%name//'", '//to_text(limit)//' s (wave speed '// &
                     to_text(speed)//' m/s): the run may blow up')
    end do
    if (lost > self%lost_reported) then
      self%lost_reported = lost
      call self%warn(counted(lost, 'point')//trim(merge(' has ', ' have', lost == 1))// &
                     ' left the grid by t = '//to_text(model%time)//' s (no longer active)')
    end if
  end subroutine monitor_check

  !> Tell the remark of a body's points, once.
  subroutine monitor_tell(self, model, body)
    !> The monitor.
    class(monitor_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Position of the body.
    integer, intent(in) :: body

    associate (item => model%bodies(body)%body)
      if (self%told(body) .or. .not. allocated(item%points%remark)) return
      self%told(body) = .true.
      call self%warn('body "'//item%name//'": '//item%points%remark)
    end associate
  end subroutine monitor_tell

  !> A frame has been written.
  subroutine monitor_frame(self, model, frames)
    !> The monitor.
    class(monitor_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Frames written so far.
    integer, intent(in) :: frames

    if (self%verbosity < verbose) return
    call self%say('frame '//to_text(frames - 1)//' at t = '//to_text(model%time)//' s, step '// &
                  to_text(model%step))
  end subroutine monitor_frame

  !> End of a step.
  subroutine monitor_progress(self, model, t_stop, frames)
    !> The monitor.
    class(monitor_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Stop time. [s]
    real(wp), intent(in) :: t_stop
    !> Frames written so far.
    integer, intent(in) :: frames
    integer(lp) :: now, rate
    real(wp) :: seconds, speed, part, done
    integer :: i

    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      self%point_steps = self%point_steps + real(model%bodies(i)%body%points%n_inside, wp)
    end do
    if (.not. self%shows_progress) return
    call system_clock(now, rate)
    if (real(now - self%clock_progress, wp) < progress_interval*real(rate, wp)) return
    self%clock_progress = now
    seconds = self%elapsed()
    speed = real(model%step - self%first_step, wp)/seconds
    part = (model%time - self%first_time)/(t_stop - self%first_time)
    done = (model%time - model%t_start)/(t_stop - model%t_start)
    call put_now(start_of_line//'t = '//to_text(model%time, 4)//' s   '// &
      to_text(int(100.0_wp*done))//' %   frames '//to_text(frames)//'   '// &
      to_text(speed, 3)//' steps/s   left '// &
      duration_text(anint(seconds*(1.0_wp - part)/part))//erase_line)
  end subroutine monitor_progress

  !> End of the run: cost, momentum and energy.
  subroutine monitor_finish(self, model, serializer)
    !> The monitor.
    class(monitor_t), intent(inout) :: self
    !> The model at its end.
    type(model_t), intent(in) :: model
    !> The serializer.
    class(serializer_t), intent(in) :: serializer
    type(energy_t) :: now
    real(wp) :: seconds
    integer :: i, lost

    call self%clear_line()
    seconds = self%elapsed()
    call measure(model, now)
    call self%say('done: '//counted(model%step, 'step')//' to t = '// &
                  to_text(model%time)//' s in '//duration_text(seconds)//', '// &
                  to_text(1.0e9_wp*seconds/max(1.0_wp, self%point_steps), 3)// &
                  ' ns per point and step, frames included')
    call self%say('momentum: '//vector_text(self%at_start%momentum(:model%kin%nvel))//' -> '// &
                  vector_text(now%momentum(:model%kin%nvel))//' kg m/s, change '// &
                  to_text(relative(norm2(now%momentum - self%at_start%momentum), &
                                   max(now%momentum_scale, self%at_start%momentum_scale)), 3)// &
                  ' of sum m|v|')
    call self%say('energy: kinetic '//to_text(now%kinetic)//', strain '//to_text(now%strain)// &
                  ', potential '//to_text(now%potential)//' J, total changed by '// &
                  to_text(now%total() - self%at_start%total(), 3)//' J from '// &
                  to_text(self%at_start%total())//' J')
    lost = 0
    do i = 1, size(model%bodies)
      lost = lost + model%bodies(i)%body%points%n_lost
      call self%tell(model, i)
    end do
    if (lost > 0) call self%say('points that left the grid: '//to_text(lost))
    call self%say('frames: '//to_text(serializer%frames)//' in '//serializer%destination()// &
                  ' ('//to_text(real(serializer%bytes, wp)/1.0e6_wp, 3)//' MB)')
    if (serializer%history%is_on()) then
      call self%say('history: '//counted(serializer%history%file%rows, 'row')//' in '// &
                    serializer%history%file%path)
    end if
    call self%say_phases(model%clock)
  end subroutine monitor_finish

  !> Save what the end of the run tells of its start.
  subroutine monitor_save(self, store)
    !> The monitor.
    class(monitor_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    associate (start => self%at_start)
      call store%put('momentum', start%momentum)
      call store%put('energies', [start%momentum_scale, start%kinetic, start%strain, &
                                  start%potential])
    end associate
    call store%put('warned', self%warned)
    call store%put('lost_reported', self%lost_reported)
  end subroutine monitor_save

  !> Take back what the end of the run tells of its start.
  subroutine monitor_restore(self, store)
    !> The monitor, before the loop.
    class(monitor_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store
    real(wp) :: energies(4)

    energies = 0.0_wp
    self%goes_on = .true.
    associate (start => self%at_start)
      call store%get_fixed('momentum', start%momentum)
      call store%get_fixed('energies', energies)
      start%momentum_scale = energies(1)
      start%kinetic = energies(2)
      start%strain = energies(3)
      start%potential = energies(4)
    end associate
    call store%get('warned', self%warned)
    call store%get('lost_reported', self%lost_reported)
  end subroutine monitor_restore

  !> A table of the phases of the run: time, share of the loop over time, cost of a point and step.
  subroutine monitor_say_phases(self, clock)
    !> The monitor.
    class(monitor_t), intent(in) :: self
    !> Time of the phases; nothing is written when it is off.
    type(phase_clock_t), intent(in) :: clock
    real(wp) :: seconds(size(phase_names)), loop
    character(60) :: text
    integer :: i

    if (.not. clock%on) return
    seconds = [(clock%seconds(i), i=1, size(phase_names))]
    loop = max(sum(seconds) - seconds(phase_setup), tiny(1.0_wp))
    call self%say('phase       seconds   share   ns per point and step')
    do i = 1, size(phase_names)
      if (i == phase_setup) then
        write (text, '(a,f11.3)') phase_names(i), seconds(i)
      else
        write (text, '(a,f11.3,f6.1,a,f10.2)') phase_names(i), seconds(i), &
          100.0_wp*seconds(i)/loop, ' %', 1.0e9_wp*seconds(i)/max(1.0_wp, self%point_steps)
      end if
      call self%say(trim(text))
    end do
  end subroutine monitor_say_phases

  !> Write a line unless quiet.
  subroutine monitor_say(self, text)
    !> The monitor.
    class(monitor_t), intent(in) :: self
    !> The line.
    character(*), intent(in) :: text

    if (self%verbosity >= normal) call put_line(text)
  end subroutine monitor_say

  !> Write a warning.
  subroutine monitor_warn(self, text)
    !> The monitor.
    class(monitor_t), intent(in) :: self
    !> What to warn of.
    character(*), intent(in) :: text
    type(error_t), allocatable :: ignored

    call self%clear_line()
    ! Whether it fails is asked at the end of the program.
    call finish_output(ignored)
    write (error_unit, '(a)') coloured('warning: '//text, standard_error)
  end subroutine monitor_warn

  !> Take the progress line off the terminal, so that the next text stands alone.
  subroutine monitor_clear_line(self)
    !> The monitor.
    class(monitor_t), intent(in) :: self

    if (self%shows_progress) call put_now(start_of_line//erase_line)
  end subroutine monitor_clear_line

  !> Seconds since the start of the loop.
  function monitor_elapsed(self) result(seconds)
    !> The monitor.
    class(monitor_t), intent(in) :: self
    !> Wall time. [s]
    real(wp) :: seconds
    integer(lp) :: now, rate

    call system_clock(now, rate)
    seconds = max(real(now - self%clock_start, wp)/real(rate, wp), tiny(1.0_wp))
  end function monitor_elapsed

  !> a/b, 0 when both are 0.
  pure function relative(a, b) result(ratio)
    !> Numerator.
    real(wp), intent(in) :: a
    !> Denominator.
    real(wp), intent(in) :: b
    !> Their ratio.
    real(wp) :: ratio

    ratio = 0.0_wp
    if (b > 0.0_wp) ratio = a/b
  end function relative

  !> A vector as `(1, 2)`.
  pure function vector_text(vector) result(text)
    !> Its components.
    real(wp), intent(in) :: vector(:)
    !> The text.
    character(:), allocatable :: text
    integer :: i

    text = '('
    do i = 1, size(vector)
      if (i > 1) text = text//', '
      text = text//to_text(vector(i))
    end do
    text = text//')'
  end function vector_text

end module mpm_monitor
