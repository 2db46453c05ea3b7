!> Points with a choice of quadratures, whose positions can be corrected.
module mpm_improved_quadrature_points
  use mpm_avoid_a_void, only: insert_and_merge
  use mpm_default_points, only: default_points_t
  use mpm_delta_correction, only: correct_by_delta
  use mpm_description, only: description_t
  use mpm_document, only: value_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: lp, wp
  use mpm_level_set, only: level_set_t
  use mpm_memory, only: way_to_more
  use mpm_mesh_grid, only: mesh_grid_t
  use mpm_point_cells, only: point_cells_t
  use mpm_point_exchange, only: add_reserve
  use mpm_points, only: bytes_per_point, points_restore, points_save
  use mpm_properties, only: properties_t
  use mpm_quadrature_settings, only: add_quadrature_properties, avoid_a_void, &
                                     newton_shift, no_correction, quadrature_settings_t, &
                                     speed_shift, sph_shift, strain_shift
  use mpm_sph_shift, only: correct_as_sph, neighbour_distance
  use mpm_store, only: store_t
  use mpm_volume_overshoot, only: gradients_at, measure_overshoot, overshoot_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: improved_quadrature_points_t

  !> Points from a table, with the settings of their quadrature and of their corrections.
  type, extends(default_points_t) :: improved_quadrature_points_t
    !> The rules.
    type(quadrature_settings_t) :: settings
    !> The grid, to whose nodes the volumes of the points are compared.
    class(grid_t), allocatable :: grid
    !> Time since the last correction. [s]
    real(wp) :: elapsed = 0.0_wp
    !> Whether a point that is inactive may be inserted somewhere, by its number; only in position
    !! rule 1. (n)
    logical, allocatable :: may_return(:)
  contains
    procedure, nopass :: describe => improved_quadrature_points_describe
    procedure :: init => improved_quadrature_points_init
    procedure :: averages => improved_quadrature_points_averages
    procedure :: correct => improved_quadrature_points_correct
    procedure :: write_fields => improved_quadrature_points_write_fields
    procedure :: write_node_fields => improved_quadrature_points_write_node_fields
    procedure :: save => improved_quadrature_points_save
    procedure :: restore => improved_quadrature_points_restore
    !> Take the rules, and what they need beside the table.
    procedure :: adopt => improved_quadrature_points_adopt
    procedure, private :: take_reserve
    procedure, private :: measure_level
  end type improved_quadrature_points_t

contains

  !> Purpose and properties of the class.
  subroutine improved_quadrature_points_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('points', 'ImprovedQuadraturePoints', &
                          'Points as those of DefaultPoints, with a choice of quadratures (uGIMP, &
                          &cpGIMP, CPDI, CPDI2) and of corrections of their positions.', &
                          'Baumgarten and Kamrin, IJNME 124 (2023) 2449-2497', &
                          '    point-class = "ImprovedQuadraturePoints"'//nl// &
                          '    point-file = "block.points"'//nl// &
                          '    point-int-props = {0}')
    call add_quadrature_properties(description)
    call description%add_note('The table is that of DefaultPoints. The solver''s flag cpdi has no &
                              &effect on these points.')
    call description%add_note('One integer is enough: position rule 0, no files of corners.')
    call description%add_note('Entries without names follow the order of mpm_3d, in which a scale &
                              &of quadrature 1 comes before the numbers of the position rule; a &
                              &list that is one too short is an error.')
    call description%add_note('Results do not depend on the number of threads; random directions &
                              &depend on the seed, the step and the place alone.')
  end subroutine improved_quadrature_points_describe

  !> Read the points.
  subroutine improved_quadrature_points_init(self, grid, properties, point_file, config_file, error)
    !> The points.
    class(improved_quadrature_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The table.
    type(value_t), intent(in) :: point_file
    !> The config, beside which a relative path is looked for.
    character(*), intent(in) :: config_file
    !> A missing or bad table, or entries that do not fit together.
    type(error_t), allocatable, intent(out) :: error

    call self%settings%read(properties, error)
    if (allocated(error)) return
    call self%default_points_t%init(grid, properties, point_file, config_file, error)
    if (.not. allocated(error)) call self%adopt(grid, properties, error)
  end subroutine improved_quadrature_points_init

  !> Take the rules, and what they need beside the table.
  subroutine improved_quadrature_points_adopt(self, grid, properties, error)
    !> The points, read, with their settings.
    class(improved_quadrature_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties, for the place of a bad one.
    type(properties_t), intent(in) :: properties
    !> Rules that do not go with the grid.
    type(error_t), allocatable, intent(out) :: error
    type(point_cells_t) :: cells
    character(:), allocatable :: message
    integer :: periods(3)

    select type (grid)
    class is (mesh_grid_t)
      call properties%reject('quadrature', 'ImprovedQuadraturePoints need a Cartesian grid', &
                             error, 'use DefaultPoints, or a Cartesian grid')
      return
    class default
    end select
    periods = grid%periods()
    if (self%settings%x_periodic .and. periods(1) == 0) then
      call properties%reject('flags', 'X_PERIODIC, but the grid is not periodic along x', error, &
                             'use a grid such as CartesianCustom, or remove the flag')
      return
    end if
    if (self%settings%rule == avoid_a_void .and. grid%kin%dim == 1) then
      call properties%reject('position', 'position rule 1 needs two or three dimensions', error, &
                             'in TYPE 1 there is no room beside a point: use another rule')
      return
    else if (self%settings%rule == avoid_a_void .or. self%settings%rule == sph_shift) then
      call cells%init(grid, neighbour_distance(self%settings%r), message)
      if (allocated(message)) then
        call properties%reject('position', message, error, 'neighbours are looked for at distances &
                               &up to 2 r: use a smaller r')
        return
      end if
    end if
    allocate (self%grid, source=grid)
    if (self%settings%rule == avoid_a_void .and. self%is_revived) then
      allocate (self%may_return(self%n), source=.true.)
    else if (self%settings%rule == avoid_a_void) then
      call self%take_reserve(properties, error)
      if (allocated(error)) return
    end if
    if (self%settings%quadrature > 0) then
      allocate (self%domains)
      call self%domains%init(self%kin, self%settings%quadrature, self%settings%scale, self%volume, &
                             self%x)
      if (len(self%settings%folder) > 0) self%domains%folder = self%settings%folder
    end if
    if (self%settings%rule < sph_shift) return
    allocate (self%shifted(self%kin%dim, self%n), source=0.0_wp)
    self%needs_gradient = self%settings%corrects_velocity .or. self%settings%rule == strain_shift &
                          .or. self%settings%strain_limit > 0.0_wp
    if (self%needs_gradient) then
      allocate (self%gradient(self%kin%ngrad, self%n), source=0.0_wp)
    end if
  end subroutine improved_quadrature_points_adopt

  !> Put points in reserve behind those of the table.
  subroutine take_reserve(self, properties, error)
    !> The points, read.
    class(improved_quadrature_points_t), intent(inout) :: self
    !> Checked properties, for the place of a bad one.
    type(properties_t), intent(in) :: properties
    !> More points than there is memory for.
    type(error_t), allocatable, intent(out) :: error
    type(error_t), allocatable :: refusal
    integer :: n, n_more

    n = self%n
    ! The buffer may be so large that its product with n has no number.
    n_more = ceiling(min(min(self%settings%buffer, real(huge(1), wp))*real(n, wp), &
                         real(huge(1) - n, wp)))
    call self%claim(int(n, lp) + n_more, bytes_per_point(self%kin), refusal)
    if (allocated(refusal)) then
      call properties%reject('buffer', 'with those in reserve '//refusal%message, error, &
                             'use a smaller buffer, or '//way_to_more())
      return
    end if
    allocate (self%may_return(n + n_more))
    self%may_return = .true.
    ! What the table says to be inactive stays so.
    self%may_return(self%id(self%n_inside + 1:)) = .false.
    call add_reserve(self, n_more)
    self%x(:, n + 1:) = spread(self%x(:, n), 2, n_more)
  end subroutine take_reserve

  !> Correct positions at the end of a step.
  subroutine improved_quadrature_points_correct(self, step, dt, threads)
    !> The points, moved.
    class(improved_quadrature_points_t), intent(inout) :: self
    !> Number of the step, from 1.
    integer(lp), intent(in) :: step
    !> Its length. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads

    if (self%settings%rule == no_correction) return
    self%elapsed = self%elapsed + dt
    if (mod(step, int(self%settings%skip, lp)) /= 0) return
    ! Points that left the grid in this step take no part.
    call self%refresh_order(threads)
    select case (self%settings%rule)
    case (avoid_a_void)
      call insert_and_merge(self, self%grid, self%settings, step, self%may_return)
    case (sph_shift)
      call correct_as_sph(self, self%grid, self%settings, self%elapsed, threads)
    case (strain_shift, speed_shift, newton_shift)
      call correct_by_delta(self, self%grid, self%settings, self%elapsed, threads)
    case default
    end select
    self%elapsed = 0.0_wp
  end subroutine improved_quadrature_points_correct

  !> Send the fields of a frame.
  subroutine improved_quadrature_points_write_fields(self, writer)
    !> The points.
    class(improved_quadrature_points_t), intent(in) :: self
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer
    type(overshoot_t) :: overshoot
    type(level_set_t) :: level
    real(wp), allocatable :: gradient(:, :), distance(:)
    integer :: p

    call self%default_points_t%write_fields(writer)
    allocate (gradient(self%kin%dim, self%n), source=0.0_wp)
    call measure_overshoot(self, self%grid, overshoot)
    call gradients_at(self, overshoot, overshoot%relative, 1, gradient)
    call writer%vector('grad_err', gradient)
    call gradients_at(self, overshoot, overshoot%excess, 1, gradient)
    call writer%vector('grad_H', gradient)
    if (allocated(self%shifted)) call writer%vector('del_pos', self%shifted)
    if (self%settings%rule /= avoid_a_void) return
    call self%measure_level(level)
    allocate (distance(self%n), source=0.0_wp)
    do p = 1, self%n_inside
      distance(p) = level%at(self%x(:, p))
    end do
    call writer%scalar('point_dist', distance)
  end subroutine improved_quadrature_points_write_fields

  !> Distance of the nodes to the surface of the points, for a frame.
  subroutine measure_level(self, level)
    !> The points.
    class(improved_quadrature_points_t), intent(in) :: self
    !> The distances.
    type(level_set_t), intent(out) :: level
    type(point_cells_t) :: cells
    character(:), allocatable :: message
    integer :: p

    call cells%init(self%grid, 2.0_wp*self%settings%r, message)
    call cells%fill([(p, p=1, self%n_inside)], self%x)
    call level%init(self%grid, self%n_inside, self%x)
    call level%measure(cells, self%x, self%settings%r)
  end subroutine measure_level

  !> Send nodal fields of a frame.
  subroutine improved_quadrature_points_write_node_fields(self, writer)
    !> The points.
    class(improved_quadrature_points_t), intent(in) :: self
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    type(overshoot_t) :: overshoot
    type(level_set_t) :: level
    type(window_t) :: whole
    real(wp), allocatable :: own(:)
    integer :: i

    whole = self%grid%whole()
    allocate (own(whole%size()))
    do i = 1, size(own)
      own(i) = self%grid%node_volume(whole%node(i))
    end do
    call writer%scalar('grid_volume', own, whole)
    call measure_overshoot(self, self%grid, overshoot)
    call writer%scalar('err', overshoot%relative, overshoot%window)
    call writer%scalar('H', overshoot%excess, overshoot%window)
    if (self%settings%rule /= avoid_a_void) return
    call self%measure_level(level)
    call writer%scalar('grid_dist', level%distance, level%window)
  end subroutine improved_quadrature_points_write_node_fields

  !> Functions at the points, or means over domains: the flag of the solver has no effect.
  pure function improved_quadrature_points_averages(self, cpdi) result(averages)
    !> The points.
    class(improved_quadrature_points_t), intent(in) :: self
    !> What the solver asks for.
    logical, intent(in) :: cpdi
    !> Whether the functions are averaged over the corners of the points' boxes.
    logical :: averages

    associate (unused => self, unused_cpdi => cpdi)
    end associate
    averages = .false.
  end function improved_quadrature_points_averages

  !> Save what corrections remember besides the points.
  subroutine improved_quadrature_points_save(self, store)
    !> The points.
    class(improved_quadrature_points_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store

    call points_save(self, store)
    call store%put('elapsed', self%elapsed)
    if (allocated(self%may_return)) call store%put('may_return', self%may_return)
  end subroutine improved_quadrature_points_save

  !> Take it back.
  subroutine improved_quadrature_points_restore(self, store)
    !> The points, started.
    class(improved_quadrature_points_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store

    call points_restore(self, store)
    call store%get('elapsed', self%elapsed)
    if (store%has('may_return')) call store%get('may_return', self%may_return)
  end subroutine improved_quadrature_points_restore

end module mpm_improved_quadrature_points
