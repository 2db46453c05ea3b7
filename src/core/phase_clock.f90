!> Wall time of the phases of a run.
!!
!! One phase runs at a time: to enter one ends the one before. A clock that is off costs a branch.
module mpm_phase_clock
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: phase_clock_t, phase_names
  public :: phase_contact, phase_g2p, phase_material, phase_nodes, phase_other, phase_output
  public :: phase_p2g, phase_setup, phase_sort

  !> Reading the input, first mapping.
  integer, parameter :: phase_setup = 1
  !> Order of the points by cell.
  integer, parameter :: phase_sort = 2
  !> From the points to the nodes.
  integer, parameter :: phase_p2g = 3
  !> Update of the nodes.
  integer, parameter :: phase_nodes = 4
  !> Contacts and walls.
  integer, parameter :: phase_contact = 5
  !> From the nodes to the points, their motion and volume.
  integer, parameter :: phase_g2p = 6
  !> Stress of the points.
  integer, parameter :: phase_material = 7
  !> Frames.
  integer, parameter :: phase_output = 8
  !> The loop over time: choice of the step, progress.
  integer, parameter :: phase_other = 9
  !> Names of the phases.
  character(8), parameter :: phase_names(9) = &
    [character(8) :: 'set-up', 'sort', 'P2G', 'nodes', 'contact', 'G2P', 'material', 'output', &
     'other']

  !> A clock for each phase.
  type :: phase_clock_t
    !> Whether time is taken.
    logical :: on = .false.
    !> The phase that runs.
    integer, private :: current = phase_setup
    !> Clock count when it was entered.
    integer(lp), private :: entered = 0
    !> Clock counts of all phases.
    integer(lp), private :: ticks(size(phase_names)) = 0
  contains
    !> Begin with a phase.
    procedure :: start => phase_clock_start
    !> End the phase that runs and begin another.
    procedure :: enter => phase_clock_enter
    !> Give a part of a phase's time to another.
    procedure :: move => phase_clock_move
    !> Time of a phase that has ended.
    procedure :: seconds => phase_clock_seconds
  end type phase_clock_t

contains

  !> Begin with a phase.
  subroutine phase_clock_start(self, phase)
    !> The clock.
    class(phase_clock_t), intent(inout) :: self
    !> The phase.
    integer, intent(in) :: phase

    self%on = .true.
    self%current = phase
    call system_clock(self%entered)
  end subroutine phase_clock_start

  !> End the phase that runs and begin another.
  subroutine phase_clock_enter(self, phase)
    !> The clock.
    class(phase_clock_t), intent(inout) :: self
    !> The phase.
    integer, intent(in) :: phase
    integer(lp) :: now

    if (.not. self%on) return
    call system_clock(now)
    self%ticks(self%current) = self%ticks(self%current) + (now - self%entered)
    self%entered = now
    self%current = phase
  end subroutine phase_clock_enter

  !> Give a part of the time since the phase that runs was entered to another phase.
  !!
  !! For loops that do the work of two phases in turn, on several threads.
  subroutine phase_clock_move(self, phase, part, whole)
    !> The clock.
    class(phase_clock_t), intent(inout) :: self
    !> The phase that receives.
    integer, intent(in) :: phase
    !> Clock counts that all threads spent in it.
    integer(lp), intent(in) :: part
    !> Clock counts that all threads spent.
    integer(lp), intent(in) :: whole
    integer(lp) :: now, moved

    if (.not. self%on .or. whole <= 0) return
    call system_clock(now)
    moved = int(real(now - self%entered, wp)*(real(part, wp)/real(whole, wp)), lp)
    self%ticks(phase) = self%ticks(phase) + moved
    self%ticks(self%current) = self%ticks(self%current) - moved
  end subroutine phase_clock_move

  !> Time of a phase up to its last end.
  function phase_clock_seconds(self, phase) result(seconds)
    !> The clock.
    class(phase_clock_t), intent(in) :: self
    !> The phase.
    integer, intent(in) :: phase
    !> Wall time. [s]
    real(wp) :: seconds
    integer(lp) :: now, rate

    call system_clock(now, rate)
    seconds = real(self%ticks(phase), wp)/real(rate, wp)
  end function phase_clock_seconds

end module mpm_phase_clock
