!> How velocities go from the points to the grid and back.
!!
!! A point keeps the part `kept` of its velocity and receives the interpolated gain of the nodes:
!! v_p <- kept v_p + sum_i N_i(x_p) g_i. FLIP has kept = 1 and the increments of the step as gains,
!! PIC kept = 0 and the velocities of the nodes. See docs/3_running.md.
module mpm_transfer
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_nodes, only: nodes_t
  use mpm_point_maps, only: interpolate_points, map_momentum
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_seam, only: copy_to_ghosts
  use mpm_stencil, only: block_size
  use mpm_threads, only: useful_threads
  implicit none
  private
  public :: add_transfer_properties, fit_length, map_velocities, points_gain, transfer_t

  !> One way of transfer.
  type :: transfer_t
    !> Part of its own velocity that a point keeps: 1 in FLIP, 0 in all but blends.
    real(wp) :: kept = 1.0_wp
    !> Points have affine fields of velocity (APIC).
    logical :: affine = .false.
    !> Slopes of the affine fit serve as gradients of the basis (MLS).
    logical :: fitted = .false.
    !> Order of XPIC; 1 is PIC.
    integer :: order = 1
  contains
    !> Set up from the properties.
    procedure :: init => transfer_init
    !> Whether the points receive the increments of the nodes and nothing else.
    procedure :: is_flip => transfer_is_flip
    !> Prepare a body before the first mapping.
    procedure :: start => transfer_start
    !> Find what the points receive beyond the nodal velocities, right after the mapping.
    procedure :: filter => transfer_filter
    !> Find what the points receive, after the grid update.
    procedure :: finish => transfer_finish
  end type transfer_t

contains

  !> Add the properties that choose a transfer.
  subroutine add_transfer_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_integer('xpic_order', 'XPIC: its order k; 1 is PIC', default=2, lower=1, &
                                 upper=20)
    call description%add_real('flip', '-', 'FLIP: part of the increments; the rest is PIC', &
                              default=1.0_wp, lower=0.0_wp, upper=1.0_wp)
    call description%add_string('transfer', 'FLIP, PIC, APIC, MLS or XPIC', default='FLIP')
    call description%add_note('FLIP: v_p += S dv_i. Conserves linear momentum; keeps velocities &
                              &that the grid does not see; angular momentum drifts a little.')
    call description%add_note('flip = a < 1: a times FLIP plus (1 - a) times PIC. Conserves linear &
                              &momentum; unseen velocities shrink by a in each step, resolved &
                              &waves lose energy as in PIC, 1 - a times as fast.')
    call description%add_note('PIC: v_p = S v_i. Conserves linear momentum; removes unseen &
                              &velocities at once, and angular momentum and energy with them: a &
                              &wave loses the part 1 - mu of its velocity in each step.')
    call description%add_note('APIC: v_p = S v_i, and each point has an affine field with the &
                              &gradient C_p that fits the nodal velocities. Conserves linear &
                              &momentum, and angular momentum with the part m_p D_p C_p in each &
                              &mapping; affine fields pass unchanged.')
    call description%add_note('MLS: APIC, with the slopes of the fit in place of the gradients of &
                              &the functions, in forces and velocity gradients alike; the same as &
                              &APIC for hats. Conserves what APIC does.')
    call description%add_note('XPIC: v_p = S (v_i + sum_{j=1}^{k-1} (1 - Q)^j v_i(start)), Q the &
                              &map from the nodes to the points and back. Conserves linear &
                              &momentum; removes unseen velocities at once, but damps resolved &
                              &ones by (1 - mu)^k only.')
  end subroutine add_transfer_properties

  !> Set up from the properties.
  subroutine transfer_init(self, properties, error)
    !> The transfer.
    class(transfer_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> An unknown name, or values that do not belong to it.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: name

    name = properties%string('transfer')
    ! A class without this property keeps FLIP.
    if (name == '' .and. .not. properties%given('transfer')) return
    if (name /= 'FLIP' .and. properties%given('flip')) then
      call properties%reject('flip', 'flip does not belong to the transfer '//name, error, &
                             'leave it out, or use transfer = "FLIP"')
      return
    end if
    if (name /= 'XPIC' .and. properties%given('xpic_order')) then
      call properties%reject('xpic_order', 'xpic_order does not belong to the transfer '//name, &
                             error, 'leave it out, or use transfer = "XPIC"')
      return
    end if
    self%kept = 0.0_wp
    self%affine = name == 'APIC' .or. name == 'MLS'
    self%fitted = name == 'MLS'
    self%order = 1
    select case (name)
    case ('FLIP')
      self%kept = properties%real('flip')
    case ('XPIC')
      self%order = properties%integer('xpic_order')
    case ('PIC', 'APIC', 'MLS')
      self%order = 1
    case default
      call properties%reject('transfer', 'unknown transfer "'//name//'"', error, &
                             'use FLIP, PIC, APIC, MLS or XPIC; a blend is FLIP with flip below 1')
    end select
  end subroutine transfer_init

  !> Whether the points receive the increments of the nodes and nothing else.
  pure function transfer_is_flip(self) result(is_flip)
    !> The transfer.
    class(transfer_t), intent(in) :: self
    !> Whether they do.
    logical :: is_flip

    is_flip = self%kept >= 1.0_wp
  end function transfer_is_flip

  !> Prepare a body before the first mapping: room for affine fields.
  subroutine transfer_start(self, points, error)
    !> The transfer.
    class(transfer_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points
    !> Affine fields of points whose functions are means over domains.
    type(error_t), allocatable, intent(out) :: error

    if (allocated(points%affine)) deallocate (points%affine)
    if (.not. self%affine) return
    if (allocated(points%stencil%mesh)) then
      call raise(error, err_input, 'the transfers APIC and MLS need a Cartesian grid', &
                 hint='use transfer = "FLIP", "PIC" or "XPIC"')
      return
    end if
    if (allocated(points%domains)) then
      call raise(error, err_input, 'the transfers APIC and MLS need the functions at the points, &
                 &but these points have means over domains', hint='use transfer = "FLIP", "PIC" &
                 &or "XPIC", or points without domains (quadrature 0)')
      return
    end if
    allocate (points%affine(points%kin%nvel*points%kin%dim, points%n), source=0.0_wp)
  end subroutine transfer_start

  !> Find what XPIC gives beyond the nodal velocities: sum_{j=1}^{k-1} (1 - Q)^j v.
  subroutine transfer_filter(self, body, threads)
    !> The transfer.
    class(transfer_t), intent(in) :: self
    !> The body, mapped to its nodes.
    class(body_t), intent(inout) :: body
    !> Number of threads.
    integer, intent(in) :: threads
    real(wp), allocatable :: rest(:, :), mapped(:, :), velocity(:, :)
    integer :: j, n

    if (self%order == 1) return
    call fit_length(body%nodes, body%nodes%gain)
    if (body%points%n_inside == 0) return
    n = body%nodes%window%size()
    allocate (rest, source=body%nodes%velocity(:, :n))
    allocate (mapped(size(rest, 1), n), velocity(size(rest, 1), body%points%n_inside))
    call hold(body, .false., rest)
    body%nodes%gain(:, :n) = 0.0_wp
    do j = 1, self%order - 1
      if (any(body%points%stencil%periodic)) then
        call copy_to_ghosts(body%points%stencil, body%nodes%window, size(rest, 1), rest)
      end if
      call gather(body%points, body%nodes, threads, rest, velocity)
      call map_velocities(body, threads, velocity, .false., mapped)
      rest = rest - mapped
      call hold(body, .true., rest)
      body%nodes%gain(:, :n) = body%nodes%gain(:, :n) + rest
    end do
  end subroutine transfer_filter

  !> Let the walls of a body prescribe a nodal velocity.
  subroutine hold(body, still, velocity)
    !> The body.
    class(body_t), intent(in) :: body
    !> Walls that move do not.
    logical, intent(in) :: still
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)

    if (.not. allocated(body%boundary)) return
    call body%boundary%prescribe(body%nodes%window, still, velocity)
  end subroutine hold

  !> Interpolate a nodal field to the points.
  subroutine gather(points, nodes, threads, field, values)
    !> The points.
    class(points_t), intent(in) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Number of threads.
    integer, intent(in) :: threads
    !> Field. (nvel, nn)
    real(wp), contiguous, intent(in) :: field(:, :)
    !> Values at the points. (nvel, n)
    real(wp), contiguous, intent(inout) :: values(:, :)
    integer :: first, last

    !$omp parallel do default(none) schedule(static) private(last) &
    !$omp num_threads(useful_threads(threads, points%n_inside)) &
    !$omp shared(points, nodes, field, values)
    do first = 1, points%n_inside, block_size
      last = min(first + block_size - 1, points%n_inside)
      call gather_block(points, nodes, field, first, last, values(:, first:last))
    end do
    !$omp end parallel do
  end subroutine gather

  !> Interpolate a nodal field to one block of points.
  subroutine gather_block(points, nodes, field, a, b, values)
    !> The points.
    class(points_t), intent(in) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Field. (nvel, nn)
    real(wp), contiguous, intent(in) :: field(:, :)
    !> First slot.
    integer, intent(in) :: a
    !> Last slot.
    integer, intent(in) :: b
    !> Values at the points. (nvel, b - a + 1)
    real(wp), contiguous, intent(inout) :: values(:, :)
    real(wp) :: unused(3*block_size), gradient(9*block_size)

    call interpolate_points(points, points%stencil, nodes%window, a, b, field, field, values, &
                            unused, gradient)
  end subroutine gather_block

  !> Map velocities of the points to nodal velocities: sum m_p N_i v_p/m_i.
  subroutine map_velocities(body, threads, velocity, affine, mapped)
    !> The body, mapped to its nodes.
    class(body_t), intent(in) :: body
    !> Number of threads.
    integer, intent(in) :: threads
    !> Velocities of the points inside. [m/s] (nvel, n)
    real(wp), contiguous, intent(in) :: velocity(:, :)
    !> Map the affine fields of the points too.
    logical, intent(in) :: affine
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), contiguous, intent(inout) :: mapped(:, :)
    integer :: n, i

    n = body%points%n_inside
    mapped(:, :body%nodes%window%size()) = 0.0_wp
    associate (points => body%points, nodes => body%nodes)
      if (affine) then
        call map_momentum(points, nodes%window, threads, mapped, velocity, points%affine(:, :n))
      else
        call map_momentum(points, nodes%window, threads, mapped, velocity)
      end if
      do i = 1, nodes%window%size()
        if (nodes%mass(i) > 0.0_wp) mapped(:, i) = mapped(:, i)/nodes%mass(i)
      end do
    end associate
  end subroutine map_velocities

  !> Find what the points receive, after the grid update.
  subroutine transfer_finish(self, nodes, dt, threads)
    !> The transfer.
    class(transfer_t), intent(in) :: self
    !> The nodes after their update; XPIC: `gain` is what `filter` found.
    class(nodes_t), intent(inout) :: nodes
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads

    if (self%is_flip()) return
    if (self%order == 1) then
      call fit_length(nodes, nodes%gain)
      nodes%gain(:, :nodes%window%size()) = 0.0_wp
    end if
    call points_gain(nodes%kin%nvel, nodes%window%size(), threads, dt, self%kept, nodes%mass, &
                     nodes%force, nodes%velocity, nodes%increment, nodes%gain)
  end subroutine transfer_finish

  !> Gains of the nodes: g += kept dv + (1 - kept) v.
  !!
  !! v is the velocity with the forces that wait at nodes of negligible mass, dv - dt f/m, so that
  !! momentum is conserved.
  subroutine points_gain(nvel, n, threads, dt, kept, mass, force, velocity, increment, gain)
    !> Components of a vector.
    integer, intent(in) :: nvel
    !> Number of nodes.
    integer, intent(in) :: n
    !> Number of threads.
    integer, intent(in) :: threads
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Part of its own velocity that a point keeps.
    real(wp), intent(in) :: kept
    !> Nodal masses. [kg]
    real(wp), intent(in) :: mass(n)
    !> Nodal forces. [N]
    real(wp), intent(in) :: force(nvel, n)
    !> Nodal velocities at the end of the step. [m/s]
    real(wp), intent(in) :: velocity(nvel, n)
    !> Velocity increments of the step. [m/s]
    real(wp), intent(in) :: increment(nvel, n)
    !> The gains; on entry what is added to them. [m/s]
    real(wp), intent(inout) :: gain(nvel, n)
    integer :: i

    !$omp parallel do default(none) num_threads(useful_threads(threads, n)) schedule(static) &
    !$omp shared(nvel, n, dt, kept, mass, force, velocity, increment, gain) private(i)
    do i = 1, n
      if (mass(i) > 0.0_wp) then
        gain(:, i) = gain(:, i) + kept*increment(:, i) + (1.0_wp - kept)* &
                     (velocity(:, i) + (increment(:, i) - dt*(force(:, i)/mass(i))))
      else
        gain(:, i) = 0.0_wp
      end if
    end do
    !$omp end parallel do
  end subroutine points_gain

  !> Give a nodal field the length of the others.
  subroutine fit_length(nodes, field)
    !> The nodes.
    class(nodes_t), intent(in) :: nodes
    !> The field. (nvel, nn)
    real(wp), allocatable, intent(inout) :: field(:, :)

    if (allocated(field)) then
      if (size(field, 2) == size(nodes%mass)) return
      deallocate (field)
    end if
    allocate (field(nodes%kin%nvel, size(nodes%mass)))
  end subroutine fit_length

end module mpm_transfer
