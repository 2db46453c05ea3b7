!> Permutations of arrays in place.
!!
!! Values go round along the cycles of the permutation, each with room for one value: arrays of
!! points need no second copy while they are sorted.
module mpm_permutation
  use mpm_kinds, only: wp
  implicit none
  private
  public :: permutation_t

  !> A permutation that is applied to several arrays.
  type :: permutation_t
    private
    !> Slot i receives what was in slot from(i). (n)
    integer, allocatable :: from(:)
    !> One slot of each cycle of two slots and more. (any)
    integer, allocatable :: start(:)
    !> Number of threads.
    integer :: threads = 1
  contains
    !> Find the cycles.
    procedure :: init => permutation_init
    !> Number of slots.
    procedure :: size => permutation_size
    !> Put an array into the new order.
    generic :: apply => apply_to_integers, apply_to_integer_columns, apply_to_reals, &
      apply_to_real_columns
    procedure, private :: apply_to_integers
    procedure, private :: apply_to_integer_columns
    procedure, private :: apply_to_reals
    procedure, private :: apply_to_real_columns
  end type permutation_t

contains

  !> Find the cycles.
  subroutine permutation_init(self, from, threads)
    !> The permutation.
    class(permutation_t), intent(out) :: self
    !> Slot i shall receive what is in slot from(i). (n)
    integer, intent(in) :: from(:)
    !> Number of threads; 1 when left out.
    integer, intent(in), optional :: threads
    integer :: i, at, next, n, pass

    if (present(threads)) self%threads = threads
    allocate (self%from, source=from)
    do pass = 1, 2
      n = 0
      do i = 1, size(from)
        if (self%from(i) < 0 .or. self%from(i) == i) cycle
        n = n + 1
        if (pass == 2) self%start(n) = i
        ! Slots that a cycle has visited are marked by their sign.
        at = i
        do while (self%from(at) > 0)
          next = self%from(at)
          self%from(at) = -next
          at = next
        end do
      end do
      self%from = abs(self%from)
      if (pass == 1) allocate (self%start(n))
    end do
  end subroutine permutation_init

  !> Number of slots.
  pure function permutation_size(self) result(n)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Number of slots.
    integer :: n

    n = size(self%from)
  end function permutation_size

  !> Put integers into the new order.
  subroutine apply_to_integers(self, values)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Values. (n)
    integer, contiguous, intent(inout) :: values(:)

    call carry_integers(self, 1, values)
  end subroutine apply_to_integers

  !> Put columns of integers into the new order.
  subroutine apply_to_integer_columns(self, values)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Values. (components, n)
    integer, contiguous, intent(inout) :: values(:, :)

    call carry_integers(self, size(values, 1), values)
  end subroutine apply_to_integer_columns

  !> Put reals into the new order.
  subroutine apply_to_reals(self, values)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Values. (n)
    real(wp), contiguous, intent(inout) :: values(:)

    call carry_reals(self, 1, values)
  end subroutine apply_to_reals

  !> Put columns of reals into the new order.
  subroutine apply_to_real_columns(self, values)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Values. (components, n)
    real(wp), contiguous, intent(inout) :: values(:, :)

    call carry_reals(self, size(values, 1), values)
  end subroutine apply_to_real_columns

  !> Carry columns of integers round along the cycles.
  subroutine carry_integers(self, width, values)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Length of a column.
    integer, intent(in) :: width
    !> Values.
    integer, intent(inout) :: values(width, size(self%from))
    integer :: held(width)
    integer :: k, at, next

    !$omp parallel do default(none) num_threads(self%threads) schedule(dynamic, 256) &
    !$omp shared(self, values) private(held, k, at, next)
    do k = 1, size(self%start)
      at = self%start(k)
      held = values(:, at)
      next = self%from(at)
      do while (next /= self%start(k))
        values(:, at) = values(:, next)
        at = next
        next = self%from(at)
      end do
      values(:, at) = held
    end do
    !$omp end parallel do
  end subroutine carry_integers

  !> Carry columns of reals round along the cycles.
  subroutine carry_reals(self, width, values)
    !> The permutation.
    class(permutation_t), intent(in) :: self
    !> Length of a column.
    integer, intent(in) :: width
    !> Values.
    real(wp), intent(inout) :: values(width, size(self%from))
    real(wp) :: held(width)
    integer :: k, at, next

    !$omp parallel do default(none) num_threads(self%threads) schedule(dynamic, 256) &
    !$omp shared(self, values) private(held, k, at, next)
    do k = 1, size(self%start)
      at = self%start(k)
      held = values(:, at)
      next = self%from(at)
      do while (next /= self%start(k))
        values(:, at) = values(:, next)
        at = next
        next = self%from(at)
      end do
      values(:, at) = held
    end do
    !$omp end parallel do
  end subroutine carry_reals

end module mpm_permutation
