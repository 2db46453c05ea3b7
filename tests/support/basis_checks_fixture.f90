!> What the functions of a basis must fulfil, along one line of cells of a grid.
module mpm_basis_checks_fixture
  use mpm_kinds, only: wp
  use mpm_random_fixture, only: random_t
  use mpm_stencil, only: basis_box, basis_cubic, decode_keys, stencil_keys, stencil_t, &
                         stencil_weights
  implicit none
  private
  public :: integrals, largest_errors, line_definition, line_functions

  !> Random points on a line, beside those on nodes and between them.
  integer, parameter :: n_random = 60

contains

  !> Functions of all nodes of a line, ghosts added to the nodes that they stand for.
  subroutine line_functions(stencil, d, s, extent, value, slope)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction of the line; it runs through the middle of the grid.
    integer, intent(in) :: d
    !> Coordinate in cells.
    real(wp), intent(in) :: s
    !> Half side of the point's box. [m]
    real(wp), intent(in) :: extent
    !> Values at the nodes 0 ... n.
    real(wp), intent(out) :: value(0:)
    !> Derivatives. [1/cell]
    real(wp), intent(out) :: slope(0:)
    real(wp) :: x(stencil%dim, 1), w(stencil%width, stencil%dim), dw(stencil%width, stencil%dim)
    integer :: key(1), base(3, 1), j, node

    associate (dim => stencil%dim)
      x(:, 1) = stencil%lower(:dim) + 0.5_wp*stencil%n_cells(:dim)*stencil%h(:dim)
    end associate
    x(d, 1) = stencil%lower(d) + s*stencil%h(d)
    call stencil_keys(stencil, 1, x, [extent], key)
    call decode_keys(stencil, 1, key, base)
    call stencil_weights(stencil, 1, x, [extent], base, w, dw)
    value = 0.0_wp
    slope = 0.0_wp
    do j = 1, stencil%width
      node = base(d, 1) + j - 1
      if (stencil%periodic(d)) node = modulo(node, stencil%n_cells(d))
      if (node > stencil%n_cells(d)) cycle
      value(node) = value(node) + w(j, d)
      slope(node) = slope(node) + dw(j, d)*stencil%h(d)
    end do
  end subroutine line_functions

  !> The function of a node by its definition: a spline, with the node behind a wall folded in, or
  !! the sum over all periods.
  pure function line_definition(stencil, d, node, s) result(value)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction.
    integer, intent(in) :: d
    !> Index of the node, from 0.
    integer, intent(in) :: node
    !> Coordinate in cells.
    real(wp), intent(in) :: s
    !> The value.
    real(wp) :: value
    integer :: n, period

    n = stencil%n_cells(d)
    associate (kind => stencil%kind, lambda => stencil%lambda(d))
      if (stencil%periodic(d)) then
        value = 0.0_wp
        if (node == n) return
        do period = -4, 4
          value = value + spline(kind, lambda, s - real(node + period*n, wp))
        end do
      else
        value = spline(kind, lambda, s - real(node, wp))
        if (node == 0) value = value + 2.0_wp*spline(kind, lambda, s + 1.0_wp)
        if (node == 1) value = value - spline(kind, lambda, s + 1.0_wp)
        if (node == n - 1) value = value - spline(kind, lambda, s - real(n + 1, wp))
        if (node == n) value = value + 2.0_wp*spline(kind, lambda, s - real(n + 1, wp))
      end if
    end associate
  end function line_definition

  !> The function of a node far from walls.
  pure function spline(kind, lambda, xi) result(value)
    !> One of the `basis_*`.
    integer, intent(in) :: kind
    !> Half width of the box in cells.
    real(wp), intent(in) :: lambda
    !> Coordinate from the node in cells.
    real(wp), intent(in) :: xi
    !> The value.
    real(wp) :: value
    real(wp) :: r

    r = abs(xi)
    value = 0.0_wp
    select case (kind)
    case (basis_cubic)
      if (r <= 1.0_wp) then
        value = 2.0_wp/3.0_wp - r**2 + 0.5_wp*r**3
      else if (r < 2.0_wp) then
        value = (2.0_wp - r)**3/6.0_wp
      end if
    case (basis_box)
      if (r <= lambda) then
        value = 1.0_wp - (r**2 + lambda**2)/(2.0_wp*lambda)
      else if (r <= 1.0_wp - lambda) then
        value = 1.0_wp - r
      else if (r < 1.0_wp + lambda) then
        value = (1.0_wp + lambda - r)**2/(4.0_wp*lambda)
      end if
    case default
      value = max(0.0_wp, 1.0_wp - r)
    end select
  end function spline

  !> Largest errors over random points, nodes and middles of cells of a line.
  subroutine largest_errors(stencil, d, extent, errors)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction.
    integer, intent(in) :: d
    !> Half side of the points' boxes; counts when the basis is averaged. [m]
    real(wp), intent(in) :: extent
    !> Sum of values less 1; sum of slopes; position; slope of the position less 1; values against
    !! their definition; slopes against finite differences.
    real(wp), intent(out) :: errors(6)
    type(random_t) :: random
    real(wp) :: s(n_random + 2*stencil%n_cells(d) + 3), found(6)
    integer :: i, n

    n = stencil%n_cells(d)
    ! Not nearer to the ends than the finite differences reach.
    call random%fill(1.0e-5_wp, n - 1.0e-5_wp, s(:n_random))
    do i = 0, 2*n
      s(n_random + 1 + i) = 0.5_wp*i
    end do
    ! The seam from below, and what a periodic grid does not have, its last face.
    s(size(s) - 1) = n - 1.0e-12_wp
    s(size(s)) = n
    if (stencil%periodic(d)) s(n_random + 1 + 2*n:) = n - 1.0e-12_wp
    errors = 0.0_wp
    do i = 1, size(s)
      call errors_at(stencil, d, s(i), extent, found)
      if (i > n_random) found(6) = 0.0_wp
      errors = max(errors, found)
    end do
  end subroutine largest_errors

  !> Errors at one point.
  subroutine errors_at(stencil, d, s, extent, errors)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction.
    integer, intent(in) :: d
    !> Coordinate in cells.
    real(wp), intent(in) :: s
    !> Half side of the point's box. [m]
    real(wp), intent(in) :: extent
    !> As of `largest_errors`.
    real(wp), intent(out) :: errors(6)
    real(wp), parameter :: step = 1.0e-6_wp
    real(wp), dimension(0:stencil%n_cells(d)) :: value, slope, above, below, unused, distance
    integer :: i, n

    n = stencil%n_cells(d)
    call line_functions(stencil, d, s, extent, value, slope)
    do i = 0, n
      distance(i) = real(i, wp) - s
      ! The nearest image; stencils are narrower than half of the periods checked.
      if (stencil%periodic(d)) distance(i) = distance(i) - n*anint(distance(i)/n)
    end do
    errors(1) = abs(sum(value) - 1.0_wp)
    errors(2) = abs(sum(slope))
    errors(3) = abs(sum(value*distance))
    errors(4) = abs(sum(slope*distance) - 1.0_wp)
    errors(5) = 0.0_wp
    if (.not. stencil%averaged) then
      do i = 0, n
        errors(5) = max(errors(5), abs(value(i) - line_definition(stencil, d, i, s)))
      end do
    end if
    errors(6) = 0.0_wp
    if (s <= step .or. s >= n - step) return
    call line_functions(stencil, d, s + step, extent, above, unused)
    call line_functions(stencil, d, s - step, extent, below, unused)
    errors(6) = maxval(abs(slope - (above - below)/(2.0_wp*step)))
  end subroutine errors_at

  !> Integrals of the functions of all nodes, and of the distances from their nodes.
  subroutine integrals(stencil, d, integral, moment)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction.
    integer, intent(in) :: d
    !> Integrals in cells. (0:n)
    real(wp), intent(out) :: integral(0:)
    !> First moments in cells squared; of nodes at a periodic seam they have no meaning. (0:n)
    real(wp), intent(out) :: moment(0:)
    real(wp), dimension(0:ubound(integral, 1)) :: value, slope
    real(wp) :: breaks(5), middle, half, s
    real(wp), parameter :: point(3) = [-0.7745966692414834_wp, 0.0_wp, 0.7745966692414834_wp]
    real(wp), parameter :: weight(3) = [5.0_wp, 8.0_wp, 5.0_wp]/9.0_wp
    integer :: cell, part, i, q

    integral = 0.0_wp
    moment = 0.0_wp
    ! Three Gauss points are exact for polynomials of degree 5; these are their ends.
    breaks = [0.0_wp, stencil%lambda(d), 0.5_wp, 1.0_wp - stencil%lambda(d), 1.0_wp]
    do cell = 0, stencil%n_cells(d) - 1
      do part = 1, 4
        middle = cell + 0.5_wp*(breaks(part) + breaks(part + 1))
        half = 0.5_wp*(breaks(part + 1) - breaks(part))
        do q = 1, 3
          s = middle + half*point(q)
          call line_functions(stencil, d, s, 0.1_wp*stencil%h(d), value, slope)
          do i = 0, ubound(integral, 1)
            integral(i) = integral(i) + half*weight(q)*value(i)
            moment(i) = moment(i) + half*weight(q)*value(i)*(s - i)
          end do
        end do
      end do
    end do
  end subroutine integrals

end module mpm_basis_checks_fixture
