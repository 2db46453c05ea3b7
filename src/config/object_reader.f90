!> Class and properties of one object of a config.
module mpm_object_reader
  use mpm_description, only: description_t
  use mpm_document, only: section_t, value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_properties, only: properties_t, resolve_properties, values_of_key
  use mpm_section_reader, only: check_keys, single_value
  implicit none
  private
  public :: class_of, lacks, properties_of

contains

  !> The class that a section names, after a check of its keys.
  subroutine class_of(section, file, key, known_keys, class, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> Key of the class.
    character(*), intent(in) :: key
    !> Keys that the section may have.
    character(*), intent(in) :: known_keys(:)
    !> The class name and its place.
    type(value_t), intent(out) :: class
    !> Unknown keys, or no class.
    type(error_t), allocatable, intent(out) :: error
    logical :: found

    call check_keys(section, file, known_keys, error)
    if (allocated(error)) return
    call single_value(section, file, key, class, found, error)
    if (allocated(error) .or. found) return
    call raise(error, err_input, 'section "'//section%name//'" needs "'//key//'"', file, &
               section%line, 'for example: '//key//' = "..."   (mpm3d --list)')
  end subroutine class_of

  !> The checked properties of an object.
  subroutine properties_of(section, prefix, stem, description, sim_type, class, properties, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> What stands in front of the stem of the keys: '' or `point-` ...
    character(*), intent(in) :: prefix
    !> Stem of the keys: `properties` or `props`.
    character(*), intent(in) :: stem
    !> The class.
    type(description_t), intent(in) :: description
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> The class name and its place.
    type(value_t), intent(in) :: class
    !> The checked properties.
    type(properties_t), intent(out) :: properties
    !> Missing, surplus or bad properties.
    type(error_t), allocatable, intent(out) :: error
    type(value_t), allocatable :: reals(:), integers(:), strings(:)

    call values_of_key(section, prefix//stem, reals)
    call values_of_key(section, prefix//'int-'//stem, integers)
    call values_of_key(section, prefix//'str-'//stem, strings)
    call resolve_properties(description, sim_type, reals, integers, strings, class%file, &
                            class%line, properties, error)
  end subroutine properties_of

  !> Whether there is an error; one without a place gets that of the class.
  function lacks(error, class) result(failed)
    !> The error, if any.
    type(error_t), allocatable, intent(inout) :: error
    !> The class, as the config gives it.
    type(value_t), intent(in) :: class
    !> Whether there is an error.
    logical :: failed

    failed = allocated(error)
    if (.not. failed) return
    if (len(error%file) > 0) return
    error%file = class%file
    error%line = class%line
  end function lacks

end module mpm_object_reader
