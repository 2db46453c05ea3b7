!> Smoothing of the volumes of points over cells, against locking.
!!
!! J_p = V_p/V0_p is the volume of a point over its volume at the start. A nearly incompressible
!! material holds it for each point, which is more than the functions of a cell can do: the body
!! locks. The mean of J over a cell asks for one thing a cell only (Mast, Mackenzie-Helnwein,
!! Arduino, Miller and Shin, J. Comput. Phys. 231 (2012) 5351-5373).
module mpm_volume_smoothing
  use mpm_kinds, only: wp
  implicit none
  private
  public :: cells_t, smooth_by_cells, smooth_by_flux, smooth_by_nodes

  !> Equal cells in a box.
  type :: cells_t
    !> Dimensions.
    integer :: dim = 3
    !> Lower corner. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Sides of a cell. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Cells in each direction; those of unused directions are not looked at.
    integer :: n(3) = 1
  end type cells_t

contains

  !> Give all points of a cell the mean J = sum V/sum V0 of the cell.
  pure subroutine smooth_by_cells(cells, n, x, reference, volume)
    !> The cells.
    type(cells_t), intent(in) :: cells
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(cells%dim, n)
    !> Volumes at the start. [m3] (n)
    real(wp), intent(in) :: reference(n)
    !> Volumes; points outside the cells keep theirs. [m3] (n)
    real(wp), intent(inout) :: volume(n)
    real(wp), allocatable :: total(:), total_reference(:)
    integer, allocatable :: cell(:)
    integer :: counts(3), p

    call find_cells(cells, n, x, cell, counts)
    call sum_cells(n, cell, reference, volume, product(counts), total, total_reference)
    do p = 1, n
      if (cell(p) > 0) volume(p) = reference(p)*(total(cell(p))/total_reference(cell(p)))
    end do
  end subroutine smooth_by_cells

  !> Project J to the corners of each cell alone, and back to its points.
  !!
  !! J_i = sum S_ip V_p J_p/sum S_ip V_p over the points of the cell, then J_p = sum S_ip J_i, with
  !! the hat functions S of the cell's corners.
  pure subroutine smooth_by_nodes(cells, n, x, reference, volume)
    !> The cells.
    type(cells_t), intent(in) :: cells
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(cells%dim, n)
    !> Volumes at the start. [m3] (n)
    real(wp), intent(in) :: reference(n)
    !> Volumes; points outside the cells keep theirs. [m3] (n)
    real(wp), intent(inout) :: volume(n)
    real(wp), allocatable :: weight(:, :), moment(:, :)
    integer, allocatable :: cell(:)
    real(wp) :: s(8)
    integer :: counts(3), corners, p, i

    corners = 2**cells%dim
    call find_cells(cells, n, x, cell, counts)
    allocate (weight(corners, product(counts)), moment(corners, product(counts)))
    weight = 0.0_wp
    moment = 0.0_wp
    do p = 1, n
      i = cell(p)
      if (i == 0) cycle
      s = volume(p)*corner_weights(cells, x(:, p))
      weight(:, i) = weight(:, i) + s(:corners)
      moment(:, i) = moment(:, i) + s(:corners)*(volume(p)/reference(p))
    end do
    ! A corner that no point reaches has no part in the J of the points.
    where (weight > tiny(1.0_wp)) moment = moment/weight
    do p = 1, n
      i = cell(p)
      if (i == 0) cycle
      s = corner_weights(cells, x(:, p))
      volume(p) = reference(p)*dot_product(s(:corners), moment(:, i))
    end do
  end subroutine smooth_by_nodes

  !> Means of the cells as of `smooth_by_cells`, smoothed where they oscillate from cell to cell.
  !!
  !! Two dimensions. What one cell gives the other takes, so that sum V0 J is kept.
  pure subroutine smooth_by_flux(cells, n, x, reference, volume)
    !> The cells.
    type(cells_t), intent(in) :: cells
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (2, n)
    real(wp), intent(in) :: x(cells%dim, n)
    !> Volumes at the start. [m3] (n)
    real(wp), intent(in) :: reference(n)
    !> Volumes; points outside the cells keep theirs. [m3] (n)
    real(wp), intent(inout) :: volume(n)
    real(wp), allocatable :: total(:), total_reference(:), ratio(:, :), weight(:, :), change(:, :)
    real(wp), allocatable :: ratio_t(:, :), weight_t(:, :), change_t(:, :)
    integer, allocatable :: cell(:)
    integer :: counts(3), p, i, j

    call find_cells(cells, n, x, cell, counts)
    call sum_cells(n, cell, reference, volume, product(counts), total, total_reference)
    allocate (change(counts(1), counts(2)), change_t(counts(2), counts(1)), source=0.0_wp)
    weight = reshape(total_reference, counts(:2))
    ratio = reshape(total, counts(:2))
    where (weight > 0.0_wp) ratio = ratio/weight
    do j = 1, counts(2)
      call add_line_fluxes(counts(1), ratio(:, j), weight(:, j), change(:, j))
    end do
    ratio_t = transpose(ratio)
    weight_t = transpose(weight)
    do i = 1, counts(1)
      call add_line_fluxes(counts(2), ratio_t(:, i), weight_t(:, i), change_t(:, i))
    end do
    ratio = ratio + change + transpose(change_t)
    do p = 1, n
      if (cell(p) == 0) cycle
      i = mod(cell(p) - 1, counts(1)) + 1
      j = (cell(p) - 1)/counts(1) + 1
      volume(p) = reference(p)*ratio(i, j)
    end do
  end subroutine smooth_by_flux

  !> Fluxes along a line of cells; each run of cells with points is a line of its own.
  pure subroutine add_line_fluxes(n, ratio, weight, change)
    !> Number of cells.
    integer, intent(in) :: n
    !> J of the cells.
    real(wp), intent(in) :: ratio(n)
    !> Volumes of their points at the start; 0 in empty cells. [m3]
    real(wp), intent(in) :: weight(n)
    !> Changes of J, added to.
    real(wp), intent(inout) :: change(n)
    integer :: first, last

    first = 1
    do while (first <= n)
      last = first
      if (weight(first) > 0.0_wp) then
        do while (last < n)
          if (.not. weight(last + 1) > 0.0_wp) exit
          last = last + 1
        end do
        call add_run_fluxes(last - first + 1, ratio(first:last), weight(first:last), &
                            change(first:last))
      end if
      first = last + 1
    end do
  end subroutine add_line_fluxes

  !> Fluxes between neighbours in a run of cells with points.
  pure subroutine add_run_fluxes(n, ratio, weight, change)
    !> Number of cells.
    integer, intent(in) :: n
    !> J of the cells.
    real(wp), intent(in) :: ratio(n)
    !> Volumes of their points at the start. [m3]
    real(wp), intent(in) :: weight(n)
    !> Changes of J, added to.
    real(wp), intent(inout) :: change(n)
    real(wp) :: slope(n), jump, gamma, flux
    integer :: c
    logical :: before, behind

    if (n < 2) return
    ! Differences from cell to cell, without the spacing.
    slope(1) = ratio(2) - ratio(1)
    slope(2:n - 1) = 0.5_wp*(ratio(3:) - ratio(:n - 2))
    slope(n) = ratio(n) - ratio(n - 1)
    before = .true.
    do c = 1, n - 1
      behind = c + 1 == n
      if (.not. behind) behind = (ratio(c + 1) - ratio(c))*(ratio(c + 2) - ratio(c + 1)) < 0.0_wp
      jump = ratio(c) - ratio(c + 1)
      if (before .and. behind .and. abs(jump) > 0.0_wp) then
        gamma = 1.0_wp + 0.5_wp*(slope(c) + slope(c + 1))/jump
        gamma = max(0.0_wp, min(1.0_wp, gamma))
        flux = 0.25_wp*gamma*jump/(weight(c) + weight(c + 1))
        change(c) = change(c) - flux*weight(c + 1)
        change(c + 1) = change(c + 1) + flux*weight(c)
      end if
      before = behind
    end do
  end subroutine add_run_fluxes

  !> The cell of each point in the smallest box of cells around all points.
  pure subroutine find_cells(cells, n, x, cell, counts)
    !> The cells.
    type(cells_t), intent(in) :: cells
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(cells%dim, n)
    !> Position of the cell in the box, x fastest, from 1; 0 outside all cells. (n)
    integer, allocatable, intent(out) :: cell(:)
    !> Cells of the box; 1 in unused directions.
    integer, intent(out) :: counts(3)
    integer :: index(3), lo(3), hi(3), p, d
    logical :: inside

    allocate (cell(n))
    lo = huge(1)
    hi = -1
    do p = 1, n
      call locate(cells, x(:, p), index, inside)
      if (.not. inside) cycle
      lo = min(lo, index)
      hi = max(hi, index)
    end do
    counts = max(0, hi - min(lo, hi + 1) + 1)
    do p = 1, n
      cell(p) = 0
      call locate(cells, x(:, p), index, inside)
      if (.not. inside) cycle
      do d = 3, 1, -1
        cell(p) = cell(p)*counts(d) + index(d) - lo(d)
      end do
      cell(p) = cell(p) + 1
    end do
  end subroutine find_cells

  !> The cell of a position; a node line belongs to the cell above it, an upper face to the last.
  pure subroutine locate(cells, x, index, inside)
    !> The cells.
    type(cells_t), intent(in) :: cells
    !> Position. [m]
    real(wp), intent(in) :: x(cells%dim)
    !> Cell in each direction, from 0; 0 in unused directions.
    integer, intent(out) :: index(3)
    !> Whether the position is in a cell.
    logical, intent(out) :: inside
    real(wp) :: s
    integer :: d

    index = 0
    inside = .true.
    do d = 1, cells%dim
      s = (x(d) - cells%lower(d))/cells%h(d)
      inside = inside .and. s >= 0.0_wp .and. s <= real(cells%n(d), wp)
      if (inside) index(d) = min(int(s), cells%n(d) - 1)
    end do
  end subroutine locate

  !> Values of the hat functions of the corners of a point's cell, x fastest.
  pure function corner_weights(cells, x) result(s)
    !> The cells.
    type(cells_t), intent(in) :: cells
    !> A position inside. [m]
    real(wp), intent(in) :: x(cells%dim)
    !> Values; 0 beyond the corners that there are.
    real(wp) :: s(8)
    real(wp) :: xi
    integer :: index(3), d, m
    logical :: inside

    call locate(cells, x, index, inside)
    s = 0.0_wp
    s(1) = 1.0_wp
    do d = 1, cells%dim
      xi = (x(d) - cells%lower(d))/cells%h(d) - real(index(d), wp)
      m = 2**(d - 1)
      s(m + 1:2*m) = xi*s(:m)
      s(:m) = (1.0_wp - xi)*s(:m)
    end do
  end function corner_weights

  !> Volumes of the points of each cell.
  pure subroutine sum_cells(n, cell, reference, volume, n_cells, total, total_reference)
    !> Number of points.
    integer, intent(in) :: n
    !> Their cells; 0 for none. (n)
    integer, intent(in) :: cell(n)
    !> Volumes at the start. [m3] (n)
    real(wp), intent(in) :: reference(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Number of cells.
    integer, intent(in) :: n_cells
    !> Sums of the volumes. [m3] (n_cells)
    real(wp), allocatable, intent(out) :: total(:)
    !> Sums of the volumes at the start. [m3] (n_cells)
    real(wp), allocatable, intent(out) :: total_reference(:)
    integer :: p

    allocate (total(n_cells), total_reference(n_cells), source=0.0_wp)
    do p = 1, n
      if (cell(p) == 0) cycle
      total(cell(p)) = total(cell(p)) + volume(p)
      total_reference(cell(p)) = total_reference(cell(p)) + reference(p)
    end do
  end subroutine sum_cells

end module mpm_volume_smoothing
