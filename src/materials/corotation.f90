!> What rate laws of isotropic materials share: strains, rotations, pressure and shear stress.
!!
!! A step takes L as constant. The stress turns by the spin of the step before its strain,
!!
!!     T* = Q T transpose(Q) + dt C:D  -> law -> T,   Q = (I - dt W/2)**-1 (I + dt W/2),
!!
!! which keeps all invariants under spin, for steps of any length, and gives the direction of the
!! stress in a steady shear flow exactly: with q = tau/G, T_xy = tau sqrt(1 - q**2) and
!! T_xx = -p + q tau. Elastic strains that turn as they grow are of first order in dt.
module mpm_corotation
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_1d, type_3d, type_axisymmetric, type_out_of_plane, &
                            type_plane_strain
  implicit none
  private
  public :: add_strain, elastic_energy, first_not_finite, invariants, rates_by_component, rebuild
  public :: shear_rates, spin_stress, strain_rates, trial_stress, width

  !> Points that lie component by component at a time.
  integer, parameter :: width = 128

contains

  !> Trial stresses of a step, T* = Q T transpose(Q) + dt C:D, their pressures and shear stresses.
  pure subroutine trial_stress(kin, n, dt, lambda, shear, gradient, stress, pressure, tau)
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
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(kin%nstress, n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(out) :: pressure(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)

    if (kin%sim_type == type_3d) then
      call trial_stress_3d(n, dt, lambda, shear, gradient, stress, pressure, tau)
    else
      call spin_stress(kin, n, dt, gradient, stress)
      call add_strain(kin, n, dt, lambda, shear, gradient, stress)
      call invariants(kin%nstress, n, stress, pressure, tau)
    end if
  end subroutine trial_stress

  !> Trial stresses in 3D, so many points at a time that they lie component by component in scratch
  !> of a fixed size.
  pure subroutine trial_stress_3d(n, dt, lambda, shear, gradient, stress, pressure, tau)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Velocity gradients. [1/s] (9, n)
    real(wp), intent(in) :: gradient(9, n)
    !> Stresses. [Pa] (6, n)
    real(wp), intent(inout) :: stress(6, n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(out) :: pressure(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)
    real(wp) :: g(width, 9), t(width, 6)
    integer :: first, m, i, p

    do first = 1, n, width
      m = min(width, n - first + 1)
      do i = 1, m
        p = first + i - 1
        g(i, :) = gradient(:, p)
        t(i, :) = stress(:, p)
      end do
      call turn_and_strain(m, dt, lambda, shear, g, t, pressure(first), tau(first))
      do i = 1, m
        p = first + i - 1
        stress(:, p) = t(i, :)
      end do
    end do
  end subroutine trial_stress_3d

  !> Trial stresses of points that lie component by component.
  pure subroutine turn_and_strain(n, dt, lambda, shear, g, t, pressure, tau)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Velocity gradients xx xy xz yx yy yz zx zy zz. [1/s]
    real(wp), intent(in) :: g(width, 9)
    !> Stresses xx yy zz xy yz zx. [Pa]
    real(wp), intent(inout) :: t(width, 6)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(out) :: pressure(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)
    real(wp) :: h, g1, g2, x, y, z, f, xx, yy, zz, xy, yx, yz, zy, zx, xz, sphere
    real(wp) :: s1, s2, s3, s4, s5, s6, m11, m12, m13, m21, m22, m23, m31, m32, m33
    integer :: p

    h = 0.25_wp*dt
    g1 = dt*shear
    g2 = 2.0_wp*g1
    do p = 1, n
      ! As in `turn`.
      x = h*(g(p, 8) - g(p, 6))
      y = h*(g(p, 3) - g(p, 7))
      z = h*(g(p, 4) - g(p, 2))
      f = 2.0_wp/(1.0_wp + (x*x + y*y + z*z))
      xx = 1.0_wp - f*(y*y + z*z)
      yy = 1.0_wp - f*(z*z + x*x)
      zz = 1.0_wp - f*(x*x + y*y)
      xy = f*(x*y - z)
      yx = f*(x*y + z)
      yz = f*(y*z - x)
      zy = f*(y*z + x)
      zx = f*(z*x - y)
      xz = f*(z*x + y)
      m11 = xx*t(p, 1) + xy*t(p, 4) + xz*t(p, 6)
      m21 = yx*t(p, 1) + yy*t(p, 4) + yz*t(p, 6)
      m31 = zx*t(p, 1) + zy*t(p, 4) + zz*t(p, 6)
      m12 = xx*t(p, 4) + xy*t(p, 2) + xz*t(p, 5)
      m22 = yx*t(p, 4) + yy*t(p, 2) + yz*t(p, 5)
      m32 = zx*t(p, 4) + zy*t(p, 2) + zz*t(p, 5)
      m13 = xx*t(p, 6) + xy*t(p, 5) + xz*t(p, 3)
      m23 = yx*t(p, 6) + yy*t(p, 5) + yz*t(p, 3)
      m33 = zx*t(p, 6) + zy*t(p, 5) + zz*t(p, 3)
      sphere = dt*lambda*(g(p, 1) + g(p, 5) + g(p, 9))
      s1 = m11*xx + m12*xy + m13*xz + (sphere + g2*g(p, 1))
      s2 = m21*yx + m22*yy + m23*yz + (sphere + g2*g(p, 5))
      s3 = m31*zx + m32*zy + m33*zz + (sphere + g2*g(p, 9))
      s4 = m11*yx + m12*yy + m13*yz + g1*(g(p, 2) + g(p, 4))
      s5 = m21*zx + m22*zy + m23*zz + g1*(g(p, 6) + g(p, 8))
      s6 = m11*zx + m12*zy + m13*zz + g1*(g(p, 3) + g(p, 7))
      f = -(s1 + s2 + s3)/3.0_wp
      pressure(p) = f
      tau(p) = sqrt(0.5_wp*((s1 + f)**2 + (s2 + f)**2 + (s3 + f)**2) + s4**2 + s5**2 + s6**2)
      t(p, 1) = s1
      t(p, 2) = s2
      t(p, 3) = s3
      t(p, 4) = s4
      t(p, 5) = s5
      t(p, 6) = s6
    end do
  end subroutine turn_and_strain

  !> T += dt C:D, and the traces of D.
  pure subroutine add_strain(kin, n, dt, lambda, shear, gradient, stress)
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
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(kin%nstress, n)
    real(wp) :: sphere, g2, d(6)
    integer :: p

    g2 = 2.0_wp*dt*shear
    select case (kin%sim_type)
    case (type_1d)
      do p = 1, n
        stress(1:3, p) = stress(1:3, p) + dt*lambda*gradient(1, p)
        stress(1, p) = stress(1, p) + g2*gradient(1, p)
      end do
    case (type_plane_strain)
      do p = 1, n
        sphere = dt*lambda*(gradient(1, p) + gradient(4, p))
        stress(1, p) = stress(1, p) + sphere + g2*gradient(1, p)
        stress(2, p) = stress(2, p) + sphere + g2*gradient(4, p)
        stress(3, p) = stress(3, p) + sphere
        stress(4, p) = stress(4, p) + 0.5_wp*g2*(gradient(2, p) + gradient(3, p))
      end do
    case default
      do p = 1, n
        call stretching(kin%sim_type, gradient(:, p), d)
        stress(:, p) = stress(:, p) + g2*d
        stress(1:3, p) = stress(1:3, p) + dt*lambda*(d(1) + d(2) + d(3))
      end do
    end select
  end subroutine add_strain

  !> D as stored stress components times a factor, and its traces.
  pure subroutine strain_rates(kin, n, factor, gradient, rate, trace)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Factor.
    real(wp), intent(in) :: factor
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> factor D. (nstress, n)
    real(wp), intent(out) :: rate(kin%nstress, n)
    !> tr D. [1/s] (n)
    real(wp), intent(out) :: trace(n)
    real(wp) :: d(6)
    integer :: p

    select case (kin%sim_type)
    case (type_1d)
      do p = 1, n
        rate(1, p) = factor*gradient(1, p)
        rate(2:3, p) = 0.0_wp
        trace(p) = gradient(1, p)
      end do
    case (type_plane_strain)
      do p = 1, n
        rate(1, p) = factor*gradient(1, p)
        rate(2, p) = factor*gradient(4, p)
        rate(3, p) = 0.0_wp
        rate(4, p) = 0.5_wp*factor*(gradient(2, p) + gradient(3, p))
        trace(p) = gradient(1, p) + gradient(4, p)
      end do
    case (type_3d)
      ! As in `stretching`, whose choice of the TYPE and copies would cost more than the sums.
      do p = 1, n
        rate(1, p) = factor*gradient(1, p)
        rate(2, p) = factor*gradient(5, p)
        rate(3, p) = factor*gradient(9, p)
        rate(4, p) = 0.5_wp*factor*(gradient(2, p) + gradient(4, p))
        rate(5, p) = 0.5_wp*factor*(gradient(6, p) + gradient(8, p))
        rate(6, p) = 0.5_wp*factor*(gradient(3, p) + gradient(7, p))
        trace(p) = gradient(1, p) + gradient(5, p) + gradient(9, p)
      end do
    case default
      do p = 1, n
        call stretching(kin%sim_type, gradient(:, p), d)
        rate(:, p) = factor*d
        trace(p) = d(1) + d(2) + d(3)
      end do
    end select
  end subroutine strain_rates

  !> D of at most `width` points component by component, and its traces; 0 behind the last point.
  pure subroutine rates_by_component(kin, n, gradient, rate, trace)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> D, xx yy zz xy yz zx, 0 where the TYPE has none. [1/s]
    real(wp), intent(out) :: rate(width, 6)
    !> tr D. [1/s]
    real(wp), intent(out) :: trace(width)
    real(wp) :: d(6)
    integer :: p

    rate(n + 1:, :) = 0.0_wp
    select case (kin%sim_type)
    case (type_1d)
      rate = 0.0_wp
      do p = 1, n
        rate(p, 1) = gradient(1, p)
      end do
    case (type_plane_strain)
      rate = 0.0_wp
      do p = 1, n
        rate(p, 1) = gradient(1, p)
        rate(p, 2) = gradient(4, p)
        rate(p, 4) = 0.5_wp*(gradient(2, p) + gradient(3, p))
      end do
    case (type_3d)
      call rates_3d(n, gradient, rate)
    case default
      do p = 1, n
        call stretching(kin%sim_type, gradient(:, p), d)
        rate(p, :) = d
      end do
    end select
    do p = 1, width
      trace(p) = rate(p, 1) + rate(p, 2) + rate(p, 3)
    end do
  end subroutine rates_by_component

  !> D in 3D component by component.
  pure subroutine rates_3d(n, gradient, rate)
    !> Number of points.
    integer, intent(in) :: n
    !> Velocity gradients. [1/s] (9, n)
    real(wp), intent(in) :: gradient(9, n)
    !> D, xx yy zz xy yz zx. [1/s]
    real(wp), intent(out) :: rate(width, 6)
    integer :: p

    do p = 1, n
      rate(p, 1) = gradient(1, p)
      rate(p, 2) = gradient(5, p)
      rate(p, 3) = gradient(9, p)
      rate(p, 4) = 0.5_wp*(gradient(2, p) + gradient(4, p))
      rate(p, 5) = 0.5_wp*(gradient(6, p) + gradient(8, p))
      rate(p, 6) = 0.5_wp*(gradient(3, p) + gradient(7, p))
    end do
  end subroutine rates_3d

  !> Shear rates sqrt(2 D':D').
  pure subroutine shear_rates(kin, n, gradient, rate)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Shear rates. [1/s] (n)
    real(wp), intent(out) :: rate(n)
    real(wp) :: d(kin%nstress, n), trace(n)

    call strain_rates(kin, n, 1.0_wp, gradient, d, trace)
    call invariants(kin%nstress, n, d, trace, rate)
    rate = 2.0_wp*rate
  end subroutine shear_rates

  !> The six components of D in the TYPEs that have them all.
  pure subroutine stretching(sim_type, g, d)
    !> Simulation TYPE: 3, 4 or 5.
    integer, intent(in) :: sim_type
    !> Stored velocity gradient. [1/s] (ngrad)
    real(wp), intent(in) :: g(:)
    !> Components xx yy zz xy yz zx. [1/s]
    real(wp), intent(out) :: d(6)

    select case (sim_type)
    case (type_out_of_plane)
      d = [g(1), g(4), 0.0_wp, 0.5_wp*(g(2) + g(3)), 0.5_wp*g(6), 0.5_wp*g(5)]
    case (type_axisymmetric)
      d = [g(1), g(4), g(8), 0.5_wp*(g(2) + g(3)), 0.5_wp*g(6), 0.5_wp*(g(5) + g(7))]
    case default
      d = [g(1), g(5), g(9), 0.5_wp*(g(2) + g(4)), 0.5_wp*(g(6) + g(8)), 0.5_wp*(g(3) + g(7))]
    end select
  end subroutine stretching

  !> Turn stresses by the rotation of a step.
  pure subroutine spin_stress(kin, n, dt, gradient, stress)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(kin%nstress, n)
    real(wp) :: w, c, s, mean, difference, b(3), h
    integer :: p

    h = 0.25_wp*dt
    select case (kin%sim_type)
    case (type_1d)
    case (type_plane_strain)
      do p = 1, n
        ! The rotation by 2 atan(w) turns the stress by twice as much.
        w = h*(gradient(3, p) - gradient(2, p))
        c = (1.0_wp - w*w)/(1.0_wp + w*w)
        s = 2.0_wp*w/(1.0_wp + w*w)
        mean = 0.5_wp*(stress(1, p) + stress(2, p))
        difference = 0.5_wp*(stress(1, p) - stress(2, p))
        w = (c*c - s*s)*difference - 2.0_wp*s*c*stress(4, p)
        stress(4, p) = (c*c - s*s)*stress(4, p) + 2.0_wp*s*c*difference
        stress(1, p) = mean + w
        stress(2, p) = mean - w
      end do
    case (type_out_of_plane)
      do p = 1, n
        associate (g => gradient(:, p))
          b = h*[g(6), -g(5), g(3) - g(2)]
        end associate
        call turn(b, stress(:, p))
      end do
    case (type_axisymmetric)
      do p = 1, n
        associate (g => gradient(:, p))
          b = h*[g(6), g(7) - g(5), g(3) - g(2)]
        end associate
        call turn(b, stress(:, p))
      end do
    case default
      do p = 1, n
        associate (g => gradient(:, p))
          b = h*[g(8) - g(6), g(3) - g(7), g(4) - g(2)]
        end associate
        call turn(b, stress(:, p))
      end do
    end select
  end subroutine spin_stress

  !> T <- Q T transpose(Q) with Q = I + 2 (B + B**2)/(1 + b.b), b the axial vector of the skew B.
  pure subroutine turn(b, t)
    !> Axial vector.
    real(wp), intent(in) :: b(3)
    !> Stress xx yy zz xy yz zx. [Pa]
    real(wp), intent(inout) :: t(6)
    real(wp) :: q(3, 3), m(3, 3), f, bb

    bb = b(1)**2 + b(2)**2 + b(3)**2
    if (.not. bb > 0.0_wp) return
    f = 2.0_wp/(1.0_wp + bb)
    q(1, 1) = 1.0_wp - f*(b(2)**2 + b(3)**2)
    q(2, 2) = 1.0_wp - f*(b(3)**2 + b(1)**2)
    q(3, 3) = 1.0_wp - f*(b(1)**2 + b(2)**2)
    q(1, 2) = f*(b(1)*b(2) - b(3))
    q(2, 1) = f*(b(1)*b(2) + b(3))
    q(2, 3) = f*(b(2)*b(3) - b(1))
    q(3, 2) = f*(b(2)*b(3) + b(1))
    q(3, 1) = f*(b(3)*b(1) - b(2))
    q(1, 3) = f*(b(3)*b(1) + b(2))
    ! M = Q T
    m(:, 1) = q(:, 1)*t(1) + q(:, 2)*t(4) + q(:, 3)*t(6)
    m(:, 2) = q(:, 1)*t(4) + q(:, 2)*t(2) + q(:, 3)*t(5)
    m(:, 3) = q(:, 1)*t(6) + q(:, 2)*t(5) + q(:, 3)*t(3)
    t(1) = m(1, 1)*q(1, 1) + m(1, 2)*q(1, 2) + m(1, 3)*q(1, 3)
    t(2) = m(2, 1)*q(2, 1) + m(2, 2)*q(2, 2) + m(2, 3)*q(2, 3)
    t(3) = m(3, 1)*q(3, 1) + m(3, 2)*q(3, 2) + m(3, 3)*q(3, 3)
    t(4) = m(1, 1)*q(2, 1) + m(1, 2)*q(2, 2) + m(1, 3)*q(2, 3)
    t(5) = m(2, 1)*q(3, 1) + m(2, 2)*q(3, 2) + m(2, 3)*q(3, 3)
    t(6) = m(1, 1)*q(3, 1) + m(1, 2)*q(3, 2) + m(1, 3)*q(3, 3)
  end subroutine turn

  !> Pressures p = -tr T/3 and shear stresses tau = sqrt(s:s/2), s the deviator.
  pure subroutine invariants(nstress, n, stress, pressure, tau)
    !> Components of a stress.
    integer, intent(in) :: nstress
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(nstress, n)
    !> Pressures. [Pa] (n)
    real(wp), intent(out) :: pressure(n)
    !> Shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)
    real(wp) :: m
    integer :: p

    select case (nstress)
    case (3)
      do p = 1, n
        m = -(stress(1, p) + stress(2, p) + stress(3, p))/3.0_wp
        pressure(p) = m
        tau(p) = sqrt(0.5_wp*((stress(1, p) + m)**2 + (stress(2, p) + m)**2 &
                              + (stress(3, p) + m)**2))
      end do
    case (4)
      do p = 1, n
        m = -(stress(1, p) + stress(2, p) + stress(3, p))/3.0_wp
        pressure(p) = m
        tau(p) = sqrt(0.5_wp*((stress(1, p) + m)**2 + (stress(2, p) + m)**2 &
                              + (stress(3, p) + m)**2) + stress(4, p)**2)
      end do
    case default
      do p = 1, n
        m = -(stress(1, p) + stress(2, p) + stress(3, p))/3.0_wp
        pressure(p) = m
        tau(p) = sqrt(0.5_wp*((stress(1, p) + m)**2 + (stress(2, p) + m)**2 &
                              + (stress(3, p) + m)**2) &
                      + stress(4, p)**2 + stress(5, p)**2 + stress(6, p)**2)
      end do
    end select
  end subroutine invariants

  !> Give stresses another pressure and a multiple of their deviator.
  pure subroutine rebuild(nstress, n, before, factor, pressure, stress)
    !> Components of a stress.
    integer, intent(in) :: nstress
    !> Number of points.
    integer, intent(in) :: n
    !> Pressures of the stresses on entry. [Pa] (n)
    real(wp), intent(in) :: before(n)
    !> What multiplies the deviator. (n)
    real(wp), intent(in) :: factor(n)
    !> New pressures. [Pa] (n)
    real(wp), intent(in) :: pressure(n)
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(nstress, n)
    integer :: p

    do p = 1, n
      stress(1:3, p) = factor(p)*(stress(1:3, p) + before(p)) - pressure(p)
    end do
    if (nstress == 4) then
      stress(4, :) = factor*stress(4, :)
    else if (nstress == 6) then
      do p = 1, n
        stress(4:6, p) = factor(p)*stress(4:6, p)
      end do
    end if
  end subroutine rebuild

  !> Sum of V (s:s/(4 G) + p**2/(2 K)), s the deviator, p the pressure.
  pure function elastic_energy(nstress, n, lambda, shear, volume, stress) result(energy)
    !> Components of a stress.
    integer, intent(in) :: nstress
    !> Number of points.
    integer, intent(in) :: n
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(nstress, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    real(wp) :: pressure(n), tau(n)

    call invariants(nstress, n, stress, pressure, tau)
    energy = sum(volume*(tau**2/(2.0_wp*shear) &
                         + pressure**2/(2.0_wp*(lambda + 2.0_wp*shear/3.0_wp))))
  end function elastic_energy

  !> First point with a stress that is not finite; 0 when there is none.
  pure function first_not_finite(nstress, n, stress) result(first)
    !> Components of a stress.
    integer, intent(in) :: nstress
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(nstress, n)
    !> The point.
    integer :: first
    integer :: p

    first = 0
    if (all_finite(nstress*n, stress)) return
    do p = n, 1, -1
      if (any(.not. abs(stress(:, p)) <= huge(1.0_wp))) first = p
    end do
  end function first_not_finite

  !> Whether all of so many numbers are finite.
  pure function all_finite(n, x) result(finite)
    !> Number of numbers.
    integer, intent(in) :: n
    !> The numbers. (n)
    real(wp), intent(in) :: x(n)
    !> Whether they are finite.
    logical :: finite

    finite = count(.not. abs(x) <= huge(1.0_wp)) == 0
  end function all_finite

end module mpm_corotation
