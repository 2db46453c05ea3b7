!> The property lists of one object, checked against its class description.
module mpm_properties
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_description, only: description_t, kind_integer, kind_real, kind_string, property_t
  use mpm_document, only: document_t, section_t, value_t, value_to_integer, value_to_real
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_parser, only: parse_text
  use mpm_strings, only: append_text, excerpt, nearest_name, string_t, to_text
  implicit none
  private
  public :: make_properties, properties_t, resolve_properties, values_of_key

  !> A property with its value.
  type :: resolved_t
    !> Name in the description.
    character(:), allocatable :: name
    !> Value of a real.
    real(wp) :: real = 0.0_wp
    !> Value of an integer.
    integer :: integer = 0
    !> Value of a string.
    character(:), allocatable :: string
    !> Values of a list property of reals.
    real(wp), allocatable :: reals(:)
    !> Values of a list property of integers.
    integer, allocatable :: integers(:)
    !> Values of a list property of strings.
    type(string_t), allocatable :: strings(:)
    !> Whether the config gives it.
    logical :: given = .false.
    !> Where the config gives it, or where it should.
    character(:), allocatable :: file
    !> Line in `file`.
    integer :: line = 0
  end type resolved_t

  !> Checked properties of one object, found by name.
  type :: properties_t
    private
    !> The properties that exist in the job's TYPE.
    type(resolved_t), allocatable :: items(:)
  contains
    !> Value of a real property.
    procedure :: real => properties_real
    !> Value of an integer property.
    procedure :: integer => properties_integer
    !> Value of a string property.
    procedure :: string => properties_string
    !> Values of a list of reals.
    procedure :: reals => properties_reals
    !> Values of a list of integers.
    procedure :: integers => properties_integers
    !> Values of a list of strings.
    procedure :: strings => properties_strings
    !> Whether the config gives the property.
    procedure :: given => properties_given
    !> The config that gives the property.
    procedure :: file_of => properties_file_of
    !> Report a bad value at its place in the config.
    procedure :: reject => properties_reject
    !> Position of a property.
    procedure, private :: find => properties_find
  end type properties_t

contains

  !> Check the three lists of one object against its class description.
  subroutine resolve_properties(description, sim_type, reals, integers, strings, file, line, &
                                properties, error)
    !> The class.
    type(description_t), intent(in) :: description
    !> Simulation TYPE, 1 to 5.
    integer, intent(in) :: sim_type
    !> Entries of the list of reals.
    type(value_t), intent(in) :: reals(:)
    !> Entries of the list of integers.
    type(value_t), intent(in) :: integers(:)
    !> Entries of the list of strings.
    type(value_t), intent(in) :: strings(:)
    !> File of the object's section.
    character(*), intent(in) :: file
    !> Line of the object's class.
    integer, intent(in) :: line
    !> The checked properties.
    type(properties_t), intent(out) :: properties
    !> Missing, surplus, unknown, of the wrong kind or out of bounds.
    type(error_t), allocatable, intent(out) :: error
    integer :: i, n

    n = count([(description%properties(i)%types(sim_type), i=1, size(description%properties))])
    allocate (properties%items(n))
    n = 0
    do i = 1, size(description%properties)
      if (.not. description%properties(i)%types(sim_type)) cycle
      n = n + 1
      call set_default(description%properties(i), file, line, properties%items(n))
    end do
    call resolve_list(description, sim_type, kind_real, reals, properties, error)
    if (allocated(error)) return
    call resolve_list(description, sim_type, kind_integer, integers, properties, error)
    if (allocated(error)) return
    call resolve_list(description, sim_type, kind_string, strings, properties, error)
    if (allocated(error)) return
    call check_required(description, sim_type, properties, error)
  end subroutine resolve_properties

  !> Properties from text such as `properties = {1, 2}` newline `int-properties = {3}`.
  subroutine make_properties(description, sim_type, text, properties, error)
    !> The class.
    type(description_t), intent(in) :: description
    !> Simulation TYPE, 1 to 5.
    integer, intent(in) :: sim_type
    !> Any of the keys `properties`, `int-properties`, `str-properties`.
    character(*), intent(in) :: text
    !> The checked properties.
    type(properties_t), intent(out) :: properties
    !> As of `resolve_properties`, or a syntax error.
    type(error_t), allocatable, intent(out) :: error
    type(document_t) :: document
    type(value_t), allocatable :: reals(:), integers(:), strings(:)

    call parse_text('object {'//new_line('a')//text//new_line('a')//'}', 'text', document, error)
    if (allocated(error)) return
    call values_of_key(document%sections(1), 'properties', reals)
    call values_of_key(document%sections(1), 'int-properties', integers)
    call values_of_key(document%sections(1), 'str-properties', strings)
    call resolve_properties(description, sim_type, reals, integers, strings, 'text', 1, &
                            properties, error)
  end subroutine make_properties

  !> Values of a key of a section; none when the section does not have the key.
  subroutine values_of_key(section, key, values)
    !> The section.
    type(section_t), intent(in) :: section
    !> The key.
    character(*), intent(in) :: key
    !> Its values.
    type(value_t), allocatable, intent(out) :: values(:)
    integer :: i

    i = section%find(key)
    if (i > 0) then
      values = section%entries(i)%values
    else
      allocate (values(0))
    end if
  end subroutine values_of_key

  !> Start a property with its default.
  subroutine set_default(property, file, line, item)
    !> Its declaration.
    type(property_t), intent(in) :: property
    !> File of the object's section.
    character(*), intent(in) :: file
    !> Line of the object's class.
    integer, intent(in) :: line
    !> The property with its default value.
    type(resolved_t), intent(out) :: item

    item%name = property%name
    item%real = property%default_real
    item%integer = property%default_integer
    item%string = ''
    if (allocated(property%default_string)) item%string = property%default_string
    allocate (item%reals(0), item%integers(0), item%strings(0))
    item%file = file
    item%line = line
  end subroutine set_default

  !> Give the entries of one list to the properties of that kind.
  subroutine resolve_list(description, sim_type, kind, values, properties, error)
    !> The class.
    type(description_t), intent(in) :: description
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Kind of the list.
    integer, intent(in) :: kind
    !> Entries as written.
    type(value_t), intent(in) :: values(:)
    !> Properties to fill.
    type(properties_t), intent(inout) :: properties
    !> Unknown, surplus or bad entry.
    type(error_t), allocatable, intent(out) :: error
    integer, allocatable :: slots(:), declared(:), in_order(:)
    integer :: i, k, n

    allocate (slots(0), declared(0), in_order(0))
    n = 0
    do i = 1, size(description%properties)
      if (.not. description%properties(i)%types(sim_type)) cycle
      n = n + 1
      if (description%properties(i)%kind /= kind) cycle
      slots = [slots, n]
      declared = [declared, i]
      if (.not. description%properties(i)%by_name) in_order = [in_order, size(declared)]
    end do
    do i = 1, size(values)
      if (len(values(i)%name) > 0) then
        call find_named(description, declared, values(i), k, error)
      else
        call find_positional(description, declared(in_order), kind, i, size(values), values(i), k, &
                             error)
        if (allocated(error)) return
        k = in_order(k)
      end if
      if (allocated(error)) return
      call set_value(description%properties(declared(k)), values(i), properties%items(slots(k)), &
                     error)
      if (allocated(error)) return
    end do
  end subroutine resolve_list

  !> The property that a named entry means.
  subroutine find_named(description, declared, value, k, error)
    !> The class.
    type(description_t), intent(in) :: description
    !> Its properties of the list's kind that exist in the TYPE.
    integer, intent(in) :: declared(:)
    !> The entry.
    type(value_t), intent(in) :: value
    !> Index into `declared`.
    integer, intent(out) :: k
    !> No such property.
    type(error_t), allocatable, intent(out) :: error
    type(string_t) :: known(size(declared))
    character(:), allocatable :: names, near

    do k = 1, size(declared)
      if (description%properties(declared(k))%name == value%name) return
    end do
    names = ''
    do k = 1, size(declared)
      known(k)%text = description%properties(declared(k))%name
      names = names//merge(', ', '  ', k > 1)//known(k)%text
    end do
    near = nearest_name(value%name, known)
    if (len(near) > 0) then
      near = 'did you mean "'//near//'"?'
    else if (size(declared) > 0) then
      near = 'known in this list and TYPE: '//trim(adjustl(names))
    else
      near = 'the class takes no entries in this list'
    end if
    call raise(error, err_input, description%name//' has no property "'//excerpt(value%name)// &
               '" here', value%file, value%line, &
               near//'   (mpm3d --describe '//description%name//')')
  end subroutine find_named

  !> The property that the entry at a position means.
  subroutine find_positional(description, declared, kind, position, total, value, k, error)
    !> The class.
    type(description_t), intent(in) :: description
    !> Its properties of the list's kind that exist in the TYPE.
    integer, intent(in) :: declared(:)
    !> Kind of the list.
    integer, intent(in) :: kind
    !> Position of the entry, from 1.
    integer, intent(in) :: position
    !> Number of entries in the list.
    integer, intent(in) :: total
    !> The entry.
    type(value_t), intent(in) :: value
    !> Index into `declared`.
    integer, intent(out) :: k
    !> The list is too long.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: names

    k = position
    if (k <= size(declared)) return
    k = size(declared)
    if (k > 0) then
      if (description%properties(declared(k))%is_list) return
    end if
    names = ''
    do k = 1, size(declared)
      if (k > 1) names = names//', '
      names = names//description%properties(declared(k))%name
    end do
    if (size(declared) > 0) names = ': '//names
    call raise(error, err_input, 'surplus entry in the '//list_name(kind)//' of '// &
               description%name//': '//to_text(total)//' given, '//to_text(size(declared))// &
               ' expected in this TYPE'//names, value%file, value%line, &
               'remove it   (mpm3d --describe '//description%name//')')
  end subroutine find_positional

  !> Convert and check one entry.
  subroutine set_value(property, value, item, error)
    !> Declaration of the property.
    type(property_t), intent(in) :: property
    !> The entry.
    type(value_t), intent(in) :: value
    !> The property to set.
    type(resolved_t), intent(inout) :: item
    !> Wrong kind, out of bounds or given twice.
    type(error_t), allocatable, intent(out) :: error
    integer :: integer_value
    real(wp) :: real_value

    if (item%given .and. .not. property%is_list) then
      call raise(error, err_input, 'property "'//item%name//'" is given twice', value%file, &
                 value%line, 'keep either the positional or the named entry')
      return
    end if
    item%given = .true.
    item%file = value%file
    item%line = value%line
    select case (property%kind)
    case (kind_real)
      call value_to_real(value, real_value, error)
      if (allocated(error)) return
      if (.not. property%any_real .and. .not. ieee_is_finite(real_value)) then
        call raise(error, err_input, property%name//' must be a finite number, found '// &
                   excerpt(value%text), value%file, value%line, property%meaning)
        return
      end if
      if (ieee_is_finite(real_value)) call check_bounds(property, real_value, value, error)
      if (allocated(error)) return
      item%real = real_value
      item%reals = [item%reals, real_value]
    case (kind_integer)
      call value_to_integer(value, integer_value, error)
      if (allocated(error)) return
      call check_bounds(property, real(integer_value, wp), value, error)
      if (allocated(error)) return
      item%integer = integer_value
      item%integers = [item%integers, integer_value]
    case default
      item%string = value%text
      call append_text(item%strings, value%text)
    end select
  end subroutine set_value

  !> Compare a number with the bounds of its property.
  subroutine check_bounds(property, number, value, error)
    !> Declaration of the property.
    type(property_t), intent(in) :: property
    !> The number.
    real(wp), intent(in) :: number
    !> The entry, for its place.
    type(value_t), intent(in) :: value
    !> Out of bounds.
    type(error_t), allocatable, intent(out) :: error
    logical :: low, high

    low = number < property%lower .or. (property%above .and. number <= property%lower)
    high = number > property%upper .or. (property%below .and. number >= property%upper)
    if (.not. (low .or. high)) return
    call raise(error, err_input, property%name//' = '//excerpt(value%text)// &
               ' is out of bounds: '//bounds_text(property), value%file, value%line, &
               property%meaning)
  end subroutine check_bounds

  !> The bounds of a property in words.
  pure function bounds_text(property) result(text)
    !> Declaration of the property.
    type(property_t), intent(in) :: property
    !> For example `above 0, at most 1`.
    character(:), allocatable :: text
    real(wp) :: largest
    logical :: has_lower

    text = ''
    largest = merge(real(huge(1), wp), huge(1.0_wp), property%kind == kind_integer)
    has_lower = property%lower > -largest
    if (has_lower) then
      text = merge('above   ', 'at least', property%above)
      text = trim(text)//' '//to_text(property%lower)
    end if
    if (property%upper < largest) then
      if (has_lower) text = text//', '
      text = text//trim(merge('below  ', 'at most', property%below))//' '//to_text(property%upper)
    end if
  end function bounds_text

  !> Every required property must be given.
  subroutine check_required(description, sim_type, properties, error)
    !> The class.
    type(description_t), intent(in) :: description
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> The properties.
    type(properties_t), intent(in) :: properties
    !> The first that is missing.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: hint
    integer :: i, n

    n = 0
    do i = 1, size(description%properties)
      if (.not. description%properties(i)%types(sim_type)) cycle
      n = n + 1
      if (properties%items(n)%given .or. .not. description%properties(i)%required) cycle
      hint = description%properties(i)%name//': '//description%properties(i)%meaning
      if (description%properties(i)%unit /= '-') then
        hint = hint//' ['//description%properties(i)%unit//']'
      end if
      call raise(error, err_input, description%name//' needs "'//description%properties(i)%name// &
                 '" in its '//list_name(description%properties(i)%kind), &
                 properties%items(n)%file, properties%items(n)%line, &
                 hint//'   (mpm3d --describe '//description%name//')')
      return
    end do
  end subroutine check_required

  !> Name of a list in messages.
  pure function list_name(kind) result(name)
    !> Kind of the list.
    integer, intent(in) :: kind
    !> Its name.
    character(:), allocatable :: name

    select case (kind)
    case (kind_real)
      name = 'list of reals (properties)'
    case (kind_integer)
      name = 'list of integers (int-properties)'
    case default
      name = 'list of strings (str-properties)'
    end select
  end function list_name

  !> Position of a property; 0 when the class has none of that name in this TYPE.
  pure function properties_find(self, name) result(position)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> Position in `items`, or 0.
    integer :: position

    if (allocated(self%items)) then
      do position = 1, size(self%items)
        if (self%items(position)%name == name) return
      end do
    end if
    position = 0
  end function properties_find

  !> Value of a real property; 0 when the TYPE does not have it.
  pure function properties_real(self, name) result(value)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> Its value or default.
    real(wp) :: value
    integer :: i

    i = self%find(name)
    value = 0.0_wp
    if (i > 0) value = self%items(i)%real
  end function properties_real

  !> Value of an integer property; 0 when the TYPE does not have it.
  pure function properties_integer(self, name) result(value)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> Its value or default.
    integer :: value
    integer :: i

    i = self%find(name)
    value = 0
    if (i > 0) value = self%items(i)%integer
  end function properties_integer

  !> Value of a string property; '' when the TYPE does not have it.
  pure function properties_string(self, name) result(value)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> Its value or default.
    character(:), allocatable :: value
    integer :: i

    i = self%find(name)
    value = ''
    if (i > 0) value = self%items(i)%string
  end function properties_string

  !> Values of a list of reals.
  pure function properties_reals(self, name) result(values)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> All its values, none included.
    real(wp), allocatable :: values(:)
    integer :: i

    i = self%find(name)
    allocate (values(0))
    if (i > 0) values = self%items(i)%reals
  end function properties_reals

  !> Values of a list of integers.
  pure function properties_integers(self, name) result(values)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> All its values, none included.
    integer, allocatable :: values(:)
    integer :: i

    i = self%find(name)
    allocate (values(0))
    if (i > 0) values = self%items(i)%integers
  end function properties_integers

  !> Values of a list of strings.
  pure subroutine properties_strings(self, name, values)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> All its values, none included.
    type(string_t), allocatable, intent(out) :: values(:)
    integer :: i

    i = self%find(name)
    if (i > 0) then
      allocate (values, source=self%items(i)%strings)
    else
      allocate (values(0))
    end if
  end subroutine properties_strings

  !> Whether the config gives the property.
  pure function properties_given(self, name) result(given)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> Whether it is given.
    logical :: given
    integer :: i

    i = self%find(name)
    given = .false.
    if (i > 0) given = self%items(i)%given
  end function properties_given

  !> The config that gives a property, or that of its object.
  pure function properties_file_of(self, name) result(path)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name in the description.
    character(*), intent(in) :: name
    !> The path; empty when there is none.
    character(:), allocatable :: path
    integer :: i

    i = self%find(name)
    path = ''
    if (i > 0) path = self%items(i)%file
  end function properties_file_of

  !> Report a value that the class can't take, at its place in the config.
  pure subroutine properties_reject(self, name, message, error, hint)
    !> The properties.
    class(properties_t), intent(in) :: self
    !> Name of the bad property.
    character(*), intent(in) :: name
    !> What is wrong.
    character(*), intent(in) :: message
    !> The error to fill.
    type(error_t), allocatable, intent(inout) :: error
    !> The way out.
    character(*), intent(in), optional :: hint
    integer :: i

    i = self%find(name)
    if (i > 0) then
      call raise(error, err_input, message, self%items(i)%file, self%items(i)%line, hint)
    else
      call raise(error, err_input, message, hint=hint)
    end if
  end subroutine properties_reject

end module mpm_properties
