!> Points with random domains in a grid, and their functions by definition.
module mpm_domains_fixture
  use mpm_basis_checks_fixture, only: line_definition
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, make_kinematics
  use mpm_point_domains, only: point_domains_t, rule_cpdi, rule_cpdi2, rule_cpgimp
  use mpm_points, only: points_t
  use mpm_random_fixture, only: random_t
  use mpm_stencil, only: basis_box, natural_width, stencil_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: deform_domains, domain_cloud_t, functions_of, give_domains, list_all, make_basis
  public :: make_domain_cloud, set_parallelepiped, sums_by_definition

  !> Points with domains as `points_t` holds them.
  type :: domain_cloud_t
    !> Component counts.
    type(kinematics_t) :: kin
    !> Basis.
    type(stencil_t) :: stencil
    !> Window of all nodes that the points reach.
    type(window_t) :: window
    !> The domains.
    type(point_domains_t) :: domains
    !> Number of points.
    integer :: n = 0
    !> Positions. (dim, n)
    real(wp), allocatable :: x(:, :)
    !> Volumes, of boxes of a constant side. (n)
    real(wp), allocatable :: volume(:)
  end type domain_cloud_t

contains

  !> Give points domains that are boxes of their volumes.
  subroutine give_domains(points, rule)
    !> The points.
    class(points_t), intent(inout) :: points
    !> One of `rule_*`; 0 leaves them without.
    integer, intent(in) :: rule

    if (rule == 0) return
    allocate (points%domains)
    call points%domains%init(points%kin, rule, 1.0_wp, points%volume, points%x)
  end subroutine give_domains

  !> A basis on cells of uneven sides; the box does not begin at 0, but for the radius in TYPE 4.
  subroutine make_basis(sim_type, kind, periodic, n_cells, stencil)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> One of `basis_*`; boxes have half widths of half of a cell along x, else a quarter.
    integer, intent(in) :: kind
    !> Whether the last direction is periodic.
    logical, intent(in) :: periodic
    !> Cells in each direction.
    integer, intent(in) :: n_cells(3)
    !> The basis.
    type(stencil_t), intent(out) :: stencil
    type(kinematics_t) :: kin

    kin = make_kinematics(sim_type)
    stencil%dim = kin%dim
    stencil%kind = kind
    stencil%width = natural_width(kind)
    if (kind == basis_box) stencil%lambda = [0.5_wp, 0.25_wp, 0.25_wp]
    stencil%h(:kin%dim) = [0.5_wp, 0.4_wp, 0.7_wp]
    stencil%lower(:kin%dim) = [0.0_wp, -0.3_wp, 1.1_wp]
    stencil%n_cells(:kin%dim) = n_cells(:kin%dim)
    stencil%periodic(kin%dim) = periodic
  end subroutine make_basis

  !> Random points anywhere in the grid, with random domains about 0.3 m wide.
  subroutine make_domain_cloud(sim_type, kind, periodic, rule, n, cloud)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> One of `basis_*`.
    integer, intent(in) :: kind
    !> Whether the last direction is periodic.
    logical, intent(in) :: periodic
    !> One of `rule_*`.
    integer, intent(in) :: rule
    !> Number of points.
    integer, intent(in) :: n
    !> The points.
    type(domain_cloud_t), intent(out) :: cloud
    real(wp), parameter :: side = 0.3_wp
    type(random_t) :: random
    integer :: p, d

    cloud%kin = make_kinematics(sim_type)
    cloud%n = n
    call make_basis(sim_type, kind, periodic, [6, 5, 4], cloud%stencil)
    allocate (cloud%x(cloud%kin%dim, n), cloud%volume(n))
    associate (stencil => cloud%stencil)
      do p = 1, n
        do d = 1, stencil%dim
          call random%fill(stencil%lower(d), stencil%lower(d) + stencil%h(d)*stencil%n_cells(d), &
                           cloud%x(d:d, p))
        end do
      end do
    end associate
    cloud%volume = side**cloud%kin%dim
    if (sim_type == 4) cloud%volume = cloud%volume*cloud%x(1, :)
    call cloud%domains%init(cloud%kin, rule, 1.0_wp, cloud%volume, cloud%x)
    call deform_domains(random, cloud%domains)
  end subroutine make_domain_cloud

  !> Deform boxes at random, by up to two fifths.
  subroutine deform_domains(random, domains)
    !> Random numbers.
    type(random_t), intent(inout) :: random
    !> The domains.
    type(point_domains_t), intent(inout) :: domains
    real(wp), allocatable :: change(:)
    integer :: p, c

    do p = 1, size(domains%side)
      select case (domains%rule)
      case (rule_cpgimp, rule_cpdi)
        allocate (change(size(domains%stretch, 1)))
        call random%fill(-0.2_wp, 0.2_wp, change)
        domains%stretch(:, p) = domains%stretch(:, p) + change
        deallocate (change)
      case (rule_cpdi2)
        allocate (change(size(domains%corner, 1)))
        call random%fill(-0.2_wp*domains%side(p), 0.2_wp*domains%side(p), change)
        do c = 1, size(change)
          domains%corner(c, p) = domains%corner(c, p) + change(c)
        end do
        deallocate (change)
      case default
        continue
      end select
    end do
  end subroutine deform_domains

  !> Corners of a CPDI2 domain that are those of a CPDI domain.
  subroutine set_parallelepiped(parallelepipeds, slot, domains)
    !> CPDI domains.
    type(point_domains_t), intent(in) :: parallelepipeds
    !> Slot of the point.
    integer, intent(in) :: slot
    !> CPDI2 domains.
    type(point_domains_t), intent(inout) :: domains

    domains%corner(:, slot) = reshape(parallelepipeds%corners(slot), [size(domains%corner, 1)])
  end subroutine set_parallelepiped

  !> Place the points and list their nodes.
  subroutine list_all(cloud, threads)
    !> The points.
    type(domain_cloud_t), intent(inout) :: cloud
    !> Number of threads.
    integer, intent(in) :: threads

    call cloud%domains%place(cloud%stencil, threads, cloud%n, cloud%x, cloud%window)
    call cloud%domains%make_lists(cloud%kin, cloud%stencil, threads, cloud%n, cloud%x, cloud%window)
  end subroutine list_all

  !> Values and gradients of all nodes of the grid at a point, from the lists.
  subroutine functions_of(cloud, p, shape, gradient)
    !> The points, listed.
    type(domain_cloud_t), intent(in) :: cloud
    !> The point.
    integer, intent(in) :: p
    !> Values, nodes with x fastest. (nodes)
    real(wp), intent(out) :: shape(0:)
    !> Gradients. [1/m] (dim, nodes)
    real(wp), intent(out) :: gradient(:, 0:)
    integer :: e, i, node(3), rest

    shape = 0.0_wp
    gradient = 0.0_wp
    associate (list => cloud%domains%list, window => cloud%window, n => cloud%stencil%n_cells + 1)
      do e = list%offset(p - 1) + 1, list%offset(p)
        rest = list%node(e) - 1
        node(1) = mod(rest, window%n(1))
        node(2) = mod(rest/window%n(1), window%n(2))
        node(3) = rest/(window%n(1)*window%n(2))
        node = node + window%lo
        i = node(1) + n(1)*(node(2) + n(2)*node(3))
        shape(i) = shape(i) + list%basis(0, e)
        gradient(:, i) = gradient(:, i) + list%basis(1:, e)
      end do
    end associate
  end subroutine functions_of

  !> Sums over the corners of a domain by their definition, at all nodes of the grid.
  subroutine sums_by_definition(stencil, x, corners, weight, slope, shape, gradient)
    !> Basis.
    type(stencil_t), intent(in) :: stencil
    !> Position of the point. [m]
    real(wp), intent(in) :: x(:)
    !> Corners from the position. [m] (dim, corners)
    real(wp), intent(in) :: corners(:, :)
    !> Weights. (corners)
    real(wp), intent(in) :: weight(:)
    !> Gradients. [1/m] (dim, corners)
    real(wp), intent(in) :: slope(:, :)
    !> Values, nodes with x fastest. (nodes)
    real(wp), intent(out) :: shape(0:)
    !> Gradients. [1/m] (dim, nodes)
    real(wp), intent(out) :: gradient(:, 0:)
    real(wp) :: value
    integer :: c, i, d, rest

    shape = 0.0_wp
    gradient = 0.0_wp
    do c = 1, size(corners, 2)
      do i = 0, size(shape) - 1
        value = 1.0_wp
        rest = i
        do d = 1, stencil%dim
          associate (n => stencil%n_cells(d) + 1)
            value = value*line_definition(stencil, d, mod(rest, n), &
                                          (x(d) + corners(d, c) - stencil%lower(d))/stencil%h(d))
            rest = rest/n
          end associate
        end do
        shape(i) = shape(i) + weight(c)*value
        gradient(:, i) = gradient(:, i) + slope(:, c)*value
      end do
    end do
  end subroutine sums_by_definition

end module mpm_domains_fixture
