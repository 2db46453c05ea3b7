!> Scatter of all points of a body to its nodes on several threads.
!!
!! The points, ordered by cell, are cut into slabs of whole cell rows along the last direction. A
!! slab is at least as thick as a stencil reaches beyond it, so that all even slabs can be added at
!! once, then all odd ones: no two threads ever add to one node, and every sum is formed in the same
!! order for any number of threads. At the seams of periodic grids what went to ghosts of nodes is
!! then added to the nodes.
module mpm_scatter
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_p2g, only: p2g
  use mpm_seam, only: fold_ghosts
  use mpm_stencil, only: stencil_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: scatter

  !> Points in a slab, about; fewer would cost more in scheduling than they give.
  integer, parameter :: slab_points = 512
  !> Nodes that are set to 0 at once.
  integer, parameter :: clear_nodes = 64

contains

  !> Nodal mass, momentum and internal force of a body.
  subroutine scatter(kin, stencil, window, threads, n, order, row_offset, key, x, extent, mass, &
                     volume, velocity, stress, node_mass, node_momentum, node_force)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays; holds all stencils of the points.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Slots of the points in the order of their cells. (n)
    integer, intent(in) :: order(n)
    !> Points before each row of cells. (0:rows)
    integer, intent(in) :: row_offset(0:)
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(kin%dim, n)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Velocities. [m/s] (nvel, n)
    real(wp), intent(in) :: velocity(kin%nvel, n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(in) :: stress(kin%nstress, n)
    !> Nodal masses. [kg] (nn)
    real(wp), contiguous, intent(inout) :: node_mass(:)
    !> Nodal momenta. [kg m/s] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_momentum(:, :)
    !> Nodal forces. [N] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_force(:, :)
    integer :: rows, thickness, slabs, slab, colour, first, last, nodes

    rows = ubound(row_offset, 1)
    nodes = window%size()
    thickness = max(stencil%width - 1, int((int(slab_points, lp)*rows)/max(n, 1)))
    slabs = (rows + thickness - 1)/thickness
    !$omp parallel default(none) num_threads(threads) &
    !$omp shared(kin, stencil, window, order, row_offset, key, x, extent, mass, volume, velocity) &
    !$omp shared(stress, node_mass, node_momentum, node_force, rows, thickness, slabs, nodes) &
    !$omp private(slab, colour, first, last)
    !$omp do schedule(static)
    do first = 1, nodes, clear_nodes
      last = min(nodes, first + clear_nodes - 1)
      call clear(last - first + 1, node_mass(first:last))
      call clear(kin%nvel*(last - first + 1), node_momentum(:, first:last))
      call clear(kin%nvel*(last - first + 1), node_force(:, first:last))
    end do
    !$omp end do
    do colour = 0, 1
      !$omp do schedule(dynamic)
      do slab = colour, slabs - 1, 2
        first = row_offset(slab*thickness)
        last = row_offset(min(rows, (slab + 1)*thickness))
        call p2g(kin, stencil, window, last - first, order(first + 1:last), key, x, extent, mass, &
                 volume, velocity, stress, node_mass, node_momentum, node_force)
      end do
      !$omp end do
    end do
    !$omp end parallel
    if (.not. any(stencil%periodic)) return
    call fold_ghosts(stencil, window, 1, node_mass)
    call fold_ghosts(stencil, window, kin%nvel, node_momentum)
    call fold_ghosts(stencil, window, kin%nvel, node_force)
  end subroutine scatter

  !> Set numbers that follow each other to 0.
  pure subroutine clear(n, values)
    !> How many.
    integer, intent(in) :: n
    !> The numbers.
    real(wp), intent(out) :: values(n)

    values = 0.0_wp
  end subroutine clear

end module mpm_scatter
