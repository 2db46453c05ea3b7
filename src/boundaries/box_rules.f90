!> What the walls of CartesianBoxCustom do to one node.
module mpm_box_rules
  use mpm_box_faces, only: axis_of, box_faces_t, is_lower
  use mpm_box_wall, only: box_wall_t, wall_bounded, wall_driven, wall_free, wall_free_slip, &
                          wall_friction, wall_no_slip, wall_periodic, wall_traction
  use mpm_kinds, only: wp
  implicit none
  private
  public :: apply_rules, hold_increment, node_rules, prescribe

  !> Rule of a component that is fixed; the other rules are the codes of the walls.
  integer, parameter :: fixed = 1

contains

  !> The rule that each component of a node follows: 0 for none, `fixed`, or the code of a wall,
  !! codes from 2 but 3 with the sign of the face, + on lower faces.
  pure function node_rules(faces, walls, node) result(rules)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Their walls. (faces%n)
    type(box_wall_t), intent(in) :: walls(:)
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> The rules; components that the TYPE does not have do not count.
    integer :: rules(3)
    integer :: face, axis, side

    rules = 0
    do face = 1, faces%n
      if (.not. faces%holds(face, node)) cycle
      axis = axis_of(face)
      side = merge(1, -1, is_lower(face))
      select case (walls(face)%code)
      case (wall_no_slip)
        rules = fixed
      case (wall_free_slip)
        rules(axis) = fixed
      case (wall_free)
        rules(axis) = wall_free
      case (wall_friction)
        rules(axis) = side*wall_friction
      case (wall_periodic)
        if (rules(axis) == 0) rules(axis) = wall_periodic
      case default
        if (rules(axis) == fixed) cycle
        rules = 0
        rules(axis) = side*walls(face)%code
      end select
    end do
    if (is_smooth_axis(faces, walls, node)) rules([1, 3]) = fixed
  end function node_rules

  !> Whether a node is on the axis of TYPE 4 and the wall there is smooth.
  !!
  !! Neither radial velocity nor swirl can differ from 0 there, whatever other faces ask for.
  pure function is_smooth_axis(faces, walls, node) result(is_axis)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Their walls. (faces%n)
    type(box_wall_t), intent(in) :: walls(:)
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Whether it is.
    logical :: is_axis

    is_axis = faces%is_axis(1) .and. node(1) == 0 .and. walls(1)%code == wall_free_slip
  end function is_smooth_axis

  !> Apply the rules of one node.
  pure subroutine apply_rules(faces, walls, node, dt, mass, velocity, momentum, force)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Their walls, with what they know of the step. (faces%n)
    type(box_wall_t), intent(in) :: walls(:)
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Mass of the node. [kg]
    real(wp), intent(in) :: mass
    !> Velocity of the node. [m/s] (nvel)
    real(wp), intent(inout) :: velocity(:)
    !> Momentum of the node. [kg m/s] (nvel)
    real(wp), intent(inout) :: momentum(:)
    !> Force on the node. [N] (nvel)
    real(wp), intent(inout) :: force(:)

    call apply_walls(faces, walls, node, dt, mass, velocity, momentum, force)
    if (is_smooth_axis(faces, walls, node)) then
      call fix(1, velocity, momentum, force)
      call fix(3, velocity, momentum, force)
    end if
  end subroutine apply_rules

  !> Apply the walls to one node, component by component.
  pure subroutine apply_walls(faces, walls, node, dt, mass, velocity, momentum, force)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Their walls, with what they know of the step. (faces%n)
    type(box_wall_t), intent(in) :: walls(:)
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Mass of the node. [kg]
    real(wp), intent(in) :: mass
    !> Velocity of the node. [m/s] (nvel)
    real(wp), intent(inout) :: velocity(:)
    !> Momentum of the node. [kg m/s] (nvel)
    real(wp), intent(inout) :: momentum(:)
    !> Force on the node. [N] (nvel)
    real(wp), intent(inout) :: force(:)
    real(wp) :: largest(3), push
    integer :: rules(3), c, face, n

    rules = node_rules(faces, walls, node)
    largest = 0.0_wp
    do c = 1, size(force)
      if (rules(c) == fixed) call fix(c, velocity, momentum, force)
      if (abs(rules(c)) < wall_friction .or. rules(c) == wall_periodic) cycle
      face = 2*c - merge(1, 0, rules(c) > 0)
      n = walls(face)%part%index(node)
      select case (walls(face)%code)
      case (wall_friction)
        push = momentum(c)/dt + walls(face)%own_force(n)
        if (is_lower(face)) push = -push
        largest(c) = walls(face)%friction*max(0.0_wp, push)
        if (.not. walls(face)%unilateral) then
          call fix(c, velocity, momentum, force)
        else if (push > 0.0_wp) then
          ! A force, which the points feel, brings the node to rest.
          force(c) = -momentum(c)/dt
        end if
      case (wall_driven)
        force = (mass*walls(face)%vector(:size(force)) - momentum)/dt
        return
      case (wall_traction)
        call load(walls(face), walls(face)%filled_area(n), velocity, momentum, force)
        return
      case (wall_bounded)
        call fix(c, velocity, momentum, force)
        call drag(mass*walls(face)%vector(:size(force)), &
                  walls(face)%limit*walls(face)%filled_area(n), dt, momentum, force)
        return
      case default
        cycle
      end select
    end do
    if (any(largest > 0.0_wp)) call rub(norm2(largest), dt, momentum, force)
  end subroutine apply_walls

  !> Drop the accelerations that wait at a node of negligible mass where its walls take the force.
  pure subroutine hold_increment(rules, increment)
    !> Rules of the components, as of `node_rules`.
    integer, intent(in) :: rules(3)
    !> Accelerations by internal forces that are not part of the node's force. [m/s2] (nvel)
    real(wp), intent(inout) :: increment(:)
    integer :: c

    if (any(abs(rules) == wall_driven) .or. any(abs(rules) == wall_bounded)) then
      increment = 0.0_wp
    else
      do c = 1, size(increment)
        if (rules(c) == fixed .or. abs(rules(c)) == wall_friction) increment(c) = 0.0_wp
      end do
    end if
  end subroutine hold_increment

  !> Give components of a node's velocity that its walls prescribe their values.
  pure subroutine prescribe(faces, walls, node, still, velocity)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Their walls. (faces%n)
    type(box_wall_t), intent(in) :: walls(:)
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Take 0 for the velocity of walls that move.
    logical, intent(in) :: still
    !> Velocity of the node. [m/s] (nvel)
    real(wp), intent(inout) :: velocity(:)
    integer :: rules(3), c, face

    rules = node_rules(faces, walls, node)
    do c = 1, size(velocity)
      face = 2*c - merge(1, 0, rules(c) > 0)
      select case (rules(c))
      case (wall_friction, -wall_friction)
        if (still .or. .not. walls(face)%unilateral) then
          velocity(c) = 0.0_wp
        else
          ! It stops what closes, and lets go what leaves.
          velocity(c) = merge(max(0.0_wp, velocity(c)), min(0.0_wp, velocity(c)), is_lower(face))
        end if
      case (fixed, wall_bounded, -wall_bounded)
        velocity(c) = 0.0_wp
      case (wall_driven, -wall_driven)
        velocity = 0.0_wp
        if (.not. still) velocity = walls(face)%vector(:size(velocity))
        exit
      case (wall_traction, -wall_traction)
        where (walls(face)%held(:size(velocity))) velocity = 0.0_wp
        exit
      case default
        cycle
      end select
    end do
    if (is_smooth_axis(faces, walls, node)) velocity([1, 3]) = 0.0_wp
  end subroutine prescribe

  !> Fix one component.
  pure subroutine fix(c, velocity, momentum, force)
    !> The component.
    integer, intent(in) :: c
    !> Velocity of the node. [m/s] (nvel)
    real(wp), intent(inout) :: velocity(:)
    !> Momentum of the node. [kg m/s] (nvel)
    real(wp), intent(inout) :: momentum(:)
    !> Force on the node. [N] (nvel)
    real(wp), intent(inout) :: force(:)

    velocity(c) = 0.0_wp
    momentum(c) = 0.0_wp
    force(c) = 0.0_wp
  end subroutine fix

  !> Load a node with the traction of a wall.
  pure subroutine load(wall, area, velocity, momentum, force)
    !> The wall.
    type(box_wall_t), intent(in) :: wall
    !> Filled area of the node. [m2]
    real(wp), intent(in) :: area
    !> Velocity of the node. [m/s] (nvel)
    real(wp), intent(inout) :: velocity(:)
    !> Momentum of the node. [kg m/s] (nvel)
    real(wp), intent(inout) :: momentum(:)
    !> Force on the node. [N] (nvel)
    real(wp), intent(inout) :: force(:)
    integer :: c

    do c = 1, size(force)
      if (wall%held(c)) then
        call fix(c, velocity, momentum, force)
      else
        force(c) = force(c) + wall%vector(c)*area
      end if
    end do
  end subroutine load

  !> Drag a node towards a momentum with a bounded force.
  pure subroutine drag(aim, largest, dt, momentum, force)
    !> The momentum to reach. [kg m/s] (nvel)
    real(wp), intent(in) :: aim(:)
    !> Largest magnitude of the force. [N]
    real(wp), intent(in) :: largest
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Momentum of the node. [kg m/s] (nvel)
    real(wp), intent(in) :: momentum(:)
    !> Force on the node. [N] (nvel)
    real(wp), intent(inout) :: force(:)
    real(wp) :: pull(3), magnitude
    integer :: n

    n = size(force)
    pull(:n) = (aim - momentum)/dt - force
    magnitude = norm2(pull(:n))
    if (magnitude > largest) pull(:n) = pull(:n)*(largest/magnitude)
    force = force + pull(:n)
  end subroutine drag

  !> Resist the motion that a node is left with by a bounded force.
  pure subroutine rub(largest, dt, momentum, force)
    !> Largest magnitude of the force. [N]
    real(wp), intent(in) :: largest
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Momentum of the node. [kg m/s] (nvel)
    real(wp), intent(in) :: momentum(:)
    !> Force on the node. [N] (nvel)
    real(wp), intent(inout) :: force(:)
    real(wp) :: stopping(3), magnitude
    integer :: n

    n = size(force)
    stopping(:n) = momentum/dt + force
    magnitude = norm2(stopping(:n))
    if (magnitude > largest) stopping(:n) = stopping(:n)*(largest/magnitude)
    force = force - stopping(:n)
  end subroutine rub

end module mpm_box_rules
