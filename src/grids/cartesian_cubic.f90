!> Cubic B-splines on a box with walls.
module mpm_cartesian_cubic
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_cartesian_text, only: add_cells, add_lengths, add_notes, add_origin
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: basis_cubic
  implicit none
  private
  public :: cartesian_cubic_t

  !> Cubic B-splines on a box with walls.
  type, extends(cartesian_grid_t) :: cartesian_cubic_t
  contains
    procedure, nopass :: describe => cartesian_cubic_describe
    procedure :: init => cartesian_cubic_init
  end type cartesian_cubic_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_cubic_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'CartesianCubic', &
                          'Cubic B-splines on equal cells of a box.', &
                          'Steffen, Kirby and Berzins, Int. J. Numer. Meth. Engng 76 (2008) &
                          &922-948', &
                          'grid'//nl//'{'//nl//'    class = "CartesianCubic"'//nl// &
                          '    properties = {1.0, 1.0}     # Lx, Ly'//nl// &
                          '    int-properties = {20, 20}   # Nx, Ny'//nl//'}')
    call add_lengths(description)
    call add_origin(description)
    call add_cells(description)
    call add_notes(description, smooth=.true., periodic=.false.)
  end subroutine cartesian_cubic_describe

  !> Build the grid from its properties.
  subroutine cartesian_cubic_init(self, kin, properties, error)
    !> The grid.
    class(cartesian_cubic_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Sizes that do not fit together.
    type(error_t), allocatable, intent(out) :: error

    call self%init_box(kin, properties, error)
    if (allocated(error)) return
    call self%init_basis(basis_cubic, properties, error)
  end subroutine cartesian_cubic_init

end module mpm_cartesian_cubic
