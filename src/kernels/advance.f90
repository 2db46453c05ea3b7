!> Update of a block of points from the grid: positions, velocities, volumes.
module mpm_advance
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_1d, type_3d, type_axisymmetric
  use mpm_stencil, only: axis_fraction, block_size, stencil_t
  implicit none
  private
  public :: advance_points, exponential, largest_growth, trace_of_gradient, turn_stress

  !> Largest growth of v_theta in a step: more would need a path that the axis bends away.
  real(wp), parameter :: largest_growth = 2.0_wp

contains

  !> Move points with the grid, add the velocity increments and stretch the volumes.
  !!
  !! x += dt v_grid, u += dt v_grid, v += dv (FLIP), V *= exp(dt tr L). In TYPE 4 the velocity
  !! goes over to the local basis of the moved point, which carries the centrifugal and Coriolis
  !! terms of the cylindrical components.
  pure subroutine advance_points(kin, stencil, n, dt, grid_velocity, increment, gradient, x, &
                                 displacement, velocity, volume, first_bad)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis, for the spacing of the grid.
    type(stencil_t), intent(in) :: stencil
    !> Number of points, at most `block_size`.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity of the grid at the points. [m/s] (nvel, n)
    real(wp), intent(in) :: grid_velocity(kin%nvel, n)
    !> Velocity increments. [m/s] (nvel, n)
    real(wp), intent(in) :: increment(kin%nvel, n)
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Positions. [m] (dim, n)
    real(wp), intent(inout) :: x(kin%dim, n)
    !> Displacements. [m] (nvel, n)
    real(wp), intent(inout) :: displacement(kin%nvel, n)
    !> Velocities. [m/s] (nvel, n)
    real(wp), intent(inout) :: velocity(kin%nvel, n)
    !> Volumes. [m3] (n)
    real(wp), intent(inout) :: volume(n)
    !> First point that is not finite, moves more than a cell or loses its volume; 0 when none does.
    integer, intent(out) :: first_bad
    real(wp) :: trace(block_size), stretch(block_size)
    integer :: n_bad, p

    call trace_of_gradient(kin, n, gradient, trace)
    trace(:n) = dt*trace(:n)
    call exponential(n, trace, stretch)
    call add_scaled(kin%nvel*n, 1.0_wp, increment, velocity)
    if (kin%sim_type == type_axisymmetric) then
      call turn_basis(n, dt, axis_fraction*stencil%h(1), x, grid_velocity, &
                      velocity)
    end if
    call add_scaled(kin%nvel*n, dt, grid_velocity, displacement)
    if (kin%dim == kin%nvel) then
      call add_scaled(kin%nvel*n, dt, grid_velocity, x)
    else
      do p = 1, n
        x(:, p) = x(:, p) + dt*grid_velocity(:kin%dim, p)
      end do
    end if
    n_bad = 0
    do p = 1, n
      volume(p) = volume(p)*stretch(p)
      if (.not. (volume(p) > 0.0_wp .and. volume(p) <= huge(1.0_wp))) n_bad = n_bad + 1
    end do
    n_bad = n_bad + count_above(kin%nvel*n, minval(stencil%h(:kin%dim))/dt, grid_velocity)
    first_bad = 0
    if (n_bad > 0) call find_bad(kin, stencil%h, n, dt, grid_velocity, volume, first_bad)
  end subroutine advance_points

  !> y += a x.
  pure subroutine add_scaled(n, a, x, y)
    !> Number of values.
    integer, intent(in) :: n
    !> Factor.
    real(wp), intent(in) :: a
    !> What is added.
    real(wp), intent(in) :: x(n)
    !> What is added to.
    real(wp), intent(inout) :: y(n)

    y = y + a*x
  end subroutine add_scaled

  !> How many values are not at most a limit in size; NaN is not.
  pure function count_above(n, limit, values) result(number)
    !> Number of values.
    integer, intent(in) :: n
    !> The limit.
    real(wp), intent(in) :: limit
    !> Values.
    real(wp), intent(in) :: values(n)
    !> Values above the limit.
    integer :: number

    number = n - count(abs(values) <= limit)
  end function count_above

  !> The first point that moved more than a cell or lost its volume.
  pure subroutine find_bad(kin, h, n, dt, grid_velocity, volume, first_bad)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: h(3)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity of the grid at the points. [m/s] (nvel, n)
    real(wp), intent(in) :: grid_velocity(kin%nvel, n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> The point; 0 when there is none.
    integer, intent(out) :: first_bad
    logical :: good

    do first_bad = 1, n
      good = volume(first_bad) > 0.0_wp .and. volume(first_bad) <= huge(1.0_wp)
      good = good .and. all(dt*abs(grid_velocity(:kin%dim, first_bad)) <= h(:kin%dim))
      ! What does not move in the grid must be finite.
      good = good .and. all(abs(grid_velocity(:, first_bad)) <= huge(1.0_wp))
      if (.not. good) return
    end do
    first_bad = 0
  end subroutine find_bad

  !> Express velocities in the local cylindrical basis of the moved points.
  !!
  !! v_r gains the centrifugal part by a turn of the basis, which is bounded; v_theta changes so
  !! that the angular momentum r v_theta stays. A turn of both would lose (dt v_theta/r)**2/2 of it
  !! in a step, since the grid moves r as if the path were not curved.
  pure subroutine turn_basis(n, dt, r_floor, x, grid_velocity, velocity)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Smallest radius that divides. [m]
    real(wp), intent(in) :: r_floor
    !> Positions r, z before the move. [m] (2, n)
    real(wp), intent(in) :: x(2, n)
    !> Velocities of the grid r, z, theta, by which the points move. [m/s] (3, n)
    real(wp), intent(in) :: grid_velocity(3, n)
    !> Velocities r, z, theta. [m/s] (3, n)
    real(wp), intent(inout) :: velocity(3, n)
    real(wp) :: angle, r, r_new, v_t
    integer :: p

    do p = 1, n
      v_t = velocity(3, p)
      if (abs(v_t) > 0.0_wp) then
        r = max(x(1, p), r_floor)
        r_new = max(x(1, p) + dt*grid_velocity(1, p), r_floor)
        angle = dt*v_t/r
        velocity(1, p) = cos(angle)*velocity(1, p) + sin(angle)*v_t
        velocity(3, p) = v_t*min(r/r_new, largest_growth)
      end if
    end do
  end subroutine turn_basis

  !> TYPE 4: express new stresses in the local cylindrical basis of the moved points.
  !!
  !! The gradient has its components in the basis of the start of the step, and so has the stress
  !! that a material makes of it. The basis turns by the angle dt v_theta/r = -dt L_rt.
  pure subroutine turn_stress(n, dt, gradient, stress)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients rr rz zr zz tr tz rt tt. [1/s] (8, n)
    real(wp), intent(in) :: gradient(8, n)
    !> Stresses rr zz tt rz zt tr. [Pa] (6, n)
    real(wp), intent(inout) :: stress(6, n)
    real(wp) :: c, s, t(6)
    integer :: p

    do p = 1, n
      if (.not. abs(gradient(7, p)) > 0.0_wp) cycle
      c = cos(dt*gradient(7, p))
      s = -sin(dt*gradient(7, p))
      t = stress(:, p)
      stress(1, p) = c*c*t(1) + 2.0_wp*c*s*t(6) + s*s*t(3)
      stress(3, p) = s*s*t(1) - 2.0_wp*c*s*t(6) + c*c*t(3)
      stress(4, p) = c*t(4) + s*t(5)
      stress(5, p) = c*t(5) - s*t(4)
      stress(6, p) = (c*c - s*s)*t(6) + c*s*(t(3) - t(1))
    end do
  end subroutine turn_stress

  !> Traces of velocity gradients.
  pure subroutine trace_of_gradient(kin, n, gradient, trace)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Their traces. [1/s] (n)
    real(wp), intent(out) :: trace(n)

    select case (kin%sim_type)
    case (type_1d)
      trace = gradient(1, :)
    case (type_3d)
      trace = gradient(1, :) + gradient(5, :) + gradient(9, :)
    case (type_axisymmetric)
      trace = gradient(1, :) + gradient(4, :) + gradient(8, :)
    case default
      trace = gradient(1, :) + gradient(4, :)
    end select
  end subroutine trace_of_gradient

  !> Exponentials; small arguments, the rule in a resolved step, without a library call.
  !!
  !! The Taylor polynomial of degree 9 has a relative error below 1/10! 2**-40 < 3e-19 for
  !! |y| <= 1/16.
  pure subroutine exponential(n, y, value)
    !> Number of arguments.
    integer, intent(in) :: n
    !> Arguments. (n)
    real(wp), intent(in) :: y(n)
    !> exp(y). (n)
    real(wp), intent(out) :: value(n)
    real(wp), parameter :: small = 0.0625_wp
    real(wp) :: c, z
    integer :: p

    do p = 1, n
      ! Larger arguments are done below; the polynomial must not overflow for them.
      z = max(-small, min(small, y(p)))
      c = 1.0_wp + z*(1.0_wp/9.0_wp)
      c = 1.0_wp + c*(z*0.125_wp)
      c = 1.0_wp + c*(z*(1.0_wp/7.0_wp))
      c = 1.0_wp + c*(z*(1.0_wp/6.0_wp))
      c = 1.0_wp + c*(z*0.2_wp)
      c = 1.0_wp + c*(z*0.25_wp)
      c = 1.0_wp + c*(z*(1.0_wp/3.0_wp))
      c = 1.0_wp + c*(z*0.5_wp)
      value(p) = 1.0_wp + c*z
    end do
    do p = 1, n
      if (.not. abs(y(p)) <= small) value(p) = bounded_exponential(y(p))
    end do
  end subroutine exponential

  !> exp(y), where the result would overflow or vanish infinity or 0 without a trap.
  pure function bounded_exponential(y) result(value)
    !> Argument.
    real(wp), intent(in) :: y
    !> exp(y), at most huge, at least 0.
    real(wp) :: value
    real(wp), parameter :: limit = 700.0_wp

    if (y > limit) then
      value = huge(1.0_wp)
    else if (y < -limit) then
      value = 0.0_wp
    else
      value = exp(y)
    end if
  end function bounded_exponential

end module mpm_advance
