!> Unit normals of bodies at nodes, from the gradient of their mass.
module mpm_contact_normals
  use mpm_body, only: body_t
  use mpm_kinds, only: wp
  use mpm_point_maps, only: map_mass_gradient
  use mpm_stencil, only: stencil_t
  use mpm_threads, only: useful_threads
  use mpm_window, only: window_t
  implicit none
  private
  public :: body_normals, mean_normals
  public :: edges_cut, edges_level, edges_mirror

  !> A body ends at the faces of the grid, as in mpm_3d.
  integer, parameter :: edges_cut = 0
  !> A body goes on beyond the faces, but where it would have no normal at all it ends there.
  integer, parameter :: edges_level = 1
  !> A body goes on beyond the faces.
  integer, parameter :: edges_mirror = 2
  !> A normal shorter than this times mass over spacing has no direction.
  real(wp), parameter :: tiny_normal = 1.0e-10_wp

contains

  !> Unit normals out of one body.
  subroutine body_normals(body, window, h, edges, normal)
    !> The body.
    class(body_t), intent(in) :: body
    !> The nodes wanted.
    type(window_t), intent(in) :: window
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: h
    !> What faces of the grid are to the body: `edges_cut`, `edges_level` or `edges_mirror`.
    integer, intent(in) :: edges
    !> Unit vectors, or 0 where the mass around is balanced. (nvel, nn)
    real(wp), intent(out) :: normal(:, :)
    real(wp) :: floor(size(normal, 2))
    integer :: i, j, k, node(3), hi(3)

    call map_mass_gradient(body%points, window, normal)
    if (edges /= edges_cut) then
      call level_at_faces(body%points%stencil, window, edges == edges_mirror, normal)
    end if
    hi = window%hi()
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          floor(window%index(node)) = tiny_normal*body%nodes%mass(body%nodes%window%index(node))/h
        end do
      end do
    end do
    call normalise(normal, floor)
  end subroutine body_normals

  !> Mean of the unit normals of two bodies, out of the first: unit vectors, or 0.
  subroutine mean_normals(first, second, window, h, threads, normal)
    !> First body.
    class(body_t), intent(in) :: first
    !> Second body.
    class(body_t), intent(in) :: second
    !> The nodes wanted.
    type(window_t), intent(in) :: window
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: h
    !> Number of threads.
    integer, intent(in) :: threads
    !> The normals. (nvel, nn)
    real(wp), intent(out) :: normal(:, :)
    real(wp), allocatable :: other(:, :)
    integer :: nn, crew

    nn = size(normal, 2)
    crew = useful_threads(threads, 64*nn)
    allocate (other(size(normal, 1), nn))
    ! LLVM 19 wants what num_threads uses to be shared, and that said before.
    !$omp parallel sections default(none) shared(window, first, second, h, normal, other, crew) &
    !$omp num_threads(crew)
    !$omp section
    call body_normals(first, window, h, edges_level, normal)
    !$omp section
    call body_normals(second, window, h, edges_level, other)
    !$omp end parallel sections
    ! Each is a unit vector or 0, so that one without a direction leaves the other.
    normal = normal - other
    call normalise(normal, spread(tiny_normal, 1, nn))
  end subroutine mean_normals

  !> Drop the components across faces of the grid at the nodes of these faces.
  !!
  !! The grid cuts bodies off there: their gradient lacks the mass beyond the face and points out of
  !! the grid. A vector of which nothing is left keeps its components, unless it may vanish.
  pure subroutine level_at_faces(stencil, window, may_vanish, normal)
    !> Basis of the body.
    type(stencil_t), intent(in) :: stencil
    !> Nodes of the vectors.
    type(window_t), intent(in) :: window
    !> Vectors of which nothing is left become 0.
    logical, intent(in) :: may_vanish
    !> Vectors. (nvel, nn)
    real(wp), intent(inout) :: normal(:, :)
    real(wp) :: levelled(size(normal, 1))
    integer :: i, j, k, d, node(3), hi(3), here

    hi = window%hi()
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          node = [i, j, k]
          here = window%index(node)
          levelled = normal(:, here)
          do d = 1, stencil%dim
            if (stencil%periodic(d)) cycle
            if (on_face(stencil, d, node)) levelled(d) = 0.0_wp
          end do
          if (may_vanish .or. norm2(levelled) > tiny_normal*norm2(normal(:, here))) then
            normal(:, here) = levelled
          end if
        end do
      end do
    end do
  end subroutine level_at_faces

  !> Whether a node is on a face of the grid across a direction; of a mesh on that of its box.
  pure function on_face(stencil, d, node)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> The direction.
    integer, intent(in) :: d
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Whether it is.
    logical :: on_face

    if (allocated(stencil%mesh)) then
      on_face = stencil%mesh%on_box(node(1) + 1, d)
    else
      on_face = node(d) == 0 .or. node(d) == stencil%n_cells(d)
    end if
  end function on_face

  !> Make vectors unit vectors; those not longer than their floor become 0.
  pure subroutine normalise(vectors, floor)
    !> Vectors. (nvel, nn)
    real(wp), intent(inout) :: vectors(:, :)
    !> Lengths at or below which a vector has no direction. (nn)
    real(wp), intent(in) :: floor(:)
    real(wp) :: length
    integer :: i

    do i = 1, size(vectors, 2)
      length = norm2(vectors(:, i))
      if (length > floor(i)) then
        vectors(:, i) = vectors(:, i)/length
      else
        vectors(:, i) = 0.0_wp
      end if
    end do
  end subroutine normalise

end module mpm_contact_normals
