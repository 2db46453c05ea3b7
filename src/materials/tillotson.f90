!> The Tillotson equation of state and its cold curve.
!!
!! With eta = rho/rho_0, mu = eta - 1, w = E/(E_0 eta**2) + 1 and z = rho_0/rho - 1,
!!
!!     P2 = (a + b/w) rho E + A mu + B mu**2
!!     P3 = a rho E + (b rho E/w + A mu exp(-beta z)) exp(-alpha z**2)
!!
!! P2 where compressed or cold, P3 where expanded and hot, a blend between; below rho_IV the cold
!! branch is P2 without B, so that P jumps there.
module mpm_tillotson
  use mpm_bracket, only: bracket_t
  use mpm_corotation, only: width
  use mpm_kinds, only: wp
  implicit none
  private
  public :: densest, hottest, thinnest, tillotson_t

  !> Densities over rho_0 beyond which there is no pressure.
  real(wp), parameter :: densest = 100.0_wp, thinnest = 1.0e-12_wp
  !> Energy at which a point is out of all bounds. [J/kg]
  real(wp), parameter :: hottest = 1.0e20_wp
  !> Smallest w = E/(E_0 eta**2) + 1; P2 has a pole at 0.
  real(wp), parameter :: pole = 1.0e-6_wp
  !> Intervals of the table of the cold curve, and its first density over rho_0.
  integer, parameter :: intervals = 4500
  real(wp), parameter :: first = 0.505_wp
  !> Its spacing: a node lies at rho_0.
  real(wp), parameter :: spacing = 0.001_wp
  !> Node of rho_0.
  integer, parameter :: origin = 495

  !> Constants of the equation of state.
  type :: tillotson_t
    !> Reference density rho_0. [kg/m3]
    real(wp) :: density = 1.0_wp
    !> Density of incipient vaporisation rho_IV. [kg/m3]
    real(wp) :: thin = 0.0_wp
    !> a and b.
    real(wp) :: a = 0.0_wp, b = 0.0_wp
    !> A and B. [Pa]
    real(wp) :: bulk = 0.0_wp, bulk2 = 0.0_wp
    !> E_0. [J/kg]
    real(wp) :: energy = 1.0_wp
    !> alpha and beta.
    real(wp) :: alpha = 0.0_wp, beta = 0.0_wp
    !> Energies of incipient and complete vaporisation, E_IV and E_CV. [J/kg]
    real(wp) :: melt = 0.0_wp, vapour = 0.0_wp
    !> Energies of the cold curve and their slopes over eta. [J/kg] (2, 0:intervals)
    real(wp), allocatable :: table(:, :)
  contains
    !> Make the table of the cold curve.
    procedure :: tabulate => tillotson_tabulate
    !> Pressure.
    procedure :: pressure => tillotson_pressure
    !> Energies and pressures at the end of a step, where the pressure is P2.
    procedure :: settle => tillotson_settle
    !> Energy of the cold curve.
    procedure :: cold => tillotson_cold
    !> Square of the speed of sound.
    procedure :: square_of_speed => tillotson_square_of_speed
    !> Density of the cold curve that has a pressure.
    procedure :: density_at => tillotson_density_at
  end type tillotson_t

contains

  !> Pressure; `slopes` are its derivatives by density and energy.
  pure subroutine tillotson_pressure(self, rho, e, p, good, slopes)
    !> Constants.
    class(tillotson_t), intent(in) :: self
    !> Density. [kg/m3]
    real(wp), intent(in) :: rho
    !> Energy. [J/kg]
    real(wp), intent(in) :: e
    !> Pressure. [Pa]
    real(wp), intent(out) :: p
    !> Whether there is one: the density is within its bounds, and E above -E_0 eta**2, where P2 has
    !! a pole.
    logical, intent(out) :: good
    !> dP/drho and dP/dE. [Pa m3/kg, kg/m3]
    real(wp), intent(out), optional :: slopes(2)
    real(wp) :: eta, mu, w, z, p2(3), p3(3), share, g(2), h, k

    p = 0.0_wp
    if (present(slopes)) slopes = 0.0_wp
    good = rho >= thinnest*self%density .and. rho <= densest*self%density
    if (.not. good) return
    eta = rho/self%density
    w = e/(self%energy*eta**2) + 1.0_wp
    good = w > pole
    if (.not. good) return
    mu = eta - 1.0_wp
    ! Slopes of 1/w, by density and by energy.
    g = [2.0_wp*(w - 1.0_wp)/rho, -1.0_wp/(self%energy*eta**2)]/w**2
    p2(1) = (self%a + self%b/w)*rho*e + self%bulk*mu + self%bulk2*mu**2
    p2(2) = (self%a + self%b/w + self%b*rho*g(1))*e &
            + (self%bulk + 2.0_wp*self%bulk2*mu)/self%density
    p2(3) = (self%a + self%b/w + self%b*e*g(2))*rho
    if (rho < self%density .and. rho < self%thin) then
      p2(1) = p2(1) - self%bulk2*mu**2
      p2(2) = p2(2) - 2.0_wp*self%bulk2*mu/self%density
    end if
    share = 0.0_wp
    if (rho < self%density) then
      if (e >= self%vapour) then
        share = 1.0_wp
      else if (rho >= self%thin .and. e > self%melt) then
        share = (e - self%melt)/(self%vapour - self%melt)
      end if
    end if
    p3 = 0.0_wp
    if (share > 0.0_wp) then
      z = self%density/rho - 1.0_wp
      h = exp(-min(700.0_wp, self%alpha*z**2))
      k = exp(-min(700.0_wp, self%beta*z))
      p3(1) = self%a*rho*e + (self%b*rho*e/w + self%bulk*mu*k)*h
      p3(2) = self%a*e + (self%b*e/w + self%b*rho*e*g(1) + self%bulk*k/self%density &
                          + self%bulk*mu*k*self%beta*eta**(-2)/self%density)*h &
              + (p3(1) - self%a*rho*e)*2.0_wp*self%alpha*z*eta**(-2)/self%density
      p3(3) = self%a*rho + (self%b*rho/w + self%b*rho*e*g(2))*h
    end if
    p = share*p3(1) + (1.0_wp - share)*p2(1)
    if (.not. present(slopes)) return
    slopes = share*p3(2:3) + (1.0_wp - share)*p2(2:3)
    if (share > 0.0_wp .and. share < 1.0_wp) then
      slopes(2) = slopes(2) + (p3(1) - p2(1))/(self%vapour - self%melt)
    end if
  end subroutine tillotson_pressure

  !> Energies and pressures at the end of a step, E = E_s - (P_n + P2(rho, E)) dv/2, `width`
  !> points at a time: a loop of another length could have its last points rounded otherwise.
  !!
  !! With h = rho dv/2, c = E_0 eta**2 and s = E_s - (P_n + A mu + B mu**2) dv/2 the
  !! energy is the larger root of
  !!
  !!     (1 + h a) E**2 + ((1 + h a + h b) c - s) E - s c = 0.
  !!
  !! Points are not found that have a share of P3, that are hotter than c, near the pole, or pressed
  !! together so much that the quadratic equation loses digits. The loop has no branches, and
  !! nothing in it overflows, whatever such points give.
  pure subroutine tillotson_settle(self, rho, swell, before, start, e, p, found)
    !> Constants.
    class(tillotson_t), intent(in) :: self
    !> Densities within their bounds. [kg/m3]
    real(wp), intent(in) :: rho(width)
    !> Changes of the volume over the volume, rho dv, at least -exp(60).
    real(wp), intent(in) :: swell(width)
    !> Pressures P_n, at most 1e150 in size. [Pa]
    real(wp), intent(in) :: before(width)
    !> Energies E_s without the work of the step, at most 1e250. [J/kg]
    real(wp), intent(in) :: start(width)
    !> Energies. [J/kg]
    real(wp), intent(out) :: e(width)
    !> Pressures. [Pa]
    real(wp), intent(out) :: p(width)
    !> 1 for points that are found, 0 for others.
    real(wp), intent(out) :: found(width)
    real(wp), parameter :: far = 1.0e60_wp, least = 1.0e-60_wp
    real(wp) :: per_density, eta, mu, c, kept, h, cold, s, alpha, slope, beta, square, energy, hot
    integer :: i

    per_density = 1.0_wp/self%density
    do i = 1, width
      mu = (rho(i) - self%density)*per_density
      eta = rho(i)*per_density
      c = self%energy*eta*eta
      ! 1 from rho_IV on, 0 below.
      kept = 0.5_wp + sign(0.5_wp, rho(i) - self%thin)
      cold = mu*(self%bulk + kept*self%bulk2*mu)
      h = 0.5_wp*swell(i)
      s = max(-far, min(far, start(i) - h*(before(i) + cold)/rho(i)))
      alpha = 1.0_wp + h*self%a
      slope = alpha + h*self%b
      beta = c*slope - s
      square = beta*beta + 4.0_wp*alpha*s*c
      energy = 2.0_wp*s*c/max(beta + sqrt(max(0.0_wp, square)), least)
      e(i) = energy
      p(i) = (self%a + self%b*c/max(energy + c, pole*c))*rho(i)*energy + cold
      ! 1 for a share of P3.
      hot = (0.5_wp - sign(0.5_wp, mu)) &
            *(0.5_wp + sign(0.5_wp, energy - (kept*self%melt + (1.0_wp - kept)*self%vapour)))
      found(i) = (1.0_wp - hot)*(0.5_wp + sign(0.5_wp, beta)) &
                 *(0.5_wp + sign(0.5_wp, slope - 0.25_wp)) &
                 *(0.5_wp + sign(0.5_wp, square - 0.25_wp*beta*beta)) &
                 *(0.5_wp - sign(0.5_wp, pole*c - (energy + c))) &
                 *(0.5_wp + sign(0.5_wp, hottest - abs(energy)))
    end do
  end subroutine tillotson_settle

  !> Slope of the cold curve over eta, dE/deta = rho_0 P/rho**2.
  pure function cold_slope(self, eta, e) result(slope)
    !> Constants.
    class(tillotson_t), intent(in) :: self
    !> Density over rho_0.
    real(wp), intent(in) :: eta
    !> Energy. [J/kg]
    real(wp), intent(in) :: e
    !> The slope. [J/kg]
    real(wp) :: slope
    real(wp) :: p
    logical :: good

    call self%pressure(eta*self%density, e, p, good)
    slope = p/(self%density*eta**2)
  end function cold_slope

  !> One step of the rule of Runge and Kutta along the cold curve.
  pure function cold_step(self, eta, h, e) result(next)
    !> Constants.
    class(tillotson_t), intent(in) :: self
    !> Density over rho_0.
    real(wp), intent(in) :: eta
    !> Step of it.
    real(wp), intent(in) :: h
    !> Energy. [J/kg]
    real(wp), intent(in) :: e
    !> Energy at eta + h. [J/kg]
    real(wp) :: next
    real(wp) :: k(4)

    k(1) = cold_slope(self, eta, e)
    k(2) = cold_slope(self, eta + 0.5_wp*h, e + 0.5_wp*h*k(1))
    k(3) = cold_slope(self, eta + 0.5_wp*h, e + 0.5_wp*h*k(2))
    k(4) = cold_slope(self, eta + h, e + h*k(3))
    next = e + h*(k(1) + 2.0_wp*k(2) + 2.0_wp*k(3) + k(4))/6.0_wp
  end function cold_step

  !> Make the table of the cold curve, E = 0 at rho_0.
  pure subroutine tillotson_tabulate(self)
    !> Constants; receives the table.
    class(tillotson_t), intent(inout) :: self
    real(wp) :: eta
    integer :: i

    if (allocated(self%table)) deallocate (self%table)
    allocate (self%table(2, 0:intervals))
    self%table(:, origin) = 0.0_wp
    do i = origin + 1, intervals
      eta = first + spacing*real(i - 1, wp)
      self%table(1, i) = cold_step(self, eta, spacing, self%table(1, i - 1))
    end do
    do i = origin - 1, 0, -1
      eta = first + spacing*real(i + 1, wp)
      self%table(1, i) = cold_step(self, eta, -spacing, self%table(1, i + 1))
    end do
    do i = 0, intervals
      self%table(2, i) = cold_slope(self, first + spacing*real(i, wp), self%table(1, i))
    end do
  end subroutine tillotson_tabulate

  !> Energy of the cold curve: cubic between nodes, constant below the table, by steps above up to
  !! the largest density.
  pure function tillotson_cold(self, rho) result(e)
    !> Constants and table.
    class(tillotson_t), intent(in) :: self
    !> Density. [kg/m3]
    real(wp), intent(in) :: rho
    !> Energy. [J/kg]
    real(wp) :: e
    integer, parameter :: more = 200
    real(wp) :: s, h
    integer :: i

    s = (min(rho, densest*self%density)/self%density - first)/spacing
    if (s <= 0.0_wp) then
      e = self%table(1, 0)
    else if (s < real(intervals, wp)) then
      i = int(s)
      s = s - real(i, wp)
      associate (l => self%table(:, i), r => self%table(:, i + 1))
        e = l(1) + s*s*(3.0_wp - 2.0_wp*s)*(r(1) - l(1)) &
            + spacing*s*(1.0_wp - s)*((1.0_wp - s)*l(2) - s*r(2))
      end associate
    else
      e = self%table(1, intervals)
      h = (s - real(intervals, wp))*spacing/real(more, wp)
      do i = 0, more - 1
        e = cold_step(self, first + spacing*real(intervals, wp) + h*real(i, wp), h, e)
      end do
    end if
  end function tillotson_cold

  !> Square of the speed of sound, dP/drho + P/rho**2 dP/dE; 0 where that is negative, or where
  !! there is no pressure.
  pure function tillotson_square_of_speed(self, rho, e) result(square)
    !> Constants.
    class(tillotson_t), intent(in) :: self
    !> Density. [kg/m3]
    real(wp), intent(in) :: rho
    !> Energy. [J/kg]
    real(wp), intent(in) :: e
    !> The square. [m2/s2]
    real(wp) :: square
    real(wp) :: p, slopes(2)
    logical :: good

    square = 0.0_wp
    call self%pressure(rho, e, p, good, slopes)
    if (good) square = max(0.0_wp, slopes(1) + p/rho**2*slopes(2))
  end function tillotson_square_of_speed

  !> Density of the cold curve that has a pressure.
  pure subroutine tillotson_density_at(self, p, rho, good)
    !> Constants and table.
    class(tillotson_t), intent(in) :: self
    !> Pressure. [Pa]
    real(wp), intent(in) :: p
    !> Density. [kg/m3]
    real(wp), intent(out) :: rho
    !> Whether there is one within the table.
    logical, intent(out) :: good
    type(bracket_t) :: search
    real(wp) :: far

    rho = self%density
    good = .true.
    if (.not. abs(p) > 0.0_wp) return
    far = merge(first + spacing*real(intervals, wp), max(first, self%thin/self%density), p > 0.0_wp)
    far = far*self%density
    good = (missing(far) > 0.0_wp) .eqv. (p > 0.0_wp)
    if (.not. good) return
    call search%start(self%density, -p, far, missing(far))
    do while (.not. search%done .and. search%n < 200)
      call search%take(missing(search%x))
    end do
    rho = search%x

  contains

    !> Cold pressure of a density above the one that is wanted.
    pure function missing(at) result(value)
      !> Density. [kg/m3]
      real(wp), intent(in) :: at
      !> Pressure. [Pa]
      real(wp) :: value
      logical :: exists

      call self%pressure(at, self%cold(at), value, exists)
      value = value - p
    end function missing

  end subroutine tillotson_density_at

end module mpm_tillotson
