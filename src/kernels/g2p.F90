!> Grid-to-particle interpolation of velocity, velocity increment and velocity gradient.
!!
!! Templates, compiled for each simulation TYPE and stencil width: `g2p_hat_template.inc` for hats,
!! `g2p_template.inc` for three nodes in each direction and more. The nodal values are gathered once
!! per run of points that share a stencil.
!!
!! In TYPE 4 with the radius r before the move: L_tt = v_r/r, L_rt = -v_t/r.
module mpm_g2p
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_stencil, only: axis_fraction, block_size, decode_keys, hat_coordinates, outside, &
                         stencil_t, weights_of_points
  use mpm_window, only: window_t
  implicit none
  private
  public :: g2p

contains

  !> Interpolate to one block of points.
  pure subroutine g2p(kin, stencil, window, n, key, x, extent, node_velocity, node_increment, &
                      velocity, increment, gradient)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the node arrays; holds all stencils of the points.
    type(window_t), intent(in) :: window
    !> Number of points, at most `block_size`.
    integer, intent(in) :: n
    !> Keys. (n)
    integer, intent(in) :: key(n)
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(*)
    !> Half sides of the points' boxes. [m] (n)
    real(wp), intent(in) :: extent(n)
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(in) :: node_velocity(*)
    !> Nodal velocity increments of the step. [m/s] (nvel, nn)
    real(wp), intent(in) :: node_increment(*)
    !> Velocity of the grid at the points. [m/s] (nvel, n)
    real(wp), intent(inout) :: velocity(*)
    !> Velocity increment at the points. [m/s] (nvel, n)
    real(wp), intent(inout) :: increment(*)
    !> Velocity gradient, components in the order of `kinematics_t`. [1/s] (ngrad, n)
    real(wp), intent(inout) :: gradient(*)

    select case (10*kin%sim_type + stencil%width)
    case (12)
      call g2p_1d_2(stencil, window, n, key, x, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (13)
      call g2p_1d_3(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (14)
      call g2p_1d_4(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (15)
      call g2p_1d_5(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (22)
      call g2p_plane_2(stencil, window, n, key, x, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (23)
      call g2p_plane_3(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (24)
      call g2p_plane_4(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (25)
      call g2p_plane_5(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (32)
      call g2p_3d_2(stencil, window, n, key, x, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (33)
      call g2p_3d_3(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (34)
      call g2p_3d_4(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (35)
      call g2p_3d_5(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (42)
      call g2p_axisymmetric_2(stencil, window, n, key, x, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (43)
      call g2p_axisymmetric_3(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (44)
      call g2p_axisymmetric_4(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (45)
      call g2p_axisymmetric_5(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (52)
      call g2p_out_of_plane_2(stencil, window, n, key, x, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (53)
      call g2p_out_of_plane_3(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (54)
      call g2p_out_of_plane_4(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    case (55)
      call g2p_out_of_plane_5(stencil, window, n, key, x, extent, node_velocity, &
                   node_increment, velocity, increment, gradient)
    end select
  end subroutine g2p

#define DIM 1
#define NVEL 1
#define NGRAD 1
#define NAME g2p_1d_2
#include "g2p_hat_template.inc"
#undef NAME
#define NAME g2p_1d_3
#define WIDTH 3
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_1d_4
#define WIDTH 4
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_1d_5
#define WIDTH 5
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NGRAD
#define DIM 2
#define NVEL 2
#define NGRAD 4
#define NAME g2p_plane_2
#include "g2p_hat_template.inc"
#undef NAME
#define NAME g2p_plane_3
#define WIDTH 3
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_plane_4
#define WIDTH 4
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_plane_5
#define WIDTH 5
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NGRAD
#define DIM 3
#define NVEL 3
#define NGRAD 9
#define NAME g2p_3d_2
#include "g2p_hat_template.inc"
#undef NAME
#define NAME g2p_3d_3
#define WIDTH 3
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_3d_4
#define WIDTH 4
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_3d_5
#define WIDTH 5
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NGRAD
#define DIM 2
#define NVEL 3
#define NGRAD 8
#define HOOP
#define NAME g2p_axisymmetric_2
#include "g2p_hat_template.inc"
#undef NAME
#define NAME g2p_axisymmetric_3
#define WIDTH 3
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_axisymmetric_4
#define WIDTH 4
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_axisymmetric_5
#define WIDTH 5
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NGRAD
#undef HOOP
#define DIM 2
#define NVEL 3
#define NGRAD 6
#define NAME g2p_out_of_plane_2
#include "g2p_hat_template.inc"
#undef NAME
#define NAME g2p_out_of_plane_3
#define WIDTH 3
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_out_of_plane_4
#define WIDTH 4
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#define NAME g2p_out_of_plane_5
#define WIDTH 5
#include "g2p_template.inc"
#undef NAME
#undef WIDTH
#undef DIM
#undef NVEL
#undef NGRAD

end module mpm_g2p
