!> The layout of legacy VTK files: version 3.0, one unstructured grid with point data, in text or in
!! binary.
!!
!! Blocks come in the order points, cells, fields; each is started with its size and then filled by
!! any number of `put_*` calls, so that no block is ever held as a whole.
module mpm_vtk_legacy
  use mpm_errors, only: error_t
  use mpm_kinds, only: lp, wp
  use mpm_strings, only: string_t, to_text
  use mpm_text_writer, only: text_writer_t
  implicit none
  private
  public :: cells_at_once, vtk_legacy_t, vtk_vertex

  !> VTK cell type of a single point.
  integer, parameter :: vtk_vertex = 1
  !> Cells that are best put at a time.
  integer, parameter :: cells_at_once = 256
  !> Readers take 255 characters of a title or name, and then there may be a number behind it.
  integer, parameter :: max_name_length = 240

  !> A legacy VTK file on its way.
  type :: vtk_legacy_t
    private
    !> The text of the file.
    type(text_writer_t) :: text
    !> Names of the fields so far.
    type(string_t), allocatable :: names(:)
    !> Numbers as bytes instead of text.
    logical :: binary = .false.
  contains
    !> Start a file.
    procedure :: open => vtk_legacy_open
    !> Start the block of positions.
    procedure :: start_points
    !> Write positions.
    procedure :: put_points
    !> Write vertex cells, one a point.
    procedure :: put_vertices
    !> Start the block of cells.
    procedure :: start_cells
    !> Write some cells.
    procedure :: put_cells
    !> Write the types of all cells.
    procedure :: put_cell_types
    !> Start the fields.
    procedure :: start_fields
    !> Start a field of numbers.
    procedure :: start_scalars
    !> Write numbers of a field.
    procedure :: put_scalars
    !> Start a field of vectors.
    procedure :: start_vectors
    !> Write vectors of a field.
    procedure :: put_vectors
    !> Start a field of tensors.
    procedure :: start_tensors
    !> Write tensors of a field.
    procedure :: put_tensors
    !> Finish the file and give it its name.
    procedure :: commit => vtk_legacy_commit
    !> Give up the file.
    procedure :: discard => vtk_legacy_discard
    procedure, private :: put_field_name
    procedure, private :: put_header
  end type vtk_legacy_t

contains

  !> Start a file.
  subroutine vtk_legacy_open(self, path, title, digits, error, binary)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Its name; the folder exists.
    character(*), intent(in) :: path
    !> Title, one line; what is beyond 255 characters is lost to readers.
    character(*), intent(in) :: title
    !> Significant digits of reals, 1 to 17.
    integer, intent(in) :: digits
    !> `err_io` when the file can't be written.
    type(error_t), allocatable, intent(out) :: error
    !> Numbers as bytes, in full, instead of text; text when left out.
    logical, intent(in), optional :: binary

    self%binary = .false.
    if (present(binary)) self%binary = binary
    call self%text%open(path, error, digits)
    if (allocated(error)) return
    if (allocated(self%names)) deallocate (self%names)
    allocate (self%names(0))
    call self%text%put_line('# vtk DataFile Version 3.0')
    call self%text%put_line(title)
    call self%text%put_line(trim(merge('BINARY', 'ASCII ', self%binary)))
    call self%text%put_line('DATASET UNSTRUCTURED_GRID')
  end subroutine vtk_legacy_open

  !> Write the first line of a block.
  subroutine put_header(self, line)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> The line.
    character(*), intent(in) :: line

    ! Bytes do not end a line.
    if (self%binary) call self%text%put_line()
    call self%text%put_line(line)
  end subroutine put_header

  !> Start the block of positions.
  subroutine start_points(self, n)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Number of points.
    integer, intent(in) :: n

    call self%put_header('POINTS '//to_text(n)//' double')
  end subroutine start_points

  !> Write positions.
  subroutine put_points(self, positions)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Positions, unused components 0. [m] (3, any)
    real(wp), contiguous, intent(in) :: positions(:, :)

    call self%put_vectors(positions)
  end subroutine put_points

  !> Write vertex cells, one a point: the blocks of cells and of cell types.
  subroutine put_vertices(self, n)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Number of points.
    integer, intent(in) :: n
    integer :: first, last, i

    call self%start_cells(n, 1)
    do first = 0, n - 1, cells_at_once
      last = min(n, first + cells_at_once) - 1
      call self%put_cells(reshape([(i, i=first, last)], [1, last - first + 1]))
    end do
    call self%put_cell_types(n, vtk_vertex)
  end subroutine put_vertices

  !> Start the block of cells, which all have the same number of nodes.
  subroutine start_cells(self, n, nodes_per_cell)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Number of cells.
    integer, intent(in) :: n
    !> Nodes of a cell.
    integer, intent(in) :: nodes_per_cell

    call self%put_header('CELLS '//to_text(n)//' '//to_text(int(n, lp)*(nodes_per_cell + 1)))
  end subroutine start_cells

  !> Write some cells.
  subroutine put_cells(self, nodes)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Their nodes, from 0, in the order of the VTK cell type. (nodes of a cell, any)
    integer, intent(in) :: nodes(:, :)
    integer :: numbers((size(nodes, 1) + 1)*size(nodes, 2)), n, i, k

    n = size(nodes, 1)
    k = 0
    do i = 1, size(nodes, 2)
      numbers(k + 1) = n
      numbers(k + 2:k + 1 + n) = nodes(:, i)
      k = k + 1 + n
    end do
    if (self%binary) then
      call self%text%put_integer_bytes(numbers)
    else
      call self%text%put_integers(numbers, n + 1)
    end if
  end subroutine put_cells

  !> Write the types of all cells, which are the same.
  subroutine put_cell_types(self, n, cell_type)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Number of cells.
    integer, intent(in) :: n
    !> VTK cell type.
    integer, intent(in) :: cell_type
    integer :: some(min(n, cells_at_once)), m, i

    call self%put_header('CELL_TYPES '//to_text(n))
    some = cell_type
    do i = 1, n, cells_at_once
      m = min(n + 1 - i, cells_at_once)
      if (self%binary) then
        call self%text%put_integer_bytes(some(:m))
      else
        call self%text%put_integers(some(:m), 1)
      end if
    end do
  end subroutine put_cell_types

  !> Start the fields.
  subroutine start_fields(self, n)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Number of points.
    integer, intent(in) :: n

    call self%put_header('POINT_DATA '//to_text(n))
  end subroutine start_fields

  !> Start a field of numbers.
  subroutine start_scalars(self, name)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name

    call self%put_field_name('SCALARS', name, 'double 1')
    call self%text%put_line('LOOKUP_TABLE default')
  end subroutine start_scalars

  !> Write numbers of a field.
  subroutine put_scalars(self, numbers)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Numbers. (any)
    real(wp), contiguous, intent(in) :: numbers(:)

    if (self%binary) then
      call self%text%put_real_bytes(numbers)
    else
      call self%text%put_reals(numbers, 1)
    end if
  end subroutine put_scalars

  !> Start a field of vectors.
  subroutine start_vectors(self, name)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name

    call self%put_field_name('VECTORS', name, 'double')
  end subroutine start_vectors

  !> Write vectors of a field.
  subroutine put_vectors(self, vectors)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Vectors, unused components 0. (3, any)
    real(wp), contiguous, intent(in) :: vectors(:, :)

    call put_triples(self%text, self%binary, vectors, size(vectors))
  end subroutine put_vectors

  !> Start a field of tensors.
  subroutine start_tensors(self, name)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name

    call self%put_field_name('TENSORS', name, 'double')
  end subroutine start_tensors

  !> Write tensors of a field, an empty line behind each.
  subroutine put_tensors(self, tensors)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> Rows one behind the other: xx xy xz yx ... (9, any)
    real(wp), contiguous, intent(in) :: tensors(:, :)

    call put_triples(self%text, self%binary, tensors, size(tensors), per_group=9)
  end subroutine put_tensors

  !> Write numbers, three on each line.
  subroutine put_triples(text, binary, numbers, n, per_group)
    !> The text of the file.
    type(text_writer_t), intent(inout) :: text
    !> Numbers as bytes.
    logical, intent(in) :: binary
    !> Number of numbers.
    integer, intent(in) :: n
    !> The numbers.
    real(wp), intent(in) :: numbers(n)
    !> Numbers behind which there is an empty line in text; none when left out.
    integer, intent(in), optional :: per_group

    if (binary) then
      call text%put_real_bytes(numbers)
    else
      call text%put_reals(numbers, 3, per_group)
    end if
  end subroutine put_triples

  !> Write the first line of a field; a name that is in use gets a number.
  subroutine put_field_name(self, kind, name, format)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> `SCALARS`, `VECTORS` or `TENSORS`.
    character(*), intent(in) :: kind
    !> Name of the field.
    character(*), intent(in) :: name
    !> What follows the name.
    character(*), intent(in) :: format
    type(string_t), allocatable :: longer(:)
    character(:), allocatable :: plain, unique
    integer :: number, i

    plain = as_name(name)
    unique = plain
    number = 1
    do while (any([(self%names(i)%text == unique, i=1, size(self%names))]))
      number = number + 1
      unique = plain//'_'//to_text(number)
    end do
    allocate (longer(size(self%names) + 1))
    do i = 1, size(self%names)
      longer(i)%text = self%names(i)%text
    end do
    longer(size(longer))%text = unique
    call move_alloc(longer, self%names)
    call self%put_header(kind//' '//unique//' '//format)
  end subroutine put_field_name

  !> A name as the format has it: no blanks, none of VTK's escapes, not too long.
  pure function as_name(text) result(name)
    !> Any text.
    character(*), intent(in) :: text
    !> Blanks, control characters and `%` are replaced by `_`.
    character(:), allocatable :: name
    integer :: i

    name = text(:min(len(text), max_name_length))
    do i = 1, len(name)
      if (iachar(name(i:i)) <= iachar(' ') .or. iachar(name(i:i)) == 127 &
          .or. name(i:i) == '%') name(i:i) = '_'
    end do
    if (len(name) == 0) name = '_'
  end function as_name

  !> Finish the file and give it its name.
  subroutine vtk_legacy_commit(self, error)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self
    !> `err_io` with the first failure; then there is no new file.
    type(error_t), allocatable, intent(out) :: error

    call self%text%commit(error)
  end subroutine vtk_legacy_commit

  !> Give up the file: nothing is left of it.
  subroutine vtk_legacy_discard(self)
    !> The file.
    class(vtk_legacy_t), intent(inout) :: self

    call self%text%discard()
  end subroutine vtk_legacy_discard

end module mpm_vtk_legacy
