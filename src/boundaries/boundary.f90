!> The role `boundary`: what holds a body at the faces of the grid.
module mpm_boundary
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: boundary_t

  !> A rule for the nodes of one body.
  type, abstract, extends(configurable_t) :: boundary_t
  contains
    !> Set up the rule.
    procedure(init_i), deferred :: init
    !> See the body's own forces, before contacts add theirs.
    procedure :: generate => boundary_generate
    !> Change momentum, velocity and force of the nodes, after the contacts.
    procedure(apply_i), deferred :: apply
    !> Give components of nodal velocities that the walls prescribe their values.
    procedure :: prescribe => boundary_prescribe
    !> Send the fields of a frame.
    procedure :: write_fields => boundary_write_fields
  end type boundary_t

  abstract interface
    !> Set up the rule.
    subroutine init_i(self, grid, points, properties, error)
      import :: boundary_t, error_t, grid_t, points_t, properties_t
      implicit none
      !> The boundary.
      class(boundary_t), intent(inout) :: self
      !> The grid.
      class(grid_t), intent(in) :: grid
      !> Points of the body; a boundary may set their initial velocity.
      class(points_t), intent(inout) :: points
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> A grid or values that do not fit.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Change momentum, velocity and force of the nodes.
    subroutine apply_i(self, grid, points, nodes, dt)
      import :: boundary_t, grid_t, nodes_t, points_t, wp
      implicit none
      !> The boundary.
      class(boundary_t), intent(inout) :: self
      !> The grid.
      class(grid_t), intent(in) :: grid
      !> Points of the body.
      class(points_t), intent(in) :: points
      !> Nodes of the body: momentum at the start of the step, all forces.
      class(nodes_t), intent(inout) :: nodes
      !> Time step. [s]
      real(wp), intent(in) :: dt
    end subroutine apply_i
  end interface

contains

  !> Most rules need nothing of the body's own forces.
  subroutine boundary_generate(self, grid, points, nodes)
    !> The boundary.
    class(boundary_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> Nodes of the body: mass, momentum, internal and body forces.
    class(nodes_t), intent(in) :: nodes

    associate (unused => self, unused_grid => grid, unused_points => points, unused_nodes => nodes)
    end associate
  end subroutine boundary_generate

  !> Give components of nodal velocities that the walls prescribe their values: none here.
  subroutine boundary_prescribe(self, window, still, velocity)
    !> The boundary.
    class(boundary_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Take 0 for the velocity of walls that move, as for a difference of two velocities.
    logical, intent(in) :: still
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)

    associate (unused => self, unused_window => window, unused_still => still, &
               unused_velocity => velocity)
    end associate
  end subroutine boundary_prescribe

  !> Most rules have no field of their own.
  subroutine boundary_write_fields(self, grid, nodes, writer)
    !> The boundary.
    class(boundary_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Nodes of the body.
    class(nodes_t), intent(in) :: nodes
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => self, unused_grid => grid, unused_nodes => nodes, unused_writer => writer)
    end associate
  end subroutine boundary_write_fields

end module mpm_boundary
