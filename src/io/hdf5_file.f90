!> HDF5 files; no other module uses the library.
!!
!! As a store an `hdf5_file_t` holds numbers as datasets and texts as fixed-length strings. For
!! series that grow it has datasets that are extended along their last index.
module mpm_hdf5_file
  use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
  use hdf5, only: h5_integer_kind, h5_real_kind, h5kind_to_type, h5open_f, h5eset_auto_f, &
                  hid_t, hsize_t, size_t, &
                  h5aclose_f, h5acreate_f, h5adelete_f, h5aexists_f, h5aopen_f, h5awrite_f, &
                  h5dclose_f, h5dcreate_f, h5dget_space_f, h5dget_type_f, h5dopen_f, h5dread_f, &
                  h5dset_extent_f, h5dwrite_f, &
                  h5fclose_f, h5fcreate_f, h5fflush_f, h5fopen_f, &
                  h5gclose_f, h5gcreate_f, h5gget_obj_info_idx_f, h5gn_members_f, h5gopen_f, &
                  h5lexists_f, &
                  h5pclose_f, h5pcreate_f, h5pset_chunk_f, h5pset_deflate_f, h5pset_shuffle_f, &
                  h5pset_userblock_f, &
                  h5sclose_f, h5screate_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
                  h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, &
                  h5tclose_f, h5tcopy_f, h5tget_class_f, h5tget_size_f, h5tset_size_f, &
                  h5tset_strpad_f, &
                  h5f_acc_rdonly_f, h5f_acc_rdwr_f, h5f_acc_trunc_f, h5f_scope_global_f, &
                  h5p_dataset_create_f, h5p_file_create_f, h5p_default_f, &
                  h5s_scalar_f, h5s_select_set_f, h5s_unlimited_f, &
                  h5t_c_s1, h5t_float_f, h5t_ieee_f64le, h5t_integer_f, h5t_native_integer, &
                  h5t_std_i64le, h5t_std_u8le, h5t_str_nullpad_f, h5t_string_f
  use mpm_errors, only: err_input, err_io, error_t, raise
  use mpm_file_system, only: set_environment
  use mpm_files, only: file_exists, is_readable, reason_against
  use mpm_kinds, only: lp, wp
  use mpm_store, only: store_t
  use mpm_strings, only: append_text, string_t
  implicit none
  private
  public :: hdf5_file_t, user_block

  !> Bytes in front of the HDF5 data of a file that has a user block.
  integer, parameter :: user_block = 512
  !> Most groups within each other.
  integer, parameter :: max_depth = 16
  !> What is told when the library refuses to write.
  character(*), parameter :: write_failed = 'writing failed: the disk may be full'

  !> An HDF5 file, open for reading or writing.
  type, extends(store_t) :: hdf5_file_t
    private
    !> The file; negative when it is not open.
    integer(hid_t) :: file = -1
    !> The file's root and the groups that were entered.
    integer(hid_t) :: groups(0:max_depth) = -1
    !> Number of groups that were entered.
    integer :: depth = 0
    !> Whether the file is being written.
    logical :: writes = .false.
  contains
    !> Start a file in place of any of that name.
    procedure :: create => hdf5_file_create
    !> Open a file that exists.
    procedure :: open => hdf5_file_open
    !> Close the file.
    procedure :: close => hdf5_file_close
    !> Bring all data into the file.
    procedure :: flush => hdf5_file_flush
    procedure :: enter => hdf5_file_enter
    procedure :: leave => hdf5_file_leave
    procedure :: has => hdf5_file_has
    procedure :: write_reals => hdf5_file_write_reals
    procedure :: write_integers => hdf5_file_write_integers
    procedure :: write_text => hdf5_file_write_text
    procedure :: extents_of => hdf5_file_extents_of
    procedure :: read_reals => hdf5_file_read_reals
    procedure :: read_integers => hdf5_file_read_integers
    procedure :: read_text => hdf5_file_read_text
    !> Names of what the current group holds.
    procedure :: names => hdf5_file_names
    !> Give the current group an attribute.
    generic :: set_attribute => set_integers, set_text
    !> Make a dataset that can grow along its last index.
    procedure :: create_series => hdf5_file_create_series
    !> Append to a dataset that can grow.
    generic :: append => append_reals, append_integers
    !> Change the extent of a dataset along its last index.
    procedure :: resize => hdf5_file_resize
    procedure, private :: set_integers
    procedure, private :: set_text
    procedure, private :: append_reals
    procedure, private :: append_integers
    procedure, private :: here
    procedure, private :: make_dataset
    procedure, private :: open_dataset
    procedure, private :: read_values
    procedure, private :: write_values
    procedure, private :: append_values
    procedure, private :: fail
  end type hdf5_file_t

contains

  !> Start a file in place of any of that name.
  subroutine hdf5_file_create(self, path, with_user_block)
    !> The file; `failure` tells why there is none.
    class(hdf5_file_t), intent(inout) :: self
    !> Its path.
    character(*), intent(in) :: path
    !> Leave `user_block` bytes in front of the HDF5 data.
    logical, intent(in) :: with_user_block
    integer(hid_t) :: list
    integer :: status, ignored

    call start(self, path)
    self%writes = .true.
    call h5pcreate_f(h5p_file_create_f, list, status)
    if (with_user_block) call h5pset_userblock_f(list, int(user_block, hsize_t), status)
    call h5fcreate_f(path, h5f_acc_trunc_f, self%file, status, creation_prp=list)
    call h5pclose_f(list, ignored)
    if (status /= 0) then
      self%file = -1
      call raise(self%failure, err_io, 'the file cannot be written: '// &
                 reason_against(path, replaces_file=.true.), file=path)
      return
    end if
    call open_root(self)
  end subroutine hdf5_file_create

  !> Open a file that exists.
  subroutine hdf5_file_open(self, path, for_writing)
    !> The file; `failure` tells why it can't be opened.
    class(hdf5_file_t), intent(inout) :: self
    !> Its path.
    character(*), intent(in) :: path
    !> Open it for writing as well.
    logical, intent(in) :: for_writing
    integer :: status

    call start(self, path)
    self%writes = for_writing
    if (.not. file_exists(path)) then
      call raise(self%failure, err_input, 'there is no such file', file=path)
    else if (.not. is_readable(path)) then
      call raise(self%failure, err_input, 'no permission to read the file', file=path)
    end if
    if (allocated(self%failure)) return
    call h5fopen_f(path, merge(h5f_acc_rdwr_f, h5f_acc_rdonly_f, for_writing), self%file, status)
    if (status /= 0) then
      self%file = -1
      call raise(self%failure, err_input, 'the file is not an HDF5 file, or it is damaged', &
                 file=path)
      return
    end if
    call open_root(self)
  end subroutine hdf5_file_open

  !> Start the library, which must not print messages of its own, and forget an earlier file.
  subroutine start(self, path)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Its path.
    character(*), intent(in) :: path
    integer :: status

    call self%close()
    if (allocated(self%failure)) deallocate (self%failure)
    self%path = path
    ! The library would refuse to write to a file that a viewer has open.
    call set_environment('HDF5_USE_FILE_LOCKING', 'FALSE')
    call h5open_f(status)
    call h5eset_auto_f(0, status)
  end subroutine start

  !> Open the root group.
  subroutine open_root(self)
    !> The file, open.
    class(hdf5_file_t), intent(inout) :: self
    integer :: status

    self%depth = 0
    call h5gopen_f(self%file, '/', self%groups(0), status)
    if (status /= 0) call self%fail('')
  end subroutine open_root

  !> Close the file; `failure` tells whether all was written.
  subroutine hdf5_file_close(self)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    integer :: status, i

    if (self%file < 0) return
    do i = self%depth, 0, -1
      if (self%groups(i) >= 0) call h5gclose_f(self%groups(i), status)
    end do
    self%groups = -1
    self%depth = 0
    call h5fclose_f(self%file, status)
    self%file = -1
    if (status /= 0) call self%fail('')
  end subroutine hdf5_file_close

  !> Bring all data into the file.
  subroutine hdf5_file_flush(self)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    integer :: status

    if (allocated(self%failure)) return
    call h5fflush_f(self%file, h5f_scope_global_f, status)
    if (status /= 0) call self%fail('')
  end subroutine hdf5_file_flush

  !> Keep the first failure.
  subroutine fail(self, name)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> The value or group at fault; may be empty.
    character(*), intent(in) :: name

    if (allocated(self%failure)) return
    if (self%writes) then
      call raise(self%failure, err_io, write_failed, file=self%path)
    else if (len(name) > 0) then
      call raise(self%failure, err_input, '"'//name//'" is missing or not what it should be', &
                 file=self%path)
    else
      call raise(self%failure, err_input, 'the file is damaged', file=self%path)
    end if
  end subroutine fail

  !> The current group.
  pure function here(self) result(group)
    !> The file.
    class(hdf5_file_t), intent(in) :: self
    !> Its identifier.
    integer(hid_t) :: group

    group = self%groups(self%depth)
  end function here

  !> Enter a group of the current one; when writing it is made unless it is there.
  subroutine hdf5_file_enter(self, name)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name of the group.
    character(*), intent(in) :: name
    integer :: status
    logical :: there

    if (allocated(self%failure)) return
    if (self%depth == max_depth) then
      call self%fail(name)
      return
    end if
    there = self%has(name)
    if (allocated(self%failure)) return
    if (self%writes .and. .not. there) then
      call h5gcreate_f(self%here(), name, self%groups(self%depth + 1), status)
    else
      call h5gopen_f(self%here(), name, self%groups(self%depth + 1), status)
    end if
    if (status /= 0) then
      self%groups(self%depth + 1) = -1
      call self%fail(name)
      return
    end if
    self%depth = self%depth + 1
  end subroutine hdf5_file_enter

  !> Go back to the group around the current one.
  subroutine hdf5_file_leave(self)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    integer :: status

    if (allocated(self%failure) .or. self%depth == 0) return
    call h5gclose_f(self%here(), status)
    self%groups(self%depth) = -1
    self%depth = self%depth - 1
    if (status /= 0) call self%fail('')
  end subroutine hdf5_file_leave

  !> Whether the current group has a value or group of a name.
  function hdf5_file_has(self, name) result(has)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> The name.
    character(*), intent(in) :: name
    !> False after a failure.
    logical :: has
    integer :: status

    has = .false.
    if (allocated(self%failure)) return
    call h5lexists_f(self%here(), name, has, status)
    if (status /= 0) call self%fail(name)
  end function hdf5_file_has

  !> Names of what the current group holds.
  subroutine hdf5_file_names(self, names)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Names of groups and datasets.
    type(string_t), allocatable, intent(out) :: names(:)
    character(256) :: name
    integer :: status, n, i, kind

    allocate (names(0))
    if (allocated(self%failure)) return
    call h5gn_members_f(self%here(), '.', n, status)
    do i = 0, n - 1
      if (status == 0) call h5gget_obj_info_idx_f(self%here(), '.', i, name, kind, status)
      if (status == 0) call append_text(names, trim(name))
    end do
    if (status /= 0) call self%fail('')
  end subroutine hdf5_file_names

  !> Write reals.
  subroutine hdf5_file_write_reals(self, name, values, extents)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values, the first index fastest.
    real(wp), contiguous, target, intent(in) :: values(:)
    !> Extents; none for a single number.
    integer(lp), intent(in) :: extents(:)

    if (size(values) == 0) then
      call self%write_values(name, h5t_ieee_f64le, real_type(), extents)
    else
      call self%write_values(name, h5t_ieee_f64le, real_type(), extents, c_loc(values))
    end if
  end subroutine hdf5_file_write_reals

  !> Write integers.
  subroutine hdf5_file_write_integers(self, name, values, extents)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values, the first index fastest.
    integer(lp), contiguous, target, intent(in) :: values(:)
    !> Extents; none for a single number.
    integer(lp), intent(in) :: extents(:)

    if (size(values) == 0) then
      call self%write_values(name, h5t_std_i64le, long_type(), extents)
    else
      call self%write_values(name, h5t_std_i64le, long_type(), extents, c_loc(values))
    end if
  end subroutine hdf5_file_write_integers

  !> Write a text.
  subroutine hdf5_file_write_text(self, name, text)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The text.
    character(*), intent(in) :: text
    character(:), allocatable, target :: bytes
    integer(hid_t) :: kind
    integer(lp) :: none(0)
    integer :: status

    if (allocated(self%failure)) return
    call make_text_type(len(text), kind)
    bytes = text//achar(0)
    call self%write_values(name, kind, kind, none, c_loc(bytes(1:1)))
    call h5tclose_f(kind, status)
  end subroutine hdf5_file_write_text

  !> Write a dataset of its final size.
  subroutine write_values(self, name, file_type, memory_type, extents, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Type in the file.
    integer(hid_t), intent(in) :: file_type
    !> Type in memory.
    integer(hid_t), intent(in) :: memory_type
    !> Extents; none for a single value.
    integer(lp), intent(in) :: extents(:)
    !> Address of the values; left out when there are none.
    type(c_ptr), intent(in), optional :: values
    integer(hid_t) :: space, dataset
    integer :: status, ignored

    if (allocated(self%failure)) return
    if (size(extents) == 0) then
      call h5screate_f(h5s_scalar_f, space, status)
    else
      call h5screate_simple_f(size(extents), int(extents, hsize_t), space, status)
    end if
    if (status == 0) call self%make_dataset(name, file_type, space, h5p_default_f, dataset)
    call h5sclose_f(space, ignored)
    if (status /= 0) call self%fail(name)
    if (allocated(self%failure)) return
    if (present(values)) call h5dwrite_f(dataset, memory_type, values, status)
    if (status /= 0) call self%fail(name)
    call h5dclose_f(dataset, status)
    if (status /= 0) call self%fail(name)
  end subroutine write_values

  !> Make a dataset in the current group.
  subroutine make_dataset(self, name, file_type, space, list, dataset)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Type in the file.
    integer(hid_t), intent(in) :: file_type
    !> Its space.
    integer(hid_t), intent(in) :: space
    !> Properties of its creation.
    integer(hid_t), intent(in) :: list
    !> The dataset, open unless there is a failure.
    integer(hid_t), intent(out) :: dataset
    integer :: status

    call h5dcreate_f(self%here(), name, file_type, space, dataset, status, dcpl_id=list)
    if (status /= 0) call self%fail(name)
  end subroutine make_dataset

  !> Open a dataset of a class of types.
  subroutine open_dataset(self, name, class, dataset)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Class that its type must have; negative for integers or reals.
    integer, intent(in) :: class
    !> The dataset, open unless there is a failure.
    integer(hid_t), intent(out) :: dataset
    integer(hid_t) :: kind
    integer :: status, found, ignored
    logical :: there

    dataset = -1
    if (allocated(self%failure)) return
    there = self%has(name)
    if (.not. there) call self%fail(name)
    if (allocated(self%failure)) return
    call h5dopen_f(self%here(), name, dataset, status)
    if (status /= 0) then
      call self%fail(name)
      return
    end if
    call h5dget_type_f(dataset, kind, status)
    call h5tget_class_f(kind, found, status)
    call h5tclose_f(kind, ignored)
    if (class < 0 .and. (found == h5t_integer_f .or. found == h5t_float_f)) return
    if (found == class .and. status == 0) return
    call h5dclose_f(dataset, ignored)
    call self%fail(name)
  end subroutine open_dataset

  !> Extents of integers or reals.
  subroutine hdf5_file_extents_of(self, name, extents)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Extents, the fastest first; not allocated upon failure.
    integer(lp), allocatable, intent(out) :: extents(:)
    integer(hid_t) :: dataset, space
    integer(hsize_t), allocatable :: now(:), most(:)
    integer :: status, rank, ignored

    call self%open_dataset(name, -1, dataset)
    if (allocated(self%failure)) return
    call h5dget_space_f(dataset, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    if (status == 0) then
      allocate (now(rank), most(rank))
      if (rank > 0) call h5sget_simple_extent_dims_f(space, now, most, status)
      if (status == rank) extents = int(now, lp)
    end if
    if (.not. allocated(extents)) call self%fail(name)
    call h5sclose_f(space, ignored)
    call h5dclose_f(dataset, ignored)
  end subroutine hdf5_file_extents_of

  !> Read reals.
  subroutine hdf5_file_read_reals(self, name, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values, as many as there are.
    real(wp), contiguous, target, intent(inout) :: values(:)

    if (size(values) > 0) then
      call self%read_values(name, h5t_float_f, real_type(), c_loc(values))
    end if
  end subroutine hdf5_file_read_reals

  !> Read integers.
  subroutine hdf5_file_read_integers(self, name, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values, as many as there are.
    integer(lp), contiguous, target, intent(inout) :: values(:)

    if (size(values) > 0) then
      call self%read_values(name, h5t_integer_f, long_type(), c_loc(values))
    end if
  end subroutine hdf5_file_read_integers

  !> Read a text.
  subroutine hdf5_file_read_text(self, name, text)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The text; empty upon failure.
    character(:), allocatable, intent(out) :: text
    character(:), allocatable, target :: bytes
    integer(hid_t) :: dataset, kind
    integer(size_t) :: length
    integer :: status, ignored

    text = ''
    call self%open_dataset(name, h5t_string_f, dataset)
    if (allocated(self%failure)) return
    call h5dget_type_f(dataset, kind, status)
    call h5tget_size_f(kind, length, status)
    call h5tclose_f(kind, ignored)
    call h5dclose_f(dataset, ignored)
    allocate (character(length) :: bytes)
    call make_text_type(int(length), kind)
    call self%read_values(name, h5t_string_f, kind, c_loc(bytes(1:1)))
    call h5tclose_f(kind, ignored)
    if (.not. allocated(self%failure)) text = bytes(:verify(bytes, achar(0), back=.true.))
  end subroutine hdf5_file_read_text

  !> Read a whole dataset.
  subroutine read_values(self, name, class, memory_type, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Class that its type must have.
    integer, intent(in) :: class
    !> Type in memory.
    integer(hid_t), intent(in) :: memory_type
    !> Address of the values.
    type(c_ptr), intent(in) :: values
    integer(hid_t) :: dataset
    type(c_ptr) :: address
    integer :: status, ignored

    call self%open_dataset(name, class, dataset)
    if (allocated(self%failure)) return
    address = values
    call h5dread_f(dataset, memory_type, address, status)
    if (status /= 0) call self%fail(name)
    call h5dclose_f(dataset, ignored)
  end subroutine read_values

  !> Give the current group an attribute of integers; one of that name has as many.
  subroutine set_integers(self, name, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values; one is written as a scalar.
    integer(lp), contiguous, target, intent(in) :: values(:)
    integer(hid_t) :: space
    integer :: status

    if (allocated(self%failure)) return
    if (size(values) == 1) then
      call h5screate_f(h5s_scalar_f, space, status)
    else
      call h5screate_simple_f(1, [size(values, kind=hsize_t)], space, status)
    end if
    call write_attribute(self, name, h5t_std_i64le, long_type(), space, c_loc(values))
    call h5sclose_f(space, status)
  end subroutine set_integers

  !> Give the current group an attribute of text, in place of any of that name.
  subroutine set_text(self, name, text)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The text.
    character(*), intent(in) :: text
    character(:), allocatable, target :: bytes
    integer(hid_t) :: space, kind
    integer :: status

    if (allocated(self%failure)) return
    call h5screate_f(h5s_scalar_f, space, status)
    call make_text_type(len(text), kind)
    bytes = text//achar(0)
    call write_attribute(self, name, kind, kind, space, c_loc(bytes(1:1)))
    call h5tclose_f(kind, status)
    call h5sclose_f(space, status)
  end subroutine set_text

  !> Write an attribute of the current group; numbers are written over those that are there.
  subroutine write_attribute(self, name, file_type, memory_type, space, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Type in the file.
    integer(hid_t), intent(in) :: file_type
    !> Type in memory.
    integer(hid_t), intent(in) :: memory_type
    !> Its space.
    integer(hid_t), intent(in) :: space
    !> Address of the values.
    type(c_ptr), intent(in) :: values
    integer(hid_t) :: attribute
    type(c_ptr) :: address
    integer :: status, ignored
    logical :: there

    call h5aexists_f(self%here(), name, there, status)
    if (status == 0 .and. there .and. file_type == memory_type) then
      call h5adelete_f(self%here(), name, status)
      there = .false.
    end if
    if (status == 0 .and. there) then
      call h5aopen_f(self%here(), name, attribute, status)
    else if (status == 0) then
      call h5acreate_f(self%here(), name, file_type, space, attribute, status)
    end if
    if (status == 0) then
      address = values
      call h5awrite_f(attribute, memory_type, address, status)
      call h5aclose_f(attribute, ignored)
    end if
    if (status /= 0) call self%fail(name)
  end subroutine write_attribute

  !> Make a dataset of extent 0 that can grow along its last index.
  subroutine hdf5_file_create_series(self, name, kind, extents, chunk, deflate)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> `real`, `integer` or `byte`.
    character(*), intent(in) :: kind
    !> Extents in front of the last; none for a list of numbers.
    integer(lp), intent(in) :: extents(:)
    !> Entries along the last index in a chunk.
    integer(lp), intent(in) :: chunk
    !> Level of compression, 0 to 9; 0 for none.
    integer, intent(in) :: deflate
    integer(hid_t) :: space, list, dataset, file_type
    integer(hsize_t) :: now(size(extents) + 1), most(size(extents) + 1)
    integer :: status, ignored

    if (allocated(self%failure)) return
    select case (kind)
    case ('real')
      file_type = h5t_ieee_f64le
    case ('integer')
      file_type = h5t_std_i64le
    case default
      file_type = h5t_std_u8le
    end select
    now = [int(extents, hsize_t), 0_hsize_t]
    most = [int(extents, hsize_t), h5s_unlimited_f]
    call h5screate_simple_f(size(now), now, space, status, most)
    call h5pcreate_f(h5p_dataset_create_f, list, status)
    now(size(now)) = chunk
    call h5pset_chunk_f(list, size(now), now, status)
    if (deflate > 0) then
      call h5pset_shuffle_f(list, status)
      if (status == 0) call h5pset_deflate_f(list, deflate, status)
    end if
    if (status == 0) then
      call self%make_dataset(name, file_type, space, list, dataset)
      if (.not. allocated(self%failure)) call h5dclose_f(dataset, ignored)
    else
      call self%fail(name)
    end if
    call h5pclose_f(list, ignored)
    call h5sclose_f(space, ignored)
  end subroutine hdf5_file_create_series

  !> Append reals to a dataset.
  subroutine append_reals(self, name, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values, whole entries along the last index.
    real(wp), contiguous, target, intent(in) :: values(:)

    if (size(values) > 0) then
      call self%append_values(name, real_type(), size(values, kind=lp), c_loc(values))
    end if
  end subroutine append_reals

  !> Append integers to a dataset.
  subroutine append_integers(self, name, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Values, whole entries along the last index.
    integer(lp), contiguous, target, intent(in) :: values(:)

    if (size(values) > 0) then
      call self%append_values(name, long_type(), size(values, kind=lp), c_loc(values))
    end if
  end subroutine append_integers

  !> Append values to a dataset.
  subroutine append_values(self, name, memory_type, n, values)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> Type in memory.
    integer(hid_t), intent(in) :: memory_type
    !> Number of values.
    integer(lp), intent(in) :: n
    !> Their address.
    type(c_ptr), intent(in) :: values
    integer(hid_t) :: dataset, space, memory
    integer(lp), allocatable :: extents(:)
    integer(hsize_t), allocatable :: first(:), counts(:)
    type(c_ptr) :: address
    integer :: status, ignored, rank

    call self%extents_of(name, extents)
    if (allocated(self%failure)) return
    rank = size(extents)
    allocate (first(rank), counts(rank))
    first = 0
    first(rank) = extents(rank)
    counts(:) = int(extents, hsize_t)
    counts(rank) = n/max(1_lp, product(extents(:rank - 1)))
    extents(rank) = extents(rank) + counts(rank)
    call self%open_dataset(name, -1, dataset)
    if (allocated(self%failure)) return
    call h5dset_extent_f(dataset, int(extents, hsize_t), status)
    if (status == 0) then
      call h5dget_space_f(dataset, space, status)
      call h5sselect_hyperslab_f(space, h5s_select_set_f, first, counts, status)
      call h5screate_simple_f(rank, counts, memory, status)
      address = values
      call h5dwrite_f(dataset, memory_type, address, status, mem_space_id=memory, &
                      file_space_id=space)
      call h5sclose_f(memory, ignored)
      call h5sclose_f(space, ignored)
    end if
    if (status /= 0) call self%fail(name)
    call h5dclose_f(dataset, status)
    if (status /= 0) call self%fail(name)
  end subroutine append_values

  !> Change the extent of a dataset along its last index.
  subroutine hdf5_file_resize(self, name, n)
    !> The file.
    class(hdf5_file_t), intent(inout) :: self
    !> Name.
    character(*), intent(in) :: name
    !> The new extent.
    integer(lp), intent(in) :: n
    integer(hid_t) :: dataset
    integer(lp), allocatable :: extents(:)
    integer :: status, ignored

    call self%extents_of(name, extents)
    if (allocated(self%failure)) return
    call self%open_dataset(name, -1, dataset)
    if (allocated(self%failure)) return
    extents(size(extents)) = n
    call h5dset_extent_f(dataset, int(extents, hsize_t), status)
    if (status /= 0) call self%fail(name)
    call h5dclose_f(dataset, ignored)
  end subroutine hdf5_file_resize

  !> The library's type of `wp` in memory.
  function real_type() result(kind)
    !> Its identifier.
    integer(hid_t) :: kind

    kind = h5kind_to_type(wp, h5_real_kind)
  end function real_type

  !> The library's type of `lp` in memory.
  function long_type() result(kind)
    !> Its identifier.
    integer(hid_t) :: kind

    kind = h5kind_to_type(lp, h5_integer_kind)
  end function long_type

  !> A type of texts of one length, null characters at the end.
  subroutine make_text_type(length, kind)
    !> Bytes; an empty text takes one null character.
    integer, intent(in) :: length
    !> Its identifier, to be closed.
    integer(hid_t), intent(out) :: kind
    integer :: status

    call h5tcopy_f(h5t_c_s1, kind, status)
    call h5tset_size_f(kind, int(max(1, length), size_t), status)
    call h5tset_strpad_f(kind, h5t_str_nullpad_f, status)
  end subroutine make_text_type

end module mpm_hdf5_file
