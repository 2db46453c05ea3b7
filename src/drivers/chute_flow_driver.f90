!> Flow of grains down a chute, compared with the steady one.
module mpm_chute_flow_driver
  use mpm_description, only: description_t
  use mpm_driver, only: driver_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_exact_number, only: exact_text
  use mpm_files, only: directory_of
  use mpm_history_file, only: history_file_t
  use mpm_initial_stress, only: assign_pressure
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_plane_strain
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_store, only: store_t
  use mpm_volume_overshoot, only: measure_overshoot, overshoot_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: chute_flow_driver_t

  !> Nodes whose heights differ by less than this are equal. [m]
  real(wp), parameter :: same_height = 1.0e-7_wp
  !> Columns of the output file.
  character(*), parameter :: header = &
    'time,overshoot,velocity_error,highest_y,centre_y,largest_velocity_x,mean_velocity_x'

  !> Gravity along an inclined bed of grains, which starts with the pressure of rest.
  type, extends(driver_t) :: chute_flow_driver_t
    !> Acceleration. [m/s2]
    real(wp) :: gravity(3) = 0.0_wp
    !> Factor of the steady velocities. [1/(m1/2 s)]
    real(wp) :: factor = 0.0_wp
    !> Density of the bed. [kg/m3]
    real(wp) :: density = 0.0_wp
    !> Height of the bed. [m]
    real(wp) :: height = 0.0_wp
    !> A line for each frame.
    type(history_file_t) :: file
    !> Whether the file has been begun in this run.
    logical, private :: is_open = .false.
  contains
    procedure, nopass :: describe => chute_flow_driver_describe
    procedure :: init => chute_flow_driver_init
    procedure :: body_force => chute_flow_driver_body_force
    procedure :: prepare => chute_flow_driver_prepare
    procedure :: at_frame => chute_flow_driver_at_frame
    procedure :: save => chute_flow_driver_save
    procedure :: restore => chute_flow_driver_restore
    !> Steady velocity along the bed at a height.
    procedure :: steady_velocity => chute_flow_driver_steady_velocity
    !> The numbers of a line behind the time.
    procedure :: measure => chute_flow_driver_measure
  end type chute_flow_driver_t

contains

  !> Purpose and properties of the class.
  subroutine chute_flow_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'ChuteFlowDriver', &
                          'Flow of grains down a chute: gravity at an angle to the bed, which &
                          &starts under its own weight; with each frame a line that compares it &
                          &with the steady flow. TYPE 2, the first body.', &
                          'MiDi, Eur. Phys. J. E 14 (2004) 341-365; Jop, Forterre and Pouliquen, &
                          &Nature 441 (2006) 727-730', &
                          'driver'//nl//'{'//nl//'    class = "ChuteFlowDriver"'//nl// &
                          '    # t_stop, g, mu_1, mu_2, b, d, rho_s, h, theta, phi'//nl// &
                          '    properties = {1, 9.81, 0.38, 0.64, 0.28, 0.005, 2450, 0.5, 25, &
                          &0.6}'//nl//'    str-properties = {"chute.csv"}'//nl//'}')
    call description%add_real('t_stop', 's', 'stop time')
    call description%add_real('g', 'm/s2', 'gravity', lower=0.0_wp)
    call description%add_real('mu_1', '-', 'friction at rest', lower=0.0_wp)
    call description%add_real('mu_2', '-', 'friction of fast flow, above mu_1', lower=0.0_wp)
    call description%add_real('b', '-', 'inertial number half way between both (I_0)', &
                              above=0.0_wp)
    call description%add_real('d', 'm', 'diameter of grains', above=0.0_wp)
    call description%add_real('rho_s', 'kg/m3', 'density of the grains themselves', above=0.0_wp)
    call description%add_real('h', 'm', 'height of the bed', above=0.0_wp)
    call description%add_real('theta', 'degrees', 'slope', lower=0.0_wp, below=90.0_wp)
    call description%add_real('phi', '-', 'packing fraction', above=0.0_wp, upper=1.0_wp)
    call description%add_string('output_file', 'file for the lines, relative to the working &
                                &directory')
    call description%add_note('x runs down the slope, y across the bed from its floor at 0; &
                              &gravity is (g sin theta, -g cos theta).')
    call description%add_note('Columns of the file: time; overshoot, the largest e_i; &
                              &velocity_error, the norm of the difference to the steady flow; &
                              &highest_y and centre_y of the points; largest and mean nodal &
                              &velocity along x.')
    call description%add_note('Nodes above h do not count (mpm_3d: NaN a hair above it); of nodes &
                              &at h half of the volume counts, all of it at the top of the grid &
                              &(mpm_3d: by the order of the nodes).')
  end subroutine chute_flow_driver_describe

  !> Set up from the properties.
  subroutine chute_flow_driver_init(self, properties, error)
    !> The driver.
    class(chute_flow_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Frictions out of order, or a file without a name.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: angle, slope
    character(:), allocatable :: path
    integer :: slash

    self%t_stop = properties%real('t_stop')
    angle = properties%real('theta')*acos(-1.0_wp)/180.0_wp
    self%gravity = properties%real('g')*[sin(angle), -cos(angle), 0.0_wp]
    self%density = properties%real('rho_s')*properties%real('phi')
    self%height = properties%real('h')
    slope = tan(angle)
    associate (mu_1 => properties%real('mu_1'), mu_2 => properties%real('mu_2'))
      if (.not. mu_2 > mu_1) then
        call properties%reject('mu_2', 'mu_2 is not above mu_1', error, &
                               'friction grows with the rate of flow')
        return
      end if
      if (slope >= mu_2) then
        call properties%reject('theta', 'grains accelerate for ever on a slope of more than mu_2', &
                               error, 'tan(theta) lies below mu_2')
        return
      end if
      ! At rest below mu_1.
      self%factor = 2.0_wp/3.0_wp*max(0.0_wp, slope - mu_1)/(mu_2 - slope)*properties%real('b')/ &
                    (properties%real('d')*sqrt(properties%real('rho_s')))* &
                    sqrt(-self%density*self%gravity(2))
    end associate
    path = properties%string('output_file')
    slash = index(path, '/', back=.true.)
    if (len_trim(path(slash + 1:)) == 0) then
      call properties%reject('output_file', 'the output file has no name', error, &
                             'for example "chute.csv"')
      return
    end if
    call self%file%place(directory_of(path), path(slash + 1:))
  end subroutine chute_flow_driver_init

  !> Gravity at an angle to the bed.
  pure function chute_flow_driver_body_force(self, kin) result(b)
    !> The driver.
    class(chute_flow_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    associate (unused => kin)
    end associate
    b = self%gravity
  end function chute_flow_driver_body_force

  !> Give the bed the pressure of rest.
  subroutine chute_flow_driver_prepare(self, model, error)
    !> The driver.
    class(chute_flow_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Another TYPE than 2, or a body that can't have a pressure.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: pressure(:)

    if (model%kin%sim_type /= type_plane_strain) then
      call raise(error, err_input, 'ChuteFlowDriver is for TYPE 2', &
                 hint='set TYPE = 2, or take UserDefinedGravityDriver')
      return
    end if
    associate (body => model%bodies(1)%body)
      allocate (pressure(body%points%n))
      pressure = -self%density*self%gravity(2)*max(0.0_wp, self%height - body%points%x(2, :))
      call assign_pressure(body, pressure, error)
    end associate
  end subroutine chute_flow_driver_prepare

  !> Steady velocity along the bed at a height.
  elemental function chute_flow_driver_steady_velocity(self, y) result(velocity)
    !> The driver.
    class(chute_flow_driver_t), intent(in) :: self
    !> Height above the floor. [m]
    real(wp), intent(in) :: y
    !> Velocity. [m/s]
    real(wp) :: velocity

    velocity = self%factor*(self%height**1.5_wp - max(0.0_wp, self%height - y)**1.5_wp)
  end function chute_flow_driver_steady_velocity

  !> A frame has been written: add a line.
  subroutine chute_flow_driver_at_frame(self, model, error)
    !> The driver.
    class(chute_flow_driver_t), intent(inout) :: self
    !> The state of the frame.
    type(model_t), intent(in) :: model
    !> The file can't be written.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: line
    real(wp) :: values(6)
    integer :: k

    if (.not. self%is_open) then
      call self%file%open(header, error)
      if (allocated(error)) return
      self%is_open = .true.
    end if
    call self%measure(model, values)
    line = exact_text(model%time)
    do k = 1, size(values)
      line = line//','//exact_text(values(k))
    end do
    call self%file%append(line, error)
  end subroutine chute_flow_driver_at_frame

  !> Overshoot, difference to the steady flow, heights, velocities of the first body.
  subroutine chute_flow_driver_measure(self, model, values)
    !> The driver.
    class(chute_flow_driver_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The numbers.
    real(wp), intent(out) :: values(6)
    type(overshoot_t) :: overshoot
    real(wp) :: mass
    integer :: n, i

    values = 0.0_wp
    associate (points => model%bodies(1)%body%points, nodes => model%bodies(1)%body%nodes)
      n = points%n_inside
      call sum_errors(self, model, values(2))
      if (n == 0) return
      call measure_overshoot(points, model%grid, overshoot)
      do i = 1, overshoot%window%size()
        if (weight_of(self, model, overshoot%window%node(i)) > 0.0_wp) then
          values(1) = max(values(1), overshoot%relative(i))
        end if
      end do
      values(3) = maxval(points%x(2, :n))
      values(4) = dot_product(points%mass(:n), points%x(2, :n))/sum(points%mass(:n))
      values(5) = -huge(1.0_wp)
      mass = 0.0_wp
      do i = 1, nodes%window%size()
        if (.not. nodes%mass(i) > 0.0_wp) cycle
        values(5) = max(values(5), nodes%velocity(1, i))
        values(6) = values(6) + nodes%mass(i)*nodes%velocity(1, i)
        mass = mass + nodes%mass(i)
      end do
      values(5) = merge(values(5), 0.0_wp, mass > 0.0_wp)
      if (mass > 0.0_wp) values(6) = values(6)/mass
    end associate
  end subroutine chute_flow_driver_measure

  !> Norm of the difference between nodal velocities and those of the steady flow.
  subroutine sum_errors(self, model, norm)
    !> The driver.
    class(chute_flow_driver_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> sqrt(sum w_i |v_i - v_ss|**2). [m2/s]
    real(wp), intent(out) :: norm
    type(window_t) :: whole
    real(wp) :: weight, x(3), difference(2)
    integer :: i, node(3)

    norm = 0.0_wp
    whole = model%grid%whole()
    associate (nodes => model%bodies(1)%body%nodes)
      do i = 1, whole%size()
        node = whole%node(i)
        weight = weight_of(self, model, node)
        if (.not. weight > 0.0_wp) cycle
        x = model%grid%node_position(node)
        difference = [-self%steady_velocity(x(2)), 0.0_wp]
        if (nodes%window%holds(node)) then
          difference = difference + nodes%velocity(:, nodes%window%index(node))
        end if
        norm = norm + weight*sum(difference**2)
      end do
    end associate
    norm = sqrt(norm)
  end subroutine sum_errors

  !> Part of the bed that belongs to a node.
  function weight_of(self, model, node) result(weight)
    !> The driver.
    class(chute_flow_driver_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Grid indices of the node.
    integer, intent(in) :: node(3)
    !> Its volume below h. [m2]
    real(wp) :: weight
    real(wp) :: x(3), lower(3), upper(3)
    integer :: repeats(3)

    weight = 0.0_wp
    repeats = model%grid%periods()
    ! The last node of a period is the first one.
    if (any(repeats(:2) > 0 .and. node(:2) >= repeats(:2))) return
    x = model%grid%node_position(node)
    if (x(2) > self%height + same_height) return
    weight = model%grid%node_volume(node)
    call model%grid%bounds(lower, upper)
    if (abs(x(2) - self%height) <= same_height .and. x(2) < upper(2) - same_height) then
      weight = 0.5_wp*weight
    end if
  end function weight_of

  !> Save how far the file has come.
  subroutine chute_flow_driver_save(self, store)
    !> The driver.
    class(chute_flow_driver_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call self%file%save(store)
  end subroutine chute_flow_driver_save

  !> Take back how far the file has come.
  subroutine chute_flow_driver_restore(self, store)
    !> The driver.
    class(chute_flow_driver_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call self%file%restore(store)
  end subroutine chute_flow_driver_restore

end module mpm_chute_flow_driver
