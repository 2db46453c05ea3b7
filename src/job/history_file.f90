!> A table of numbers that grows by whole rows, each of which is on the disk when it is written.
module mpm_history_file
  use mpm_errors, only: err_io, error_t, raise
  use mpm_file_system, only: file_size, truncate_file
  use mpm_files, only: file_exists, join_path, make_directories, reason_against
  use mpm_kinds, only: lp
  use mpm_store, only: store_t
  implicit none
  private
  public :: history_file_t

  !> A table with a line of names.
  type :: history_file_t
    !> Its path.
    character(:), allocatable :: path
    !> Rows so far.
    integer(lp) :: rows = 0
    !> Its folder.
    character(:), allocatable, private :: folder
    !> Bytes of all lines so far.
    integer(lp), private :: bytes = 0
  contains
    !> Say where it is.
    procedure :: place => history_file_place
    !> Start the table, or go on behind the rows that were saved.
    procedure :: open => history_file_open
    !> Write a row.
    procedure :: append => history_file_append
    !> Save how far it has come.
    procedure :: save => history_file_save
    !> Take that back.
    procedure :: restore => history_file_restore
    procedure, private :: has_header
    procedure, private :: write_line
  end type history_file_t

contains

  !> Say where it is.
  subroutine history_file_place(self, folder, name)
    !> The table.
    class(history_file_t), intent(inout) :: self
    !> Its folder.
    character(*), intent(in) :: folder
    !> Its name.
    character(*), intent(in) :: name

    self%folder = folder
    self%path = join_path(folder, name)
  end subroutine history_file_place

  !> Start the table, or go on behind the rows that were saved.
  !!
  !! Rows behind these are those of the run that was interrupted. Where the saved ones are gone, the
  !! table starts anew.
  subroutine history_file_open(self, header, error)
    !> The table.
    class(history_file_t), intent(inout) :: self
    !> Names of the columns.
    character(*), intent(in) :: header
    !> It can't be written.
    type(error_t), allocatable, intent(out) :: error
    integer :: unit, status
    logical :: goes_on

    call make_directories(self%folder, error)
    if (allocated(error)) return
    goes_on = self%rows > 0
    if (goes_on) goes_on = self%has_header(header)
    if (goes_on) then
      call truncate_file(self%path, self%bytes, error)
      return
    end if
    self%rows = 0
    self%bytes = 0
    open (newunit=unit, file=self%path, access='stream', form='unformatted', status='replace', &
          action='write', iostat=status)
    if (status == 0) close (unit, iostat=status)
    if (status /= 0) then
      call raise(error, err_io, 'the file cannot be written: '// &
                 reason_against(self%path, replaces_file=.true.), file=self%path)
      return
    end if
    call self%write_line(header, error)
  end subroutine history_file_open

  !> Whether the file has all rows that were saved, below these names.
  function has_header(self, header)
    !> The table.
    class(history_file_t), intent(in) :: self
    !> Names of the columns.
    character(*), intent(in) :: header
    !> Whether rows can be added to it.
    logical :: has_header
    character(len(header) + 1) :: first
    integer :: unit, status

    has_header = .false.
    if (.not. file_exists(self%path)) return
    if (file_size(self%path) < self%bytes) return
    open (newunit=unit, file=self%path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status /= 0) return
    read (unit, iostat=status) first
    if (status == 0) has_header = first == header//new_line('a')
    close (unit)
  end function has_header

  !> Write a row.
  subroutine history_file_append(self, row, error)
    !> The table.
    class(history_file_t), intent(inout) :: self
    !> The numbers, parted by commas.
    character(*), intent(in) :: row
    !> It can't be written; the rows before it are whole.
    type(error_t), allocatable, intent(out) :: error

    call self%write_line(row, error)
    if (.not. allocated(error)) self%rows = self%rows + 1
  end subroutine history_file_append

  !> Write a line behind all others, and see that it has arrived.
  subroutine write_line(self, line, error)
    !> The table.
    class(history_file_t), intent(inout) :: self
    !> The line.
    character(*), intent(in) :: line
    !> It can't be written; what there is of it is taken away.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    character(256) :: reason
    integer(lp) :: expected
    integer :: unit, status, closed

    reason = reason_against(self%path, replaces_file=.true.)
    expected = self%bytes + len(line, lp) + 1
    open (newunit=unit, file=self%path, access='stream', form='unformatted', status='old', &
          position='append', action='write', iostat=status)
    if (status == 0) then
      write (unit, iostat=status, iomsg=reason) line//new_line('a')
      close (unit, iostat=closed)
      if (status == 0) status = closed
    end if
    if (status == 0) then
      if (file_size(self%path) == expected) then
        self%bytes = expected
        return
      end if
    end if
    if (file_exists(self%path)) then
      if (status == 0) reason = 'the disk may be full, or something else writes to it'
      call truncate_file(self%path, self%bytes, ignored)
    end if
    call raise(error, err_io, 'writing failed: '//trim(reason), file=self%path)
  end subroutine write_line

  !> Save how far the table has come.
  subroutine history_file_save(self, store)
    !> The table.
    class(history_file_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call store%put('rows', self%rows)
    call store%put('bytes', self%bytes)
  end subroutine history_file_save

  !> Take back how far the table has come.
  subroutine history_file_restore(self, store)
    !> The table.
    class(history_file_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call store%get('rows', self%rows)
    call store%get('bytes', self%bytes)
  end subroutine history_file_restore

end module mpm_history_file
