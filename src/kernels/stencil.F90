!> One-dimensional stencils of tensor-product bases on Cartesian grids.
!!
!! Every basis on a Cartesian grid is a product of 1D functions. Per point and direction a stencil
!! gives the first node and the values and derivatives of the functions of `width` nodes; the
!! kernels multiply them. The bases, with the nodes that a point reaches:
!!
!! - `basis_hat`: piecewise linear, 2;
!! - `basis_box`: hats averaged over a box of half width lambda h, lambda <= 1/2, 3. This is uGIMP,
!!   and with lambda = 1/2 the quadratic B-spline;
!! - `basis_cubic`: cubic B-splines, 4;
!! - any of them corner-averaged (`cpdi` flag 1 of mpm_3d): the mean of the functions at x + a and
!!   x - a, and their difference over 2a as derivative, with a = half of the point's half side. One
!!   node more while a <= h/2, for hats two while a <= h. When any corner of the point's box lies
!!   outside the grid, the point uses the functions at its own position.
!!
!! Box and cubic functions reach beyond a wall; the node behind it has the linearly extrapolated
!! value v(-1) = 2 v(0) - v(1), and its function is folded into those of nodes 0 and 1. So linear
!! fields are reproduced up to the wall, where the wall node has weight 1.
!!
!! In periodic directions of N cells node N is node 0. The first node of a stencil is taken from
!! 0 ... N - 1, and the stencil runs on beyond node N; `mpm_seam` brings together what belongs to
!! one node.
!!
!! A point on a node line belongs to the cell above it, a point on the upper face to the last cell,
!! so that the one-sided derivative of one cell is used everywhere. The far node of that cell, whose
!! function vanishes at the point but whose derivative does not, is given a weight of a few
!! roundings, so that it has a velocity also when no other point reaches it.
module mpm_stencil
  use mpm_kinds, only: wp
  use mpm_mesh, only: mesh_t
  implicit none
  private
  public :: stencil_t
  public :: axis_fraction, block_size, decode_keys, hat_coordinates, outside, stencil_keys
  public :: stencil_weights, weights_of_points
  public :: basis_box, basis_cubic, basis_hat, natural_width, period_shift

  !> Points treated together by the kernels; their scratch fits the first-level cache.
  integer, parameter :: block_size = 128
  !> TYPE 4: below this fraction of the spacing from the axis, 1/r is replaced by its limit there.
  real(wp), parameter :: axis_fraction = 1.0e-3_wp
  !> Key of a point outside the grid.
  integer, parameter :: outside = -1
  !> Hat functions.
  integer, parameter :: basis_hat = 1
  !> Hats averaged over a box: quadratic B-splines and uGIMP.
  integer, parameter :: basis_box = 2
  !> Cubic B-splines.
  integer, parameter :: basis_cubic = 3
  !> Nodes per direction that the functions of a basis have at a point.
  integer, parameter :: natural_width(3) = [2, 3, 4]
  !> Distance in cells by which the first node lies below the cell of the point.
  real(wp), parameter :: reach(3) = [0.0_wp, 0.5_wp, 1.0_wp]
  !> 1/6, of the cubic splines.
  real(wp), parameter :: sixth = 1.0_wp/6.0_wp
  !> Distance from a node, in cells, at which points of a wall cell are kept.
  real(wp), parameter :: few = 4.0_wp*epsilon(1.0_wp)

  !> What the kernels need to know of grid and basis.
  type :: stencil_t
    !> Dimensions of the grid.
    integer :: dim = 3
    !> Nodes per direction: 2, 3, 4 or 5.
    integer :: width = 2
    !> One of `basis_hat`, `basis_box`, `basis_cubic`.
    integer :: kind = basis_hat
    !> Corner-averaged instead of the functions themselves.
    logical :: averaged = .false.
    !> `basis_box`: half width of the box over the spacing, above 0, at most 1/2.
    real(wp) :: lambda(3) = 0.5_wp
    !> Directions in which the grid repeats.
    logical :: periodic(3) = .false.
    !> Slopes of the best affine fit in place of the functions' derivatives.
    logical :: fitted = .false.
    !> Lower corner of the grid. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Spacing of the nodes. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Cells in each direction; 0 in unused ones.
    integer :: n_cells(3) = 0
    !> The mesh of a grid that is not Cartesian, whose functions are no products: points have lists
    !! of nodes there (`mpm_node_list`), and the key of a point is its cell. Then `h` is the least
    !! height of a cell and `n_cells` is 0.
    type(mesh_t), allocatable :: mesh
  contains
    !> Whether points must be treated by the general routines.
    procedure, private :: general => stencil_general
    !> First node of the functions at a coordinate.
    procedure, private :: first_node => stencil_first_node
  end type stencil_t

contains

  !> Keys of points: the flattened grid index of the first node of the stencil, or `outside`.
  pure subroutine stencil_keys(stencil, n, x, extent, key, guess)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(stencil%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> b_x + (N_x + 1) (b_y + (N_y + 1) b_z); on a mesh the cell, from 1. (n)
    integer, intent(out) :: key(n)
    !> Keys that are likely; saves time on a mesh. (n)
    integer, intent(in), optional :: guess(n)

    if (allocated(stencil%mesh)) then
      key = outside
      if (present(guess)) key = guess
      call stencil%mesh%locate(n, x, key)
      return
    end if
    if (any(stencil%periodic)) then
      call general_keys(stencil, n, x, extent, key)
      return
    end if
    select case (stencil%dim)
    case (1)
      if (stencil%averaged) then
        call averaged_keys_1d(stencil, n, x, extent, key)
      else
        call keys_1d(stencil, n, x, key)
      end if
    case (2)
      if (stencil%averaged) then
        call averaged_keys_2d(stencil, n, x, extent, key)
      else
        call keys_2d(stencil, n, x, key)
      end if
    case default
      if (stencil%averaged) then
        call averaged_keys_3d(stencil, n, x, extent, key)
      else
        call keys_3d(stencil, n, x, key)
      end if
    end select
  end subroutine stencil_keys

  !> Whether a basis is neither hats nor their averages between walls.
  pure function stencil_general(self) result(general)
    !> Basis.
    class(stencil_t), intent(in) :: self
    !> Whether it is.
    logical :: general

    general = self%kind /= basis_hat .or. any(self%periodic)
  end function stencil_general

  !> First node of the functions at a coordinate, for stencils of so many nodes; between walls the
  !! stencil is kept inside the grid, in periodic directions the index may be negative.
  elemental function stencil_first_node(self, d, width, s) result(first)
    !> Basis.
    class(stencil_t), intent(in) :: self
    !> Direction.
    integer, intent(in) :: d
    !> Nodes of the stencil.
    integer, intent(in) :: width
    !> Coordinate in cells.
    real(wp), intent(in) :: s
    !> Index of the node.
    integer :: first

    first = floor(s - reach(self%kind))
    if (self%periodic(d)) return
    first = max(0, min(first, self%n_cells(d) + 1 - width))
  end function stencil_first_node

  !> Keys of points of any basis, also in periodic directions.
  pure subroutine general_keys(stencil, n, x, extent, key)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions; within the box also in periodic directions. [m] (dim, n)
    real(wp), intent(in) :: x(stencil%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> As of `stencil_keys`. (n)
    integer, intent(out) :: key(n)
    real(wp) :: inverse_h(3), s(3), a(3)
    integer :: stride(3), p, d, b
    logical :: averaged

    inverse_h = 1.0_wp/stencil%h
    stride = [1, stencil%n_cells(1) + 1, (stencil%n_cells(1) + 1)*(stencil%n_cells(2) + 1)]
    do p = 1, n
      key(p) = outside
      do d = 1, stencil%dim
        s(d) = (x(d, p) - stencil%lower(d))*inverse_h(d)
        if (.not. (s(d) >= 0.0_wp .and. s(d) <= real(stencil%n_cells(d), wp))) exit
      end do
      if (d <= stencil%dim) cycle
      call corner_distance(stencil, s, extent(p)*inverse_h, a, averaged)
      key(p) = 0
      do d = 1, stencil%dim
        b = stencil%first_node(d, stencil%width, s(d) - a(d))
        if (stencil%periodic(d)) b = modulo(b, stencil%n_cells(d))
        key(p) = key(p) + stride(d)*b
      end do
    end do
  end subroutine general_keys

  !> Distance of the corners over which the functions of a point are averaged.
  pure subroutine corner_distance(stencil, s, extent, a, averaged)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Position in cells.
    real(wp), intent(in) :: s(3)
    !> Half side of the point's box in cells.
    real(wp), intent(in) :: extent(3)
    !> Distances in cells; 0 when the functions at the point itself count.
    real(wp), intent(out) :: a(3)
    !> Whether the functions are averaged.
    logical, intent(out) :: averaged
    integer :: d

    a = 0.0_wp
    averaged = stencil%averaged
    if (.not. averaged) return
    do d = 1, stencil%dim
      if (stencil%periodic(d)) cycle
      ! Written so that fused operations round as others do: keys and weights must agree.
      averaged = averaged .and. s(d) >= 0.5_wp*extent(d) &
                 .and. s(d) <= real(stencil%n_cells(d), wp) - 0.5_wp*extent(d)
    end do
    if (averaged) a(:stencil%dim) = 0.5_wp*extent(:stencil%dim)
  end subroutine corner_distance

  !> First nodes of the stencils of points from their keys.
  pure subroutine decode_keys(stencil, n, key, base)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Keys, none of them `outside`. (n)
    integer, intent(in) :: key(n)
    !> Grid indices of the first node, from 0; unused directions are 0. (3, n)
    integer, intent(out) :: base(3, n)
    integer :: p, row, previous, b(3)

    if (stencil%dim == 1) then
      do p = 1, n
        base(1, p) = key(p)
        base(2, p) = 0
        base(3, p) = 0
      end do
      return
    end if
    ! The points of a cell follow each other.
    previous = outside
    b = 0
    do p = 1, n
      if (key(p) /= previous) then
        previous = key(p)
        row = previous/(stencil%n_cells(1) + 1)
        b(1) = previous - row*(stencil%n_cells(1) + 1)
        b(3) = row/(stencil%n_cells(2) + 1)
        b(2) = row - b(3)*(stencil%n_cells(2) + 1)
      end if
      base(:, p) = b
    end do
  end subroutine decode_keys

  !> Coordinates of points in their cells: all that hat functions need.
  !!
  !! The lower node of a direction has the value 1 - xi, the upper one xi.
  pure subroutine hat_coordinates(stencil, dim, n, x, n_max, xi)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Dimensions of the grid.
    integer, intent(in) :: dim
    !> Number of points.
    integer, intent(in) :: n
    !> Positions, inside the grid. [m] (dim, n)
    real(wp), intent(in) :: x(dim, n)
    !> Rows of `xi`.
    integer, intent(in) :: n_max
    !> Coordinates in the cell, neither 0 nor 1. (n_max, dim)
    real(wp), intent(inout) :: xi(n_max, dim)
    real(wp) :: inverse_h, lower, s, last
    integer :: p, d

    do d = 1, dim
      inverse_h = 1.0_wp/stencil%h(d)
      lower = stencil%lower(d)
      ! A point on the upper face belongs to the last cell, in periodic directions to the first one.
      last = merge(huge(1.0_wp), real(stencil%n_cells(d) - 1, wp), stencil%periodic(d))
      do p = 1, n
        s = (x(d, p) - lower)*inverse_h
        xi(p, d) = off_node(s - min(real(int(s), wp), last))
      end do
    end do
  end subroutine hat_coordinates

  !> Values and derivatives of the 1D functions at points.
  pure subroutine stencil_weights(stencil, n, x, extent, base, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(*)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> First nodes, as of `decode_keys`. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (width, dim, n)
    real(wp), intent(inout) :: w(*)
    !> Derivatives. [1/m] (width, dim, n)
    real(wp), intent(inout) :: dw(*)
    real(wp) :: value(block_size*stencil%width*stencil%dim)
    real(wp) :: slope(block_size*stencil%width*stencil%dim)

    if (stencil%width == 2) then
      call hat_weights(stencil, stencil%dim, n, x, w, dw)
    else if (stencil%averaged .and. stencil%general() .and. .not. stencil%fitted) then
      call averaged_weights(stencil, n, x, extent, base, w, dw)
    else
      call weights_of_points(stencil, n, x, extent, base, value, slope)
      call turn(stencil%width*stencil%dim, n, value, w)
      call turn(stencil%width*stencil%dim, n, slope, dw)
    end if
  end subroutine stencil_weights

  !> Values and derivatives of hats, from the coordinates that P2G and G2P use: mass and momentum
  !! of a node must be sums with the same functions.
  pure subroutine hat_weights(stencil, dim, n, x, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Dimensions of the grid.
    integer, intent(in) :: dim
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(dim, n)
    !> Values. (2, dim, n)
    real(wp), intent(out) :: w(2, dim, n)
    !> Derivatives. [1/m] (2, dim, n)
    real(wp), intent(out) :: dw(2, dim, n)
    real(wp) :: xi(n, dim)
    integer :: p, d

    call hat_coordinates(stencil, dim, n, x, n, xi)
    do p = 1, n
      do d = 1, dim
        w(1, d, p) = 1.0_wp - xi(p, d)
        w(2, d, p) = xi(p, d)
        dw(1, d, p) = -1.0_wp/stencil%h(d)
        dw(2, d, p) = 1.0_wp/stencil%h(d)
      end do
    end do
  end subroutine hat_weights

  !> Make the first dimension the last one.
  pure subroutine turn(n_values, n, values, turned)
    !> Values of a point.
    integer, intent(in) :: n_values
    !> Number of points.
    integer, intent(in) :: n
    !> Values. (block_size, n_values)
    real(wp), intent(in) :: values(block_size, n_values)
    !> The same. (n_values, n)
    real(wp), intent(out) :: turned(n_values, n)
    integer :: p

    ! Gather instructions are slower than loads.
    !GCC$ novector
    do p = 1, n
      turned(:, p) = values(p, :)
    end do
  end subroutine turn

  !> Values and derivatives of more than two functions, the points first.
  pure subroutine many_weights(stencil, n, x, extent, base, w, dw)
    !> Basis, neither averages of smooth or periodic functions nor fitted.
    type(stencil_t), intent(in) :: stencil
    !> Number of points, at most `block_size`.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(*)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> First nodes. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (block_size, width, dim)
    real(wp), intent(inout) :: w(*)
    !> Derivatives. [1/m] (block_size, width, dim)
    real(wp), intent(inout) :: dw(*)

    select case (10*stencil%dim + stencil%width)
    case (13)
      call weights_1d_3(stencil, n, x, extent, base, w, dw)
    case (14)
      call weights_1d_4(stencil, n, x, extent, base, w, dw)
    case (23)
      call weights_2d_3(stencil, n, x, extent, base, w, dw)
    case (24)
      call weights_2d_4(stencil, n, x, extent, base, w, dw)
    case (33)
      call weights_3d_3(stencil, n, x, extent, base, w, dw)
    case (34)
      call weights_3d_4(stencil, n, x, extent, base, w, dw)
    end select
  end subroutine many_weights

  !> Values and derivatives of the functions of three nodes and more, the points first.
  pure subroutine weights_of_points(stencil, n, x, extent, base, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points, at most `block_size`.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(*)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> First nodes, as of `decode_keys`. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (block_size, width, dim)
    real(wp), intent(inout) :: w(block_size, stencil%width*stencil%dim)
    !> Derivatives. [1/m] (block_size, width, dim)
    real(wp), intent(inout) :: dw(block_size, stencil%width*stencil%dim)
    real(wp) :: value(stencil%width*stencil%dim, n), slope(stencil%width*stencil%dim, n)
    integer :: p

    if (stencil%averaged .and. stencil%general()) then
      call averaged_weights(stencil, n, x, extent, base, value, slope)
      do p = 1, n
        w(p, :) = value(:, p)
        dw(p, :) = slope(:, p)
      end do
    else
      call many_weights(stencil, n, x, extent, base, w, dw)
    end if
    if (stencil%fitted) then
      call fitted_slopes(stencil, stencil%width, stencil%dim, n, x, base, w, dw)
    end if
  end subroutine weights_of_points

  !> The period that lies between the stored position of a point and the nodes of its stencil.
  !!
  !! A stencil that begins below the lower face of a periodic direction is kept at its image at the
  !! upper end, a period away from the point.
  elemental function period_shift(stencil, d, x, first) result(shift)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction.
    integer, intent(in) :: d
    !> Position in this direction. [m]
    real(wp), intent(in) :: x
    !> First node of the stencil.
    integer, intent(in) :: first
    !> What brings the point to its stencil when added to x. [m]
    real(wp) :: shift

    shift = 0.0_wp
    if (.not. stencil%periodic(d)) return
    ! Otherwise the point lies above the first node, but for roundings.
    if ((x - stencil%lower(d))/stencil%h(d) < real(first, wp) - 0.25_wp) then
      shift = real(stencil%n_cells(d), wp)*stencil%h(d)
    end if
  end function period_shift

  !> Replace derivatives by the weights of the best affine fit, w r/sum(w r**2) in each direction.
  !!
  !! r is the distance of a node from the weighted mean of the nodes, which is the point itself for
  !! functions that reproduce positions. Of hats the fit is the derivative, which stays where the
  !! point is so close to a node that the quotient is of roundings.
  pure subroutine fitted_slopes(stencil, width, dim, n, x, base, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(dim, n)
    !> First nodes. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (block_size, width, dim)
    real(wp), intent(in) :: w(block_size, width, dim)
    !> Derivatives, then slopes of the fit. [1/m] (block_size, width, dim)
    real(wp), intent(inout) :: dw(block_size, width, dim)
    real(wp), parameter :: least = 1.0e-3_wp
    real(wp) :: s(block_size), mean(block_size), spread(block_size), factor
    integer :: p, d, j

    do d = 1, dim
      do p = 1, n
        s(p) = x(d, p) + period_shift(stencil, d, x(d, p), base(d, p))
        s(p) = (s(p) - stencil%lower(d))/stencil%h(d) - real(base(d, p) - 1, wp)
      end do
      mean(:n) = 0.0_wp
      do j = 1, width
        do p = 1, n
          mean(p) = mean(p) + w(p, j, d)*(real(j, wp) - s(p))
        end do
      end do
      s(:n) = s(:n) + mean(:n)
      spread(:n) = 0.0_wp
      do j = 1, width
        do p = 1, n
          spread(p) = spread(p) + w(p, j, d)*(real(j, wp) - s(p))**2
        end do
      end do
      do j = 1, width
        do p = 1, n
          factor = 1.0_wp/(max(least, spread(p))*stencil%h(d))
          if (spread(p) > least) dw(p, j, d) = w(p, j, d)*(real(j, wp) - s(p))*factor
        end do
      end do
    end do
  end subroutine fitted_slopes

  !> Keep a local coordinate of a cell a few roundings away from both its nodes.
  elemental function off_node(xi) result(inside)
    !> Coordinate in the cell, 0 to 1.
    real(wp), intent(in) :: xi
    !> The coordinate, but neither 0 nor 1.
    real(wp) :: inside

    inside = max(few, min(1.0_wp - few, xi))
  end function off_node

  !> Hat functions of the point's cell, placed in a wider stencil.
  pure subroutine cell_weights(width, dim, s, base, n_cells, inverse_h, w, dw)
    !> Nodes per direction.
    integer, intent(in) :: width
    !> Dimensions.
    integer, intent(in) :: dim
    !> Position in cells.
    real(wp), intent(in) :: s(dim)
    !> First node.
    integer, intent(in) :: base(3)
    !> Cells of the grid.
    integer, intent(in) :: n_cells(3)
    !> One over the spacing. [1/m]
    real(wp), intent(in) :: inverse_h(3)
    !> Values. (width, dim)
    real(wp), intent(out) :: w(width, dim)
    !> Derivatives. [1/m] (width, dim)
    real(wp), intent(out) :: dw(width, dim)
    real(wp) :: xi
    integer :: d, cell, j

    w = 0.0_wp
    dw = 0.0_wp
    do d = 1, dim
      cell = min(int(s(d)), n_cells(d) - 1)
      xi = off_node(s(d) - real(cell, wp))
      j = cell - base(d) + 1
      w(j, d) = 1.0_wp - xi
      w(j + 1, d) = xi
      dw(j, d) = -inverse_h(d)
      dw(j + 1, d) = inverse_h(d)
    end do
  end subroutine cell_weights

  !> Functions of three nodes: hats averaged over a box.
  !!
  !! With the nodes at -1, 0, 1 and |t| <= 1/2 this is the mean of the hats over t - lambda ...
  !! t + lambda. Beyond, it goes on as the hats, which is what folding the node behind a wall gives
  !! for the half cell next to the wall.
  pure subroutine box_functions(t, lambda, value, slope)
    !> Coordinate in cells from the middle node, -1 to 1.
    real(wp), intent(in) :: t
    !> Half width of the box in cells.
    real(wp), intent(in) :: lambda
    !> Values.
    real(wp), intent(out) :: value(3)
    !> Derivatives with respect to the coordinate in cells.
    real(wp), intent(out) :: slope(3)
    real(wp) :: u, c, quarter

    u = max(few - 1.0_wp, min(1.0_wp - few, t))
    c = max(-lambda, min(lambda, u))
    quarter = 0.25_wp/lambda
    value(1) = quarter*(lambda - c)**2 + max(0.0_wp, c - u)
    value(3) = quarter*(lambda + c)**2 + max(0.0_wp, u - c)
    value(2) = 1.0_wp - (value(1) + value(3))
    slope(1) = -2.0_wp*quarter*(lambda - c)
    slope(3) = 2.0_wp*quarter*(lambda + c)
    slope(2) = -(slope(1) + slope(3))
  end subroutine box_functions

  !> Functions of four nodes: cubic B-splines, in the first and last cell between walls folded.
  pure subroutine cubic_functions(s, base, n_cells, periodic, value, slope)
    !> Coordinate in cells.
    real(wp), intent(in) :: s
    !> First of the nodes.
    integer, intent(in) :: base
    !> Cells of the grid in this direction.
    integer, intent(in) :: n_cells
    !> Whether the direction is periodic.
    logical, intent(in) :: periodic
    !> Values.
    real(wp), intent(out) :: value(4)
    !> Derivatives with respect to the coordinate in cells.
    real(wp), intent(out) :: slope(4)
    real(wp), parameter :: third = 1.0_wp/3.0_wp
    real(wp) :: t, u

    if (.not. periodic .and. base == 0 .and. s < 1.0_wp) then
      t = max(few, s)
      value = [1.0_wp - t + sixth*t**3, t - third*t**3, sixth*t**3, 0.0_wp]
      slope = [0.5_wp*t*t - 1.0_wp, 1.0_wp - t*t, 0.5_wp*t*t, 0.0_wp]
    else if (.not. periodic .and. base == n_cells - 3 .and. s >= real(n_cells - 1, wp)) then
      u = max(few, real(n_cells, wp) - s)
      value = [0.0_wp, sixth*u**3, u - third*u**3, 1.0_wp - u + sixth*u**3]
      slope = [0.0_wp, -0.5_wp*u*u, u*u - 1.0_wp, 1.0_wp - 0.5_wp*u*u]
    else
      t = s - real(base + 1, wp)
      u = 1.0_wp - t
      value(1) = sixth*u**3
      value(2) = 2.0_wp*third - t*t*(1.0_wp - 0.5_wp*t)
      value(3) = 2.0_wp*third - u*u*(1.0_wp - 0.5_wp*u)
      value(4) = sixth*t**3
      slope(1) = -0.5_wp*u*u
      slope(2) = t*(1.5_wp*t - 2.0_wp)
      slope(3) = -u*(1.5_wp*u - 2.0_wp)
      slope(4) = 0.5_wp*t*t
    end if
  end subroutine cubic_functions

  !> Values and derivatives of any basis, corner-averaged.
  pure subroutine averaged_weights(stencil, n, x, extent, base, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(stencil%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> First nodes. (3, n)
    integer, intent(in) :: base(3, n)
    !> Values. (width, dim, n)
    real(wp), intent(out) :: w(stencil%width, stencil%dim, n)
    !> Derivatives. [1/m] (width, dim, n)
    real(wp), intent(out) :: dw(stencil%width, stencil%dim, n)
    real(wp) :: inverse_h(3), s(3), a(3), slope
    integer :: p, d
    logical :: averaged

    inverse_h = 1.0_wp/stencil%h
    w = 0.0_wp
    dw = 0.0_wp
    do p = 1, n
      s(:stencil%dim) = (x(:, p) - stencil%lower(:stencil%dim))*inverse_h(:stencil%dim)
      call corner_distance(stencil, s, extent(p)*inverse_h, a, averaged)
      slope = 1.0_wp/extent(p)
      do d = 1, stencil%dim
        if (averaged) then
          call add_functions(stencil, d, s(d) - a(d), base(d, p), 0.5_wp, -slope, 0.0_wp, &
                             w(:, d, p), dw(:, d, p))
          call add_functions(stencil, d, s(d) + a(d), base(d, p), 0.5_wp, slope, 0.0_wp, &
                             w(:, d, p), dw(:, d, p))
        else
          call add_functions(stencil, d, s(d), base(d, p), 1.0_wp, 0.0_wp, inverse_h(d), &
                             w(:, d, p), dw(:, d, p))
        end if
      end do
    end do
  end subroutine averaged_weights

  !> Add the functions at a coordinate to the values and derivatives of a stencil.
  pure subroutine add_functions(stencil, d, s, first, share, value_share, slope_share, w, dw)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Direction.
    integer, intent(in) :: d
    !> Coordinate in cells.
    real(wp), intent(in) :: s
    !> First node of the stencil.
    integer, intent(in) :: first
    !> Factor of the values in `w`.
    real(wp), intent(in) :: share
    !> Factor of the values in `dw`. [1/m]
    real(wp), intent(in) :: value_share
    !> Factor of the derivatives in `dw`. [1/m]
    real(wp), intent(in) :: slope_share
    !> Values. (width)
    real(wp), intent(inout) :: w(:)
    !> Derivatives. [1/m] (width)
    real(wp), intent(inout) :: dw(:)
    real(wp) :: value(4), slope(4), c
    integer :: n, j

    n = natural_width(stencil%kind)
    c = s
    if (stencil%periodic(d)) then
      do while (c - real(first, wp) < reach(stencil%kind) - 0.25_wp)
        c = c + real(stencil%n_cells(d), wp)
      end do
    end if
    ! Rounding may put a corner into the cell next to the one that it touches.
    j = max(0, min(stencil%first_node(d, n, c) - first, size(w) - n))
    select case (stencil%kind)
    case (basis_hat)
      value(2) = off_node(c - real(first + j, wp))
      value(1) = 1.0_wp - value(2)
      slope(:2) = [-1.0_wp, 1.0_wp]
    case (basis_box)
      call box_functions(c - real(first + j + 1, wp), stencil%lambda(d), value(:3), slope(:3))
    case default
      call cubic_functions(c, first + j, stencil%n_cells(d), stencil%periodic(d), value, slope)
    end select
    w(j + 1:j + n) = w(j + 1:j + n) + share*value(:n)
    dw(j + 1:j + n) = dw(j + 1:j + n) + value_share*value(:n) + slope_share*slope(:n)
  end subroutine add_functions

#define DIM 1
#define NAME keys_1d
#include "keys_template.inc"
#undef NAME
#define NAME averaged_keys_1d
#define AVERAGED
#include "keys_template.inc"
#undef NAME
#undef AVERAGED
#undef DIM
#define DIM 2
#define NAME keys_2d
#include "keys_template.inc"
#undef NAME
#define NAME averaged_keys_2d
#define AVERAGED
#include "keys_template.inc"
#undef NAME
#undef AVERAGED
#undef DIM
#define DIM 3
#define NAME keys_3d
#include "keys_template.inc"
#undef NAME
#define NAME averaged_keys_3d
#define AVERAGED
#include "keys_template.inc"
#undef NAME
#undef AVERAGED
#undef DIM
#define DIM 1
#define NAME weights_1d_3
#define WIDTH 3
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_1d_4
#define WIDTH 4
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#define DIM 2
#define NAME weights_2d_3
#define WIDTH 3
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_2d_4
#define WIDTH 4
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#define DIM 3
#define NAME weights_3d_3
#define WIDTH 3
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#define NAME weights_3d_4
#define WIDTH 4
#include "weights_template.inc"
#undef NAME
#undef WIDTH
#undef DIM

end module mpm_stencil
