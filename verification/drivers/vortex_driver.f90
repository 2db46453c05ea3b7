!> The generalised vortex: a ring that turns back and forth, each circle of it as a rigid one.
module mpm_vortex_driver
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_load_driver, only: add_load_properties, exact_state_t, load_driver_t, &
                             read_load_properties
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: vortex_driver_t

  !> The TYPEs that have the solution, and those of them in which the centre is free.
  logical, parameter :: solved(5) = [.false., .true., .true., .true., .false.]
  logical, parameter :: plane(5) = [.false., .true., .true., .false., .false.]
  !> Half a turn.
  real(wp), parameter :: pi = acos(-1.0_wp)

  !> A circle of radius R turns by the angle a = g(t) f(R).
  !!
  !! g = A sin(pi t/T), f = (1 - 16 s**2)**2 with s = R/R0 - 1, and 0 unless |s| < 1/4. In the basis
  !! (e_r, e_t) at the current angle the deformation is the simple shear k = R g f'(R), whose stress
  !! by the Jaumann rate is S_rt = G sin k, S_tt = -S_rr = G (1 - cos k). The volume does not
  !! change. Displacement, k and the stress vanish at both radii of the ring.
  type, extends(load_driver_t) :: vortex_driver_t
    !> Largest angle A.
    real(wp) :: amplitude = 0.0_wp
    !> Time T from rest position to rest position. [s]
    real(wp) :: half_period = 1.0_wp
    !> Mean radius R0. [m]
    real(wp) :: radius = 1.0_wp
    !> Density. [kg/m3]
    real(wp) :: density = 0.0_wp
    !> Shear modulus. [Pa]
    real(wp) :: shear = 0.0_wp
    !> Centre; TYPE 4: the axis. [m]
    real(wp) :: center(2) = 0.0_wp
  contains
    procedure, nopass :: describe => vortex_driver_describe
    procedure :: init => vortex_driver_init
    procedure :: acceleration => vortex_driver_acceleration
    procedure :: exact => vortex_driver_exact
    !> The motion of one circle.
    procedure, private :: circle => vortex_driver_circle
  end type vortex_driver_t

  !> The motion of one circle at one time.
  type :: circle_t
    !> Whether it belongs to the ring.
    logical :: turns = .false.
    !> Its radius. [m]
    real(wp) :: radius = 0.0_wp
    !> From the centre to the reference position in the plane. [m]
    real(wp) :: arm(2) = 0.0_wp
    !> Angle.
    real(wp) :: angle = 0.0_wp
    !> Angular velocity. [1/s]
    real(wp) :: spin = 0.0_wp
    !> Angular acceleration. [1/s2]
    real(wp) :: spin_rate = 0.0_wp
    !> Shear k.
    real(wp) :: shear = 0.0_wp
    !> Derivative of the shear by the radius. [1/m]
    real(wp) :: shear_gradient = 0.0_wp
  end type circle_t

contains

  !> Purpose and properties of the class.
  subroutine vortex_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'VortexDriver', &
                          'Manufactured solution: the ring 3/4 < R/R0 < 5/4 turns by the angle &
                          &A sin(pi t/T) (1 - 16 (R/R0 - 1)^2)^2, all else rests.', &
                          'Kamojjala, Brannon, Sadeghirad and Guilkey, Engineering with Computers &
                          &31 (2015); the stress is that of the Jaumann rate', &
                          'driver'//nl//'{'//nl//'    class = "VortexDriver"'//nl// &
                          '    properties = {t_stop = 1, amplitude = 0.1, density = 1000, '// &
                          'E = 1000, nu = 0.3}'//nl//'}')
    call add_load_properties(description)
    ! k is at most 7.066 A (at s = 0.1502); 0.2 keeps it below pi/2.
    call description%add_real('amplitude', 'rad', 'largest angle A', above=0.0_wp, upper=0.2_wp)
    call description%add_real('density', 'kg/m3', 'density in the reference configuration', &
                              above=0.0_wp)
    call description%add_real('E', 'Pa', 'Young''s modulus of the material', above=0.0_wp)
    call description%add_real('nu', '-', 'Poisson ratio of the material', above=-1.0_wp, &
                              below=0.5_wp)
    call description%add_real('half_period', 's', 'time T', default=1.0_wp, above=0.0_wp)
    call description%add_real('radius', 'm', 'mean radius R0', default=1.0_wp, above=0.0_wp)
    call description%add_real('center_x', 'm', 'centre', default=0.0_wp, types=plane)
    call description%add_real('center_y', 'm', 'centre', default=0.0_wp, types=plane)
    call description%add_note('For TYPE 2, TYPE 3 (about an axis along z, uniform along it) and &
                              &TYPE 4 (about the axis r = 0, uniform along it).')
    call description%add_note('For IsotropicLinearElasticity. The shear k reaches 7.066 A. At pi/2 &
                              &(A = 0.222) its modulus G cos k is 0 and the equations of motion &
                              &are no longer elliptic: hence the bound of A. In TYPE 2 and 3, &
                              &where waves also run across the radii, that happens at pi/3 (A = &
                              &0.148), where the principal stresses differ by 2 G: expect &
                              &convergence below that only.')
    call description%add_note('The material must fill the ring. Outside of it nothing moves.')
  end subroutine vortex_driver_describe

  !> Set up from the properties.
  subroutine vortex_driver_init(self, properties, error)
    !> The driver.
    class(vortex_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error

    call read_load_properties(self, properties)
    self%types = solved
    self%amplitude = properties%real('amplitude')
    self%half_period = properties%real('half_period')
    self%radius = properties%real('radius')
    self%density = properties%real('density')
    self%shear = properties%real('E')/(2.0_wp*(1.0_wp + properties%real('nu')))
    self%center = [properties%real('center_x'), properties%real('center_y')]
  end subroutine vortex_driver_init

  !> The motion of the circle of a point.
  pure function vortex_driver_circle(self, kin, reference, time) result(circle)
    !> The driver.
    class(vortex_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Its circle.
    type(circle_t) :: circle
    real(wp) :: f, df, d2f, g, q, s, w

    circle%arm = reference(:2) - self%center
    if (kin%sim_type == type_axisymmetric) circle%arm = [reference(1), 0.0_wp]
    circle%radius = norm2(circle%arm)
    s = circle%radius/self%radius - 1.0_wp
    circle%turns = abs(s) < 0.25_wp
    if (.not. circle%turns) return
    q = 1.0_wp - 16.0_wp*s**2
    f = q**2
    df = -64.0_wp*s*q/self%radius
    d2f = -64.0_wp*(1.0_wp - 48.0_wp*s**2)/self%radius**2
    w = pi/self%half_period
    g = self%amplitude*sin(w*time)
    circle%angle = g*f
    circle%spin = self%amplitude*w*cos(w*time)*f
    circle%spin_rate = -w**2*g*f
    circle%shear = circle%radius*g*df
    circle%shear_gradient = g*(df + circle%radius*d2f)
  end function vortex_driver_circle

  !> Body force per unit mass: a - div S/rho, the divergence taken in the turned circle.
  pure function vortex_driver_acceleration(self, kin, reference, x, velocity, time) result(b)
    !> The driver.
    class(vortex_driver_t), intent(in) :: self
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
    real(wp) :: b_r, b_t, e(2), r, ratio

    associate (unused => x, unused_velocity => velocity)
    end associate
    b = 0.0_wp
    circle = self%circle(kin, reference, time)
    if (.not. circle%turns) return
    ratio = self%shear/self%density
    r = circle%radius
    associate (k => circle%shear, dk => circle%shear_gradient)
      b_r = ratio*(sin(k)*dk + 4.0_wp*sin(0.5_wp*k)**2/r) - r*circle%spin**2
      b_t = -ratio*(cos(k)*dk + 2.0_wp*sin(k)/r) + r*circle%spin_rate
    end associate
    if (kin%sim_type == type_axisymmetric) then
      b = [b_r, 0.0_wp, b_t]
    else
      e = direction(circle, circle%angle)
      b(:2) = b_r*e + b_t*[-e(2), e(1)]
    end if
  end function vortex_driver_acceleration

  !> The exact state of a point.
  pure subroutine vortex_driver_exact(self, kin, reference, time, state)
    !> The driver.
    class(vortex_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> State; TYPE 4: the displacement along theta is the length of the arc.
    type(exact_state_t), intent(out) :: state
    type(circle_t) :: circle
    real(wp) :: e(2), p, q

    circle = self%circle(kin, reference, time)
    if (.not. circle%turns) return
    p = 2.0_wp*self%shear*sin(0.5_wp*circle%shear)**2
    q = self%shear*sin(circle%shear)
    if (kin%sim_type == type_axisymmetric) then
      state%displacement(3) = circle%radius*circle%angle
      state%velocity(3) = circle%radius*circle%spin
      state%stress = [-p, 0.0_wp, p, 0.0_wp, 0.0_wp, q]
    else
      e = direction(circle, circle%angle)
      state%velocity(:2) = circle%radius*circle%spin*[-e(2), e(1)]
      state%stress(1) = -p*(e(1)**2 - e(2)**2) - 2.0_wp*q*e(1)*e(2)
      state%stress(2) = -state%stress(1)
      state%stress(4) = q*(e(1)**2 - e(2)**2) - 2.0_wp*p*e(1)*e(2)
      ! The chord stands at right angles to the middle of the arc.
      e = direction(circle, 0.5_wp*(circle%angle + pi))
      state%displacement(:2) = 2.0_wp*circle%radius*sin(0.5_wp*circle%angle)*e
    end if
  end subroutine vortex_driver_exact

  !> Unit vector at an angle from the reference position of a point, seen from the centre.
  pure function direction(circle, angle) result(e)
    !> The point's circle.
    type(circle_t), intent(in) :: circle
    !> Angle.
    real(wp), intent(in) :: angle
    !> Cartesian components.
    real(wp) :: e(2)

    e = (cos(angle)*circle%arm + sin(angle)*[-circle%arm(2), circle%arm(1)])/circle%radius
  end function direction

end module mpm_vortex_driver
