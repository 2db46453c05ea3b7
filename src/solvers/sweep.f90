!> What one visit to the points of a body does.
module mpm_sweep
  use mpm_kinds, only: wp
  implicit none
  private
  public :: sweep_t

  !> Parts of a step that a visit to all points makes, and how velocities are transferred.
  type :: sweep_t
    !> Change the velocities of the points.
    logical :: kick = .true.
    !> Move the points; find their new cells.
    logical :: drift = .true.
    !> Form the velocity gradients; change volumes and stresses.
    logical :: strain = .true.
    !> Form the gradients of the velocities of a second mapping.
    logical :: remapped = .false.
    !> Part of its own velocity that a point keeps.
    real(wp) :: kept = 1.0_wp
  end type sweep_t

end module mpm_sweep
