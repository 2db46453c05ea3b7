!> The parts of an explicit step, from which the explicit solvers are put together.
module mpm_explicit_steps
  use mpm_advance, only: advance_points, turn_stress
  use mpm_body, only: body_t
  use mpm_corotation, only: shear_rates
  use mpm_errors, only: err_simulation, error_t, raise
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t, type_axisymmetric
  use mpm_material, only: material_t
  use mpm_memory, only: memory_left, size_text, way_to_more
  use mpm_model, only: model_t
  use mpm_node_update, only: advance_nodes, finish_mapping
  use mpm_nodes, only: nodes_t
  use mpm_phase_clock, only: phase_clock_t, phase_g2p, phase_material, phase_nodes, phase_p2g, &
                             phase_sort
  use mpm_point_blocks, only: sweep_block
  use mpm_point_maps, only: interpolate_points, list_mesh_nodes, map_momentum, map_points
  use mpm_points, only: points_t
  use mpm_seam, only: copy_to_ghosts, widen_at_seam, wrap_points
  use mpm_sort, only: base_bounds
  use mpm_stencil, only: block_size, stencil_keys, stencil_t
  use mpm_strings, only: to_text
  use mpm_stability, only: courant_limit, filtered_limit
  use mpm_sweep, only: sweep_t
  use mpm_threads, only: useful_threads
  use mpm_window, only: window_t
  implicit none
  private
  public :: advance_stress, body_stable_step, locate_points, map_to_nodes, raise_bad_point
  public :: update_nodes, update_points
  public :: bad_stress

  !> Why a block of points stopped the run.
  integer, parameter :: went_well = 0, bad_motion = 1, bad_stress = 2

contains

  !> Choose the basis of a body and sort its points by cell.
  subroutine locate_points(model, body, averaged, error, fitted)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Average the basis over the corners of the points' boxes.
    logical, intent(in) :: averaged
    !> Points that the basis can't take.
    type(error_t), allocatable, intent(out) :: error
    !> Slopes of the best affine fit in place of the functions' derivatives; not when left out.
    logical, intent(in), optional :: fitted
    type(stencil_t) :: stencil

    associate (item => model%bodies(body)%body)
      call model%grid%make_stencil(item%points%averages(averaged), maxval(item%points%extent), &
                                   stencil, error)
      if (allocated(error)) then
        error%message = 'body "'//item%name//'": '//error%message
        error%file = item%points%file
        error%line = item%points%widest_line
        return
      end if
      if (present(fitted)) stencil%fitted = fitted
      call item%points%locate(stencil)
    end associate
  end subroutine locate_points

  !> Map a body to its nodes: mass, momentum, velocity, internal force and body force.
  subroutine map_to_nodes(body, threads, error, clock)
    !> The body.
    class(body_t), intent(inout) :: body
    !> Number of threads.
    integer, intent(in) :: threads
    !> The nodes need more memory than there is.
    type(error_t), allocatable, intent(out) :: error
    !> Time of the phases.
    type(phase_clock_t), intent(inout), optional :: clock
    type(window_t) :: window
    integer(lp) :: bytes_missing
    integer :: n, dim

    if (present(clock)) call clock%enter(phase_nodes)
    dim = body%points%stencil%dim
    if (allocated(body%points%stencil%mesh)) then
      call body%points%refresh_order(threads)
      call list_mesh_nodes(body%points, threads, window)
    else if (allocated(body%points%domains)) then
      call body%points%refresh_order(threads)
      n = body%points%n_inside
      call body%points%domains%place(body%points%stencil, useful_threads(threads, n), n, &
                                     body%points%x(:, :n), window)
    else if (body%points%hi(1) >= 0) then
      window%lo = body%points%lo
      window%n = 1
      window%n(:dim) = body%points%hi(:dim) - body%points%lo(:dim) + body%points%stencil%width
      call widen_at_seam(body%points%stencil, window)
    end if
    call body%nodes%place(window, bytes_missing)
    if (bytes_missing > 0) then
      call raise(error, err_simulation, 'body "'//body%name//'" reaches over '// &
                 to_text(window%size())//' nodes, which need '//size_text(bytes_missing)// &
                 ' of memory, more than there is', hint='memory is for the box around the points &
                 &of a body: use larger cells, put points that lie far apart into bodies of their &
                 &own, or '//way_to_more())
      return
    end if
    if (allocated(body%points%domains) .and. .not. allocated(body%points%stencil%mesh)) then
      call check_lists(body, window, error)
      if (allocated(error)) return
    end if
    if (present(clock)) call clock%enter(phase_sort)
    call body%points%refresh_order(threads)
    if (present(clock)) call clock%enter(phase_p2g)
    n = body%points%n_inside
    if (n == 0) return
    associate (points => body%points, nodes => body%nodes)
      if (allocated(points%domains) .and. .not. allocated(points%stencil%mesh)) then
        call points%domains%make_lists(points%kin, points%stencil, useful_threads(threads, n), n, &
                                       points%x(:, :n), window)
      end if
      call map_points(points, window, threads, points%velocity(:, :n), points%stress(:, :n), &
                      nodes%mass, nodes%momentum, nodes%force)
      if (allocated(points%affine)) then
        call map_momentum(points, window, threads, nodes%momentum, affine=points%affine(:, :n))
      end if
      if (present(clock)) call clock%enter(phase_nodes)
      call finish_mapping(points%kin%nvel, window%size(), threads, points%mass_cutoff, &
                          points%body_force, nodes%mass, nodes%momentum, nodes%force, &
                          nodes%velocity, nodes%increment)
      if (allocated(points%load)) call add_loads(points, window, threads, nodes%force)
    end associate
  end subroutine map_to_nodes

  !> See that the lists of the nodes of all points have room in memory.
  subroutine check_lists(body, window, error)
    !> The body, its domains and nodes placed.
    class(body_t), intent(in) :: body
    !> Window of the node arrays.
    type(window_t), intent(in) :: window
    !> They have none.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: entries, bytes, room

    associate (domains => body%points%domains, nodes => body%nodes)
      call domains%count_lists(body%points%stencil, entries, bytes)
      room = memory_left(nodes%memory_limit, nodes%memory()) + domains%list%memory()
    end associate
    if (entries < huge(1) .and. bytes <= room) return
    call raise(error, err_simulation, 'the domains of the points of body "'//body%name// &
               '" reach '//to_text(entries)//' times a node of '//to_text(window%size())// &
               ', which needs '//size_text(bytes)//' of memory, more than there is', &
               hint='use fewer points, larger cells, smaller domains, or '//way_to_more())
  end subroutine check_lists

  !> Add the body forces that differ from point to point: f_i += sum_p m_p N_i(x_p) b_p.
  !!
  !! The sums are the momenta of points whose velocity is their load. As the uniform body force, and
  !! unlike internal forces, loads take part in the velocities of negligible nodes: a node's
  !! acceleration by them is a mean of b_p with the weights m_p N_i(x_p), which is bounded.
  subroutine add_loads(points, window, threads, force)
    !> The points, with loads and sorted by cell.
    class(points_t), intent(in) :: points
    !> Window of the node arrays; holds all stencils of the points.
    type(window_t), intent(in) :: window
    !> Number of threads.
    integer, intent(in) :: threads
    !> Nodal forces, added to. [N] (nvel, nn)
    real(wp), intent(inout) :: force(:, :)
    real(wp), allocatable :: mass(:), load(:, :), unused(:, :), stress(:, :)
    integer :: n, nodes, i

    n = points%n_inside
    nodes = window%size()
    associate (kin => points%kin)
      allocate (mass(nodes), load(kin%nvel, nodes), unused(kin%nvel, nodes))
      allocate (stress(kin%nstress, n), source=0.0_wp)
      call map_points(points, window, threads, points%load(:, :n), stress, mass, load, unused)
    end associate
    do i = 1, nodes
      force(:, i) = force(:, i) + load(:, i)
    end do
  end subroutine add_loads

  !> Advance the nodal momenta: P += dt f, v = P/m, dv = dt f/m.
  subroutine update_nodes(nodes, dt, threads)
    !> The nodes.
    class(nodes_t), intent(inout) :: nodes
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads

    call advance_nodes(nodes%kin%nvel, nodes%window%size(), threads, dt, nodes%mass, nodes%force, &
                       nodes%momentum, nodes%velocity, nodes%increment)
  end subroutine update_nodes

  !> Advance the points of a body with the grid, then their stress.
  subroutine update_points(model, body, dt, keep_gradient, error, keep_stress, sweep)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients.
    logical, intent(in) :: keep_gradient
    !> A point is not finite, moved more than a cell or lost its volume.
    type(error_t), allocatable, intent(out) :: error
    !> Leave the stress as it is; false when left out.
    logical, intent(in), optional :: keep_stress
    !> What to do; when left out all of it, by FLIP with the stress updated last.
    type(sweep_t), intent(in), optional :: sweep
    integer, allocatable :: slot(:), cause(:)
    integer :: blocks, first_bad, i
    logical :: keep, with_stress

    associate (item => model%bodies(body)%body)
      call model%clock%enter(phase_g2p)
      if (item%points%n_inside == 0) return
      if (any(item%points%stencil%periodic)) call fill_ghosts(item, sweep)
      blocks = (item%points%n_inside + block_size - 1)/block_size
      allocate (slot(blocks), cause(blocks))
      keep = keep_gradient .or. item%points%needs_gradient
      with_stress = allocated(item%material)
      if (present(keep_stress)) with_stress = with_stress .and. .not. keep_stress
      if (with_stress) then
        call sweep_blocks(item%points, item%nodes, item%points%stencil, model%threads, dt, &
                          keep, slot, cause, model%clock, item%material, sweep)
      else
        call sweep_blocks(item%points, item%nodes, item%points%stencil, model%threads, dt, &
                          keep, slot, cause, model%clock, sweep=sweep)
      end if
      first_bad = 0
      do i = 1, blocks
        if (slot(i) == 0) cycle
        if (first_bad == 0) first_bad = i
        if (item%points%id(slot(i)) < item%points%id(slot(first_bad))) first_bad = i
      end do
      if (first_bad > 0) then
        call raise_bad_point(model, item, slot(first_bad), cause(first_bad), dt, error)
      end if
    end associate
  end subroutine update_points

  !> Give the ghosts at the seams of a periodic grid the values of their nodes.
  subroutine fill_ghosts(body, sweep)
    !> The body, before a visit to its points.
    class(body_t), intent(inout) :: body
    !> What the visit does.
    type(sweep_t), intent(in), optional :: sweep

    associate (stencil => body%points%stencil, nodes => body%nodes)
      call copy_to_ghosts(stencil, nodes%window, nodes%kin%nvel, nodes%velocity)
      call copy_to_ghosts(stencil, nodes%window, nodes%kin%nvel, nodes%increment)
      if (.not. present(sweep)) return
      ! Fields that the visit does not read may be of an earlier window.
      if (sweep%remapped) then
        call copy_to_ghosts(stencil, nodes%window, nodes%kin%nvel, nodes%remapped)
      else if (sweep%kick .and. allocated(nodes%gain)) then
        call copy_to_ghosts(stencil, nodes%window, nodes%kin%nvel, nodes%gain)
      end if
    end associate
  end subroutine fill_ghosts

  !> Visit the points of a body in blocks on all threads.
  subroutine sweep_blocks(points, nodes, stencil, threads, dt, keep_gradient, slot, cause, clock, &
                          material, sweep)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Their nodes, after the grid update.
    class(nodes_t), intent(in) :: nodes
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of threads.
    integer, intent(in) :: threads
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients.
    logical, intent(in) :: keep_gradient
    !> First bad point of each block, or 0. (blocks)
    integer, intent(out) :: slot(:)
    !> What is wrong with it. (blocks)
    integer, intent(out) :: cause(:)
    !> Time of the phases.
    type(phase_clock_t), intent(inout) :: clock
    !> Constitutive law.
    class(material_t), intent(in), optional :: material
    !> What to do.
    type(sweep_t), intent(in), optional :: sweep
    integer :: block, lo(3), hi(3), block_lo(3), block_hi(3), n_changed, changed
    integer(lp) :: on_stress, on_all, ticks(2)

    on_stress = 0
    on_all = 0
    ticks = 0
    lo = huge(1)
    hi = -1
    n_changed = 0
    !$omp parallel do default(none) schedule(static) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) &
    !$omp shared(points, nodes, stencil, dt, keep_gradient, slot, cause, material, sweep, clock) &
    !$omp private(block, block_lo, block_hi, changed) firstprivate(ticks) &
    !$omp reduction(min:lo) reduction(max:hi) reduction(+:n_changed, on_stress, on_all)
    do block = 1, size(slot)
      call update_block(points, nodes, stencil, dt, keep_gradient, block, slot(block), &
                        cause(block), block_lo, block_hi, changed, clock%on, ticks, material, sweep)
      on_stress = on_stress + ticks(1)
      on_all = on_all + ticks(2)
      lo = min(lo, block_lo)
      hi = max(hi, block_hi)
      n_changed = n_changed + changed
    end do
    !$omp end parallel do
    call clock%move(phase_material, on_stress, on_all)
    if (present(sweep)) then
      if (.not. sweep%drift) return
    end if
    points%lo = lo
    points%hi = hi
    points%n_changed = points%n_changed + n_changed
    points%n_drifted = points%n_drifted + n_changed
  end subroutine sweep_blocks

  !> Interpolate to one block of points, move them, update their stress and their keys.
  subroutine update_block(points, nodes, stencil, dt, keep_gradient, block, slot, cause, lo, hi, &
                          changed, timed, ticks, material, sweep)
    !> The points; the blocks of different threads do not overlap.
    class(points_t), intent(inout) :: points
    !> Their nodes, after the grid update.
    class(nodes_t), intent(in) :: nodes
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Store the velocity gradients.
    logical, intent(in) :: keep_gradient
    !> Number of the block, from 1.
    integer, intent(in) :: block
    !> First bad point, or 0.
    integer, intent(out) :: slot
    !> What is wrong with it.
    integer, intent(out) :: cause
    !> Smallest first node of the new stencils.
    integer, intent(out) :: lo(3)
    !> Largest first node of the new stencils.
    integer, intent(out) :: hi(3)
    !> Points whose key changed.
    integer, intent(out) :: changed
    !> Whether to take the time.
    logical, intent(in) :: timed
    !> Clock counts of the stress and of all; untouched unless timed.
    integer(lp), intent(inout) :: ticks(2)
    !> Constitutive law.
    class(material_t), intent(in), optional :: material
    !> What to do.
    type(sweep_t), intent(in), optional :: sweep
    real(wp) :: velocity(3*block_size), increment(3*block_size), gradient(9*block_size)
    integer :: key(block_size), a, b, n
    integer(lp) :: begun, now
    logical :: strain, drift

    begun = 0
    if (timed) call system_clock(begun)
    if (timed) ticks(1) = 0
    strain = .true.
    drift = .true.
    if (present(sweep)) then
      strain = sweep%strain
      drift = sweep%drift
    end if
    a = (block - 1)*block_size + 1
    b = min(block*block_size, points%n_inside)
    n = b - a + 1
    associate (kin => points%kin)
      if (present(sweep)) then
        call sweep_block(points, nodes, stencil, sweep, dt, a, b, gradient, slot, material)
      else
        call interpolate_points(points, stencil, nodes%window, a, b, nodes%velocity, &
                                nodes%increment, velocity, increment, gradient)
        if (allocated(points%domains)) then
          call points%domains%follow(kin, stencil, dt, a, n, points%x(:, a:b), nodes%velocity, &
                                     gradient, velocity, strain=.true., drift=.true.)
        end if
        call advance_points(kin, stencil, n, dt, velocity, increment, gradient, points%x(:, a:b), &
                            points%displacement(:, a:b), points%velocity(:, a:b), &
                            points%volume(a:b), slot)
      end if
      if (drift .and. slot == 0 .and. allocated(points%domains)) then
        call points%domains%fit_volumes(kin, a, n, points%x(:, a:b), points%volume(a:b), slot)
      end if
      if (keep_gradient .and. strain) then
        if (allocated(points%gradient)) then
          points%gradient(:, a:b) = reshape(gradient(:kin%ngrad*n), [kin%ngrad, n])
        end if
        if (allocated(points%shear_rate)) then
          call shear_rates(kin, n, gradient, points%shear_rate(a:b))
        end if
      end if
    end associate
    cause = bad_motion
    lo = huge(1)
    hi = -1
    changed = 0
    if (slot == 0) then
      cause = went_well
      if (present(material) .and. strain) then
        if (timed) call system_clock(ticks(1))
        if (drift) then
          call advance_stress(points%kin, material, n, dt, gradient, points%mass(a:b), &
                              points%volume(a:b), points%stress(:, a:b), &
                              points%history(:, a:b), slot)
        else
          call material%update_stress(n, dt, gradient, points%mass(a:b), points%volume(a:b), &
                                      points%stress(:, a:b), points%history(:, a:b), slot)
        end if
        if (slot > 0) cause = bad_stress
        if (timed) call system_clock(now)
        if (timed) ticks(1) = now - ticks(1)
      end if
      if (drift) then
        if (any(stencil%periodic)) call wrap_points(stencil, n, points%x(:, a:b))
        call stencil_keys(stencil, n, points%x(:, a:b), points%extent(a:b), key, points%key(a:b))
        changed = count(key(:n) /= points%key(a:b))
        points%key(a:b) = key(:n)
        call base_bounds(stencil, n, key, lo, hi)
      end if
    end if
    if (slot > 0) slot = slot + a - 1
    if (timed) call system_clock(now)
    if (timed) ticks(2) = now - begun
  end subroutine update_block

  !> Advance the stress of a block of points over one step.
  subroutine advance_stress(kin, material, n, dt, gradient, mass, volume, stress, history, &
                            first_bad)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Constitutive law.
    class(material_t), intent(in) :: material
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(kin%ngrad, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes at the end of the step. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses, of the start of the step on entry, of its end on exit. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(kin%nstress, n)
    !> What the material remembers of the points. (n_history, n)
    real(wp), intent(inout) :: history(material%n_history, n)
    !> First point for which there is no stress; 0 when there is none.
    integer, intent(out) :: first_bad

    call material%update_stress(n, dt, gradient, mass, volume, stress, history, first_bad)
    if (kin%sim_type == type_axisymmetric) then
      call turn_stress(n, dt, gradient, stress)
      call material%turn_history(n, dt, gradient, history)
    end if
  end subroutine advance_stress

  !> The error that stops a run that went bad.
  subroutine raise_bad_point(model, body, slot, cause, dt, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> The body.
    class(body_t), intent(in) :: body
    !> Slot of the point.
    integer, intent(in) :: slot
    !> What is wrong.
    integer, intent(in) :: cause
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> The error.
    type(error_t), allocatable, intent(inout) :: error
    character(:), allocatable :: what, hint
    real(wp) :: limit

    if (cause == bad_stress) then
      what = 'has no admissible stress'
    else if (.not. abs(body%points%volume(slot)) <= huge(1.0_wp) .or. &
             any(.not. abs(body%points%x(:, slot)) <= huge(1.0_wp))) then
      what = 'is no longer finite'
    else if (.not. body%points%volume(slot) > 0.0_wp) then
      what = 'has lost its volume'
    else
      what = 'moved more than a cell'
    end if
    limit = initial_stable_step(model%grid%spacing(), body)
    if (dt > limit) then
      hint = 'dt is above the stable step of this body, '//to_text(limit)//' s: use a smaller dt'
    else
      hint = 'likely causes: a dt too large for the speed of the points, too few points in a cell, &
             &or loads that crush the material'
    end if
    call raise(error, err_simulation, 'body "'//body%name//'": point '// &
               to_text(body%points%id(slot))//' '//what//' in step '// &
               to_text(model%step + 1_lp)//', t = '//to_text(model%time)//' s', hint=hint)
  end subroutine raise_bad_point

  !> Stable time step of a body in its initial state, which a run gone bad has not spoilt.
  pure function initial_stable_step(spacing, body) result(limit)
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: spacing(3)
    !> The body.
    class(body_t), intent(in) :: body
    !> Largest stable step; huge when nothing bounds it. [s]
    real(wp) :: limit
    real(wp), allocatable :: volume(:), stress(:, :), history(:, :)
    integer :: n

    limit = huge(1.0_wp)
    if (.not. allocated(body%material)) return
    associate (points => body%points)
      n = points%n_inside
      volume = (2.0_wp*points%extent(:n))**points%kin%dim
      if (points%kin%sim_type == type_axisymmetric) then
        volume = volume*abs(points%x(1, :n) - points%displacement(1, :n))
      end if
      allocate (stress(points%kin%nstress, n), source=0.0_wp)
      allocate (history(body%material%n_history, n))
      call body%material%start(n, points%x(:, :n), points%mass(:n), volume, history)
      limit = stable_time(stable_length(spacing, body), &
                          body%material%wave_speed(n, points%mass(:n), volume, stress, history), &
                          body%material%diffusivity(n, points%mass(:n), volume))
    end associate
  end function initial_stable_step

  !> Largest stable time step of a body with FLIP and stress update last.
  !!
  !! A mode is stable for c**2 K dt**2 <= 4/(2 - mu), which bounds c dt over the smallest spacing;
  !! other limits hold when the gradient is formed from velocities that went through the points
  !! (MUSL, USF). See `mpm_stability`.
  pure subroutine body_stable_step(spacing, body, wave_speed, limit, filtered, flip)
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: spacing(3)
    !> The body.
    class(body_t), intent(in) :: body
    !> Largest wave speed; 0 without a material. [m/s]
    real(wp), intent(out) :: wave_speed
    !> Largest stable step; huge when nothing bounds it. [s]
    real(wp), intent(out) :: limit
    !> Gradients are formed from velocities that went through the points; not when left out.
    logical, intent(in), optional :: filtered
    !> They did so by FLIP; so they do when left out.
    logical, intent(in), optional :: flip
    integer :: n

    wave_speed = 0.0_wp
    limit = huge(1.0_wp)
    n = body%points%n_inside
    if (n == 0 .or. .not. allocated(body%material)) return
    wave_speed = body%material%wave_speed(n, body%points%mass(:n), body%points%volume(:n), &
                                          body%points%stress(:, :n), body%points%history(:, :n))
    limit = stable_time(stable_length(spacing, body, filtered, flip), wave_speed, &
                        body%material%diffusivity(n, body%points%mass(:n), body%points%volume(:n)))
  end subroutine body_stable_step

  !> Largest stable step of a material with waves and viscosity.
  !!
  !! Waves alone are stable for w dt <= 2 of the highest frequency w = c k, so that `length` is 2/k.
  !! Viscous forces are of the velocities a step ago, which turns the bound into
  !! (w dt)**2/4 + nu k**2 dt/2 <= 1, nu the diffusivity.
  pure function stable_time(length, speed, diffusivity) result(limit)
    !> Largest stable c dt of waves. [m]
    real(wp), intent(in) :: length
    !> Speed c of waves. [m/s]
    real(wp), intent(in) :: speed
    !> Diffusivity of momentum. [m2/s]
    real(wp), intent(in) :: diffusivity
    !> Largest stable step; huge when nothing bounds it. [s]
    real(wp) :: limit
    real(wp) :: rate, damping

    limit = huge(1.0_wp)
    if (diffusivity > 0.0_wp) then
      rate = speed/length
      damping = diffusivity/length**2
      limit = 1.0_wp/(damping + sqrt(damping**2 + rate**2))
    else if (speed > 0.0_wp) then
      limit = length/speed
    end if
  end function stable_time

  !> Largest stable c dt of a body, from the spacing of the grid and the points in a cell; on a mesh
  !! from the cells alone.
  pure function stable_length(spacing, body, filtered, flip) result(length)
    !> Spacing of the grid. [m]
    real(wp), intent(in) :: spacing(3)
    !> The body.
    class(body_t), intent(in) :: body
    !> Gradients are formed from velocities that went through the points; not when left out.
    logical, intent(in), optional :: filtered
    !> They did so by FLIP; so they do when left out.
    logical, intent(in), optional :: flip
    !> Wave speed times stable step. [m]
    real(wp) :: length
    real(wp) :: per_cell
    logical :: through_points, by_flip
    integer :: n, dim

    n = body%points%n_inside
    dim = body%points%kin%dim
    ! Points per cell along the smallest spacing, as the side of the mean point has it.
    per_cell = minval(spacing(:dim))/(sum((2.0_wp*body%points%extent(:n))**dim)/real(n, wp)) &
               **(1.0_wp/real(dim, wp))
    per_cell = max(1.0_wp, per_cell)
    through_points = .false.
    if (present(filtered)) through_points = filtered
    by_flip = .true.
    if (present(flip)) by_flip = flip
    if (allocated(body%points%stencil%mesh)) then
      length = body%points%stencil%mesh%stable
    else if (through_points) then
      length = filtered_limit(per_cell, by_flip)/sqrt(sum(1.0_wp/spacing(:dim)**2))
    else
      length = courant_limit(body%points%stencil, per_cell, touches_wall(body%points))* &
               minval(spacing(:dim))
    end if
  end function stable_length

  !> Whether stencils of points reach the nodes of a wall.
  pure function touches_wall(points)
    !> The points, with keys.
    class(points_t), intent(in) :: points
    !> Whether one does.
    logical :: touches_wall

    associate (stencil => points%stencil, dim => points%stencil%dim)
      touches_wall = any(.not. stencil%periodic(:dim) .and. &
                         (points%lo(:dim) == 0 .or. &
                          points%hi(:dim) + stencil%width > stencil%n_cells(:dim)))
    end associate
  end function touches_wall

end module mpm_explicit_steps
