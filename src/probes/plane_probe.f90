!> Force and flow of mass through a plane.
module mpm_plane_probe
  use mpm_body, only: body_slot_t, body_t
  use mpm_body_list, only: find_body
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: axis_name, expand_stress, kinematics_t
  use mpm_model, only: model_t
  use mpm_probe, only: hat, hat_area, probe_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t
  implicit none
  private
  public :: plane_probe_t

  !> A plane across an axis of the grid.
  type, extends(probe_t) :: plane_probe_t
    !> The body in the model's list; 0 for all.
    integer :: body = 0
    !> Direction of the plane's normal.
    integer :: axis = 1
    !> Place on the axis. [m]
    real(wp) :: position = 0.0_wp
  contains
    procedure, nopass :: describe => plane_probe_describe
    procedure :: init => plane_probe_init
    procedure :: columns => plane_probe_columns
    procedure :: sample => plane_probe_sample
  end type plane_probe_t

contains

  !> Purpose and properties of the class.
  subroutine plane_probe_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('probe', 'PlaneProbe', &
                          'Force and flow of mass through a plane across an axis, in the &
                          &history.', &
                          'Means over the plane: Irving and Kirkwood, J. Chem. Phys. 18 (1950) &
                          &817-829', &
                          'probe'//nl//'{'//nl//'    class = "PlaneProbe"'//nl// &
                          '    name = "gate"'//nl//'    properties = {0.5}   # position'//nl// &
                          '    str-properties = {"x", "block_0"}'//nl//'}')
    call description%add_real('position', 'm', 'place of the plane on its axis')
    call description%add_integer('id', 'the body by its number, from 0, when no name is given', &
                                 default=-1, lower=0)
    call description%add_string('axis', 'direction of the normal: "x", "y" or "z"; in TYPE 4 "r" &
                                &or "z"')
    call description%add_string('body', 'name of the body; all bodies when none is given', &
                                default='')
    call description%add_note('Columns: force_<axis>, the force that what lies behind the plane &
                              &exerts on what lies in front of it; mass_flux, mass through the &
                              &plane along the axis in a second.')
    call description%add_note('Both are means with the weights of a hat function one cell to each &
                              &side; in front of a wall they are those of the side within the &
                              &grid.')
    call description%add_note('A history is written when the serializer has a history_rate.')
  end subroutine plane_probe_describe

  !> Find the body and the plane.
  subroutine plane_probe_init(self, grid, bodies, properties, error)
    !> The probe.
    class(plane_probe_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> All bodies of the job.
    type(body_slot_t), intent(in) :: bodies(:)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> No such body or axis, or a plane outside of the grid.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: known
    real(wp) :: lower(3), upper(3)
    integer :: d

    self%body = 0
    if (properties%given('body') .or. properties%given('id')) then
      call find_body(bodies, properties, 'body', 'id', self%body, error)
      if (allocated(error)) return
    end if
    self%axis = 0
    known = ''
    do d = 1, grid%kin%dim
      if (properties%string('axis') == axis_name(grid%kin, d)) self%axis = d
      known = known//' "'//axis_name(grid%kin, d)//'"'
    end do
    if (self%axis == 0) then
      call properties%reject('axis', 'there is no axis "'//excerpt(properties%string('axis'))// &
                             '" in this TYPE', error, 'axes of the grid:'//known)
      return
    end if
    self%position = properties%real('position')
    call grid%bounds(lower, upper)
    if (self%position >= lower(self%axis) .and. self%position <= upper(self%axis)) return
    call properties%reject('position', 'the plane is outside of the grid', error, &
                           'a plane lies between the ends of the grid along its axis')
  end subroutine plane_probe_init

  !> Names of the columns.
  subroutine plane_probe_columns(self, kin, names)
    !> The probe.
    class(plane_probe_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The names.
    type(string_t), allocatable, intent(out) :: names(:)
    integer :: a

    associate (unused => self)
    end associate
    allocate (names(kin%nvel + 1))
    do a = 1, kin%nvel
      names(a)%text = 'force_'//axis_name(kin, a)
    end do
    names(kin%nvel + 1)%text = 'mass_flux'
  end subroutine plane_probe_columns

  !> Force and flow of mass.
  subroutine plane_probe_sample(self, model, values)
    !> The probe.
    class(plane_probe_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> Force, flow of mass. [N, kg/s] (nvel + 1)
    real(wp), intent(out) :: values(:)
    real(wp) :: lower(3), upper(3), h(3), length, part
    integer :: i, repeats(3)

    call model%grid%bounds(lower, upper)
    h = model%grid%spacing()
    repeats = model%grid%periods()
    length = 0.0_wp
    part = 1.0_wp
    associate (a => self%axis, x => self%position)
      if (repeats(a) > 0) then
        length = upper(a) - lower(a)
      else
        part = hat_area((upper(a) - x)/h(a)) - hat_area((lower(a) - x)/h(a))
      end if
      values = 0.0_wp
      do i = 1, size(model%bodies)
        if (self%body > 0 .and. i /= self%body) cycle
        if (.not. model%bodies(i)%body%active) cycle
        call add_points(self, model%bodies(i)%body, h(a), length, values)
      end do
      values = values/(h(a)*part)
    end associate
  end subroutine plane_probe_sample

  !> Add the points of a body near the plane.
  subroutine add_points(self, body, h, length, values)
    !> The probe.
    class(plane_probe_t), intent(in) :: self
    !> The body.
    class(body_t), intent(in) :: body
    !> Side of a cell along the axis. [m]
    real(wp), intent(in) :: h
    !> Length after which the grid repeats; 0 where it does not. [m]
    real(wp), intent(in) :: length
    !> Sums, times a length. (nvel + 1)
    real(wp), intent(inout) :: values(:)
    real(wp) :: distance, weight, stress(3, 3)
    integer :: p, nvel

    nvel = size(values) - 1
    associate (points => body%points)
      do p = 1, points%n_inside
        distance = points%x(self%axis, p) - self%position
        if (length > 0.0_wp) distance = distance - length*anint(distance/length)
        weight = hat(distance/h)
        if (.not. weight > 0.0_wp) cycle
        stress = expand_stress(points%stress(:, p))
        values(:nvel) = values(:nvel) + weight*points%volume(p)*stress(:nvel, self%axis)
        values(nvel + 1) = values(nvel + 1) + weight*points%mass(p)*points%velocity(self%axis, p)
      end do
    end associate
  end subroutine add_points

end module mpm_plane_probe
