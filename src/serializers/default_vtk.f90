!> Frames with all fields of all objects.
module mpm_default_vtk
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_field_writer, only: field_writer_t
  use mpm_model, only: model_t
  use mpm_vtk_frames, only: add_vtk_properties, vtk_frames_t
  implicit none
  private
  public :: default_vtk_t, send_all_node_fields

  !> Legacy VTK files with every field that an object has to offer.
  type, extends(vtk_frames_t) :: default_vtk_t
  contains
    procedure, nopass :: describe => default_vtk_describe
    procedure :: send_point_fields => default_vtk_send_point_fields
    procedure :: send_node_fields => default_vtk_send_node_fields
  end type default_vtk_t

contains

  !> Purpose and properties of the class.
  subroutine default_vtk_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('serializer', 'DefaultVTK', &
                          'Frames with all fields of points, nodes, boundaries and contacts, as &
                          &legacy VTK files.', &
                          'VTK File Formats, www.vtk.org (legacy format, version 3.0, ASCII)', &
                          'serializer'//nl//'{'//nl//'    class = "DefaultVTK"'//nl// &
                          '    properties = {60}   # rate'//nl// &
                          '    str-properties = {"output", "save", "two_blocks"}'//nl//'}')
    call add_vtk_properties(description)
    call description%add_note('The files of a body that is not active hold positions and the &
                              &fields of contacts.')
  end subroutine default_vtk_describe

  !> Send all fields of the points.
  subroutine default_vtk_send_point_fields(self, body, writer)
    !> The serializer.
    class(default_vtk_t), intent(in) :: self
    !> The body.
    class(body_t), intent(in) :: body
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => self)
    end associate
    call body%points%write_fields(writer)
    if (allocated(body%material)) then
      associate (points => body%points)
        call body%material%write_fields(points%n, points%mass, points%volume, points%stress, &
                                        points%history, writer)
      end associate
    end if
  end subroutine default_vtk_send_point_fields

  !> Send all fields of the nodes, the boundary and the contacts.
  subroutine default_vtk_send_node_fields(self, model, body, writer)
    !> The serializer.
    class(default_vtk_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => self)
    end associate
    call send_all_node_fields(model, body, writer)
  end subroutine default_vtk_send_node_fields

  !> Send all fields of the nodes of a body, its boundary and the contacts.
  subroutine send_all_node_fields(model, body, writer)
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    integer :: i

    if (body%active .and. allocated(body%nodes)) then
      associate (window => body%nodes%window)
        call model%grid%write_velocity(window, body%nodes%velocity(:, :window%size()), writer)
      end associate
      call body%nodes%write_fields(model%last_dt, writer)
      if (allocated(body%boundary)) then
        call body%boundary%write_fields(model%grid, body%nodes, writer)
      end if
      call model%grid%write_fields(writer)
      if (allocated(body%points)) call body%points%write_node_fields(writer)
    end if
    if (.not. allocated(model%contacts)) return
    do i = 1, size(model%contacts)
      call model%contacts(i)%contact%write_fields(model%bodies, writer)
    end do
  end subroutine send_all_node_fields

end module mpm_default_vtk
