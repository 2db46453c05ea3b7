!> What a face of CartesianBoxCustom does, read from its code and its share of the reals.
module mpm_box_wall
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
  use mpm_box_faces, only: axis_names, axis_of, box_faces_t, face_names
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: box_wall_t, read_walls
  public :: wall_bounded, wall_driven, wall_free, wall_free_slip, wall_friction, wall_no_slip
  public :: wall_periodic, wall_traction

  !> Nothing happens.
  integer, parameter :: wall_free = -1
  !> No slip.
  integer, parameter :: wall_no_slip = 0
  !> Free slip.
  integer, parameter :: wall_free_slip = 1
  !> Coulomb friction.
  integer, parameter :: wall_friction = 2
  !> Continues on the opposite face.
  integer, parameter :: wall_periodic = 3
  !> Sticks to a wall that moves.
  integer, parameter :: wall_driven = 4
  !> Given traction.
  integer, parameter :: wall_traction = 5
  !> Sticks to a wall that moves, up to a largest traction.
  integer, parameter :: wall_bounded = 6

  !> One face: its rule, and what it must know of the step.
  type :: box_wall_t
    !> One of the `wall_*` codes.
    integer :: code = wall_free
    !> Code 2: coefficient of friction.
    real(wp) :: friction = 0.0_wp
    !> Code 2: only pushes, and takes the momentum that it stops from the points.
    logical :: unilateral = .false.
    !> Codes 4, 6: velocity [m/s]; code 5: traction [Pa], 0 where `held`.
    real(wp) :: vector(3) = 0.0_wp
    !> Code 5: components that are fixed instead.
    logical :: held(3) = .false.
    !> Code 6: largest traction. [Pa]
    real(wp) :: limit = 0.0_wp
    !> Nodes of the face in the window of the body.
    type(window_t) :: part
    !> Code 2: normal component of the body's own forces at the nodes of `part`. [N]
    real(wp), allocatable :: own_force(:)
    !> Codes 5, 6: area at the nodes of `part`, times the fraction that is filled. [m2]
    real(wp), allocatable :: filled_area(:)
  end type box_wall_t

contains

  !> Number of reals that a code takes, the same in every TYPE.
  pure function reals_of(code) result(n)
    !> One of the `wall_*` codes.
    integer, intent(in) :: code
    !> Number of entries in `values`.
    integer :: n

    select case (code)
    case (wall_friction)
      n = 1
    case (wall_driven, wall_traction)
      n = 3
    case (wall_bounded)
      n = 4
    case default
      n = 0
    end select
  end function reals_of

  !> Read the walls from the codes and the list `values`.
  subroutine read_walls(faces, properties, walls, error)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> One wall a face. (faces%n)
    type(box_wall_t), allocatable, intent(out) :: walls(:)
    !> A code that does not fit the grid, or values that do not fit the codes.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: values(:)
    integer :: face, used, n

    allocate (walls(faces%n))
    do face = 1, faces%n
      walls(face)%code = properties%integer(trim(face_names(face)))
      walls(face)%unilateral = properties%integer('unilateral') == 1
    end do
    call check_periodic(faces, properties, walls, error)
    if (allocated(error)) return
    values = properties%reals('values')
    n = 0
    do face = 1, faces%n
      n = n + reals_of(walls(face)%code)
    end do
    if (size(values) /= n) then
      call properties%reject('values', 'the codes need '//to_text(n)//' reals, found '// &
                             to_text(size(values)), error, layout(faces%kin, walls))
      return
    end if
    used = 0
    do face = 1, faces%n
      n = reals_of(walls(face)%code)
      call read_values(faces, face, properties, values(used + 1:used + n), walls(face), error)
      if (allocated(error)) return
      used = used + n
    end do
  end subroutine read_walls

  !> Periodic faces come in pairs, on a grid that is periodic in their direction; such a direction
  !! takes no other rule.
  subroutine check_periodic(faces, properties, walls, error)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The walls, with their codes.
    type(box_wall_t), intent(in) :: walls(:)
    !> A face without its partner, or a grid with walls.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: name
    integer :: face, axis, other

    do face = 1, faces%n
      axis = axis_of(face)
      name = trim(face_names(face))
      if (walls(face)%code /= wall_periodic) then
        if (walls(face)%code == wall_free .or. .not. faces%periodic(axis)) cycle
        call properties%reject(name, name//' = '//to_text(walls(face)%code)//' does not fit the &
                               &grid, which is periodic along '//axis_names(axis), error, &
                               'use 3 (periodic) on both faces, or a grid with walls there')
        return
      end if
      other = 4*axis - 1 - face
      if (.not. faces%periodic(axis)) then
        call properties%reject(name, name//' = 3 (periodic) does not fit the grid, which is not &
                               &periodic along '//axis_names(axis), error, &
                               'use a grid that is periodic in this direction, or another code')
        return
      end if
      if (walls(other)%code /= wall_periodic) then
        call properties%reject(name, name//' = 3 (periodic), but '//trim(face_names(other))// &
                               ' = '//to_text(walls(other)%code), error, &
                               'both faces of a direction must be periodic, or none')
        return
      end if
    end do
  end subroutine check_periodic

  !> Read what one wall takes of the list `values`.
  subroutine read_values(faces, face, properties, values, wall, error)
    !> The faces of the grid.
    type(box_faces_t), intent(in) :: faces
    !> Face of the wall.
    integer, intent(in) :: face
    !> Checked properties, for the place of an error.
    type(properties_t), intent(in) :: properties
    !> Its values; entries beyond those that the TYPE has are not looked at.
    real(wp), intent(in) :: values(:)
    !> The wall, with its code.
    type(box_wall_t), intent(inout) :: wall
    !> A value that is not finite, or negative where it can't be.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: takes
    integer :: nvel

    nvel = faces%kin%nvel
    select case (wall%code)
    case (wall_friction)
      wall%friction = values(1)
    case (wall_driven)
      wall%vector(:nvel) = values(:nvel)
    case (wall_traction)
      wall%held(:nvel) = ieee_is_nan(values(:nvel))
      where (.not. wall%held(:nvel)) wall%vector(:nvel) = values(:nvel)
    case (wall_bounded)
      wall%vector(:nvel) = values(:nvel)
      wall%limit = values(nvel + 1)
    case default
      return
    end select
    takes = trim(face_names(face))//' = '//to_text(wall%code)//' takes '// &
            value_names(faces%kin, wall%code)
    if (.not. all(ieee_is_finite([wall%friction, wall%vector, wall%limit]))) then
      call properties%reject('values', 'a value of '//trim(face_names(face))// &
                             ' is not a finite number', error, &
                             takes//'; only components of code 5 may be NaN, which fixes them')
    else if (wall%friction < 0.0_wp .or. wall%limit < 0.0_wp) then
      call properties%reject('values', trim(merge('mu     ', 'tau_max', wall%friction < 0.0_wp)) &
                             //' of '//trim(face_names(face))//' is negative', error, takes)
    end if
  end subroutine read_values

  !> Which face takes which values.
  pure function layout(kin, walls) result(text)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The walls, with their codes.
    type(box_wall_t), intent(in) :: walls(:)
    !> For example `x_lower (2): mu; y_upper (4): V_x, V_y, -`.
    character(:), allocatable :: text
    integer :: face

    text = ''
    do face = 1, size(walls)
      if (reals_of(walls(face)%code) == 0) cycle
      if (len(text) > 0) text = text//'; '
      text = text//trim(face_names(face))//' ('//to_text(walls(face)%code)//'): '// &
             value_names(kin, walls(face)%code)
    end do
    if (len(text) == 0) text = 'none of the codes takes a value: leave the list out'
  end function layout

  !> Names of the values that a code takes, in their order.
  pure function value_names(kin, code) result(text)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> One of the `wall_*` codes.
    integer, intent(in) :: code
    !> Names; `-` for an entry that the TYPE does not use.
    character(:), allocatable :: text
    character(5) :: axes(3)
    character(1) :: letter
    integer :: i

    if (code == wall_friction) then
      text = 'mu'
      return
    end if
    axes = ['x    ', 'y    ', 'z    ']
    if (kin%sim_type == type_axisymmetric) axes = ['r    ', 'z    ', 'theta']
    letter = merge('t', 'V', code == wall_traction)
    text = ''
    do i = 1, reals_of(code)
      if (i > 1) text = text//', '
      if (i <= kin%nvel) then
        text = text//letter//'_'//trim(axes(i))
      else if (i == kin%nvel + 1 .and. code == wall_bounded) then
        text = text//'tau_max'
      else
        text = text//'-'
      end if
    end do
  end function value_names

end module mpm_box_wall
