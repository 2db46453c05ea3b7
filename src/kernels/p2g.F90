!> Particle-to-grid scatter of mass, momentum and internal force.
!!
!! Templates, compiled for each simulation TYPE and stencil width, with both known to the compiler:
!! `p2g_hat_template.inc` for hats, `p2g_three_template.inc` for three nodes in each direction,
!! which fill registers of four lanes badly, and `p2g_template.inc` for more. Points that share a
!! stencil (the points of a cell) are summed into local accumulators, which are added to the grid
!! once per cell.
!!
!! f_i = -sum_p V_p T_p . grad N_i(x_p); in TYPE 4 also f_r -= sum_p S_ip A_p T_tt and
!! f_t += sum_p S_ip A_p T_rt with the meridian area A_p = V_p/r_p (Sulsky, Chen and Schreyer,
!! CMAME 118, 1994, for the Cartesian terms).
module mpm_p2g
  use, intrinsic :: iso_fortran_env, only: lp => int64
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_prefetch, only: prefetch_batch, prefetch_rows
  use mpm_stencil, only: axis_fraction, block_size, decode_keys, hat_coordinates, stencil_t, &
                         weights_of_points
  use mpm_window, only: window_t
  implicit none
  private
  public :: p2g

  !> Stored stress component of row c, column k of the tensor.
  integer, parameter :: stress_index(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])

contains

  !> Add the points of a visiting range to the grid.
  pure subroutine p2g(kin, stencil, window, n, order, key, x, extent, mass, volume, velocity, &
                      stress, node_mass, node_momentum, node_force)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays; holds all stencils of the points.
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
    !> Volumes. [m3] (np)
    real(wp), intent(in) :: volume(*)
    !> Velocities. [m/s] (nvel, np)
    real(wp), intent(in) :: velocity(*)
    !> Cauchy stresses. [Pa] (nstress, np)
    real(wp), intent(in) :: stress(*)
    !> Nodal masses, added to. [kg] (nn)
    real(wp), intent(inout) :: node_mass(*)
    !> Nodal momenta, added to. [kg m/s] (nvel, nn)
    real(wp), intent(inout) :: node_momentum(*)
    !> Nodal forces, added to. [N] (nvel, nn)
    real(wp), intent(inout) :: node_force(*)

    select case (10*kin%sim_type + stencil%width)
    case (12)
      call p2g_1d_2(stencil, window, n, order, key, x, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (13)
      call p2g_1d_3(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (14)
      call p2g_1d_4(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (15)
      call p2g_1d_5(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (22)
      call p2g_plane_2(stencil, window, n, order, key, x, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (23)
      call p2g_plane_3(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (24)
      call p2g_plane_4(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (25)
      call p2g_plane_5(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (32)
      call p2g_3d_2(stencil, window, n, order, key, x, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (33)
      call p2g_3d_3(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (34)
      call p2g_3d_4(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (35)
      call p2g_3d_5(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (42)
      call p2g_axisymmetric_2(stencil, window, n, order, key, x, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (43)
      call p2g_axisymmetric_3(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (44)
      call p2g_axisymmetric_4(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (45)
      call p2g_axisymmetric_5(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (52)
      call p2g_out_of_plane_2(stencil, window, n, order, key, x, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (53)
      call p2g_out_of_plane_3(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (54)
      call p2g_out_of_plane_4(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    case (55)
      call p2g_out_of_plane_5(stencil, window, n, order, key, x, extent, mass, volume, &
                   velocity, stress, node_mass, node_momentum, node_force)
    end select
  end subroutine p2g

#define DIM 1
#define NVEL 1
#define NSTRESS 3
#define NAME p2g_1d_2
#include "p2g_hat_template.inc"
#undef NAME
#define NAME p2g_1d_3
#define WIDTH 3
#include "p2g_three_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_1d_4
#define WIDTH 4
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_1d_5
#define WIDTH 5
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NSTRESS
#define DIM 2
#define NVEL 2
#define NSTRESS 4
#define NAME p2g_plane_2
#include "p2g_hat_template.inc"
#undef NAME
#define NAME p2g_plane_3
#define WIDTH 3
#include "p2g_three_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_plane_4
#define WIDTH 4
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_plane_5
#define WIDTH 5
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NSTRESS
#define DIM 3
#define NVEL 3
#define NSTRESS 6
#define NAME p2g_3d_2
#include "p2g_hat_template.inc"
#undef NAME
#define NAME p2g_3d_3
#define WIDTH 3
#include "p2g_three_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_3d_4
#define WIDTH 4
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_3d_5
#define WIDTH 5
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NSTRESS
#define DIM 2
#define NVEL 3
#define NSTRESS 6
#define HOOP
#define NAME p2g_axisymmetric_2
#include "p2g_hat_template.inc"
#undef NAME
#define NAME p2g_axisymmetric_3
#define WIDTH 3
#include "p2g_three_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_axisymmetric_4
#define WIDTH 4
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_axisymmetric_5
#define WIDTH 5
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NSTRESS
#undef HOOP
#define DIM 2
#define NVEL 3
#define NSTRESS 6
#define NAME p2g_out_of_plane_2
#include "p2g_hat_template.inc"
#undef NAME
#define NAME p2g_out_of_plane_3
#define WIDTH 3
#include "p2g_three_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_out_of_plane_4
#define WIDTH 4
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#define NAME p2g_out_of_plane_5
#define WIDTH 5
#include "p2g_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NSTRESS

end module mpm_p2g
