!> Isotropic linear elasticity in rate form.
module mpm_isotropic_linear_elasticity
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_hughes_winget, only: hughes_winget
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_1d, type_axisymmetric, type_out_of_plane, &
                            type_plane_strain
  use mpm_material, only: material_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt
  implicit none
  private
  public :: isotropic_linear_elasticity_t

  !> Hypoelastic solid with the Jaumann rate.
  !!
  !! By forward Euler T += dt (2 G D + lambda tr(D) I + W T - T W), D and W the symmetric and skew
  !! parts of L; or by the incrementally objective rule of `mpm_hughes_winget`.
  type, extends(material_t) :: isotropic_linear_elasticity_t
    !> First Lame constant. [Pa]
    real(wp) :: lambda = 0.0_wp
    !> Shear modulus. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Integrate the rotation by the rule of Hughes and Winget instead of forward Euler.
    logical :: incrementally_objective = .false.
  contains
    procedure, nopass :: describe => isotropic_linear_elasticity_describe
    procedure :: init => isotropic_linear_elasticity_init
    procedure :: update_stress => isotropic_linear_elasticity_update_stress
    procedure :: wave_speed => isotropic_linear_elasticity_wave_speed
    procedure :: strain_energy => isotropic_linear_elasticity_strain_energy
    !> Set the constants from numbers.
    procedure :: set => isotropic_linear_elasticity_set
  end type isotropic_linear_elasticity_t

contains

  !> Purpose and properties of the class.
  subroutine isotropic_linear_elasticity_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'IsotropicLinearElasticity', &
                          'Isotropic linear elasticity in rate form with the Jaumann rate, &
                          &T += dt (2 G D + lambda tr(D) I + W T - T W).', &
                          'Zaremba (1903); Jaumann (1911); Gurtin, Fried and Anand, The Mechanics &
                          &and Thermodynamics of Continua (2010)', &
                          '    material-class = "IsotropicLinearElasticity"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3}')
    call description%add_real('E', 'Pa', 'Young''s modulus', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio', above=-1.0_wp, below=0.5_wp)
    call description%add_string('rate', 'integration of the rotation: "jaumann", forward Euler as &
                                &in mpm_3d, or "hughes_winget", incrementally objective', &
                                default='jaumann')
    call description%add_note('rate = "jaumann": under a spin w the deviator grows by &
                              &sqrt(1 + 4 w^2 dt^2) a step. rate = "hughes_winget": a rigid motion &
                              &turns the stress to round-off, and strains are of second order in &
                              &dt (Hughes and Winget, IJNME 15 (1980) 1862-1867).')
  end subroutine isotropic_linear_elasticity_describe

  !> Set the constants from the properties.
  subroutine isotropic_linear_elasticity_init(self, kin, properties, error)
    !> The material.
    class(isotropic_linear_elasticity_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> There is no such rate.
    type(error_t), allocatable, intent(out) :: error

    call self%set(kin, properties%real('E'), properties%real('nu'))
    select case (properties%string('rate'))
    case ('jaumann')
      self%incrementally_objective = .false.
    case ('hughes_winget')
      self%incrementally_objective = .true.
    case default
      call properties%reject('rate', 'there is no rate "'//excerpt(properties%string('rate'))// &
                             '"', error, '"jaumann" or "hughes_winget"   (mpm3d --describe &
                             &IsotropicLinearElasticity)')
    end select
  end subroutine isotropic_linear_elasticity_init

  !> Set the constants from numbers.
  pure subroutine isotropic_linear_elasticity_set(self, kin, young, poisson)
    !> The material.
    class(isotropic_linear_elasticity_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Young's modulus. [Pa]
    real(wp), intent(in) :: young
    !> Poisson ratio.
    real(wp), intent(in) :: poisson

    self%kin = kin
    self%shear = young/(2.0_wp*(1.0_wp + poisson))
    self%lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
  end subroutine isotropic_linear_elasticity_set

  !> Advance the stress of a block of points over one step.
  pure subroutine isotropic_linear_elasticity_update_stress(self, n, dt, gradient, mass, volume, &
                                                            stress, history, first_bad)
    !> The material.
    class(isotropic_linear_elasticity_t), intent(in) :: self
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
    !> Nothing is remembered. (0, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that is turned inside out within the step; always 0 with forward Euler, for which
    !> every velocity gradient has its stress.
    integer, intent(out) :: first_bad

    associate (unused => mass, unused_volume => volume, unused_history => history)
    end associate
    first_bad = 0
    if (self%incrementally_objective) then
      call hughes_winget(self%kin, n, dt, self%lambda, self%shear, gradient, stress, first_bad)
      return
    end if
    select case (self%kin%sim_type)
    case (type_1d)
      call update_1d(n, dt*self%lambda, 2.0_wp*dt*self%shear, gradient, stress)
    case (type_plane_strain)
      call update_plane(n, dt, dt*self%lambda, 2.0_wp*dt*self%shear, gradient, stress)
    case default
      call update_full(self%kin%sim_type, self%kin%ngrad, n, dt, dt*self%lambda, &
                       2.0_wp*dt*self%shear, gradient, stress)
    end select
  end subroutine isotropic_linear_elasticity_update_stress

  !> Uniaxial strain: no rotation.
  pure subroutine update_1d(n, dt_lambda, dt_2g, gradient, stress)
    !> Number of points.
    integer, intent(in) :: n
    !> dt lambda. [Pa s]
    real(wp), intent(in) :: dt_lambda
    !> 2 dt G. [Pa s]
    real(wp), intent(in) :: dt_2g
    !> Velocity gradients. [1/s] (1, n)
    real(wp), intent(in) :: gradient(1, n)
    !> Stresses xx yy zz. [Pa] (3, n)
    real(wp), intent(inout) :: stress(3, n)
    integer :: p

    do p = 1, n
      stress(1, p) = stress(1, p) + (dt_lambda + dt_2g)*gradient(1, p)
      stress(2, p) = stress(2, p) + dt_lambda*gradient(1, p)
      stress(3, p) = stress(3, p) + dt_lambda*gradient(1, p)
    end do
  end subroutine update_1d

  !> Plane strain.
  pure subroutine update_plane(n, dt, dt_lambda, dt_2g, gradient, stress)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> dt lambda. [Pa s]
    real(wp), intent(in) :: dt_lambda
    !> 2 dt G. [Pa s]
    real(wp), intent(in) :: dt_2g
    !> Velocity gradients xx xy yx yy. [1/s] (4, n)
    real(wp), intent(in) :: gradient(4, n)
    !> Stresses xx yy zz xy. [Pa] (4, n)
    real(wp), intent(inout) :: stress(4, n)
    real(wp) :: sphere, spin, txx, tyy, txy
    integer :: p

    do p = 1, n
      txx = stress(1, p)
      tyy = stress(2, p)
      txy = stress(4, p)
      sphere = dt_lambda*(gradient(1, p) + gradient(4, p))
      spin = 0.5_wp*dt*(gradient(2, p) - gradient(3, p))
      stress(1, p) = txx + sphere + dt_2g*gradient(1, p) + 2.0_wp*spin*txy
      stress(2, p) = tyy + sphere + dt_2g*gradient(4, p) - 2.0_wp*spin*txy
      stress(3, p) = stress(3, p) + sphere
      stress(4, p) = txy + 0.5_wp*dt_2g*(gradient(2, p) + gradient(3, p)) + spin*(tyy - txx)
    end do
  end subroutine update_plane

  !> The TYPEs with six stress components.
  pure subroutine update_full(sim_type, ngrad, n, dt, dt_lambda, dt_2g, gradient, stress)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Stored components of a velocity gradient.
    integer, intent(in) :: ngrad
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> dt lambda. [Pa s]
    real(wp), intent(in) :: dt_lambda
    !> 2 dt G. [Pa s]
    real(wp), intent(in) :: dt_2g
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(ngrad, n)
    !> Stresses xx yy zz xy yz zx. [Pa] (6, n)
    real(wp), intent(inout) :: stress(6, n)
    real(wp) :: l(9)
    integer :: p

    select case (sim_type)
    case (type_out_of_plane)
      do p = 1, n
        l = [gradient(1, p), gradient(2, p), 0.0_wp, gradient(3, p), gradient(4, p), 0.0_wp, &
             gradient(5, p), gradient(6, p), 0.0_wp]
        call update_point(dt, dt_lambda, dt_2g, l, stress(:, p))
      end do
    case (type_axisymmetric)
      do p = 1, n
        l = [gradient(1, p), gradient(2, p), gradient(7, p), gradient(3, p), gradient(4, p), &
             0.0_wp, gradient(5, p), gradient(6, p), gradient(8, p)]
        call update_point(dt, dt_lambda, dt_2g, l, stress(:, p))
      end do
    case default
      do p = 1, n
        call update_point(dt, dt_lambda, dt_2g, gradient(:, p), stress(:, p))
      end do
    end select
  end subroutine update_full

  !> One point with a full velocity gradient.
  pure subroutine update_point(dt, dt_lambda, dt_2g, l, t)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> dt lambda. [Pa s]
    real(wp), intent(in) :: dt_lambda
    !> 2 dt G. [Pa s]
    real(wp), intent(in) :: dt_2g
    !> Velocity gradient, row by row. [1/s]
    real(wp), intent(in) :: l(9)
    !> Stress xx yy zz xy yz zx. [Pa]
    real(wp), intent(inout) :: t(6)
    real(wp) :: sphere, wxy, wyz, wzx, g, s(6)

    s = t
    sphere = dt_lambda*(l(1) + l(5) + l(9))
    g = 0.5_wp*dt_2g
    wxy = 0.5_wp*dt*(l(2) - l(4))
    wyz = 0.5_wp*dt*(l(6) - l(8))
    wzx = 0.5_wp*dt*(l(7) - l(3))
    t(1) = s(1) + sphere + dt_2g*l(1) + 2.0_wp*(wxy*s(4) - wzx*s(6))
    t(2) = s(2) + sphere + dt_2g*l(5) + 2.0_wp*(wyz*s(5) - wxy*s(4))
    t(3) = s(3) + sphere + dt_2g*l(9) + 2.0_wp*(wzx*s(6) - wyz*s(5))
    t(4) = s(4) + g*(l(2) + l(4)) + wxy*(s(2) - s(1)) + wyz*s(6) - wzx*s(5)
    t(5) = s(5) + g*(l(6) + l(8)) + wyz*(s(3) - s(2)) + wzx*s(4) - wxy*s(6)
    t(6) = s(6) + g*(l(3) + l(7)) + wzx*(s(1) - s(3)) + wxy*s(5) - wyz*s(4)
  end subroutine update_point

  !> Largest sqrt((lambda + 2 G)/rho).
  pure function isotropic_linear_elasticity_wave_speed(self, n, mass, volume, stress, &
                                                               history) result(speed)
    !> The material.
    class(isotropic_linear_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Nothing is remembered. (0, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of a longitudinal wave. [m/s]
    real(wp) :: speed
    integer :: p

    associate (unused => stress, unused_history => history)
    end associate
    speed = 0.0_wp
    do p = 1, n
      speed = max(speed, (self%lambda + 2.0_wp*self%shear)*volume(p)/mass(p))
    end do
    speed = sqrt(speed)
  end function isotropic_linear_elasticity_wave_speed

  !> Sum of V (s:s/(4 G) + p**2/(2 K)), s the deviator, p the pressure.
  pure function isotropic_linear_elasticity_strain_energy(self, n, mass, volume, stress, &
                                                                  history) result(energy)
    !> The material.
    class(isotropic_linear_elasticity_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Nothing is remembered. (0, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    real(wp) :: bulk, p, shear_part
    integer :: i

    associate (unused => mass, unused_history => history)
    end associate
    bulk = self%lambda + 2.0_wp*self%shear/3.0_wp
    energy = 0.0_wp
    do i = 1, n
      p = -(stress(1, i) + stress(2, i) + stress(3, i))/3.0_wp
      shear_part = sum((stress(1:3, i) + p)**2) + 2.0_wp*sum(stress(4:, i)**2)
      energy = energy + volume(i)*(shear_part/(4.0_wp*self%shear) + p*p/(2.0_wp*bulk))
    end do
  end function isotropic_linear_elasticity_strain_energy

end module mpm_isotropic_linear_elasticity
