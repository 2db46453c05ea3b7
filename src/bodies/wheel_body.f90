!> A body that is kept spinning.
module mpm_wheel_body
  use mpm_body, only: body_t
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_3d, type_axisymmetric
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: wheel_body_t

  !> Smallest determinant of an inertia tensor that is inverted, over that of a ball.
  real(wp), parameter :: flat = 1.0e-9_wp

  !> A body whose mean angular velocity is set anew in each step.
  type, extends(body_t) :: wheel_body_t
    !> Angular velocity along the axle. [1/s]
    real(wp) :: spin = 0.0_wp
    !> Time at which the drive begins. [s]
    real(wp) :: t_start = 0.0_wp
    !> Unit vector of the axle.
    real(wp) :: axle(3) = [0.0_wp, 0.0_wp, 1.0_wp]
  contains
    procedure, nopass :: describe => wheel_body_describe
    procedure :: init => wheel_body_init
    procedure :: act_on_points => wheel_body_act_on_points
  end type wheel_body_t

contains

  !> Purpose and properties of the class.
  subroutine wheel_body_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('body', 'WheelBody', &
                          'A body whose mean angular velocity about its centre of mass is kept; it &
                          &moves along freely.', &
                          'Agarwal, Senatore, Zhang, Kingsbury, Iagnemma, Goldman and Kamrin, J. &
                          &Terramechanics 85 (2019) 1-14', &
                          'body'//nl//'{'//nl//'    class = "WheelBody"'//nl// &
                          '    name = "block_0"'//nl// &
                          '    properties = {-3.0, 0.5}   # omega, t_start'//nl// &
                          '    point-file = "block_0.points"'//nl// &
                          '    point-class = "DefaultPoints"'//nl// &
                          '    node-class = "DefaultNodes"'//nl// &
                          '    material-class = "IsotropicLinearElasticity"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3}'//nl//'}')
    call description%add_real('omega', '1/s', 'angular velocity, about +z by the right hand (TYPE &
                              &4: about the axis of symmetry)')
    call description%add_real('t_start', 's', 'time from which it is kept')
    call description%add_real('ax', '-', 'axle, component along x', types=types_with_dim(3))
    call description%add_real('ay', '-', 'axle, component along y', types=types_with_dim(3))
    call description%add_real('az', '-', 'axle, component along z', types=types_with_dim(3))
    call description%add_note('Each step adds delta x b to the velocities of the points at b from &
                              &the centre of mass, after the points have been mapped, with delta = &
                              &omega axle - J^-1 H, the inertia tensor J and the angular momentum &
                              &H. mpm_3d takes the polar moment for J, which is right in the plane &
                              &only, and gives NaN when delta vanishes or a point lies on the &
                              &axle.')
    call description%add_note('In directions in which the grid repeats, points count at the image &
                              &nearest to the others; the wheel must be smaller than the period.')
  end subroutine wheel_body_describe

  !> Set up from the properties.
  subroutine wheel_body_init(self, grid, properties, error)
    !> The body.
    class(wheel_body_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> TYPE 1, or an axle without direction.
    type(error_t), allocatable, intent(out) :: error

    if (grid%kin%dim == 1) then
      call properties%reject('omega', 'nothing turns in TYPE 1', error, &
                             'take another class of body')
      return
    end if
    self%spin = properties%real('omega')
    self%t_start = properties%real('t_start')
    if (grid%kin%sim_type == type_3d) then
      self%axle = [properties%real('ax'), properties%real('ay'), properties%real('az')]
      if (.not. norm2(self%axle) > 0.0_wp) then
        call properties%reject('ax', 'the axle has no direction', error, &
                               'give a vector that is not 0, for example 0, 0, 1')
        return
      end if
      self%axle = self%axle/norm2(self%axle)
    end if
  end subroutine wheel_body_init

  !> Bring the mean angular velocity to that of the drive.
  subroutine wheel_body_act_on_points(self, time)
    !> The body.
    class(wheel_body_t), intent(inout) :: self
    !> Time at the start of the step. [s]
    real(wp), intent(in) :: time
    real(wp), allocatable :: arm(:, :)
    real(wp) :: turn(3)
    integer :: p

    if (time < self%t_start .or. self%points%n_inside == 0) return
    if (self%points%kin%sim_type == type_axisymmetric) then
      call spin_about_axis(self%points, self%spin)
      return
    end if
    allocate (arm(3, self%points%n_inside))
    call arms(self%points, arm)
    call missing_turn(self%points, arm, self%spin*self%axle, turn)
    associate (velocity => self%points%velocity, dim => self%points%kin%dim)
      do p = 1, self%points%n_inside
        velocity(1, p) = velocity(1, p) + turn(2)*arm(3, p) - turn(3)*arm(2, p)
        velocity(2, p) = velocity(2, p) + turn(3)*arm(1, p) - turn(1)*arm(3, p)
        if (dim == 3) velocity(3, p) = velocity(3, p) + turn(1)*arm(2, p) - turn(2)*arm(1, p)
      end do
    end associate
  end subroutine wheel_body_act_on_points

  !> TYPE 4: add a rigid rotation about the axis, so that the mean angular velocity is `spin`.
  subroutine spin_about_axis(points, spin)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Angular velocity. [1/s]
    real(wp), intent(in) :: spin
    real(wp) :: change
    integer :: n

    n = points%n_inside
    change = spin - sum(points%mass(:n)*points%x(1, :n)*points%velocity(3, :n))/ &
             sum(points%mass(:n)*points%x(1, :n)**2)
    points%velocity(3, :n) = points%velocity(3, :n) + change*points%x(1, :n)
  end subroutine spin_about_axis

  !> Places of the points seen from their centre of mass.
  subroutine arms(points, arm)
    !> The points.
    class(points_t), intent(in) :: points
    !> Vectors from the centre of mass; the third component 0 in the plane. [m] (3, n_inside)
    real(wp), intent(out) :: arm(:, :)
    real(wp), parameter :: two_pi = 2.0_wp*acos(-1.0_wp)
    real(wp) :: period, middle
    integer :: n, d

    n = points%n_inside
    arm = 0.0_wp
    associate (stencil => points%stencil, mass => points%mass)
      do d = 1, points%kin%dim
        arm(d, :) = points%x(d, :n)
        if (stencil%periodic(d)) then
          ! The middle on the circle of the period; then the images nearest to it.
          period = stencil%h(d)*real(stencil%n_cells(d), wp)
          middle = period/two_pi*atan2(sum(mass(:n)*sin(two_pi/period*arm(d, :))), &
                                       sum(mass(:n)*cos(two_pi/period*arm(d, :))))
          arm(d, :) = arm(d, :) - middle
          arm(d, :) = arm(d, :) - period*anint(arm(d, :)/period)
        end if
        arm(d, :) = arm(d, :) - sum(mass(:n)*arm(d, :))/sum(mass(:n))
      end do
    end associate
  end subroutine arms

  !> Rotation that the points lack.
  subroutine missing_turn(points, arm, wanted, turn)
    !> The points.
    class(points_t), intent(in) :: points
    !> Vectors from the centre of mass. [m] (3, n_inside)
    real(wp), intent(in) :: arm(:, :)
    !> Angular velocity that they should have. [1/s]
    real(wp), intent(in) :: wanted(3)
    !> Angular velocity to add. [1/s]
    real(wp), intent(out) :: turn(3)
    real(wp) :: inertia(3, 3), momentum(3), v(3), mean(3), along
    integer :: n, dim, p, d

    n = points%n_inside
    dim = points%kin%dim
    mean = 0.0_wp
    do d = 1, dim
      mean(d) = sum(points%mass(:n)*points%velocity(d, :n))/sum(points%mass(:n))
    end do
    inertia = 0.0_wp
    momentum = 0.0_wp
    v = 0.0_wp
    do p = 1, n
      v(:dim) = points%velocity(:dim, p) - mean(:dim)
      momentum = momentum + points%mass(p)*cross(arm(:, p), v)
      do d = 1, 3
        inertia(d, d) = inertia(d, d) + points%mass(p)*dot_product(arm(:, p), arm(:, p))
        inertia(:, d) = inertia(:, d) - points%mass(p)*arm(d, p)*arm(:, p)
      end do
    end do
    if (dim == 2) then
      turn = 0.0_wp
      if (inertia(3, 3) > 0.0_wp) turn(3) = wanted(3) - momentum(3)/inertia(3, 3)
    else if (determinant(inertia) > flat*(inertia(1, 1) + inertia(2, 2) + inertia(3, 3))**3) then
      turn = wanted - solution(inertia, momentum)
    else
      ! Points on a line do not tell how fast they turn about it.
      turn = 0.0_wp
      along = dot_product(wanted, matmul(inertia, wanted))
      if (along > 0.0_wp) turn = wanted*(1.0_wp - dot_product(wanted, momentum)/along)
    end if
  end subroutine missing_turn

  !> a x b.
  pure function cross(a, b) result(c)
    !> First vector.
    real(wp), intent(in) :: a(3)
    !> Second vector.
    real(wp), intent(in) :: b(3)
    !> Their cross product.
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

  !> Determinant of a matrix by its columns.
  pure function determinant(a) result(value)
    !> The matrix.
    real(wp), intent(in) :: a(3, 3)
    !> Its determinant.
    real(wp) :: value

    value = dot_product(a(:, 1), cross(a(:, 2), a(:, 3)))
  end function determinant

  !> Solution of a symmetric 3 x 3 system by Cramer's rule.
  pure function solution(a, b) result(x)
    !> Symmetric matrix with a determinant above 0.
    real(wp), intent(in) :: a(3, 3)
    !> Right-hand side.
    real(wp), intent(in) :: b(3)
    !> x of a x = b.
    real(wp) :: x(3)

    x = [dot_product(b, cross(a(:, 2), a(:, 3))), dot_product(b, cross(a(:, 3), a(:, 1))), &
         dot_product(b, cross(a(:, 1), a(:, 2)))]/determinant(a)
  end function solution

end module mpm_wheel_body
