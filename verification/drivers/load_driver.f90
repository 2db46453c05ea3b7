!> Drivers whose body force depends on point and time, with an exact solution to compare with.
module mpm_load_driver
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_driver, only: driver_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_model, only: model_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: add_load_properties, exact_state_t, load_driver_t, prepare_loads, read_load_properties

  !> Exact state of a point; what the simulation TYPE does not have is not looked at.
  type :: exact_state_t
    !> Displacement. [m]
    real(wp) :: displacement(3) = 0.0_wp
    !> Velocity. [m/s]
    real(wp) :: velocity(3) = 0.0_wp
    !> Cauchy stress in the order of the points' stress. [Pa]
    real(wp) :: stress(6) = 0.0_wp
    !> Determinant of the deformation gradient: volume over reference volume.
    real(wp) :: jacobian = 1.0_wp
  end type exact_state_t

  !> A driver with a body force that is a function of point and time.
  type, abstract, extends(driver_t) :: load_driver_t
    !> Begin at the exact state of the start time; the points file is the reference configuration.
    logical :: exact_start = .true.
    !> Begin with the velocities of half a step before the start time.
    !!
    !! Symplectic Euler keeps the velocity half a step behind the positions. Without this a start
    !! with an acceleration costs an order in dt.
    logical :: staggered = .false.
    !> The simulation TYPEs that the solution is for.
    logical :: types(5) = .true.
  contains
    !> Acceleration by the body force.
    procedure(acceleration_i), deferred :: acceleration
    !> Exact state of a point.
    procedure(exact_i), deferred :: exact
    procedure :: body_force => load_driver_body_force
    procedure :: prepare => prepare_loads
    procedure :: before_step => load_driver_before_step
  end type load_driver_t

  abstract interface
    !> Acceleration by the body force.
    pure function acceleration_i(self, kin, reference, x, velocity, time) result(b)
      import :: kinematics_t, load_driver_t, wp
      implicit none
      !> The driver.
      class(load_driver_t), intent(in) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Reference position, components beyond dim 0. [m]
      real(wp), intent(in) :: reference(3)
      !> Position, components beyond dim 0. [m]
      real(wp), intent(in) :: x(3)
      !> Velocity, components beyond nvel 0. [m/s]
      real(wp), intent(in) :: velocity(3)
      !> Time. [s]
      real(wp), intent(in) :: time
      !> Acceleration; components beyond nvel are not looked at. [m/s2]
      real(wp) :: b(3)
    end function acceleration_i

    !> Exact state of a point.
    pure subroutine exact_i(self, kin, reference, time, state)
      import :: exact_state_t, kinematics_t, load_driver_t, wp
      implicit none
      !> The driver.
      class(load_driver_t), intent(in) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Reference position, components beyond dim 0. [m]
      real(wp), intent(in) :: reference(3)
      !> Time. [s]
      real(wp), intent(in) :: time
      !> The state.
      type(exact_state_t), intent(out) :: state
    end subroutine exact_i
  end interface

contains

  !> Declare the properties that all these drivers share; to be called before any other is added.
  subroutine add_load_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_real('t_stop', 's', 'stop time')
    call description%add_integer('staggered', '1: the first velocities are those of dt/2 before &
                                 &the start time; 0: those of the start time', default=0, &
                                 lower=0, upper=1)
  end subroutine add_load_properties

  !> Take over the properties that all these drivers share.
  subroutine read_load_properties(self, properties)
    !> The driver.
    class(load_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties

    self%t_stop = properties%real('t_stop')
    self%staggered = properties%integer('staggered') == 1
  end subroutine read_load_properties

  !> No uniform body force.
  pure function load_driver_body_force(self, kin) result(b)
    !> The driver.
    class(load_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    associate (unused => self, unused_kin => kin)
    end associate
    b = 0.0_wp
  end function load_driver_body_force

  !> Put the points into the exact state of the start time and give them their first loads.
  !!
  !! Public since a class that overrides `prepare` can't call that of an abstract type.
  subroutine prepare_loads(self, model, error)
    !> The driver.
    class(load_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> A TYPE without solution, or a point whose exact state is outside of the grid.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    real(wp) :: t_velocity
    integer :: i

    if (.not. self%types(model%kin%sim_type)) then
      call self%describe(description)
      call raise(error, err_input, description%name//' has no solution in TYPE '// &
                 to_text(model%kin%sim_type), hint='(mpm3d-verification --describe '// &
                 description%name//')')
      return
    end if
    t_velocity = model%t_start
    if (self%staggered) t_velocity = model%t_start - 0.5_wp*model%dt
    do i = 1, size(model%bodies)
      associate (points => model%bodies(i)%body%points)
        allocate (points%load(points%kin%nvel, points%n), source=0.0_wp)
        if (.not. self%exact_start) cycle
        call set_exact_state(self, points, model%t_start, t_velocity)
      end associate
      call check_positions(model, model%bodies(i)%body, error)
      if (allocated(error)) return
    end do
    call self%before_step(model)
  end subroutine prepare_loads

  !> Move points from the reference configuration to their exact state.
  pure subroutine set_exact_state(self, points, time, t_velocity)
    !> The driver.
    class(load_driver_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points
    !> Time of the positions, stresses and volumes. [s]
    real(wp), intent(in) :: time
    !> Time of the velocities. [s]
    real(wp), intent(in) :: t_velocity
    type(exact_state_t) :: state, earlier
    real(wp) :: reference(3)
    integer :: p

    associate (kin => points%kin)
      reference = 0.0_wp
      do p = 1, points%n_inside
        reference(:kin%dim) = points%x(:, p)
        call self%exact(kin, reference, time, state)
        call self%exact(kin, reference, t_velocity, earlier)
        points%x(:, p) = reference(:kin%dim) + state%displacement(:kin%dim)
        points%displacement(:, p) = state%displacement(:kin%nvel)
        points%velocity(:, p) = earlier%velocity(:kin%nvel)
        points%stress(:, p) = state%stress(:kin%nstress)
        points%volume(p) = points%volume(p)*state%jacobian
      end do
    end associate
  end subroutine set_exact_state

  !> All points of a body must be inside the grid.
  subroutine check_positions(model, body, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> The first point that is not.
    type(error_t), allocatable, intent(out) :: error
    integer :: p

    do p = 1, body%points%n_inside
      if (model%grid%in_domain(body%points%x(:, p))) cycle
      call raise(error, err_input, 'body "'//body%name//'": the exact start of point '// &
                 to_text(body%points%id(p))//' is outside of the grid', body%points%file, &
                 hint='the points file gives reference positions: enlarge the grid')
      return
    end do
  end subroutine check_positions

  !> Set the loads of all points.
  subroutine load_driver_before_step(self, model)
    !> The driver.
    class(load_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(inout) :: model
    integer :: i

    do i = 1, size(model%bodies)
      call set_loads(self, model%bodies(i)%body%points, model%time, model%threads)
    end do
  end subroutine load_driver_before_step

  !> Set the loads of the points of a body that are inside the grid.
  subroutine set_loads(self, points, time, threads)
    !> The driver.
    class(load_driver_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Number of threads.
    integer, intent(in) :: threads
    integer :: p

    !$omp parallel do default(none) schedule(static) shared(self, points, time) private(p) &
    !$omp num_threads(useful_threads(threads, points%n_inside))
    do p = 1, points%n_inside
      call set_load(self, points, p, time)
    end do
    !$omp end parallel do
  end subroutine set_loads

  !> Set the load of one point.
  pure subroutine set_load(self, points, p, time)
    !> The driver.
    class(load_driver_t), intent(in) :: self
    !> The points; different threads set the loads of different points.
    class(points_t), intent(inout) :: points
    !> Slot of the point.
    integer, intent(in) :: p
    !> Time. [s]
    real(wp), intent(in) :: time
    real(wp) :: reference(3), x(3), velocity(3), b(3)

    associate (kin => points%kin)
      reference = 0.0_wp
      x = 0.0_wp
      velocity = 0.0_wp
      x(:kin%dim) = points%x(:, p)
      reference(:kin%dim) = points%x(:, p) - points%displacement(:kin%dim, p)
      velocity(:kin%nvel) = points%velocity(:, p)
      b = self%acceleration(kin, reference, x, velocity, time)
      points%load(:, p) = b(:kin%nvel)
    end associate
  end subroutine set_load

end module mpm_load_driver
