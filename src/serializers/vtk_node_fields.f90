!> The node file of one body and frame.
module mpm_vtk_node_fields
  use mpm_body, only: body_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_strings, only: to_text
  use mpm_vtk_fields, only: block_size, vtk_fields_t
  use mpm_vtk_legacy, only: cells_at_once
  use mpm_window, only: window_t
  implicit none
  private
  public :: vtk_node_fields_t

  !> All nodes and cells of the grid; values are 0 outside the window of a field.
  type, extends(vtk_fields_t) :: vtk_node_fields_t
    !> Nodes after which the grid repeats in each direction; 0 where it does not.
    integer, private :: periods(3) = 0
  contains
    !> Start the file and write the grid.
    procedure :: open => vtk_node_fields_open
    procedure :: locate => vtk_node_fields_locate
    procedure :: label => vtk_node_fields_label
    procedure, private :: put_positions
    procedure, private :: put_cells
  end type vtk_node_fields_t

contains

  !> Start the file and write the grid.
  subroutine vtk_node_fields_open(self, grid, body, path, title, digits, when, error, &
                                  binary)
    !> The file.
    class(vtk_node_fields_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The body.
    class(body_t), intent(in) :: body
    !> Name of the file.
    character(*), intent(in) :: path
    !> Title line.
    character(*), intent(in) :: title
    !> Significant digits.
    integer, intent(in) :: digits
    !> Frame and time, for messages.
    character(*), intent(in) :: when
    !> The file can't be written.
    type(error_t), allocatable, intent(out) :: error
    !> Numbers as bytes instead of text.
    logical, intent(in) :: binary

    call self%file%open(path, title, digits, error, binary)
    if (allocated(error)) return
    self%body = body%name
    self%when = when
    self%kin = grid%kin
    self%whole = grid%whole()
    self%periods = grid%periods()
    call self%put_positions(grid)
    call self%put_cells(grid)
    call self%file%start_fields(self%whole%size())
  end subroutine vtk_node_fields_open

  !> Write the positions of all nodes.
  subroutine put_positions(self, grid)
    !> The file.
    class(vtk_node_fields_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    real(wp) :: x(3, block_size)
    integer :: n, first, m, i

    n = self%whole%size()
    call self%file%start_points(n)
    do first = 1, n, block_size
      m = min(block_size, n - first + 1)
      do i = 1, m
        x(:, i) = grid%node_position(node_at(self%whole, first + i - 1))
      end do
      call self%file%put_points(x(:, :m))
    end do
  end subroutine put_positions

  !> Write all cells.
  subroutine put_cells(self, grid)
    !> The file.
    class(vtk_node_fields_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    integer :: nodes(8, cells_at_once), n_nodes, n_cells, first, n, i

    n_cells = grid%cell_count()
    call grid%cell_nodes(0, nodes(:, 1), n_nodes)
    call self%file%start_cells(n_cells, n_nodes)
    do first = 0, n_cells - 1, cells_at_once
      n = min(cells_at_once, n_cells - first)
      do i = 1, n
        call grid%cell_nodes(first + i - 1, nodes(:, i), n_nodes)
      end do
      call self%file%put_cells(nodes(:n_nodes, :n))
    end do
    call self%file%put_cell_types(n_cells, grid%vtk_cell_type())
  end subroutine put_cells

  !> Grid indices of a node of the whole grid.
  pure function node_at(whole, entry) result(node)
    !> All nodes of the grid.
    type(window_t), intent(in) :: whole
    !> Position of the node, from 1.
    integer, intent(in) :: entry
    !> Its indices, from 0.
    integer :: node(3)
    integer :: rest

    rest = (entry - 1)/whole%n(1)
    node(1) = entry - 1 - rest*whole%n(1)
    node(3) = rest/whole%n(2)
    node(2) = rest - node(3)*whole%n(2)
    node = node + whole%lo
  end function node_at

  !> Positions in a window of a range of nodes of the grid.
  subroutine vtk_node_fields_locate(self, first, window, source)
    !> The file.
    class(vtk_node_fields_t), intent(in) :: self
    !> First node, from 1.
    integer, intent(in) :: first
    !> Window of the values.
    type(window_t), intent(in) :: window
    !> Positions in the window; 0 outside of it.
    integer, intent(out) :: source(:)
    integer :: i, node(3)

    do i = 1, size(source)
      node = node_at(self%whole, first + i - 1)
      ! The last node of a period is the first one.
      where (self%periods > 0 .and. node == self%periods) node = 0
      source(i) = 0
      if (window%holds(node)) source(i) = window%index(node)
    end do
  end subroutine vtk_node_fields_locate

  !> A node by its grid indices.
  pure function vtk_node_fields_label(self, entry) result(text)
    !> The file.
    class(vtk_node_fields_t), intent(in) :: self
    !> Node, from 1.
    integer, intent(in) :: entry
    !> Its name.
    character(:), allocatable :: text
    integer :: node(3)

    node = node_at(self%whole, entry)
    text = 'node '//to_text(entry - 1)//' (indices '//to_text(node(1))//', '//to_text(node(2))// &
           ', '//to_text(node(3))//')'
  end function vtk_node_fields_label

end module mpm_vtk_node_fields
