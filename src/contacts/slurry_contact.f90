!> Contact of a solid with grains and the fluid in their pores.
module mpm_slurry_contact
  use mpm_body, only: body_slot_t
  use mpm_body_list, only: find_body
  use mpm_contact, only: contact_t
  use mpm_contact_normals, only: body_normals, edges_cut
  use mpm_contact_pair, only: shared_nodes, smallest_spacing
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_properties, only: properties_t
  use mpm_threads, only: useful_threads
  use mpm_window, only: window_t
  implicit none
  private
  public :: add_slurry_contact_properties, slurry_contact_t

  !> Neither grains nor fluid enter the solid; grains rub, fluid slips.
  type, extends(contact_t) :: slurry_contact_t
    !> Coefficient of friction of the grains.
    real(wp) :: friction = 0.0_wp
    !> What faces of the grid are to the normals of the solid, as in `mpm_contact_normals`.
    integer :: edges = edges_cut
    !> Positions of solid, grains and fluid in the model's list.
    integer :: trio(3) = 0
    !> Bounding box of the nodes that the solid shares with one of the others.
    type(window_t) :: window
    !> Unit normals out of the solid; 0 where it has none. (nvel, nn)
    real(wp), allocatable :: normal(:, :)
    !> Contact force on the solid. [N] (nvel, nn)
    real(wp), allocatable :: force(:, :)
  contains
    procedure, nopass :: describe => slurry_contact_describe
    procedure :: init => slurry_contact_init
    !> Set the constants and bodies.
    procedure :: set => slurry_contact_set
    procedure :: apply => slurry_contact_apply
    procedure :: write_fields => slurry_contact_write_fields
  end type slurry_contact_t

contains

  !> Purpose and properties of the class.
  subroutine slurry_contact_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'SlurryContact', &
                          'A solid that meets grains and the fluid in their pores: one normal &
                          &velocity for those that approach it, Coulomb friction of the grains.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764; Huang, Zhang, &
                          &Ma and Huang, Int. J. Numer. Meth. Engng 85 (2011) 498-517', &
                          'contact'//nl//'{'//nl//'    class = "SlurryContact"'//nl// &
                          '    name = "impact"'//nl//'    properties = {0.4}'//nl// &
                          '    str-properties = {"block_0", "block_1", "projectile"}'//nl//'}')
    call add_slurry_contact_properties(description)
    call description%add_note('The normals are those of the solid as far as it is in the grid: &
                              &SlurryContact_ReflectedBoundary is for solids that touch its faces.')
  end subroutine slurry_contact_describe

  !> Add the properties and remarks of both classes.
  subroutine add_slurry_contact_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_real('mu', '-', 'coefficient of friction between solid and grains', &
                              lower=0.0_wp)
    call description%add_integer('solid_id', 'solid by its number, from 0, when no names are &
                                 &given', default=-1, lower=0)
    call description%add_integer('grains_id', 'grains by their number', default=-1, lower=0)
    call description%add_integer('fluid_id', 'fluid by its number', default=-1, lower=0)
    call description%add_string('solid', 'name of the solid, which gives the normals', default='')
    call description%add_string('grains', 'name of the grains', default='')
    call description%add_string('fluid', 'name of the fluid', default='')
    call description%add_note('Nothing pulls: where grains or fluid would be held back by the &
                              &other, they leave. In mpm_3d forces may pull there.')
    call description%add_note('Grains stick where friction can hold them; mpm_3d lacks a division &
                              &by dt, and nothing sticks.')
    call description%add_note('Nodes where the normal has no direction are skipped; in mpm_3d &
                              &they make the forces of all three bodies NaN.')
    call description%add_note('Name it behind the SlurryMixture of grains and fluid, so that it &
                              &sees the forces of that one.')
  end subroutine add_slurry_contact_properties

  !> Find the bodies and set the constants.
  subroutine slurry_contact_init(self, grid, bodies, properties, error)
    !> The contact.
    class(slurry_contact_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error
    character(6), parameter :: names(3) = ['solid ', 'grains', 'fluid ']
    integer :: trio(3), i

    do i = 1, 3
      call find_body(bodies, properties, trim(names(i)), trim(names(i))//'_id', trio(i), error)
      if (allocated(error)) return
      if (all(trio(:i - 1) /= trio(i))) cycle
      call properties%reject(trim(names(i))//trim(merge('   ', '_id', &
                                                        properties%given(trim(names(i))))), &
                             'the contact needs three bodies, but "'// &
                             bodies(trio(i))%body%name//'" is given twice', error, &
                             'name another body')
      return
    end do
    call self%set(grid%kin%nvel, trio, properties%real('mu'))
  end subroutine slurry_contact_init

  !> Set the constants and bodies.
  subroutine slurry_contact_set(self, nvel, trio, friction)
    !> The contact.
    class(slurry_contact_t), intent(inout) :: self
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Positions of solid, grains and fluid in the model's list.
    integer, intent(in) :: trio(3)
    !> Coefficient of friction of the grains.
    real(wp), intent(in) :: friction

    self%trio = trio
    self%friction = friction
    if (.not. allocated(self%normal)) allocate (self%normal(nvel, 0), self%force(nvel, 0))
  end subroutine slurry_contact_set

  !> Add the contact forces to the nodes of the three bodies.
  subroutine slurry_contact_apply(self, grid, bodies, dt, implicit, threads)
    !> The contact.
    class(slurry_contact_t), intent(inout) :: self
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
    type(window_t) :: parts(2)
    logical :: there(2)
    integer :: i, nn

    self%window%n = 0
    associate (solid => bodies(self%trio(1))%body, grains => bodies(self%trio(2))%body, &
               fluid => bodies(self%trio(3))%body)
      if (.not. solid%active) return
      there = [grains%active, fluid%active]
      if (there(1)) call shared_nodes(solid%nodes, grains%nodes, parts(1))
      if (there(2)) call shared_nodes(solid%nodes, fluid%nodes, parts(2))
      do i = 1, 2
        if (parts(i)%size() > 0) self%window = hull(self%window, parts(i))
      end do
      nn = self%window%size()
      if (nn == 0) return
      deallocate (self%normal, self%force)
      allocate (self%normal(grid%kin%nvel, nn), self%force(grid%kin%nvel, nn))
      call body_normals(solid, self%window, smallest_spacing(grid), self%edges, self%normal)
      call add_forces(self%window, self%friction, self%normal, dt, implicit, threads, there, &
                      solid%nodes, grains%nodes, fluid%nodes, self%force)
    end associate
  end subroutine slurry_contact_apply

  !> The box around two boxes; the first may be empty.
  pure function hull(a, b) result(both)
    !> First box.
    type(window_t), intent(in) :: a
    !> Second box.
    type(window_t), intent(in) :: b
    !> The box around them.
    type(window_t) :: both

    both = b
    if (a%size() == 0) return
    both%lo = min(a%lo, b%lo)
    both%n = max(a%hi(), b%hi()) - both%lo + 1
  end function hull

  !> Add the contact forces at all nodes of the window.
  subroutine add_forces(window, friction, normal, dt, implicit, threads, there, solid, grains, &
                        fluid, force)
    !> The nodes.
    type(window_t), intent(in) :: window
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Unit normals out of the solid, or 0. (nvel, nn)
    real(wp), intent(in) :: normal(:, :)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Use trial momenta that include the forces so far.
    logical, intent(in) :: implicit
    !> Number of threads.
    integer, intent(in) :: threads
    !> Whether grains and fluid are active.
    logical, intent(in) :: there(2)
    !> Nodes of the solid.
    class(nodes_t), intent(inout) :: solid
    !> Nodes of the grains.
    class(nodes_t), intent(inout) :: grains
    !> Nodes of the fluid.
    class(nodes_t), intent(inout) :: fluid
    !> Contact forces on the solid. [N] (nvel, nn)
    real(wp), intent(out) :: force(:, :)
    integer :: i, at(3), node(3), nvel
    real(wp) :: m(3), f(3, 3), p(3, 3)

    nvel = size(normal, 1)
    !$omp parallel do default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, window%size())) &
    !$omp shared(window, friction, normal, dt, implicit, there, solid, grains, fluid, force) &
    !$omp shared(nvel) private(i, at, node, m, f, p)
    do i = 1, window%size()
      node = window%node(i)
      at = 0
      if (solid%window%holds(node)) at(1) = solid%window%index(node)
      if (there(1) .and. grains%window%holds(node)) at(2) = grains%window%index(node)
      if (there(2) .and. fluid%window%holds(node)) at(3) = fluid%window%index(node)
      m = 0.0_wp
      p = 0.0_wp
      if (at(1) > 0) call read_node(solid, at(1), dt, implicit, m(1), p(:nvel, 1))
      if (at(2) > 0) call read_node(grains, at(2), dt, implicit, m(2), p(:nvel, 2))
      if (at(3) > 0) call read_node(fluid, at(3), dt, implicit, m(3), p(:nvel, 3))
      call node_contact(dt, friction, normal(:, i), m, p(:nvel, :), f(:nvel, 2:3))
      force(:, i) = -(f(:nvel, 2) + f(:nvel, 3))
      if (at(1) > 0) solid%force(:, at(1)) = solid%force(:, at(1)) + force(:, i)
      if (at(2) > 0) grains%force(:, at(2)) = grains%force(:, at(2)) + f(:nvel, 2)
      if (at(3) > 0) fluid%force(:, at(3)) = fluid%force(:, at(3)) + f(:nvel, 3)
    end do
    !$omp end parallel do
  end subroutine add_forces

  !> Mass and trial momentum of a node.
  pure subroutine read_node(nodes, i, dt, implicit, mass, momentum)
    !> The nodes.
    class(nodes_t), intent(in) :: nodes
    !> Position of the node.
    integer, intent(in) :: i
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Include the forces so far.
    logical, intent(in) :: implicit
    !> The mass. [kg]
    real(wp), intent(out) :: mass
    !> The momentum. [kg m/s]
    real(wp), intent(out) :: momentum(:)

    mass = nodes%mass(i)
    momentum = nodes%momentum(:, i)
    if (implicit) momentum = momentum + dt*nodes%force(:, i)
  end subroutine read_node

  !> Forces on grains and fluid at one node.
  pure subroutine node_contact(dt, friction, normal, m, p, f)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Unit normal out of the solid, or 0.
    real(wp), intent(in) :: normal(:)
    !> Masses of solid, grains and fluid; 0 of those that are not there. [kg]
    real(wp), intent(in) :: m(3)
    !> Their trial momenta. [kg m/s] (nvel, 3)
    real(wp), intent(in) :: p(:, :)
    !> Forces on grains and fluid. [N] (nvel, 2)
    real(wp), intent(out) :: f(:, :)
    real(wp) :: push(2), stick(size(normal)), size_of_stick, along(3)
    integer :: k

    f = 0.0_wp
    if (.not. (m(1) > 0.0_wp .and. any(m(2:) > 0.0_wp))) return
    do k = 1, 3
      along(k) = dot_product(normal, p(:, k))
    end do
    push = pushes(dt, m, along)
    f(:, 1) = push(1)*normal
    f(:, 2) = push(2)*normal
    if (.not. (push(1) > 0.0_wp .and. friction > 0.0_wp)) return
    ! The force that gives grains and solid one velocity along the surface.
    stick = (m(2)*(p(:, 1) - dt*(f(:, 1) + f(:, 2))) - m(1)*(p(:, 2) + dt*f(:, 1))) &
            /((m(1) + m(2))*dt)
    stick = stick - dot_product(stick, normal)*normal
    size_of_stick = norm2(stick)
    if (size_of_stick > 0.0_wp) then
      f(:, 1) = f(:, 1) + min(friction*push(1)/size_of_stick, 1.0_wp)*stick
    end if
  end subroutine node_contact

  !> Normal forces on grains and fluid, none of which pulls.
  !!
  !! If both approach the solid all three get one velocity, unless that would hold one of them back:
  !! then the solid and the other one get theirs, which is below that of the first.
  pure function pushes(dt, m, p) result(f)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Masses of solid, grains and fluid. [kg]
    real(wp), intent(in) :: m(3)
    !> Their momenta along the normal. [kg m/s]
    real(wp), intent(in) :: p(3)
    !> Forces along the normal. [N]
    real(wp) :: f(2)
    logical :: meets(2)

    f = 0.0_wp
    meets = m(2:) > 0.0_wp .and. m(2:)*p(1) - m(1)*p(2:) > 0.0_wp
    if (all(meets)) then
      ! m_k (w - w_k)/dt with the common velocity w.
      f = (m(2:)*sum(p) - sum(m)*p(2:))/(sum(m)*dt)
      if (all(f >= 0.0_wp)) return
      meets = f >= 0.0_wp
    end if
    f = 0.0_wp
    where (meets) f = (m(2:)*p(1) - m(1)*p(2:))/((m(1) + m(2:))*dt)
  end function pushes

  !> Send the fields of a frame.
  subroutine slurry_contact_write_fields(self, bodies, writer)
    !> The contact.
    class(slurry_contact_t), intent(in) :: self
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    integer :: nn

    nn = self%window%size()
    associate (solid => bodies(self%trio(1))%body%name, grains => bodies(self%trio(2))%body%name, &
               fluid => bodies(self%trio(3))%body%name)
      call writer%vector('contact_normal_'//solid//'_'//grains, self%normal(:, :nn), self%window)
      call writer%vector('contact_force_by_'//grains//'_and_'//fluid//'_on_'//solid, &
                         self%force(:, :nn), self%window)
    end associate
  end subroutine slurry_contact_write_fields

end module mpm_slurry_contact
