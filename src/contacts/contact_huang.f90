!> Frictional contact between two bodies at shared nodes.
module mpm_contact_huang
  use mpm_body, only: body_slot_t, body_t
  use mpm_body_list, only: find_body
  use mpm_contact, only: contact_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_point_maps, only: map_mass_gradient
  use mpm_properties, only: properties_t
  use mpm_stencil, only: stencil_t
  use mpm_threads, only: useful_threads
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: contact_huang_t

  !> A normal shorter than this times mass over spacing has no direction.
  real(wp), parameter :: tiny_normal = 1.0e-10_wp

  !> Non-penetration and Coulomb friction between two bodies.
  type, extends(contact_t) :: contact_huang_t
    !> Coefficient of friction.
    real(wp) :: friction = 0.0_wp
    !> Average the normals of both bodies; otherwise that of the first.
    logical :: average_normals = .true.
    !> Positions of the two bodies in the model's list.
    integer :: pair(2) = 0
    !> Bounding box of the nodes that both bodies reach.
    type(window_t) :: window
    !> Unit normals out of the first body; 0 where there is no contact. (nvel, nn)
    real(wp), allocatable :: normal(:, :)
    !> Contact force on the first body. [N] (nvel, nn)
    real(wp), allocatable :: force(:, :)
  contains
    procedure, nopass :: describe => contact_huang_describe
    procedure :: init => contact_huang_init
    procedure :: apply => contact_huang_apply
    procedure :: write_fields => contact_huang_write_fields
    !> Unit normals at the shared nodes.
    procedure, private :: find_normals => contact_huang_find_normals
  end type contact_huang_t

contains

  !> Purpose and properties of the class.
  subroutine contact_huang_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'ContactHuang', &
                          'Two bodies that meet at a node and approach each other get one normal &
                          &velocity there, and Coulomb friction.', &
                          'Huang, Zhang, Ma and Huang, Int. J. Numer. Meth. Engng 85 (2011) &
                          &498-517', &
                          'contact'//nl//'{'//nl//'    class = "ContactHuang"'//nl// &
                          '    name = "collision"'//nl//'    properties = {0.4}'//nl// &
                          '    str-properties = {"block_0", "block_1"}'//nl//'}')
    call description%add_real('mu', '-', 'coefficient of friction', lower=0.0_wp)
    call description%add_integer('id_1', 'first body by its number, from 0, when no names are &
                                 &given', default=-1, lower=0)
    call description%add_integer('id_2', 'second body by its number', default=-1, lower=0)
    call description%add_integer('normals', '1: average the normals of both bodies; 0: take that &
                                 &of the first, as mpm_3d does', default=1, lower=0, upper=1)
    call description%add_string('body_1', 'name of the first body', default='')
    call description%add_string('body_2', 'name of the second body', default='')
    call description%add_note('The normals of two bodies at a node are not opposite to each other; &
                              &the unit normals are averaged. mpm_3d takes that of the first body &
                              &(normals = 0). Nodes where the normal has no direction are skipped.')
    call description%add_note('normals = 1: at nodes on faces of the grid normals lie in the face, &
                              &as if bodies went on beyond it. With normals = 0 they tilt there, &
                              &and bodies between side walls leak past each other.')
    call description%add_note('normals = 1 tilts at corners of a body on a flat one, which hold &
                              &it: there use normals = 0 and name the flat body first.')
    call description%add_note('Contact begins when both bodies reach the same node, up to one cell &
                              &before their points meet.')
    call description%add_note('The fields are 0 at nodes that only one body reaches.')
  end subroutine contact_huang_describe

  !> Find the bodies and set the constants.
  subroutine contact_huang_init(self, grid, bodies, properties, error)
    !> The contact.
    class(contact_huang_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => grid)
    end associate
    self%friction = properties%real('mu')
    self%average_normals = properties%integer('normals') == 1
    call find_body(bodies, properties, 'body_1', 'id_1', self%pair(1), error)
    if (allocated(error)) return
    call find_body(bodies, properties, 'body_2', 'id_2', self%pair(2), error)
    if (allocated(error)) return
    if (self%pair(1) == self%pair(2)) then
      call properties%reject(merge('body_2', 'id_2  ', properties%given('body_2')), &
                             'a contact needs two bodies, but both are "'// &
                             bodies(self%pair(1))%body%name//'"', error, 'name another body')
      return
    end if
    allocate (self%normal(0, 0), self%force(0, 0))
  end subroutine contact_huang_init

  !> Add the contact forces to the nodes of the two bodies.
  subroutine contact_huang_apply(self, grid, bodies, dt, implicit, threads)
    !> The contact.
    class(contact_huang_t), intent(inout) :: self
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

    associate (first => bodies(self%pair(1))%body, second => bodies(self%pair(2))%body)
      self%window%n = 0
      if (first%active .and. second%active) then
        call shared_nodes(first%nodes, second%nodes, self%window)
      end if
      if (self%window%size() == 0) return
      call self%find_normals(grid, first, second, threads)
      deallocate (self%force)
      allocate (self%force(first%nodes%kin%nvel, self%window%size()))
      call add_forces(self%window, self%friction, self%normal, dt, implicit, threads, &
                      first%nodes, second%nodes, self%force)
    end associate
  end subroutine contact_huang_apply

  !> Add the contact forces at all shared nodes.
  subroutine add_forces(window, friction, normal, dt, implicit, threads, first, second, force)
    !> The shared nodes.
    type(window_t), intent(in) :: window
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Unit normals out of the first body, or 0. (nvel, nn)
    real(wp), intent(in) :: normal(:, :)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Use trial momenta that include the forces so far.
    logical, intent(in) :: implicit
    !> Number of threads.
    integer, intent(in) :: threads
    !> Nodes of the first body.
    class(nodes_t), intent(inout) :: first
    !> Nodes of the second body.
    class(nodes_t), intent(inout) :: second
    !> Contact forces on the first body. [N] (nvel, nn)
    real(wp), intent(out) :: force(:, :)
    integer :: i, j, k, node(3), hi(3), here, a, b, nvel

    hi = window%hi()
    nvel = size(normal, 1)
    !$omp parallel do collapse(2) default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, window%size())) &
    !$omp shared(window, friction, normal, dt, implicit, first, second, force, hi, nvel) &
    !$omp private(i, j, k, node, here, a, b)
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          here = window%index(node)
          a = first%window%index(node)
          b = second%window%index(node)
          call node_contact(nvel, dt, implicit, friction, normal(:, here), first%mass(a), &
                            second%mass(b), first%momentum(:, a), second%momentum(:, b), &
                            first%force(:, a), second%force(:, b), force(:, here))
        end do
      end do
    end do
    !$omp end parallel do
  end subroutine add_forces

  !> Bounding box of the nodes that both bodies reach with mass; n = 0 when there are none.
  pure subroutine shared_nodes(a, b, window)
    !> Nodes of the first body.
    class(nodes_t), intent(in) :: a
    !> Nodes of the second body.
    class(nodes_t), intent(in) :: b
    !> The box.
    type(window_t), intent(out) :: window
    type(window_t) :: both
    integer :: i, j, k, node(3), lo(3), hi(3), last(3)

    both = intersect(a%window, b%window)
    last = both%hi()
    lo = huge(1)
    hi = -1
    do k = both%lo(3), last(3)
      do j = both%lo(2), last(2)
        do i = both%lo(1), last(1)
          node = [i, j, k]
          if (.not. a%mass(a%window%index(node)) > 0.0_wp) cycle
          if (.not. b%mass(b%window%index(node)) > 0.0_wp) cycle
          lo = min(lo, node)
          hi = max(hi, node)
        end do
      end do
    end do
    if (any(hi < 0)) return
    window%lo = lo
    window%n = hi - lo + 1
  end subroutine shared_nodes

  !> Unit normals out of the first body at the shared nodes, 0 where there is no direction.
  subroutine contact_huang_find_normals(self, grid, first, second, threads)
    !> The contact.
    class(contact_huang_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> First body.
    class(body_t), intent(in) :: first
    !> Second body.
    class(body_t), intent(in) :: second
    !> Number of threads.
    integer, intent(in) :: threads
    real(wp), allocatable :: other(:, :)
    real(wp) :: h
    integer :: nn, dim

    nn = self%window%size()
    dim = first%points%kin%dim
    associate (spacing => grid%spacing())
      h = minval(spacing(:dim))
    end associate
    deallocate (self%normal)
    allocate (self%normal(first%nodes%kin%nvel, nn))
    if (.not. self%average_normals) then
      call body_normals(first, self%window, h, .false., self%normal)
      return
    end if
    allocate (other(first%nodes%kin%nvel, nn))
    !$omp parallel sections default(none) num_threads(useful_threads(threads, 64*nn)) &
    !$omp shared(self, first, second, h, other)
    !$omp section
    call body_normals(first, self%window, h, .true., self%normal)
    !$omp section
    call body_normals(second, self%window, h, .true., other)
    !$omp end parallel sections
    ! Each is a unit vector or 0, so that one without a direction leaves the other.
    self%normal = self%normal - other
    call normalise(self%normal, spread(tiny_normal, 1, nn))
  end subroutine contact_huang_find_normals

  !> Unit normals out of one body.
  subroutine body_normals(body, window, h, level, normal)
    !> The body.
    class(body_t), intent(in) :: body
    !> The nodes wanted.
    type(window_t), intent(in) :: window
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: h
    !> The body goes on beyond the faces of the grid; otherwise it ends there, as in mpm_3d.
    logical, intent(in) :: level
    !> Unit vectors, or 0 where the mass around is balanced. (nvel, nn)
    real(wp), intent(out) :: normal(:, :)
    real(wp) :: floor(size(normal, 2))
    integer :: i, j, k, node(3), hi(3)

    call map_mass_gradient(body%points, window, normal)
    if (level) call level_at_faces(body%points%stencil, window, normal)
    hi = window%hi()
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          floor(window%index(node)) = tiny_normal*body%nodes%mass(body%nodes%window%index(node))/h
        end do
      end do
    end do
    call normalise(normal, floor)
  end subroutine body_normals

  !> Drop the components across faces of the grid at the nodes of these faces.
  !!
  !! The grid cuts bodies off there: their gradient lacks the mass beyond the face and points out of
  !! the grid. A vector that would vanish keeps its components.
  pure subroutine level_at_faces(stencil, window, normal)
    !> Basis of the body.
    type(stencil_t), intent(in) :: stencil
    !> Nodes of the vectors.
    type(window_t), intent(in) :: window
    !> Vectors. (nvel, nn)
    real(wp), intent(inout) :: normal(:, :)
    real(wp) :: levelled(size(normal, 1))
    integer :: i, j, k, d, node(3), hi(3), here

    hi = window%hi()
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          here = window%index(node)
          levelled = normal(:, here)
          do d = 1, stencil%dim
            if (stencil%periodic(d)) cycle
            if (on_face(stencil, d, node)) levelled(d) = 0.0_wp
          end do
          if (norm2(levelled) > tiny_normal*norm2(normal(:, here))) normal(:, here) = levelled
        end do
      end do
    end do
  end subroutine level_at_faces

  !> Whether a node is on a face of the grid across a direction; of a mesh on that of its box.
  pure function on_face(stencil, d, node)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The direction.
    integer, intent(in) :: d
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Whether it is.
    logical :: on_face

    if (allocated(stencil%mesh)) then
      on_face = stencil%mesh%on_box(node(1) + 1, d)
    else
      on_face = node(d) == 0 .or. node(d) == stencil%n_cells(d)
    end if
  end function on_face

  !> Make vectors unit vectors; those not longer than their floor become 0.
  pure subroutine normalise(vectors, floor)
    !> Vectors. (nvel, nn)
    real(wp), intent(inout) :: vectors(:, :)
    !> Lengths at or below which a vector has no direction. (nn)
    real(wp), intent(in) :: floor(:)
    real(wp) :: length
    integer :: i

    do i = 1, size(vectors, 2)
      length = norm2(vectors(:, i))
      if (length > floor(i)) then
        vectors(:, i) = vectors(:, i)/length
      else
        vectors(:, i) = 0.0_wp
      end if
    end do
  end subroutine normalise

  !> Contact forces at one node.
  pure subroutine node_contact(nvel, dt, implicit, friction, normal, m1, m2, p1, p2, f1, f2, force)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Use trial momenta that include the forces so far.
    logical, intent(in) :: implicit
    !> Coefficient of friction.
    real(wp), intent(in) :: friction
    !> Unit normal out of body 1, or 0.
    real(wp), intent(in) :: normal(nvel)
    !> Mass of body 1. [kg]
    real(wp), intent(in) :: m1
    !> Mass of body 2. [kg]
    real(wp), intent(in) :: m2
    !> Momentum of body 1. [kg m/s]
    real(wp), intent(in) :: p1(nvel)
    !> Momentum of body 2. [kg m/s]
    real(wp), intent(in) :: p2(nvel)
    !> Force on body 1. [N]
    real(wp), intent(inout) :: f1(nvel)
    !> Force on body 2. [N]
    real(wp), intent(inout) :: f2(nvel)
    !> Contact force on body 1. [N]
    real(wp), intent(out) :: force(nvel)
    real(wp) :: trial1(nvel), trial2(nvel), stick(nvel), pull, slip(nvel), size_of_slip

    force = 0.0_wp
    if (.not. (m1 > 0.0_wp .and. m2 > 0.0_wp)) return
    trial1 = p1
    trial2 = p2
    if (implicit) then
      trial1 = trial1 + dt*f1
      trial2 = trial2 + dt*f2
    end if
    ! The force that gives body 1 the common velocity: m1 (w_c - w_1)/dt.
    stick = (m1*trial2 - m2*trial1)/((m1 + m2)*dt)
    pull = dot_product(stick, normal)
    if (.not. pull < 0.0_wp) return
    slip = stick - pull*normal
    size_of_slip = norm2(slip)
    force = pull*normal
    if (size_of_slip > 0.0_wp) then
      force = force + min(friction*abs(pull)/size_of_slip, 1.0_wp)*slip
    end if
    f1 = f1 + force
    f2 = f2 - force
  end subroutine node_contact

  !> Send the fields of a frame.
  subroutine contact_huang_write_fields(self, bodies, writer)
    !> The contact.
    class(contact_huang_t), intent(in) :: self
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    character(:), allocatable :: first, second
    real(wp) :: nothing(bodies(1)%body%nodes%kin%nvel, 0)

    first = bodies(self%pair(1))%body%name
    second = bodies(self%pair(2))%body%name
    if (self%window%size() > 0) then
      call writer%vector('contact_normal_'//first//'_'//second, self%normal, self%window)
      call writer%vector('contact_force_by_'//second//'_on_'//first, self%force, self%window)
    else
      call writer%vector('contact_normal_'//first//'_'//second, nothing, self%window)
      call writer%vector('contact_force_by_'//second//'_on_'//first, nothing, self%window)
    end if
  end subroutine contact_huang_write_fields

end module mpm_contact_huang
