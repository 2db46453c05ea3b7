!> A small complete config, written to the working directory section by section.
module mpm_config_fixture
  use mpm_configurator, only: configure
  use mpm_errors, only: err_input, err_usage, error_t
  use mpm_job, only: job_t
  use mpm_strings, only: string_t, to_text
  implicit none
  private
  public :: config, config_failure, config_path, configure_text, n_sections, points_path, &
            remove_config, section_text, write_config

  !> Number of sections.
  integer, parameter :: n_sections = 8
  character(*), parameter :: nl = new_line('a')

contains

  !> The config: a file of the program's own, since tests run side by side.
  function config_path() result(path)
    !> Its name.
    character(:), allocatable :: path
    integer :: length

    call get_command_argument(0, length=length)
    allocate (character(length) :: path)
    call get_command_argument(0, path)
    path = path(index(path, '/', back=.true.) + 1:)//'.tmp.cfg'
  end function config_path

  !> The points of both bodies: two, at (1.25, 0.25) and (1.75, 0.25).
  function points_path() result(path)
    !> Name of the file.
    character(:), allocatable :: path

    path = config_path()//'.points'
  end function points_path

  !> The whole config, with a text in place of another.
  function config(old, new) result(text)
    !> What to replace, once; nothing when left out.
    character(*), intent(in), optional :: old
    !> What to put there.
    character(*), intent(in), optional :: new
    !> The config.
    character(:), allocatable :: text
    integer :: i, at

    text = ''
    do i = 1, n_sections
      text = text//section_text(i)//nl
    end do
    if (.not. present(old)) return
    at = index(text, old)
    text = text(:at - 1)//new//text(at + len(old):)
  end function config

  !> Printed error of a config, empty when there is none; the path in front is left out.
  function config_failure(text, overrides) result(message)
    !> The config.
    character(*), intent(in) :: text
    !> Texts `section.key=value` parted by newlines.
    character(*), intent(in), optional :: overrides
    !> The error; `usage: ` stands in front when it is one of the command line.
    character(:), allocatable :: message
    type(job_t) :: job
    type(error_t), allocatable :: error

    if (present(overrides)) then
      call configure_text(text, overrides, job, error)
    else
      call configure_text(text, '', job, error)
    end if
    message = ''
    if (.not. allocated(error)) return
    message = error%text()
    if (index(message, config_path()//':') == 1) message = message(len(config_path()) + 2:)
    if (error%code == err_usage) message = 'usage: '//message
    if (error%code /= err_input .and. error%code /= err_usage) then
      message = 'code '//to_text(error%code)//': '//message
    end if
  end function config_failure

  !> Delete the files.
  subroutine remove_config()
    call remove_file(config_path())
    call remove_file(points_path())
  end subroutine remove_config

  !> Delete a file, if it is there.
  subroutine remove_file(path)
    !> The file.
    character(*), intent(in) :: path
    integer :: unit

    open (newunit=unit, file=path)
    close (unit, status='delete')
  end subroutine remove_file

  !> One section, with a line for each key.
  function section_text(number) result(text)
    !> 1: job, 2: serializer, 3: driver, 4: solver, 5: grid, 6: body a, 7: body b, 8: contact.
    integer, intent(in) :: number
    !> The section.
    character(:), allocatable :: text

    select case (number)
    case (1)
      text = 'job {'//nl//'t = 0.5'//nl//'dt = 1e-3'//nl//'TYPE = 2'//nl//'threads = 2'//nl//'}'
    case (2)
      text = 'serializer {'//nl//'class = "MinimalVTK"'//nl//'properties = {10}'//nl// &
             'str-properties = {"test_configurator.out", "save", "run"}'//nl//'}'
    case (3)
      text = 'driver {'//nl//'class = "DefaultDriver"'//nl//'properties = {2}'//nl//'}'
    case (4)
      text = 'solver {'//nl//'class = "ExplicitUSL"'//nl//'int-properties = {0, 1}'//nl//'}'
    case (5)
      text = 'grid {'//nl//'class = "CartesianLinear"'//nl//'properties = {4, 2}'//nl// &
             'int-properties = {8, 4}'//nl//'}'
    case (6)
      text = 'body {'//nl//'class = "DefaultBody"'//nl//'name = "a"'//nl//'point-file = "'// &
             points_path()//'"'//nl//'point-class = "DefaultPoints"'//nl// &
             'node-class = "DefaultNodes"'//nl//'material-class = "IsotropicLinearElasticity"'// &
             nl//'material-props = {E = 1e5, nu = 0.25}'//nl//'boundary-class = "CartesianBox"'// &
             nl//'}'
    case (7)
      text = 'body {'//nl//'class = "DefaultBody"'//nl//'name = "b"'//nl//'point-file = "'// &
             points_path()//'"'//nl//'point-class = "DefaultPoints"'//nl// &
             'node-class = "DefaultNodes"'//nl//'}'
    case default
      text = 'contact {'//nl//'class = "ContactHuang"'//nl//'name = "ab"'//nl// &
             'properties = {0.4}'//nl//'str-properties = {"a", "b"}'//nl//'}'
    end select
  end function section_text

  !> Write a file, byte for byte.
  subroutine write_text(path, text)
    !> The file.
    character(*), intent(in) :: path
    !> Its bytes.
    character(*), intent(in) :: text
    integer :: unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace')
    write (unit) text
    close (unit)
  end subroutine write_text

  !> Write a config of these sections and the points file.
  subroutine write_config(sections)
    !> Numbers of the sections in the order in which they are written.
    integer, intent(in) :: sections(:)
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(sections)
      text = text//section_text(sections(i))//nl
    end do
    call write_text(config_path(), text)
    call write_text(points_path(), '2'//nl//'1 0.25 1.25 0.25 0 0 1'//nl// &
                    '1 0.25 1.75 0.25 0 0 1'//nl)
  end subroutine write_config

  !> Configure a job from a text, and from overrides parted by newlines.
  subroutine configure_text(text, overrides, job, error)
    !> The config.
    character(*), intent(in) :: text
    !> Texts `section.key=value`; empty for none.
    character(*), intent(in) :: overrides
    !> The job.
    type(job_t), intent(out) :: job
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: list(:), longer(:)
    integer :: start, length

    call write_config([1])
    call write_text(config_path(), text)
    allocate (list(0))
    start = 1
    do while (start <= len(overrides))
      length = index(overrides(start:)//nl, nl) - 1
      allocate (longer(size(list) + 1))
      longer(:size(list)) = list
      longer(size(longer))%text = overrides(start:start + length - 1)
      call move_alloc(longer, list)
      start = start + length + 1
    end do
    call configure(config_path(), list, job, error)
  end subroutine configure_text

end module mpm_config_fixture
