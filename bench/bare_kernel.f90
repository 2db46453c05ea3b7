!> The reference of the bench suite: the bandwidth of the memory, and a bare step in 3D.
!!
!! The bare step is what every step of `ExplicitUSL` with hats must do and no more: points to grid,
!! update of the nodes, grid to points, motion, volume and Jaumann update of an elastic stress, for
!! 8 points in each cell that stay where they were sorted. It reads and writes 320 bytes a point.
!!
!! Prints `triad_gb_per_s`, `kernel_ns`, its parts `p2g_ns`, `nodes_ns` and `g2p_ns` (motion and
!! stress included), and `bytes_per_point`, one each line.
program bare_kernel
  use, intrinsic :: iso_fortran_env, only: lp => int64, output_unit, wp => real64
  implicit none

  !> Cells along each side; points in a cell.
  integer, parameter :: nc = 31, per_cell = 8
  !> Nodes along each side.
  integer, parameter :: nn = nc + 1
  !> Points.
  integer, parameter :: np = per_cell*nc**3
  !> Steps of a measurement, and measurements.
  integer, parameter :: steps = 12, repeats = 9
  !> What a point reads and writes in a step: in P2G x, v, T, m, V; in G2P x, v, T, V, both ways.
  integer, parameter :: bytes = 8*(3 + 3 + 6 + 1 + 1) + 2*8*(3 + 3 + 6 + 1)
  !> Corners of a cell: N = (s1 xi1 + t1)(s2 xi2 + t2)(s3 xi3 + t3).
  real(wp), parameter :: s1(8) = [-1, 1, -1, 1, -1, 1, -1, 1], t1(8) = [1, 0, 1, 0, 1, 0, 1, 0]
  !> The same in y.
  real(wp), parameter :: s2(8) = [-1, -1, 1, 1, -1, -1, 1, 1], t2(8) = [1, 1, 0, 0, 1, 1, 0, 0]
  !> The same in z.
  real(wp), parameter :: s3(8) = [-1, -1, -1, -1, 1, 1, 1, 1], t3(8) = [1, 1, 1, 1, 0, 0, 0, 0]
  !> Entries of the triad's arrays: more than any cache.
  integer, parameter :: triad_size = 40000000
  !> Points to grid, nodes, grid to points. [ns]
  real(wp) :: parts(3)

  write (output_unit, '(a,f10.3)') 'triad_gb_per_s ', triad()
  call time_kernel(parts)
  write (output_unit, '(a,f10.3)') 'kernel_ns ', sum(parts)
  write (output_unit, '(a,f10.3)') 'p2g_ns ', parts(1)
  write (output_unit, '(a,f10.3)') 'nodes_ns ', parts(2)
  write (output_unit, '(a,f10.3)') 'g2p_ns ', parts(3)
  write (output_unit, '(a,i10)') 'bytes_per_point ', bytes

contains

  !> Seconds of a clock.
  function clock() result(seconds)
    !> The time. [s]
    real(wp) :: seconds
    integer(lp) :: ticks, rate

    call system_clock(ticks, rate)
    seconds = real(ticks, wp)/real(rate, wp)
  end function clock

  !> Bandwidth of a = b + s c, best of several. [GB/s]
  function triad() result(bandwidth)
    !> The bandwidth, of three arrays.
    real(wp) :: bandwidth
    real(wp), allocatable :: a(:), b(:), c(:)
    real(wp) :: begun, best, sum_a
    integer :: i

    allocate (a(triad_size), b(triad_size), c(triad_size))
    a = 0.0_wp
    b = 1.0_wp
    c = 2.0_wp
    best = huge(1.0_wp)
    sum_a = 0.0_wp
    do i = 1, 5
      begun = clock()
      call add_scaled(real(i, wp), b, c, a)
      best = min(best, clock() - begun)
      sum_a = sum_a + a(i)
    end do
    ! A use of the result, without which there would be nothing to compute.
    if (sum_a < 0.0_wp) best = 2.0_wp*best
    bandwidth = 24.0e-9_wp*real(triad_size, wp)/best
  end function triad

  !> a = b + s c.
  subroutine add_scaled(s, b, c, a)
    !> Factor.
    real(wp), intent(in) :: s
    !> First term.
    real(wp), intent(in) :: b(triad_size)
    !> Second term.
    real(wp), intent(in) :: c(triad_size)
    !> The sum.
    real(wp), intent(out) :: a(triad_size)

    a = b + s*c
  end subroutine add_scaled

  !> Time of a bare step for a point, best of several.
  subroutine time_kernel(best)
    !> Points to grid, nodes, grid to points. [ns]
    real(wp), intent(out) :: best(3)
    real(wp), parameter :: h = 1.0_wp/real(nc, wp), dt = 1.0e-7_wp
    real(wp), allocatable :: x(:, :), v(:, :), t(:, :), m(:), vol(:), sums(:, :), moved(:, :)
    real(wp) :: now(0:3), spent(3)
    integer :: i, j, k, p, q, r

    allocate (x(3, np), v(3, np), t(6, np), m(np), vol(np), sums(7, nn**3), moved(6, nn**3))
    m = 1000.0_wp*h**3/8.0_wp
    vol = h**3/8.0_wp
    t = 0.0_wp
    p = 0
    do k = 0, nc - 1
      do j = 0, nc - 1
        do i = 0, nc - 1
          do q = 0, per_cell - 1
            p = p + 1
            x(:, p) = h*(real([i, j, k], wp) + 0.25_wp &
                         + 0.5_wp*real([mod(q, 2), mod(q/2, 2), q/4], wp))
            v(:, p) = [x(2, p), -x(1, p), 0.1_wp*x(3, p)]
          end do
        end do
      end do
    end do
    best = 0.1_wp*huge(1.0_wp)
    do r = 1, repeats
      spent = 0.0_wp
      do i = 1, steps
        now(0) = clock()
        sums = 0.0_wp
        call to_grid(1.0_wp/h, x, v, t, m, vol, sums)
        now(1) = clock()
        call update(dt, sums, moved)
        now(2) = clock()
        call to_points(dt, 1.0_wp/h, 1.0e6_wp, 4.0e5_wp, moved, x, v, t, vol)
        now(3) = clock()
        spent = spent + now(1:) - now(:2)
      end do
      spent = 1.0e9_wp*spent/(real(steps, wp)*real(np, wp))
      if (sum(spent) < sum(best)) best = spent
    end do
    if (.not. sum(vol) > 0.0_wp) best = 2.0_wp*best
  end subroutine time_kernel

  !> First node of the corners of a cell, less one.
  pure function corner(i, j, k) result(node)
    !> Cell in x.
    integer, intent(in) :: i
    !> Cell in y.
    integer, intent(in) :: j
    !> Cell in z.
    integer, intent(in) :: k
    !> The node.
    integer :: node

    node = i + nn*(j + nn*k)
  end function corner

  !> Mass, momentum and internal force of the nodes.
  subroutine to_grid(inverse_h, x, v, t, m, vol, sums)
    !> One over the spacing. [1/m]
    real(wp), intent(in) :: inverse_h
    !> Positions. [m]
    real(wp), intent(in) :: x(3, np)
    !> Velocities. [m/s]
    real(wp), intent(in) :: v(3, np)
    !> Stresses. [Pa]
    real(wp), intent(in) :: t(6, np)
    !> Masses. [kg]
    real(wp), intent(in) :: m(np)
    !> Volumes. [m3]
    real(wp), intent(in) :: vol(np)
    !> Mass, momentum, force.
    real(wp), intent(inout) :: sums(7, nn**3)
    integer, parameter :: offset(8) = [1, 2, nn + 1, nn + 2, nn*nn + 1, nn*nn + 2, nn*nn + nn + 1, &
                                       nn*nn + nn + 2]
    real(wp) :: acc(8, 7), xi(3), n1, n2, n3, n, gx, gy, gz, f(6)
    integer :: i, j, k, p, q, l, node

    p = 0
    do k = 0, nc - 1
      do j = 0, nc - 1
        do i = 0, nc - 1
          acc = 0.0_wp
          do q = 1, per_cell
            p = p + 1
            xi = x(:, p)*inverse_h - real([i, j, k], wp)
            f = -(vol(p)*inverse_h)*t(:, p)
            !$omp simd private(n1, n2, n3, n, gx, gy, gz)
            do l = 1, 8
              n1 = s1(l)*xi(1) + t1(l)
              n2 = s2(l)*xi(2) + t2(l)
              n3 = s3(l)*xi(3) + t3(l)
              gx = s1(l)*n2*n3
              gy = s2(l)*n1*n3
              gz = s3(l)*n1*n2
              n = m(p)*n1*n2*n3
              acc(l, 1) = acc(l, 1) + n
              acc(l, 2) = acc(l, 2) + n*v(1, p)
              acc(l, 3) = acc(l, 3) + n*v(2, p)
              acc(l, 4) = acc(l, 4) + n*v(3, p)
              acc(l, 5) = acc(l, 5) + f(1)*gx + f(4)*gy + f(6)*gz
              acc(l, 6) = acc(l, 6) + f(4)*gx + f(2)*gy + f(5)*gz
              acc(l, 7) = acc(l, 7) + f(6)*gx + f(5)*gy + f(3)*gz
            end do
          end do
          node = corner(i, j, k)
          do l = 1, 8
            sums(:, node + offset(l)) = sums(:, node + offset(l)) + acc(l, :)
          end do
        end do
      end do
    end do
  end subroutine to_grid

  !> Velocities of the nodes and their increments.
  subroutine update(dt, sums, moved)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Mass, momentum, force.
    real(wp), intent(in) :: sums(7, nn**3)
    !> Velocity, increment. [m/s]
    real(wp), intent(out) :: moved(6, nn**3)
    integer :: i

    do i = 1, nn**3
      moved(4:6, i) = dt*sums(5:7, i)/sums(1, i)
      moved(1:3, i) = sums(2:4, i)/sums(1, i) + moved(4:6, i)
    end do
  end subroutine update

  !> Motion, volume and stress of the points.
  subroutine to_points(dt, inverse_h, lambda, shear, moved, x, v, t, vol)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> One over the spacing. [1/m]
    real(wp), intent(in) :: inverse_h
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Velocities of the nodes, increments. [m/s]
    real(wp), intent(in) :: moved(6, nn**3)
    !> Positions. [m]
    real(wp), intent(inout) :: x(3, np)
    !> Velocities. [m/s]
    real(wp), intent(inout) :: v(3, np)
    !> Stresses. [Pa]
    real(wp), intent(inout) :: t(6, np)
    !> Volumes. [m3]
    real(wp), intent(inout) :: vol(np)
    integer, parameter :: offset(8) = [1, 2, nn + 1, nn + 2, nn*nn + 1, nn*nn + 2, nn*nn + nn + 1, &
                                       nn*nn + nn + 2]
    real(wp) :: near(8, 4), step(8, 4), row, r0(4), ry(4), rz(4), xi(3)
    real(wp) :: value(8), in_x(8), in_y(8), in_z(8), l9(9)
    integer :: i, j, k, p, q, l, c, node

    near = 0.0_wp
    step = 0.0_wp
    p = 0
    do k = 0, nc - 1
      do j = 0, nc - 1
        do i = 0, nc - 1
          node = corner(i, j, k)
          ! Along x the field is near + xi step.
          do l = 1, 4
            near(:6, l) = moved(:, node + offset(2*l - 1))
            step(:6, l) = moved(:, node + offset(2*l)) - near(:6, l)
          end do
          do q = 1, per_cell
            p = p + 1
            xi = x(:, p)*inverse_h - real([i, j, k], wp)
            r0 = [(1.0_wp - xi(2))*(1.0_wp - xi(3)), xi(2)*(1.0_wp - xi(3)), &
                  (1.0_wp - xi(2))*xi(3), xi(2)*xi(3)]
            ry = inverse_h*[xi(3) - 1.0_wp, 1.0_wp - xi(3), -xi(3), xi(3)]
            rz = inverse_h*[xi(2) - 1.0_wp, -xi(2), 1.0_wp - xi(2), xi(2)]
            !$omp simd private(row)
            do c = 1, 8
              row = near(c, 1) + xi(1)*step(c, 1)
              value(c) = r0(1)*row
              in_x(c) = r0(1)*step(c, 1)
              in_y(c) = ry(1)*row
              in_z(c) = rz(1)*row
              do l = 2, 4
                row = near(c, l) + xi(1)*step(c, l)
                value(c) = value(c) + r0(l)*row
                in_x(c) = in_x(c) + r0(l)*step(c, l)
                in_y(c) = in_y(c) + ry(l)*row
                in_z(c) = in_z(c) + rz(l)*row
              end do
            end do
            l9 = [inverse_h*in_x(1), in_y(1), in_z(1), inverse_h*in_x(2), in_y(2), in_z(2), &
                  inverse_h*in_x(3), in_y(3), in_z(3)]
            x(:, p) = x(:, p) + dt*value(1:3)
            v(:, p) = v(:, p) + value(4:6)
            vol(p) = vol(p)*(1.0_wp + dt*(l9(1) + l9(5) + l9(9)))
            call rotate(dt, lambda, shear, l9, t(:, p))
          end do
        end do
      end do
    end do
  end subroutine to_points

  !> Jaumann update of an elastic stress.
  pure subroutine rotate(dt, lambda, shear, l, t)
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> First Lame constant. [Pa]
    real(wp), intent(in) :: lambda
    !> Shear modulus. [Pa]
    real(wp), intent(in) :: shear
    !> Velocity gradient, row by row. [1/s]
    real(wp), intent(in) :: l(9)
    !> Stress xx yy zz xy yz zx. [Pa]
    real(wp), intent(inout) :: t(6)
    real(wp) :: sphere, g, wxy, wyz, wzx, s(6)

    s = t
    sphere = dt*lambda*(l(1) + l(5) + l(9))
    g = dt*shear
    wxy = 0.5_wp*dt*(l(2) - l(4))
    wyz = 0.5_wp*dt*(l(6) - l(8))
    wzx = 0.5_wp*dt*(l(7) - l(3))
    t(1) = s(1) + sphere + 2.0_wp*(g*l(1) + wxy*s(4) - wzx*s(6))
    t(2) = s(2) + sphere + 2.0_wp*(g*l(5) + wyz*s(5) - wxy*s(4))
    t(3) = s(3) + sphere + 2.0_wp*(g*l(9) + wzx*s(6) - wyz*s(5))
    t(4) = s(4) + g*(l(2) + l(4)) + wxy*(s(2) - s(1)) + wyz*s(6) - wzx*s(5)
    t(5) = s(5) + g*(l(6) + l(8)) + wyz*(s(3) - s(2)) + wzx*s(4) - wxy*s(6)
    t(6) = s(6) + g*(l(3) + l(7)) + wzx*(s(1) - s(3)) + wxy*s(5) - wyz*s(4)
  end subroutine rotate

end program bare_kernel
