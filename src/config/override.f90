!> Changes of a config from the command line: `--set section.key=value`.
module mpm_override
  use mpm_document, only: document_t, value_t
  use mpm_errors, only: err_usage, error_t, raise
  use mpm_parser, only: parse_text
  use mpm_source, only: is_name
  use mpm_strings, only: excerpt
  implicit none
  private
  public :: parse_override

contains

  !> Parse `section.key=value` of the command line.
  !!
  !! The section is everything in front of the last dot left of the first `=`: `body.block_0` in
  !! `body.block_0.material-props={E = 1e5}`.
  pure subroutine parse_override(text, section_selector, key, values, error)
    !> The text behind `--set`.
    character(*), intent(in) :: text
    !> Which section is meant, not checked; not empty.
    character(:), allocatable, intent(out) :: section_selector
    !> The key.
    character(:), allocatable, intent(out) :: key
    !> The values, none for an empty list; their file is `--set` and the text, their line is 0.
    type(value_t), allocatable, intent(out) :: values(:)
    !> `err_usage`; its file is `--set` and the text.
    type(error_t), allocatable, intent(out) :: error
    type(document_t) :: document
    character(:), allocatable :: place
    integer :: equals, dot, i

    place = '--set '//excerpt(text, 80)
    section_selector = ''
    key = ''
    allocate (values(0))
    equals = index(text, '=')
    dot = index(text(:max(0, equals - 1)), '.', back=.true.)
    if (dot > 0) then
      section_selector = trim(adjustl(text(:dot - 1)))
      key = trim(adjustl(text(dot + 1:equals - 1)))
    end if
    if (len(section_selector) == 0 .or. .not. is_name(key)) then
      call raise(error, err_usage, 'this is not section.key=value', file=place, &
                 hint='for example --set job.dt=1e-4 or --set body.block_0.properties={1, 2}')
      return
    end if
    call parse_text(key//'='//text(equals + 1:), place, document, error)
    if (allocated(error)) then
      error%code = err_usage
      error%line = 0
    else if (size(document%entries) /= 1 .or. size(document%sections) > 0) then
      call raise(error, err_usage, 'unexpected text behind the value', file=place, &
                 hint='each --set changes one key')
    else
      call move_alloc(document%entries(1)%values, values)
      do i = 1, size(values)
        values(i)%line = 0
      end do
    end if
  end subroutine parse_override

end module mpm_override
