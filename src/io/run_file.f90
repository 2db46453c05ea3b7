!> Text files beside the output of a run that say how it came about.
!!
!! A file has one text for the whole run. A restart that changes anything adds its own text, behind
!! an empty line, below the number of the first frame that it holds for.
module mpm_run_file
  use mpm_checkpoint_file, only: read_run_text
  use mpm_errors, only: err_input, error_t, raise
  use mpm_file_system, only: delete_leftovers, file_size
  use mpm_files, only: directory_of, file_exists, is_directory, is_readable, join_path
  use mpm_kinds, only: lp
  use mpm_strings, only: to_text
  use mpm_text_file, only: read_whole_file
  use mpm_text_writer, only: text_writer_t
  implicit none
  private
  public :: describe_run, name_as_file, write_run_file

  !> End of the names of these files.
  character(*), parameter :: ending = '.run.txt'
  !> End of the names of histories.
  character(*), parameter :: history_ending = '.history.csv'
  !> Start of every text.
  character(*), parameter :: start = 'program:'
  !> Start of the line that tells the first frame of a text.
  character(*), parameter :: from = 'from:     frame '
  !> Start of a legacy VTK file, and of the titles of mpm3d.
  character(*), parameter :: vtk_start = '# vtk DataFile Version', title_start = 'mpm3d'
  !> Characters of a name at most.
  integer, parameter :: max_name = 160
  !> Bytes at the start of a file that has a title in them.
  integer, parameter :: head_size = 512
  !> End of a line.
  character(*), parameter :: nl = new_line('a')

contains

  !> The name of a run as a part of names of files.
  pure function name_as_file(name) result(text)
    !> Name of the run; may be empty.
    character(*), intent(in) :: name
    !> Not too long, `_` for slashes and control characters, `mpm3d` for none.
    character(:), allocatable :: text
    integer :: i

    text = trim(name(:min(len(name), max_name)))
    do i = 1, len(text)
      if (iachar(text(i:i)) < iachar(' ') .or. text(i:i) == '/') text(i:i) = '_'
    end do
    if (len(text) == 0) text = 'mpm3d'
  end function name_as_file

  !> Say how the output in a folder comes about.
  subroutine write_run_file(folder, name, text, goes_on, frame, error)
    !> The folder, which exists.
    character(*), intent(in) :: folder
    !> Name of the run, as a part of names of files.
    character(*), intent(in) :: name
    !> What there is to say.
    character(*), intent(in) :: text
    !> Whether the run goes on from a checkpoint: what is said of the frames before it stays.
    logical, intent(in) :: goes_on
    !> Number of the next frame.
    integer, intent(in) :: frame
    !> `err_io` when the file can't be written.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: unread
    type(text_writer_t) :: writer
    character(:), allocatable :: path, before, all
    integer :: last

    path = join_path(folder, name//ending)
    call delete_leftovers(folder, name//ending)
    all = text//nl
    if (goes_on) then
      call read_whole_file(path, before, unread)
      if (allocated(unread)) before = ''
      if (index(before, start) == 1) then
        last = end_of(before, frame - 1)
        if (holds_last(before(:last), text)) then
          all = before(:last)
        else
          all = before(:last)//nl//from//to_text(frame)//nl//text//nl
        end if
        if (all == before) return
      end if
    end if
    call writer%open(path, error)
    if (allocated(error)) return
    call writer%put_text(all)
    call writer%commit(error)
  end subroutine write_run_file

  !> Where the texts end that hold for frames up to one.
  pure function end_of(all, frame) result(last)
    !> All texts.
    character(*), intent(in) :: all
    !> The frame.
    integer, intent(in) :: frame
    !> Position of the end of a line; the first text always stays.
    integer :: last
    integer :: at, first, length

    last = len(all)
    at = 0
    do
      length = index(all(at + 1:), nl//nl//from)
      if (length == 0) return
      at = at + length
      call read_frame(all(at + 2 + len(from):), first)
      if (first <= frame) cycle
      last = at
      return
    end do
  end function end_of

  !> Whether the last of some texts is this one.
  pure function holds_last(texts, text) result(holds)
    !> The texts, the end of the last line with them.
    character(*), intent(in) :: texts
    !> The text.
    character(*), intent(in) :: text
    !> True when it is.
    logical :: holds
    integer :: at

    at = index(texts, nl//start, back=.true.)
    holds = texts(at + 1:) == text//nl
  end function holds_last

  !> A number of a frame at the start of a text.
  pure subroutine read_frame(text, frame)
    !> The text.
    character(*), intent(in) :: text
    !> The number; 0 where there is none.
    integer, intent(out) :: frame
    integer :: n, status

    n = verify(text//' ', '0123456789') - 1
    frame = 0
    status = 1
    if (n > 0 .and. n < 11) read (text(:n), *, iostat=status) frame
    if (status /= 0) frame = 0
  end subroutine read_frame

  !> What an output of a run says of its origin, or the run file beside it.
  subroutine describe_run(path, text, error)
    !> A checkpoint, VTKHDF file, legacy frame, history or run file.
    character(*), intent(in) :: path
    !> The text, without the end of the last line.
    character(:), allocatable, intent(out) :: text
    !> It is missing, damaged, or says nothing.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: head
    integer :: frame, slash
    logical :: of_frame

    text = ''
    call read_head(path, head)
    slash = index(path, '/', back=.true.)
    of_frame = index(head, vtk_start) == 1
    if (of_frame) then
      call beside_frame(path, head, text, frame, error)
    else if (ends(path, history_ending)) then
      text = path(slash + 1:len(path) - len(history_ending))
    else if (ends(path, ending)) then
      text = path(slash + 1:len(path) - len(ending))
    else
      call read_run_text(path, text, error)
      return
    end if
    if (allocated(error)) return
    call read_run_file(path, text, error)
    if (.not. allocated(error) .and. of_frame) call keep_one(text, frame)
  end subroutine describe_run

  !> The start of a file; empty where there is none to read.
  subroutine read_head(path, head)
    !> The file.
    character(*), intent(in) :: path
    !> Its first bytes.
    character(:), allocatable, intent(out) :: head
    integer :: unit, status

    head = ''
    if (is_directory(path)) return
    if (.not. is_readable(path)) return
    head = repeat(' ', int(min(max(0_lp, file_size(path)), int(head_size, lp))))
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status == 0) then
      read (unit, iostat=status) head
      close (unit)
    end if
    if (status /= 0) head = ''
  end subroutine read_head

  !> Whether a path ends so.
  pure function ends(path, with)
    !> The path.
    character(*), intent(in) :: path
    !> The end.
    character(*), intent(in) :: with
    !> True when it does.
    logical :: ends

    ends = len(path) > len(with)
    if (ends) ends = path(len(path) - len(with) + 1:) == with
  end function ends

  !> Name of the run and number of the frame, from the title of a legacy VTK file.
  subroutine beside_frame(path, head, name, frame, error)
    !> The file.
    character(*), intent(in) :: path
    !> Its first bytes.
    character(*), intent(in) :: head
    !> Name of the run, as a part of names of files.
    character(:), allocatable, intent(out) :: name
    !> Number of the frame.
    integer, intent(out) :: frame
    !> It is no frame of mpm3d.
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: number = ': Frame '
    character(:), allocatable :: title
    integer :: at

    frame = 0
    name = ''
    title = head(index(head, nl) + 1:)
    title = title(:index(title//nl, nl) - 1)
    at = index(title, number, back=.true.)
    if (at == 0 .or. index(title, title_start) /= 1) then
      call raise(error, err_input, 'the file is no frame of mpm3d', file=path, hint='its second &
                 &line does not tell the run and the frame')
      return
    end if
    call read_frame(title(at + len(number):), frame)
    name = name_as_file(title(min(at, len(title_start) + 2):at - 1))
  end subroutine beside_frame

  !> Read the run file beside another file.
  subroutine read_run_file(path, text, error)
    !> The other file.
    character(*), intent(in) :: path
    !> Name of the run; then what its file says, without the end of the last line.
    character(:), allocatable, intent(inout) :: text
    !> There is none, or it is no run file.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: beside

    beside = join_path(directory_of(path), text//ending)
    text = ''
    if (.not. file_exists(path)) then
      beside = path
    else if (.not. file_exists(beside)) then
      call raise(error, err_input, 'the file does not say which run it comes from', file=path, &
                 hint='there is no '//beside//', which comes with the output of a run')
      return
    end if
    call read_whole_file(beside, text, error)
    if (allocated(error)) return
    if (index(text, start) /= 1) then
      call raise(error, err_input, 'the file does not say which run it comes from', file=beside, &
                 hint='its first line does not tell the program')
      text = ''
      return
    end if
    text = text(:len(text) - merge(1, 0, text(len(text):) == nl))
  end subroutine read_run_file

  !> Of several texts keep the one that holds for a frame.
  pure subroutine keep_one(text, frame)
    !> The texts; then one of them.
    character(:), allocatable, intent(inout) :: text
    !> The frame.
    integer, intent(in) :: frame
    integer :: at

    text = text(:end_of(text, frame))
    at = index(text, nl//start, back=.true.)
    if (at > 0) text = text(at + 1:)
    if (text(len(text):) == nl) text = text(:len(text) - 1)
  end subroutine keep_one

end module mpm_run_file
