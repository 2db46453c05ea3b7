!> Nodes of a body where contacts act in a step, and the velocities that they leave there.
!!
!! Velocities that are mapped from the points again lack the part of the contact forces that the
!! mapping filters away: the bodies seem to approach each other still, and stresses formed from such
!! velocities do work that nothing pays for. Strain rates at these nodes are formed from the
!! velocities of the grid update instead, which obey the contact.
module mpm_contact_marks
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_store, only: store_t
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: contact_marks_t

  !> The marks of one body.
  type :: contact_marks_t
    private
    !> Nodes of the last step.
    type(window_t) :: window
    !> Whether a contact acts on the node. (nn)
    logical, allocatable :: touched(:)
    !> Forces before the contacts [N], then velocities after the grid update [m/s]. (nvel, nn)
    real(wp), allocatable :: values(:, :)
  contains
    !> Keep the forces before the contacts.
    procedure :: begin => marks_begin
    !> Mark the nodes whose forces the contacts changed.
    procedure :: mark => marks_mark
    !> Keep the velocities of the grid update.
    procedure :: keep => marks_keep
    !> Put the kept velocities in place of others at marked nodes.
    procedure :: impose => marks_impose
    !> Save what the next step may impose.
    procedure :: save => marks_save
    !> Take it back.
    procedure :: restore => marks_restore
  end type contact_marks_t

contains

  !> Keep the forces before the contacts.
  subroutine marks_begin(self, nodes)
    !> The marks.
    class(contact_marks_t), intent(inout) :: self
    !> Nodes of the body with all forces but those of contacts.
    class(nodes_t), intent(in) :: nodes

    self%window = nodes%window
    self%values = nodes%force(:, :nodes%window%size())
  end subroutine marks_begin

  !> Mark the nodes whose forces the contacts changed.
  subroutine marks_mark(self, nodes)
    !> The marks.
    class(contact_marks_t), intent(inout) :: self
    !> The same nodes with the forces of contacts.
    class(nodes_t), intent(in) :: nodes
    integer :: i, n

    n = nodes%window%size()
    self%touched = [(any(abs(nodes%force(:, i) - self%values(:, i)) > 0.0_wp), i=1, n)]
    if (.not. any(self%touched)) deallocate (self%touched)
  end subroutine marks_mark

  !> Keep the velocities of the grid update.
  subroutine marks_keep(self, nodes)
    !> The marks.
    class(contact_marks_t), intent(inout) :: self
    !> The same nodes after the grid update.
    class(nodes_t), intent(in) :: nodes

    if (allocated(self%touched)) self%values = nodes%velocity(:, :nodes%window%size())
  end subroutine marks_keep

  !> Put the kept velocities in place of others at marked nodes.
  subroutine marks_impose(self, window, mass, velocity)
    !> The marks.
    class(contact_marks_t), intent(in) :: self
    !> Nodes that have memory now.
    type(window_t), intent(in) :: window
    !> Their masses; nodes without mass stay as they are. [kg] (nn)
    real(wp), intent(in) :: mass(:)
    !> Their velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)
    type(window_t) :: both
    integer :: hi(3), node(3), i, j, k, n

    if (.not. allocated(self%touched)) return
    both = intersect(self%window, window)
    hi = both%hi()
    do k = both%lo(3), hi(3)
      do j = both%lo(2), hi(2)
        do i = both%lo(1), hi(1)
          node = [i, j, k]
          if (.not. self%touched(self%window%index(node))) cycle
          n = window%index(node)
          if (mass(n) > 0.0_wp) velocity(:, n) = self%values(:, self%window%index(node))
        end do
      end do
    end do
  end subroutine marks_impose

  !> Save what the next step may impose.
  subroutine marks_save(self, store)
    !> The marks.
    class(contact_marks_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    if (.not. allocated(self%touched)) return
    call store%put('lo', self%window%lo)
    call store%put('n', self%window%n)
    call store%put('touched', self%touched)
    call store%put('values', self%values)
  end subroutine marks_save

  !> Take back what the next step may impose.
  subroutine marks_restore(self, store)
    !> The marks.
    class(contact_marks_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    if (.not. store%has('touched')) return
    call store%get_fixed('lo', self%window%lo)
    call store%get_fixed('n', self%window%n)
    call store%get('touched', self%touched)
    call store%get('values', self%values)
  end subroutine marks_restore

end module mpm_contact_marks
