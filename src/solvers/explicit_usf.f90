!> Explicit time integration, stress updated first.
module mpm_explicit_usf
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_solver, only: add_explicit_properties, explicit_solver_t
  use mpm_explicit_steps, only: body_stable_step, update_points
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_sweep, only: sweep_t
  implicit none
  private
  public :: explicit_usf_t

  !> Symplectic Euler steps; the stress follows from the velocities at the start of the step.
  type, extends(explicit_solver_t) :: explicit_usf_t
  contains
    procedure, nopass :: describe => explicit_usf_describe
    procedure :: step => explicit_usf_step
    procedure :: stable_step => explicit_usf_stable_step
  end type explicit_usf_t

contains

  !> Purpose and properties of the class.
  subroutine explicit_usf_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('solver', 'ExplicitUSF', &
                          'Explicit steps with the stress updated first: points to grid, stress, &
                          &forces, contacts, boundaries, grid update, grid to points.', &
                          'Bardenhagen, J. Comput. Phys. 180 (2002) 383-403', &
                          'solver'//nl//'{'//nl//'    class = "ExplicitUSF"'//nl// &
                          '    int-properties = {cpdi = 1, staggered = 1}'//nl//'}')
    call add_explicit_properties(description)
    call description%add_note('Stresses and volumes of a frame are those of one step before its &
                              &positions. staggered = 1 also leaves out the first change of &
                              &stress, so that they begin at the start time, too.')
  end subroutine explicit_usf_describe

  !> Advance the model by one step.
  subroutine explicit_usf_step(self, model, dt, keep_gradient, error)
    !> The solver.
    class(explicit_usf_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients, for a frame.
    logical, intent(in) :: keep_gradient
    !> The simulation went bad.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    call self%mark_contacts(model)
    call self%map(model, error)
    if (allocated(error)) return
    if (.not. self%staggered .or. model%step > 0_lp) then
      do i = 1, size(model%bodies)
        associate (body => model%bodies(i)%body)
          if (.not. body%active) cycle
          if (allocated(self%marks)) then
            call self%marks(i)%impose(body%nodes%window, body%nodes%mass, body%nodes%velocity)
          end if
          if (allocated(body%boundary)) then
            call body%boundary%prescribe(body%nodes%window, .false., body%nodes%velocity)
          end if
        end associate
      end do
      call self%observe(model, .false.)
      do i = 1, size(model%bodies)
        if (.not. model%bodies(i)%body%active) cycle
        call update_points(model, i, dt, keep_gradient, error, &
                         sweep=sweep_t(kick=.false., drift=.false.))
        if (allocated(error)) return
      end do
      call self%map(model, error)
      if (allocated(error)) return
    end if
    call self%push(model, dt)
    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      call update_points(model, i, dt, .false., error, &
                         sweep=sweep_t(strain=.false., kept=self%transfer%kept))
      if (allocated(error)) return
    end do
    call self%correct(model, dt)
  end subroutine explicit_usf_step

  !> Largest stable time step of a body by linear theory.
  pure subroutine explicit_usf_stable_step(self, model, body, wave_speed, limit)
    !> The solver.
    class(explicit_usf_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Largest wave speed; 0 when nothing bounds the step. [m/s]
    real(wp), intent(out) :: wave_speed
    !> Largest stable step; huge when nothing bounds it. [s]
    real(wp), intent(out) :: limit

    call body_stable_step(model%grid%spacing(), model%bodies(body)%body, wave_speed, limit, &
                          filtered=.true., flip=self%transfer%is_flip())
  end subroutine explicit_usf_stable_step

end module mpm_explicit_usf
