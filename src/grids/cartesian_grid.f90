!> What all Cartesian grids share: equal cells in a box, numbered x first, and a basis.
module mpm_cartesian_grid
  use mpm_errors, only: err_input, error_t, raise
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_grid_velocity, only: at_nodes
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_line_integrals, only: line_integral, smoothing
  use mpm_properties, only: properties_t
  use mpm_stencil, only: basis_box, basis_cubic, basis_hat, natural_width, stencil_t
  use mpm_strings, only: to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: cartesian_grid_t

  !> Equal cells in a box.
  type, abstract, extends(grid_t) :: cartesian_grid_t
    !> Cells in each direction; 0 in unused ones.
    integer :: n_cells(3) = 0
    !> Spacing; 1 in unused directions. [m]
    real(wp) :: h(3) = 1.0_wp
    !> Lower corner. [m]
    real(wp) :: lower(3) = 0.0_wp
    !> Upper corner. [m]
    real(wp) :: upper(3) = 0.0_wp
    !> Directions in which the upper face is the lower one again.
    logical :: periodic(3) = .false.
    !> One of the `basis_*` of `mpm_stencil`.
    integer :: kind = basis_hat
    !> `basis_box`: half width of the box over the spacing.
    real(wp) :: lambda(3) = 0.5_wp
  contains
    procedure :: whole => cartesian_whole
    procedure :: cell_count => cartesian_cell_count
    procedure :: vtk_cell_type => cartesian_vtk_cell_type
    procedure :: cell_nodes => cartesian_cell_nodes
    procedure :: node_position => cartesian_node_position
    procedure :: bounds => cartesian_bounds
    procedure :: spacing => cartesian_spacing
    procedure :: in_domain => cartesian_in_domain
    procedure :: node_volume => cartesian_node_volume
    procedure :: make_stencil => cartesian_make_stencil
    procedure :: periods => cartesian_periods
    procedure :: write_velocity => cartesian_write_velocity
    procedure :: write_fields => cartesian_write_fields
    !> Set lengths, cell counts and origin from the properties Lx ..., Nx ... and x0 ...
    procedure :: init_box => cartesian_init_box
    !> Take the periodic directions from the properties periodic_x ...
    procedure :: init_periodic => cartesian_init_periodic
    !> Take a basis.
    procedure :: init_basis => cartesian_init_basis
    !> Kind of a node in each direction.
    procedure :: edge_id => cartesian_edge_id
  end type cartesian_grid_t

contains

  !> Set lengths, cell counts and origin from the properties Lx ..., Nx ... and x0 ...
  subroutine cartesian_init_box(self, kin, properties, error, origin)
    !> The grid.
    class(cartesian_grid_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> More nodes than indices exist, or a negative radius.
    type(error_t), allocatable, intent(out) :: error
    !> Name of the property in place of x0.
    character(2), intent(in), optional :: origin
    character(2), parameter :: lengths(3) = ['Lx', 'Ly', 'Lz'], counts(3) = ['Nx', 'Ny', 'Nz']
    character(2) :: origins(3)
    integer(lp) :: nodes
    integer :: d

    self%kin = kin
    origins = ['x0', 'y0', 'z0']
    if (present(origin)) origins(1) = origin
    nodes = 1
    do d = 1, kin%dim
      self%lower(d) = properties%real(origins(d))
      self%upper(d) = self%lower(d) + properties%real(lengths(d))
      self%n_cells(d) = properties%integer(counts(d))
      self%h(d) = properties%real(lengths(d))/real(self%n_cells(d), wp)
      if (nodes <= huge(1)) nodes = nodes*(int(self%n_cells(d), lp) + 1)
    end do
    if (nodes > int(huge(1), lp)) then
      call properties%reject('Nx', 'the grid has more than '//to_text(huge(1))//' nodes', error, &
                             'use fewer cells')
    else if (kin%sim_type == type_axisymmetric .and. self%lower(1) < 0.0_wp) then
      call properties%reject(origins(1), 'in TYPE 4 x is the radius, which cannot begin at '// &
                             to_text(self%lower(1)), error, 'use 0 or more')
    end if
  end subroutine cartesian_init_box

  !> Take the periodic directions from the properties periodic_x, periodic_y, periodic_z.
  subroutine cartesian_init_periodic(self, properties, error)
    !> The grid, with its box.
    class(cartesian_grid_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A periodic radius.
    type(error_t), allocatable, intent(out) :: error
    character(10), parameter :: names(3) = ['periodic_x', 'periodic_y', 'periodic_z']
    integer :: d

    do d = 1, self%kin%dim
      self%periodic(d) = properties%integer(names(d)) == 1
    end do
    if (self%periodic(1) .and. self%kin%sim_type == type_axisymmetric) then
      call properties%reject(names(1), 'in TYPE 4 x is the radius, which cannot be periodic', &
                             error, 'use 0')
    end if
  end subroutine cartesian_init_periodic

  !> Take a basis.
  subroutine cartesian_init_basis(self, kind, properties, error)
    !> The grid, with its box and periodic directions.
    class(cartesian_grid_t), intent(inout) :: self
    !> One of the `basis_*` of `mpm_stencil`.
    integer, intent(in) :: kind
    !> Checked properties; with a property `l` the half width of points in a basis of boxes.
    type(properties_t), intent(in) :: properties
    !> Too few cells between walls, or points wider than a cell.
    type(error_t), allocatable, intent(out) :: error
    character(2), parameter :: counts(3) = ['Nx', 'Ny', 'Nz']
    integer :: d

    self%kind = kind
    do d = 1, self%kin%dim
      if (self%periodic(d) .or. self%n_cells(d) >= 3) cycle
      call properties%reject(counts(d), counts(d)//' = '//to_text(self%n_cells(d))//', but the &
                             &functions of this grid need 3 cells between walls', error, &
                             'use more cells, or a grid with linear functions')
      return
    end do
    if (.not. properties%given('l')) return
    self%lambda(:self%kin%dim) = properties%real('l')/self%h(:self%kin%dim)
    ! l = h/2 from decimal numbers may be off by their rounding.
    where (abs(self%lambda - 0.5_wp) <= 4.0_wp*epsilon(1.0_wp)) self%lambda = 0.5_wp
    if (any(self%lambda > 0.5_wp)) then
      call properties%reject('l', 'l = '//to_text(properties%real('l'))//' m is more than half of &
                             &the smallest cell, '//to_text(minval(self%h(:self%kin%dim)))//' m', &
                             error, 'l is half of the width of a point, h/4 for two points in a &
                             &cell and direction')
    end if
  end subroutine cartesian_init_basis

  !> All nodes of the grid.
  pure function cartesian_whole(self) result(window)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Window of all nodes.
    type(window_t) :: window

    window%lo = 0
    window%n = self%n_cells + 1
  end function cartesian_whole

  !> Number of cells.
  pure function cartesian_cell_count(self) result(n)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Number of cells.
    integer :: n

    n = product(self%n_cells(:self%kin%dim))
  end function cartesian_cell_count

  !> VTK line, pixel or voxel.
  pure function cartesian_vtk_cell_type(self) result(n)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> VTK cell type.
    integer :: n
    integer, parameter :: types(3) = [3, 8, 11]

    n = types(self%kin%dim)
  end function cartesian_vtk_cell_type

  !> Corners of a cell, x fastest.
  pure subroutine cartesian_cell_nodes(self, cell, nodes, n)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Cell, from 0, x fastest.
    integer, intent(in) :: cell
    !> Node ids, from 0.
    integer, intent(out) :: nodes(8)
    !> Number of nodes.
    integer, intent(out) :: n
    integer :: c(3), rest, corner, node(3)
    type(window_t) :: window

    window = self%whole()
    c(1) = mod(cell, self%n_cells(1))
    rest = cell/self%n_cells(1)
    c(2) = 0
    c(3) = 0
    if (self%kin%dim > 1) then
      c(2) = mod(rest, self%n_cells(2))
      c(3) = rest/self%n_cells(2)
    end if
    n = 2**self%kin%dim
    nodes = 0
    do corner = 0, n - 1
      node = c + [iand(corner, 1), iand(corner/2, 1), corner/4]
      nodes(corner + 1) = window%start(node)
    end do
  end subroutine cartesian_cell_nodes

  !> Position of a node.
  pure function cartesian_node_position(self, node) result(x)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Position; nodes of the upper faces lie on the faces exactly. [m]
    real(wp) :: x(3)

    x = self%lower + real(node, wp)*self%h
    where (node == self%n_cells) x = self%upper
  end function cartesian_node_position

  !> Corners of the box.
  pure subroutine cartesian_bounds(self, lower, upper)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    lower = self%lower
    upper = self%upper
  end subroutine cartesian_bounds

  !> Spacing of the nodes.
  pure function cartesian_spacing(self) result(h)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Spacing. [m]
    real(wp) :: h(3)

    h = self%h
  end function cartesian_spacing

  !> Whether a position is in the closed box.
  pure function cartesian_in_domain(self, x) result(inside)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is inside; false for NaN.
    logical :: inside

    inside = all((x >= self%lower(:size(x)) .and. x <= self%upper(:size(x))) .or. &
                 (self%periodic(:size(x)) .and. abs(x) <= huge(1.0_wp)))
  end function cartesian_in_domain

  !> Integral of a node's function; all nodes of a periodic direction are alike.
  pure function cartesian_node_volume(self, node) result(volume)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> Volume. [m3]
    real(wp) :: volume
    integer :: d

    volume = 1.0_wp
    do d = 1, self%kin%dim
      volume = volume*self%h(d)*line_integral(node(d), self%n_cells(d), &
                                              smoothing(self%kind, self%lambda(d)), &
                                              self%periodic(d))
    end do
  end function cartesian_node_volume

  !> The functions, or their averages over the corners of the points' boxes.
  subroutine cartesian_make_stencil(self, averaged, largest_extent, stencil, error)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Average over the corners of the points' boxes.
    logical, intent(in) :: averaged
    !> Largest half side of a point's box. [m]
    real(wp), intent(in) :: largest_extent
    !> The basis.
    type(stencil_t), intent(out) :: stencil
    !> The boxes are too wide for the cells.
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: most(3) = [character(4) :: 'four', 'two', 'two']
    real(wp) :: smallest, widest

    smallest = minval(self%h(:self%kin%dim))
    stencil%dim = self%kin%dim
    stencil%kind = self%kind
    stencil%lambda = self%lambda
    stencil%periodic = self%periodic
    stencil%lower = self%lower
    stencil%h = self%h
    stencil%n_cells = self%n_cells
    stencil%averaged = averaged
    stencil%width = natural_width(self%kind)
    if (.not. averaged) return
    ! The corners lie half of the half side away from the point on both sides.
    stencil%width = stencil%width + 1
    widest = smallest
    if (self%kind == basis_hat) then
      if (largest_extent > smallest) stencil%width = stencil%width + 1
      widest = 2.0_wp*smallest
    end if
    if (largest_extent > widest) then
      call raise(error, err_input, 'a point with a box of side '//to_text(2.0_wp*largest_extent)// &
                 ' m is wider than '//trim(most(self%kind))//' cells of the grid', &
                 hint='use more points, a coarser grid, or no corner averaging (cpdi = 0)')
    end if
  end subroutine cartesian_make_stencil

  !> Nodes after which the grid repeats; 0 in directions with walls.
  pure function cartesian_periods(self) result(periods)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Cells of periodic directions.
    integer :: periods(3)

    periods = merge(self%n_cells, 0, self%periodic)
  end function cartesian_periods

  !> Kind of a node in each direction, as mpm_3d numbers them: 0 at a wall, 1 and -1 next to a lower
  !! and upper wall, 3 and -3 next to the seam of a periodic direction, 2 elsewhere.
  pure function cartesian_edge_id(self, node) result(id)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Grid indices, from 0.
    integer, intent(in) :: node(3)
    !> The kinds; 0 in unused directions.
    integer :: id(3)
    integer :: d

    id = 0
    do d = 1, self%kin%dim
      id(d) = 2
      if (node(d) == self%n_cells(d) - 1) id(d) = merge(-3, -1, self%periodic(d))
      if (node(d) == 1) id(d) = merge(3, 1, self%periodic(d))
      if (self%periodic(d)) cycle
      if (node(d) == 0 .or. node(d) == self%n_cells(d)) id(d) = 0
    end do
  end function cartesian_edge_id

  !> Send the field `grid_velocity` where it differs from the velocities of the nodes.
  subroutine cartesian_write_velocity(self, window, velocity, writer)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(in) :: velocity(:, :)
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: grid_velocity(:, :)
    real(wp) :: side(3)
    type(window_t) :: wide

    select case (self%kind)
    case (basis_box)
      side = 0.25_wp*self%lambda
    case (basis_cubic)
      side = 1.0_wp/6.0_wp
    case default
      return
    end select
    call at_nodes(self%kin%dim, self%n_cells, self%periodic, side, window, velocity, wide, &
                  grid_velocity)
    call writer%vector('grid_velocity', grid_velocity, wide)
  end subroutine cartesian_write_velocity

  !> Send the field `edge_id` where the functions of nodes next to walls differ.
  subroutine cartesian_write_fields(self, writer)
    !> The grid.
    class(cartesian_grid_t), intent(in) :: self
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: id(:, :)
    type(window_t) :: whole
    integer :: i, j, k, code(3)

    if (self%kind == basis_hat) return
    whole = self%whole()
    allocate (id(self%kin%dim, whole%size()))
    do k = 0, whole%n(3) - 1
      do j = 0, whole%n(2) - 1
        do i = 0, whole%n(1) - 1
          code = self%edge_id([i, j, k])
          id(:, whole%index([i, j, k])) = real(code(:self%kin%dim), wp)
        end do
      end do
    end do
    call writer%vector('edge_id', id, whole)
  end subroutine cartesian_write_fields

end module mpm_cartesian_grid
