!> The grains of a mixture with a fluid, or dry.
module mpm_slurry_granular_phase
  use mpm_corotation, only: elastic_energy, first_not_finite, invariants, rebuild, trial_stress
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_granular_flow, only: granular_flow_t
  use mpm_granular_step, only: width
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_material, only: material_t
  use mpm_nodes, only: nodes_t
  use mpm_points, only: points_t
  use mpm_pore_fluid, only: points_of_nodes
  use mpm_properties, only: properties_t
  use mpm_seam, only: copy_to_ghosts
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: add_slurry_properties, slurry_granular_phase_t, write_flow_fields

  !> Grains with mu(I_m) friction that dilate and compact as they flow.
  !!
  !! The memory of a point is its plastic shear strain, the rate of it, and the viscosity of the
  !! fluid around it.
  type, extends(material_t) :: slurry_granular_phase_t
    !> The law of flow.
    type(granular_flow_t) :: law
    !> Place of the viscosity in the memory of a point, the last one. [Pa s]
    integer :: at_viscosity = 3
  contains
    procedure, nopass :: describe => slurry_granular_phase_describe
    procedure :: init => slurry_granular_phase_init
    procedure :: start => slurry_granular_phase_start
    procedure :: observe => slurry_granular_phase_observe
    procedure :: grains => slurry_granular_phase_grains
    procedure :: update_stress => slurry_granular_phase_update_stress
    procedure :: assign_stress => slurry_granular_phase_assign_stress
    procedure :: wave_speed => slurry_granular_phase_wave_speed
    procedure :: strain_energy => slurry_granular_phase_strain_energy
    procedure :: write_fields => slurry_granular_phase_write_fields
  end type slurry_granular_phase_t

contains

  !> Purpose and properties of the class.
  subroutine slurry_granular_phase_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'SlurryGranularPhase', &
                          'Grains of a fluid-sediment mixture, or dry: mu(I_m) friction, packing &
                          &that follows the flow, suspension when dilute.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764', &
                          '    material-class = "SlurryGranularPhase"'//nl// &
                          '    material-props = {E = 1e6, nu = 0.3, mu_1 = 0.3819, mu_2 = 0.6435, &
                          &a = 1.23,'//nl// &
                          '                      b = 0.3085, K_3 = 4.7154, K_4 = 0, phi_m = 0.585, &
                          &rho_s = 2700,'//nl// &
                          '                      eta_0 = 1e-3, d = 1e-3, rho_f = 1000}')
    call add_slurry_properties(description)
    call description%add_note('Below phi_m grains carry pressure only while they flow: a pressure &
                              &at rest is an error when it is assigned, and fades otherwise. &
                              &SlurryGranularPhase_wUnderCompaction is for loose packings at rest.')
  end subroutine slurry_granular_phase_describe

  !> Add the properties that the classes of grains in a fluid share.
  subroutine add_slurry_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_real('E', 'Pa', 'Young''s modulus', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio', above=-1.0_wp, below=0.5_wp)
    call description%add_real('mu_1', '-', 'static friction', lower=0.0_wp)
    call description%add_real('mu_2', '-', 'friction of fast flow', lower=0.0_wp)
    call description%add_real('a', '-', 'slope of the packing law', above=0.0_wp)
    call description%add_real('b', '-', 'scale of the friction law', lower=0.0_wp)
    call description%add_real('K_3', '-', 'dilation', lower=0.0_wp)
    call description%add_real('K_4', '-', 'compaction of loose grains by flow; 0, none', &
                              lower=0.0_wp)
    call description%add_real('phi_m', '-', 'critical packing fraction', above=0.0_wp, upper=1.0_wp)
    call description%add_real('rho_s', 'kg/m3', 'density of the grains', above=0.0_wp)
    call description%add_real('eta_0', 'Pa s', 'viscosity of the fluid; 0, dry', lower=0.0_wp)
    call description%add_real('d', 'm', 'diameter of the grains', above=0.0_wp)
    call description%add_real('rho_f', 'kg/m3', 'density of the fluid; not used', lower=0.0_wp)
    call description%add_string('fluid', 'body of the fluid: eta_0 counts at nodes that it &
                                &reaches; without one, everywhere', default='')
    call description%add_note('The stress is that of the grains. The contact SlurryMixture adds &
                              &buoyancy and drag of a fluid.')
    call description%add_note('The plastic step is one equation, solved to round-off; it has one &
                              &solution unless mu_1 < K_3 (phi_m - phi). A search that fails ends &
                              &the run. mpm_3d goes through six stages and deletes the pressure &
                              &where the shear stress is 0.')
    call description%add_note('The stress turns by exact rotations; mpm_3d takes forward Euler, by &
                              &which it grows.')
  end subroutine add_slurry_properties

  !> Set the constants from the properties.
  subroutine slurry_granular_phase_init(self, kin, properties, error)
    !> The material.
    class(slurry_granular_phase_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Friction that falls with the rate.
    type(error_t), allocatable, intent(out) :: error

    self%kin = kin
    self%n_history = 3
    associate (young => properties%real('E'), poisson => properties%real('nu'))
      self%law%shear = young/(2.0_wp*(1.0_wp + poisson))
      self%law%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
    end associate
    self%law%friction = properties%real('mu_1')
    self%law%fast_friction = properties%real('mu_2')
    self%law%slope = properties%real('a')
    self%law%inertial = properties%real('b')
    self%law%dilation = properties%real('K_3')
    self%law%compaction = properties%real('K_4')
    self%law%critical = properties%real('phi_m')
    self%law%gate = self%law%critical
    self%law%grain_density = properties%real('rho_s')
    self%law%viscosity = properties%real('eta_0')
    self%law%diameter = properties%real('d')
    if (self%law%fast_friction < self%law%friction) then
      call properties%reject('mu_2', 'mu_2 is below mu_1', error, 'friction must not fall with the &
                             &rate')
    end if
    call self%partner%ask(properties, 'fluid', '')
  end subroutine slurry_granular_phase_init

  !> Points begin at rest, with the fluid around them.
  pure subroutine slurry_granular_phase_start(self, n, x, mass, volume, history)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
    real(wp), intent(out) :: history(self%n_history, n)

    associate (unused => x, unused_mass => mass, unused_volume => volume)
    end associate
    history = 0.0_wp
    history(self%at_viscosity, :) = self%law%viscosity
  end subroutine slurry_granular_phase_start

  !> Find the viscosity around the points: eta_0 where there is fluid, 0 elsewhere.
  subroutine slurry_granular_phase_observe(self, grid, points, nodes, remapped, threads, &
                                           other_points, other_nodes)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the grains.
    class(points_t), intent(inout) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Strain rates will be formed from the velocities of the second mapping.
    logical, intent(in) :: remapped
    !> Number of threads.
    integer, intent(in) :: threads
    !> Points of the fluid; left out while it is not active.
    class(points_t), intent(in), optional :: other_points
    !> Their nodes.
    class(nodes_t), intent(in), optional :: other_nodes
    real(wp), allocatable :: wet(:, :), unused_rate(:), share(:)
    integer :: n

    associate (unused => grid, unused_flag => remapped)
    end associate
    n = points%n_inside
    allocate (share(n), unused_rate(n), source=0.0_wp)
    if (present(other_points) .and. present(other_nodes)) then
      allocate (wet(points%kin%nvel, nodes%window%size()), source=0.0_wp)
      if (other_points%n_inside > 0) call mark_wet(nodes%window, other_nodes, wet)
      if (any(points%stencil%periodic)) then
        call copy_to_ghosts(points%stencil, nodes%window, points%kin%nvel, wet)
      end if
      call points_of_nodes(points, nodes%window, threads, wet, wet, unused_rate, share)
    end if
    points%history(self%at_viscosity, :n) = self%law%viscosity*share
  end subroutine slurry_granular_phase_observe

  !> Density and friction of the grains.
  pure subroutine slurry_granular_phase_grains(self, density, friction)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
    !> Density of the grains themselves. [kg/m3]
    real(wp), intent(out) :: density
    !> Largest ratio of shear stress to pressure at rest.
    real(wp), intent(out) :: friction

    density = self%law%grain_density
    friction = self%law%friction
  end subroutine slurry_granular_phase_grains

  !> Set nodes that the fluid reaches to 1.
  pure subroutine mark_wet(window, fluid, wet)
    !> Window of the marks.
    type(window_t), intent(in) :: window
    !> Nodes of the fluid.
    class(nodes_t), intent(in) :: fluid
    !> The marks, in the first component. (nvel, nn)
    real(wp), intent(inout) :: wet(:, :)
    type(window_t) :: both
    integer :: i, j, k, node(3), hi(3)

    both = intersect(window, fluid%window)
    hi = both%hi()
    do k = both%lo(3), hi(3)
      do j = both%lo(2), hi(2)
        do i = both%lo(1), hi(1)
          node = [i, j, k]
          if (.not. fluid%mass(fluid%window%index(node)) > 0.0_wp) cycle
          wet(1, window%index(node)) = 1.0_wp
        end do
      end do
    end do
  end subroutine mark_wet

  !> Advance the stress of a block of points over one step.
  pure subroutine slurry_granular_phase_update_stress(self, n, dt, gradient, mass, volume, stress, &
                                                      history, first_bad)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
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
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
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
  end subroutine slurry_granular_phase_update_stress

  !> Advance the stress of so many points that work arrays have a fixed size.
  pure subroutine advance(self, n, dt, gradient, mass, volume, stress, history, first_bad)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
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
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point without a stress; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp), dimension(width) :: trial, tau, pressure, kept, phi, rate, viscosity, factor
    real(wp), dimension(width) :: slope, critical, gate

    pressure(:n) = -(stress(1, :) + stress(2, :) + stress(3, :))/3.0_wp
    call trial_stress(self%kin, n, dt, self%law%bulk - 2.0_wp*self%law%shear/3.0_wp, &
                      self%law%shear, gradient, stress, trial, tau)
    factor(:n) = trial(:n) + tau(:n)
    first_bad = first_not_finite(1, n, factor)
    if (first_bad > 0) return
    phi(:n) = mass/(volume*self%law%grain_density)
    rate(:n) = history(2, :)
    viscosity(:n) = history(self%at_viscosity, :)
    slope = self%law%slope
    critical = self%law%critical
    gate = self%law%gate
    call self%law%solve_block(n, dt, viscosity, slope, critical, gate, phi, trial, tau, pressure, &
                              kept, rate, first_bad)
    if (first_bad > 0) return
    factor(:n) = kept(:n)/max(tau(:n), tiny(1.0_wp))
    history(2, :) = rate(:n)
    history(1, :) = history(1, :) + dt*rate(:n)
    call rebuild(self%kin%nstress, n, trial, factor, pressure, stress)
  end subroutine advance

  !> Give points a stress, where they can have it: its shear is cut to the static strength.
  pure subroutine slurry_granular_phase_assign_stress(self, n, target, mass, volume, stress, &
                                                      history, first_bad)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
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
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that is too loose to carry its pressure at rest, or that is to have tension; 0
    !> when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: pressure(n), tau(n), factor(n), strength, phi
    integer :: p

    call invariants(self%kin%nstress, n, target, pressure, tau)
    factor = 1.0_wp
    first_bad = 0
    do p = n, 1, -1
      phi = mass(p)/(volume(p)*self%law%grain_density)
      strength = self%law%strength(phi, pressure(p), 0.0_wp)
      if (pressure(p) < 0.0_wp .or. (pressure(p) > 0.0_wp .and. phi < self%law%gate)) then
        first_bad = p
      else if (tau(p) > strength) then
        factor(p) = strength/tau(p)
      end if
    end do
    if (first_bad > 0) return
    stress = target
    call rebuild(self%kin%nstress, n, pressure, factor, pressure, stress)
    history(2, :) = 0.0_wp
  end subroutine slurry_granular_phase_assign_stress

  !> Largest sqrt((K + 4 G/3)/rho); grains too loose to carry pressure have no waves.
  pure function slurry_granular_phase_wave_speed(self, n, mass, volume, stress, &
                                                 history) result(speed)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Largest speed of a longitudinal wave. [m/s]
    real(wp) :: speed
    real(wp) :: density
    integer :: p

    associate (unused => stress, unused_history => history)
    end associate
    density = huge(1.0_wp)
    do p = 1, n
      density = min(density, max(mass(p)/volume(p), self%law%gate*self%law%grain_density))
    end do
    speed = sqrt((self%law%bulk + 4.0_wp*self%law%shear/3.0_wp)/density)
  end function slurry_granular_phase_wave_speed

  !> Sum of V (s:s/(4 G) + p**2/(2 K)), s the deviator, p the pressure.
  pure function slurry_granular_phase_strain_energy(self, n, mass, volume, stress, history) &
    result(energy)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Sum over the points. [J]
    real(wp) :: energy

    associate (unused => mass, unused_history => history)
    end associate
    energy = elastic_energy(self%kin%nstress, n, self%law%bulk - 2.0_wp*self%law%shear/3.0_wp, &
                            self%law%shear, volume, stress)
  end function slurry_granular_phase_strain_energy

  !> Send the plastic shear strain, its rate, the inertial numbers and the packing fraction.
  subroutine slurry_granular_phase_write_fields(self, n, mass, volume, stress, history, writer)
    !> The material.
    class(slurry_granular_phase_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(self%kin%nstress, n)
    !> Plastic shear strain, its rate, viscosity. [-, 1/s, Pa s] (3, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer

    call write_flow_fields(self%law, n, mass, volume, stress, history, &
                           history(self%at_viscosity, :), writer)
  end subroutine slurry_granular_phase_write_fields

  !> Send the fields of a flow; inertial numbers are 0 where there is no pressure.
  subroutine write_flow_fields(law, n, mass, volume, stress, history, viscosity, writer)
    !> The law.
    type(granular_flow_t), intent(in) :: law
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(:, :)
    !> Plastic shear strain and its rate, and more. [-, 1/s] (n_history, n)
    real(wp), intent(in) :: history(:, :)
    !> Viscosities of the fluid around. [Pa s] (n)
    real(wp), intent(in) :: viscosity(:)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp) :: inertial(n), viscous(n), pressure
    integer :: p

    inertial = 0.0_wp
    viscous = 0.0_wp
    do p = 1, n
      pressure = -(stress(1, p) + stress(2, p) + stress(3, p))/3.0_wp
      if (.not. pressure > 0.0_wp) cycle
      inertial(p) = history(2, p)*law%diameter*sqrt(law%grain_density/pressure)
      viscous(p) = history(2, p)*viscosity(p)/pressure
    end do
    call writer%scalar('gammap', (history(1, :)))
    call writer%scalar('gammap_dot', (history(2, :)))
    call writer%scalar('I_v', viscous)
    call writer%scalar('I', inertial)
    call writer%scalar('I_m', sqrt(inertial**2 + 2.0_wp*viscous))
    call writer%scalar('packing_fraction', mass/(volume*law%grain_density))
    call writer%scalar('eta_interp', (viscosity))
  end subroutine write_flow_fields

end module mpm_slurry_granular_phase
