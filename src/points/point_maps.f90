!> Maps between the points of a body and its nodes, by the basis that the points have.
!!
!! Points with domains have lists of nodes (`mpm_node_list`), all others stencils (`mpm_stencil`).
module mpm_point_maps
  use, intrinsic :: iso_fortran_env, only: lp => int64
  use mpm_g2p, only: g2p
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_mass_gradient, only: mass_gradient
  use mpm_mesh_lists, only: list_nodes_of_cells
  use mpm_momentum, only: add_momentum
  use mpm_nodal_volume, only: nodal_volume
  use mpm_points, only: points_t
  use mpm_prefetch, only: prefetch_batch, prefetch_rows
  use mpm_scatter, only: scatter
  use mpm_stencil, only: axis_fraction, basis_hat, natural_width, stencil_t
  use mpm_threads, only: useful_threads
  use mpm_window, only: window_t
  implicit none
  private
  public :: interpolate_points, list_mesh_nodes, map_mass_gradient, map_momentum, map_points
  public :: map_volume

contains

  !> List the nodes of the points inside a mesh.
  subroutine list_mesh_nodes(points, threads, window)
    !> The points, with keys.
    class(points_t), intent(inout) :: points
    !> Number of threads.
    integer, intent(in) :: threads
    !> The nodes that the points reach; none when no point is inside.
    type(window_t), intent(out) :: window
    integer :: n

    n = points%n_inside
    associate (stencil => points%stencil, domains => points%domains)
      if (n > 0) then
        call list_nodes_of_cells(stencil%mesh, useful_threads(threads, n), stencil%averaged, n, &
                                 points%x(:, :n), points%extent(:n), points%key(:n), &
                                 domains%corner_cell, domains%list, window)
        if (points%kin%sim_type == type_axisymmetric) then
          domains%list%radius = points%x(1, :n)
          domains%list%least_radius = axis_fraction*stencil%h(1)
        end if
      end if
      domains%window = window
    end associate
  end subroutine list_mesh_nodes

  !> Nodal mass, momentum and internal force of the points inside the grid.
  subroutine map_points(points, window, threads, velocity, stress, node_mass, node_momentum, &
                        node_force)
    !> The points, with lists or sorted by cell.
    class(points_t), intent(in) :: points
    !> Window of the node arrays; holds all nodes of the points.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Velocities that give the momenta. [m/s] (nvel, n_inside)
    real(wp), contiguous, intent(in) :: velocity(:, :)
    !> Stresses that give the forces. [Pa] (nstress, n_inside)
    real(wp), contiguous, intent(in) :: stress(:, :)
    !> Nodal masses. [kg] (nn)
    real(wp), contiguous, intent(inout) :: node_mass(:)
    !> Nodal momenta. [kg m/s] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_momentum(:, :)
    !> Nodal forces. [N] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_force(:, :)
    integer :: n

    n = points%n_inside
    if (allocated(points%domains)) then
      call points%domains%list%scatter(points%kin, useful_threads(threads, n), points%mass, &
                                       points%volume, velocity, stress, node_mass, node_momentum, &
                                       node_force)
    else
      call scatter(points%kin, points%stencil, window, useful_threads(threads, n), n, &
                   points%order(:n), points%row_offset, points%key(:n), points%x(:, :n), &
                   points%extent(:n), points%mass(:n), points%volume(:n), velocity, stress, &
                   node_mass, node_momentum, node_force)
    end if
  end subroutine map_points

  !> Add the momenta of the points inside the grid for given velocities.
  subroutine map_momentum(points, window, threads, node_momentum, velocity, affine)
    !> The points, with lists or sorted by cell.
    class(points_t), intent(in) :: points
    !> Window of the node arrays; holds all nodes of the points.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Nodal momenta, added to; 0 at ghosts. [kg m/s] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_momentum(:, :)
    !> Velocities, 0 when left out. [m/s] (nvel, n_inside)
    real(wp), contiguous, intent(in), optional :: velocity(:, :)
    !> Gradients of the points' own velocities; not for points with domains. [1/s]
    !! (nvel dim, n_inside)
    real(wp), contiguous, intent(in), optional :: affine(:, :)
    real(wp), allocatable :: momentum(:, :)
    integer :: n, p

    n = points%n_inside
    ! gfortran reads the first element of an array that is not there when it passes it on.
    if (.not. allocated(points%domains) .and. present(affine) .and. present(velocity)) then
      call add_momentum(points%kin, points%stencil, window, useful_threads(threads, n), n, &
                        points%order(:n), points%row_offset, points%key(:n), points%x(:, :n), &
                        points%extent(:n), points%mass(:n), node_momentum, velocity, affine)
    else if (.not. allocated(points%domains) .and. present(affine)) then
      call add_momentum(points%kin, points%stencil, window, useful_threads(threads, n), n, &
                        points%order(:n), points%row_offset, points%key(:n), points%x(:, :n), &
                        points%extent(:n), points%mass(:n), node_momentum, affine=affine)
    else if (.not. allocated(points%domains)) then
      call add_momentum(points%kin, points%stencil, window, useful_threads(threads, n), n, &
                        points%order(:n), points%row_offset, points%key(:n), points%x(:, :n), &
                        points%extent(:n), points%mass(:n), node_momentum, velocity)
    else if (present(velocity)) then
      allocate (momentum(points%kin%nvel, n))
      do p = 1, n
        momentum(:, p) = points%mass(p)*velocity(:, p)
      end do
      call points%domains%list%add_values(useful_threads(threads, n), points%kin%nvel, momentum, &
                                          node_momentum)
    end if
  end subroutine map_momentum

  !> Interpolate to one block of points.
  subroutine interpolate_points(points, stencil, window, a, b, node_velocity, node_increment, &
                                velocity, increment, gradient)
    !> The points.
    class(points_t), intent(in) :: points
    !> Basis of points without domains.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays; holds all nodes of the points.
    type(window_t), intent(in) :: window
    !> First slot.
    integer, intent(in) :: a
    !> Last slot; the kernels take blocks of at most `block_size` points.
    integer, intent(in) :: b
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), contiguous, intent(in) :: node_velocity(:, :)
    !> Nodal velocity increments. [m/s] (nvel, nn)
    real(wp), contiguous, intent(in) :: node_increment(:, :)
    !> Velocity of the grid at the points. [m/s] (nvel, b - a + 1)
    real(wp), intent(inout) :: velocity(points%kin%nvel*(b - a + 1))
    !> Velocity increment at the points. [m/s] (nvel, b - a + 1)
    real(wp), intent(inout) :: increment(points%kin%nvel*(b - a + 1))
    !> Velocity gradient, components in the order of `kinematics_t`. [1/s] (ngrad, b - a + 1)
    real(wp), intent(inout) :: gradient(points%kin%ngrad*(b - a + 1))
    integer(lp) :: seen
    integer :: dim, batch, i, j, v, g
    logical :: listed, ahead

    listed = allocated(points%domains)
    dim = points%kin%dim
    if (listed) then
      ahead = points%domains%list%is_far()
    else
      ! The many nodes of wider stencils in 3D are arithmetic that the memory hardly delays.
      ahead = dim == 2 .or. (dim == 3 .and. stencil%width == 2)
    end if
    batch = max(b - a + 1, 1)
    if (ahead) batch = prefetch_batch(dim)
    seen = 0
    do i = a, b, batch
      j = min(i + batch - 1, b)
      if (ahead) call prefetch_points(points, i, j, seen)
      v = points%kin%nvel*(i - a) + 1
      g = points%kin%ngrad*(i - a) + 1
      if (listed) then
        call points%domains%list%gather(points%kin, i, j, node_velocity, node_increment, &
                                        velocity(v:), increment(v:), gradient(g:))
      else
        call g2p(points%kin, stencil, window, j - i + 1, points%key(i:j), points%x(:, i:j), &
                 points%extent(i:j), node_velocity, node_increment, velocity(v:), increment(v:), &
                 gradient(g:))
      end if
    end do
  end subroutine interpolate_points

  !> Ask for the fields that a step changes of the points after some.
  pure subroutine prefetch_points(points, a, b, seen)
    !> The points.
    class(points_t), intent(in) :: points
    !> First slot.
    integer, intent(in) :: a
    !> Last slot.
    integer, intent(in) :: b
    !> See `prefetch_rows`.
    integer(lp), intent(inout) :: seen
    integer :: n

    n = b - a + 1
    call prefetch_rows(points%kin%dim, n, points%x(1, a), seen)
    call prefetch_rows(points%kin%nvel, n, points%velocity(1, a), seen)
    call prefetch_rows(points%kin%nvel, n, points%displacement(1, a), seen)
    call prefetch_rows(1, n, points%volume(a), seen)
    call prefetch_rows(points%kin%nstress, n, points%stress(1, a), seen)
    if (size(points%history, 1) > 0) then
      call prefetch_rows(size(points%history, 1), n, points%history(1, a), seen)
    end if
  end subroutine prefetch_points

  !> N_i = sum_p m_p grad N_i(x_p) at the nodes of a part of the grid; in TYPE 4 with m_p/r_p.
  subroutine map_mass_gradient(points, part, gradient)
    !> The points, with lists or sorted by cell.
    class(points_t), intent(in) :: points
    !> The nodes wanted; where the points have lists, nodes of their window.
    type(window_t), intent(in) :: part
    !> Gradients, components beyond dim 0. [kg/m] (nvel, nn)
    real(wp), intent(out) :: gradient(:, :)
    real(wp), allocatable :: amount(:), sums(:, :)
    integer :: n, dim

    n = points%n_inside
    dim = points%kin%dim
    if (.not. allocated(points%domains)) then
      call mass_gradient(points%kin, points%stencil, part, n, points%order(:n), &
                         points%row_offset, points%lo(dim), points%key(:n), points%x(:, :n), &
                         points%extent(:n), points%mass(:n), gradient)
      return
    end if
    amount = points%mass(:n)
    if (points%kin%sim_type == type_axisymmetric) then
      amount = amount/max(points%x(1, :n), axis_fraction*points%stencil%h(1))
    end if
    gradient = 0.0_wp
    associate (domains => points%domains)
      allocate (sums(dim, domains%window%size()), source=0.0_wp)
      call domains%list%add_gradients(1, amount, sums)
      call copy_part(dim, domains%window, sums, part, gradient)
    end associate
  end subroutine map_mass_gradient

  !> Volume of the points at the nodes of a part of the grid, sum_p S_ip V_p.
  subroutine map_volume(points, part, per_radius, node_volume, by_hats)
    !> The points, with lists or sorted by cell.
    class(points_t), intent(in) :: points
    !> The nodes that are asked for.
    type(window_t), intent(in) :: part
    !> TYPE 4: count the meridian areas V_p/r_p instead of the volumes per radian.
    logical, intent(in) :: per_radius
    !> Volumes at the nodes of `part`. [m3] (part%size())
    real(wp), intent(out) :: node_volume(:)
    !> Take hats at the points in place of the functions of a smoother basis; false when left out.
    logical, intent(in), optional :: by_hats
    real(wp), allocatable :: amount(:), sums(:, :), wanted(:, :)
    type(stencil_t) :: stencil
    integer :: n, first, last

    stencil = points%stencil
    if (present(by_hats)) then
      if (by_hats .and. stencil%kind /= basis_hat) then
        stencil%kind = basis_hat
        stencil%width = natural_width(basis_hat)
        stencil%averaged = .false.
      end if
    end if
    if (.not. allocated(points%domains) .or. stencil%kind /= points%stencil%kind) then
      first = 1
      last = points%n_inside
      if (.not. allocated(points%domains)) call points_near(points, part, first, last)
      call nodal_volume(points%kin, stencil, part, last - first + 1, points%order(first:last), &
                        points%x, points%extent, points%volume, per_radius, node_volume)
      return
    end if
    n = points%n_inside
    amount = points%volume(:n)
    if (per_radius .and. points%kin%sim_type == type_axisymmetric) then
      amount = amount/max(points%x(1, :n), axis_fraction*points%stencil%h(1))
    end if
    associate (domains => points%domains)
      allocate (sums(1, domains%window%size()), wanted(1, size(node_volume)), source=0.0_wp)
      call domains%list%add_values(1, 1, amount, sums)
      call copy_part(1, domains%window, sums, part, wanted)
    end associate
    node_volume = wanted(1, :)
  end subroutine map_volume

  !> The range in the order of cells that has all points which reach a part of the grid.
  pure subroutine points_near(points, part, first, last)
    !> The points, in order.
    class(points_t), intent(in) :: points
    !> The nodes.
    type(window_t), intent(in) :: part
    !> First of the points.
    integer, intent(out) :: first
    !> Last of the points; before the first when there are none.
    integer, intent(out) :: last
    integer :: low, high

    first = 1
    last = points%n_inside
    if (last == 0 .or. any(points%stencil%periodic)) return
    associate (d => points%stencil%dim)
      low = max(0, part%lo(d) - points%stencil%width + 1 - points%lo(d))
      high = min(ubound(points%row_offset, 1) - 1, part%lo(d) + part%n(d) - 1 - points%lo(d))
    end associate
    last = 0
    if (high < low) return
    first = points%row_offset(low) + 1
    last = points%row_offset(high + 1)
  end subroutine points_near

  !> Copy the values of the nodes that two windows share.
  pure subroutine copy_part(components, window, values, part, wanted)
    !> Components of a value.
    integer, intent(in) :: components
    !> Window of the values.
    type(window_t), intent(in) :: window
    !> Values. (components, nn)
    real(wp), intent(in) :: values(:, :)
    !> The other window.
    type(window_t), intent(in) :: part
    !> Its values; those of other nodes stay, as do further components. (any, nn)
    real(wp), intent(inout) :: wanted(:, :)
    integer :: i, j, k, hi(3)

    hi = part%hi()
    do k = part%lo(3), hi(3)
      do j = part%lo(2), hi(2)
        do i = part%lo(1), hi(1)
          if (.not. window%holds([i, j, k])) cycle
          wanted(:components, part%index([i, j, k])) = &
            values(:components, window%index([i, j, k]))
        end do
      end do
    end do
  end subroutine copy_part

end module mpm_point_maps
