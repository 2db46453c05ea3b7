!> Bodies that stick together.
module mpm_contact_linked
  use mpm_body, only: body_slot_t
  use mpm_contact_law, only: law_joint, law_slip_joint
  use mpm_contact_pair, only: add_pair_properties, contact_pair_t, normals_none
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t
  implicit none
  private
  public :: contact_linked_t

  !> One velocity for two bodies, or one normal velocity, as long as they share nodes.
  type, extends(contact_pair_t) :: contact_linked_t
  contains
    procedure, nopass :: describe => contact_linked_describe
    procedure :: init => contact_linked_init
    procedure :: write_fields => contact_linked_write_fields
  end type contact_linked_t

contains

  !> Purpose and properties of the class.
  subroutine contact_linked_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('contact', 'ContactLinked', &
                          'Two bodies that meet at a node stick together there: they get one &
                          &velocity, or with SLIP_BOUNDARY one normal velocity.', &
                          'the common velocity of Sulsky, Chen and Schreyer, CMAME 118 (1994) &
                          &179-196, for bodies that are mapped one by one', &
                          'contact'//nl//'{'//nl//'    class = "ContactLinked"'//nl// &
                          '    name = "glue"'//nl// &
                          '    str-properties = {"block_0", "block_1"}'//nl//'}')
    call add_pair_properties(description)
    call description%add_integer('normals', 'with SLIP_BOUNDARY: 1: average the normals of both &
                                 &bodies; 0: take that of the first, as mpm_3d does', default=1, &
                                 lower=0, upper=1)
    call description%add_string('flags', '"SLIP_BOUNDARY": bodies slide along each other without &
                                &friction, and neither part nor enter each other', is_list=.true.)
    call description%add_note('Nothing tears them apart: the link acts as long as both bodies &
                              &reach a common node, and begins up to one cell before their points &
                              &meet.')
    call description%add_note('SLIP_BOUNDARY: nodes where the normal has no direction are left &
                              &alone; in mpm_3d NaN spoils the forces there.')
    call description%add_note('With bodies by number the flag needs its name: flags = &
                              &"SLIP_BOUNDARY".')
    call description%add_note('The fields are 0 at nodes that only one body reaches, and that of &
                              &the normals everywhere without SLIP_BOUNDARY.')
  end subroutine contact_linked_describe

  !> Find the bodies and read the flags.
  subroutine contact_linked_init(self, grid, bodies, properties, error)
    !> The contact.
    class(contact_linked_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, one body twice, or an unknown flag.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    integer :: i

    self%law%kind = law_joint
    self%normals = normals_none
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      if (flags(i)%text /= 'SLIP_BOUNDARY') then
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               'the only one is SLIP_BOUNDARY')
        return
      end if
      self%law%kind = law_slip_joint
      self%normals = properties%integer('normals')
    end do
    call self%find_bodies(grid, bodies, properties, error)
  end subroutine contact_linked_init

  !> Send the fields of a frame.
  subroutine contact_linked_write_fields(self, bodies, writer)
    !> The contact.
    class(contact_linked_t), intent(in) :: self
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    character(:), allocatable :: name

    name = 'force_by_'//bodies(self%pair(2))%body%name//'_on_'//bodies(self%pair(1))%body%name
    call self%send('contact_'//name, self%force, writer)
    call self%send('contact_normal_for_'//name, self%normal, writer)
  end subroutine contact_linked_write_fields

end module mpm_contact_linked
