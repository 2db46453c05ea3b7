!> Gmsh meshes, versions 2.2 and 4.1, ASCII and binary.
!!
!! Read are nodes, the cells of one dimension with straight edges, and the elements of their sides,
!! which carry tags. The tag of an element is its first physical group or, where it has none, the
!! number of its geometric entity, so that a mesh has the same tags in both versions.
module mpm_gmsh_reader
  use mpm_errors, only: error_t
  use mpm_gmsh_cursor, only: gmsh_cursor_t, long_integer, short_integer
  use mpm_kinds, only: lp, wp
  use mpm_number_parser, only: number_ok, parse_integer
  use mpm_strings, only: excerpt, to_text
  implicit none
  private
  public :: gmsh_mesh_t, read_gmsh

  !> Nodes of the element types of Gmsh, 1 to 19.
  integer, parameter :: nodes_of_type(19) = [2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, &
                                             20, 15, 13]
  !> Their dimensions.
  integer, parameter :: dim_of_type(19) = [1, 2, 2, 3, 3, 3, 3, 1, 2, 2, 3, 3, 3, 3, 0, 2, 3, 3, 3]
  !> Types of points, lines, triangles and tetrahedra, by dimension.
  integer, parameter :: simplex(0:3) = [15, 1, 2, 4]
  !> Most numbers that are left free between node tags, for each node.
  integer, parameter :: gap = 16

  !> What a file has, node numbers from 1 in the order of the file.
  type :: gmsh_mesh_t
    !> Positions. [m] (3, n)
    real(wp), allocatable :: x(:, :)
    !> Nodes of the cells. (dim + 1, n_cells)
    integer, allocatable :: cell(:, :)
    !> Line, or byte, of each cell. (n_cells)
    integer(lp), allocatable :: place(:)
    !> Nodes of the tagged sides. (dim, n_sides)
    integer, allocatable :: side(:, :)
    !> Their tags. (n_sides)
    integer, allocatable :: tag(:)
    !> The file, for messages.
    type(gmsh_cursor_t) :: cursor
  contains
    !> Raise an error at a cell.
    procedure :: fail_cell => gmsh_mesh_fail_cell
    procedure, private :: add_element
  end type gmsh_mesh_t

  !> What is known while a file is read.
  type :: reader_t
    !> Dimension of the cells.
    integer :: dim = 2
    !> Version 4.1.
    logical :: is_new = .false.
    !> The first tag of a node.
    integer(lp) :: first_tag = 0
    !> The last one.
    integer(lp) :: last_tag = -1
    !> Number of the node with each tag, from the first one; 0 where there is none.
    integer, allocatable :: number(:)
    !> Dimension, number and physical group of the entities that have one. (3, n)
    integer, allocatable :: entity(:, :)
    !> Number of cells so far.
    integer :: cells = 0
    !> Number of sides so far.
    integer :: sides = 0
  end type reader_t

contains

  !> Read the cells of one dimension, their nodes, and the tags of their sides.
  subroutine read_gmsh(path, dim, mesh, error)
    !> The file.
    character(*), intent(in) :: path
    !> Dimension of the cells: 2 for triangles, 3 for tetrahedra.
    integer, intent(in) :: dim
    !> What the file has.
    type(gmsh_mesh_t), intent(out) :: mesh
    !> A file that can't be read, is cut short, or has no such cells.
    type(error_t), allocatable, intent(out) :: error
    character(9), parameter :: names(2:3) = ['triangle ', 'tetrahedr']
    character(2), parameter :: endings(2:3) = ['s ', 'a ']
    type(reader_t) :: reader
    character(:), allocatable :: name
    logical :: found

    reader%dim = dim
    allocate (reader%entity(3, 0))
    call mesh%cursor%open(path, error)
    if (.not. allocated(error)) call read_format(mesh%cursor, reader, error)
    if (allocated(error)) return
    do
      call next_section(mesh%cursor, found, name, error)
      if (allocated(error)) return
      if (.not. found) exit
      select case (name)
      case ('Entities')
        if (reader%is_new) call read_entities(mesh%cursor, reader, error)
      case ('Nodes')
        call read_nodes(mesh, reader, error)
      case ('Elements')
        call read_elements(mesh, reader, error)
      case default
        continue
      end select
      if (.not. allocated(error)) call mesh%cursor%go_behind('$End'//name, error)
      if (allocated(error)) return
    end do
    if (reader%cells > 0) then
      mesh%cell = mesh%cell(:, :reader%cells)
      mesh%place = mesh%place(:reader%cells)
      mesh%side = mesh%side(:, :reader%sides)
      mesh%tag = mesh%tag(:reader%sides)
      ! Only the places are needed from here on.
      deallocate (mesh%cursor%text)
      return
    end if
    call mesh%cursor%fail('the mesh has no '//trim(names(dim))//trim(endings(dim)), error, &
                          hint='make a mesh of '//to_text(dim)//' dimensions (gmsh -'// &
                          to_text(dim)//'); with physical groups Gmsh only writes what is in one')
  end subroutine read_gmsh

  !> Raise an error at a cell.
  subroutine gmsh_mesh_fail_cell(self, cell, message, error, hint)
    !> The mesh.
    class(gmsh_mesh_t), intent(in) :: self
    !> The cell, from 1.
    integer, intent(in) :: cell
    !> What is wrong.
    character(*), intent(in) :: message
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    !> The way out.
    character(*), intent(in) :: hint

    call self%cursor%fail(message, error, self%place(cell), hint)
  end subroutine gmsh_mesh_fail_cell

  !> Read the section that tells the version and the kind of numbers.
  subroutine read_format(cursor, reader, error)
    !> The file, at its start.
    type(gmsh_cursor_t), intent(inout) :: cursor
    !> Receives the version.
    type(reader_t), intent(inout) :: reader
    !> The file is no mesh of a version that can be read.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: first, last, kind, bytes, one
    character(:), allocatable :: version

    call cursor%next_word(first, last)
    if (cursor%text(first:last) /= '$MeshFormat') then
      call cursor%fail('this is no Gmsh mesh: it does not begin with $MeshFormat', error)
      return
    end if
    call cursor%next_word(first, last)
    version = cursor%text(first:last)
    if (version /= '2' .and. version /= '2.1' .and. version /= '2.2' .and. version /= '4.1') then
      call cursor%fail('version "'//excerpt(version)//'" of the format can''t be read', error)
      return
    end if
    reader%is_new = version == '4.1'
    call cursor%get_integer(short_integer, kind, error)
    if (.not. allocated(error)) call cursor%get_integer(short_integer, bytes, error)
    if (allocated(error)) return
    if (kind < 0 .or. kind > 1 .or. bytes /= 8) then
      call cursor%fail('numbers of kind '//to_text(kind)//' and '//to_text(bytes)// &
                       ' bytes can''t be read', error)
      return
    end if
    if (kind == 1) then
      call cursor%end_line()
      cursor%binary = .true.
      call cursor%get_integer(short_integer, one, error)
      if (allocated(error)) return
      cursor%swapped = one /= 1
      if (cursor%swapped .and. one /= 16777216) then
        call cursor%fail('the mark of the order of bytes is '//to_text(one)//' instead of 1', error)
        return
      end if
    end if
    call cursor%go_behind('$EndMeshFormat', error)
  end subroutine read_format

  !> Go to the next section.
  subroutine next_section(cursor, found, name, error)
    !> The file, behind a section; behind the header of the next one afterwards.
    type(gmsh_cursor_t), intent(inout) :: cursor
    !> Whether there is one.
    logical, intent(out) :: found
    !> Its name.
    character(:), allocatable, intent(out) :: name
    !> Something else stands there.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: first, last

    call cursor%next_word(first, last)
    found = first <= last
    name = ''
    if (.not. found) return
    if (cursor%text(first:first) /= '$' .or. last - first > 100) then
      call cursor%fail('"'//excerpt(cursor%text(first:min(last, first + 100)))// &
                       '" stands where a section such as $Nodes should begin', error)
      return
    end if
    name = cursor%text(first + 1:last)
    call cursor%end_line()
  end subroutine next_section

  !> Read the physical groups of the entities, in version 4.1.
  subroutine read_entities(cursor, reader, error)
    !> The file.
    type(gmsh_cursor_t), intent(inout) :: cursor
    !> Receives the groups.
    type(reader_t), intent(inout) :: reader
    !> Bad numbers.
    type(error_t), allocatable, intent(inout) :: error
    integer, allocatable :: found(:, :)
    integer(lp) :: tag, group
    real(wp) :: unused
    integer :: n(0:3), dim, i, k, m, total

    do dim = 0, 3
      call cursor%get_count(long_integer, 'entities', merge(36, 10, cursor%binary), n(dim), error)
      if (allocated(error)) return
    end do
    ! Each count is bounded by the size of the file, so that the sum fits.
    allocate (found(3, sum(n)))
    total = 0
    do dim = 0, 3
      do i = 1, n(dim)
        call cursor%get_integer(short_integer, tag, error)
        do k = 1, merge(3, 6, dim == 0)
          if (.not. allocated(error)) call cursor%get_real(unused, error)
        end do
        if (.not. allocated(error)) then
          call cursor%get_count(long_integer, 'groups', merge(4, 2, cursor%binary), m, error)
        end if
        do k = 1, m
          if (.not. allocated(error)) call cursor%get_integer(short_integer, group, error)
          if (allocated(error)) return
          if (k > 1 .or. abs(tag) > huge(1) .or. abs(group) > huge(1) .or. group == 0) cycle
          total = total + 1
          found(:, total) = [dim, int(tag), int(abs(group))]
        end do
        if (allocated(error)) return
        if (dim == 0) cycle
        call cursor%get_count(long_integer, 'bounding entities', merge(4, 2, cursor%binary), m, &
                              error)
        if (.not. allocated(error)) call cursor%skip_integers(short_integer, m, error)
        if (allocated(error)) return
      end do
    end do
    reader%entity = found(:, :total)
  end subroutine read_entities

  !> Read the nodes.
  subroutine read_nodes(mesh, reader, error)
    !> Receives the positions.
    type(gmsh_mesh_t), intent(inout) :: mesh
    !> Receives the numbers of the nodes.
    type(reader_t), intent(inout) :: reader
    !> Bad numbers.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp), allocatable :: tag(:)
    integer(lp) :: entity_dim, unused, parametric
    integer :: blocks, n, m, b, i, first, status
    real(wp) :: skipped

    associate (cursor => mesh%cursor)
      if (allocated(mesh%x)) then
        call cursor%fail('a second section $Nodes', error)
        return
      end if
      blocks = 1
      if (reader%is_new) then
        call cursor%get_count(long_integer, 'blocks of nodes', merge(20, 8, cursor%binary), &
                              blocks, error)
      end if
      if (.not. allocated(error)) then
        call cursor%get_count(merge(long_integer, short_integer, reader%is_new), 'nodes', &
                              merge(28, 8, cursor%binary), n, error, &
                              as_text=.not. reader%is_new)
      end if
      if (reader%is_new .and. .not. allocated(error)) then
        call cursor%skip_integers(long_integer, 2, error)
      else if (.not. allocated(error)) then
        call skip_end_of_line(cursor)
      end if
      if (allocated(error)) return
      allocate (mesh%x(3, n), stat=status)
      if (status == 0) allocate (tag(n), stat=status)
      if (status /= 0) then
        call cursor%fail(to_text(n)//' nodes are too many for the memory', error)
        return
      end if
      first = 0
      do b = 1, blocks
        m = n
        parametric = 0
        entity_dim = 0
        if (reader%is_new) then
          call cursor%get_integer(short_integer, entity_dim, error)
          if (.not. allocated(error)) call cursor%get_integer(short_integer, unused, error)
          if (.not. allocated(error)) call cursor%get_integer(short_integer, parametric, error)
          if (.not. allocated(error)) then
            call cursor%get_count(long_integer, 'nodes', merge(32, 8, cursor%binary), m, error)
          end if
          if (allocated(error)) return
          if (m > n - first .or. entity_dim < 0 .or. entity_dim > 3) then
            call cursor%fail('a block of nodes does not fit the count of nodes', error)
            return
          end if
          do i = first + 1, first + m
            call cursor%get_integer(long_integer, tag(i), error)
            if (allocated(error)) return
          end do
        end if
        do i = first + 1, first + m
          if (.not. reader%is_new) call cursor%get_integer(short_integer, tag(i), error)
          if (.not. allocated(error)) call cursor%get_real(mesh%x(1, i), error)
          if (.not. allocated(error)) call cursor%get_real(mesh%x(2, i), error)
          if (.not. allocated(error)) call cursor%get_real(mesh%x(3, i), error)
          if (allocated(error)) return
          if (parametric == 0) cycle
          do unused = 1, entity_dim
            call cursor%get_real(skipped, error)
            if (allocated(error)) return
          end do
        end do
        first = first + m
      end do
      if (first < n) then
        call cursor%fail('the blocks have '//to_text(first)//' of '//to_text(n)//' nodes', error)
        return
      end if
    end associate
    call number_nodes(mesh%cursor, tag, reader, error)
  end subroutine read_nodes

  !> Go behind the end of the line of a count, which binary numbers follow.
  subroutine skip_end_of_line(cursor)
    !> The file.
    type(gmsh_cursor_t), intent(inout) :: cursor

    if (cursor%binary) call cursor%end_line()
  end subroutine skip_end_of_line

  !> Make the table of the numbers of the nodes by their tags.
  subroutine number_nodes(cursor, tag, reader, error)
    !> The file, for messages.
    type(gmsh_cursor_t), intent(in) :: cursor
    !> Tags in the order of the nodes. (n)
    integer(lp), intent(in) :: tag(:)
    !> Receives the table.
    type(reader_t), intent(inout) :: reader
    !> A tag that occurs twice, or tags too far apart.
    type(error_t), allocatable, intent(inout) :: error
    integer :: i

    if (size(tag) == 0) then
      call cursor%fail('the mesh has no nodes', error)
      return
    end if
    reader%first_tag = minval(tag)
    reader%last_tag = maxval(tag)
    ! Halves: the difference of two large numbers may be too large.
    if (reader%last_tag/2 - reader%first_tag/2 > int(gap, lp)*size(tag) + 1000) then
      call cursor%fail('the tags of the nodes lie too far apart: '//to_text(reader%first_tag)// &
                       ' to '//to_text(reader%last_tag), error, hint='renumber the mesh in Gmsh: &
                       &Mesh.Renumber = 1, or RenumberMeshNodes')
      return
    end if
    allocate (reader%number(reader%last_tag - reader%first_tag + 1), source=0)
    do i = 1, size(tag)
      associate (number => reader%number(tag(i) - reader%first_tag + 1))
        if (number > 0) then
          call cursor%fail('two nodes have the tag '//to_text(tag(i)), error)
          return
        end if
        number = i
      end associate
    end do
  end subroutine number_nodes

  !> Read the elements.
  subroutine read_elements(mesh, reader, error)
    !> Receives cells and sides.
    type(gmsh_mesh_t), intent(inout) :: mesh
    !> Numbers of the nodes, groups of the entities.
    type(reader_t), intent(inout) :: reader
    !> Bad numbers, unknown nodes, or cells that are no simplices.
    type(error_t), allocatable, intent(inout) :: error
    integer :: n, blocks, status, bytes

    associate (cursor => mesh%cursor)
      if (allocated(mesh%cell) .or. .not. allocated(mesh%x)) then
        call cursor%fail('the section $Elements must stand once, behind $Nodes', error)
        return
      end if
      bytes = merge(long_integer, short_integer, reader%is_new)
      blocks = 1
      if (reader%is_new) then
        call cursor%get_count(bytes, 'blocks of elements', merge(20, 8, cursor%binary), blocks, &
                              error)
        if (allocated(error)) return
      end if
      call cursor%get_count(bytes, 'elements', merge(8, 4, cursor%binary), n, error, &
                            as_text=.not. reader%is_new)
      if (reader%is_new .and. .not. allocated(error)) then
        call cursor%skip_integers(bytes, 2, error)
      else if (.not. allocated(error)) then
        call skip_end_of_line(cursor)
      end if
      if (allocated(error)) return
      allocate (mesh%cell(reader%dim + 1, n), stat=status)
      if (status == 0) allocate (mesh%place(n), stat=status)
      if (status == 0) allocate (mesh%side(reader%dim, n), stat=status)
      if (status == 0) allocate (mesh%tag(n), stat=status)
      if (status /= 0) then
        call cursor%fail(to_text(n)//' elements are too many for the memory', error)
        return
      end if
    end associate
    if (reader%is_new) then
      call read_new_blocks(mesh, reader, blocks, n, error)
    else
      call read_old_elements(mesh, reader, n, error)
    end if
  end subroutine read_elements

  !> Read the blocks of elements of version 4.1.
  subroutine read_new_blocks(mesh, reader, blocks, n, error)
    !> Receives cells and sides.
    type(gmsh_mesh_t), intent(inout) :: mesh
    !> Numbers of the nodes, groups of the entities.
    type(reader_t), intent(inout) :: reader
    !> Number of blocks.
    integer, intent(in) :: blocks
    !> Number of elements of all blocks.
    integer, intent(in) :: n
    !> Bad numbers, unknown nodes, or cells that are no simplices.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: dim, entity, kind, tag
    integer :: b, i, m, done

    done = 0
    do b = 1, blocks
      associate (cursor => mesh%cursor)
        call cursor%get_integer(short_integer, dim, error)
        if (.not. allocated(error)) call cursor%get_integer(short_integer, entity, error)
        if (.not. allocated(error)) call cursor%get_integer(short_integer, kind, error)
        if (.not. allocated(error)) then
          call cursor%get_count(long_integer, 'elements', merge(16, 4, cursor%binary), m, error)
        end if
        if (.not. allocated(error)) then
          if (m > n - done) then
            call cursor%fail('a block of elements does not fit the count of elements', error)
          end if
        end if
      end associate
      if (allocated(error)) return
      tag = group_of(reader, dim, entity)
      do i = 1, m
        call mesh%cursor%skip_integers(long_integer, 1, error)
        if (.not. allocated(error)) then
          call mesh%add_element(reader, kind, tag, long_integer, error)
        end if
        if (allocated(error)) return
      end do
      done = done + m
    end do
    if (done < n) then
      call mesh%cursor%fail('the blocks have '//to_text(done)//' of '//to_text(n)//' elements', &
                            error)
    end if
  end subroutine read_new_blocks

  !> Tag of the elements of an entity: its physical group, or its own number.
  pure function group_of(reader, dim, entity) result(tag)
    !> The groups.
    type(reader_t), intent(in) :: reader
    !> Dimension of the entity.
    integer(lp), intent(in) :: dim
    !> Its number.
    integer(lp), intent(in) :: entity
    !> The tag.
    integer(lp) :: tag
    integer :: i

    tag = entity
    do i = 1, size(reader%entity, 2)
      if (reader%entity(1, i) == dim .and. reader%entity(2, i) == entity) then
        tag = reader%entity(3, i)
        return
      end if
    end do
  end function group_of

  !> Read the elements of version 2.
  subroutine read_old_elements(mesh, reader, n, error)
    !> Receives cells and sides.
    type(gmsh_mesh_t), intent(inout) :: mesh
    !> Numbers of the nodes.
    type(reader_t), intent(inout) :: reader
    !> Number of elements.
    integer, intent(in) :: n
    !> Bad numbers, unknown nodes, or cells that are no simplices.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: kind, tag
    integer :: done, in_block, tags, i

    done = 0
    do while (done < n)
      in_block = 1
      kind = 0
      tags = 0
      if (mesh%cursor%binary) call read_header(in_block)
      if (allocated(error)) return
      do i = 1, in_block
        call mesh%cursor%skip_integers(short_integer, 1, error)
        if (.not. (mesh%cursor%binary .or. allocated(error))) call read_header()
        if (.not. allocated(error)) call read_tags(mesh%cursor, tags, tag, error)
        if (.not. allocated(error)) then
          call mesh%add_element(reader, kind, tag, short_integer, error)
        end if
        if (allocated(error)) return
      end do
      done = done + in_block
    end do

  contains

    !> Read the type, in a binary file the number of elements that have it, and the number of tags.
    subroutine read_header(elements)
      !> Number of elements.
      integer, intent(out), optional :: elements

      call mesh%cursor%get_integer(short_integer, kind, error)
      if (present(elements)) then
        elements = 0
        if (.not. allocated(error)) then
          call mesh%cursor%get_count(short_integer, 'elements', 8, elements, error)
        end if
        if (.not. allocated(error) .and. (elements < 1 .or. elements > n - done)) then
          call mesh%cursor%fail('a block of elements does not fit the count of elements', error)
        end if
      end if
      if (allocated(error)) return
      call mesh%cursor%get_count(short_integer, 'tags', merge(4, 2, mesh%cursor%binary), tags, &
                                 error)
    end subroutine read_header

  end subroutine read_old_elements

  !> Read the tags of an element of version 2: physical group, entity, others.
  subroutine read_tags(cursor, n, tag, error)
    !> The file.
    type(gmsh_cursor_t), intent(inout) :: cursor
    !> Number of tags.
    integer, intent(in) :: n
    !> The group or, when that is 0, the entity.
    integer(lp), intent(out) :: tag
    !> Bad numbers.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: number
    integer :: i

    tag = 0
    do i = 1, n
      call cursor%get_integer(short_integer, number, error)
      if (allocated(error)) return
      if (i <= 2 .and. tag == 0) tag = abs(number)
    end do
  end subroutine read_tags

  !> Read the nodes of an element, and keep it when it is a cell or a side.
  subroutine add_element(self, reader, kind, tag, bytes, error)
    !> Receives cells and sides.
    class(gmsh_mesh_t), intent(inout) :: self
    !> Numbers of the nodes.
    type(reader_t), intent(inout) :: reader
    !> Type of the element.
    integer(lp), intent(in) :: kind
    !> Its tag.
    integer(lp), intent(in) :: tag
    !> Length of the numbers in a binary file.
    integer, intent(in) :: bytes
    !> Bad numbers, unknown nodes, or a cell that is no simplex.
    type(error_t), allocatable, intent(inout) :: error
    integer(lp) :: node, place
    integer :: number(27), i, dim

    place = self%cursor%place()
    if (kind < 1 .or. kind > size(nodes_of_type)) then
      call self%cursor%fail('elements of type '//to_text(kind)//' are not known', error)
      return
    end if
    dim = dim_of_type(kind)
    if (dim == reader%dim .and. kind /= simplex(dim)) then
      call self%cursor%fail('an element of type '//to_text(kind)//', which is no '// &
                            trim(merge('triangle   ', 'tetrahedron', dim == 2))//' with straight &
                            &edges', error, hint='make the mesh of first order and without &
                            &recombined elements')
      return
    end if
    do i = 1, nodes_of_type(kind)
      call self%cursor%get_integer(bytes, node, error)
      if (allocated(error)) return
      number(i) = 0
      if (node >= reader%first_tag .and. node <= reader%last_tag) then
        number(i) = reader%number(node - reader%first_tag + 1)
      end if
      if (number(i) > 0) cycle
      call self%cursor%fail('there is no node '//to_text(node), error)
      return
    end do
    if (dim == reader%dim) then
      reader%cells = reader%cells + 1
      self%cell(:, reader%cells) = number(:dim + 1)
      self%place(reader%cells) = place
    else if (kind == simplex(reader%dim - 1) .and. tag <= huge(1)) then
      reader%sides = reader%sides + 1
      self%side(:, reader%sides) = number(:reader%dim)
      self%tag(reader%sides) = int(tag)
    end if
  end subroutine add_element

end module mpm_gmsh_reader
