!> Points read from a table.
module mpm_default_points
  use mpm_description, only: description_t
  use mpm_document, only: raise_at, value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_points, only: bytes_per_point, points_t
  use mpm_points_table, only: read_points_table
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  use mpm_text_file, only: find_input_file
  implicit none
  private
  public :: add_points_properties, default_points_t, find_point_file, full_width

  !> Largest magnitude of a number in a table, so that products of two of them can be stored.
  real(wp), parameter :: largest = 1.0e150_wp

  !> Points with the fields of mpm_3d's points.
  type, extends(points_t) :: default_points_t
  contains
    procedure, nopass :: describe => default_points_describe
    procedure :: init => default_points_init
    procedure :: write_fields => default_points_write_fields
    !> Set all arrays from the rows of a table.
    procedure :: init_from_table => default_points_init_from_table
  end type default_points_t

contains

  !> Purpose and properties of the class.
  subroutine default_points_describe(description)
    !> The description.
    type(description_t), intent(out) :: description

    call description%init('points', 'DefaultPoints', &
                          'Points read from a table: their number, then a line for each point with &
                          &mass, volume, position, velocity and active (1) or not (0).', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          '    point-class = "DefaultPoints"'//new_line('a')// &
                          '    point-file = "block.points"')
    call add_points_properties(description)
    call description%add_note('Columns: m V x v a (TYPE 1), m V x y vx vy a (2), &
                              &m V x y z vx vy vz a (3), m V r z t vr vz vt a or m V r z vr vz a &
                              &(4), m V x y z vx vy vz a or m V x y vx vy a (5). The third &
                              &component of positions is not used in TYPE 4 and 5.')
    call description%add_note('TYPE 4: the table has mass and area of the meridian section; both &
                              &are multiplied by r, once.')
    call description%add_note('The file is looked for in the working directory, then in the folder &
                              &of the config.')
    call description%add_note('A bad table ends the run (mpm_3d: all points from the bad line on &
                              &stay zero).')
  end subroutine default_points_describe

  !> Add the properties that all points made from tables or generator texts share.
  subroutine add_points_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_integer('remember_element', &
                                 'accepted as in mpm_3d; has no effect on Cartesian grids', &
                                 default=0, lower=0, upper=1)
  end subroutine add_points_properties

  !> Read the points.
  subroutine default_points_init(self, grid, properties, point_file, config_file, error)
    !> The points.
    class(default_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties: without effect.
    type(properties_t), intent(in) :: properties
    !> The table.
    type(value_t), intent(in) :: point_file
    !> The config, beside which a relative path is looked for.
    character(*), intent(in) :: config_file
    !> A missing or bad table.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer, allocatable :: line_of_row(:)
    real(wp), allocatable :: table(:, :)
    logical, allocatable :: is_active(:)
    integer :: widths(2), n_widths, n_rows, n_columns

    associate (unused => properties)
    end associate
    if (allocated(self%kept)) then
      call self%revive(grid%kin)
      return
    end if
    call find_point_file(point_file, config_file, path, error)
    if (allocated(error)) return
    widths = [full_width(grid%kin), 3 + 2*grid%kin%dim]
    n_widths = merge(1, 2, widths(1) == widths(2))
    call read_points_table(path, widths(:n_widths), n_rows, n_columns, table, error, line_of_row, &
                           self%memory_room, bytes_per_point(grid%kin))
    if (allocated(error)) return
    call take_table(self, grid, table, path, line_of_row, is_active, error)
    if (allocated(error)) return
    ! Large tables and all of the points together may be more than the memory holds.
    deallocate (table, line_of_row)
    call add_the_rest(self, grid%kin, path, is_active)
  end subroutine default_points_init

  !> Columns of a table that has all components.
  pure function full_width(kin) result(n)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Mass, volume, position, velocity, active.
    integer :: n

    n = 3 + 2*kin%nvel
  end function full_width

  !> Find the file that the key `point-file` names.
  subroutine find_point_file(point_file, config_file, path, error)
    !> The key's value.
    type(value_t), intent(in) :: point_file
    !> The config, beside which a relative path is looked for.
    character(*), intent(in) :: config_file
    !> The path to open.
    character(:), allocatable, intent(out) :: path
    !> No value, or no such file; at the place of the value.
    type(error_t), allocatable, intent(out) :: error
    logical :: is_missing

    is_missing = .not. allocated(point_file%text)
    if (.not. is_missing) is_missing = len_trim(point_file%text) == 0
    if (is_missing) then
      call raise_at(error, point_file, 'this body has no points file', &
                    hint='add a line such as   point-file = "block.points"')
      return
    end if
    call find_input_file(point_file%text, config_file, path, error)
    if (.not. allocated(error)) return
    if (allocated(point_file%file)) error%file = point_file%file
    error%line = point_file%line
  end subroutine find_point_file

  !> Set all arrays from the rows of a table.
  subroutine default_points_init_from_table(self, grid, table, path, line_of_row, error)
    !> The points, not yet set.
    class(default_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Rows as in the class description, finite numbers, at least one row. (columns, n)
    real(wp), intent(in) :: table(:, :)
    !> File of the rows, for messages.
    character(*), intent(in) :: path
    !> Line of each row in the file, for messages. (n)
    integer, intent(in) :: line_of_row(:)
    !> The first row that can't be a point.
    type(error_t), allocatable, intent(out) :: error
    logical, allocatable :: is_active(:)

    call take_table(self, grid, table, path, line_of_row, is_active, error)
    if (.not. allocated(error)) call add_the_rest(self, grid%kin, path, is_active)
  end subroutine default_points_init_from_table

  !> Set the arrays that a table has.
  subroutine take_table(points, grid, table, path, line_of_row, is_active, error)
    !> The points, not yet set.
    class(default_points_t), intent(inout) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Rows as in the class description, finite numbers, at least one row. (columns, n)
    real(wp), intent(in) :: table(:, :)
    !> File of the rows, for messages.
    character(*), intent(in) :: path
    !> Line of each row in the file, for messages. (n)
    integer, intent(in) :: line_of_row(:)
    !> Whether each point is active. (n)
    logical, allocatable, intent(out) :: is_active(:)
    !> The first row that can't be a point.
    type(error_t), allocatable, intent(out) :: error
    integer :: p, n, n_components
    real(wp) :: side

    n = size(table, 2)
    do p = 1, n
      call check_row(grid, table(:, p), path, line_of_row(p), error)
      if (allocated(error)) return
    end do
    n_components = (size(table, 1) - 3)/2
    allocate (is_active(n), points%mass(n), points%volume(n), points%extent(n))
    allocate (points%x(grid%kin%dim, n), points%velocity(grid%kin%nvel, n))
    do p = 1, n
      points%mass(p) = table(1, p)
      points%volume(p) = table(2, p)
      points%x(:, p) = table(3:2 + grid%kin%dim, p)
      points%velocity(:, p) = 0.0_wp
      points%velocity(:n_components, p) = table(3 + n_components:2 + 2*n_components, p)
      is_active(p) = table(size(table, 1), p) > 0.5_wp
      ! In TYPE 4 the box of a point is its meridian section.
      side = points%volume(p)
      if (grid%kin%dim == 2) side = sqrt(points%volume(p))
      if (grid%kin%dim == 3) side = points%volume(p)**(1.0_wp/3.0_wp)
      points%extent(p) = 0.5_wp*side
      if (grid%kin%sim_type == type_axisymmetric) then
        points%mass(p) = points%mass(p)*points%x(1, p)
        points%volume(p) = points%volume(p)*points%x(1, p)
      end if
    end do
    points%widest_line = line_of_row(maxloc(points%extent, dim=1))
  end subroutine take_table

  !> Set what a table does not have.
  subroutine add_the_rest(points, kin, path, is_active)
    !> The points, with the arrays of a table.
    class(default_points_t), intent(inout) :: points
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> File of the rows.
    character(*), intent(in) :: path
    !> Whether each point is active. (n)
    logical, intent(in) :: is_active(:)

    call points%allocate(kin, size(is_active))
    points%file = path
    call move_inactive_back(points, is_active)
  end subroutine add_the_rest

  !> Check one row of a table.
  subroutine check_row(grid, row, path, line, error)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Mass, volume, position, velocity, active. (columns)
    real(wp), intent(in) :: row(:)
    !> File, for messages.
    character(*), intent(in) :: path
    !> Line in the file, for messages.
    integer, intent(in) :: line
    !> What is wrong with the row.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: active
    integer :: dim

    dim = grid%kin%dim
    active = row(size(row))
    if (abs(active) > 0.0_wp .and. abs(active - 1.0_wp) > 0.0_wp) then
      call raise(error, err_input, 'active = '//to_text(active)//' is neither 0 nor 1', path, &
                 line, columns_hint(grid%kin, size(row)))
    else if (row(1) <= 0.0_wp) then
      call raise(error, err_input, 'mass = '//to_text(row(1))//' of a point must be above 0', &
                 path, line, columns_hint(grid%kin, size(row)))
    else if (row(2) <= 0.0_wp) then
      call raise(error, err_input, 'volume = '//to_text(row(2))//' of a point must be above 0', &
                 path, line, columns_hint(grid%kin, size(row)))
    else if (any(abs(row) > largest) .or. any(row(:2) < 1.0_wp/largest)) then
      call raise(error, err_input, 'a number of this point is too large or too small to calculate &
                 &with', path, line, 'magnitudes reach to '//to_text(largest)// &
                 ', mass and volume from '//to_text(1.0_wp/largest))
    else if (grid%kin%sim_type == type_axisymmetric .and. row(3) < 1.0_wp/largest) then
      call raise(error, err_input, 'the radius r = '//to_text(row(3))//' of a point must be above &
                 &0 in TYPE 4', path, line, 'mass and volume of a point are proportional to its &
                 &distance from the axis r = 0')
    else if (active > 0.5_wp .and. .not. grid%in_domain(row(3:2 + dim))) then
      call raise(error, err_input, 'the point at ('//position_text(row(3:2 + dim))// &
                 ') is outside of the grid '//box_text(grid), path, line, &
                 'move the point or enlarge the grid')
    end if
  end subroutine check_row

  !> The columns of a row in words.
  pure function columns_hint(kin, n_columns) result(text)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Numbers in a row.
    integer, intent(in) :: n_columns
    !> One line.
    character(:), allocatable :: text
    character(5), parameter :: planes(3) = [character(5) :: 'x', 'x y', 'x y z']
    character(8), parameter :: velocities(3) = [character(8) :: 'v', 'vx vy', 'vx vy vz']
    integer :: k

    k = (n_columns - 3)/2
    if (kin%sim_type /= type_axisymmetric) then
      text = trim(planes(k))//' '//trim(velocities(k))
    else if (k == 2) then
      text = 'r z vr vz'
    else
      text = 'r z theta vr vz vtheta'
    end if
    text = 'columns in TYPE '//to_text(kin%sim_type)//': mass volume '//text//' active'
  end function columns_hint

  !> A position for a message.
  pure function position_text(x) result(text)
    !> Position. [m]
    real(wp), intent(in) :: x(:)
    !> Its components, separated by commas.
    character(:), allocatable :: text
    integer :: d

    text = to_text(x(1), 12)
    do d = 2, size(x)
      text = text//', '//to_text(x(d), 12)
    end do
  end function position_text

  !> The box of a grid for a message.
  function box_text(grid) result(text)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> For example `[0, 1] x [0, 2]`.
    character(:), allocatable :: text
    real(wp) :: lower(3), upper(3)
    integer :: d

    call grid%bounds(lower, upper)
    text = ''
    do d = 1, grid%kin%dim
      if (d > 1) text = text//' x '
      text = text//'['//to_text(lower(d))//', '//to_text(upper(d))//']'
    end do
  end function box_text

  !> Store the inactive points behind all others.
  subroutine move_inactive_back(points, is_active)
    !> The points.
    class(default_points_t), intent(inout) :: points
    !> Whether each point is active. (n)
    logical, intent(in) :: is_active(:)
    integer, allocatable :: order(:)
    integer :: p, n_first, n_last

    points%n_inside = count(is_active)
    if (points%n_inside == points%n) return
    allocate (order(points%n))
    n_first = 0
    n_last = points%n_inside
    do p = 1, points%n
      if (is_active(p)) then
        n_first = n_first + 1
        order(n_first) = p
      else
        n_last = n_last + 1
        order(n_last) = p
      end if
    end do
    call points%permute(order)
  end subroutine move_inactive_back

  !> Send the fields of a frame.
  subroutine default_points_write_fields(self, writer)
    !> The points.
    class(default_points_t), intent(in) :: self
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: scalar(:), vector(:, :)
    integer :: p

    allocate (scalar(self%n), vector(self%kin%nvel, self%n))
    call writer%vector('displacement', self%displacement)
    call writer%vector('velocity', self%velocity)
    call writer%scalar('mass', self%mass)
    call writer%scalar('volume', self%volume)
    do p = 1, self%n
      vector(:, p) = self%mass(p)*self%velocity(:, p)
    end do
    call writer%vector('momentum', vector)
    do p = 1, self%n
      vector(:, p) = self%body_force(:self%kin%nvel)
    end do
    if (allocated(self%load)) vector = vector + self%load
    call writer%vector('body_force', vector)
    call writer%symmetric_tensor('cauchy_stress', self%stress)
    if (allocated(self%gradient)) call writer%gradient_tensor('velocity_gradient', self%gradient)
    scalar(:self%n_inside) = 1.0_wp
    scalar(self%n_inside + 1:) = 0.0_wp
    call writer%scalar('active', scalar)
    call writer%scalar('extent', self%extent)
    do p = 1, self%n
      scalar(p) = -(self%stress(1, p) + self%stress(2, p) + self%stress(3, p))/3.0_wp
    end do
    call writer%scalar('pressure', scalar)
    scalar = 0.0_wp
    do p = 1, self%n
      ! Points in reserve have neither.
      if (self%volume(p) > 0.0_wp) scalar(p) = self%mass(p)/self%volume(p)
    end do
    call writer%scalar('density', scalar)
  end subroutine default_points_write_fields

end module mpm_default_points
