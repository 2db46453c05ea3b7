!> Linear functions on a box that is periodic in all directions but the last.
module mpm_cartesian_periodic
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_cartesian_text, only: add_cells, add_lengths, add_notes, add_origin
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: cartesian_periodic_t

  !> Linear functions on a box that is periodic in all directions but the last.
  type, extends(cartesian_grid_t) :: cartesian_periodic_t
  contains
    procedure, nopass :: describe => cartesian_periodic_describe
    procedure :: init => cartesian_periodic_init
  end type cartesian_periodic_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_periodic_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'CartesianPeriodic', &
                          'Linear functions on equal cells of a box that is periodic in all &
                          &directions but the last.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'grid'//nl//'{'//nl//'    class = "CartesianPeriodic"'//nl// &
                          '    properties = {1.0, 1.0}     # Lx, Ly'//nl// &
                          '    int-properties = {20, 20}   # Nx, Ny'//nl//'}')
    call add_lengths(description)
    call add_origin(description)
    call add_cells(description)
    call description%add_note('In mpm_3d the forces of the last cell of a periodic direction are &
                              &lost.')
    call add_notes(description, smooth=.false., periodic=.true.)
  end subroutine cartesian_periodic_describe

  !> Build the grid from its properties.
  subroutine cartesian_periodic_init(self, kin, properties, error)
    !> The grid.
    class(cartesian_periodic_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Sizes that do not fit together.
    type(error_t), allocatable, intent(out) :: error

    call self%init_box(kin, properties, error)
    if (allocated(error)) return
    if (kin%sim_type == type_axisymmetric) then
      call properties%reject('Lx', 'CartesianPeriodic has a periodic radius in TYPE 4', error, &
                             'use CartesianCustom, with walls along x and a periodic height')
      return
    end if
    self%periodic(:kin%dim - 1) = .true.
  end subroutine cartesian_periodic_init

end module mpm_cartesian_periodic
