!> What two bodies do to each other at the nodes that they share.
module mpm_contact_law
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_threads, only: useful_threads
  use mpm_window, only: window_t
  implicit none
  private
  public :: contact_law_t
  public :: law_friction, law_joint, law_rigid, law_slip_joint

  !> Non-penetration and Coulomb friction.
  integer, parameter :: law_friction = 1
  !> The same, and the first body does not feel it in its velocity.
  integer, parameter :: law_rigid = 2
  !> One velocity.
  integer, parameter :: law_joint = 3
  !> One velocity along the normal.
  integer, parameter :: law_slip_joint = 4

  !> The law of a contact.
  type :: contact_law_t
    !> One of the `law_*`.
    integer :: kind = law_friction
    !> Coefficient of friction.
    real(wp) :: friction = 0.0_wp
  contains
    !> Add the forces at all shared nodes.
    procedure :: act => law_act
  end type contact_law_t

contains

  !> Add the forces of the law at all shared nodes.
  subroutine law_act(self, window, normal, dt, implicit, threads, first, second, force)
    !> The law.
    class(contact_law_t), intent(in) :: self
    !> The shared nodes.
    type(window_t), intent(in) :: window
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
    integer :: i, j, k, node(3), hi(3), here, a, b, nvel, kind
    real(wp) :: friction

    hi = window%hi()
    nvel = size(normal, 1)
    kind = self%kind
    friction = self%friction
    !$omp parallel do collapse(2) default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, window%size())) &
    !$omp shared(window, kind, friction, normal, dt, implicit, first, second, force, hi, nvel) &
    !$omp private(i, j, k, node, here, a, b)
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          here = window%index(node)
          a = first%window%index(node)
          b = second%window%index(node)
          call node_contact(nvel, dt, implicit, kind, friction, normal(:, here), &
                            first%mass(a), second%mass(b), first%momentum(:, a), &
                            second%momentum(:, b), first%force(:, a), second%force(:, b), &
                            force(:, here))
        end do
      end do
    end do
    !$omp end parallel do
  end subroutine law_act

  !> Contact forces at one node.
  pure subroutine node_contact(nvel, dt, implicit, kind, friction, normal, m1, m2, p1, p2, f1, f2, &
                               force)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Use trial momenta that include the forces so far.
    logical, intent(in) :: implicit
    !> One of the `law_*`.
    integer, intent(in) :: kind
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
    ! Of a fixed size: arrays of a size known at run time alone may be allocated.
    real(wp) :: trial1(3), trial2(3), stick(3), share, pull

    force = 0.0_wp
    if (.not. (m1 > 0.0_wp .and. m2 > 0.0_wp)) return
    trial1(:nvel) = p1
    trial2(:nvel) = p2
    share = m1 + m2
    if (implicit) trial2(:nvel) = trial2(:nvel) + dt*f2
    if (kind == law_rigid) then
      ! Body 1 takes all momentum and stays as fast as it is.
      share = m1
    else if (implicit) then
      trial1(:nvel) = trial1(:nvel) + dt*f1
    end if
    ! The force on body 1 by which both get one velocity: m1 (w_c - w_1)/dt.
    stick(:nvel) = (m1*trial2(:nvel) - m2*trial1(:nvel))/(share*dt)
    pull = dot_product(stick(:nvel), normal)
    select case (kind)
    case (law_joint)
      force = stick(:nvel)
    case (law_slip_joint)
      force = pull*normal
    case default
      if (.not. pull < 0.0_wp) return
      force = pull*normal + rub(nvel, friction*abs(pull), stick(:nvel) - pull*normal)
    end select
    f1 = f1 + force
    f2 = f2 - force
  end subroutine node_contact

  !> Coulomb friction: what ends the slip, or its largest value in that direction.
  pure function rub(nvel, largest, slip) result(force)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Largest magnitude. [N]
    real(wp), intent(in) :: largest
    !> The force that would end the slip. [N]
    real(wp), intent(in) :: slip(nvel)
    !> The force. [N]
    real(wp) :: force(nvel)
    real(wp) :: magnitude

    magnitude = norm2(slip)
    force = slip
    if (magnitude > largest) force = (largest/magnitude)*slip
  end function rub

end module mpm_contact_law
