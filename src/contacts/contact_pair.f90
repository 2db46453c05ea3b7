!> Contacts between two bodies: the bodies, their shared nodes, normals, forces and fields.
module mpm_contact_pair
  use mpm_body, only: body_slot_t, body_t
  use mpm_body_list, only: find_body
  use mpm_contact, only: contact_t
  use mpm_contact_law, only: contact_law_t
  use mpm_contact_normals, only: body_normals, edges_cut, edges_mirror, mean_normals
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_properties, only: properties_t
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: add_mirror_notes, add_pair_properties, contact_pair_t, shared_nodes, smallest_spacing
  public :: normals_first, normals_mean, normals_mirrored, normals_none

  !> The law needs no normals.
  integer, parameter :: normals_none = -1
  !> Those of the first body.
  integer, parameter :: normals_first = 0
  !> The mean of those of both bodies.
  integer, parameter :: normals_mean = 1
  !> Those of the first body, as if it went on beyond the faces of the grid.
  integer, parameter :: normals_mirrored = 2

  !> A contact between two bodies.
  !!
  !! Its class names the bodies, the law and the normals in `init`; the rest is the same for all.
  type, abstract, extends(contact_t) :: contact_pair_t
    !> What the bodies do to each other.
    type(contact_law_t) :: law
    !> One of the `normals_*`.
    integer :: normals = normals_mean
    !> Positions of the two bodies in the model's list.
    integer :: pair(2) = 0
    !> Bounding box of the nodes that both bodies reach.
    type(window_t) :: window
    !> Unit normals out of the first body; 0 where there is no contact. (nvel, nn)
    real(wp), allocatable :: normal(:, :)
    !> Contact force on the first body. [N] (nvel, nn)
    real(wp), allocatable :: force(:, :)
  contains
    !> Find the bodies that the properties name.
    procedure :: find_bodies => contact_pair_find_bodies
    procedure :: apply => contact_pair_apply
    procedure :: write_fields => contact_pair_write_fields
    !> Send a nodal field, or nothing of it when the bodies share no node.
    procedure :: send => contact_pair_send
    !> Unit normals at the shared nodes.
    procedure, private :: find_normals => contact_pair_find_normals
  end type contact_pair_t

contains

  !> Add the properties that name the two bodies, behind the integers and strings there are.
  subroutine add_pair_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_integer('id_1', 'first body by its number, from 0, when no names are &
                                 &given', default=-1, lower=0)
    call description%add_integer('id_2', 'second body by its number', default=-1, lower=0)
    call description%add_string('body_1', 'name of the first body', default='')
    call description%add_string('body_2', 'name of the second body', default='')
  end subroutine add_pair_properties

  !> Remarks on mirrored normals.
  subroutine add_mirror_notes(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_note('The normal is that of the first body, without the components across &
                              &faces of the grid at the nodes of these faces, so that at a &
                              &symmetry plane or a wall the body seems to go on. The faces are &
                              &those of the grid, wherever its lower corner is, and none where it &
                              &is periodic; mpm_3d takes coordinate 0 as the lower face.')
    call description%add_note('Nodes where nothing is left of the normal, as in corners of the &
                              &grid, are skipped.')
  end subroutine add_mirror_notes

  !> Find the bodies that the properties name.
  subroutine contact_pair_find_bodies(self, grid, bodies, properties, error)
    !> The contact.
    class(contact_pair_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error

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
    if (allocated(self%normal)) deallocate (self%normal, self%force)
    allocate (self%normal(grid%kin%nvel, 0), self%force(grid%kin%nvel, 0))
  end subroutine contact_pair_find_bodies

  !> Add the contact forces to the nodes of the two bodies.
  subroutine contact_pair_apply(self, grid, bodies, dt, implicit, threads)
    !> The contact.
    class(contact_pair_t), intent(inout) :: self
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
      call self%law%act(self%window, self%normal, dt, implicit, threads, first%nodes, &
                        second%nodes, self%force)
    end associate
  end subroutine contact_pair_apply

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

  !> Spacing of the grid in its finest direction.
  function smallest_spacing(grid) result(h)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The spacing. [m]
    real(wp) :: h

    associate (spacing => grid%spacing())
      h = minval(spacing(:grid%kin%dim))
    end associate
  end function smallest_spacing

  !> Unit normals out of the first body at the shared nodes, 0 where there is no direction.
  subroutine contact_pair_find_normals(self, grid, first, second, threads)
    !> The contact.
    class(contact_pair_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> First body.
    class(body_t), intent(in) :: first
    !> Second body.
    class(body_t), intent(in) :: second
    !> Number of threads.
    integer, intent(in) :: threads
    real(wp) :: h

    h = smallest_spacing(grid)
    deallocate (self%normal)
    allocate (self%normal(first%nodes%kin%nvel, self%window%size()))
    select case (self%normals)
    case (normals_mean)
      call mean_normals(first, second, self%window, h, threads, self%normal)
    case (normals_first)
      call body_normals(first, self%window, h, edges_cut, self%normal)
    case (normals_mirrored)
      call body_normals(first, self%window, h, edges_mirror, self%normal)
    case default
      self%normal = 0.0_wp
    end select
  end subroutine contact_pair_find_normals

  !> Send the fields of a frame.
  subroutine contact_pair_write_fields(self, bodies, writer)
    !> The contact.
    class(contact_pair_t), intent(in) :: self
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    associate (first => bodies(self%pair(1))%body%name, second => bodies(self%pair(2))%body%name)
      call self%send('contact_normal_'//first//'_'//second, self%normal, writer)
      call self%send('contact_force_by_'//second//'_on_'//first, self%force, writer)
    end associate
  end subroutine contact_pair_write_fields

  !> Send a nodal field, or nothing of it when the bodies share no node.
  subroutine contact_pair_send(self, name, values, writer)
    !> The contact.
    class(contact_pair_t), intent(in) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Vectors of the nodes of the last step in which there were any. (nvel, nn)
    real(wp), intent(in) :: values(:, :)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    call writer%vector(name, values(:, :self%window%size()), self%window)
  end subroutine contact_pair_send

end module mpm_contact_pair
