!> The role `part`: shapes that say which generated points a body has.
module mpm_part
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: part_slot_t, part_t

  !> A set of positions.
  type, abstract, extends(configurable_t) :: part_t
  contains
    !> Set the shape from its properties.
    procedure(init_i), deferred :: init
    !> Whether a position is in the part.
    procedure(contains_i), deferred :: contains
    !> A box around the part.
    procedure :: bounds => part_bounds
  end type part_t

  !> A part in a list of parts.
  type :: part_slot_t
    !> The part.
    class(part_t), allocatable :: part
    !> Line of its section, for messages.
    integer :: line = 0
  end type part_slot_t

  abstract interface
    !> Set the shape from its properties.
    subroutine init_i(self, kin, properties, error)
      import :: error_t, kinematics_t, part_t, properties_t
      implicit none
      !> The part.
      class(part_t), intent(inout) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together, or a TYPE that the part does not exist in.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Whether a position is in the part.
    pure function contains_i(self, x) result(inside)
      import :: part_t, wp
      implicit none
      !> The part.
      class(part_t), intent(in) :: self
      !> Position. [m] (dim)
      real(wp), intent(in) :: x(:)
      !> Whether it is inside; the surface belongs to it unless the class says otherwise.
      logical :: inside
    end function contains_i
  end interface

contains

  !> Most parts have no bounds.
  pure subroutine part_bounds(self, lower, upper)
    !> The part.
    class(part_t), intent(in) :: self
    !> Lower corner, at or below every position of the part without negative coordinates. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner, at or above every such position. [m]
    real(wp), intent(out) :: upper(3)

    associate (unused => self)
    end associate
    lower = -huge(1.0_wp)
    upper = huge(1.0_wp)
  end subroutine part_bounds

end module mpm_part
