!> Moving the points of a body by small shifts that are no motion of the material.
module mpm_position_shift
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_kinds, only: wp
  use mpm_points, only: points_t
  use mpm_quadrature_settings, only: quadrature_settings_t
  use mpm_seam, only: wrap_points
  use mpm_sort, only: base_bounds
  use mpm_stencil, only: block_size, stencil_keys
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: shift_points

contains

  !> Move points: x, u and the sums of the shifts += delta, v += L delta.
  !!
  !! Shifts that are not finite or lead out of the grid are left out. A shift never takes a point
  !! nearer to a wall than the wall buffer; points that are nearer for another reason stay there.
  subroutine shift_points(points, settings, threads, shift)
    !> The points; those that left the grid in the step are behind `n_inside`.
    class(points_t), intent(inout) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Number of threads.
    integer, intent(in) :: threads
    !> Shifts, on exit those made. [m] (dim, n_inside)
    real(wp), intent(inout) :: shift(:, :)
    integer :: first, lo(3), hi(3), block_lo(3), block_hi(3), n_changed, changed

    if (points%n_inside == 0) return
    lo = huge(1)
    hi = -1
    n_changed = 0
    !$omp parallel do default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) &
    !$omp shared(points, settings, shift) private(first, block_lo, block_hi, changed) &
    !$omp reduction(min:lo) reduction(max:hi) reduction(+:n_changed)
    do first = 1, points%n_inside, block_size
      call shift_block(points, settings, first, min(first + block_size - 1, points%n_inside), &
                       shift, block_lo, block_hi, changed)
      lo = min(lo, block_lo)
      hi = max(hi, block_hi)
      n_changed = n_changed + changed
    end do
    !$omp end parallel do
    points%lo = lo
    points%hi = hi
    points%n_changed = points%n_changed + n_changed
    points%n_drifted = points%n_drifted + n_changed
  end subroutine shift_points

  !> Move one block of points, and find their new keys.
  subroutine shift_block(points, settings, a, b, shift, lo, hi, changed)
    !> The points.
    class(points_t), intent(inout) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> First slot of the block.
    integer, intent(in) :: a
    !> Last slot of the block.
    integer, intent(in) :: b
    !> Shifts. [m] (dim, n_inside)
    real(wp), intent(inout) :: shift(:, :)
    !> Smallest first node of the new stencils.
    integer, intent(out) :: lo(3)
    !> Largest first node of the new stencils.
    integer, intent(out) :: hi(3)
    !> Points whose key changed.
    integer, intent(out) :: changed
    integer :: key(block_size), p, c, n, k

    n = b - a + 1
    do p = a, b
      call allow(points, settings, points%x(:, p), shift(:, p))
      points%x(:, p) = points%x(:, p) + shift(:, p)
      points%shifted(:, p) = points%shifted(:, p) + shift(:, p)
      associate (dim => points%kin%dim)
        points%displacement(:dim, p) = points%displacement(:dim, p) + shift(:, p)
        if (.not. settings%corrects_velocity) cycle
        do c = 1, points%kin%nvel
          k = (c - 1)*dim
          points%velocity(c, p) = points%velocity(c, p) &
                                  + dot_product(points%gradient(k + 1:k + dim, p), shift(:, p))
        end do
      end associate
    end do
    if (any(points%stencil%periodic)) call wrap_points(points%stencil, n, points%x(:, a:b))
    call stencil_keys(points%stencil, n, points%x(:, a:b), points%extent(a:b), key)
    changed = count(key(:n) /= points%key(a:b))
    points%key(a:b) = key(:n)
    call base_bounds(points%stencil, n, key, lo, hi)
  end subroutine shift_block

  !> Make a shift one that may be made.
  pure subroutine allow(points, settings, x, shift)
    !> The points, for the box of the grid.
    class(points_t), intent(in) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Position of the point. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Its shift. [m] (dim)
    real(wp), intent(inout) :: shift(:)
    real(wp), parameter :: inner = 1.0_wp - 4.0_wp*epsilon(1.0_wp)
    real(wp) :: low, high, margin
    integer :: d

    ! Roundings must not leave a point behind the upper face.
    where (.not. ieee_is_finite(shift)) shift = 0.0_wp
    margin = 0.0_wp
    if (settings%keeps_off_walls) margin = settings%wall_buffer
    do d = 1, size(x)
      if (points%stencil%periodic(d)) cycle
      low = points%stencil%lower(d)
      high = low + inner*real(points%stencil%n_cells(d), wp)*points%stencil%h(d)
      if (x(d) + shift(d) < low .or. x(d) + shift(d) > high) then
        shift = 0.0_wp
        return
      end if
    end do
    do d = 1, size(x)
      if (points%stencil%periodic(d) .or. margin <= 0.0_wp) cycle
      low = points%stencil%lower(d)
      high = low + inner*real(points%stencil%n_cells(d), wp)*points%stencil%h(d)
      if (shift(d) < 0.0_wp) shift(d) = max(shift(d), min(0.0_wp, low + margin - x(d)))
      if (shift(d) > 0.0_wp) shift(d) = min(shift(d), max(0.0_wp, high - margin - x(d)))
    end do
  end subroutine allow

end module mpm_position_shift
