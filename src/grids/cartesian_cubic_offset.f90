!> Cubic B-splines on a box that begins at a radius.
module mpm_cartesian_cubic_offset
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_cartesian_text, only: add_cells, add_lengths, add_notes, add_origin
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: basis_cubic
  use mpm_strings, only: to_text
  implicit none
  private
  public :: cartesian_cubic_offset_t

  !> Cubic B-splines on [r0, r0 + Lx] x [0, Ly].
  type, extends(cartesian_grid_t) :: cartesian_cubic_offset_t
  contains
    procedure, nopass :: describe => cartesian_cubic_offset_describe
    procedure :: init => cartesian_cubic_offset_init
  end type cartesian_cubic_offset_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_cubic_offset_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'CartesianCubic_Offset', &
                          'Cubic B-splines on equal cells of the box [r0, r0 + Lx] x [0, Ly], &
                          &meant for hollow bodies in TYPE 4; TYPE 2 and 5 too.', &
                          'Steffen, Kirby and Berzins, Int. J. Numer. Meth. Engng 76 (2008) &
                          &922-948', &
                          'grid'//nl//'{'//nl//'    class = "CartesianCubic_Offset"'//nl// &
                          '    properties = {1.0, 1.0, 0.1}   # Lx, Ly, r0'//nl// &
                          '    int-properties = {20, 20}      # Nx, Ny'//nl//'}')
    call add_lengths(description)
    call description%add_real('r0', 'm', 'lower face of the box along x')
    call add_origin(description, first=2)
    call add_cells(description)
    call description%add_note('The same as CartesianCubic with x0 = r0. mpm_3d prints an error in &
                              &TYPE 2 and 5 and goes on.')
    call add_notes(description, smooth=.true., periodic=.false.)
  end subroutine cartesian_cubic_offset_describe

  !> Build the grid from its properties.
  subroutine cartesian_cubic_offset_init(self, kin, properties, error)
    !> The grid.
    class(cartesian_cubic_offset_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Sizes that do not fit together, or a TYPE whose grid does not have two dimensions.
    type(error_t), allocatable, intent(out) :: error

    if (kin%dim /= 2) then
      call properties%reject('r0', 'CartesianCubic_Offset is a grid of two dimensions, and &
                             &TYPE '//to_text(kin%sim_type)//' has '//to_text(kin%dim), error, &
                             'use CartesianCubic with a named property: x0 = ...')
      return
    end if
    call self%init_box(kin, properties, error, origin='r0')
    if (allocated(error)) return
    call self%init_basis(basis_cubic, properties, error)
  end subroutine cartesian_cubic_offset_init

end module mpm_cartesian_cubic_offset
