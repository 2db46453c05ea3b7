!> Explicit time integration with volumes smoothed over cells, against locking.
module mpm_explicit_usl_with_volumetric_strain_smoothing
  use mpm_advance, only: trace_of_gradient
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_solver, only: explicit_solver_restore, explicit_solver_save
  use mpm_explicit_steps, only: advance_stress, bad_stress, raise_bad_point, update_points
  use mpm_explicit_usl, only: explicit_usl_step, explicit_usl_t
  use mpm_file_system, only: file_size, truncate_file
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t, type_plane_strain
  use mpm_material, only: material_t
  use mpm_mesh_grid, only: mesh_grid_t
  use mpm_model, only: model_t
  use mpm_phase_clock, only: phase_material
  use mpm_point_domains, only: rule_cpdi2
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: block_size
  use mpm_store, only: store_t
  use mpm_strings, only: excerpt, nearest_name, string_t
  use mpm_threads, only: useful_threads
  use mpm_volume_metrics, only: write_volume_metrics
  use mpm_volume_smoothing, only: cells_t, smooth_by_cells, smooth_by_flux, smooth_by_nodes
  implicit none
  private
  public :: explicit_usl_with_volumetric_strain_smoothing_t

  !> Ways of smoothing.
  integer, parameter :: zhang_cells = 1, mast_cells = 2, zhang_flux = 3

  !> ExplicitUSL with volumes, and the rates of volume that materials see, smoothed over cells.
  type, extends(explicit_usl_t) :: explicit_usl_with_volumetric_strain_smoothing_t
    !> Way of smoothing.
    integer :: method = zhang_cells
    !> The points keep their own volumes; only the material sees the smoothed ones.
    logical :: material_only = .false.
    !> File of error metrics; empty for none.
    character(:), allocatable :: metrics_file
    !> Steps between two lines of metrics.
    integer :: stride = 1
    !> Lengths of the box of cells of the flux method; 0 for those of the grid. [m]
    real(wp) :: length(2) = 0.0_wp
    !> Cells of the flux method in each direction; 0 for those of the grid.
    integer :: n_cells(2) = 0
    !> Lines of metrics written so far.
    integer, private :: lines = 0
    !> Bytes of the file of metrics to go on behind; negative for all that it has.
    integer(lp), private :: kept_bytes = -1
    !> The properties, until the TYPE is known.
    type(properties_t), private :: properties
  contains
    procedure, nopass :: describe => strain_smoothing_describe
    procedure :: init => strain_smoothing_init
    procedure :: start => strain_smoothing_start
    procedure :: step => strain_smoothing_step
    procedure :: save => strain_smoothing_save
    procedure :: restore => strain_smoothing_restore
    procedure :: advance_body => strain_smoothing_advance_body
    procedure, private :: read_flags
    procedure, private :: smooth
  end type explicit_usl_with_volumetric_strain_smoothing_t

contains

  !> Purpose and properties of the class.
  subroutine strain_smoothing_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    logical, parameter :: plane(5) = [.false., .true., .false., .false., .false.]

    call description%init('solver', 'ExplicitUSLwithVolumetricStrainSmoothing', &
                          'As ExplicitUSL, with volumes and rates of volume smoothed over cells, &
                          &so that nearly incompressible bodies do not lock.', &
                          'Mast et al., J. Comput. Phys. 231 (2012) 5351-5373; de Souza Neto, &
                          &Peric, Dutko and Owen, IJSS 33 (1996) 3277-3296', &
                          'solver'//nl//'{'//nl// &
                          '    class = "ExplicitUSLwithVolumetricStrainSmoothing"'//nl// &
                          '    int-properties = {1, 1}   # cpdi, contact'//nl// &
                          '    str-properties = {"USE_ZHANG_CELLS"}'//nl//'}')
    call description%add_real('Lx', 'm', 'USE_ZHANG_FLUX: length of the box of cells, from the &
                              &lower corner of the grid; 0: that of the grid', default=0.0_wp, &
                              lower=0.0_wp, types=plane)
    call description%add_real('Ly', 'm', 'as Lx, along y', default=0.0_wp, lower=0.0_wp, &
                              types=plane)
    call description%add_integer('cpdi', 'as of ExplicitUSL', default=1, lower=0, upper=1)
    call description%add_integer('contact', 'as of ExplicitUSL', default=1, lower=0, upper=1)
    call description%add_integer('stride', 'WRITE_ERROR_METRICS: steps between two lines', &
                                 default=1, lower=1)
    call description%add_integer('Nx', 'USE_ZHANG_FLUX: cells along x; 0: those of the grid', &
                                 default=0, lower=0, types=plane)
    call description%add_integer('Ny', 'as Nx, along y', default=0, lower=0, types=plane)
    call description%add_integer('staggered', 'as of ExplicitUSL', default=0, lower=0, upper=1)
    call description%add_string('flags', 'USE_ZHANG_CELLS (default): one mean for each cell; &
                                &USE_MAST_CELLS: a function of each cell; USE_ZHANG_FLUX (TYPE 2): &
                                &means that do not oscillate from cell to cell; the last of these &
                                &three counts. ANTI_LOCKING_ONLY: only materials see the smoothed &
                                &volume. WRITE_ERROR_METRICS: the first string names a file for &
                                &them', &
                                is_list=.true.)
    call description%add_note('Materials get the velocity gradient with its trace replaced by the &
                              &rate of the smoothed volume, d ln V/dt, so that laws in rate form &
                              &do not lock either (mpm_3d: the smoothed volume alone, which those &
                              &do not look at). The difference is shared equally by the diagonal &
                              &components that the TYPE has.')
    call description%add_note('mpm_3d took Nx, Ny as the integers 0, 1 or 2, 3, and the last &
                              &integer as stride; here each has a place of its own, and a name.')
  end subroutine strain_smoothing_describe

  !> Set up from the properties.
  subroutine strain_smoothing_init(self, properties, error)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Flags that there are not, or that do not fit together.
    type(error_t), allocatable, intent(out) :: error

    call self%explicit_usl_t%init(properties, error)
    if (allocated(error)) return
    self%length = [properties%real('Lx'), properties%real('Ly')]
    self%n_cells = [properties%integer('Nx'), properties%integer('Ny')]
    self%stride = properties%integer('stride')
    self%properties = properties
    call self%read_flags(properties, error)
    if (allocated(error)) return
    if (self%method == zhang_flux) return
    if (any(self%n_cells > 0) .or. any(self%length > 0.0_wp)) then
      call properties%reject('Nx', 'Nx, Ny, Lx and Ly are for USE_ZHANG_FLUX', error, &
                             'the other ways take the cells of the grid: leave them out')
    end if
  end subroutine strain_smoothing_init

  !> Read the list of flags.
  subroutine read_flags(self, properties, error)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Flags that there are not, or a file that is missing.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    type(string_t) :: known(5)
    character(:), allocatable :: near
    logical :: writes
    integer :: i, first

    known(1)%text = 'USE_ZHANG_CELLS'
    known(2)%text = 'USE_MAST_CELLS'
    known(3)%text = 'USE_ZHANG_FLUX'
    known(4)%text = 'ANTI_LOCKING_ONLY'
    known(5)%text = 'WRITE_ERROR_METRICS'
    call properties%strings('flags', flags)
    writes = .false.
    do i = 1, size(flags)
      writes = writes .or. flags(i)%text == known(5)%text
    end do
    first = merge(2, 1, writes)
    self%metrics_file = ''
    if (writes) then
      self%metrics_file = flags(1)%text
      if (is_known(self%metrics_file) .or. len(self%metrics_file) == 0) then
        call properties%reject('flags', 'WRITE_ERROR_METRICS needs the name of a file as the first &
                               &string', error, '{"metrics.txt", "WRITE_ERROR_METRICS"}')
        return
      end if
    end if
    do i = first, size(flags)
      select case (flags(i)%text)
      case ('USE_ZHANG_CELLS')
        self%method = zhang_cells
      case ('USE_MAST_CELLS')
        self%method = mast_cells
      case ('USE_ZHANG_FLUX')
        self%method = zhang_flux
      case ('ANTI_LOCKING_ONLY')
        self%material_only = .true.
      case ('WRITE_ERROR_METRICS')
      case default
        near = nearest_name(flags(i)%text, known)
        if (len(near) > 0) near = 'did you mean "'//near//'"?   '
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               near//'(mpm3d --describe &
                               &ExplicitUSLwithVolumetricStrainSmoothing)')
        return
      end select
    end do

  contains

    !> Whether a text is a flag.
    pure function is_known(text)
      !> The text.
      character(*), intent(in) :: text
      !> Whether it is.
      logical :: is_known
      integer :: k

      is_known = any([(known(k)%text == text, k=1, size(known))])
    end function is_known

  end subroutine read_flags

  !> Choose the basis of each body, map the initial state to the nodes, remember the volumes.
  subroutine strain_smoothing_start(self, model, error)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> A TYPE or points that the solver can't take.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    select type (grid => model%grid)
    class is (mesh_grid_t)
      call self%properties%reject('flags', 'the smoothing of strains needs a Cartesian grid', &
                                  error, 'use the solver ExplicitUSL, or a Cartesian grid')
      return
    class default
    end select
    if (self%method == zhang_flux .and. model%kin%sim_type /= type_plane_strain) then
      call self%properties%reject('flags', 'USE_ZHANG_FLUX is for TYPE 2 (plane strain)', error, &
                                  'use USE_ZHANG_CELLS or USE_MAST_CELLS')
      return
    end if
    call self%explicit_usl_t%start(model, error)
    if (allocated(error)) return
    do i = 1, size(model%bodies)
      associate (points => model%bodies(i)%body%points)
        if (allocated(points%domains) .and. .not. self%material_only) then
          if (points%domains%rule == rule_cpdi2) then
            call self%properties%reject('flags', 'the volume of CPDI2 points is that between their &
                                        &corners, which smoothing would change', error, &
                                        'add the flag ANTI_LOCKING_ONLY, or use CPDI')
            return
          end if
        end if
        allocate (points%reference_volume, source=points%volume)
        if (self%material_only) allocate (points%smoothed_volume, source=points%volume)
        if (allocated(points%gradient)) cycle
        allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
      end associate
    end do
  end subroutine strain_smoothing_start

  !> Advance the model by one step, and write a line of metrics.
  subroutine strain_smoothing_step(self, model, dt, keep_gradient, error)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients, for a frame.
    logical, intent(in) :: keep_gradient
    !> The simulation went bad, or metrics can't be written.
    type(error_t), allocatable, intent(out) :: error

    call explicit_usl_step(self, model, dt, keep_gradient, error)
    if (allocated(error) .or. len(self%metrics_file) == 0) return
    if (mod(model%step + 1, int(self%stride, lp)) /= 0) return
    if (self%kept_bytes >= 0) call truncate_file(self%metrics_file, self%kept_bytes, error)
    if (allocated(error)) return
    self%kept_bytes = -1
    call write_volume_metrics(model, model%time + dt, self%metrics_file, self%lines == 0, error)
    self%lines = 1
  end subroutine strain_smoothing_step

  !> Save how much of the metrics is written.
  subroutine strain_smoothing_save(self, store)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call explicit_solver_save(self, store)
    if (len(self%metrics_file) == 0) return
    call store%put('lines', self%lines)
    call store%put('metrics_bytes', file_size(self%metrics_file))
  end subroutine strain_smoothing_save

  !> Take back how much of the metrics is written: lines behind that are dropped.
  subroutine strain_smoothing_restore(self, store)
    !> The solver, started.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call explicit_solver_restore(self, store)
    if (.not. store%has('metrics_bytes')) return
    if (len(self%metrics_file) == 0) return
    call store%get('lines', self%lines)
    call store%get('metrics_bytes', self%kept_bytes)
    if (file_size(self%metrics_file) == 0) self%lines = 0
  end subroutine strain_smoothing_restore

  !> Advance the points of a body, smooth their volumes, then advance their stress.
  subroutine strain_smoothing_advance_body(self, model, body, dt, keep_gradient, error)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(inout) :: self
    !> The model, its nodes advanced.
    type(model_t), intent(inout) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients: they always are.
    logical, intent(in) :: keep_gradient
    !> The simulation went bad.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: before(:), smoothed(:)
    integer :: first_bad, n

    associate (points => model%bodies(body)%body%points, unused => keep_gradient)
      n = points%n_inside
      if (n == 0) return
      if (self%material_only) then
        before = points%smoothed_volume(:n)
      else
        before = points%volume(:n)
      end if
      call update_points(model, body, dt, .true., error, keep_stress=.true.)
      if (allocated(error)) return
      call model%clock%enter(phase_material)
      smoothed = points%volume(:n)
      call self%smooth(model, points, n, smoothed)
      call stress_of_body(model%bodies(body)%body, model%threads, dt, n, before, smoothed, &
                          first_bad)
      if (self%material_only) then
        points%smoothed_volume(:n) = smoothed
      else
        points%volume(:n) = smoothed
      end if
    end associate
    if (first_bad == 0) return
    call raise_bad_point(model, model%bodies(body)%body, first_bad, bad_stress, dt, error)
  end subroutine strain_smoothing_advance_body

  !> Smooth the volumes of the points of a body.
  pure subroutine smooth(self, model, points, n, volume)
    !> The solver.
    class(explicit_usl_with_volumetric_strain_smoothing_t), intent(in) :: self
    !> The model, for the box of the grid.
    type(model_t), intent(in) :: model
    !> The points.
    class(points_t), intent(in) :: points
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Volumes. [m3] (n)
    real(wp), intent(inout) :: volume(n)
    type(cells_t) :: cells
    real(wp) :: lower(3), upper(3)

    cells%dim = model%kin%dim
    call model%grid%bounds(lower, upper)
    cells%lower = lower
    cells%h = model%grid%spacing()
    cells%n = nint((upper - lower)/cells%h)
    select case (self%method)
    case (zhang_cells)
      call smooth_by_cells(cells, n, points%x(:, :n), points%reference_volume(:n), volume)
    case (mast_cells)
      call smooth_by_nodes(cells, n, points%x(:, :n), points%reference_volume(:n), volume)
    case default
      where (self%n_cells > 0) cells%n(:2) = self%n_cells
      where (self%length > 0.0_wp) upper(:2) = lower(:2) + self%length
      cells%h(:2) = (upper(:2) - lower(:2))/real(cells%n(:2), wp)
      call smooth_by_flux(cells, n, points%x(:, :n), points%reference_volume(:n), volume)
    end select
  end subroutine smooth

  !> Advance the stress of all points of a body, in blocks on all threads.
  subroutine stress_of_body(body, threads, dt, n, before, smoothed, first_bad)
    !> The body; its points have moved and hold the velocity gradients of the step.
    class(body_t), intent(inout) :: body
    !> Number of threads.
    integer, intent(in) :: threads
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Smoothed volumes at the start of the step. [m3] (n)
    real(wp), intent(in) :: before(n)
    !> Smoothed volumes at its end. [m3] (n)
    real(wp), intent(in) :: smoothed(n)
    !> The point of lowest number for which there is no stress; 0 when there is none.
    integer, intent(out) :: first_bad
    integer, allocatable :: slot(:)
    integer :: block

    first_bad = 0
    if (.not. allocated(body%material)) return
    allocate (slot((n + block_size - 1)/block_size))
    !$omp parallel do default(none) schedule(static) num_threads(useful_threads(threads, n)) &
    !$omp shared(body, dt, n, before, smoothed, slot) private(block)
    do block = 1, size(slot)
      call stress_of_block(body%points, body%material, dt, block, n, before, smoothed, slot(block))
    end do
    !$omp end parallel do
    do block = 1, size(slot)
      if (slot(block) == 0) cycle
      if (first_bad == 0) first_bad = slot(block)
      if (body%points%id(slot(block)) < body%points%id(first_bad)) first_bad = slot(block)
    end do
  end subroutine stress_of_body

  !> Advance the stress of one block of points.
  subroutine stress_of_block(points, material, dt, block, n, before, smoothed, slot)
    !> The points; the blocks of different threads do not overlap.
    class(points_t), intent(inout) :: points
    !> Constitutive law.
    class(material_t), intent(in) :: material
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Number of the block, from 1.
    integer, intent(in) :: block
    !> Number of points inside the grid.
    integer, intent(in) :: n
    !> Smoothed volumes at the start of the step. [m3] (n)
    real(wp), intent(in) :: before(n)
    !> Smoothed volumes at its end. [m3] (n)
    real(wp), intent(in) :: smoothed(n)
    !> First point for which there is no stress; 0 when there is none.
    integer, intent(out) :: slot
    real(wp) :: gradient(9*block_size)
    integer :: a, b

    a = (block - 1)*block_size + 1
    b = min(block*block_size, n)
    call replace_trace(points%kin, b - a + 1, dt, before(a:b), smoothed(a:b), &
                       points%gradient(:, a:b), gradient)
    call advance_stress(points%kin, material, b - a + 1, dt, gradient, points%mass(a:b), &
                        smoothed(a:b), points%stress(:, a:b), points%history(:, a:b), slot)
    if (slot > 0) slot = slot + a - 1
  end subroutine stress_of_block

  !> Velocity gradients whose trace is the rate of the smoothed volume, ln(after/before)/dt.
  pure subroutine replace_trace(kin, n, dt, before, after, gradient, replaced)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Number of points, at most `block_size`.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Volumes at the start of the step. [m3] (n)
    real(wp), intent(in) :: before(n)
    !> Volumes at its end. [m3] (n)
    real(wp), intent(in) :: after(n)
    !> Velocity gradients. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> The same with the other trace. [1/s] (ngrad, n)
    real(wp), intent(out) :: replaced(kin%ngrad, n)
    !> Positions of the diagonal components of the TYPEs, and their numbers.
    integer, parameter :: diagonal(3, 5) = reshape([1, 0, 0, 1, 4, 0, 1, 5, 9, 1, 4, 8, 1, 4, 0], &
                                                   [3, 5]), count(5) = [1, 2, 3, 3, 2]
    real(wp) :: share(block_size)
    integer :: i, k

    replaced = gradient
    call trace_of_gradient(kin, n, gradient, share)
    share(:n) = (log(after/before)/dt - share(:n))/real(count(kin%sim_type), wp)
    do i = 1, count(kin%sim_type)
      k = diagonal(i, kin%sim_type)
      replaced(k, :) = replaced(k, :) + share(:n)
    end do
  end subroutine replace_trace

end module mpm_explicit_usl_with_volumetric_strain_smoothing
