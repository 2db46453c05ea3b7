!> The plastic step of grains in a fluid: mu(I_m) friction, dilation, no tension, loose compaction.
!!
!! With the plastic shear rate g, the pressure p and c**2 = rho_s d**2 g**2 + 2 eta g,
!!
!!     I_m = c/sqrt(p),   phi_eq = phi_m/(1 + a I_m),   beta = K_3 (phi - phi_eq),
!!     mu = mu_1 + (mu_2 - mu_1)/(1 + b/I_m) + 5/2 phi (g eta/p)/(a I_m),
!!     tau = tau_tr - G dt g <= (mu + beta) p,   p = p_tr + K dt (beta g + x1 + x2),
!!
!! x1 >= 0 keeps p >= 0, and x2 <= 0 keeps p <= C (rho_s d**2 y**2 + 2 eta y) with y = g - K_4 x2
!! and C = (a phi/(phi_m - phi))**2 where phi is below a gate. All of it is one equation for g: for
!! each g there is one p, and tau - strength falls from g = 0 to tau = 0. Only in packings that rest
!! and yet liquefy, mu_1 < K_3 (phi_m - phi), it may rise in between and have three roots; which one
!! is found depends on where the search starts, at the shear rate and pressure of the last step.
module mpm_granular_flow
  use mpm_bracket, only: bracket_t
  use mpm_granular_newton, only: search_in_step
  use mpm_granular_step, only: granular_step_t, rest_and_compact, rest_or_pull, suspend_in_step, &
                               width
  use mpm_kinds, only: wp
  implicit none
  private
  public :: granular_flow_t

  !> Missing shear stress over the trial stress at which a point is found.
  real(wp), parameter :: tolerance = 1.0e-13_wp
  !> Values until the search counts as failed; halving an interval to nothing takes some 1100.
  integer, parameter :: patience = 2000

  !> Constants of the law for one point.
  type :: granular_flow_t
    !> Bulk modulus K. [Pa]
    real(wp) :: bulk = 0.0_wp
    !> Shear modulus G. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Static friction mu_1.
    real(wp) :: friction = 0.0_wp
    !> Friction of fast flow mu_2.
    real(wp) :: fast_friction = 0.0_wp
    !> Slope a of the packing law.
    real(wp) :: slope = 1.0_wp
    !> Scale b of the friction law.
    real(wp) :: inertial = 0.0_wp
    !> Dilation K_3.
    real(wp) :: dilation = 0.0_wp
    !> Compaction K_4.
    real(wp) :: compaction = 0.0_wp
    !> Critical packing fraction phi_m.
    real(wp) :: critical = 1.0_wp
    !> Packing fraction from which grains carry pressure at rest.
    real(wp) :: gate = 1.0_wp
    !> Density of the grains rho_s. [kg/m3]
    real(wp) :: grain_density = 0.0_wp
    !> Viscosity of the fluid eta. [Pa s]
    real(wp) :: viscosity = 0.0_wp
    !> Diameter of the grains d. [m]
    real(wp) :: diameter = 0.0_wp
  contains
    !> Bring a trial state back.
    procedure :: solve => granular_flow_solve
    !> Bring the trial states of a block of points back.
    procedure :: solve_block => granular_flow_solve_block
    !> Pressure of a plastic shear rate.
    procedure :: pressure => granular_flow_pressure
    !> Largest shear stress.
    procedure :: strength => granular_flow_strength
    !> c**2 = rho_s d**2 g**2 + 2 eta g.
    procedure :: square => granular_flow_square
  end type granular_flow_t

contains

  !> Bring a trial state back.
  pure subroutine granular_flow_solve(self, dt, phi, p_trial, tau_trial, p, tau, rate, good)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Packing fraction.
    real(wp), intent(in) :: phi
    !> Trial pressure. [Pa]
    real(wp), intent(in) :: p_trial
    !> Trial shear stress. [Pa]
    real(wp), intent(in) :: tau_trial
    !> Pressure. [Pa]
    real(wp), intent(out) :: p
    !> Shear stress. [Pa]
    real(wp), intent(out) :: tau
    !> Plastic shear rate. [1/s]
    real(wp), intent(out) :: rate
    !> Whether a solution was found.
    logical, intent(out) :: good
    type(bracket_t) :: search
    real(wp) :: largest, low, high, missing

    good = .true.
    rate = 0.0_wp
    tau = tau_trial
    p = self%pressure(dt, phi, p_trial, 0.0_wp)
    low = tau - self%strength(phi, p, 0.0_wp)
    if (low <= 0.0_wp) return
    largest = tau_trial/(self%shear*dt)
    p = self%pressure(dt, phi, p_trial, largest)
    high = -self%strength(phi, p, largest)
    rate = largest
    tau = 0.0_wp
    if (high >= 0.0_wp) return
    call search%start(0.0_wp, low, largest, high)
    do
      rate = search%x
      p = self%pressure(dt, phi, p_trial, rate)
      tau = max(0.0_wp, tau_trial - self%shear*dt*rate)
      missing = tau - self%strength(phi, p, rate)
      if (abs(missing) <= tolerance*max(abs(p_trial), tau_trial)) return
      call search%take(missing)
      if (search%done) return
      good = search%n < patience
      if (.not. good) return
    end do
  end subroutine granular_flow_solve

  !> Bring the trial states of a block of points back.
  !!
  !! The solutions of `solve`, in step for all points: those in closed form, and the others from the
  !! shear rates and pressures of the last step. The few that are not found are left to `solve`.
  pure subroutine granular_flow_solve_block(self, n, dt, viscosity, slope, critical, gate, phi, &
                                            p_trial, tau_trial, p, tau, rate, first_bad)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Viscosities, in place of that of the law. [Pa s] (n)
    real(wp), intent(in) :: viscosity(n)
    !> Slopes of the packing law, in place of that of the law. (n)
    real(wp), intent(in) :: slope(n)
    !> Critical packing fractions, in place of that of the law. (n)
    real(wp), intent(in) :: critical(n)
    !> Packing fractions from which grains carry pressure at rest, too. (n)
    real(wp), intent(in) :: gate(n)
    !> Packing fractions. (n)
    real(wp), intent(in) :: phi(n)
    !> Trial pressures. [Pa] (n)
    real(wp), intent(in) :: p_trial(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau_trial(n)
    !> Pressures, of the last step on entry. [Pa] (n)
    real(wp), intent(inout) :: p(n)
    !> Shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)
    !> Plastic shear rates, of the last step on entry. [1/s] (n)
    real(wp), intent(inout) :: rate(n)
    !> First point without a solution; 0 when there is none.
    integer, intent(out) :: first_bad
    integer :: a, m

    first_bad = 0
    do a = 1, n, width
      m = min(width, n - a + 1)
      call solve_some(self, m, dt, viscosity(a), slope(a), critical(a), gate(a), phi(a), &
                      p_trial(a), tau_trial(a), p(a), tau(a), rate(a), first_bad)
      if (first_bad == 0) cycle
      first_bad = first_bad + a - 1
      return
    end do
  end subroutine granular_flow_solve_block

  !> Bring the trial states of so many points back that work arrays have a fixed size.
  pure subroutine solve_some(self, n, dt, viscosity, slope, critical, gate, phi, p_trial, &
                             tau_trial, p, tau, rate, first_bad)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Number of points, at most `width`.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Viscosities. [Pa s] (n)
    real(wp), intent(in) :: viscosity(n)
    !> Slopes of the packing law. (n)
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
    !> Pressures, of the last step on entry. [Pa] (n)
    real(wp), intent(inout) :: p(n)
    !> Shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)
    !> Plastic shear rates, of the last step on entry. [1/s] (n)
    real(wp), intent(inout) :: rate(n)
    !> First point without a solution; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: known(width), p_known(width), rate_known(width), bound(width), largest(width)
    type(granular_step_t) :: step
    type(granular_flow_t) :: law
    integer :: list(width), m, i
    logical :: good

    first_bad = 0
    step = step_of(self, dt)
    call rest_or_pull(step, n, critical, gate, phi, p_trial, tau_trial, rate_known, p_known, known)
    bound(:n) = 0.0_wp
    if (any(phi < gate)) then
      if (self%compaction > 0.0_wp) then
        call rest_and_compact(step, n, viscosity, slope, critical, gate, phi, p_trial, tau_trial, &
                              rate_known, p_known, known)
      end if
      call suspend_in_step(step, n, viscosity, slope, critical, gate, phi, p_trial, tau_trial, &
                           rate_known, p_known, known, bound)
    end if
    m = 0
    do i = 1, n
      if (known(i) > 0.0_wp .or. (bound(i) > 0.0_wp .and. .not. (rate(i) > 0.0_wp))) then
        rate(i) = rate_known(i)
        p(i) = p_known(i)
      end if
      if (known(i) > 0.0_wp) cycle
      m = m + 1
      list(m) = i
    end do
    if (m > 0) then
      call search_in_step(step, n, m, list, viscosity, slope, critical, phi, bound, p_trial, &
                          tau_trial, rate, p, known)
    end if
    ! Nothing is left at the largest rate, but for a rounding.
    do i = 1, n
      largest(i) = tau_trial(i)/step%shear
      tau(i) = max(0.0_wp, tau_trial(i) - step%shear*rate(i))
    end do
    do i = 1, n
      tau(i) = merge(tau(i), 0.0_wp, rate(i) < largest(i))
    end do
    do i = 1, n
      if (known(i) > 0.0_wp) cycle
      law = self
      law%viscosity = viscosity(i)
      law%slope = slope(i)
      law%critical = critical(i)
      law%gate = gate(i)
      call law%solve(dt, phi(i), p_trial(i), tau_trial(i), p(i), tau(i), rate(i), good)
      if (.not. good .and. first_bad == 0) first_bad = i
    end do
  end subroutine solve_some

  !> What of a law is the same for all points of a step.
  pure function step_of(law, dt) result(step)
    !> The law.
    class(granular_flow_t), intent(in) :: law
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Its constants.
    type(granular_step_t) :: step

    step%shear = law%shear*dt
    step%bulk = law%bulk*dt
    step%friction = law%friction
    step%rise = law%fast_friction - law%friction
    step%inertial = law%inertial
    step%dilation = law%dilation
    step%inertia = law%grain_density*law%diameter**2
    step%compaction = law%compaction/step%bulk
  end function step_of

  !> Pressure of a plastic shear rate.
  !!
  !! With s = sqrt(p), the balance of volume is a convex cubic in s; Newton's rule falls to its root
  !! from above.
  pure function granular_flow_pressure(self, dt, phi, p_trial, rate) result(p)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Packing fraction.
    real(wp), intent(in) :: phi
    !> Trial pressure. [Pa]
    real(wp), intent(in) :: p_trial
    !> Plastic shear rate g. [1/s]
    real(wp), intent(in) :: rate
    !> The pressure. [Pa]
    real(wp) :: p
    real(wp) :: push, top, ac, s, value, slope, next
    integer :: i

    push = self%bulk*dt*self%dilation*rate
    top = p_trial + push*phi
    p = 0.0_wp
    if (top <= 0.0_wp) return
    s = sqrt(top)
    ac = self%slope*sqrt(self%square(rate))
    if (push > 0.0_wp) then
      do i = 1, 100
        value = (s*s - top)*(s + ac) + push*self%critical*s
        slope = 2.0_wp*s*(s + ac) + (s*s - top) + push*self%critical
        if (.not. slope > 0.0_wp) exit
        next = max(0.0_wp, s - value/slope)
        if (.not. next < s*(1.0_wp - 2.0_wp*epsilon(1.0_wp))) exit
        s = next
      end do
    end if
    p = s*s
    if (phi < self%gate) p = suspended(self, dt, phi, p_trial, rate, p)
  end function granular_flow_pressure

  !> The pressure that grains of a loose packing have: at most C (rho_s d**2 y**2 + 2 eta y).
  pure function suspended(self, dt, phi, p_trial, rate, p_free) result(p)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Packing fraction.
    real(wp), intent(in) :: phi
    !> Trial pressure. [Pa]
    real(wp), intent(in) :: p_trial
    !> Plastic shear rate g. [1/s]
    real(wp), intent(in) :: rate
    !> Pressure without the bound. [Pa]
    real(wp), intent(in) :: p_free
    !> The pressure. [Pa]
    real(wp) :: p
    type(bracket_t) :: search
    real(wp) :: c, over

    c = (self%slope*phi/(self%critical - phi))**2
    p = p_free
    over = p - c*self%square(rate)
    if (over <= 0.0_wp) return
    if (.not. self%compaction > 0.0_wp) then
      p = c*self%square(rate)
      return
    end if
    call search%start(0.0_wp, excess(0.0_wp), p, over)
    do
      p = search%x
      if (search%done .or. search%n > patience) return
      over = excess(p)
      if (abs(over) <= 4.0_wp*epsilon(1.0_wp)*p) return
      call search%take(over)
    end do

  contains

    !> p less its bound, which grows as x2 falls below 0.
    pure function excess(pressure) result(value)
      !> Pressure. [Pa]
      real(wp), intent(in) :: pressure
      !> The excess. [Pa]
      real(wp) :: value
      real(wp) :: s, ac, x2

      s = sqrt(pressure)
      ac = self%slope*sqrt(self%square(rate))
      x2 = (pressure - p_trial)/(self%bulk*dt)
      x2 = x2 - self%dilation*rate*(phi - self%critical*s/max(s + ac, tiny(s)))
      value = pressure - c*self%square(rate - self%compaction*min(x2, 0.0_wp))
    end function excess

  end function suspended

  !> Largest shear stress, (mu + beta) p, or 0.
  pure function granular_flow_strength(self, phi, p, rate) result(strength)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Packing fraction.
    real(wp), intent(in) :: phi
    !> Pressure. [Pa]
    real(wp), intent(in) :: p
    !> Plastic shear rate. [1/s]
    real(wp), intent(in) :: rate
    !> The strength. [Pa]
    real(wp) :: strength
    real(wp) :: c, s

    strength = 0.0_wp
    if (.not. p > 0.0_wp) return
    c = sqrt(self%square(rate))
    s = sqrt(p)
    strength = self%friction + self%dilation*(phi - self%critical*s/(s + self%slope*c))
    if (c > 0.0_wp) then
      strength = strength + (self%fast_friction - self%friction)*c/(c + self%inertial*s) &
                 + 2.5_wp*phi*rate*self%viscosity/(self%slope*c*s)
    end if
    strength = max(0.0_wp, strength*p)
  end function granular_flow_strength

  !> c**2 = rho_s d**2 g**2 + 2 eta g.
  pure function granular_flow_square(self, rate) result(square)
    !> The law.
    class(granular_flow_t), intent(in) :: self
    !> Rate g. [1/s]
    real(wp), intent(in) :: rate
    !> The square. [Pa]
    real(wp) :: square

    square = self%grain_density*(self%diameter*rate)**2 + 2.0_wp*self%viscosity*rate
  end function granular_flow_square

end module mpm_granular_flow
