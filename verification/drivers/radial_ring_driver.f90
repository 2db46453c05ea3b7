!> A ring that expands and shrinks.
module mpm_radial_ring_driver
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_load_driver, only: add_load_properties, exact_state_t, load_driver_t, &
                             read_load_properties
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: radial_ring_driver_t

  !> The TYPEs that have the solution, and the one of them in which the centre is free.
  logical, parameter :: solved(5) = [.false., .true., .false., .true., .false.]
  logical, parameter :: plane(5) = [.false., .true., .false., .false., .false.]
  !> Largest strain u' and u/R. The logarithms of the stretches then differ by log 2 at most; at 1
  !! the principal stresses would differ by 2 G and the equations of motion not be elliptic.
  real(wp), parameter :: largest_strain = 1.0_wp/3.0_wp
  !> Half a turn.
  real(wp), parameter :: pi = acos(-1.0_wp)

  !> Radial displacement u = g(t) T(R), g = A sin(omega t).
  !!
  !! T is the cubic with T(0) = 0, T(b) = 1 and T'(a) = T'(b) = 0 at the inner radius a and the
  !! outer radius b. Without rotation the Jaumann rate integrates to logarithms; with nu = 0
  !! S_rr = E log F_rr and S_tt = E log F_tt, F_rr = 1 + g T', F_tt = 1 + g T/R. Hence S_rr = 0 at
  !! both rims, which nu /= 0 would spoil.
  type, extends(load_driver_t) :: radial_ring_driver_t
    !> Largest displacement A of the outer rim. [m]
    real(wp) :: amplitude = 0.0_wp
    !> Radii a and b in the reference configuration. [m]
    real(wp) :: rims(2) = 0.0_wp
    !> E/rho in the reference configuration. [m2/s2]
    real(wp) :: speed_squared = 0.0_wp
    !> Young's modulus. [Pa]
    real(wp) :: young = 0.0_wp
    !> Angular frequency. [1/s]
    real(wp) :: omega = 0.0_wp
    !> Centre; TYPE 4: the axis. [m]
    real(wp) :: center(2) = 0.0_wp
  contains
    procedure, nopass :: describe => radial_ring_driver_describe
    procedure :: init => radial_ring_driver_init
    procedure :: acceleration => radial_ring_driver_acceleration
    procedure :: exact => radial_ring_driver_exact
    !> Radius, direction and motion of a point.
    procedure, private :: circle => radial_ring_driver_circle
  end type radial_ring_driver_t

  !> The motion of one circle at one time.
  type :: circle_t
    !> Unit vector along the radius; TYPE 4: components r, z.
    real(wp) :: outward(2) = [1.0_wp, 0.0_wp]
    !> Displacement. [m]
    real(wp) :: displacement = 0.0_wp
    !> Velocity. [m/s]
    real(wp) :: velocity = 0.0_wp
    !> Acceleration. [m/s2]
    real(wp) :: acceleration = 0.0_wp
    !> Current radius. [m]
    real(wp) :: radius = 0.0_wp
    !> F_rr - 1 and F_tt - 1.
    real(wp) :: strain(2) = 0.0_wp
    !> Derivative of F_rr by the reference radius. [1/m]
    real(wp) :: strain_gradient = 0.0_wp
  end type circle_t

contains

  !> Purpose and properties of the class.
  subroutine radial_ring_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'RadialRingDriver', &
                          'Manufactured solution: a ring with free rims moves by A sin(omega t) &
                          &T(R) along its radii, T a cubic with T'' = 0 at both rims and 1 at the &
                          &outer one.', &
                          'Wallstedt and Guilkey, J. Comput. Phys. 227 (2008) 9628-9642; the &
                          &stress is that of the Jaumann rate', &
                          'driver'//nl//'{'//nl//'    class = "RadialRingDriver"'//nl// &
                          '    properties = {t_stop = 0.02, amplitude = 0.005, inner = 0.4, '// &
                          'outer = 0.6, density = 1000, E = 1e7}'//nl//'}')
    call add_load_properties(description)
    call description%add_real('amplitude', 'm', 'largest displacement A of the outer rim; strains &
                              &reach 1/3 at most', above=0.0_wp)
    call description%add_real('inner', 'm', 'inner radius', above=0.0_wp)
    call description%add_real('outer', 'm', 'outer radius, below 3 inner', above=0.0_wp)
    call description%add_real('density', 'kg/m3', 'density in the reference configuration', &
                              above=0.0_wp)
    call description%add_real('E', 'Pa', 'Young''s modulus of the material', above=0.0_wp)
    call description%add_real('omega', '1/s', 'angular frequency; 0: pi c/(2 R) with c = &
                              &sqrt(E/density) and the mean radius R', default=0.0_wp, &
                              lower=0.0_wp)
    call description%add_real('center_x', 'm', 'centre', default=0.0_wp, types=plane)
    call description%add_real('center_y', 'm', 'centre', default=0.0_wp, types=plane)
    call description%add_note('For TYPE 2 (uniform along z) and TYPE 4 (about the axis r = 0, &
                              &uniform along it).')
    call description%add_note('For IsotropicLinearElasticity with nu = 0: any other Poisson ratio &
                              &puts a traction on the rims, which has no place in a body force.')
    call description%add_note('The motion starts at the rest position with its largest velocity.')
  end subroutine radial_ring_driver_describe

  !> Set up from the properties.
  subroutine radial_ring_driver_init(self, properties, error)
    !> The driver.
    class(radial_ring_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Radii or an amplitude for which there is no such motion.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: a, b, strain

    call read_load_properties(self, properties)
    self%types = solved
    self%amplitude = properties%real('amplitude')
    a = properties%real('inner')
    b = properties%real('outer')
    self%rims = [a, b]
    self%young = properties%real('E')
    self%speed_squared = self%young/properties%real('density')
    self%omega = properties%real('omega')
    if (.not. self%omega > 0.0_wp) self%omega = pi*sqrt(self%speed_squared)/(a + b)
    self%center = [properties%real('center_x'), properties%real('center_y')]
    if (b <= a .or. b >= 3.0_wp*a) then
      ! A cubic with T(0) = 0 and T' = 0 at a and b = 3 a vanishes at b.
      call properties%reject('outer', 'outer = '//to_text(b)//' is not above inner = '// &
                             to_text(a)//' and below 3 inner', error, 'T(outer) = 1 needs a ring &
                             &that is not as wide')
      return
    end if
    ! The strain by a displacement of 1 at the outer rim: T/R at the inner rim, |T'| in the middle.
    strain = max((3.0_wp*b - a)*a, 1.5_wp*(b - a)**2)/((3.0_wp*a - b)*b**2)
    if (self%amplitude*strain > largest_strain) then
      call properties%reject('amplitude', 'the strain of the ring would reach '// &
                             to_text(self%amplitude*strain, 3)//', more than 1/3', error, &
                             'use an amplitude of at most '// &
                             to_text(0.99_wp*largest_strain/strain, 3))
    end if
  end subroutine radial_ring_driver_init

  !> The motion of the circle of a point.
  pure function radial_ring_driver_circle(self, kin, reference, time) result(circle)
    !> The driver.
    class(radial_ring_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Its circle.
    type(circle_t) :: circle
    real(wp) :: c, g, r, ratio, slope, t(2)

    if (kin%sim_type == type_axisymmetric) then
      r = reference(1)
    else
      t = reference(:2) - self%center
      r = norm2(t)
      if (r > 0.0_wp) circle%outward = t/r
    end if
    associate (a => self%rims(1), b => self%rims(2))
      c = 2.0_wp/((3.0_wp*a - b)*b**2)
      ratio = c*(r**2 - 1.5_wp*(a + b)*r + 3.0_wp*a*b)
      slope = 3.0_wp*c*(r - a)*(r - b)
      g = self%amplitude*sin(self%omega*time)
      circle%displacement = g*ratio*r
      circle%velocity = self%amplitude*self%omega*cos(self%omega*time)*ratio*r
      circle%acceleration = -self%omega**2*circle%displacement
      circle%radius = r + circle%displacement
      circle%strain = g*[slope, ratio]
      circle%strain_gradient = 3.0_wp*c*g*(2.0_wp*r - a - b)
    end associate
  end function radial_ring_driver_circle

  !> Body force per unit mass, d2u/dt2 - (1/rho) (dS_rr/dr + (S_rr - S_tt)/r).
  pure function radial_ring_driver_acceleration(self, kin, reference, x, velocity, time) result(b)
    !> The driver.
    class(radial_ring_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Position; not used. [m]
    real(wp), intent(in) :: x(3)
    !> Velocity; not used. [m/s]
    real(wp), intent(in) :: velocity(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Acceleration, components beyond nvel 0. [m/s2]
    real(wp) :: b(3)
    type(circle_t) :: circle
    real(wp) :: divergence, stretch(2)

    associate (unused => x, unused_velocity => velocity)
    end associate
    circle = self%circle(kin, reference, time)
    stretch = 1.0_wp + circle%strain
    divergence = circle%strain_gradient/stretch(1)**2
    ! On the axis, which no ring reaches, the difference of the stresses is 0.
    if (circle%radius > 0.0_wp) then
      divergence = divergence + log(stretch(1)/stretch(2))/circle%radius
    end if
    b = 0.0_wp
    b(:2) = (circle%acceleration - self%speed_squared*product(stretch)*divergence)*circle%outward
  end function radial_ring_driver_acceleration

  !> The exact state of a point.
  pure subroutine radial_ring_driver_exact(self, kin, reference, time, state)
    !> The driver.
    class(radial_ring_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> State.
    type(exact_state_t), intent(out) :: state
    type(circle_t) :: circle
    real(wp) :: t(2)

    circle = self%circle(kin, reference, time)
    t = self%young*log(1.0_wp + circle%strain)
    state%jacobian = product(1.0_wp + circle%strain)
    associate (e => circle%outward)
      state%displacement(:2) = circle%displacement*e
      state%velocity(:2) = circle%velocity*e
      if (kin%sim_type == type_axisymmetric) then
        state%stress(1) = t(1)
        state%stress(3) = t(2)
      else
        state%stress(1) = t(1)*e(1)**2 + t(2)*e(2)**2
        state%stress(2) = t(1)*e(2)**2 + t(2)*e(1)**2
        state%stress(4) = (t(1) - t(2))*e(1)*e(2)
      end if
    end associate
  end subroutine radial_ring_driver_exact

end module mpm_radial_ring_driver
