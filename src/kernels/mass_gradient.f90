!> Nodal gradient of a body's mass, which points out of the body at its surface.
module mpm_mass_gradient
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_seam, only: fold_ghosts
  use mpm_stencil, only: axis_fraction, block_size, decode_keys, outside, stencil_t, stencil_weights
  use mpm_window, only: window_t
  implicit none
  private
  public :: mass_gradient

  !> Most nodes of a stencil in one direction.
  integer, parameter :: most_nodes = 5

contains

  !> N_i = sum_p m_p grad N_i(x_p) at the nodes of a window; in TYPE 4 with m_p/r_p.
  !!
  !! Only points whose stencils reach the window are visited, in the order of their cells.
  pure subroutine mass_gradient(kin, stencil, window, n, order, row_offset, first_row, key, x, &
                                extent, mass, gradient)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The nodes wanted.
    type(window_t), intent(in) :: window
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Slots of the points in the order of their cells. (n)
    integer, intent(in) :: order(n)
    !> Points before each row of cells. (0:rows)
    integer, intent(in) :: row_offset(0:)
    !> Grid index of the first row.
    integer, intent(in) :: first_row
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(kin%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Gradients, components beyond dim 0. [kg/m] (nvel, nn)
    real(wp), intent(out) :: gradient(:, :)
    real(wp), allocatable :: all_gradients(:, :)
    type(window_t) :: wide
    integer :: d, i, j, k, hi(3), here, there

    if (.not. any(stencil%periodic)) then
      call sum_gradients(kin, stencil, window, n, order, row_offset, first_row, key, x, extent, &
                         mass, gradient)
      return
    end if
    ! Points beyond a seam reach the ghosts of the nodes wanted.
    wide = window
    do d = 1, kin%dim
      if (.not. stencil%periodic(d)) cycle
      wide%lo(d) = 0
      wide%n(d) = stencil%n_cells(d) + stencil%width - 1
    end do
    allocate (all_gradients(size(gradient, 1), wide%size()))
    call sum_gradients(kin, stencil, wide, n, order, row_offset, first_row, key, x, extent, mass, &
                       all_gradients)
    call fold_ghosts(stencil, wide, size(gradient, 1), all_gradients)
    hi = window%hi()
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          here = window%index([i, j, k])
          there = wide%index([i, j, k])
          gradient(:, here) = all_gradients(:, there)
        end do
      end do
    end do
  end subroutine mass_gradient

  !> The sums at the nodes of a window, ghosts of periodic grids for themselves.
  pure subroutine sum_gradients(kin, stencil, window, n, order, row_offset, first_row, key, x, &
                                extent, mass, gradient)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The nodes wanted.
    type(window_t), intent(in) :: window
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Slots of the points in the order of their cells. (n)
    integer, intent(in) :: order(n)
    !> Points before each row of cells. (0:rows)
    integer, intent(in) :: row_offset(0:)
    !> Grid index of the first row.
    integer, intent(in) :: first_row
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(kin%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Gradients, components beyond dim 0. [kg/m] (nvel, nn)
    real(wp), intent(out) :: gradient(:, :)
    real(wp) :: xb(kin%dim, block_size), eb(block_size), m(block_size), r_floor
    real(wp) :: w(most_nodes*kin%dim*block_size), dw(most_nodes*kin%dim*block_size)
    integer :: base(3, block_size), here(3, 1), rows, low, high, k, p, previous, nb, j, values
    logical :: near

    gradient = 0.0_wp
    r_floor = axis_fraction*stencil%h(1)
    rows = ubound(row_offset, 1)
    associate (d => kin%dim)
      low = max(0, window%lo(d) - stencil%width + 1 - first_row)
      high = min(rows - 1, window%lo(d) + window%n(d) - 1 - first_row)
    end associate
    if (high < low) return
    values = stencil%width*kin%dim
    previous = outside
    near = .false.
    here = 0
    nb = 0
    do k = row_offset(low) + 1, row_offset(high + 1)
      p = order(k)
      if (key(p) /= previous) then
        previous = key(p)
        call decode_keys(stencil, 1, key(p:p), here)
        near = reaches(stencil, kin%dim, here(:, 1), window)
      end if
      if (near) then
        nb = nb + 1
        base(:, nb) = here(:, 1)
        xb(:, nb) = x(:, p)
        eb(nb) = extent(p)
        m(nb) = mass(p)
        if (kin%sim_type == type_axisymmetric) m(nb) = m(nb)/max(x(1, p), r_floor)
      end if
      if (nb == 0 .or. nb < block_size .and. k < row_offset(high + 1)) cycle
      call stencil_weights(stencil, nb, xb, eb, base, w, dw)
      do j = 1, nb
        call add_point(stencil%width, kin%dim, base(:, j), w(values*(j - 1) + 1:values*j), &
                       dw(values*(j - 1) + 1:values*j), m(j), window, gradient)
      end do
      nb = 0
    end do
  end subroutine sum_gradients

  !> Whether a stencil has a node in a window.
  pure function reaches(stencil, dim, base, window) result(does)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Dimensions.
    integer, intent(in) :: dim
    !> First node.
    integer, intent(in) :: base(3)
    !> The window.
    type(window_t), intent(in) :: window
    !> Whether it has.
    logical :: does

    does = all(base(:dim) + stencil%width > window%lo(:dim) .and. &
               base(:dim) < window%lo(:dim) + window%n(:dim))
  end function reaches

  !> Add one point to the nodes of its stencil that are in the window.
  pure subroutine add_point(width, dim, base, w, dw, mass, window, gradient)
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> First node.
    integer, intent(in) :: base(3)
    !> Values of the 1D functions.
    real(wp), intent(in) :: w(width, dim)
    !> Their derivatives. [1/m]
    real(wp), intent(in) :: dw(width, dim)
    !> Mass of the point. [kg]
    real(wp), intent(in) :: mass
    !> Window of the gradients.
    type(window_t), intent(in) :: window
    !> Gradients, added to. [kg/m]
    real(wp), intent(inout) :: gradient(:, :)
    ! Of a fixed size: arrays of a size known at run time alone may be allocated.
    real(wp) :: value(most_nodes, 3), slope(most_nodes, 3)
    integer :: first(3), last(3), i, j, k, start, position

    ! Unused directions have one function, 1.
    value(1, :) = 1.0_wp
    value(:width, :dim) = w
    slope(:width, :dim) = dw
    first = max(1, window%lo - base + 1)
    last = min(width, window%lo + window%n - base)
    last(dim + 1:) = 1
    start = window%start(base)
    do k = first(3), last(3)
      do j = first(2), last(2)
        do i = first(1), last(1)
          position = start + i + window%n(1)*(j - 1 + window%n(2)*(k - 1))
          gradient(1, position) = gradient(1, position) &
                                  + mass*slope(i, 1)*value(j, 2)*value(k, 3)
          if (dim < 2) cycle
          gradient(2, position) = gradient(2, position) &
                                  + mass*slope(j, 2)*value(i, 1)*value(k, 3)
          if (dim < 3) cycle
          gradient(3, position) = gradient(3, position) &
                                  + mass*slope(k, 3)*value(i, 1)*value(j, 2)
        end do
      end do
    end do
  end subroutine add_point

end module mpm_mass_gradient
