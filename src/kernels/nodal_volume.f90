!> Volume of points as nodes see it, sum_p N_i(x_p) V_p.
!!
!! Plain loops in one fixed order: boundaries ask for the nodes of a face, so that few points count.
module mpm_nodal_volume
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_stencil, only: axis_fraction, block_size, decode_keys, outside, stencil_keys, &
                         stencil_t, stencil_weights
  use mpm_window, only: window_t
  implicit none
  private
  public :: nodal_volume

contains

  !> Volume of points at the nodes of a part of the grid.
  pure subroutine nodal_volume(kin, stencil, part, n, order, x, extent, volume, per_radius, &
                               node_volume)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The nodes that are asked for.
    type(window_t), intent(in) :: part
    !> Number of points to visit.
    integer, intent(in) :: n
    !> Slots of the points in visiting order. (n)
    integer, intent(in) :: order(n)
    !> Positions. [m] (dim, np)
    real(wp), intent(in) :: x(stencil%dim, *)
    !> Half sides of the points' boxes. [m] (np)
    real(wp), intent(in) :: extent(*)
    !> Volumes. [m3] (np)
    real(wp), intent(in) :: volume(*)
    !> TYPE 4: count the meridian areas V_p/r_p instead of the volumes per radian.
    logical, intent(in) :: per_radius
    !> Volumes at the nodes of `part`. [m3] (part%size())
    real(wp), intent(out) :: node_volume(:)
    real(wp) :: xb(stencil%dim, block_size), eb(block_size), share
    integer :: keys(block_size), base(3, block_size), reach(3), first, nb, j, p

    node_volume = 0.0_wp
    reach = 0
    reach(:stencil%dim) = stencil%width - 1
    do first = 1, n, block_size
      nb = min(block_size, n - first + 1)
      do j = 1, nb
        p = order(first + j - 1)
        xb(:, j) = x(:, p)
        eb(j) = extent(p)
      end do
      call stencil_keys(stencil, nb, xb, eb, keys)
      call decode_keys(stencil, nb, keys, base)
      do j = 1, nb
        if (keys(j) == outside) cycle
        if (any(base(:, j) > part%hi() .or. base(:, j) + reach < part%lo)) cycle
        share = volume(order(first + j - 1))
        if (per_radius .and. kin%sim_type == type_axisymmetric) then
          share = share/max(xb(1, j), axis_fraction*stencil%h(1))
        end if
        call add_point(stencil, part, reach, base(:, j), xb(:, j), eb(j), share, node_volume)
      end do
    end do
  end subroutine nodal_volume

  !> Add one point to the nodes that its stencil shares with the part.
  pure subroutine add_point(stencil, part, reach, base, x, extent, share, node_volume)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The nodes that are asked for.
    type(window_t), intent(in) :: part
    !> Nodes of a stencil beyond its first in each direction.
    integer, intent(in) :: reach(3)
    !> First node of the stencil.
    integer, intent(in) :: base(3)
    !> Position. [m]
    real(wp), intent(in) :: x(stencil%dim)
    !> Half side of the point's box. [m]
    real(wp), intent(in) :: extent
    !> What the nodes share. [m3]
    real(wp), intent(in) :: share
    !> Sums at the nodes of the part. [m3]
    real(wp), intent(inout) :: node_volume(:)
    real(wp) :: w(12), dw(12), product_w
    integer :: lo(3), hi(3), node(3), i, j, k, d

    call stencil_weights(stencil, 1, x, [extent], base, w, dw)
    lo = max(base, part%lo)
    hi = min(base + reach, part%hi())
    do k = lo(3), hi(3)
      do j = lo(2), hi(2)
        do i = lo(1), hi(1)
          node = [i, j, k]
          product_w = share
          do d = 1, stencil%dim
            product_w = product_w*w((d - 1)*stencil%width + node(d) - base(d) + 1)
          end do
          node_volume(part%index(node)) = node_volume(part%index(node)) + product_w
        end do
      end do
    end do
  end subroutine add_point

end module mpm_nodal_volume
