!> Linear functions on the triangles of a Gmsh mesh.
module mpm_triangular_grid_linear
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_mesh_grid, only: add_mesh_file, add_mesh_notes, mesh_grid_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: triangular_grid_linear_t

  !> Triangles.
  type, extends(mesh_grid_t) :: triangular_grid_linear_t
  contains
    procedure, nopass :: describe => triangular_grid_linear_describe
    procedure :: init => triangular_grid_linear_init
  end type triangular_grid_linear_t

contains

  !> Purpose and properties of the class.
  subroutine triangular_grid_linear_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'TriangularGridLinear', &
                          'Linear functions on the triangles of a Gmsh mesh; in TYPE 2, 4, 5.', &
                          'Gmsh reference manual, file formats (gmsh.info)', &
                          'grid'//nl//'{'//nl//'    class = "TriangularGridLinear"'//nl// &
                          '    properties = {0.05}   # side of the search boxes; optional'// &
                          nl//'    str-properties = {"box.msh"}'//nl//'}')
    call description%add_real('cell_size', 'm', 'side of the boxes in which points are looked for; &
                              &0: chosen from the mesh. Has no effect on results', default=0.0_wp, &
                              lower=0.0_wp)
    call add_mesh_file(description)
    call description%add_note('The triangles must lie in a plane z = const. TYPE 4: x is the &
                              &radius.')
    call add_mesh_notes(description)
  end subroutine triangular_grid_linear_describe

  !> Read the mesh.
  subroutine triangular_grid_linear_init(self, kin, properties, error)
    !> The grid.
    class(triangular_grid_linear_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A TYPE without a plane, or a bad mesh.
    type(error_t), allocatable, intent(out) :: error

    self%kin = kin
    if (kin%dim /= 2) then
      call properties%reject('mesh', 'TriangularGridLinear is for TYPE 2, 4 and 5, not '// &
                             to_text(kin%sim_type), error, 'use another grid, or another TYPE')
      return
    end if
    call self%init_from_file(kin, properties, spread(properties%real('cell_size'), 1, 3), error)
  end subroutine triangular_grid_linear_init

end module mpm_triangular_grid_linear
