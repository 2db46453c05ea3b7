!> A receiver of fields that keeps what it gets.
module mpm_recorder_fixture
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_window, only: window_t
  implicit none
  private
  public :: recorder_t

  !> One field.
  type :: field_t
    !> Its name.
    character(:), allocatable :: name
    !> `scalar`, `vector`, `symmetric` or `gradient`.
    character(:), allocatable :: kind
    !> Values; one component of a scalar. (components, n)
    real(wp), allocatable :: values(:, :)
    !> Window of nodal values.
    type(window_t) :: window
  end type field_t

  !> Keeps the fields in the order in which they come.
  type, extends(field_writer_t) :: recorder_t
    !> Number of fields.
    integer :: n = 0
    !> The fields; the first n are set.
    type(field_t) :: fields(40)
  contains
    procedure :: scalar => recorder_scalar
    procedure :: vector => recorder_vector
    procedure :: symmetric_tensor => recorder_symmetric_tensor
    procedure :: gradient_tensor => recorder_gradient_tensor
    !> Position of a field, or 0.
    procedure :: find => recorder_find
    !> All names, parted by blanks.
    procedure :: names => recorder_names
  end type recorder_t

contains

  !> Keep a field.
  subroutine keep(self, name, kind, values, window)
    !> The recorder.
    class(recorder_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Kind of the field.
    character(*), intent(in) :: kind
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    self%n = self%n + 1
    self%fields(self%n)%name = name
    self%fields(self%n)%kind = kind
    allocate (self%fields(self%n)%values, source=values)
    if (present(window)) self%fields(self%n)%window = window
  end subroutine keep

  !> Keep a scalar field.
  subroutine recorder_scalar(self, name, values, window)
    !> The recorder.
    class(recorder_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (n)
    real(wp), intent(in) :: values(:)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    call keep(self, name, 'scalar', reshape(values, [1, size(values)]), window)
  end subroutine recorder_scalar

  !> Keep a vector field.
  subroutine recorder_vector(self, name, values, window)
    !> The recorder.
    class(recorder_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    call keep(self, name, 'vector', values, window)
  end subroutine recorder_vector

  !> Keep a field of stresses.
  subroutine recorder_symmetric_tensor(self, name, values, window)
    !> The recorder.
    class(recorder_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    call keep(self, name, 'symmetric', values, window)
  end subroutine recorder_symmetric_tensor

  !> Keep a field of velocity gradients.
  subroutine recorder_gradient_tensor(self, name, values, window)
    !> The recorder.
    class(recorder_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    call keep(self, name, 'gradient', values, window)
  end subroutine recorder_gradient_tensor

  !> Position of a field.
  pure function recorder_find(self, name) result(position)
    !> The recorder.
    class(recorder_t), intent(in) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Its position; 0 when there is none.
    integer :: position

    do position = 1, self%n
      if (self%fields(position)%name == name) return
    end do
    position = 0
  end function recorder_find

  !> All names.
  pure function recorder_names(self) result(text)
    !> The recorder.
    class(recorder_t), intent(in) :: self
    !> Names parted by blanks.
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, self%n
      if (i > 1) text = text//' '
      text = text//self%fields(i)%name
    end do
  end function recorder_names

end module mpm_recorder_fixture
