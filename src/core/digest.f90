!> Digests that tell whether numbers or bytes are still the same.
module mpm_digest
  use, intrinsic :: iso_fortran_env, only: int32
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: digest_t

  !> The sums are taken modulo 2^32 - 1.
  integer(lp), parameter :: modulus = 4294967295_lp
  !> Words between two divisions; the second sum stays below 2^63.
  integer, parameter :: part_size = 16384

  !> Fletcher's checksum of 64 bits over words of 32 bits.
  !!
  !! J. G. Fletcher, IEEE Trans. Commun. 30 (1982) 247-252. It finds every change of fewer than 32
  !! bits in a row, and misses other accidents once in 2^64; it is no defence against intent.
  type :: digest_t
    !> Sum of the words.
    integer(lp), private :: first = 1
    !> Sum of the sums.
    integer(lp), private :: second = 0
  contains
    !> Add words of 32 bits.
    procedure :: add_words => digest_add_words
    !> Add reals.
    procedure :: add => digest_add
    !> Add reals of two indices.
    procedure :: add_columns => digest_add_columns
    !> Add a text.
    procedure :: add_text => digest_add_text
    !> The digest as 16 hexadecimal digits.
    procedure :: text => digest_text
  end type digest_t

contains

  !> Add words of 32 bits.
  pure subroutine digest_add_words(self, words)
    !> The digest.
    class(digest_t), intent(inout) :: self
    !> The words.
    integer(int32), intent(in) :: words(:)
    integer(lp) :: a, b
    integer :: i, start

    a = self%first
    b = self%second
    do start = 1, size(words), part_size
      do i = start, min(start + part_size - 1, size(words))
        a = a + iand(int(words(i), lp), modulus)
        b = b + a
      end do
      a = mod(a, modulus)
      b = mod(b, modulus)
    end do
    self%first = a
    self%second = b
  end subroutine digest_add_words

  !> Add reals.
  pure subroutine digest_add(self, values)
    !> The digest.
    class(digest_t), intent(inout) :: self
    !> Values. (n)
    real(wp), intent(in) :: values(:)
    integer :: start

    do start = 1, size(values), part_size
      call self%add_words(transfer(values(start:min(start + part_size - 1, size(values))), &
                                   [0_int32]))
    end do
  end subroutine digest_add

  !> Add reals of two indices.
  pure subroutine digest_add_columns(self, values)
    !> The digest.
    class(digest_t), intent(inout) :: self
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    integer :: i

    do i = 1, size(values, 2)
      call self%add(values(:, i))
    end do
  end subroutine digest_add_columns

  !> Add a text, and its length in bytes.
  pure subroutine digest_add_text(self, text)
    !> The digest.
    class(digest_t), intent(inout) :: self
    !> The text.
    character(*), intent(in) :: text
    integer :: missing

    missing = modulo(-len(text), 4)
    call self%add_words(transfer(text//repeat(achar(0), missing), [0_int32]))
    call self%add_words([int(len(text), int32)])
  end subroutine digest_add_text

  !> The digest as 16 hexadecimal digits.
  pure function digest_text(self) result(text)
    !> The digest.
    class(digest_t), intent(in) :: self
    !> The digits.
    character(16) :: text

    write (text, '(z8.8, z8.8)') self%second, self%first
  end function digest_text

end module mpm_digest
