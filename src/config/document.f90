!> A config as a tree: a document of sections, entries and values that know their place.
module mpm_document
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: lp, wp
  use mpm_number_parser, only: number_ok, number_too_large, parse_integer, parse_real, &
                               parse_special
  use mpm_strings, only: excerpt, string_t
  implicit none
  private
  public :: document_t, entry_t, section_t, value_t
  public :: find_repeated, raise_at, resize, value_to_integer, value_to_real

  !> One value: a word or a quoted text, perhaps named.
  type :: value_t
    !> The text, without its quotes.
    character(:), allocatable :: text
    !> Name of an entry `name = text` in a list; empty for a positional one.
    character(:), allocatable :: name
    !> The file, or the command line option, that holds the value.
    character(:), allocatable :: file
    !> Line in that file, from 1; 0 when the value comes from the command line.
    integer :: line = 0
    !> First byte in that line, from 1.
    integer :: column = 0
    !> Whether the text stands in quotes.
    logical :: quoted = .false.
  end type value_t

  !> `key = value`, or `key = {value, ...}`.
  type :: entry_t
    !> The name left of `=`.
    character(:), allocatable :: key
    !> The values in the order of the file; none for an empty list.
    type(value_t), allocatable :: values(:)
    !> The command line option that gives the entry; not allocated for one of the config.
    character(:), allocatable :: file
    !> Line of the key, from 1; 0 when it comes from the command line.
    integer :: line = 0
    !> Whether the values stand in braces.
    logical :: braced = .false.
  end type entry_t

  !> `name { entries }`.
  type :: section_t
    !> The name in front of the brace.
    character(:), allocatable :: name
    !> The entries in the order of the file; no key occurs twice.
    type(entry_t), allocatable :: entries(:)
    !> Line of the name, from 1.
    integer :: line = 0
  contains
    !> Index of the entry with a key, or 0.
    procedure :: find => section_find
  end type section_t

  !> A whole config.
  type :: document_t
    !> The file it was read from, for messages.
    character(:), allocatable :: path
    !> Entries outside of all sections; no key occurs twice.
    type(entry_t), allocatable :: entries(:)
    !> Sections in the order of the file; names may repeat.
    type(section_t), allocatable :: sections(:)
  contains
    !> Index of the entry with a key outside of all sections, or 0.
    procedure :: find => document_find
    !> Index of the next section of a name, or 0.
    procedure :: find_section => document_find_section
    !> Number of sections of a name.
    procedure :: count_sections => document_count_sections
    !> Whether there is neither a section nor an entry.
    procedure :: is_empty => document_is_empty
  end type document_t

  !> Change the size of a list; the elements that fit are kept.
  interface resize
    module procedure resize_values
    module procedure resize_entries
    module procedure resize_sections
  end interface resize

contains

  !> Index of the entry with a key, or 0.
  pure function section_find(self, key) result(index_found)
    !> The section.
    class(section_t), intent(in) :: self
    !> The key; upper and lower case differ.
    character(*), intent(in) :: key
    !> Index into `entries`, or 0.
    integer :: index_found

    index_found = find_key(self%entries, key)
  end function section_find

  !> Index of the entry with a key outside of all sections, or 0.
  pure function document_find(self, key) result(index_found)
    !> The document.
    class(document_t), intent(in) :: self
    !> The key; upper and lower case differ.
    character(*), intent(in) :: key
    !> Index into `entries`, or 0.
    integer :: index_found

    index_found = find_key(self%entries, key)
  end function document_find

  !> Index of the entry with a key, or 0.
  pure function find_key(entries, key) result(index_found)
    !> The entries.
    type(entry_t), intent(in) :: entries(:)
    !> The key.
    character(*), intent(in) :: key
    !> Index, or 0.
    integer :: index_found
    integer :: i

    index_found = 0
    do i = 1, size(entries)
      if (same_text(entries(i)%key, key)) then
        index_found = i
        return
      end if
    end do
  end function find_key

  !> Index of the next section of a name, or 0.
  pure function document_find_section(self, name, after) result(index_found)
    !> The document.
    class(document_t), intent(in) :: self
    !> The name; upper and lower case differ.
    character(*), intent(in) :: name
    !> Index of the section behind which to look; 0, the default, is the start.
    integer, intent(in), optional :: after
    !> Index into `sections`, or 0.
    integer :: index_found
    integer :: i, start

    start = 0
    if (present(after)) start = after
    index_found = 0
    do i = start + 1, size(self%sections)
      if (same_text(self%sections(i)%name, name)) then
        index_found = i
        return
      end if
    end do
  end function document_find_section

  !> Number of sections of a name.
  pure function document_count_sections(self, name) result(number)
    !> The document.
    class(document_t), intent(in) :: self
    !> The name; upper and lower case differ.
    character(*), intent(in) :: name
    !> How often it occurs.
    integer :: number
    integer :: i

    number = 0
    do i = 1, size(self%sections)
      if (same_text(self%sections(i)%name, name)) number = number + 1
    end do
  end function document_count_sections

  !> Whether there is neither a section nor an entry.
  pure function document_is_empty(self) result(is_empty)
    !> The document.
    class(document_t), intent(in) :: self
    !> True for a file with nothing but white space and comments.
    logical :: is_empty

    is_empty = size(self%entries) + size(self%sections) == 0
  end function document_is_empty

  !> Whether two texts are equal, trailing blanks included.
  pure function same_text(a, b) result(same)
    !> First text.
    character(*), intent(in) :: a
    !> Second text.
    character(*), intent(in) :: b
    !> True when equal.
    logical :: same

    same = .false.
    if (len(a) == len(b)) same = a == b
  end function same_text

  !> Change the size of a list of values.
  pure subroutine resize_values(values, n)
    !> The values; the first ones are kept.
    type(value_t), allocatable, intent(inout) :: values(:)
    !> The new size.
    integer, intent(in) :: n
    type(value_t), allocatable :: other(:)
    integer :: n_kept

    n_kept = min(n, size(values))
    allocate (other(n))
    ! LLVM 19 never ends the assignment of none.
    if (n_kept > 0) other(:n_kept) = values(:n_kept)
    call move_alloc(other, values)
  end subroutine resize_values

  !> Change the size of a list of entries.
  pure subroutine resize_entries(entries, n)
    !> The entries; the first ones are kept.
    type(entry_t), allocatable, intent(inout) :: entries(:)
    !> The new size.
    integer, intent(in) :: n
    type(entry_t), allocatable :: other(:)
    integer :: n_kept

    n_kept = min(n, size(entries))
    allocate (other(n))
    ! LLVM 19 never ends the assignment of none.
    if (n_kept > 0) other(:n_kept) = entries(:n_kept)
    call move_alloc(other, entries)
  end subroutine resize_entries

  !> Change the size of a list of sections.
  pure subroutine resize_sections(sections, n)
    !> The sections; the first ones are kept.
    type(section_t), allocatable, intent(inout) :: sections(:)
    !> The new size.
    integer, intent(in) :: n
    type(section_t), allocatable :: other(:)
    integer :: n_kept

    n_kept = min(n, size(sections))
    allocate (other(n))
    ! LLVM 19 never ends the assignment of none.
    if (n_kept > 0) other(:n_kept) = sections(:n_kept)
    call move_alloc(other, sections)
  end subroutine resize_sections

  !> Find a name that occurs twice, in time proportional to the number of names.
  pure subroutine find_repeated(names, first, second)
    !> The names; empty ones do not count.
    type(string_t), intent(in) :: names(:)
    !> Index of its first occurrence, or 0.
    integer, intent(out) :: first
    !> Index of its second occurrence, or 0.
    integer, intent(out) :: second
    integer, allocatable :: table(:)
    integer :: slot, i

    allocate (table(0:2*size(names)), source=0)
    do i = 1, size(names)
      if (len(names(i)%text) == 0) cycle
      slot = hash(names(i)%text, size(table))
      do while (table(slot) > 0)
        if (same_text(names(table(slot))%text, names(i)%text)) then
          first = table(slot)
          second = i
          return
        end if
        slot = mod(slot + 1, size(table))
      end do
      table(slot) = i
    end do
    first = 0
    second = 0
  end subroutine find_repeated

  !> A number for a text that is seldom the same for two texts.
  pure function hash(text, n) result(slot)
    !> The text.
    character(*), intent(in) :: text
    !> How many numbers there are.
    integer, intent(in) :: n
    !> The number, from 0 to n - 1.
    integer :: slot
    integer(lp) :: total
    integer :: i

    total = 0
    do i = 1, len(text)
      total = mod(131*total + ichar(text(i:i)), 2147483647_lp)
    end do
    slot = int(mod(total, int(n, lp)))
  end function hash

  !> Raise an input error at the place of a value.
  pure subroutine raise_at(error, value, message, hint)
    !> The error to fill.
    type(error_t), allocatable, intent(inout) :: error
    !> The value at fault.
    type(value_t), intent(in) :: value
    !> What is wrong.
    character(*), intent(in) :: message
    !> The way out.
    character(*), intent(in), optional :: hint

    call raise(error, err_input, message, file=value%file, line=value%line, hint=hint)
  end subroutine raise_at

  !> The real number that a value holds; its whole text must be a number.
  pure subroutine value_to_real(value, number, error)
    !> The value; quotes around a number do no harm, `nan` and `inf` are numbers.
    type(value_t), intent(in) :: value
    !> The number; 0 when there is an error.
    real(wp), intent(out) :: number
    !> `err_input` at the place of the value.
    type(error_t), allocatable, intent(out) :: error
    integer :: status
    logical :: is_special

    call parse_special(value%text, number, is_special)
    if (is_special) return
    call parse_real(value%text, 1_lp, len(value%text, lp), number, status)
    select case (status)
    case (number_ok)
      return
    case (number_too_large)
      call raise_at(error, value, '"'//excerpt(value%text)//'" is too large for a number', &
                    hint='the largest is about 1.79e308')
    case default
      if (len(value%text) == 0) then
        call raise_at(error, value, 'an empty text is not a number')
      else if (has_fortran_exponent(value%text)) then
        call raise_at(error, value, '"'//excerpt(value%text)//'" is not a number', &
                      hint='write the exponent with e, as in 1e5')
      else
        call raise_at(error, value, '"'//excerpt(value%text)//'" is not a number', &
                      hint='numbers are written as 2, -0.5 or 1.5e-3')
      end if
    end select
  end subroutine value_to_real

  !> The integer that a value holds; its whole text must be an integer.
  pure subroutine value_to_integer(value, number, error)
    !> The value; quotes around a number do no harm.
    type(value_t), intent(in) :: value
    !> The number; 0 when there is an error.
    integer, intent(out) :: number
    !> `err_input` at the place of the value.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: long
    real(wp) :: as_real
    integer :: status

    number = 0
    call parse_integer(value%text, 1_lp, len(value%text, lp), long, status)
    if (status == number_ok) then
      if (abs(long) <= huge(number)) then
        number = int(long)
        return
      end if
      status = number_too_large
    end if
    if (status == number_too_large) then
      call raise_at(error, value, '"'//excerpt(value%text)//'" is too large for an integer', &
                    hint='the largest is 2147483647')
      return
    end if
    call parse_real(value%text, 1_lp, len(value%text, lp), as_real, status)
    if (status == number_ok) then
      call raise_at(error, value, '"'//excerpt(value%text)//'" is not an integer', &
                    hint='write it with digits only, without a point or an exponent')
    else if (len(value%text) == 0) then
      call raise_at(error, value, 'an empty text is not an integer')
    else
      call raise_at(error, value, '"'//excerpt(value%text)//'" is not an integer', &
                    hint='integers are written as 2 or -10')
    end if
  end subroutine value_to_integer

  !> Whether a text is a number but for an exponent with the letter d.
  pure function has_fortran_exponent(text) result(found)
    !> The text.
    character(*), intent(in) :: text
    !> True for `1d5`.
    logical :: found
    character(len(text)) :: changed
    real(wp) :: number
    integer :: status, i

    changed = text
    i = scan(text, 'dD')
    if (i > 0) changed(i:i) = 'e'
    call parse_real(changed, 1_lp, len(changed, lp), number, status)
    found = status == number_ok
  end function has_fortran_exponent

end module mpm_document
