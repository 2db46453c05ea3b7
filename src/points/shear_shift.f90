!> Shifts of points out of places where they are too many, at the rate at which the material shears.
module mpm_shear_shift
  use mpm_corotation, only: shear_rates
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_points, only: points_t
  use mpm_position_shift, only: shift_points
  use mpm_quadrature_settings, only: quadrature_settings_t
  use mpm_volume_overshoot, only: gradients_at, measure_overshoot, overshoot_t
  implicit none
  private
  public :: shift_by_shear

contains

  !> Move points by -alpha dt g h**2 grad e, g the rate of shear, e the overshoot of their volumes.
  !!
  !! Velocities follow with the gradient at the point. A rotation shifts nothing.
  subroutine shift_by_shear(points, grid, h, alpha, dt, threads)
    !> The points, moved, with the velocity gradients of the step.
    class(points_t), intent(inout) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Length of the shift, about that of a cell. [m]
    real(wp), intent(in) :: h
    !> Strength.
    real(wp), intent(in) :: alpha
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads
    type(quadrature_settings_t) :: settings
    type(overshoot_t) :: overshoot
    real(wp), allocatable :: shift(:, :), rate(:)
    integer :: n, p

    ! Points that left the grid in this step take no part.
    call points%refresh_order()
    n = points%n_inside
    if (n == 0) return
    allocate (shift(points%kin%dim, n), rate(n))
    call measure_overshoot(points, grid, overshoot, threads)
    call gradients_at(points, overshoot, overshoot%relative, threads, shift)
    call shear_rates(points%kin, n, points%gradient(:, :n), rate)
    do p = 1, n
      shift(:, p) = -alpha*dt*h**2*rate(p)*shift(:, p)
    end do
    call shift_points(points, settings, threads, shift)
  end subroutine shift_by_shear

end module mpm_shear_shift
