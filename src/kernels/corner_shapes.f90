!> Functions averaged over segments, quadrilaterals and hexahedra between corners.
!!
!! Within the element a function f is replaced by its interpolation from the corners, which gives
!! means of f and of its gradient as sums over the corners, mean f = sum_c w_c f(x_c) and
!! mean grad f = sum_c g_c f(x_c), with w_c = (1/V) int M_c dV and g_c = (1/V) int grad M_c dV; the
!! M_c are the linear, bilinear or trilinear functions of the corners. g_c is also the derivative of
!! ln V by the position of the corner.
!!
!! Corners are numbered with x fastest: ---, +--, -+-, ++-, --+, ...
module mpm_corner_shapes
  use mpm_kinds, only: wp
  implicit none
  private
  public :: corner_sign, element_factors, parallelepiped_slopes

  !> Side of the unit cube on which each corner lies.
  real(wp), parameter :: corner_sign(3, 8) = reshape( &
                         [-1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, &
                          -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, &
                          -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, &
                          -1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp], [3, 8])

  !> Distance of the Gauss points from the middle of the cube.
  real(wp), parameter :: at = sqrt(1.0_wp/3.0_wp)
  !> Counters of the tables below.
  integer :: i, k
  !> Functions of the corners at the eight Gauss points of the cube. (corner, point)
  real(wp), parameter :: gauss_value(8, 8) = reshape([((0.125_wp* &
                         (1.0_wp + at*corner_sign(1, i)*corner_sign(1, k))* &
                         (1.0_wp + at*corner_sign(2, i)*corner_sign(2, k))* &
                         (1.0_wp + at*corner_sign(3, i)*corner_sign(3, k)), i=1, 8), k=1, 8)], &
                                                     [8, 8])
  !> Their derivatives. (direction, corner, point)
  real(wp), parameter :: gauss_slope(3, 8, 8) = reshape([(( &
                         0.125_wp*corner_sign(1, i)* &
                         (1.0_wp + at*corner_sign(2, i)*corner_sign(2, k))* &
                         (1.0_wp + at*corner_sign(3, i)*corner_sign(3, k)), &
                         0.125_wp*corner_sign(2, i)* &
                         (1.0_wp + at*corner_sign(1, i)*corner_sign(1, k))* &
                         (1.0_wp + at*corner_sign(3, i)*corner_sign(3, k)), &
                         0.125_wp*corner_sign(3, i)* &
                         (1.0_wp + at*corner_sign(1, i)*corner_sign(1, k))* &
                         (1.0_wp + at*corner_sign(2, i)*corner_sign(2, k)), i=1, 8), k=1, 8)], &
                                                        [3, 8, 8])

contains

  !> Weights and gradients of the corners of an element, and its volume.
  pure subroutine element_factors(dim, corner, weight, slope, volume)
    !> Dimensions: 1, 2 or 3.
    integer, intent(in) :: dim
    !> Corners, from any origin. [m] (dim, 2**dim)
    real(wp), intent(in) :: corner(dim, 2**dim)
    !> Weights; their sum is 1. (2**dim)
    real(wp), intent(out) :: weight(2**dim)
    !> Gradients; their sum is 0. [1/m] (dim, 2**dim)
    real(wp), intent(out) :: slope(dim, 2**dim)
    !> Length, area or volume; weights and gradients are 0 unless it is above 0.
    real(wp), intent(out) :: volume

    weight = 0.0_wp
    slope = 0.0_wp
    select case (dim)
    case (1)
      volume = corner(1, 2) - corner(1, 1)
      weight = 0.5_wp*volume
      slope(1, :) = [-1.0_wp, 1.0_wp]
    case (2)
      call quadrilateral(corner, weight, slope, volume)
    case default
      call hexahedron(corner, weight, slope, volume)
    end select
    if (volume > 0.0_wp) then
      weight = weight/volume
      slope = slope/volume
    else
      weight = 0.0_wp
      slope = 0.0_wp
    end if
  end subroutine element_factors

  !> Gradients of the corners of a parallelepiped, whose weights are all 2**-dim.
  pure subroutine parallelepiped_slopes(dim, edge, slope)
    !> Dimensions: 1, 2 or 3.
    integer, intent(in) :: dim
    !> Halves of its edges. [m] (dim, edges)
    real(wp), intent(in) :: edge(dim, dim)
    !> Gradients. [1/m] (dim, 2**dim)
    real(wp), intent(out) :: slope(dim, 2**dim)
    real(wp) :: f(3, 3), cofactor(3, 3), factor
    integer :: c, d

    ! Unit edges in the directions that there are not.
    f = 0.0_wp
    f(1, 1) = 1.0_wp
    f(2, 2) = 1.0_wp
    f(3, 3) = 1.0_wp
    f(:dim, :dim) = edge
    cofactor(:, 1) = cross(f(:, 2), f(:, 3))
    cofactor(:, 2) = cross(f(:, 3), f(:, 1))
    cofactor(:, 3) = cross(f(:, 1), f(:, 2))
    factor = 0.5_wp**dim/dot_product(f(:, 1), cofactor(:, 1))
    slope = 0.0_wp
    do c = 1, 2**dim
      do d = 1, dim
        slope(:, c) = slope(:, c) + (factor*corner_sign(d, c))*cofactor(:dim, d)
      end do
    end do
  end subroutine parallelepiped_slopes

  !> Integrals over a bilinear quadrilateral.
  pure subroutine quadrilateral(corner, weight, slope, area)
    !> Corners. [m]
    real(wp), intent(in) :: corner(2, 4)
    !> Integrals of the corners' functions. [m2]
    real(wp), intent(out) :: weight(4)
    !> Integrals of their gradients. [m]
    real(wp), intent(out) :: slope(2, 4)
    !> Area. [m2]
    real(wp), intent(out) :: area
    real(wp) :: a(2, 3), jacobian(3)
    integer :: d

    associate (sx => corner_sign(1, :4), sy => corner_sign(2, :4))
      ! x = a_0 + a_1 xi + a_2 eta + a_3 xi eta.
      do d = 1, 2
        a(d, 1) = 0.25_wp*sum(corner(d, :)*sx)
        a(d, 2) = 0.25_wp*sum(corner(d, :)*sy)
        a(d, 3) = 0.25_wp*sum(corner(d, :)*sx*sy)
      end do
      ! The determinant of its gradient is linear in xi and eta.
      jacobian(1) = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
      jacobian(2) = a(1, 1)*a(2, 3) - a(1, 3)*a(2, 1)
      jacobian(3) = a(1, 3)*a(2, 2) - a(1, 2)*a(2, 3)
      area = 4.0_wp*jacobian(1)
      weight = jacobian(1) + (jacobian(2)*sx + jacobian(3)*sy)/3.0_wp
      slope(1, :) = a(2, 2)*sx - a(2, 1)*sy
      slope(2, :) = a(1, 1)*sy - a(1, 2)*sx
    end associate
  end subroutine quadrilateral

  !> Integrals over a trilinear hexahedron.
  !!
  !! The integrands are polynomials of at most third degree in each coordinate, which two Gauss
  !! points a direction integrate exactly.
  pure subroutine hexahedron(corner, weight, slope, volume)
    !> Corners. [m]
    real(wp), intent(in) :: corner(3, 8)
    !> Integrals of the corners' functions. [m3]
    real(wp), intent(out) :: weight(8)
    !> Integrals of their gradients. [m2]
    real(wp), intent(out) :: slope(3, 8)
    !> Volume. [m3]
    real(wp), intent(out) :: volume
    real(wp) :: j(3, 3), cofactor(3, 3), determinant
    integer :: g, c, d

    weight = 0.0_wp
    slope = 0.0_wp
    volume = 0.0_wp
    do g = 1, 8
      j = 0.0_wp
      do c = 1, 8
        do d = 1, 3
          j(:, d) = j(:, d) + corner(:, c)*gauss_slope(d, c, g)
        end do
      end do
      cofactor(:, 1) = cross(j(:, 2), j(:, 3))
      cofactor(:, 2) = cross(j(:, 3), j(:, 1))
      cofactor(:, 3) = cross(j(:, 1), j(:, 2))
      determinant = j(1, 1)*cofactor(1, 1) + j(2, 1)*cofactor(2, 1) + j(3, 1)*cofactor(3, 1)
      volume = volume + determinant
      do c = 1, 8
        weight(c) = weight(c) + determinant*gauss_value(c, g)
        do d = 1, 3
          slope(:, c) = slope(:, c) + cofactor(:, d)*gauss_slope(d, c, g)
        end do
      end do
    end do
  end subroutine hexahedron

  !> Cross product.
  pure function cross(a, b) result(c)
    !> First vector.
    real(wp), intent(in) :: a(3)
    !> Second vector.
    real(wp), intent(in) :: b(3)
    !> a x b.
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

end module mpm_corner_shapes
