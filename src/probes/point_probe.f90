!> The state at a point: of the material there at the start, or of what passes by.
module mpm_point_probe
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use mpm_body, only: body_slot_t
  use mpm_body_list, only: find_body
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: axis_name, kinematics_t
  use mpm_model, only: model_t
  use mpm_points, only: points_t
  use mpm_probe, only: hat, probe_t
  use mpm_properties, only: properties_t
  use mpm_store, only: store_t
  use mpm_strings, only: string_t
  implicit none
  private
  public :: point_probe_t

  !> Columns of a stress, in the order in which it is stored.
  integer, parameter :: row(6) = [1, 2, 3, 1, 2, 3], column(6) = [1, 2, 3, 2, 3, 1]

  !> A point of a body.
  type, extends(probe_t) :: point_probe_t
    !> The body in the model's list.
    integer :: body = 0
    !> Place. [m]
    real(wp) :: position(3) = 0.0_wp
    !> Whether it goes with the material point that was next to it.
    logical :: follows = .true.
    !> That point, by its position in the points file.
    integer :: id = 0
  contains
    procedure, nopass :: describe => point_probe_describe
    procedure :: init => point_probe_init
    procedure :: columns => point_probe_columns
    procedure :: sample => point_probe_sample
    procedure :: save => point_probe_save
    procedure :: restore => point_probe_restore
  end type point_probe_t

contains

  !> Purpose and properties of the class.
  subroutine point_probe_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('probe', 'PointProbe', &
                          'State at a point of a body, in the history.', &
                          'Means with the functions of the grid: Sulsky, Chen and Schreyer, CMAME &
                          &118 (1994) 179-196', &
                          'probe'//nl//'{'//nl//'    class = "PointProbe"'//nl// &
                          '    name = "tip"'//nl//'    properties = {0.5, 0.5}   # x, y'//nl// &
                          '    int-properties = {follow = 1}'//nl// &
                          '    str-properties = {"block_0"}'//nl//'}')
    call description%add_real('x', 'm', 'place (TYPE 4: r)')
    call description%add_real('y', 'm', 'place (TYPE 4: z)', types=types_with_dim(2))
    call description%add_real('z', 'm', 'place', types=types_with_dim(3))
    call description%add_integer('id', 'the body by its number, from 0, when no name is given', &
                                 default=-1, lower=0)
    call description%add_integer('follow', '1: the material point that is nearest at the start; &
                                 &0: what is at the place in the moment', default=1, lower=0, &
                                 upper=1)
    call description%add_string('body', 'name of the body', default='')
    call description%add_note('Columns: position, velocity, pressure, density, stress.')
    call description%add_note('follow = 0: means over the points around, with the weights of the &
                              &hat functions of a node at the place, velocities by mass, stresses &
                              &by volume; nan where the body is not.')
    call description%add_note('A history is written when the serializer has a history_rate.')
  end subroutine point_probe_describe

  !> Find the body and the point.
  subroutine point_probe_init(self, grid, bodies, properties, error)
    !> The probe.
    class(point_probe_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job, at their start.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body, or a place outside of the grid.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: nearest, distance
    integer :: p

    call find_body(bodies, properties, 'body', 'id', self%body, error)
    if (allocated(error)) return
    self%position = [properties%real('x'), properties%real('y'), properties%real('z')]
    self%follows = properties%integer('follow') == 1
    associate (dim => grid%kin%dim, points => bodies(self%body)%body%points)
      if (.not. grid%in_domain(self%position(:dim))) then
        call properties%reject('x', 'the probe is outside of the grid', error, &
                               'a probe lies within the grid')
        return
      end if
      nearest = huge(1.0_wp)
      do p = 1, points%n
        distance = norm2(points%x(:, p) - self%position(:dim))
        ! Of two at the same distance the first of the points file.
        if (distance > nearest) cycle
        if (.not. distance < nearest .and. points%id(p) > self%id) cycle
        nearest = distance
        self%id = points%id(p)
      end do
    end associate
  end subroutine point_probe_init

  !> Names of the columns.
  subroutine point_probe_columns(self, kin, names)
    !> The probe.
    class(point_probe_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The names.
    type(string_t), allocatable, intent(out) :: names(:)
    character(:), allocatable :: first
    integer :: a, k

    associate (unused => self)
    end associate
    allocate (names(kin%dim + kin%nvel + 2 + kin%nstress))
    do a = 1, kin%dim
      names(a)%text = axis_name(kin, a)
    end do
    k = kin%dim
    do a = 1, kin%nvel
      names(k + a)%text = 'velocity_'//axis_name(kin, a)
    end do
    k = k + kin%nvel
    names(k + 1)%text = 'pressure'
    names(k + 2)%text = 'density'
    do a = 1, kin%nstress
      first = axis_name(kin, row(a))
      if (len(first) > 1) first = 't'
      names(k + 2 + a)%text = axis_name(kin, column(a))
      if (len(names(k + 2 + a)%text) > 1) names(k + 2 + a)%text = 't'
      names(k + 2 + a)%text = 'stress_'//first//names(k + 2 + a)%text
    end do
  end subroutine point_probe_columns

  !> Position, velocity, pressure, density, stress.
  subroutine point_probe_sample(self, model, values)
    !> The probe.
    class(point_probe_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The numbers.
    real(wp), intent(out) :: values(:)
    real(wp) :: weight(model%bodies(self%body)%body%points%n), mass, volume, h(3)
    integer :: p, k, repeats(3)

    associate (points => model%bodies(self%body)%body%points, dim => model%kin%dim, &
               nvel => model%kin%nvel)
      weight = 0.0_wp
      if (self%follows) then
        where (points%id == self%id) weight = 1.0_wp
      else
        h = model%grid%spacing()
        repeats = model%grid%periods()
        call weigh(self, points, h(:dim), repeats(:dim), weight)
      end if
      mass = dot_product(weight, points%mass)
      volume = dot_product(weight, points%volume)
      values = ieee_value(1.0_wp, ieee_quiet_nan)
      values(:dim) = self%position(:dim)
      if (.not. volume > 0.0_wp) return
      if (self%follows) values(:dim) = 0.0_wp
      values(dim + 1:) = 0.0_wp
      k = dim + nvel
      do p = 1, points%n
        if (.not. weight(p) > 0.0_wp) cycle
        if (self%follows) values(:dim) = points%x(:, p)
        values(dim + 1:k) = values(dim + 1:k) + weight(p)*points%mass(p)/mass*points%velocity(:, p)
        values(k + 3:) = values(k + 3:) + weight(p)*points%volume(p)/volume*points%stress(:, p)
      end do
      values(k + 1) = -sum(values(k + 3:k + 5))/3.0_wp
      values(k + 2) = mass/volume
    end associate
  end subroutine point_probe_sample

  !> Weights of the points around the place.
  subroutine weigh(self, points, h, repeats, weight)
    !> The probe.
    class(point_probe_t), intent(in) :: self
    !> The points.
    class(points_t), intent(in) :: points
    !> Sides of a cell. [m] (dim)
    real(wp), intent(in) :: h(:)
    !> Cells after which the grid repeats; 0 where it does not. (dim)
    integer, intent(in) :: repeats(:)
    !> Weights, 0 at the start. (n)
    real(wp), intent(inout) :: weight(:)
    real(wp) :: distance(size(h)), length
    integer :: p, d

    do p = 1, points%n_inside
      distance = (points%x(:, p) - self%position(:size(h)))/h
      do d = 1, size(h)
        length = real(repeats(d), wp)
        if (repeats(d) > 0) distance(d) = distance(d) - length*anint(distance(d)/length)
      end do
      weight(p) = product(hat(distance))
    end do
  end subroutine weigh

  !> Save the point.
  subroutine point_probe_save(self, store)
    !> The probe.
    class(point_probe_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call store%put('id', self%id)
  end subroutine point_probe_save

  !> Take back the point.
  subroutine point_probe_restore(self, store)
    !> The probe.
    class(point_probe_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call store%get('id', self%id)
  end subroutine point_probe_restore

end module mpm_point_probe
