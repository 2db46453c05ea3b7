!> The pore fluid of a mixture.
module mpm_slurry_fluid_phase
  use mpm_corotation, only: first_not_finite, strain_rates
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_nodes, only: nodes_t
  use mpm_points, only: points_t
  use mpm_pore_fluid, only: observe_grains
  use mpm_properties, only: properties_t
  use mpm_shear_shift, only: shift_by_shear
  implicit none
  private
  public :: slurry_fluid_phase_t

  !> Places in the memory of a point: ln J of the fluid itself, the porosity, and what the rate of
  !! ln J exceeds the rate of volume of the point by [1/s].
  integer, parameter :: log_j = 1, porosity = 2, excess = 3

  !> p = -K ln J, T = 2 eta_0 (1 + 5/2 (1 - n)) D' - p I, with the porosity n and J of the fluid.
  type, extends(material_t) :: slurry_fluid_phase_t
    !> Bulk modulus K. [Pa]
    real(wp) :: bulk = 0.0_wp
    !> Viscosity of the pure fluid. [Pa s]
    real(wp) :: viscosity = 0.0_wp
    !> Density of the grains. [kg/m3]
    real(wp) :: grain_density = 0.0_wp
    !> Length h of the shift of points. [m]
    real(wp) :: length = 0.0_wp
    !> Strength alpha of the shift of points; 0, there is none.
    real(wp) :: strength = 0.0_wp
  contains
    procedure, nopass :: describe => slurry_fluid_phase_describe
    procedure :: init => slurry_fluid_phase_init
    procedure :: start => slurry_fluid_phase_start
    procedure :: observe => slurry_fluid_phase_observe
    procedure :: prepare => slurry_fluid_phase_prepare
    procedure :: correct => slurry_fluid_phase_correct
    procedure :: update_stress => slurry_fluid_phase_update_stress
    procedure :: assign_stress => slurry_fluid_phase_assign_stress
    procedure :: wave_speed => slurry_fluid_phase_wave_speed
    procedure :: diffusivity => slurry_fluid_phase_diffusivity
    procedure :: strain_energy => slurry_fluid_phase_strain_energy
    procedure :: write_fields => slurry_fluid_phase_write_fields
  end type slurry_fluid_phase_t

contains

  !> Purpose and properties of the class.
  subroutine slurry_fluid_phase_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'SlurryFluidPhase', &
                          'Pore fluid of a fluid-sediment mixture: pressure from its own volume, &
                          &viscosity of a suspension.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764; Einstein, &
                          &Ann. Phys. 324 (1906) 289-306', &
                          '    material-class = "SlurryFluidPhase"'//nl// &
                          '    material-props = {K = 1e5, eta_0 = 1e-3, rho_s = 2700}')
    call description%add_real('K', 'Pa', 'bulk modulus', above=0.0_wp)
    call description%add_real('eta_0', 'Pa s', 'viscosity of the pure fluid', lower=0.0_wp)
    call description%add_real('rho_s', 'kg/m3', 'density of the grains; not used without a body &
                              &of grains', above=0.0_wp)
    call description%add_real('h', 'm', 'length of the shift of points, about that of a cell', &
                              default=0.0_wp, lower=0.0_wp)
    call description%add_real('alpha', '-', 'strength of the shift of points, about 1; 0, there is &
                              &none', default=0.0_wp, lower=0.0_wp)
    call description%add_string('solid', 'body of the grains; without one the porosity is 1', &
                                default='')
    call description%add_integer('solid_id', 'that body by its number, from 0, when no name is &
                                 &given', default=-1, lower=-1)
    call description%add_note('Without a body of grains the law is that of BarotropicViscousFluid. &
                              &With one, the contact SlurryMixture adds buoyancy and drag, and the &
                              &masses of the points are those of the fluid in their volume, n &
                              &rho_f V.')
    call description%add_note('The rate of volume comes from the velocities that strain rates are &
                              &formed from, whichever the solver takes.')
    call description%add_note('alpha shifts points out of places where they are too many, at the &
                              &rate of shear. In mpm_3d rotation shifts them as well. &
                              &ImprovedQuadraturePoints has other rules for any material; with &
                              &one of them leave alpha out.')
    call description%add_note('A pressure that a body assigns changes J and leaves mass and &
                              &volume.')
  end subroutine slurry_fluid_phase_describe

  !> Set the constants from the properties.
  subroutine slurry_fluid_phase_init(self, kin, properties, error)
    !> The material.
    class(slurry_fluid_phase_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A shift of points without its length.
    type(error_t), allocatable, intent(out) :: error

    self%kin = kin
    self%n_history = 3
    self%bulk = properties%real('K')
    self%viscosity = properties%real('eta_0')
    self%grain_density = properties%real('rho_s')
    call self%partner%ask(properties, 'solid', 'solid_id')
    self%length = properties%real('h')
    self%strength = properties%real('alpha')
    if (self%strength > 0.0_wp .and. .not. self%length > 0.0_wp) then
      call properties%reject('h', 'a shift of points needs its length h', error, 'give the size of &
                             &a cell, or alpha = 0')
    end if
  end subroutine slurry_fluid_phase_init

  !> Points begin free of pressure, with nothing but fluid.
  pure subroutine slurry_fluid_phase_start(self, n, x, mass, volume, history)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> ln J, porosity, and excess of the rate of ln J. (3, n)
    real(wp), intent(out) :: history(self%n_history, n)

    associate (unused => x, unused_mass => mass, unused_volume => volume)
    end associate
    history(log_j, :) = 0.0_wp
    history(porosity, :) = 1.0_wp
    history(excess, :) = 0.0_wp
  end subroutine slurry_fluid_phase_start

  !> Ask the points for velocity gradients and the sums of shifts, if they are shifted.
  subroutine slurry_fluid_phase_prepare(self, points)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points

    if (.not. self%strength > 0.0_wp) return
    points%needs_gradient = .true.
    if (.not. allocated(points%gradient)) then
      allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
    end if
    if (.not. allocated(points%shifted)) then
      allocate (points%shifted(points%kin%dim, points%n), source=0.0_wp)
    end if
  end subroutine slurry_fluid_phase_prepare

  !> Shift the points, if asked for.
  subroutine slurry_fluid_phase_correct(self, grid, points, dt, threads)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The points, moved.
    class(points_t), intent(inout) :: points
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads

    if (.not. self%strength > 0.0_wp) return
    call shift_by_shear(points, grid, self%length, self%strength, dt, threads)
  end subroutine slurry_fluid_phase_correct

  !> Take porosity and rate of volume from the grains.
  subroutine slurry_fluid_phase_observe(self, grid, points, nodes, remapped, threads, &
                                        other_points, other_nodes)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the fluid.
    class(points_t), intent(inout) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Strain rates will be formed from the velocities of the second mapping.
    logical, intent(in) :: remapped
    !> Number of threads.
    integer, intent(in) :: threads
    !> Points of the grains; left out while these are not active.
    class(points_t), intent(in), optional :: other_points
    !> Their nodes.
    class(nodes_t), intent(in), optional :: other_nodes
    real(wp), allocatable :: n(:), rate(:)

    allocate (n(points%n_inside), source=1.0_wp)
    allocate (rate(points%n_inside), source=0.0_wp)
    if (present(other_points) .and. present(other_nodes)) then
      call observe_grains(grid, self%grain_density, points, nodes, other_points, other_nodes, &
                          remapped, threads, n, rate)
    end if
    points%history(porosity, :points%n_inside) = n
    points%history(excess, :points%n_inside) = rate
  end subroutine slurry_fluid_phase_observe

  !> The stress of a block of points at the end of a step.
  pure subroutine slurry_fluid_phase_update_stress(self, n, dt, gradient, mass, volume, stress, &
                                                   history, first_bad)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
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
    !> ln J, porosity, and excess of the rate of ln J. (3, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point whose stress is not finite; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: trace(n), eta
    integer :: p

    associate (unused => mass, unused_volume => volume)
    end associate
    call strain_rates(self%kin, n, 2.0_wp*self%viscosity, gradient, stress, trace)
    do p = 1, n
      eta = 1.0_wp + 2.5_wp*(1.0_wp - history(porosity, p))
      history(log_j, p) = history(log_j, p) + dt*(trace(p) + history(excess, p))
      stress(:, p) = eta*stress(:, p)
      stress(1:3, p) = stress(1:3, p) + self%bulk*history(log_j, p) &
                       - (2.0_wp*eta*self%viscosity/3.0_wp)*trace(p)
    end do
    first_bad = first_not_finite(self%kin%nstress, n, stress)
  end subroutine slurry_fluid_phase_update_stress

  !> Give points the pressure of a stress; a fluid at rest has no deviator.
  pure subroutine slurry_fluid_phase_assign_stress(self, n, target, mass, volume, stress, history, &
                                                   first_bad)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
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
    !> ln J, porosity, and excess of the rate of ln J. (3, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> Always 0.
    integer, intent(out) :: first_bad
    real(wp) :: pressure
    integer :: p

    associate (unused => mass, unused_volume => volume)
    end associate
    first_bad = 0
    do p = 1, n
      pressure = -(target(1, p) + target(2, p) + target(3, p))/3.0_wp
      history(log_j, p) = -pressure/self%bulk
      stress(:, p) = 0.0_wp
      stress(1:3, p) = -pressure
    end do
  end subroutine slurry_fluid_phase_assign_stress

  !> Largest sqrt(K n V/m + K (1 - n)/(n rho_s)), that of waves in fluid and free grains.
  !!
  !! With rho_f = m/(n V), n rho_f a_f = -n grad p and rho_s a_s = -grad p give c**2 = K/n (n/rho_f
  !! + (1 - n)/rho_s). Drag makes waves slower: locked grains, K/n over the density of the mixture.
  pure function slurry_fluid_phase_wave_speed(self, n, mass, volume, stress, history) result(speed)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> ln J, porosity, and excess of the rate of ln J. (3, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of sound. [m/s]
    real(wp) :: speed
    integer :: p

    associate (unused => stress)
    end associate
    speed = 0.0_wp
    do p = 1, n
      associate (share => history(porosity, p))
        speed = max(speed, share*volume(p)/mass(p) &
                    + (1.0_wp - share)/(share*self%grain_density))
      end associate
    end do
    speed = sqrt(self%bulk*speed)
  end function slurry_fluid_phase_wave_speed

  !> Largest 4 eta/(3 rho), with the viscosity of the densest suspension.
  pure function slurry_fluid_phase_diffusivity(self, n, mass, volume) result(diffusivity)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Factor of the second derivative of a velocity. [m2/s]
    real(wp) :: diffusivity

    diffusivity = 0.0_wp
    if (n > 0) diffusivity = 3.5_wp*4.0_wp*self%viscosity/3.0_wp*maxval(volume/mass)
  end function slurry_fluid_phase_diffusivity

  !> Sum of n V/J K (J ln J - J + 1), the work of the pressure on the fluid itself.
  pure function slurry_fluid_phase_strain_energy(self, n, mass, volume, stress, history) &
    result(energy)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> ln J, porosity, and excess of the rate of ln J. (3, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy
    integer :: p

    associate (unused => stress, unused_mass => mass)
    end associate
    energy = 0.0_wp
    do p = 1, n
      associate (x => history(log_j, p))
        energy = energy + history(porosity, p)*volume(p)*self%bulk*(x - 1.0_wp + exp(-x))
      end associate
    end do
  end function slurry_fluid_phase_strain_energy

  !> Send J and the porosity.
  subroutine slurry_fluid_phase_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(slurry_fluid_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> ln J, porosity, and excess of the rate of ln J. (3, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => mass, unused_volume => volume, unused_stress => stress)
    end associate
    call writer%scalar('J', exp(history(log_j, :)))
    call writer%scalar('porosity', (history(porosity, :)))
  end subroutine slurry_fluid_phase_write_fields

end module mpm_slurry_fluid_phase
