!> Descriptions of classes as text for a terminal.
module mpm_describe_text
  use mpm_description, only: description_t, kind_integer, kind_real, kind_string, property_t
  use mpm_kinds, only: wp
  use mpm_original_classes, only: class_state, describe_original, is_new, missing, &
                                  original_class_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: describe_text, list_line, missing_lines

  !> Columns of the text.
  integer, parameter :: width = 92
  !> Columns of names in a list, and of all that stands in front of a purpose.
  integer, parameter :: name_width = 28, head_width = 45

contains

  !> One line of a list of classes.
  pure function list_line(description) result(text)
    !> The class.
    type(description_t), intent(in) :: description
    !> Its name, what became of the class of mpm_3d, and the first sentence of its purpose; below,
    !> what is better.
    character(:), allocatable :: text
    character(:), allocatable :: state, why
    integer :: last

    last = index(description%purpose, '. ')
    if (last == 0) last = len(description%purpose)
    call class_state(description%role, description%name, state, why)
    if (state == missing) then  ! a class that a user has added under this name
      state = is_new
      why = ''
    end if
    text = head_of_line(description%name, state)//description%purpose(:last)
    if (len(why) > 0) text = text//new_line('a')//repeat(' ', head_width)//state//': '//why
  end function list_line

  !> Lines for the classes of mpm_3d that are not available.
  pure function missing_lines(descriptions) result(text)
    !> The classes of one role that are here.
    type(description_t), intent(in) :: descriptions(:)
    !> A line each, with the reason; empty when all are here.
    character(:), allocatable :: text
    type(original_class_t), allocatable :: classes(:)
    integer :: i, j

    text = ''
    if (size(descriptions) == 0) return
    call describe_original(descriptions(1)%role, classes)
    do i = 1, size(classes)
      if (classes(i)%state /= missing) cycle
      if (any([(descriptions(j)%name == classes(i)%name, j=1, size(descriptions))])) cycle
      if (len(text) > 0) text = text//new_line('a')
      text = text//head_of_line(classes(i)%name, missing)//classes(i)%why
    end do
  end function missing_lines

  !> Name and state of a class, in columns.
  pure function head_of_line(name, state) result(text)
    !> Name of the class.
    character(*), intent(in) :: name
    !> Its state.
    character(*), intent(in) :: state
    !> What stands in front of its purpose.
    character(:), allocatable :: text

    text = '  '//name//repeat(' ', max(1, name_width - len(name)))//state
    text = text//repeat(' ', max(1, head_width - len(text)))
  end function head_of_line

  !> Purpose, properties, remarks, source and an example of a class.
  pure function describe_text(description) result(text)
    !> The class.
    type(description_t), intent(in) :: description
    !> Several lines.
    character(:), allocatable :: text
    character(*), parameter :: nl = new_line('a')
    integer :: i

    text = description%name//' ('//description%role//')'//nl//wrap(description%purpose, 2)
    text = text//kind_text(description, kind_real, 'reals (properties)')
    text = text//kind_text(description, kind_integer, 'integers (int-properties)')
    text = text//kind_text(description, kind_string, 'strings (str-properties)')
    do i = 1, size(description%notes)
      if (i == 1) text = text//nl//nl//'remarks'
      text = text//nl//wrap(description%notes(i)%text, 2)
    end do
    text = text//nl//nl//'source'//nl//wrap(description%source, 2)
    text = text//nl//nl//'example'//nl//description%example
  end function describe_text

  !> The properties of one list.
  pure function kind_text(description, kind, title) result(text)
    !> The class.
    type(description_t), intent(in) :: description
    !> The list.
    integer, intent(in) :: kind
    !> Its title.
    character(*), intent(in) :: title
    !> Several lines; empty when the class has none.
    character(:), allocatable :: text
    character(*), parameter :: nl = new_line('a')
    integer :: i

    text = ''
    do i = 1, size(description%properties)
      if (description%properties(i)%kind /= kind) cycle
      if (len(text) == 0) text = nl//nl//title
      text = text//nl//'  '//property_line(description%properties(i))// &
             nl//wrap(description%properties(i)%meaning, 6)
    end do
  end function kind_text

  !> Name, unit, default, bounds and TYPEs of a property.
  pure function property_line(property) result(text)
    !> The property.
    type(property_t), intent(in) :: property
    !> One line.
    character(:), allocatable :: text
    character(:), allocatable :: types
    real(wp) :: largest
    integer :: t

    text = property%name
    if (property%unit /= '-') text = text//' ['//property%unit//']'
    if (property%is_list) then
      text = text//', any number'
    else if (property%required) then
      text = text//', required'
    else if (property%kind == kind_integer .and. &
             real(property%default_integer, wp) < property%lower) then
      text = text//', optional'
    else if (property%kind == kind_real .and. property%default_real < property%lower) then
      text = text//', optional'
    else
      select case (property%kind)
      case (kind_real)
        text = text//', default '//to_text(property%default_real)
      case (kind_integer)
        text = text//', default '//to_text(property%default_integer)
      case default
        if (len(property%default_string) > 0) then
          text = text//', default "'//property%default_string//'"'
        else
          text = text//', optional'
        end if
      end select
    end if
    if (property%kind /= kind_string) then
      largest = merge(real(huge(1), wp), huge(1.0_wp), property%kind == kind_integer)
      if (property%lower > -largest) then
        text = text//trim(merge(', above   ', ', at least', property%above))//' '// &
               to_text(property%lower)
      end if
      if (property%upper < largest) then
        text = text//trim(merge(', below  ', ', at most', property%below))//' '// &
               to_text(property%upper)
      end if
    end if
    if (property%by_name) text = text//', by name'
    if (all(property%types)) return
    types = ''
    do t = 1, 5
      if (property%types(t)) types = types//' '//to_text(t)
    end do
    text = text//' (TYPE'//types//')'
  end function property_line

  !> Break a text into lines of limited width.
  pure function wrap(text, indent) result(lines)
    !> One paragraph.
    character(*), intent(in) :: text
    !> Blanks in front of each line.
    integer, intent(in) :: indent
    !> Lines parted by newlines.
    character(:), allocatable :: lines
    integer :: start, last

    lines = ''
    start = 1
    do while (start <= len(text))
      last = min(len(text), start + width - indent - 1)
      if (last < len(text)) then
        last = start - 1 + scan(text(start:last), ' ', back=.true.)
        if (last < start) last = min(len(text), start + width - indent - 1)
      end if
      if (len(lines) > 0) lines = lines//new_line('a')
      lines = lines//repeat(' ', indent)//trim(text(start:last))
      start = last + 1
    end do
  end function wrap

end module mpm_describe_text
