!> Frictional contact of bodies that go on beyond the faces of the grid.
module mpm_contact_huang_reflected_boundary
  use mpm_body, only: body_slot_t
  use mpm_contact_law, only: contact_law_t, law_friction
  use mpm_contact_pair, only: add_mirror_notes, add_pair_properties, contact_pair_t, &
                              normals_mirrored
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: contact_huang_reflected_boundary_t

  !> Friction with the normals of the first body, which has no surface at faces of the grid.
  type, extends(contact_pair_t) :: contact_huang_reflected_boundary_t
  contains
    procedure, nopass :: describe => contact_huang_reflected_boundary_describe
    procedure :: init => contact_huang_reflected_boundary_init
  end type contact_huang_reflected_boundary_t

contains

  !> Purpose and properties of the class.
  subroutine contact_huang_reflected_boundary_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'ContactHuang_ReflectedBoundary', &
                          'Two bodies that meet at a node and approach each other get one normal &
                          &velocity there, and Coulomb friction; the first one goes on beyond the &
                          &faces of the grid.', &
                          'Huang, Zhang, Ma and Huang, Int. J. Numer. Meth. Engng 85 (2011) &
                          &498-517; symmetry planes: elementary', &
                          'contact'//nl//'{'//nl// &
                          '    class = "ContactHuang_ReflectedBoundary"'//nl// &
                          '    name = "impact"'//nl//'    properties = {0.4}'//nl// &
                          '    str-properties = {"block_0", "block_1"}'//nl//'}')
    call description%add_real('mu', '-', 'coefficient of friction', lower=0.0_wp)
    call add_pair_properties(description)
    call add_mirror_notes(description)
    call description%add_note('It differs from ContactHuang with normals = 1 in taking the normal &
                              &of the first body alone: name the one whose surface is smooth.')
  end subroutine contact_huang_reflected_boundary_describe

  !> Find the bodies and set the constants.
  subroutine contact_huang_reflected_boundary_init(self, grid, bodies, properties, error)
    !> The contact.
    class(contact_huang_reflected_boundary_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error

    self%law = contact_law_t(law_friction, properties%real('mu'))
    self%normals = normals_mirrored
    call self%find_bodies(grid, bodies, properties, error)
  end subroutine contact_huang_reflected_boundary_init

end module mpm_contact_huang_reflected_boundary
