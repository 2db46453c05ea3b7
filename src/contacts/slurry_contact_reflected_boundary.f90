!> Contact of a solid at the faces of the grid with grains and the fluid in their pores.
module mpm_slurry_contact_reflected_boundary
  use mpm_body, only: body_slot_t
  use mpm_contact_normals, only: edges_mirror
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_properties, only: properties_t
  use mpm_slurry_contact, only: add_slurry_contact_properties, slurry_contact_t
  implicit none
  private
  public :: slurry_contact_reflected_boundary_t

  !> As `slurry_contact_t`, with a solid that goes on beyond the faces of the grid.
  type, extends(slurry_contact_t) :: slurry_contact_reflected_boundary_t
  contains
    procedure, nopass :: describe => reflected_describe
    procedure :: init => reflected_init
  end type slurry_contact_reflected_boundary_t

contains

  !> Purpose and properties of the class.
  subroutine reflected_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'SlurryContact_ReflectedBoundary', &
                          'As SlurryContact, with normals that lie in the faces of the grid, as if &
                          &the solid went on beyond them.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764', &
                          'contact'//nl//'{'//nl// &
                          '    class = "SlurryContact_ReflectedBoundary"'//nl// &
                          '    name = "impact"'//nl//'    properties = {0.4}'//nl// &
                          '    str-properties = {"block_0", "block_1", "projectile"}'//nl//'}')
    call add_slurry_contact_properties(description)
    call description%add_note('At nodes on a face of the grid the normal loses its component &
                              &across it. Nodes where nothing is left of it have no contact, as &
                              &in corners. Periodic faces are none; mpm_3d takes coordinates 0 and &
                              &the largest for faces, and in TYPE 5 drops the third component, &
                              &which is 0.')
  end subroutine reflected_describe

  !> Find the bodies and set the constants.
  subroutine reflected_init(self, grid, bodies, properties, error)
    !> The contact.
    class(slurry_contact_reflected_boundary_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or one body twice.
    type(error_t), allocatable, intent(out) :: error

    call self%slurry_contact_t%init(grid, bodies, properties, error)
    self%edges = edges_mirror
  end subroutine reflected_init

end module mpm_slurry_contact_reflected_boundary
