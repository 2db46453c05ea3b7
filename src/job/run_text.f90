!> How the results of a run came about, in words that its files keep.
module mpm_run_text
  use mpm_build_info, only: build_type, compiler, flags, revision, version
  use mpm_digest, only: digest_t
  use mpm_model, only: model_t
  use mpm_strings, only: counted, string_t, to_text
  implicit none
  private
  public :: run_text

contains

  !> Program, config and points of a run, a line each.
  function run_text(model, config, overrides) result(text)
    !> The model, started.
    type(model_t), intent(in) :: model
    !> Text of the config.
    character(*), intent(in) :: config
    !> What `--set` says.
    type(string_t), intent(in) :: overrides(:)
    !> The lines, without the end of the last one.
    character(:), allocatable :: text
    character(*), parameter :: nl = new_line('a')
    type(digest_t) :: digest
    integer :: i

    call digest%add_text(config)
    do i = 1, size(overrides)
      call digest%add_text(overrides(i)%text)
    end do
    text = 'program:  mpm3d '//version//nl//'revision: '//revision//nl// &
           'compiler: '//compiler//nl//'build:    '//build_type//' '//flags//nl// &
           'config:   digest '//digest%text()
    do i = 1, size(overrides)
      text = text//nl//'set:      '//one_line(overrides(i)%text)
    end do
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        text = text//nl//'points:   '//to_text(body%id)//' "'//body%name//'", '// &
               counted(body%points%n, 'point')
        if (allocated(body%points%digest)) text = text//', digest '//body%points%digest
      end associate
    end do
  end function run_text

  !> A text without ends of lines.
  pure function one_line(text) result(line)
    !> Any text.
    character(*), intent(in) :: text
    !> The same with blanks for control characters.
    character(len(text)) :: line
    integer :: i

    line = text
    do i = 1, len(line)
      if (iachar(line(i:i)) < iachar(' ')) line(i:i) = ' '
    end do
  end function one_line

end module mpm_run_text
