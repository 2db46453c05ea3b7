!> A config text on its way through the parser: its tokens, and which one is next.
module mpm_source
  use mpm_errors, only: err_input, error_t, raise
  use mpm_lexer, only: token_close, token_end, token_equals, token_open, token_t, &
                       token_word, tokenize
  use mpm_strings, only: excerpt
  implicit none
  private
  public :: is_name, source_t

  !> Characters of keys and names.
  character(*), parameter :: name_characters = &
    'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.'

  !> A text, its tokens and a position in them.
  type :: source_t
    !> The text.
    character(:), allocatable :: text
    !> Its file, for messages.
    character(:), allocatable :: path
    !> Its tokens; the last one is the end.
    type(token_t), allocatable :: tokens(:)
    !> Index of the token to look at next.
    integer :: next = 1
  contains
    !> Split a text into tokens and stand at the first one.
    procedure :: open => source_open
    !> Kind of the token to look at next, or of a later one.
    procedure :: kind_ahead
    !> Line of the token to look at next, or of a later one.
    procedure :: line_ahead
    !> Text of the token to look at next.
    procedure :: text_ahead
    !> The same, cut for a message.
    procedure :: short
    !> The same in quotes.
    procedure :: quoted
    !> Whether the next tokens start `key = ...`.
    procedure :: at_key
    !> Whether the next tokens start `section {`.
    procedure :: at_section
    !> Whether no value can follow.
    procedure :: at_list_end
    !> Raise an input error at the token to look at next.
    procedure :: fail
    !> Refuse the token to look at next as a key or name when it has other characters.
    procedure :: check_name
  end type source_t

contains

  !> Split a text into tokens and stand at the first one.
  pure subroutine source_open(self, text, path, error)
    !> The text, ready for parsing.
    class(source_t), intent(inout) :: self
    !> The text.
    character(*), intent(in) :: text
    !> Its file, for messages.
    character(*), intent(in) :: path
    !> What the lexer found.
    type(error_t), allocatable, intent(inout) :: error

    self%text = text
    self%path = path
    self%next = 1
    call tokenize(text, path, self%tokens, error)
  end subroutine source_open

  !> Kind of the token to look at next, or of a later one.
  pure function kind_ahead(self, offset) result(kind)
    !> The text.
    class(source_t), intent(in) :: self
    !> How many tokens to look past; default 0.
    integer, intent(in), optional :: offset
    !> One of the `token_*` constants; `token_end` behind the end.
    integer :: kind
    integer :: i

    i = self%next
    if (present(offset)) i = i + offset
    kind = self%tokens(min(i, size(self%tokens)))%kind
  end function kind_ahead

  !> Line of the token to look at next, or of a later one.
  pure function line_ahead(self, offset) result(line)
    !> The text.
    class(source_t), intent(in) :: self
    !> How many tokens to look past; default 0.
    integer, intent(in), optional :: offset
    !> The line, 0 for the end of the text.
    integer :: line
    integer :: i

    i = self%next
    if (present(offset)) i = i + offset
    line = 0
    if (i < size(self%tokens)) line = self%tokens(i)%line
  end function line_ahead

  !> Text of the token to look at next.
  pure function text_ahead(self) result(text)
    !> The text.
    class(source_t), intent(in) :: self
    !> The token without quotes.
    character(:), allocatable :: text

    associate (token => self%tokens(self%next))
      text = self%text(token%first:token%last)
    end associate
  end function text_ahead

  !> Whether the next tokens start `key = ...`.
  pure function at_key(self)
    !> The text.
    class(source_t), intent(in) :: self
    !> True for a word and `=` on one line.
    logical :: at_key

    at_key = self%kind_ahead() == token_word .and. self%kind_ahead(1) == token_equals &
             .and. self%line_ahead() == self%line_ahead(1)
  end function at_key

  !> Whether the next tokens start `section {`.
  pure function at_section(self)
    !> The text.
    class(source_t), intent(in) :: self
    !> True for a word and `{` on one line.
    logical :: at_section

    at_section = self%kind_ahead() == token_word .and. self%kind_ahead(1) == token_open &
                 .and. self%line_ahead() == self%line_ahead(1)
  end function at_section

  !> Whether values without braces end here: at a brace or the end of the text.
  pure function at_list_end(self)
    !> The text.
    class(source_t), intent(in) :: self
    !> True when no value can follow.
    logical :: at_list_end

    at_list_end = self%kind_ahead() == token_close .or. self%kind_ahead() == token_end
  end function at_list_end

  !> The token to look at next, cut for a message.
  pure function short(self) result(text)
    !> The text.
    class(source_t), intent(in) :: self
    !> The token or its start.
    character(:), allocatable :: text

    text = excerpt(self%text_ahead())
  end function short

  !> The token to look at next, cut and quoted for a message.
  pure function quoted(self) result(text)
    !> The text.
    class(source_t), intent(in) :: self
    !> The token or its start in quotes, or `end of the file`.
    character(:), allocatable :: text

    text = '"'//self%short()//'"'
    if (self%kind_ahead() == token_end) text = 'end of the file'
  end function quoted

  !> Raise an input error at the token to look at next.
  pure subroutine fail(self, message, error, hint)
    !> The text.
    class(source_t), intent(in) :: self
    !> What is wrong.
    character(*), intent(in) :: message
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    !> The way out.
    character(*), intent(in), optional :: hint

    call raise(error, err_input, message, file=self%path, hint=hint, &
               line=self%tokens(self%next)%line)
  end subroutine fail

  !> Whether a text can be a key or a name.
  pure function is_name(text)
    !> The text.
    character(*), intent(in) :: text
    !> True for one or more letters, digits, `-`, `_` and `.`.
    logical :: is_name

    is_name = len(text) > 0 .and. verify(text, name_characters) == 0
  end function is_name

  !> Refuse the token to look at next as a key or name when it has other characters.
  pure subroutine check_name(self, what, error)
    !> The text.
    class(source_t), intent(in) :: self
    !> What the token is, for the message.
    character(*), intent(in) :: what
    !> `err_input` with its line.
    type(error_t), allocatable, intent(inout) :: error

    if (is_name(self%text_ahead())) return
    call self%fail('unexpected characters in the '//what//' "'//self%short()//'"', error, &
                   hint='it may have letters, digits, "-", "_" and "."')
  end subroutine check_name

end module mpm_source
