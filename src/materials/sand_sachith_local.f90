!> Dry granular flow with the local mu(I) law.
module mpm_sand_sachith_local
  use mpm_corotation, only: elastic_energy, first_not_finite, invariants, rebuild, shear_rates, &
                            trial_stress
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t
  implicit none
  private
  public :: sand_sachith_local_t

  !> Relative lack of density that still counts as none, for rounded masses and volumes.
  real(wp), parameter :: slack = 1.0e-12_wp

  !> Elastic and frictional grains that carry no stress when looser than a critical density.
  !!
  !! The memory of a point is its plastic shear strain and the rate of it.
  type, extends(material_t) :: sand_sachith_local_t
    !> First Lame constant. [Pa]
    real(wp) :: lambda = 0.0_wp
    !> Shear modulus. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Grain diameter. [m]
    real(wp) :: diameter = 0.0_wp
    !> Static friction mu_s.
    real(wp) :: friction = 0.0_wp
    !> Friction of fast flow mu_2.
    real(wp) :: fast_friction = 0.0_wp
    !> Inertial number I_0 at which friction is half way.
    real(wp) :: inertial = 1.0_wp
    !> Density of the grains. [kg/m3]
    real(wp) :: grain_density = 0.0_wp
    !> Density below which grains do not touch. [kg/m3]
    real(wp) :: critical_density = 0.0_wp
    !> The pressure follows from the density.
    logical :: by_density = .false.
  contains
    procedure, nopass :: describe => sand_sachith_local_describe
    procedure :: init => sand_sachith_local_init
    procedure :: grains => sand_sachith_local_grains
    procedure :: update_stress => sand_sachith_local_update_stress
    procedure :: assign_stress => sand_sachith_local_assign_stress
    procedure :: wave_speed => sand_sachith_local_wave_speed
    procedure :: strain_energy => sand_sachith_local_strain_energy
    procedure :: write_fields => sand_sachith_local_write_fields
  end type sand_sachith_local_t

contains

  !> Purpose and properties of the class.
  subroutine sand_sachith_local_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'Sand_SachithLocal', &
                          'Dry granular flow: elastic, with local mu(I) friction, without stress &
                          &where it is looser than a critical density.', &
                          'Dunatunga and Kamrin, J. Fluid Mech. 779 (2015) 483-513; Jop, Forterre &
                          &and Pouliquen, Nature 441 (2006) 727-730', &
                          '    material-class = "Sand_SachithLocal"'//nl// &
                          '    material-props = {E = 1e6, nu = 0.3, d = 0.005, mu_s = 0.3819, &
                          &rho_s = 2450,'//nl// &
                          '                      rho_c = 1500, mu_2 = 0.6435, I_0 = 0.279}')
    call description%add_real('E', 'Pa', 'Young''s modulus', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio', above=-1.0_wp, below=0.5_wp)
    call description%add_real('d', 'm', 'diameter of the grains', above=0.0_wp)
    call description%add_real('mu_s', '-', 'static friction', lower=0.0_wp)
    call description%add_real('rho_s', 'kg/m3', 'density of the grains', above=0.0_wp)
    call description%add_real('rho_c', 'kg/m3', 'density of the body below which grains do not &
                              &touch', above=0.0_wp)
    call description%add_real('mu_2', '-', 'friction of fast flow; that of mu_s when left out, &
                              &with I_0 otherwise', default=0.0_wp, lower=0.0_wp)
    call description%add_real('I_0', '-', 'inertial number at which friction is half way between &
                              &mu_s and mu_2', default=1.0_wp, above=0.0_wp)
    call description%add_string('flags', '"USE_DENSITY_FOR_PRESSURE": the pressure is &
                                &K (rho/rho_c - 1)', is_list=.true.)
    call description%add_note('The stress turns by exact rotations; mpm_3d takes forward Euler, by &
                              &which it grows.')
    call description%add_note('Where grains do not touch the plastic shear rate is that of the &
                              &flow; mpm_3d counts elastic unloading as flow.')
    call description%add_note('Densities down to 1e-12 below rho_c count as rho_c.')
  end subroutine sand_sachith_local_describe

  !> Set the constants from the properties.
  subroutine sand_sachith_local_init(self, kin, properties, error)
    !> The material.
    class(sand_sachith_local_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> mu_2 without I_0, or an unknown flag.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    real(wp) :: young, poisson
    integer :: i

    self%kin = kin
    self%n_history = 2
    young = properties%real('E')
    poisson = properties%real('nu')
    self%shear = young/(2.0_wp*(1.0_wp + poisson))
    self%lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    self%diameter = properties%real('d')
    self%friction = properties%real('mu_s')
    self%grain_density = properties%real('rho_s')
    self%critical_density = properties%real('rho_c')
    self%fast_friction = self%friction
    self%inertial = properties%real('I_0')
    if (properties%given('mu_2') .neqv. properties%given('I_0')) then
      call properties%reject('mu_2', 'mu_2 and I_0 belong together', error, 'give both, or leave &
                             &both out for a friction that does not depend on the rate')
      return
    end if
    if (properties%given('mu_2')) self%fast_friction = properties%real('mu_2')
    if (self%fast_friction < self%friction) then
      call properties%reject('mu_2', 'mu_2 is below mu_s', error, 'friction must not fall with the &
                             &rate')
      return
    end if
    self%by_density = .false.
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      if (flags(i)%text /= 'USE_DENSITY_FOR_PRESSURE') then
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               '"USE_DENSITY_FOR_PRESSURE"   (mpm3d --describe Sand_SachithLocal)')
        return
      end if
      self%by_density = .true.
    end do
  end subroutine sand_sachith_local_init

  !> Density and friction of the grains.
  pure subroutine sand_sachith_local_grains(self, density, friction)
    !> The material.
    class(sand_sachith_local_t), intent(in) :: self
    !> Density of the grains themselves. [kg/m3]
    real(wp), intent(out) :: density
    !> Largest ratio of shear stress to pressure at rest.
    real(wp), intent(out) :: friction

    density = self%grain_density
    friction = self%friction
  end subroutine sand_sachith_local_grains

  !> Advance the stress of a block of points over one step.
  pure subroutine sand_sachith_local_update_stress(self, n, dt, gradient, mass, volume, stress, &
                                                   history, first_bad)
    !> The material.
    class(sand_sachith_local_t), intent(in) :: self
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
    !> Plastic shear strain and its rate. [-, 1/s] (2, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point whose stress is not finite; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: pressure(n), tau(n), flow(n), wanted(n), factor(n), rate(n)
    integer :: p, n_open

    call trial_stress(self%kin, n, dt, self%lambda, self%shear, gradient, stress, pressure, tau)
    wanted = pressure
    if (self%by_density) then
      wanted = (self%lambda + 2.0_wp*self%shear/3.0_wp)*(mass/volume/self%critical_density - 1.0_wp)
    end if
    ! An infinite trial stress must not look like an open state.
    first_bad = first_not_finite(1, n, pressure + tau)
    if (first_bad > 0) return
    call return_to_yield(n, dt*self%shear, self%friction, self%fast_friction, &
                         self%shear*self%inertial*dt/(self%diameter*sqrt(self%grain_density)), &
                         self%critical_density*(1.0_wp - slack), mass, volume, wanted, tau, flow, &
                         factor, n_open)
    call rebuild(self%kin%nstress, n, pressure, factor, wanted, stress)
    if (n_open > 0) then
      call shear_rates(self%kin, n, gradient, rate)
      do p = 1, n
        if (flow(p) < 0.0_wp) flow(p) = rate(p)
      end do
    end if
    do p = 1, n
      history(1, p) = history(1, p) + dt*flow(p)
      history(2, p) = flow(p)
    end do
  end subroutine sand_sachith_local_update_stress

  !> Bring trial states back: what the deviator is multiplied with, and the plastic shear rate.
  !!
  !! tau is the smaller root of tau**2 - (S2 + tau_tr + a) tau + S2 tau_tr + S0 a = 0, which solves
  !! tau = tau_tr - G dt g and tau/p = mu_s + (mu_2 - mu_s)/(I_0/I + 1), I = g d sqrt(rho_s/p).
  pure subroutine return_to_yield(n, g_dt, friction, fast, inertia, closed, mass, volume, &
                                  pressure, tau, flow, factor, n_open)
    !> Number of points.
    integer, intent(in) :: n
    !> G dt. [Pa s]
    real(wp), intent(in) :: g_dt
    !> mu_s.
    real(wp), intent(in) :: friction
    !> mu_2.
    real(wp), intent(in) :: fast
    !> G I_0 dt/(d sqrt(rho_s)). [Pa**(1/2)]
    real(wp), intent(in) :: inertia
    !> Density from which grains touch. [kg/m3]
    real(wp), intent(in) :: closed
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Trial pressures on entry, pressures on exit. [Pa] (n)
    real(wp), intent(inout) :: pressure(n)
    !> Trial shear stresses. [Pa] (n)
    real(wp), intent(in) :: tau(n)
    !> Plastic shear rates; -1 where grains do not touch. [1/s] (n)
    real(wp), intent(out) :: flow(n)
    !> Ratio of the shear stress to that of the trial state. (n)
    real(wp), intent(out) :: factor(n)
    !> Points whose grains do not touch.
    integer, intent(out) :: n_open
    real(wp) :: s0, a, b, h, s2, kept, push
    integer :: p

    n_open = 0
    do p = 1, n
      push = merge(pressure(p), 0.0_wp, mass(p) >= closed*volume(p) .and. pressure(p) > 0.0_wp)
      n_open = n_open + merge(0, 1, push > 0.0_wp)
      s0 = friction*push
      s2 = fast*push
      a = inertia*sqrt(push)
      b = s2 + tau(p) + a
      h = s2*tau(p) + s0*a
      ! b**2 - 4 h, as a sum that does not cancel.
      kept = sqrt((tau(p) + a - s2)**2 + 4.0_wp*a*(s2 - s0))
      kept = merge(2.0_wp*h/max(b + kept, tiny(b)), tau(p), tau(p) > s0)
      factor(p) = merge(kept/max(tau(p), tiny(b)), 1.0_wp, tau(p) > s0)
      flow(p) = merge((tau(p) - kept)/g_dt, -1.0_wp, push > 0.0_wp)
      pressure(p) = push
    end do
    if (n_open == 0) return
    do p = 1, n
      if (.not. pressure(p) > 0.0_wp) factor(p) = 0.0_wp
    end do
  end subroutine return_to_yield

  !> Give points a stress, where they can have it: its shear is cut to the static strength.
  pure subroutine sand_sachith_local_assign_stress(self, n, target, mass, volume, stress, history, &
                                                   first_bad)
    !> The material.
    class(sand_sachith_local_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses that are asked for. [Pa] (nstress, n)
    real(wp), intent(in) :: target(self%kin%nstress, n)
    !> Masses; with the pressure by density they give it. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> Plastic shear strain and its rate. [-, 1/s] (2, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point whose grains do not touch and that is to have a pressure, or that is to have
    !> tension; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: pressure(n), tau(n), factor(n), bulk
    logical :: loose
    integer :: p

    bulk = self%lambda + 2.0_wp*self%shear/3.0_wp
    call invariants(self%kin%nstress, n, target, pressure, tau)
    factor = 1.0_wp
    first_bad = 0
    do p = n, 1, -1
      if (self%by_density .and. pressure(p) >= 0.0_wp) then
        mass(p) = volume(p)*self%critical_density*(1.0_wp + pressure(p)/bulk)
      end if
      loose = mass(p) < self%critical_density*(1.0_wp - slack)*volume(p)
      if (pressure(p) < 0.0_wp .or. (pressure(p) > 0.0_wp .and. loose)) then
        first_bad = p
      else if (tau(p) > self%friction*pressure(p)) then
        factor(p) = self%friction*pressure(p)/tau(p)
      end if
    end do
    if (first_bad > 0) return
    stress = target
    call rebuild(self%kin%nstress, n, pressure, factor, pressure, stress)
    history(2, :) = 0.0_wp
  end subroutine sand_sachith_local_assign_stress

  !> Largest sqrt((lambda + 2 G)/rho).
  pure function sand_sachith_local_wave_speed(self, n, mass, volume, stress, history) result(speed)
    !> The material.
    class(sand_sachith_local_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain and its rate. [-, 1/s] (2, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of a longitudinal wave. [m/s]
    real(wp) :: speed
    real(wp) :: slowness
    integer :: p

    associate (unused => stress, unused_history => history)
    end associate
    ! Grains that do not touch carry no waves; when they meet they have the critical density.
    slowness = huge(1.0_wp)
    do p = 1, n
      slowness = min(slowness, max(mass(p)/volume(p), self%critical_density))
    end do
    speed = sqrt((self%lambda + 2.0_wp*self%shear)/slowness)
  end function sand_sachith_local_wave_speed

  !> Sum of V (s:s/(4 G) + p**2/(2 K)), s the deviator, p the pressure.
  pure function sand_sachith_local_strain_energy(self, n, mass, volume, stress, history) &
    result(energy)
    !> The material.
    class(sand_sachith_local_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain and its rate. [-, 1/s] (2, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy

    associate (unused => mass, unused_history => history)
    end associate
    energy = elastic_energy(self%kin%nstress, n, self%lambda, self%shear, volume, stress)
  end function sand_sachith_local_strain_energy

  !> Send the plastic shear strain and its rate.
  subroutine sand_sachith_local_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(sand_sachith_local_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain and its rate. [-, 1/s] (2, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => mass, unused_volume => volume, unused_stress => stress)
    end associate
    call writer%scalar('gammap', (history(1, :)))
    call writer%scalar('gammap_dot', (history(2, :)))
  end subroutine sand_sachith_local_write_fields

end module mpm_sand_sachith_local
