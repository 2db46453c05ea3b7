!> What the serializers of legacy VTK files share: names, titles, whole frames.
module mpm_vtk_frames
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_exact_number, only: exact_text
  use mpm_field_writer, only: field_writer_t
  use mpm_file_system, only: delete_leftovers
  use mpm_files, only: delete_file, join_path, make_directories
  use mpm_kinds, only: lp, wp
  use mpm_memory, only: memory_left, size_text, way_to_more
  use mpm_model, only: model_t
  use mpm_number_text, only: default_digits
  use mpm_properties, only: properties_t
  use mpm_serializer, only: add_save_properties, serializer_t
  use mpm_strings, only: string_t, to_text
  use mpm_text_writer, only: text_writer_t
  use mpm_vtk_corners, only: write_corners
  use mpm_vtk_node_fields, only: vtk_node_fields_t
  use mpm_vtk_point_fields, only: vtk_point_fields_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: add_vtk_properties, vtk_frames_t

  !> Longest run name in a title, so that readers, which take 255 characters, see all of the title.
  integer, parameter :: max_run_name = 160

  !> Bytes of a node in the shortest frame: position, cell, cell type and fields of zeros.
  integer(lp), parameter :: least_node_bytes = 50

  !> A point file and a node file for each body and frame.
  type, abstract, extends(serializer_t) :: vtk_frames_t
    private
    !> Points of the points file for each point in the frames.
    integer, public :: stride = 1
    !> Folder of the frames.
    character(:), allocatable :: folder
    !> Name of the run in titles; may be empty.
    character(:), allocatable :: run_name
    !> Significant digits.
    integer :: digits = default_digits
    !> Numbers as bytes instead of text.
    logical :: binary = .false.
    !> Whether there are files of the nodes.
    logical :: with_nodes = .true.
  contains
    procedure :: init => vtk_frames_init
    procedure :: check => vtk_frames_check
    procedure :: open => vtk_frames_open
    procedure :: write_frame => vtk_frames_write_frame
    procedure :: destination => vtk_frames_destination
    !> Send the fields of the points of an active body.
    procedure(send_point_fields_i), deferred :: send_point_fields
    !> Send the fields of the nodes of a body.
    procedure(send_node_fields_i), deferred :: send_node_fields
    procedure, private :: write_points
    procedure, private :: write_nodes
    procedure, private :: path
    procedure, private :: corner_path
    procedure, private :: file_name
    procedure, private :: title
  end type vtk_frames_t

  abstract interface
    !> Send the fields of the points of an active body that has points.
    subroutine send_point_fields_i(self, body, writer)
      import :: body_t, field_writer_t, vtk_frames_t
      implicit none
      !> The serializer.
      class(vtk_frames_t), intent(in) :: self
      !> The body.
      class(body_t), intent(in) :: body
      !> Receiver of point fields.
      class(field_writer_t), intent(inout) :: writer
    end subroutine send_point_fields_i

    !> Send the fields of the nodes of a body, active or not.
    subroutine send_node_fields_i(self, model, body, writer)
      import :: body_t, field_writer_t, model_t, vtk_frames_t
      implicit none
      !> The serializer.
      class(vtk_frames_t), intent(in) :: self
      !> The state.
      type(model_t), intent(in) :: model
      !> The body.
      class(body_t), intent(in) :: body
      !> Receiver of nodal fields.
      class(field_writer_t), intent(inout) :: writer
    end subroutine send_node_fields_i
  end interface

contains

  !> Describe the properties and remarks that these serializers have in common.
  subroutine add_vtk_properties(description, with_rate)
    !> The description, started.
    type(description_t), intent(inout) :: description
    !> Describe the rate as well; true when left out.
    logical, intent(in), optional :: with_rate
    logical :: has_rate

    has_rate = .false.
    if (present(with_rate)) has_rate = .not. with_rate
    if (.not. has_rate) then
      call description%add_real('rate', '1/s', 'frames per unit of time; 0 writes the first only', &
                                lower=0.0_wp)
    end if
    call description%add_integer('digits', 'significant digits of the numbers', &
                                 default=default_digits, lower=9, upper=17)
    call description%add_integer('binary', '1: binary files, with the numbers in full; 0: text', &
                                 default=0, lower=0, upper=1)
    call description%add_integer('nodes', '1: a file of the nodes of the whole grid with each &
                                 &frame; 0: none', default=1, lower=0, upper=1)
    call description%add_string('frame_folder', 'folder of the frames, relative to the working &
                                &directory; made when missing')
    call description%add_string('save_folder', 'folder of checkpoints, relative to the working &
                                &directory; made when needed; empty: no checkpoints')
    call description%add_string('run_name', 'name of the run, for the title line of the files and &
                                &the names of checkpoints; may be empty')
    call add_save_properties(description)
    call description%add_note('A frame is two files a body: fpd.<id>.<name>.<frame>.vtk has its &
                              &points, in the order of the points file, &
                              &fnd.<id>.<name>.<frame>.vtk the whole grid, 0 where the body has no &
                              &node. A / in a name becomes _.')
    call description%add_note('<frame_folder>/<run_name>.run.txt says which program, config and &
                              &points the frames come from, which mpm3d --describe-run prints for &
                              &a frame. The frames are bytes of the state alone.')
    call description%add_note('binary = 1 writes bytes, highest first, and 4-byte integers, as the &
                              &format has it; digits has no effect then.')
    call description%add_note('A frame labelled t holds the state at t; frame 0 is the initial &
                              &state (mpm_3d: the state after the first step). Both files have the &
                              &same frame number in their title.')
    call description%add_note('A value that is not finite stops the run (mpm_3d: written as 0). &
                              &Points that are inactive or have left the grid keep their last &
                              &state (mpm_3d: all 0).')
  end subroutine add_vtk_properties

  !> Set up from the properties; nothing is written.
  subroutine vtk_frames_init(self, properties, error)
    !> The serializer.
    class(vtk_frames_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The name of the folder is empty.
    type(error_t), allocatable, intent(out) :: error

    self%rate = properties%real('rate')
    call self%init_saving(properties)
    self%digits = properties%integer('digits')
    self%binary = properties%integer('binary') == 1
    self%with_nodes = properties%integer('nodes') == 1
    self%folder = properties%string('frame_folder')
    self%run_name = one_line(properties%string('run_name'))
    if (len_trim(self%folder) == 0) then
      call properties%reject('frame_folder', 'the name of the frame folder is empty', error, &
                             'write "." for the working directory')
    end if
  end subroutine vtk_frames_init

  !> Refuse a grid whose node frames could not be read back on this machine.
  subroutine vtk_frames_check(self, model, error)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> More text in a frame than the machine has memory.
    type(error_t), allocatable, intent(out) :: error
    type(window_t) :: whole
    integer(lp) :: n_bytes

    if (.not. self%with_nodes) return
    whole = model%grid%whole()
    n_bytes = least_node_bytes*whole%size()
    if (n_bytes <= memory_left(model%memory_limit, 0_lp)) return
    call raise(error, err_input, 'the grid has '//to_text(whole%size())//' nodes, whose frames &
               &would take more than '//to_text(real(n_bytes, wp)/1.0e9_wp, 3)// &
               ' GB each, more than the memory of this machine', hint='use larger cells, or nodes &
               &= 0 for frames without the nodes of the whole grid')
  end subroutine vtk_frames_check

  !> Make the folder, and see that every file can be written.
  subroutine vtk_frames_open(self, model, error)
    !> The serializer.
    class(vtk_frames_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(inout) :: model
    !> The folder can't be made or written to.
    type(error_t), allocatable, intent(out) :: error
    type(text_writer_t) :: trial
    integer :: i

    call make_directories(self%folder, error)
    if (allocated(error)) return
    call delete_leftovers(self%folder, 'fpd.')
    call delete_leftovers(self%folder, 'fnd.')
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        call trial%open(self%path('fpd', body), error)
        call trial%discard()
        if (allocated(error)) return
        if (.not. allocated(body%points)) cycle
        if (has_corners(body)) then
          call make_directories(body%points%domains%folder, error)
          if (allocated(error)) return
          call trial%open(self%corner_path(body), error)
          call trial%discard()
          if (allocated(error)) return
        end if
      end associate
    end do
  end subroutine vtk_frames_open

  !> Write the state as the next frame; upon failure none of its files stays.
  subroutine vtk_frames_write_frame(self, model, error)
    !> The serializer.
    class(vtk_frames_t), intent(inout) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    type(string_t) :: paths(3*size(model%bodies))
    integer(lp) :: n_bytes, total
    integer :: i, k, n_written

    n_written = 0
    total = 0
    do i = 1, size(model%bodies)
      do k = 1, 3
        if (k == 2 .and. .not. self%with_nodes) cycle
        associate (body => model%bodies(i)%body, file => paths(n_written + 1))
          if (k == 1) then
            file%text = self%path('fpd', body)
            call self%write_points(model, body, file%text, error)
          else if (k == 2) then
            file%text = self%path('fnd', body)
            call self%write_nodes(model, body, file%text, error)
          else
            if (.not. has_corners(body)) cycle
            file%text = self%corner_path(body)
            call write_corners(body%points, file%text, self%title(model), self%digits, error)
          end if
          if (allocated(error)) exit
          inquire (file=file%text, size=n_bytes)
        end associate
        total = total + n_bytes
        n_written = n_written + 1
      end do
      if (allocated(error)) exit
    end do
    if (allocated(error)) then
      do i = 1, n_written
        call delete_file(paths(i)%text, ignored)
      end do
      return
    end if
    self%bytes = self%bytes + total
    self%frames = self%frames + 1
  end subroutine vtk_frames_write_frame

  !> Write the point file of a body.
  subroutine write_points(self, model, body, path, error)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Name of the file.
    character(*), intent(in) :: path
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    type(vtk_point_fields_t) :: fields

    call fields%open(body, path, self%title(model), self%digits, &
                     when(self%frames, model%time), error, self%binary, self%stride)
    if (allocated(error)) return
    if (body%active .and. allocated(body%points)) call self%send_point_fields(body, fields)
    call fields%commit(error)
  end subroutine write_points

  !> Write the node file of a body.
  subroutine write_nodes(self, model, body, path, error)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Name of the file.
    character(*), intent(in) :: path
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    type(vtk_node_fields_t) :: fields

    call fields%open(model%grid, body, path, self%title(model), self%digits, &
                     when(self%frames, model%time), error, self%binary)
    if (allocated(error)) return
    call self%send_node_fields(model, body, fields)
    call fields%commit(error)
  end subroutine write_nodes

  !> Whether the corners of the domains of a body's points are written.
  pure function has_corners(body)
    !> The body.
    class(body_t), intent(in) :: body
    !> Whether they are.
    logical :: has_corners

    has_corners = .false.
    if (.not. allocated(body%points)) return
    if (.not. allocated(body%points%domains)) return
    has_corners = allocated(body%points%domains%folder)
  end function has_corners

  !> Name of the file of corners of the next frame.
  function corner_path(self, body) result(path)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> The body, whose points have a folder for corners.
    class(body_t), intent(in) :: body
    !> The path.
    character(:), allocatable :: path

    path = join_path(body%points%domains%folder, self%file_name('fpd', body, '.corners'))
  end function corner_path

  !> Path of a file of the next frame.
  function path(self, prefix, body)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> `fpd` or `fnd`.
    character(*), intent(in) :: prefix
    !> The body.
    class(body_t), intent(in) :: body
    !> The path.
    character(:), allocatable :: path

    path = join_path(self%folder, self%file_name(prefix, body, ''))
  end function path

  !> Name of a file of the next frame.
  function file_name(self, prefix, body, kind)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> `fpd` or `fnd`.
    character(*), intent(in) :: prefix
    !> The body.
    class(body_t), intent(in) :: body
    !> What stands between the name of the body and the number of the frame.
    character(*), intent(in) :: kind
    !> The name.
    character(:), allocatable :: file_name
    character(:), allocatable :: name
    character(10) :: number
    integer :: i

    name = body%name
    do i = 1, len(name)
      if (name(i:i) == '/') name(i:i) = '_'
    end do
    write (number, '(i10.10)') self%frames
    file_name = prefix//'.'//to_text(body%id)//'.'//name//kind//'.'//number//'.vtk'
  end function file_name

  !> Title line of the next frame.
  function title(self, model)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> `mpm3d run: Frame 3, Time 0.1`.
    character(:), allocatable :: title

    title = 'mpm3d'
    if (len(self%run_name) > 0) title = title//' '//self%run_name
    title = title//': Frame '//to_text(self%frames)//', Time '//exact_text(model%time)
  end function title

  !> Frame and time for messages.
  pure function when(frame, time)
    !> Number of the frame.
    integer, intent(in) :: frame
    !> Its time. [s]
    real(wp), intent(in) :: time
    !> `frame 3, t = 0.1 s`.
    character(:), allocatable :: when

    when = 'frame '//to_text(frame)//', t = '//to_text(time)//' s'
  end function when

  !> A name for the title line: without line ends, not too long.
  pure function one_line(text) result(line)
    !> Any text.
    character(*), intent(in) :: text
    !> The same with blanks for control characters.
    character(:), allocatable :: line
    integer :: i

    line = trim(text(:min(len(text), max_run_name)))
    do i = 1, len(line)
      if (iachar(line(i:i)) < iachar(' ')) line(i:i) = ' '
    end do
  end function one_line

  !> Where the frames go.
  function vtk_frames_destination(self) result(text)
    !> The serializer.
    class(vtk_frames_t), intent(in) :: self
    !> The folder.
    character(:), allocatable :: text

    text = self%folder
  end function vtk_frames_destination

end module mpm_vtk_frames
