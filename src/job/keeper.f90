!> What looks after a run between its steps: it may save it, or end it.
module mpm_keeper
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_model, only: model_t
  use mpm_monitor, only: monitor_t
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  implicit none
  private
  public :: keeper_t

  !> A keeper of runs.
  type, abstract :: keeper_t
  contains
    !> Look at the run when a step and its frame are done.
    procedure(look_i), deferred :: look
  end type keeper_t

  abstract interface
    !> Look at the run when a step and its frame are done.
    subroutine look_i(self, model, driver, solver, serializer, monitor, at_end, error)
      import :: configurable_t, error_t, keeper_t, model_t, monitor_t, serializer_t, solver_t
      implicit none
      !> The keeper.
      class(keeper_t), intent(inout) :: self
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
    end subroutine look_i
  end interface

end module mpm_keeper
