!> A compressible fluid with the Tillotson equation of state, for shocks.
module mpm_tillotson_eos_fluid
  use mpm_advance, only: exponential
  use mpm_corotation, only: rates_by_component, width
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t
  use mpm_tillotson, only: densest, hottest, thinnest, tillotson_t
  implicit none
  private
  public :: tillotson_eos_fluid_t

  !> Bounds of the constants, far from those of any material in any units: with them no pressure,
  !! energy or slope of a density within its bounds is beyond what a number can hold.
  real(wp), parameter :: least = 1.0e-20_wp, most = 1.0e20_wp
  !> Largest logarithm of a ratio of volumes in a step.
  real(wp), parameter :: fastest = 60.0_wp
  !> Rates and pressures from which a point is out of all bounds; no constants lead there. [1/s, Pa]
  real(wp), parameter :: wildest = 1.0e100_wp, hardest = 1.0e120_wp

  !> Tillotson fluid with viscosity, cavitation and energy balance.
  !!
  !! The memory of a point is its energy per mass.
  type, extends(material_t) :: tillotson_eos_fluid_t
    !> Equation of state.
    type(tillotson_t) :: state
    !> Heat capacity c_v. [J/(kg K)]
    real(wp) :: heat = 1.0_wp
    !> Temperature of the cold curve T_0. [K]
    real(wp) :: first_temperature = 0.0_wp
    !> Viscosity eta_0. [Pa s]
    real(wp) :: viscosity = 0.0_wp
    !> Smallest pressure P_cav. [Pa]
    real(wp) :: cavitation = 0.0_wp
    !> rho_0 c_0 h_i, the artificial bulk viscosity in compression. [Pa s]
    real(wp) :: artificial = 0.0_wp
    !> The energy is that of the cold curve.
    logical :: isothermal = .false.
  contains
    procedure, nopass :: describe => tillotson_eos_fluid_describe
    procedure :: init => tillotson_eos_fluid_init
    procedure :: update_stress => tillotson_eos_fluid_update_stress
    procedure :: assign_stress => tillotson_eos_fluid_assign_stress
    procedure :: wave_speed => tillotson_eos_fluid_wave_speed
    procedure :: diffusivity => tillotson_eos_fluid_diffusivity
    procedure :: strain_energy => tillotson_eos_fluid_strain_energy
    procedure :: write_fields => tillotson_eos_fluid_write_fields
  end type tillotson_eos_fluid_t

contains

  !> Purpose and properties of the class.
  subroutine tillotson_eos_fluid_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'TillotsonEOSFluid', &
                          'Compressible fluid with the Tillotson equation of state, for shocks.', &
                          'Tillotson, GA-3216 (1962); Brundage, Procedia Engineering 58 (2013) &
                          &461-470', &
                          '    material-class = "TillotsonEOSFluid"'//nl// &
                          '    material-props = {rho_0 = 998, rho_IV = 958, a = 0.7, b = 0.15, &
                          &A = 2.18e9,'//nl// &
                          '                      B = 1.325e10, E_0 = 7e6, alpha = 10, beta = 5,'// &
                          nl//'                      E_IV = 4.19e5, E_CV = 2.69e6, c_v = 3690, &
                          &T_0 = 293,'//nl// &
                          '                      eta_0 = 8.9e-4, P_cav = -1e5}')
    call description%add_real('rho_0', 'kg/m3', 'reference density', lower=least, upper=most)
    call description%add_real('rho_IV', 'kg/m3', 'density of incipient vaporisation', lower=0.0_wp)
    call description%add_real('a', '-', 'constant a', lower=0.0_wp, upper=10.0_wp)
    call description%add_real('b', '-', 'constant b', lower=0.0_wp, upper=100.0_wp)
    call description%add_real('A', 'Pa', 'bulk modulus at rho_0', lower=least, upper=most)
    call description%add_real('B', 'Pa', 'constant B', lower=0.0_wp, upper=most)
    call description%add_real('E_0', 'J/kg', 'constant E_0', lower=least, upper=most)
    call description%add_real('alpha', '-', 'constant alpha', lower=0.0_wp, upper=most)
    call description%add_real('beta', '-', 'constant beta', lower=0.0_wp, upper=most)
    call description%add_real('E_IV', 'J/kg', 'energy of incipient vaporisation', lower=0.0_wp)
    call description%add_real('E_CV', 'J/kg', 'energy of complete vaporisation', lower=least, &
                              upper=most)
    call description%add_real('c_v', 'J/(kg K)', 'heat capacity', lower=least, upper=most)
    call description%add_real('T_0', 'K', 'temperature at the start', lower=0.0_wp, upper=most)
    call description%add_real('eta_0', 'Pa s', 'viscosity', lower=0.0_wp, upper=most)
    call description%add_real('P_cav', 'Pa', 'smallest pressure', lower=-most**5, upper=0.0_wp)
    call description%add_real('h_i', 'm', 'length of the artificial viscosity, about a cell; for &
                              &its flag', default=0.0_wp, lower=0.0_wp, upper=most)
    call description%add_string('flags', '"ISOTHERMAL": the energy is that of the cold curve; &
                                &"USE_ARTIFICIAL_VISCOSITY": with h_i', is_list=.true.)
    call description%add_note('The viscosity acts, 2 eta_0 D''; in mpm_3d it has no effect.')
    call description%add_note('The work of a step is that of the mean of old and new pressure, the &
                              &new one found with the energy that results: a jump in one step ends &
                              &on the Hugoniot curve.')
    call description%add_note('Where the pressure would fall below P_cav it is P_cav and the &
                              &energy stays; mpm_3d sets the energy to 0.')
    call description%add_note('The energy in the summary of a run is the internal one.')
  end subroutine tillotson_eos_fluid_describe

  !> Set the constants from the properties.
  subroutine tillotson_eos_fluid_init(self, kin, properties, error)
    !> The material.
    class(tillotson_eos_fluid_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Energies or densities in the wrong order, an unknown flag, or a flag without its length.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    logical :: wanted
    integer :: i

    self%kin = kin
    self%n_history = 1
    self%state%density = properties%real('rho_0')
    self%state%thin = properties%real('rho_IV')
    self%state%a = properties%real('a')
    self%state%b = properties%real('b')
    self%state%bulk = properties%real('A')
    self%state%bulk2 = properties%real('B')
    self%state%energy = properties%real('E_0')
    self%state%alpha = properties%real('alpha')
    self%state%beta = properties%real('beta')
    self%state%melt = properties%real('E_IV')
    self%state%vapour = properties%real('E_CV')
    self%heat = properties%real('c_v')
    self%first_temperature = properties%real('T_0')
    self%viscosity = properties%real('eta_0')
    self%cavitation = properties%real('P_cav')
    self%artificial = 0.0_wp
    self%isothermal = .false.
    wanted = .false.
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      select case (flags(i)%text)
      case ('ISOTHERMAL')
        self%isothermal = .true.
      case ('USE_ARTIFICIAL_VISCOSITY')
        wanted = .true.
        self%artificial = properties%real('h_i')*sqrt(self%state%bulk*self%state%density)
      case default
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               '"ISOTHERMAL", "USE_ARTIFICIAL_VISCOSITY"   (mpm3d --describe &
                               &TillotsonEOSFluid)')
        return
      end select
    end do
    if (wanted .neqv. properties%real('h_i') > 0.0_wp) then
      call properties%reject('h_i', 'h_i and USE_ARTIFICIAL_VISCOSITY belong together', error, &
                             'give both or none')
    else if (self%state%melt >= self%state%vapour) then
      call properties%reject('E_CV', 'E_CV is not above E_IV', error, 'vaporisation ends at E_CV')
    else if (self%state%thin > self%state%density) then
      call properties%reject('rho_IV', 'rho_IV is above rho_0', error, 'vaporisation begins in &
                             &expansion')
    else
      call self%state%tabulate()
    end if
  end subroutine tillotson_eos_fluid_init

  !> The stress of a block of points at the end of a step.
  pure subroutine tillotson_eos_fluid_update_stress(self, n, dt, gradient, mass, volume, stress, &
                                                    history, first_bad)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes at the end of the step. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> Energies. [J/kg] (1, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point without a pressure; 0 when there is none.
    integer, intent(out) :: first_bad
    integer :: a

    first_bad = 0
    do a = 1, n, width
      call advance(self, min(width, n - a + 1), dt, gradient(1, a), mass(a), volume(a), &
                   stress(1, a), history(1, a), first_bad)
      if (first_bad == 0) cycle
      first_bad = first_bad + a - 1
      return
    end do
  end subroutine tillotson_eos_fluid_update_stress

  !> The stress of so many points at the end of a step that their scratch has a fixed size.
  pure subroutine advance(self, n, dt, gradient, mass, volume, stress, energy, first_bad)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes at the end of the step. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> Energies. [J/kg] (n)
    real(wp), intent(inout) :: energy(n)
    !> First point without a pressure; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: rate(width, 6)
    real(wp), dimension(width) :: trace, swell, rho, before, push, heat, p, good, e
    integer :: i

    ! Behind the last point there are more, at rest: loops of `width` round all points alike.
    rho(n + 1:) = self%state%density
    before(n + 1:) = 0.0_wp
    e(n + 1:) = 0.0_wp
    e(:n) = energy
    call rates_by_component(self%kin, n, gradient, rate, trace)
    swell = -dt*trace
    call exponential(width, swell, p)
    do i = 1, n
      rho(i) = mass(i)/volume(i)
      before(i) = -(stress(1, i) + stress(2, i) + stress(3, i))/3.0_wp
    end do
    call measure(self, dt, rate, trace, swell, p, rho, before, push, heat, good)
    call balance_block(self, n, rho, swell, before, heat, good, e, p, first_bad)
    if (first_bad > 0) return
    energy = e(:n)
    do i = 1, width
      ! 1 above P_cav; there is no viscosity at it.
      good(i) = 0.5_wp - sign(0.5_wp, self%cavitation - p(i))
      p(i) = p(i) + good(i)*push(i)
      good(i) = 2.0_wp*self%viscosity*good(i)
    end do
    call assemble(self%kin%nstress, n, good, rate, p, stress)
  end subroutine advance

  !> What the balance of energy needs of so many points; those out of all bounds count as at rest.
  pure subroutine measure(self, dt, rate, trace, swell, shrunk, rho, before, push, heat, good)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> D on entry, its deviator on exit. [1/s]
    real(wp), intent(inout) :: rate(width, 6)
    !> tr D. [1/s]
    real(wp), intent(in) :: trace(width)
    !> -dt tr D on entry, what volumes have grown by over the volumes on exit.
    real(wp), intent(inout) :: swell(width)
    !> exp(-dt tr D).
    real(wp), intent(in) :: shrunk(width)
    !> Densities. [kg/m3]
    real(wp), intent(inout) :: rho(width)
    !> Pressures at the start on entry, with artificial ones of the end on exit. [Pa]
    real(wp), intent(inout) :: before(width)
    !> Artificial pressures. [Pa]
    real(wp), intent(out) :: push(width)
    !> Energies from viscosity. [J/kg]
    real(wp), intent(out) :: heat(width)
    !> 1 for points within bounds, 0 for others.
    real(wp), intent(out) :: good(width)
    real(wp) :: lowest, highest, factor, third, t, r1, r2, r3, r4, r5, r6
    integer :: i

    lowest = thinnest*self%state%density
    highest = densest*self%state%density
    factor = 2.0_wp*self%viscosity*dt
    do i = 1, width
      third = trace(i)/3.0_wp
      r1 = rate(i, 1) - third
      r2 = rate(i, 2) - third
      r3 = rate(i, 3) - third
      r4 = rate(i, 4)
      r5 = rate(i, 5)
      r6 = rate(i, 6)
      t = max(abs(r1), abs(r2), abs(r3), abs(r4), abs(r5), abs(r6), abs(trace(i)))
      ! As a product: with a condition the loop has a branch.
      t = (0.5_wp + sign(0.5_wp, wildest - t))*(0.5_wp - sign(0.5_wp, abs(swell(i)) - fastest)) &
          *(0.5_wp - sign(0.5_wp, abs(before(i)) - hardest)) &
          *(0.5_wp + sign(0.5_wp, rho(i) - lowest))*(0.5_wp + sign(0.5_wp, highest - rho(i)))
      good(i) = t
      rate(i, 1) = t*r1
      rate(i, 2) = t*r2
      rate(i, 3) = t*r3
      rate(i, 4) = t*r4
      rate(i, 5) = t*r5
      rate(i, 6) = t*r6
      rho(i) = max(lowest, min(highest, rho(i)))
      push(i) = -self%artificial*min(t*trace(i), 0.0_wp)
      before(i) = t*before(i) + push(i)
      swell(i) = t*(1.0_wp - shrunk(i))
    end do
    do i = 1, width
      heat(i) = factor*(rate(i, 1)**2 + rate(i, 2)**2 + rate(i, 3)**2 &
                        + 2.0_wp*(rate(i, 4)**2 + rate(i, 5)**2 + rate(i, 6)**2))/rho(i)
    end do
  end subroutine measure

  !> Energies and pressures at the end of a step: most in closed form, the others one by one.
  pure subroutine balance_block(self, n, rho, swell, before, heat, good, e, p, first_bad)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Densities at the end. [kg/m3]
    real(wp), intent(in) :: rho(width)
    !> What volumes have grown by, over the volumes.
    real(wp), intent(in) :: swell(width)
    !> Pressures at the start and artificial pressures at the end. [Pa]
    real(wp), intent(in) :: before(width)
    !> Energies from viscosity. [J/kg]
    real(wp), intent(in) :: heat(width)
    !> 1 for points within bounds, 0 for others.
    real(wp), intent(in) :: good(width)
    !> Energies. [J/kg]
    real(wp), intent(inout) :: e(width)
    !> Pressures at the end, at least P_cav. [Pa]
    real(wp), intent(out) :: p(width)
    !> First point without a pressure; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: next(width), found(width), start(width), lifted
    integer :: i
    logical :: exists

    if (self%isothermal) then
      found = 0.0_wp
      p = 0.0_wp
    else
      start = e + heat
      call self%state%settle(rho, swell, before, start, next, p, found)
      do i = 1, width
        ! 0 where P_cav is reached, and the energy stays, or nothing is found.
        lifted = found(i)*(0.5_wp - sign(0.5_wp, self%cavitation - p(i)))
        e(i) = lifted*next(i) + (1.0_wp - lifted)*e(i)
        p(i) = max(p(i), self%cavitation)
      end do
    end if
    first_bad = 0
    do i = 1, n
      exists = good(i) > 0.0_wp
      if (exists .and. .not. found(i) > 0.0_wp) then
        call balance(self, rho(i), swell(i)/rho(i), before(i), heat(i), e(i), p(i), exists)
      end if
      if (exists) cycle
      first_bad = i
      return
    end do
  end subroutine balance_block

  !> Stresses of pressures and deviators.
  pure subroutine assemble(nstress, n, factor, rate, p, stress)
    !> Components of a stress.
    integer, intent(in) :: nstress
    !> Number of points.
    integer, intent(in) :: n
    !> Deviators of the stresses over those of D. [Pa s]
    real(wp), intent(in) :: factor(width)
    !> Deviators of D. [1/s]
    real(wp), intent(in) :: rate(width, 6)
    !> Pressures. [Pa]
    real(wp), intent(in) :: p(width)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(out) :: stress(nstress, n)
    integer :: c, i

    do i = 1, n
      stress(1, i) = factor(i)*rate(i, 1) - p(i)
      stress(2, i) = factor(i)*rate(i, 2) - p(i)
      stress(3, i) = factor(i)*rate(i, 3) - p(i)
    end do
    do c = 4, nstress
      do i = 1, n
        stress(c, i) = factor(i)*rate(i, c)
      end do
    end do
  end subroutine assemble

  !> Energy and pressure at the end of a step: E = E_n + heat - (P_n + P(rho, E)) dv/2.
  pure subroutine balance(self, rho, growth, before, heat, e, p, good)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Density at the end. [kg/m3]
    real(wp), intent(in) :: rho
    !> Change dv of the volume per mass. [m3/kg]
    real(wp), intent(in) :: growth
    !> Pressure at the start and artificial pressure at the end. [Pa]
    real(wp), intent(in) :: before
    !> Energy from viscosity. [J/kg]
    real(wp), intent(in) :: heat
    !> Energy. [J/kg]
    real(wp), intent(inout) :: e
    !> Pressure at the end, at least P_cav. [Pa]
    real(wp), intent(out) :: p
    !> Whether there is one.
    logical, intent(out) :: good
    real(wp) :: start, next, slopes(2), missing, scale
    integer :: i

    if (self%isothermal) then
      next = self%state%cold(rho)
      call self%state%pressure(rho, next, p, good)
      p = max(p, self%cavitation)
      e = next
      return
    end if
    start = e + heat - 0.5_wp*before*growth
    next = e
    do i = 1, 50
      call self%state%pressure(rho, next, p, good, slopes)
      if (.not. good) exit
      missing = next - start + 0.5_wp*p*growth
      scale = abs(start) + abs(next) + abs(p*growth)
      if (abs(missing) <= 8.0_wp*epsilon(1.0_wp)*scale) exit
      next = next - missing/max(0.5_wp, 1.0_wp + 0.5_wp*slopes(2)*growth)
      good = abs(next) <= hottest
      if (.not. good) exit
    end do
    if (good) then
      if (p > self%cavitation) then
        ! Rounding may keep the last iterations from ending; a real failure is far off.
        good = abs(missing) <= 1.0e-9_wp*scale
        e = next
        return
      end if
    end if
    p = self%cavitation
    ! Without a pressure at all only an expanded fluid cavitates.
    good = good .or. rho < self%state%density
  end subroutine balance

  !> Give points the pressure of a stress, on the cold curve.
  pure subroutine tillotson_eos_fluid_assign_stress(self, n, target, mass, volume, stress, &
                                                    history, first_bad)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses that are asked for. [Pa] (nstress, n)
    real(wp), intent(in) :: target(self%kin%nstress, n)
    !> Masses; the density gives the pressure. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> Energies. [J/kg] (1, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that can't have its pressure; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: pressure, rho
    integer :: p
    logical :: good

    first_bad = 0
    do p = 1, n
      pressure = -(target(1, p) + target(2, p) + target(3, p))/3.0_wp
      call self%state%density_at(pressure, rho, good)
      if (pressure < self%cavitation .or. .not. good) then
        first_bad = p
        return
      end if
      mass(p) = rho*volume(p)
      history(1, p) = self%state%cold(rho)
      stress(:, p) = 0.0_wp
      stress(1:3, p) = -pressure
    end do
  end subroutine tillotson_eos_fluid_assign_stress

  !> Largest speed of sound, at least that of rho_0.
  pure function tillotson_eos_fluid_wave_speed(self, n, mass, volume, stress, &
                                               history) result(speed)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Energies. [J/kg] (1, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of sound. [m/s]
    real(wp) :: speed
    integer :: p

    associate (unused => stress)
    end associate
    speed = self%state%bulk/self%state%density
    do p = 1, n
      speed = max(speed, self%state%square_of_speed(mass(p)/volume(p), history(1, p)))
    end do
    speed = sqrt(speed)
  end function tillotson_eos_fluid_wave_speed

  !> Largest (4 eta_0/3 + rho_0 c_0 h_i)/rho.
  pure function tillotson_eos_fluid_diffusivity(self, n, mass, volume) result(diffusivity)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Factor of the second derivative of a velocity. [m2/s]
    real(wp) :: diffusivity

    diffusivity = 0.0_wp
    if (n > 0) diffusivity = (4.0_wp*self%viscosity/3.0_wp + self%artificial)*maxval(volume/mass)
  end function tillotson_eos_fluid_diffusivity

  !> Sum of the internal energies m E.
  pure function tillotson_eos_fluid_strain_energy(self, n, mass, volume, stress, history) &
    result(energy)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Energies. [J/kg] (1, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy

    associate (unused => stress, unused_volume => volume)
    end associate
    energy = dot_product(mass, history(1, :))
  end function tillotson_eos_fluid_strain_energy

  !> Send energies and temperatures T_0 + (E - E_c)/c_v.
  subroutine tillotson_eos_fluid_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(tillotson_eos_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Energies. [J/kg] (1, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp) :: temperature(n)
    integer :: p

    associate (unused => stress)
    end associate
    do p = 1, n
      temperature(p) = self%first_temperature &
                       + (history(1, p) - self%state%cold(mass(p)/volume(p)))/self%heat
    end do
    call writer%scalar('Ef', (history(1, :)))
    call writer%scalar('Tf', temperature)
  end subroutine tillotson_eos_fluid_write_fields

end module mpm_tillotson_eos_fluid
