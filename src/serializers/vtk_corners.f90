!> Files of the corners of points' domains.
module mpm_vtk_corners
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_points, only: points_t
  use mpm_vtk_legacy, only: vtk_legacy_t
  implicit none
  private
  public :: write_corners

  !> VTK cell types of a line, a quadrilateral and a hexahedron.
  integer, parameter :: cell_types(3) = [3, 9, 12]
  !> Corners, x fastest, in the order of these cells.
  integer, parameter :: corner_order(8) = [1, 2, 4, 3, 5, 6, 8, 7]

contains

  !> Write the domains of all points as cells, each with corners of its own.
  subroutine write_corners(points, path, title, digits, error)
    !> The points, with domains; they are written in the order of the points file.
    class(points_t), intent(in) :: points
    !> Name of the file.
    character(*), intent(in) :: path
    !> Title line.
    character(*), intent(in) :: title
    !> Significant digits.
    integer, intent(in) :: digits
    !> The file can't be written.
    type(error_t), allocatable, intent(out) :: error
    type(vtk_legacy_t) :: file
    real(wp) :: x(3, 2**points%kin%dim), r(points%kin%dim, 2**points%kin%dim)
    integer :: slot(points%n), corners, p, c

    call file%open(path, title, digits, error)
    if (allocated(error)) return
    slot = points%slots()
    corners = 2**points%kin%dim
    call file%start_points(points%n*corners)
    x = 0.0_wp
    do p = 1, points%n
      r = points%domains%corners(slot(p))
      do c = 1, corners
        x(:points%kin%dim, c) = points%x(:, slot(p)) + r(:, corner_order(c))
      end do
      call file%put_points(x)
    end do
    call file%start_cells(points%n, corners)
    do p = 1, points%n
      call file%put_cells(reshape([(corners*(p - 1) + c, c=0, corners - 1)], [corners, 1]))
    end do
    call file%put_cell_types(points%n, cell_types(points%kin%dim))
    call file%start_fields(points%n*corners)
    call file%start_scalars('volume')
    do p = 1, points%n
      call file%put_scalars(spread(points%volume(slot(p)), 1, corners))
    end do
    call file%commit(error)
  end subroutine write_corners

end module mpm_vtk_corners
