!> The config language: text to a tree of sections, entries and values.
!!
!!     document = { section | entry }
!!     section  = name "{" { entry } "}"
!!     entry    = key "=" ( list | values on the same line )
!!     list     = "{" [ item { "," item } [ "," ] ] "}"
!!     item     = value | name "=" value          (positional ones first)
!!
!! Line ends count in two places only: `=` stands on the line of its key, and values without braces
!! end with the line, or at the next `key =` on it.
module mpm_parser
  use mpm_document, only: document_t, entry_t, find_repeated, resize, section_t, value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_lexer, only: token_close, token_comma, token_end, token_equals, token_open, &
                       token_string, token_word
  use mpm_source, only: source_t
  use mpm_strings, only: excerpt, string_t, to_text
  use mpm_text_file, only: read_whole_file
  implicit none
  private
  public :: parse_file, parse_text

contains

  !> Parse a file.
  subroutine parse_file(path, document, error)
    !> The file.
    character(*), intent(in) :: path
    !> Its tree; not complete when there is an error.
    type(document_t), intent(out) :: document
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text

    call read_whole_file(path, text, error)
    if (allocated(error)) return
    call parse_text(text, path, document, error)
  end subroutine parse_file

  !> Parse a text.
  pure subroutine parse_text(text, path, document, error)
    !> The text.
    character(*), intent(in) :: text
    !> The file it comes from, for messages.
    character(*), intent(in) :: path
    !> Its tree; not complete when there is an error.
    type(document_t), intent(out) :: document
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(out) :: error
    type(source_t) :: source
    type(entry_t) :: entry
    type(section_t) :: section
    integer :: n_entries, n_sections

    document%path = path
    allocate (document%entries(0), document%sections(0))
    n_entries = 0
    n_sections = 0
    call source%open(text, path, error)
    if (allocated(error)) return
    do while (source%kind_ahead() /= token_end)
      if (source%at_key()) then
        call parse_entry(source, entry, error)
        if (allocated(error)) return
        if (n_entries == size(document%entries)) call resize(document%entries, 2*n_entries + 8)
        n_entries = n_entries + 1
        document%entries(n_entries) = entry
      else
        call parse_section(source, section, error)
        if (allocated(error)) return
        if (n_sections == size(document%sections)) call resize(document%sections, 2*n_sections + 8)
        n_sections = n_sections + 1
        document%sections(n_sections) = section
      end if
    end do
    call resize(document%entries, n_entries)
    call resize(document%sections, n_sections)
    call check_keys(source, document%entries, error)
  end subroutine parse_text

  !> Parse `name { entries }`.
  pure subroutine parse_section(source, section, error)
    !> The text; stands behind the section afterwards.
    type(source_t), intent(inout) :: source
    !> The section.
    type(section_t), intent(out) :: section
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error
    type(entry_t) :: entry
    integer :: n

    call parse_section_start(source, section, error)
    if (allocated(error)) return
    allocate (section%entries(0))
    n = 0
    do while (source%kind_ahead() /= token_close)
      if (.not. source%at_key()) then
        call explain_missing_key(source, section, error)
        return
      end if
      call parse_entry(source, entry, error)
      if (allocated(error)) return
      if (n == size(section%entries)) call resize(section%entries, 2*n + 8)
      n = n + 1
      section%entries(n) = entry
    end do
    source%next = source%next + 1
    call resize(section%entries, n)
    call check_keys(source, section%entries, error)
  end subroutine parse_section

  !> Parse `name {`, or say what is wrong with the text outside of sections.
  pure subroutine parse_section_start(source, section, error)
    !> The text; stands behind the brace afterwards.
    type(source_t), intent(inout) :: source
    !> The section; name and line are set.
    type(section_t), intent(inout) :: section
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error

    select case (source%kind_ahead())
    case (token_word)
      if (source%kind_ahead(1) == token_open) then
        section%name = source%text_ahead()
        section%line = source%line_ahead()
        call source%check_name('section', error)
        source%next = source%next + 2
      else if (source%line_ahead(1) == source%line_ahead()) then
        call source%fail('missing "=" or "{" behind "'//source%short()//'"', error, &
                         hint='entries are written as key = value, sections as name { ... }')
      else
        call source%fail('missing "{" behind the section name "'//source%short()//'"', error, &
                         hint='sections are written as name { ... }')
      end if
    case (token_open)
      call source%fail('"{" without a section name in front of it', error, &
                       hint='sections are written as name { ... }')
    case (token_close)
      call source%fail('"}" without a "{"', error, hint='no section or list is open here')
    case default
      call source%fail('unexpected '//source%quoted()//' outside of all sections', error, &
                       hint='sections are written as name { ... }')
    end select
  end subroutine parse_section_start

  !> Say what is wrong where a key or the end of a section should stand.
  pure subroutine explain_missing_key(source, section, error)
    !> The text.
    type(source_t), intent(in) :: source
    !> The open section.
    type(section_t), intent(in) :: section
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: opened

    opened = 'section "'//excerpt(section%name)//'", opened in line '//to_text(section%line)
    select case (source%kind_ahead())
    case (token_end)
      call raise(error, err_input, 'section "'//excerpt(section%name)//'" is never closed', &
                 file=source%path, line=section%line, hint='end it with }')
    case (token_word)
      if (source%kind_ahead(1) == token_open) then
        call source%fail('section "'//source%short()//'" starts within '//opened, error, &
                         hint='end the section in front of it with }')
      else
        call source%fail('missing "=" behind "'//source%short()//'"', error, &
                         hint='entries are written as key = value; '// &
                         'lists over several lines need braces')
      end if
    case default
      call source%fail('unexpected '//source%quoted()//' where a key should stand, in '//opened, &
                       error, hint='entries are written as key = value; '// &
                       'lists over several lines need braces')
    end select
  end subroutine explain_missing_key

  !> Parse `key = value` or `key = {...}`.
  pure subroutine parse_entry(source, entry, error)
    !> The text, at a key; stands behind the entry afterwards.
    type(source_t), intent(inout) :: source
    !> The entry.
    type(entry_t), intent(out) :: entry
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error

    entry%key = source%text_ahead()
    entry%line = source%line_ahead()
    call source%check_name('key', error)
    if (allocated(error)) return
    source%next = source%next + 2
    entry%braced = source%kind_ahead() == token_open
    if (entry%braced) then
      call parse_list(source, entry%values, error)
    else
      call parse_line_values(source, entry, error)
    end if
  end subroutine parse_entry

  !> Parse values without braces up to the end of the line or the next key on it.
  pure subroutine parse_line_values(source, entry, error)
    !> The text, behind `=`; stands behind the last value afterwards.
    type(source_t), intent(inout) :: source
    !> The entry; its values are set.
    type(entry_t), intent(inout) :: entry
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error
    type(value_t) :: value
    integer :: n

    allocate (entry%values(0))
    n = 0
    do while (source%line_ahead() == entry%line .and. .not. source%at_list_end())
      if (source%at_key()) then
        call source%fail('missing value behind "'//excerpt(entry%key)//' ="', error, &
                         hint='lists with named entries need braces: key = {name = value, ...}')
        if (n > 0) error%message = 'named entry "'//source%short()//'" in a list without braces'
        return
      end if
      call take_value(source, value, error)
      if (allocated(error)) return
      if (n == size(entry%values)) call resize(entry%values, 2*n + 8)
      n = n + 1
      entry%values(n) = value
      if (source%line_ahead() /= entry%line) exit
      if (source%kind_ahead() == token_comma) then
        source%next = source%next + 1
        call check_line_goes_on(source, entry%line, error)
      else if (source%at_key() .or. source%at_section() .or. source%at_list_end()) then
        exit
      else
        call explain_missing_comma(source, error)
      end if
      if (allocated(error)) return
    end do
    call resize(entry%values, n)
  end subroutine parse_line_values

  !> Refuse a list without braces that goes on behind a comma at the end of its line.
  pure subroutine check_line_goes_on(source, line, error)
    !> The text, behind a comma.
    type(source_t), intent(in) :: source
    !> Line of the list.
    integer, intent(in) :: line
    !> `err_input` when a value starts the next line.
    type(error_t), allocatable, intent(inout) :: error

    if (source%line_ahead() == line) return
    select case (source%kind_ahead())
    case (token_word)
      if (source%at_key() .or. source%kind_ahead(1) == token_open) return
    case (token_string, token_comma)
      continue
    case default
      return
    end select
    call source%fail('the list without braces in line '//to_text(line)//' goes on here', error, &
                     hint='lists over several lines need braces: key = { ... }')
  end subroutine check_line_goes_on

  !> Parse `{...}`.
  pure subroutine parse_list(source, values, error)
    !> The text, at the opening brace; stands behind the closing brace afterwards.
    type(source_t), intent(inout) :: source
    !> The values.
    type(value_t), allocatable, intent(out) :: values(:)
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error
    type(value_t) :: value
    integer :: n, opening

    allocate (values(0))
    n = 0
    opening = source%next
    source%next = opening + 1
    do while (source%kind_ahead() /= token_close)
      call parse_item(source, opening, value, error)
      if (allocated(error)) return
      if (n > 0 .and. value%name == '') then
        if (values(n)%name /= '') then
          source%next = source%next - 1
          call source%fail('value '//source%quoted()//' without a name behind the named entry "'// &
                           excerpt(values(n)%name)//'"', error, &
                           hint='entries with names come last in a list')
          return
        end if
      end if
      if (n == size(values)) call resize(values, 2*n + 8)
      n = n + 1
      values(n) = value
      call take_separator(source, opening, error)
      if (allocated(error)) return
    end do
    source%next = source%next + 1
    call resize(values, n)
    call check_value_names(source, values, error)
  end subroutine parse_list

  !> Parse `value` or `name = value` in a list.
  pure subroutine parse_item(source, opening, value, error)
    !> The text; stands behind the value afterwards.
    type(source_t), intent(inout) :: source
    !> Index of the token that opened the list.
    integer, intent(in) :: opening
    !> The value.
    type(value_t), intent(out) :: value
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: name

    name = ''
    if (source%kind_ahead() == token_word .and. source%kind_ahead(1) == token_equals) then
      name = source%text_ahead()
      call source%check_name('name', error)
      if (allocated(error)) return
      source%next = source%next + 2
      if (source%kind_ahead() == token_comma .or. source%kind_ahead() == token_close) then
        source%next = source%next - 1
        call source%fail('missing value behind "'//excerpt(name)//' ="', error)
        return
      end if
    end if
    select case (source%kind_ahead())
    case (token_word, token_string)
      call take_value(source, value, error)
      if (.not. allocated(error)) value%name = name
    case (token_comma)
      call source%fail('empty entry in the list '//opened_in(source, opening), error, &
                       hint='there is no value between two commas')
    case (token_open)
      call source%fail('"{" within the list '//opened_in(source, opening), error, &
                       hint='lists cannot be nested; is there a } missing in front of it?')
    case (token_equals)
      call source%fail('"=" without a name, in the list '//opened_in(source, opening), error, &
                       hint='named entries are written as name = value')
    case default
      call fail_unclosed(source, opening, error)
    end select
  end subroutine parse_item

  !> Where a list was opened, for a message.
  pure function opened_in(source, opening) result(text)
    !> The text.
    type(source_t), intent(in) :: source
    !> Index of the token that opened the list.
    integer, intent(in) :: opening
    !> `opened in line 12`.
    character(:), allocatable :: text

    text = 'opened in line '//to_text(source%tokens(opening)%line)
  end function opened_in

  !> Go over the comma behind a value in a list; the end of the list needs none.
  pure subroutine take_separator(source, opening, error)
    !> The text, behind a value; stands at the next value or the closing brace afterwards.
    type(source_t), intent(inout) :: source
    !> Index of the token that opened the list.
    integer, intent(in) :: opening
    !> `err_input` with the line at fault.
    type(error_t), allocatable, intent(inout) :: error

    select case (source%kind_ahead())
    case (token_close)
      return
    case (token_comma)
      source%next = source%next + 1
    case (token_end)
      call fail_unclosed(source, opening, error)
    case (token_word)
      if (source%kind_ahead(1) == token_equals .or. source%kind_ahead(1) == token_open) then
        call source%fail('missing "," or "}" in front of "'//source%short()//'"', error, &
                         hint='the list was '//opened_in(source, opening))
      else
        call explain_missing_comma(source, error)
      end if
    case default
      call explain_missing_comma(source, error)
    end select
  end subroutine take_separator

  !> Say that two values stand side by side, or what else follows a value.
  pure subroutine explain_missing_comma(source, error)
    !> The text, behind a value.
    type(source_t), intent(in) :: source
    !> The error.
    type(error_t), allocatable, intent(inout) :: error

    select case (source%kind_ahead())
    case (token_word, token_string)
      call source%fail('no comma between two values, in front of '//source%quoted(), error, &
                       hint='put text with blanks in quotes: "two words"')
    case default
      call source%fail('unexpected '//source%quoted()//' behind a value', error, &
                       hint='put text with such characters in quotes')
    end select
  end subroutine explain_missing_comma

  !> Take one word or quoted text as a value.
  pure subroutine take_value(source, value, error)
    !> The text, at the value; stands behind it afterwards.
    type(source_t), intent(inout) :: source
    !> The value, without a name.
    type(value_t), intent(out) :: value
    !> `err_input` when there is no value here.
    type(error_t), allocatable, intent(inout) :: error

    select case (source%kind_ahead())
    case (token_word, token_string)
      value%text = source%text_ahead()
      value%name = ''
      value%file = source%path
      value%line = source%line_ahead()
      value%column = source%tokens(source%next)%column
      value%quoted = source%kind_ahead() == token_string
      source%next = source%next + 1
    case (token_comma)
      call source%fail('empty entry in a list', error, hint='there is no value in front of ","')
    case default
      call source%fail('unexpected '//source%quoted()//' where a value should stand', error, &
                       hint='put text with such characters in quotes')
    end select
  end subroutine take_value

  !> Raise the error of a list without an end, at the line that opened it.
  pure subroutine fail_unclosed(source, opening, error)
    !> The text.
    type(source_t), intent(in) :: source
    !> Index of the token that opened the list.
    integer, intent(in) :: opening
    !> The error.
    type(error_t), allocatable, intent(inout) :: error

    call raise(error, err_input, 'this list is never closed', file=source%path, &
               line=source%tokens(opening)%line, hint='end it with }')
  end subroutine fail_unclosed

  !> Refuse a key that occurs twice.
  pure subroutine check_keys(source, entries, error)
    !> The text.
    type(source_t), intent(in) :: source
    !> Entries of one section.
    type(entry_t), intent(in) :: entries(:)
    !> `err_input` at the second one.
    type(error_t), allocatable, intent(inout) :: error
    type(string_t), allocatable :: names(:)
    integer :: i, first, second

    if (allocated(error)) return
    allocate (names(size(entries)))
    do i = 1, size(entries)
      names(i)%text = entries(i)%key
    end do
    call find_repeated(names, first, second)
    if (second == 0) return
    call raise(error, err_input, 'key "'//excerpt(entries(second)%key)//'" is given twice', &
               file=source%path, line=entries(second)%line, &
               hint='the first one is in line '//to_text(entries(first)%line))
  end subroutine check_keys

  !> Refuse a name that occurs twice in a list.
  pure subroutine check_value_names(source, values, error)
    !> The text.
    type(source_t), intent(in) :: source
    !> The values of one list.
    type(value_t), intent(in) :: values(:)
    !> `err_input` at the second one.
    type(error_t), allocatable, intent(inout) :: error
    type(string_t), allocatable :: names(:)
    integer :: i, first, second

    allocate (names(size(values)))
    do i = 1, size(values)
      names(i)%text = values(i)%name
    end do
    call find_repeated(names, first, second)
    if (second == 0) return
    call raise(error, err_input, 'named entry "'//excerpt(values(second)%name)// &
               '" is given twice', file=source%path, line=values(second)%line, &
               hint='the first one is in line '//to_text(values(first)%line))
  end subroutine check_value_names

end module mpm_parser
