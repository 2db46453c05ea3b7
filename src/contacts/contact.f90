!> The role `contact`: what bodies do to each other at shared nodes.
module mpm_contact
  use mpm_body, only: body_slot_t
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: contact_slot_t, contact_t

  !> A rule between bodies.
  type, abstract, extends(configurable_t) :: contact_t
    !> Name in the config; may be empty.
    character(:), allocatable :: name
  contains
    !> Find the bodies and set the constants.
    procedure(init_i), deferred :: init
    !> Add the contact forces to the nodes of the bodies.
    procedure(apply_i), deferred :: apply
    !> Send the fields of a frame.
    procedure(write_fields_i), deferred :: write_fields
  end type contact_t

  !> A contact in a list of contacts.
  type :: contact_slot_t
    !> The contact.
    class(contact_t), allocatable :: contact
  end type contact_slot_t

  abstract interface
    !> Find the bodies and set the constants.
    subroutine init_i(self, grid, bodies, properties, error)
      import :: body_slot_t, contact_t, error_t, grid_t, properties_t
      implicit none
      !> The contact.
      class(contact_t), intent(inout) :: self
      !> The grid.
      class(grid_t), intent(in) :: grid
      !> All bodies of the job.
      type(body_slot_t), intent(in) :: bodies(:)
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> No such body, or one body twice.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Add the contact forces to the nodes of the bodies.
    subroutine apply_i(self, grid, bodies, dt, implicit, threads)
      import :: body_slot_t, contact_t, grid_t, wp
      implicit none
      !> The contact.
      class(contact_t), intent(inout) :: self
      !> The grid.
      class(grid_t), intent(in) :: grid
      !> All bodies of the job, with the forces of this step so far.
      type(body_slot_t), intent(inout) :: bodies(:)
      !> Time step. [s]
      real(wp), intent(in) :: dt
      !> Use trial momenta that include the forces so far.
      logical, intent(in) :: implicit
      !> Number of threads.
      integer, intent(in) :: threads
    end subroutine apply_i

    !> Send the fields of a frame; every body's node file gets them.
    subroutine write_fields_i(self, bodies, writer)
      import :: body_slot_t, contact_t, field_writer_t
      implicit none
      !> The contact.
      class(contact_t), intent(in) :: self
      !> All bodies of the job.
      type(body_slot_t), intent(in) :: bodies(:)
      !> Receiver of nodal fields.
      class(field_writer_t), intent(inout) :: writer
    end subroutine write_fields_i
  end interface

end module mpm_contact
