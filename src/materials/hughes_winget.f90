!> Incrementally objective update of an isotropic rate law.
!!
!! With the displacement dt v of a step and its gradient at half of the step,
!!
!!     A = dt L (I + dt L/2)**-1,   e = sym A,   Q = (I - skw A/2)**-1 (I + skw A/2),
!!
!! a rigid rotation dt L = R - I gives e = 0 and Q = R exactly (Hughes and Winget, IJNME 15, 1980).
!! Half of the elastic increment is added before the rotation and half behind it,
!!
!!     T <- Q (T + C:e/2) transpose(Q) + C:e/2,   C:e = lambda tr(e) I + 2 G e,
!!
!! since all of it behind the rotation, as published, is of first order in dt where strain and spin
!! come together.
module mpm_hughes_winget
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_gradient, kinematics_t, type_1d, type_plane_strain
  implicit none
  private
  public :: hughes_winget

contains

  !> Advance the stress of a block of points over one step.
  pure subroutine hughes_winget(kin, n, dt, lambda, shear, gradient, stress, first_bad)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Velocity gradients of the step, in the positions of its start. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(kin%nstress, n)
    !> First point that is turned inside out before half of the step; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: step(3, 3)
    integer :: p
    logical :: good

    do p = 1, n
      select case (kin%sim_type)
      case (type_1d)
        call advance_line(dt*gradient(1, p), lambda, shear, stress(:, p), good)
      case (type_plane_strain)
        call advance_plane(dt*gradient(:, p), lambda, shear, stress(:, p), good)
      case default
        step = dt*expand_gradient(kin, gradient(:, p))
        call advance_full(step, lambda, shear, stress(:, p), good)
      end select
      if (good) cycle
      first_bad = p
      return
    end do
    first_bad = 0
  end subroutine hughes_winget

  !> Uniaxial strain: no rotation.
  pure subroutine advance_line(step, lambda, shear, t, good)
    !> dt L_xx.
    real(wp), intent(in) :: step
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Stress xx yy zz. [Pa]
    real(wp), intent(inout) :: t(3)
    !> Whether there is a state at half of the step.
    logical, intent(out) :: good
    real(wp) :: strain

    good = 1.0_wp + 0.5_wp*step > 0.0_wp
    if (.not. good) return
    strain = step/(1.0_wp + 0.5_wp*step)
    t = t + lambda*strain
    t(1) = t(1) + 2.0_wp*shear*strain
  end subroutine advance_line

  !> Plane strain.
  pure subroutine advance_plane(step, lambda, shear, t, good)
    !> dt L, components xx xy yx yy.
    real(wp), intent(in) :: step(4)
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Stress xx yy zz xy. [Pa]
    real(wp), intent(inout) :: t(4)
    !> Whether there is a state at half of the step.
    logical, intent(out) :: good
    real(wp) :: h(4), det, e(4), half_spin, c, s, mean, difference, half(4)

    h = 0.5_wp*step + [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]
    det = h(1)*h(4) - h(2)*h(3)
    good = det > 0.0_wp
    if (.not. good) return
    ! A = step h**-1
    e(1) = (step(1)*h(4) - step(2)*h(3))/det
    e(2) = (step(4)*h(1) - step(3)*h(2))/det
    e(3) = (step(2)*h(1) - step(1)*h(2))/det
    e(4) = (step(3)*h(4) - step(4)*h(3))/det
    ! The rotation by the angle 2 atan(half_spin) turns the stress by twice as much.
    half_spin = 0.25_wp*(e(4) - e(3))
    c = (1.0_wp - half_spin**2)/(1.0_wp + half_spin**2)
    s = 2.0_wp*half_spin/(1.0_wp + half_spin**2)
    half(3) = 0.5_wp*lambda*(e(1) + e(2))
    half(1:2) = half(3) + shear*e(1:2)
    half(4) = 0.5_wp*shear*(e(3) + e(4))
    t = t + half
    mean = 0.5_wp*(t(1) + t(2))
    difference = 0.5_wp*(t(1) - t(2))
    t(1) = (c*c - s*s)*difference - 2.0_wp*s*c*t(4)
    t(4) = (c*c - s*s)*t(4) + 2.0_wp*s*c*difference
    t(2) = mean - t(1)
    t(1) = mean + t(1)
    t = t + half
  end subroutine advance_plane

  !> All components.
  pure subroutine advance_full(step, lambda, shear, t, good)
    !> dt L.
    real(wp), intent(in) :: step(3, 3)
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Stress xx yy zz xy yz zx. [Pa]
    real(wp), intent(inout) :: t(6)
    !> Whether there is a state at half of the step.
    logical, intent(out) :: good
    real(wp) :: h(3, 3), inverse(3, 3), det, a(3, 3), q(3, 3), half(3, 3), full(3, 3), sphere
    integer :: i

    h = 0.5_wp*step
    do i = 1, 3
      h(i, i) = h(i, i) + 1.0_wp
    end do
    inverse(:, 1) = [h(2, 2)*h(3, 3) - h(2, 3)*h(3, 2), h(2, 3)*h(3, 1) - h(2, 1)*h(3, 3), &
                     h(2, 1)*h(3, 2) - h(2, 2)*h(3, 1)]
    inverse(:, 2) = [h(3, 2)*h(1, 3) - h(3, 3)*h(1, 2), h(3, 3)*h(1, 1) - h(3, 1)*h(1, 3), &
                     h(3, 1)*h(1, 2) - h(3, 2)*h(1, 1)]
    inverse(:, 3) = [h(1, 2)*h(2, 3) - h(1, 3)*h(2, 2), h(1, 3)*h(2, 1) - h(1, 1)*h(2, 3), &
                     h(1, 1)*h(2, 2) - h(1, 2)*h(2, 1)]
    det = dot_product(h(1, :), inverse(:, 1))
    good = det > 0.0_wp
    if (.not. good) return
    a = matmul(step, inverse)/det
    call cayley(0.25_wp*(a - transpose(a)), q)
    half = 0.5_wp*shear*(a + transpose(a))
    sphere = 0.5_wp*lambda*(a(1, 1) + a(2, 2) + a(3, 3))
    do i = 1, 3
      half(i, i) = half(i, i) + sphere
    end do
    full = half + reshape([t(1), t(4), t(6), t(4), t(2), t(5), t(6), t(5), t(3)], [3, 3])
    full = half + matmul(q, matmul(full, transpose(q)))
    t = [full(1, 1), full(2, 2), full(3, 3), full(1, 2), full(2, 3), full(3, 1)]
  end subroutine advance_full

  !> The rotation (I - B)**-1 (I + B) = I + 2 (B + B**2)/(1 + b.b) of a skew B, b its axial vector.
  pure subroutine cayley(b, q)
    !> Skew tensor.
    real(wp), intent(in) :: b(3, 3)
    !> Rotation.
    real(wp), intent(out) :: q(3, 3)
    integer :: i

    q = b + matmul(b, b)
    q = q*(2.0_wp/(1.0_wp + b(3, 2)**2 + b(1, 3)**2 + b(2, 1)**2))
    do i = 1, 3
      q(i, i) = q(i, i) + 1.0_wp
    end do
  end subroutine cayley

end module mpm_hughes_winget
