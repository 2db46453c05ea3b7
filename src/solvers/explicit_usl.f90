!> Explicit time integration, stress updated last.
module mpm_explicit_usl
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_solver, only: add_explicit_properties, explicit_solver_t
  use mpm_explicit_steps, only: body_stable_step, update_points
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_sweep, only: sweep_t
  implicit none
  private
  public :: explicit_usl_step, explicit_usl_t

  !> Symplectic Euler steps; the stress follows from the new velocities of the nodes.
  type, extends(explicit_solver_t) :: explicit_usl_t
  contains
    procedure, nopass :: describe => explicit_usl_describe
    procedure :: step => explicit_usl_step
    procedure :: stable_step => explicit_usl_stable_step
    !> Advance the points of a body, their volume and stress, when its nodes are advanced.
    procedure :: advance_body => explicit_usl_advance_body
  end type explicit_usl_t

contains

  !> Purpose and properties of the class.
  subroutine explicit_usl_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('solver', 'ExplicitUSL', &
                          'Explicit steps with the stress updated last: points to grid, forces, &
                          &contacts, boundaries, grid update, grid to points, stress.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196; Bardenhagen, &
                          &J. Comput. Phys. 180 (2002) 383-403', &
                          'solver'//nl//'{'//nl//'    class = "ExplicitUSL"'//nl// &
                          '    int-properties = {1, 1}   # cpdi, contact'//nl//'}')
    call add_explicit_properties(description)
  end subroutine explicit_usl_describe

  !> Advance the model by one step.
  !!
  !! Public since a class that overrides `step` loses its own type in a call of its parent's.
  subroutine explicit_usl_step(self, model, dt, keep_gradient, error)
    !> The solver.
    class(explicit_usl_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients, for a frame.
    logical, intent(in) :: keep_gradient
    !> The simulation went bad.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    call self%map(model, error)
    if (allocated(error)) return
    call self%push(model, dt)
    call self%observe(model, .false.)
    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      call self%advance_body(model, i, dt, keep_gradient, error)
      if (allocated(error)) return
    end do
    call self%correct(model, dt)
  end subroutine explicit_usl_step

  !> Advance the points of a body with the grid, then their stress.
  subroutine explicit_usl_advance_body(self, model, body, dt, keep_gradient, error)
    !> The solver.
    class(explicit_usl_t), intent(inout) :: self
    !> The model, its nodes advanced.
    type(model_t), intent(inout) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients, for a frame.
    logical, intent(in) :: keep_gradient
    !> The simulation went bad.
    type(error_t), allocatable, intent(out) :: error

    if (self%transfer%is_flip()) then
      call update_points(model, body, dt, keep_gradient, error)
    else
      call update_points(model, body, dt, keep_gradient, error, &
                         sweep=sweep_t(kept=self%transfer%kept))
    end if
  end subroutine explicit_usl_advance_body

  !> Largest stable time step of a body by linear theory.
  !!
  !! A transfer that keeps the part nu of a mode's velocity on the grid, mu <= nu <= 1, is stable
  !! for c**2 K dt**2 <= 2 (1 + nu)/(1 + nu - mu), which is least for FLIP, nu = 1.
  pure subroutine explicit_usl_stable_step(self, model, body, wave_speed, limit)
    !> The solver.
    class(explicit_usl_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Largest wave speed; 0 when nothing bounds the step. [m/s]
    real(wp), intent(out) :: wave_speed
    !> Largest stable step; huge when nothing bounds it. [s]
    real(wp), intent(out) :: limit

    associate (unused => self)
    end associate
    call body_stable_step(model%grid%spacing(), model%bodies(body)%body, wave_speed, limit)
  end subroutine explicit_usl_stable_step

end module mpm_explicit_usl
