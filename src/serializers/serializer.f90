!> The role `serializer`: when frames are due and how they are written.
module mpm_serializer
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: serializer_t

  !> A writer of frames.
  type, abstract, extends(configurable_t) :: serializer_t
    !> Frames per unit of time; 0 writes the first only. [1/s]
    real(wp) :: rate = 0.0_wp
    !> Frames written so far, which is the number of the next one.
    integer :: frames = 0
    !> Bytes written so far.
    integer(lp) :: bytes = 0
  contains
    !> Set up from the properties; nothing is written.
    procedure(init_i), deferred :: init
    !> Refuse a model whose frames would be too large; nothing is written.
    procedure :: check => serializer_check
    !> Make the folder of the frames.
    procedure(open_i), deferred :: open
    !> Write the state as the next frame.
    procedure(write_frame_i), deferred :: write_frame
    !> Where the frames go, for people.
    procedure(destination_i), deferred :: destination
    !> Whether a frame is due at a time.
    procedure :: due => serializer_due
  end type serializer_t

  abstract interface
    !> Set up from the properties; nothing is written.
    subroutine init_i(self, properties, error)
      import :: error_t, properties_t, serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(inout) :: self
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Values that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Make the folder of the frames and whatever else writing needs.
    subroutine open_i(self, model, error)
      import :: error_t, model_t, serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(inout) :: self
      !> The model at its start.
      type(model_t), intent(inout) :: model
      !> The folder can't be made or written to.
      type(error_t), allocatable, intent(out) :: error
    end subroutine open_i

    !> Write the state as the next frame.
    subroutine write_frame_i(self, model, error)
      import :: error_t, model_t, serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(inout) :: self
      !> The state.
      type(model_t), intent(in) :: model
      !> Writing failed; earlier frames are whole.
      type(error_t), allocatable, intent(out) :: error
    end subroutine write_frame_i

    !> Where the frames go.
    function destination_i(self) result(text)
      import :: serializer_t
      implicit none
      !> The serializer.
      class(serializer_t), intent(in) :: self
      !> A folder or file.
      character(:), allocatable :: text
    end function destination_i
  end interface

contains

  !> Most serializers take any model.
  subroutine serializer_check(self, model, error)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> Frames that are too large.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self, unused_model => model)
    end associate
  end subroutine serializer_check

  !> Whether a frame is due at a time: t - t_start >= k / rate for the next frame k.
  pure function serializer_due(self, model, time) result(due)
    !> The serializer.
    class(serializer_t), intent(in) :: self
    !> The model at the start of the step that ends at the time.
    type(model_t), intent(in) :: model
    !> The time in question. [s]
    real(wp), intent(in) :: time
    !> Whether a frame is due.
    logical :: due
    real(wp) :: slack

    due = self%frames == 0
    if (due .or. .not. self%rate > 0.0_wp) return
    ! A frame time that a step reaches up to rounding must not wait for the next step.
    slack = 1.0e-6_wp*min(model%dt, time - model%time)
    due = time - model%t_start >= real(self%frames, wp)/self%rate - slack
  end function serializer_due

end module mpm_serializer
