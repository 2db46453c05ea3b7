!> Tensors that a motion carries along: B <- f B transpose(f) with f = exp(dt L), for many points.
module mpm_push_forward
  use mpm_deformation, only: exponential, largest_step, small_exponentials, unpack_gradients
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_gradient, kinematics_t
  implicit none
  private
  public :: push_forward

contains

  !> B <- exp(dt L) B transpose(exp(dt L)) of a block of points.
  !!
  !! Points of steps too long for the series are moved one by one.
  pure subroutine push_forward(kin, n, dt, gradient, rows, b, trace, good)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Rows of `b`, at least `n`.
    integer, intent(in) :: rows
    !> Symmetric tensors, components xx yy zz xy yz zx. (rows, 6)
    real(wp), intent(inout) :: b(rows, 6)
    !> dt tr L. (n)
    real(wp), intent(out) :: trace(n)
    !> Whether the step is one of a body; where it is not, B stays. (n)
    logical, intent(out) :: good(n)
    real(wp) :: l(n, 3, 3), e(n, 3, 3), one(3, 3), before(6)
    logical :: small(n)
    integer :: p

    call unpack_gradients(kin, n, dt, gradient, l)
    trace = l(:, 1, 1) + l(:, 2, 2) + l(:, 3, 3)
    call small_exponentials(n, l, e, small)
    call transform(n, e, rows, b)
    good = .true.
    if (all(small)) return
    do p = 1, n
      if (small(p)) cycle
      one = dt*expand_gradient(kin, gradient(:, p))
      good(p) = all(abs(one) <= largest_step)
      before = b(p, :)
      if (good(p)) b(p, :) = alone(one, before)
    end do
  end subroutine push_forward

  !> f B transpose(f) of one point.
  pure function alone(step, b) result(moved)
    !> dt L.
    real(wp), intent(in) :: step(3, 3)
    !> B, components xx yy zz xy yz zx.
    real(wp), intent(in) :: b(6)
    !> The product.
    real(wp) :: moved(6)
    real(wp) :: f(3, 3), t(3, 3)

    call exponential(step, f)
    t = reshape([b(1), b(4), b(6), b(4), b(2), b(5), b(6), b(5), b(3)], [3, 3])
    t = matmul(f, matmul(t, transpose(f)))
    moved = [t(1, 1), t(2, 2), t(3, 3), t(1, 2), t(2, 3), t(3, 1)]
  end function alone

  !> (1 + e) B transpose(1 + e) = B + e B + B transpose(e) + e B transpose(e).
  pure subroutine transform(n, e, rows, b)
    !> Number of points.
    integer, intent(in) :: n
    !> Small tensors. (n, 3, 3)
    real(wp), intent(in) :: e(n, 3, 3)
    !> Rows of `b`, at least `n`.
    integer, intent(in) :: rows
    !> B. (rows, 6)
    real(wp), intent(inout) :: b(rows, 6)
    integer, parameter :: i_of(6) = [1, 2, 3, 1, 2, 3], j_of(6) = [1, 2, 3, 2, 3, 1]
    integer, parameter :: at(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
    real(wp) :: g(n, 3, 3)
    integer :: c, i, j, p

    do j = 1, 3
      do i = 1, 3
        do p = 1, n
          g(p, i, j) = e(p, i, 1)*b(p, at(1, j)) + e(p, i, 2)*b(p, at(2, j)) &
                       + e(p, i, 3)*b(p, at(3, j))
        end do
      end do
    end do
    do c = 1, 6
      i = i_of(c)
      j = j_of(c)
      do p = 1, n
        b(p, c) = b(p, c) + ((g(p, i, j) + g(p, j, i)) &
                             + (g(p, i, 1)*e(p, j, 1) + g(p, i, 2)*e(p, j, 2) &
                                + g(p, i, 3)*e(p, j, 3)))
      end do
    end do
  end subroutine transform

end module mpm_push_forward
