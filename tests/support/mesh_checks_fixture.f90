!> Checks of the functions of a mesh at random points, at nodes and on edges.
module mpm_mesh_checks_fixture
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_mesh_lists, only: list_nodes_of_cells
  use mpm_node_list, only: node_list_t
  use mpm_random_fixture, only: random_t
  use mpm_stencil, only: stencil_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: check_points, mesh_errors

contains

  !> Positions inside a mesh: nodes, middles of edges and of sides, centres, and some at random.
  subroutine check_points(stencil, x)
    !> Basis with a mesh.
    type(stencil_t), intent(in) :: stencil
    !> Positions. [m] (dim, n)
    real(wp), allocatable, intent(out) :: x(:, :)
    type(random_t) :: random
    real(wp) :: share(4)
    integer :: c, k, l, n

    associate (mesh => stencil%mesh)
      allocate (x(mesh%dim, mesh%n_cells*20))
      n = 0
      do c = 1, mesh%n_cells
        associate (corner => mesh%x(:, mesh%node(:, c)))
          do k = 1, mesh%dim + 1
            call add(corner(:, k))
            do l = 1, k - 1
              call add(0.5_wp*(corner(:, k) + corner(:, l)))
            end do
          end do
          call add(sum(corner, dim=2)/real(mesh%dim + 1, wp))
          do k = 1, 5
            call random%fill(0.01_wp, 1.0_wp, share)
            share(:mesh%dim + 1) = share(:mesh%dim + 1)/sum(share(:mesh%dim + 1))
            call add(matmul(corner, share(:mesh%dim + 1)))
          end do
        end associate
      end do
    end associate
    x = x(:, :n)

  contains

    !> Append a position.
    subroutine add(position)
      !> The position. [m]
      real(wp), intent(in) :: position(:)

      n = n + 1
      x(:, n) = position
    end subroutine add

  end subroutine check_points

  !> Largest errors at such positions: sum of the functions less 1, sum of their positions less that
  !! of the point, sum of gradients, gradient of positions less 1; negative values.
  subroutine mesh_errors(grid, averaged, errors)
    !> A grid with a mesh.
    class(grid_t), intent(in) :: grid
    !> Average over the corners of boxes of different sizes.
    logical, intent(in) :: averaged
    !> The errors, gradients times the least height of a cell.
    real(wp), intent(out) :: errors(5)
    type(stencil_t) :: stencil
    type(error_t), allocatable :: error
    type(node_list_t) :: list
    type(window_t) :: window
    real(wp), allocatable :: x(:, :), extent(:)
    integer, allocatable :: cell(:), corner_cell(:, :)
    real(wp) :: gradient(3, 3), total(3)
    integer :: p, e, d, n

    errors = 1.0_wp
    call grid%make_stencil(averaged, 1.0_wp, stencil, error)
    call check_points(stencil, x)
    n = size(x, 2)
    allocate (cell(n), extent(n))
    do p = 1, n
      cell(p) = stencil%mesh%find(x(:, p))
      extent(p) = stencil%mesh%h*real(mod(p, 7) + 1, wp)/3.0_wp
    end do
    if (any(cell < 1)) return
    call list_nodes_of_cells(stencil%mesh, 1, averaged, n, x, extent, cell, corner_cell, list, &
                             window)
    errors = 0.0_wp
    do p = 1, n
      associate (mesh => stencil%mesh, dim => stencil%dim)
        total = 0.0_wp
        gradient = 0.0_wp
        errors(1) = max(errors(1), &
                        abs(sum(list%basis(0, list%offset(p - 1) + 1:list%offset(p))) - 1.0_wp))
        do e = list%offset(p - 1) + 1, list%offset(p)
          associate (node => mesh%x(:, window%lo(1) + list%node(e)))
            total(:dim) = total(:dim) + list%basis(0, e)*(node - x(:, p))
            do d = 1, dim
              gradient(:dim, d) = gradient(:dim, d) + list%basis(1:, e)*(node(d) - x(d, p))
            end do
          end associate
          errors(5) = max(errors(5), -list%basis(0, e))
        end do
        errors(2) = max(errors(2), maxval(abs(total)))
        do d = 1, dim
          gradient(d, d) = gradient(d, d) - 1.0_wp
          errors(3) = max(errors(3), mesh%h*abs(sum(list%basis(d, list%offset(p - 1) + 1: &
                                                               list%offset(p)))))
        end do
        errors(4) = max(errors(4), maxval(abs(gradient(:dim, :dim))))
      end associate
    end do
  end subroutine mesh_errors

end module mpm_mesh_checks_fixture
