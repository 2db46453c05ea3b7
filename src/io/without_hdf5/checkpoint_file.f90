!> Checkpoint files of a build without HDF5: there are none.
module mpm_checkpoint_file
  use mpm_errors, only: err_input, err_io, error_t, raise
  use mpm_kinds, only: lp, wp
  use mpm_store, only: store_t
  implicit none
  private
  public :: checkpoint_file_t, can_checkpoint, read_run_text

  !> Whether this build has checkpoints.
  logical, parameter :: can_checkpoint = .false.
  !> What is told of it.
  character(*), parameter :: message = 'this mpm3d was built without HDF5 and has no checkpoints'
  !> The way out.
  character(*), parameter :: way_out = 'build it with -DMPM3D_HDF5=ON (Debian: libhdf5-dev)'

  !> A checkpoint that can't be.
  type, extends(store_t) :: checkpoint_file_t
  contains
    !> Start a checkpoint.
    procedure :: begin => checkpoint_file_begin
    !> Finish it.
    procedure :: commit => checkpoint_file_commit
    !> Open a checkpoint.
    procedure :: read => checkpoint_file_read
    !> Close it.
    procedure :: close => checkpoint_file_leave
    procedure :: enter => checkpoint_file_enter
    procedure :: leave => checkpoint_file_leave
    procedure :: has => checkpoint_file_has
    procedure :: write_reals => checkpoint_file_write_reals
    procedure :: write_integers => checkpoint_file_write_integers
    procedure :: write_text => checkpoint_file_write_text
    procedure :: extents_of => checkpoint_file_extents_of
    procedure :: read_reals => checkpoint_file_read_reals
    procedure :: read_integers => checkpoint_file_read_integers
    procedure :: read_text => checkpoint_file_read_text
  end type checkpoint_file_t

contains

  !> Start a checkpoint.
  subroutine checkpoint_file_begin(self, path)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Its path.
    character(*), intent(in) :: path

    self%path = path
    call raise(self%failure, err_io, message, hint=way_out)
  end subroutine checkpoint_file_begin

  !> Finish it.
  subroutine checkpoint_file_commit(self, error)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Always.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self)
    end associate
    call raise(error, err_io, message, hint=way_out)
  end subroutine checkpoint_file_commit

  !> Open a checkpoint.
  subroutine checkpoint_file_read(self, path, error)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Its path.
    character(*), intent(in) :: path
    !> Always.
    type(error_t), allocatable, intent(out) :: error

    self%path = path
    call raise(error, err_input, message, hint=way_out)
  end subroutine checkpoint_file_read

  !> There is nothing to read.
  subroutine read_run_text(path, text, error)
    !> The file.
    character(*), intent(in) :: path
    !> Empty.
    character(:), allocatable, intent(out) :: text
    !> Always.
    type(error_t), allocatable, intent(out) :: error

    text = ''
    call raise(error, err_input, message, file=path, hint=way_out)
  end subroutine read_run_text

  !> Nothing.
  subroutine checkpoint_file_enter(self, name)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name of a group.
    character(*), intent(in) :: name

    associate (unused => self, unused_name => name)
    end associate
  end subroutine checkpoint_file_enter

  !> Nothing.
  subroutine checkpoint_file_leave(self)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self

    associate (unused => self)
    end associate
  end subroutine checkpoint_file_leave

  !> Nothing is there.
  function checkpoint_file_has(self, name) result(has)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> The name.
    character(*), intent(in) :: name
    !> False.
    logical :: has

    associate (unused => self, unused_name => name)
    end associate
    has = .false.
  end function checkpoint_file_has

  !> Nothing.
  subroutine checkpoint_file_write_reals(self, name, values, extents)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values.
    real(wp), contiguous, target, intent(in) :: values(:)
    !> Extents.
    integer(lp), intent(in) :: extents(:)

    associate (unused => self, unused_name => name, unused_values => values, unused_ => extents)
    end associate
  end subroutine checkpoint_file_write_reals

  !> Nothing.
  subroutine checkpoint_file_write_integers(self, name, values, extents)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values.
    integer(lp), contiguous, target, intent(in) :: values(:)
    !> Extents.
    integer(lp), intent(in) :: extents(:)

    associate (unused => self, unused_name => name, unused_values => values, unused_ => extents)
    end associate
  end subroutine checkpoint_file_write_integers

  !> Nothing.
  subroutine checkpoint_file_write_text(self, name, text)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The text.
    character(*), intent(in) :: text

    associate (unused => self, unused_name => name, unused_text => text)
    end associate
  end subroutine checkpoint_file_write_text

  !> Nothing.
  subroutine checkpoint_file_extents_of(self, name, extents)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> None.
    integer(lp), allocatable, intent(out) :: extents(:)

    associate (unused => self, unused_name => name)
    end associate
    allocate (extents(0))
  end subroutine checkpoint_file_extents_of

  !> Nothing.
  subroutine checkpoint_file_read_reals(self, name, values)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; stay.
    real(wp), contiguous, target, intent(inout) :: values(:)

    associate (unused => self, unused_name => name, unused_values => values)
    end associate
  end subroutine checkpoint_file_read_reals

  !> Nothing.
  subroutine checkpoint_file_read_integers(self, name, values)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; stay.
    integer(lp), contiguous, target, intent(inout) :: values(:)

    associate (unused => self, unused_name => name, unused_values => values)
    end associate
  end subroutine checkpoint_file_read_integers

  !> Nothing.
  subroutine checkpoint_file_read_text(self, name, text)
    !> The checkpoint.
    class(checkpoint_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Empty.
    character(:), allocatable, intent(out) :: text

    associate (unused => self, unused_name => name)
    end associate
    text = ''
  end subroutine checkpoint_file_read_text

end module mpm_checkpoint_file
