!> Steps as long as stability allows, which end at the times of frames.
module mpm_adaptive_driver
  use mpm_description, only: description_t
  use mpm_errors, only: err_simulation, error_t, raise
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  use mpm_store, only: store_t
  use mpm_strings, only: to_text
  use mpm_threads, only: useful_threads
  use mpm_user_defined_gravity_driver, only: add_gravity_properties, user_defined_gravity_driver_t
  implicit none
  private
  public :: adaptive_driver_t

  !> A constant body force; each step is chosen anew from wave speeds and point speeds.
  type, extends(user_defined_gravity_driver_t) :: adaptive_driver_t
    !> Step over the stable step.
    real(wp) :: fraction = 0.5_wp
    !> Largest ratio of two successive steps.
    real(wp) :: growth = 1.05_wp
    !> Length of the last step before it was shortened to meet a time; 0 before the first. [s]
    real(wp), private :: chosen = 0.0_wp
  contains
    procedure, nopass :: describe => adaptive_driver_describe
    procedure :: init => adaptive_driver_init
    procedure :: next_step => adaptive_driver_next_step
    procedure :: plan => adaptive_driver_plan
    procedure :: save => adaptive_driver_save
    procedure :: restore => adaptive_driver_restore
    !> Longest step that the state allows.
    procedure :: longest_step => adaptive_driver_longest_step
  end type adaptive_driver_t

contains

  !> Purpose and properties of the class.
  subroutine adaptive_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'AdaptiveDriver', &
                          'As UserDefinedGravityDriver, with steps that follow the stable step of &
                          &the solver, and frames at exactly the times that are asked for.', &
                          'Courant, Friedrichs and Lewy, Math. Ann. 100 (1928) 32-74', &
                          'driver'//nl//'{'//nl//'    class = "AdaptiveDriver"'//nl// &
                          '    properties = {1, 0, -9.81, cfl = 0.5}   # t_stop, gx, gy'//nl//'}')
    call add_gravity_properties(description)
    call description%add_real('cfl', '-', 'step over the stable step', default=0.5_wp, &
                              above=0.0_wp, upper=1.0_wp)
    call description%add_real('growth', '-', 'a step is at most this times the one before', &
                              default=1.05_wp, above=1.0_wp)
    call description%add_note('Each step is cfl/max(1/s + |v_d|/h_d) over all bodies, with the &
                              &stable step s of the body, the components of the speeds of its &
                              &points and the spacing of the grid; and never above dt of the job.')
    call description%add_note('Steps are shortened, by half at most, to end at the time of each &
                              &frame and at the stop time. A rate of frames above 1/dt makes steps &
                              &of 1/rate.')
  end subroutine adaptive_driver_describe

  !> Set up from the properties.
  subroutine adaptive_driver_init(self, properties, error)
    !> The driver.
    class(adaptive_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error

    call self%user_defined_gravity_driver_t%init(properties, error)
    self%fraction = properties%real('cfl')
    self%growth = properties%real('growth')
  end subroutine adaptive_driver_init

  !> Choose the next step, or end the run.
  subroutine adaptive_driver_next_step(self, model, solver, serializer, dt, t_next, error)
    !> The driver.
    class(adaptive_driver_t), intent(inout) :: self
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
    !> The step is too short to go on with.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: longest, frame_time

    dt = 0.0_wp
    t_next = model%time
    if (model%time >= self%t_stop) return
    longest = self%longest_step(model, solver)
    if (self%chosen > 0.0_wp) longest = min(longest, self%growth*self%chosen)
    self%chosen = longest
    t_next = self%t_stop
    if (serializer%rate > 0.0_wp) then
      frame_time = serializer%next_time(model)
      ! A frame time that is the stop time up to rounding needs no sliver of a step behind it.
      if (frame_time < self%t_stop - 1.0e-6_wp*longest) t_next = frame_time
    end if
    call divide(model%time, longest, dt, t_next)
    if (model%time + dt > model%time) return
    call raise(error, err_simulation, 'a step of '//to_text(dt)//' s does not advance t = '// &
               to_text(model%time)//' s', hint='wave speeds or point speeds, or the rate of the &
               &frames, have become too large')
  end subroutine adaptive_driver_next_step

  !> The first of equal steps to a time, or of steps of the largest length.
  pure subroutine divide(time, longest, dt, t_next)
    !> Time at the start of the step. [s]
    real(wp), intent(in) :: time
    !> Largest length. [s]
    real(wp), intent(in) :: longest
    !> Length of the step. [s]
    real(wp), intent(out) :: dt
    !> On entry the time to meet, on exit that at the end of the step. [s]
    real(wp), intent(inout) :: t_next

    dt = t_next - time
    ! No step for a rest that is a rounding error of the times.
    if (dt <= longest + 8.0_wp*spacing(max(abs(time), abs(t_next)))) return
    ! Two halves rather than a whole step and a sliver.
    dt = min(longest, 0.5_wp*dt)
    t_next = time + dt
  end subroutine divide

  !> Longest step that the state allows, at most dt of the job.
  function adaptive_driver_longest_step(self, model, solver) result(dt)
    !> The driver.
    class(adaptive_driver_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The solver.
    class(solver_t), intent(in) :: solver
    !> The step. [s]
    real(wp) :: dt
    real(wp) :: h(3), speed, limit, rate
    integer :: i

    h = model%grid%spacing()
    dt = model%dt
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        rate = crossing_rate(model%kin%dim, model%kin%nvel, body%points%n_inside, model%threads, &
                             h, body%points%velocity)
        call solver%stable_step(model, i, speed, limit)
        if (limit < huge(1.0_wp)) rate = rate + 1.0_wp/limit
        if (rate*dt > self%fraction) dt = self%fraction/rate
      end associate
    end do
  end function adaptive_driver_longest_step

  !> Largest number of cells that a point crosses in a unit of time along one direction.
  function crossing_rate(dim, nvel, n, threads, h, velocity) result(rate)
    !> Dimensions of the grid.
    integer, intent(in) :: dim
    !> Components of a velocity.
    integer, intent(in) :: nvel
    !> Number of points.
    integer, intent(in) :: n
    !> Number of threads.
    integer, intent(in) :: threads
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: h(3)
    !> Velocities. [m/s] (nvel, n)
    real(wp), intent(in) :: velocity(nvel, n)
    !> Largest |v_d|/h_d. [1/s]
    real(wp) :: rate
    real(wp) :: fastest(3)
    integer :: p, d

    fastest = 0.0_wp
    !$omp parallel do default(none) schedule(static) shared(dim, n, velocity) private(p, d) &
    !$omp num_threads(useful_threads(threads, n)) reduction(max:fastest)
    do p = 1, n
      do d = 1, dim
        fastest(d) = max(fastest(d), abs(velocity(d, p)))
      end do
    end do
    !$omp end parallel do
    rate = maxval(fastest(:dim)/h(:dim))
  end function crossing_rate

  !> Number of steps of the length that the start allows.
  subroutine adaptive_driver_plan(self, model, solver, steps, exact)
    !> The driver.
    class(adaptive_driver_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> The solver, started, for its stable steps.
    class(solver_t), intent(in) :: solver
    !> Number of steps, at least 0.
    integer(lp), intent(out) :: steps
    !> False.
    logical, intent(out) :: exact
    real(wp) :: number

    number = (self%t_stop - model%t_start)/self%longest_step(model, solver)
    steps = ceiling(max(0.0_wp, min(number - 1.0e-6_wp, real(huge(1), wp))), lp)
    exact = .false.
  end subroutine adaptive_driver_plan

  !> Save the length of the last step.
  subroutine adaptive_driver_save(self, store)
    !> The driver.
    class(adaptive_driver_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call store%put('chosen', self%chosen)
  end subroutine adaptive_driver_save

  !> Take back the length of the last step.
  subroutine adaptive_driver_restore(self, store)
    !> The driver.
    class(adaptive_driver_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call store%get('chosen', self%chosen)
  end subroutine adaptive_driver_restore

end module mpm_adaptive_driver
