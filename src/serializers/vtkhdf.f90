!> Frames in one HDF5 file a body, which viewers open as a series in time.
module mpm_vtkhdf
  use mpm_body, only: body_t
  use mpm_build_info, only: compiler, revision, version
  use mpm_default_vtk, only: send_all_node_fields
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, err_io, error_t, raise
  use mpm_field_names, only: field_names_t
  use mpm_file_system, only: copy_file, delete_leftovers, exchange_files, file_size, reserve_space
  use mpm_files, only: delete_file, file_exists, join_path, make_directories, process_id, &
                       rename_file
  use mpm_grid, only: grid_t
  use mpm_hdf5_fields, only: chunk_length, hdf5_fields_t
  use mpm_hdf5_file, only: hdf5_file_t
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_serializer, only: add_save_properties, serializer_ask, serializer_name_run, serializer_t
  use mpm_strings, only: nearest_name, string_t, to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: vtkhdf_t

  !> Kinds of cells of PolyData, in the order of their offsets.
  character(8), parameter :: topologies(4) = &
    [character(8) :: 'Vertices', 'Lines', 'Polygons', 'Strips']

  !> A temporal VTKHDF file of the points of each body, and one of its nodes when asked.
  type, extends(serializer_t) :: vtkhdf_t
    private
    !> Folder of the files.
    character(:), allocatable :: folder
    !> Level of compression.
    integer :: deflate = 0
    !> Whether nodes are written, too.
    logical :: with_nodes = .false.
    !> Whether each file has a spare one, so that one of them is whole at each instant.
    logical :: with_spare = .true.
    !> Fields to write; none for all.
    type(string_t), allocatable :: fields(:)
    !> Components of a point or node in a frame, at most.
    integer :: components = 0
  contains
    procedure, nopass :: describe => vtkhdf_describe
    procedure :: init => vtkhdf_init
    procedure :: ask => vtkhdf_ask
    procedure :: open => vtkhdf_open
    procedure :: name_run => vtkhdf_name_run
    procedure :: write_frame => vtkhdf_write_frame
    procedure :: finish => vtkhdf_finish
    procedure :: destination => vtkhdf_destination
    procedure, private :: path
    procedure, private :: check_fields
    procedure, private :: create
    procedure, private :: cut
    procedure, private :: prepare
    procedure, private :: write_body
    procedure, private :: append_frame
  end type vtkhdf_t

contains

  !> Purpose and properties of the class.
  subroutine vtkhdf_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('serializer', 'VTKHDF', &
                          'All frames in one HDF5 file for the points of each body, and one for &
                          &its nodes when asked, which ParaView and VTK open as a time series.', &
                          'VTK File Formats, docs.vtk.org (VTKHDF, version 2.0)', &
                          'serializer'//nl//'{'//nl//'    class = "VTKHDF"'//nl// &
                          '    properties = {60}   # rate'//nl// &
                          '    int-properties = {deflate = 4}'//nl// &
                          '    str-properties = {"output", "save", "two_blocks"}'//nl//'}')
    call description%add_real('rate', '1/s', 'frames per unit of time; 0 writes the first only', &
                              lower=0.0_wp)
    call description%add_integer('deflate', 'compression of the fields, from 1 (fast) to 9 &
                                 &(small); 0: none', default=0, lower=0, upper=9)
    call description%add_integer('nodes', '1: write the nodes of each body, too', default=0, &
                                 lower=0, upper=1)
    call description%add_integer('spare', '1: each file has a spare one while the run goes on, so &
                                 &that a killed run leaves whole files; 0: half the writing, but a &
                                 &run that is killed while it writes may leave a file that can''t &
                                 &be read', default=1, lower=0, upper=1)
    call description%add_string('frame_folder', 'folder of the files, relative to the working &
                                &directory; made when missing')
    call description%add_string('save_folder', 'folder of checkpoints, relative to the working &
                                &directory; made when needed; empty: no checkpoints')
    call description%add_string('run_name', 'name of the run, for the names of checkpoints; may be &
                                &empty')
    call add_save_properties(description)
    call description%add_string('fields', 'fields to write, by their names; all when none is &
                                &given', is_list=.true.)
    call description%add_note('points.<id>.<name>.vtkhdf has the points of a body in the order of &
                              &the points file, as PolyData; nodes.<id>.<name>.vtkhdf the whole &
                              &grid as UnstructuredGrid, 0 where the body has no node. ParaView &
                              &5.12 and VTK 9.3 or later read them.')
    call description%add_note('Fields are those of DefaultVTK, with all digits. A body that waits &
                              &for its time has fields of points, too.')
    call description%add_note('The files are closed between frames and can be read while the run &
                              &goes on. The group mpm3d beside that of VTK has the config, the &
                              &program and its revision.')
    call description%add_note('A restart goes on in the same files, behind the last frame before &
                              &the checkpoint.')
  end subroutine vtkhdf_describe

  !> Set up from the properties; nothing is written.
  subroutine vtkhdf_init(self, properties, error)
    !> The serializer.
    class(vtkhdf_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The name of the folder is empty.
    type(error_t), allocatable, intent(out) :: error

    self%rate = properties%real('rate')
    self%deflate = properties%integer('deflate')
    self%with_nodes = properties%integer('nodes') == 1
    self%with_spare = properties%integer('spare') == 1
    self%folder = properties%string('frame_folder')
    call properties%strings('fields', self%fields)
    call self%init_saving(properties)
    if (len_trim(self%folder) == 0) then
      call properties%reject('frame_folder', 'the name of the frame folder is empty', error, &
                             'write "." for the working directory')
    end if
  end subroutine vtkhdf_init

  !> Make points keep velocity gradients, unless the fields that were chosen are there without.
  subroutine vtkhdf_ask(self, points)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> Points of a body, started.
    class(points_t), intent(inout) :: points
    type(field_names_t) :: known
    logical :: enough
    integer :: i

    enough = size(self%fields) > 0
    if (enough) call points%write_fields(known)
    do i = 1, size(self%fields)
      enough = enough .and. known%has(self%fields(i)%text)
    end do
    if (.not. enough) call serializer_ask(self, points)
  end subroutine vtkhdf_ask

  !> Make the folder and the files, or go on in those of an earlier run.
  subroutine vtkhdf_open(self, model, error)
    !> The serializer.
    class(vtkhdf_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(inout) :: model
    !> The folder or a file can't be made or written to.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    call self%check_fields(model, error)
    if (.not. allocated(error)) call make_directories(self%folder, error)
    if (allocated(error)) return
    call delete_leftovers(self%folder, 'points.')
    call delete_leftovers(self%folder, 'nodes.')
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        call self%prepare(model, body, .false., error)
        if (.not. allocated(error) .and. self%with_nodes) then
          call self%prepare(model, body, .true., error)
        end if
        if (allocated(error)) return
      end associate
    end do
  end subroutine vtkhdf_open

  !> The files say themselves where they come from, histories do not.
  subroutine vtkhdf_name_run(self, model, goes_on, error)
    !> The serializer, opened.
    class(vtkhdf_t), intent(in) :: self
    !> The model at its start, or restored.
    type(model_t), intent(in) :: model
    !> Whether the run goes on from a checkpoint.
    logical, intent(in) :: goes_on
    !> It can't be written.
    type(error_t), allocatable, intent(out) :: error

    if (self%history%is_on()) call serializer_name_run(self, model, goes_on, error)
  end subroutine vtkhdf_name_run

  !> Make a file, or go on in that of an earlier run; make its spare.
  subroutine prepare(self, model, body, of_nodes, error)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Of the nodes; otherwise of the points.
    logical, intent(in) :: of_nodes
    !> It can't be written, or is not what it was.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer :: n
    logical :: found

    path = self%path('points', body)
    if (of_nodes) path = self%path('nodes', body)
    n = body%points%n
    if (of_nodes) n = whole_size(model%grid)
    found = file_exists(path)
    if (self%frames == 0) then
      call self%create(model, body, of_nodes, error)
    else if (self%with_spare .and. found) then
      call copy_file(path, spare_of(path), error)
      if (.not. allocated(error)) call self%cut(spare_of(path), n, error)
      if (.not. allocated(error)) call rename_file(spare_of(path), path, error)
    else
      call self%cut(path, n, error)
    end if
    if (.not. allocated(error) .and. self%with_spare) call copy_file(path, spare_of(path), error)
  end subroutine prepare

  !> Name of a spare file.
  pure function spare_of(path) result(spare)
    !> The file.
    character(*), intent(in) :: path
    !> Its spare.
    character(:), allocatable :: spare

    spare = path//'.spare'
  end function spare_of

  !> Delete the spare files.
  subroutine vtkhdf_finish(self, model)
    !> The serializer.
    class(vtkhdf_t), intent(inout) :: self
    !> The model at its end.
    type(model_t), intent(in) :: model
    type(error_t), allocatable :: ignored
    integer :: i

    if (.not. self%with_spare) return
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        call delete_file(spare_of(self%path('points', body)), ignored)
        if (self%with_nodes) call delete_file(spare_of(self%path('nodes', body)), ignored)
      end associate
    end do
  end subroutine vtkhdf_finish

  !> Every field that is asked for is one that an object has.
  subroutine check_fields(self, model, error)
    !> The serializer.
    class(vtkhdf_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> A name that is not known.
    type(error_t), allocatable, intent(out) :: error
    type(field_names_t) :: known
    character(:), allocatable :: hint
    integer :: i

    do i = 1, size(model%bodies)
      call model%bodies(i)%body%points%write_fields(known)
      if (self%with_nodes) call send_all_node_fields(model, model%bodies(i)%body, known)
    end do
    self%components = 3 + known%components
    do i = 1, size(self%fields)
      if (known%has(self%fields(i)%text)) cycle
      hint = nearest_name(self%fields(i)%text, known%names)
      if (len(hint) > 0) hint = 'did you mean "'//hint//'"?'
      call raise(error, err_input, 'serializer: there is no field "'//self%fields(i)%text//'"', &
                 hint=hint)
      return
    end do
  end subroutine check_fields

  !> Make a file without frames.
  subroutine create(self, model, body, of_nodes, error)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Of the nodes; otherwise of the points.
    logical, intent(in) :: of_nodes
    !> It can't be written.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: ignored
    type(hdf5_file_t), allocatable :: file
    character(:), allocatable :: path, temporary
    integer(lp) :: columns

    path = self%path('points', body)
    if (of_nodes) path = self%path('nodes', body)
    temporary = path//'.tmp'//to_text(process_id())
    allocate (file)
    call file%create(temporary, .false.)
    call file%enter('mpm3d')
    call file%set_attribute('program', 'mpm3d '//version)
    call file%set_attribute('revision', revision)
    call file%set_attribute('compiler', compiler)
    call file%set_attribute('body', body%name)
    call file%set_attribute('type', [int(model%kin%sim_type, lp)])
    call file%set_attribute('units', 'm, kg, s, N, Pa, J; in TYPE 1, 2 and 5 per m2 of section or &
                            &m of depth, in TYPE 4 per radian')
    if (allocated(self%config_text)) then
      call file%put('config', self%config_text)
      call file%put('run', self%run)
    end if
    call file%leave()
    call file%enter('VTKHDF')
    call file%set_attribute('Version', [2_lp, 0_lp])
    call file%set_attribute('Type', trim(merge('UnstructuredGrid', 'PolyData        ', of_nodes)))
    call file%enter('PointData')
    call file%leave()
    columns = size(topologies, kind=lp)
    if (of_nodes) then
      columns = 1
      call put_grid(file, model%grid)
    else
      call put_vertices(file, body%points%n, self%deflate)
    end if
    call file%enter('Steps')
    call file%set_attribute('NSteps', [0_lp])
    call file%create_series('Values', 'real', [integer(lp) ::], 64_lp, 0)
    call file%create_series('PartOffsets', 'integer', [integer(lp) ::], 64_lp, 0)
    call file%create_series('NumberOfParts', 'integer', [integer(lp) ::], 64_lp, 0)
    call file%create_series('PointOffsets', 'integer', [integer(lp) ::], 64_lp, 0)
    call file%create_series('CellOffsets', 'integer', [columns], 64_lp, 0)
    call file%create_series('ConnectivityIdOffsets', 'integer', [columns], 64_lp, 0)
    call file%enter('PointDataOffsets')
    call file%close()
    if (allocated(file%failure)) then
      call move_alloc(file%failure, error)
      error%file = path
    else
      call rename_file(temporary, path, error)
    end if
    if (allocated(error)) call delete_file(temporary, ignored)
  end subroutine create

  !> Write what does not change of points: each is a vertex.
  subroutine put_vertices(file, n, deflate)
    !> The file.
    type(hdf5_file_t), intent(inout) :: file
    !> Number of points.
    integer, intent(in) :: n
    !> Level of compression.
    integer, intent(in) :: deflate
    integer(lp) :: i
    integer :: k, m

    call file%write_integers('NumberOfPoints', [int(n, lp)], [1_lp])
    call file%create_series('Points', 'real', [3_lp], chunk_length(n), deflate)
    do k = 1, size(topologies)
      m = 0
      if (k == 1) m = n
      call file%enter(trim(topologies(k)))
      call file%write_integers('NumberOfCells', [int(m, lp)], [1_lp])
      call file%write_integers('NumberOfConnectivityIds', [int(m, lp)], [1_lp])
      call file%write_integers('Connectivity', [(i, i=0, m - 1)], [int(m, lp)])
      call file%write_integers('Offsets', [(i, i=0, m)], [m + 1_lp])
      call file%leave()
    end do
  end subroutine put_vertices

  !> Write what does not change of nodes: their positions and cells.
  subroutine put_grid(file, grid)
    !> The file.
    type(hdf5_file_t), intent(inout) :: file
    !> The grid.
    class(grid_t), intent(in) :: grid
    type(window_t) :: whole
    real(wp), allocatable, target :: x(:, :)
    integer(lp), allocatable :: connectivity(:)
    integer(lp) :: k
    integer :: nodes(8), n_nodes, n_cells, cell, i, j, l, n, last(3)

    whole = grid%whole()
    last = whole%hi()
    allocate (x(3, whole%size()))
    n = 0
    do l = whole%lo(3), last(3)
      do j = whole%lo(2), last(2)
        do i = whole%lo(1), last(1)
          n = n + 1
          x(:, n) = grid%node_position([i, j, l])
        end do
      end do
    end do
    n_cells = grid%cell_count()
    call grid%cell_nodes(0, nodes, n_nodes)
    allocate (connectivity(int(n_nodes, lp)*n_cells))
    do cell = 0, n_cells - 1
      call grid%cell_nodes(cell, nodes, n_nodes)
      k = int(n_nodes, lp)*cell
      connectivity(k + 1:k + n_nodes) = nodes(:n_nodes)
    end do
    call file%write_integers('NumberOfPoints', [int(n, lp)], [1_lp])
    call file%write_integers('NumberOfCells', [int(n_cells, lp)], [1_lp])
    call file%write_integers('NumberOfConnectivityIds', [size(connectivity, kind=lp)], [1_lp])
    call file%put('Points', x)
    call file%write_integers('Connectivity', connectivity, [size(connectivity, kind=lp)])
    call file%write_integers('Offsets', [(k*n_nodes, k=0, n_cells)], [n_cells + 1_lp])
    call file%create_series('Types', 'byte', [integer(lp) ::], chunk_length(n_cells), 0)
    call file%append('Types', [(int(grid%vtk_cell_type(), lp), i=1, n_cells)])
  end subroutine put_grid

  !> Drop the frames behind those before the checkpoint.
  subroutine cut(self, path, n, error)
    !> The serializer, restored.
    class(vtkhdf_t), intent(in) :: self
    !> The file.
    character(*), intent(in) :: path
    !> Entries of a frame.
    integer, intent(in) :: n
    !> The file is not there, is damaged, or has fewer frames.
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_file_t), allocatable :: file
    type(string_t), allocatable :: names(:)
    integer(lp), allocatable :: extents(:)
    integer(lp) :: steps, entries
    integer :: i

    steps = self%frames
    entries = steps*n
    allocate (file)
    call file%open(path, .true.)
    call file%enter('VTKHDF')
    call file%enter('Steps')
    call file%extents_of('Values', extents)
    if (.not. allocated(file%failure)) then
      if (extents(1) < steps) then
        call raise(file%failure, err_io, 'the file has '//to_text(extents(1))//' frames, but '// &
                   to_text(steps)//' were written when the run was saved', file=path)
      end if
    end if
    call file%set_attribute('NSteps', [steps])
    call file%flush()
    call file%names(names)
    do i = 1, size(names)
      if (names(i)%text /= 'PointDataOffsets') call file%resize(names(i)%text, steps)
    end do
    call file%enter('PointDataOffsets')
    call file%names(names)
    do i = 1, size(names)
      call file%resize(names(i)%text, steps)
    end do
    call file%leave()
    call file%leave()
    call file%enter('PointData')
    do i = 1, size(names)
      call file%resize(names(i)%text, entries)
    end do
    call file%leave()
    if (file%has('Vertices')) call file%resize('Points', entries)
    call file%close()
    if (.not. allocated(file%failure)) return
    call move_alloc(file%failure, error)
    if (.not. file_exists(path)) error%message = 'the frames of the run that was saved are gone'
    error%code = err_io
    error%file = path
  end subroutine cut

  !> Write the state as the next frame.
  subroutine vtkhdf_write_frame(self, model, error)
    !> The serializer.
    class(vtkhdf_t), intent(inout) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: total
    integer :: i

    total = 0
    do i = 1, size(model%bodies)
      call self%write_body(model, model%bodies(i)%body, .false., total, error)
      if (allocated(error)) return
      if (.not. self%with_nodes) cycle
      call self%write_body(model, model%bodies(i)%body, .true., total, error)
      if (allocated(error)) return
    end do
    self%bytes = total
    self%frames = self%frames + 1
  end subroutine vtkhdf_write_frame

  !> Write the state of a body as the next frame of a file and its spare.
  !!
  !! The library changes a file in many places, between which it is not whole: that is done to the
  !! spare one, which then takes the name.
  subroutine write_body(self, model, body, of_nodes, total, error)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Its nodes; otherwise its points.
    logical, intent(in) :: of_nodes
    !> Bytes of files; that of this one is added.
    integer(lp), intent(inout) :: total
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: path

    path = self%path('points', body)
    if (of_nodes) path = self%path('nodes', body)
    if (self%with_spare) then
      call self%append_frame(model, body, of_nodes, spare_of(path), error)
      if (.not. allocated(error)) call exchange_files(path, spare_of(path), error)
      if (.not. allocated(error)) then
        call self%append_frame(model, body, of_nodes, spare_of(path), error)
      end if
      if (allocated(error)) then
        if (len(error%file) > 0) error%file = path
      end if
    else
      call self%append_frame(model, body, of_nodes, path, error)
    end if
    total = total + file_size(path)
  end subroutine write_body

  !> Write the state of a body as the next frame of a file.
  subroutine append_frame(self, model, body, of_nodes, path, error)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Its nodes; otherwise its points.
    logical, intent(in) :: of_nodes
    !> The file.
    character(*), intent(in) :: path
    !> Writing failed, or a value is not finite.
    type(error_t), allocatable, intent(out) :: error
    type(hdf5_fields_t), allocatable :: fields
    real(wp), allocatable, target :: x(:)
    integer(lp) :: columns
    integer :: i

    allocate (fields)
    fields%kin = model%kin
    fields%step = self%frames
    fields%chosen = self%fields
    fields%deflate = self%deflate
    fields%body = body%name
    fields%when = 'frame '//to_text(self%frames)//', t = '//to_text(model%time)//' s'
    fields%n = body%points%n
    if (of_nodes) fields%n = whole_size(model%grid)
    ! A write that fails in the middle would damage what the file has already.
    call reserve_space(path, frame_bytes(self%components, fields%n), error)
    if (allocated(error)) return
    call fields%file%open(path, .true.)
    call fields%file%enter('VTKHDF')
    columns = size(topologies, kind=lp)
    if (of_nodes) then
      columns = 1
      fields%whole = model%grid%whole()
      fields%periods = model%grid%periods()
      call send_all_node_fields(model, body, fields)
    else
      fields%slot = body%points%slots()
      allocate (x(3*fields%n), source=0.0_wp)
      do i = 1, fields%n
        x(3*i - 2:3*i - 3 + model%kin%dim) = body%points%x(:, fields%slot(i))
      end do
      call fields%file%append('Points', x)
      call body%points%write_fields(fields)
    end if
    if (.not. allocated(fields%failure)) then
      call fields%finish()
      call fields%file%enter('Steps')
      call fields%file%append('Values', [model%time])
      call fields%file%append('PartOffsets', [0_lp])
      call fields%file%append('NumberOfParts', [1_lp])
      call fields%file%append('PointOffsets', [merge(0_lp, int(fields%n, lp)*self%frames, &
                                                     of_nodes)])
      call fields%file%append('CellOffsets', spread(0_lp, 1, int(columns)))
      call fields%file%append('ConnectivityIdOffsets', spread(0_lp, 1, int(columns)))
      ! A reader looks at no more than NSteps frames: this one counts when its data are there.
      call fields%file%flush()
      call fields%file%set_attribute('NSteps', [self%frames + 1_lp])
    end if
    call fields%file%close()
    if (allocated(fields%file%failure)) then
      call move_alloc(fields%file%failure, error)
      error%code = err_io
    end if
    if (allocated(fields%failure)) call move_alloc(fields%failure, error)
  end subroutine append_frame

  !> Bytes that a file may grow by in a frame: whole chunks, and what the library adds.
  pure function frame_bytes(components, n) result(n_bytes)
    !> Components of an entry.
    integer, intent(in) :: components
    !> Entries of a frame.
    integer, intent(in) :: n
    !> Bytes.
    integer(lp) :: n_bytes
    integer(lp), parameter :: for_the_library = 131072
    integer(lp) :: entries

    entries = n
    if (mod(entries, chunk_length(n)) > 0) entries = entries + 2*chunk_length(n)
    n_bytes = components*entries*(storage_size(1.0_wp)/8) + for_the_library
  end function frame_bytes

  !> Nodes of a grid.
  function whole_size(grid) result(n)
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Their number.
    integer :: n
    type(window_t) :: whole

    whole = grid%whole()
    n = whole%size()
  end function whole_size

  !> Name of a file.
  function path(self, prefix, body)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> `points` or `nodes`.
    character(*), intent(in) :: prefix
    !> The body.
    class(body_t), intent(in) :: body
    !> The path.
    character(:), allocatable :: path

    path = join_path(self%folder, prefix//'.'//to_text(body%id)//'.'//body%name//'.vtkhdf')
  end function path

  !> Where the frames go.
  function vtkhdf_destination(self) result(text)
    !> The serializer.
    class(vtkhdf_t), intent(in) :: self
    !> The folder.
    character(:), allocatable :: text

    text = self%folder
  end function vtkhdf_destination

end module mpm_vtkhdf
