!> Random numbers without a state: a number is a function of a seed and of what it is for.
!!
!! So they do not depend on threads, on the order in which they are asked for, or on a restart.
module mpm_hashed_random
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: random_direction, random_number_of

  !> Numbers are kept below 2**31, so that products of two can be stored.
  integer(lp), parameter :: modulus = 2147483647_lp
  !> Multipliers that are primitive roots of the modulus (Fishman and Moore, SIAM J. Sci. Stat.
  !! Comput. 7 (1986) 24-45).
  integer(lp), parameter :: factors(3) = [742938285_lp, 950706376_lp, 1226874159_lp]
  !> Rounds of mixing; each brings every bit to all others.
  integer, parameter :: rounds = 3

contains

  !> A number in (0, 1) of a seed and three counters.
  pure function random_number_of(seed, a, b, c) result(value)
    !> Seed.
    integer, intent(in) :: seed
    !> First counter.
    integer(lp), intent(in) :: a
    !> Second counter.
    integer(lp), intent(in) :: b
    !> Third counter.
    integer(lp), intent(in) :: c
    !> The number.
    real(wp) :: value
    integer(lp) :: word(4), state
    integer :: i, k

    word = [int(seed, lp), a, b, c]
    state = 1_lp
    do i = 1, 4
      ! Both halves of a counter count.
      state = mix(state, iand(word(i), 4294967295_lp))
      state = mix(state, iand(ishft(word(i), -32), 4294967295_lp))
    end do
    do k = 1, rounds
      state = mix(state, int(k, lp))
    end do
    value = (real(state, wp) + 0.5_wp)/real(modulus, wp)
  end function random_number_of

  !> Put a word into a state.
  pure function mix(state, word) result(mixed)
    !> The state, 0 to the modulus less 1.
    integer(lp), intent(in) :: state
    !> The word, 0 to 2**32 - 1.
    integer(lp), intent(in) :: word
    !> The new state.
    integer(lp) :: mixed
    integer :: i

    mixed = mod(state + mod(word, modulus) + word/modulus*7_lp + 1_lp, modulus)
    do i = 1, 3
      mixed = mod(factors(i)*ieor(mixed, ishft(mixed, -15)), modulus)
      mixed = mod(mixed + 1013904223_lp, modulus)
    end do
  end function mix

  !> A unit vector, uniform on the circle or the sphere.
  pure function random_direction(dim, seed, a, b) result(direction)
    !> Dimensions, 2 or 3.
    integer, intent(in) :: dim
    !> Seed.
    integer, intent(in) :: seed
    !> First counter.
    integer(lp), intent(in) :: a
    !> Second counter.
    integer(lp), intent(in) :: b
    !> The vector.
    real(wp) :: direction(dim)
    real(wp), parameter :: turn = 8.0_wp*atan(1.0_wp)
    real(wp) :: angle, z, radius

    angle = turn*random_number_of(seed, a, b, 1_lp)
    radius = 1.0_wp
    if (dim == 3) then
      ! Bands of equal height have equal areas on a sphere.
      z = 2.0_wp*random_number_of(seed, a, b, 2_lp) - 1.0_wp
      radius = sqrt(1.0_wp - z**2)
      direction(3) = z
    end if
    direction(1) = radius*cos(angle)
    direction(2) = radius*sin(angle)
  end function random_direction

end module mpm_hashed_random
