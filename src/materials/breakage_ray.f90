!> Directions of flow of breakage mechanics, and states and yields along them.
!!
!! Along a direction Be changes by -d, B by its rate, and the logarithm of 1 - phi by minus the rate
!! of the plastic volume, for each unit of the multiplier.
module mpm_breakage_ray
  use mpm_breakage, only: breakage_t, broken, least_gap, n_level, n_state, of_a, of_breakage, &
                          of_c, of_d, of_density, of_dilatancy, of_es, of_ev, of_free, of_high, &
                          of_j, of_left, of_low, of_p, of_phi, of_porosity, of_r, of_s, &
                          of_square, smooth, weakest, width
  use mpm_elementary, only: exponentials
  use mpm_kinds, only: wp
  implicit none
  private
  public :: direct, move, slopes

  !> Columns of rays after the six of d, xx yy zz xy yz zx: rates of the plastic volume, of the
  !! plastic shear and of B, and the largest multiplier.
  integer, parameter, public :: of_dilation = 7, of_shear = 8, of_crushing = 9, of_far = 10
  integer, parameter, public :: n_ray = 10

  !> Largest change of B or phi along one direction of flow.
  real(wp), parameter :: largest_change = 0.02_wp

contains

  !> Directions of flow of the elastic strains, and how far they may be followed.
  !!
  !! No further than half of the volume strain, of the shear strain and of all strain, and until B
  !! or the porosity has changed by the largest amount.
  pure subroutine direct(law, n, state, level, ray, path)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> Number of states, all with a pressure.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(in) :: level(width, n_level)
    !> Directions, rates of flow, and largest multipliers.
    real(wp), intent(out) :: ray(width, n_ray)
    !> Derivatives of ev, J and D along the directions.
    real(wp), intent(out) :: path(width, 3)
    real(wp), parameter :: least = tiny(1.0_wp), third = 1.0_wp/3.0_wp
    real(wp) :: e(6), s(6), t(6), f, a, c, j, along, across, near, trace
    integer :: i

    call law%rates(n, level, ray(:, of_dilation:of_crushing))
    do i = 1, n
      associate (ev => level(i, of_ev), be => state(i, :6))
        j = level(i, of_j)
        c = level(i, of_c)
        e(1) = 0.5_wp*(be(1) - 1.0_wp) - third*ev
        e(2) = 0.5_wp*(be(2) - 1.0_wp) - third*ev
        e(3) = 0.5_wp*(be(3) - 1.0_wp) - third*ev
        e(4) = 0.5_wp*be(4)
        e(5) = 0.5_wp*be(5)
        e(6) = 0.5_wp*be(6)
        ! The square of e, and from it the deviator of the stress.
        s(1) = e(1)*e(1) + e(4)*e(4) + e(6)*e(6)
        s(2) = e(4)*e(4) + e(2)*e(2) + e(5)*e(5)
        s(3) = e(6)*e(6) + e(5)*e(5) + e(3)*e(3)
        s(4) = e(4)*(e(1) + e(2)) + e(5)*e(6)
        s(5) = e(5)*(e(2) + e(3)) + e(4)*e(6)
        s(6) = e(6)*(e(1) + e(3)) + e(4)*e(5)
        f = 3.0_wp*ray(i, of_shear)/sqrt(max(level(i, of_square), least))
        a = f*(c*(1.0_wp + 2.0_wp*third*ev) - 2.0_wp*level(i, of_s))
        c = 2.0_wp*f*c
        t(1) = a*e(1) + c*(s(1) - third*j)
        t(2) = a*e(2) + c*(s(2) - third*j)
        t(3) = a*e(3) + c*(s(3) - third*j)
        t(4) = a*e(4) + c*s(4)
        t(5) = a*e(5) + c*s(5)
        t(6) = a*e(6) + c*s(6)
        f = 2.0_wp*third*ray(i, of_dilation)
        ray(i, 1) = (f + t(1))*be(1) + t(4)*be(4) + t(6)*be(6)
        ray(i, 2) = t(4)*be(4) + (f + t(2))*be(2) + t(5)*be(5)
        ray(i, 3) = t(6)*be(6) + t(5)*be(5) + (f + t(3))*be(3)
        ray(i, 4) = (f + t(1))*be(4) + t(4)*be(2) + t(6)*be(5)
        ray(i, 5) = t(4)*be(6) + (f + t(2))*be(5) + t(5)*be(3)
        ray(i, 6) = t(6)*be(1) + t(5)*be(4) + (f + t(3))*be(6)
      end associate
      associate (d => ray(i, :6), ev => level(i, of_ev))
        trace = d(1) + d(2) + d(3)
        along = e(1)*d(1) + e(2)*d(2) + e(3)*d(3) &
                + 2.0_wp*(e(4)*d(4) + e(5)*d(5) + e(6)*d(6))
        across = s(1)*d(1) + s(2)*d(2) + s(3)*d(3) &
                 + 2.0_wp*(s(4)*d(4) + s(5)*d(5) + s(6)*d(6)) - third*j*trace
        path(i, 1) = -0.5_wp*trace
        path(i, 2) = -along
        path(i, 3) = -1.5_wp*across
        near = d(1)*d(1) + d(2)*d(2) + d(3)*d(3) &
               + 2.0_wp*(d(4)*d(4) + d(5)*d(5) + d(6)*d(6))
        near = sqrt(near/max(j + third*ev*ev, least))
        near = max(near, trace/min(ev, -least), along/max(j, least))
        near = max(near, abs(ray(i, of_dilation))*(1.0_wp/largest_change))
        near = max(near, ray(i, of_crushing)/min(largest_change, level(i, of_left)))
        ray(i, of_far) = 1.0_wp/max(near, least)
      end associate
    end do
  end subroutine direct

  !> Derivatives of yields along directions of flow, of states that are pressed and sheared.
  pure subroutine slopes(law, n, state, level, ray, path, slope)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(in) :: level(width, n_level)
    !> Their directions and rates of flow.
    real(wp), intent(in) :: ray(width, n_ray)
    !> Derivatives of ev, J and D.
    real(wp), intent(in) :: path(width, 3)
    !> Derivatives of the yields.
    real(wp), intent(out) :: slope(width)
    real(wp), parameter :: least = tiny(1.0_wp)
    real(wp) :: p1(width), square1(width), phi1(width), factor, share, on, above, p, left, f
    real(wp) :: free1, low1, high1, r1, strength, strength1
    integer :: i

    call stress_slopes(law, n, state, level, ray, path, p1, square1, phi1)
    factor = law%offset()
    share = law%grading*law%pressure/law%energy
    do i = 1, n
      associate (b_rate => ray(i, of_crushing), low => level(i, of_low), high => level(i, of_high))
        left = level(i, of_left)
        free1 = share*state(i, of_density)*left*(phi1(i)*left - 2.0_wp*level(i, of_phi)*b_rate)
        f = b_rate/left
        low1 = -law%powers(1)*low*f
        high1 = -law%powers(2)*high*f
        r1 = high1 - (1.0_wp - state(i, of_porosity))*ray(i, of_dilation) &
             - level(i, of_r)*(high1 - low1)
        r1 = r1/max(high - low, least_gap)
      end associate
      strength = law%friction + level(i, of_dilatancy)
      ! Factors that are 0 or 1, since conditions would make the loop branch.
      above = 0.5_wp + sign(0.5_wp, strength - weakest*law%friction)
      strength1 = above*factor*(law%dilation*r1 - 0.5_wp*free1/sqrt(max(level(i, of_free), least)))
      strength = above*strength + (1.0_wp - above)*weakest*law%friction
      on = 0.5_wp + sign(0.5_wp, level(i, of_p) - least)
      p = 1.0_wp/(on*level(i, of_p) + (1.0_wp - on))
      strength = 1.0_wp/strength
      slope(i) = on*(free1 + p*strength*(p*strength*(square1(i) - 2.0_wp*level(i, of_square) &
                                                     *(p1(i)*p + strength1*strength))))
    end do
  end subroutine slopes

  !> Derivatives of p, q**2 and Phi along directions of flow.
  pure subroutine stress_slopes(law, n, state, level, ray, path, p1, square1, phi1)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them.
    real(wp), intent(in) :: level(width, n_level)
    !> Their directions and rates of flow.
    real(wp), intent(in) :: ray(width, n_ray)
    !> Derivatives of ev, J and D.
    real(wp), intent(in) :: path(width, 3)
    !> That of p.
    real(wp), intent(out) :: p1(width)
    !> That of q**2.
    real(wp), intent(out) :: square1(width)
    !> That of Phi.
    real(wp), intent(out) :: phi1(width)
    real(wp), parameter :: least = tiny(1.0_wp)
    real(wp) :: g, g6, scale, a, b, j, x, h, w, u, f, es1, a1, h1, u1, s1, c1, b1
    integer :: i

    g = sqrt(3.0_wp*law%bulk*law%shear)
    g6 = g/6.0_wp
    do i = 1, n
      associate (ev1 => path(i, 1), j1 => path(i, 2), d1 => path(i, 3), s => level(i, of_s), &
                 c => level(i, of_c), es => level(i, of_es))
        a = level(i, of_a)
        j = level(i, of_j)
        x = max(0.0_wp, -level(i, of_ev))
        f = 1.0_wp/(smooth + x)
        h = 0.5_wp*law%bulk*x*f
        h1 = -0.5_wp*law%bulk*smooth*f*f*ev1
        a1 = -h*ev1
        es1 = j1/(3.0_wp*max(es, least))
        f = 1.0_wp - law%grading*state(i, of_breakage)
        scale = state(i, of_density)*f*law%pressure
        f = -law%grading*ray(i, of_crushing)/f
        u = (2.0_wp/law%bulk)*a*a + law%shear*j
        u1 = (4.0_wp/law%bulk)*a*a1 + law%shear*j1
        s1 = s*f + scale*(u1*h + u*h1)
        c1 = c*f + 2.0_wp*scale*law%shear*(a1 + 0.25_wp*g*es1)
        w = 1.0_wp + (2.0_wp/3.0_wp)*level(i, of_ev)
        p1(i) = s1*w + (2.0_wp/3.0_wp)*(s*ev1 - c1*j - c*j1)
        b = c*w - 2.0_wp*s
        b1 = c1*w + (2.0_wp/3.0_wp)*c*ev1 - 2.0_wp*s1
        square1(i) = 3.0_wp*b*b1*j + 1.5_wp*b*b*j1 + 2.0_wp*c*j*(c1*j + c*j1) &
                     + 6.0_wp*((b1*c + b*c1)*level(i, of_d) + b*c*d1)
        phi1(i) = (2.0_wp/law%bulk)*a*a*a1 &
                  + law%shear*(j1*(a + g6*es) + j*(a1 + g6*es1))
      end associate
    end do
  end subroutine stress_slopes

  !> States some way along their directions of flow.
  pure subroutine move(n, state, ray, way, next)
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> Their directions and rates of flow.
    real(wp), intent(in) :: ray(width, n_ray)
    !> The multipliers.
    real(wp), intent(in) :: way(width)
    !> The states there.
    real(wp), intent(out) :: next(width, n_state)
    real(wp) :: less(width), factor(width)
    integer :: k

    do k = 1, 6
      next(:n, k) = state(:n, k) - way(:n)*ray(:n, k)
    end do
    next(:n, of_breakage) = min(state(:n, of_breakage) &
                                + way(:n)*ray(:n, of_crushing), broken)
    less(:n) = -way(:n)*ray(:n, of_dilation)
    call exponentials(n, less, factor)
    next(:n, of_porosity) = 1.0_wp - (1.0_wp - state(:n, of_porosity))*factor(:n)
    next(:n, of_density) = state(:n, of_density)
  end subroutine move

end module mpm_breakage_ray
