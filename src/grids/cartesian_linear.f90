!> Hat functions on a Cartesian grid.
module mpm_cartesian_linear
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_cartesian_text, only: add_cells, add_lengths, add_notes, add_origin
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: cartesian_linear_t

  !> Linear, bilinear or trilinear functions on a box.
  type, extends(cartesian_grid_t) :: cartesian_linear_t
  contains
    procedure, nopass :: describe => cartesian_linear_describe
    procedure :: init => cartesian_linear_init
  end type cartesian_linear_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_linear_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'CartesianLinear', &
                          'Linear (TYPE 1), bilinear (2, 4, 5) or trilinear (3) functions on equal &
                          &cells of a box.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'grid'//nl//'{'//nl//'    class = "CartesianLinear"'//nl// &
                          '    properties = {1.0, 1.0}     # Lx, Ly'//nl// &
                          '    int-properties = {20, 20}   # Nx, Ny'//nl//'}')
    call add_lengths(description)
    call add_origin(description)
    call add_cells(description)
    call add_notes(description, smooth=.false., periodic=.false.)
  end subroutine cartesian_linear_describe

  !> Build the grid from its properties.
  subroutine cartesian_linear_init(self, kin, properties, error)
    !> The grid.
    class(cartesian_linear_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> More nodes than indices exist.
    type(error_t), allocatable, intent(out) :: error

    call self%init_box(kin, properties, error)
  end subroutine cartesian_linear_init

end module mpm_cartesian_linear
