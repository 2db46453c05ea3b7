!> A suspension that thickens when sheared.
module mpm_cornstarch
  use mpm_corotation, only: first_not_finite, invariants, rebuild, trial_stress
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_granular_flow, only: granular_flow_t
  use mpm_granular_step, only: width
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_slurry_granular_phase, only: slurry_granular_phase_t, write_flow_fields
  implicit none
  private
  public :: cornstarch_t

  !> Relative distance from the strength at which an assigned shear stress is elastic for sure.
  real(wp), parameter :: inside = 1.0_wp - 1.0e-12_wp

  !> Grains of which a fraction c touches; c moves the packing at which they jam.
  !!
  !! The memory of a point is its plastic shear strain, the rate of it, c, and the viscosity of the
  !! fluid around it.
  type, extends(slurry_granular_phase_t) :: cornstarch_t
    !> Slope of the packing law without and with contacts.
    real(wp) :: slope(0:1) = 1.0_wp
    !> Packing fractions phi_j and phi_c at which grains without and with contacts jam.
    real(wp) :: jammed(0:1) = 1.0_wp
    !> Largest c near phi_j.
    real(wp) :: delta = 0.0_wp
    !> Stress that pushes grains into contact. [Pa]
    real(wp) :: push = 1.0_wp
    !> Rate K_5 of c.
    real(wp) :: contact_rate = 0.0_wp
    !> Loss of contacts K_6 and K_7. [1/(Pa s)]
    real(wp) :: loss(2) = 0.0_wp
    !> Exponent of K_6.
    real(wp) :: power = 1.0_wp
    !> c at the start.
    real(wp) :: first = 0.0_wp
  contains
    procedure, nopass :: describe => cornstarch_describe
    procedure :: init => cornstarch_init
    procedure :: start => cornstarch_start
    procedure :: update_stress => cornstarch_update_stress
    procedure :: assign_stress => cornstarch_assign_stress
    procedure :: write_fields => cornstarch_write_fields
  end type cornstarch_t

contains

  !> Purpose and properties of the class.
  subroutine cornstarch_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'Cornstarch', &
                          'Grains of a dense suspension that thickens when sheared: as &
                          &SlurryGranularPhase, with a fraction of frictional contacts.', &
                          'Baumgarten and Kamrin, PNAS 116 (2019) 20828-20836', &
                          '    material-class = "Cornstarch"'//nl// &
                          '    material-props = {E = 1e6, nu = 0.3, mu_1 = 0.5, a_0 = 0.2, &
                          &a_inf = 1, K_3 = 0.6,'//nl// &
                          '                      K_4 = 0, K_5 = 1, K_6 = 1e-3, phi_j = 0.6, &
                          &phi_c = 0.55, Delta = 0.5,'//nl// &
                          '                      tau_star = 10, alpha = 1, rho_s = 1500, &
                          &eta_0 = 1e-3, d = 1e-5, rho_f = 1000}')
    call description%add_real('E', 'Pa', 'Young''s modulus', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio', above=-1.0_wp, below=0.5_wp)
    call description%add_real('mu_1', '-', 'friction', lower=0.0_wp)
    call description%add_real('a_0', '-', 'slope of the packing law without contacts', above=0.0_wp)
    call description%add_real('a_inf', '-', 'slope of the packing law with all contacts', &
                              above=0.0_wp)
    call description%add_real('K_3', '-', 'dilation', lower=0.0_wp)
    call description%add_real('K_4', '-', 'compaction of loose grains by flow; 0, none', &
                              lower=0.0_wp)
    call description%add_real('K_5', '-', 'rate of the contacts', lower=0.0_wp)
    call description%add_real('K_6', '1/(Pa s)', 'loss of contacts', lower=0.0_wp)
    call description%add_real('phi_j', '-', 'packing fraction that jams without contacts', &
                              above=0.0_wp, upper=1.0_wp)
    call description%add_real('phi_c', '-', 'packing fraction that jams with contacts', &
                              above=0.0_wp, upper=1.0_wp)
    call description%add_real('Delta', '-', 'largest fraction of contacts close to phi_j', &
                              lower=0.0_wp, upper=1.0_wp)
    call description%add_real('tau_star', 'Pa', 'stress that pushes grains into contact', &
                              above=0.0_wp)
    call description%add_real('alpha', '-', 'exponent of the loss of contacts', lower=0.0_wp)
    call description%add_real('rho_s', 'kg/m3', 'density of the grains', above=0.0_wp)
    call description%add_real('eta_0', 'Pa s', 'viscosity of the fluid', lower=0.0_wp)
    call description%add_real('d', 'm', 'diameter of the grains', above=0.0_wp)
    call description%add_real('rho_f', 'kg/m3', 'density of the fluid; not used', lower=0.0_wp)
    call description%add_real('K_7', '1/(Pa s)', 'loss of contacts close to phi_j', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_real('c_0', '-', 'fraction of contacts at the start', default=0.0_wp, &
                              lower=0.0_wp, upper=1.0_wp)
    call description%add_string('fluid', 'body of the fluid: eta_0 counts at nodes that it &
                                &reaches; without one, everywhere', default='')
    call description%add_note('The stress is that of the grains. The contact SlurryMixture adds &
                              &buoyancy and drag of a fluid.')
    call description%add_note('A stress within the static cone stays at any packing, as in mpm_3d &
                              &and unlike SlurryGranularPhase.')
    call description%add_note('The plastic step is one equation, solved to round-off; mpm_3d takes &
                              &Newton steps without a bound.')
  end subroutine cornstarch_describe

  !> Set the constants from the properties.
  subroutine cornstarch_init(self, kin, properties, error)
    !> The material.
    class(cornstarch_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> phi_c is not below phi_j.
    type(error_t), allocatable, intent(out) :: error

    self%kin = kin
    self%n_history = 4
    self%at_viscosity = 4
    associate (young => properties%real('E'), poisson => properties%real('nu'))
      self%law%shear = young/(2.0_wp*(1.0_wp + poisson))
      self%law%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    end associate
    self%law%friction = properties%real('mu_1')
    self%law%fast_friction = self%law%friction
    self%law%inertial = 0.0_wp
    self%law%dilation = properties%real('K_3')
    self%law%compaction = properties%real('K_4')
    self%law%grain_density = properties%real('rho_s')
    self%law%viscosity = properties%real('eta_0')
    self%law%diameter = properties%real('d')
    self%slope = [properties%real('a_0'), properties%real('a_inf')]
    self%jammed = [properties%real('phi_j'), properties%real('phi_c')]
    self%delta = properties%real('Delta')
    self%push = properties%real('tau_star')
    self%contact_rate = properties%real('K_5')
    self%loss = [properties%real('K_6'), properties%real('K_7')]
    self%power = properties%real('alpha')
    self%first = properties%real('c_0')
    ! The packing below which no cone is left, for the speed of waves.
    self%law%gate = 0.0_wp
    if (self%law%dilation > 0.0_wp) then
      self%law%gate = max(0.0_wp, self%jammed(1) - self%law%friction/self%law%dilation)
    end if
    if (self%jammed(1) >= self%jammed(0)) then
      call properties%reject('phi_c', 'phi_c is not below phi_j', error, 'contacts jam looser &
                             &packings')
    end if
    call self%partner%ask(properties, 'fluid', '')
  end subroutine cornstarch_init

  !> Points begin with the first fraction of contacts.
  pure subroutine cornstarch_start(self, n, x, mass, volume, history)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Plastic shear strain, its rate, c, and viscosity. (4, n)
    real(wp), intent(out) :: history(self%n_history, n)

    associate (unused => x, unused_mass => mass, unused_volume => volume)
    end associate
    history(1:2, :) = 0.0_wp
    history(3, :) = self%first
    history(self%at_viscosity, :) = self%law%viscosity
  end subroutine cornstarch_start

  !> The law at a fraction of contacts.
  pure function law_of(self, c) result(law)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Fraction of contacts.
    real(wp), intent(in) :: c
    !> The law.
    type(granular_flow_t) :: law

    law = self%law
    law%slope = self%slope(0) + (self%slope(1) - self%slope(0))*c
    law%critical = jam(self, c)
    law%gate = law%critical
  end function law_of

  !> Packing fraction that jams with a fraction of contacts.
  elemental function jam(self, c) result(critical)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Fraction of contacts.
    real(wp), intent(in) :: c
    !> The packing fraction.
    real(wp) :: critical

    critical = self%jammed(0) + (self%jammed(1) - self%jammed(0))*c
  end function jam

  !> Advance the stress of a block of points over one step.
  pure subroutine cornstarch_update_stress(self, n, dt, gradient, mass, volume, stress, history, &
                                           first_bad)
    !> The material.
    class(cornstarch_t), intent(in) :: self
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
    !> Plastic shear strain, its rate, c, and viscosity. (4, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point without a stress; 0 when there is none.
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
  end subroutine cornstarch_update_stress

  !> Advance the stress of so many points that work arrays have a fixed size.
  pure subroutine advance(self, n, dt, gradient, mass, volume, stress, history, first_bad)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Number of points, at most `width`.
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
    !> Plastic shear strain, its rate, c, and viscosity. (4, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point without a stress; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp), dimension(width) :: trial, tau, pressure, kept, phi, rate, viscosity, factor
    real(wp), dimension(width) :: contacts, slope, critical, gate
    integer :: p

    pressure(:n) = -(stress(1, :) + stress(2, :) + stress(3, :))/3.0_wp
    call trial_stress(self%kin, n, dt, self%law%bulk - 2.0_wp*self%law%shear/3.0_wp, &
                      self%law%shear, gradient, stress, trial, tau)
    factor(:n) = trial(:n) + tau(:n)
    first_bad = first_not_finite(1, n, factor)
    if (first_bad > 0) return
    phi(:n) = mass/(volume*self%law%grain_density)
    rate(:n) = history(2, :)
    contacts(:n) = history(3, :)
    viscosity(:n) = history(self%at_viscosity, :)
    slope(:n) = self%slope(0) + (self%slope(1) - self%slope(0))*contacts(:n)
    critical(:n) = jam(self, contacts(:n))
    ! Stresses within the static cone stay at any packing.
    do p = 1, n
      factor(p) = tau(p) - max(0.0_wp, self%law%friction &
                               + self%law%dilation*(phi(p) - critical(p)))*trial(p)
      gate(p) = merge(0.0_wp, critical(p), factor(p) <= 0.0_wp .and. trial(p) >= 0.0_wp)
    end do
    call self%law%solve_block(n, dt, viscosity, slope, critical, gate, phi, trial, tau, pressure, &
                              kept, rate, first_bad)
    if (first_bad > 0) return
    factor(:n) = kept(:n)/max(tau(:n), tiny(1.0_wp))
    history(1, :) = history(1, :) + dt*rate(:n)
    history(2, :) = rate(:n)
    call advance_contacts(self, n, dt, phi, kept, rate, contacts)
    history(3, :) = contacts(:n)
    call rebuild(self%kin%nstress, n, trial, factor, pressure, stress)
  end subroutine advance

  !> Advance the fractions of contacts by backward Euler.
  pure subroutine advance_contacts(self, n, dt, phi, tau, rate, contacts)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Packing fractions. (n)
    real(wp), intent(in) :: phi(n)
    !> Shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau(n)
    !> Plastic shear rates. [1/s] (n)
    real(wp), intent(in) :: rate(n)
    !> Fractions of contacts. (n)
    real(wp), intent(inout) :: contacts(n)
    real(wp) :: lost(width), jammed(0:1), delta, push, gain, loss, most, k5
    integer :: i

    jammed = self%jammed
    delta = self%delta
    push = self%push
    k5 = dt*self%contact_rate
    do i = 1, n
      lost(i) = self%loss(1)*max(0.0_wp, jammed(0) - phi(i))
    end do
    if (abs(self%power - 1.0_wp) > 0.0_wp .or. self%loss(2) > 0.0_wp) then
      do i = 1, n
        lost(i) = self%loss(1)*max(0.0_wp, jammed(0) - phi(i))**self%power &
                  + self%loss(2)*max(0.0_wp, jammed(0) - phi(i))**0.1_wp
      end do
    end if
    do i = 1, n
      gain = k5*(tau(i)/push)*sqrt(tau(i)/push)*rate(i)
      loss = k5*(rate(i) + tau(i)*lost(i))
      most = min(1.0_wp, max(delta, (phi(i) - jammed(0))/(jammed(1) - jammed(0))))
      contacts(i) = (contacts(i) + gain*most)/(1.0_wp + gain + loss)
    end do
    do i = 1, n
      contacts(i) = merge(1.0_wp, contacts(i), phi(i) > jammed(0))
    end do
  end subroutine advance_contacts

  !> Give points a stress, where they can have it: its shear is cut to the static strength.
  pure subroutine cornstarch_assign_stress(self, n, target, mass, volume, stress, history, &
                                           first_bad)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses that are asked for. [Pa] (nstress, n)
    real(wp), intent(in) :: target(self%kin%nstress, n)
    !> Masses. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> Plastic shear strain, its rate, c, and viscosity. (4, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that is too loose to carry its pressure at rest, or that is to have tension; 0
    !> when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: pressure(n), tau(n), factor(n), strength, phi
    type(granular_flow_t) :: law
    integer :: p

    call invariants(self%kin%nstress, n, target, pressure, tau)
    factor = 1.0_wp
    first_bad = 0
    do p = n, 1, -1
      phi = mass(p)/(volume(p)*self%law%grain_density)
      law = law_of(self, history(3, p))
      strength = inside*law%strength(phi, pressure(p), 0.0_wp)
      if (pressure(p) < 0.0_wp .or. (pressure(p) > 0.0_wp .and. .not. strength > 0.0_wp)) then
        first_bad = p
      else if (tau(p) > strength) then
        factor(p) = strength/tau(p)
      end if
    end do
    if (first_bad > 0) return
    stress = target
    call rebuild(self%kin%nstress, n, pressure, factor, pressure, stress)
    history(2, :) = 0.0_wp
  end subroutine cornstarch_assign_stress

  !> Send the fields of the flow, c, and the packing fraction that jams.
  subroutine cornstarch_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(cornstarch_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain, its rate, c, and viscosity. (4, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer

    call write_flow_fields(self%law, n, mass, volume, stress, history, &
                           history(self%at_viscosity, :), writer)
    call writer%scalar('c', (history(3, :)))
    call writer%scalar('phi_m', jam(self, history(3, :)))
  end subroutine cornstarch_write_fields

end module mpm_cornstarch
