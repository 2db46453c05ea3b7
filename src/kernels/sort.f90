!> Counting sort of points by the cell (key) of their stencil.
module mpm_sort
  use mpm_kinds, only: lp
  use mpm_stencil, only: block_size, decode_keys, outside, stencil_t
  implicit none
  private
  public :: base_bounds, sort_by_cell

  !> Rows of cells in which points are looked for one row at a time.
  integer, parameter :: few_rows = 4

contains

  !> Smallest and largest first node of the stencils of points inside the grid; on a mesh the lowest
  !! and highest node of their cells.
  pure subroutine base_bounds(stencil, n, key, lo, hi)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Keys; those outside the grid do not count. (n)
    integer, intent(in) :: key(n)
    !> Smallest first node per direction; huge when all points are outside.
    integer, intent(out) :: lo(3)
    !> Largest first node per direction; -1 when all points are outside.
    integer, intent(out) :: hi(3)
    integer :: p, previous, low, high, next, row, base(3, 1)

    lo = huge(1)
    hi = -1
    if (allocated(stencil%mesh)) then
      previous = outside
      do p = 1, n
        if (key(p) == previous .or. key(p) == outside) cycle
        previous = key(p)
        lo = [min(lo(1), stencil%mesh%span(1, key(p)) - 1), 0, 0]
        hi = [max(hi(1), stencil%mesh%span(2, key(p)) - 1), 0, 0]
      end do
      return
    end if
    call split_keys(n, key, 0, high, low)
    if (low == huge(1)) return
    if (stencil%dim == 1) then
      call split_keys(n, key, huge(1), high, next)
      lo = [low, 0, 0]
      hi = [high, 0, 0]
      return
    end if
    ! Keys are in the order of rows along x, and most blocks have points in few of them.
    do row = 1, few_rows
      call decode_keys(stencil, 1, [low], base)
      call split_keys(n, key, low - base(1, 1) + stencil%n_cells(1) + 1, high, next)
      lo = min(lo, base(:, 1))
      base(1, 1) = base(1, 1) + high - low
      hi = max(hi, base(:, 1))
      if (next == huge(1)) return
      low = next
    end do
    previous = outside
    do p = 1, n
      if (key(p) == previous .or. key(p) < low) cycle
      previous = key(p)
      call decode_keys(stencil, 1, key(p:p), base)
      lo = min(lo, base(:, 1))
      hi = max(hi, base(:, 1))
    end do
  end subroutine base_bounds

  !> Largest key below a limit and smallest key from there on.
  pure subroutine split_keys(n, key, limit, below, above)
    !> Number of points.
    integer, intent(in) :: n
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> The limit, 0 or more: what is outside the grid is below it.
    integer, intent(in) :: limit
    !> Largest key below the limit; `outside` when there is none.
    integer, intent(out) :: below
    !> Smallest other key; huge when there is none.
    integer, intent(out) :: above
    integer :: p

    below = outside
    above = huge(1)
    !$omp simd reduction(max:below) reduction(min:above)
    do p = 1, n
      below = max(below, merge(key(p), outside, key(p) < limit))
      above = min(above, merge(huge(1), key(p), key(p) < limit))
    end do
  end subroutine split_keys

  !> Order points by cell, x fastest, and find where each row of cells begins.
  !!
  !! The sort is stable, so the order depends on the storage order alone, not on the number of
  !! threads: each thread counts and places a part of the points. A row is one layer of cells in the
  !! last direction of the grid; a mesh is one row.
  subroutine sort_by_cell(stencil, n, key, lo, hi, order, row_offset, threads)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points, all inside the grid.
    integer, intent(in) :: n
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> Smallest first node per direction.
    integer, intent(in) :: lo(3)
    !> Largest first node per direction.
    integer, intent(in) :: hi(3)
    !> Slots of the points in the order of their cells. (n)
    integer, intent(out) :: order(n)
    !> Points in rows before each row; the last entry is n. (0:rows)
    integer, allocatable, intent(inout) :: row_offset(:)
    !> Number of threads; 1 when left out.
    integer, intent(in), optional :: threads
    integer, allocatable :: begin(:, :), cell(:)
    integer :: cells(3), parts, part, rows

    if (allocated(stencil%mesh)) then
      call sort_by_key(n, key, order)
      if (allocated(row_offset)) deallocate (row_offset)
      allocate (row_offset(0:1))
      row_offset = [0, n]
      return
    end if
    cells = hi - lo + 1
    parts = 1
    ! Counts of an almost empty window would cost more than the threads gain.
    if (present(threads)) parts = max(1, min(threads, 2*n/product(cells)))
    allocate (begin(0:product(cells) - 1, parts), cell(n))
    !$omp parallel do default(none) num_threads(parts) schedule(static, 1) &
    !$omp shared(stencil, parts, n, key, lo, cells, cell, begin) private(part)
    do part = 1, parts
      call count_points(stencil, bound(part - 1) + 1, bound(part), key, lo, cells, cell, &
                        begin(:, part))
    end do
    !$omp end parallel do
    rows = cells(stencil%dim)
    if (allocated(row_offset)) deallocate (row_offset)
    allocate (row_offset(0:rows))
    call sum_up(size(begin, 1), parts, size(begin, 1)/rows, begin, row_offset)
    !$omp parallel do default(none) num_threads(parts) schedule(static, 1) &
    !$omp shared(parts, n, cell, begin, order) private(part)
    do part = 1, parts
      call place_points(bound(part - 1) + 1, bound(part), cell, begin(:, part), order)
    end do
    !$omp end parallel do

  contains

    !> Last point of a part.
    pure integer function bound(part)
      !> Number of the part.
      integer, intent(in) :: part

      bound = int(int(n, lp)*part/parts)
    end function bound

  end subroutine sort_by_cell

  !> Find the cells of points, and count them.
  pure subroutine count_points(stencil, low, high, key, lo, cells, cell, number)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> First point.
    integer, intent(in) :: low
    !> Last point.
    integer, intent(in) :: high
    !> Keys. (n)
    integer, intent(in) :: key(:)
    !> Lower corner of the box of cells.
    integer, intent(in) :: lo(3)
    !> Cells of the box in each direction.
    integer, intent(in) :: cells(3)
    !> Cells of the points, from 0; only those of low to high are found. (n)
    integer, intent(inout) :: cell(:)
    !> Points in each cell. (0:cells - 1)
    integer, intent(out) :: number(0:)
    integer :: base(3, block_size), first, nb, j

    number = 0
    do first = low, high, block_size
      nb = min(block_size, high - first + 1)
      call decode_keys(stencil, nb, key(first:first + nb - 1), base)
      call local_cells(nb, base, lo, cells, cell(first:first + nb - 1))
      do j = first, first + nb - 1
        number(cell(j)) = number(cell(j)) + 1
      end do
    end do
  end subroutine count_points

  !> Turn numbers of points into those of the points before, in earlier cells and earlier parts.
  pure subroutine sum_up(cells, parts, row_size, begin, row_offset)
    !> Number of cells.
    integer, intent(in) :: cells
    !> Number of parts.
    integer, intent(in) :: parts
    !> Cells in a row.
    integer, intent(in) :: row_size
    !> Points of each cell and part; on exit those before. (0:cells - 1, parts)
    integer, intent(inout) :: begin(0:cells - 1, parts)
    !> Points before each row; the last entry is the number of points. (0:rows)
    integer, intent(out) :: row_offset(0:)
    integer :: c, part, count, total

    total = 0
    do c = 0, cells - 1
      if (mod(c, row_size) == 0) row_offset(c/row_size) = total
      do part = 1, parts
        count = begin(c, part)
        begin(c, part) = total
        total = total + count
      end do
    end do
    row_offset(cells/row_size) = total
  end subroutine sum_up

  !> Put points at the places of their cells, in the order in which they are stored.
  pure subroutine place_points(low, high, cell, begin, order)
    !> First point.
    integer, intent(in) :: low
    !> Last point.
    integer, intent(in) :: high
    !> Cells of the points. (n)
    integer, intent(in) :: cell(:)
    !> Points before the next one of each cell. (0:cells - 1)
    integer, intent(inout) :: begin(0:)
    !> Slots in the order of cells; only the places of these points are written. (n)
    integer, intent(inout) :: order(:)
    integer :: j

    do j = low, high
      begin(cell(j)) = begin(cell(j)) + 1
      order(begin(cell(j))) = j
    end do
  end subroutine place_points

  !> Order points by their keys; a stable sort.
  pure subroutine sort_by_key(n, key, order)
    !> Number of points.
    integer, intent(in) :: n
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> Slots of the points in the order of their keys. (n)
    integer, intent(out) :: order(n)
    integer, allocatable :: begin(:)
    integer :: p, k, total, count

    allocate (begin(minval(key):maxval(key)), source=0)
    do p = 1, n
      begin(key(p)) = begin(key(p)) + 1
    end do
    total = 0
    do k = lbound(begin, 1), ubound(begin, 1)
      count = begin(k)
      begin(k) = total
      total = total + count
    end do
    do p = 1, n
      begin(key(p)) = begin(key(p)) + 1
      order(begin(key(p))) = p
    end do
  end subroutine sort_by_key

  !> Cells of points counted from the lower corner of their bounding box.
  pure subroutine local_cells(n, base, lo, cells, cell)
    !> Number of points.
    integer, intent(in) :: n
    !> First nodes. (3, n)
    integer, intent(in) :: base(3, n)
    !> Lower corner of the box.
    integer, intent(in) :: lo(3)
    !> Cells of the box in each direction.
    integer, intent(in) :: cells(3)
    !> Cell of each point, from 0. (n)
    integer, intent(out) :: cell(:)
    integer :: j

    do j = 1, n
      cell(j) = base(1, j) - lo(1) + cells(1)*(base(2, j) - lo(2) + cells(2)*(base(3, j) - lo(3)))
    end do
  end subroutine local_cells

end module mpm_sort
