!> Avoid a void: points where a body has opened up, fewer where they have come together.
!!
!! A material that stretches draws its points apart until the grid sees holes that are not there. A
!! level set tells inside from outside; where inside no point is near, one is inserted, to which its
!! neighbours give equal parts; points that are too near to each other become one.
module mpm_avoid_a_void
  use mpm_grid, only: grid_t
  use mpm_hashed_random, only: random_direction
  use mpm_kinds, only: lp, wp
  use mpm_level_set, only: level_set_t
  use mpm_point_cells, only: point_cells_t
  use mpm_point_exchange, only: activate, donate, field_means_t, merge_points
  use mpm_points, only: points_t
  use mpm_quadrature_settings, only: quadrature_settings_t
  implicit none
  private
  public :: insert_and_merge

  !> Distance over r of an inserted point from all others; in a cubic lattice of spacing r the
  !! points of a cell are sqrt(3)/2 r from its centre.
  real(wp), parameter :: clearance = 0.5_wp*sqrt(3.0_wp) + 0.01_wp
  !> Distance over r from the surface within which no point is inserted.
  real(wp), parameter :: depth = 2.2_wp
  !> Part of the clearance that roundings may take.
  real(wp), parameter :: slack = 1.0e-9_wp

  !> The points of a body while some are inserted or merged.
  type :: change_t
    !> Whether the point in a slot is active. (n)
    logical, allocatable :: active(:)
    !> Slots of the points in reserve, those of the lowest numbers last. (first `n_reserve`)
    integer, allocatable :: reserve(:)
    !> Points in reserve.
    integer :: n_reserve = 0
    !> Slots of the points inserted. (first `n_new`)
    integer, allocatable :: new(:)
    !> Points inserted.
    integer :: n_new = 0
    !> Points merged into others.
    integer :: n_merged = 0
  contains
    !> Look for the points that are active, and those in reserve.
    procedure :: begin => change_begin
    !> Slots of all active points by their numbers.
    procedure :: by_number => change_by_number
    !> Store the active points first.
    procedure :: finish => change_finish
  end type change_t

contains

  !> Insert and merge points of a body.
  subroutine insert_and_merge(points, grid, settings, step, may_return)
    !> The points, sorted by cell.
    class(points_t), intent(inout) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Number of the step.
    integer(lp), intent(in) :: step
    !> Whether each point of the points file may be taken from the reserve when it is inactive. (n)
    logical, intent(in) :: may_return(:)
    type(change_t) :: change
    type(point_cells_t) :: cells
    character(:), allocatable :: message

    if (points%n_inside == 0) return
    call cells%init(grid, 2.0_wp*settings%r, message)
    if (allocated(message)) return
    call change%begin(points, may_return)
    call cells%fill(change%by_number(points), points%x)
    call insert(points, grid, settings, step, cells, change)
    if (change%n_new > 0) call cells%fill(change%by_number(points), points%x)
    call merge_close(points, settings, cells, change)
    call change%finish(points)
  end subroutine insert_and_merge

  !> Look for the points that are active, and those in reserve.
  subroutine change_begin(self, points, may_return)
    !> The change.
    class(change_t), intent(out) :: self
    !> The points.
    class(points_t), intent(in) :: points
    !> Whether each point of the points file may be taken from the reserve. (n)
    logical, intent(in) :: may_return(:)
    integer :: slot(points%n), id

    allocate (self%active(points%n), self%reserve(points%n), self%new(points%n))
    self%active(:points%n_inside) = .true.
    self%active(points%n_inside + 1:) = .false.
    slot = points%slots()
    do id = points%n, 1, -1
      if (self%active(slot(id)) .or. .not. may_return(id)) cycle
      self%n_reserve = self%n_reserve + 1
      self%reserve(self%n_reserve) = slot(id)
    end do
  end subroutine change_begin

  !> Slots of all active points by their numbers, so that nothing depends on how they are stored.
  pure function change_by_number(self, points) result(slots)
    !> The change.
    class(change_t), intent(in) :: self
    !> The points.
    class(points_t), intent(in) :: points
    !> The slots.
    integer, allocatable :: slots(:)
    integer :: slot(points%n)

    slot = points%slots()
    slots = pack(slot, self%active(slot))
  end function change_by_number

  !> Insert points where there are voids: at most one for each cell.
  subroutine insert(points, grid, settings, step, cells, change)
    !> The points.
    class(points_t), intent(inout) :: points
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Number of the step.
    integer(lp), intent(in) :: step
    !> The active points in cells.
    type(point_cells_t), intent(in) :: cells
    !> The change.
    type(change_t), intent(inout) :: change
    type(level_set_t) :: level
    type(field_means_t) :: means
    real(wp) :: x(points%kin%dim)
    integer :: cell

    call level%init(grid, points%n_inside, points%x)
    call level%measure(cells, points%x, settings%r)
    do cell = 1, cells%window%size()
      x = candidate(settings, step, cells, cell, points%x)
      if (.not. is_void(points, settings, cells, level, change, x)) cycle
      if (change%n_reserve == 0) then
        points%remark = 'no point is left in reserve for position rule 1, so that voids are not &
                        &filled: use a larger "buffer"'
        return
      end if
      if (change%n_new == 0) call means%form(points, level)
      call insert_point(points, settings%scale, cells, level, means, change, x)
    end do
  end subroutine insert

  !> Where a point might be inserted: near the first point of a cell, or at the centre of an empty
  !! one.
  pure function candidate(settings, step, cells, cell, x) result(position)
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> Number of the step.
    integer(lp), intent(in) :: step
    !> The active points in cells.
    type(point_cells_t), intent(in) :: cells
    !> Place of the cell in their window.
    integer, intent(in) :: cell
    !> Positions of all points. [m] (dim, n)
    real(wp), intent(in) :: x(:, :)
    !> The position; in the box of the grid where that repeats. [m]
    real(wp) :: position(size(x, 1))
    integer(lp) :: number
    integer :: at(3), d

    at = cells%window%node(cell)
    if (cells%begin(cell + 1) > cells%begin(cell)) then
      number = at(1) + int(cells%n(1), lp)*(at(2) + int(cells%n(2), lp)*at(3))
      position = x(:, cells%point(cells%begin(cell))) &
                 + clearance*settings%r*random_direction(size(x, 1), settings%seed, step, number)
    else
      position = cells%lower(:size(x, 1)) &
                 + (real(at(:size(x, 1)), wp) + 0.5_wp)*cells%side(:size(x, 1))
    end if
    do d = 1, size(x, 1)
      if (.not. cells%periodic(d)) cycle
      position(d) = cells%lower(d) + modulo(position(d) - cells%lower(d), cells%length(d))
    end do
  end function candidate

  !> Whether a position lies in a void of the body.
  function is_void(points, settings, cells, level, change, x) result(void)
    !> The points.
    class(points_t), intent(in) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> The points that were active before, in cells.
    type(point_cells_t), intent(in) :: cells
    !> Distance to the surface.
    type(level_set_t), intent(in) :: level
    !> The change.
    type(change_t), intent(in) :: change
    !> The position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it does.
    logical :: void
    real(wp) :: margin, least
    integer :: places(125), n_places, i, k, d
    logical :: has_neighbours

    void = .false.
    has_neighbours = .false.
    margin = 0.0_wp
    if (settings%keeps_off_walls) margin = settings%wall_buffer
    do d = 1, size(x)
      if (cells%periodic(d)) cycle
      if (x(d) < cells%lower(d) + margin) return
      if (x(d) > cells%lower(d) + cells%length(d) - margin) return
    end do
    if (.not. level%at(x) < -depth*settings%r) return
    least = clearance*settings%r*(1.0_wp - slack)
    call cells%around(cells%cell_of(x), 1, places, n_places)
    do i = 1, n_places
      do k = cells%begin(places(i)), cells%begin(places(i) + 1) - 1
        if (norm2(cells%way(x, points%x(:, cells%point(k)))) < least) return
        has_neighbours = .true.
      end do
    end do
    do i = 1, change%n_new
      if (norm2(cells%way(x, points%x(:, change%new(i)))) < least) return
    end do
    ! Neighbours give what is put into a void.
    void = has_neighbours
  end function is_void

  !> Insert a point, to which its neighbours give equal parts.
  subroutine insert_point(points, scale, cells, level, means, change, x)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Side of a domain over that of the cube of the point's volume.
    real(wp), intent(in) :: scale
    !> The points that were active before, in cells.
    type(point_cells_t), intent(in) :: cells
    !> Nodes around the points.
    type(level_set_t), intent(in) :: level
    !> Means of their fields at the nodes.
    type(field_means_t), intent(in) :: means
    !> The change, with points in reserve.
    type(change_t), intent(inout) :: change
    !> The position. [m] (dim)
    real(wp), intent(in) :: x(:)
    integer :: places(125), n_places, i, k, n, slot

    slot = change%reserve(change%n_reserve)
    change%n_reserve = change%n_reserve - 1
    call activate(points, slot, x)
    call cells%around(cells%cell_of(x), 1, places, n_places)
    n = sum(cells%begin(places(:n_places) + 1) - cells%begin(places(:n_places)))
    do i = 1, n_places
      do k = cells%begin(places(i)), cells%begin(places(i) + 1) - 1
        call donate(points, cells%point(k), slot, 1.0_wp/real(n + 1, wp))
      end do
    end do
    if (allocated(points%domains)) then
      call points%domains%set_box(points%kin, slot, scale, points%volume(slot), x)
    end if
    call means%give(points, level, slot)
    change%active(slot) = .true.
    change%n_new = change%n_new + 1
    change%new(change%n_new) = slot
  end subroutine insert_point

  !> Make one point of two that are too near to each other.
  !!
  !! A point takes part in one merger at most; otherwise one behind the other would take over a
  !! whole row of points.
  subroutine merge_close(points, settings, cells, change)
    !> The points.
    class(points_t), intent(inout) :: points
    !> The rules.
    type(quadrature_settings_t), intent(in) :: settings
    !> The active points in cells.
    type(point_cells_t), intent(in) :: cells
    !> The change.
    type(change_t), intent(inout) :: change
    integer, allocatable :: slots(:)
    logical :: has_merged(points%n)
    real(wp) :: distance, nearest
    integer :: places(125), n_places, i, j, k, p, q, partner

    if (.not. settings%merge > 0.0_wp) return
    slots = change%by_number(points)
    has_merged = .false.
    do i = 1, size(slots)
      p = slots(i)
      if (has_merged(p)) cycle
      nearest = settings%merge*settings%r
      partner = 0
      call cells%around(cells%cell_of(points%x(:, p)), 1, places, n_places)
      do j = 1, n_places
        do k = cells%begin(places(j)), cells%begin(places(j) + 1) - 1
          q = cells%point(k)
          if (q == p .or. has_merged(q)) cycle
          distance = norm2(cells%way(points%x(:, p), points%x(:, q)))
          if (distance > nearest) cycle
          if (partner > 0 .and. .not. distance < nearest) then
            ! Of two at the same distance that of the lower number.
            if (points%id(q) > points%id(partner)) cycle
          end if
          nearest = distance
          partner = q
        end do
      end do
      if (partner == 0) cycle
      call merge_points(points, p, partner)
      has_merged([p, partner]) = .true.
      change%active(p) = .false.
      change%n_merged = change%n_merged + 1
    end do
  end subroutine merge_close

  !> Store the active points first.
  subroutine change_finish(self, points)
    !> The change.
    class(change_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points
    integer :: p

    if (self%n_new + self%n_merged == 0) return
    call points%permute([pack([(p, p=1, points%n)], self%active), &
                         pack([(p, p=1, points%n)],.not. self%active)])
    points%n_inside = count(self%active)
    call points%locate(points%stencil)
  end subroutine change_finish

end module mpm_avoid_a_void
