!> Plastic shear rates and pressures of grains in a fluid, for many points in step.
!!
!! The laws are those of `mpm_granular_flow`: with s = sqrt(p),
!!
!!     y(g, s) = tau_tr - G dt g - (mu + beta) s**2 = 0,
!!     v(g, s) = p_tr + K dt g beta - s**2 = 0,
!!
!! and where loose packings compact, x2 < 0, the bound of the pressure in place of v. Newton's rule
!! takes g and s together. A step changes neither by more than a factor, and a point is found when
!! the next step would change both by less than `near`: what that step leaves is of the order of its
!! square, 1e-16 of the stresses.
module mpm_granular_newton
  use mpm_granular_step, only: granular_step_t, width
  use mpm_kinds, only: wp
  implicit none
  private
  public :: search_in_step

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
  real(wp), parameter :: least_ratio = 0.2_wp, most_ratio = 10.0_wp
  !> Share of the trial stresses below which a rate or a pressure is no guess.
  real(wp), parameter :: faint = 1.0e-12_wp
  !> The least that is divided by, and the largest quotient whose square is wanted.
  real(wp), parameter :: least_divisor = 1.0e-290_wp, largest_quotient = 1.0e140_wp
  !> Columns of the points at work: what they are given, the shear rate, the root of the pressure, 0
  !> or, once they are found, 1, 5/2 phi eta/a, and C of compacting points.
  integer, parameter :: c_eta = 1, c_slope = 2, c_critical = 3, c_phi = 4, c_trial = 5, c_tau = 6
  integer, parameter :: c_rate = 7, c_root = 8, c_done = 9, c_drag = 10, c_bound = 11
  integer, parameter :: n_columns = 11

contains

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
    real(wp), dimension(width) :: y, y_g, y_s, v, v_g, v_s, least
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
      call balance(step, full, work(:, c_eta), work(:, c_slope), work(:, c_critical), &
                   work(:, c_phi), work(:, c_trial), work(:, c_tau), work(:, c_drag), &
                   work(:, c_rate), work(:, c_root), y, y_g, y_s, v, v_g, v_s, least)
      if (step%compaction > 0.0_wp) then
        call compact(step, full, work(:, c_eta), work(:, c_bound), work(:, c_trial), &
                     work(:, c_tau), work(:, c_rate), work(:, c_root), v, v_g, v_s, least)
      end if
      call newton(step, full, work(:, c_trial), work(:, c_tau), y, y_g, y_s, v, v_g, v_s, least, &
                  work(:, c_rate), work(:, c_root), work(:, c_done))
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

  !> What is missing in the balances y of shear and v of volume, and its derivatives.
  pure subroutine balance(step, m, eta, slope, critical, phi, p_trial, tau_trial, drag, rate, &
                          root, y, y_g, y_s, v, v_g, v_s, least)
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
    !> 5/2 phi eta/a. [Pa s] (m)
    real(wp), intent(in) :: drag(m)
    !> Plastic shear rates g. [1/s] (m)
    real(wp), intent(in) :: rate(m)
    !> Roots s of the pressures. (m)
    real(wp), intent(in) :: root(m)
    !> Shear stress that is missing. [Pa] (m)
    real(wp), intent(out) :: y(m)
    !> Its derivative with respect to g. (m)
    real(wp), intent(out) :: y_g(m)
    !> Its derivative with respect to s. (m)
    real(wp), intent(out) :: y_s(m)
    !> Pressure that is missing. [Pa] (m)
    real(wp), intent(out) :: v(m)
    !> Its derivative with respect to g. (m)
    real(wp), intent(out) :: v_g(m)
    !> Its derivative with respect to s. (m)
    real(wp), intent(out) :: v_s(m)
    !> Denominator of these numbers. (m)
    real(wp), intent(out) :: least(m)
    real(wp) :: g, s, c, p, packed, rubbed, over, all, rise, beta, beta_g, beta_s, mu, mu_g, mu_s
    real(wp) :: viscous
    integer :: i

    do i = 1, m
      g = rate(i)
      s = root(i)
      p = s*s
      c = sqrt(g*(step%inertia*g + 2.0_wp*eta(i)))
      ! One division for over = 1/c, and 1/(s + a c) and 1/(c + b s) in place of these.
      packed = s + slope(i)*c
      rubbed = c + step%inertial*s
      least(i) = c*packed*rubbed
      all = 1.0_wp/max(least(i), least_divisor)
      over = min(packed*rubbed*all, largest_quotient)
      mu = packed*c*all
      packed = rubbed*c*all
      rubbed = mu
      ! beta and mu, and their derivatives with respect to g, where dc/dg = rise, and to s.
      rise = (step%inertia*g + eta(i))*over
      beta = step%dilation*(phi(i) - critical(i)*s*packed)
      beta_s = step%dilation*critical(i)*slope(i)*packed*packed
      beta_g = beta_s*s*rise
      beta_s = -beta_s*c
      mu = step%friction + beta + step%rise*c*rubbed
      mu_s = step%rise*step%inertial*rubbed*rubbed
      mu_g = mu_s*s*rise
      mu_s = -mu_s*c
      viscous = drag(i)*g*over
      y(i) = tau_trial(i) - step%shear*g - p*mu - viscous*s
      y_g(i) = -(step%shear + p*(beta_g + mu_g) + viscous*s*eta(i)*over*over)
      y_s(i) = -(2.0_wp*s*mu + p*(beta_s + mu_s) + viscous)
      v(i) = p_trial(i) + step%bulk*g*beta - p
      v_g(i) = step%bulk*(beta + g*beta_g)
      v_s(i) = step%bulk*g*beta_s - 2.0_wp*s
    end do
  end subroutine balance

  !> Put the bound of the pressure in place of the balance of volume where points compact: v over
  !> K dt is -x2, which must not be above 0.
  pure subroutine compact(step, m, eta, bound, p_trial, tau_trial, rate, root, v, v_g, v_s, least)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: m
    !> Viscosities. [Pa s] (m)
    real(wp), intent(in) :: eta(m)
    !> C of points that compact; 0 for others. (m)
    real(wp), intent(in) :: bound(m)
    !> Trial pressures. [Pa] (m)
    real(wp), intent(in) :: p_trial(m)
    !> Trial shear stresses. [Pa] (m)
    real(wp), intent(in) :: tau_trial(m)
    !> Plastic shear rates. [1/s] (m)
    real(wp), intent(in) :: rate(m)
    !> Roots of the pressures. (m)
    real(wp), intent(in) :: root(m)
    !> Pressure that is missing. [Pa] (m)
    real(wp), intent(inout) :: v(m)
    !> Its derivative with respect to the rate. (m)
    real(wp), intent(inout) :: v_g(m)
    !> Its derivative with respect to the root. (m)
    real(wp), intent(inout) :: v_s(m)
    !> A number that is made 0 where a point can't be found here. (m)
    real(wp), intent(inout) :: least(m)
    real(wp) :: w(width), w_g(width), w_s(width), enough(width), swept, slope
    integer :: i

    do i = 1, m
      swept = rate(i) + step%compaction*v(i)
      slope = 2.0_wp*bound(i)*(step%inertia*swept + eta(i))
      w(i) = bound(i)*swept*(step%inertia*swept + 2.0_wp*eta(i)) - root(i)**2
      w_g(i) = slope*(1.0_wp + step%compaction*v_g(i))
      w_s(i) = slope*step%compaction*v_s(i) - 2.0_wp*root(i)
      enough(i) = v(i) + tolerance*max(abs(p_trial(i)), tau_trial(i))
    end do
    do i = 1, m
      enough(i) = merge(enough(i), 1.0_wp, bound(i) > 0.0_wp)
      v(i) = merge(w(i), v(i), bound(i) > 0.0_wp)
      v_g(i) = merge(w_g(i), v_g(i), bound(i) > 0.0_wp)
      v_s(i) = merge(w_s(i), v_s(i), bound(i) > 0.0_wp)
      least(i) = merge(least(i), 0.0_wp, enough(i) >= 0.0_wp)
    end do
  end subroutine compact

  !> One step of Newton of all points that are not found yet.
  pure subroutine newton(step, m, p_trial, tau_trial, y, y_g, y_s, v, v_g, v_s, least, rate, root, &
                         done)
    !> Constants of the law and the step.
    type(granular_step_t), intent(in) :: step
    !> Number of points.
    integer, intent(in) :: m
    !> Trial pressures. [Pa] (m)
    real(wp), intent(in) :: p_trial(m)
    !> Trial shear stresses. [Pa] (m)
    real(wp), intent(in) :: tau_trial(m)
    !> Shear stress that is missing. [Pa] (m)
    real(wp), intent(in) :: y(m)
    !> Its derivative with respect to the rate. (m)
    real(wp), intent(in) :: y_g(m)
    !> Its derivative with respect to the root. (m)
    real(wp), intent(in) :: y_s(m)
    !> Pressure that is missing. [Pa] (m)
    real(wp), intent(in) :: v(m)
    !> Its derivative with respect to the rate. (m)
    real(wp), intent(in) :: v_g(m)
    !> Its derivative with respect to the root. (m)
    real(wp), intent(in) :: v_s(m)
    !> Denominator of these numbers; too small where they are not valid. (m)
    real(wp), intent(in) :: least(m)
    !> Plastic shear rates. [1/s] (m)
    real(wp), intent(inout) :: rate(m)
    !> Roots s of the pressures. (m)
    real(wp), intent(inout) :: root(m)
    !> 1 for points that are found, which stay as they are. (m)
    real(wp), intent(inout) :: done(m)
    real(wp) :: new_rate(width), new_root(width), left(width), g, s, missing, det, dg, ds, largest
    integer :: i

    largest = 1.0_wp/step%shear
    do i = 1, m
      g = rate(i)
      s = root(i)
      ! Cramer's rule. `missing` is -v_s times the shear stress that is missing where v is 0.
      missing = y_s(i)*v(i) - y(i)*v_s(i)
      det = y_g(i)*v_s(i) - y_s(i)*v_g(i)
      det = 1.0_wp/sign(max(abs(det), least_divisor), det)
      dg = missing*det
      ds = (v_g(i)*y(i) - y_g(i)*v(i))*det
      left(i) = max(abs(missing) + tolerance*v_s(i)*max(abs(p_trial(i)), tau_trial(i)), &
                    abs(dg) - 0.5_wp*g)
      left(i) = max(min(left(i), abs(dg) - near*g), abs(ds) - near*s, least_divisor - least(i))
      new_rate(i) = min(min(max(g + dg, least_ratio*g), most_ratio*g), largest*tau_trial(i))
      new_root(i) = min(max(s + ds, least_ratio*s), most_ratio*s)
    end do
    do i = 1, m
      rate(i) = merge(rate(i), new_rate(i), done(i) > 0.0_wp)
      root(i) = merge(root(i), new_root(i), done(i) > 0.0_wp)
      done(i) = merge(done(i), 1.0_wp, left(i) > 0.0_wp)
    end do
  end subroutine newton

end module mpm_granular_newton
