!> Frictional contact between two bodies at shared nodes.
module mpm_contact_huang
  use mpm_body, only: body_slot_t
  use mpm_contact_law, only: contact_law_t, law_friction
  use mpm_contact_pair, only: add_pair_properties, contact_pair_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: contact_huang_t

  !> Non-penetration and Coulomb friction between two bodies.
  type, extends(contact_pair_t) :: contact_huang_t
  contains
    procedure, nopass :: describe => contact_huang_describe
    procedure :: init => contact_huang_init
  end type contact_huang_t

contains

  !> Purpose and properties of the class.
  subroutine contact_huang_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'ContactHuang', &
                          'Two bodies that meet at a node and approach each other get one normal &
                          &velocity there, and Coulomb friction.', &
                          'Huang, Zhang, Ma and Huang, Int. J. Numer. Meth. Engng 85 (2011) &
                          &498-517', &
                          'contact'//nl//'{'//nl//'    class = "ContactHuang"'//nl// &
                          '    name = "collision"'//nl//'    properties = {0.4}'//nl// &
                          '    str-properties = {"block_0", "block_1"}'//nl//'}')
    call description%add_real('mu', '-', 'coefficient of friction', lower=0.0_wp)
    call add_pair_properties(description)
    call description%add_integer('normals', '1: average the normals of both bodies; 0: take that &
                                 &of the first, as mpm_3d does', default=1, lower=0, upper=1)
    call description%add_note('The normals of two bodies at a node are not opposite to each other; &
                              &the unit normals are averaged. mpm_3d takes that of the first body &
                              &(normals = 0). Nodes where the normal has no direction are skipped.')
    call description%add_note('normals = 1: at nodes on faces of the grid normals lie in the face, &
                              &as if bodies went on beyond it. With normals = 0 they tilt there, &
                              &and bodies between side walls leak past each other.')
    call description%add_note('normals = 1 tilts at corners of a body on a flat one, which hold &
                              &it: there use normals = 0 and name the flat body first.')
    call description%add_note('Contact begins when both bodies reach the same node, up to one cell &
                              &before their points meet.')
    call description%add_note('The fields are 0 at nodes that only one body reaches.')
  end subroutine contact_huang_describe

  !> Find the bodies and set the constants.
  subroutine contact_huang_init(self, grid, bodies, properties, error)
    !> The contact.
    class(contact_huang_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error

    self%law = contact_law_t(law_friction, properties%real('mu'))
    self%normals = properties%integer('normals')
    call self%find_bodies(grid, bodies, properties, error)
  end subroutine contact_huang_init

end module mpm_contact_huang
