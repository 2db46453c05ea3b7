!> What the explicit solvers share: properties, start, and the parts of a step on the grid.
module mpm_explicit_solver
  use mpm_contact_marks, only: contact_marks_t
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t
  use mpm_explicit_steps, only: locate_points, map_to_nodes, update_nodes
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_phase_clock, only: phase_contact, phase_nodes
  use mpm_point_blocks, only: fit_points
  use mpm_properties, only: properties_t
  use mpm_seam, only: copy_to_ghosts
  use mpm_solver, only: solver_t
  use mpm_store, only: store_t
  use mpm_strings, only: to_text
  use mpm_transfer, only: add_transfer_properties, transfer_t
  implicit none
  private
  public :: add_explicit_properties, explicit_solver_t
  public :: explicit_solver_restore, explicit_solver_save

  !> Symplectic Euler steps with a choice of transfers.
  type, abstract, extends(solver_t) :: explicit_solver_t
    !> Average the basis over the corners of the points' boxes.
    logical :: averaged = .true.
    !> Contacts use trial momenta that include the forces so far.
    logical :: implicit_contact = .true.
    !> Velocities advance from the middle of the last step to that of the present one.
    logical :: staggered = .false.
    !> How velocities go from the points to the grid and back.
    type(transfer_t) :: transfer
    !> Where contacts act, body by body; not allocated unless a step asks. (bodies)
    type(contact_marks_t), allocatable :: marks(:)
  contains
    procedure :: init => explicit_solver_init
    procedure :: start => explicit_solver_start
    procedure :: save => explicit_solver_save
    procedure :: restore => explicit_solver_restore
    !> Ask for the marks of contacts.
    procedure :: mark_contacts => explicit_solver_mark_contacts
    !> Map all bodies to their nodes.
    procedure :: map => explicit_solver_map
    !> Add the forces of contacts and walls, and update all nodes.
    procedure :: push => explicit_solver_push
    !> Let materials take what they know of other bodies.
    procedure :: observe => explicit_solver_observe
    !> Let the points of all bodies correct their positions.
    procedure, nopass :: correct => explicit_solver_correct
  end type explicit_solver_t

contains

  !> Add the properties of all explicit solvers.
  subroutine add_explicit_properties(description, has_threads, has_debug)
    !> The description.
    type(description_t), intent(inout) :: description
    !> Whether there is a number of threads; false when left out.
    logical, intent(in), optional :: has_threads
    !> Whether there is a table of times to ask for; false when left out.
    logical, intent(in), optional :: has_debug
    logical :: adds

    call description%add_integer('cpdi', '1: average the basis over the corners of each point''s &
                                 &box; 0: evaluate it at the point', default=1, lower=0, upper=1)
    call description%add_integer('contact', '1: contacts use trial momenta with all forces so far &
                                 &(implicit); 0: the momenta of the start of the step (explicit)', &
                                 default=1, lower=0, upper=1)
    adds = .false.
    if (present(has_threads)) adds = has_threads
    if (adds) then
      call description%add_integer('threads', 'number of threads; 0: those of the job', &
                                   default=0, lower=0, upper=4096)
    end if
    adds = .false.
    if (present(has_debug)) adds = has_debug
    if (adds) then
      call description%add_integer('debug', '1: a table of the time that each phase of the run &
                                   &took, as with -v', default=0, lower=0, upper=1)
    end if
    call description%add_integer('staggered', '1: velocities advance by (dt + last dt)/2, dt/2 in &
                                 &the first step, so that they belong to the middle of each step; &
                                 &0: by dt', default=0, lower=0, upper=1)
    call add_transfer_properties(description)
    call description%add_note('TYPE 4 carries the inertia of the rotating basis (v_theta^2/r and &
                              &v_r v_theta/r), which mpm_3d lacks; close to the axis 1/r is &
                              &replaced by its limit.')
    call description%add_note('The velocity of a node with less than 1e-9 of the mean mass of the &
                              &points leaves out internal forces, which have no bound there; the &
                              &points still receive them, so that momentum is conserved.')
    call description%add_note('The stable step of each body is compared with dt before the first &
                              &step and at each frame. A point that is not finite, moves more than &
                              &a cell or loses its volume stops the run.')
  end subroutine add_explicit_properties

  !> Set up from the properties.
  subroutine explicit_solver_init(self, properties, error)
    !> The solver.
    class(explicit_solver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An unknown transfer, or values that do not belong to it.
    type(error_t), allocatable, intent(out) :: error

    self%averaged = properties%integer('cpdi') == 1
    self%implicit_contact = properties%integer('contact') == 1
    self%staggered = properties%integer('staggered') == 1
    call self%transfer%init(properties, error)
  end subroutine explicit_solver_init

  !> Choose the basis of each body and map the initial state to the nodes.
  subroutine explicit_solver_start(self, model, error)
    !> The solver.
    class(explicit_solver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Points that the basis can't take.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, size(model%bodies)
      call locate_points(model, i, self%averaged, error, self%transfer%fitted)
      if (allocated(error)) return
      call self%transfer%start(model%bodies(i)%body%points, error)
      if (allocated(error)) then
        error%message = 'body "'//model%bodies(i)%body%name//'": '//error%message
        return
      end if
    end do
    call self%map(model, error)
    if (allocated(error)) then
      ! What does not fit at the start is a matter of the config.
      error%code = err_input
      return
    end if
    if (self%transfer%affine) then
      ! The first mapping had no affine fields; they begin as those that fit its velocities.
      do i = 1, size(model%bodies)
        associate (body => model%bodies(i)%body)
          if (.not. body%active) cycle
          if (allocated(body%boundary)) then
            call body%boundary%prescribe(body%nodes%window, .false., body%nodes%velocity)
          end if
          if (any(body%points%stencil%periodic)) then
            call copy_to_ghosts(body%points%stencil, body%nodes%window, model%kin%nvel, &
                                body%nodes%velocity)
          end if
          call fit_points(body%points, body%nodes, model%threads)
        end associate
      end do
      call self%map(model, error)
      if (allocated(error)) return
    end if
    do i = 1, size(model%bodies)
      if (model%bodies(i)%body%active) model%bodies(i)%body%nodes%increment = 0.0_wp
    end do
    call self%observe(model, .false.)
  end subroutine explicit_solver_start

  !> Ask for the marks of contacts, if there are contacts.
  subroutine explicit_solver_mark_contacts(self, model)
    !> The solver.
    class(explicit_solver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model

    if (size(model%contacts) == 0 .or. allocated(self%marks)) return
    allocate (self%marks(size(model%bodies)))
  end subroutine explicit_solver_mark_contacts

  !> Map all bodies to their nodes.
  subroutine explicit_solver_map(self, model, error)
    !> The solver.
    class(explicit_solver_t), intent(in) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> The nodes need more memory than there is.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, size(model%bodies)
      if (.not. model%bodies(i)%body%active) cycle
      call limit_nodes(model, i)
      call map_to_nodes(model%bodies(i)%body, model%threads, error, model%clock)
      if (allocated(error)) return
      call self%transfer%filter(model%bodies(i)%body, model%threads)
    end do
  end subroutine explicit_solver_map

  !> Tell the nodes of a body how much memory the other bodies and its points leave.
  subroutine limit_nodes(model, i)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position of the body.
    integer, intent(in) :: i
    integer(lp) :: used
    integer :: j

    if (model%memory_limit == 0) return
    used = 0
    do j = 1, size(model%bodies)
      used = used + model%bodies(j)%body%points%memory()
      if (j /= i) used = used + model%bodies(j)%body%nodes%memory()
    end do
    model%bodies(i)%body%nodes%memory_limit = max(1_lp, model%memory_limit - used)
  end subroutine limit_nodes

  !> Add the forces of contacts and walls, and update all nodes.
  subroutine explicit_solver_push(self, model, dt)
    !> The solver.
    class(explicit_solver_t), intent(inout) :: self
    !> The model, mapped.
    type(model_t), intent(inout) :: model
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    real(wp) :: kick
    integer :: i

    kick = dt
    call model%clock%enter(phase_contact)
    if (self%staggered) kick = 0.5_wp*(model%last_dt + dt)
    model%last_kick = kick
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        call body%act_on_points(model%time)
        if (allocated(self%marks)) call self%marks(i)%begin(body%nodes)
        if (.not. allocated(body%boundary)) cycle
        call body%boundary%generate(model%grid, body%points, body%nodes)
      end associate
    end do
    do i = 1, size(model%contacts)
      call model%contacts(i)%contact%apply(model%grid, model%bodies, kick, self%implicit_contact, &
                                           model%threads)
    end do
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        if (allocated(self%marks)) call self%marks(i)%mark(body%nodes)
        if (allocated(body%boundary)) then
          call body%boundary%apply(model%grid, body%points, body%nodes, kick)
        end if
        call model%clock%enter(phase_nodes)
        call update_nodes(body%nodes, kick, model%threads)
        if (allocated(self%marks)) call self%marks(i)%keep(body%nodes)
        call self%transfer%finish(body%nodes, kick, model%threads)
        call model%clock%enter(phase_contact)
      end associate
    end do
  end subroutine explicit_solver_push

  !> Let materials take what they know of other bodies, before strain rates are formed.
  subroutine explicit_solver_observe(self, model, remapped)
    !> The solver.
    class(explicit_solver_t), intent(inout) :: self
    !> The model; its nodes have the velocities for the strain rates, its points have not moved.
    type(model_t), intent(inout) :: model
    !> These velocities are those of the second mapping.
    logical, intent(in) :: remapped
    integer :: i, other

    associate (unused => self)
    end associate
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. (body%active .and. allocated(body%material))) cycle
        other = body%material%partner%position
        if (other == 0) cycle
        if (model%bodies(other)%body%active) then
          call body%material%observe(model%grid, body%points, body%nodes, remapped, &
                                     model%threads, model%bodies(other)%body%points, &
                                     model%bodies(other)%body%nodes)
        else
          call body%material%observe(model%grid, body%points, body%nodes, remapped, model%threads)
        end if
      end associate
    end do
  end subroutine explicit_solver_observe

  !> Save the marks of contacts, which the next step may use.
  !!
  !! Public since a class that overrides it can't call it by the name of an abstract parent.
  subroutine explicit_solver_save(self, store)
    !> The solver.
    class(explicit_solver_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store
    integer :: i

    if (.not. allocated(self%marks)) return
    call store%put('marks', size(self%marks))
    do i = 1, size(self%marks)
      call store%enter('marks_'//to_text(i))
      call self%marks(i)%save(store)
      call store%leave()
    end do
  end subroutine explicit_solver_save

  !> Take back the marks of contacts.
  subroutine explicit_solver_restore(self, store)
    !> The solver, started.
    class(explicit_solver_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store
    integer :: n, i

    if (.not. store%has('marks')) return
    n = 0
    call store%get('marks', n)
    allocate (self%marks(n))
    do i = 1, n
      call store%enter('marks_'//to_text(i))
      call self%marks(i)%restore(store)
      call store%leave()
    end do
  end subroutine explicit_solver_restore

  !> Let the points of all bodies correct their positions.
  subroutine explicit_solver_correct(model, dt)
    !> The model, its points advanced.
    type(model_t), intent(inout) :: model
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    integer :: i

    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        call body%points%correct(model%step + 1, dt, model%threads)
        if (.not. allocated(body%material)) cycle
        call body%material%correct(model%grid, body%points, dt, model%threads)
      end associate
    end do
  end subroutine explicit_solver_correct

end module mpm_explicit_solver
