!> Random points in a grid, with everything that the kernels need.
module mpm_cloud_fixture
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, make_kinematics
  use mpm_random_fixture, only: random_t
  use mpm_sort, only: base_bounds, sort_by_cell
  use mpm_stencil, only: stencil_keys, stencil_t
  use mpm_strings, only: to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: cloud_t, grid_nodes, label, make_cloud, make_stencil, place_points

  !> Points as arrays, as `points_t` holds them.
  type :: cloud_t
    !> Component counts.
    type(kinematics_t) :: kin
    !> Basis.
    type(stencil_t) :: stencil
    !> Box of all nodes that the points reach.
    type(window_t) :: window
    !> Number of points.
    integer :: n = 0
    !> First node of the stencils: lowest and highest.
    integer :: lo(3) = 0, hi(3) = -1
    !> Keys, slots in the order of cells, points before each row.
    integer, allocatable :: key(:), order(:), row_offset(:)
    !> Half sides, masses, volumes. (n)
    real(wp), allocatable :: extent(:), mass(:), volume(:)
    !> Positions, velocities, stresses. (components, n)
    real(wp), allocatable :: x(:, :), velocity(:, :), stress(:, :)
  end type cloud_t

contains

  !> A basis on cells of uneven sides; the box does not begin at 0, but for the radius in TYPE 4.
  subroutine make_stencil(sim_type, width, n_cells, stencil)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> 2: hats; 3, 4: corner-averaged.
    integer, intent(in) :: width
    !> Cells in each direction; those of unused directions are not used.
    integer, intent(in) :: n_cells(3)
    !> The basis.
    type(stencil_t), intent(out) :: stencil
    type(kinematics_t) :: kin

    kin = make_kinematics(sim_type)
    stencil%dim = kin%dim
    stencil%width = width
    stencil%averaged = width > 2
    stencil%h(:kin%dim) = [0.5_wp, 0.4_wp, 0.7_wp]
    stencil%lower(:kin%dim) = [0.0_wp, -0.3_wp, 1.1_wp]
    stencil%n_cells(:kin%dim) = n_cells(:kin%dim)
  end subroutine make_stencil

  !> Which case a message is about.
  pure function label(sim_type, width) result(text)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Width of the stencil.
    integer, intent(in) :: width
    !> For example `TYPE 2, width 3`.
    character(:), allocatable :: text

    text = 'TYPE '//to_text(sim_type)//', width '//to_text(width)
  end function label

  !> Number of nodes of the grid.
  pure function grid_nodes(stencil) result(n)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Number of nodes.
    integer :: n

    n = product(stencil%n_cells + 1)
  end function grid_nodes

  !> Random points anywhere in the grid, with boxes as wide as the basis takes.
  subroutine make_cloud(sim_type, width, n_cells, n, cloud)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> 2: hats; 3, 4: corner-averaged.
    integer, intent(in) :: width
    !> Cells in each direction.
    integer, intent(in) :: n_cells(3)
    !> Number of points.
    integer, intent(in) :: n
    !> The points.
    type(cloud_t), intent(out) :: cloud
    type(random_t) :: random
    real(wp) :: widest
    integer :: p, d

    cloud%kin = make_kinematics(sim_type)
    cloud%n = n
    call make_stencil(sim_type, width, n_cells, cloud%stencil)
    allocate (cloud%key(n), cloud%order(n), cloud%extent(n), cloud%mass(n), cloud%volume(n))
    allocate (cloud%x(cloud%kin%dim, n), cloud%velocity(cloud%kin%nvel, n))
    allocate (cloud%stress(cloud%kin%nstress, n))
    associate (stencil => cloud%stencil)
      widest = real(max(1, width - 2), wp)*minval(stencil%h(:stencil%dim))
      call random%fill(0.25_wp*widest, widest, cloud%extent)
      call random%fill(0.5_wp, 2.0_wp, cloud%mass)
      call random%fill(0.5_wp, 2.0_wp, cloud%volume)
      do p = 1, n
        do d = 1, stencil%dim
          call random%fill(stencil%lower(d), stencil%lower(d) + stencil%h(d)*stencil%n_cells(d), &
                           cloud%x(d:d, p))
        end do
        call random%fill(-1.0_wp, 1.0_wp, cloud%velocity(:, p))
        call random%fill(-1.0_wp, 1.0_wp, cloud%stress(:, p))
      end do
    end associate
    call place_points(cloud)
  end subroutine make_cloud

  !> Keys, order of cells and window of the points.
  subroutine place_points(cloud)
    !> The points.
    type(cloud_t), intent(inout) :: cloud

    call stencil_keys(cloud%stencil, cloud%n, cloud%x, cloud%extent, cloud%key)
    call base_bounds(cloud%stencil, cloud%n, cloud%key, cloud%lo, cloud%hi)
    call sort_by_cell(cloud%stencil, cloud%n, cloud%key, cloud%lo, cloud%hi, cloud%order, &
                      cloud%row_offset)
    cloud%window%lo = cloud%lo
    cloud%window%n = 1
    associate (dim => cloud%stencil%dim)
      cloud%window%n(:dim) = cloud%hi(:dim) - cloud%lo(:dim) + cloud%stencil%width
    end associate
  end subroutine place_points

end module mpm_cloud_fixture
