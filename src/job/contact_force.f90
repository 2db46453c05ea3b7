!> The force of a contact as a whole, of the nodal fields that it writes for frames.
module mpm_contact_force
  use mpm_body, only: body_slot_t
  use mpm_contact, only: contact_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_window, only: window_t
  implicit none
  private
  public :: sum_contact_force

  !> Start of the names of fields that hold the force on the first body.
  character(*), parameter :: force_field = 'contact_force_by_'

  !> Adds up the vectors of the force fields.
  type, extends(field_writer_t) :: force_sum_t
    !> The sum. [N]
    real(wp) :: total(3) = 0.0_wp
    !> Number of fields that it was made of.
    integer :: n_fields = 0
  contains
    procedure :: scalar => force_sum_scalar
    procedure :: vector => force_sum_vector
    procedure :: symmetric_tensor => force_sum_tensor
    procedure :: gradient_tensor => force_sum_tensor
  end type force_sum_t

contains

  !> Force of the last step on the first body of a contact.
  subroutine sum_contact_force(contact, bodies, force, known)
    !> The contact.
    class(contact_t), intent(in) :: contact
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> The sum over the nodes. [N] (nvel)
    real(wp), intent(out) :: force(:)
    !> Whether the contact has such a field.
    logical, intent(out) :: known
    type(force_sum_t) :: sums

    call contact%write_fields(bodies, sums)
    force = sums%total(:size(force))
    known = sums%n_fields > 0
  end subroutine sum_contact_force

  !> Scalars are no forces.
  subroutine force_sum_scalar(self, name, values, window)
    !> The sum.
    class(force_sum_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (n)
    real(wp), intent(in) :: values(:)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    associate (unused => self, unused_name => name, unused_values => values)
    end associate
    if (present(window)) return
  end subroutine force_sum_scalar

  !> Add a field of forces.
  subroutine force_sum_vector(self, name, values, window)
    !> The sum.
    class(force_sum_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    integer :: a

    if (index(name, force_field) /= 1) return
    self%n_fields = self%n_fields + 1
    do a = 1, size(values, 1)
      self%total(a) = self%total(a) + sum(values(a, :))
    end do
    if (present(window)) return
  end subroutine force_sum_vector

  !> Tensors are no forces.
  subroutine force_sum_tensor(self, name, values, window)
    !> The sum.
    class(force_sum_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    associate (unused => self, unused_name => name, unused_values => values)
    end associate
    if (present(window)) return
  end subroutine force_sum_tensor

end module mpm_contact_force
