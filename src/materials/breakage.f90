!> Breakage mechanics of a sand: elastic energy, stress, yield and flow.
!!
!! With Ee = (Be - I)/2, ev = tr Ee, its deviator Ed, J = Ed:Ed, es = sqrt(2 J/3), rr = rho/rho_0
!! and A = -K/2 (ev + e0 ln(1 - ev/e0)), the energy per volume is rr (1 - theta B) p_r Phi with
!! Phi = 2 A**3/(3 K) + 3/2 G A es**2 + G/4 sqrt(3 K G) es**3, and its share E_B = rr theta p_r Phi
!! is what breakage can set free.
!!
!! The stress is (c Ed - s I) Be with c = 2 C G (A + sqrt(3 K G) es/4), s = C h (2 A**2/K + G J),
!! C = rr (1 - theta B) p_r and h = -dA/dev. With w = 1 + 2 ev/3, a = c w - 2 s and D = tr Ed**3
!! its invariants are
!!
!!     p = s w - 2/3 c J,   q**2 = 3/2 (a**2 J + 4 a c D + 2/3 c**2 J**2).
!!
!! States and what is known of them are arrays with a row for each point, whose columns have names,
!! so that loops over points become vector instructions.
module mpm_breakage
  use mpm_elementary, only: exponentials, log_remainders, logarithms, sines
  use mpm_deformation, only: identity
  use mpm_kinds, only: wp
  implicit none
  private
  public :: breakage_state_t, breakage_t, broken, least_gap, row_of, smooth, weakest, width

  !> Rows of arrays of states: points that are treated together, at most. More than a block has, so
  !! that the columns do not start at the same place of a page each.
  integer, parameter :: width = 136
  !> Columns of states after the six of Be, xx yy zz xy yz zx: B, porosity phi, which changes with
  !! the plastic volume, and density over that of the solid.
  integer, parameter, public :: of_breakage = 7, of_porosity = 8, of_density = 9, n_state = 9
  !> Columns of levels. The yield: elastic at and below 0; -1 without stress, 1 under shear alone.
  integer, parameter, public :: of_y = 1
  !> -tr T/3 [Pa], and the square of q = sqrt(3 s:s/2) [Pa2].
  integer, parameter, public :: of_p = 2, of_square = 3
  !> ev, J, D, es, A, Phi.
  integer, parameter, public :: of_ev = 4, of_j = 5, of_d = 6, of_es = 7, of_a = 8, of_phi = 18
  !> The factors s and c of the stress. [Pa]
  integer, parameter, public :: of_s = 9, of_c = 10
  !> Share of the energy to crush that is there, and 1 - B.
  integer, parameter, public :: of_free = 11, of_left = 12
  !> Porosities between which the grains touch, and where the porosity is between them: 1 at the
  !! lowest.
  integer, parameter, public :: of_low = 13, of_high = 14, of_r = 15
  !> Ratio of stresses due to dilation, and largest q without crushing. [-, Pa]
  integer, parameter, public :: of_dilatancy = 16, of_bound = 17, n_level = 18
  !> Columns of rates of flow per unit of its multiplier: plastic volume, plastic shear, B.
  integer, parameter :: of_volume = 1, of_shear = 2, of_broken = 3

  !> Volume strain e0 by which the energy starts smoothly.
  real(wp), parameter :: smooth = 1.0e-3_wp
  !> Largest breakage: all grains are as small as they get.
  real(wp), parameter :: broken = 1.0_wp - 1.0e-9_wp
  !> Least strength over that of the critical state.
  real(wp), parameter :: weakest = 1.0e-3_wp
  !> Least difference of the porosities between which the grains touch.
  real(wp), parameter :: least_gap = tiny(1.0_wp)/epsilon(1.0_wp)
  !> A right angle.
  real(wp), parameter :: quarter_turn = acos(0.0_wp)

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
    !> Yields of states and what they are made of.
    procedure :: evaluate => breakage_evaluate
    !> Stresses of states.
    procedure :: stresses => breakage_stresses
    !> Rates of flow of states.
    procedure :: rates => breakage_rates
    !> Factor of the ratio of stresses due to dilation.
    procedure :: offset => breakage_offset
    !> Stress of one state.
    procedure :: respond => breakage_respond
    !> Yield of one state.
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

  !> Row of a state.
  pure function row_of(state, rr) result(row)
    !> The state.
    type(breakage_state_t), intent(in) :: state
    !> Density over that of the solid.
    real(wp), intent(in) :: rr
    !> The row.
    real(wp) :: row(n_state)

    row(:6) = six_of(state%be)
    row(of_breakage) = state%breakage
    row(of_porosity) = state%porosity
    row(of_density) = rr
  end function row_of

  !> 1 above 0, or else 0, as a factor: several conditions in a loop would be branches.
  elemental function above_zero(x) result(factor)
    !> A number.
    real(wp), intent(in) :: x
    !> The factor.
    real(wp) :: factor

    factor = 0.5_wp + sign(0.5_wp, x - tiny(1.0_wp))
  end function above_zero

  !> Yields of states and what they are made of.
  pure subroutine breakage_evaluate(self, n, state, level)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(out) :: level(width, n_level)

    call find_strains(self, n, state, level)
    call find_invariants(self, n, state, level)
    level(:n, of_left) = 1.0_wp - min(state(:n, of_breakage), broken)
    call touching(self, n, level(:, of_left), level(:, of_low), level(:, of_high))
    call find_yields(self, n, state, level)
  end subroutine breakage_evaluate

  !> Elastic strains.
  pure subroutine find_strains(self, n, state, level)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(inout) :: level(width, n_level)
    real(wp), parameter :: third = 1.0_wp/3.0_wp
    real(wp) :: z(width), x, y, v, mean, xy, yz, zx
    integer :: i

    do i = 1, n
      ! Less 1 before they are added: strains are small.
      x = state(i, 1) - 1.0_wp
      y = state(i, 2) - 1.0_wp
      v = state(i, 3) - 1.0_wp
      mean = third*(x + y + v)
      level(i, of_ev) = 1.5_wp*mean
      z(i) = max(0.0_wp, -1.5_wp*mean)*(1.0_wp/smooth)
      x = 0.5_wp*(x - mean)
      y = 0.5_wp*(y - mean)
      v = 0.5_wp*(v - mean)
      xy = 0.5_wp*state(i, 4)
      yz = 0.5_wp*state(i, 5)
      zx = 0.5_wp*state(i, 6)
      level(i, of_j) = x*x + y*y + v*v + 2.0_wp*(xy*xy + yz*yz + zx*zx)
      ! Three determinants.
      level(i, of_d) = 3.0_wp*(x*y*v + 2.0_wp*xy*yz*zx - x*yz*yz - y*zx*zx - v*xy*xy)
      level(i, of_es) = sqrt(2.0_wp*third*level(i, of_j))
    end do
    call log_remainders(n, z, level(:, of_a))
    level(:n, of_a) = (0.5_wp*self%bulk*smooth)*level(:n, of_a)
  end subroutine find_strains

  !> Porosities between which the grains touch.
  pure subroutine touching(self, n, left, low, high)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> 1 - B.
    real(wp), intent(in) :: left(width)
    !> Lowest porosity.
    real(wp), intent(out) :: low(width)
    !> Highest porosity.
    real(wp), intent(out) :: high(width)
    real(wp) :: logarithm(width), power(width)

    call logarithms(n, left, logarithm)
    power(:n) = self%powers(1)*logarithm(:n)
    call exponentials(n, power, low)
    power(:n) = self%powers(2)*logarithm(:n)
    call exponentials(n, power, high)
    low(:n) = self%limits(1)*low(:n)
    high(:n) = self%limits(2)*high(:n)
  end subroutine touching

  !> Factors and invariants of the stresses, and the energies; all 0 in tension.
  pure subroutine find_invariants(self, n, state, level)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(inout) :: level(width, n_level)
    real(wp) :: g, g6, compliance, on, scale, h, w, a, j, s, c, phi
    integer :: i

    ! Divisions are slow: none by a constant of the loop.
    g = sqrt(3.0_wp*self%bulk*self%shear)
    g6 = g/6.0_wp
    compliance = 2.0_wp/(3.0_wp*self%bulk)
    do i = 1, n
      a = level(i, of_a)
      j = level(i, of_j)
      scale = state(i, of_density)*(1.0_wp - self%grading*state(i, of_breakage))*self%pressure
      on = above_zero(-level(i, of_ev))
      scale = on*scale
      h = max(0.0_wp, -level(i, of_ev))
      h = 0.5_wp*self%bulk*h/(smooth + h)
      s = scale*h*(3.0_wp*compliance*a*a + self%shear*j)
      c = 2.0_wp*scale*self%shear*(a + 0.25_wp*g*level(i, of_es))
      level(i, of_s) = s
      level(i, of_c) = c
      phi = compliance*a*a*a + self%shear*j*(a + g6*level(i, of_es))
      level(i, of_phi) = on*phi
      w = 1.0_wp + (2.0_wp/3.0_wp)*level(i, of_ev)
      level(i, of_p) = s*w - (2.0_wp/3.0_wp)*c*j
      a = c*w - 2.0_wp*s
      level(i, of_square) = max(0.0_wp, 1.5_wp*(a*(a*j + 4.0_wp*c*level(i, of_d)) &
                                                + (2.0_wp/3.0_wp)*(c*j)**2))
    end do
  end subroutine find_invariants

  !> Factor of the ratio of stresses due to dilation: that of the offset and the angle of friction
  !! together, less that of friction.
  pure function breakage_offset(self) result(factor)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> The factor.
    real(wp) :: factor
    real(wp), parameter :: offset = 2.0_wp*quarter_turn/15.0_wp
    real(wp), parameter :: across = cos(offset), along = sin(offset)
    real(wp) :: sine

    sine = 3.0_wp*self%friction/(6.0_wp + self%friction)
    sine = across*sine + along*sqrt(1.0_wp - sine**2)
    factor = 6.0_wp*sine/(3.0_wp - sine) - self%friction
  end function breakage_offset

  !> Yields.
  pure subroutine find_yields(self, n, state, level)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(inout) :: level(width, n_level)
    real(wp) :: factor, share, on, bound, y, p
    integer :: i

    factor = self%offset()
    share = self%grading*self%pressure/self%energy
    do i = 1, n
      p = level(i, of_p)
      level(i, of_free) = share*state(i, of_density)*level(i, of_phi)*level(i, of_left)**2
      level(i, of_r) = (level(i, of_high) - state(i, of_porosity)) &
                       /max(level(i, of_high) - level(i, of_low), least_gap)
      level(i, of_dilatancy) = factor*(self%dilation*level(i, of_r) - sqrt(level(i, of_free)))
      on = above_zero(p)
      bound = max(self%friction + level(i, of_dilatancy), weakest*self%friction)*p
      level(i, of_bound) = bound
      bound = on*bound + (1.0_wp - on)
      bound = 1.0_wp/bound
      y = on*(level(i, of_free) + level(i, of_square)*bound*bound - 2.0_wp) + 2.0_wp
      level(i, of_y) = above_zero(max(level(i, of_square), abs(p)))*y - 1.0_wp
    end do
  end subroutine find_yields

  !> Stresses of states.
  pure subroutine breakage_stresses(self, n, state, level, t)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(in) :: level(width, n_level)
    !> Stresses, components as of `six_of`. [Pa]
    real(wp), intent(out) :: t(width, 6)
    real(wp) :: third, xx, yy, zz, xy, yz, zx
    integer :: i

    associate (unused => self)
    end associate
    do i = 1, n
      third = level(i, of_ev)/3.0_wp
      xx = level(i, of_c)*(0.5_wp*(state(i, 1) - 1.0_wp) - third) - level(i, of_s)
      yy = level(i, of_c)*(0.5_wp*(state(i, 2) - 1.0_wp) - third) - level(i, of_s)
      zz = level(i, of_c)*(0.5_wp*(state(i, 3) - 1.0_wp) - third) - level(i, of_s)
      xy = 0.5_wp*level(i, of_c)*state(i, 4)
      yz = 0.5_wp*level(i, of_c)*state(i, 5)
      zx = 0.5_wp*level(i, of_c)*state(i, 6)
      t(i, 1) = xx*state(i, 1) + xy*state(i, 4) + zx*state(i, 6)
      t(i, 2) = xy*state(i, 4) + yy*state(i, 2) + yz*state(i, 5)
      t(i, 3) = zx*state(i, 6) + yz*state(i, 5) + zz*state(i, 3)
      t(i, 4) = xx*state(i, 4) + xy*state(i, 2) + zx*state(i, 5)
      t(i, 5) = xy*state(i, 6) + yy*state(i, 5) + yz*state(i, 3)
      t(i, 6) = zx*state(i, 1) + yz*state(i, 4) + zz*state(i, 6)
    end do
  end subroutine breakage_stresses

  !> Rates of flow per unit of its multiplier. Only their ratios count; these are of strains.
  pure subroutine breakage_rates(self, n, level, rates)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Number of states.
    integer, intent(in) :: n
    !> What is known of them.
    real(wp), intent(in) :: level(width, n_level)
    !> Rates. [-, -, -]
    real(wp), intent(out) :: rates(width, 3)
    real(wp) :: angle(width), sine(width), p, q, crush, bound, sheared, share, on, alone, per_energy
    integer :: i

    angle(:n) = quarter_turn*(1.0_wp - max(0.0_wp, min(1.0_wp, level(:n, of_r))))
    call sines(n, angle, sine)
    per_energy = 1.0_wp/self%energy
    do i = 1, n
      p = level(i, of_p)
      q = sqrt(level(i, of_square))
      on = above_zero(p)
      ! Shear alone tears the grains apart: it flows until they are pressed together.
      alone = (1.0_wp - on)*above_zero(level(i, of_y))
      p = on*p + (1.0_wp - on)
      bound = 1.0_wp/(on*level(i, of_bound) + (1.0_wp - on))
      share = sine(i)**2
      crush = level(i, of_free)*share*p/(p*p + q*q)
      sheared = (q*bound)*(p*bound)
      rates(i, of_volume) = on*(sheared*level(i, of_dilatancy) - crush*p) + alone
      rates(i, of_shear) = on*(crush*q + sheared) + alone
      rates(i, of_broken) = on*level(i, of_left)**2*(1.0_wp - share)*per_energy*p
    end do
  end subroutine breakage_rates

  !> Elastic energy over (1 - theta B) p_r, per volume of solid.
  pure function breakage_stored(self, be) result(phi)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Elastic left Cauchy-Green tensor.
    real(wp), intent(in) :: be(3, 3)
    !> Phi.
    real(wp) :: phi
    real(wp) :: rows(width, n_state), level(width, n_level)

    rows(1, :) = row_of(breakage_state_t(be=be), 1.0_wp)
    call find_strains(self, 1, rows, level)
    call find_invariants(self, 1, rows, level)
    phi = level(1, of_phi)
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
    real(wp) :: rows(width, n_state), level(width, n_level), stress(width, 6), six(6)

    rows(1, :) = row_of(state, rr)
    call find_strains(self, 1, rows, level)
    call find_invariants(self, 1, rows, level)
    call self%stresses(1, rows, level, stress)
    six = stress(1, :)
    t = full_of(six)
    p = level(1, of_p)
    q = sqrt(level(1, of_square))
  end subroutine breakage_respond

  !> Porosities between which the grains touch.
  pure function breakage_porosities(self, breakage) result(limits)
    !> Constants.
    class(breakage_t), intent(in) :: self
    !> Breakage B.
    real(wp), intent(in) :: breakage
    !> Lowest and highest.
    real(wp) :: limits(2)
    real(wp) :: left(width), low(width), high(width)

    left(1) = 1.0_wp - min(breakage, broken)
    call touching(self, 1, left, low, high)
    limits = [low(1), high(1)]
  end function breakage_porosities

  !> Yield of a state, and the volume, shear and breakage rates of flow per unit of its multiplier.
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
    real(wp) :: rows(width, n_state), level(width, n_level), speed(width, 3), stress(width, 6)
    real(wp) :: six(6)

    rows(1, :) = row_of(state, rr)
    call self%evaluate(1, rows, level)
    call self%rates(1, level, speed)
    call self%stresses(1, rows, level, stress)
    y = level(1, of_y)
    rates = speed(1, :)
    six = stress(1, :)
    t = full_of(six)
    q = sqrt(level(1, of_square))
  end subroutine breakage_yield

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
    real(wp) :: rows(width, n_state), level(width, n_level), x, g, crushing, now

    rows(1, :) = row_of(state, rr)
    call find_strains(self, 1, rows, level)
    associate (ev => level(1, of_ev), es => level(1, of_es), a => level(1, of_a))
      x = max(0.0_wp, -ev)
      g = sqrt(3.0_wp*self%bulk*self%shear)
      now = self%bulk*a + (a**2 + 0.75_wp*self%bulk*self%shear*es**2)*smooth/(smooth + x)**2 &
            + 4.0_wp/3.0_wp*self%shear*(a + 0.5_wp*g*es) + 2.0_wp*self%bulk*self%shear*es
      if (ev >= 0.0_wp) now = 0.0_wp
    end associate
    crushing = (1.5_wp*self%bulk*self%energy/(self%grading*self%pressure*rr))**(1.0_wp/3.0_wp)
    crushing = crushing*(self%bulk + 4.0_wp/3.0_wp*self%shear)
    modulus = rr*self%pressure*(1.0_wp + 2.0_wp*x)*max(now, crushing)
  end function breakage_modulus

end module mpm_breakage
