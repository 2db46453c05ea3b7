!> Sweeps over blocks of points that differ from the one sweep of FLIP with the stress updated last.
module mpm_point_blocks
  use mpm_advance, only: advance_points, exponential, largest_growth, trace_of_gradient, turn_stress
  use mpm_g2p, only: g2p
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_material, only: material_t
  use mpm_nodes, only: nodes_t
  use mpm_point_maps, only: interpolate_points
  use mpm_points, only: points_t
  use mpm_stencil, only: axis_fraction, block_size, stencil_t
  use mpm_sweep, only: sweep_t
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: fit_points, sweep_block

contains

  !> Interpolate to one block of points; change velocities, positions and volumes as asked.
  subroutine sweep_block(points, nodes, stencil, sweep, dt, a, b, gradient, slot, material)
    !> The points; the blocks of different threads do not overlap.
    class(points_t), intent(inout) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> What to do.
    type(sweep_t), intent(in) :: sweep
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First slot of the block.
    integer, intent(in) :: a
    !> Last slot of the block.
    integer, intent(in) :: b
    !> Velocity gradients, 0 without strain. [1/s] (ngrad (b - a + 1))
    real(wp), intent(inout) :: gradient(9*block_size)
    !> First point of the block that is not finite, moved more than a cell or lost its volume, or 0.
    integer, intent(out) :: slot
    !> Constitutive law, whose memory turns with the basis.
    class(material_t), intent(in), optional :: material
    real(wp) :: velocity(3*block_size), gain(3*block_size)
    integer :: n

    n = b - a + 1
    slot = 0
    call interpolate(points, nodes, stencil, sweep, a, b, velocity, gain, gradient)
    associate (kin => points%kin)
      if (allocated(points%domains)) then
        call points%domains%follow(kin, stencil, dt, a, n, points%x(:, a:b), nodes%velocity, &
                                   gradient, velocity, sweep%strain, sweep%drift)
      end if
      if (sweep%kick) then
        if (allocated(points%affine)) then
          call fit_velocities(points, nodes, stencil, a, b, gradient)
        end if
        if (sweep%kept < 1.0_wp) points%velocity(:, a:b) = sweep%kept*points%velocity(:, a:b)
      else
        gain(:kin%nvel*n) = 0.0_wp
      end if
      if (.not. sweep%strain) then
        ! The stress of the start of the step turns with the basis, which moves now.
        if (sweep%drift .and. kin%sim_type == type_axisymmetric) then
          call turn_stress(n, dt, gradient, points%stress(:, a:b))
          if (present(material)) then
            call material%turn_history(n, dt, gradient, points%history(:, a:b))
          end if
        end if
        gradient(:kin%ngrad*n) = 0.0_wp
      end if
      if (sweep%drift) then
        if (kin%sim_type == type_axisymmetric .and. allocated(points%affine)) then
          call turn_affine(n, dt, axis_fraction*stencil%h(1), points%x(:, a:b), &
                           points%velocity(:, a:b), gain, points%affine(:, a:b))
        end if
        call advance_points(kin, stencil, n, dt, velocity, gain, gradient, points%x(:, a:b), &
                            points%displacement(:, a:b), points%velocity(:, a:b), &
                            points%volume(a:b), slot)
      else
        points%velocity(:, a:b) = points%velocity(:, a:b) &
                                  + reshape(gain(:kin%nvel*n), [kin%nvel, n])
        if (sweep%strain) call stretch(points, dt, a, b, gradient, slot)
      end if
    end associate
  end subroutine sweep_block

  !> Interpolate what a sweep needs: velocity of the grid, gain of the points, velocity gradient.
  subroutine interpolate(points, nodes, stencil, sweep, a, b, velocity, gain, gradient)
    !> The points.
    class(points_t), intent(in) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> What to do.
    type(sweep_t), intent(in) :: sweep
    !> First slot of the block.
    integer, intent(in) :: a
    !> Last slot of the block.
    integer, intent(in) :: b
    !> Velocity of the grid at the points. [m/s] (nvel (b - a + 1))
    real(wp), intent(inout) :: velocity(3*block_size)
    !> What the velocities of the points receive. [m/s] (nvel (b - a + 1))
    real(wp), intent(inout) :: gain(3*block_size)
    !> Velocity gradients. [1/s] (ngrad (b - a + 1))
    real(wp), intent(inout) :: gradient(9*block_size)

    if (sweep%remapped) then
      call interpolate_points(points, stencil, nodes%window, a, b, nodes%remapped, &
                              nodes%velocity, gain, velocity, gradient)
    else if (sweep%kick .and. allocated(nodes%gain)) then
      call interpolate_points(points, stencil, nodes%window, a, b, nodes%velocity, nodes%gain, &
                              velocity, gain, gradient)
    else
      call interpolate_points(points, stencil, nodes%window, a, b, nodes%velocity, &
                              nodes%increment, velocity, gain, gradient)
    end if
  end subroutine interpolate

  !> Fit affine fields of velocity to the nodes of all points of a body.
  subroutine fit_points(points, nodes, threads)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Their nodes, with velocities.
    class(nodes_t), intent(in) :: nodes
    !> Number of threads.
    integer, intent(in) :: threads
    real(wp) :: velocity(3*block_size), gain(3*block_size), gradient(9*block_size)
    type(sweep_t) :: sweep
    integer :: a, b

    sweep%kick = .false.
    !$omp parallel do default(none) schedule(static) private(b, velocity, gain, gradient) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) shared(points, nodes, sweep)
    do a = 1, points%n_inside, block_size
      b = min(a + block_size - 1, points%n_inside)
      call interpolate(points, nodes, points%stencil, sweep, a, b, velocity, gain, gradient)
      call fit_velocities(points, nodes, points%stencil, a, b, gradient)
    end do
    !$omp end parallel do
  end subroutine fit_points

  !> Fit affine fields of velocity to the nodes of points: C_p = sum_i v_i (x_i - x_p) w_i/D.
  subroutine fit_velocities(points, nodes, stencil, a, b, gradient)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Their nodes, after the grid update.
    class(nodes_t), intent(in) :: nodes
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> First slot of the block.
    integer, intent(in) :: a
    !> Last slot of the block.
    integer, intent(in) :: b
    !> Velocity gradients by the slopes of `stencil`. [1/s] (ngrad (b - a + 1))
    real(wp), intent(in) :: gradient(9*block_size)
    real(wp) :: unused(3*block_size), same(3*block_size), slopes(9*block_size)
    type(stencil_t) :: fit
    integer :: n, p, c

    n = b - a + 1
    associate (kin => points%kin)
      ! The fit to hats is their derivative.
      if (stencil%fitted .or. stencil%width == 2) then
        slopes(:kin%ngrad*n) = gradient(:kin%ngrad*n)
      else
        fit = stencil
        fit%fitted = .true.
        call g2p(kin, fit, nodes%window, n, points%key(a:b), points%x(:, a:b), &
                 points%extent(a:b), nodes%velocity, nodes%velocity, unused, same, slopes)
      end if
      do p = 1, n
        do c = 1, kin%nvel*kin%dim
          points%affine(c, a + p - 1) = slopes((p - 1)*kin%ngrad + c)
        end do
      end do
    end associate
  end subroutine fit_velocities

  !> Express affine fields in the cylindrical basis of the moved points.
  !!
  !! They become the gradients of the velocities that `advance_points` makes of the points: v_r is
  !! turned by the angle dt v_t/r, r v_t stays while r grows to r + dt v_r.
  pure subroutine turn_affine(n, dt, r_floor, x, velocity, gain, affine)
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Smallest radius that divides. [m]
    real(wp), intent(in) :: r_floor
    !> Positions r, z before the move. [m] (2, n)
    real(wp), intent(in) :: x(2, n)
    !> Velocities r, z, theta before `gain`. [m/s] (3, n)
    real(wp), intent(in) :: velocity(3, n)
    !> What they receive. [m/s] (3, n)
    real(wp), intent(in) :: gain(3, n)
    !> Gradients rr rz zr zz tr tz. [1/s] (6, n)
    real(wp), intent(inout) :: affine(6, n)
    real(wp) :: v(3), r, r_new, angle, slope(2), radial(2), hoop(2), dr(2), dr_new(2)
    integer :: p

    do p = 1, n
      v = velocity(:, p) + gain(:, p)
      r = max(x(1, p), r_floor)
      dr = 0.0_wp
      if (x(1, p) > r_floor) dr(1) = 1.0_wp
      radial = affine(1:2, p)
      hoop = affine(5:6, p)
      angle = dt*v(3)/r
      slope = dt*(hoop - v(3)*dr/r)/r
      affine(1:2, p) = cos(angle)*radial + sin(angle)*hoop &
                       + (cos(angle)*v(3) - sin(angle)*v(1))*slope
      r_new = x(1, p) + dt*v(1)
      dr_new = [1.0_wp, 0.0_wp] + dt*radial
      if (.not. r_new > r_floor) then
        r_new = r_floor
        dr_new = 0.0_wp
      end if
      if (r < largest_growth*r_new) then
        affine(5:6, p) = (r*hoop + v(3)*(dr - (r/r_new)*dr_new))/r_new
      else
        affine(5:6, p) = largest_growth*hoop
      end if
    end do
  end subroutine turn_affine

  !> Stretch the volumes of points that stay where they are: V *= exp(dt tr L).
  subroutine stretch(points, dt, a, b, gradient, slot)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First slot of the block.
    integer, intent(in) :: a
    !> Last slot of the block.
    integer, intent(in) :: b
    !> Velocity gradients. [1/s] (ngrad (b - a + 1))
    real(wp), intent(in) :: gradient(9*block_size)
    !> First point of the block that lost its volume or is not finite, or 0.
    integer, intent(out) :: slot
    real(wp) :: trace(block_size), factor(block_size)
    integer :: n, p

    n = b - a + 1
    call trace_of_gradient(points%kin, n, gradient, trace)
    trace(:n) = dt*trace(:n)
    call exponential(n, trace, factor)
    slot = 0
    do p = n, 1, -1
      associate (volume => points%volume(a + p - 1))
        volume = volume*factor(p)
        if (.not. (volume > 0.0_wp .and. volume <= huge(1.0_wp))) slot = p
      end associate
    end do
  end subroutine stretch

end module mpm_point_blocks
