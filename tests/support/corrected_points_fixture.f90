!> Points of ImprovedQuadraturePoints without files: a table, the text of their properties, a basis.
module mpm_corrected_points_fixture
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_improved_quadrature_points, only: improved_quadrature_points_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: make_properties, properties_t
  use mpm_random_fixture, only: random_t
  use mpm_stencil, only: stencil_t
  implicit none
  private
  public :: fill_box, make_corrected_points

contains

  !> Points with the rules of a text, located on a grid.
  subroutine make_corrected_points(grid, table, lists, points, error)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Rows m, V, x, v, active, as in a points file. (columns, n)
    real(wp), intent(in) :: table(:, :)
    !> Property lists.
    character(*), intent(in) :: lists
    !> The points.
    type(improved_quadrature_points_t), intent(out) :: points
    !> Properties or rows that can't be.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(stencil_t) :: stencil
    integer :: i

    call points%describe(description)
    call make_properties(description, grid%kin%sim_type, lists, properties, error)
    if (.not. allocated(error)) call points%settings%read(properties, error)
    if (allocated(error)) return
    call points%init_from_table(grid, table, 'table', [(i, i=1, size(table, 2))], error)
    if (.not. allocated(error)) call points%adopt(grid, properties, error)
    if (allocated(error)) return
    call grid%make_stencil(points%averages(.true.), maxval(points%extent), stencil, error)
    if (allocated(error)) return
    call points%locate(stencil)
    call points%refresh_order()
  end subroutine make_corrected_points

  !> Table of points that fill a grid: a lattice, moved at random by a part of its spacing.
  subroutine fill_box(grid, per_cell, jitter, random, table)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points in a cell and direction.
    integer, intent(in) :: per_cell
    !> Largest move over the spacing of the points, at most 1/2.
    real(wp), intent(in) :: jitter
    !> Random numbers.
    type(random_t), intent(inout) :: random
    !> Rows m, V, x, v, active; density 1. (columns, n)
    real(wp), allocatable, intent(out) :: table(:, :)
    real(wp) :: lower(3), upper(3), spacing(3), centre(3), move(3), h(3)
    integer :: n(3), i, j, k, p
    type(kinematics_t) :: kin

    kin = grid%kin
    call grid%bounds(lower, upper)
    h = grid%spacing()
    n = 1
    n(:kin%dim) = per_cell*nint((upper(:kin%dim) - lower(:kin%dim))/h(:kin%dim))
    spacing = h/real(per_cell, wp)
    allocate (table(3 + 2*kin%nvel, product(n)))
    table = 0.0_wp
    table(size(table, 1), :) = 1.0_wp
    p = 0
    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          p = p + 1
          call random%fill(-jitter, jitter, move)
          centre = lower + spacing*(real([i, j, k], wp) - 0.5_wp + move)
          table(:2, p) = product(spacing(:kin%dim))
          table(3:2 + kin%dim, p) = centre(:kin%dim)
        end do
      end do
    end do
  end subroutine fill_box

end module mpm_corrected_points_fixture
