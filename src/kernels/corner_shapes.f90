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
    real(wp) :: cofactor(dim, dim), determinant
    integer :: c

    select case (dim)
    case (1)
      cofactor = 1.0_wp
    case (2)
      cofactor(:, 1) = [edge(2, 2), -edge(1, 2)]
      cofactor(:, 2) = [-edge(2, 1), edge(1, 1)]
    case default
      cofactor(:, 1) = cross(edge(:, 2), edge(:, 3))
      cofactor(:, 2) = cross(edge(:, 3), edge(:, 1))
      cofactor(:, 3) = cross(edge(:, 1), edge(:, 2))
    end select
    determinant = dot_product(edge(:, 1), cofactor(:, 1))
    cofactor = (0.5_wp**dim/determinant)*cofactor
    do c = 1, 2**dim
      slope(:, c) = matmul(cofactor, corner_sign(:dim, c))
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
    real(wp) :: at(3), one(3, 8), m(8), dm(8, 3), j(3, 3), cofactor(3, 3), determinant
    integer :: g

    weight = 0.0_wp
    slope = 0.0_wp
    volume = 0.0_wp
    do g = 1, 8
      at = corner_sign(:, g)*sqrt(1.0_wp/3.0_wp)
      one = 1.0_wp + spread(at, 2, 8)*corner_sign
      m = 0.125_wp*one(1, :)*one(2, :)*one(3, :)
      dm(:, 1) = 0.125_wp*corner_sign(1, :)*one(2, :)*one(3, :)
      dm(:, 2) = 0.125_wp*corner_sign(2, :)*one(1, :)*one(3, :)
      dm(:, 3) = 0.125_wp*corner_sign(3, :)*one(1, :)*one(2, :)
      j = matmul(corner, dm)
      cofactor(:, 1) = cross(j(:, 2), j(:, 3))
      cofactor(:, 2) = cross(j(:, 3), j(:, 1))
      cofactor(:, 3) = cross(j(:, 1), j(:, 2))
      determinant = dot_product(j(:, 1), cofactor(:, 1))
      volume = volume + determinant
      weight = weight + determinant*m
      slope = slope + matmul(cofactor, transpose(dm))
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
