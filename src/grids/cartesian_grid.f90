!> What all Cartesian grids share: equal cells in a box, numbered x first.
module mpm_cartesian_grid
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: cartesian_grid_t

  !> Equal cells in a box.
  type, abstract, extends(grid_t) :: cartesian_grid_t
    !> Cells in each direction; 0 in unused ones.
    integer :: n_cells(3) = 0
    !> Spacing; 1 in unused directions. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Lower corner. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Upper corner. [m]
    real(wp) :: upper(3) = 0.0_wp
    !> Directions in which the upper face is the lower one again.
    logical :: periodic(3) = .false.
  contains
    procedure :: whole => cartesian_whole
    procedure :: cell_count => cartesian_cell_count
    procedure :: vtk_cell_type => cartesian_vtk_cell_type
    procedure :: cell_nodes => cartesian_cell_nodes
    procedure :: node_position => cartesian_node_position
    procedure :: bounds => cartesian_bounds
    procedure :: spacing => cartesian_spacing
    procedure :: in_domain => cartesian_in_domain
    !> Set lengths and cell counts from the properties Lx Ly Lz and Nx Ny Nz.
    procedure :: init_box => cartesian_init_box
  end type cartesian_grid_t

contains

  !> Set lengths and cell counts from the properties Lx, Ly, Lz and Nx, Ny, Nz.
  subroutine cartesian_init_box(self, kin, properties, error)
    !> The grid.
    class(cartesian_grid_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> More nodes than indices exist.
    type(error_t), allocatable, intent(out) :: error
    character(2), parameter :: lengths(3) = ['Lx', 'Ly', 'Lz'], counts(3) = ['Nx', 'Ny', 'Nz']
    integer(lp) :: nodes
    integer :: d

    self%kin = kin
    nodes = 1
    do d = 1, kin%dim
      self%upper(d) = properties%real(lengths(d))
      self%n_cells(d) = properties%integer(counts(d))
      self%h(d) = self%upper(d)/real(self%n_cells(d), wp)
      if (nodes <= huge(1)) nodes = nodes*(int(self%n_cells(d), lp) + 1)
    end do
    if (nodes > int(huge(1), lp)) then
      call properties%reject('Nx', 'the grid has more than '//to_text(huge(1))//' nodes', error, &
                             'use fewer cells')
    end if
  end subroutine cartesian_init_box

  !> All nodes of the grid.
  pure function cartesian_whole(self) result(window)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Window of all nodes.
    type(window_t) :: window

    window%lo = 0
    window%n = self%n_cells + 1
  end function cartesian_whole

  !> Number of cells.
  pure function cartesian_cell_count(self) result(n)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Number of cells.
    integer :: n

    n = product(self%n_cells(:self%kin%dim))
  end function cartesian_cell_count

  !> VTK line, pixel or voxel.
  pure function cartesian_vtk_cell_type(self) result(n)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> VTK cell type.
    integer :: n
    integer, parameter :: types(3) = [3, 8, 11]

    n = types(self%kin%dim)
  end function cartesian_vtk_cell_type

  !> Corners of a cell, x fastest.
  pure subroutine cartesian_cell_nodes(self, cell, nodes, n)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Cell, from 0, x fastest.
    integer, intent(in) :: cell
    !> Node ids, from 0.
    integer, intent(out) :: nodes(8)
    !> Number of nodes.
    integer, intent(out) :: n
    integer :: c(3), rest, corner, node(3)
    type(window_t) :: window

    window = self%whole()
    c(1) = mod(cell, self%n_cells(1))
    rest = cell/self%n_cells(1)
    c(2) = 0
    c(3) = 0
    if (self%kin%dim > 1) then
      c(2) = mod(rest, self%n_cells(2))
      c(3) = rest/self%n_cells(2)
    end if
    n = 2**self%kin%dim
    nodes = 0
    do corner = 0, n - 1
      node = c + [iand(corner, 1), iand(corner/2, 1), corner/4]
      nodes(corner + 1) = window%start(node)
    end do
  end subroutine cartesian_cell_nodes

  !> Position of a node.
  pure function cartesian_node_position(self, node) result(x)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Position; nodes of the upper faces lie on the faces exactly. [m]
    real(wp) :: x(3)

    x = self%lower + real(node, wp)*self%h
    where (node == self%n_cells) x = self%upper
  end function cartesian_node_position

  !> Corners of the box.
  pure subroutine cartesian_bounds(self, lower, upper)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    lower = self%lower
    upper = self%upper
  end subroutine cartesian_bounds

  !> Spacing of the nodes.
  pure function cartesian_spacing(self) result(h)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Spacing. [m]
    real(wp) :: h(3)

    h = self%h
  end function cartesian_spacing

  !> Whether a position is in the closed box.
  pure function cartesian_in_domain(self, x) result(inside)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is inside; false for NaN.
    logical :: inside

    inside = all(x >= self%lower(:size(x)) .and. x <= self%upper(:size(x)))
  end function cartesian_in_domain

end module mpm_cartesian_grid
