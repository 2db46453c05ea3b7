!> Nodes without properties of their own.
module mpm_default_nodes
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_nodes, only: nodes_t
  use mpm_properties, only: properties_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: default_nodes_t

  !> Nodal mass, momentum, force, velocity and velocity increment.
  type, extends(nodes_t) :: default_nodes_t
  contains
    procedure, nopass :: describe => default_nodes_describe
    procedure :: init => default_nodes_init
    procedure :: write_fields => default_nodes_write_fields
  end type default_nodes_t

contains

  !> Purpose and properties of the class.
  subroutine default_nodes_describe(description)
    !> The description.
    type(description_t), intent(out) :: description

    call description%init('nodes', 'DefaultNodes', &
                          'The nodal fields of a body: mass, momentum, force, velocity and its &
                          &increment over the step.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          '    node-class = "DefaultNodes"')
    call description%add_note('Only nodes near the body have memory; frames show the whole grid, 0 &
                              &elsewhere.')
  end subroutine default_nodes_describe

  !> Set up the nodes of a body.
  subroutine default_nodes_init(self, kin, properties, error)
    !> The nodes.
    class(default_nodes_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties: the class has none.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error
    type(window_t) :: nothing

    associate (unused => properties)
    end associate
    self%kin = kin
    call self%place(nothing)
  end subroutine default_nodes_init

  !> Send the fields of a frame.
  subroutine default_nodes_write_fields(self, dt, writer)
    !> The nodes.
    class(default_nodes_t), intent(in) :: self
    !> Length of the last step; 0 before the first. [s]
    real(wp), intent(in) :: dt
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: active(:)
    integer :: nn

    nn = self%window%size()
    allocate (active(nn))
    active = 1.0_wp
    call writer%vector('displacement', dt*self%velocity(:, :nn), self%window)
    call writer%vector('velocity', self%velocity(:, :nn), self%window)
    call writer%vector('diff_velocity', self%increment(:, :nn), self%window)
    call writer%scalar('mass', self%mass(:nn), self%window)
    call writer%vector('momentum', self%momentum(:, :nn), self%window)
    call writer%vector('force', self%force(:, :nn), self%window)
    call writer%scalar('active', active, self%window)
  end subroutine default_nodes_write_fields

end module mpm_default_nodes
