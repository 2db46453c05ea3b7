!> The role `points`: the material points of one body.
module mpm_points
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_huge_pages, only: use_huge_pages
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_memory, only: size_text, way_to_more
  use mpm_permutation, only: permutation_t
  use mpm_description, only: description_t
  use mpm_digest, only: digest_t
  use mpm_document, only: value_t
  use mpm_point_domains, only: point_domains_t, rule_none
  use mpm_properties, only: properties_t
  use mpm_seam, only: widen_at_seam, wrap_points
  use mpm_sort, only: base_bounds, sort_by_cell
  use mpm_threads, only: useful_threads
  use mpm_stencil, only: outside, stencil_keys, stencil_t
  use mpm_store, only: store_t
  use mpm_strings, only: counted
  use mpm_window, only: window_t
  implicit none
  private
  public :: bytes_per_point, points_restore, points_save, points_t

  !> Mass of a node whose velocity leaves out internal forces, relative to the points' mean mass.
  !!
  !! The force of a point on a node does not vanish with the point's weight there, so that the
  !! acceleration of a node that a point has just reached has no bound.
  real(wp), parameter :: relative_cutoff = 1.0e-9_wp

  !> Points of a checkpoint, from which points are set up in place of a file.
  type :: kept_points_t
    !> Number of points, and of those inside the grid.
    integer :: n = 0, n_inside = 0
    !> Positions in the points file. (n)
    integer, allocatable :: id(:)
    !> Masses [kg], volumes [m3] and half sides of the boxes [m]. (n)
    real(wp), allocatable :: mass(:), volume(:), extent(:)
    !> Positions [m] (dim, n) and velocities [m/s] (nvel, n).
    real(wp), allocatable :: x(:, :), velocity(:, :)
    !> Digest of the points as they were read.
    character(:), allocatable :: digest
  end type kept_points_t

  !> Material points as arrays, component first.
  !!
  !! The arrays are in storage order: cell by cell at the last full sort, points that are inactive
  !! or outside the grid at the end, behind `n_inside`. `id` gives the position in the file.
  type, abstract, extends(configurable_t) :: points_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
    !> Number of points.
    integer :: n = 0
    !> Number of points that are active and inside the grid; they are stored first.
    integer :: n_inside = 0
    !> Number of points that were active at the start and have left the grid.
    integer :: n_lost = 0
    !> The file of the points, for messages; empty when there is none.
    character(:), allocatable :: file
    !> Line in `file` of the point with the largest box.
    integer :: widest_line = 0
    !> Bytes that the points may take when they are made.
    integer(lp) :: memory_room = huge(1_lp)
    !> Position in the points file, from 1. (n)
    integer, allocatable :: id(:)
    !> Mass. [kg] (n)
    real(wp), allocatable :: mass(:)
    !> Volume. [m3] (n)
    real(wp), allocatable :: volume(:)
    !> Half side of the point's box, of its initial volume. [m] (n)
    real(wp), allocatable :: extent(:)
    !> Position. [m] (dim, n)
    real(wp), allocatable :: x(:, :)
    !> Displacement. [m] (nvel, n)
    real(wp), allocatable :: displacement(:, :)
    !> Velocity. [m/s] (nvel, n)
    real(wp), allocatable :: velocity(:, :)
    !> Cauchy stress. [Pa] (nstress, n)
    real(wp), allocatable :: stress(:, :)
    !> What the material remembers of each point besides the stress. (n_history, n)
    real(wp), allocatable :: history(:, :)
    !> Velocity gradient of the last step that was asked to keep it; 0 before. [1/s] (ngrad, n)
    real(wp), allocatable :: gradient(:, :)
    !> Shear rate sqrt(2 D':D') of the last step that was asked to keep it, for frames that need no
    !> more than that; 0 before. [1/s] (n)
    real(wp), allocatable :: shear_rate(:)
    !> Acceleration by the body force, the same for all points. [m/s2]
    real(wp) :: body_force(3) = 0.0_wp
    !> Acceleration by a body force that differs from point to point; not allocated when there is
    !> none. [m/s2] (nvel, n)
    real(wp), allocatable :: load(:, :)
    !> Gradient of the point's own field of velocities, components as the first of the velocity
    !! gradient; not allocated unless the solver maps such fields. [1/s] (nvel dim, n)
    real(wp), allocatable :: affine(:, :)
    !> Volume at the start, for solvers that ask for it. [m3] (n)
    real(wp), allocatable :: reference_volume(:)
    !> Volume that the material sees, where it is not `volume`. [m3] (n)
    real(wp), allocatable :: smoothed_volume(:)
    !> Sums of the shifts that were no motion of the material; not allocated unless positions are
    !! corrected. [m] (dim, n)
    real(wp), allocatable :: shifted(:, :)
    !> The velocity gradients of every step are kept.
    logical :: needs_gradient = .false.
    !> What the points have to tell the user, once; not allocated when there is nothing.
    character(:), allocatable :: remark
    !> Domains over which functions are averaged, and lists of nodes; not allocated where the basis
    !! is that of `stencil`.
    type(point_domains_t), allocatable :: domains
    !> The basis between points and nodes.
    type(stencil_t) :: stencil
    !> Key of the stencil, or `outside`. (n)
    integer, allocatable :: key(:)
    !> Slots of the points inside in the order of their cells. (n_inside)
    integer, allocatable :: order(:)
    !> Points before each row of cells in `order`. (0:rows)
    integer, allocatable :: row_offset(:)
    !> The velocity of a node with no more mass than this leaves out internal forces. [kg]
    real(wp) :: mass_cutoff = 0.0_wp
    !> Lowest and highest first node of all stencils.
    integer :: lo(3) = 0, hi(3) = -1
    !> Points whose key changed since `order` was made.
    integer :: n_changed = 0
    !> Points whose key changed since the arrays were sorted.
    integer :: n_drifted = 0
    !> Digest of the points as they were read; not allocated until `sign` is called.
    character(:), allocatable :: digest
    !> Points of a checkpoint for `init`; not allocated when there are none.
    type(kept_points_t), allocatable :: kept
    !> Whether they were taken in place of a file.
    logical :: is_revived = .false.
  contains
    !> Read or make the points.
    procedure(init_i), deferred :: init
    !> Send the fields of a frame.
    procedure(write_fields_i), deferred :: write_fields
    !> Write what the config asks to keep of the points, when the run begins.
    procedure :: write_table => points_write_table
    !> Whether the functions are averaged over the corners of the points' boxes.
    procedure :: averages => points_averages
    !> Correct positions at the end of a step.
    procedure :: correct => points_correct
    !> Send nodal fields of the points for a frame.
    procedure :: write_node_fields => points_write_node_fields
    !> Give all arrays their length.
    procedure :: allocate => points_allocate
    !> Take a basis and find the keys of all points.
    procedure :: locate => points_locate
    !> Bring the order of cells up to date; switch off points that left the grid.
    procedure :: refresh_order => points_refresh_order
    !> Put all arrays into another order.
    procedure :: permute => points_permute
    !> Storage slot of each point of the points file.
    procedure :: slots => points_slots
    !> Take the digest of the points as they are.
    procedure :: sign => points_sign
    !> See that points have room in memory before they are made.
    procedure :: claim => points_claim
    !> Bytes that the points hold.
    procedure :: memory => points_memory
    !> Put the arrays of a step into huge pages.
    procedure :: use_huge_pages => points_use_huge_pages
    !> Look for points of this class in a checkpoint.
    procedure :: keep => points_keep
    !> Take them in place of those of a file.
    procedure :: revive => points_revive
    procedure :: save => points_save
    procedure :: restore => points_restore
    !> The nodes that the stencils of the points reach.
    procedure :: reach => points_reach
  end type points_t

  abstract interface
    !> Read or make the points.
    subroutine init_i(self, grid, properties, point_file, config_file, error)
      import :: error_t, grid_t, points_t, properties_t, value_t
      implicit none
      !> The points.
      class(points_t), intent(inout) :: self
      !> The grid; gives the component counts and tells which positions are inside.
      class(grid_t), intent(in) :: grid
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> The key `point-file`.
      type(value_t), intent(in) :: point_file
      !> The config, beside which a relative path is looked for.
      character(*), intent(in) :: config_file
      !> A missing or bad points file.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Send the fields of a frame.
    subroutine write_fields_i(self, writer)
      import :: field_writer_t, points_t
      implicit none
      !> The points.
      class(points_t), intent(in) :: self
      !> Receiver of point fields.
      class(field_writer_t), intent(inout) :: writer
    end subroutine write_fields_i
  end interface

contains

  !> Most points come from a file and leave none.
  subroutine points_write_table(self, error)
    !> The points.
    class(points_t), intent(inout) :: self
    !> A table that can't be written.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self)
    end associate
  end subroutine points_write_table

  !> Most points do as the solver says; domains have means of their own.
  pure function points_averages(self, cpdi) result(averages)
    !> The points.
    class(points_t), intent(in) :: self
    !> What the solver asks for.
    logical, intent(in) :: cpdi
    !> Whether the functions are averaged over the corners of the points' boxes.
    logical :: averages

    averages = cpdi .and. .not. allocated(self%domains)
  end function points_averages

  !> Most points stay where their motion takes them.
  subroutine points_correct(self, step, dt, threads)
    !> The points, moved, with the velocity gradients of the step if they need them.
    class(points_t), intent(inout) :: self
    !> Number of the step, from 1.
    integer(lp), intent(in) :: step
    !> Its length. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads

    associate (unused => self, unused_step => step, unused_dt => dt, unused_threads => threads)
    end associate
  end subroutine points_correct

  !> Most points have no nodal fields.
  subroutine points_write_node_fields(self, writer)
    !> The points.
    class(points_t), intent(in) :: self
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => self, unused_writer => writer)
    end associate
  end subroutine points_write_node_fields

  !> Give all arrays their length; those that are there already stay, all others are 0 and in the
  !! order of the points file.
  subroutine points_allocate(self, kin, n)
    !> The points.
    class(points_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points.
    integer, intent(in) :: n
    integer :: i

    self%kin = kin
    self%n = n
    self%n_inside = n
    self%file = ''
    if (.not. allocated(self%id)) then
      allocate (self%id(n))
      do i = 1, n
        self%id(i) = i
      end do
    end if
    if (.not. allocated(self%mass)) allocate (self%mass(n), source=0.0_wp)
    if (.not. allocated(self%volume)) allocate (self%volume(n), source=0.0_wp)
    if (.not. allocated(self%extent)) allocate (self%extent(n), source=0.0_wp)
    if (.not. allocated(self%x)) allocate (self%x(kin%dim, n), source=0.0_wp)
    if (.not. allocated(self%velocity)) allocate (self%velocity(kin%nvel, n), source=0.0_wp)
    allocate (self%displacement(kin%nvel, n), self%stress(kin%nstress, n))
    call use_huge_pages(self%displacement)
    call use_huge_pages(self%stress)
    self%displacement = 0.0_wp
    self%stress = 0.0_wp
    allocate (self%key(n), source=outside)
    allocate (self%order(n), self%history(0, n))
  end subroutine points_allocate

  !> Put the arrays of a step into huge pages.
  subroutine points_use_huge_pages(self)
    !> The points.
    class(points_t), intent(in) :: self

    call use_huge_pages(self%mass)
    call use_huge_pages(self%volume)
    call use_huge_pages(self%extent)
    call use_huge_pages(self%x)
    call use_huge_pages(self%displacement)
    call use_huge_pages(self%velocity)
    call use_huge_pages(self%stress)
    call use_huge_pages(self%history)
    call use_huge_pages(self%gradient)
    call use_huge_pages(self%shear_rate)
    call use_huge_pages(self%affine)
    call use_huge_pages(self%key)
    call use_huge_pages(self%order)
  end subroutine points_use_huge_pages

  !> Take a basis and find the keys of all points; `refresh_order` sorts them.
  subroutine points_locate(self, stencil)
    !> The points.
    class(points_t), intent(inout) :: self
    !> Basis.
    type(stencil_t), intent(in) :: stencil

    self%stencil = stencil
    if (allocated(stencil%mesh) .and. .not. allocated(self%domains)) then
      ! Functions of a mesh are no products: its points have lists of nodes.
      allocate (self%domains)
      self%domains%rule = rule_none
      self%domains%dim = stencil%dim
    end if
    if (any(stencil%periodic)) then
      call wrap_points(stencil, self%n_inside, self%x(:, :self%n_inside))
    end if
    self%mass_cutoff = relative_cutoff*sum(self%mass)/real(self%n, wp)
    call stencil_keys(stencil, self%n_inside, self%x(:, :self%n_inside), &
                      self%extent(:self%n_inside), self%key(:self%n_inside))
    call base_bounds(stencil, self%n_inside, self%key(:self%n_inside), self%lo, self%hi)
    self%n_changed = 1
    self%n_drifted = self%n
  end subroutine points_locate

  !> Bring the order of cells up to date; switch off points that left the grid.
  !!
  !! Only the list `order` is made anew when points changed their cell; the arrays themselves are
  !! sorted when an eighth of the points have, or when a point must go to the end.
  subroutine points_refresh_order(self, threads)
    !> The points.
    class(points_t), intent(inout) :: self
    !> Number of threads; 1 when left out.
    integer, intent(in), optional :: threads
    integer :: n_left, p, k, inside_now, team
    integer, allocatable :: order(:)

    if (self%n_changed == 0) return
    self%n_changed = 0
    n_left = count(self%key(:self%n_inside) == outside)
    if (n_left > 0) then
      inside_now = self%n_inside - n_left
      allocate (order(self%n))
      k = 0
      do p = 1, self%n_inside
        if (self%key(p) == outside) then
          order(inside_now + p - k) = p
        else
          k = k + 1
          order(k) = p
        end if
      end do
      order(self%n_inside + 1:) = [(p, p=self%n_inside + 1, self%n)]
      call self%permute(order)
      deallocate (order)
      self%n_inside = inside_now
      self%n_lost = self%n_lost + n_left
    end if
    if (self%n_inside == 0) return
    team = 1
    if (present(threads)) team = useful_threads(threads, self%n_inside)
    call sort_by_cell(self%stencil, self%n_inside, self%key(:self%n_inside), self%lo, self%hi, &
                      self%order(:self%n_inside), self%row_offset, team)
    if (self%n_drifted < self%n_inside/8) return
    self%n_drifted = 0
    do p = self%n_inside + 1, self%n
      self%order(p) = p
    end do
    call self%permute(self%order, team)
    do p = 1, self%n_inside
      self%order(p) = p
    end do
  end subroutine points_refresh_order

  !> Put all arrays into another order: slot i receives what was in slot order(i).
  subroutine points_permute(self, order, threads)
    !> The points.
    class(points_t), intent(inout) :: self
    !> A permutation of the slots. (n)
    integer, intent(in) :: order(:)
    !> Number of threads; 1 when left out.
    integer, intent(in), optional :: threads
    type(permutation_t) :: permutation

    call permutation%init(order, threads)
    call permutation%apply(self%id)
    call permutation%apply(self%key)
    call permutation%apply(self%mass)
    call permutation%apply(self%volume)
    call permutation%apply(self%extent)
    call permutation%apply(self%x)
    call permutation%apply(self%displacement)
    call permutation%apply(self%velocity)
    call permutation%apply(self%stress)
    if (size(self%history, 1) > 0) call permutation%apply(self%history)
    if (allocated(self%gradient)) call permutation%apply(self%gradient)
    if (allocated(self%shear_rate)) call permutation%apply(self%shear_rate)
    if (allocated(self%load)) call permutation%apply(self%load)
    if (allocated(self%affine)) call permutation%apply(self%affine)
    if (allocated(self%reference_volume)) call permutation%apply(self%reference_volume)
    if (allocated(self%smoothed_volume)) call permutation%apply(self%smoothed_volume)
    if (allocated(self%shifted)) call permutation%apply(self%shifted)
    if (allocated(self%domains)) call self%domains%permute(permutation)
  end subroutine points_permute

  !> Storage slot of each point of the points file.
  pure function points_slots(self) result(slot)
    !> The points.
    class(points_t), intent(in) :: self
    !> Slot by position in the file. (n)
    integer :: slot(self%n)
    integer :: p

    do p = 1, self%n
      slot(self%id(p)) = p
    end do
  end function points_slots

  !> Bytes of a point in the arrays that all points have.
  pure function bytes_per_point(kin) result(bytes)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Bytes.
    integer(lp) :: bytes

    bytes = (storage_size(1.0_wp)/8)*int(3 + kin%dim + 2*kin%nvel + kin%nstress, lp) &
            + (storage_size(1)/8)*3_lp
  end function bytes_per_point

  !> See that points have room in memory before they are made.
  subroutine points_claim(self, n, bytes_each, error)
    !> The points.
    class(points_t), intent(in) :: self
    !> Their number, or that of points in addition.
    integer(lp), intent(in) :: n
    !> Bytes that each of them takes.
    integer(lp), intent(in) :: bytes_each
    !> `err_input`, without a place, when there is no room.
    type(error_t), allocatable, intent(out) :: error

    if (n <= self%memory_room/bytes_each) return
    call raise(error, err_input, counted(n, 'point')//' need '// &
               size_text(min(n, huge(n)/bytes_each)*bytes_each)//' of memory, more than there &
               &is ('//size_text(self%memory_room)//')', &
               hint='use fewer points, or '//way_to_more())
  end subroutine points_claim

  !> Bytes that the points hold.
  pure function points_memory(self) result(bytes)
    !> The points.
    class(points_t), intent(in) :: self
    !> Bytes.
    integer(lp) :: bytes
    integer(lp) :: reals

    reals = 0
    bytes = 0
    if (.not. allocated(self%mass)) return
    reals = size(self%mass, kind=lp) + size(self%volume, kind=lp) + size(self%extent, kind=lp) &
            + size(self%x, kind=lp) + size(self%displacement, kind=lp) &
            + size(self%velocity, kind=lp) + size(self%stress, kind=lp) &
            + size(self%history, kind=lp)
    if (allocated(self%gradient)) reals = reals + size(self%gradient, kind=lp)
    if (allocated(self%shear_rate)) reals = reals + size(self%shear_rate, kind=lp)
    if (allocated(self%load)) reals = reals + size(self%load, kind=lp)
    if (allocated(self%affine)) reals = reals + size(self%affine, kind=lp)
    if (allocated(self%reference_volume)) reals = reals + size(self%reference_volume, kind=lp)
    if (allocated(self%smoothed_volume)) reals = reals + size(self%smoothed_volume, kind=lp)
    if (allocated(self%shifted)) reals = reals + size(self%shifted, kind=lp)
    bytes = (reals*storage_size(1.0_wp, lp) + 3*size(self%id, kind=lp)*storage_size(1, lp))/8
    if (allocated(self%domains)) bytes = bytes + self%domains%memory()
  end function points_memory

  !> Take the digest of the points as they are, so that a restart knows them again.
  subroutine points_sign(self)
    !> The points, in the order of the points file.
    class(points_t), intent(inout) :: self
    type(digest_t) :: digest

    if (self%is_revived) return
    call digest%add(self%mass)
    call digest%add(self%volume)
    call digest%add_columns(self%x)
    self%digest = digest%text()
  end subroutine points_sign

  !> Look for points of this class in a checkpoint.
  !!
  !! What is not there, or of another class, is left to the end of the restart, which tells of it.
  subroutine points_keep(self, kin, store, error)
    !> The points, before `init`.
    class(points_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The checkpoint, at the points of the body.
    class(store_t), intent(inout) :: store
    !> More points than there is memory for.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    character(:), allocatable :: class

    call self%describe(description)
    call store%get('class', class)
    if (allocated(store%failure) .or. class /= description%name) return
    allocate (self%kept)
    associate (kept => self%kept)
      call store%get('n', kept%n)
      call self%claim(int(kept%n, lp), bytes_per_point(kin), error)
      if (allocated(error)) return
      call store%get('n_inside', kept%n_inside)
      call store%get('id', kept%id)
      call store%get('mass', kept%mass)
      call store%get('volume', kept%volume)
      call store%get('extent', kept%extent)
      call store%get('x', kept%x)
      call store%get('velocity', kept%velocity)
      call store%get('digest', kept%digest)
      if (.not. allocated(store%failure)) then
        if (size(kept%x, 1) == kin%dim .and. size(kept%velocity, 1) == kin%nvel) return
      end if
    end associate
    deallocate (self%kept)
  end subroutine points_keep

  !> Take the points of a checkpoint in place of those of a file.
  !!
  !! They are set up as they were saved; `restore` adds the rest when the run has been started.
  subroutine points_revive(self, kin)
    !> The points, with `kept` points.
    class(points_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    type(kept_points_t), allocatable :: kept

    call move_alloc(self%kept, kept)
    call move_alloc(kept%id, self%id)
    call move_alloc(kept%mass, self%mass)
    call move_alloc(kept%volume, self%volume)
    call move_alloc(kept%extent, self%extent)
    call move_alloc(kept%x, self%x)
    call move_alloc(kept%velocity, self%velocity)
    call self%allocate(kin, kept%n)
    self%n_inside = kept%n_inside
    call move_alloc(kept%digest, self%digest)
    self%is_revived = .true.
  end subroutine points_revive

  !> Save all arrays in storage order.
  !!
  !! Public since a class that overrides it can't call it by the name of an abstract parent.
  subroutine points_save(self, store)
    !> The points.
    class(points_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store
    character(:), allocatable :: digest

    digest = ''
    if (allocated(self%digest)) digest = self%digest
    call store%put('digest', digest)
    call store%put('n', self%n)
    call store%put('n_inside', self%n_inside)
    call store%put('n_lost', self%n_lost)
    call store%put('n_changed', self%n_changed)
    call store%put('n_drifted', self%n_drifted)
    call store%put('lo', self%lo)
    call store%put('hi', self%hi)
    call store%put('mass_cutoff', self%mass_cutoff)
    call store%put('id', self%id)
    call store%put('key', self%key)
    call store%put('order', self%order(:self%n_inside))
    if (allocated(self%row_offset)) call store%put('row_offset', self%row_offset)
    call store%put('mass', self%mass)
    call store%put('volume', self%volume)
    call store%put('extent', self%extent)
    call store%put('x', self%x)
    call store%put('displacement', self%displacement)
    call store%put('velocity', self%velocity)
    call store%put('stress', self%stress)
    if (size(self%history, 1) > 0) call store%put('history', self%history)
    if (allocated(self%gradient)) call store%put('gradient', self%gradient)
    if (allocated(self%shear_rate)) call store%put('shear_rate', self%shear_rate)
    if (allocated(self%load)) call store%put('load', self%load)
    if (allocated(self%affine)) call store%put('affine', self%affine)
    if (allocated(self%reference_volume)) then
      call store%put('reference_volume', self%reference_volume)
    end if
    if (allocated(self%smoothed_volume)) call store%put('smoothed_volume', self%smoothed_volume)
    if (allocated(self%shifted)) call store%put('shifted', self%shifted)
    if (allocated(self%domains)) then
      call store%enter('domains')
      call self%domains%save(store)
      call store%leave()
    end if
  end subroutine points_save

  !> Take back all arrays.
  subroutine points_restore(self, store)
    !> The points, started.
    class(points_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store
    character(:), allocatable :: digest
    integer, allocatable :: list(:)
    integer :: n

    call store%get('digest', digest)
    n = self%n
    call store%get('n', n)
    if (.not. allocated(store%failure) .and. (n /= self%n .or. digest /= self%digest)) then
      call raise(store%failure, err_input, 'the points are not those of the run that was saved', &
                 file=self%file, hint='the points file has changed since, or point-file or &
                 &point-class name another one')
    end if
    call store%get('n_inside', self%n_inside)
    call store%get('n_lost', self%n_lost)
    call store%get('n_changed', self%n_changed)
    call store%get('n_drifted', self%n_drifted)
    call store%get_fixed('lo', self%lo)
    call store%get_fixed('hi', self%hi)
    call store%get('mass_cutoff', self%mass_cutoff)
    call store%get('id', self%id)
    call store%get('key', self%key)
    call store%get('order', list)
    if (allocated(store%failure)) return
    self%order(:self%n_inside) = list
    if (store%has('row_offset')) then
      call store%get('row_offset', list)
      if (allocated(store%failure)) return
      if (allocated(self%row_offset)) deallocate (self%row_offset)
      allocate (self%row_offset(0:size(list) - 1))
      self%row_offset(:) = list
    end if
    call store%get('mass', self%mass)
    call store%get('volume', self%volume)
    call store%get('extent', self%extent)
    call store%get('x', self%x)
    call store%get('displacement', self%displacement)
    call store%get('velocity', self%velocity)
    call store%get('stress', self%stress)
    if (size(self%history, 1) > 0) call store%get('history', self%history)
    if (store%has('gradient')) call store%get('gradient', self%gradient)
    if (store%has('shear_rate')) call store%get('shear_rate', self%shear_rate)
    if (store%has('load')) call store%get('load', self%load)
    if (store%has('affine')) call store%get('affine', self%affine)
    if (store%has('reference_volume')) then
      call store%get('reference_volume', self%reference_volume)
    end if
    if (store%has('smoothed_volume')) call store%get('smoothed_volume', self%smoothed_volume)
    if (store%has('shifted')) call store%get('shifted', self%shifted)
    if (allocated(self%domains)) then
      call store%enter('domains')
      call self%domains%restore(store)
      call store%leave()
    end if
  end subroutine points_restore

  !> The nodes that the stencils of the points reach, with ghosts at seams; none when no point is
  !! inside.
  pure function points_reach(self) result(window)
    !> The points.
    class(points_t), intent(in) :: self
    !> Box of the nodes.
    type(window_t) :: window

    if (self%hi(1) < 0) return
    window%lo = self%lo
    window%n = 1
    if (allocated(self%stencil%mesh)) then
      window%n(1) = self%hi(1) - self%lo(1) + 1
      return
    end if
    associate (dim => self%stencil%dim)
      window%n(:dim) = self%hi(:dim) - self%lo(:dim) + self%stencil%width
    end associate
    call widen_at_seam(self%stencil, window)
  end function points_reach

end module mpm_points
