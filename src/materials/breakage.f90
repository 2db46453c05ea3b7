!> Breakage mechanics of a sand: elastic energy, yield, flow, and the plastic step.
!!
!! With Ee = (Be - I)/2, ev = tr Ee, es = sqrt(2 Ee':Ee'/3), rr = rho/rho_0 and
!! A = -K/2 (ev + e0 ln(1 - ev/e0)), the energy per volume is rr (1 - theta B) p_r Phi with
!! Phi = 2 A**3/(3 K) + 3/2 G A es**2 + G/4 sqrt(3 K G) es**3, and its share E_B = rr theta p_r Phi
!! is what breakage can set free.
module mpm_breakage
  use mpm_bracket, only: bracket_t
  use mpm_deformation, only: identity
  use mpm_kinds, only: wp
  implicit none
  private
  public :: breakage_state_t, breakage_t

  !> Volume strain e0 by which the energy starts smoothly.
  real(wp), parameter :: smooth = 1.0e-3_wp
  !> Largest breakage: all grains are as small as they get.
  real(wp), parameter :: broken = 1.0_wp - 1.0e-9_wp
  !> Yield up to which a state counts as elastic.
  real(wp), parameter :: tolerance = 1.0e-11_wp
  !> Largest change of B or phi along one direction of flow.
  real(wp), parameter :: largest_change = 0.02_wp
  !> Elastic strain, over that of the trial state, that counts as none.
  real(wp), parameter :: vanished = 1.0e-8_wp
  !> Size of the shear part of Be, which is near 1, that is lost in rounding.
  real(wp), parameter :: unresolved = 4.0_wp*epsilon(1.0_wp)
  !> Directions of flow until a step counts as failed.
  integer, parameter :: patience = 2000

  !> Constants.
  type :: breakage_t
    !> Reference pressure p_r. [Pa]
    real(wp) :: pressure = 0.0_wp
    !> Elastic constants K and G.
    real(wp) :: bulk = 0.0_wp, shear = 0.0_wp
    !> Critical breakage energy E_c. [J/m3]
    real(wp) :: energy = 0.0_wp
    !> Critical state stress ratio M_0.
    real(wp) :: friction = 0.0_wp
    !> Dilation factor gamma.
    real(wp) :: dilation = 0.0_wp
    !> Lowest and highest porosity without breakage.
    real(wp) :: limits(2) = 0.0_wp
    !> Exponents of both.
    real(wp) :: powers(2) = 0.0_wp
    !> Grading index theta.
    real(wp) :: grading = 0.0_wp
    !> Density of the solid. [kg/m3]
    real(wp) :: density = 0.0_wp
  contains
    !> Bring a trial state back.
    procedure :: flow => breakage_flow
    !> Stress and energy of a state.
    procedure :: respond => breakage_respond
    !> Yield.
    procedure :: yield => breakage_yield
    !> Elastic energy over (1 - theta B) p_r.
    procedure :: stored => breakage_stored
    !> Porosities between which the grains touch.
    procedure :: porosities => breakage_porosities
    !> Modulus of a longitudinal wave, at most.
    procedure :: modulus => breakage_modulus
  end type breakage_t

  !> State of a point.
  type :: breakage_state_t
    !> Elastic left Cauchy-Green tensor.
    real(wp) :: be(3, 3) = identity
    !> Breakage B.
    real(wp) :: breakage = 0.0_wp
    !> Porosity phi, which changes with the plastic volume.
    real(wp) :: porosity = 0.0_wp
  end type breakage_state_t

  !> Yield of a state and what it is made of.
  type :: level_t
    !> Elastic at and below 0; -1 without stress, 1 under shear alone.
    real(wp) :: y = -1.0_wp
    !> -tr T/3. [Pa]
    real(wp) :: p = 0.0_wp
    !> sqrt(3 s:s/2). [Pa]
    real(wp) :: q = 0.0_wp
    !> Share of the energy to crush that is there.
    real(wp) :: free = 0.0_wp
    !> 1 - B.
    real(wp) :: left = 1.0_wp
    !> Relative density.
    real(wp) :: r = 0.0_wp
    !> Ratio of stresses due to dilation.
    real(wp) :: dilatancy = 0.0_wp
    !> Largest q without crushing. [Pa]
    real(wp) :: bound = 0.0_wp
  end type level_t

  !> A right angle.
  real(wp), parameter :: quarter_turn = acos(0.0_wp)

contains

  !> Components xx yy zz xy yz zx of a symmetric tensor.
  pure function six_of(tensor) result(six)
    !> The tensor.
    real(wp), intent(in) :: tensor(3, 3)
    !> Its components.
    real(wp) :: six(6)

    six = [tensor(1, 1), tensor(2, 2), tensor(3, 3), tensor(1, 2), tensor(2, 3), tensor(3, 1)]
  end function six_of

  !> Symmetric tensor of components xx yy zz xy yz zx.
  pure function full_of(six) result(tensor)
    !> Its components.
    real(wp), intent(in) :: six(6)
    !> The tensor.
    real(wp) :: tensor(3, 3)

    tensor(:, 1) = [six(1), six(4), six(6)]
    tensor(:, 2) = [six(4), six(2), six(5)]
    tensor(:, 3) = [six(6), six(5), six(3)]
  end function full_of

  !> Product of two symmetric tensors that commute, which is symmetric.
  pure function product_of(a, b) result(six)
    !> First factor, components as of `six_of`.
    real(wp), intent(in) :: a(6)
    !> Second factor.
    real(wp), intent(in) :: b(6)
    !> The product.
    real(wp) :: six(6)

    six(1) = a(1)*b(1) + a(4)*b(4) + a(6)*b(6)
    six(2) = a(4)*b(4) + a(2)*b(2) + a(5)*b(5)
    six(3) = a(6)*b(6) + a(5)*b(5) + a(3)*b(3)
    six(4) = a(1)*b(4) + a(4)*b(2) + a(6)*b(5)
    six(5) = a(4)*b(6) + a(2)*b(5) + a(5)*b(3)
    six(6) = a(6)*b(1) + a(5)*b(4) + a(3)*b(6)
  end function product_of

  !> Elastic strains of a state: ev, es, A.
  pure subroutine strains(self, be, ev, es, a)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Elastic left Cauchy-Green tensor, components as of `six_of`.
    real(wp), intent(in) :: be(6)
    !> Volume strain, below 0 in compression.
    real(wp), intent(out) :: ev
    !> Shear strain.
    real(wp), intent(out) :: es
    !> A.
    real(wp), intent(out) :: a
    real(wp) :: mean

    ! Less 1 before they are added: strains are small.
    mean = ((be(1) - 1.0_wp) + (be(2) - 1.0_wp) + (be(3) - 1.0_wp))/3.0_wp
    ev = 1.5_wp*mean
    es = sqrt((sum(((be(1:3) - 1.0_wp) - mean)**2) + 2.0_wp*sum(be(4:6)**2))/6.0_wp)
    a = 0.0_wp
    if (ev < 0.0_wp) a = max(0.0_wp, -0.5_wp*self%bulk*(ev + smooth*log(1.0_wp - ev/smooth)))
  end subroutine strains

  !> Elastic energy over (1 - theta B) p_r, per volume of solid.
  pure function breakage_stored(self, be) result(phi)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Elastic left Cauchy-Green tensor.
    real(wp), intent(in) :: be(3, 3)
    !> Phi.
    real(wp) :: phi
    real(wp) :: ev, es, a

    call strains(self, six_of(be), ev, es, a)
    phi = energy_of(self, ev, es, a)
  end function breakage_stored

  !> Elastic energy of strains over (1 - theta B) p_r, per volume of solid.
  pure function energy_of(self, ev, es, a) result(phi)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Volume strain.
    real(wp), intent(in) :: ev
    !> Shear strain.
    real(wp), intent(in) :: es
    !> A.
    real(wp), intent(in) :: a
    !> Phi.
    real(wp) :: phi

    phi = 2.0_wp*a**3/(3.0_wp*self%bulk) + 1.5_wp*self%shear*a*es**2 &
          + 0.25_wp*self%shear*sqrt(3.0_wp*self%bulk*self%shear)*es**3
    if (ev >= 0.0_wp) phi = 0.0_wp
  end function energy_of

  !> Stress of a state; 0 in tension.
  pure subroutine breakage_respond(self, state, rr, t, p, q)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> Stress. [Pa]
    real(wp), intent(out) :: t(3, 3)
    !> -tr T/3. [Pa]
    real(wp), intent(out) :: p
    !> sqrt(3 s:s/2). [Pa]
    real(wp), intent(out) :: q
    real(wp) :: six(6), phi

    call stress_of(self, six_of(state%be), state%breakage, rr, six, p, q, phi)
    t = full_of(six)
  end subroutine breakage_respond

  !> Stress and energy of a state; 0 in tension.
  pure subroutine stress_of(self, be, breakage, rr, t, p, q, phi)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Elastic left Cauchy-Green tensor, components as of `six_of`.
    real(wp), intent(in) :: be(6)
    !> Breakage B.
    real(wp), intent(in) :: breakage
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> Stress, components as of `six_of`. [Pa]
    real(wp), intent(out) :: t(6)
    !> -tr T/3. [Pa]
    real(wp), intent(out) :: p
    !> sqrt(3 s:s/2). [Pa]
    real(wp), intent(out) :: q
    !> Elastic energy over (1 - theta B) p_r.
    real(wp), intent(out) :: phi
    real(wp) :: ev, es, a, c, spherical, factor(6)

    t = 0.0_wp
    p = 0.0_wp
    q = 0.0_wp
    phi = 0.0_wp
    call strains(self, be, ev, es, a)
    if (ev >= 0.0_wp) return
    phi = energy_of(self, ev, es, a)
    c = rr*(1.0_wp - self%grading*breakage)*self%pressure
    spherical = c*(2.0_wp*a**2/self%bulk + 1.5_wp*self%shear*es**2) &
                *(-self%bulk*ev)/(2.0_wp*(smooth - ev))
    ! 2 q/(3 es) without the division.
    c = 2.0_wp*c*self%shear*(a + 0.25_wp*sqrt(3.0_wp*self%bulk*self%shear)*es)
    factor(1:3) = c*(0.5_wp*(be(1:3) - 1.0_wp) - ev/3.0_wp) - spherical
    factor(4:6) = 0.5_wp*c*be(4:6)
    t = product_of(factor, be)
    p = -(t(1) + t(2) + t(3))/3.0_wp
    q = sqrt(1.5_wp*(sum((t(1:3) + p)**2) + 2.0_wp*sum(t(4:6)**2)))
  end subroutine stress_of

  !> Porosities between which the grains touch.
  pure function breakage_porosities(self, breakage) result(limits)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Breakage B.
    real(wp), intent(in) :: breakage
    !> Lowest and highest.
    real(wp) :: limits(2)

    limits = self%limits*exp(self%powers*log(1.0_wp - min(breakage, broken)))
  end function breakage_porosities

  !> Yield, and the volume, shear and breakage rates of flow per unit of its multiplier.
  pure subroutine breakage_yield(self, state, rr, y, rates, t, q)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> Yield: elastic at and below 0.
    real(wp), intent(out) :: y
    !> Rates of plastic volume, plastic shear, B. [-, -, -]
    real(wp), intent(out) :: rates(3)
    !> Stress. [Pa]
    real(wp), intent(out) :: t(3, 3)
    !> Its q. [Pa]
    real(wp), intent(out) :: q
    type(level_t) :: level
    real(wp) :: six(6)

    call find_level(self, state, rr, level, six)
    call find_rates(self, level, rates)
    t = full_of(six)
    y = level%y
    q = level%q
  end subroutine breakage_yield

  !> Yield and what it is made of.
  pure subroutine find_level(self, state, rr, level, t)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> The yield.
    type(level_t), intent(out) :: level
    !> Stress, components as of `six_of`. [Pa]
    real(wp), intent(out) :: t(6)
    real(wp), parameter :: offset = 2.0_wp*quarter_turn/15.0_wp
    real(wp) :: phi, limits(2), sine

    call stress_of(self, six_of(state%be), state%breakage, rr, t, level%p, level%q, phi)
    if (.not. (level%q > 0.0_wp .or. abs(level%p) > 0.0_wp)) return
    level%y = 1.0_wp
    if (level%p <= 0.0_wp) return
    level%left = 1.0_wp - min(state%breakage, broken)
    level%free = rr*self%grading*self%pressure*phi/self%energy*level%left**2
    limits = self%porosities(state%breakage)
    level%r = (limits(2) - state%porosity)/max(limits(2) - limits(1), tiny(1.0_wp)/epsilon(1.0_wp))
    ! Sine of the offset and the angle of friction together.
    sine = 3.0_wp*self%friction/(6.0_wp + self%friction)
    sine = cos(offset)*sine + sin(offset)*sqrt(1.0_wp - sine**2)
    level%dilatancy = self%dilation*level%r - sqrt(level%free)
    level%dilatancy = level%dilatancy*(6.0_wp*sine/(3.0_wp - sine) - self%friction)
    level%bound = max(self%friction + level%dilatancy, 1.0e-3_wp*self%friction)*level%p
    level%y = level%free + (level%q/level%bound)**2 - 1.0_wp
  end subroutine find_level

  !> Rates of flow per unit of its multiplier. Only their ratios count; these are of strains.
  pure subroutine find_rates(self, level, rates)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> The yield.
    type(level_t), intent(in) :: level
    !> Rates of plastic volume, plastic shear, B. [-, -, -]
    real(wp), intent(out) :: rates(3)
    real(wp) :: share, crush, sheared

    rates = 0.0_wp
    if (level%y <= -1.0_wp) return
    if (level%p <= 0.0_wp) then
      ! Shear alone tears the grains apart: it flows until they are pressed together.
      rates = [1.0_wp, 1.0_wp, 0.0_wp]
      return
    end if
    share = sin(quarter_turn*(1.0_wp - max(0.0_wp, min(1.0_wp, level%r))))**2
    crush = level%free*share*level%p/(level%p**2 + level%q**2)
    sheared = level%q/level%bound*(level%p/level%bound)
    rates(1) = -crush*level%p + sheared*level%dilatancy
    rates(2) = crush*level%q + sheared
    rates(3) = level%left**2*(1.0_wp - share)/self%energy*level%p
  end subroutine find_rates

  !> Bring a trial state back to the yield surface along directions of flow.
  pure subroutine breakage_flow(self, rr, state, t, good)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> The state, a trial one on entry.
    type(breakage_state_t), intent(inout) :: state
    !> Stress. [Pa]
    real(wp), intent(out) :: t(3, 3)
    !> Whether a state was found.
    logical, intent(out) :: good
    type(breakage_state_t) :: next
    type(level_t) :: level
    real(wp) :: rates(3), direction(6), far, start, six(6), mean, sheared
    logical :: found
    integer :: i

    good = .true.
    start = norm2(state%be - identity)
    do i = 1, patience
      call find_level(self, state, rr, level, six)
      t = full_of(six)
      if (level%y <= tolerance) return
      if (norm2(state%be - identity) < vanished*start) then
        ! Contraction has taken all of the pressure, and with it the strength.
        state%be = identity
        t = 0.0_wp
        return
      end if
      mean = (state%be(1, 1) + state%be(2, 2) + state%be(3, 3))/3.0_wp
      sheared = norm2(state%be - mean*identity)
      if (sheared > 0.0_wp .and. sheared <= unresolved) then
        ! Hardly any pressure: one unit in the last place of shear is more than it bears.
        state%be = mean*identity
        cycle
      end if
      call find_rates(self, level, rates)
      call direct(state, rates, six, level%q, direction, far)
      call follow_secants(self, rr, state, level%y, rates, direction, far, next, six, found)
      if (.not. found) then
        call follow_bracket(self, rr, state, level%y, rates, direction, far, next, six, found)
      end if
      state = next
      t = full_of(six)
      if (found) return
    end do
    good = .false.
  end subroutine breakage_flow

  !> Look for the yield surface by secants: few values, where it is near.
  pure subroutine follow_secants(self, rr, state, y, rates, direction, far, next, t, found)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Its yield, above 0.
    real(wp), intent(in) :: y
    !> Rates of plastic volume, plastic shear, B.
    real(wp), intent(in) :: rates(3)
    !> -dBe per unit of the multiplier.
    real(wp), intent(in) :: direction(6)
    !> Largest multiplier.
    real(wp), intent(in) :: far
    !> The state on the surface, if it is found.
    type(breakage_state_t), intent(out) :: next
    !> Its stress, components as of `six_of`. [Pa]
    real(wp), intent(out) :: t(6)
    !> Whether it is found.
    logical, intent(out) :: found
    !> Values until the bracket is the better rule; first way over the largest one.
    integer, parameter :: most = 8
    real(wp), parameter :: first_way = 1.0e-3_wp
    type(level_t) :: level
    real(wp) :: x(0:1), values(0:1), slope
    integer :: i

    found = .false.
    x = [0.0_wp, first_way*far]
    values = y
    do i = 1, most
      next = moved(state, rates, direction, x(1))
      call find_level(self, next, rr, level, t)
      values(1) = level%y
      found = abs(values(1)) <= tolerance
      if (found .or. .not. abs(x(1) - x(0)) > 0.0_wp) return
      slope = (values(1) - values(0))/(x(1) - x(0))
      if (.not. slope < 0.0_wp) return
      x = [x(1), x(1) - values(1)/slope]
      values(0) = values(1)
      if (.not. (x(1) > 0.0_wp .and. x(1) < far)) return
    end do
  end subroutine follow_secants

  !> Go along a direction of flow to the yield surface, or as far as it may be followed.
  pure subroutine follow_bracket(self, rr, state, y, rates, direction, far, next, t, found)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Its yield, above 0.
    real(wp), intent(in) :: y
    !> Rates of plastic volume, plastic shear, B.
    real(wp), intent(in) :: rates(3)
    !> -dBe per unit of the multiplier.
    real(wp), intent(in) :: direction(6)
    !> Largest multiplier.
    real(wp), intent(in) :: far
    !> The state there.
    type(breakage_state_t), intent(out) :: next
    !> Its stress, components as of `six_of`. [Pa]
    real(wp), intent(out) :: t(6)
    !> Whether it does not yield.
    logical, intent(out) :: found
    type(level_t) :: level
    type(bracket_t) :: search

    next = moved(state, rates, direction, far)
    call find_level(self, next, rr, level, t)
    found = level%y <= tolerance
    if (.not. found) return
    call search%start(0.0_wp, y, far, min(level%y, -tolerance))
    do while (.not. search%done .and. search%n < 200)
      next = moved(state, rates, direction, search%x)
      call find_level(self, next, rr, level, t)
      if (abs(level%y) <= tolerance) exit
      call search%take(level%y)
    end do
    if (level%y > tolerance) then
      ! Strains near nothing have too few digits for the tolerance: the end that does not yield.
      next = moved(state, rates, direction, search%b)
      call find_level(self, next, rr, level, t)
    end if
  end subroutine follow_bracket

  !> Direction of flow of the elastic strain, and how far it may be followed.
  pure subroutine direct(state, rates, t, q, direction, far)
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Rates of plastic volume, plastic shear, B.
    real(wp), intent(in) :: rates(3)
    !> Stress, components as of `six_of`. [Pa]
    real(wp), intent(in) :: t(6)
    !> Its q. [Pa]
    real(wp), intent(in) :: q
    !> -dBe per unit of the multiplier, components as of `six_of`.
    real(wp), intent(out) :: direction(6)
    !> Largest multiplier.
    real(wp), intent(out) :: far
    real(wp), parameter :: share = 0.5_wp
    real(wp) :: s(6), be(6), strain(6), volume, shear

    be = six_of(state%be)
    strain = be
    strain(1:3) = strain(1:3) - 1.0_wp
    direction = (2.0_wp/3.0_wp)*rates(1)*be
    if (q > 0.0_wp) then
      s = t
      s(1:3) = s(1:3) - (t(1) + t(2) + t(3))/3.0_wp
      direction = direction + product_of((3.0_wp*rates(2)/q)*s, be)
    end if
    far = huge(1.0_wp)
    volume = sum(direction(1:3))
    if (volume < 0.0_wp) far = share*sum(strain(1:3))/volume
    far = min(far, share*sqrt(contraction(strain, strain)/contraction(direction, direction)))
    strain(1:3) = strain(1:3) - sum(strain(1:3))/3.0_wp
    shear = contraction(strain, direction)
    if (shear > 0.0_wp) far = min(far, share*contraction(strain, strain)/shear)
    if (rates(3) > 0.0_wp) then
      far = min(far, min(largest_change, 1.0_wp - min(state%breakage, broken))/rates(3))
    end if
    if (abs(rates(1)) > 0.0_wp) far = min(far, largest_change/abs(rates(1)))
  end subroutine direct

  !> Sum over all components of the product of two symmetric tensors.
  pure function contraction(a, b) result(total)
    !> First tensor, components as of `six_of`.
    real(wp), intent(in) :: a(6)
    !> Second tensor.
    real(wp), intent(in) :: b(6)
    !> The sum.
    real(wp) :: total

    total = sum(a(1:3)*b(1:3)) + 2.0_wp*sum(a(4:6)*b(4:6))
  end function contraction

  !> A state some way along a direction of flow.
  pure function moved(state, rates, direction, way) result(next)
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Rates of plastic volume, plastic shear, B.
    real(wp), intent(in) :: rates(3)
    !> -dBe per unit of the multiplier.
    real(wp), intent(in) :: direction(6)
    !> The multiplier.
    real(wp), intent(in) :: way
    !> The state there.
    type(breakage_state_t) :: next

    next%be = state%be - way*full_of(direction)
    next%breakage = min(state%breakage + way*rates(3), broken)
    next%porosity = 1.0_wp - (1.0_wp - state%porosity)*exp(-way*rates(1))
  end function moved

  !> Modulus of a longitudinal wave, at most, at least that of the pressure which crushes.
  pure function breakage_modulus(self, state, rr) result(modulus)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> The modulus. [Pa]
    real(wp) :: modulus
    real(wp) :: ev, es, a, x, g, crushing, now

    call strains(self, six_of(state%be), ev, es, a)
    x = max(0.0_wp, -ev)
    g = sqrt(3.0_wp*self%bulk*self%shear)
    now = self%bulk*a + (a**2 + 0.75_wp*self%bulk*self%shear*es**2)*smooth/(smooth + x)**2 &
          + 4.0_wp/3.0_wp*self%shear*(a + 0.5_wp*g*es) + 2.0_wp*self%bulk*self%shear*es
    if (ev >= 0.0_wp) now = 0.0_wp
    crushing = (1.5_wp*self%bulk*self%energy/(self%grading*self%pressure*rr))**(1.0_wp/3.0_wp)
    crushing = crushing*(self%bulk + 4.0_wp/3.0_wp*self%shear)
    modulus = rr*self%pressure*(1.0_wp + 2.0_wp*x)*max(now, crushing)
  end function breakage_modulus

end module mpm_breakage
