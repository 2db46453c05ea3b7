!> The role `solver`: one step of the equations of motion.
module mpm_solver
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: solver_t

  !> An integrator of the equations of motion.
  type, abstract, extends(configurable_t) :: solver_t
    !> Threads that its properties ask for; 0 for those of the job.
    integer :: threads = 0
    !> Whether its properties ask for the time of each phase.
    logical :: timed = .false.
  contains
    !> Set up from the properties.
    procedure(init_i), deferred :: init
    !> Choose the basis of each body and map the initial state to the nodes.
    procedure(start_i), deferred :: start
    !> Advance the model by one step.
    procedure(step_i), deferred :: step
    !> Largest stable time step of a body by linear theory.
    procedure(stable_step_i), deferred :: stable_step
  end type solver_t

  abstract interface
    !> Set up from the properties.
    subroutine init_i(self, properties, error)
      import :: error_t, properties_t, solver_t
      implicit none
      !> The solver.
      class(solver_t), intent(inout) :: self
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Choose the basis of each body and map the initial state to the nodes.
    subroutine start_i(self, model, error)
      import :: error_t, model_t, solver_t
      implicit none
      !> The solver.
      class(solver_t), intent(inout) :: self
      !> The model.
      type(model_t), intent(inout) :: model
      !> Points that the basis can't take.
      type(error_t), allocatable, intent(out) :: error
    end subroutine start_i

    !> Advance the model by one step; its time and step count are the caller's.
    subroutine step_i(self, model, dt, keep_gradient, error)
      import :: error_t, model_t, solver_t, wp
      implicit none
      !> The solver.
      class(solver_t), intent(inout) :: self
      !> The model.
      type(model_t), intent(inout) :: model
      !> Length of the step. [s]
      real(wp), intent(in) :: dt
      !> Store the velocity gradients, for a frame.
      logical, intent(in) :: keep_gradient
      !> The simulation went bad.
      type(error_t), allocatable, intent(out) :: error
    end subroutine step_i

    !> Largest stable time step of a body by linear theory.
    pure subroutine stable_step_i(self, model, body, wave_speed, limit)
      import :: model_t, solver_t, wp
      implicit none
      !> The solver.
      class(solver_t), intent(in) :: self
      !> The model.
      type(model_t), intent(in) :: model
      !> Position of the body in the model's list.
      integer, intent(in) :: body
      !> Largest wave speed; 0 when nothing bounds the step. [m/s]
      real(wp), intent(out) :: wave_speed
      !> Largest stable step; huge when nothing bounds it. [s]
      real(wp), intent(out) :: limit
    end subroutine stable_step_i
  end interface

end module mpm_solver
