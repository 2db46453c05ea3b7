!> Check of exact solutions by finite differences.
!!
!! From the motion alone, as a map of Cartesian space whatever the simulation TYPE, it forms
!! velocity, F, L, the Jaumann rate of the stress and DIV P, none of them by a formula that the
!! drivers use.
module mpm_manufactured_fixture
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_stress, kinematics_t, make_kinematics, type_axisymmetric
  use mpm_load_driver, only: exact_state_t, load_driver_t
  implicit none
  private
  public :: misfit_of_solution, solution_scales_t

  !> What a solution is measured with.
  type :: solution_scales_t
    !> Density of the reference configuration. [kg/m3]
    real(wp) :: density = 1.0_wp
    !> Young's modulus. [Pa]
    real(wp) :: young = 1.0_wp
    !> Poisson ratio.
    real(wp) :: poisson = 0.0_wp
    !> Size of the displacements. [m]
    real(wp) :: amplitude = 1.0_wp
    !> Length over which they change by a part that is not small, below a quarter wave. [m]
    real(wp) :: length = 1.0_wp
    !> Time in which they change by a part that is not small, below a quarter period. [s]
    real(wp) :: time = 1.0_wp
  end type solution_scales_t

  !> Steps of the differences over `length` and `time`.
  real(wp), parameter :: step = 2.0e-3_wp
  !> Rounding of a value over its size: a few operations on arguments of at most ten radians.
  real(wp), parameter :: rounding = 16.0_wp*epsilon(1.0_wp)
  !> A tolerance above this part of the size of what is checked would say nothing.
  real(wp), parameter :: significant = 1.0e-5_wp
  !> Position, velocity, stress, determinant of F.
  integer, parameter :: n_sampled = 13
  !> Velocity, determinant of F, Jaumann rate, body force.
  integer, parameter :: n_checked = 13
  integer, parameter :: first(4) = [1, 4, 5, 11], last(4) = [3, 4, 10, 13]

contains

  !> Largest deviation over its tolerance: 1 or less where the solution is one.
  !!
  !! 1: velocity against dx/dt; 2: jacobian against det F; 3: dS/dt against
  !! lambda tr(D) I + 2 G D + W S - S W; 4: acceleration against d2x/dt2 - DIV P/rho.
  !! The tolerance is what doubling the steps changes, 15 times the error of a fourth-order
  !! difference, and a bound of the rounding errors. The result is huge where that is not small.
  function misfit_of_solution(driver, sim_type, scales, references, times) result(misfit)
    !> The driver, set up.
    class(load_driver_t), intent(in) :: driver
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> Reference positions, Cartesian; TYPE 4: the axis is along z. [m] (3, n)
    real(wp), intent(in) :: references(:, :)
    !> Times. [s]
    real(wp), intent(in) :: times(:)
    !> Deviations over tolerances.
    real(wp) :: misfit(4)
    type(kinematics_t) :: kin
    real(wp) :: deviation(n_checked), coarse(n_checked), tolerance(n_checked)
    real(wp) :: noise(4), size_of(4)
    integer :: c, i, j

    kin = make_kinematics(sim_type)
    size_of = sizes(scales)
    misfit = 0.0_wp
    do j = 1, size(times)
      do i = 1, size(references, 2)
        call compare(driver, kin, scales, references(:, i), times(j), 1.0_wp, deviation)
        call compare(driver, kin, scales, references(:, i), times(j), 2.0_wp, coarse)
        noise = noises(driver, kin, scales, references(:, i), times(j))
        do c = 1, 4
          tolerance(first(c):last(c)) = abs(coarse(first(c):last(c)) &
                                            - deviation(first(c):last(c))) + noise(c)
          misfit(c) = max(misfit(c), maxval(abs(deviation(first(c):last(c))) &
                                            /tolerance(first(c):last(c))))
          if (any(tolerance(first(c):last(c)) > significant*size_of(c))) misfit(c) = huge(1.0_wp)
        end do
      end do
    end do
  end function misfit_of_solution

  !> Sizes of velocity, strain, rate of stress and acceleration in a solution.
  pure function sizes(scales) result(size_of)
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> The sizes.
    real(wp) :: size_of(4)

    associate (a => scales%amplitude, l => scales%length, t => scales%time)
      size_of = [a/t, a/l, modulus(scales)*a/(l*t), a/t**2 + modulus(scales)/scales%density*a/l**2]
    end associate
  end function sizes

  !> Bounds of the rounding errors.
  !!
  !! A difference multiplies the error of a value by at most (8 + 8 + 1 + 1)/12 over the step. The
  !! entries of F, its inverse and its cofactors are taken to be at most 2. To first order, with e
  !! the error of an entry of F, det F has 9 2 e, a cofactor 8 e, an entry of the inverse 36 e.
  function noises(driver, kin, scales, reference, time) result(noise)
    !> The driver.
    class(load_driver_t), intent(in) :: driver
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Of velocity, determinant, rate of stress, body force.
    real(wp) :: noise(4)
    real(wp) :: q(n_sampled), per_length, per_time, f, l, m, p, rate, stress, v, x

    q = sample(driver, kin, reference, time)
    per_length = 1.5_wp/(step*scales%length)
    per_time = 1.5_wp/(step*scales%time)
    ! A logarithm of a stretch near 1 has the rounding error of the stretch, whatever its size.
    m = modulus(scales)
    stress = maxval(abs(q(7:12)))
    x = rounding*max(maxval(abs(q(:3))), maxval(abs(reference)), scales%length)
    v = rounding*max(maxval(abs(q(4:6))), scales%amplitude/scales%time)
    rate = maxval(abs(gradient_of(driver, kin, scales, reference, time, 4, 1.0_wp)))
    f = per_length*x
    l = 3.0_wp*(2.0_wp*per_length*v + 36.0_wp*f*rate)
    p = 3.0_wp*(2.0_wp*rounding*m + 8.0_wp*f*stress)
    noise(1) = per_time*x
    noise(2) = 18.0_wp*f
    noise(3) = per_time*rounding*m + (3.0_wp*m + 6.0_wp*stress)*l
    noise(4) = per_time*v + 3.0_wp*per_length*p/scales%density
  end function noises

  !> lambda + 2 G.
  pure function modulus(scales) result(m)
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> The modulus of uniaxial strain. [Pa]
    real(wp) :: m

    m = lame(scales) + scales%young/(1.0_wp + scales%poisson)
  end function modulus

  !> First Lame constant.
  pure function lame(scales) result(lambda)
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> lambda. [Pa]
    real(wp) :: lambda

    lambda = scales%young*scales%poisson &
             /((1.0_wp + scales%poisson)*(1.0_wp - 2.0_wp*scales%poisson))
  end function lame

  !> Deviations of a solution at one point and time.
  subroutine compare(driver, kin, scales, reference, time, wider, deviation)
    !> The driver.
    class(load_driver_t), intent(in) :: driver
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Factor of the steps.
    real(wp), intent(in) :: wider
    !> Velocity, determinant, rate of stress, body force.
    real(wp), intent(out) :: deviation(n_checked)
    real(wp) :: q(n_sampled), dq(n_sampled), f(3, 3), l(3, 3), d(3, 3), s(3, 3), cof(3, 3), jac
    real(wp) :: rate(3, 3), div(3), own(3), basis(3, 3), x(3), v(3), h
    integer :: j

    q = sample(driver, kin, reference, time)
    h = wider*step*scales%time
    dq = difference(sample(driver, kin, reference, time - 2.0_wp*h), &
                    sample(driver, kin, reference, time - h), &
                    sample(driver, kin, reference, time + h), &
                    sample(driver, kin, reference, time + 2.0_wp*h), h)
    f = gradient_of(driver, kin, scales, reference, time, 1, wider)
    cof = cofactors(f)
    jac = dot_product(f(:, 1), cof(:, 1))
    l = matmul(gradient_of(driver, kin, scales, reference, time, 4, wider), transpose(cof))/jac
    d = 0.5_wp*(l + transpose(l))
    s = expand_stress(q(7:12))
    rate = 0.5_wp*(matmul(l - transpose(l), s) - matmul(s, l - transpose(l))) &
           + scales%young/(1.0_wp + scales%poisson)*d
    do j = 1, 3
      rate(j, j) = rate(j, j) + lame(scales)*(l(1, 1) + l(2, 2) + l(3, 3))
    end do
    div = 0.0_wp
    h = wider*step*scales%length
    do j = 1, 3
      div = div + difference(nominal(-2.0_wp), nominal(-1.0_wp), nominal(1.0_wp), &
                             nominal(2.0_wp), h)
    end do
    call own_frame(driver, kin, reference, time, own, basis)
    ! Position and velocity in the components of the job.
    v = matmul(transpose(basis), q(4:6))
    x = q(:3)
    if (kin%sim_type == type_axisymmetric) x = [norm2(q(:2)), q(3), 0.0_wp]
    x(kin%dim + 1:) = 0.0_wp
    deviation(1:3) = dq(1:3) - q(4:6)
    deviation(4) = jac - q(13)
    deviation(5:10) = dq(7:12) - [rate(1, 1), rate(2, 2), rate(3, 3), rate(1, 2), rate(2, 3), &
                                  rate(3, 1)]
    deviation(11:13) = matmul(transpose(basis), dq(4:6) - div/scales%density) &
                       - driver%acceleration(kin, own, x, v, time)

  contains

    !> Column j of P = J S F^-T beside the point.
    function nominal(steps) result(column)
      !> Distance in steps along axis j.
      real(wp), intent(in) :: steps
      !> Stress on the reference face with normal j.
      real(wp) :: column(3)
      real(wp) :: beside(3), there(n_sampled), faces(3, 3)

      beside = reference
      beside(j) = beside(j) + steps*h
      there = sample(driver, kin, beside, time)
      faces = cofactors(gradient_of(driver, kin, scales, beside, time, 1, wider))
      column = matmul(expand_stress(there(7:12)), faces(:, j))
    end function nominal
  end subroutine compare

  !> Derivatives of three sampled values by the reference position.
  function gradient_of(driver, kin, scales, reference, time, c, wider) result(gradient)
    !> The driver.
    class(load_driver_t), intent(in) :: driver
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Material and size of the solution.
    type(solution_scales_t), intent(in) :: scales
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> The first of the three: 1 for positions, 4 for velocities.
    integer, intent(in) :: c
    !> Factor of the steps.
    real(wp), intent(in) :: wider
    !> d value_i / d X_j.
    real(wp) :: gradient(3, 3)
    real(wp) :: dq(n_sampled), h, shift(3)
    integer :: j

    h = wider*step*scales%length
    do j = 1, 3
      shift = 0.0_wp
      shift(j) = h
      dq = difference(sample(driver, kin, reference - 2.0_wp*shift, time), &
                      sample(driver, kin, reference - shift, time), &
                      sample(driver, kin, reference + shift, time), &
                      sample(driver, kin, reference + 2.0_wp*shift, time), h)
      gradient(:, j) = dq(c:c + 2)
    end do
  end function gradient_of

  !> Fourth-order central difference.
  pure function difference(qmm, qm, qp, qpp, h) result(dq)
    !> Values two steps before.
    real(wp), intent(in) :: qmm(:)
    !> Values a step before.
    real(wp), intent(in) :: qm(:)
    !> Values a step behind.
    real(wp), intent(in) :: qp(:)
    !> Values two steps behind.
    real(wp), intent(in) :: qpp(:)
    !> The step.
    real(wp), intent(in) :: h
    !> The derivatives.
    real(wp) :: dq(size(qm))

    dq = (8.0_wp*(qp - qm) - (qpp - qmm))/(12.0_wp*h)
  end function difference

  !> Cofactors of a matrix: det(A) A^-T.
  pure function cofactors(a) result(cof)
    !> The matrix.
    real(wp), intent(in) :: a(3, 3)
    !> Its cofactors.
    real(wp) :: cof(3, 3)
    integer :: j, k, m

    do j = 1, 3
      k = modulo(j, 3) + 1
      m = modulo(k, 3) + 1
      cof(:, j) = [a(2, k)*a(3, m) - a(3, k)*a(2, m), a(3, k)*a(1, m) - a(1, k)*a(3, m), &
                   a(1, k)*a(2, m) - a(2, k)*a(1, m)]
    end do
  end function cofactors

  !> Cartesian position, velocity and stress and the determinant of F by the driver.
  function sample(driver, kin, reference, time) result(q)
    !> The driver.
    class(load_driver_t), intent(in) :: driver
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Position, velocity, stress in the order of `expand_stress`, determinant.
    real(wp) :: q(n_sampled)
    type(exact_state_t) :: state
    real(wp) :: own(3), basis(3, 3), s(3, 3)

    call own_frame(driver, kin, reference, time, own, basis)
    call driver%exact(kin, own, time, state)
    if (kin%sim_type == type_axisymmetric) then
      q(:3) = (own(1) + state%displacement(1))*basis(:, 1) &
              + (own(2) + state%displacement(2))*basis(:, 2)
    else
      q(:3) = reference + state%displacement
    end if
    q(4:6) = matmul(basis, state%velocity)
    s = matmul(basis, matmul(expand_stress(state%stress), transpose(basis)))
    q(7:12) = [s(1, 1), s(2, 2), s(3, 3), s(1, 2), s(2, 3), s(3, 1)]
    q(13) = state%jacobian
  end function sample

  !> Reference position in the coordinates of the job, and the basis of the point's components.
  !!
  !! TYPE 4: r, z; e_r, e_z, e_theta where the point is now. The angle by which it has turned
  !! follows from the displacement along theta if r is constant or nothing turns.
  subroutine own_frame(driver, kin, reference, time, own, basis)
    !> The driver.
    class(load_driver_t), intent(in) :: driver
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Reference position. [m]
    real(wp), intent(in) :: reference(3)
    !> Time. [s]
    real(wp), intent(in) :: time
    !> Reference position of the job, components beyond dim 0. [m]
    real(wp), intent(out) :: own(3)
    !> Base vectors as columns.
    real(wp), intent(out) :: basis(3, 3)
    type(exact_state_t) :: state
    real(wp) :: angle

    own = 0.0_wp
    basis = 0.0_wp
    if (kin%sim_type == type_axisymmetric) then
      own(:2) = [norm2(reference(:2)), reference(3)]
      call driver%exact(kin, own, time, state)
      angle = atan2(reference(2), reference(1)) + state%displacement(3)/own(1)
      basis(:2, 1) = [cos(angle), sin(angle)]
      basis(3, 2) = 1.0_wp
      basis(:2, 3) = [-sin(angle), cos(angle)]
    else
      own(:kin%dim) = reference(:kin%dim)
      basis(1, 1) = 1.0_wp
      basis(2, 2) = 1.0_wp
      basis(3, 3) = 1.0_wp
    end if
  end subroutine own_frame

end module mpm_manufactured_fixture
