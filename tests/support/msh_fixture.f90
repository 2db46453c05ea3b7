!> Meshes of boxes in Gmsh files, version 2.2 and 4.1, as text and as bytes.
module mpm_msh_fixture
  use, intrinsic :: iso_fortran_env, only: int32, int64
  use mpm_kinds, only: wp
  use mpm_random_fixture, only: random_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: box_mesh, write_msh

  !> Corners of the six tetrahedra of a cube, bits x, y, z: one for each way from corner 0 to 7.
  integer, parameter :: ways(4, 6) = reshape([0, 1, 3, 7, 0, 1, 5, 7, 0, 2, 3, 7, 0, 2, 6, 7, &
                                              0, 4, 5, 7, 0, 4, 6, 7], [4, 6])

contains

  !> Cut a box into triangles or tetrahedra, n cells in each direction; inner nodes are moved.
  subroutine box_mesh(dim, n, lower, length, shake, x, cell, side, tag)
    !> Dimensions, 2 or 3.
    integer, intent(in) :: dim
    !> Cells in each direction.
    integer, intent(in) :: n
    !> Lower corner. [m]
    real(wp), intent(in) :: lower
    !> Length of all sides. [m]
    real(wp), intent(in) :: length
    !> Largest move of an inner node, in cells.
    real(wp), intent(in) :: shake
    !> Nodes. [m] (3, nodes)
    real(wp), allocatable, intent(out) :: x(:, :)
    !> Cells, nodes from 1. (dim + 1, cells)
    integer, allocatable, intent(out) :: cell(:, :)
    !> Sides on the lower (tag 7) and the upper (tag 8) face across the last direction.
    integer, allocatable, intent(out) :: side(:, :)
    !> Their tags.
    integer, allocatable, intent(out) :: tag(:)
    type(random_t) :: random
    integer :: at(3), last(3), i, j, k, c, w, m, s
    real(wp) :: move(3)

    last = [n, n, merge(n, 0, dim == 3)]
    allocate (x(3, product(last + 1)), cell(dim + 1, merge(2, 6, dim == 2)*n**dim))
    allocate (side(dim, 4*n**(dim - 1)), tag(4*n**(dim - 1)))
    x = 0.0_wp
    do k = 0, last(3)
      do j = 0, last(2)
        do i = 0, last(1)
          at = [i, j, k]
          call random%fill(-shake, shake, move)
          where (at == 0 .or. at == last) move = 0.0_wp
          m = 1 + i + (n + 1)*(j + (n + 1)*k)
          x(:dim, m) = lower + length*(real(at(:dim), wp) + move(:dim))/real(n, wp)
        end do
      end do
    end do
    c = 0
    s = 0
    do k = 0, max(0, last(3) - 1)
      do j = 0, n - 1
        do i = 0, n - 1
          do w = 1, merge(2, 6, dim == 2)
            c = c + 1
            if (dim == 3) then
              cell(:, c) = [(corner([i, j, k], ways(m, w)), m=1, 4)]
            else
              cell(:, c) = [corner([i, j, k], 0), corner([i, j, k], w), corner([i, j, k], 3)]
            end if
          end do
          if (dim == 2) then
            if (j == 0) call add([corner([i, j, k], 0), corner([i, j, k], 1)], 7)
            if (j == n - 1) call add([corner([i, j, k], 2), corner([i, j, k], 3)], 8)
          else
            if (k == 0) call add([(corner([i, j, k], m), m=0, 2)], 7)
            if (k == 0) call add([(corner([i, j, k], m), m=1, 3)], 7)
            if (k == n - 1) call add([(corner([i, j, k], m), m=4, 6)], 8)
            if (k == n - 1) call add([(corner([i, j, k], m), m=5, 7)], 8)
          end if
        end do
      end do
    end do
    side = side(:, :s)
    tag = tag(:s)

  contains

    !> Number of a corner of a cell.
    pure integer function corner(place, bits)
      !> The cell.
      integer, intent(in) :: place(3)
      !> Bits x, y, z.
      integer, intent(in) :: bits

      corner = 1 + place(1) + ibits(bits, 0, 1) + (n + 1)*(place(2) + ibits(bits, 1, 1) &
                                                           + (n + 1)*(place(3) + ibits(bits, 2, 1)))
    end function corner

    !> Append a side.
    subroutine add(nodes, number)
      !> Its nodes.
      integer, intent(in) :: nodes(:)
      !> Its tag.
      integer, intent(in) :: number

      s = s + 1
      side(:, s) = nodes
      tag(s) = number
    end subroutine add

  end subroutine box_mesh

  !> Write a mesh; tags of nodes are 10 more than their numbers.
  !!
  !! The groups of sides are those of the entities 101, 102 ... in version 4.1.
  subroutine write_msh(path, version, binary, x, cell, side, tag)
    !> The file.
    character(*), intent(in) :: path
    !> 2 or 4.
    integer, intent(in) :: version
    !> Numbers as bytes.
    logical, intent(in) :: binary
    !> Nodes. [m] (3, nodes)
    real(wp), intent(in) :: x(:, :)
    !> Cells, nodes from 1.
    integer, intent(in) :: cell(:, :)
    !> Sides.
    integer, intent(in) :: side(:, :)
    !> Their tags, ascending.
    integer, intent(in) :: tag(:)
    integer, parameter :: kinds(4) = [15, 1, 2, 4]
    integer :: unit, i, n, dim, first, groups

    dim = size(cell, 1) - 1
    n = size(x, 2)
    ! The tags are 7 and more.
    groups = maxval([6, tag]) - 6
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace')
    call line('$MeshFormat')
    call line(merge('2.2', '4.1', version == 2)//merge(' 1', ' 0', binary)//' 8')
    if (binary) write (unit) 1_int32
    if (binary) call line('')
    call line('$EndMeshFormat')
    call line('$Comments')
    call line('a mesh of a box')
    call line('$EndComments')
    if (version == 4) call put_entities()
    call line('$Nodes')
    if (version == 2) then
      call line(to_text(n))
    else
      call long([1, n, 11, n + 10])
      call short([dim, 1, 0])
      call long([n])
      do i = 1, n
        call long([i + 10])
      end do
    end if
    do i = 1, n
      if (version == 2) call short([i + 10], open_line=.true.)
      if (binary) then
        write (unit) x(:, i)
      else
        call line(to_text(x(1, i), 17)//' '//to_text(x(2, i), 17)//' '//to_text(x(3, i), 17))
      end if
    end do
    if (binary) call line('')
    call line('$EndNodes')
    call line('$Elements')
    if (version == 2) then
      call line(to_text(size(cell, 2) + size(tag) + 1))
      if (binary) call short([15, 1, 2])
      call put_old(1, 15, 0, [1])
      if (binary .and. size(tag) > 0) call short([kinds(dim), size(tag), 2])
      do i = 1, size(tag)
        call put_old(i + 1, kinds(dim), tag(i), side(:, i))
      end do
      if (binary) call short([kinds(dim + 1), size(cell, 2), 2])
      do i = 1, size(cell, 2)
        call put_old(i + 1 + size(tag), kinds(dim + 1), 1, cell(:, i))
      end do
    else
      call long([2 + groups, size(cell, 2) + size(tag) + 1, 1, size(cell, 2) + size(tag) + 1])
      call put_new(0, 1, 15, 0, reshape([1], [1, 1]))
      first = 1
      do i = 1, groups
        associate (m => count(tag == 6 + i))
          call put_new(dim - 1, 100 + i, kinds(dim), first, side(:, first:first + m - 1))
          first = first + m
        end associate
      end do
      call put_new(dim, 1, kinds(dim + 1), first, cell)
    end if
    if (binary) call line('')
    call line('$EndElements')
    close (unit)

  contains

    !> The entities of the sides, with their groups, and one without.
    subroutine put_entities()
      integer :: d, g

      call line('$Entities')
      call long([1, merge(groups, 0, dim == 2), merge(groups, 1, dim == 3), &
                 merge(1, 0, dim == 3)])
      call put_entity(0, 1, 0)
      do d = 1, dim
        if (d == dim - 1) then
          do g = 1, groups
            call put_entity(d, 100 + g, 6 + g)
          end do
        else if (d == dim) then
          call put_entity(d, 1, 0)
        end if
      end do
      if (binary) call line('')
      call line('$EndEntities')
    end subroutine put_entities

    !> One entity.
    subroutine put_entity(d, number, group)
      !> Dimension.
      integer, intent(in) :: d
      !> Its number.
      integer, intent(in) :: number
      !> Its group, or 0.
      integer, intent(in) :: group
      integer :: r

      call short([number], open_line=.true.)
      do r = 1, merge(3, 6, d == 0)
        if (binary) write (unit) 0.5_wp
        if (.not. binary) write (unit) '0.5 '
      end do
      call long([merge(1, 0, group > 0)])
      if (group > 0) call short([group])
      if (d > 0) call long([2])
      if (d > 0) call short([3, -4])
    end subroutine put_entity

    !> An element of version 2.
    subroutine put_old(number, kind, group, nodes)
      !> Its number.
      integer, intent(in) :: number
      !> Its type.
      integer, intent(in) :: kind
      !> Its physical group.
      integer, intent(in) :: group
      !> Its nodes.
      integer, intent(in) :: nodes(:)

      if (binary) then
        call short([number, group, 55, nodes + 10])
      else
        call short([number, kind, 2, group, 55, nodes + 10])
      end if
    end subroutine put_old

    !> A block of elements of version 4.
    subroutine put_new(d, entity, kind, before, nodes)
      !> Dimension.
      integer, intent(in) :: d
      !> Its entity.
      integer, intent(in) :: entity
      !> Type of the elements.
      integer, intent(in) :: kind
      !> Number of elements before.
      integer, intent(in) :: before
      !> Nodes. (any, elements)
      integer, intent(in) :: nodes(:, :)
      integer :: e

      call short([d, entity, kind])
      call long([size(nodes, 2)])
      do e = 1, size(nodes, 2)
        call long([before + e, nodes(:, e) + 10])
      end do
    end subroutine put_new

    !> Write a line.
    subroutine line(text)
      !> The line.
      character(*), intent(in) :: text

      write (unit) text//new_line('a')
    end subroutine line

    !> Write integers of 4 bytes, or a line of them.
    subroutine short(numbers, open_line)
      !> The numbers.
      integer, intent(in) :: numbers(:)
      !> More follow in the line.
      logical, intent(in), optional :: open_line
      integer :: k

      if (binary) then
        write (unit) int(numbers, int32)
        return
      end if
      do k = 1, size(numbers)
        write (unit) to_text(numbers(k))//' '
      end do
      if (present(open_line)) return
      write (unit) new_line('a')
    end subroutine short

    !> Write integers of 8 bytes, or a line of them.
    subroutine long(numbers)
      !> The numbers.
      integer, intent(in) :: numbers(:)

      if (binary) then
        write (unit) int(numbers, int64)
      else
        call short(numbers)
      end if
    end subroutine long

  end subroutine write_msh

end module mpm_msh_fixture
