!> Walls without slip on all faces of the grid.
module mpm_cartesian_box
  use mpm_boundary, only: boundary_t
  use mpm_box_faces, only: box_faces_t
  use mpm_description, only: description_t
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
  public :: cartesian_box_t

  !> No slip: every component of velocity is 0 on every face.
  type, extends(boundary_t) :: cartesian_box_t
    private
    !> The walls.
    type(box_faces_t) :: faces
  contains
    procedure, nopass :: describe => cartesian_box_describe
    procedure :: init => cartesian_box_init
    procedure :: apply => cartesian_box_apply
    procedure :: prescribe => cartesian_box_prescribe
    procedure :: write_fields => cartesian_box_write_fields
  end type cartesian_box_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_box_describe(description)
    !> The description.
    type(description_t), intent(out) :: description

    call description%init('boundary', 'CartesianBox', &
                          'No slip on every face of the grid: velocity, momentum and force of its &
                          &nodes are 0, the third component of TYPE 4 and 5 included.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          '    boundary-class = "CartesianBox"')
    call description%add_note('The faces are those of the grid, wherever its lower corner is; &
                              &mpm_3d takes coordinate 0 as the lower face.')
    call description%add_note('On a mesh the faces are those of the box around it: nodes on other &
                              &sides are free.')
    call description%add_note('TYPE 4: the axis r = 0 is a face like the others, so that the body &
                              &can''t move along it or turn on it; with CartesianSmoothBox or &
                              &CartesianBoxCustom it can.')
    call description%add_note('The field bc_nodal_mask is 1 for a component that is held; nodes &
                              &without memory show 0.')
  end subroutine cartesian_box_describe

  !> Take the faces from the grid.
  subroutine cartesian_box_init(self, grid, points, properties, error)
    !> The boundary.
    class(cartesian_box_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body; left as they are.
    class(points_t), intent(inout) :: points
    !> Checked properties: the class has none.
    type(properties_t), intent(in) :: properties
    !> A grid without a box.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => points, unused_properties => properties)
    end associate
    call self%faces%init(grid, 'CartesianBox', error, of_mesh=.true.)
  end subroutine cartesian_box_init

  !> Hold the nodes of all faces.
  subroutine cartesian_box_apply(self, grid, points, nodes, dt)
    !> The boundary.
    class(cartesian_box_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> Nodes of the body: momentum at the start of the step, all forces.
    class(nodes_t), intent(inout) :: nodes
    !> Time step. [s]
    real(wp), intent(in) :: dt
    integer :: face

    associate (unused => grid, unused_points => points, unused_dt => dt)
    end associate
    do face = 1, self%faces%n
      call self%faces%fix(face, 1, self%faces%kin%nvel, nodes)
    end do
  end subroutine cartesian_box_apply

  !> Nodes of all faces are at rest.
  subroutine cartesian_box_prescribe(self, window, still, velocity)
    !> The boundary.
    class(cartesian_box_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Take 0 for the velocity of walls that move: none does.
    logical, intent(in) :: still
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)
    integer :: face

    associate (unused => still)
    end associate
    do face = 1, self%faces%n
      call self%faces%set(face, 1, self%faces%kin%nvel, 0.0_wp, window, velocity)
    end do
  end subroutine cartesian_box_prescribe

  !> Send the components that are held.
  subroutine cartesian_box_write_fields(self, grid, nodes, writer)
    !> The boundary.
    class(cartesian_box_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Nodes of the body.
    class(nodes_t), intent(in) :: nodes
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: mask(:, :)
    integer :: face

    associate (unused => grid)
    end associate
    allocate (mask(self%faces%kin%nvel, nodes%window%size()), source=0.0_wp)
    do face = 1, self%faces%n
      call self%faces%mark(face, 1, self%faces%kin%nvel, nodes%window, mask)
    end do
    call writer%vector('bc_nodal_mask', mask, nodes%window)
  end subroutine cartesian_box_write_fields

end module mpm_cartesian_box
