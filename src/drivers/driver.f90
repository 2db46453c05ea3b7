!> The role `driver`: the loop over time.
module mpm_driver
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_keeper, only: keeper_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t, type_1d, type_3d
  use mpm_model, only: model_t
  use mpm_monitor, only: monitor_t
  use mpm_phase_clock, only: phase_other, phase_output
  use mpm_properties, only: properties_t
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  implicit none
  private
  public :: driver_t, standard_gravity

  !> A loop over time with a body force.
  type, abstract, extends(configurable_t) :: driver_t
    !> Stop time. [s]
    real(wp) :: t_stop = 0.0_wp
  contains
    !> Set up from the properties.
    procedure(init_i), deferred :: init
    !> Acceleration by the body force.
    procedure(body_force_i), deferred :: body_force
    !> Prepare the model when everything is set up.
    procedure :: prepare => driver_prepare
    !> Look at the model when the solver has started.
    procedure :: after_start => driver_after_start
    !> Act on the model before a step.
    procedure :: before_step => driver_before_step
    !> A frame has been written.
    procedure :: at_frame => driver_at_frame
    !> Run from the start time to the stop time.
    procedure, non_overridable :: run => driver_run
    !> Choose the next step, or end the run.
    procedure :: next_step => driver_next_step
    !> Number of steps of the whole run, and whether it is known before the run.
    procedure :: plan => driver_plan
    !> Number of steps when all have the configured length.
    procedure, non_overridable :: step_count => driver_step_count
  end type driver_t

  abstract interface
    !> Set up from the properties.
    subroutine init_i(self, properties, error)
      import :: driver_t, error_t, properties_t
      implicit none
      !> The driver.
      class(driver_t), intent(inout) :: self
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Acceleration by the body force.
    pure function body_force_i(self, kin) result(b)
      import :: driver_t, kinematics_t, wp
      implicit none
      !> The driver.
      class(driver_t), intent(in) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Acceleration, components beyond nvel 0. [m/s2]
      real(wp) :: b(3)
    end function body_force_i
  end interface

contains

  !> 9.81 m/s2 downwards: along -x in TYPE 1, -z in TYPE 3, -y (TYPE 4: the height) otherwise.
  pure function standard_gravity(kin) result(b)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    b = 0.0_wp
    select case (kin%sim_type)
    case (type_1d)
      b(1) = -9.81_wp
    case (type_3d)
      b(3) = -9.81_wp
    case default
      b(2) = -9.81_wp
    end select
  end function standard_gravity

  !> Most drivers have nothing to prepare.
  subroutine driver_prepare(self, model, error)
    !> The driver.
    class(driver_t), intent(inout) :: self
    !> The model, set up and not yet mapped.
    type(model_t), intent(inout) :: model
    !> The model does not have what the driver needs.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self, unused_model => model)
    end associate
  end subroutine driver_prepare

  !> Most drivers have nothing to keep of the start.
  subroutine driver_after_start(self, model)
    !> The driver.
    class(driver_t), intent(inout) :: self
    !> The model at its start, mapped to its nodes.
    type(model_t), intent(in) :: model

    associate (unused => self, unused_model => model)
    end associate
  end subroutine driver_after_start

  !> Most drivers do nothing before a step.
  subroutine driver_before_step(self, model)
    !> The driver.
    class(driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(inout) :: model

    associate (unused => self, unused_model => model)
    end associate
  end subroutine driver_before_step

  !> Most drivers do nothing with a frame.
  subroutine driver_at_frame(self, model, error)
    !> The driver.
    class(driver_t), intent(inout) :: self
    !> The state of the frame.
    type(model_t), intent(in) :: model
    !> What the driver writes can't be written.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self, unused_model => model)
    end associate
  end subroutine driver_at_frame

  !> Choose the next step, or end the run: here a step of the configured length.
  !!
  !! Called before `before_step`. The last step is shortened to end at the stop time.
  subroutine driver_next_step(self, model, solver, serializer, dt, t_next, error)
    !> The driver.
    class(driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(in) :: model
    !> The solver, for its stable steps.
    class(solver_t), intent(in) :: solver
    !> The serializer, for the time of the next frame.
    class(serializer_t), intent(in) :: serializer
    !> Length of the step; 0 when the run has reached its end. [s]
    real(wp), intent(out) :: dt
    !> Time at the end of the step. [s]
    real(wp), intent(out) :: t_next
    !> There is no step to go on with.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: steps

    associate (unused => solver, unused_serializer => serializer)
    end associate
    steps = self%step_count(model)
    t_next = model%time
    dt = 0.0_wp
    if (model%step >= steps) return
    t_next = model%t_start + model%t_counted + &
             real(model%step + 1 - model%step_counted, wp)*model%dt
    dt = model%dt
    if (model%step + 1 == steps) then
      t_next = self%t_stop
      dt = t_next - model%time
    end if
  end subroutine driver_next_step

  !> Number of steps of the whole run, and whether it is known before the run.
  subroutine driver_plan(self, model, solver, steps, exact)
    !> The driver.
    class(driver_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> The solver, started, for its stable steps.
    class(solver_t), intent(in) :: solver
    !> Number of steps, at least 0.
    integer(lp), intent(out) :: steps
    !> Whether it is no estimate, since dt is kept as it is configured.
    logical, intent(out) :: exact

    associate (unused => solver)
    end associate
    steps = self%step_count(model)
    exact = .true.
  end subroutine driver_plan

  !> Number of steps from the start to the stop time; the last one may be shorter.
  pure function driver_step_count(self, model) result(steps)
    !> The driver.
    class(driver_t), intent(in) :: self
    !> The model, for its start time and time step.
    type(model_t), intent(in) :: model
    !> Number of steps, at least 0.
    integer(lp) :: steps
    real(wp) :: exact

    exact = (self%t_stop - model%t_start - model%t_counted)/model%dt
    ! A span that is a multiple of dt up to rounding needs no sliver of a step at its end.
    steps = model%step_counted + max(0_lp, ceiling(exact - 1.0e-6_wp, lp))
  end function driver_step_count

  !> Run from the start time to the stop time.
  subroutine driver_run(self, model, solver, serializer, monitor, error, keeper)
    !> The driver.
    class(driver_t), intent(inout) :: self
    !> The model, prepared.
    type(model_t), intent(inout) :: model
    !> The solver, started.
    class(solver_t), intent(inout) :: solver
    !> The serializer, opened.
    class(serializer_t), intent(inout) :: serializer
    !> What is told of the run.
    class(monitor_t), intent(inout) :: monitor
    !> The simulation went bad, or a frame can't be written.
    type(error_t), allocatable, intent(out) :: error
    !> What looks after the run between its steps.
    class(keeper_t), intent(inout), optional :: keeper
    integer(lp) :: steps
    real(wp) :: dt, t_next
    logical :: frame, exact

    call self%plan(model, solver, steps, exact)
    call monitor%begin(model, solver, steps, exact)
    if (serializer%frames == 0) then
      call model%clock%enter(phase_output)
      call serializer%write_frame(model, error)
      if (.not. allocated(error)) call self%at_frame(model, error)
      if (allocated(error)) return
      call monitor%frame(model, serializer%frames)
    end if
    call model%clock%enter(phase_other)
    do
      call self%next_step(model, solver, serializer, dt, t_next, error)
      if (allocated(error)) exit
      if (.not. dt > 0.0_wp) exit
      call self%before_step(model)
      frame = serializer%due(model, t_next)
      call solver%step(model, dt, frame, error)
      if (allocated(error)) exit
      call model%clock%enter(phase_other)
      model%step = model%step + 1
      model%time = t_next
      model%last_dt = dt
      if (frame) then
        call model%clock%enter(phase_output)
        call monitor%check(model, solver)
        call serializer%write_frame(model, error)
        if (.not. allocated(error)) call self%at_frame(model, error)
        if (allocated(error)) exit
        call monitor%frame(model, serializer%frames)
        call model%clock%enter(phase_other)
      end if
      if (serializer%history%is_on()) then
        call model%clock%enter(phase_output)
        call serializer%history%advance(model, error)
        if (allocated(error)) exit
        call model%clock%enter(phase_other)
      end if
      call monitor%progress(model, self%t_stop, serializer%frames)
      if (.not. present(keeper)) cycle
      call keeper%look(model, self, solver, serializer, monitor, .false., error)
      if (allocated(error)) exit
    end do
    if (present(keeper) .and. .not. allocated(error)) then
      call keeper%look(model, self, solver, serializer, monitor, .true., error)
    end if
    call model%clock%enter(phase_other)
    if (allocated(error)) then
      call monitor%clear_line()
    else
      call monitor%finish(model, serializer)
    end if
  end subroutine driver_run

end module mpm_driver
