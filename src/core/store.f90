!> Where objects save the state from which a run can go on: a tree of named values.
!!
!! A class overrides `save` and `restore` of `configurable_t`, and puts or gets by name what its
!! next step depends on and `init` does not give it. The first failure is kept in the store; what is
!! put or gotten after it is left undone, so that callers ask for `failure` once at the end.
module mpm_store
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: store_t

  !> A tree of groups that hold named values; there is one current group.
  type, abstract :: store_t
    !> The file, for messages.
    character(:), allocatable :: path
    !> The first failure.
    type(error_t), allocatable :: failure
  contains
    !> Enter a group of the current one; when writing it is made.
    procedure(enter_i), deferred :: enter
    !> Go back to the group around the current one.
    procedure(leave_i), deferred :: leave
    !> Whether the current group has a value or group of a name.
    procedure(has_i), deferred :: has
    !> Write reals.
    procedure(write_reals_i), deferred :: write_reals
    !> Write integers.
    procedure(write_integers_i), deferred :: write_integers
    !> Write a text.
    procedure(write_text_i), deferred :: write_text
    !> Extents of reals or integers.
    procedure(extents_of_i), deferred :: extents_of
    !> Read reals.
    procedure(read_reals_i), deferred :: read_reals
    !> Read integers.
    procedure(read_integers_i), deferred :: read_integers
    !> Read a text.
    procedure(read_text_i), deferred :: read_text
    !> Save a value of the current group: a number, logical or text, or an array of numbers.
    generic :: put => put_logical, put_integer, put_long, put_real, put_text, put_integers, &
                      put_logicals, put_reals, put_real_columns
    !> Restore a value; arrays get the extents that they had.
    generic :: get => get_logical, get_integer, get_long, get_real, get_text, get_integers, &
                      get_logicals, get_reals, get_real_columns
    !> Restore an array of fixed extents.
    generic :: get_fixed => get_fixed_integers, get_fixed_reals
    procedure, private :: put_logical
    procedure, private :: put_integer
    procedure, private :: put_long
    procedure, private :: put_real
    procedure, private :: put_text
    procedure, private :: put_integers
    procedure, private :: put_logicals
    procedure, private :: put_reals
    procedure, private :: put_real_columns
    procedure, private :: get_logical
    procedure, private :: get_integer
    procedure, private :: get_long
    procedure, private :: get_real
    procedure, private :: get_text
    procedure, private :: get_integers
    procedure, private :: get_logicals
    procedure, private :: get_reals
    procedure, private :: get_real_columns
    procedure, private :: get_fixed_integers
    procedure, private :: get_fixed_reals
    procedure, private :: find_extents
  end type store_t

  abstract interface
    !> Enter a group of the current one; when writing it is made.
    subroutine enter_i(self, name)
      import :: store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name of the group.
      character(*), intent(in) :: name
    end subroutine enter_i

    !> Go back to the group around the current one.
    subroutine leave_i(self)
      import :: store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
    end subroutine leave_i

    !> Whether the current group has a value or group of a name.
    function has_i(self, name) result(has)
      import :: store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> The name.
      character(*), intent(in) :: name
      !> False after a failure.
      logical :: has
    end function has_i

    !> Write reals.
    subroutine write_reals_i(self, name, values, extents)
      import :: lp, store_t, wp
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> Values, the first index fastest.
      real(wp), contiguous, target, intent(in) :: values(:)
      !> Extents; none for a single number.
      integer(lp), intent(in) :: extents(:)
    end subroutine write_reals_i

    !> Write integers.
    subroutine write_integers_i(self, name, values, extents)
      import :: lp, store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> Values, the first index fastest.
      integer(lp), contiguous, target, intent(in) :: values(:)
      !> Extents; none for a single number.
      integer(lp), intent(in) :: extents(:)
    end subroutine write_integers_i

    !> Write a text.
    subroutine write_text_i(self, name, text)
      import :: store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> The text.
      character(*), intent(in) :: text
    end subroutine write_text_i

    !> Extents of reals or integers.
    subroutine extents_of_i(self, name, extents)
      import :: lp, store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> Extents, the fastest first; not allocated upon failure.
      integer(lp), allocatable, intent(out) :: extents(:)
    end subroutine extents_of_i

    !> Read reals.
    subroutine read_reals_i(self, name, values)
      import :: store_t, wp
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> Values, as many as there are.
      real(wp), contiguous, target, intent(inout) :: values(:)
    end subroutine read_reals_i

    !> Read integers.
    subroutine read_integers_i(self, name, values)
      import :: lp, store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> Values, as many as there are.
      integer(lp), contiguous, target, intent(inout) :: values(:)
    end subroutine read_integers_i

    !> Read a text.
    subroutine read_text_i(self, name, text)
      import :: store_t
      implicit none
      !> The store.
      class(store_t), intent(inout) :: self
      !> Name.
      character(*), intent(in) :: name
      !> The text; empty upon failure.
      character(:), allocatable, intent(out) :: text
    end subroutine read_text_i
  end interface

contains

  !> Save a logical.
  subroutine put_logical(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value.
    logical, intent(in) :: value

    call self%put_long(name, merge(1_lp, 0_lp, value))
  end subroutine put_logical

  !> Save an integer.
  subroutine put_integer(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value.
    integer, intent(in) :: value

    call self%put_long(name, int(value, lp))
  end subroutine put_integer

  !> Save a long integer.
  subroutine put_long(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value.
    integer(lp), intent(in) :: value
    integer(lp) :: none(0)

    call self%write_integers(name, [value], none)
  end subroutine put_long

  !> Save a real.
  subroutine put_real(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value.
    real(wp), intent(in) :: value
    integer(lp) :: none(0)

    call self%write_reals(name, [value], none)
  end subroutine put_real

  !> Save a text.
  subroutine put_text(self, name, text)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The text.
    character(*), intent(in) :: text

    call self%write_text(name, text)
  end subroutine put_text

  !> Save integers.
  subroutine put_integers(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values. (n)
    integer, intent(in) :: values(:)

    call self%write_integers(name, int(values, lp), shape(values, lp))
  end subroutine put_integers

  !> Save logicals.
  subroutine put_logicals(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values. (n)
    logical, intent(in) :: values(:)

    call self%write_integers(name, merge(1_lp, 0_lp, values), shape(values, lp))
  end subroutine put_logicals

  !> Save reals.
  subroutine put_reals(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values. (n)
    real(wp), contiguous, target, intent(in) :: values(:)

    call self%write_reals(name, values, shape(values, lp))
  end subroutine put_reals

  !> Save reals of two indices.
  subroutine put_real_columns(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), contiguous, target, intent(in) :: values(:, :)
    real(wp), pointer, contiguous :: flat(:)

    flat(1:size(values)) => values
    call self%write_reals(name, flat, shape(values, lp))
  end subroutine put_real_columns

  !> Restore a logical.
  subroutine get_logical(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value; as it was upon failure.
    logical, intent(inout) :: value
    integer(lp) :: number

    number = merge(1_lp, 0_lp, value)
    call self%get_long(name, number)
    value = number /= 0_lp
  end subroutine get_logical

  !> Restore an integer.
  subroutine get_integer(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value; as it was upon failure.
    integer, intent(inout) :: value
    integer(lp) :: number

    number = int(value, lp)
    call self%get_long(name, number)
    value = int(number)
  end subroutine get_integer

  !> Restore a long integer.
  subroutine get_long(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value; as it was upon failure.
    integer(lp), intent(inout) :: value
    integer(lp), allocatable :: extents(:)
    integer(lp), target :: values(1)

    call self%find_extents(name, 0, extents)
    if (allocated(self%failure)) return
    values = value
    call self%read_integers(name, values)
    value = values(1)
  end subroutine get_long

  !> Restore a real.
  subroutine get_real(self, name, value)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Value; as it was upon failure.
    real(wp), intent(inout) :: value
    integer(lp), allocatable :: extents(:)
    real(wp), target :: values(1)

    call self%find_extents(name, 0, extents)
    if (allocated(self%failure)) return
    values = value
    call self%read_reals(name, values)
    value = values(1)
  end subroutine get_real

  !> Restore a text.
  subroutine get_text(self, name, text)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The text; empty upon failure.
    character(:), allocatable, intent(out) :: text

    text = ''
    if (.not. allocated(self%failure)) call self%read_text(name, text)
  end subroutine get_text

  !> Restore integers.
  subroutine get_integers(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; as they were upon failure. (n)
    integer, allocatable, intent(inout) :: values(:)
    integer(lp), allocatable :: extents(:)
    integer(lp), allocatable, target :: numbers(:)

    call self%find_extents(name, 1, extents)
    if (allocated(self%failure)) return
    allocate (numbers(extents(1)))
    call self%read_integers(name, numbers)
    if (.not. allocated(self%failure)) values = int(numbers)
  end subroutine get_integers

  !> Restore logicals.
  subroutine get_logicals(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; as they were upon failure. (n)
    logical, allocatable, intent(inout) :: values(:)
    integer, allocatable :: numbers(:)

    call self%get_integers(name, numbers)
    if (.not. allocated(self%failure)) values = numbers /= 0
  end subroutine get_logicals

  !> Restore reals.
  subroutine get_reals(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; as they were upon failure. (n)
    real(wp), allocatable, intent(inout) :: values(:)
    integer(lp), allocatable :: extents(:)
    real(wp), allocatable, target :: numbers(:)

    call self%find_extents(name, 1, extents)
    if (allocated(self%failure)) return
    allocate (numbers(extents(1)))
    call self%read_reals(name, numbers)
    if (.not. allocated(self%failure)) call move_alloc(numbers, values)
  end subroutine get_reals

  !> Restore reals of two indices.
  subroutine get_real_columns(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; as they were upon failure. (components, n)
    real(wp), allocatable, intent(inout) :: values(:, :)
    integer(lp), allocatable :: extents(:)
    real(wp), allocatable, target :: numbers(:, :)
    real(wp), pointer, contiguous :: flat(:)

    call self%find_extents(name, 2, extents)
    if (allocated(self%failure)) return
    allocate (numbers(extents(1), extents(2)))
    flat(1:size(numbers)) => numbers
    call self%read_reals(name, flat)
    if (.not. allocated(self%failure)) call move_alloc(numbers, values)
  end subroutine get_real_columns

  !> Restore integers of a fixed number.
  subroutine get_fixed_integers(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; as they were upon failure. (n)
    integer, intent(inout) :: values(:)
    integer, allocatable :: numbers(:)

    call self%get_integers(name, numbers)
    if (allocated(self%failure)) return
    if (size(numbers) == size(values)) then
      values = numbers
    else
      call raise_extents(self, name)
    end if
  end subroutine get_fixed_integers

  !> Restore reals of a fixed number.
  subroutine get_fixed_reals(self, name, values)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; as they were upon failure. (n)
    real(wp), intent(inout) :: values(:)
    real(wp), allocatable :: numbers(:)

    call self%get_reals(name, numbers)
    if (allocated(self%failure)) return
    if (size(numbers) == size(values)) then
      values = numbers
    else
      call raise_extents(self, name)
    end if
  end subroutine get_fixed_reals

  !> Extents of numbers, of which there must be so many.
  subroutine find_extents(self, name, rank, extents)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Number of extents.
    integer, intent(in) :: rank
    !> Extents; use them only when there is no failure.
    integer(lp), allocatable, intent(out) :: extents(:)

    if (allocated(self%failure)) return
    call self%extents_of(name, extents)
    if (allocated(self%failure)) return
    if (size(extents) /= rank) call raise_extents(self, name)
  end subroutine find_extents

  !> The failure of a value that is not as large as its object takes it.
  subroutine raise_extents(self, name)
    !> The store.
    class(store_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name

    call raise(self%failure, err_input, '"'//name//'" does not have the extents that are &
               &expected', file=self%path)
  end subroutine raise_extents

end module mpm_store
