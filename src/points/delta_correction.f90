!> Shifts of points down the gradient of the overshoot of their volumes (delta-corrections).
!!
!! A quadrature that counts space twice at some nodes and leaves it out at others makes errors that
!! do not vanish with the spacing of the grid; a shift of the points of the order of their
!! displacement against the grid mends it (Baumgarten and Kamrin, IJNME 124 (2023) 2449-2497).
module mpm_delta_correction
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_gradient
  use mpm_points, only: points_t
  use mpm_position_shift, only: shift_points
  use mpm_quadrature_settings, only: newton_shift, quadrature_settings_t, strain_shift
  use mpm_volume_overshoot, only: gradients_at, measure_overshoot, overshoot_t, shared_volume
  implicit none
  private
  public :: correct_by_delta

contains

  !> Correct the positions of points by one of the three rules.
  subroutine correct_by_delta(points, grid, settings, dt, threads)
    !> The points, sorted by cell.
    class(points_t), intent(inout) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads
    type(overshoot_t) :: overshoot
    real(wp), allocatable :: shift(:, :)
    real(wp) :: step
    integer :: iteration, n

    n = points%n_inside
    if (n == 0) return
    allocate (shift(points%kin%dim, n))
    if (settings%rule /= newton_shift) then
      call measure_overshoot(points, grid, overshoot, threads)
      call gradients_at(points, overshoot, overshoot%relative*sqrt(overshoot%own), threads, shift)
      call scale_by_rate(points, settings, dt, shift)
      call shift_points(points, settings, threads, shift)
      return
    end if
    do iteration = 1, settings%max_iterations
      ! Shifts of the last iteration may have changed the order of the cells.
      if (iteration > 1) call points%refresh_order(threads)
      call measure_overshoot(points, grid, overshoot, threads)
      if (.not. maxval(overshoot%relative) > settings%tolerance) return
      call gradients_at(points, overshoot, overshoot%excess, threads, shift)
      call find_step(points, settings%alpha, overshoot%excess, shift, step)
      call descend(points, settings, step, dt, shift)
      call shift_points(points, settings, threads, shift)
    end do
  end subroutine correct_by_delta

  !> Shifts of rules 3 and 4: -alpha dt V |dev L| h**2 or -alpha dt V |v| h times grad(e sqrt(V_i)).
  subroutine scale_by_rate(points, settings, dt, shift)
    !> The points.
    class(points_t), intent(in) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> On entry the gradients, on exit the shifts. [m] (dim, n_inside)
    real(wp), intent(inout) :: shift(:, :)
    real(wp) :: volume(1), rate
    integer :: p

    do p = 1, points%n_inside
      volume = shared_volume(points, p, p)
      if (settings%rule == strain_shift) then
        rate = distortion(points, p)*settings%h**2
      else
        rate = norm2(points%velocity(:, p))*settings%h
      end if
      shift(:, p) = -settings%alpha*dt*volume(1)*rate*shift(:, p)
    end do
  end subroutine scale_by_rate

  !> Norm of the velocity gradient without a third of its trace on the diagonal.
  pure function distortion(points, p) result(norm)
    !> The points, with velocity gradients.
    class(points_t), intent(in) :: points
    !> Slot.
    integer, intent(in) :: p
    !> The norm. [1/s]
    real(wp) :: norm
    real(wp) :: gradient(3, 3), third
    integer :: i

    gradient = expand_gradient(points%kin, points%gradient(:, p))
    third = (gradient(1, 1) + gradient(2, 2) + gradient(3, 3))/3.0_wp
    do i = 1, points%kin%nvel
      gradient(i, i) = gradient(i, i) - third
    end do
    norm = sqrt(sum(gradient**2))
  end function distortion

  !> Step of Newton's method for sum H**2 = 0 along its gradient, alpha sum H**2/(2 sum V**2 |grad
  !! H|**2).
  subroutine find_step(points, alpha, excess, gradient, step)
    !> The points.
    class(points_t), intent(in) :: points
    !> Factor.
    real(wp), intent(in) :: alpha
    !> Excess of volume at the nodes. [m3]
    real(wp), intent(in) :: excess(:)
    !> Its gradient at the points. [m2] (dim, n_inside)
    real(wp), intent(in) :: gradient(:, :)
    !> The shift of a point over -V grad H; 0 where nothing can be gained.
    real(wp), intent(out) :: step
    real(wp) :: volume(1), slope
    integer :: p

    slope = 0.0_wp
    do p = 1, points%n_inside
      volume = shared_volume(points, p, p)
      slope = slope + volume(1)**2*sum(gradient(:, p)**2)
    end do
    step = 0.0_wp
    if (slope > 0.0_wp) step = alpha*sum(excess**2)/(2.0_wp*slope)
  end subroutine find_step

  !> Shifts of rule 5, -s V grad H, none longer than its limit.
  subroutine descend(points, settings, step, dt, shift)
    !> The points.
    class(points_t), intent(in) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Factor of all shifts.
    real(wp), intent(in) :: step
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> On entry the gradients, on exit the shifts. [m] (dim, n_inside)
    real(wp), intent(inout) :: shift(:, :)
    real(wp) :: volume(1), limit, length, rate
    integer :: p

    do p = 1, points%n_inside
      volume = shared_volume(points, p, p)
      shift(:, p) = -step*volume(1)*shift(:, p)
      limit = settings%h
      if (settings%velocity_limit > 0.0_wp) then
        limit = min(limit, settings%velocity_limit*norm2(points%velocity(:, p))*dt)
      end if
      if (settings%strain_limit > 0.0_wp) then
        rate = norm2(expand_gradient(points%kin, points%gradient(:, p)))
        limit = min(limit, settings%strain_limit*rate*dt* &
                    volume(1)**(1.0_wp/real(points%kin%dim, wp)))
      end if
      length = norm2(shift(:, p))
      if (length > limit) shift(:, p) = shift(:, p)*(limit/length)
    end do
  end subroutine descend

end module mpm_delta_correction
