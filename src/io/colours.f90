!> Colours of messages, on terminals that show them.
module mpm_colours
  use mpm_files, only: is_terminal
  implicit none
  private
  public :: coloured, is_plain

  !> What starts and ends bold red and bold yellow text.
  character(*), parameter :: escape = achar(27)//'[', red = escape//'1;31m', &
                             yellow = escape//'1;33m', ordinary = escape//'0m'

contains

  !> A message with its kind in colour where that can be seen: the first `error:` or `warning:`.
  function coloured(message, descriptor) result(text)
    !> The message.
    character(*), intent(in) :: message
    !> Where it goes: 1 for the standard output, 2 for the standard error.
    integer, intent(in) :: descriptor
    !> The message, or the message with escape sequences.
    character(:), allocatable :: text

    text = message
    if (is_plain(descriptor)) return
    call paint(text, 'error:', red)
    call paint(text, 'warning:', yellow)
  end function coloured

  !> Give the first occurrence of a word a colour.
  pure subroutine paint(text, word, colour)
    !> The text.
    character(:), allocatable, intent(inout) :: text
    !> The word.
    character(*), intent(in) :: word
    !> What starts the colour.
    character(*), intent(in) :: colour
    integer :: first

    first = index(text, word)
    if (first == 0) return
    ! Hints and what stands in quotes are not painted.
    if (first > 1) then
      if (text(first - 1:first - 1) /= ' ') return
    end if
    text = text(:first - 1)//colour//word//ordinary//text(first + len(word):)
  end subroutine paint

  !> Whether text goes to where colours are not wanted: to a file or a pipe, to a terminal that
  !! can't show them, or when the variable NO_COLOR is set.
  function is_plain(descriptor) result(plain)
    !> 1 for the standard output, 2 for the standard error.
    integer, intent(in) :: descriptor
    !> Whether there are no colours.
    logical :: plain
    character(8) :: terminal
    integer :: length, status

    plain = .true.
    if (.not. is_terminal(descriptor)) return
    call get_environment_variable('NO_COLOR', length=length, status=status)
    if (status == 0 .and. length > 0) return
    call get_environment_variable('TERM', terminal, status=status)
    plain = status == 1 .or. terminal == 'dumb' .or. terminal == ''
  end function is_plain

end module mpm_colours
