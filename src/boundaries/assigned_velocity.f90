!> Bodies that move as they are told.
module mpm_assigned_velocity
  use mpm_boundary, only: boundary_t
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_out_of_plane
  use mpm_nodes, only: nodes_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: assigned_velocity_t

  !> All nodes of the body have one velocity, whatever acts on them.
  type, extends(boundary_t) :: assigned_velocity_t
    private
    !> The velocity. [m/s]
    real(wp) :: velocity(3) = 0.0_wp
  contains
    procedure, nopass :: describe => assigned_velocity_describe
    procedure :: init => assigned_velocity_init
    procedure :: apply => assigned_velocity_apply
    procedure :: prescribe => assigned_velocity_prescribe
  end type assigned_velocity_t

contains

  !> Purpose and properties of the class.
  subroutine assigned_velocity_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    integer :: i

    call description%init('boundary', 'AssignedVelocity', &
                          'A body that moves with a constant velocity like a rigid one, whatever &
                          &acts on it: plates, tools and moving walls.', &
                          'elementary', &
                          '    boundary-class = "AssignedVelocity"'//new_line('a')// &
                          '    boundary-props = {0.5, 0.0}   # V_x, V_y')
    call description%add_real('V_x', 'm/s', 'velocity along x (TYPE 4: r)')
    call description%add_real('V_y', 'm/s', 'velocity along y (TYPE 4: z)', &
                              types=types_with_dim(2))
    call description%add_real('V_z', 'm/s', 'velocity along z', types=types_with_dim(3))
    call description%add_real('V_out', 'm/s', 'velocity out of the plane', default=0.0_wp, &
                              types=[(i == type_out_of_plane, i=1, 5)])
    call description%add_note('It takes the place of a boundary at all nodes of the body, not only &
                              &at faces of the grid: the body passes walls, and its points leave &
                              &the grid.')
    call description%add_note('The points start with this velocity, whatever their file says, and &
                              &keep it. Forces on the body are dropped after contacts have seen &
                              &them: the fields of a contact tell with which force it is pushed. &
                              &Work that moves it comes from outside, so that energy and momentum &
                              &of the whole change.')
    call description%add_note('ContactHuang shares the momentum of both bodies: give this one a &
                              &large density, by the masses of its points, or it pushes softly.')
    call description%add_note('TYPE 4: with V_x other than 0 the rings of the body widen, which is &
                              &no rigid motion; the body has no swirl.')
    call description%add_note('TYPE 5: V_out is not in mpm_3d, where it is 0.')
  end subroutine assigned_velocity_describe

  !> Take the velocity and give it to the points.
  subroutine assigned_velocity_init(self, grid, points, properties, error)
    !> The boundary.
    class(assigned_velocity_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body, which get the velocity.
    class(points_t), intent(inout) :: points
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error
    character(3), parameter :: names(3) = ['V_x', 'V_y', 'V_z']
    integer :: d

    self%velocity = 0.0_wp
    do d = 1, grid%kin%dim
      self%velocity(d) = properties%real(names(d))
    end do
    if (grid%kin%sim_type == type_out_of_plane) self%velocity(3) = properties%real('V_out')
    do d = 1, grid%kin%nvel
      points%velocity(d, :) = self%velocity(d)
    end do
  end subroutine assigned_velocity_init

  !> Move the nodes that the body reaches.
  subroutine assigned_velocity_apply(self, grid, points, nodes, dt)
    !> The boundary.
    class(assigned_velocity_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> Nodes of the body: momentum at the start of the step, all forces.
    class(nodes_t), intent(inout) :: nodes
    !> Time step. [s]
    real(wp), intent(in) :: dt
    integer :: i

    associate (unused => grid, unused_points => points, unused_dt => dt)
    end associate
    associate (v => self%velocity(:nodes%kin%nvel))
      do i = 1, nodes%window%size()
        if (.not. nodes%mass(i) > 0.0_wp) cycle
        nodes%velocity(:, i) = v
        nodes%momentum(:, i) = nodes%mass(i)*v
        nodes%force(:, i) = 0.0_wp
        nodes%increment(:, i) = 0.0_wp
      end do
    end associate
  end subroutine assigned_velocity_apply

  !> All nodes have the velocity.
  subroutine assigned_velocity_prescribe(self, window, still, velocity)
    !> The boundary.
    class(assigned_velocity_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Take 0 for it.
    logical, intent(in) :: still
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)
    integer :: i

    do i = 1, window%size()
      velocity(:, i) = 0.0_wp
      if (.not. still) velocity(:, i) = self%velocity(:size(velocity, 1))
    end do
  end subroutine assigned_velocity_prescribe

end module mpm_assigned_velocity
