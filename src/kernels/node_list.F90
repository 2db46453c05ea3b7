!> Explicit lists of the nodes of points: the general path between points and nodes.
!!
!! Whoever owns a basis lists for each point the nodes that it reaches, with the values and
!! gradients of their functions; a node may be listed more than once, its entries add up. Nothing
!! here knows how the nodes lie in space. Grids that are products of lines have faster kernels
!! (`mpm_p2g`, `mpm_g2p`), which do the same work.
!!
!! Sums at nodes: blocks of consecutive points are put together into slabs, such that no two even
!! slabs share a node, nor two odd ones. So all even slabs can be added at once, then all odd ones,
!! with no two threads at one node and every sum in the same order for any number of threads. The
!! slabs are found from the lowest and highest node of each block: points should be stored such that
!! nodes far apart in their arrays belong to points far apart in theirs. Blocks that reach over more
!! than half of all nodes (at seams of periodic grids) are added last, by one thread.
module mpm_node_list
  use, intrinsic :: iso_fortran_env, only: int64
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t, type_1d, type_3d, type_axisymmetric, type_plane_strain
  use mpm_prefetch, only: prefetch_batch, prefetch_rows
  implicit none
  private
  public :: list_block, node_list_t

  !> Consecutive points whose nodes are looked at together.
  integer, parameter :: list_block = 64
  !> Points in a slab, at least; fewer would cost more in scheduling than they give.
  integer, parameter :: slab_points = 512
  !> Numbers in lists that no longer fit a cache, where asking for them ahead gains a tenth; below,
  !! it costs as much.
  real(wp), parameter :: far = 1.0e6_wp
  !> Stored stress component of row c, column k of the tensor.
  integer, parameter :: stress_index(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])

  !> Nodes of each point, with values and gradients of their functions.
  type :: node_list_t
    !> Number of points.
    integer :: n = 0
    !> Components of a gradient.
    integer :: dim = 3
    !> Number of nodes.
    integer :: n_nodes = 0
    !> Entries before those behind each point. (0:n)
    integer, allocatable :: offset(:)
    !> Node of each entry, from 1. (entries)
    integer, allocatable :: node(:)
    !> Value (row 0) and gradient of the node's function at the point. [-, 1/m] (0:dim, entries)
    real(wp), allocatable :: basis(:, :)
    !> TYPE 4: distance of each point from the axis. [m] (n)
    real(wp), allocatable :: radius(:)
    !> TYPE 4: below it 1/r is replaced by its limit on the axis. [m]
    real(wp) :: least_radius = 0.0_wp
    !> Blocks before each slab. (0:slabs)
    integer, allocatable, private :: slab(:)
    !> Blocks that are added last. (blocks)
    logical, allocatable, private :: is_wide(:)
  contains
    !> Make room for the entries of points; `offset` is set, the entries are not.
    procedure :: resize => node_list_resize
    !> Number of entries of a point.
    procedure :: count => node_list_count
    !> Find the slabs, when all entries are set.
    procedure :: cut => node_list_cut
    !> Nodal mass, momentum and internal force.
    procedure :: scatter => node_list_scatter
    !> Velocity, increment and velocity gradient at a block of points.
    procedure :: gather => node_list_gather
    !> Add what points share out by the values of the functions.
    procedure :: add_values => node_list_add_values
    !> Add what points share out by the gradients of the functions.
    procedure :: add_gradients => node_list_add_gradients
    !> Interpolate a nodal field to points.
    procedure :: values_at => node_list_values_at
    !> Gradients of a nodal field at points.
    procedure :: gradients_at => node_list_gradients_at
    !> Bytes that the lists hold.
    procedure :: memory => node_list_memory
    !> Whether it pays to ask for points ahead.
    procedure :: is_far => node_list_is_far
    procedure, private :: add_range
    procedure, private :: prefetch
    procedure, private :: scatter_block
  end type node_list_t

contains

  !> Make room for the entries of points.
  subroutine node_list_resize(self, dim, n_nodes, counts)
    !> The lists; of earlier ones nothing stays but the memory.
    class(node_list_t), intent(inout) :: self
    !> Components of a gradient.
    integer, intent(in) :: dim
    !> Number of nodes.
    integer, intent(in) :: n_nodes
    !> Entries of each point. (n)
    integer, intent(in) :: counts(:)
    integer :: p, entries

    if (allocated(self%offset)) then
      if (ubound(self%offset, 1) < size(counts)) deallocate (self%offset)
    end if
    if (.not. allocated(self%offset)) allocate (self%offset(0:size(counts)))
    self%n = size(counts)
    self%dim = dim
    self%n_nodes = n_nodes
    self%offset(0) = 0
    do p = 1, self%n
      self%offset(p) = self%offset(p - 1) + counts(p)
    end do
    entries = self%offset(self%n)
    if (allocated(self%node)) then
      if (size(self%node) >= entries .and. ubound(self%basis, 1) == dim) return
      deallocate (self%node, self%basis)
    end if
    ! Some more, so that a body that grows does not ask for memory in every step.
    entries = entries + min(entries/8, huge(1) - entries)
    allocate (self%node(entries), self%basis(0:dim, entries))
  end subroutine node_list_resize

  !> Number of entries of a point.
  pure function node_list_count(self, point) result(n)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> The point, from 1.
    integer, intent(in) :: point
    !> Entries.
    integer :: n

    n = self%offset(point) - self%offset(point - 1)
  end function node_list_count

  !> Find the slabs, when all entries are set.
  subroutine node_list_cut(self, threads)
    !> The lists.
    class(node_list_t), intent(inout) :: self
    !> Number of threads; the slabs do not depend on it.
    integer, intent(in) :: threads
    integer, allocatable :: lowest(:), highest(:), cuts(:)
    integer :: blocks, b, first, slabs, top, top_before

    blocks = (self%n + list_block - 1)/list_block
    allocate (lowest(blocks + 1), highest(blocks), cuts(0:blocks))
    if (allocated(self%is_wide)) deallocate (self%is_wide)
    allocate (self%is_wide(blocks))
    !$omp parallel do default(none) schedule(static) num_threads(threads) &
    !$omp shared(self, blocks, lowest, highest) private(b)
    do b = 1, blocks
      call node_range(self%offset((b - 1)*list_block), self%offset(min(self%n, b*list_block)), &
                      self%node, lowest(b), highest(b))
      self%is_wide(b) = highest(b) - lowest(b) > self%n_nodes/2
    end do
    !$omp end parallel do
    ! From here on lowest(b) is the lowest node of all blocks from b on.
    lowest(blocks + 1) = huge(1)
    do b = blocks, 1, -1
      if (self%is_wide(b)) lowest(b) = huge(1)
      lowest(b) = min(lowest(b), lowest(b + 1))
    end do
    slabs = 0
    cuts(0) = 0
    first = 1
    top = -1
    top_before = -1
    do b = 1, blocks
      if (.not. self%is_wide(b)) top = max(top, highest(b))
      if ((b - first + 1)*list_block < slab_points .and. b < blocks) cycle
      ! What follows must not meet the slab before this one.
      if (lowest(b + 1) <= top_before .and. b < blocks) cycle
      slabs = slabs + 1
      cuts(slabs) = b
      first = b + 1
      top_before = top
      top = -1
    end do
    if (allocated(self%slab)) deallocate (self%slab)
    allocate (self%slab(0:slabs))
    self%slab(:) = cuts(0:slabs)
  end subroutine node_list_cut

  !> Lowest and highest node of a range of entries.
  pure subroutine node_range(before, last, node, lowest, highest)
    !> Entries before the range.
    integer, intent(in) :: before
    !> Last entry.
    integer, intent(in) :: last
    !> Nodes of all entries.
    integer, contiguous, intent(in) :: node(:)
    !> Lowest node; huge when there are none.
    integer, intent(out) :: lowest
    !> Highest node; -1 when there are none.
    integer, intent(out) :: highest
    integer :: e, low, high

    ! Of its own, so that they stay in registers.
    low = huge(1)
    high = -1
    do e = before + 1, last
      low = min(low, node(e))
      high = max(high, node(e))
    end do
    lowest = low
    highest = high
  end subroutine node_range

  !> Nodal mass, momentum and internal force of points, as of `mpm_p2g`.
  subroutine node_list_scatter(self, kin, threads, mass, volume, velocity, stress, node_mass, &
                               node_momentum, node_force)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of threads.
    integer, intent(in) :: threads
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(*)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(*)
    !> Velocities. [m/s] (nvel, n)
    real(wp), intent(in) :: velocity(*)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(*)
    !> Nodal masses. [kg] (nn)
    real(wp), contiguous, intent(inout) :: node_mass(:)
    !> Nodal momenta. [kg m/s] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_momentum(:, :)
    !> Nodal forces. [N] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_force(:, :)
    integer :: colour, s, b, i

    !$omp parallel default(none) num_threads(threads) private(colour, s, b, i) &
    !$omp shared(self, kin, mass, volume, velocity, stress, node_mass, node_momentum, node_force)
    !$omp do schedule(static)
    do i = 1, self%n_nodes
      node_mass(i) = 0.0_wp
      node_momentum(:, i) = 0.0_wp
      node_force(:, i) = 0.0_wp
    end do
    !$omp end do
    do colour = 1, 2
      !$omp do schedule(dynamic)
      do s = colour, ubound(self%slab, 1), 2
        do b = self%slab(s - 1) + 1, self%slab(s)
          if (self%is_wide(b)) cycle
          call self%scatter_block(kin, b, mass, volume, velocity, stress, node_mass, &
                                  node_momentum, node_force)
        end do
      end do
      !$omp end do
    end do
    !$omp single
    do b = 1, size(self%is_wide)
      if (self%is_wide(b)) then
        call self%scatter_block(kin, b, mass, volume, velocity, stress, node_mass, &
                                node_momentum, node_force)
      end if
    end do
    !$omp end single
    !$omp end parallel
  end subroutine node_list_scatter

  !> Add one block of points to the nodal sums.
  pure subroutine scatter_block(self, kin, block, mass, volume, velocity, stress, node_mass, &
                                node_momentum, node_force)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of the block, from 1.
    integer, intent(in) :: block
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(*)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(*)
    !> Velocities. [m/s] (nvel, n)
    real(wp), intent(in) :: velocity(*)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(*)
    !> Nodal masses, added to. [kg] (nn)
    real(wp), intent(inout) :: node_mass(*)
    !> Nodal momenta, added to. [kg m/s] (nvel, nn)
    real(wp), intent(inout) :: node_momentum(*)
    !> Nodal forces, added to. [N] (nvel, nn)
    real(wp), intent(inout) :: node_force(*)
    integer(int64) :: seen
    integer :: a, b, last, batch
    logical :: is_far

    last = min(self%n, block*list_block)
    is_far = self%is_far()
    batch = list_block
    if (is_far) batch = prefetch_batch(self%dim)
    seen = 0
    do a = (block - 1)*list_block + 1, last, batch
      b = min(last, a + batch - 1)
      if (is_far) then
        call prefetch_rows(1, b - a + 1, mass(a), seen)
        call prefetch_rows(1, b - a + 1, volume(a), seen)
        call prefetch_rows(kin%nvel, b - a + 1, velocity((a - 1)*kin%nvel + 1), seen)
        call prefetch_rows(kin%nstress, b - a + 1, stress((a - 1)*kin%nstress + 1), seen)
        call self%prefetch(a, b, seen)
      end if
      select case (kin%sim_type)
      case (type_1d)
        call scatter_1d(a, b, self%offset, self%node, self%basis, mass, volume, velocity, stress, &
                        node_mass, node_momentum, node_force)
      case (type_plane_strain)
        call scatter_plane(a, b, self%offset, self%node, self%basis, mass, volume, velocity, &
                           stress, node_mass, node_momentum, node_force)
      case (type_3d)
        call scatter_3d(a, b, self%offset, self%node, self%basis, mass, volume, velocity, stress, &
                        node_mass, node_momentum, node_force)
      case (type_axisymmetric)
        call scatter_axisymmetric(a, b, self%offset, self%node, self%basis, mass, volume, &
                                  velocity, stress, node_mass, node_momentum, node_force, &
                                  self%radius, self%least_radius)
      case default
        call scatter_out_of_plane(a, b, self%offset, self%node, self%basis, mass, volume, &
                                  velocity, stress, node_mass, node_momentum, node_force)
      end select
    end do
  end subroutine scatter_block

  !> Whether it pays to ask for points ahead: in more than one dimension, and where the lists are
  !! too large for a cache.
  pure function node_list_is_far(self) result(is_far)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Whether it does.
    logical :: is_far

    is_far = self%dim > 1 .and. (self%dim + 1)*real(self%offset(self%n), wp) > far
  end function node_list_is_far

  !> Ask for the functions of the points after some.
  pure subroutine prefetch(self, a, b, seen)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> First point.
    integer, intent(in) :: a
    !> Last point.
    integer, intent(in) :: b
    !> See `prefetch_rows`.
    integer(int64), intent(inout) :: seen
    integer :: first, n

    first = self%offset(a - 1) + 1
    n = self%offset(b) + 1 - first
    if (n > 0) call prefetch_rows(self%dim + 1, n, self%basis(0, first), seen)
  end subroutine prefetch

  !> Velocity, increment and velocity gradient at a block of points, as of `mpm_g2p`.
  pure subroutine node_list_gather(self, kin, a, b, node_velocity, node_increment, velocity, &
                                   increment, gradient)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> First point.
    integer, intent(in) :: a
    !> Last point.
    integer, intent(in) :: b
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(in) :: node_velocity(*)
    !> Nodal velocity increments of the step. [m/s] (nvel, nn)
    real(wp), intent(in) :: node_increment(*)
    !> Velocity of the grid at the points. [m/s] (nvel, b - a + 1)
    real(wp), intent(inout) :: velocity(*)
    !> Velocity increment at the points. [m/s] (nvel, b - a + 1)
    real(wp), intent(inout) :: increment(*)
    !> Velocity gradient, components in the order of `kinematics_t`. [1/s] (ngrad, b - a + 1)
    real(wp), intent(inout) :: gradient(*)
    integer(int64) :: seen

    seen = 0
    if (self%is_far()) call self%prefetch(a, b, seen)
    select case (kin%sim_type)
    case (type_1d)
      call gather_1d(a, b, self%offset, self%node, self%basis, node_velocity, node_increment, &
                     velocity, increment, gradient)
    case (type_plane_strain)
      call gather_plane(a, b, self%offset, self%node, self%basis, node_velocity, node_increment, &
                        velocity, increment, gradient)
    case (type_3d)
      call gather_3d(a, b, self%offset, self%node, self%basis, node_velocity, node_increment, &
                     velocity, increment, gradient)
    case (type_axisymmetric)
      call gather_axisymmetric(a, b, self%offset, self%node, self%basis, node_velocity, &
                               node_increment, velocity, increment, gradient, self%radius, &
                               self%least_radius)
    case default
      call gather_out_of_plane(a, b, self%offset, self%node, self%basis, node_velocity, &
                               node_increment, velocity, increment, gradient)
    end select
  end subroutine node_list_gather

  !> Add what points share out by the values of the functions: s_i += sum_p S_ip q_p.
  subroutine node_list_add_values(self, threads, components, amount, sums)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Number of threads.
    integer, intent(in) :: threads
    !> Components of an amount.
    integer, intent(in) :: components
    !> Amounts. (components, n)
    real(wp), intent(in) :: amount(components, *)
    !> Nodal sums, added to. (components, nn)
    real(wp), intent(inout) :: sums(components, *)

    call self%add_range(threads, components, .false., amount, sums)
  end subroutine node_list_add_values

  !> Add what points share out by the gradients of the functions: s_i += sum_p q_p G_ip.
  subroutine node_list_add_gradients(self, threads, amount, sums)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Number of threads.
    integer, intent(in) :: threads
    !> Amounts. (n)
    real(wp), intent(in) :: amount(*)
    !> Nodal sums, added to. [1/m] (dim, nn)
    real(wp), intent(inout) :: sums(self%dim, *)

    call self%add_range(threads, self%dim, .true., amount, sums)
  end subroutine node_list_add_gradients

  !> Add all points in the order of the slabs.
  subroutine add_range(self, threads, components, by_gradient, amount, sums)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Number of threads.
    integer, intent(in) :: threads
    !> Components of a sum.
    integer, intent(in) :: components
    !> The factors of the (single) amount are gradients, otherwise values.
    logical, intent(in) :: by_gradient
    !> Amounts. (1 or components, n)
    real(wp), intent(in) :: amount(*)
    !> Nodal sums, added to. (components, nn)
    real(wp), intent(inout) :: sums(components, *)
    integer :: colour, s, b

    !$omp parallel default(none) num_threads(threads) private(colour, s, b) &
    !$omp shared(self, components, by_gradient, amount, sums)
    do colour = 1, 2
      !$omp do schedule(dynamic)
      do s = colour, ubound(self%slab, 1), 2
        do b = self%slab(s - 1) + 1, self%slab(s)
          if (.not. self%is_wide(b)) call add_block(b)
        end do
      end do
      !$omp end do
    end do
    !$omp single
    do b = 1, size(self%is_wide)
      if (self%is_wide(b)) call add_block(b)
    end do
    !$omp end single
    !$omp end parallel

  contains

    !> Add one block of points.
    subroutine add_block(block)
      !> Number of the block, from 1.
      integer, intent(in) :: block
      integer :: p, e

      do p = (block - 1)*list_block + 1, min(self%n, block*list_block)
        do e = self%offset(p - 1) + 1, self%offset(p)
          associate (i => self%node(e))
            if (by_gradient) then
              sums(:, i) = sums(:, i) + amount(p)*self%basis(1:, e)
            else
              sums(:, i) = sums(:, i) &
                           + self%basis(0, e)*amount((p - 1)*components + 1:p*components)
            end if
          end associate
        end do
      end do
    end subroutine add_block

  end subroutine add_range

  !> Interpolate a nodal field to points: q_p = sum_i S_ip q_i.
  pure subroutine node_list_values_at(self, a, b, components, field, values)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> First point.
    integer, intent(in) :: a
    !> Last point.
    integer, intent(in) :: b
    !> Components of the field.
    integer, intent(in) :: components
    !> Nodal field. (components, nn)
    real(wp), intent(in) :: field(components, *)
    !> Values at the points. (components, b - a + 1)
    real(wp), intent(out) :: values(components, b - a + 1)
    integer :: p, e

    values = 0.0_wp
    do p = a, b
      do e = self%offset(p - 1) + 1, self%offset(p)
        values(:, p - a + 1) = values(:, p - a + 1) + self%basis(0, e)*field(:, self%node(e))
      end do
    end do
  end subroutine node_list_values_at

  !> Gradients of a nodal field at points: sum_i G_ip q_i.
  pure subroutine node_list_gradients_at(self, a, b, field, gradients)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> First point.
    integer, intent(in) :: a
    !> Last point.
    integer, intent(in) :: b
    !> Nodal field. (nn)
    real(wp), intent(in) :: field(*)
    !> Gradients at the points. [1/m] (dim, b - a + 1)
    real(wp), intent(out) :: gradients(self%dim, b - a + 1)
    integer :: p, e

    gradients = 0.0_wp
    do p = a, b
      do e = self%offset(p - 1) + 1, self%offset(p)
        gradients(:, p - a + 1) = gradients(:, p - a + 1) + self%basis(1:, e)*field(self%node(e))
      end do
    end do
  end subroutine node_list_gradients_at

  !> Bytes that the lists hold.
  pure function node_list_memory(self) result(bytes)
    !> The lists.
    class(node_list_t), intent(in) :: self
    !> Bytes.
    integer(lp) :: bytes
    integer(lp) :: bits

    bits = 0
    if (allocated(self%offset)) bits = storage_size(1, lp)*size(self%offset, kind=lp)
    if (allocated(self%node)) then
      bits = bits + storage_size(1, lp)*size(self%node, kind=lp) &
             + storage_size(1.0_wp, lp)*size(self%basis, kind=lp)
    end if
    if (allocated(self%radius)) then
      bits = bits + storage_size(1.0_wp, lp)*size(self%radius, kind=lp)
    end if
    bytes = bits/8
  end function node_list_memory

#define NAME scatter_1d
#define GATHER gather_1d
#define DIM 1
#define NVEL 1
#define NSTRESS 3
#define NGRAD 1
#include "node_list_template.inc"
#undef NAME
#undef GATHER
#undef DIM
#undef NVEL
#undef NSTRESS
#undef NGRAD
#define NAME scatter_plane
#define GATHER gather_plane
#define DIM 2
#define NVEL 2
#define NSTRESS 4
#define NGRAD 4
#include "node_list_template.inc"
#undef NAME
#undef GATHER
#undef DIM
#undef NVEL
#undef NSTRESS
#undef NGRAD
#define NAME scatter_3d
#define GATHER gather_3d
#define DIM 3
#define NVEL 3
#define NSTRESS 6
#define NGRAD 9
#include "node_list_template.inc"
#undef NAME
#undef GATHER
#undef DIM
#undef NVEL
#undef NSTRESS
#undef NGRAD
#define NAME scatter_out_of_plane
#define GATHER gather_out_of_plane
#define DIM 2
#define NVEL 3
#define NSTRESS 6
#define NGRAD 6
#include "node_list_template.inc"
#undef NAME
#undef GATHER
#undef NGRAD
#define HOOP
#define NGRAD 8
#define NAME scatter_axisymmetric
#define GATHER gather_axisymmetric
#include "node_list_template.inc"
#undef HOOP
#undef NAME
#undef GATHER
#undef DIM
#undef NVEL
#undef NSTRESS
#undef NGRAD

end module mpm_node_list
