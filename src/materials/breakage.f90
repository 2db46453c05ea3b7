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

contains

  !> Elastic strains of a state: ev, es, A.
  pure subroutine strains(self, be, ev, es, a)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Elastic left Cauchy-Green tensor.
    real(wp), intent(in) :: be(3, 3)
    !> Volume strain, below 0 in compression.
    real(wp), intent(out) :: ev
    !> Shear strain.
    real(wp), intent(out) :: es
    !> A.
    real(wp), intent(out) :: a
    real(wp) :: e(3, 3)

    e = 0.5_wp*(be - identity)
    ev = e(1, 1) + e(2, 2) + e(3, 3)
    e = e - (ev/3.0_wp)*identity
    es = sqrt(2.0_wp*sum(e**2)/3.0_wp)
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

    call strains(self, be, ev, es, a)
    phi = 2.0_wp*a**3/(3.0_wp*self%bulk) + 1.5_wp*self%shear*a*es**2 &
          + 0.25_wp*self%shear*sqrt(3.0_wp*self%bulk*self%shear)*es**3
    if (ev >= 0.0_wp) phi = 0.0_wp
  end function breakage_stored

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
    real(wp) :: ev, es, a, c, spherical

    t = 0.0_wp
    p = 0.0_wp
    q = 0.0_wp
    call strains(self, state%be, ev, es, a)
    if (ev >= 0.0_wp) return
    c = rr*(1.0_wp - self%grading*state%breakage)*self%pressure
    spherical = c*(2.0_wp*a**2/self%bulk + 1.5_wp*self%shear*es**2) &
                *(-self%bulk*ev)/(2.0_wp*(smooth - ev))
    ! 2 q/(3 es) without the division.
    c = 2.0_wp*c*self%shear*(a + 0.25_wp*sqrt(3.0_wp*self%bulk*self%shear)*es)
    t = c*(0.5_wp*(state%be - identity) - (ev/3.0_wp)*identity) - spherical*identity
    t = matmul(t, state%be)
    t = 0.5_wp*(t + transpose(t))
    p = -(t(1, 1) + t(2, 2) + t(3, 3))/3.0_wp
    q = sqrt(1.5_wp*sum((t + p*identity)**2))
  end subroutine breakage_respond

  !> Porosities between which the grains touch.
  pure function breakage_porosities(self, breakage) result(limits)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Breakage B.
    real(wp), intent(in) :: breakage
    !> Lowest and highest.
    real(wp) :: limits(2)

    limits = self%limits*(1.0_wp - min(breakage, broken))**self%powers
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
    real(wp), parameter :: quarter_turn = acos(0.0_wp)
    real(wp) :: p, free, limits(2), r, angle, dilatancy, strength, crush, left

    call self%respond(state, rr, t, p, q)
    y = -1.0_wp
    rates = 0.0_wp
    if (.not. (q > 0.0_wp .or. abs(p) > 0.0_wp)) return
    if (p <= 0.0_wp) then
      ! Shear alone tears the grains apart: it flows until they are pressed together.
      y = 1.0_wp
      rates = [1.0_wp, 1.0_wp, 0.0_wp]
      return
    end if
    left = 1.0_wp - min(state%breakage, broken)
    free = rr*self%grading*self%pressure*self%stored(state%be)/self%energy*left**2
    limits = self%porosities(state%breakage)
    r = (limits(2) - state%porosity)/max(limits(2) - limits(1), tiny(1.0_wp)/epsilon(1.0_wp))
    angle = 2.0_wp*quarter_turn/15.0_wp + asin(3.0_wp*self%friction/(6.0_wp + self%friction))
    dilatancy = self%dilation*r - sqrt(free)
    dilatancy = dilatancy*(6.0_wp*sin(angle)/(3.0_wp - sin(angle)) - self%friction)
    strength = max(self%friction + dilatancy, 1.0e-3_wp*self%friction)
    r = max(0.0_wp, min(1.0_wp, r))
    crush = free*sin(quarter_turn*(1.0_wp - r))**2
    y = free + (q/(strength*p))**2 - 1.0_wp
    rates(1) = -crush*(p/(p**2 + q**2)) + (q/(strength*p))*(dilatancy/(strength*p))
    rates(2) = crush*(q/(p**2 + q**2)) + (q/(strength*p))/(strength*p)
    rates(3) = left**2*cos(quarter_turn*(1.0_wp - r))**2/self%energy
    ! Only the ratios count; these are of strains.
    rates = rates*p
  end subroutine breakage_yield

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
    type(bracket_t) :: search
    real(wp) :: rates(3), direction(3, 3), y, y_next, far, q, unused(3), along, start
    integer :: i

    good = .true.
    start = norm2(state%be - identity)
    do i = 1, patience
      call self%yield(state, rr, y, rates, t, q)
      if (y <= tolerance) return
      if (norm2(state%be - identity) < vanished*start) then
        ! Contraction has taken all of the pressure, and with it the strength.
        state%be = identity
        t = 0.0_wp
        return
      end if
      call direct(state, rates, t, q, direction, far)
      next = moved(state, rates, direction, far)
      call self%yield(next, rr, y_next, unused, t, along)
      if (y_next <= tolerance) then
        call search%start(0.0_wp, y, far, min(y_next, -tolerance))
        do while (.not. search%done .and. search%n < 200)
          next = moved(state, rates, direction, search%x)
          call self%yield(next, rr, y_next, unused, t, along)
          if (abs(y_next) <= tolerance) exit
          call search%take(y_next)
        end do
        state = next
        if (y_next <= tolerance) return
      else
        state = next
      end if
    end do
    good = .false.
  end subroutine breakage_flow

  !> Direction of flow of the elastic strain, and how far it may be followed.
  pure subroutine direct(state, rates, t, q, direction, far)
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Rates of plastic volume, plastic shear, B.
    real(wp), intent(in) :: rates(3)
    !> Stress. [Pa]
    real(wp), intent(in) :: t(3, 3)
    !> Its q. [Pa]
    real(wp), intent(in) :: q
    !> -dBe per unit of the multiplier.
    real(wp), intent(out) :: direction(3, 3)
    !> Largest multiplier.
    real(wp), intent(out) :: far
    real(wp), parameter :: share = 0.5_wp
    real(wp) :: s(3, 3), volume, shear

    direction = (2.0_wp/3.0_wp)*rates(1)*state%be
    if (q > 0.0_wp) then
      s = t - (t(1, 1) + t(2, 2) + t(3, 3))/3.0_wp*identity
      s = (1.5_wp*rates(2)/q)*s
      direction = direction + matmul(s, state%be) + matmul(state%be, s)
    end if
    far = huge(1.0_wp)
    volume = sum(direction*identity)
    if (volume < 0.0_wp) far = share*(3.0_wp - sum(state%be*identity))/(-volume)
    far = min(far, share*norm2(state%be - identity)/norm2(direction))
    s = state%be - sum(state%be*identity)/3.0_wp*identity
    shear = sum(s*direction)
    if (shear > 0.0_wp) far = min(far, share*sum(s**2)/shear)
    if (rates(3) > 0.0_wp) then
      far = min(far, min(largest_change, 1.0_wp - min(state%breakage, broken))/rates(3))
    end if
    if (abs(rates(1)) > 0.0_wp) far = min(far, largest_change/abs(rates(1)))
  end subroutine direct

  !> A state some way along a direction of flow.
  pure function moved(state, rates, direction, way) result(next)
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Rates of plastic volume, plastic shear, B.
    real(wp), intent(in) :: rates(3)
    !> -dBe per unit of the multiplier.
    real(wp), intent(in) :: direction(3, 3)
    !> The multiplier.
    real(wp), intent(in) :: way
    !> The state there.
    type(breakage_state_t) :: next

    next%be = state%be - way*direction
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

    call strains(self, state%be, ev, es, a)
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
