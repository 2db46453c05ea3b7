!> Frictional contact with a rigid body.
module mpm_contact_rigid_reflected_boundary
  use mpm_body, only: body_slot_t
  use mpm_contact_law, only: contact_law_t, law_rigid
  use mpm_contact_pair, only: add_mirror_notes, add_pair_properties, contact_pair_t, &
                              normals_mirrored
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: contact_rigid_reflected_boundary_t

  !> Friction at a body that does not feel it.
  type, extends(contact_pair_t) :: contact_rigid_reflected_boundary_t
  contains
    procedure, nopass :: describe => contact_rigid_reflected_boundary_describe
    procedure :: init => contact_rigid_reflected_boundary_init
  end type contact_rigid_reflected_boundary_t

contains

  !> Purpose and properties of the class.
  subroutine contact_rigid_reflected_boundary_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'ContactRigid_ReflectedBoundary', &
                          'A body that meets a rigid one takes its normal velocity, and feels &
                          &Coulomb friction; the rigid one goes on beyond the faces of the grid.', &
                          'Coulomb friction at a rigid body as in Bardenhagen, Brackbill and &
                          &Sulsky, CMAME 187 (2000) 529-541', &
                          'contact'//nl//'{'//nl// &
                          '    class = "ContactRigid_ReflectedBoundary"'//nl// &
                          '    name = "push"'//nl//'    properties = {0.4}'//nl// &
                          '    str-properties = {"block_0", "block_1"}'//nl//'}')
    call description%add_real('mu', '-', 'coefficient of friction', lower=0.0_wp)
    call add_pair_properties(description)
    call description%add_note('The first body is the rigid one. Its velocity is that of the start &
                              &of the step, whatever acts on it, so that the second one takes all &
                              &of the difference: use it for bodies with AssignedVelocity.')
    call description%add_note('The force that the second body feels acts on the first one with the &
                              &other sign; AssignedVelocity drops it. A first body that is free to &
                              &move gets too much of it, the more the heavier the second one is, &
                              &up to a run that blows up: use ContactHuang there.')
    call add_mirror_notes(description)
  end subroutine contact_rigid_reflected_boundary_describe

  !> Find the bodies and set the constants.
  subroutine contact_rigid_reflected_boundary_init(self, grid, bodies, properties, error)
    !> The contact.
    class(contact_rigid_reflected_boundary_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error

    self%law = contact_law_t(law_rigid, properties%real('mu'))
    self%normals = normals_mirrored
    call self%find_bodies(grid, bodies, properties, error)
  end subroutine contact_rigid_reflected_boundary_init

end module mpm_contact_rigid_reflected_boundary
