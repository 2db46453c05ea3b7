!> Nodal velocities from what was mapped, and the update of the nodes, over all nodes of a window.
!!
!! Nodes are taken in blocks. The masses of a block are written out once for each component; then
!! fields are single rows of numbers, and loops over them vectors, whatever the number of
!! components.
module mpm_node_update
  use mpm_kinds, only: wp
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: advance_nodes, finish_mapping

  !> Nodes in a block.
  integer, parameter :: node_block = 64
  !> Stands for the mass of nodes without any.
  real(wp), parameter :: no_mass = huge(1.0_wp)

contains

  !> Add the body force and form the nodal velocities.
  !!
  !! At nodes of negligible mass the acceleration by internal forces waits in `increment`: it takes
  !! part in the velocities of the points, where the small weight of the node makes up for it and
  !! momentum is conserved, but not in the velocity of the node, from which L is formed.
  subroutine finish_mapping(nvel, n, threads, cutoff, body_force, mass, momentum, force, &
                            velocity, increment)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Number of nodes.
    integer, intent(in) :: n
    !> Number of threads.
    integer, intent(in) :: threads
    !> Mass at or below which a node is negligible. [kg]
    real(wp), intent(in) :: cutoff
    !> Acceleration by the body force. [m/s2]
    real(wp), intent(in) :: body_force(3)
    !> Nodal masses. [kg]
    real(wp), intent(in) :: mass(n)
    !> Nodal momenta. [kg m/s]
    real(wp), intent(in) :: momentum(nvel, n)
    !> Nodal forces. [N]
    real(wp), intent(inout) :: force(nvel, n)
    !> Nodal velocities. [m/s]
    real(wp), intent(out) :: velocity(nvel, n)
    !> Accelerations by the internal forces of negligible nodes, 0 elsewhere. [m/s2]
    real(wp), intent(out) :: increment(nvel, n)
    real(wp) :: masses(3*node_block), fall(3*node_block), lightest
    integer :: a, b
    logical :: falls

    falls = any(abs(body_force(:nvel)) > 0.0_wp)
    do a = 0, node_block - 1
      fall(a*nvel + 1:(a + 1)*nvel) = body_force(:nvel)
    end do
    !$omp parallel do default(none) num_threads(useful_threads(threads, n)) schedule(static) &
    !$omp shared(nvel, n, cutoff, fall, falls, mass, momentum, force, velocity, increment) &
    !$omp private(a, b, masses, lightest)
    do a = 1, n, node_block
      b = min(n, a + node_block - 1)
      call write_out(nvel, b - a + 1, mass(a:b), masses, lightest)
      call form_velocities(nvel*(b - a + 1), masses, momentum(:, a:b), velocity(:, a:b), &
                           increment(:, a:b))
      if (lightest <= cutoff) then
        call set_aside(nvel, b - a + 1, cutoff, mass(a:b), force(:, a:b), increment(:, a:b))
      end if
      if (falls) then
        call add_weights(nvel*(b - a + 1), fall, masses, force(:, a:b))
      end if
    end do
    !$omp end parallel do
  end subroutine finish_mapping

  !> Advance the nodal momenta: P += dt f, v = P/m, dv = dt f/m.
  subroutine advance_nodes(nvel, n, threads, dt, mass, force, momentum, velocity, increment)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Number of nodes.
    integer, intent(in) :: n
    !> Number of threads.
    integer, intent(in) :: threads
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Nodal masses. [kg]
    real(wp), intent(in) :: mass(n)
    !> Nodal forces. [N]
    real(wp), intent(in) :: force(nvel, n)
    !> Nodal momenta. [kg m/s]
    real(wp), intent(inout) :: momentum(nvel, n)
    !> Nodal velocities. [m/s]
    real(wp), intent(out) :: velocity(nvel, n)
    !> On entry accelerations that `force` leaves out, on exit velocity increments. [m/s]
    real(wp), intent(inout) :: increment(nvel, n)
    real(wp) :: masses(3*node_block), lightest
    integer :: a, b

    !$omp parallel do default(none) num_threads(useful_threads(threads, n)) schedule(static) &
    !$omp shared(nvel, n, dt, mass, force, momentum, velocity, increment) &
    !$omp private(a, b, masses, lightest)
    do a = 1, n, node_block
      b = min(n, a + node_block - 1)
      call write_out(nvel, b - a + 1, mass(a:b), masses, lightest)
      call push(nvel*(b - a + 1), dt, masses, force(:, a:b), momentum(:, a:b), velocity(:, a:b), &
                increment(:, a:b))
    end do
    !$omp end parallel do
  end subroutine advance_nodes

  !> Write the masses of nodes out for each component.
  pure subroutine write_out(nvel, n, mass, masses, lightest)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Number of nodes.
    integer, intent(in) :: n
    !> Nodal masses. [kg]
    real(wp), intent(in) :: mass(n)
    !> Masses of the components; `no_mass` at nodes without mass. [kg]
    real(wp), intent(out) :: masses(nvel*n)
    !> Least mass of nodes that have one. [kg]
    real(wp), intent(out) :: lightest
    real(wp) :: m
    integer :: i

    lightest = no_mass
    select case (nvel)
    case (1)
      !$omp simd private(m) reduction(min:lightest)
      do i = 1, n
        m = merge(mass(i), no_mass, mass(i) > 0.0_wp)
        lightest = min(lightest, m)
        masses(i) = m
      end do
    case (2)
      !$omp simd private(m) reduction(min:lightest)
      do i = 1, n
        m = merge(mass(i), no_mass, mass(i) > 0.0_wp)
        lightest = min(lightest, m)
        masses(2*i - 1) = m
        masses(2*i) = m
      end do
    case default
      !$omp simd private(m) reduction(min:lightest)
      do i = 1, n
        m = merge(mass(i), no_mass, mass(i) > 0.0_wp)
        lightest = min(lightest, m)
        masses(3*i - 2) = m
        masses(3*i - 1) = m
        masses(3*i) = m
      end do
    end select
  end subroutine write_out

  !> Form velocities of nodes; 0 where there is no mass.
  pure subroutine form_velocities(n, masses, momentum, velocity, increment)
    !> Number of nodes times components.
    integer, intent(in) :: n
    !> Masses, as of `write_out`. [kg]
    real(wp), intent(in) :: masses(n)
    !> Momenta. [kg m/s]
    real(wp), intent(in) :: momentum(n)
    !> Velocities. [m/s]
    real(wp), intent(out) :: velocity(n)
    !> Set to 0. [m/s2]
    real(wp), intent(out) :: increment(n)
    real(wp) :: there
    integer :: i

    ! A factor 0 or 1: of `merge` with other values the compiler makes a branch and scalar code.
    !$omp simd private(there)
    do i = 1, n
      there = merge(1.0_wp, 0.0_wp, masses(i) < no_mass)
      velocity(i) = there*momentum(i)/masses(i)
      increment(i) = 0.0_wp
    end do
  end subroutine form_velocities

  !> Take the internal forces of negligible nodes out of their forces.
  pure subroutine set_aside(nvel, n, cutoff, mass, force, increment)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Number of nodes.
    integer, intent(in) :: n
    !> Mass at or below which a node is negligible. [kg]
    real(wp), intent(in) :: cutoff
    !> Nodal masses. [kg]
    real(wp), intent(in) :: mass(n)
    !> Nodal forces. [N]
    real(wp), intent(inout) :: force(nvel, n)
    !> Accelerations by these forces. [m/s2]
    real(wp), intent(inout) :: increment(nvel, n)
    integer :: i

    do i = 1, n
      if (mass(i) > cutoff .or. .not. mass(i) > 0.0_wp) cycle
      increment(:, i) = force(:, i)/mass(i)
      force(:, i) = 0.0_wp
    end do
  end subroutine set_aside

  !> Add the body force.
  pure subroutine add_weights(n, body_force, masses, force)
    !> Number of nodes times components.
    integer, intent(in) :: n
    !> Acceleration by the body force, for each number. [m/s2]
    real(wp), intent(in) :: body_force(n)
    !> Masses, as of `write_out`. [kg]
    real(wp), intent(in) :: masses(n)
    !> Nodal forces. [N]
    real(wp), intent(inout) :: force(n)
    integer :: i

    !$omp simd
    do i = 1, n
      force(i) = force(i) + body_force(i)*merge(masses(i), 0.0_wp, masses(i) < no_mass)
    end do
  end subroutine add_weights

  !> Advance momenta and velocities.
  pure subroutine push(n, dt, masses, force, momentum, velocity, increment)
    !> Number of nodes times components.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Masses, as of `write_out`. [kg]
    real(wp), intent(in) :: masses(n)
    !> Forces. [N]
    real(wp), intent(in) :: force(n)
    !> Momenta. [kg m/s]
    real(wp), intent(inout) :: momentum(n)
    !> Velocities; 0 where there is no mass. [m/s]
    real(wp), intent(out) :: velocity(n)
    !> On entry accelerations that `force` leaves out, on exit velocity increments. [m/s]
    real(wp), intent(inout) :: increment(n)
    real(wp) :: there, f
    integer :: i

    !$omp simd private(there, f)
    do i = 1, n
      there = merge(1.0_wp, 0.0_wp, masses(i) < no_mass)
      f = there*force(i)
      momentum(i) = momentum(i) + dt*f
      velocity(i) = there*momentum(i)/masses(i)
      increment(i) = dt*(f/masses(i) + there*increment(i))
    end do
  end subroutine push

end module mpm_node_update
