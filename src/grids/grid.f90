!> The role `grid`: the nodes and the functions on them.
module mpm_grid
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: stencil_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: grid_t

  !> Nodes, cells and basis of the computational grid.
  type, abstract, extends(configurable_t) :: grid_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
  contains
    !> Build the grid from its properties.
    procedure(init_i), deferred :: init
    !> All nodes of the grid.
    procedure(whole_i), deferred :: whole
    !> Number of cells.
    procedure(count_i), deferred :: cell_count
    !> Kind of the cells in VTK files.
    procedure(count_i), deferred :: vtk_cell_type
    !> Nodes of a cell in the order of its VTK kind.
    procedure(cell_nodes_i), deferred :: cell_nodes
    !> Position of a node.
    procedure(node_position_i), deferred :: node_position
    !> Integral of a node's function.
    procedure(node_volume_i), deferred :: node_volume
    !> Corners of the bounding box.
    procedure(bounds_i), deferred :: bounds
    !> Smallest distance between nodes along each direction.
    procedure(spacing_i), deferred :: spacing
    !> Whether a position is inside.
    procedure(in_domain_i), deferred :: in_domain
    !> The basis as the kernels need it.
    procedure(make_stencil_i), deferred :: make_stencil
    !> After how many nodes the grid repeats in each direction; 0 where it does not.
    procedure :: periods => grid_periods
    !> Send the velocity of the grid at its nodes, for frames.
    procedure :: write_velocity => grid_write_velocity
    !> Send fields of the grid itself, for frames.
    procedure :: write_fields => grid_write_fields
  end type grid_t

  abstract interface
    !> Build the grid from its properties.
    subroutine init_i(self, kin, properties, error)
      import :: error_t, grid_t, kinematics_t, properties_t
      implicit none
      !> The grid.
      class(grid_t), intent(inout) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Sizes that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> All nodes of the grid as a window.
    pure function whole_i(self) result(window)
      import :: grid_t, window_t
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Window of all nodes.
      type(window_t) :: window
    end function whole_i

    !> A count or code.
    pure function count_i(self) result(n)
      import :: grid_t
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> The number.
      integer :: n
    end function count_i

    !> Nodes of a cell.
    pure subroutine cell_nodes_i(self, cell, nodes, n)
      import :: grid_t
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Cell, from 0.
      integer, intent(in) :: cell
      !> Node ids, from 0, the first `n` are set. (8)
      integer, intent(out) :: nodes(8)
      !> Number of nodes.
      integer, intent(out) :: n
    end subroutine cell_nodes_i

    !> Position of a node.
    pure function node_position_i(self, node) result(x)
      import :: grid_t, wp
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Grid indices, from 0.
      integer, intent(in) :: node(3)
      !> Position, unused components 0. [m]
      real(wp) :: x(3)
    end function node_position_i

    !> Integral of a node's function over the grid (TYPE 4: over the meridian plane, without r).
    pure function node_volume_i(self, node) result(volume)
      import :: grid_t, wp
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Grid indices, from 0.
      integer, intent(in) :: node(3)
      !> Volume. [m3, per unit depth where the TYPE has no depth]
      real(wp) :: volume
    end function node_volume_i

    !> Corners of the bounding box.
    pure subroutine bounds_i(self, lower, upper)
      import :: grid_t, wp
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Lower corner, unused components 0. [m]
      real(wp), intent(out) :: lower(3)
      !> Upper corner, unused components 0. [m]
      real(wp), intent(out) :: upper(3)
    end subroutine bounds_i

    !> Smallest distance between nodes along each direction.
    pure function spacing_i(self) result(h)
      import :: grid_t, wp
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Spacing, unused components 1. [m]
      real(wp) :: h(3)
    end function spacing_i

    !> Whether a position is inside, faces included.
    pure function in_domain_i(self, x) result(inside)
      import :: grid_t, wp
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Position. [m] (dim)
      real(wp), intent(in) :: x(:)
      !> Whether it is inside; false for NaN.
      logical :: inside
    end function in_domain_i

    !> The basis as the kernels need it.
    subroutine make_stencil_i(self, averaged, largest_extent, stencil, error)
      import :: error_t, grid_t, stencil_t, wp
      implicit none
      !> The grid.
      class(grid_t), intent(in) :: self
      !> Average over the corners of the points' boxes.
      logical, intent(in) :: averaged
      !> Largest half side of a point's box. [m]
      real(wp), intent(in) :: largest_extent
      !> The basis.
      type(stencil_t), intent(out) :: stencil
      !> The boxes are too large for the grid.
      type(error_t), allocatable, intent(out) :: error
    end subroutine make_stencil_i
  end interface

contains

  !> Most grids do not repeat.
  pure function grid_periods(self) result(periods)
    !> The grid.
    class(grid_t), intent(in) :: self
    !> Nodes of a period; 0 where there is none.
    integer :: periods(3)

    associate (unused => self)
    end associate
    periods = 0
  end function grid_periods

  !> Nothing to send where the velocity of the grid at a node is that of the node.
  subroutine grid_write_velocity(self, window, velocity, writer)
    !> The grid.
    class(grid_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(in) :: velocity(:, :)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => self, unused_window => window, unused_velocity => velocity, &
               unused_writer => writer)
    end associate
  end subroutine grid_write_velocity

  !> Most grids have no fields of their own.
  subroutine grid_write_fields(self, writer)
    !> The grid.
    class(grid_t), intent(in) :: self
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => self, unused_writer => writer)
    end associate
  end subroutine grid_write_fields

end module mpm_grid
