!> Frames with all fields, of every step within a window of time.
module mpm_debug_vtk
  use mpm_default_vtk, only: default_vtk_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_vtk_frames, only: add_vtk_properties
  implicit none
  private
  public :: debug_vtk_t

  !> Times that differ by less than this part of a step are the same.
  real(wp), parameter :: slack = 1.0e-6_wp

  !> Legacy VTK files with every field; frames of all steps within a window.
  type, extends(default_vtk_t) :: debug_vtk_t
    !> Start and end of the window, which do not belong to it. [s]
    real(wp) :: window(2) = 0.0_wp
  contains
    procedure, nopass :: describe => debug_vtk_describe
    procedure :: init => debug_vtk_init
    procedure :: due => debug_vtk_due
    procedure :: write_frame => debug_vtk_write_frame
  end type debug_vtk_t

contains

  !> Purpose and properties of the class.
  subroutine debug_vtk_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('serializer', 'DebugVTK', &
                          'Frames as those of DefaultVTK, and a frame of every step within a &
                          &window of time.', &
                          'VTK File Formats, www.vtk.org (legacy format, version 3.0, ASCII)', &
                          'serializer'//nl//'{'//nl//'    class = "DebugVTK"'//nl// &
                          '    properties = {60, 0.5, 0.51}   # rate, t_start, t_end'//nl// &
                          '    str-properties = {"output", "save", "two_blocks"}'//nl//'}')
    call description%add_real('rate', '1/s', 'frames per unit of time beside those of the window; &
                              &0 writes the first only', lower=0.0_wp)
    call description%add_real('t_start', 's', 'start of the window')
    call description%add_real('t_end', 's', 'end of the window; later than t_start')
    call add_vtk_properties(description, with_rate=.false.)
    call description%add_note('Steps that end after t_start and before t_end have a frame.')
    call description%add_note('Frames of the window do not delay those that the rate asks for &
                              &(mpm_3d: as many intervals late as there were steps in the window).')
  end subroutine debug_vtk_describe

  !> Set up from the properties; nothing is written.
  subroutine debug_vtk_init(self, properties, error)
    !> The serializer.
    class(debug_vtk_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The name of the folder is empty, or the window is.
    type(error_t), allocatable, intent(out) :: error

    call self%default_vtk_t%init(properties, error)
    if (allocated(error)) return
    self%window = [properties%real('t_start'), properties%real('t_end')]
    if (self%window(2) > self%window(1)) return
    call properties%reject('t_end', 'the window ends before it begins', error, &
                           't_end is later than t_start')
  end subroutine debug_vtk_init

  !> Whether a frame is due: one that the rate asks for, or one of the window.
  pure function debug_vtk_due(self, model, time) result(due)
    !> The serializer.
    class(debug_vtk_t), intent(in) :: self
    !> The model at the start of the step that ends at the time.
    type(model_t), intent(in) :: model
    !> The time in question. [s]
    real(wp), intent(in) :: time
    !> Whether a frame is due.
    logical :: due
    real(wp) :: margin

    margin = slack*min(model%dt, time - model%time)
    due = time > self%window(1) + margin .and. time < self%window(2) - margin
    due = due .or. self%default_vtk_t%due(model, time)
  end function debug_vtk_due

  !> Write the state as the next frame; frames that the rate did not ask for do not count for it.
  subroutine debug_vtk_write_frame(self, model, error)
    !> The serializer.
    class(debug_vtk_t), intent(inout) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    logical :: extra
    real(wp) :: margin

    extra = self%frames > 0
    if (extra .and. self%rate > 0.0_wp) then
      margin = slack*min(model%dt, model%last_dt)
      extra = model%time < self%next_time(model) - margin
    end if
    call self%default_vtk_t%write_frame(model, error)
    if (allocated(error)) return
    if (extra) self%skipped = self%skipped - 1
  end subroutine debug_vtk_write_frame

end module mpm_debug_vtk
