!> Frames with few fields of some of the points.
module mpm_slice_points_vtk
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_minimal_vtk, only: minimal_vtk_t
  use mpm_properties, only: properties_t
  use mpm_vtk_frames, only: add_vtk_properties
  implicit none
  private
  public :: slice_points_vtk_t

  !> Legacy VTK files of every so many points.
  type, extends(minimal_vtk_t) :: slice_points_vtk_t
  contains
    procedure, nopass :: describe => slice_points_vtk_describe
    procedure :: init => slice_points_vtk_init
  end type slice_points_vtk_t

contains

  !> Purpose and properties of the class.
  subroutine slice_points_vtk_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('serializer', 'SlicePointsVTK', &
                          'Frames as those of MinimalVTK with some of the points: one in every &
                          &stride points of the points file.', &
                          'VTK File Formats, www.vtk.org (legacy format, version 3.0, ASCII)', &
                          'serializer'//nl//'{'//nl//'    class = "SlicePointsVTK"'//nl// &
                          '    properties = {60}   # rate'//nl// &
                          '    int-properties = {10}   # stride'//nl// &
                          '    str-properties = {"output", "save", "two_blocks"}'//nl//'}')
    call description%add_integer('stride', 'points of the points file for each point in the &
                                 &frames', lower=1)
    call add_vtk_properties(description)
    call description%add_note('Of n points n/stride, rounded down, are written: the first, and &
                              &every one that is stride further on. A body with fewer than stride &
                              &points has none in its frames.')
    call description%add_note('Whether a point is active is its own affair (mpm_3d asks the point &
                              &whose number is that in the frame).')
  end subroutine slice_points_vtk_describe

  !> Set up from the properties; nothing is written.
  subroutine slice_points_vtk_init(self, properties, error)
    !> The serializer.
    class(slice_points_vtk_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The name of the folder is empty.
    type(error_t), allocatable, intent(out) :: error

    self%stride = properties%integer('stride')
    call self%minimal_vtk_t%init(properties, error)
  end subroutine slice_points_vtk_init

end module mpm_slice_points_vtk
