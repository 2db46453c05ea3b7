!> Buoyancy and drag between grains and the fluid in their pores.
module mpm_slurry_mixture
  use mpm_body, only: body_slot_t
  use mpm_body_list, only: find_body
  use mpm_contact, only: contact_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_point_maps, only: map_points
  use mpm_points, only: points_t
  use mpm_pore_drag, only: pore_drag_t
  use mpm_pore_fluid, only: find_porosity
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t, to_text
  use mpm_threads, only: useful_threads
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: slurry_mixture_t

  !> Trial momenta: as the solver says, without forces, with them.
  integer, parameter :: as_solver = -1, explicit = 0, with_forces = 1

  !> Grains and pore fluid share the pressure gradient and drag each other along.
  type, extends(contact_t) :: slurry_mixture_t
    !> The drag.
    type(pore_drag_t) :: drag
    !> Density of the grains. [kg/m3]
    real(wp) :: grain_density = 0.0_wp
    !> Momenta that the drag is formed of.
    integer :: trial = as_solver
    !> Positions of grains and fluid in the model's list.
    integer :: pair(2) = 0
    !> Nodes that both bodies may reach.
    type(window_t) :: window
    !> Porosity, 0 at nodes that one of them does not reach. (nn)
    real(wp), allocatable :: porosity(:)
    !> Force of the pressure gradient on the mixture. [N] (nvel, nn)
    real(wp), allocatable :: push(:, :)
    !> Volume of the fluid's points. [m3] (nn)
    real(wp), allocatable :: volume(:)
  contains
    procedure, nopass :: describe => slurry_mixture_describe
    procedure :: init => slurry_mixture_init
    !> Set the constants and bodies.
    procedure :: set => slurry_mixture_set
    procedure :: apply => slurry_mixture_apply
    procedure :: write_fields => slurry_mixture_write_fields
    procedure, private :: read_choices
  end type slurry_mixture_t

contains

  !> Purpose and properties of the class.
  subroutine slurry_mixture_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'SlurryMixture', &
                          'Grains and the fluid in their pores: buoyancy by the gradient of the &
                          &pore pressure, and drag.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764; Carman, &
                          &Trans. IChemE 15 (1937) 150-166; Beetstra, van der Hoef and Kuipers, &
                          &AIChE J. 53 (2007) 489-501', &
                          'contact'//nl//'{'//nl//'    class = "SlurryMixture"'//nl// &
                          '    name = "mixture"'//nl// &
                          '    properties = {rho_grain = 2700, d_grain = 1e-3, eta_0 = 1e-3, &
                          &rho_fluid = 1000}'//nl// &
                          '    str-properties = {"block_0", "block_1", "USE_CARMAN_KOZENY"}'//nl// &
                          '}')
    call description%add_real('rho_grain', 'kg/m3', 'density of the grains', above=0.0_wp)
    call description%add_real('d_grain', 'm', 'diameter of the grains', above=0.0_wp)
    call description%add_real('eta_0', 'Pa s', 'viscosity of the pure fluid', above=0.0_wp)
    call description%add_real('rho_fluid', 'kg/m3', 'density of the fluid, for the Reynolds number &
                              &of the drag', lower=0.0_wp)
    call description%add_integer('grains_id', 'grains by their number, from 0, when no names are &
                                 &given; alone and with names: the flag "contact"', default=-1, &
                                 lower=0)
    call description%add_integer('fluid_id', 'fluid by its number', default=-1, lower=0)
    call description%add_integer('contact', '1: drag of trial momenta with all forces so far; 0: &
                                 &of the momenta of the start of the step; left out: as the solver &
                                 &does contacts', default=-1, lower=0, upper=1)
    call description%add_string('grains', 'name of the grains', default='')
    call description%add_string('fluid', 'name of the fluid', default='')
    call description%add_string('flags', 'USE_CARMAN_KOZENY: drag of dense packings; otherwise &
                                &that of Beetstra et al., which goes over to single grains and &
                                &fast flow', is_list=.true.)
    call description%add_note('Points of either body stand for the space that the mixture fills: &
                              &the mass of a fluid point is n rho_fluid V, that of a grain point &
                              &(1 - n) rho_grain V.')
    call description%add_note('The drag is found with the velocities at the end of the step, &
                              &without other forces: it never turns the relative motion around, &
                              &whatever dt.')
    call description%add_note('TYPE 4: drag and buoyancy have the factor r that all forces have, &
                              &and the pressure acts along r as it does in the fluid itself; &
                              &mpm_3d lacks both.')
    call description%add_note('SlurryFluidPhase and the classes of grains may name each other for &
                              &porosity and viscosity; the contact works with any materials.')
    call description%add_note('Fields: n_<grains>_<fluid>, the porosity, and divT, the nodal force &
                              &of the pressure gradient; both are 0 at nodes that one of the &
                              &bodies does not reach.')
  end subroutine slurry_mixture_describe

  !> Find the bodies and set the constants.
  subroutine slurry_mixture_init(self, grid, bodies, properties, error)
    !> The contact.
    class(slurry_mixture_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, one body twice, or an unknown flag.
    type(error_t), allocatable, intent(out) :: error
    integer :: pair(2)

    call find_body(bodies, properties, 'grains', 'grains_id', pair(1), error)
    if (allocated(error)) return
    call find_body(bodies, properties, 'fluid', 'fluid_id', pair(2), error)
    if (allocated(error)) return
    if (pair(1) == pair(2)) then
      call properties%reject(merge('fluid   ', 'fluid_id', properties%given('fluid')), &
                             'a mixture needs two bodies, but both are "'// &
                             bodies(pair(1))%body%name//'"', error, 'name another body')
      return
    end if
    call self%set(grid%kin%nvel, pair, properties%real('rho_grain'), &
                  pore_drag_t(diameter=properties%real('d_grain'), &
                              viscosity=properties%real('eta_0'), &
                              density=properties%real('rho_fluid')))
    call self%read_choices(properties, error)
  end subroutine slurry_mixture_init

  !> Set the constants and bodies.
  subroutine slurry_mixture_set(self, nvel, pair, grain_density, drag)
    !> The contact.
    class(slurry_mixture_t), intent(inout) :: self
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Positions of grains and fluid in the model's list.
    integer, intent(in) :: pair(2)
    !> Density of the grains. [kg/m3]
    real(wp), intent(in) :: grain_density
    !> The drag.
    type(pore_drag_t), intent(in) :: drag

    self%pair = pair
    self%grain_density = grain_density
    self%drag = drag
    if (.not. allocated(self%push)) then
      allocate (self%push(nvel, 0), self%porosity(0), self%volume(0))
    end if
  end subroutine slurry_mixture_set

  !> Read the flags, and which momenta the drag is formed of.
  subroutine read_choices(self, properties, error)
    !> The contact.
    class(slurry_mixture_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An unknown flag.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    integer :: i

    self%trial = as_solver
    if (properties%given('contact')) then
      self%trial = properties%integer('contact')
    else if (properties%given('grains') .and. properties%given('grains_id') .and. &
             .not. properties%given('fluid_id')) then
      ! mpm_3d: a single integer beside names.
      self%trial = properties%integer('grains_id')
      if (self%trial > with_forces) then
        call properties%reject('grains_id', 'a contact flag of '//to_text(self%trial), error, &
                               'a single integer beside the names of the bodies is the flag &
                               &"contact": 0 or 1')
        return
      end if
    end if
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      if (flags(i)%text /= 'USE_CARMAN_KOZENY') then
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               '"USE_CARMAN_KOZENY"   (mpm3d --describe SlurryMixture)')
        return
      end if
      self%drag%carman_kozeny = .true.
    end do
  end subroutine read_choices

  !> Add buoyancy and drag to the nodes of grains and fluid.
  subroutine slurry_mixture_apply(self, grid, bodies, dt, implicit, threads)
    !> The contact.
    class(slurry_mixture_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job, with the forces of this step so far.
    type(body_slot_t), intent(inout) :: bodies(:)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Use trial momenta that include the forces so far.
    logical, intent(in) :: implicit
    !> Number of threads.
    integer, intent(in) :: threads
    logical :: with_them
    integer :: nn

    with_them = implicit
    if (self%trial /= as_solver) with_them = self%trial /= explicit
    associate (grains => bodies(self%pair(1))%body, fluid => bodies(self%pair(2))%body)
      self%window%n = 0
      if (.not. (grains%active .and. fluid%active)) return
      if (grains%points%n_inside == 0 .or. fluid%points%n_inside == 0) return
      self%window = intersect(grains%nodes%window, fluid%nodes%window)
      nn = self%window%size()
      if (nn == 0) return
      deallocate (self%porosity, self%push, self%volume)
      allocate (self%porosity(nn), self%push(grid%kin%nvel, nn), self%volume(nn))
      call find_porosity(grid, self%grain_density, grains%points, grains%nodes, self%window, &
                         threads, self%porosity)
      call find_push(fluid%points, fluid%nodes%window, self%window, threads, self%push, &
                     self%volume)
      call add_forces(self, dt, with_them, threads, grains%points%mass_cutoff, &
                      fluid%points%mass_cutoff, grains%nodes, fluid%nodes)
    end associate
  end subroutine slurry_mixture_apply

  !> Force of the pressure gradient of a fluid, sum_p p_p V_p grad N_i, and its volume at the nodes.
  !!
  !! The force is mapped as the internal force of the fluid is, in TYPE 4 with its part along r, so
  !! that what one body gets is missing in the other to the last bit but rounding.
  subroutine find_push(fluid, reach, window, threads, push, volume)
    !> Points of the fluid, mapped.
    class(points_t), intent(in) :: fluid
    !> Window of its nodes.
    type(window_t), intent(in) :: reach
    !> Nodes that are asked for, in that window.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Forces. [N] (nvel, nn)
    real(wp), intent(out) :: push(:, :)
    !> Volumes. [m3] (nn)
    real(wp), intent(out) :: volume(:)
    real(wp), allocatable :: stress(:, :), specific(:, :), mass(:), sums(:, :), force(:, :)
    integer :: n, p, i, there

    n = fluid%n_inside
    associate (kin => fluid%kin)
      allocate (stress(kin%nstress, n), specific(kin%nvel, n), source=0.0_wp)
      allocate (mass(reach%size()), sums(kin%nvel, reach%size()), force(kin%nvel, reach%size()))
    end associate
    do p = 1, n
      stress(1:3, p) = sum(fluid%stress(1:3, p))/3.0_wp
      ! Mapped as a momentum: m_p (V_p/m_p).
      specific(1, p) = fluid%volume(p)/fluid%mass(p)
    end do
    call map_points(fluid, reach, threads, specific, stress, mass, sums, force)
    do i = 1, size(volume)
      there = reach%index(window%node(i))
      volume(i) = sums(1, there)
      push(:, i) = force(:, there)
    end do
  end subroutine find_push

  !> Add buoyancy and drag at all nodes that both bodies reach.
  subroutine add_forces(self, dt, implicit, threads, light_grains, light_fluid, grains, fluid)
    !> The contact.
    class(slurry_mixture_t), intent(inout) :: self
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Use trial momenta that include the forces so far.
    logical, intent(in) :: implicit
    !> Number of threads.
    integer, intent(in) :: threads
    !> Mass at or below which a node of the grains is negligible. [kg]
    real(wp), intent(in) :: light_grains
    !> The same for the fluid. [kg]
    real(wp), intent(in) :: light_fluid
    !> Nodes of the grains.
    class(nodes_t), intent(inout) :: grains
    !> Nodes of the fluid.
    class(nodes_t), intent(inout) :: fluid
    integer :: i, a, b, nvel, node(3)
    real(wp) :: buoyancy(3), friction(3), slip(3)

    nvel = grains%kin%nvel
    !$omp parallel do default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, self%window%size())) &
    !$omp shared(self, dt, implicit, light_grains, light_fluid, grains, fluid, nvel) &
    !$omp private(i, a, b, node, buoyancy, friction, slip)
    do i = 1, self%window%size()
      node = self%window%node(i)
      a = grains%window%index(node)
      b = fluid%window%index(node)
      if (.not. (grains%mass(a) > 0.0_wp .and. fluid%mass(b) > 0.0_wp)) then
        self%porosity(i) = 0.0_wp
        self%push(:, i) = 0.0_wp
        cycle
      end if
      buoyancy(:nvel) = (1.0_wp - self%porosity(i))*self%push(:, i)
      call add_force(grains, a, light_grains, buoyancy(:nvel))
      call add_force(fluid, b, light_fluid, -buoyancy(:nvel))
      slip(:nvel) = trial_velocity(grains, a, dt, implicit) &
                    - trial_velocity(fluid, b, dt, implicit)
      friction(:nvel) = self%drag%force(self%porosity(i), self%volume(i), dt, grains%mass(a), &
                                        fluid%mass(b), slip(:nvel))
      grains%force(:, a) = grains%force(:, a) - friction(:nvel)
      fluid%force(:, b) = fluid%force(:, b) + friction(:nvel)
    end do
    !$omp end parallel do
  end subroutine add_forces

  !> Add an internal force to a node; where its mass is negligible the force waits as an increment,
  !! as that of the body's own stress does.
  pure subroutine add_force(nodes, i, light, force)
    !> The nodes.
    class(nodes_t), intent(inout) :: nodes
    !> Position of the node.
    integer, intent(in) :: i
    !> Mass at or below which a node is negligible. [kg]
    real(wp), intent(in) :: light
    !> The force. [N]
    real(wp), intent(in) :: force(:)

    if (nodes%mass(i) <= light) then
      nodes%increment(:, i) = nodes%increment(:, i) + force/nodes%mass(i)
    else
      nodes%force(:, i) = nodes%force(:, i) + force
    end if
  end subroutine add_force

  !> Velocity of a node at the start of the step, or with the forces so far.
  pure function trial_velocity(nodes, i, dt, implicit) result(velocity)
    !> The nodes.
    class(nodes_t), intent(in) :: nodes
    !> Position of the node.
    integer, intent(in) :: i
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Count the forces so far.
    logical, intent(in) :: implicit
    !> The velocity. [m/s]
    real(wp) :: velocity(nodes%kin%nvel)

    if (implicit) then
      velocity = (nodes%momentum(:, i) + dt*nodes%force(:, i))/nodes%mass(i)
    else
      velocity = nodes%momentum(:, i)/nodes%mass(i)
    end if
  end function trial_velocity

  !> Send the fields of a frame.
  subroutine slurry_mixture_write_fields(self, bodies, writer)
    !> The contact.
    class(slurry_mixture_t), intent(in) :: self
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    integer :: nn

    nn = self%window%size()
    associate (grains => bodies(self%pair(1))%body%name, fluid => bodies(self%pair(2))%body%name)
      call writer%scalar('n_'//grains//'_'//fluid, self%porosity(:nn), self%window)
      call writer%vector('divT', self%push(:, :nn), self%window)
    end associate
  end subroutine slurry_mixture_write_fields

end module mpm_slurry_mixture
