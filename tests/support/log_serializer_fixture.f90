!> A serializer that writes nothing and remembers when it was asked to.
module mpm_log_serializer_fixture
  use mpm_description, only: description_t
  use mpm_errors, only: err_io, error_t, raise
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_serializer, only: serializer_t
  implicit none
  private
  public :: log_serializer_t

  !> Remembers the times and last steps of frames.
  type, extends(serializer_t) :: log_serializer_t
    !> Frame at which writing fails; -1 for none.
    integer :: fails_at = -1
    !> Times of the frames. [s]
    real(wp), allocatable :: times(:)
    !> Lengths of the steps before them. [s]
    real(wp), allocatable :: last_dt(:)
  contains
    procedure, nopass :: describe => log_serializer_describe
    procedure :: init => log_serializer_init
    procedure :: open => log_serializer_open
    procedure :: write_frame => log_serializer_write_frame
    procedure :: destination => log_serializer_destination
  end type log_serializer_t

contains

  !> Purpose and properties of the class.
  subroutine log_serializer_describe(description)
    !> The description.
    type(description_t), intent(out) :: description

    call description%init('serializer', 'Log', 'Remembers frames.', '', '')
  end subroutine log_serializer_describe

  !> Nothing to set up.
  subroutine log_serializer_init(self, properties, error)
    !> The serializer.
    class(log_serializer_t), intent(inout) :: self
    !> Not used.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self, unused_properties => properties)
    end associate
  end subroutine log_serializer_init

  !> Start without frames.
  subroutine log_serializer_open(self, model, error)
    !> The serializer.
    class(log_serializer_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(inout) :: model
    !> Never set.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    self%times = [real(wp) ::]
    self%last_dt = [real(wp) ::]
    do i = 1, size(model%bodies)
      associate (points => model%bodies(i)%body%points)
        allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
      end associate
    end do
  end subroutine log_serializer_open

  !> Remember a frame.
  subroutine log_serializer_write_frame(self, model, error)
    !> The serializer.
    class(log_serializer_t), intent(inout) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> Set at the frame that fails.
    type(error_t), allocatable, intent(out) :: error

    if (self%frames == self%fails_at) then
      call raise(error, err_io, 'no frame')
      return
    end if
    self%frames = self%frames + 1
    self%times = [self%times, model%time]
    self%last_dt = [self%last_dt, model%last_dt]
  end subroutine log_serializer_write_frame

  !> Nowhere.
  function log_serializer_destination(self) result(text)
    !> The serializer.
    class(log_serializer_t), intent(in) :: self
    !> A word.
    character(:), allocatable :: text

    associate (unused => self)
    end associate
    text = 'nowhere'
  end function log_serializer_destination

end module mpm_log_serializer_fixture
