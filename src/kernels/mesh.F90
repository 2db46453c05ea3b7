!> Meshes of simplices with linear functions: lines, triangles or tetrahedra.
!!
!! In a cell with the nodes 0 ... dim, N_k(x) = g_k . (x - x_0) for k > 0 and N_0 = 1 - sum N_k,
!! with gradients g_k that are the rows of the inverse of the edges from node 0. A point is in a
!! cell when no N_k is negative by more than a few roundings; of several cells the one with the
!! lowest number has it, so that a point on an edge belongs to exactly one.
!!
!! The search looks at the cells that overlap the bucket of the point. Buckets are equal boxes,
!! about as many as there are cells, so that the number of cells in one does not depend on the size
!! of the mesh. Nodes and cells are numbered bucket by bucket, the longest direction of the mesh
!! slowest, so that what is close in space is close in memory.
module mpm_mesh
  use mpm_kinds, only: lp, wp
  implicit none
  private
  public :: few, mesh_t, off_edge

  !> Largest ratio of an edge to the least height of its cell.
  real(wp), parameter :: flattest = 1.0e4_wp
  !> Most buckets for each cell.
  integer, parameter :: buckets_per_cell = 4
  !> A point with all functions above this is in the cell, and in no other one.
  real(wp), parameter :: sure = 1.0e-6_wp
  !> Least value of a function at a point of its cell, as of `mpm_stencil`.
  real(wp), parameter :: few = 4.0_wp*epsilon(1.0_wp)

  !> A mesh.
  type :: mesh_t
    !> Dimensions.
    integer :: dim = 0
    !> Number of nodes; all of them belong to cells.
    integer :: n_nodes = 0
    !> Number of cells.
    integer :: n_cells = 0
    !> Lower corner of the bounding box. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Upper corner of the bounding box. [m]
    real(wp) :: upper(3) = 0.0_wp
    !> Least height of a cell. [m]
    real(wp) :: h = 1.0_wp
    !> Speed of waves times the largest stable step of FLIP with the stress updated last. [m]
    real(wp) :: stable = 1.0_wp
    !> Positions of the nodes. [m] (dim, n_nodes)
    real(wp), allocatable :: x(:, :)
    !> Nodes of the cells, from 1. (dim + 1, n_cells)
    integer, allocatable :: node(:, :)
    !> Lowest and highest node of each cell, from 1. (2, n_cells)
    integer, allocatable :: span(:, :)
    !> Position of node 0 of each cell, then the gradients g_k. [m, 1/m] (dim, 0:dim, n_cells)
    real(wp), allocatable :: affine(:, :, :)
    !> Integrals of the functions of the nodes. [m3] (n_nodes)
    real(wp), allocatable :: volume(:)
    !> A function may be negative by this much inside its cell.
    real(wp), private :: slack = 0.0_wp
    !> Buckets in each direction.
    integer, private :: n_buckets(3) = 1
    !> Distance in memory of neighbouring buckets in each direction.
    integer, private :: stride(3) = 0
    !> One over the sides of a bucket. [1/m]
    real(wp), private :: per_length(3) = 0.0_wp
    !> Entries of `listed` up to each bucket. (0:buckets)
    integer, allocatable, private :: before(:)
    !> Cells that overlap the buckets, bucket by bucket, in ascending order.
    integer, allocatable, private :: listed(:)
  contains
    !> Number nodes and cells, and prepare the search.
    procedure :: init => mesh_init
    !> The cell of a position.
    procedure :: find => mesh_find
    !> The cells of many positions.
    procedure :: locate => mesh_locate
    !> Values of the functions of a cell.
    procedure :: values => mesh_values
    !> Whether a node lies on the bounding box, across a direction.
    procedure :: on_box => mesh_on_box
    procedure, private :: measure_box
    procedure, private :: choose_buckets
    procedure, private :: bucket_of
    procedure, private :: order_by_bucket
    procedure, private :: set_functions
    procedure, private :: fill_buckets
    procedure, private :: overlaps
  end type mesh_t

contains

  !> Number nodes and cells, and prepare the search.
  subroutine mesh_init(self, dim, x, cell, side, axisymmetric, kept, flat)
    !> The mesh.
    class(mesh_t), intent(inout) :: self
    !> Dimensions.
    integer, intent(in) :: dim
    !> Positions, of magnitudes whose cubes can be stored. [m] (at least dim, any)
    real(wp), intent(in) :: x(:, :)
    !> Nodes of the cells by their number in `x`, at least one cell. (dim + 1, n_cells)
    integer, intent(in) :: cell(:, :)
    !> Sides of the buckets; 0 to choose them. [m]
    real(wp), intent(in) :: side(3)
    !> The first coordinate is a radius.
    logical, intent(in) :: axisymmetric
    !> Number in `x` of each node of the mesh. (n_nodes)
    integer, allocatable, intent(out) :: kept(:)
    !> A cell whose edges are too long for its height, or 0; the mesh is useless then.
    integer, intent(out) :: flat
    integer, allocatable :: order(:), number(:)
    real(wp), allocatable :: centre(:, :)
    logical, allocatable :: used(:)
    integer :: i, k

    self%dim = dim
    self%n_cells = size(cell, 2)
    allocate (used(size(x, 2)), source=.false.)
    do i = 1, self%n_cells
      used(cell(:, i)) = .true.
    end do
    self%n_nodes = count(used)
    allocate (kept(self%n_nodes))
    kept(:) = pack([(i, i=1, size(used))], used)
    call self%measure_box(x(:dim, :), kept)
    call self%choose_buckets(side)
    call self%order_by_bucket(x(:dim, kept), order)
    kept = kept(order)
    self%x = x(:dim, kept)
    allocate (number(size(used)), source=0)
    number(kept) = [(i, i=1, self%n_nodes)]
    allocate (centre(dim, self%n_cells))
    do i = 1, self%n_cells
      centre(:, i) = 0.0_wp
      do k = 1, dim + 1
        centre(:, i) = centre(:, i) + x(:dim, cell(k, i))/real(dim + 1, wp)
      end do
    end do
    call self%order_by_bucket(centre, order)
    allocate (self%node(dim + 1, self%n_cells), self%span(2, self%n_cells))
    do i = 1, self%n_cells
      self%node(:, i) = number(cell(:, order(i)))
      self%span(:, i) = [minval(self%node(:, i)), maxval(self%node(:, i))]
    end do
    call self%set_functions(axisymmetric, flat)
    if (flat > 0) flat = order(flat)
    if (flat == 0) call self%fill_buckets()
  end subroutine mesh_init

  !> The box around all nodes that are used.
  subroutine measure_box(self, x, kept)
    !> The mesh.
    class(mesh_t), intent(inout) :: self
    !> Positions. [m] (dim, any)
    real(wp), intent(in) :: x(:, :)
    !> The nodes that are used. (n_nodes)
    integer, intent(in) :: kept(:)
    integer :: i

    self%lower(:self%dim) = huge(1.0_wp)
    self%upper(:self%dim) = -huge(1.0_wp)
    do i = 1, size(kept)
      self%lower(:self%dim) = min(self%lower(:self%dim), x(:, kept(i)))
      self%upper(:self%dim) = max(self%upper(:self%dim), x(:, kept(i)))
    end do
  end subroutine measure_box

  !> Choose the buckets: as large as asked for, unless there were far more of them than cells.
  subroutine choose_buckets(self, side)
    !> The mesh, with its box.
    class(mesh_t), intent(inout) :: self
    !> Sides; 0 to choose them. [m]
    real(wp), intent(in) :: side(3)
    real(wp) :: length(3), wanted(3), counts(3), most
    integer :: d, slow, axis(3)

    length = self%upper - self%lower
    most = real(buckets_per_cell, wp)*real(self%n_cells, wp)
    wanted = 1.0_wp
    associate (dim => self%dim)
      wanted(:dim) = maxval(length)/real(self%n_cells, wp)
      if (all(length(:dim) > 0.0_wp)) then
        ! Roots first: the product of the sides may be too small a number.
        wanted(:dim) = product((length(:dim)/real(self%n_cells, wp))**(1.0_wp/real(dim, wp)))
        wanted(:dim) = wanted(:dim)*real(self%n_cells, wp)**(1.0_wp - 1.0_wp/real(dim, wp))
      end if
      where (side(:dim) > 0.0_wp) wanted(:dim) = side(:dim)
      counts = 1.0_wp
      do
        do d = 1, dim
          counts(d) = 1.0_wp
          if (wanted(d) < length(d)) counts(d) = aint(min(length(d)/wanted(d), most))
        end do
        if (product(counts) <= max(1.0_wp, most)) exit
        wanted(:dim) = 1.25_wp*wanted(:dim)
      end do
    end associate
    self%n_buckets = int(counts)
    where (length > 0.0_wp) self%per_length = counts/length
    axis = [1, 2, 3]
    ! The longest direction is the slowest.
    slow = maxloc(length(:self%dim), dim=1)
    axis(self%dim) = slow
    axis(slow) = self%dim
    self%stride(axis(1)) = 1
    self%stride(axis(2)) = self%n_buckets(axis(1))
    self%stride(axis(3)) = self%n_buckets(axis(1))*self%n_buckets(axis(2))
  end subroutine choose_buckets

  !> Bucket of a position, in each direction; of positions outside the box the nearest one.
  pure function bucket_of(self, x) result(bucket)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> Position, not NaN. [m]
    real(wp), intent(in) :: x(self%dim)
    !> Bucket, from 0.
    integer :: bucket(3)
    real(wp) :: place
    integer :: d

    bucket = 0
    do d = 1, self%dim
      place = (x(d) - self%lower(d))*self%per_length(d)
      bucket(d) = int(max(0.0_wp, min(place, real(self%n_buckets(d) - 1, wp))))
    end do
  end function bucket_of

  !> Order positions by their buckets.
  subroutine order_by_bucket(self, x, order)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    !> Number of each position in the new order. (n)
    integer, allocatable, intent(out) :: order(:)
    integer, allocatable :: begin(:), bucket(:)
    integer :: i, b, total, here

    allocate (begin(0:product(self%n_buckets) - 1), source=0)
    allocate (bucket(size(x, 2)), order(size(x, 2)))
    do i = 1, size(x, 2)
      bucket(i) = sum(self%stride*self%bucket_of(x(:, i)))
      begin(bucket(i)) = begin(bucket(i)) + 1
    end do
    total = 0
    do b = 0, size(begin) - 1
      here = begin(b)
      begin(b) = total
      total = total + here
    end do
    do i = 1, size(x, 2)
      begin(bucket(i)) = begin(bucket(i)) + 1
      order(begin(bucket(i))) = i
    end do
  end subroutine order_by_bucket

  !> Set the functions of all cells, and what follows from them.
  !!
  !! The stable step: with waves of the speed c, and masses of a cell shared by its nodes in parts
  !! of at least s, no frequency is above c sqrt(sum_k |g_k|**2/s), s = 1/(dim + 1) in cells that
  !! points fill evenly. FLIP with the stress updated last is stable for w dt <= sqrt(2) whatever
  !! the points see of a mode. In TYPE 4 the nodes next to the axis have smaller shares, and N/r is
  !! a strain too, taken at the centroid.
  subroutine set_functions(self, axisymmetric, flat)
    !> The mesh, with nodes and cells.
    class(mesh_t), intent(inout) :: self
    !> The first coordinate is a radius.
    logical, intent(in) :: axisymmetric
    !> A cell that is too flat, or 0.
    integer, intent(out) :: flat
    real(wp) :: volume, steepest, worst, squares, share, radius, highest, ratio
    integer :: c

    associate (dim => self%dim)
      allocate (self%affine(dim, 0:dim, self%n_cells), self%volume(self%n_nodes))
      self%volume = 0.0_wp
      flat = 0
      worst = 0.0_wp
      highest = 0.0_wp
      squares = 0.0_wp
      do c = 1, self%n_cells
        call cell_functions(dim, self%x(:, self%node(:, c)), self%affine(:, :, c), volume, &
                            steepest, ratio)
        if (.not. ratio <= flattest) then
          flat = c
          return
        end if
        self%volume(self%node(:, c)) = self%volume(self%node(:, c)) + volume/real(dim + 1, wp)
        worst = max(worst, ratio)
        highest = max(highest, steepest)
        associate (g => self%affine(:, 1:, c))
          steepest = sum(g**2) + sum(sum(g, dim=2)**2)
        end associate
        share = 1.0_wp/real(dim + 1, wp)
        if (axisymmetric) then
          radius = sum(self%x(1, self%node(:, c)))
          steepest = steepest + real(dim + 1, wp)/radius**2
          share = (1.0_wp + minval(self%x(1, self%node(:, c)))/radius)/real(dim + 2, wp)
        end if
        squares = max(squares, steepest/share)
      end do
      self%h = 1.0_wp/highest
      self%stable = sqrt(2.0_wp/squares)
      self%slack = 32.0_wp*epsilon(1.0_wp)*worst**2
    end associate
  end subroutine set_functions

  !> The functions of one cell.
  pure subroutine cell_functions(dim, x, affine, volume, steepest, ratio)
    !> Dimensions.
    integer, intent(in) :: dim
    !> Positions of the nodes. [m]
    real(wp), intent(in) :: x(dim, 0:dim)
    !> Position of node 0, gradients of the others. [m, 1/m]
    real(wp), intent(out) :: affine(dim, 0:dim)
    !> Length, area or volume.
    real(wp), intent(out) :: volume
    !> Largest gradient: one over the least height. [1/m]
    real(wp), intent(out) :: steepest
    !> Longest edge over the least height; huge when there is no height.
    real(wp), intent(out) :: ratio
    real(wp) :: e(3, 3), longest, determinant
    integer :: k, l

    affine = 0.0_wp
    affine(:, 0) = x(:, 0)
    e = 0.0_wp
    longest = 0.0_wp
    do k = 1, dim
      e(:dim, k) = x(:, k) - x(:, 0)
      do l = 0, k - 1
        longest = max(longest, norm2(x(:, k) - x(:, l)))
      end do
    end do
    ! Missing edges are unit vectors across, so that cross products serve all dimensions.
    do k = dim + 1, 3
      e(k, k) = 1.0_wp
    end do
    determinant = dot_product(e(:, 1), cross(e(:, 2), e(:, 3)))
    volume = abs(determinant)
    if (dim > 1) volume = volume/real(dim*(dim - 1), wp)
    steepest = 0.0_wp
    ratio = huge(1.0_wp)
    if (.not. abs(determinant) > longest**dim/flattest**2) return
    do k = 1, dim
      affine(:, k) = take(dim, cross(e(:, mod(k, 3) + 1), e(:, mod(k + 1, 3) + 1)))/determinant
      steepest = max(steepest, norm2(affine(:, k)))
    end do
    steepest = max(steepest, norm2(sum(affine(:, 1:), dim=2)))
    ratio = longest*steepest
  end subroutine cell_functions

  !> The first components of a vector.
  pure function take(dim, vector) result(part)
    !> How many.
    integer, intent(in) :: dim
    !> The vector.
    real(wp), intent(in) :: vector(3)
    !> Its first components.
    real(wp) :: part(dim)

    part = vector(:dim)
  end function take

  !> Cross product.
  pure function cross(a, b) result(c)
    !> First vector.
    real(wp), intent(in) :: a(3)
    !> Second vector.
    real(wp), intent(in) :: b(3)
    !> The product.
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

  !> List the cells that overlap each bucket.
  subroutine fill_buckets(self)
    !> The mesh, with its functions.
    class(mesh_t), intent(inout) :: self
    integer, allocatable :: last(:)
    integer :: pass, c, b, i, j, k, low(3), high(3), buckets

    buckets = product(self%n_buckets)
    allocate (self%before(0:buckets), source=0)
    allocate (last(0:buckets - 1), source=0)
    do pass = 1, 2
      do c = 1, self%n_cells
        associate (corner => self%x(:, self%node(:, c)))
          low = self%bucket_of(minval(corner, dim=2))
          high = self%bucket_of(maxval(corner, dim=2))
        end associate
        do k = low(3), high(3)
          do j = low(2), high(2)
            do i = low(1), high(1)
              if (.not. self%overlaps(c, [i, j, k])) cycle
              b = sum(self%stride*[i, j, k])
              last(b) = last(b) + 1
              if (pass == 2) self%listed(last(b)) = c
            end do
          end do
        end do
      end do
      if (pass == 2) exit
      do b = 0, buckets - 1
        self%before(b + 1) = self%before(b) + last(b)
      end do
      last = self%before(:buckets - 1)
      allocate (self%listed(self%before(buckets)))
    end do
  end subroutine fill_buckets

  !> Whether a cell may overlap a bucket: none of its functions is negative all over the bucket.
  pure function overlaps(self, cell, bucket)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> The cell.
    integer, intent(in) :: cell
    !> The bucket, from 0.
    integer, intent(in) :: bucket(3)
    !> Whether it does.
    logical :: overlaps
    ! Of fixed size: others are allocated in each call.
    real(wp) :: value(0:3), centre(3), half(3), size_of(0:3), g
    integer :: d, k

    do d = 1, self%dim
      half(d) = 0.5_wp/self%per_length(d)
      centre(d) = self%lower(d) + real(2*bucket(d) + 1, wp)*half(d)
    end do
    call self%values(cell, centre, value)
    ! How much each function changes from the centre to a corner.
    size_of = 0.0_wp
    do d = 1, self%dim
      g = 0.0_wp
      do k = 1, self%dim
        g = g + self%affine(d, k, cell)
        size_of(k) = size_of(k) + abs(self%affine(d, k, cell))*half(d)
      end do
      size_of(0) = size_of(0) + abs(g)*half(d)
    end do
    ! Much more than a rounding: a cell too many does no harm.
    overlaps = all(value(:self%dim) + size_of(:self%dim) >= -sure - self%slack)
  end function overlaps

  !> The cell of a position.
  pure function mesh_find(self, x, guess) result(cell)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> Position. [m]
    real(wp), intent(in) :: x(self%dim)
    !> A cell in which it may be; any number.
    integer, intent(in), optional :: guess
    !> The cell, from 1; -1 outside of the mesh and for NaN.
    integer :: cell
    real(wp) :: value(0:3), margin
    integer :: b, i, d

    cell = -1
    margin = self%slack*self%h
    do d = 1, self%dim
      if (.not. (x(d) >= self%lower(d) - margin .and. x(d) <= self%upper(d) + margin)) return
    end do
    if (present(guess)) then
      if (guess >= 1 .and. guess <= self%n_cells) then
        call self%values(guess, x, value)
        if (minval(value(:self%dim)) > sure) then
          cell = guess
          return
        end if
      end if
    end if
    b = sum(self%stride*self%bucket_of(x))
    do i = self%before(b) + 1, self%before(b + 1)
      call self%values(self%listed(i), x, value)
      if (minval(value(:self%dim)) < -self%slack) cycle
      cell = self%listed(i)
      return
    end do
  end function mesh_find

  !> The cells of many positions.
  pure subroutine mesh_locate(self, n, x, cell)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> Number of positions.
    integer, intent(in) :: n
    !> Positions. [m]
    real(wp), intent(in) :: x(self%dim, n)
    !> On entry a guess for each, any number; then as of `find`.
    integer, intent(inout) :: cell(n)
    integer :: p

    select case (self%dim)
    case (1)
      call confirm_1d(n, x, self%n_cells, self%affine, cell)
    case (2)
      call confirm_2d(n, x, self%n_cells, self%affine, cell)
    case default
      call confirm_3d(n, x, self%n_cells, self%affine, cell)
    end select
    do p = 1, n
      if (cell(p) == 0) cell(p) = self%find(x(:, p))
    end do
  end subroutine mesh_locate

  !> Values of the functions of a cell.
  pure subroutine mesh_values(self, cell, x, value)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> The cell.
    integer, intent(in) :: cell
    !> Position, in the cell or not. [m]
    real(wp), intent(in) :: x(self%dim)
    !> Values, in the order of the nodes of the cell.
    real(wp), intent(out) :: value(0:self%dim)
    real(wp) :: r(3)
    integer :: k

    ! Written out: this is the innermost loop of the search.
    select case (self%dim)
    case (1)
      value(1) = self%affine(1, 1, cell)*(x(1) - self%affine(1, 0, cell))
      value(0) = 1.0_wp - value(1)
    case (2)
      r(:2) = x(:2) - self%affine(:2, 0, cell)
      do k = 1, 2
        value(k) = self%affine(1, k, cell)*r(1) + self%affine(2, k, cell)*r(2)
      end do
      value(0) = 1.0_wp - value(1) - value(2)
    case default
      r = x(:3) - self%affine(:3, 0, cell)
      do k = 1, 3
        value(k) = self%affine(1, k, cell)*r(1) + self%affine(2, k, cell)*r(2) &
                   + self%affine(3, k, cell)*r(3)
      end do
      value(0) = 1.0_wp - value(1) - value(2) - value(3)
    end select
  end subroutine mesh_values

  !> Keep functions a few roundings above 0, so that every node of a point's cell has a velocity.
  pure subroutine off_edge(value)
    !> Values of all functions of a cell, which sum to 1.
    real(wp), intent(inout) :: value(:)

    if (minval(value) >= few) return
    value = max(few, value)
    value = value/sum(value)
  end subroutine off_edge

  !> Whether a node lies on the bounding box, across a direction.
  pure function mesh_on_box(self, node, d, lower) result(on_box)
    !> The mesh.
    class(mesh_t), intent(in) :: self
    !> The node, from 1.
    integer, intent(in) :: node
    !> The direction.
    integer, intent(in) :: d
    !> The lower or the upper face; either one when left out.
    logical, intent(in), optional :: lower
    !> Whether it does, up to a millionth of the least height of a cell.
    logical :: on_box
    logical :: low, high

    low = self%x(d, node) - self%lower(d) <= 1.0e-6_wp*self%h
    high = self%upper(d) - self%x(d, node) <= 1.0e-6_wp*self%h
    on_box = low .or. high
    if (.not. present(lower)) return
    on_box = merge(low, high, lower)
  end function mesh_on_box

#define DIM 1
#define CONFIRM confirm_1d
#include "mesh_template.inc"
#undef DIM
#undef CONFIRM
#define DIM 2
#define CONFIRM confirm_2d
#include "mesh_template.inc"
#undef DIM
#undef CONFIRM
#define DIM 3
#define CONFIRM confirm_3d
#include "mesh_template.inc"
#undef DIM
#undef CONFIRM

end module mpm_mesh
