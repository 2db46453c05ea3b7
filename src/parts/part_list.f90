!> The parts of a generator text: together they say where points are.
module mpm_part_list
  use mpm_description, only: description_t
  use mpm_document, only: document_t, entry_t, raise_at, section_t, value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_part, only: part_slot_t
  use mpm_part_registry, only: create_part
  use mpm_properties, only: properties_t, resolve_properties, values_of_key
  use mpm_strings, only: excerpt, nearest_name, string_t
  implicit none
  private
  public :: part_list_t, suggestion

  !> The union of some parts.
  type :: part_list_t
    !> The parts in the order of the text.
    type(part_slot_t), allocatable :: slots(:)
  contains
    !> Make the parts from the sections of a text.
    procedure :: init => part_list_init
    !> The first part that a position is in.
    procedure :: find => part_list_find
  end type part_list_t

contains

  !> Make the parts from the sections `part { ... }` of a text, which has no others.
  subroutine part_list_init(self, kin, document, error)
    !> The list.
    class(part_list_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The text.
    type(document_t), intent(in) :: document
    !> No part, another section, or a part that is wrong.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    if (allocated(self%slots)) deallocate (self%slots)
    allocate (self%slots(size(document%sections)))
    do i = 1, size(document%sections)
      if (document%sections(i)%name /= 'part') then
        call raise(error, err_input, 'unknown section "'//excerpt(document%sections(i)%name)//'"', &
                   file=document%path, line=document%sections(i)%line, &
                   hint='a generator text has sections "part" only')
        return
      end if
      call make_part(kin, document%path, document%sections(i), self%slots(i), error)
      if (allocated(error)) return
    end do
    if (size(self%slots) > 0) return
    call raise(error, err_input, 'there is no part, and so no place for points', &
               file=document%path, hint='add a section such as   part { class = "Box" '// &
               'properties = {...} }   (mpm3d --list parts)')
  end subroutine part_list_init

  !> Make one part.
  subroutine make_part(kin, path, section, slot, error)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> File of the text.
    character(*), intent(in) :: path
    !> Its section.
    type(section_t), intent(in) :: section
    !> The part.
    type(part_slot_t), intent(inout) :: slot
    !> An unknown key, no class, an unknown class, or bad properties.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t), allocatable :: reals(:), integers(:), strings(:)
    type(value_t) :: class_name

    call check_keys(path, section, error)
    if (allocated(error)) return
    call find_class(path, section, class_name, error)
    if (allocated(error)) return
    call create_part(class_name%text, slot%part, error)
    if (allocated(error)) then
      error%file = class_name%file
      error%line = class_name%line
      return
    end if
    slot%line = section%line
    call values_of_key(section, 'properties', reals)
    call values_of_key(section, 'int-properties', integers)
    call values_of_key(section, 'str-properties', strings)
    call slot%part%describe(description)
    call resolve_properties(description, kin%sim_type, reals, integers, strings, path, &
                            class_name%line, properties, error)
    if (allocated(error)) return
    call slot%part%init(kin, properties, error)
  end subroutine make_part

  !> Refuse keys that a part does not have.
  subroutine check_keys(path, section, error)
    !> File of the text.
    character(*), intent(in) :: path
    !> Section of the part.
    type(section_t), intent(in) :: section
    !> The first unknown key.
    type(error_t), allocatable, intent(out) :: error
    character(14), parameter :: known(4) = [character(14) :: 'class', 'properties', &
                                            'int-properties', 'str-properties']
    integer :: i

    do i = 1, size(section%entries)
      if (any(known == section%entries(i)%key)) cycle
      call raise(error, err_input, 'unknown key "'//excerpt(section%entries(i)%key)// &
                 '" in a part', file=path, line=section%entries(i)%line, &
                 hint=suggestion(section%entries(i)%key, known))
      return
    end do
  end subroutine check_keys

  !> The class that a part names.
  subroutine find_class(path, section, class_name, error)
    !> File of the text.
    character(*), intent(in) :: path
    !> Section of the part.
    type(section_t), intent(in) :: section
    !> The name of its class.
    type(value_t), intent(out) :: class_name
    !> No class, or more than one.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    i = section%find('class')
    if (i == 0) then
      call raise(error, err_input, 'this part has no class', file=path, line=section%line, &
                 hint='add a line such as   class = "Box"   (mpm3d --list parts)')
      return
    end if
    associate (entry => section%entries(i))
      if (size(entry%values) /= 1) then
        call raise(error, err_input, 'a part has one class', file=path, line=entry%line, &
                   hint='write for example   class = "Box"   (mpm3d --list parts)')
        return
      end if
      class_name = entry%values(1)
    end associate
    if (len(class_name%name) == 0) return
    call raise_at(error, class_name, 'a class takes no name in front of it')
  end subroutine find_class

  !> A hint for an unknown key: the key that was meant, or all of them.
  pure function suggestion(key, known) result(hint)
    !> The key as it was written.
    character(*), intent(in) :: key
    !> The known keys.
    character(*), intent(in) :: known(:)
    !> One line.
    character(:), allocatable :: hint
    type(string_t) :: names(size(known))
    integer :: i

    do i = 1, size(known)
      names(i)%text = trim(known(i))
    end do
    hint = nearest_name(key, names)
    if (len(hint) > 0) then
      hint = 'did you mean "'//hint//'"?'
      return
    end if
    hint = 'known: '//names(1)%text
    do i = 2, size(known)
      hint = hint//', '//names(i)%text
    end do
  end function suggestion

  !> The first part that a position is in.
  pure function part_list_find(self, x) result(position)
    !> The list.
    class(part_list_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Index into `slots`, or 0.
    integer :: position

    do position = 1, size(self%slots)
      if (self%slots(position)%part%contains(x)) return
    end do
    position = 0
  end function part_list_find

end module mpm_part_list
