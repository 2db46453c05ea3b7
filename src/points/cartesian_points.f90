!> Points on a lattice, generated from a text.
module mpm_cartesian_points
  use mpm_default_points, only: add_points_properties, default_points_t, find_point_file, &
                                full_width
  use mpm_description, only: description_t
  use mpm_document, only: value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_generator_text, only: generator_text_t, write_points_table
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_part_list, only: part_list_t
  use mpm_points, only: bytes_per_point
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: cartesian_points_t

  !> Keys of the generator text.
  character(8), parameter :: known_keys(5) = [character(8) :: 'Lx', 'Nx', 'lmpp', 'rho', 'out_file']

  !> Points at the centres of equal cells, where they lie in any part.
  type, extends(default_points_t) :: cartesian_points_t
    private
    !> File for the table of the points; not allocated when none is asked for.
    character(:), allocatable :: out_file
    !> The points as rows of a points file, until they are written. (columns, n)
    real(wp), allocatable :: table(:, :)
  contains
    procedure, nopass :: describe => cartesian_points_describe
    procedure :: init => cartesian_points_init
    procedure :: write_table => cartesian_points_write_table
    procedure, private :: make_table
  end type cartesian_points_t

  !> Where points can be, and what they are like.
  type :: lattice_t
    !> Component counts.
    type(kinematics_t) :: kin
    !> Positions in each direction; 1 in unused ones.
    integer :: n(3) = 1
    !> Distance of positions. [m] (dim)
    real(wp), allocatable :: spacing(:)
    !> Density. [kg/m3]
    real(wp) :: density = 0.0_wp
    !> The shapes to fill.
    type(part_list_t) :: parts
  end type lattice_t

contains

  !> Purpose and properties of the class.
  subroutine cartesian_points_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('points', 'CartesianPoints', &
                          'Points at rest on a lattice, kept where they lie in any of the parts of &
                          &a generator text, which `point-file` names.', &
                          'The generator texts of mpm_3d v3', &
                          '# in the config'//nl// &
                          '    point-class = "CartesianPoints"'//nl// &
                          '    point-file = "block.parts"'//nl// &
                          '# block.parts'//nl// &
                          'Lx = {1.0, 1.0}     # lengths of the lattice'//nl// &
                          'Nx = {20, 20}       # its cells'//nl// &
                          'lmpp = 2            # points in each cell and direction'//nl// &
                          'rho = 1000          # density'//nl// &
                          'out_file = "block.points"     # optional: write the table'//nl// &
                          'part { class = "Box" properties = {0.2, 0.0, 0.8, 0.4} }')
    call add_points_properties(description)
    call description%add_note('The spacing is L/(N lmpp), the first position half of it from 0; L &
                              &and N need not be those of the grid. (mpm3d --list parts)')
    call description%add_note('out_file is relative to the working directory and can be read by &
                              &DefaultPoints: TYPE 4 has mass and area of the meridian section in &
                              &it (mpm_3d: already multiplied by r, and again when read).')
  end subroutine cartesian_points_describe

  !> Generate the points.
  subroutine cartesian_points_init(self, grid, properties, point_file, config_file, error)
    !> The points.
    class(cartesian_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties: without effect.
    type(properties_t), intent(in) :: properties
    !> The generator text.
    type(value_t), intent(in) :: point_file
    !> The config, beside which a relative path is looked for.
    character(*), intent(in) :: config_file
    !> A missing or bad text, or no points.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    type(generator_text_t) :: text
    type(lattice_t) :: lattice
    real(wp), allocatable :: table(:, :)
    integer, allocatable :: line_of_row(:)

    associate (unused => properties)
    end associate
    if (allocated(self%kept)) then
      call self%revive(grid%kin)
      return
    end if
    call find_point_file(point_file, config_file, path, error)
    if (.not. allocated(error)) call text%open(path, known_keys, error)
    if (.not. allocated(error)) call read_lattice(text, grid%kin, lattice, error)
    if (.not. allocated(error)) call self%make_table(text, lattice, table, line_of_row, error)
    if (allocated(error)) return
    call self%init_from_table(grid, table, path, line_of_row, error)
    if (allocated(error) .or. len(text%out_file) == 0) return
    self%out_file = text%out_file
    call move_alloc(table, self%table)
  end subroutine cartesian_points_init

  !> Write the table that the generator text asks for, once.
  subroutine cartesian_points_write_table(self, error)
    !> The points.
    class(cartesian_points_t), intent(inout) :: self
    !> A table that can't be written.
    type(error_t), allocatable, intent(out) :: error

    if (.not. allocated(self%table)) return
    call write_points_table(self%out_file, self%table, error)
    deallocate (self%table)
  end subroutine cartesian_points_write_table

  !> Read the lattice and the parts.
  subroutine read_lattice(text, kin, lattice, error)
    !> The generator text.
    type(generator_text_t), intent(in) :: text
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The lattice.
    type(lattice_t), intent(out) :: lattice
    !> A key that is missing or bad, or a bad part.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: density(1)
    integer :: cells(kin%dim), points_per_cell(1)

    lattice%kin = kin
    allocate (lattice%spacing(kin%dim))
    call text%read_reals('Lx', lattice%spacing, error)
    if (.not. allocated(error)) call text%read_integers('Nx', cells, error)
    if (.not. allocated(error)) call text%read_integers('lmpp', points_per_cell, error)
    if (.not. allocated(error)) call text%read_reals('rho', density, error)
    if (.not. allocated(error)) call check_size(text, cells, points_per_cell(1), error)
    if (.not. allocated(error)) call lattice%parts%init(kin, text%document, error)
    if (allocated(error)) return
    lattice%n(:kin%dim) = cells*points_per_cell(1)
    lattice%spacing = lattice%spacing/real(lattice%n(:kin%dim), wp)
    lattice%density = density(1)
  end subroutine read_lattice

  !> Refuse a lattice with more positions than indices exist.
  subroutine check_size(text, cells, points_per_cell, error)
    !> The generator text.
    type(generator_text_t), intent(in) :: text
    !> Cells of the lattice. (dim)
    integer, intent(in) :: cells(:)
    !> Points in each cell and direction.
    integer, intent(in) :: points_per_cell
    !> Too many.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: total
    integer :: d

    total = 1
    do d = 1, size(cells)
      ! Each factor is below 2**31, so that the first product fits.
      total = total*cells(d)
      if (total <= huge(1)) total = total*points_per_cell
      if (total > huge(1)) exit
    end do
    if (d > size(cells)) return
    call raise(error, err_input, 'the lattice has more than '//to_text(huge(1))//' positions', &
               file=text%document%path, line=text%line_of('Nx'), &
               hint='use fewer cells (Nx) or fewer points in a cell (lmpp)')
  end subroutine check_size

  !> Rows of a points table for all positions that lie in a part.
  subroutine make_table(self, text, lattice, table, line_of_row, error)
    !> The points, not yet made.
    class(cartesian_points_t), intent(in) :: self
    !> The generator text.
    type(generator_text_t), intent(in) :: text
    !> The lattice.
    type(lattice_t), intent(in) :: lattice
    !> Mass, volume, position, velocity, active. (columns, n)
    real(wp), allocatable, intent(out) :: table(:, :)
    !> Line of the part of each point. (n)
    integer, allocatable, intent(out) :: line_of_row(:)
    !> No point, or too many for the memory.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: bytes
    integer :: n, most, status

    bytes = bytes_per_point(lattice%kin) + full_width(lattice%kin)*(storage_size(1.0_wp)/8) &
            + storage_size(n)/8
    most = int(min(self%memory_room/bytes, huge(1) - 1_lp))
    call visit_positions(lattice, most, n)
    if (n > most) then
      call self%claim(int(n, lp), bytes, error)
      error%message = 'more than '//error%message
      error%file = text%document%path
      return
    else if (n == 0) then
      call raise(error, err_input, 'no point of the lattice lies in a part', &
                 file=text%document%path, hint='the lattice fills the box from 0 to Lx: check '// &
                 'the parts against it, or use more points')
      return
    end if
    allocate (table(full_width(lattice%kin), n), stat=status)
    if (status == 0) allocate (line_of_row(n), stat=status)
    if (status /= 0) then
      call raise(error, err_input, to_text(n)//' points are too many for the memory', &
                 file=text%document%path)
      return
    end if
    call visit_positions(lattice, most, n, table, line_of_row)
  end subroutine make_table

  !> Count the positions that lie in a part, the first direction slowest, and fill their rows.
  subroutine visit_positions(lattice, most, n, table, line_of_row)
    !> The lattice.
    type(lattice_t), intent(in) :: lattice
    !> Number of positions in parts above which no more are counted.
    integer, intent(in) :: most
    !> Number of positions in parts; one above `most` when there are more.
    integer, intent(out) :: n
    !> Mass, volume, position, velocity, active. (columns, n)
    real(wp), intent(inout), optional :: table(:, :)
    !> Line of the part of each point. (n)
    integer, intent(inout), optional :: line_of_row(:)
    real(wp) :: x(size(lattice%spacing)), volume
    integer :: i, j, k, part, at(3), first(3), last(3)

    volume = product(lattice%spacing)
    call reach(lattice, first, last)
    n = 0
    do i = first(1), last(1)
      do j = first(2), last(2)
        do k = first(3), last(3)
          at = [i, j, k]
          x = (real(at(:size(x)), wp) + 0.5_wp)*lattice%spacing
          part = lattice%parts%find(x)
          if (part == 0) cycle
          n = n + 1
          if (n > most) return
          if (.not. (present(table) .and. present(line_of_row))) cycle
          table(:, n) = 0.0_wp
          table(1, n) = lattice%density*volume
          table(2, n) = volume
          table(3:2 + size(x), n) = x
          table(size(table, 1), n) = 1.0_wp
          line_of_row(n) = lattice%parts%slots(part)%line
        end do
      end do
    end do
  end subroutine visit_positions

  !> Positions that can lie in a part, so that a small part of a large lattice is found fast.
  pure subroutine reach(lattice, first, last)
    !> The lattice.
    type(lattice_t), intent(in) :: lattice
    !> Lowest index in each direction.
    integer, intent(out) :: first(3)
    !> Highest index in each direction.
    integer, intent(out) :: last(3)
    real(wp) :: lower(3), upper(3), low(3), high(3)
    integer :: i, d

    lower = huge(1.0_wp)
    upper = -huge(1.0_wp)
    do i = 1, size(lattice%parts%slots)
      call lattice%parts%slots(i)%part%bounds(low, high)
      lower = min(lower, low)
      upper = max(upper, high)
    end do
    first = 0
    last = lattice%n - 1
    do d = 1, size(lattice%spacing)
      associate (length => lattice%n(d)*lattice%spacing(d))
        ! One position more on each side than rounding can take away.
        low(d) = min(max(lower(d), 0.0_wp), length)
        high(d) = min(max(upper(d), 0.0_wp), length)
        first(d) = int(max(low(d)/lattice%spacing(d) - 2.0_wp, 0.0_wp))
        last(d) = int(min(high(d)/lattice%spacing(d) + 2.0_wp, real(last(d), wp)))
      end associate
    end do
  end subroutine reach

end module mpm_cartesian_points
