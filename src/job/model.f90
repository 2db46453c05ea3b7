!> The physical model that a solver advances: grid, bodies and contacts at one time.
module mpm_model
  use mpm_body, only: body_slot_t
  use mpm_contact, only: contact_slot_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_phase_clock, only: phase_clock_t
  implicit none
  private
  public :: model_t

  !> Grid, bodies and contacts, and the time to which they belong.
  type :: model_t
    !> Component counts of the job's TYPE.
    type(kinematics_t) :: kin
    !> Number of threads; 0, until the job starts, for what OMP_NUM_THREADS says.
    integer :: threads = 1
    !> Start time. [s]
    real(wp) :: t_start = 0.0_wp
    !> Time and step from which steps are counted, when dt or the end of the run was changed at a
    !! restart: time since the start [s].
    real(wp) :: t_counted = 0.0_wp
    !> Steps made up to there.
    integer(lp) :: step_counted = 0
    !> Time of the state. [s]
    real(wp) :: time = 0.0_wp
    !> Time step as configured. [s]
    real(wp) :: dt = 0.0_wp
    !> Length of the last step; 0 before the first. [s]
    real(wp) :: last_dt = 0.0_wp
    !> Time over which the forces of the last step acted: its length, or that between the middles of
    !! the last two steps. [s]
    real(wp) :: last_kick = 0.0_wp
    !> Steps made.
    integer(lp) :: step = 0
    !> Most bytes that points and nodes may take; 0 for what the machine has.
    integer(lp) :: memory_limit = 0
    !> The grid.
    class(grid_t), allocatable :: grid
    !> The bodies in the order of the config.
    type(body_slot_t), allocatable :: bodies(:)
    !> The contacts in the order of the config.
    type(contact_slot_t), allocatable :: contacts(:)
    !> Wall time of the phases of the run.
    type(phase_clock_t) :: clock
  end type model_t

end module mpm_model
