!> Loads that come slowly, and damping of the motion that they leave.
module mpm_quasi_static_driver
  use mpm_adaptive_driver, only: adaptive_driver_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  use mpm_store, only: store_t
  use mpm_threads, only: useful_threads
  use mpm_user_defined_gravity_driver, only: add_gravity_properties
  implicit none
  private
  public :: quasi_static_driver_t

  !> Points whose kinetic energy is summed up together.
  integer, parameter :: part_size = 4096

  !> A body force that grows to its full value, with viscous and kinetic damping.
  type, extends(adaptive_driver_t) :: quasi_static_driver_t
    !> Time in which the body force grows. [s]
    real(wp) :: t_ramp = 0.0_wp
    !> Acceleration against the velocity, over the velocity. [1/s]
    real(wp) :: viscous = 0.0_wp
    !> Bring all points to rest when their kinetic energy has passed a maximum.
    logical :: kinetic = .false.
    !> Length of the step to come. [s]
    real(wp), private :: dt = 0.0_wp
    !> Kinetic energy before the last step; 0 after a stop. [J]
    real(wp), private :: energy = 0.0_wp
  contains
    procedure, nopass :: describe => quasi_static_driver_describe
    procedure :: init => quasi_static_driver_init
    procedure :: prepare => quasi_static_driver_prepare
    procedure :: plan => quasi_static_driver_plan
    procedure :: next_step => quasi_static_driver_next_step
    procedure :: before_step => quasi_static_driver_before_step
    procedure :: save => quasi_static_driver_save
    procedure :: restore => quasi_static_driver_restore
  end type quasi_static_driver_t

contains

  !> Purpose and properties of the class.
  subroutine quasi_static_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'QuasiStaticDriver', &
                          'As UserDefinedGravityDriver, for loads in equilibrium: the body force &
                          &grows slowly, and viscous or kinetic damping takes the motion away.', &
                          'Day, The Engineer 219 (1965) 218-221; Barnes, Int. J. Space Structures &
                          &14 (1999) 89-104', &
                          'driver'//nl//'{'//nl//'    class = "QuasiStaticDriver"'//nl// &
                          '    properties = {1, 0, -9.81, t_ramp = 0.2, viscous = 10}'//nl//'}')
    call add_gravity_properties(description)
    call description%add_real('t_ramp', 's', 'time in which the body force grows from 0 to its &
                              &full value, as 3 s^2 - 2 s^3', default=0.0_wp, lower=0.0_wp)
    call description%add_real('viscous', '1/s', 'viscous damping: acceleration against the &
                              &velocity, over the velocity', default=0.0_wp, lower=0.0_wp)
    call description%add_real('cfl', '-', 'step over the stable step, as of AdaptiveDriver; 0: all &
                              &steps are dt of the job', default=0.0_wp, lower=0.0_wp, &
                              upper=1.0_wp)
    call description%add_real('growth', '-', 'a step is at most this times the one before, as of &
                              &AdaptiveDriver', default=1.05_wp, above=1.0_wp)
    call description%add_integer('kinetic', '1: kinetic damping, all points are brought to rest &
                                 &when their kinetic energy has passed a maximum', default=0, &
                                 lower=0, upper=1)
    call description%add_note('Viscous damping is critical for a mode of angular frequency w when &
                              &viscous = 2 w; the slowest mode is the one that takes longest. A &
                              &mode with w above viscous/2 decays as exp(-viscous t/2).')
    call description%add_note('Both take momentum away, and slow down a body that falls freely as &
                              &well.')
  end subroutine quasi_static_driver_describe

  !> Set up from the properties.
  subroutine quasi_static_driver_init(self, properties, error)
    !> The driver.
    class(quasi_static_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error

    call self%adaptive_driver_t%init(properties, error)
    self%t_ramp = properties%real('t_ramp')
    self%viscous = properties%real('viscous')
    self%kinetic = properties%integer('kinetic') == 1
  end subroutine quasi_static_driver_init

  !> Give the points the body force of the start.
  subroutine quasi_static_driver_prepare(self, model, error)
    !> The driver.
    class(quasi_static_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    call set_body_force(self, model)
  end subroutine quasi_static_driver_prepare

  !> Number of steps, known before the run when they are dt of the job.
  subroutine quasi_static_driver_plan(self, model, solver, steps, exact)
    !> The driver.
    class(quasi_static_driver_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> The solver, started.
    class(solver_t), intent(in) :: solver
    !> Number of steps, at least 0.
    integer(lp), intent(out) :: steps
    !> Whether it is no estimate.
    logical, intent(out) :: exact

    if (self%fraction > 0.0_wp) then
      call self%adaptive_driver_t%plan(model, solver, steps, exact)
    else
      call self%adaptive_driver_t%user_defined_gravity_driver_t%plan(model, solver, steps, exact)
    end if
  end subroutine quasi_static_driver_plan

  !> Choose the next step, or end the run.
  subroutine quasi_static_driver_next_step(self, model, solver, serializer, dt, t_next, error)
    !> The driver.
    class(quasi_static_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(in) :: model
    !> The solver.
    class(solver_t), intent(in) :: solver
    !> The serializer.
    class(serializer_t), intent(in) :: serializer
    !> Length of the step; 0 when the run has reached its end. [s]
    real(wp), intent(out) :: dt
    !> Time at the end of the step. [s]
    real(wp), intent(out) :: t_next
    !> The step is too short to go on with.
    type(error_t), allocatable, intent(out) :: error

    if (self%fraction > 0.0_wp) then
      call self%adaptive_driver_t%next_step(model, solver, serializer, dt, t_next, error)
    else
      call self%adaptive_driver_t%user_defined_gravity_driver_t%next_step( &
        model, solver, serializer, dt, t_next, error)
    end if
    self%dt = dt
  end subroutine quasi_static_driver_next_step

  !> Set the body force and damp the motion.
  subroutine quasi_static_driver_before_step(self, model)
    !> The driver.
    class(quasi_static_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(inout) :: model
    real(wp) :: energy, factor
    integer :: i

    call set_body_force(self, model)
    factor = exp(-self%viscous*self%dt)
    if (self%kinetic) then
      energy = 0.0_wp
      do i = 1, size(model%bodies)
        associate (points => model%bodies(i)%body%points, active => model%bodies(i)%body%active)
          if (active) energy = energy + kinetic_energy(points%kin%nvel, points%n_inside, &
                                                       model%threads, points%mass, points%velocity)
        end associate
      end do
      if (energy < self%energy) then
        factor = 0.0_wp
        energy = 0.0_wp
      end if
      self%energy = energy
    end if
    if (factor >= 1.0_wp) return
    do i = 1, size(model%bodies)
      associate (points => model%bodies(i)%body%points)
        if (model%bodies(i)%body%active) call scale(points%kin%nvel*points%n_inside, &
                                                    model%threads, factor, points%velocity)
      end associate
    end do
  end subroutine quasi_static_driver_before_step

  !> Give all points the body force of the time.
  pure subroutine set_body_force(self, model)
    !> The driver.
    class(quasi_static_driver_t), intent(in) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    real(wp) :: s
    integer :: i

    s = 1.0_wp
    if (model%time - model%t_start < self%t_ramp) s = (model%time - model%t_start)/self%t_ramp
    do i = 1, size(model%bodies)
      model%bodies(i)%body%points%body_force = s*s*(3.0_wp - 2.0_wp*s)*self%body_force(model%kin)
    end do
  end subroutine set_body_force

  !> Kinetic energy of points, summed in one order for any number of threads.
  function kinetic_energy(nvel, n, threads, mass, velocity) result(energy)
    !> Components of a velocity.
    integer, intent(in) :: nvel
    !> Number of points.
    integer, intent(in) :: n
    !> Number of threads.
    integer, intent(in) :: threads
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Velocities. [m/s] (nvel, n)
    real(wp), intent(in) :: velocity(nvel, n)
    !> Sum of m v**2/2. [J]
    real(wp) :: energy
    real(wp), allocatable :: parts(:)
    integer :: part, p

    allocate (parts((n + part_size - 1)/part_size))
    !$omp parallel do default(none) schedule(static) shared(n, mass, velocity, parts) &
    !$omp private(part, p) num_threads(useful_threads(threads, n))
    do part = 1, size(parts)
      parts(part) = 0.0_wp
      do p = (part - 1)*part_size + 1, min(part*part_size, n)
        parts(part) = parts(part) + 0.5_wp*mass(p)*sum(velocity(:, p)**2)
      end do
    end do
    !$omp end parallel do
    energy = sum(parts)
  end function kinetic_energy

  !> Multiply values by a factor.
  subroutine scale(n, threads, factor, values)
    !> Number of values.
    integer, intent(in) :: n
    !> Number of threads.
    integer, intent(in) :: threads
    !> The factor.
    real(wp), intent(in) :: factor
    !> The values. (n)
    real(wp), intent(inout) :: values(n)
    integer :: i

    !$omp parallel do default(none) schedule(static) shared(n, factor, values) private(i) &
    !$omp num_threads(useful_threads(threads, n))
    do i = 1, n
      values(i) = factor*values(i)
    end do
    !$omp end parallel do
  end subroutine scale

  !> Save the kinetic energy before the last step.
  subroutine quasi_static_driver_save(self, store)
    !> The driver.
    class(quasi_static_driver_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call self%adaptive_driver_t%save(store)
    call store%put('energy', self%energy)
  end subroutine quasi_static_driver_save

  !> Take back the kinetic energy before the last step.
  subroutine quasi_static_driver_restore(self, store)
    !> The driver.
    class(quasi_static_driver_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call self%adaptive_driver_t%restore(store)
    call store%get('energy', self%energy)
  end subroutine quasi_static_driver_restore

end module mpm_quasi_static_driver
