!> Quadratic B-splines on a box with walls.
module mpm_cartesian_quadratic
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_cartesian_text, only: add_cells, add_lengths, add_notes, add_origin
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: basis_box
  implicit none
  private
  public :: cartesian_quadratic_t

  !> Quadratic B-splines on a box with walls.
  type, extends(cartesian_grid_t) :: cartesian_quadratic_t
  contains
    procedure, nopass :: describe => cartesian_quadratic_describe
    procedure :: init => cartesian_quadratic_init
  end type cartesian_quadratic_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_quadratic_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'CartesianQuadratic', &
                          'Quadratic B-splines on equal cells of a box.', &
                          'Steffen, Kirby and Berzins, Int. J. Numer. Meth. Engng 76 (2008) &
                          &922-948', &
                          'grid'//nl//'{'//nl//'    class = "CartesianQuadratic"'//nl// &
                          '    properties = {1.0, 1.0}     # Lx, Ly'//nl// &
                          '    int-properties = {20, 20}   # Nx, Ny'//nl//'}')
    call add_lengths(description)
    call add_origin(description)
    call add_cells(description)
    call description%add_note('The volumes of nodes next to a wall are 23/24 of the others &
                              &(mpm_3d: 47/48), so that node volumes fill the box.')
    call add_notes(description, smooth=.true., periodic=.false.)
  end subroutine cartesian_quadratic_describe

  !> Build the grid from its properties.
  subroutine cartesian_quadratic_init(self, kin, properties, error)
    !> The grid.
    class(cartesian_quadratic_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Sizes that do not fit together.
    type(error_t), allocatable, intent(out) :: error

    call self%init_box(kin, properties, error)
    if (allocated(error)) return
    call self%init_basis(basis_box, properties, error)
  end subroutine cartesian_quadratic_init

end module mpm_cartesian_quadratic
