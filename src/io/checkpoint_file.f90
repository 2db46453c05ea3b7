!> Checkpoint files: HDF5 with a seal, whole or absent.
module mpm_checkpoint_file
  use mpm_errors, only: err_input, error_t, raise
  use mpm_file_system, only: sync_file
  use mpm_files, only: delete_file, process_id, rename_file
  use mpm_hdf5_file, only: hdf5_file_t
  use mpm_sealed_file, only: check_seal, seal_file
  use mpm_strings, only: to_text
  implicit none
  private
  public :: checkpoint_file_t, can_checkpoint, read_run_text

  !> Whether this build has checkpoints.
  logical, parameter :: can_checkpoint = .true.
  !> Number of the format: what a checkpoint has and where.
  integer, parameter :: format = 1

  !> A checkpoint, open for writing or reading; `failure` has the first failure.
  type, extends(hdf5_file_t) :: checkpoint_file_t
    !> The name that it gets at the end.
    character(:), allocatable, private :: final
  contains
    !> Start a checkpoint.
    procedure :: begin => checkpoint_file_begin
    !> Finish it, and give it its name when all its data are on the disk.
    procedure :: commit => checkpoint_file_commit
    !> See that a checkpoint is whole, and open it.
    procedure :: read => checkpoint_file_read
  end type checkpoint_file_t

contains

  !> Start a checkpoint.
  subroutine checkpoint_file_begin(self, path)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> The name that it gets at the end.
    character(*), intent(in) :: path

    self%final = path
    call self%create(path//'.tmp'//to_text(process_id()), .true.)
  end subroutine checkpoint_file_begin

  !> Finish it, and give it its name when all its data are on the disk.
  subroutine checkpoint_file_commit(self, error)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> `err_io`; nothing is left of it then.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored

    call self%close()
    if (allocated(self%failure)) then
      call move_alloc(self%failure, error)
      error%file = self%final
    end if
    if (.not. allocated(error)) call seal_file(self%path, format, error)
    if (.not. allocated(error)) call sync_file(self%path, error)
    if (.not. allocated(error)) call rename_file(self%path, self%final, error)
    if (allocated(error)) then
      call delete_file(self%path, ignored)
    else
      ! The checkpoint is whole under its name; what may fail is to remember the name in a crash.
      call sync_file(self%final, ignored)
    end if
  end subroutine checkpoint_file_commit

  !> See that a checkpoint is whole, and open it.
  subroutine checkpoint_file_read(self, path, error)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Its path.
    character(*), intent(in) :: path
    !> It is missing, damaged, none or of a later format.
    type(error_t), allocatable, intent(out) :: error

    call check_seal(path, format, error)
    if (allocated(error)) return
    call self%open(path, .false.)
    if (allocated(self%failure)) allocate (error, source=self%failure)
  end subroutine checkpoint_file_read

  !> What a checkpoint or a VTKHDF file says of the run that it comes from.
  subroutine read_run_text(path, text, error)
    !> The file.
    character(*), intent(in) :: path
    !> The text.
    character(:), allocatable, intent(out) :: text
    !> It is missing, damaged, or says nothing.
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t), allocatable :: file
    logical :: found

    text = ''
    found = .false.
    allocate (file)
    call file%open(path, .false.)
    if (.not. allocated(file%failure)) then
      if (file%has('mpm3d')) call file%enter('mpm3d')
      found = file%has('run')
      if (found) call file%get('run', text)
    end if
    call file%close()
    if (allocated(file%failure)) then
      call move_alloc(file%failure, error)
    else if (.not. found) then
      call raise(error, err_input, 'the file does not say which run it comes from', file=path, &
                 hint='checkpoints and VTKHDF files of mpm3d do')
    end if
  end subroutine read_run_text

end module mpm_checkpoint_file
