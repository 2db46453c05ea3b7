!> Another body from which a law takes a part of the state of its points.
module mpm_partner
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: partner_t

  !> The other body: named in the properties of the material, found when all bodies exist.
  type :: partner_t
    !> Position in the model's list of bodies; 0 until it is found, or when there is none.
    integer :: position = 0
    !> Property that holds its name; not allocated when there is no other body.
    character(:), allocatable :: name_key
    !> Property that holds its number.
    character(:), allocatable :: id_key
    !> Properties of the material.
    type(properties_t) :: properties
  contains
    !> Ask for the body that the properties name, if they name one.
    procedure :: ask => partner_ask
  end type partner_t

contains

  !> Ask for the body that the properties name, if they name one.
  subroutine partner_ask(self, properties, name_key, id_key)
    !> The partner.
    class(partner_t), intent(inout) :: self
    !> Properties of the material.
    type(properties_t), intent(in) :: properties
    !> Property that holds the name.
    character(*), intent(in) :: name_key
    !> Property that holds the number, if there is one.
    character(*), intent(in) :: id_key

    if (len(properties%string(name_key)) == 0) then
      if (.not. properties%given(id_key)) return
      if (properties%integer(id_key) < 0) return
    end if
    self%name_key = name_key
    self%id_key = id_key
    self%properties = properties
  end subroutine partner_ask

end module mpm_partner
