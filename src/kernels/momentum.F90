!> Particle-to-grid scatter of momenta alone, on several threads.
!!
!! It serves mappings beside the one that forms mass, momentum and force: P_i += sum_p m_p N_i(x_p)
!! (v_p + C_p (x_i - x_p)), with C_p = 0 unless points have an affine field of velocities. Slabs of
!! cell rows are coloured as in mpm_scatter, so that sums do not depend on the number of threads,
!! and what goes to ghosts at the seams of periodic grids is added to their nodes.
module mpm_momentum
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_seam, only: fold_ghosts
  use mpm_stencil, only: block_size, decode_keys, hat_coordinates, period_shift, stencil_t, &
                         weights_of_points
  use mpm_window, only: window_t
  implicit none
  private
  public :: add_momentum

  !> Points in a slab, about; fewer would cost more in scheduling than they give.
  integer, parameter :: slab_points = 512

contains

  !> Add the momenta of all points of a body to its nodes.
  subroutine add_momentum(kin, stencil, window, threads, n, order, row_offset, key, x, extent, &
                          mass, node_momentum, velocity, affine)
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
    !> Nodal momenta, added to; 0 at ghosts. [kg m/s] (nvel, nn)
    real(wp), contiguous, intent(inout) :: node_momentum(:, :)
    !> Velocities, 0 when left out. [m/s] (nvel, n)
    real(wp), intent(in), optional :: velocity(kin%nvel, n)
    !> Gradients of the points' own velocities. [1/s] (nvel dim, n)
    real(wp), intent(in), optional :: affine(kin%nvel*kin%dim, n)
    type(stencil_t) :: values
    integer :: rows, thickness, slabs, slab, colour, first, last

    ! Slopes are not used.
    values = stencil
    values%fitted = .false.
    rows = ubound(row_offset, 1)
    thickness = max(stencil%width - 1, int((int(slab_points, lp)*rows)/max(n, 1)))
    slabs = (rows + thickness - 1)/thickness
    !$omp parallel default(none) num_threads(threads) &
    !$omp shared(kin, values, window, order, row_offset, key, x, extent, mass, velocity, affine) &
    !$omp shared(node_momentum, rows, thickness, slabs) private(slab, colour, first, last)
    do colour = 0, 1
      !$omp do schedule(dynamic)
      do slab = colour, slabs - 1, 2
        first = row_offset(slab*thickness)
        last = row_offset(min(rows, (slab + 1)*thickness))
        call add_range(kin, values, window, last - first, order(first + 1:last), key, x, extent, &
                       mass, node_momentum, velocity, affine)
      end do
      !$omp end do
    end do
    !$omp end parallel
    if (any(stencil%periodic)) call fold_ghosts(stencil, window, kin%nvel, node_momentum)
  end subroutine add_momentum

  !> Add the points of a visiting range.
  pure subroutine add_range(kin, stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays.
    type(window_t), intent(in) :: window
    !> Number of points to visit.
    integer, intent(in) :: n
    !> Slots of the points in visiting order. (n)
    integer, intent(in) :: order(n)
    !> Keys. (np)
    integer, intent(in) :: key(*)
    !> Positions. [m] (dim, np)
    real(wp), intent(in) :: x(*)
    !> Half sides of the points' boxes. [m] (np)
    real(wp), intent(in) :: extent(*)
    !> Masses. [kg] (np)
    real(wp), intent(in) :: mass(*)
    !> Nodal momenta, added to. [kg m/s] (nvel, nn)
    real(wp), intent(inout) :: node_momentum(*)
    !> Velocities, 0 when left out. [m/s] (nvel, np)
    real(wp), intent(in), optional :: velocity(*)
    !> Gradients of the points' own velocities. [1/s] (nvel dim, np)
    real(wp), intent(in), optional :: affine(*)

    select case (100*kin%dim + 10*kin%nvel + stencil%width)
    case (112)
      call momentum_1d_2(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (113)
      call momentum_1d_3(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (114)
      call momentum_1d_4(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (115)
      call momentum_1d_5(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (222)
      call momentum_plane_2(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (223)
      call momentum_plane_3(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (224)
      call momentum_plane_4(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (225)
      call momentum_plane_5(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (332)
      call momentum_3d_2(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (333)
      call momentum_3d_3(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (334)
      call momentum_3d_4(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (335)
      call momentum_3d_5(stencil, window, n, order, key, x, extent, mass, &
                         node_momentum, velocity, affine)
    case (232)
      call momentum_swirl_2(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (233)
      call momentum_swirl_3(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (234)
      call momentum_swirl_4(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    case (235)
      call momentum_swirl_5(stencil, window, n, order, key, x, extent, mass, &
                            node_momentum, velocity, affine)
    end select
  end subroutine add_range

#define DIM 1
#define NVEL 1
#define NAME momentum_1d_2
#define WIDTH 2
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_1d_3
#define WIDTH 3
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_1d_4
#define WIDTH 4
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_1d_5
#define WIDTH 5
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#define DIM 2
#define NVEL 2
#define NAME momentum_plane_2
#define WIDTH 2
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_plane_3
#define WIDTH 3
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_plane_4
#define WIDTH 4
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_plane_5
#define WIDTH 5
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#define DIM 3
#define NVEL 3
#define NAME momentum_3d_2
#define WIDTH 2
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_3d_3
#define WIDTH 3
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_3d_4
#define WIDTH 4
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_3d_5
#define WIDTH 5
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#define DIM 2
#define NVEL 3
#define NAME momentum_swirl_2
#define WIDTH 2
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_swirl_3
#define WIDTH 3
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_swirl_4
#define WIDTH 4
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#define NAME momentum_swirl_5
#define WIDTH 5
#include "momentum_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL

end module mpm_momentum
