!> Overshoot of the volumes of points at the nodes: where a quadrature counts space twice.
!!
!! With V_i the volume of the grid that belongs to node i (TYPE 4: its area in the meridian plane),
!! H_i = max(0, sum_p S_ip V_p - V_i) and e_i = H_i/V_i. Exact quadrature has H_i = 0 at all nodes.
module mpm_volume_overshoot
  use mpm_g2p, only: g2p
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_momentum, only: add_momentum
  use mpm_nodal_volume, only: nodal_volume
  use mpm_point_domains, only: point_domains_t
  use mpm_points, only: points_t
  use mpm_seam, only: copy_to_ghosts
  use mpm_stencil, only: axis_fraction, block_size, outside
  use mpm_threads, only: useful_threads
  use mpm_window, only: window_t
  implicit none
  private
  public :: gradients_at, measure_overshoot, overshoot_t, shared_volume

  !> Overshoot at the nodes that the points of a body reach.
  type :: overshoot_t
    !> Those nodes.
    type(window_t) :: window
    !> Volume of the grid that belongs to each node. [m3] (nn)
    real(wp), allocatable :: own(:)
    !> What the points have in excess of it. [m3] (nn)
    real(wp), allocatable :: excess(:)
    !> The same over the volume of the node. (nn)
    real(wp), allocatable :: relative(:)
    !> The domains of the points, with lists of their nodes; only of points that have domains.
    type(point_domains_t), allocatable :: domains
  end type overshoot_t

contains

  !> Overshoot of the points of a body at their present positions.
  subroutine measure_overshoot(points, grid, overshoot, threads)
    !> The points, with keys of their positions.
    class(points_t), intent(in) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The overshoot; of no node when no point is inside.
    type(overshoot_t), intent(out) :: overshoot
    !> Number of threads, for points in the order of their cells; otherwise they may have any.
    integer, intent(in), optional :: threads
    real(wp), allocatable :: filled(:)
    integer :: i, n

    if (allocated(points%domains)) then
      call fill_by_domains(points, overshoot, filled, threads)
    else
      overshoot%window = points%reach()
      allocate (filled(overshoot%window%size()))
      call fill_nodes(points, overshoot%window, filled, threads)
    end if
    n = size(filled)
    allocate (overshoot%own(n), overshoot%excess(n), overshoot%relative(n))
    do i = 1, n
      overshoot%own(i) = grid%node_volume(overshoot%window%node(i))
      overshoot%excess(i) = max(0.0_wp, filled(i) - overshoot%own(i))
      overshoot%relative(i) = overshoot%excess(i)/overshoot%own(i)
    end do
  end subroutine measure_overshoot

  !> Volume of points as nodes see it, sum_p S_ip V_p.
  subroutine fill_nodes(points, window, filled, threads)
    !> The points.
    class(points_t), intent(in) :: points
    !> The nodes that they reach.
    type(window_t), intent(in) :: window
    !> Volumes. [m3] (nn)
    real(wp), intent(out) :: filled(:)
    !> Number of threads, for points in the order of their cells.
    integer, intent(in), optional :: threads
    real(wp), allocatable :: sums(:, :), one(:, :)
    integer, allocatable :: order(:)
    integer :: n, p

    n = points%n_inside
    if (n == 0 .or. size(filled) == 0) then
      filled = 0.0_wp
    else if (present(threads)) then
      allocate (one(points%kin%nvel, n), sums(points%kin%nvel, size(filled)))
      one = 1.0_wp
      sums = 0.0_wp
      call add_momentum(points%kin, points%stencil, window, useful_threads(threads, n), n, &
                        points%order(:n), points%row_offset, points%key(:n), points%x(:, :n), &
                        points%extent(:n), shared_volume(points, 1, n), sums, velocity=one)
      filled = sums(1, :)
    else
      order = [(p, p=1, n)]
      call nodal_volume(points%kin, points%stencil, window, n, order, points%x, points%extent, &
                        points%volume, .true., filled)
    end if
  end subroutine fill_nodes

  !> Volume as nodes see it of points with domains, which are kept with the lists of their nodes.
  subroutine fill_by_domains(points, overshoot, filled, threads)
    !> The points.
    class(points_t), intent(in) :: points
    !> Receives the window and the domains.
    type(overshoot_t), intent(inout) :: overshoot
    !> Volumes. [m3] (nn)
    real(wp), allocatable, intent(out) :: filled(:)
    !> Number of threads; one when left out.
    integer, intent(in), optional :: threads
    real(wp), allocatable :: sums(:, :), volume(:)
    integer :: n, workers

    n = points%n_inside
    workers = 1
    if (present(threads)) workers = useful_threads(threads, n)
    allocate (overshoot%domains)
    associate (domains => overshoot%domains)
      ! All but the lists, which belong to the positions of the last mapping.
      domains%rule = points%domains%rule
      domains%dim = points%domains%dim
      domains%side = points%domains%side
      if (allocated(points%domains%stretch)) domains%stretch = points%domains%stretch
      if (allocated(points%domains%corner)) domains%corner = points%domains%corner
      call domains%place(points%stencil, workers, n, points%x(:, :n), overshoot%window)
      allocate (sums(1, overshoot%window%size()), source=0.0_wp)
      if (n > 0) then
        call domains%make_lists(points%kin, points%stencil, workers, n, points%x(:, :n), &
                                overshoot%window)
        allocate (volume, source=shared_volume(points, 1, n))
        where (points%key(:n) == outside) volume = 0.0_wp
        call domains%list%add_values(workers, 1, volume, sums)
      end if
    end associate
    allocate (filled, source=sums(1, :))
  end subroutine fill_by_domains

  !> What points share out among nodes: their volumes, in TYPE 4 their areas in the meridian plane.
  pure function shared_volume(points, first, last) result(volume)
    !> The points.
    class(points_t), intent(in) :: points
    !> First slot.
    integer, intent(in) :: first
    !> Last slot.
    integer, intent(in) :: last
    !> Volumes. [m3]
    real(wp) :: volume(last - first + 1)

    volume = points%volume(first:last)
    if (points%kin%sim_type == type_axisymmetric) then
      volume = volume/max(points%x(1, first:last), axis_fraction*points%stencil%h(1))
    end if
  end function shared_volume

  !> Gradients of a nodal field at the points inside the grid, sum_i G_ip f_i.
  subroutine gradients_at(points, overshoot, field, threads, gradient)
    !> The points, with keys of their positions.
    class(points_t), intent(in) :: points
    !> Overshoot at the present positions, for the nodes that the points reach.
    type(overshoot_t), intent(in) :: overshoot
    !> Values at these nodes, anything at ghosts. (nn)
    real(wp), intent(in) :: field(:)
    !> Number of threads.
    integer, intent(in) :: threads
    !> Gradients, 0 for points that have left the grid; what is behind `n_inside` stays.
    !! (dim, at least n_inside)
    real(wp), intent(inout) :: gradient(:, :)
    real(wp), allocatable :: values(:, :)
    integer :: first

    if (points%n_inside == 0) return
    if (allocated(overshoot%domains)) then
      !$omp parallel do default(none) schedule(static) shared(points, overshoot, field, gradient) &
      !$omp num_threads(useful_threads(threads, points%n_inside)) private(first)
      do first = 1, points%n_inside, block_size
        call gradients_by_lists(points, overshoot%domains, field, first, gradient)
      end do
      !$omp end parallel do
      return
    end if
    allocate (values(points%kin%nvel, size(field)), source=0.0_wp)
    values(1, :) = field
    if (any(points%stencil%periodic)) then
      call copy_to_ghosts(points%stencil, overshoot%window, points%kin%nvel, values)
    end if
    !$omp parallel do default(none) schedule(static) shared(points, overshoot, values, gradient) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) private(first)
    do first = 1, points%n_inside, block_size
      call gradients_of_block(points, overshoot%window, values, first, gradient)
    end do
    !$omp end parallel do
  end subroutine gradients_at

  !> Gradients at one block of points with domains.
  subroutine gradients_by_lists(points, domains, field, first, gradient)
    !> The points.
    class(points_t), intent(in) :: points
    !> Their domains, with lists.
    type(point_domains_t), intent(in) :: domains
    !> Values at the nodes. (nn)
    real(wp), intent(in) :: field(:)
    !> First slot of the block.
    integer, intent(in) :: first
    !> Gradients. (dim, n_inside)
    real(wp), intent(inout) :: gradient(:, :)
    integer :: p, last

    last = min(first + block_size - 1, points%n_inside)
    call domains%list%gradients_at(first, last, field, gradient(:, first:last))
    do p = first, last
      if (points%key(p) == outside) gradient(:, p) = 0.0_wp
    end do
  end subroutine gradients_by_lists

  !> Gradients at one block of points.
  subroutine gradients_of_block(points, window, values, first, gradient)
    !> The points.
    class(points_t), intent(in) :: points
    !> Window of the field.
    type(window_t), intent(in) :: window
    !> The field as the first component of a vector. (nvel, nn)
    real(wp), contiguous, intent(in) :: values(:, :)
    !> First slot of the block.
    integer, intent(in) :: first
    !> Gradients. (dim, n_inside)
    real(wp), intent(inout) :: gradient(:, :)
    real(wp) :: x(3*block_size), extent(block_size)
    real(wp) :: unused(3*block_size), same(3*block_size), slopes(9*block_size)
    integer :: key(block_size), slot(block_size), p, j, n

    n = 0
    do p = first, min(first + block_size - 1, points%n_inside)
      gradient(:, p) = 0.0_wp
      if (points%key(p) == outside) cycle
      n = n + 1
      slot(n) = p
      key(n) = points%key(p)
      extent(n) = points%extent(p)
      x((n - 1)*points%kin%dim + 1:n*points%kin%dim) = points%x(:, p)
    end do
    if (n == 0) return
    associate (kin => points%kin)
      call g2p(kin, points%stencil, window, n, key, x, extent, values, values, unused, same, slopes)
      do j = 1, n
        gradient(:, slot(j)) = slopes((j - 1)*kin%ngrad + 1:(j - 1)*kin%ngrad + kin%dim)
      end do
    end associate
  end subroutine gradients_of_block

end module mpm_volume_overshoot
