!> Taking points from a reserve and giving them back, without loss of mass, volume or momentum.
module mpm_point_exchange
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_level_set, only: level_set_t
  use mpm_points, only: points_t
  use mpm_stencil, only: basis_hat, outside
  implicit none
  private
  public :: add_reserve, activate, donate, field_means_t, merge_points, retire

  !> Means of the fields of points at nodes, weighted by volume.
  !!
  !! The fields are those that do not add up when points become one: displacement, stress, and where
  !! they exist loads, velocity gradients and affine fields.
  type :: field_means_t
    !> Means, 0 at nodes without points. (fields, nn)
    real(wp), allocatable :: mean(:, :)
    !> Volumes. [m3] (nn)
    real(wp), allocatable :: volume(:)
  contains
    !> Form the means.
    procedure :: form => field_means_form
    !> Give their values at its position to a point.
    procedure :: give => field_means_give
  end type field_means_t

contains

  !> Put inactive points without mass behind all others.
  subroutine add_reserve(points, n_more)
    !> The points, as read.
    class(points_t), intent(inout) :: points
    !> Number of points to add.
    integer, intent(in) :: n_more
    integer :: i, n

    n = points%n
    call lengthen_integers(points%id, n_more)
    points%id(n + 1:) = [(i, i=n + 1, n + n_more)]
    call lengthen_integers(points%key, n_more)
    points%key(n + 1:) = outside
    call lengthen_integers(points%order, n_more)
    call lengthen_scalars(points%mass, n_more)
    call lengthen_scalars(points%volume, n_more)
    call lengthen_scalars(points%extent, n_more)
    call lengthen_vectors(points%x, n_more)
    call lengthen_vectors(points%displacement, n_more)
    call lengthen_vectors(points%velocity, n_more)
    call lengthen_vectors(points%stress, n_more)
    points%n = n + n_more
  end subroutine add_reserve

  !> Put zeros behind integers.
  subroutine lengthen_integers(values, n_more)
    !> Values.
    integer, allocatable, intent(inout) :: values(:)
    !> Number of zeros.
    integer, intent(in) :: n_more
    integer, allocatable :: longer(:)

    allocate (longer(size(values) + n_more), source=0)
    longer(:size(values)) = values
    call move_alloc(longer, values)
  end subroutine lengthen_integers

  !> Put zeros behind reals.
  subroutine lengthen_scalars(values, n_more)
    !> Values.
    real(wp), allocatable, intent(inout) :: values(:)
    !> Number of zeros.
    integer, intent(in) :: n_more
    real(wp), allocatable :: longer(:)

    allocate (longer(size(values) + n_more), source=0.0_wp)
    longer(:size(values)) = values
    call move_alloc(longer, values)
  end subroutine lengthen_scalars

  !> Put columns of zeros behind columns.
  subroutine lengthen_vectors(values, n_more)
    !> Values. (components, n)
    real(wp), allocatable, intent(inout) :: values(:, :)
    !> Number of columns of zeros.
    integer, intent(in) :: n_more
    real(wp), allocatable :: longer(:, :)

    allocate (longer(size(values, 1), size(values, 2) + n_more), source=0.0_wp)
    longer(:, :size(values, 2)) = values
    call move_alloc(longer, values)
  end subroutine lengthen_vectors

  !> Make a point one without mass at a position.
  subroutine activate(points, slot, x)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Slot of a point of the reserve.
    integer, intent(in) :: slot
    !> The position. [m] (dim)
    real(wp), intent(in) :: x(:)

    call retire(points, slot)
    points%x(:, slot) = x
  end subroutine activate

  !> Take everything but its place from a point, whose mass another one has.
  subroutine retire(points, slot)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Slot.
    integer, intent(in) :: slot

    points%mass(slot) = 0.0_wp
    points%volume(slot) = 0.0_wp
    points%extent(slot) = 0.0_wp
    points%displacement(:, slot) = 0.0_wp
    points%velocity(:, slot) = 0.0_wp
    points%stress(:, slot) = 0.0_wp
    if (allocated(points%load)) points%load(:, slot) = 0.0_wp
    if (allocated(points%gradient)) points%gradient(:, slot) = 0.0_wp
    if (allocated(points%shear_rate)) points%shear_rate(slot) = 0.0_wp
    if (allocated(points%affine)) points%affine(:, slot) = 0.0_wp
    if (allocated(points%reference_volume)) points%reference_volume(slot) = 0.0_wp
    if (allocated(points%smoothed_volume)) points%smoothed_volume(slot) = 0.0_wp
  end subroutine retire

  !> Give a part of one point to another: mass, volume and momentum.
  subroutine donate(points, from, to, part)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Slot of the giver.
    integer, intent(in) :: from
    !> Slot of the receiver.
    integer, intent(in) :: to
    !> What it gives, above 0, at most 1.
    real(wp), intent(in) :: part
    real(wp) :: gift, momentum(points%kin%nvel), arm(points%kin%nvel), dim

    if (allocated(points%domains)) then
      if (points%volume(to) > 0.0_wp) then
        call points%domains%resize(to, 1.0_wp + part*points%volume(from)/points%volume(to))
      end if
      call points%domains%resize(from, 1.0_wp - part)
    end if
    gift = part*points%mass(from)
    ! In TYPE 4 the third component carries angular momentum.
    arm = 1.0_wp
    if (points%kin%sim_type == type_axisymmetric) arm(3) = points%x(1, from)/points%x(1, to)
    momentum = points%mass(to)*points%velocity(:, to) + gift*points%velocity(:, from)*arm
    points%mass(to) = points%mass(to) + gift
    points%mass(from) = points%mass(from) - gift
    points%velocity(:, to) = momentum/points%mass(to)
    call pass(points%volume, from, to, part)
    if (allocated(points%reference_volume)) call pass(points%reference_volume, from, to, part)
    if (allocated(points%smoothed_volume)) call pass(points%smoothed_volume, from, to, part)
    dim = real(points%kin%dim, wp)
    points%extent(to) = (points%extent(to)**dim + part*points%extent(from)**dim)**(1.0_wp/dim)
    points%extent(to) = min(points%extent(to), widest(points))
    points%extent(from) = (1.0_wp - part)**(1.0_wp/dim)*points%extent(from)
  end subroutine donate

  !> Pass a part of a quantity on.
  pure subroutine pass(values, from, to, part)
    !> The quantity. (n)
    real(wp), intent(inout) :: values(:)
    !> Slot of the giver.
    integer, intent(in) :: from
    !> Slot of the receiver.
    integer, intent(in) :: to
    !> The part.
    real(wp), intent(in) :: part
    real(wp) :: gift

    gift = part*values(from)
    values(to) = values(to) + gift
    values(from) = values(from) - gift
  end subroutine pass

  !> The largest half side of a box that the basis takes.
  pure function widest(points) result(extent)
    !> The points.
    class(points_t), intent(in) :: points
    !> Half side. [m]
    real(wp) :: extent

    extent = huge(1.0_wp)
    associate (stencil => points%stencil)
      if (.not. stencil%averaged) return
      extent = minval(stencil%h(:stencil%dim))
      if (stencil%kind == basis_hat .and. stencil%width > 3) extent = 2.0_wp*extent
    end associate
  end function widest

  !> Make one point of two; it stays where it is.
  subroutine merge_points(points, from, to)
    !> The points.
    class(points_t), intent(inout) :: points
    !> Slot of the point that goes back to the reserve.
    integer, intent(in) :: from
    !> Slot of the point that stays.
    integer, intent(in) :: to
    real(wp) :: part

    part = points%volume(from)/(points%volume(from) + points%volume(to))
    points%stress(:, to) = points%stress(:, to) &
                           + part*(points%stress(:, from) - points%stress(:, to))
    if (allocated(points%load)) then
      points%load(:, to) = points%load(:, to) + part*(points%load(:, from) - points%load(:, to))
    end if
    if (allocated(points%affine)) then
      points%affine(:, to) = points%affine(:, to) &
                             + part*(points%affine(:, from) - points%affine(:, to))
    end if
    call donate(points, from, to, 1.0_wp)
    call retire(points, from)
  end subroutine merge_points

  !> Fields of a point behind one another.
  subroutine gather(points, slot, fields)
    !> The points.
    class(points_t), intent(in) :: points
    !> Slot.
    integer, intent(in) :: slot
    !> Their values.
    real(wp), allocatable, intent(inout) :: fields(:)

    fields = [points%displacement(:, slot), points%stress(:, slot)]
    if (allocated(points%load)) fields = [fields, points%load(:, slot)]
    if (allocated(points%gradient)) fields = [fields, points%gradient(:, slot)]
    if (allocated(points%shear_rate)) fields = [fields, points%shear_rate(slot)]
    if (allocated(points%affine)) fields = [fields, points%affine(:, slot)]
  end subroutine gather

  !> Form the means.
  subroutine field_means_form(self, points, level)
    !> The means.
    class(field_means_t), intent(out) :: self
    !> The points.
    class(points_t), intent(in) :: points
    !> Nodes around the points.
    type(level_set_t), intent(in) :: level
    real(wp), allocatable :: fields(:)
    real(wp) :: weights(8), share
    integer :: nodes(8), p, c, i

    call gather(points, 1, fields)
    allocate (self%mean(size(fields), level%window%size()), self%volume(level%window%size()))
    self%mean = 0.0_wp
    self%volume = 0.0_wp
    do p = 1, points%n_inside
      call gather(points, p, fields)
      call level%hats(points%x(:, p), nodes, weights)
      do c = 1, 2**level%dim
        if (nodes(c) == 0) cycle
        share = weights(c)*points%volume(p)
        self%volume(nodes(c)) = self%volume(nodes(c)) + share
        self%mean(:, nodes(c)) = self%mean(:, nodes(c)) + share*fields
      end do
    end do
    do i = 1, size(self%volume)
      if (self%volume(i) > 0.0_wp) self%mean(:, i) = self%mean(:, i)/self%volume(i)
    end do
  end subroutine field_means_form

  !> Give their values at its position to a point.
  subroutine field_means_give(self, points, level, slot)
    !> The means.
    class(field_means_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points
    !> Nodes around the points.
    type(level_set_t), intent(in) :: level
    !> Slot of the point.
    integer, intent(in) :: slot
    real(wp) :: weights(8), total, fields(size(self%mean, 1))
    integer :: nodes(8), c, k

    call level%hats(points%x(:, slot), nodes, weights)
    fields = 0.0_wp
    total = 0.0_wp
    do c = 1, 2**level%dim
      if (nodes(c) == 0) cycle
      if (.not. self%volume(nodes(c)) > 0.0_wp) cycle
      total = total + weights(c)
      fields = fields + weights(c)*self%mean(:, nodes(c))
    end do
    if (total > 0.0_wp) fields = fields/total
    k = 0
    call take(points%displacement(:, slot), fields, k)
    call take(points%stress(:, slot), fields, k)
    if (allocated(points%load)) call take(points%load(:, slot), fields, k)
    if (allocated(points%gradient)) call take(points%gradient(:, slot), fields, k)
    if (allocated(points%shear_rate)) call take(points%shear_rate(slot:slot), fields, k)
    if (allocated(points%affine)) call take(points%affine(:, slot), fields, k)
  end subroutine field_means_give

  !> Take the next values of a list.
  pure subroutine take(values, list, k)
    !> The values.
    real(wp), intent(inout) :: values(:)
    !> The list.
    real(wp), intent(in) :: list(:)
    !> Values of the list taken so far.
    integer, intent(inout) :: k

    values = list(k + 1:k + size(values))
    k = k + size(values)
  end subroutine take

end module mpm_point_exchange
