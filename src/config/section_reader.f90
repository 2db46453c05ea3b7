!> Typed access to the keys of one section of a config.
module mpm_section_reader
  use mpm_document, only: entry_t, section_t, value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_strings, only: excerpt, nearest_name, string_t
  implicit none
  private
  public :: check_keys, single_value

contains

  !> Every key of a section must be known.
  subroutine check_keys(section, file, known, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The keys that the section may have.
    character(*), intent(in) :: known(:)
    !> The first unknown key.
    type(error_t), allocatable, intent(out) :: error
    type(string_t) :: names(size(known))
    character(:), allocatable :: list, near
    integer :: i

    list = ''
    do i = 1, size(known)
      names(i)%text = trim(known(i))
      if (i > 1) list = list//', '
      list = list//names(i)%text
    end do
    do i = 1, size(section%entries)
      associate (entry => section%entries(i))
        if (any(known == entry%key)) cycle
        near = nearest_name(entry%key, names)
        if (len(near) > 0) then
          near = 'did you mean "'//near//'"?'
        else
          near = 'keys of this section: '//list
        end if
        call raise(error, err_input, 'unknown key "'//excerpt(entry%key)//'" in section "'// &
                   section%name//'"', file, entry%line, near)
        if (allocated(entry%file)) error%file = entry%file
        return
      end associate
    end do
  end subroutine check_keys

  !> The one value of a key.
  subroutine single_value(section, file, key, value, found, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The key.
    character(*), intent(in) :: key
    !> Its value; upon absence an empty text at the line of the section.
    type(value_t), intent(out) :: value
    !> Whether the section has the key.
    logical, intent(out) :: found
    !> No value or several.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    i = section%find(key)
    found = i > 0
    value%text = ''
    value%name = ''
    value%file = file
    value%line = section%line
    if (.not. found) return
    if (size(section%entries(i)%values) == 1) then
      value = section%entries(i)%values(1)
      if (len(value%text) > 0) return
    end if
    value%line = section%entries(i)%line
    if (allocated(section%entries(i)%file)) value%file = section%entries(i)%file
    call raise(error, err_input, '"'//key//'" takes one value', value%file, value%line, &
               'for example: '//key//' = value')
  end subroutine single_value

end module mpm_section_reader
