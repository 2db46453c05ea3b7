!> Explicit time integration of grains, the fluid in their pores, and a solid.
module mpm_explicit_mixture_solver
  use mpm_advance, only: exponential, trace_of_gradient, turn_stress
  use mpm_barotropic_viscous_fluid, only: barotropic_viscous_fluid_t
  use mpm_body, only: body_t
  use mpm_body_list, only: find_body
  use mpm_contact_normals, only: edges_cut, edges_mirror
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_steps, only: bad_stress, raise_bad_point, update_points
  use mpm_explicit_usl, only: explicit_usl_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_material, only: material_t
  use mpm_model, only: model_t
  use mpm_phase_clock, only: phase_material
  use mpm_points, only: points_t
  use mpm_pore_drag, only: pore_drag_t
  use mpm_pore_fluid, only: observe_grains
  use mpm_properties, only: properties_t
  use mpm_slurry_contact, only: slurry_contact_t
  use mpm_slurry_mixture, only: slurry_mixture_t
  use mpm_stencil, only: block_size
  use mpm_strings, only: excerpt, nearest_name, string_t
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: explicit_mixture_solver_t

  !> Flags.
  character(18), parameter :: flag_names(3) = &
    [character(18) :: 'INCOMPRESSIBLE', 'REFLECTED_BOUNDARY', 'ISOTHERMAL']

  !> ExplicitUSL with the forces between the three bodies, and the pressure of a pore fluid.
  type, extends(explicit_usl_t) :: explicit_mixture_solver_t
    !> Diameter of the grains. [m]
    real(wp) :: diameter = 0.0_wp
    !> Density of the fluid without pressure. [kg/m3]
    real(wp) :: fluid_density = 0.0_wp
    !> What faces of the grid are to the normals of the solid, as in `mpm_contact_normals`.
    integer :: edges = edges_cut
    !> Positions of grains, fluid and solid in the model's list.
    integer :: trio(3) = 0
    !> Density of the grains. [kg/m3]
    real(wp) :: grain_density = 0.0_wp
    !> Porosity at the points of the fluid, in the present step. (n_inside)
    real(wp), allocatable, private :: porosity(:)
    !> What the rate of the fluid's own volume exceeds that of the points by. [1/s] (n_inside)
    real(wp), allocatable, private :: excess(:)
    !> The properties, until the bodies exist.
    type(properties_t), private :: properties
  contains
    procedure, nopass :: describe => mixture_solver_describe
    procedure :: init => mixture_solver_init
    procedure :: start => mixture_solver_start
    procedure :: observe => mixture_solver_observe
    procedure :: advance_body => mixture_solver_advance_body
    procedure, private :: find_bodies
    procedure, private :: make_contacts
  end type explicit_mixture_solver_t

contains

  !> Purpose and properties of the class.
  subroutine mixture_solver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('solver', 'ExplicitMixtureSolver', &
                          'As ExplicitUSL, with buoyancy and drag between grains and a simple &
                          &fluid, whose pressure follows the room that the grains leave, and with &
                          &contact of both with a solid.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764', &
                          'solver'//nl//'{'//nl//'    class = "ExplicitMixtureSolver"'//nl// &
                          '    properties = {d_grain = 1e-3, rho_f0 = 1000}'//nl// &
                          '    int-properties = {1, 1}   # cpdi, contact'//nl// &
                          '    str-properties = {"block_0", "block_1", "projectile", &
                          &"INCOMPRESSIBLE"}'//nl//'}')
    call description%add_real('d_grain', 'm', 'diameter of the grains', above=0.0_wp)
    call description%add_real('rho_f0', 'kg/m3', 'density of the fluid without pressure: the &
                              &masses of its points may not be larger than it allows', above=0.0_wp)
    call description%add_integer('cpdi', 'as of ExplicitUSL', default=1, lower=0, upper=1)
    call description%add_integer('contact', 'accepted; forces between the three bodies are those &
                                 &of trial momenta with all forces so far, as in mpm_3d', &
                                 default=1, lower=0, upper=1)
    call description%add_integer('staggered', 'as of ExplicitUSL', default=0, lower=0, upper=1)
    call description%add_string('granular', 'body of the grains: SlurryGranularPhase or its &
                                &relatives, BreakageMechanicsSand, Sand_SachithLocal')
    call description%add_string('fluid', 'body of the fluid: BarotropicViscousFluid')
    call description%add_string('solid', 'body of the solid, of any material')
    call description%add_string('flags', 'REFLECTED_BOUNDARY: contact as &
                                &SlurryContact_ReflectedBoundary; INCOMPRESSIBLE, ISOTHERMAL: &
                                &accepted, grains keep their density and nothing its heat', &
                                is_list=.true.)
    call description%add_note('The solver sets up a SlurryMixture with the drag of Carman and &
                              &Kozeny, and a SlurryContact with the friction of the grains (M_0/&
                              &sqrt(3) of BreakageMechanicsSand). A config that has contacts of &
                              &its own is refused; mpm_3d does not run them.')
    call description%add_note('mpm_3d is for CompressibleBreakageMechanicsSand, whose grains &
                              &change their density, and knows TillotsonEOSFluid: these are not &
                              &available here.')
    call description%add_note('The same scene with ExplicitUSL: SlurryFluidPhase, SlurryMixture &
                              &and SlurryContact, which leave the choice of solver, drag and &
                              &contacts.')
    call description%add_note('Bodies beside the three move as with ExplicitUSL; mpm_3d leaves &
                              &their stress as it is.')
    call description%add_note('A pressure that the fluid starts with stays. The stable step counts &
                              &the viscosity of the fluid without grains.')
  end subroutine mixture_solver_describe

  !> Set up from the properties.
  subroutine mixture_solver_init(self, properties, error)
    !> The solver.
    class(explicit_mixture_solver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An unknown flag.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    type(string_t) :: known(size(flag_names))
    character(:), allocatable :: near
    integer :: i, k

    call self%explicit_usl_t%init(properties, error)
    if (allocated(error)) return
    self%implicit_contact = .true.
    self%properties = properties
    self%diameter = properties%real('d_grain')
    self%fluid_density = properties%real('rho_f0')
    self%edges = edges_cut
    call properties%strings('flags', flags)
    do k = 1, size(known)
      known(k)%text = trim(flag_names(k))
    end do
    do i = 1, size(flags)
      if (flags(i)%text == 'REFLECTED_BOUNDARY') self%edges = edges_mirror
      if (any([(flags(i)%text == known(k)%text, k=1, size(known))])) cycle
      near = nearest_name(flags(i)%text, known)
      if (len(near) > 0) near = 'did you mean "'//near//'"?   '
      call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                             near//'(mpm3d --describe ExplicitMixtureSolver)')
      return
    end do
  end subroutine mixture_solver_init

  !> Find the bodies, set up the forces between them, and map the initial state to the nodes.
  subroutine mixture_solver_start(self, model, error)
    !> The solver.
    class(explicit_mixture_solver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Bodies, materials, contacts or points that the solver can't take.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: friction

    call self%find_bodies(model, friction, error)
    if (allocated(error)) return
    call self%make_contacts(model, friction, error)
    if (allocated(error)) return
    associate (points => model%bodies(self%trio(2))%body%points)
      allocate (points%smoothed_volume, source=points%volume)
      if (.not. allocated(points%gradient)) then
        allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
      end if
    end associate
    call self%explicit_usl_t%start(model, error)
  end subroutine mixture_solver_start

  !> Find the bodies and look at their materials.
  subroutine find_bodies(self, model, friction, error)
    !> The solver.
    class(explicit_mixture_solver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Friction of the grains.
    real(wp), intent(out) :: friction
    !> No such body, one body twice, or a material that does not fit.
    type(error_t), allocatable, intent(out) :: error
    character(8), parameter :: names(3) = ['granular', 'fluid   ', 'solid   ']
    integer :: i

    friction = 0.0_wp
    do i = 1, 3
      call find_body(model%bodies, self%properties, trim(names(i)), '', self%trio(i), error)
      if (allocated(error)) return
      if (all(self%trio(:i - 1) /= self%trio(i))) cycle
      call self%properties%reject(trim(names(i)), 'the solver needs three bodies, but "'// &
                                  model%bodies(self%trio(i))%body%name//'" is given twice', error, &
                                  'name another body')
      return
    end do
    associate (grains => model%bodies(self%trio(1))%body, fluid => model%bodies(self%trio(2))%body)
      self%grain_density = 0.0_wp
      if (allocated(grains%material)) then
        call grains%material%grains(self%grain_density, friction)
      end if
      if (.not. self%grain_density > 0.0_wp) then
        call self%properties%reject('granular', 'the material of "'//grains%name//'" is none of &
                                    &grains', error, 'use SlurryGranularPhase, &
                                    &BreakageMechanicsSand or Sand_SachithLocal')
      else if (.not. is_simple_fluid(fluid)) then
        call self%properties%reject('fluid', 'the material of "'//fluid%name//'" is not &
                                    &BarotropicViscousFluid', error, 'SlurryFluidPhase goes with &
                                    &ExplicitUSL and the contact SlurryMixture')
      else if (any(fluid%points%mass > 1.01_wp*pressed_density(self, fluid)*fluid%points%volume)) &
        then
        call self%properties%reject('rho_f0', 'the points of "'//fluid%name//'" hold more fluid &
                                    &than rho_f0 lets into their volume', error, 'the mass of a &
                                    &point is rho_f0 times its volume times the porosity')
      end if
    end associate
  end subroutine find_bodies

  !> Whether a body is of the fluid that the solver knows.
  function is_simple_fluid(body) result(simple)
    !> The body.
    class(body_t), intent(in) :: body
    !> Whether it is.
    logical :: simple

    simple = .false.
    if (.not. allocated(body%material)) return
    select type (material => body%material)
    class is (barotropic_viscous_fluid_t)
      simple = .true.
    end select
  end function is_simple_fluid

  !> Density of the fluid at the points, under the pressure that they have at the start.
  function pressed_density(self, body) result(density)
    !> The solver.
    class(explicit_mixture_solver_t), intent(in) :: self
    !> The fluid.
    class(body_t), intent(in) :: body
    !> Densities. [kg/m3] (n)
    real(wp) :: density(body%points%n)

    ! The memory of a point is its volume without pressure.
    density = self%fluid_density*body%points%history(1, :)/body%points%volume
  end function pressed_density

  !> Make the contacts of the three bodies those of the model.
  subroutine make_contacts(self, model, friction, error)
    !> The solver.
    class(explicit_mixture_solver_t), intent(in) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Friction of the grains.
    real(wp), intent(in) :: friction
    !> The config has contacts of its own.
    type(error_t), allocatable, intent(out) :: error
    type(slurry_mixture_t) :: mixture
    type(slurry_contact_t) :: contact
    type(pore_drag_t) :: drag

    if (size(model%contacts) > 0) then
      call self%properties%reject('granular', 'ExplicitMixtureSolver makes its contacts itself', &
                                  error, 'remove the sections contact, or use ExplicitUSL with &
                                  &SlurryFluidPhase, SlurryMixture and SlurryContact')
      return
    end if
    drag%diameter = self%diameter
    drag%density = self%fluid_density
    drag%carman_kozeny = .true.
    select type (material => model%bodies(self%trio(2))%body%material)
    class is (barotropic_viscous_fluid_t)
      drag%viscosity = material%viscosity
    end select
    mixture%name = 'mixture'
    call mixture%set(model%kin%nvel, self%trio(:2), self%grain_density, drag)
    contact%name = 'contact'
    contact%edges = self%edges
    call contact%set(model%kin%nvel, [self%trio(3), self%trio(1), self%trio(2)], friction)
    deallocate (model%contacts)
    allocate (model%contacts(2))
    allocate (model%contacts(1)%contact, source=mixture)
    allocate (model%contacts(2)%contact, source=contact)
  end subroutine make_contacts

  !> Find what the fluid sees of the grains.
  subroutine mixture_solver_observe(self, model, remapped)
    !> The solver.
    class(explicit_mixture_solver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Velocities are those of the second mapping.
    logical, intent(in) :: remapped

    call self%explicit_usl_t%observe(model, remapped)
    associate (grains => model%bodies(self%trio(1))%body, fluid => model%bodies(self%trio(2))%body)
      if (allocated(self%porosity)) deallocate (self%porosity, self%excess)
      allocate (self%porosity(fluid%points%n_inside), source=1.0_wp)
      allocate (self%excess(fluid%points%n_inside), source=0.0_wp)
      if (.not. (grains%active .and. fluid%active)) return
      call observe_grains(model%grid, self%grain_density, fluid%points, fluid%nodes, &
                          grains%points, grains%nodes, remapped, model%threads, self%porosity, &
                          self%excess)
    end associate
  end subroutine mixture_solver_observe

  !> Advance the points of a body, then their stress; that of the fluid follows its own volume.
  subroutine mixture_solver_advance_body(self, model, body, dt, keep_gradient, error)
    !> The solver.
    class(explicit_mixture_solver_t), intent(inout) :: self
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
    integer :: first_bad

    if (body /= self%trio(2)) then
      call self%explicit_usl_t%advance_body(model, body, dt, keep_gradient, error)
      return
    end if
    call update_points(model, body, dt, .true., error, keep_stress=.true.)
    if (allocated(error)) return
    call model%clock%enter(phase_material)
    call stress_of_fluid(model%bodies(body)%body, model%threads, dt, self%porosity, self%excess, &
                         first_bad)
    if (first_bad == 0) return
    call raise_bad_point(model, model%bodies(body)%body, first_bad, bad_stress, dt, error)
  end subroutine mixture_solver_advance_body

  !> Advance the stress of all points of the fluid, in blocks on all threads.
  subroutine stress_of_fluid(body, threads, dt, porosity, excess, first_bad)
    !> The fluid; its points have moved and hold the velocity gradients of the step.
    class(body_t), intent(inout) :: body
    !> Number of threads.
    integer, intent(in) :: threads
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Porosity. (n_inside)
    real(wp), intent(in) :: porosity(:)
    !> Excess of the rate of the fluid's own volume. [1/s] (n_inside)
    real(wp), intent(in) :: excess(:)
    !> First slot for which there is no stress; 0 when there is none.
    integer, intent(out) :: first_bad
    integer, allocatable :: bad(:)
    integer :: n, block

    n = size(porosity)
    allocate (bad((n + block_size - 1)/block_size))
    !$omp parallel do default(none) schedule(static) num_threads(useful_threads(threads, n)) &
    !$omp shared(body, dt, n, porosity, excess, bad) private(block)
    do block = 1, size(bad)
      call stress_of_block(body%points, body%material, dt, (block - 1)*block_size + 1, &
                           min(block*block_size, n), porosity, excess, bad(block))
    end do
    !$omp end parallel do
    first_bad = 0
    do block = size(bad), 1, -1
      if (bad(block) > 0) first_bad = bad(block)
    end do
  end subroutine stress_of_fluid

  !> Advance the stress of one block of the fluid's points.
  !!
  !! The material gets the fluid's own volume, which gives the pressure, and the velocity gradient
  !! times 1 + 5/2 (1 - n): the viscosity of a suspension.
  subroutine stress_of_block(points, material, dt, a, b, porosity, excess, bad)
    !> The points, moved, with the velocity gradients of the step.
    class(points_t), intent(inout) :: points
    !> Their material.
    class(material_t), intent(in) :: material
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First slot.
    integer, intent(in) :: a
    !> Last slot.
    integer, intent(in) :: b
    !> Porosity. (n_inside)
    real(wp), intent(in) :: porosity(:)
    !> Excess of the rate of the fluid's own volume. [1/s] (n_inside)
    real(wp), intent(in) :: excess(:)
    !> First point for which there is no stress, or 0.
    integer, intent(out) :: bad
    real(wp) :: rate(block_size), growth(block_size)
    real(wp), allocatable :: gradient(:, :)
    integer :: n, p, i

    n = b - a + 1
    call trace_of_gradient(points%kin, n, points%gradient(:, a:b), rate(:n))
    rate(:n) = dt*(rate(:n) + excess(a:b))
    call exponential(n, rate(:n), growth(:n))
    allocate (gradient(points%kin%ngrad, n))
    do p = 1, n
      i = a + p - 1
      gradient(:, p) = (1.0_wp + 2.5_wp*(1.0_wp - porosity(i)))*points%gradient(:, i)
      points%smoothed_volume(i) = points%smoothed_volume(i)*growth(p)
    end do
    call material%update_stress(n, dt, gradient, points%mass(a:b), points%smoothed_volume(a:b), &
                                points%stress(:, a:b), points%history(:, a:b), bad)
    if (points%kin%sim_type == type_axisymmetric) then
      call turn_stress(n, dt, points%gradient(:, a:b), points%stress(:, a:b))
    end if
    if (bad > 0) bad = bad + a - 1
  end subroutine stress_of_block

end module mpm_explicit_mixture_solver
