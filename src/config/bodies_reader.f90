!> One section `body` of a config.
module mpm_bodies_reader
  use mpm_body, only: body_t
  use mpm_body_registry, only: create_body
  use mpm_boundary_registry, only: create_boundary
  use mpm_description, only: description_t
  use mpm_document, only: section_t, value_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_material_registry, only: create_material
  use mpm_nodes_registry, only: create_nodes
  use mpm_object_reader, only: class_of, lacks, properties_of
  use mpm_points_registry, only: create_points
  use mpm_properties, only: properties_t
  use mpm_section_reader, only: single_value
  use mpm_store, only: store_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: read_body

  !> Keys of a body.
  character(18), parameter :: body_keys(22) = &
    [character(18) :: 'class', 'name', 'point-file', 'properties', 'int-properties', &
     'str-properties', 'point-class', 'point-props', 'point-int-props', 'point-str-props', &
     'node-class', 'node-props', 'node-int-props', 'node-str-props', 'material-class', &
     'material-props', 'material-int-props', 'material-str-props', 'boundary-class', &
     'boundary-props', 'boundary-int-props', 'boundary-str-props']

contains

  !> Set up a body and its parts: points, nodes, material, boundary, then the body itself.
  subroutine read_body(section, file, id, grid, memory_room, body, error, store)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> Number of the body, from 0.
    integer, intent(in) :: id
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Bytes that its points may take.
    integer(lp), intent(in) :: memory_room
    !> The body.
    class(body_t), allocatable, intent(out) :: body
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    !> A checkpoint with points for all bodies.
    class(store_t), intent(inout), optional :: store
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class

    call class_of(section, file, 'class', body_keys, class, error)
    if (allocated(error)) return
    call create_body(class%text, body, error)
    if (lacks(error, class)) return
    body%id = id
    call read_name(section, file, body%name, error)
    if (allocated(error)) return
    call read_points(section, file, grid, memory_room, body, error, store)
    if (allocated(error)) return
    call read_nodes(section, file, grid, body, error)
    if (allocated(error)) return
    call read_material(section, file, grid, body, error)
    if (allocated(error)) return
    call read_boundary(section, file, grid, body, error)
    if (allocated(error)) return
    call body%describe(description)
    call properties_of(section, '', 'properties', description, grid%kin%sim_type, class, &
                       properties, error)
    if (allocated(error)) return
    call body%init(grid, properties, error)
    if (lacks(error, class)) return
  end subroutine read_body

  !> The name of a body, which becomes part of file names.
  subroutine read_name(section, file, name, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The name.
    character(:), allocatable, intent(out) :: name
    !> No name, or one that can't be part of a file name.
    type(error_t), allocatable, intent(out) :: error
    type(value_t) :: value
    logical :: found

    call single_value(section, file, 'name', value, found, error)
    if (allocated(error)) return
    name = value%text
    if (.not. found) then
      call raise(error, err_input, 'a body needs a "name"', file, section%line, &
                 'frames and contacts know it by its name: name = "block_0"')
    else if (scan(name, '/') > 0 .or. len(name) > 200) then
      call raise(error, err_input, 'the name of a body becomes part of file names', value%file, &
                 value%line, 'use at most 200 characters and no "/"')
    end if
  end subroutine read_name

  !> The points of a body.
  subroutine read_points(section, file, grid, memory_room, body, error, store)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Bytes that the points may take.
    integer(lp), intent(in) :: memory_room
    !> The body.
    class(body_t), intent(inout) :: body
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    !> A checkpoint with points for all bodies.
    class(store_t), intent(inout), optional :: store
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class, point_file
    logical :: found

    call class_of(section, file, 'point-class', body_keys, class, error)
    if (allocated(error)) return
    call create_points(class%text, body%points, error)
    if (lacks(error, class)) return
    body%points%memory_room = memory_room
    call body%points%describe(description)
    call properties_of(section, 'point-', 'props', description, grid%kin%sim_type, class, &
                       properties, error)
    if (allocated(error)) return
    call single_value(section, file, 'point-file', point_file, found, error)
    if (allocated(error)) return
    if (present(store)) then
      call store%enter('body_'//to_text(body%id))
      call store%enter('points')
      call body%points%keep(grid%kin, store, error)
      call store%leave()
      call store%leave()
      if (lacks(error, class)) return
    end if
    call body%points%init(grid, properties, point_file, file, error)
    if (lacks(error, class)) return
  end subroutine read_points

  !> The nodes of a body.
  subroutine read_nodes(section, file, grid, body, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The body.
    class(body_t), intent(inout) :: body
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class

    call class_of(section, file, 'node-class', body_keys, class, error)
    if (allocated(error)) return
    call create_nodes(class%text, body%nodes, error)
    if (lacks(error, class)) return
    call body%nodes%describe(description)
    call properties_of(section, 'node-', 'props', description, grid%kin%sim_type, class, &
                       properties, error)
    if (allocated(error)) return
    call body%nodes%init(grid%kin, properties, error)
    if (lacks(error, class)) return
  end subroutine read_nodes

  !> The material of a body, if it has one.
  subroutine read_material(section, file, grid, body, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The body.
    class(body_t), intent(inout) :: body
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class
    integer(lp) :: bytes

    call optional_class(section, file, 'material', class, error)
    if (allocated(error) .or. len(class%text) == 0) return
    call create_material(class%text, body%material, error)
    if (lacks(error, class)) return
    call body%material%describe(description)
    call properties_of(section, 'material-', 'props', description, grid%kin%sim_type, class, &
                       properties, error)
    if (allocated(error)) return
    call body%material%init(grid%kin, properties, error)
    if (lacks(error, class)) return
    associate (points => body%points)
      bytes = points%memory() + body%material%n_history*int(storage_size(1.0_wp)/8, lp)*points%n
      if (bytes > points%memory_room) then
        call points%claim(int(points%n, lp), bytes/points%n, error)
        if (lacks(error, class)) return
      end if
      deallocate (points%history)
      allocate (points%history(body%material%n_history, points%n))
      call body%material%start(points%n, points%x, points%mass, points%volume, points%history)
      call body%material%prepare(points)
    end associate
  end subroutine read_material

  !> The boundary of a body, if it has one.
  subroutine read_boundary(section, file, grid, body, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The body.
    class(body_t), intent(inout) :: body
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class

    call optional_class(section, file, 'boundary', class, error)
    if (allocated(error) .or. len(class%text) == 0) return
    call create_boundary(class%text, body%boundary, error)
    if (lacks(error, class)) return
    call body%boundary%describe(description)
    call properties_of(section, 'boundary-', 'props', description, grid%kin%sim_type, class, &
                       properties, error)
    if (allocated(error)) return
    call body%boundary%init(grid, body%points, properties, error)
    if (lacks(error, class)) return
  end subroutine read_boundary

  !> The class of a part that a body need not have.
  subroutine optional_class(section, file, part, class, error)
    !> The section.
    type(section_t), intent(in) :: section
    !> The config.
    character(*), intent(in) :: file
    !> `material` or `boundary`.
    character(*), intent(in) :: part
    !> The class name; empty when the body has no such part.
    type(value_t), intent(out) :: class
    !> Properties of a part that is not there.
    type(error_t), allocatable, intent(out) :: error
    character(10), parameter :: endings(3) = [character(10) :: '-props', '-int-props', '-str-props']
    logical :: found
    integer :: i, e

    call single_value(section, file, part//'-class', class, found, error)
    if (allocated(error) .or. found) return
    do i = 1, size(endings)
      e = section%find(part//trim(endings(i)))
      if (e == 0) cycle
      if (size(section%entries(e)%values) == 0) cycle
      call raise(error, err_input, '"'//section%entries(e)%key//'" without "'//part//'-class"', &
                 file, section%entries(e)%line, 'name the class: '//part//'-class = "..."')
      return
    end do
  end subroutine optional_class

end module mpm_bodies_reader
