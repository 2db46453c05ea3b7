!> What objects send their fields to when a frame is written.
!!
!! There is one writer for the points of a body and one for its nodes, so that every field says
!! where it lives.
module mpm_field_writer
  use mpm_kinds, only: wp
  use mpm_window, only: window_t
  implicit none
  private
  public :: field_writer_t

  !> Receiver of the fields of one frame of one body.
  !!
  !! Fields of points are given in storage order without a window, fields of nodes with the window
  !! of their arrays; nodes outside of it are 0.
  type, abstract :: field_writer_t
  contains
    !> A number for each point or node.
    procedure(scalar_i), deferred :: scalar
    !> A vector with as many components as the TYPE has.
    procedure(vector_i), deferred :: vector
    !> A symmetric tensor in stored stress components.
    procedure(vector_i), deferred :: symmetric_tensor
    !> A tensor in stored velocity gradient components.
    procedure(vector_i), deferred :: gradient_tensor
  end type field_writer_t

  abstract interface
    !> Send a scalar field.
    subroutine scalar_i(self, name, values, window)
      import :: field_writer_t, window_t, wp
      implicit none
      !> The writer.
      class(field_writer_t), intent(inout) :: self
      !> Name of the field.
      character(*), intent(in) :: name
      !> Values. (n)
      real(wp), intent(in) :: values(:)
      !> Window of nodal values.
      type(window_t), intent(in), optional :: window
    end subroutine scalar_i

    !> Send a vector or tensor field.
    subroutine vector_i(self, name, values, window)
      import :: field_writer_t, window_t, wp
      implicit none
      !> The writer.
      class(field_writer_t), intent(inout) :: self
      !> Name of the field.
      character(*), intent(in) :: name
      !> Values. (components, n)
      real(wp), intent(in) :: values(:, :)
      !> Window of nodal values.
      type(window_t), intent(in), optional :: window
    end subroutine vector_i
  end interface

end module mpm_field_writer
