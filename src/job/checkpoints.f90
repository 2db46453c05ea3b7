!> When a run is saved, and where to.
module mpm_checkpoints
  use mpm_build_info, only: compiler, revision, version
  use mpm_checkpoint_file, only: can_checkpoint, checkpoint_file_t
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_file_system, only: delete_leftovers, matching_files
  use mpm_files, only: delete_file, join_path, make_directories
  use mpm_keeper, only: keeper_t
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_monitor, only: monitor_t
  use mpm_run_text, only: run_text
  use mpm_serializer, only: serializer_t
  use mpm_signals, only: save_was_asked, signal_name, stop_signal
  use mpm_solver, only: solver_t
  use mpm_state, only: save_state
  use mpm_strings, only: string_t, to_text
  implicit none
  private
  public :: checkpoints_t

  !> Saves a run when it is time for it, or when a signal asks for it.
  type, extends(keeper_t) :: checkpoints_t
    !> The config.
    character(:), allocatable :: config
    !> Its text.
    character(:), allocatable :: text
    !> What `--set` says.
    type(string_t), allocatable :: overrides(:)
    !> Clock count when the run was last saved, or when it began.
    integer(lp), private :: clock_saved = 0
    !> Step that was saved last; negative for none.
    integer(lp), private :: step_saved = -1
    !> Number of the next save by simulated time.
    integer(lp), private :: next = 1
  contains
    !> Make ready for the start of a run.
    procedure :: begin => checkpoints_begin
    procedure :: look => checkpoints_look
    !> Save the run.
    procedure, private :: write => checkpoints_write
  end type checkpoints_t

contains

  !> Make ready for the start of a run.
  subroutine checkpoints_begin(self, model, serializer, error)
    !> The keeper.
    class(checkpoints_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> The serializer.
    class(serializer_t), intent(in) :: serializer
    !> Checkpoints are asked for that can't be written.
    type(error_t), allocatable, intent(out) :: error

    call system_clock(self%clock_saved)
    self%next = passed(model, serializer%save_time) + 1
    if (.not. can_checkpoint) then
      if (serializer%save_wall > 0.0_wp .or. serializer%save_time > 0.0_wp .or. &
          serializer%save_at_end) then
        call raise(error, err_input, 'checkpoints need HDF5, which this mpm3d was built without', &
                   file=self%config, hint='build it with -DMPM3D_HDF5=ON, or leave out save_wall, &
                   &save_time and save_at_end')
      end if
    else if (serializer%can_save()) then
      call delete_leftovers(serializer%save_folder, serializer%save_name//'.')
    end if
  end subroutine checkpoints_begin

  !> Save the run when it is time for it; end it when a signal asks for that.
  subroutine checkpoints_look(self, model, driver, solver, serializer, monitor, at_end, error)
    !> The keeper.
    class(checkpoints_t), intent(inout) :: self
    !> The model at the end of the step.
    type(model_t), intent(in) :: model
    !> The loop over time.
    class(configurable_t), intent(in) :: driver
    !> The solver.
    class(solver_t), intent(in) :: solver
    !> The serializer.
    class(serializer_t), intent(in) :: serializer
    !> What is told of the run.
    class(monitor_t), intent(inout) :: monitor
    !> Whether the run has reached its stop time.
    logical, intent(in) :: at_end
    !> The run has to end here.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path, hint
    integer(lp) :: now, rate
    integer :: signal
    logical :: wanted

    signal = stop_signal()
    wanted = save_was_asked()
    wanted = (wanted .or. signal > 0) .and. serializer%save_on_signal
    if (at_end) wanted = wanted .or. serializer%save_at_end
    if (serializer%save_time > 0.0_wp .and. .not. at_end) then
      now = passed(model, serializer%save_time)
      if (now >= self%next) then
        self%next = now + 1
        wanted = .true.
      end if
    end if
    if (serializer%save_wall > 0.0_wp .and. .not. at_end) then
      call system_clock(now, rate)
      if (real(now - self%clock_saved, wp) >= serializer%save_wall*real(rate, wp)) wanted = .true.
    end if
    wanted = wanted .and. can_checkpoint .and. serializer%can_save()
    hint = 'nothing was saved: serializer has no save_folder, or save_on_signal = 0'
    if (.not. can_checkpoint) hint = 'nothing was saved: this mpm3d was built without HDF5'
    if (wanted) then
      path = join_path(serializer%save_folder, serializer%save_name//'.'//padded(model%step)//'.h5')
      if (model%step /= self%step_saved) then
        call self%write(path, model, driver, solver, serializer, monitor, error)
        if (allocated(error)) return
      end if
      hint = 'mpm3d -r '//path//' goes on from there'
    end if
    if (signal == 0 .or. at_end) return
    call raise(error, 128 + signal, 'stopped by '//signal_name(signal)//' at t = '// &
               to_text(model%time)//' s, step '//to_text(model%step), hint=hint)
  end subroutine checkpoints_look

  !> Save the run, and delete the checkpoints before the last one.
  subroutine checkpoints_write(self, path, model, driver, solver, serializer, monitor, error)
    !> The keeper.
    class(checkpoints_t), intent(inout) :: self
    !> The file.
    character(*), intent(in) :: path
    !> The model.
    type(model_t), intent(in) :: model
    !> The loop over time.
    class(configurable_t), intent(in) :: driver
    !> The solver.
    class(solver_t), intent(in) :: solver
    !> The serializer.
    class(serializer_t), intent(in) :: serializer
    !> What is told of the run.
    class(monitor_t), intent(inout) :: monitor
    !> The checkpoint can't be written; earlier ones are whole.
    type(error_t), allocatable, intent(out) :: error
    type(checkpoint_file_t), allocatable :: file
    integer :: i

    call make_directories(serializer%save_folder, error)
    if (allocated(error)) return
    allocate (file)
    call file%begin(path)
    call file%put('program', 'mpm3d '//version//' ('//revision//', '//compiler//')')
    call file%put('run', run_text(model, self%text, self%overrides))
    call file%put('config', self%config)
    call file%put('text', self%text)
    call file%put('overrides', size(self%overrides))
    do i = 1, size(self%overrides)
      call file%put('override_'//to_text(i), self%overrides(i)%text)
    end do
    call save_state(file, model, driver, solver, serializer, monitor)
    call file%commit(error)
    if (allocated(error)) return
    call system_clock(self%clock_saved)
    self%step_saved = model%step
    call monitor%clear_line()
    call monitor%say('saved '//path)
    call prune(serializer%save_folder, serializer%save_name, path)
  end subroutine checkpoints_write

  !> Of the checkpoints of earlier steps, keep the last one.
  subroutine prune(folder, name, path)
    !> The folder.
    character(*), intent(in) :: folder
    !> Start of the names.
    character(*), intent(in) :: name
    !> The checkpoint that was just written.
    character(*), intent(in) :: path
    type(string_t), allocatable :: paths(:)
    type(error_t), allocatable :: ignored
    integer :: i, newer, start

    call matching_files(folder, name//'.', '.h5', paths)
    newer = 0
    start = len(path) - len(padded(0_lp)) - 2
    do i = size(paths), 1, -1
      associate (other => paths(i)%text)
        if (len(other) /= len(path)) cycle
        if (verify(other(start:len(path) - 3), '0123456789') > 0) cycle
        if (other >= path) cycle
        newer = newer + 1
        if (newer > 1) call delete_file(other, ignored)
      end associate
    end do
  end subroutine prune

  !> A step as text whose order is that of the steps.
  pure function padded(step) result(text)
    !> The step.
    integer(lp), intent(in) :: step
    !> Twelve digits, or as many as it takes.
    character(:), allocatable :: text

    text = to_text(step)
    text = repeat('0', max(0, 12 - len(text)))//text
  end function padded

  !> How often an interval of simulated time has passed.
  pure function passed(model, interval) result(times)
    !> The model.
    type(model_t), intent(in) :: model
    !> The interval; 0 for never. [s]
    real(wp), intent(in) :: interval
    !> Whole intervals since the start.
    integer(lp) :: times

    times = 0
    if (.not. interval > 0.0_wp) return
    ! A time that a step reaches up to rounding counts.
    times = int(min(1.0e18_wp, (model%time - model%t_start + 1.0e-6_wp*model%dt)/interval), lp)
  end function passed

end module mpm_checkpoints
