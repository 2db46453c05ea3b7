!> Domains of points: boxes, parallelepipeds or free corners over which functions are averaged.
!!
!! With the corners x_c of a point's domain, the functions of the grid at them and factors w_c, g_c,
!! S_ip = sum_c w_c N_i(x_c) and G_ip = sum_c g_c N_i(x_c). The rules, with the side w of the box of
!! the point at the start and s the signs of a corner:
!!
!! - uGIMP: x_c = x_p + (w/2) s, w_c = 2**-dim, g_c = 2**-dim s/(w/2); never changes;
!! - cpGIMP: the sides are stretched by F_kk, F_kk *= exp(dt L_kk);
!! - CPDI: x_c = x_p + (w/2) F s, g_c = 2**-dim F**-T s/(w/2), F <- exp(dt L) F in the plane of the
!!   grid;
!! - CPDI2: corners that move with the grid; means over the element between them.
!!
!! When a corner lies outside the grid, the point uses the functions at its own position.
module mpm_point_domains
  use mpm_corner_basis, only: add_box, add_corners, add_plain, corner_functions, keep_inside, &
                              list_nodes, reaches_out, value_at_corner
  use mpm_corner_shapes, only: corner_sign, element_factors, parallelepiped_slopes
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_node_list, only: node_list_t
  use mpm_permutation, only: permutation_t
  use mpm_stencil, only: axis_fraction, block_size, natural_width, stencil_t
  use mpm_store, only: store_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: point_domains_t
  public :: rule_cpdi, rule_cpdi2, rule_cpgimp, rule_none, rule_ugimp

  !> Rules, as mpm_3d numbers them; on a mesh points have no domains, but lists of nodes.
  integer, parameter :: rule_none = 0, rule_ugimp = 1, rule_cpgimp = 2, rule_cpdi = 3
  !> The last one.
  integer, parameter :: rule_cpdi2 = 4
  !> Most values and derivatives of 1D functions of a block of corners.
  integer, parameter :: most_values = 12*block_size
  !> Degree of the Taylor polynomial of exp(dt L).
  integer, parameter :: degree = 5

  !> Domains of all points of a body, in the order of the points' arrays.
  type :: point_domains_t
    !> One of `rule_*`.
    integer :: rule = rule_ugimp
    !> Dimensions of the grid.
    integer :: dim = 3
    !> Side of each point's box at the start; not allocated without domains. [m] (n)
    real(wp), allocatable :: side(:)
    !> cpGIMP: F_kk (dim, n); CPDI: F by rows (dim dim, n).
    real(wp), allocatable :: stretch(:, :)
    !> CPDI2: corners from the position of the point, x fastest. [m] (dim 2**dim, n)
    real(wp), allocatable :: corner(:, :)
    !> CPDI2: length, area or volume between the corners. (n)
    real(wp), allocatable :: content(:)
    !> Folder of the files of corners; not allocated when none are written.
    character(:), allocatable :: folder
    !> Nodes of the points inside the grid, since the last mapping.
    type(node_list_t) :: list
    !> Window of the node arrays, as of the lists.
    type(window_t) :: window
    !> Cells of a mesh in which the corners of the points' boxes were, as a guess. (2**dim, any)
    integer, allocatable :: corner_cell(:, :)
    !> First nodes of the boxes of nodes of the points, not brought back at seams. (3, n)
    integer, allocatable, private :: first(:, :)
    !> Nodes of the boxes in each direction. (3, n)
    integer, allocatable, private :: counts(:, :)
    !> Whether a point uses the functions at its position. (n)
    logical, allocatable, private :: is_plain(:)
  contains
    !> Undeformed boxes of all points.
    procedure :: init => point_domains_init
    !> An undeformed box for one point.
    procedure :: set_box => point_domains_set_box
    !> Give the domain of a point another volume.
    procedure :: resize => point_domains_resize
    !> Put all arrays into another order.
    procedure :: permute => point_domains_permute
    !> Corners of a domain.
    procedure :: corners => point_domains_corners
    !> Weights and gradients of the corners of a domain.
    procedure :: factors => point_domains_factors
    !> Find the nodes that points reach.
    procedure :: place => point_domains_place
    !> Size of the lists of these nodes.
    procedure :: count_lists => point_domains_count_lists
    !> List these nodes with the values and gradients of their functions.
    procedure :: make_lists => point_domains_make_lists
    !> Let the domains of a block of points follow the grid.
    procedure :: follow => point_domains_follow
    !> Give a block of points the volumes of their domains.
    procedure :: fit_volumes => point_domains_fit_volumes
    !> Bytes that the domains and the lists hold.
    procedure :: memory => point_domains_memory
    !> Save the shapes of the domains.
    procedure :: save => point_domains_save
    !> Take them back.
    procedure :: restore => point_domains_restore
    procedure, private :: entries_of
    procedure, private :: get_corners
    procedure, private :: span
    procedure, private :: is_box
    procedure, private :: place_block
    procedure, private :: list_block
    procedure, private :: list_point
    procedure, private :: list_corners
    procedure, private :: corner_positions
    procedure, private :: move_corners
  end type point_domains_t

contains

  !> Undeformed boxes of all points.
  subroutine point_domains_init(self, kin, rule, scale, volume, x)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> One of `rule_*`.
    integer, intent(in) :: rule
    !> Side of the boxes over that of the cube of the point's volume.
    real(wp), intent(in) :: scale
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(:)
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    integer :: p, n

    n = size(volume)
    self%rule = rule
    self%dim = kin%dim
    allocate (self%side(n))
    if (rule == rule_cpgimp) allocate (self%stretch(kin%dim, n))
    if (rule == rule_cpdi) allocate (self%stretch(kin%dim**2, n))
    if (rule == rule_cpdi2) allocate (self%corner(kin%dim*2**kin%dim, n), self%content(n))
    do p = 1, n
      call self%set_box(kin, p, scale, volume(p), x(:, p))
    end do
  end subroutine point_domains_init

  !> An undeformed box for one point.
  pure subroutine point_domains_set_box(self, kin, slot, scale, volume, x)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Side of the box over that of the cube of the point's volume.
    real(wp), intent(in) :: scale
    !> Volume. [m3]
    real(wp), intent(in) :: volume
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    real(wp) :: section
    integer :: c, d

    section = volume
    if (kin%sim_type == type_axisymmetric) section = volume/x(1)
    select case (kin%dim)
    case (1)
      self%side(slot) = scale*section
    case (2)
      self%side(slot) = scale*sqrt(section)
    case default
      self%side(slot) = scale*section**(1.0_wp/3.0_wp)
    end select
    select case (self%rule)
    case (rule_cpgimp)
      self%stretch(:, slot) = 1.0_wp
    case (rule_cpdi)
      self%stretch(:, slot) = 0.0_wp
      do d = 1, self%dim
        self%stretch((d - 1)*self%dim + d, slot) = 1.0_wp
      end do
    case (rule_cpdi2)
      do c = 1, 2**self%dim
        self%corner((c - 1)*self%dim + 1:c*self%dim, slot) = 0.5_wp*self%side(slot) &
                                                             *corner_sign(:self%dim, c)
      end do
      self%content(slot) = self%side(slot)**self%dim
    case default
      continue
    end select
  end subroutine point_domains_set_box

  !> Give the domain of a point another volume and the same shape.
  pure subroutine point_domains_resize(self, slot, factor)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Slot of the point.
    integer, intent(in) :: slot
    !> The new volume over the old one.
    real(wp), intent(in) :: factor
    real(wp) :: length

    length = factor**(1.0_wp/real(self%dim, wp))
    self%side(slot) = length*self%side(slot)
    if (.not. allocated(self%corner)) return
    self%corner(:, slot) = length*self%corner(:, slot)
    self%content(slot) = factor*self%content(slot)
  end subroutine point_domains_resize

  !> Put all arrays into another order.
  subroutine point_domains_permute(self, permutation)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Where each slot takes its value from. (n)
    type(permutation_t), intent(in) :: permutation

    if (allocated(self%side)) call permutation%apply(self%side)
    if (allocated(self%stretch)) call permutation%apply(self%stretch)
    if (allocated(self%corner)) call permutation%apply(self%corner)
    if (allocated(self%content)) call permutation%apply(self%content)
    if (.not. allocated(self%corner_cell)) return
    ! Some of the points may never have been inside the mesh.
    if (size(self%corner_cell, 2) == permutation%size()) call permutation%apply(self%corner_cell)
  end subroutine point_domains_permute

  !> Corners of a domain, from the position of the point, x fastest.
  pure function point_domains_corners(self, slot) result(r)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Corners. [m]
    real(wp) :: r(self%dim, 2**self%dim)

    call self%get_corners(slot, r)
  end function point_domains_corners

  !> The same without a new array.
  pure subroutine get_corners(self, slot, r)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Corners. [m]
    real(wp), intent(out) :: r(self%dim, 2**self%dim)
    real(wp) :: half
    integer :: c, d, k

    half = 0.5_wp*self%side(slot)
    do c = 1, 2**self%dim
      do d = 1, self%dim
        select case (self%rule)
        case (rule_cpgimp)
          r(d, c) = half*self%stretch(d, slot)*corner_sign(d, c)
        case (rule_cpdi)
          r(d, c) = 0.0_wp
          do k = 1, self%dim
            r(d, c) = r(d, c) + self%stretch((d - 1)*self%dim + k, slot)*corner_sign(k, c)
          end do
          r(d, c) = half*r(d, c)
        case (rule_cpdi2)
          r(d, c) = self%corner((c - 1)*self%dim + d, slot)
        case default
          r(d, c) = half*corner_sign(d, c)
        end select
      end do
    end do
  end subroutine get_corners

  !> Weights and gradients of the corners of a domain.
  pure subroutine point_domains_factors(self, slot, weight, slope)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Weights.
    real(wp), intent(out) :: weight(2**self%dim)
    !> Gradients. [1/m]
    real(wp), intent(out) :: slope(self%dim, 2**self%dim)
    real(wp) :: r(24), edge(9), volume
    integer :: d, k

    if (self%rule == rule_cpdi2) then
      call self%get_corners(slot, r)
      call element_factors(self%dim, r, weight, slope, volume)
      return
    end if
    weight = 0.5_wp**self%dim
    edge = 0.0_wp
    do d = 1, self%dim
      ! Component d of edge k.
      do k = 1, self%dim
        if (self%rule == rule_cpdi) then
          edge((k - 1)*self%dim + d) = self%stretch((d - 1)*self%dim + k, slot)
        else if (d == k) then
          edge((k - 1)*self%dim + d) = 1.0_wp
          if (self%rule == rule_cpgimp) edge((k - 1)*self%dim + d) = self%stretch(d, slot)
        end if
      end do
    end do
    edge = 0.5_wp*self%side(slot)*edge
    call parallelepiped_slopes(self%dim, edge, slope)
  end subroutine point_domains_factors

  !> Whether the domains are boxes along the axes, so that means are products of 1D means.
  pure function is_box(self)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Whether they are.
    logical :: is_box

    is_box = self%rule == rule_ugimp .or. self%rule == rule_cpgimp
  end function is_box

  !> Box around a domain, from the position of the point.
  pure subroutine span(self, slot, low, high)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Lower corner. [m]
    real(wp), intent(out) :: low(self%dim)
    !> Upper corner. [m]
    real(wp), intent(out) :: high(self%dim)
    real(wp) :: r(24)
    integer :: d, c

    if (self%is_box()) then
      high = 0.5_wp*self%side(slot)
      if (self%rule == rule_cpgimp) high = high*self%stretch(:, slot)
      low = -high
    else
      call self%get_corners(slot, r)
      low = r(:self%dim)
      high = low
      do c = 1, 2**self%dim - 1
        do d = 1, self%dim
          low(d) = min(low(d), r(c*self%dim + d))
          high(d) = max(high(d), r(c*self%dim + d))
        end do
      end do
    end if
  end subroutine span

  !> Find the nodes that points reach.
  subroutine point_domains_place(self, stencil, threads, n, x, window)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Basis, not averaged.
    type(stencil_t), intent(in) :: stencil
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%dim, n)
    !> Window of all nodes.
    type(window_t), intent(out) :: window
    integer :: a, d, lo(3), hi(3)

    if (allocated(self%is_plain)) then
      if (size(self%is_plain) /= n) deallocate (self%is_plain, self%first, self%counts)
    end if
    if (.not. allocated(self%is_plain)) then
      allocate (self%is_plain(n), self%first(3, n), self%counts(3, n))
    end if
    lo = huge(1)
    hi = -huge(1)
    !$omp parallel do default(none) schedule(static) num_threads(threads) &
    !$omp shared(self, stencil, n, x) reduction(min:lo) reduction(max:hi)
    do a = 1, n, block_size/2
      associate (b => min(n, a + block_size/2 - 1))
        call self%place_block(stencil, a, b, x(:, a:b))
        lo = min(lo, minval(self%first(:, a:b), dim=2))
        hi = max(hi, maxval(self%first(:, a:b) + self%counts(:, a:b), dim=2) - 1)
      end associate
    end do
    !$omp end parallel do
    if (n == 0) return
    do d = 1, self%dim
      if (.not. stencil%periodic(d)) cycle
      if (lo(d) >= 0 .and. hi(d) < stencil%n_cells(d)) cycle
      ! Nodes behind a seam are at the other end.
      lo(d) = 0
      hi(d) = stencil%n_cells(d) - 1
    end do
    window%lo = lo
    window%n = hi - lo + 1
  end subroutine point_domains_place

  !> Find the nodes that a block of points reaches.
  subroutine place_block(self, stencil, a, b, x)
    !> The domains; the blocks of different threads do not overlap.
    class(point_domains_t), intent(inout) :: self
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> First slot.
    integer, intent(in) :: a
    !> Last slot.
    integer, intent(in) :: b
    !> Positions. [m]
    real(wp), intent(in) :: x(self%dim, a:b)
    real(wp) :: y(3*block_size), low(3), high(3)
    integer :: first(3, block_size), p, k

    associate (dim => self%dim)
      do p = a, b
        call self%span(p, low, high)
        self%is_plain(p) = reaches_out(stencil, x(:, p), low, high)
        if (self%is_plain(p)) low = 0.0_wp
        if (self%is_plain(p)) high = 0.0_wp
        k = 2*(p - a)*dim
        y(k + 1:k + dim) = x(:, p) + low(:dim)
        y(k + dim + 1:k + 2*dim) = x(:, p) + high(:dim)
      end do
      call keep_inside(stencil, 2*(b - a + 1), y)
      call corner_functions(stencil, 2*(b - a + 1), y, first)
      do p = a, b
        k = 2*(p - a)
        self%first(:, p) = first(:, k + 1)
        self%counts(:, p) = 1
        self%counts(:dim, p) = first(:dim, k + 2) - first(:dim, k + 1) + natural_width(stencil%kind)
      end do
    end associate
  end subroutine place_block

  !> Size of the lists of the nodes of all points.
  pure subroutine point_domains_count_lists(self, stencil, entries, bytes)
    !> The domains, placed.
    class(point_domains_t), intent(in) :: self
    !> Basis, not averaged.
    type(stencil_t), intent(in) :: stencil
    !> Entries of the lists.
    integer(lp), intent(out) :: entries
    !> Bytes of their arrays.
    integer(lp), intent(out) :: bytes
    integer :: p

    entries = 0
    do p = 1, size(self%is_plain)
      entries = entries + self%entries_of(stencil, p)
    end do
    bytes = entries*(storage_size(1)/8 + (self%dim + 1)*(storage_size(1.0_wp)/8))
    ! Lists are made longer than they have to be.
    bytes = bytes + bytes/8
  end subroutine point_domains_count_lists

  !> Entries of a point: the nodes on the box of all corners, unless the corners themselves have
  !! fewer.
  pure function entries_of(self, stencil, slot) result(n)
    !> The domains, placed.
    class(point_domains_t), intent(in) :: self
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Their number, at most.
    integer :: n
    integer(lp) :: on_box

    on_box = product(int(self%counts(:, slot), lp))
    n = int(min(on_box, int((2*natural_width(stencil%kind))**self%dim, lp)))
  end function entries_of

  !> List the nodes of all points with the values and gradients of their functions.
  subroutine point_domains_make_lists(self, kin, stencil, threads, n, x, window)
    !> The domains, placed.
    class(point_domains_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis, not averaged.
    type(stencil_t), intent(in) :: stencil
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%dim, n)
    !> Window of the node arrays; holds all nodes of the points.
    type(window_t), intent(in) :: window
    integer :: entries(n), step, a, p

    self%window = window
    do p = 1, n
      entries(p) = self%entries_of(stencil, p)
    end do
    call self%list%resize(self%dim, window%size(), entries)
    step = block_size/merge(2, 2**self%dim, self%is_box())
    !$omp parallel do default(none) schedule(static) num_threads(threads) &
    !$omp shared(self, stencil, n, x, step)
    do a = 1, n, step
      call self%list_block(stencil, a, min(n, a + step - 1), x(:, a:min(n, a + step - 1)))
    end do
    !$omp end parallel do
    call self%list%cut(threads)
    if (kin%sim_type /= type_axisymmetric) return
    self%list%radius = x(1, :)
    self%list%least_radius = axis_fraction*stencil%h(1)
  end subroutine point_domains_make_lists

  !> Set the entries of a block of points.
  subroutine list_block(self, stencil, a, b, x)
    !> The domains; the blocks of different threads do not overlap.
    class(point_domains_t), intent(inout) :: self
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> First slot.
    integer, intent(in) :: a
    !> Last slot.
    integer, intent(in) :: b
    !> Positions. [m]
    real(wp), intent(in) :: x(self%dim, a:b)
    real(wp) :: w(most_values), dw(most_values), y(3*block_size)
    integer :: first(3, block_size), corners, values, k, p

    corners = merge(2, 2**self%dim, self%is_box())
    values = natural_width(stencil%kind)*self%dim
    do p = a, b
      k = corners*(p - a)
      call self%corner_positions(p, corners, x(:, p), y(k*self%dim + 1))
    end do
    call keep_inside(stencil, corners*(b - a + 1), y)
    call corner_functions(stencil, corners*(b - a + 1), y, first, w, dw)
    do p = a, b
      k = corners*(p - a)
      if (.not. self%is_plain(p) .and. &
          product(int(self%counts(:, p), lp)) > self%list%count(p)) then
        call self%list_corners(stencil, p, x(:, p))
      else
        call self%list_point(stencil, p, corners, first(:, k + 1:k + corners), w(values*k + 1), &
                             dw(values*k + 1))
      end if
    end do
  end subroutine list_block

  !> Positions at which the functions of a point are needed.
  pure subroutine corner_positions(self, slot, corners, x, y)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Slot of the point.
    integer, intent(in) :: slot
    !> 2: the lowest and the highest corner, otherwise all.
    integer, intent(in) :: corners
    !> Position of the point. [m]
    real(wp), intent(in) :: x(self%dim)
    !> The positions; those of the point itself where its functions count. [m]
    real(wp), intent(out) :: y(self%dim, corners)

    integer :: c

    if (self%is_plain(slot)) then
      y = 0.0_wp
    else if (self%is_box() .and. corners == 2) then
      call self%span(slot, y(:, 1), y(:, 2))
    else
      call self%get_corners(slot, y)
    end if
    do c = 1, corners
      y(:, c) = y(:, c) + x
    end do
  end subroutine corner_positions

  !> Set the entries of a point on the box of all its nodes.
  subroutine list_point(self, stencil, slot, corners, first, w, dw)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Number of corners that were looked at.
    integer, intent(in) :: corners
    !> First nodes of the corners.
    integer, intent(in) :: first(3, corners)
    !> Values of the 1D functions there. (width, dim, corners)
    real(wp), intent(in) :: w(natural_width(stencil%kind)*self%dim*corners)
    !> Their derivatives. [1/m] (width, dim, corners)
    real(wp), intent(in) :: dw(natural_width(stencil%kind)*self%dim*corners)
    real(wp) :: low(3), high(3), weight(8), slope(24)
    integer :: from(3, 8), width, c

    width = natural_width(stencil%kind)
    associate (counts => self%counts(:, slot), list => self%list, &
               e => self%list%offset(slot - 1) + 1, last => self%list%offset(slot))
      call list_nodes(stencil, self%window, self%first(:, slot), counts, list%node(e:last))
      if (self%is_plain(slot)) then
        call add_plain(width, self%dim, w, dw, list%basis(:, e:last))
        return
      end if
      do c = 1, corners
        ! In the box, unless a position was rounded once here and once there.
        from(:, c) = max(0, min(first(:, c) - self%first(:, slot), counts - width))
      end do
      if (self%is_box()) then
        call self%span(slot, low, high)
        call add_box(width, self%dim, counts, from(:self%dim, 2), w, high, list%basis(:, e:last))
      else
        call self%factors(slot, weight, slope)
        call add_corners(width, self%dim, corners, counts, from, w, weight, slope, &
                         list%basis(:, e:last))
      end if
    end associate
  end subroutine list_point

  !> Set the entries of a point whose corners lie far apart: the nodes of each for itself.
  subroutine list_corners(self, stencil, slot, x)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Position of the point. [m]
    real(wp), intent(in) :: x(self%dim)
    real(wp) :: w(4*self%dim*2**self%dim), dw(4*self%dim*2**self%dim), y(self%dim, 2**self%dim)
    real(wp) :: weight(2**self%dim), slope(self%dim, 2**self%dim)
    integer :: first(3, 2**self%dim), counts(3), width, corners, c, e, step

    width = natural_width(stencil%kind)
    corners = 2**self%dim
    step = width**self%dim
    counts = 1
    counts(:self%dim) = width
    call self%corner_positions(slot, corners, x, y)
    call keep_inside(stencil, corners, y)
    call corner_functions(stencil, corners, y, first, w, dw)
    call self%factors(slot, weight, slope)
    e = self%list%offset(slot - 1)
    do c = 1, corners
      call list_nodes(stencil, self%window, first(:, c), counts, self%list%node(e + 1:e + step))
      call add_corners(width, self%dim, 1, counts, [0, 0, 0], w((c - 1)*width*self%dim + 1), &
                       weight(c:c), slope(:, c:c), self%list%basis(:, e + 1:e + step))
      e = e + step
    end do
  end subroutine list_corners

  !> Let the domains of a block of points follow the grid.
  !!
  !! The velocity of a CPDI2 point becomes that of the centroid of its corners.
  subroutine point_domains_follow(self, kin, stencil, dt, a, n, x, node_velocity, gradient, &
                                  velocity, strain, drift)
    !> The domains, with the lists of the step; the blocks of different threads do not overlap.
    class(point_domains_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First slot of the block.
    integer, intent(in) :: a
    !> Number of points, at most `block_size`.
    integer, intent(in) :: n
    !> Positions before they move. [m] (dim, n)
    real(wp), intent(in) :: x(kin%dim, n)
    !> Nodal velocities, by which points move. [m/s] (nvel, nn)
    real(wp), contiguous, intent(in) :: node_velocity(:, :)
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Velocities of the grid at the points. [m/s] (nvel, n)
    real(wp), intent(inout) :: velocity(kin%nvel, n)
    !> The points are strained by `gradient`.
    logical, intent(in) :: strain
    !> The points move by `velocity`.
    logical, intent(in) :: drift
    real(wp) :: l(kin%dim, kin%dim)
    integer :: p, d

    if (strain .and. allocated(self%stretch)) then
      do p = 1, n
        if (self%rule == rule_cpgimp) then
          do d = 1, kin%dim
            self%stretch(d, a + p - 1) = self%stretch(d, a + p - 1) &
                                         *exp(dt*gradient((d - 1)*kin%dim + d, p))
          end do
        else
          call deform(kin%dim, dt, gradient(:kin%dim**2, p), self%stretch(:, a + p - 1))
        end if
      end do
    end if
    if (.not. (drift .and. self%rule == rule_cpdi2)) return
    do p = 1, n
      l = transpose(reshape(gradient(:kin%dim**2, p), [kin%dim, kin%dim]))
      call self%move_corners(kin, stencil, dt, a + p - 1, x(:, p), node_velocity, l, &
                             velocity(:kin%dim, p))
    end do
  end subroutine point_domains_follow

  !> F <- exp(dt L) F with the Taylor polynomial of exp(dt L), from the inside out.
  pure subroutine deform(dim, dt, l, f)
    !> Dimensions.
    integer, intent(in) :: dim
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradient by rows: its columns here are the rows. [1/s]
    real(wp), intent(in) :: l(dim, dim)
    !> F by rows.
    real(wp), intent(inout) :: f(dim, dim)
    real(wp) :: old(3, 3), next(3, 3)
    integer :: k, i, j

    old(:dim, :dim) = f
    do k = degree, 1, -1
      next(:dim, :dim) = old(:dim, :dim)
      do i = 1, dim
        do j = 1, dim
          next(:dim, i) = next(:dim, i) + (dt/real(k, wp))*l(j, i)*f(:, j)
        end do
      end do
      f = next(:dim, :dim)
    end do
  end subroutine deform

  !> Move the corners of a point with the grid.
  pure subroutine move_corners(self, kin, stencil, dt, slot, x, node_velocity, l, velocity)
    !> The domains.
    class(point_domains_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Slot of the point.
    integer, intent(in) :: slot
    !> Position of the point. [m]
    real(wp), intent(in) :: x(kin%dim)
    !> Nodal velocities. [m/s]
    real(wp), contiguous, intent(in) :: node_velocity(:, :)
    !> Velocity gradient in the plane of the grid. [1/s]
    real(wp), intent(in) :: l(kin%dim, kin%dim)
    !> Velocity of the grid at the point, then of the centroid. [m/s]
    real(wp), intent(inout) :: velocity(kin%dim)
    real(wp) :: r(24), v(24), weight(8), slope(24), centroid(3)
    integer :: c, d, m

    associate (dim => kin%dim)
      m = dim*2**dim
      call self%get_corners(slot, r)
      if (self%is_plain(slot)) then
        do c = 0, m - dim, dim
          v(c + 1:c + dim) = velocity
          do d = 1, dim
            v(c + 1:c + dim) = v(c + 1:c + dim) + l(:, d)*r(c + d)
          end do
        end do
      else
        call corner_velocities(kin, stencil, self%window, x, r, node_velocity, v)
      end if
      r(:m) = r(:m) + dt*v(:m)
      call element_factors(dim, r, weight, slope, self%content(slot))
      centroid = 0.0_wp
      do c = 1, 2**dim
        centroid(:dim) = centroid(:dim) + weight(c)*r((c - 1)*dim + 1:c*dim)
      end do
      ! A domain without volume has no centroid; `fit_volumes` reports it.
      if (self%content(slot) > 0.0_wp) velocity = centroid(:dim)/dt
      do c = 1, m
        self%corner(c, slot) = r(c) - centroid(mod(c - 1, dim) + 1)
      end do
    end associate
  end subroutine move_corners

  !> Velocities of the grid at corners.
  pure subroutine corner_velocities(kin, stencil, window, x, corner, node_velocity, velocity)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays.
    type(window_t), intent(in) :: window
    !> Position of the point. [m]
    real(wp), intent(in) :: x(kin%dim)
    !> Corners from the position. [m]
    real(wp), intent(in) :: corner(kin%dim, 2**kin%dim)
    !> Nodal velocities. [m/s]
    real(wp), contiguous, intent(in) :: node_velocity(:, :)
    !> Velocities of the corners in the plane of the grid. [m/s]
    real(wp), intent(out) :: velocity(kin%dim, 2**kin%dim)
    real(wp) :: w(96), dw(96), y(24)
    integer :: first(3, 8), node(64), counts(3), width, c

    width = natural_width(stencil%kind)
    counts = 1
    counts(:kin%dim) = width
    do c = 1, 2**kin%dim
      y((c - 1)*kin%dim + 1:c*kin%dim) = x + corner(:, c)
    end do
    call keep_inside(stencil, 2**kin%dim, y)
    call corner_functions(stencil, 2**kin%dim, y, first, w, dw)
    do c = 1, 2**kin%dim
      call list_nodes(stencil, window, first(:, c), counts, node)
      call value_at_corner(width, kin%dim, kin%nvel, w((c - 1)*width*kin%dim + 1), node, &
                           node_velocity, velocity(:, c))
    end do
  end subroutine corner_velocities

  !> Give a block of CPDI2 points the volumes of their domains.
  pure subroutine point_domains_fit_volumes(self, kin, a, n, x, volume, slot)
    !> The domains, moved.
    class(point_domains_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> First slot of the block.
    integer, intent(in) :: a
    !> Number of points.
    integer, intent(in) :: n
    !> Positions, moved. [m] (dim, n)
    real(wp), intent(in) :: x(kin%dim, n)
    !> Volumes. [m3] (n)
    real(wp), intent(inout) :: volume(n)
    !> First point of the block whose domain has no volume, or 0.
    integer, intent(out) :: slot
    integer :: p

    slot = 0
    if (self%rule /= rule_cpdi2) return
    do p = n, 1, -1
      volume(p) = self%content(a + p - 1)
      if (kin%sim_type == type_axisymmetric) volume(p) = volume(p)*x(1, p)
      if (.not. volume(p) > 0.0_wp) slot = p
    end do
  end subroutine point_domains_fit_volumes

  !> Bytes that the domains and the lists hold.
  pure function point_domains_memory(self) result(bytes)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Bytes.
    integer(lp) :: bytes
    integer(lp) :: reals, integers

    reals = 0
    if (allocated(self%side)) reals = size(self%side, kind=lp)
    if (allocated(self%stretch)) reals = reals + size(self%stretch, kind=lp)
    if (allocated(self%corner)) then
      reals = reals + size(self%corner, kind=lp) + size(self%content, kind=lp)
    end if
    integers = 0
    if (allocated(self%first)) integers = 7*size(self%is_plain, kind=lp)
    if (allocated(self%corner_cell)) integers = integers + size(self%corner_cell, kind=lp)
    bytes = (reals*storage_size(1.0_wp, lp) + integers*storage_size(1, lp))/8 + self%list%memory()
  end function point_domains_memory

  !> Save the shapes of the domains; lists of nodes are made anew in each step.
  subroutine point_domains_save(self, store)
    !> The domains.
    class(point_domains_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    if (allocated(self%side)) call store%put('side', self%side)
    if (allocated(self%stretch)) call store%put('stretch', self%stretch)
    if (allocated(self%corner)) call store%put('corner', self%corner)
    if (allocated(self%content)) call store%put('content', self%content)
  end subroutine point_domains_save

  !> Take back the shapes of the domains.
  subroutine point_domains_restore(self, store)
    !> The domains, set up.
    class(point_domains_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    if (store%has('side')) call store%get('side', self%side)
    if (store%has('stretch')) call store%get('stretch', self%stretch)
    if (store%has('corner')) call store%get('corner', self%corner)
    if (store%has('content')) call store%get('content', self%content)
  end subroutine point_domains_restore

end module mpm_point_domains
