!> The seams of periodic grids: where node N of a direction is node 0.
!!
!! Stencils run on beyond node N - 1, onto ghosts of the nodes 0, 1, ... What points give to ghosts
!! is folded onto the nodes themselves, so that boundaries and contacts meet each node once, with
!! ghosts at 0; nodal velocities are copied to the ghosts before points read them. Windows that
!! reach a seam take in the whole direction, so that every ghost has its node in the window.
module mpm_seam
  use mpm_kinds, only: wp
  use mpm_stencil, only: stencil_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: copy_to_ghosts, fold_ghosts, image_of, widen_at_seam, wrap_points

contains

  !> The node that a ghost stands for; other nodes are their own image.
  pure function image_of(stencil, node) result(image)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Grid indices, below N in periodic directions.
    integer :: image(3)

    image = node
    where (stencil%periodic) image = modulo(node, max(1, stencil%n_cells))
  end function image_of

  !> Let a window that reaches a ghost begin at node 0 of that direction.
  pure subroutine widen_at_seam(stencil, window)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of all stencils of a body.
    type(window_t), intent(inout) :: window
    integer :: d

    do d = 1, stencil%dim
      if (.not. stencil%periodic(d)) cycle
      if (window%lo(d) + window%n(d) <= stencil%n_cells(d)) cycle
      window%n(d) = window%lo(d) + window%n(d)
      window%lo(d) = 0
    end do
  end subroutine widen_at_seam

  !> Add the sums at ghosts to those of their nodes, and set them to 0.
  pure subroutine fold_ghosts(stencil, window, components, values)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the values, widened at the seams.
    type(window_t), intent(in) :: window
    !> Components of a value.
    integer, intent(in) :: components
    !> Nodal sums. (components, nn)
    real(wp), intent(inout) :: values(components, *)
    integer :: d, i, j, k, first(3), last(3), ghost, node

    do d = 1, stencil%dim
      call ghosts(stencil, window, d, first, last)
      do k = first(3), last(3)
        do j = first(2), last(2)
          do i = first(1), last(1)
            ghost = window%index([i, j, k])
            node = window%index(image_along(stencil, d, [i, j, k]))
            values(:, node) = values(:, node) + values(:, ghost)
            values(:, ghost) = 0.0_wp
          end do
        end do
      end do
    end do
  end subroutine fold_ghosts

  !> Give ghosts the values of their nodes.
  pure subroutine copy_to_ghosts(stencil, window, components, values)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Window of the values, widened at the seams.
    type(window_t), intent(in) :: window
    !> Components of a value.
    integer, intent(in) :: components
    !> Nodal values. (components, nn)
    real(wp), intent(inout) :: values(components, *)
    integer :: d, i, j, k, first(3), last(3), ghost, node

    do d = 1, stencil%dim
      call ghosts(stencil, window, d, first, last)
      do k = first(3), last(3)
        do j = first(2), last(2)
          do i = first(1), last(1)
            ghost = window%index([i, j, k])
            node = window%index(image_along(stencil, d, [i, j, k]))
            values(:, ghost) = values(:, node)
          end do
        end do
      end do
    end do
  end subroutine copy_to_ghosts

  !> The nodes of a window that are ghosts in one direction; last < first when there are none.
  pure subroutine ghosts(stencil, window, d, first, last)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The window.
    type(window_t), intent(in) :: window
    !> The direction.
    integer, intent(in) :: d
    !> Lowest indices.
    integer, intent(out) :: first(3)
    !> Highest indices.
    integer, intent(out) :: last(3)

    first = window%lo
    last = window%hi()
    if (stencil%periodic(d)) then
      first(d) = stencil%n_cells(d)
    else
      last(d) = first(d) - 1
    end if
  end subroutine ghosts

  !> Image of a node with regard to one direction.
  pure function image_along(stencil, d, node) result(image)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The direction.
    integer, intent(in) :: d
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Grid indices of the image.
    integer :: image(3)

    image = node
    image(d) = modulo(node(d), stencil%n_cells(d))
  end function image_along

  !> Bring points that left through a periodic face back at the opposite one.
  pure subroutine wrap_points(stencil, n, x)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(inout) :: x(stencil%dim, n)
    real(wp) :: top, length, inverse_h
    integer :: d, p

    do d = 1, stencil%dim
      if (.not. stencil%periodic(d)) cycle
      top = real(stencil%n_cells(d), wp)
      length = top*stencil%h(d)
      inverse_h = 1.0_wp/stencil%h(d)
      do p = 1, n
        if (in_period(x(d, p) - stencil%lower(d))) cycle
        x(d, p) = x(d, p) - length*floor_of((x(d, p) - stencil%lower(d))/length)
        ! Rounding may leave the point on a face.
        if (.not. in_period(x(d, p) - stencil%lower(d))) x(d, p) = stencil%lower(d)
      end do
    end do

  contains

    !> Whether a distance from the lower face is below the period, as the stencils see it.
    pure function in_period(distance) result(inside)
      !> The distance. [m]
      real(wp), intent(in) :: distance
      !> Whether it is.
      logical :: inside

      inside = distance >= 0.0_wp .and. distance*inverse_h < top
    end function in_period

  end subroutine wrap_points

  !> The largest whole number not above a number of any size.
  elemental function floor_of(number) result(whole)
    !> The number.
    real(wp), intent(in) :: number
    !> The whole number.
    real(wp) :: whole

    whole = aint(number)
    if (whole > number) whole = whole - 1.0_wp
  end function floor_of

end module mpm_seam
