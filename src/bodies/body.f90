!> The role `body`: a continuum body and the objects that make it up.
module mpm_body
  use mpm_boundary, only: boundary_t
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_material, only: material_t
  use mpm_nodes, only: nodes_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_store, only: store_t
  implicit none
  private
  public :: body_restore, body_save, body_slot_t, body_t

  !> A body: points, nodes, and if given a material and a boundary.
  type, abstract, extends(configurable_t) :: body_t
    !> Position among the bodies of the config, from 0.
    integer :: id = 0
    !> Unique name.
    character(:), allocatable :: name
    !> An inactive body maps nothing, moves nothing and feels nothing.
    logical :: active = .true.
    !> Material points.
    class(points_t), allocatable :: points
    !> Nodal fields.
    class(nodes_t), allocatable :: nodes
    !> Constitutive law; without one the stress stays as it is.
    class(material_t), allocatable :: material
    !> Rule at the faces of the grid.
    class(boundary_t), allocatable :: boundary
  contains
    !> Set the body's initial state, when its parts are set up.
    procedure(init_i), deferred :: init
    procedure :: save => body_save
    procedure :: restore => body_restore
  end type body_t

  !> A body in a list of bodies.
  type :: body_slot_t
    !> The body.
    class(body_t), allocatable :: body
  end type body_slot_t

  abstract interface
    !> Set the body's initial state, when its parts are set up.
    subroutine init_i(self, grid, properties, error)
      import :: body_t, error_t, grid_t, properties_t
      implicit none
      !> The body.
      class(body_t), intent(inout) :: self
      !> The grid.
      class(grid_t), intent(in) :: grid
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i
  end interface

contains

  !> Save the state of the body itself; its parts save theirs.
  !!
  !! Public since a class that overrides it can't call it by the name of an abstract parent.
  subroutine body_save(self, store)
    !> The body.
    class(body_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call store%put('active', self%active)
  end subroutine body_save

  !> Take back the state of the body itself.
  subroutine body_restore(self, store)
    !> The body, started.
    class(body_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call store%get('active', self%active)
  end subroutine body_restore

end module mpm_body
