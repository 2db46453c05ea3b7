!> What a class says of itself: its purpose, and each of its properties as data.
!!
!! One declaration serves the validation of a config, `--list`, `--describe` and the class
!! reference of the manual, so that they can't drift apart.
module mpm_description
  use mpm_kinds, only: wp
  use mpm_strings, only: append_text, string_t
  implicit none
  private
  public :: description_t, property_t
  public :: types_with_dim, types_with_velocity
  public :: kind_integer, kind_real, kind_string

  !> A property of the list `properties`.
  integer, parameter :: kind_real = 1
  !> A property of the list `int-properties`.
  integer, parameter :: kind_integer = 2
  !> A property of the list `str-properties`.
  integer, parameter :: kind_string = 3

  !> One property of a class.
  type :: property_t
    !> Name, as used in named list entries.
    character(:), allocatable :: name
    !> Unit; '-' for a pure number.
    character(:), allocatable :: unit
    !> One line of meaning.
    character(:), allocatable :: meaning
    !> One of `kind_real`, `kind_integer`, `kind_string`.
    integer :: kind = kind_real
    !> Whether a config must give it.
    logical :: required = .true.
    !> Default of a real.
    real(wp) :: default_real = 0.0_wp
    !> Default of an integer.
    integer :: default_integer = 0
    !> Default of a string.
    character(:), allocatable :: default_string
    !> Smallest value.
    real(wp) :: lower = -huge(1.0_wp)
    !> Largest value.
    real(wp) :: upper = huge(1.0_wp)
    !> `lower` itself is not allowed.
    logical :: above = .false.
    !> `upper` itself is not allowed.
    logical :: below = .false.
    !> NaN and infinities are allowed.
    logical :: any_real = .false.
    !> The property takes all entries that are left, none included.
    logical :: is_list = .false.
    !> Entries by position do not count it; it is given by name only.
    logical :: by_name = .false.
    !> The simulation TYPEs in which the property exists.
    logical :: types(5) = .true.
  end type property_t

  !> A class as described by itself.
  type :: description_t
    !> Role: `material`, `grid`, ...
    character(:), allocatable :: role
    !> Class name in configs.
    character(:), allocatable :: name
    !> What it is for, one or two sentences.
    character(:), allocatable :: purpose
    !> Where its equations come from.
    character(:), allocatable :: source
    !> Remarks for users: what differs from mpm_3d, limits.
    type(string_t), allocatable :: notes(:)
    !> A snippet of a config.
    character(:), allocatable :: example
    !> The properties, each list in its order.
    type(property_t), allocatable :: properties(:)
  contains
    !> Start a description.
    procedure :: init => description_init
    !> Append a property of the list of reals.
    procedure :: add_real => description_add_real
    !> Append a property of the list of integers.
    procedure :: add_integer => description_add_integer
    !> Append a property of the list of strings.
    procedure :: add_string => description_add_string
    !> Append a remark.
    procedure :: add_note => description_add_note
  end type description_t

contains

  !> The TYPEs whose grid has at least `axis` dimensions.
  pure function types_with_dim(axis) result(types)
    !> Direction, 1 to 3.
    integer, intent(in) :: axis
    !> Mask over TYPE 1 to 5.
    logical :: types(5)

    types = [1, 2, 3, 2, 2] >= axis
  end function types_with_dim

  !> The TYPEs whose vectors have at least `component` components.
  pure function types_with_velocity(component) result(types)
    !> Component, 1 to 3.
    integer, intent(in) :: component
    !> Mask over TYPE 1 to 5.
    logical :: types(5)

    types = [1, 2, 3, 3, 3] >= component
  end function types_with_velocity

  !> Start a description.
  pure subroutine description_init(self, role, name, purpose, source, example)
    !> The description.
    class(description_t), intent(inout) :: self
    !> Role: `material`, `grid`, ...
    character(*), intent(in) :: role
    !> Class name in configs.
    character(*), intent(in) :: name
    !> What it is for.
    character(*), intent(in) :: purpose
    !> Where its equations come from.
    character(*), intent(in) :: source
    !> Snippet of a config that uses it; lines parted by `new_line`.
    character(*), intent(in) :: example

    self%role = role
    self%name = name
    self%purpose = purpose
    self%source = source
    self%example = example
    if (allocated(self%properties)) deallocate (self%properties)
    if (allocated(self%notes)) deallocate (self%notes)
    allocate (self%properties(0), self%notes(0))
  end subroutine description_init

  !> Append a property of the list of reals; without `default` it is required.
  pure subroutine description_add_real(self, name, unit, meaning, default, lower, upper, above, &
                                       below, any_real, is_list, types, by_name)
    !> The description.
    class(description_t), intent(inout) :: self
    !> Name in named entries.
    character(*), intent(in) :: name
    !> Unit.
    character(*), intent(in) :: unit
    !> One line of meaning.
    character(*), intent(in) :: meaning
    !> Default value.
    real(wp), intent(in), optional :: default
    !> Smallest allowed value.
    real(wp), intent(in), optional :: lower
    !> Largest allowed value.
    real(wp), intent(in), optional :: upper
    !> The value must be above this.
    real(wp), intent(in), optional :: above
    !> The value must be below this.
    real(wp), intent(in), optional :: below
    !> NaN and infinities are allowed.
    logical, intent(in), optional :: any_real
    !> Takes all entries that are left.
    logical, intent(in), optional :: is_list
    !> TYPEs in which it exists.
    logical, intent(in), optional :: types(5)
    !> It is given by name only.
    logical, intent(in), optional :: by_name
    type(property_t) :: item

    item%name = name
    item%unit = unit
    item%meaning = meaning
    item%kind = kind_real
    if (present(default)) then
      item%required = .false.
      item%default_real = default
    end if
    if (present(lower)) item%lower = lower
    if (present(upper)) item%upper = upper
    if (present(above)) then
      item%lower = above
      item%above = .true.
    end if
    if (present(below)) then
      item%upper = below
      item%below = .true.
    end if
    if (present(any_real)) item%any_real = any_real
    if (present(is_list)) then
      item%is_list = is_list
      item%required = .not. is_list
    end if
    if (present(types)) item%types = types
    if (present(by_name)) item%by_name = by_name
    call append(self%properties, item)
  end subroutine description_add_real

  !> Append a property of the list of integers; without `default` it is required.
  pure subroutine description_add_integer(self, name, meaning, default, lower, upper, is_list, &
                                          types, by_name)
    !> The description.
    class(description_t), intent(inout) :: self
    !> Name in named entries.
    character(*), intent(in) :: name
    !> One line of meaning.
    character(*), intent(in) :: meaning
    !> Default value.
    integer, intent(in), optional :: default
    !> Smallest allowed value.
    integer, intent(in), optional :: lower
    !> Largest allowed value.
    integer, intent(in), optional :: upper
    !> Takes all entries that are left.
    logical, intent(in), optional :: is_list
    !> TYPEs in which it exists.
    logical, intent(in), optional :: types(5)
    !> Has no place in the list: it is given by its name only.
    logical, intent(in), optional :: by_name
    type(property_t) :: item

    item%name = name
    item%unit = '-'
    item%meaning = meaning
    item%kind = kind_integer
    item%lower = -real(huge(1), wp)
    item%upper = real(huge(1), wp)
    if (present(default)) then
      item%required = .false.
      item%default_integer = default
    end if
    if (present(lower)) item%lower = real(lower, wp)
    if (present(upper)) item%upper = real(upper, wp)
    if (present(is_list)) then
      item%is_list = is_list
      item%required = .not. is_list
    end if
    if (present(types)) item%types = types
    if (present(by_name)) item%by_name = by_name
    call append(self%properties, item)
  end subroutine description_add_integer

  !> Append a property of the list of strings; without `default` it is required.
  pure subroutine description_add_string(self, name, meaning, default, is_list, types)
    !> The description.
    class(description_t), intent(inout) :: self
    !> Name in named entries.
    character(*), intent(in) :: name
    !> One line of meaning.
    character(*), intent(in) :: meaning
    !> Default value.
    character(*), intent(in), optional :: default
    !> Takes all entries that are left.
    logical, intent(in), optional :: is_list
    !> TYPEs in which it exists.
    logical, intent(in), optional :: types(5)
    type(property_t) :: item

    item%name = name
    item%unit = '-'
    item%meaning = meaning
    item%kind = kind_string
    if (present(default)) then
      item%required = .false.
      item%default_string = default
    end if
    if (present(is_list)) then
      item%is_list = is_list
      item%required = .not. is_list
      if (is_list) item%default_string = ''
    end if
    if (present(types)) item%types = types
    call append(self%properties, item)
  end subroutine description_add_string

  !> Append a remark for users.
  pure subroutine description_add_note(self, text)
    !> The description.
    class(description_t), intent(inout) :: self
    !> The remark.
    character(*), intent(in) :: text

    call append_text(self%notes, text)
  end subroutine description_add_note

  !> Append a property to a list.
  pure subroutine append(list, item)
    !> The list.
    type(property_t), allocatable, intent(inout) :: list(:)
    !> The new last property.
    type(property_t), intent(in) :: item
    type(property_t), allocatable :: longer(:)

    allocate (longer(size(list) + 1))
    longer(:size(list)) = list
    longer(size(longer)) = item
    call move_alloc(longer, list)
  end subroutine append

end module mpm_description
