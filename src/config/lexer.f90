!> Words, quoted texts and marks of the config language.
!!
!! A word is any run of characters but white space, quotes, braces, `=`, `,` and `#`. A quoted text
!! ends on its line. `#` starts a comment that runs to the end of its line.
module mpm_lexer
  use mpm_errors, only: err_input, error_t, raise
  use mpm_strings, only: excerpt, to_text
  use mpm_text_file, only: has_byte_order_mark
  implicit none
  private
  public :: token_t, tokenize
  public :: token_close, token_comma, token_end, token_equals, token_open, token_string, token_word

  !> A word without quotes.
  integer, parameter :: token_word = 1
  !> A quoted text.
  integer, parameter :: token_string = 2
  !> The mark `=`.
  integer, parameter :: token_equals = 3
  !> The mark `,`.
  integer, parameter :: token_comma = 4
  !> The mark `{`.
  integer, parameter :: token_open = 5
  !> The mark `}`.
  integer, parameter :: token_close = 6
  !> The end of the text; always the last token.
  integer, parameter :: token_end = 7

  !> Tab, line feed, form feed, carriage return and blank.
  character(*), parameter :: white_space = achar(9)//achar(10)//achar(12)//achar(13)//' '
  !> What ends a word beside white space.
  character(*), parameter :: marks = '"''{}=,#'

  !> A piece of the text.
  type :: token_t
    !> What it is, one of the `token_*` constants.
    integer :: kind = token_end
    !> Position of its first character in the text; quotes are left out.
    integer :: first = 1
    !> Position of its last character in the text, `first - 1` when it is empty.
    integer :: last = 0
    !> Its line, from 1.
    integer :: line = 1
    !> Its first byte in that line, quotes included, from 1.
    integer :: column = 1
  end type token_t

contains

  !> Split a text into tokens, in time proportional to its length.
  pure subroutine tokenize(text, path, tokens, error)
    !> The text of a config.
    character(*), intent(in) :: text
    !> Its file, for messages.
    character(*), intent(in) :: path
    !> The tokens; the last one is `token_end`.
    type(token_t), allocatable, intent(out) :: tokens(:)
    !> `err_input`: control characters, an unclosed quote, letters beyond ASCII without quotes.
    type(error_t), allocatable, intent(out) :: error
    type(token_t) :: token
    integer :: position, line, line_start, n

    call check_plain_text(text, path, error)
    if (allocated(error)) return
    allocate (tokens(64))
    n = 0
    position = 1
    if (has_byte_order_mark(text)) position = 4
    line = 1
    line_start = position
    do
      call skip_blank(text, position, line, line_start)
      token%line = line
      token%column = position - line_start + 1
      call read_token(text, path, position, token, error)
      if (allocated(error)) return
      if (n == size(tokens)) call enlarge(tokens)
      n = n + 1
      tokens(n) = token
      if (token%kind == token_end) exit
    end do
    tokens = tokens(:n)
  end subroutine tokenize

  !> Go to the next character that is neither white space nor in a comment.
  pure subroutine skip_blank(text, position, line, line_start)
    !> The text.
    character(*), intent(in) :: text
    !> Position of the next character to look at.
    integer, intent(inout) :: position
    !> Its line.
    integer, intent(inout) :: line
    !> Position at which its line starts.
    integer, intent(inout) :: line_start
    logical :: in_comment
    character(1) :: c

    in_comment = .false.
    do while (position <= len(text))
      c = text(position:position)
      if (c == new_line(c)) then
        in_comment = .false.
        line = line + 1
        line_start = position + 1
      else if (c == '#') then
        in_comment = .true.
      else if (.not. in_comment .and. index(white_space, c) == 0) then
        return
      end if
      position = position + 1
    end do
  end subroutine skip_blank

  !> Read the token that starts at a position, and go behind it.
  pure subroutine read_token(text, path, position, token, error)
    !> The text.
    character(*), intent(in) :: text
    !> Its file, for messages.
    character(*), intent(in) :: path
    !> Position of the token's first character, then of the one behind it.
    integer, intent(inout) :: position
    !> The token; its line and column are set before.
    type(token_t), intent(inout) :: token
    !> `err_input`: an unclosed quote, or letters beyond ASCII without quotes.
    type(error_t), allocatable, intent(inout) :: error

    token%first = position
    token%last = position
    if (position > len(text)) then
      token%kind = token_end
      token%last = position - 1
      return
    end if
    select case (text(position:position))
    case ('=')
      token%kind = token_equals
    case (',')
      token%kind = token_comma
    case ('{')
      token%kind = token_open
    case ('}')
      token%kind = token_close
    case ('"', '''')
      call read_string(text, path, token, error)
      position = token%last + 2
      return
    case default
      call read_word(text, path, token, error)
    end select
    position = token%last + 1
  end subroutine read_token

  !> Read a quoted text; the quotes are no part of the token.
  pure subroutine read_string(text, path, token, error)
    !> The text.
    character(*), intent(in) :: text
    !> Its file, for messages.
    character(*), intent(in) :: path
    !> The token; `first` is at the opening quote when called.
    type(token_t), intent(inout) :: token
    !> `err_input` when the quote is not closed on its line.
    type(error_t), allocatable, intent(inout) :: error
    character(1) :: quote
    integer :: i, last

    token%kind = token_string
    quote = text(token%first:token%first)
    token%first = token%first + 1
    i = token%first
    do while (i <= len(text))
      if (text(i:i) == quote .or. text(i:i) == new_line(quote)) exit
      i = i + 1
    end do
    token%last = i - 1
    if (i <= len(text)) then
      if (text(i:i) == quote) return
    end if
    last = token%first - 2 + verify(text(token%first - 1:token%last), white_space, back=.true.)
    call raise(error, err_input, 'unclosed string: '//excerpt(text(token%first - 1:last)), &
               file=path, line=token%line, hint='close it on the same line with '//quote)
  end subroutine read_string

  !> Read a word.
  pure subroutine read_word(text, path, token, error)
    !> The text.
    character(*), intent(in) :: text
    !> Its file, for messages.
    character(*), intent(in) :: path
    !> The token; `first` is set when called.
    type(token_t), intent(inout) :: token
    !> `err_input` when the word has letters beyond ASCII.
    type(error_t), allocatable, intent(inout) :: error
    integer :: i
    logical :: is_ascii

    token%kind = token_word
    is_ascii = .true.
    do i = token%first, len(text)
      if (index(white_space//marks, text(i:i)) > 0) exit
      is_ascii = is_ascii .and. ichar(text(i:i)) < 128
    end do
    token%last = i - 1
    if (is_ascii) return
    call raise(error, err_input, 'unexpected characters: '// &
               excerpt(text(token%first:token%last)), file=path, line=token%line, &
               hint='put text with letters beyond ASCII in "straight quotes"')
  end subroutine read_word

  !> Refuse a text with control characters: it is no text file.
  pure subroutine check_plain_text(text, path, error)
    !> The text.
    character(*), intent(in) :: text
    !> Its file, for messages.
    character(*), intent(in) :: path
    !> `err_input` with the byte and its line.
    type(error_t), allocatable, intent(inout) :: error
    character(*), parameter :: hexadecimal = '0123456789ABCDEF'
    integer :: i, code, line

    line = 1
    do i = 1, len(text)
      code = ichar(text(i:i))
      if (code == 10) line = line + 1
      if (code >= 32 .and. code /= 127) cycle
      if (index(white_space, text(i:i)) > 0) cycle
      call raise(error, err_input, 'this is not a text file: control character 0x'// &
                 hexadecimal(code/16 + 1:code/16 + 1)// &
                 hexadecimal(mod(code, 16) + 1:mod(code, 16) + 1)//' at byte '//to_text(i), &
                 file=path, line=line, hint='a config is plain text in ASCII or UTF-8')
      return
    end do
  end subroutine check_plain_text

  !> Double the room for tokens.
  pure subroutine enlarge(tokens)
    !> The tokens so far, kept.
    type(token_t), allocatable, intent(inout) :: tokens(:)
    type(token_t), allocatable :: more(:)

    allocate (more(2*size(tokens)))
    more(:size(tokens)) = tokens
    call move_alloc(more, tokens)
  end subroutine enlarge

end module mpm_lexer
