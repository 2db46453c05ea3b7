!> Shifts of points away from their neighbours, as in smoothed particle hydrodynamics.
!!
!! Xu, Stansby and Laurence, J. Comput. Phys. 228 (2009) 6703-6725: particles that would gather on
!! stream lines are moved by a small part of their way towards where neighbours are few.
module mpm_sph_shift
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_point_cells, only: point_cells_t
  use mpm_points, only: points_t
  use mpm_position_shift, only: shift_points
  use mpm_quadrature_settings, only: quadrature_settings_t
  use mpm_stencil, only: block_size
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: correct_as_sph, neighbour_distance

  !> Part by which neighbours may be farther away than 2 r: a lattice of spacing r has points at
  !! just that distance, of which roundings must not leave out some.
  real(wp), parameter :: slack = 1.0e-6_wp

contains

  !> Distance of the farthest neighbours.
  pure function neighbour_distance(r) result(distance)
    !> Radius of a point. [m]
    real(wp), intent(in) :: r
    !> The distance. [m]
    real(wp) :: distance

    distance = 2.0_wp*r*(1.0_wp + slack)
  end function neighbour_distance

  !> Move each point by r C max|v| dt R, R = sum_q m**2 (x_p - x_q)/|x_p - x_q|**3.
  !!
  !! The sum is over the neighbours within 2 r, m their mean distance.
  subroutine correct_as_sph(points, grid, settings, dt, threads)
    !> The points, sorted by cell.
    class(points_t), intent(inout) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Time since the last shift. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads
    type(point_cells_t) :: cells
    character(:), allocatable :: message
    real(wp), allocatable :: shift(:, :)
    real(wp) :: factor
    integer :: first, p

    if (points%n_inside == 0) return
    call cells%init(grid, neighbour_distance(settings%r), message)
    if (allocated(message)) return
    call cells%fill([(p, p=1, points%n_inside)], points%x)
    factor = 0.0_wp
    do p = 1, points%n_inside
      factor = max(factor, sum(points%velocity(:, p)**2))
    end do
    factor = settings%r*settings%c*sqrt(factor)*dt
    allocate (shift(points%kin%dim, points%n_inside))
    !$omp parallel do default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) &
    !$omp shared(points, cells, settings, factor, shift) private(p)
    do first = 1, points%n_inside, block_size
      do p = first, min(first + block_size - 1, points%n_inside)
        shift(:, p) = factor*crowding(cells, points%x, p, neighbour_distance(settings%r))
      end do
    end do
    !$omp end parallel do
    call shift_points(points, settings, threads, shift)
  end subroutine correct_as_sph

  !> The sum R of a point; points at the same position do not count.
  pure function crowding(cells, x, p, radius) result(sum_of_ways)
    !> The points in cells.
    type(point_cells_t), intent(in) :: cells
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    !> The point.
    integer, intent(in) :: p
    !> Distance of the farthest neighbours. [m]
    real(wp), intent(in) :: radius
    !> The sum.
    real(wp) :: sum_of_ways(size(x, 1))
    real(wp) :: way(size(x, 1)), distance, total
    integer :: places(125), n_places, i, k, n

    sum_of_ways = 0.0_wp
    total = 0.0_wp
    n = 0
    call cells%around(cells%cell_of(x(:, p)), 1, places, n_places)
    do i = 1, n_places
      do k = cells%begin(places(i)), cells%begin(places(i) + 1) - 1
        way = cells%way(x(:, cells%point(k)), x(:, p))
        distance = norm2(way)
        if (distance > radius .or. .not. distance > 0.0_wp) cycle
        n = n + 1
        total = total + distance
        sum_of_ways = sum_of_ways + way/distance**3
      end do
    end do
    if (n > 0) sum_of_ways = (total/real(n, wp))**2*sum_of_ways
  end function crowding

end module mpm_sph_shift
