!> Explicit time integration, stress updated last.
module mpm_explicit_usl
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t
  use mpm_explicit_steps, only: body_stable_step, locate_points, map_to_nodes, update_nodes, &
                                update_points
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_solver, only: solver_t
  implicit none
  private
  public :: explicit_usl_step, explicit_usl_t

  !> FLIP with symplectic Euler steps.
  type, extends(solver_t) :: explicit_usl_t
    !> Average the basis over the corners of the points' boxes.
    logical :: averaged = .true.
    !> Contacts use trial momenta that include the forces so far.
    logical :: implicit_contact = .true.
    !> Velocities advance from the middle of the last step to that of the present one.
    logical :: staggered = .false.
  contains
    procedure, nopass :: describe => explicit_usl_describe
    procedure :: init => explicit_usl_init
    procedure :: start => explicit_usl_start
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
                          &contacts, boundaries, grid update, grid to points (FLIP), stress.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196; Bardenhagen, &
                          &J. Comput. Phys. 180 (2002) 383-403', &
                          'solver'//nl//'{'//nl//'    class = "ExplicitUSL"'//nl// &
                          '    int-properties = {1, 1}   # cpdi, contact'//nl//'}')
    call description%add_integer('cpdi', '1: average the basis over the corners of each point''s &
                                 &box; 0: evaluate it at the point', default=1, lower=0, upper=1)
    call description%add_integer('contact', '1: contacts use trial momenta with all forces so far &
                                 &(implicit); 0: the momenta of the start of the step (explicit)', &
                                 default=1, lower=0, upper=1)
    call description%add_integer('staggered', '1: velocities advance by (dt + last dt)/2, dt/2 in &
                                 &the first step, so that they belong to the middle of each step; &
                                 &0: by dt', default=0, lower=0, upper=1)
    call description%add_note('TYPE 4 carries the inertia of the rotating basis (v_theta^2/r and &
                              &v_r v_theta/r), which mpm_3d lacks; close to the axis 1/r is &
                              &replaced by its limit.')
    call description%add_note('The velocity of a node with less than 1e-9 of the mean mass of the &
                              &points leaves out internal forces, which have no bound there; the &
                              &points still receive them, so that momentum is conserved.')
    call description%add_note('The stable step of each body is compared with dt before the first &
                              &step and at each frame. A point that is not finite, moves more than &
                              &a cell or loses its volume stops the run.')
  end subroutine explicit_usl_describe

  !> Set up from the properties.
  subroutine explicit_usl_init(self, properties, error)
    !> The solver.
    class(explicit_usl_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error

    self%averaged = properties%integer('cpdi') == 1
    self%implicit_contact = properties%integer('contact') == 1
    self%staggered = properties%integer('staggered') == 1
  end subroutine explicit_usl_init

  !> Choose the basis of each body and map the initial state to the nodes.
  subroutine explicit_usl_start(self, model, error)
    !> The solver.
    class(explicit_usl_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Points that the basis can't take.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, size(model%bodies)
      call locate_points(model, i, self%averaged, error)
      if (allocated(error)) return
      if (.not. model%bodies(i)%body%active) cycle
      call map_to_nodes(model%bodies(i)%body, model%threads, error)
      if (allocated(error)) then
        ! What does not fit at the start is a matter of the config.
        error%code = err_input
        return
      end if
      model%bodies(i)%body%nodes%increment = 0.0_wp
    end do
  end subroutine explicit_usl_start

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
    real(wp) :: kick
    integer :: i

    kick = dt
    if (self%staggered) kick = 0.5_wp*(model%last_dt + dt)
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        call map_to_nodes(body, model%threads, error)
        if (allocated(error)) return
        if (allocated(body%boundary)) then
          call body%boundary%generate(model%grid, body%points, body%nodes)
        end if
      end associate
    end do
    do i = 1, size(model%contacts)
      call model%contacts(i)%contact%apply(model%grid, model%bodies, kick, self%implicit_contact, &
                                           model%threads)
    end do
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        if (allocated(body%boundary)) then
          call body%boundary%apply(model%grid, body%points, body%nodes, kick)
        end if
        call update_nodes(body%nodes, kick, model%threads)
      end associate
    end do
    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      call self%advance_body(model, i, dt, keep_gradient, error)
      if (allocated(error)) return
    end do
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

    associate (unused => self)
    end associate
    call update_points(model, body, dt, keep_gradient, error)
  end subroutine explicit_usl_advance_body

  !> Largest stable time step of a body by linear theory.
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
