!> What a pore fluid sees of the grains between which it flows: its share of the volume at the
!! nodes, and at its points that share and the rate at which the grains squeeze it.
module mpm_pore_fluid
  use mpm_advance, only: trace_of_gradient
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_nodes, only: nodes_t
  use mpm_point_maps, only: interpolate_points, map_momentum
  use mpm_points, only: points_t
  use mpm_seam, only: copy_to_ghosts
  use mpm_stencil, only: axis_fraction, block_size
  use mpm_threads, only: useful_threads
  use mpm_window, only: intersect, window_t
  implicit none
  private
  public :: find_porosity, lowest_porosity, observe_grains, points_of_nodes

  !> The fluid keeps this share of the volume, however close the grains are.
  real(wp), parameter :: lowest_porosity = 0.01_wp

contains

  !> Porosity at nodes, n_i = 1 - m_i/(rho V_i) with the mass of the grains, at least 0.01.
  !!
  !! In TYPE 4 V_i is an area of the meridian plane, and the masses are sum_p S_ip m_p/r_p. Nodes
  !! that no grains reach, and those of no volume, have n = 1.
  subroutine find_porosity(grid, density, grains, grain_nodes, window, threads, porosity)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Density of the grains. [kg/m3]
    real(wp), intent(in) :: density
    !> Points of the grains, mapped.
    class(points_t), intent(in) :: grains
    !> Their nodes.
    class(nodes_t), intent(in) :: grain_nodes
    !> The nodes that are asked for.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Porosity at these nodes. (nn)
    real(wp), intent(out) :: porosity(:)
    type(window_t) :: both
    real(wp), allocatable :: mass(:)
    integer :: i, j, k, node(3), hi(3), here
    real(wp) :: volume

    porosity = 1.0_wp
    both = intersect(window, grain_nodes%window)
    if (both%size() == 0 .or. grains%n_inside == 0) return
    call meridian_mass(grains, grain_nodes, threads, mass)
    hi = both%hi()
    !$omp parallel do collapse(2) default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, both%size())) &
    !$omp shared(grid, density, grain_nodes, window, porosity, mass, both, hi) &
    !$omp private(i, j, k, node, here, volume)
    do k = both%lo(3), hi(3)
      do j = both%lo(2), hi(2)
        do i = both%lo(1), hi(1)
          node = [i, j, k]
          here = grain_nodes%window%index(node)
          if (.not. mass(here) > 0.0_wp) cycle
          volume = grid%node_volume(node)
          if (.not. volume > 0.0_wp) cycle
          porosity(window%index(node)) = max(lowest_porosity, 1.0_wp - mass(here)/(volume*density))
        end do
      end do
    end do
    !$omp end parallel do
  end subroutine find_porosity

  !> Nodal masses for the volumes that the grid has: in TYPE 4 those of the meridian plane.
  subroutine meridian_mass(points, nodes, threads, mass)
    !> Points, mapped.
    class(points_t), intent(in) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Number of threads.
    integer, intent(in) :: threads
    !> Masses, in TYPE 4 sum_p S_ip m_p/r_p. [kg, kg/m] (nn)
    real(wp), allocatable, intent(out) :: mass(:)
    real(wp), allocatable :: sums(:, :), weight(:, :)
    integer :: n, nn

    nn = nodes%window%size()
    allocate (mass(nn))
    mass(:) = nodes%mass(:nn)
    if (points%kin%sim_type /= type_axisymmetric) return
    n = points%n_inside
    allocate (sums(points%kin%nvel, nn), weight(points%kin%nvel, n), source=0.0_wp)
    weight(1, :) = 1.0_wp/max(points%x(1, :n), axis_fraction*points%stencil%h(1))
    call map_momentum(points, nodes%window, threads, sums, velocity=weight)
    mass(:) = sums(1, :)
  end subroutine meridian_mass

  !> What the points of a fluid see of the grains.
  !!
  !! The volumes of grains that do not change balance for n d(ln J)/dt = div((1 - n) v_s + n v_f),
  !! J the volume of the fluid itself: n_p = sum_i S_ip n_i, and d(ln J)/dt exceeds the rate of
  !! volume of the point, div v_f, by div(...)/n_p - div v_f.
  subroutine observe_grains(grid, density, fluid, fluid_nodes, grains, grain_nodes, remapped, &
                            threads, porosity, excess)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Density of the grains. [kg/m3]
    real(wp), intent(in) :: density
    !> Points of the fluid, mapped and not moved since.
    class(points_t), intent(in) :: fluid
    !> Their nodes, with the velocities from which strain rates will be formed.
    class(nodes_t), intent(in) :: fluid_nodes
    !> Points of the grains, in the same state.
    class(points_t), intent(in) :: grains
    !> Their nodes.
    class(nodes_t), intent(in) :: grain_nodes
    !> Strain rates will be formed from the velocities of the second mapping.
    logical, intent(in) :: remapped
    !> Number of threads.
    integer, intent(in) :: threads
    !> Share of the fluid in the volume. (n_inside)
    real(wp), intent(out) :: porosity(:)
    !> What the rate of the fluid's own volume exceeds div v_f by. [1/s] (n_inside)
    real(wp), intent(out) :: excess(:)
    real(wp), allocatable :: n(:), flux(:, :), share(:, :), own(:, :), trace(:)
    integer :: nn, nvel

    porosity = 1.0_wp
    excess = 0.0_wp
    if (fluid%n_inside == 0) return
    nn = fluid_nodes%window%size()
    nvel = fluid%kin%nvel
    allocate (n(nn), flux(nvel, nn), own(nvel, nn), trace(fluid%n_inside))
    allocate (share(nvel, nn), source=0.0_wp)
    call find_porosity(grid, density, grains, grain_nodes, fluid_nodes%window, threads, n)
    if (remapped) then
      own(:, :) = fluid_nodes%remapped(:, :nn)
      flux(:, :) = own
      call add_grains(n, fluid_nodes, grain_nodes, grain_nodes%remapped, flux)
    else
      own(:, :) = fluid_nodes%velocity(:, :nn)
      flux(:, :) = own
      call add_grains(n, fluid_nodes, grain_nodes, grain_nodes%velocity, flux)
    end if
    share(1, :) = n
    if (any(fluid%stencil%periodic)) then
      call copy_to_ghosts(fluid%stencil, fluid_nodes%window, nvel, own)
      call copy_to_ghosts(fluid%stencil, fluid_nodes%window, nvel, flux)
      call copy_to_ghosts(fluid%stencil, fluid_nodes%window, nvel, share)
    end if
    call points_of_nodes(fluid, fluid_nodes%window, threads, flux, share, excess, porosity)
    call points_of_nodes(fluid, fluid_nodes%window, threads, own, share, trace, porosity)
    ! Where all nodes are free of grains the sum of their functions may be 1 but for a rounding.
    where (porosity < 1.0_wp - 64.0_wp*epsilon(1.0_wp))
      excess = excess/porosity - trace
    else where
      porosity = 1.0_wp
      excess = 0.0_wp
    end where
  end subroutine observe_grains

  !> Turn the velocities of a fluid into those of the mixture, (1 - n) v_s + n v_f.
  pure subroutine add_grains(n, fluid_nodes, grain_nodes, grain_velocity, flux)
    !> Porosity. (nn)
    real(wp), intent(in) :: n(:)
    !> Nodes of the fluid.
    class(nodes_t), intent(in) :: fluid_nodes
    !> Nodes of the grains.
    class(nodes_t), intent(in) :: grain_nodes
    !> Velocities of the grains. [m/s] (nvel, any)
    real(wp), intent(in) :: grain_velocity(:, :)
    !> Velocities of the fluid, then those of the mixture. [m/s] (nvel, nn)
    real(wp), intent(inout) :: flux(:, :)
    type(window_t) :: both
    integer :: i, j, k, node(3), hi(3), here, there

    both = intersect(fluid_nodes%window, grain_nodes%window)
    hi = both%hi()
    do k = both%lo(3), hi(3)
      do j = both%lo(2), hi(2)
        do i = both%lo(1), hi(1)
          node = [i, j, k]
          here = fluid_nodes%window%index(node)
          there = grain_nodes%window%index(node)
          if (.not. fluid_nodes%mass(here) > 0.0_wp) cycle
          if (.not. grain_nodes%mass(there) > 0.0_wp) cycle
          flux(:, here) = (1.0_wp - n(here))*grain_velocity(:, there) + n(here)*flux(:, here)
        end do
      end do
    end do
  end subroutine add_grains

  !> Divergence of one nodal field and first component of another at all points inside.
  subroutine points_of_nodes(points, window, threads, field, share, divergence, values)
    !> The points, mapped and not moved since.
    class(points_t), intent(in) :: points
    !> Window of the nodal fields.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Field of vectors. (nvel, nn)
    real(wp), contiguous, intent(in) :: field(:, :)
    !> Field of numbers in its first component. (nvel, nn)
    real(wp), contiguous, intent(in) :: share(:, :)
    !> Divergence at the points. (n_inside)
    real(wp), intent(out) :: divergence(:)
    !> Numbers at the points. (n_inside)
    real(wp), intent(out) :: values(:)
    integer :: first, last

    !$omp parallel do default(none) schedule(static) private(last) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) &
    !$omp shared(points, window, field, share, divergence, values)
    do first = 1, points%n_inside, block_size
      last = min(first + block_size - 1, points%n_inside)
      call block_of_nodes(points, window, first, last, field, share, divergence(first:last), &
                          values(first:last))
    end do
    !$omp end parallel do
  end subroutine points_of_nodes

  !> The same for one block of points.
  subroutine block_of_nodes(points, window, a, b, field, share, divergence, values)
    !> The points.
    class(points_t), intent(in) :: points
    !> Window of the nodal fields.
    type(window_t), intent(in) :: window
    !> First slot.
    integer, intent(in) :: a
    !> Last slot.
    integer, intent(in) :: b
    !> Field of vectors. (nvel, nn)
    real(wp), contiguous, intent(in) :: field(:, :)
    !> Field of numbers in its first component. (nvel, nn)
    real(wp), contiguous, intent(in) :: share(:, :)
    !> Divergence at the points. (b - a + 1)
    real(wp), intent(out) :: divergence(:)
    !> Numbers at the points. (b - a + 1)
    real(wp), intent(out) :: values(:)
    real(wp) :: unused(3*block_size), shares(3*block_size), gradient(9*block_size)
    integer :: n, nvel

    n = b - a + 1
    nvel = points%kin%nvel
    call interpolate_points(points, points%stencil, window, a, b, field, share, unused, shares, &
                            gradient)
    call trace_of_gradient(points%kin, n, gradient, divergence)
    values = shares(1:nvel*n:nvel)
  end subroutine block_of_nodes

end module mpm_pore_fluid
