!> Hat functions on a Cartesian grid.
module mpm_cartesian_linear
  use mpm_cartesian_grid, only: cartesian_grid_t
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: stencil_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: cartesian_linear_t

  !> Linear, bilinear or trilinear functions on the box [0, L].
  type, extends(cartesian_grid_t) :: cartesian_linear_t
  contains
    procedure, nopass :: describe => cartesian_linear_describe
    procedure :: init => cartesian_linear_init
    procedure :: node_volume => cartesian_linear_node_volume
    procedure :: make_stencil => cartesian_linear_make_stencil
  end type cartesian_linear_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_linear_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    character(1), parameter :: axes(3) = ['x', 'y', 'z']
    integer :: d

    call description%init('grid', 'CartesianLinear', &
                          'Linear (TYPE 1), bilinear (2, 4, 5) or trilinear (3) functions on equal &
                          &cells of the box [0, L].', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'grid'//nl//'{'//nl//'    class = "CartesianLinear"'//nl// &
                          '    properties = {1.0, 1.0}     # Lx, Ly'//nl// &
                          '    int-properties = {20, 20}   # Nx, Ny'//nl//'}')
    do d = 1, 3
      call description%add_real('L'//axes(d), 'm', 'length of the box along '//axes(d), &
                                above=0.0_wp, types=types_with_dim(d))
    end do
    do d = 1, 3
      call description%add_integer('N'//axes(d), 'cells along '//axes(d), lower=1, &
                                   types=types_with_dim(d))
    end do
    call description%add_note('TYPE 4: x is the radius r and y the height z; TYPE 5: the third &
                              &direction has no cells.')
    call description%add_note('A point on a node line belongs to the cell above it, a point on an &
                              &upper face to the last cell (mpm_3d: NaN, and a frozen point).')
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

  !> Integral of a hat function: h per direction, half of it at the faces.
  pure function cartesian_linear_node_volume(self, node) result(volume)
    !> The grid.
    class(cartesian_linear_t), intent(in) :: self
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Volume. [m3]
    real(wp) :: volume
    integer :: d

    volume = 1.0_wp
    do d = 1, self%kin%dim
      volume = volume*self%h(d)
      if (node(d) == 0 .or. node(d) == self%n_cells(d)) volume = 0.5_wp*volume
    end do
  end function cartesian_linear_node_volume

  !> Hats, or their averages over the corners of the points' boxes.
  subroutine cartesian_linear_make_stencil(self, averaged, largest_extent, stencil, error)
    !> The grid.
    class(cartesian_linear_t), intent(in) :: self
    !> Average over the corners of the points' boxes.
    logical, intent(in) :: averaged
    !> Largest half side of a point's box. [m]
    real(wp), intent(in) :: largest_extent
    !> The basis.
    type(stencil_t), intent(out) :: stencil
    !> The boxes are wider than four cells.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: smallest

    smallest = minval(self%h(:self%kin%dim))
    stencil%dim = self%kin%dim
    stencil%lower = self%lower
    stencil%h = self%h
    stencil%n_cells = self%n_cells
    stencil%averaged = averaged
    stencil%width = 2
    if (.not. averaged) return
    ! The corners lie half of the half side away from the point on both sides.
    stencil%width = merge(3, 4, largest_extent <= smallest)
    if (largest_extent > 2.0_wp*smallest) then
      call raise(error, err_input, 'a point with a box of side '//to_text(2.0_wp*largest_extent)// &
                 ' m is wider than four cells of the grid', &
                 hint='use more points, a coarser grid, or no corner averaging (cpdi = 0)')
    end if
  end subroutine cartesian_linear_make_stencil

end module mpm_cartesian_linear
