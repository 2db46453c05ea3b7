!> Fields on their way into a legacy VTK file: order, components and finite values.
module mpm_vtk_fields
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: iso_fortran_env, only: int64
  use mpm_errors, only: err_simulation, error_t, raise
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_gradient, expand_stress, kinematics_t
  use mpm_strings, only: to_text
  use mpm_vtk_legacy, only: vtk_legacy_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: block_size, vtk_fields_t

  !> Entries that are gathered and written at a time.
  integer, parameter :: block_size = 512
  !> Kinds of a field.
  integer, parameter :: kind_scalar = 1, kind_vector = 2, kind_symmetric = 3, kind_gradient = 4

  !> A file of one body and one frame that takes fields.
  !!
  !! Values come in the order of the arrays in memory; the file has an order of its own, which the
  !! children know. The first failure is kept and reported by `commit`.
  type, abstract, extends(field_writer_t) :: vtk_fields_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
    !> The file.
    type(vtk_legacy_t) :: file
    !> All entries of the file, for fields without a window of their own.
    type(window_t) :: whole
    !> Values of a field without a window, where there are more than entries; negative elsewhere.
    integer :: n_values = -1
    !> Name of the body.
    character(:), allocatable :: body
    !> Frame and time, for messages.
    character(:), allocatable :: when
    !> The first failure.
    type(error_t), allocatable :: failure
  contains
    procedure :: scalar => vtk_fields_scalar
    procedure :: vector => vtk_fields_vector
    procedure :: symmetric_tensor => vtk_fields_symmetric_tensor
    procedure :: gradient_tensor => vtk_fields_gradient_tensor
    !> Positions in memory of a range of entries of the file.
    procedure(locate_i), deferred :: locate
    !> What an entry is called in messages.
    procedure(label_i), deferred :: label
    !> Keep the error of a value that is not finite.
    procedure :: check => vtk_fields_check
    !> Finish the file, or give it up after a failure.
    procedure :: commit => vtk_fields_commit
  end type vtk_fields_t

  abstract interface
    !> Positions in memory of the entries `first ..` of the file.
    subroutine locate_i(self, first, window, source)
      import :: vtk_fields_t, window_t
      implicit none
      !> The file.
      class(vtk_fields_t), intent(in) :: self
      !> First entry, from 1.
      integer, intent(in) :: first
      !> Window of the values.
      type(window_t), intent(in) :: window
      !> Position in memory of each entry, from 1; 0 for an entry without a value.
      integer, intent(out) :: source(:)
    end subroutine locate_i

    !> What an entry is called in messages.
    pure function label_i(self, entry) result(text)
      import :: vtk_fields_t
      implicit none
      !> The file.
      class(vtk_fields_t), intent(in) :: self
      !> Entry, from 1.
      integer, intent(in) :: entry
      !> For example `point 17`.
      character(:), allocatable :: text
    end function label_i
  end interface

contains

  !> Write a scalar field.
  subroutine vtk_fields_scalar(self, name, values, window)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (n)
    real(wp), intent(in) :: values(:)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    if (.not. fits(self, name, size(values), window)) return
    call self%file%start_scalars(name)
    call write_field(self, name, kind_scalar, 1, size(values), values, window)
  end subroutine vtk_fields_scalar

  !> Write a vector field; components that the TYPE does not have are 0.
  subroutine vtk_fields_vector(self, name, values, window)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    if (.not. fits(self, name, size(values, 2), window)) return
    call self%file%start_vectors(name)
    call write_field(self, name, kind_vector, size(values, 1), size(values, 2), values, window)
  end subroutine vtk_fields_vector

  !> Write a symmetric tensor field in full.
  subroutine vtk_fields_symmetric_tensor(self, name, values, window)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values in stored stress components. (nstress, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    if (.not. fits(self, name, size(values, 2), window)) return
    call self%file%start_tensors(name)
    call write_field(self, name, kind_symmetric, size(values, 1), size(values, 2), values, window)
  end subroutine vtk_fields_symmetric_tensor

  !> Write a tensor field in full.
  subroutine vtk_fields_gradient_tensor(self, name, values, window)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values in stored velocity gradient components. (ngrad, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window

    if (.not. fits(self, name, size(values, 2), window)) return
    call self%file%start_tensors(name)
    call write_field(self, name, kind_gradient, size(values, 1), size(values, 2), values, window)
  end subroutine vtk_fields_gradient_tensor

  !> Whether to write a field: nothing has failed and it has the right number of values.
  function fits(self, name, n, window)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Number of its values.
    integer, intent(in) :: n
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    !> Whether to go on.
    logical :: fits
    integer :: expected

    fits = .not. allocated(self%failure)
    if (.not. fits) return
    expected = self%whole%size()
    if (self%n_values >= 0) expected = self%n_values
    if (present(window)) expected = window%size()
    fits = n == expected
    if (fits) return
    call raise(self%failure, err_simulation, 'body "'//self%body//'": field "'//name//'" has '// &
               to_text(n)//' values for '//to_text(expected)//' places')
  end function fits

  !> Write the values of a field block by block in the order of the file.
  subroutine write_field(self, name, kind, components, n, values, window)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> One of the `kind_*`.
    integer, intent(in) :: kind
    !> Components of a value.
    integer, intent(in) :: components
    !> Number of values.
    integer, intent(in) :: n
    !> Values.
    real(wp), intent(in) :: values(components, n)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    real(wp) :: scalars(block_size), vectors(3, block_size), tensors(9, block_size)
    type(window_t) :: place
    integer :: source(block_size), first, m, i

    place = self%whole
    if (present(window)) place = window
    do first = 1, self%whole%size(), block_size
      m = min(block_size, self%whole%size() - first + 1)
      call self%locate(first, place, source(:m))
      select case (kind)
      case (kind_scalar)
        scalars = 0.0_wp
        do i = 1, m
          if (source(i) > 0) scalars(i) = values(1, source(i))
        end do
        call self%check(name, first, 1, m, scalars)
        call self%file%put_scalars(scalars(:m))
      case (kind_vector)
        vectors = 0.0_wp
        do i = 1, m
          if (source(i) > 0) vectors(:components, i) = values(:, source(i))
        end do
        call self%check(name, first, 3, m, vectors)
        call self%file%put_vectors(vectors(:, :m))
      case default
        tensors = 0.0_wp
        do i = 1, m
          if (source(i) == 0) cycle
          if (kind == kind_symmetric) then
            tensors(:, i) = rows(expand_stress(values(:, source(i))))
          else
            tensors(:, i) = rows(expand_gradient(self%kin, values(:, source(i))))
          end if
        end do
        call self%check(name, first, 9, m, tensors)
        call self%file%put_tensors(tensors(:, :m))
      end select
      if (allocated(self%failure)) return
    end do
  end subroutine write_field

  !> The rows of a tensor one behind the other.
  pure function rows(tensor) result(numbers)
    !> The tensor.
    real(wp), intent(in) :: tensor(3, 3)
    !> xx xy xz yx yy yz zx zy zz.
    real(wp) :: numbers(9)

    numbers = reshape(transpose(tensor), [9])
  end function rows

  !> Keep the error of the first value that is not finite, if there is one.
  subroutine vtk_fields_check(self, name, first, components, n, values)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Entry of the first value, from 1.
    integer, intent(in) :: first
    !> Components of a value.
    integer, intent(in) :: components
    !> Number of values.
    integer, intent(in) :: n
    !> Values.
    real(wp), intent(in) :: values(components, n)
    integer :: i

    if (all_finite(components*n, values) .or. allocated(self%failure)) return
    do i = 1, n
      if (.not. all(ieee_is_finite(values(:, i)))) exit
    end do
    call raise(self%failure, err_simulation, 'body "'//self%body//'": field "'//name//'" of '// &
               self%label(first + i - 1)//' is not finite in '//self%when, &
               hint='frames written before this one are whole')
  end subroutine vtk_fields_check

  !> Whether all values are finite, many at a time.
  pure function all_finite(n, values)
    !> Number of values.
    integer, intent(in) :: n
    !> Values.
    real(wp), intent(in) :: values(n)
    !> Whether they are.
    logical :: all_finite
    integer(int64) :: largest
    integer :: i

    ! Bits without the sign are in the order of the sizes, infinity above all numbers.
    largest = 0
    do i = 1, n
      largest = max(largest, iand(transfer(values(i), largest), huge(largest)))
    end do
    all_finite = largest <= transfer(huge(1.0_wp), largest)
  end function all_finite

  !> Finish the file, or give it up after a failure.
  subroutine vtk_fields_commit(self, error)
    !> The file.
    class(vtk_fields_t), intent(inout) :: self
    !> The first failure; then there is no file.
    type(error_t), allocatable, intent(out) :: error

    if (allocated(self%failure)) then
      call self%file%discard()
      call move_alloc(self%failure, error)
    else
      call self%file%commit(error)
    end if
  end subroutine vtk_fields_commit

end module mpm_vtk_fields
