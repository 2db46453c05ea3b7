!> What the Cartesian grids say of themselves in the same words.
module mpm_cartesian_text
  use mpm_description, only: description_t, types_with_dim
  use mpm_kinds, only: wp
  implicit none
  private
  public :: add_cells, add_lengths, add_notes, add_origin, add_periodic

  !> Names of the directions.
  character(1), parameter :: axes(3) = ['x', 'y', 'z']

contains

  !> Describe the lengths Lx, Ly, Lz.
  subroutine add_lengths(description)
    !> The description.
    type(description_t), intent(inout) :: description
    integer :: d

    do d = 1, 3
      call description%add_real('L'//axes(d), 'm', 'length of the box along '//axes(d), &
                                above=0.0_wp, types=types_with_dim(d))
    end do
  end subroutine add_lengths

  !> Describe the origin x0, y0, z0, which is given by name.
  subroutine add_origin(description, first)
    !> The description.
    type(description_t), intent(inout) :: description
    !> First direction; 1 when left out.
    integer, intent(in), optional :: first
    integer :: d, start

    start = 1
    if (present(first)) start = first
    do d = start, 3
      call description%add_real(axes(d)//'0', 'm', 'lower face of the box along '//axes(d), &
                                default=0.0_wp, types=types_with_dim(d), by_name=.true.)
    end do
  end subroutine add_origin

  !> Describe the numbers of cells Nx, Ny, Nz.
  subroutine add_cells(description)
    !> The description.
    type(description_t), intent(inout) :: description
    integer :: d

    do d = 1, 3
      call description%add_integer('N'//axes(d), 'cells along '//axes(d), lower=1, &
                                   types=types_with_dim(d))
    end do
  end subroutine add_cells

  !> Describe the flags of periodic directions.
  subroutine add_periodic(description)
    !> The description.
    type(description_t), intent(inout) :: description
    integer :: d

    do d = 1, 3
      call description%add_integer('periodic_'//axes(d), '1: the upper '//axes(d)//' face is the &
                                   &lower one again; 0: both are walls', lower=0, upper=1, &
                                   types=types_with_dim(d))
    end do
  end subroutine add_periodic

  !> Add the remarks on TYPEs, walls and seams.
  subroutine add_notes(description, smooth, periodic)
    !> The description.
    type(description_t), intent(inout) :: description
    !> The functions are smoother than hats.
    logical, intent(in) :: smooth
    !> The grid has periodic directions.
    logical, intent(in) :: periodic

    call description%add_note('TYPE 4: x is the radius r and y the height z. TYPE 5: no cells &
                              &along the third direction.')
    if (smooth) then
      call description%add_note('Next to walls the functions are those of a node behind the wall &
                                &with the linearly extrapolated value, so that linear fields are &
                                &exact up to the wall. That takes 3 cells between walls (mpm_3d: &
                                &not checked).')
      call description%add_note('The flag cpdi of the solver averages these functions too, over &
                                &points up to two cells wide; cpdi = 0 is the usual choice.')
      call description%add_note('Frames have grid_velocity, the velocity of the grid at the nodes, &
                                &which is not that of the nodes, and edge_id: 0 at a wall, 1 and &
                                &-1 next to a lower and an upper one, 3 and -3 next to a seam, 2 &
                                &elsewhere.')
    else
      call description%add_note('A point on a node line belongs to the cell above it, a point on &
                                &an upper face to the last cell (mpm_3d: NaN, and a frozen point).')
    end if
    if (.not. periodic) return
    call description%add_note('In a periodic direction the last node is the first one. Points that &
                              &leave through a face come back at the other; displacements go on. &
                              &CartesianBox and CartesianSmoothBox have no walls there, and &
                              &CartesianBoxCustom takes code 3 or -1.')
    call description%add_note('TYPE 4: the radius can''t be periodic.')
  end subroutine add_notes

end module mpm_cartesian_text
