!> Points in the triangles or tetrahedra of a Gmsh mesh, generated from a text.
module mpm_gmsh_points
  use mpm_default_points, only: add_points_properties, default_points_t, find_point_file, &
                                full_width
  use mpm_description, only: description_t
  use mpm_document, only: value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_generator_text, only: generator_text_t, write_points_table
  use mpm_gmsh_reader, only: gmsh_mesh_t, read_gmsh
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_part_list, only: part_list_t
  use mpm_properties, only: properties_t
  use mpm_simplex_samples, only: count_samples, simplex_samples
  use mpm_strings, only: to_text
  use mpm_text_file, only: find_input_file
  implicit none
  private
  public :: gmsh_points_t

  !> Keys of the generator text.
  character(8), parameter :: known_keys(4) = [character(8) :: 'msh_file', 'lmpp', 'rho', 'out_file']

  !> Points at equal places of all cells of a mesh, where they lie in any part.
  type, extends(default_points_t) :: gmsh_points_t
    private
    !> File for the table of the points; not allocated when none is asked for.
    character(:), allocatable :: out_file
    !> The points as rows of a points file, until they are written. (columns, n)
    real(wp), allocatable :: table(:, :)
  contains
    procedure, nopass :: describe => gmsh_points_describe
    procedure :: init => gmsh_points_init
    procedure :: write_table => gmsh_points_write_table
  end type gmsh_points_t

contains

  !> Purpose and properties of the class.
  subroutine gmsh_points_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('points', 'GmshPoints', &
                          'Points at rest in the triangles or tetrahedra of a mesh, kept where &
                          &they lie in any of the parts of a generator text, which `point-file` &
                          &names.', &
                          'The generator texts of mpm_3d v3', &
                          '# in the config'//nl// &
                          '    point-class = "GmshPoints"'//nl// &
                          '    point-file = "block.parts"'//nl// &
                          '# block.parts'//nl// &
                          'msh_file = "box.msh"'//nl// &
                          'lmpp = 2            # pieces of each edge'//nl// &
                          'rho = 1000          # density'//nl// &
                          'out_file = "block.points"     # optional: write the table'//nl// &
                          'part { class = "Box" properties = {0.2, 0.0, 0.8, 0.4} }')
    call add_points_properties(description)
    call description%add_note('Each cell has lmpp^2 points in 2D: the centres of as many equal &
                              &triangles; in 3D a lattice of octants in the coordinates of the &
                              &tetrahedron. Their volumes sum to that of the cell. Not for TYPE 1.')
    call description%add_note('The mesh need not be that of the grid, which may be Cartesian. &
                              &msh_file is relative to the working directory or to the folder of &
                              &the generator text. (mpm3d --list parts)')
    call description%add_note('out_file is relative to the working directory and can be read by &
                              &DefaultPoints: TYPE 4 has mass and area of the meridian section in &
                              &it (mpm_3d: already multiplied by r, and again when read).')
    call description%add_note('The file may also have cells of other dimensions, which are passed &
                              &over (mpm_3d in 2D: breaks).')
  end subroutine gmsh_points_describe

  !> Generate the points.
  subroutine gmsh_points_init(self, grid, properties, point_file, config_file, error)
    !> The points.
    class(gmsh_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties: without effect.
    type(properties_t), intent(in) :: properties
    !> The generator text.
    type(value_t), intent(in) :: point_file
    !> The config, beside which a relative path is looked for.
    character(*), intent(in) :: config_file
    !> A missing or bad text or mesh, or no points.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    type(generator_text_t) :: text
    type(gmsh_mesh_t) :: mesh
    type(part_list_t) :: parts
    real(wp), allocatable :: table(:, :)
    integer, allocatable :: line_of_row(:)
    real(wp) :: density(1)
    integer :: pieces(1)

    associate (unused => properties)
    end associate
    if (allocated(self%kept)) then
      call self%revive(grid%kin)
      return
    end if
    if (grid%kin%dim == 1) then
      call raise(error, err_input, 'GmshPoints are for TYPE 2 to 5', file=config_file, &
                 hint='use CartesianPoints')
      return
    end if
    call find_point_file(point_file, config_file, path, error)
    if (.not. allocated(error)) call text%open(path, known_keys, error)
    if (.not. allocated(error)) call text%read_integers('lmpp', pieces, error)
    if (.not. allocated(error)) call text%read_reals('rho', density, error)
    if (.not. allocated(error)) call read_mesh(text, grid%kin%dim, mesh, error)
    if (.not. allocated(error)) call parts%init(grid%kin, text%document, error)
    if (allocated(error)) return
    allocate (table(full_width(grid%kin), 0), line_of_row(0))
    call make_table(text, mesh, parts, grid%kin%dim, pieces(1), density(1), table, line_of_row, &
                    error)
    if (.not. allocated(error)) call self%init_from_table(grid, table, path, line_of_row, error)
    if (allocated(error) .or. len(text%out_file) == 0) return
    self%out_file = text%out_file
    call move_alloc(table, self%table)
  end subroutine gmsh_points_init

  !> Read the mesh that the text names.
  subroutine read_mesh(text, dim, mesh, error)
    !> The generator text.
    type(generator_text_t), intent(in) :: text
    !> Dimensions.
    integer, intent(in) :: dim
    !> The mesh.
    type(gmsh_mesh_t), intent(out) :: mesh
    !> A missing or bad mesh.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: name, path

    call text%read_text('msh_file', name, error)
    if (allocated(error)) return
    call find_input_file(name, text%document%path, path, error)
    if (allocated(error)) then
      error%file = text%document%path
      error%line = text%line_of('msh_file')
      return
    end if
    call read_gmsh(path, dim, mesh, error)
  end subroutine read_mesh

  !> Write the table that the generator text asks for, once.
  subroutine gmsh_points_write_table(self, error)
    !> The points.
    class(gmsh_points_t), intent(inout) :: self
    !> A table that can't be written.
    type(error_t), allocatable, intent(out) :: error

    if (.not. allocated(self%table)) return
    call write_points_table(self%out_file, self%table, error)
    deallocate (self%table)
  end subroutine gmsh_points_write_table

  !> Rows of a points table for all places that lie in a part.
  subroutine make_table(text, mesh, parts, dim, pieces, density, table, line_of_row, error)
    !> The generator text.
    type(generator_text_t), intent(in) :: text
    !> The mesh.
    type(gmsh_mesh_t), intent(in) :: mesh
    !> The parts.
    type(part_list_t), intent(in) :: parts
    !> Dimensions.
    integer, intent(in) :: dim
    !> Pieces of each edge of a cell.
    integer, intent(in) :: pieces
    !> Density. [kg/m3]
    real(wp), intent(in) :: density
    !> Mass, volume, position, velocity, active; its width is given. (columns, n)
    real(wp), allocatable, intent(inout) :: table(:, :)
    !> Line of the part of each point. (n)
    integer, allocatable, intent(inout) :: line_of_row(:)
    !> No point, or too many.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: place(:, :), share(:)
    integer(lp) :: each
    integer :: columns, pass, n, status

    columns = size(table, 1)
    each = count_samples(dim, pieces)
    if (each*size(mesh%cell, 2) > huge(1)) then
      call raise(error, err_input, to_text(each)//' points in each cell are too many', &
                 file=text%document%path, line=text%line_of('lmpp'), hint='use a smaller lmpp')
      return
    end if
    call simplex_samples(dim, pieces, place, share)
    do pass = 1, 2
      if (pass == 2) call visit_cells(mesh, parts, dim, place, share, density, n, table, &
                                      line_of_row)
      if (pass == 2) return
      call visit_cells(mesh, parts, dim, place, share, density, n)
      if (n == 0) then
        call raise(error, err_input, 'no point of the mesh lies in a part', &
                   file=text%document%path, hint='check the parts against the mesh, or use more &
                   &points (lmpp)')
        return
      end if
      deallocate (table, line_of_row)
      allocate (table(columns, n), stat=status)
      if (status == 0) allocate (line_of_row(n), stat=status)
      if (status /= 0) then
        call raise(error, err_input, to_text(n)//' points are too many for the memory', &
                   file=text%document%path)
        return
      end if
    end do
  end subroutine make_table

  !> Count the places that lie in a part, cell by cell, and fill their rows.
  subroutine visit_cells(mesh, parts, dim, place, share, density, n, table, line_of_row)
    !> The mesh.
    type(gmsh_mesh_t), intent(in) :: mesh
    !> The parts.
    type(part_list_t), intent(in) :: parts
    !> Dimensions.
    integer, intent(in) :: dim
    !> Places in the coordinates of a cell. (dim, each)
    real(wp), intent(in) :: place(:, :)
    !> Parts of the volume of the cell. (each)
    real(wp), intent(in) :: share(:)
    !> Density. [kg/m3]
    real(wp), intent(in) :: density
    !> Number of places in parts.
    integer, intent(out) :: n
    !> Mass, volume, position, velocity, active. (columns, n)
    real(wp), intent(inout), optional :: table(:, :)
    !> Line of the part of each point. (n)
    integer, intent(inout), optional :: line_of_row(:)
    real(wp) :: edge(dim, dim), x(dim), volume
    integer :: c, k, part

    n = 0
    do c = 1, size(mesh%cell, 2)
      do k = 1, dim
        edge(:, k) = mesh%x(:dim, mesh%cell(k + 1, c)) - mesh%x(:dim, mesh%cell(1, c))
      end do
      volume = volume_of(dim, edge)
      do k = 1, size(share)
        x = mesh%x(:dim, mesh%cell(1, c)) + matmul(edge, place(:, k))
        part = parts%find(x)
        if (part == 0) cycle
        n = n + 1
        if (.not. (present(table) .and. present(line_of_row))) cycle
        table(:, n) = 0.0_wp
        table(1, n) = density*volume*share(k)
        table(2, n) = volume*share(k)
        table(3:2 + dim, n) = x
        table(size(table, 1), n) = 1.0_wp
        line_of_row(n) = parts%slots(part)%line
      end do
    end do
  end subroutine visit_cells

  !> Area or volume between the edges of a simplex.
  pure function volume_of(dim, e) result(volume)
    !> Dimensions, 2 or 3.
    integer, intent(in) :: dim
    !> Edges from one node. [m]
    real(wp), intent(in) :: e(dim, dim)
    !> Its volume.
    real(wp) :: volume

    if (dim == 2) then
      volume = 0.5_wp*abs(e(1, 1)*e(2, 2) - e(2, 1)*e(1, 2))
    else
      volume = abs(e(1, 1)*(e(2, 2)*e(3, 3) - e(3, 2)*e(2, 3)) &
                   - e(2, 1)*(e(1, 2)*e(3, 3) - e(3, 2)*e(1, 3)) &
                   + e(3, 1)*(e(1, 2)*e(2, 3) - e(2, 2)*e(1, 3)))/6.0_wp
    end if
  end function volume_of

end module mpm_gmsh_points
