!> What grids of lines, triangles or tetrahedra share: linear functions on a mesh.
!!
!! The nodes form one row, so that a window is a range of their numbers; nodes close to each other
!! have close numbers (`mpm_mesh`).
module mpm_mesh_grid
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_gmsh_reader, only: gmsh_mesh_t, read_gmsh
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_mesh, only: mesh_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: basis_hat, stencil_t
  use mpm_strings, only: to_text
  use mpm_text_file, only: find_input_file
  use mpm_window, only: window_t
  implicit none
  private
  public :: add_mesh_file, add_mesh_notes, mesh_grid_t, most_tags

  !> Most tags that a node keeps.
  integer, parameter :: most_tags = 3
  !> VTK types of lines, triangles and tetrahedra.
  integer, parameter :: vtk_types(3) = [3, 5, 10]

  !> Simplices with linear functions.
  type, abstract, extends(grid_t) :: mesh_grid_t
    !> Nodes, cells and functions.
    type(mesh_t) :: mesh
    !> Tags of the sides that each node is on, -1 where there are no more; not allocated in grids
    !! without tags. (most_tags, n_nodes)
    integer, allocatable :: tags(:, :)
  contains
    procedure :: whole => mesh_grid_whole
    procedure :: cell_count => mesh_grid_cell_count
    procedure :: vtk_cell_type => mesh_grid_vtk_cell_type
    procedure :: cell_nodes => mesh_grid_cell_nodes
    procedure :: node_position => mesh_grid_node_position
    procedure :: node_volume => mesh_grid_node_volume
    procedure :: bounds => mesh_grid_bounds
    procedure :: spacing => mesh_grid_spacing
    procedure :: in_domain => mesh_grid_in_domain
    procedure :: make_stencil => mesh_grid_make_stencil
    procedure :: write_fields => mesh_grid_write_fields
    !> Set up from the mesh that the properties name.
    procedure :: init_from_file => mesh_grid_init_from_file
    procedure, private :: set_tags
  end type mesh_grid_t

contains

  !> Describe the mesh file.
  subroutine add_mesh_file(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_string('mesh', 'Gmsh file, version 2.2 or 4.1, ASCII or binary')
  end subroutine add_mesh_file

  !> Add the remarks that grids from files share.
  subroutine add_mesh_notes(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_note('The mesh is looked for in the working directory, then in the folder &
                              &of the config. Elements must have straight edges. Nodes that belong &
                              &to no cell are left out, and nodes and cells are renumbered so that &
                              &neighbours are close in memory.')
    call description%add_note('A point on an edge belongs to the cell with the lower number, a &
                              &point behind the outer sides by a rounding to the mesh (mpm_3d: it &
                              &may fall between two triangles and is switched off).')
    call description%add_note('Tags of nodes, for GeneralCustomBoundary: the first physical group &
                              &of the elements on the sides or, without a group, the number of &
                              &their geometric entity, in both versions of the format (mpm_3d: the &
                              &number of the entity in version 4). A node has up to three tags; &
                              &the field node_tags shows the last one, -1 inside.')
    call description%add_note('Memory of a body spans the nodes from its lowest to its highest &
                              &one; stable steps follow from the smallest cell. The transfers &
                              &APIC and MLS, ImprovedQuadraturePoints and the smoothing of strains &
                              &need a Cartesian grid.')
  end subroutine add_mesh_notes

  !> Set up from the mesh that the properties name.
  subroutine mesh_grid_init_from_file(self, kin, properties, side, error)
    !> The grid.
    class(mesh_grid_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Sides of the buckets of the search; 0 to choose them. [m]
    real(wp), intent(in) :: side(3)
    !> A missing or bad mesh.
    type(error_t), allocatable, intent(out) :: error
    type(gmsh_mesh_t) :: file
    character(:), allocatable :: path, message, hint
    integer, allocatable :: kept(:)
    real(wp) :: lowest
    integer :: flat, c

    self%kin = kin
    call find_input_file(properties%string('mesh'), properties%file_of('mesh'), path, error)
    if (allocated(error)) then
      message = error%message
      hint = error%hint
      call properties%reject('mesh', message, error, hint)
      return
    end if
    call read_gmsh(path, kin%dim, file, error)
    if (allocated(error)) return
    lowest = huge(1.0_wp)
    do c = 1, size(file%cell, 2)
      lowest = min(lowest, minval(file%x(1, file%cell(:, c))))
    end do
    if (kin%sim_type == type_axisymmetric .and. lowest < 0.0_wp) then
      call properties%reject('mesh', 'in TYPE 4 x is the radius, which can''t begin at '// &
                             to_text(lowest), error, 'move the mesh')
      return
    end if
    call self%mesh%init(kin%dim, file%x, file%cell, side, kin%sim_type == type_axisymmetric, &
                        kept, flat)
    if (flat > 0) then
      call file%fail_cell(flat, 'a cell that is too flat to calculate with', error, 'its longest &
                          &edge is more than 1e4 times its height: mend the mesh')
      return
    end if
    if (kin%dim == 2) call check_plane(file, kept, error)
    if (allocated(error)) return
    call self%set_tags(file, kept)
  end subroutine mesh_grid_init_from_file

  !> Refuse triangles that do not lie in a plane of constant z.
  subroutine check_plane(file, kept, error)
    !> The mesh as it was read.
    type(gmsh_mesh_t), intent(in) :: file
    !> Nodes that are used.
    integer, intent(in) :: kept(:)
    !> Different heights.
    type(error_t), allocatable, intent(inout) :: error
    real(wp) :: low, high
    integer :: c

    low = minval(file%x(3, kept))
    high = maxval(file%x(3, kept))
    if (high - low <= 1.0e-9_wp*(maxval(file%x(1, kept)) - minval(file%x(1, kept)))) return
    do c = 1, size(file%cell, 2)
      if (any(file%x(3, file%cell(:, c)) > low)) exit
    end do
    call file%fail_cell(min(c, size(file%cell, 2)), 'the triangles lie in no plane z = const: z &
                        &= '//to_text(low)//' to '//to_text(high), error, &
                        'TriangularGridLinear takes flat meshes in x and y')
  end subroutine check_plane

  !> Give nodes the tags of the sides that they are on.
  subroutine set_tags(self, file, kept)
    !> The grid, with its mesh.
    class(mesh_grid_t), intent(inout) :: self
    !> The mesh as it was read.
    type(gmsh_mesh_t), intent(in) :: file
    !> Number in the file of each node.
    integer, intent(in) :: kept(:)
    integer, allocatable :: number(:)
    integer :: i, k, n, t

    allocate (number(size(file%x, 2)), source=0)
    number(kept) = [(i, i=1, size(kept))]
    allocate (self%tags(most_tags, size(kept)), source=-1)
    do i = 1, size(file%tag)
      do k = 1, size(file%side, 1)
        n = number(file%side(k, i))
        if (n == 0) cycle
        if (any(self%tags(:, n) == file%tag(i))) cycle
        t = count(self%tags(:, n) >= 0) + 1
        ! The last tag takes the place of earlier ones where there are too many.
        self%tags(min(t, most_tags), n) = file%tag(i)
      end do
    end do
  end subroutine set_tags

  !> All nodes of the grid, in a row.
  pure function mesh_grid_whole(self) result(window)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Window of all nodes.
    type(window_t) :: window

    window%lo = 0
    window%n = [self%mesh%n_nodes, 1, 1]
  end function mesh_grid_whole

  !> Number of cells.
  pure function mesh_grid_cell_count(self) result(n)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Number of cells.
    integer :: n

    n = self%mesh%n_cells
  end function mesh_grid_cell_count

  !> VTK line, triangle or tetrahedron.
  pure function mesh_grid_vtk_cell_type(self) result(n)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> VTK cell type.
    integer :: n

    n = vtk_types(self%kin%dim)
  end function mesh_grid_vtk_cell_type

  !> Nodes of a cell.
  pure subroutine mesh_grid_cell_nodes(self, cell, nodes, n)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Cell, from 0.
    integer, intent(in) :: cell
    !> Node ids, from 0.
    integer, intent(out) :: nodes(8)
    !> Number of nodes.
    integer, intent(out) :: n

    n = self%kin%dim + 1
    nodes = 0
    nodes(:n) = self%mesh%node(:, cell + 1) - 1
  end subroutine mesh_grid_cell_nodes

  !> Position of a node.
  pure function mesh_grid_node_position(self, node) result(x)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Grid indices, from 0; the first one counts.
    integer, intent(in) :: node(3)
    !> Position. [m]
    real(wp) :: x(3)

    x = 0.0_wp
    x(:self%kin%dim) = self%mesh%x(:, node(1) + 1)
  end function mesh_grid_node_position

  !> Integral of a node's function.
  pure function mesh_grid_node_volume(self, node) result(volume)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Grid indices, from 0; the first one counts.
    integer, intent(in) :: node(3)
    !> Volume. [m3]
    real(wp) :: volume

    volume = self%mesh%volume(node(1) + 1)
  end function mesh_grid_node_volume

  !> Corners of the bounding box.
  pure subroutine mesh_grid_bounds(self, lower, upper)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    lower = self%mesh%lower
    upper = self%mesh%upper
  end subroutine mesh_grid_bounds

  !> Least height of a cell, in every direction.
  pure function mesh_grid_spacing(self) result(h)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Spacing. [m]
    real(wp) :: h(3)

    h = 1.0_wp
    h(:self%kin%dim) = self%mesh%h
  end function mesh_grid_spacing

  !> Whether a position is in a cell.
  pure function mesh_grid_in_domain(self, x) result(inside)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is; false for NaN.
    logical :: inside

    inside = self%mesh%find(x) > 0
  end function mesh_grid_in_domain

  !> The mesh, as the points of a body need it.
  subroutine mesh_grid_make_stencil(self, averaged, largest_extent, stencil, error)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Average over the corners of the points' boxes.
    logical, intent(in) :: averaged
    !> Largest half side of a point's box; any will do. [m]
    real(wp), intent(in) :: largest_extent
    !> The basis.
    type(stencil_t), intent(out) :: stencil
    !> Not raised.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => largest_extent)
    end associate
    stencil%dim = self%kin%dim
    stencil%kind = basis_hat
    stencil%averaged = averaged
    stencil%lower = self%mesh%lower
    stencil%h = self%spacing()
    allocate (stencil%mesh, source=self%mesh)
  end subroutine mesh_grid_make_stencil

  !> Send the tags of the nodes.
  subroutine mesh_grid_write_fields(self, writer)
    !> The grid.
    class(mesh_grid_t), intent(in) :: self
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: tag(:)
    integer :: i

    if (.not. allocated(self%tags)) return
    allocate (tag(self%mesh%n_nodes))
    do i = 1, self%mesh%n_nodes
      tag(i) = real(self%tags(max(1, count(self%tags(:, i) >= 0)), i), wp)
    end do
    call writer%scalar('node_tags', tag, self%whole())
  end subroutine mesh_grid_write_fields

end module mpm_mesh_grid
