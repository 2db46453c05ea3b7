!> The role `nodes`: the grid as one body sees it.
module mpm_nodes
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_huge_pages, only: use_huge_pages
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_memory, only: memory_left
  use mpm_properties, only: properties_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: nodes_t

  !> Nodal fields of one body, over a window of the grid that follows the body.
  !!
  !! The arrays may be longer than the window; only its nodes count. They are formed anew in every
  !! step, so that a moving window costs nothing.
  type, abstract, extends(configurable_t) :: nodes_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
    !> The nodes that have memory.
    type(window_t) :: window
    !> Mass. [kg] (nn)
    real(wp), allocatable :: mass(:)
    !> Momentum. [kg m/s] (nvel, nn)
    real(wp), allocatable :: momentum(:, :)
    !> Force: internal and body forces, then contacts and boundaries. [N] (nvel, nn)
    real(wp), allocatable :: force(:, :)
    !> Velocity, after the grid update that of the end of the step. [m/s] (nvel, nn)
    real(wp), allocatable :: velocity(:, :)
    !> Velocity increment of the step, dt f/m; until the grid update, accelerations of nodes of
    !! negligible mass that `force` leaves out. [m/s] (nvel, nn)
    real(wp), allocatable :: increment(:, :)
    !> What the velocities of the points receive; not allocated where that is `increment`. [m/s]
    !! (nvel, nn)
    real(wp), allocatable :: gain(:, :)
    !> Velocity of a second mapping in a step, from which strain rates are formed; not allocated
    !! unless there is one. [m/s] (nvel, nn)
    real(wp), allocatable :: remapped(:, :)
    !> Most bytes that the arrays may take; 0 for what the machine has.
    integer(lp) :: memory_limit = 0
  contains
    !> Set up the nodes of a body.
    procedure(init_i), deferred :: init
    !> Send the fields of a frame.
    procedure(write_fields_i), deferred :: write_fields
    !> Move the window; grow the arrays if they are too short.
    procedure :: place => nodes_place
    !> Bytes that the nodes hold.
    procedure :: memory => nodes_memory
  end type nodes_t

  abstract interface
    !> Set up the nodes of a body.
    subroutine init_i(self, kin, properties, error)
      import :: error_t, kinematics_t, nodes_t, properties_t
      implicit none
      !> The nodes.
      class(nodes_t), intent(inout) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Send the fields of a frame.
    subroutine write_fields_i(self, dt, writer)
      import :: field_writer_t, nodes_t, wp
      implicit none
      !> The nodes.
      class(nodes_t), intent(in) :: self
      !> Length of the last step; 0 before the first. [s]
      real(wp), intent(in) :: dt
      !> Receiver of nodal fields.
      class(field_writer_t), intent(inout) :: writer
    end subroutine write_fields_i
  end interface

contains

  !> Move the window; grow the arrays if they are too short.
  subroutine nodes_place(self, window, bytes_missing)
    !> The nodes.
    class(nodes_t), intent(inout) :: self
    !> The new window.
    type(window_t), intent(in) :: window
    !> 0, or the bytes that the window needs and may not have; the arrays stay then.
    integer(lp), intent(out), optional :: bytes_missing
    integer(lp) :: bytes
    integer :: capacity, status

    if (present(bytes_missing)) bytes_missing = 0
    capacity = 0
    if (allocated(self%mass)) capacity = size(self%mass)
    if (window%size() <= capacity .and. allocated(self%mass)) then
      self%window = window
      return
    end if
    bytes = window%size()*int(4*self%kin%nvel + 1, lp)*(storage_size(1.0_wp)/8)
    bytes = bytes + bytes/8
    if (present(bytes_missing)) then
      if (bytes > memory_left(self%memory_limit, 0_lp)) then
        bytes_missing = bytes
        return
      end if
    end if
    if (allocated(self%mass)) then
      deallocate (self%mass, self%momentum, self%force, self%velocity, self%increment)
    end if
    self%window = window
    capacity = window%size() + min(window%size()/8, huge(1) - window%size())
    associate (nvel => self%kin%nvel)
      allocate (self%mass(capacity), stat=status)
      if (status == 0) allocate (self%momentum(nvel, capacity), stat=status)
      if (status == 0) allocate (self%force(nvel, capacity), stat=status)
      if (status == 0) allocate (self%velocity(nvel, capacity), stat=status)
      if (status == 0) allocate (self%increment(nvel, capacity), stat=status)
    end associate
    if (status /= 0) then
      if (present(bytes_missing)) bytes_missing = bytes
      return
    end if
    call use_huge_pages(self%mass)
    call use_huge_pages(self%momentum)
    call use_huge_pages(self%force)
    call use_huge_pages(self%velocity)
    call use_huge_pages(self%increment)
    self%mass = 0.0_wp
    self%momentum = 0.0_wp
    self%force = 0.0_wp
    self%velocity = 0.0_wp
    self%increment = 0.0_wp
  end subroutine nodes_place

  !> Bytes that the nodes hold.
  pure function nodes_memory(self) result(bytes)
    !> The nodes.
    class(nodes_t), intent(in) :: self
    !> Bytes.
    integer(lp) :: bytes
    integer(lp) :: reals

    bytes = 0
    if (.not. allocated(self%mass)) return
    reals = size(self%mass, kind=lp) + size(self%momentum, kind=lp) + size(self%force, kind=lp) &
            + size(self%velocity, kind=lp) + size(self%increment, kind=lp)
    if (allocated(self%gain)) reals = reals + size(self%gain, kind=lp)
    if (allocated(self%remapped)) reals = reals + size(self%remapped, kind=lp)
    bytes = reals*(storage_size(1.0_wp)/8)
  end function nodes_memory

end module mpm_nodes
