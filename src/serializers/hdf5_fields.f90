!> Fields of one body and one frame on their way into a temporal VTKHDF file.
module mpm_hdf5_fields
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_errors, only: err_simulation, error_t, raise
  use mpm_field_names, only: field_names_t
  use mpm_field_writer, only: field_writer_t
  use mpm_hdf5_file, only: hdf5_file_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: expand_gradient, expand_stress, kinematics_t
  use mpm_strings, only: string_t, to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: chunk_length, hdf5_fields_t

  !> Most entries in a chunk of a dataset.
  integer, parameter :: most_in_chunk = 16384

  !> A file that takes the fields of a frame; `failure` has the first failure.
  type, extends(field_writer_t) :: hdf5_fields_t
    !> The file; its current group is VTKHDF.
    type(hdf5_file_t) :: file
    !> Component counts of the job.
    type(kinematics_t) :: kin
    !> Number of the frame in the file, from 0.
    integer :: step = 0
    !> Entries of a frame.
    integer :: n = 0
    !> Position in memory of each entry of points. (n)
    integer, allocatable :: slot(:)
    !> All nodes of the grid, for fields of nodes.
    type(window_t) :: whole
    !> Nodes after which the grid repeats in each direction; 0 where it does not.
    integer :: periods(3) = 0
    !> Fields to write; none for all.
    type(string_t), allocatable :: chosen(:)
    !> Level of compression.
    integer :: deflate = 0
    !> Name of the body.
    character(:), allocatable :: body
    !> Frame and time, for messages.
    character(:), allocatable :: when
    !> Fields written in this frame.
    type(field_names_t) :: written
    !> The first value that is not finite.
    type(error_t), allocatable :: failure
  contains
    procedure :: scalar => hdf5_fields_scalar
    procedure :: vector => hdf5_fields_vector
    procedure :: symmetric_tensor => hdf5_fields_symmetric_tensor
    procedure :: gradient_tensor => hdf5_fields_gradient_tensor
    !> Bring fields that were not sent to the length of the others, with zeros.
    procedure :: finish => hdf5_fields_finish
    !> Write a field with all its components.
    procedure :: put => hdf5_fields_put
    procedure, private :: wants
    procedure, private :: source_of
  end type hdf5_fields_t

contains

  !> Entries in a chunk, so that frames of many entries are cut evenly.
  pure function chunk_length(n) result(length)
    !> Entries of a frame.
    integer, intent(in) :: n
    !> Entries of a chunk, at least 1.
    integer(lp) :: length
    integer :: parts

    parts = (n + most_in_chunk - 1)/most_in_chunk
    length = 1
    if (parts > 0) length = (n + parts - 1)/parts
  end function chunk_length

  !> Whether a field is asked for, and nothing has failed.
  function wants(self, name)
    !> The file.
    class(hdf5_fields_t), intent(in) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Whether it is.
    logical :: wants
    integer :: i

    wants = size(self%chosen) == 0
    do i = 1, size(self%chosen)
      if (self%chosen(i)%text == name) wants = .true.
    end do
    if (allocated(self%failure) .or. allocated(self%file%failure)) wants = .false.
  end function wants

  !> Position in memory of an entry.
  pure function source_of(self, entry, window) result(source)
    !> The file.
    class(hdf5_fields_t), intent(in) :: self
    !> Entry, from 1.
    integer, intent(in) :: entry
    !> Window of the values of nodes.
    type(window_t), intent(in), optional :: window
    !> Position, from 1; 0 for an entry without a value.
    integer :: source
    integer :: node(3), rest

    if (allocated(self%slot)) then
      source = self%slot(entry)
    else if (.not. present(window)) then
      source = entry
    else
      rest = (entry - 1)/self%whole%n(1)
      node(1) = entry - 1 - rest*self%whole%n(1)
      node(3) = rest/self%whole%n(2)
      node(2) = rest - node(3)*self%whole%n(2)
      node = node + self%whole%lo
      ! The last node of a period is the first one.
      where (self%periods > 0 .and. node == self%periods) node = 0
      source = 0
      if (window%holds(node)) source = window%index(node)
    end if
  end function source_of

  !> Write a scalar field.
  subroutine hdf5_fields_scalar(self, name, values, window)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (n)
    real(wp), intent(in) :: values(:)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    real(wp), allocatable :: whole(:)
    integer :: i, p

    if (.not. self%wants(name)) return
    allocate (whole(self%n), source=0.0_wp)
    do i = 1, self%n
      p = self%source_of(i, window)
      if (p > 0) whole(i) = values(p)
    end do
    call self%put('PointData', name, 1, whole)
  end subroutine hdf5_fields_scalar

  !> Write a vector field; components that the TYPE does not have are 0.
  subroutine hdf5_fields_vector(self, name, values, window)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (components, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    real(wp), allocatable :: whole(:)
    integer :: i, p, components

    if (.not. self%wants(name)) return
    components = size(values, 1)
    allocate (whole(3*self%n), source=0.0_wp)
    do i = 1, self%n
      p = self%source_of(i, window)
      if (p > 0) whole(3*i - 2:3*i - 3 + components) = values(:, p)
    end do
    call self%put('PointData', name, 3, whole)
  end subroutine hdf5_fields_vector

  !> Write a symmetric tensor field, given in stored stress components.
  subroutine hdf5_fields_symmetric_tensor(self, name, values, window)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (nstress, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    real(wp), allocatable :: whole(:)
    integer :: i, p

    if (.not. self%wants(name)) return
    allocate (whole(9*self%n), source=0.0_wp)
    do i = 1, self%n
      p = self%source_of(i, window)
      if (p > 0) whole(9*i - 8:9*i) = reshape(expand_stress(values(:, p)), [9])
    end do
    call self%put('PointData', name, 9, whole)
  end subroutine hdf5_fields_symmetric_tensor

  !> Write a tensor field, given in stored velocity gradient components, row by row.
  subroutine hdf5_fields_gradient_tensor(self, name, values, window)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Values. (ngrad, n)
    real(wp), intent(in) :: values(:, :)
    !> Window of nodal values.
    type(window_t), intent(in), optional :: window
    real(wp), allocatable :: whole(:)
    integer :: i, p

    if (.not. self%wants(name)) return
    allocate (whole(9*self%n), source=0.0_wp)
    do i = 1, self%n
      p = self%source_of(i, window)
      if (p > 0) then
        whole(9*i - 8:9*i) = reshape(transpose(expand_gradient(self%kin, values(:, p))), [9])
      end if
    end do
    call self%put('PointData', name, 9, whole)
  end subroutine hdf5_fields_gradient_tensor

  !> Write a field with all its components.
  !!
  !! A field that earlier frames did not have is 0 in them.
  subroutine hdf5_fields_put(self, group, name, components, values)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    !> Group of the field.
    character(*), intent(in) :: group
    !> Name of the field; a / in it becomes _.
    character(*), intent(in) :: name
    !> Components of a value.
    integer, intent(in) :: components
    !> Values in the order of the file. (components n)
    real(wp), contiguous, target, intent(in) :: values(:)
    character(len(name)) :: label
    integer(lp) :: i
    integer :: k
    logical :: there

    call check(self, name, components, values)
    if (allocated(self%failure)) return
    label = name
    do k = 1, len(name)
      if (name(k:k) == '/') label(k:k) = '_'
    end do
    call self%written%keep(label, components)
    call self%file%enter(group)
    there = self%file%has(label)
    if (.not. there) then
      if (components == 1) then
        call self%file%create_series(label, 'real', [integer(lp) ::], chunk_length(self%n), &
                                     self%deflate)
      else
        call self%file%create_series(label, 'real', [int(components, lp)], chunk_length(self%n), &
                                     self%deflate)
      end if
      call self%file%resize(label, int(self%n, lp)*self%step)
    end if
    call self%file%append(label, values)
    call self%file%leave()
    if (there) return
    call self%file%enter('Steps')
    call self%file%enter('PointDataOffsets')
    call self%file%create_series(label, 'integer', [integer(lp) ::], 64_lp, 0)
    call self%file%append(label, [(i*self%n, i=0, self%step - 1)])
    call self%file%leave()
    call self%file%leave()
  end subroutine hdf5_fields_put

  !> Keep the error of the first value that is not finite, if there is one.
  subroutine check(self, name, components, values)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    !> Name of the field.
    character(*), intent(in) :: name
    !> Components of a value.
    integer, intent(in) :: components
    !> Values.
    real(wp), intent(in) :: values(:)
    character(:), allocatable :: what
    integer :: i

    if (all(ieee_is_finite(values))) return
    do i = 1, size(values)
      if (.not. ieee_is_finite(values(i))) exit
    end do
    what = 'point '//to_text((i - 1)/components + 1)
    if (.not. allocated(self%slot)) what = 'node '//to_text((i - 1)/components)
    call raise(self%failure, err_simulation, 'body "'//self%body//'": field "'//name//'" of '// &
               what//' is not finite in '//self%when, &
               hint='frames written before this one are whole')
  end subroutine check

  !> Bring fields that were not sent to the length of the others, with zeros.
  subroutine hdf5_fields_finish(self)
    !> The file.
    class(hdf5_fields_t), intent(inout) :: self
    type(string_t), allocatable :: names(:)
    integer(lp) :: first(1)
    integer :: i

    first = int(self%n, lp)*self%step
    call self%file%enter('PointData')
    call self%file%names(names)
    do i = 1, size(names)
      if (self%written%has(names(i)%text)) cycle
      call self%file%resize(names(i)%text, int(self%n, lp)*(self%step + 1))
    end do
    call self%file%leave()
    call self%file%enter('Steps')
    call self%file%enter('PointDataOffsets')
    do i = 1, size(names)
      call self%file%append(names(i)%text, first)
    end do
    call self%file%leave()
    call self%file%leave()
  end subroutine hdf5_fields_finish

end module mpm_hdf5_fields
