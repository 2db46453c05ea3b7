!> Deformation gradients as materials remember them, and small tensors.
!!
!! | TYPE | stored components |
!! |---|---|
!! | 1 | xx yy zz |
!! | 2 | xx xy yx yy zz |
!! | 3, 4, 5 | all nine, row by row |
!!
!! A step with the velocity gradient L is F <- exp(dt L) F, so that det F is multiplied with
!! exp(dt tr L) as the volume is, and a spin rotates.
module mpm_deformation
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_gradient, kinematics_t, type_1d, type_axisymmetric, &
                            type_plane_strain
  implicit none
  private
  public :: advance_deformation, advance_deformations, deformation_size, determinant
  public :: expand_deformation, exponential, identity, inverse, largest_step, root
  public :: small_exponentials, store_deformation, turn_deformation, unpack_gradients

  !> Largest dt |L| of a step, above which a motion is no longer one of a body.
  real(wp), parameter :: largest_step = 30.0_wp
  !> Largest component of a deformation gradient, so that its powers stay numbers.
  real(wp), parameter :: largest = 1.0e30_wp
  !> Largest sum of a column of dt |L| for which the series is used as it is.
  real(wp), parameter :: series_reach = 1.0_wp/32.0_wp
  !> Tensors that are multiplied together: what is between stays in the first-level cache.
  integer, parameter :: lanes = 16
  !> Rows of the stored components, by TYPE.
  integer, parameter :: row(9, 5) = reshape([1, 2, 3, 0, 0, 0, 0, 0, 0, &
                                             1, 1, 2, 2, 3, 0, 0, 0, 0, &
                                             1, 1, 1, 2, 2, 2, 3, 3, 3, &
                                             1, 1, 1, 2, 2, 2, 3, 3, 3, &
                                             1, 1, 1, 2, 2, 2, 3, 3, 3], [9, 5])
  !> Columns of the stored components, by TYPE.
  integer, parameter :: column(9, 5) = reshape([1, 2, 3, 0, 0, 0, 0, 0, 0, &
                                                1, 2, 1, 2, 3, 0, 0, 0, 0, &
                                                1, 2, 3, 1, 2, 3, 1, 2, 3, &
                                                1, 2, 3, 1, 2, 3, 1, 2, 3, &
                                                1, 2, 3, 1, 2, 3, 1, 2, 3], [9, 5])
  !> Unit tensor.
  real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, &
                                                   0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

contains

  !> Stored components of a deformation gradient.
  pure function deformation_size(kin) result(n)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of components.
    integer :: n
    integer, parameter :: sizes(5) = [3, 5, 9, 9, 9]

    n = sizes(kin%sim_type)
  end function deformation_size

  !> Full tensor of stored components.
  pure function expand_deformation(kin, stored) result(f)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Stored components.
    real(wp), intent(in) :: stored(:)
    !> Deformation gradient.
    real(wp) :: f(3, 3)

    f = 0.0_wp
    select case (kin%sim_type)
    case (type_1d)
      f(1, 1) = stored(1)
      f(2, 2) = stored(2)
      f(3, 3) = stored(3)
    case (type_plane_strain)
      f(1, 1) = stored(1)
      f(1, 2) = stored(2)
      f(2, 1) = stored(3)
      f(2, 2) = stored(4)
      f(3, 3) = stored(5)
    case default
      f(1, :) = stored(1:3)
      f(2, :) = stored(4:6)
      f(3, :) = stored(7:9)
    end select
  end function expand_deformation

  !> Stored components of a full tensor.
  pure function store_deformation(kin, f) result(stored)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Deformation gradient.
    real(wp), intent(in) :: f(3, 3)
    !> Stored components, the first ones of nine.
    real(wp) :: stored(9)

    stored = 0.0_wp
    select case (kin%sim_type)
    case (type_1d)
      stored(1:3) = [f(1, 1), f(2, 2), f(3, 3)]
    case (type_plane_strain)
      stored(1:5) = [f(1, 1), f(1, 2), f(2, 1), f(2, 2), f(3, 3)]
    case default
      stored = [f(1, :), f(2, :), f(3, :)]
    end select
  end function store_deformation

  !> F <- exp(dt L) F, and its determinant.
  pure subroutine advance_deformation(dt, l, f, j, good)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradient. [1/s]
    real(wp), intent(in) :: l(3, 3)
    !> Deformation gradient.
    real(wp), intent(inout) :: f(3, 3)
    !> Its determinant.
    real(wp), intent(out) :: j
    !> Whether there is such a deformation.
    logical, intent(out) :: good
    real(wp) :: step(3, 3)

    j = 1.0_wp
    good = all(abs(l) <= largest_step/dt)
    if (.not. good) return
    call exponential(dt*l, step)
    f = matmul(step, f)
    good = all(abs(f) <= largest)
    if (.not. good) return
    j = determinant(f)
    ! A determinant that is no more than its roundings has no sign.
    good = j > 64.0_wp*epsilon(1.0_wp)*norm2(f(1, :))*norm2(f(2, :))*norm2(f(3, :)) &
           .and. j > 1.0_wp/largest**2
  end subroutine advance_deformation

  !> F <- exp(dt L) F of a block of points, and the determinants: many points at a time.
  !!
  !! Points of steps too long for the series are advanced one by one.
  pure subroutine advance_deformations(kin, n, dt, gradient, stored, f, j, first_bad)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Stored components of the deformation gradients in the first rows. (:, n)
    real(wp), intent(inout) :: stored(:, :)
    !> Deformation gradients of the end of the step. (n, 3, 3)
    real(wp), intent(out) :: f(n, 3, 3)
    !> Their determinants. (n)
    real(wp), intent(out) :: j(n)
    !> First point without such a deformation; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: b(n, 3, 3), e(n, 3, 3), one(3, 3), size2(n), most(n)
    logical :: small(n), good(n)
    integer :: c, k, p

    call unpack_gradients(kin, n, dt, gradient, b)
    call unpack_deformations(kin, n, stored, f)
    call small_exponentials(n, b, e, small)
    call follow(n, e, f)
    j = f(:, 1, 1)*(f(:, 2, 2)*f(:, 3, 3) - f(:, 2, 3)*f(:, 3, 2)) &
        - f(:, 1, 2)*(f(:, 2, 1)*f(:, 3, 3) - f(:, 2, 3)*f(:, 3, 1)) &
        + f(:, 1, 3)*(f(:, 2, 1)*f(:, 3, 2) - f(:, 2, 2)*f(:, 3, 1))
    size2 = (f(:, 1, 1)**2 + f(:, 1, 2)**2 + f(:, 1, 3)**2) &
            *(f(:, 2, 1)**2 + f(:, 2, 2)**2 + f(:, 2, 3)**2) &
            *(f(:, 3, 1)**2 + f(:, 3, 2)**2 + f(:, 3, 3)**2)
    most = 0.0_wp
    do k = 1, 3
      do c = 1, 3
        do p = 1, n
          most(p) = max(most(p), abs(f(p, c, k)))
        end do
      end do
    end do
    ! As in `advance_deformation`.
    good = most <= largest .and. j > 1.0_wp/largest**2 .and. &
           j > 64.0_wp*epsilon(1.0_wp)*sqrt(size2)
    do p = 1, n
      if (small(p)) cycle
      one = expand_deformation(kin, stored(:, p))
      call advance_deformation(dt, expand_gradient(kin, gradient(:, p)), one, j(p), good(p))
      f(p, :, :) = one
    end do
    first_bad = findloc(good, .false., dim=1)
    if (first_bad > 0) return
    call pack_deformations(kin, n, f, stored)
  end subroutine advance_deformations

  !> Full tensors dt L of a block of points.
  pure subroutine unpack_gradients(kin, n, dt, gradient, tensor)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> dt L. (n, 3, 3)
    real(wp), intent(out) :: tensor(n, 3, 3)
    integer :: a, d

    tensor = 0.0_wp
    do a = 1, kin%nvel
      do d = 1, kin%dim
        tensor(:, a, d) = dt*gradient((a - 1)*kin%dim + d, :)
      end do
    end do
    if (kin%sim_type == type_axisymmetric) then
      tensor(:, 1, 3) = dt*gradient(7, :)
      tensor(:, 3, 3) = dt*gradient(8, :)
    end if
  end subroutine unpack_gradients

  !> Full tensors of the stored components of a block of points.
  pure subroutine unpack_deformations(kin, n, stored, f)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Stored components in the first rows. (:, n)
    real(wp), intent(in) :: stored(:, :)
    !> Deformation gradients. (n, 3, 3)
    real(wp), intent(out) :: f(n, 3, 3)
    integer :: c

    if (deformation_size(kin) < 9) f = 0.0_wp
    do c = 1, deformation_size(kin)
      f(:, row(c, kin%sim_type), column(c, kin%sim_type)) = stored(c, :)
    end do
  end subroutine unpack_deformations

  !> Stored components of full tensors of a block of points.
  pure subroutine pack_deformations(kin, n, f, stored)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Deformation gradients. (n, 3, 3)
    real(wp), intent(in) :: f(n, 3, 3)
    !> Stored components in the first rows. (:, n)
    real(wp), intent(inout) :: stored(:, :)
    integer :: c

    do c = 1, deformation_size(kin)
      stored(c, :) = f(:, row(c, kin%sim_type), column(c, kin%sim_type))
    end do
  end subroutine pack_deformations

  !> exp(b) - 1 of small tensors b, many at a time, by their series up to b**8/8!.
  !!
  !! b + b**2/2 + b**3 (1/6 + b/24 + b**2/120 + b**3 (1/720 + b/5040 + b**2/40320)): four products.
  !! At a norm of 1/32 what is left out is less than 2**-58 of b.
  pure subroutine small_exponentials(n, b, e, small)
    !> Number of tensors.
    integer, intent(in) :: n
    !> The tensors. (n, 3, 3)
    real(wp), intent(in) :: b(n, 3, 3)
    !> Their exponentials less 1; 0 where b is not small. (n, 3, 3)
    real(wp), intent(out) :: e(n, 3, 3)
    !> Whether no sum of a column of |b| is above 1/32. (n)
    logical, intent(out) :: small(n)
    real(wp), dimension(lanes, 3, 3) :: l, square, cube, factor, product
    real(wp) :: norm(lanes)
    integer :: first, m, i, k

    l = 0.0_wp
    do first = 0, n - 1, lanes
      m = min(lanes, n - first)
      l(:m, :, :) = b(first + 1:first + m, :, :)
      norm = 0.0_wp
      do k = 1, 3
        norm = max(norm, abs(l(:, 1, k)) + abs(l(:, 2, k)) + abs(l(:, 3, k)))
      end do
      small(first + 1:first + m) = norm(:m) <= series_reach
      if (.not. all(small(first + 1:first + m))) then
        do k = 1, 3
          do i = 1, 3
            l(:, i, k) = merge(l(:, i, k), 0.0_wp, norm <= series_reach)
          end do
        end do
      end if
      call multiply(l, l, square)
      call multiply(l, square, cube)
      factor = (1.0_wp/5040.0_wp)*l + (1.0_wp/40320.0_wp)*square
      do k = 1, 3
        factor(:, k, k) = factor(:, k, k) + 1.0_wp/720.0_wp
      end do
      call multiply(cube, factor, product)
      factor = product + ((1.0_wp/24.0_wp)*l + (1.0_wp/120.0_wp)*square)
      do k = 1, 3
        factor(:, k, k) = factor(:, k, k) + 1.0_wp/6.0_wp
      end do
      call multiply(cube, factor, product)
      e(first + 1:first + m, :, :) = l(:m, :, :) + (0.5_wp*square(:m, :, :) + product(:m, :, :))
    end do
  end subroutine small_exponentials

  !> F <- F + e F of a block of points.
  pure subroutine follow(n, e, f)
    !> Number of points.
    integer, intent(in) :: n
    !> Small tensors. (n, 3, 3)
    real(wp), intent(in) :: e(n, 3, 3)
    !> Deformation gradients. (n, 3, 3)
    real(wp), intent(inout) :: f(n, 3, 3)
    real(wp) :: x, y, z
    integer :: k, p

    do k = 1, 3
      do p = 1, n
        x = f(p, 1, k)
        y = f(p, 2, k)
        z = f(p, 3, k)
        f(p, 1, k) = x + (e(p, 1, 1)*x + e(p, 1, 2)*y + e(p, 1, 3)*z)
        f(p, 2, k) = y + (e(p, 2, 1)*x + e(p, 2, 2)*y + e(p, 2, 3)*z)
        f(p, 3, k) = z + (e(p, 3, 1)*x + e(p, 3, 2)*y + e(p, 3, 3)*z)
      end do
    end do
  end subroutine follow

  !> Products of some tensors.
  pure subroutine multiply(a, b, c)
    !> Left factors.
    real(wp), intent(in) :: a(lanes, 3, 3)
    !> Right factors.
    real(wp), intent(in) :: b(lanes, 3, 3)
    !> Products.
    real(wp), intent(out) :: c(lanes, 3, 3)
    integer :: i, k, p

    do k = 1, 3
      do i = 1, 3
        do p = 1, lanes
          c(p, i, k) = a(p, i, 1)*b(p, 1, k) + a(p, i, 2)*b(p, 2, k) + a(p, i, 3)*b(p, 3, k)
        end do
      end do
    end do
  end subroutine multiply

  !> Exponential of a tensor, by its series at a fraction 1/2**s and s squarings.
  !!
  !! At a norm of 1/64 the terms of degree 9 and more sum to less than 2**-54/9!.
  pure subroutine exponential(a, value)
    !> The tensor.
    real(wp), intent(in) :: a(3, 3)
    !> Its exponential.
    real(wp), intent(out) :: value(3, 3)
    real(wp) :: b(3, 3)
    integer :: squarings, k

    squarings = max(0, exponent(64.0_wp*maxval(sum(abs(a), dim=1))))
    b = scale(a, -squarings)
    ! exp(b) - 1 by Horner's rule; what is squared is kept without its 1, which would round it.
    value = b/8.0_wp
    do k = 7, 1, -1
      value = (b + matmul(b, value))/real(k, wp)
    end do
    do k = 1, squarings
      value = 2.0_wp*value + matmul(value, value)
    end do
    do k = 1, 3
      value(k, k) = value(k, k) + 1.0_wp
    end do
  end subroutine exponential

  !> Determinant.
  pure function determinant(a) result(value)
    !> The tensor.
    real(wp), intent(in) :: a(3, 3)
    !> Its determinant.
    real(wp) :: value

    value = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) &
            - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
            + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
  end function determinant

  !> Inverse of a tensor that has one.
  pure function inverse(a) result(b)
    !> The tensor.
    real(wp), intent(in) :: a(3, 3)
    !> Its inverse.
    real(wp) :: b(3, 3)
    integer :: i, j, k, l, m

    do i = 1, 3
      k = mod(i, 3) + 1
      l = mod(k, 3) + 1
      do j = 1, 3
        m = mod(j, 3) + 1
        b(j, i) = a(k, m)*a(l, mod(m, 3) + 1) - a(k, mod(m, 3) + 1)*a(l, m)
      end do
    end do
    b = b/dot_product(a(1, :), b(:, 1))
  end function inverse

  !> Square root of a positive definite symmetric tensor, by Denman and Beavers.
  pure function root(a) result(y)
    !> The tensor.
    real(wp), intent(in) :: a(3, 3)
    !> Its positive definite root.
    real(wp) :: y(3, 3)
    real(wp) :: z(3, 3), before(3, 3)
    integer :: i

    y = a
    z = identity
    do i = 1, 60
      before = y
      y = 0.5_wp*(y + inverse(z))
      z = 0.5_wp*(z + inverse(before))
      if (all(abs(y - before) <= 4.0_wp*epsilon(1.0_wp)*maxval(abs(y)))) exit
    end do
    y = 0.5_wp*(y + transpose(y))
  end function root

  !> TYPE 4: express deformation gradients in the basis of the moved points, turned by -dt L_rt.
  pure subroutine turn_deformation(kin, n, dt, gradient, f)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Deformation gradients, row by row. (9, n)
    real(wp), intent(inout) :: f(9, n)
    real(wp) :: c, s, radial(3)
    integer :: p

    if (kin%sim_type /= type_axisymmetric) return
    do p = 1, n
      c = cos(dt*gradient(7, p))
      s = -sin(dt*gradient(7, p))
      radial = f(1:3, p)
      f(1:3, p) = c*radial + s*f(7:9, p)
      f(7:9, p) = c*f(7:9, p) - s*radial
    end do
  end subroutine turn_deformation

end module mpm_deformation
