!> Logarithm, exponential and sine of many numbers at a time.
!!
!! Those of the run-time library take one number. These are loops without branches, from which the
!! compiler makes vector instructions; their errors are a few units in the last place. They are for
!! `real64`, whose bits are 1 of sign, 11 of exponent and 52 of fraction.
module mpm_elementary
  use, intrinsic :: iso_fortran_env, only: int64
  use mpm_kinds, only: wp
  implicit none
  private
  public :: exponentials, log_remainders, logarithms, sines

  !> Bits of 1 and of the square root of 1/2.
  integer(int64), parameter :: one_bits = transfer(1.0_wp, 0_int64)
  integer(int64), parameter :: half_bits = transfer(sqrt(0.5_wp), 0_int64)
  !> Bits of the fraction, and what is added to an exponent.
  integer, parameter :: fraction_bits = 52
  integer(int64), parameter :: bias = 1023_int64
  !> A number, 1.5*2**52, whose last bit is 1: what is added to it is rounded to an integer.
  real(wp), parameter :: whole = 1.5_wp*2.0_wp**fraction_bits
  integer(int64), parameter :: whole_bits = transfer(whole, 0_int64)
  !> ln 2: its first 40 bits, whose products with exponents are exact, and the rest.
  real(wp), parameter :: ln2_high = aint(log(2.0_wp)*2.0_wp**40)/2.0_wp**40
  real(wp), parameter :: ln2_low = 7.37100256516779e-13_wp
  !> Largest size of an argument of `exponentials`; beyond it the result is that of the end.
  real(wp), parameter :: longest = 700.0_wp

  !> 1/k!.
  real(wp), parameter :: over(0:21) = [1.0_wp, 1.0_wp, 1.0_wp/2.0_wp, 1.0_wp/6.0_wp, &
                                       1.0_wp/24.0_wp, 1.0_wp/120.0_wp, 1.0_wp/720.0_wp, &
                                       1.0_wp/5040.0_wp, 1.0_wp/40320.0_wp, 1.0_wp/362880.0_wp, &
                                       1.0_wp/3628800.0_wp, 1.0_wp/39916800.0_wp, &
                                       1.0_wp/479001600.0_wp, 1.0_wp/6227020800.0_wp, &
                                       1.0_wp/87178291200.0_wp, 1.0_wp/1307674368000.0_wp, &
                                       1.0_wp/20922789888000.0_wp, 1.0_wp/355687428096000.0_wp, &
                                       1.0_wp/6402373705728000.0_wp, &
                                       1.0_wp/121645100408832000.0_wp, &
                                       1.0_wp/2432902008176640000.0_wp, &
                                       1.0_wp/51090942171709440000.0_wp]

contains

  !> ln x: of x = 2**k m with m from sqrt(1/2) to sqrt(2).
  pure subroutine logarithms(n, x, y)
    !> How many.
    integer, intent(in) :: n
    !> Numbers from `tiny` to `huge`. (n)
    real(wp), intent(in) :: x(n)
    !> Logarithms. (n)
    real(wp), intent(out) :: y(n)
    integer(int64) :: bits, twos
    real(wp) :: f, k, s
    integer :: i

    do i = 1, n
      bits = transfer(x(i), bits)
      twos = shiftr(bits + (one_bits - half_bits), fraction_bits)
      k = transfer(twos + (whole_bits - bias), k) - whole
      f = transfer(bits - shiftl(twos - bias, fraction_bits), f) - 1.0_wp
      s = f/(2.0_wp + f)
      y(i) = k*ln2_high + (f - (s*(f - 2.0_wp*s*s*tail(s*s)) - k*ln2_low))
    end do
  end subroutine logarithms

  !> z - ln(1 + z), without the loss of digits of small z.
  !!
  !! With f = 1 + z over a power of two, less 1, and s = f/(2 + f), f - ln(1 + f) is
  !! s f - 2 (s**3/3 + s**5/5 ...).
  pure subroutine log_remainders(n, z, y)
    !> How many.
    integer, intent(in) :: n
    !> Numbers, at least 0. (n)
    real(wp), intent(in) :: z(n)
    !> Remainders. (n)
    real(wp), intent(out) :: y(n)
    integer(int64) :: bits, twos
    real(wp) :: f, k, s, kept
    integer :: i

    do i = 1, n
      bits = transfer(1.0_wp + z(i), bits)
      twos = shiftr(bits + (one_bits - half_bits), fraction_bits)
      k = transfer(twos + (whole_bits - bias), k) - whole
      f = transfer(bits - shiftl(twos - bias, fraction_bits), f) - 1.0_wp
      ! As a product: with a condition the loop has a branch. 1 where k is 0.
      kept = 0.5_wp + sign(0.5_wp, 0.25_wp - k*k)
      f = kept*z(i) + (1.0_wp - kept)*f
      s = f/(2.0_wp + f)
      y(i) = ((z(i) - k*ln2_high) - f) - k*ln2_low + s*(f - 2.0_wp*s*s*tail(s*s))
    end do
  end subroutine log_remainders

  !> 1/3 + t/5 + t**2/7 ...; the first term left out is less than 2**-55 at the largest t, 0.0295.
  elemental function tail(t) result(value)
    !> The square of s.
    real(wp), intent(in) :: t
    !> The sum.
    real(wp) :: value

    value = 1.0_wp/17.0_wp + t*(1.0_wp/19.0_wp + t*(1.0_wp/21.0_wp))
    value = 1.0_wp/11.0_wp + t*(1.0_wp/13.0_wp + t*(1.0_wp/15.0_wp + t*value))
    value = 1.0_wp/3.0_wp + t*(1.0_wp/5.0_wp + t*(1.0_wp/7.0_wp + t*(1.0_wp/9.0_wp + t*value)))
  end function tail

  !> exp(x): of x = k ln 2 + r with r from -ln(2)/2 to ln(2)/2.
  !!
  !! The series of exp(r) ends where the next term is less than 2**-57.
  pure subroutine exponentials(n, x, y)
    !> How many.
    integer, intent(in) :: n
    !> Numbers from -700 to 700. (n)
    real(wp), intent(in) :: x(n)
    !> Exponentials. (n)
    real(wp), intent(out) :: y(n)
    real(wp), parameter :: per_two = 1.0_wp/log(2.0_wp)
    integer(int64) :: bits
    real(wp) :: k, p, r
    integer :: i, m

    do i = 1, n
      r = max(-longest, min(longest, x(i)))
      p = r*per_two + whole
      bits = transfer(p, bits)
      k = p - whole
      r = (r - k*ln2_high) - k*ln2_low
      p = over(12) + r*over(13)
      do m = 11, 0, -1
        p = over(m) + r*p
      end do
      y(i) = transfer(transfer(p, bits) + shiftl(bits, fraction_bits), p)
    end do
  end subroutine exponentials

  !> sin(x): its series ends where the next term is less than 2**-59 at a right angle.
  pure subroutine sines(n, x, y)
    !> How many.
    integer, intent(in) :: n
    !> Angles, at most a right angle to either side. (n)
    real(wp), intent(in) :: x(n)
    !> Sines. (n)
    real(wp), intent(out) :: y(n)
    real(wp) :: p, t
    integer :: i, m

    do i = 1, n
      t = -x(i)*x(i)
      p = over(19) + t*over(21)
      do m = 17, 3, -2
        p = over(m) + t*p
      end do
      y(i) = x(i) + x(i)*(t*p)
    end do
  end subroutine sines

end module mpm_elementary
