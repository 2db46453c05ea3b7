!> Plastic shear rates and pressures of grains in a fluid, for many points in step.
!!
!! The laws are those of `mpm_granular_flow`: with s = sqrt(p),
!!
!!     y(g, s) = tau_tr - G dt g - (mu + beta) s**2 = 0,
!!     v(g, s) = p_tr + K dt g beta - s**2 = 0.
!!
!! Newton's rule takes g and s together. A step changes neither by more than a factor, and a point
!! is found when the next step would change both by less than `near`: what that step leaves is of
!! the order of its square, 1e-16 of the stresses.
module mpm_granular_step
  use mpm_kinds, only: wp
  implicit none
  private
  public :: granular_step_t, least_shear, rest_and_compact, rest_or_pull, search_in_step
  public :: suspend_in_step, width

  !> Points at a time.
  integer, parameter :: width = 128
  !> Points go in groups of so many, the last one filled up, so that each lies in a vector of the
  !> processor and what is found for it does not depend on its place.
  integer, parameter :: group = 16
  !> Steps of Newton for a point.
  integer, parameter :: patience = 24
  !> Relative change of a shear rate and of the root of a pressure that is the last one.
  real(wp), parameter :: near = 1.0e-8_wp
  !> Missing shear stress over the trial stress at which a point is found whose rate is lost in
  !> rounding.
  real(wp), parameter :: tolerance = 1.0e-13_wp
  !> Least and largest ratio of a value to the one before.
  real(wp), parameter :: least = 0.2_wp, most = 10.0_wp
  !> Share of the trial stresses below which a rate or a pressure is no guess.
  real(wp), parameter :: faint = 1.0e-12_wp
  !> Shear stress that stays as it is: ahead of waves there are stresses whose squares are 0. [Pa]
  real(wp), parameter :: least_shear = 1.0e-120_wp
  !> The least that is divided by, and the largest quotient whose square is wanted.
  real(wp), parameter :: least_divisor = 1.0e-290_wp, largest_quotient = 1.0e140_wp
  !> What takes any C above 1.
  real(wp), parameter :: large = 1.0e30_wp
  !> Least distance of a packing from the critical one.
  real(wp), parameter :: nothing = 1.0e-20_wp
  !> Columns of the points at work: what they are given, the shear rate, the root of the pressure, 0
  !> or, once they are found, 1, 5/2 phi eta/a, and C of compacting points.
  integer, parameter :: c_eta = 1, c_slope = 2, c_critical = 3, c_phi = 4, c_trial = 5, c_tau = 6
  integer, parameter :: c_rate = 7, c_root = 8, c_done = 9, c_drag = 10, c_bound = 11
  integer, parameter :: n_columns = 11

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

  !> Search the points of a list, from rates and pressures that may be close.
  pure subroutine search_in_step(step, n, m, list, eta, slope, critical, phi, bound, p_trial, &
                                 tau_trial, rate, p, found)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points, at most `width`.
    integer, intent(in) :: n
    !> Number of points of the list.
    integer, intent(in) :: m
    !> The list.
    integer, intent(in) :: list(m)
    !> Viscosities. [Pa s] (n)
    real(wp), intent(in) :: eta(n)
    !> Slopes a of the packing law. (n)
    real(wp), intent(in) :: slope(n)
    !> Critical packing fractions. (n)
    real(wp), intent(in) :: critical(n)
    !> Packing fractions. (n)
    real(wp), intent(in) :: phi(n)
    !> C of points that compact; 0 for others. (n)
    real(wp), intent(in) :: bound(n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(in) :: p_trial(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau_trial(n)
    !> Plastic shear rates, guesses on entry. [1/s] (n)
    real(wp), intent(inout) :: rate(n)
    !> Pressures, guesses on entry. [Pa] (n)
    real(wp), intent(inout) :: p(n)
    !> 1 where a point of the list has its solution; the others are as they were. (n)
    real(wp), intent(inout) :: found(n)
    real(wp) :: work(width, n_columns)
    integer :: own(width), left, full, k, i, j

    do k = 1, m
      i = list(k)
      own(k) = i
      work(k, c_eta) = eta(i)
      work(k, c_slope) = slope(i)
      work(k, c_critical) = critical(i)
      work(k, c_phi) = phi(i)
      work(k, c_trial) = p_trial(i)
      work(k, c_tau) = tau_trial(i)
      work(k, c_rate) = rate(i)
      work(k, c_root) = p(i)
      work(k, c_done) = 0.0_wp
      work(k, c_bound) = bound(i)
    end do
    left = m
    call fill(left, work, full)
    call begin(step, full, work(:, c_eta), work(:, c_slope), work(:, c_critical), &
               work(:, c_phi), work(:, c_trial), work(:, c_tau), work(:, c_rate), &
               work(:, c_root), work(:, c_drag))
    do k = 1, patience
      call newton(step, full, work(:, c_eta), work(:, c_slope), work(:, c_critical), &
                  work(:, c_phi), work(:, c_trial), work(:, c_tau), work(:, c_rate), &
                  work(:, c_root), work(:, c_drag), work(:, c_bound), work(:, c_done))
      j = 0
      do i = 1, left
        if (work(i, c_done) > 0.0_wp) j = j + 1
      end do
      ! Moving the points that are left costs about half as much as a step of theirs.
      if (3*j < left .and. k < patience) cycle
      j = 0
      do i = 1, left
        if (work(i, c_done) > 0.0_wp) then
          rate(own(i)) = work(i, c_rate)
          p(own(i)) = work(i, c_root)**2
          found(own(i)) = 1.0_wp
        else
          j = j + 1
          own(j) = own(i)
          work(j, :) = work(i, :)
        end if
      end do
      left = j
      if (left == 0) exit
      call fill(left, work, full)
    end do
  end subroutine search_in_step

  !> Fill the last group with copies of the last point.
  pure subroutine fill(m, work, full)
    !> Number of points.
    integer, intent(in) :: m
    !> The points at work.
    real(wp), intent(inout) :: work(width, n_columns)
    !> Number of points with the copies.
    integer, intent(out) :: full
    integer :: i

    full = group*((m + group - 1)/group)
    do i = m + 1, full
      work(i, :) = work(m, :)
    end do
  end subroutine fill

  !> Prepare the points: guesses where there are some, and others elsewhere.
  pure subroutine begin(step, m, eta, slope, critical, phi, p_trial, tau_trial, rate, root, drag)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: m
    !> Viscosities. [Pa s] (m)
    real(wp), intent(in) :: eta(m)
    !> Slopes a of the packing law. (m)
    real(wp), intent(in) :: slope(m)
    !> Critical packing fractions. (m)
    real(wp), intent(in) :: critical(m)
    !> Packing fractions. (m)
    real(wp), intent(in) :: phi(m)
    !> Trial pressures. [Pa] (m)
    real(wp), intent(in) :: p_trial(m)
    !> Trial shear stresses. [Pa] (m)
    real(wp), intent(in) :: tau_trial(m)
    !> Plastic shear rates, guesses on entry. [1/s] (m)
    real(wp), intent(inout) :: rate(m)
    !> Pressures that are guessed on entry, their roots on exit. (m)
    real(wp), intent(inout) :: root(m)
    !> 5/2 phi eta/a. [Pa s] (m)
    real(wp), intent(out) :: drag(m)
    real(wp) :: known(width)
    integer :: i

    do i = 1, m
      known(i) = min(rate(i)*step%shear - faint*tau_trial(i), &
                     root(i) - faint*max(abs(p_trial(i)), tau_trial(i)))
      rate(i) = min(rate(i), tau_trial(i)/step%shear)
      root(i) = sqrt(max(root(i), 0.0_wp))
      drag(i) = 2.5_wp*phi(i)*eta(i)/slope(i)
    end do
    do i = 1, m
      if (known(i) > 0.0_wp) cycle
      call guess(step, eta(i), slope(i), critical(i), phi(i), p_trial(i), tau_trial(i), rate(i), &
                 root(i))
    end do
  end subroutine begin

  !> Guess a shear rate and the root of a pressure: as if the strength were linear in c, and the
  !> pressure that of the trial.
  pure subroutine guess(step, eta, slope, critical, phi, p_trial, tau_trial, rate, root)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Viscosity. [Pa s]
    real(wp), intent(in) :: eta
    !> Slope a of the packing law.
    real(wp), intent(in) :: slope
    !> Critical packing fraction.
    real(wp), intent(in) :: critical
    !> Packing fraction.
    real(wp), intent(in) :: phi
    !> Trial pressure. [Pa]
    real(wp), intent(in) :: p_trial
    !> Trial shear stress. [Pa]
    real(wp), intent(in) :: tau_trial
    !> Plastic shear rate. [1/s]
    real(wp), intent(out) :: rate
    !> Root of the pressure.
    real(wp), intent(out) :: root
    real(wp) :: p, dense, over, linear, viscous, most_root

    p = max(p_trial, 0.01_wp*tau_trial)
    root = sqrt(p)
    dense = step%dilation*(phi - critical)
    over = max(tau_trial - max(0.0_wp, step%friction + dense)*p, 0.01_wp*tau_trial)
    linear = step%dilation*critical*slope*root
    if (step%inertial > 0.0_wp) linear = linear + step%rise/step%inertial*root
    viscous = linear*sqrt(2.0_wp*eta)
    dense = max(dense, 0.0_wp)
    linear = step%shear + linear*sqrt(step%inertia) + step%bulk*dense*(step%friction + dense)
    rate = (2.0_wp*over/(viscous + sqrt(viscous*viscous + 4.0_wp*linear*over)))**2
    rate = min(rate, tau_trial/step%shear)
    ! At most the pressure of grains that do not compact.
    most_root = sqrt(max(0.0_wp, p_trial) + step%bulk*step%dilation*rate*phi)
    root = min(max(root, 1.0e-3_wp*most_root), most_root)
  end subroutine guess

  !> One step of Newton of all points that are not found yet.
  pure subroutine newton(step, m, eta, slope, critical, phi, p_trial, tau_trial, rate, root, &
                         drag, bound, done)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: m
    !> Viscosities. [Pa s] (m)
    real(wp), intent(in) :: eta(m)
    !> Slopes a of the packing law. (m)
    real(wp), intent(in) :: slope(m)
    !> Critical packing fractions. (m)
    real(wp), intent(in) :: critical(m)
    !> Packing fractions. (m)
    real(wp), intent(in) :: phi(m)
    !> Trial pressures. [Pa] (m)
    real(wp), intent(in) :: p_trial(m)
    !> Trial shear stresses. [Pa] (m)
    real(wp), intent(in) :: tau_trial(m)
    !> Plastic shear rates. [1/s] (m)
    real(wp), intent(inout) :: rate(m)
    !> Roots s of the pressures. (m)
    real(wp), intent(inout) :: root(m)
    !> 5/2 phi eta/a. [Pa s] (m)
    real(wp), intent(in) :: drag(m)
    !> C of points that compact; 0 for others. (m)
    real(wp), intent(in) :: bound(m)
    !> 1 for points that are found, which stay as they are. (m)
    real(wp), intent(inout) :: done(m)
    real(wp) :: new_rate(width), new_root(width), left(width), g, s, c, p, packed, rubbed, over, all
    real(wp) :: beta, beta_g, beta_s, mu, mu_g, mu_s, viscous, y, y_g, y_s, v, v_g, v_s, missing
    real(wp) :: det, dg, ds, largest, excess, loose, swept, dp
    integer :: i

    largest = 1.0_wp/step%shear
    do i = 1, m
      g = rate(i)
      s = root(i)
      p = s*s
      c = sqrt(g*(step%inertia*g + 2.0_wp*eta(i)))
      ! One division for packed = 1/(s + a c), rubbed = 1/(c + b s) and over = 1/c.
      packed = s + slope(i)*c
      rubbed = c + step%inertial*s
      all = c*packed*rubbed
      det = 1.0_wp/max(all, least_divisor)
      over = min(packed*rubbed*det, largest_quotient)
      mu = packed*c*det
      packed = rubbed*c*det
      rubbed = mu
      ! beta and mu, and their derivatives with respect to g, where dc/dg = (..)/c, and to s.
      beta = step%dilation*(phi(i) - critical(i)*s*packed)
      beta_s = step%dilation*critical(i)*slope(i)*packed*packed
      beta_g = beta_s*s*(step%inertia*g + eta(i))*over
      beta_s = -beta_s*c
      mu = step%friction + beta + step%rise*c*rubbed
      mu_s = step%rise*step%inertial*rubbed*rubbed
      mu_g = mu_s*s*(step%inertia*g + eta(i))*over
      mu_s = -mu_s*c
      viscous = drag(i)*g*over
      y = tau_trial(i) - step%shear*g - p*mu - viscous*s
      y_g = -(step%shear + p*(beta_g + mu_g) + viscous*s*eta(i)*over*over)
      y_s = -(2.0_wp*s*mu + p*(beta_s + mu_s) + viscous)
      v = p_trial(i) + step%bulk*g*beta - p
      v_g = step%bulk*(beta + g*beta_g)
      v_s = step%bulk*g*beta_s - 2.0_wp*s
      ! Where they compact, v over K dt is -x2, and p has its bound.
      loose = min(1.0_wp, bound(i)*large)
      excess = -loose*v
      swept = g + step%compaction*v
      dp = 2.0_wp*bound(i)*(step%inertia*swept + eta(i))
      v = (1.0_wp - loose)*v + loose*(bound(i)*swept*(step%inertia*swept + 2.0_wp*eta(i)) - p)
      v_g = (1.0_wp - loose)*v_g + loose*dp*(1.0_wp + step%compaction*v_g)
      v_s = (1.0_wp - loose)*v_s + loose*(dp*step%compaction*v_s - 2.0_wp*s)
      ! Cramer's rule. `missing` is -v_s times the shear stress that is missing where v is 0.
      missing = y_s*v - y*v_s
      det = y_g*v_s - y_s*v_g
      det = 1.0_wp/sign(max(abs(det), least_divisor), det)
      dg = missing*det
      ds = (v_g*y - y_g*v)*det
      left(i) = max(abs(missing) + tolerance*v_s*max(abs(p_trial(i)), tau_trial(i)), &
                    abs(dg) - 0.5_wp*g)
      left(i) = max(min(left(i), abs(dg) - near*g), abs(ds) - near*s, least_divisor - all, &
                    excess - tolerance*max(abs(p_trial(i)), tau_trial(i)))
      new_rate(i) = min(min(max(g + dg, least*g), most*g), largest*tau_trial(i))
      new_root(i) = min(max(s + ds, least*s), most*s)
    end do
    do i = 1, m
      rate(i) = merge(rate(i), new_rate(i), done(i) > 0.0_wp)
      root(i) = merge(root(i), new_root(i), done(i) > 0.0_wp)
      done(i) = merge(done(i), 1.0_wp, left(i) > 0.0_wp)
    end do
  end subroutine newton

end module mpm_granular_step
