!> Counting sort of points by the cell (key) of their stencil.
module mpm_sort
  use mpm_stencil, only: block_size, decode_keys, outside, stencil_t
  implicit none
  private
  public :: base_bounds, sort_by_cell

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
    integer :: p, previous, low, high, base(3, 1)

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
    if (stencil%dim == 1) then
      low = huge(1)
      high = -1
      do p = 1, n
        low = min(low, merge(huge(1), key(p), key(p) == outside))
        high = max(high, key(p))
      end do
      if (high < 0) return
      lo = [low, 0, 0]
      hi = [high, 0, 0]
      return
    end if
    ! The points of a cell follow each other.
    previous = outside
    do p = 1, n
      if (key(p) == previous .or. key(p) == outside) cycle
      previous = key(p)
      call decode_keys(stencil, 1, key(p:p), base)
      lo = min(lo, base(:, 1))
      hi = max(hi, base(:, 1))
    end do
  end subroutine base_bounds

  !> Order points by cell, x fastest, and find where each row of cells begins.
  !!
  !! The sort is stable, so the order depends on the storage order alone. A row is one layer of
  !! cells in the last direction of the grid; a mesh is one row.
  pure subroutine sort_by_cell(stencil, n, key, lo, hi, order, row_offset)
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
    integer, allocatable :: begin(:), cell(:)
    integer :: base(3, block_size)
    integer :: cells(3), first, nb, j, c, total, count, rows, row_size

    if (allocated(stencil%mesh)) then
      call sort_by_key(n, key, order)
      if (allocated(row_offset)) deallocate (row_offset)
      allocate (row_offset(0:1))
      row_offset = [0, n]
      return
    end if
    cells = hi - lo + 1
    allocate (begin(0:product(cells) - 1), cell(n))
    begin = 0
    do first = 1, n, block_size
      nb = min(block_size, n - first + 1)
      call decode_keys(stencil, nb, key(first:first + nb - 1), base)
      call local_cells(nb, base, lo, cells, cell(first:first + nb - 1))
      do j = first, first + nb - 1
        begin(cell(j)) = begin(cell(j)) + 1
      end do
    end do
    rows = cells(stencil%dim)
    row_size = size(begin)/rows
    if (allocated(row_offset)) deallocate (row_offset)
    allocate (row_offset(0:rows))
    total = 0
    do c = 0, size(begin) - 1
      if (mod(c, row_size) == 0) row_offset(c/row_size) = total
      count = begin(c)
      begin(c) = total
      total = total + count
    end do
    row_offset(rows) = total
    do j = 1, n
      begin(cell(j)) = begin(cell(j)) + 1
      order(begin(cell(j))) = j
    end do
  end subroutine sort_by_cell

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
