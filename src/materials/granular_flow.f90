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
!! each g there is one p, and tau - strength falls from g = 0 to tau = 0.
module mpm_granular_flow
  use mpm_bracket, only: bracket_t
  use mpm_kinds, only: wp
  implicit none
  private
  public :: granular_flow_t

  !> Values of a search that many points make in step.
  integer, parameter :: lockstep = 24
  !> Missing shear stress over the trial stress at which a point is found.
  real(wp), parameter :: tolerance = 1.0e-13_wp
  !> Change of the square root of a pressure after which one more step of Newton is exact.
  real(wp), parameter :: near = 1.0e-9_wp
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
  !! The search of `solve`, in step for all points that flow, from the shear rates of the last step.
  !! Points in which a loose packing has to be searched for as well, and the few that are not found
  !! in step, are left to `solve`.
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
    !> Pressures. [Pa] (n)
    real(wp), intent(out) :: p(n)
    !> Shear stresses. [Pa] (n)
    real(wp), intent(out) :: tau(n)
    !> Plastic shear rates, of the last step on entry. [1/s] (n)
    real(wp), intent(inout) :: rate(n)
    !> First point without a solution; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: p_found(n), tau_found(n), guess(n)
    type(granular_flow_t) :: law
    integer :: list(n), m, i, k
    logical :: found(n), good

    m = 0
    first_bad = 0
    do i = 1, n
      if (phi(i) < gate(i) .and. self%compaction > 0.0_wp) then
        law = law_of(i)
        call law%solve(dt, phi(i), p_trial(i), tau_trial(i), p(i), tau(i), rate(i), good)
        if (.not. good .and. first_bad == 0) first_bad = i
        cycle
      end if
      p(i) = max(0.0_wp, p_trial(i))
      if (phi(i) < gate(i)) p(i) = 0.0_wp
      tau(i) = tau_trial(i)
      if (tau(i) > max(0.0_wp, self%friction + self%dilation*(phi(i) - critical(i)))*p(i)) then
        m = m + 1
        list(m) = i
      else
        rate(i) = 0.0_wp
      end if
    end do
    if (m == 0) return
    guess(:m) = rate(list(:m))
    call search_in_step(self, m, dt, viscosity(list(:m)), slope(list(:m)), critical(list(:m)), &
                        gate(list(:m)), phi(list(:m)), p_trial(list(:m)), tau_trial(list(:m)), &
                        guess(:m), p_found(:m), tau_found(:m), found(:m))
    do k = 1, m
      i = list(k)
      if (found(k)) then
        p(i) = p_found(k)
        tau(i) = tau_found(k)
        rate(i) = guess(k)
      else
        law = law_of(i)
        call law%solve(dt, phi(i), p_trial(i), tau_trial(i), p(i), tau(i), rate(i), good)
        if (.not. good .and. first_bad == 0) first_bad = i
      end if
    end do

  contains

    !> The law of a point.
    pure function law_of(point) result(law)
      !> The point.
      integer, intent(in) :: point
      !> Its law.
      type(granular_flow_t) :: law

      law = self
      law%viscosity = viscosity(point)
      law%slope = slope(point)
      law%critical = critical(point)
      law%gate = gate(point)
    end function law_of

  end subroutine granular_flow_solve_block

  !> Search the shear rates of points in step: false position with the weights of Anderson and
  !! Bjorck.
  pure subroutine search_in_step(law, m, dt, eta, incline, critical, gate, phi, p_trial, &
                                 tau_trial, x, p, tau, found)
    !> The law.
    class(granular_flow_t), intent(in) :: law
    !> Number of points.
    integer, intent(in) :: m
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Viscosities. [Pa s] (m)
    real(wp), intent(in) :: eta(m)
    !> Slopes a of the packing law. (m)
    real(wp), intent(in) :: incline(m)
    !> Critical packing fractions. (m)
    real(wp), intent(in) :: critical(m)
    !> Packing fractions from which grains carry pressure at rest. (m)
    real(wp), intent(in) :: gate(m)
    !> Packing fractions. (m)
    real(wp), intent(in) :: phi(m)
    !> Trial pressures. [Pa] (m)
    real(wp), intent(in) :: p_trial(m)
    !> Trial shear stresses. [Pa] (m)
    real(wp), intent(in) :: tau_trial(m)
    !> Shear rates, guesses on entry. [1/s] (m)
    real(wp), intent(inout) :: x(m)
    !> Pressures. [Pa] (m)
    real(wp), intent(out) :: p(m)
    !> Shear stresses. [Pa] (m)
    real(wp), intent(out) :: tau(m)
    !> Whether a point has its solution. (m)
    logical, intent(out) :: found(m)
    real(wp) :: a(m), b(m), fa(m), fb(m), f(m), moved(m), weight, next, steep
    integer :: i, k
    logical :: up

    steep = 1.0_wp/(law%shear*dt)
    a = 0.0_wp
    b = tau_trial*steep
    call missing_strength(law, m, dt, eta, incline, critical, gate, phi, p_trial, tau_trial, &
                          a, p, tau, fa)
    call missing_strength(law, m, dt, eta, incline, critical, gate, phi, p_trial, tau_trial, &
                          b, p, tau, fb)
    moved = 0.0_wp
    do i = 1, m
      ! Without strength at the other end there is none left, as in `solve`.
      if (.not. fb(i) < 0.0_wp) x(i) = b(i)
      found(i) = .not. (fa(i) > 0.0_wp .and. x(i) > 0.0_wp .and. x(i) < b(i))
      if (found(i) .and. fb(i) < 0.0_wp .and. fa(i) > 0.0_wp) then
        x(i) = b(i)*(fa(i)/(fa(i) - fb(i)))
      end if
    end do
    ! Those with a guess take the steepest elastic step from it, which ends beyond the solution.
    call missing_strength(law, m, dt, eta, incline, critical, gate, phi, p_trial, tau_trial, &
                          x, p, tau, f)
    do k = 1, lockstep
      do i = 1, m
        up = f(i) > 0.0_wp
        next = x(i) + f(i)*steep
        weight = merge(1.0_wp - f(i)/merge(fa(i), 1.0_wp, fa(i) > 0.0_wp), &
                       1.0_wp - f(i)/merge(fb(i), -1.0_wp, fb(i) < 0.0_wp), up)
        weight = merge(weight, 0.5_wp, weight > 0.0_wp)
        weight = merge(weight, 1.0_wp, merge(moved(i), -moved(i), up) > 0.0_wp)
        fb(i) = merge(weight*fb(i), f(i), up)
        fa(i) = merge(f(i), weight*fa(i), up)
        a(i) = merge(x(i), a(i), up)
        b(i) = merge(b(i), x(i), up)
        moved(i) = merge(1.0_wp, -1.0_wp, up)
        if (k > 1 .or. found(i)) then
          next = a(i) + (b(i) - a(i))*(fa(i)/merge(fa(i) - fb(i), 1.0_wp, fa(i) > fb(i)))
        end if
        next = merge(next, 0.5_wp*(a(i) + b(i)), next > a(i) .and. next < b(i))
        x(i) = merge(x(i), next, abs(f(i)) <= tolerance*max(abs(p_trial(i)), tau_trial(i)))
      end do
      call missing_strength(law, m, dt, eta, incline, critical, gate, phi, p_trial, tau_trial, &
                          x, p, tau, f)
      found = abs(f) <= tolerance*max(abs(p_trial), tau_trial)
      if (all(found)) exit
    end do
    ! Nothing is left at the largest rate, but for a rounding.
    tau = merge(tau, 0.0_wp, x < tau_trial*steep)
  end subroutine search_in_step

  !> Shear stresses less strengths of plastic shear rates, for many points at a time.
  pure subroutine missing_strength(law, m, dt, eta, incline, critical, gate, phi, p_trial, &
                                   tau_trial, rate, p, tau, missing)
    !> The law.
    class(granular_flow_t), intent(in) :: law
    !> Number of points.
    integer, intent(in) :: m
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Viscosities. [Pa s] (m)
    real(wp), intent(in) :: eta(m)
    !> Slopes a of the packing law. (m)
    real(wp), intent(in) :: incline(m)
    !> Critical packing fractions. (m)
    real(wp), intent(in) :: critical(m)
    !> Packing fractions from which grains carry pressure at rest. (m)
    real(wp), intent(in) :: gate(m)
    !> Packing fractions. (m)
    real(wp), intent(in) :: phi(m)
    !> Trial pressures. [Pa] (m)
    real(wp), intent(in) :: p_trial(m)
    !> Trial shear stresses. [Pa] (m)
    real(wp), intent(in) :: tau_trial(m)
    !> Plastic shear rates. [1/s] (m)
    real(wp), intent(in) :: rate(m)
    !> Pressures. [Pa] (m)
    real(wp), intent(out) :: p(m)
    !> Shear stresses. [Pa] (m)
    real(wp), intent(out) :: tau(m)
    !> tau - strength. [Pa] (m)
    real(wp), intent(out) :: missing(m)
    real(wp) :: c(m), s(m), top(m), push(m), ac, value, slope, next, worst, bound
    integer :: i, k

    do i = 1, m
      c(i) = sqrt(law%grain_density*(law%diameter*rate(i))**2 + 2.0_wp*eta(i)*rate(i))
      push(i) = law%bulk*dt*law%dilation*rate(i)
      top(i) = max(0.0_wp, p_trial(i) + push(i)*phi(i))
      s(i) = sqrt(top(i))
    end do
    ! As in `pressure`.
    do k = 1, 100
      worst = 0.0_wp
      do i = 1, m
        ac = s(i) + incline(i)*c(i)
        value = (s(i)*s(i) - top(i))*ac + push(i)*critical(i)*s(i)
        slope = 2.0_wp*s(i)*ac + (s(i)*s(i) - top(i)) + push(i)*critical(i)
        next = s(i) - value/merge(slope, 1.0_wp, slope > 0.0_wp)
        next = merge(max(0.0_wp, min(s(i), next)), s(i), slope > 0.0_wp)
        worst = max(worst, s(i) - next - near*s(i))
        s(i) = next
      end do
      if (worst <= 0.0_wp) exit
    end do
    do i = 1, m
      bound = (incline(i)*phi(i)/merge(critical(i) - phi(i), 1.0_wp, phi(i) < gate(i)))**2
      p(i) = s(i)*s(i)
      p(i) = merge(min(p(i), bound*c(i)*c(i)), p(i), phi(i) < gate(i))
      s(i) = sqrt(p(i))
      ac = merge(c(i)*s(i), 1.0_wp, c(i) > 0.0_wp .and. s(i) > 0.0_wp)
      value = s(i)/merge(s(i) + incline(i)*c(i), 1.0_wp, s(i) > 0.0_wp)
      value = law%friction + law%dilation*(phi(i) - critical(i)*value)
      slope = (law%fast_friction - law%friction)*c(i)/merge(c(i) + law%inertial*s(i), 1.0_wp, &
                                                            c(i) > 0.0_wp)
      next = 2.5_wp*phi(i)*rate(i)*eta(i)/(incline(i)*ac)
      value = value + merge(slope + next, 0.0_wp, c(i) > 0.0_wp)
      tau(i) = max(0.0_wp, tau_trial(i) - law%shear*dt*rate(i))
      missing(i) = tau(i) - max(0.0_wp, value*p(i))
    end do
  end subroutine missing_strength

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
