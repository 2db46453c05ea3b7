!> Frames with the few fields that most pictures need.
module mpm_minimal_vtk
  use mpm_body, only: body_t
  use mpm_corotation, only: invariants
  use mpm_description, only: description_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_points, only: points_t
  use mpm_vtk_frames, only: add_vtk_properties, vtk_frames_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: minimal_vtk_t

  !> Legacy VTK files with motion, stress and strain rate as scalars, and density.
  type, extends(vtk_frames_t) :: minimal_vtk_t
  contains
    procedure, nopass :: describe => minimal_vtk_describe
    procedure :: ask => minimal_vtk_ask
    procedure :: send_point_fields => minimal_vtk_send_point_fields
    procedure :: send_node_fields => minimal_vtk_send_node_fields
  end type minimal_vtk_t

contains

  !> Purpose and properties of the class.
  subroutine minimal_vtk_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('serializer', 'MinimalVTK', &
                          'Frames with few fields, as legacy VTK files: velocity, displacement, &
                          &pressure, tau_bar, gamma_dot and density of points, velocity and &
                          &density of nodes.', &
                          'VTK File Formats, www.vtk.org (legacy format, version 3.0, ASCII)', &
                          'serializer'//nl//'{'//nl//'    class = "MinimalVTK"'//nl// &
                          '    properties = {60}   # rate'//nl// &
                          '    str-properties = {"output", "save", "two_blocks"}'//nl//'}')
    call add_vtk_properties(description)
    call description%add_note('pressure = -tr T/3; tau_bar = |T - (tr T/3) I|/sqrt(2); gamma_dot = &
                              &sqrt(2) |sym L - (tr L/3) I|; density = m/V.')
    call description%add_note('The density of a node is m_i/V_i, V_i being the integral of its &
                              &function over the grid: in TYPE 4 that is r times the density, as &
                              &V_i is an area of the meridian plane.')
  end subroutine minimal_vtk_describe

  !> Ask points to keep their shear rates in steps that end with a frame.
  subroutine minimal_vtk_ask(self, points)
    !> The serializer.
    class(minimal_vtk_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points

    associate (unused => self)
    end associate
    if (.not. allocated(points%shear_rate)) allocate (points%shear_rate(points%n), source=0.0_wp)
  end subroutine minimal_vtk_ask

  !> Send velocity, displacement, pressure, tau_bar, gamma_dot and density.
  subroutine minimal_vtk_send_point_fields(self, body, writer)
    !> The serializer.
    class(minimal_vtk_t), intent(in) :: self
    !> The body.
    class(body_t), intent(in) :: body
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: values(:), pressure(:)

    associate (unused => self)
    end associate
    associate (points => body%points)
      allocate (values(points%n), pressure(points%n))
      call writer%vector('velocity', points%velocity)
      call writer%vector('displacement', points%displacement)
      call invariants(points%kin%nstress, points%n, points%stress, pressure, values)
      call writer%scalar('pressure', pressure)
      call writer%scalar('tau_bar', values)
      values = 0.0_wp
      if (allocated(points%shear_rate)) values = points%shear_rate
      call writer%scalar('gamma_dot', values)
      values = 0.0_wp
      ! Points in reserve have neither.
      where (points%volume > 0.0_wp) values = points%mass/points%volume
      call writer%scalar('density', values)
    end associate
  end subroutine minimal_vtk_send_point_fields

  !> Send velocity and density of the nodes of an active body.
  subroutine minimal_vtk_send_node_fields(self, model, body, writer)
    !> The serializer.
    class(minimal_vtk_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: density(:)
    integer :: nn

    associate (unused => self)
    end associate
    if (.not. (body%active .and. allocated(body%nodes))) return
    nn = body%nodes%window%size()
    allocate (density(nn))
    call node_density(model%grid, body%nodes%window, body%nodes%mass(:nn), density)
    call writer%vector('velocity', body%nodes%velocity(:, :nn), body%nodes%window)
    call writer%scalar('density', density, body%nodes%window)
  end subroutine minimal_vtk_send_node_fields

  !> Nodal masses over nodal volumes; 0 at a node without volume.
  subroutine node_density(grid, window, mass, density)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The nodes.
    type(window_t), intent(in) :: window
    !> Their masses. [kg] (nn)
    real(wp), intent(in) :: mass(:)
    !> Their densities. [kg/m3] (nn)
    real(wp), intent(out) :: density(:)
    real(wp) :: volume
    integer :: i, j, k, n, hi(3)

    hi = window%hi()
    n = 0
    do k = window%lo(3), hi(3)
      do j = window%lo(2), hi(2)
        do i = window%lo(1), hi(1)
          n = n + 1
          volume = grid%node_volume([i, j, k])
          density(n) = 0.0_wp
          if (volume > 0.0_wp) density(n) = mass(n)/volume
        end do
      end do
    end do
  end subroutine node_density

end module mpm_minimal_vtk
