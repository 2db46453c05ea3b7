!> Linear functions on the tetrahedra of a Gmsh mesh.
module mpm_tetrahedral_grid_linear
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_mesh_grid, only: add_mesh_file, add_mesh_notes, mesh_grid_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: tetrahedral_grid_linear_t

  !> Tetrahedra.
  type, extends(mesh_grid_t) :: tetrahedral_grid_linear_t
  contains
    procedure, nopass :: describe => tetrahedral_grid_linear_describe
    procedure :: init => tetrahedral_grid_linear_init
  end type tetrahedral_grid_linear_t

contains

  !> Purpose and properties of the class.
  subroutine tetrahedral_grid_linear_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'TetrahedralGridLinear', &
                          'Linear functions on the tetrahedra of a Gmsh mesh; only in TYPE 3.', &
                          'Gmsh reference manual, file formats (gmsh.info)', &
                          'grid'//nl//'{'//nl//'    class = "TetrahedralGridLinear"'//nl// &
                          '    properties = {0.1}   # side of the search boxes; optional'// &
                          nl//'    str-properties = {"box.msh"}'//nl//'}')
    call description%add_real('cell_size', 'm', 'side of the boxes in which points are looked for; &
                              &0: chosen from the mesh. Has no effect on results', default=0.0_wp, &
                              lower=0.0_wp)
    call description%add_real('cell_size_y', 'm', 'the same along y; 0: as along x', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_real('cell_size_z', 'm', 'the same along z; 0: as along x', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_integer('neighbours', 'accepted as in mpm_3d; the last cell of a point is &
                                 &always tried first', default=0, lower=0, upper=1)
    call add_mesh_file(description)
    call description%add_note('Tetrahedra may have either orientation (mpm_3d: inverted ones have &
                              &negative volumes).')
    call add_mesh_notes(description)
  end subroutine tetrahedral_grid_linear_describe

  !> Read the mesh.
  subroutine tetrahedral_grid_linear_init(self, kin, properties, error)
    !> The grid.
    class(tetrahedral_grid_linear_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Another TYPE than 3, or a bad mesh.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: side(3)

    self%kin = kin
    if (kin%dim /= 3) then
      call properties%reject('mesh', 'TetrahedralGridLinear is for TYPE 3, not '// &
                             to_text(kin%sim_type), error, 'use another grid, or set TYPE = 3')
      return
    end if
    side = [properties%real('cell_size'), properties%real('cell_size_y'), &
            properties%real('cell_size_z')]
    where (side <= 0.0_wp) side = side(1)
    call self%init_from_file(kin, properties, side, error)
  end subroutine tetrahedral_grid_linear_init

end module mpm_tetrahedral_grid_linear
