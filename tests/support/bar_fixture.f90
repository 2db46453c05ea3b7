!> A bar in one dimension that fills a box of 1 m between two walls, and its modes.
module mpm_bar_fixture
  use mpm_cartesian_smooth_box, only: cartesian_smooth_box_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: lp, wp
  use mpm_model, only: model_t
  use mpm_model_fixture, only: lattice_table, make_body, make_model
  use mpm_properties, only: make_properties, properties_t
  use mpm_solver, only: solver_t
  implicit none
  private
  public :: advance, energy_of, filter_of, make_bar, mode_slopes, mode_values, put_walls, set_up

  !> Ratio of a circle's circumference to its diameter.
  real(wp), parameter :: pi = acos(-1.0_wp)

contains

  !> A bar of density 1 kg/m3 at rest.
  subroutine make_bar(cells, per_cell, model, young)
    !> Cells of the grid.
    integer, intent(in) :: cells
    !> Points in a cell.
    integer, intent(in) :: per_cell
    !> The model.
    type(model_t), intent(out) :: model
    !> Young's modulus; without it the bar has no material. [Pa]
    real(wp), intent(in), optional :: young
    real(wp), allocatable :: table(:, :)

    call make_model(1, [1.0_wp, 1.0_wp, 1.0_wp], [cells, 1, 1], 1, 0, model)
    call lattice_table(model%kin, [0.0_wp, 0.0_wp, 0.0_wp], 1.0_wp/real(cells*per_cell, wp), &
                       [cells*per_cell, 0, 0], 1.0_wp, table)
    call make_body(model, 1, 'bar', table, young)
    call put_walls(model, 1)
  end subroutine make_bar

  !> Give a body walls without friction on all faces.
  subroutine put_walls(model, body)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position of the body.
    integer, intent(in) :: body
    type(cartesian_smooth_box_t) :: walls
    type(properties_t) :: nothing
    type(error_t), allocatable :: error

    associate (item => model%bodies(body)%body)
      call walls%init(model%grid, item%points, nothing, error)
      allocate (item%boundary, source=walls)
    end associate
  end subroutine put_walls

  !> Set a solver up from text.
  subroutine set_up(solver, sim_type, text, error)
    !> The solver.
    class(solver_t), intent(inout) :: solver
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Property lists as in a config.
    character(*), intent(in) :: text
    !> Bad properties.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties

    call solver%describe(description)
    call make_properties(description, sim_type, text, properties, error)
    if (allocated(error)) return
    call solver%init(properties, error)
  end subroutine set_up

  !> Make steps; stops at the first error.
  subroutine advance(solver, model, dt, steps, error)
    !> The solver, started.
    class(solver_t), intent(inout) :: solver
    !> The model.
    type(model_t), intent(inout) :: model
    !> Length of a step. [s]
    real(wp), intent(in) :: dt
    !> Number of steps.
    integer, intent(in) :: steps
    !> The first error.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    do i = 1, steps
      call solver%step(model, dt, .false., error)
      if (allocated(error)) return
      model%step = model%step + 1_lp
      model%time = model%time + dt
      model%last_dt = dt
    end do
  end subroutine advance

  !> Hats' interpolation of sin(m pi x) at positions.
  pure function mode_values(cells, m, x) result(values)
    !> Cells of the grid.
    integer, intent(in) :: cells
    !> Half waves in the bar.
    integer, intent(in) :: m
    !> Positions. [m]
    real(wp), intent(in) :: x(:)
    !> Values.
    real(wp) :: values(size(x))
    integer :: p, i

    do p = 1, size(x)
      i = int(x(p)*cells)
      values(p) = (i + 1 - x(p)*cells)*sin(m*pi*i/cells) + (x(p)*cells - i)*sin(m*pi*(i + 1)/cells)
    end do
  end function mode_values

  !> Slopes of the hats' interpolation of sin(m pi x) at positions.
  pure function mode_slopes(cells, m, x) result(slopes)
    !> Cells of the grid.
    integer, intent(in) :: cells
    !> Half waves in the bar.
    integer, intent(in) :: m
    !> Positions. [m]
    real(wp), intent(in) :: x(:)
    !> Slopes. [1/m]
    real(wp) :: slopes(size(x))
    integer :: p, i

    do p = 1, size(x)
      i = int(x(p)*cells)
      slopes(p) = cells*(sin(m*pi*(i + 1)/cells) - sin(m*pi*i/cells))
    end do
  end function mode_slopes

  !> What the map from the nodes to the points and back leaves of sin(m pi x): mu = 1 - g s,
  !! g = 2/3 + 1/(3 n**2), s = sin(k h/2)**2.
  pure function filter_of(cells, per_cell, m) result(mu)
    !> Cells of the grid.
    integer, intent(in) :: cells
    !> Points in a cell, at equal distances and symmetric in it.
    integer, intent(in) :: per_cell
    !> Half waves in the bar.
    integer, intent(in) :: m
    !> The factor.
    real(wp) :: mu

    mu = 1 - (2.0_wp/3 + 1/(3.0_wp*per_cell**2))*sin(m*pi/(2*cells))**2
  end function filter_of

  !> Kinetic and strain energy of the bar, Young's modulus 1 and no lateral strain stiffness.
  pure function energy_of(model) result(energy)
    !> The model.
    type(model_t), intent(in) :: model
    !> The sum. [J]
    real(wp) :: energy

    associate (points => model%bodies(1)%body%points)
      energy = 0.5_wp*sum(points%mass*points%velocity(1, :)**2) &
               + 0.5_wp*sum(points%volume*points%stress(1, :)**2)
    end associate
  end function energy_of

end module mpm_bar_fixture
