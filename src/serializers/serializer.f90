!> The role `serializer`: when frames are due and how they are written.
module mpm_serializer
  use mpm_configurable, only: configurable_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_files, only: make_directories
  use mpm_history, only: add_history_properties, history_t
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_run_file, only: name_as_file, write_run_file
  use mpm_store, only: store_t
  implicit none
  private
  public :: add_save_properties, serializer_ask, serializer_name_run, serializer_restore, &
            serializer_save, serializer_t

  !> A writer of frames.
  type, abstract, extends(configurable_t) :: serializer_t
    !> Frames per unit of time; 0 writes the first only. [1/s]
    real(wp) :: rate = 0.0_wp
    !> Frames written so far, which is the number of the next one.
    integer :: frames = 0
    !> Bytes written so far.
    integer(lp) :: bytes = 0
    !> Frames that a run at the present rate would have written beyond `frames`, when the rate was
    !! changed at a restart.
    integer :: skipped = 0
    !> Text of the config, for files that tell how they came about.
    character(:), allocatable :: config_text
    !> Program, config and points, for the same.
    character(:), allocatable :: run
    !> Folder of frames.
    character(:), allocatable :: frame_folder
    !> Folder of checkpoints; empty for none.
    character(:), allocatable :: save_folder
    !> Start of their names.
    character(:), allocatable :: save_name
    !> Wall time between two checkpoints; 0 for none by wall time. [s]
    real(wp) :: save_wall = 0.0_wp
    !> Simulated time between two checkpoints; 0 for none by simulated time. [s]
    real(wp) :: save_time = 0.0_wp
    !> Save at the stop time.
    logical :: save_at_end = .false.
    !> Save when a signal asks to stop or to save.
    logical :: save_on_signal = .true.
    !> Rows of sums over the bodies, at a rate of their own.
    type(history_t) :: history
    !> Rate of the run that was saved. [1/s]
    real(wp), private :: saved_rate = 0.0_wp
  contains
    !> Set up from the properties; nothing is written.
    procedure(init_i), deferred :: init
    !> Make points keep what frames need.
    procedure :: ask => serializer_ask
    !> Refuse a model whose frames would be too large; nothing is written.
    procedure :: check => serializer_check
    !> Make the folder of the frames.
    procedure(open_i), deferred :: open
    !> Say beside the frames how they come about.
    procedure :: name_run => serializer_name_run
    !> Write the state as the next frame.
    procedure(write_frame_i), deferred :: write_frame
    !> Whether there is a folder for checkpoints.
    procedure :: can_save => serializer_can_save
    !> Take when to save from the properties.
    procedure :: init_saving => serializer_init_saving
    !> Where the frames go, for people.
    procedure(destination_i), deferred :: destination
    !> Whether a frame is due at a time.
    procedure :: due => serializer_due
    !> End of the run, whether it went well or not.
    procedure :: finish => serializer_finish
    !> Time of the next frame.
    procedure :: next_time => serializer_next_time
    procedure :: save => serializer_save
    procedure :: restore => serializer_restore
    !> Go on at a rate that was changed.
    procedure :: resume => serializer_resume
  end type serializer_t

  abstract interface
    !> Set up from the properties; nothing is written.
    subroutine init_i(self, properties, error)
      import :: error_t, properties_t, serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(inout) :: self
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Make the folder of the frames and whatever else writing needs.
    subroutine open_i(self, model, error)
      import :: error_t, model_t, serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(inout) :: self
      !> The model at its start.
      type(model_t), intent(inout) :: model
      !> The folder can't be made or written to.
      type(error_t), allocatable, intent(out) :: error
    end subroutine open_i

    !> Write the state as the next frame.
    subroutine write_frame_i(self, model, error)
      import :: error_t, model_t, serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(inout) :: self
      !> The state.
      type(model_t), intent(in) :: model
      !> Writing failed; earlier frames are whole.
      type(error_t), allocatable, intent(out) :: error
    end subroutine write_frame_i

    !> Where the frames go.
    function destination_i(self) result(text)
      import :: serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(in) :: self
      !> A folder or file.
      character(:), allocatable :: text
    end function destination_i
  end interface

contains

  !> Add the properties that say when and where to save.
  subroutine add_save_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_real('save_wall', 's', 'wall time between two checkpoints; 0: none by &
                              &wall time', default=0.0_wp, lower=0.0_wp)
    call description%add_real('save_time', 's', 'simulated time between two checkpoints, written &
                              &at the end of the step that reaches it; 0: none by simulated time', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_integer('save_at_end', '1: write a checkpoint at the stop time', &
                                 default=0, lower=0, upper=1)
    call description%add_integer('save_on_signal', '1: write a checkpoint upon SIGINT, SIGTERM &
                                 &(which end the run) and SIGUSR1 (which does not)', default=1, &
                                 lower=0, upper=1)
    call description%add_note('Checkpoints are <save_folder>/<run_name>.<step>.h5; the last two &
                              &are kept. mpm3d -r FILE goes on from one.')
    call add_history_properties(description)
  end subroutine add_save_properties

  !> Take when and where to save from the properties.
  subroutine serializer_init_saving(self, properties)
    !> The serializer.
    class(serializer_t), intent(inout) :: self
    !> Checked properties, those of `add_save_properties`, `frame_folder`, `save_folder` and
    !! `run_name` among them.
    type(properties_t), intent(in) :: properties

    self%frame_folder = properties%string('frame_folder')
    self%save_folder = properties%string('save_folder')
    self%save_name = name_as_file(properties%string('run_name'))
    self%save_wall = properties%real('save_wall')
    self%save_time = properties%real('save_time')
    self%save_at_end = properties%integer('save_at_end') == 1
    self%save_on_signal = properties%integer('save_on_signal') == 1
    call self%history%init(properties, self%frame_folder, self%save_name)
  end subroutine serializer_init_saving

  !> Say beside the frames, and beside the corners of domains, how they come about.
  !!
  !! Public since a class that overrides it can't call it by the name of an abstract parent.
  subroutine serializer_name_run(self, model, goes_on, error)
    !> The serializer, opened.
    class(serializer_t), intent(in) :: self
    !> The model at its start, or restored.
    type(model_t), intent(in) :: model
    !> Whether the run goes on from a checkpoint.
    logical, intent(in) :: goes_on
    !> It can't be written.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    if (.not. (allocated(self%run) .and. allocated(self%frame_folder))) return
    call make_directories(self%frame_folder, error)
    if (allocated(error)) return
    call write_run_file(self%frame_folder, self%save_name, self%run, goes_on, self%frames, error)
    do i = 1, size(model%bodies)
      if (allocated(error)) return
      associate (body => model%bodies(i)%body)
        if (.not. allocated(body%points)) cycle
        if (.not. allocated(body%points%domains)) cycle
        if (.not. allocated(body%points%domains%folder)) cycle
        call write_run_file(body%points%domains%folder, self%save_name, self%run, goes_on, &
                            self%frames, error)
      end associate
    end do
  end subroutine serializer_name_run

  !> Whether there is a folder for checkpoints.
  pure function serializer_can_save(self) result(can_save)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> False when the config names none.
    logical :: can_save

    can_save = allocated(self%save_folder)
    if (can_save) can_save = len_trim(self%save_folder) > 0
  end function serializer_can_save

  !> Frames of all fields need the velocity gradients of the steps that end with a frame.
  subroutine serializer_ask(self, points)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> Points of a body, started.
    class(points_t), intent(inout) :: points

    associate (unused => self)
    end associate
    if (allocated(points%gradient)) return
    allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
  end subroutine serializer_ask

  !> Most serializers take any model.
  subroutine serializer_check(self, model, error)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> Frames that are too large.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self, unused_model => model)
    end associate
  end subroutine serializer_check

  !> Whether a frame is due at a time: t - t_start >= k / rate for the next frame k.
  pure function serializer_due(self, model, time) result(due)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> The model at the start of the step that ends at the time.
    type(model_t), intent(in) :: model
    !> The time in question. [s]
    real(wp), intent(in) :: time
    !> Whether a frame is due.
    logical :: due
    real(wp) :: slack

    due = self%frames == 0
    if (due .or. .not. self%rate > 0.0_wp) return
    ! A frame time that a step reaches up to rounding must not wait for the next step.
    slack = 1.0e-6_wp*min(model%dt, time - model%time)
    due = time - model%t_start >= real(self%frames + self%skipped, wp)/self%rate - slack
  end function serializer_due

  !> Most serializers have nothing to clear away.
  subroutine serializer_finish(self, model)
    !> The serializer.
    class(serializer_t), intent(inout) :: self
    !> The model at its end.
    type(model_t), intent(in) :: model

    associate (unused => self, unused_model => model)
    end associate
  end subroutine serializer_finish

  !> Time of the next frame, for a rate above 0.
  pure function serializer_next_time(self, model) result(time)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The time. [s]
    real(wp) :: time

    time = model%t_start + real(self%frames + self%skipped, wp)/self%rate
  end function serializer_next_time

  !> Save what is known of the frames so far.
  !!
  !! Public since a class that overrides it can't call it by the name of an abstract parent.
  subroutine serializer_save(self, store)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call store%put('rate', self%rate)
    call store%put('frames', self%frames)
    call store%put('skipped', self%skipped)
    call store%put('bytes', self%bytes)
    call self%history%save(store)
  end subroutine serializer_save

  !> Take back what is known of the frames so far.
  subroutine serializer_restore(self, store)
    !> The serializer.
    class(serializer_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call store%get('rate', self%saved_rate)
    call store%get('frames', self%frames)
    call store%get('skipped', self%skipped)
    call store%get('bytes', self%bytes)
    call self%history%restore(store)
  end subroutine serializer_restore

  !> Go on at a rate that was changed: with the first frame that is due after the present time.
  subroutine serializer_resume(self, model)
    !> The serializer, restored.
    class(serializer_t), intent(inout) :: self
    !> The model, restored.
    type(model_t), intent(in) :: model
    real(wp) :: passed

    if (.not. self%rate > 0.0_wp .or. .not. abs(self%rate - self%saved_rate) > 0.0_wp) return
    passed = (model%time - model%t_start)*self%rate + 1.0e-6_wp
    self%skipped = int(min(passed, 1.0e9_wp)) + 1 - self%frames
  end subroutine serializer_resume

end module mpm_serializer
