!> The faces of a Cartesian grid, as the boundaries on them see it.
!!
!! Faces are numbered -x, +x, -y, +y, -z, +z from 1. Loops run over the nodes that a face shares
!! with the window of a body, never over the grid.
module mpm_box_faces
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_line_integrals, only: line_integral, line_moment, smoothing
  use mpm_mesh_grid, only: mesh_grid_t
  use mpm_nodes, only: nodes_t
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: box_faces_t
  public :: axis_names, axis_of, face_names, is_lower

  !> Names of the directions.
  character(1), parameter :: axis_names(3) = ['x', 'y', 'z']
  !> Names of the faces in their order.
  character(7), parameter :: face_names(6) = ['x_lower', 'x_upper', 'y_lower', 'y_upper', &
                                              'z_lower', 'z_upper']

  !> Faces of the box of a Cartesian grid.
  type :: box_faces_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
    !> Number of faces: two for each dimension.
    integer :: n = 0
    !> Index of the last node in each direction.
    integer :: last(3) = 0
    !> Spacing of the nodes. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Lower corner. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Upper corner. [m]
    real(wp) :: upper(3) = 0.0_wp
    !> Directions in which the grid is periodic.
    logical :: periodic(3) = .false.
    !> Half the variance of the kernel that turns hats into the basis. [cells^2]
    real(wp) :: smoothing(3) = 0.0_wp
    !> Nodes of the faces of the box around a mesh, face by face, from 0; not allocated on Cartesian
    !! grids.
    integer, allocatable :: node(:)
    !> Entries of `node` up to each face. (0:n)
    integer, allocatable :: before(:)
  contains
    !> Take the box from the grid.
    procedure :: init => box_faces_init
    !> Nodes of a face inside a window.
    procedure :: part => box_faces_part
    !> Whether a node is on a face.
    procedure :: holds => box_faces_holds
    !> Whether a face is the axis r = 0 of TYPE 4.
    procedure :: is_axis => box_faces_is_axis
    !> First face that a node is on.
    procedure :: first => box_faces_first
    !> Integral of a node's function over a face.
    procedure :: area => box_faces_area
    !> Fix components of velocity, momentum, force and waiting acceleration on a face.
    procedure :: fix => box_faces_fix
    !> Mark components as fixed in a mask for output.
    procedure :: mark => box_faces_mark
    !> Set components of a nodal field to a value on a face.
    procedure :: set => box_faces_set
    procedure, private :: list_nodes
  end type box_faces_t

contains

  !> Direction normal to a face.
  pure function axis_of(face) result(axis)
    !> Face, 1 to 6.
    integer, intent(in) :: face
    !> Direction, 1 to 3.
    integer :: axis

    axis = (face + 1)/2
  end function axis_of

  !> Whether a face is the lower one of its direction.
  pure function is_lower(face) result(lower)
    !> Face, 1 to 6.
    integer, intent(in) :: face
    !> False for an upper face.
    logical :: lower

    lower = mod(face, 2) == 1
  end function is_lower

  !> Take the box from the grid.
  subroutine box_faces_init(self, grid, class_name, error, of_mesh)
    !> The faces.
    class(box_faces_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Class of the boundary, for the message.
    character(*), intent(in) :: class_name
    !> The grid is not Cartesian.
    type(error_t), allocatable, intent(out) :: error
    !> The faces of the box around a mesh will do: only `fix`, `set` and `mark` are used.
    logical, intent(in), optional :: of_mesh
    logical :: any_grid

    any_grid = .false.
    if (present(of_mesh)) any_grid = of_mesh
    select type (grid)
    class is (cartesian_grid_t)
      self%kin = grid%kin
      self%n = 2*grid%kin%dim
      self%last = grid%n_cells
      self%h = grid%h
      self%lower = grid%lower
      self%upper = grid%upper
      self%periodic = grid%periodic
      self%smoothing = smoothing(grid%kind, grid%lambda)
    class is (mesh_grid_t)
      if (any_grid) then
        call self%list_nodes(grid)
      else
        call raise(error, err_input, 'the boundary class '//class_name//' needs a Cartesian grid', &
                   hint='on a mesh use GeneralCustomBoundary, CartesianBox or CartesianSmoothBox')
      end if
    class default
      call raise(error, err_input, 'the boundary class '//class_name//' needs a Cartesian grid', &
                 hint='its walls are the faces of a box; use a Cartesian grid or another boundary')
    end select
  end subroutine box_faces_init

  !> Take the box around a mesh and the nodes on it.
  subroutine list_nodes(self, grid)
    !> The faces.
    class(box_faces_t), intent(inout) :: self
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    integer :: face, i

    self%kin = grid%kin
    self%n = 2*grid%kin%dim
    call grid%bounds(self%lower, self%upper)
    allocate (self%before(0:self%n), source=0)
    allocate (self%node(0))
    do face = 1, self%n
      self%node = [self%node, pack([(i - 1, i=1, grid%mesh%n_nodes)], &
                                   [(grid%mesh%on_box(i, axis_of(face), is_lower(face)), &
                                     i=1, grid%mesh%n_nodes)])]
      self%before(face) = size(self%node)
    end do
  end subroutine list_nodes

  !> Nodes of a face inside a window; empty when there are none.
  pure function box_faces_part(self, face, window) result(part)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Nodes of both.
    type(window_t) :: part
    type(window_t) :: whole
    integer :: axis

    axis = axis_of(face)
    whole%n = self%last + 1
    whole%n(axis) = 1
    if (.not. is_lower(face)) whole%lo(axis) = self%last(axis)
    part = intersect(whole, window)
  end function box_faces_part

  !> Whether a node is on a face.
  pure function box_faces_holds(self, face, node) result(holds)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Whether it is.
    logical :: holds
    integer :: axis

    axis = axis_of(face)
    holds = node(axis) == merge(0, self%last(axis), is_lower(face))
  end function box_faces_holds

  !> Whether a face is the axis r = 0 of TYPE 4.
  pure function box_faces_is_axis(self, face) result(is_axis)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> Whether it is.
    logical :: is_axis

    is_axis = self%kin%sim_type == type_axisymmetric .and. face == 1 &
              .and. self%lower(1) <= 0.0_wp
  end function box_faces_is_axis

  !> First face that a node is on, by which nodes of several faces are visited once.
  pure function box_faces_first(self, node) result(face)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Face; 0 inside the box.
    integer :: face

    do face = 1, self%n
      if (self%holds(face, node)) return
    end do
    face = 0
  end function box_faces_first

  !> Integral of a node's function over a face.
  !!
  !! A unit area in TYPE 1, a line of unit depth in TYPE 2 and 5; in TYPE 4 per radian: R dz on the
  !! faces of constant r, r dr on those of constant z.
  pure function box_faces_area(self, face, node) result(area)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> Grid indices of a node of the face, from 0.
    integer, intent(in) :: node(3)
    !> Area. [m2]
    real(wp) :: area
    integer :: axis, d

    axis = axis_of(face)
    area = 1.0_wp
    if (self%kin%sim_type == type_axisymmetric .and. axis == 1) then
      area = merge(self%lower(1), self%upper(1), is_lower(face))
    end if
    do d = 1, self%kin%dim
      if (d == axis) cycle
      area = area*self%h(d)*line_integral(node(d), self%last(d), self%smoothing(d), &
                                          self%periodic(d))
      if (self%kin%sim_type == type_axisymmetric .and. d == 1) then
        area = area*mean_radius(self, node(1))
      end if
    end do
  end function box_faces_area

  !> Mean of r weighted with a node's function.
  pure function mean_radius(self, i) result(r)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Index of the node along r, from 0.
    integer, intent(in) :: i
    !> The mean. [m]
    real(wp) :: r

    r = self%lower(1) + real(i, wp)*self%h(1)
    if (i == self%last(1)) r = self%upper(1)
    r = r + self%h(1)*line_moment(i, self%last(1), self%smoothing(1), self%periodic(1)) &
        /line_integral(i, self%last(1), self%smoothing(1), self%periodic(1))
  end function mean_radius

  !> Fix components of velocity, momentum and force on a face; the faces of periodic directions are
  !! no walls.
  pure subroutine box_faces_fix(self, face, first, last, nodes)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> First component.
    integer, intent(in) :: first
    !> Last component.
    integer, intent(in) :: last
    !> Nodes of the body.
    class(nodes_t), intent(inout) :: nodes
    type(window_t) :: part
    integer :: hi(3), i, j, k, n

    if (allocated(self%node)) then
      do i = self%before(face - 1) + 1, self%before(face)
        if (.not. nodes%window%holds([self%node(i), 0, 0])) cycle
        n = nodes%window%index([self%node(i), 0, 0])
        nodes%velocity(first:last, n) = 0.0_wp
        nodes%momentum(first:last, n) = 0.0_wp
        nodes%force(first:last, n) = 0.0_wp
        nodes%increment(first:last, n) = 0.0_wp
      end do
      return
    end if
    if (self%periodic(axis_of(face))) return
    part = self%part(face, nodes%window)
    hi = part%hi()
    do k = part%lo(3), hi(3)
      do j = part%lo(2), hi(2)
        do i = part%lo(1), hi(1)
          n = nodes%window%index([i, j, k])
          nodes%velocity(first:last, n) = 0.0_wp
          nodes%momentum(first:last, n) = 0.0_wp
          nodes%force(first:last, n) = 0.0_wp
          nodes%increment(first:last, n) = 0.0_wp
        end do
      end do
    end do
  end subroutine box_faces_fix

  !> Set components of a nodal field to a value on a face that is a wall.
  pure subroutine box_faces_set(self, face, first, last, value, window, field)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> First component.
    integer, intent(in) :: first
    !> Last component.
    integer, intent(in) :: last
    !> The value.
    real(wp), intent(in) :: value
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Field of the window's nodes. (nvel, nn)
    real(wp), intent(inout) :: field(:, :)
    type(window_t) :: part
    integer :: hi(3), i, j, k

    if (allocated(self%node)) then
      do i = self%before(face - 1) + 1, self%before(face)
        if (.not. window%holds([self%node(i), 0, 0])) cycle
        field(first:last, window%index([self%node(i), 0, 0])) = value
      end do
      return
    end if
    if (self%periodic(axis_of(face))) return
    part = self%part(face, window)
    hi = part%hi()
    do k = part%lo(3), hi(3)
      do j = part%lo(2), hi(2)
        do i = part%lo(1), hi(1)
          field(first:last, window%index([i, j, k])) = value
        end do
      end do
    end do
  end subroutine box_faces_set

  !> Mark components as fixed (1) in a mask for output, on faces that are walls.
  pure subroutine box_faces_mark(self, face, first, last, window, mask)
    !> The faces.
    class(box_faces_t), intent(in) :: self
    !> Face, 1 to `n`.
    integer, intent(in) :: face
    !> First component.
    integer, intent(in) :: first
    !> Last component.
    integer, intent(in) :: last
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Mask of the window's nodes. (nvel, nn)
    real(wp), intent(inout) :: mask(:, :)

    call self%set(face, first, last, 1.0_wp, window, mask)
  end subroutine box_faces_mark

end module mpm_box_faces
