!> Names of the fields that objects send.
module mpm_field_names
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_strings, only: append_text, string_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: field_names_t

  !> A receiver of fields that keeps their names only.
  type, extends(field_writer_t) :: field_names_t
    !> The names, each once.
    type(string_t), allocatable :: names(:)
    !> Components of all of them, 9 of a tensor.
    integer :: components = 0
  contains
    procedure :: scalar => field_names_scalar
    procedure :: vector => field_names_vector
    procedure :: symmetric_tensor => field_names_tensor
    procedure :: gradient_tensor => field_names_tensor
    !> Whether a name is among them.
    procedure :: has => field_names_has
    !> Keep a name.
    procedure :: keep => field_names_keep
  end type field_names_t

contains

  !> Keep the name of a scalar field.
  subroutine field_names_scalar(self, name, values, window)
    !> The names.
    class(field_names_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (n)
    real(wp), intent(in) :: values(:)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    associate (unused => values)
    end associate
    if (present(window)) continue
    call self%keep(name, 1)
  end subroutine field_names_scalar

  !> Keep the name of a vector field.
  subroutine field_names_vector(self, name, values, window)
    !> The names.
    class(field_names_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    associate (unused => values)
    end associate
    if (present(window)) continue
    call self%keep(name, 3)
  end subroutine field_names_vector

  !> Keep the name of a tensor field.
  subroutine field_names_tensor(self, name, values, window)
    !> The names.
    class(field_names_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    associate (unused => values)
    end associate
    if (present(window)) continue
    call self%keep(name, 9)
  end subroutine field_names_tensor

  !> Whether a name is among them.
  pure function field_names_has(self, name) result(has)
    !> The names.
    class(field_names_t), intent(in) :: self
    !> The name.
    character(*), intent(in) :: name
    !> Whether it is.
    logical :: has
    integer :: i

    has = .false.
    if (.not. allocated(self%names)) return
    do i = 1, size(self%names)
      if (self%names(i)%text == name) has = .true.
    end do
  end function field_names_has

  !> Keep a name.
  subroutine field_names_keep(self, name, components)
    !> The names.
    class(field_names_t), intent(inout) :: self
    !> The name.
    character(*), intent(in) :: name
    !> Components of the field.
    integer, intent(in) :: components

    if (.not. allocated(self%names)) allocate (self%names(0))
    if (self%has(name)) return
    call append_text(self%names, name)
    self%components = self%components + components
  end subroutine field_names_keep

end module mpm_field_names
