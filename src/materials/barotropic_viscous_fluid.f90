!> A weakly compressible Newtonian fluid.
module mpm_barotropic_viscous_fluid
  use mpm_corotation, only: first_not_finite, strain_rates
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t
  implicit none
  private
  public :: barotropic_viscous_fluid_t

  !> p = -K ln(v/v0), T = 2 eta D' - p I. The memory of a point is v0.
  type, extends(material_t) :: barotropic_viscous_fluid_t
    !> Bulk modulus K. [Pa]
    real(wp) :: bulk = 0.0_wp
    !> Dynamic viscosity eta. [Pa s]
    real(wp) :: viscosity = 0.0_wp
    !> Pressures are at least 0.
    logical :: no_tension = .false.
  contains
    procedure, nopass :: describe => barotropic_viscous_fluid_describe
    procedure :: init => barotropic_viscous_fluid_init
    procedure :: start => barotropic_viscous_fluid_start
    procedure :: update_stress => barotropic_viscous_fluid_update_stress
    procedure :: assign_stress => barotropic_viscous_fluid_assign_stress
    procedure :: wave_speed => barotropic_viscous_fluid_wave_speed
    procedure :: diffusivity => barotropic_viscous_fluid_diffusivity
    procedure :: strain_energy => barotropic_viscous_fluid_strain_energy
  end type barotropic_viscous_fluid_t

contains

  !> Purpose and properties of the class.
  subroutine barotropic_viscous_fluid_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'BarotropicViscousFluid', &
                          'Weakly compressible Newtonian fluid, T = 2 eta D'' + K ln(v/v0) I.', &
                          'Batchelor, An Introduction to Fluid Dynamics (1967)', &
                          '    material-class = "BarotropicViscousFluid"'//nl// &
                          '    material-props = {K = 1e5, eta = 1e-3}')
    call description%add_real('K', 'Pa', 'bulk modulus', above=0.0_wp)
    call description%add_real('eta', 'Pa s', 'dynamic viscosity', lower=0.0_wp)
    call description%add_real('h', 'm', 'length of the shift of points; not used without it', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_real('alpha', '-', 'strength of the shift of points: 0, there is none', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_string('flags', '"NO_TENSION": pressures are at least 0, so that the &
                                &fluid parts freely', is_list=.true.)
    call description%add_note('mpm_3d shifts the positions of points (h, alpha) and takes 1 for &
                              &any alpha. There is no shift here: leave alpha out or give 0.')
    call description%add_note('A pressure that a body assigns changes mass and v0 of a point, &
                              &the space that it fills stays; assigned twice it is the same.')
    call description%add_note('The stable step counts the viscosity: with nu = 4 eta/(3 rho) and &
                              &the length l that waves have, dt <= &
                              &l/(nu/l + sqrt(nu^2/l^2 + c^2)).')
  end subroutine barotropic_viscous_fluid_describe

  !> Set the constants from the properties.
  subroutine barotropic_viscous_fluid_init(self, kin, properties, error)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An unknown flag, or a shift of points.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    integer :: i

    self%kin = kin
    self%n_history = 1
    self%bulk = properties%real('K')
    self%viscosity = properties%real('eta')
    self%no_tension = .false.
    if (properties%real('alpha') > 0.0_wp) then
      call properties%reject('alpha', 'points are not shifted', error, 'leave h and alpha out, or &
                             &give alpha = 0')
      return
    end if
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      if (flags(i)%text /= 'NO_TENSION') then
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               '"NO_TENSION"   (mpm3d --describe BarotropicViscousFluid)')
        return
      end if
      self%no_tension = .true.
    end do
  end subroutine barotropic_viscous_fluid_init

  !> Points begin free of pressure.
  pure subroutine barotropic_viscous_fluid_start(self, n, x, mass, volume, history)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Volumes without pressure. [m3] (1, n)
    real(wp), intent(out) :: history(self%n_history, n)

    associate (unused => x, unused_mass => mass)
    end associate
    history(1, :) = volume
  end subroutine barotropic_viscous_fluid_start

  !> The stress of a block of points at the end of a step.
  pure subroutine barotropic_viscous_fluid_update_stress(self, n, dt, gradient, mass, volume, &
                                                         stress, history, first_bad)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
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
    !> Volumes without pressure. [m3] (1, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point whose stress is not finite; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: trace(n), sphere(n)
    integer :: p

    associate (unused => dt, unused_mass => mass)
    end associate
    call pressures(self, n, volume, history, sphere)
    call strain_rates(self%kin, n, 2.0_wp*self%viscosity, gradient, stress, trace)
    sphere = -sphere - (2.0_wp*self%viscosity/3.0_wp)*trace
    do p = 1, n
      stress(1:3, p) = stress(1:3, p) + sphere(p)
    end do
    first_bad = first_not_finite(self%kin%nstress, n, stress)
  end subroutine barotropic_viscous_fluid_update_stress

  !> Pressures of volumes; those of small changes without a library call.
  !!
  !! ln(v/v0) = 2 artanh z, z = (v - v0)/(v + v0); the series to z**13 has a relative error below
  !! z**14/15 < 5e-20 for |z| <= 0.04.
  pure subroutine pressures(self, n, volume, history, pressure)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Volumes without pressure. [m3] (1, n)
    real(wp), intent(in) :: history(1, n)
    !> Pressures. [Pa] (n)
    real(wp), intent(out) :: pressure(n)
    real(wp), parameter :: small = 0.04_wp
    real(wp) :: ratio(n), z, y, c
    integer :: p

    do p = 1, n
      z = (volume(p) - history(1, p))/(volume(p) + history(1, p))
      y = z*z
      c = 1.0_wp + y*(1.0_wp/3.0_wp + y*(0.2_wp + y*(1.0_wp/7.0_wp + y*(1.0_wp/9.0_wp &
          + y*(1.0_wp/11.0_wp + y*(1.0_wp/13.0_wp))))))
      pressure(p) = -2.0_wp*self%bulk*z*c
      ratio(p) = abs(z)
    end do
    if (any(.not. ratio <= small)) then
      do p = 1, n
        if (.not. ratio(p) <= small) then
          pressure(p) = -self%bulk*log(volume(p)/history(1, p))
        end if
      end do
    end if
    if (self%no_tension) pressure = max(0.0_wp, pressure)
  end subroutine pressures

  !> Give points the pressure of a stress; a fluid at rest has no deviator.
  pure subroutine barotropic_viscous_fluid_assign_stress(self, n, target, mass, volume, stress, &
                                                         history, first_bad)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses that are asked for. [Pa] (nstress, n)
    real(wp), intent(in) :: target(self%kin%nstress, n)
    !> Masses; they keep the density without pressure. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> Volumes without pressure. [m3] (1, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point whose density would not be finite; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp), parameter :: largest = 100.0_wp
    real(wp) :: pressure, reference
    integer :: p

    first_bad = 0
    do p = n, 1, -1
      pressure = -(target(1, p) + target(2, p) + target(3, p))/3.0_wp
      if (self%no_tension) pressure = max(0.0_wp, pressure)
      if (.not. abs(pressure) <= largest*self%bulk) then
        first_bad = p
        cycle
      end if
      reference = volume(p)*exp(pressure/self%bulk)
      mass(p) = mass(p)*(reference/history(1, p))
      history(1, p) = reference
      stress(:, p) = 0.0_wp
      stress(1:3, p) = -pressure
    end do
  end subroutine barotropic_viscous_fluid_assign_stress

  !> Largest sqrt(K/rho).
  pure function barotropic_viscous_fluid_wave_speed(self, n, mass, volume, stress, &
                                                    history) result(speed)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Volumes without pressure. [m3] (1, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of sound. [m/s]
    real(wp) :: speed

    associate (unused => stress, unused_history => history)
    end associate
    speed = 0.0_wp
    if (n > 0) speed = sqrt(self%bulk*maxval(volume/mass))
  end function barotropic_viscous_fluid_wave_speed

  !> Largest 4 eta/(3 rho), that of a longitudinal wave.
  pure function barotropic_viscous_fluid_diffusivity(self, n, mass, volume) result(diffusivity)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Factor of the second derivative of a velocity. [m2/s]
    real(wp) :: diffusivity

    diffusivity = 0.0_wp
    if (n > 0) diffusivity = 4.0_wp*self%viscosity/3.0_wp*maxval(volume/mass)
  end function barotropic_viscous_fluid_diffusivity

  !> Sum of the work of the pressure, v0 K (J ln J - J + 1) with J = v/v0.
  pure function barotropic_viscous_fluid_strain_energy(self, n, mass, volume, stress, &
                                                       history) result(energy)
    !> The material.
    class(barotropic_viscous_fluid_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Volumes without pressure. [m3] (1, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    real(wp) :: j
    integer :: p

    associate (unused => stress, unused_mass => mass)
    end associate
    energy = 0.0_wp
    do p = 1, n
      j = volume(p)/history(1, p)
      if (self%no_tension) j = min(j, 1.0_wp)
      energy = energy + self%bulk*history(1, p)*(j*log(j) - j + 1.0_wp)
    end do
  end function barotropic_viscous_fluid_strain_energy

end module mpm_barotropic_viscous_fluid
