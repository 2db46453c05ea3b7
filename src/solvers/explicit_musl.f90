!> Explicit time integration, stress updated last with velocities that are mapped twice.
module mpm_explicit_musl
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_solver, only: add_explicit_properties, explicit_solver_t
  use mpm_explicit_steps, only: body_stable_step, update_points
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_phase_clock, only: phase_p2g
  use mpm_sweep, only: sweep_t
  use mpm_transfer, only: fit_length, map_velocities
  implicit none
  private
  public :: explicit_musl_t

  !> Symplectic Euler steps; the stress follows from the new velocities of the points.
  type, extends(explicit_solver_t) :: explicit_musl_t
  contains
    procedure, nopass :: describe => explicit_musl_describe
    procedure :: step => explicit_musl_step
    procedure :: stable_step => explicit_musl_stable_step
  end type explicit_musl_t

contains

  !> Purpose and properties of the class.
  subroutine explicit_musl_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('solver', 'ExplicitMUSL', &
                          'Explicit steps with the stress updated last (modified USL): as &
                          &ExplicitUSL, but the new velocities of the points are mapped to the &
                          &grid again, and velocity gradients are formed from them.', &
                          'Sulsky, Zhou and Schreyer, Comput. Phys. Commun. 87 (1995) 236-252; &
                          &Nairn, CMES 4 (2003) 649-664', &
                          'solver'//nl//'{'//nl//'    class = "ExplicitMUSL"'//nl// &
                          '    int-properties = {1, 1}   # cpdi, contact'//nl//'}')
    call add_explicit_properties(description)
  end subroutine explicit_musl_describe

  !> Advance the model by one step.
  subroutine explicit_musl_step(self, model, dt, keep_gradient, error)
    !> The solver.
    class(explicit_musl_t), intent(inout) :: self
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
    call self%push(model, dt)
    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      call update_points(model, i, dt, .false., error, &
                         sweep=sweep_t(drift=.false., strain=.false., kept=self%transfer%kept))
      if (allocated(error)) return
      associate (body => model%bodies(i)%body)
        call model%clock%enter(phase_p2g)
        call map_again(body, model%threads)
        if (allocated(self%marks)) then
          call self%marks(i)%impose(body%nodes%window, body%nodes%mass, body%nodes%remapped)
        end if
      end associate
    end do
    call self%observe(model, .true.)
    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      call update_points(model, i, dt, keep_gradient, error, &
                         sweep=sweep_t(kick=.false., remapped=.true.))
      if (allocated(error)) return
    end do
    call self%correct(model, dt)
  end subroutine explicit_musl_step

  !> Map the new velocities of the points to the nodes.
  !!
  !! What a wall prescribes stays as the grid update left it.
  subroutine map_again(body, threads)
    !> The body, after the grid update, with new velocities of its points.
    class(body_t), intent(inout) :: body
    !> Number of threads.
    integer, intent(in) :: threads
    integer :: n

    n = body%nodes%window%size()
    call fit_length(body%nodes, body%nodes%remapped)
    if (body%points%n_inside == 0) return
    associate (points => body%points, nodes => body%nodes)
      call map_velocities(body, threads, points%velocity(:, :points%n_inside), &
                          allocated(points%affine), nodes%remapped)
      if (.not. allocated(body%boundary)) return
      nodes%remapped(:, :n) = nodes%remapped(:, :n) - nodes%velocity(:, :n)
      call body%boundary%prescribe(nodes%window, .true., nodes%remapped)
      nodes%remapped(:, :n) = nodes%velocity(:, :n) + nodes%remapped(:, :n)
    end associate
  end subroutine map_again

  !> Largest stable time step of a body by linear theory.
  pure subroutine explicit_musl_stable_step(self, model, body, wave_speed, limit)
    !> The solver.
    class(explicit_musl_t), intent(in) :: self
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
  end subroutine explicit_musl_stable_step

end module mpm_explicit_musl
