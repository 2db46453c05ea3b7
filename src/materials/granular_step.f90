!> A step of grains in a fluid: its constants, and the solutions that are known in closed form.
!!
!! The laws are those of `mpm_granular_flow`. All loops are over many points, without branches.
module mpm_granular_step
  use mpm_kinds, only: wp
  implicit none
  private
  public :: granular_step_t, rest_and_compact, rest_or_pull, suspend_in_step, width

  !> Points at a time.
  integer, parameter :: width = 128
  !> Shear stress that stays as it is: ahead of waves there are stresses whose squares are 0. [Pa]
  real(wp), parameter :: least_shear = 1.0e-120_wp
  !> Least distance of a packing from the critical one.
  real(wp), parameter :: nothing = 1.0e-20_wp

  !> Constants of a law over a step.
  type :: granular_step_t
    !> Shear modulus times the step, G dt. [Pa s]
    real(wp) :: shear = 0.0_wp
    !> Bulk modulus times the step, K dt. [Pa s]
    real(wp) :: bulk = 0.0_wp
    !> Static friction mu_1.
    real(wp) :: friction = 0.0_wp
    !> mu_2 - mu_1.
    real(wp) :: rise = 0.0_wp
    !> Scale b of the friction law.
    real(wp) :: inertial = 0.0_wp
    !> Dilation K_3.
    real(wp) :: dilation = 0.0_wp
    !> rho_s d**2. [kg/m]
    real(wp) :: inertia = 0.0_wp
    !> Compaction over the bulk modulus times the step, K_4/(K dt). [1/(Pa s)]
    real(wp) :: compaction = 0.0_wp
  end type granular_step_t

contains

  !> Find the points within their static strength, and those that no flow brings to a pressure.
  pure subroutine rest_or_pull(step, n, critical, gate, phi, p_trial, tau_trial, rate, p, found)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: n
    !> Critical packing fractions. (n)
    real(wp), intent(in) :: critical(n)
    !> Packing fractions from which grains carry pressure at rest. (n)
    real(wp), intent(in) :: gate(n)
    !> Packing fractions. (n)
    real(wp), intent(in) :: phi(n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(in) :: p_trial(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau_trial(n)
    !> Plastic shear rates. [1/s] (n)
    real(wp), intent(out) :: rate(n)
    !> Pressures. [Pa] (n)
    real(wp), intent(out) :: p(n)
    !> 1 for these points, 0 for others. (n)
    real(wp), intent(out) :: found(n)
    real(wp) :: over(width), pull(width)
    integer :: i

    do i = 1, n
      p(i) = max(0.0_wp, p_trial(i))
      over(i) = tau_trial(i) &
                - max(0.0_wp, step%friction + step%dilation*(phi(i) - critical(i)))*p(i)
      rate(i) = tau_trial(i)/step%shear
      ! The largest pressure of any flow.
      pull(i) = p_trial(i) + step%bulk*step%dilation*phi(i)*rate(i)
    end do
    do i = 1, n
      p(i) = merge(p(i), 0.0_wp, phi(i) >= gate(i))
      over(i) = merge(over(i), tau_trial(i), phi(i) >= gate(i))
      over(i) = merge(over(i), 0.0_wp, tau_trial(i) > least_shear)
      found(i) = merge(1.0_wp, 0.0_wp, over(i) <= 0.0_wp .or. pull(i) <= 0.0_wp)
      rate(i) = merge(0.0_wp, rate(i), over(i) <= 0.0_wp)
    end do
  end subroutine rest_or_pull

  !> Find suspended points among those that are not found: their flow carries the pressure,
  !> p = (a phi/(phi_m - phi))**2 c**2.
  !!
  !! There beta is 0, and the balance of shear a quadratic equation. It is the solution where the
  !! free pressure of this rate is not lower.
  pure subroutine suspend_in_step(step, n, eta, slope, critical, gate, phi, p_trial, tau_trial, &
                                  rate, p, found, bound)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: n
    !> Viscosities. [Pa s] (n)
    real(wp), intent(in) :: eta(n)
    !> Slopes a of the packing law. (n)
    real(wp), intent(in) :: slope(n)
    !> Critical packing fractions. (n)
    real(wp), intent(in) :: critical(n)
    !> Packing fractions from which grains carry pressure at rest. (n)
    real(wp), intent(in) :: gate(n)
    !> Packing fractions. (n)
    real(wp), intent(in) :: phi(n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(in) :: p_trial(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau_trial(n)
    !> Plastic shear rates. [1/s] (n)
    real(wp), intent(inout) :: rate(n)
    !> Pressures. [Pa] (n)
    real(wp), intent(inout) :: p(n)
    !> 1 for points that are found, 0 for others. (n)
    real(wp), intent(inout) :: found(n)
    !> C of points that are not, since they compact; 0 for others. (n)
    real(wp), intent(out) :: bound(n)
    real(wp) :: g(width), square(width), excess(width), ratio, drag, friction, linear, c, s, push
    integer :: i

    do i = 1, n
      ratio = slope(i)*phi(i)/max(critical(i) - phi(i), nothing)
      friction = ratio*ratio*(step%friction + step%rise/(1.0_wp + step%inertial*ratio))
      drag = eta(i)*(2.0_wp*friction + 2.5_wp*phi(i)*ratio/slope(i))
      linear = step%shear + drag
      g(i) = 2.0_wp*tau_trial(i) &
             /(linear + sqrt(linear*linear + 4.0_wp*friction*step%inertia*tau_trial(i)))
      c = sqrt(g(i)*(step%inertia*g(i) + 2.0_wp*eta(i)))
      s = ratio*c
      square(i) = s*s
      push = step%bulk*step%dilation*g(i)
      excess(i) = (s*s - p_trial(i) - push*phi(i))*(s + slope(i)*c) + push*critical(i)*s
    end do
    do i = 1, n
      excess(i) = merge(excess(i), 1.0_wp, phi(i) < gate(i))
      excess(i) = merge(1.0_wp, excess(i), found(i) > 0.0_wp)
      rate(i) = merge(g(i), rate(i), excess(i) <= 0.0_wp)
      p(i) = merge(square(i), p(i), excess(i) <= 0.0_wp)
      bound(i) = 0.0_wp
    end do
    if (step%compaction > 0.0_wp) then
      do i = 1, n
        ratio = slope(i)*phi(i)/max(critical(i) - phi(i), nothing)
        square(i) = ratio*ratio
      end do
      do i = 1, n
        bound(i) = merge(square(i), 0.0_wp, excess(i) <= 0.0_wp)
      end do
    else
      do i = 1, n
        found(i) = merge(1.0_wp, found(i), excess(i) <= 0.0_wp)
      end do
    end if
  end subroutine suspend_in_step

  !> Find loose points within their static strength while they compact, p = C (rho_s d**2 y**2 +
  !> 2 eta y), y = K_4 (p_tr - p)/(K dt).
  pure subroutine rest_and_compact(step, n, eta, slope, critical, gate, phi, p_trial, tau_trial, &
                                   rate, p, found)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: n
    !> Viscosities. [Pa s] (n)
    real(wp), intent(in) :: eta(n)
    !> Slopes a of the packing law. (n)
    real(wp), intent(in) :: slope(n)
    !> Critical packing fractions. (n)
    real(wp), intent(in) :: critical(n)
    !> Packing fractions from which grains carry pressure at rest. (n)
    real(wp), intent(in) :: gate(n)
    !> Packing fractions. (n)
    real(wp), intent(in) :: phi(n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(in) :: p_trial(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau_trial(n)
    !> Plastic shear rates. [1/s] (n)
    real(wp), intent(inout) :: rate(n)
    !> Pressures. [Pa] (n)
    real(wp), intent(inout) :: p(n)
    !> 1 for points that are found, 0 for others. (n)
    real(wp), intent(inout) :: found(n)
    real(wp) :: square(width), over(width), ratio, linear, quadratic, y, static
    integer :: i

    do i = 1, n
      ratio = slope(i)*phi(i)/max(critical(i) - phi(i), nothing)
      linear = 1.0_wp + 2.0_wp*ratio*ratio*eta(i)*step%compaction
      quadratic = step%inertia*(ratio*step%compaction)**2
      y = max(0.0_wp, p_trial(i))
      y = step%compaction*2.0_wp*y/(linear + sqrt(linear*linear + 4.0_wp*quadratic*y))
      square(i) = ratio*ratio*y*(step%inertia*y + 2.0_wp*eta(i))
      static = max(0.0_wp, step%friction + step%dilation*(phi(i) - critical(i)))
      over(i) = tau_trial(i) - max(static*square(i), least_shear)
    end do
    do i = 1, n
      over(i) = merge(over(i), 1.0_wp, phi(i) < gate(i))
      rate(i) = merge(0.0_wp, rate(i), over(i) <= 0.0_wp)
      p(i) = merge(square(i), p(i), over(i) <= 0.0_wp)
      found(i) = merge(1.0_wp, found(i), over(i) <= 0.0_wp)
    end do
  end subroutine rest_and_compact

end module mpm_granular_step
