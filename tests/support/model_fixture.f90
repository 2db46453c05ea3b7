!> Small models put together without files: a grid, bodies made from tables, one material.
module mpm_model_fixture
  use mpm_cartesian_linear, only: cartesian_linear_t
  use mpm_default_body, only: default_body_t
  use mpm_default_nodes, only: default_nodes_t
  use mpm_default_points, only: default_points_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_isotropic_linear_elasticity, only: isotropic_linear_elasticity_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, make_kinematics
  use mpm_model, only: model_t
  use mpm_properties, only: make_properties, properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: lattice_table, make_body, make_grid, make_model, moving

contains

  !> A grid of equal cells with its lower corner at 0.
  subroutine make_grid(sim_type, length, n_cells, grid)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Lengths of the box; those of unused directions are not used. [m]
    real(wp), intent(in) :: length(3)
    !> Cells in each direction.
    integer, intent(in) :: n_cells(3)
    !> The grid.
    type(cartesian_linear_t), intent(out) :: grid
    type(description_t) :: description
    type(properties_t) :: properties
    type(error_t), allocatable :: error
    type(kinematics_t) :: kin
    character(:), allocatable :: reals, integers
    integer :: d

    kin = make_kinematics(sim_type)
    reals = ''
    integers = ''
    do d = 1, kin%dim
      reals = reals//to_text(length(d), 17)
      integers = integers//to_text(n_cells(d))
      if (d < kin%dim) reals = reals//', '
      if (d < kin%dim) integers = integers//', '
    end do
    call grid%describe(description)
    call make_properties(description, sim_type, 'properties = {'//reals//'}'//new_line('a')// &
                         'int-properties = {'//integers//'}', properties, error)
    call grid%init(kin, properties, error)
  end subroutine make_grid

  !> A model with a grid, room for bodies and contacts, and g = 0.
  subroutine make_model(sim_type, length, n_cells, n_bodies, n_contacts, model)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Lengths of the box. [m]
    real(wp), intent(in) :: length(3)
    !> Cells in each direction.
    integer, intent(in) :: n_cells(3)
    !> Number of bodies.
    integer, intent(in) :: n_bodies
    !> Number of contacts.
    integer, intent(in) :: n_contacts
    !> The model.
    type(model_t), intent(out) :: model
    type(cartesian_linear_t) :: grid

    call make_grid(sim_type, length, n_cells, grid)
    model%kin = grid%kin
    allocate (model%grid, source=grid)
    allocate (model%bodies(n_bodies), model%contacts(n_contacts))
  end subroutine make_model

  !> Put a body made from a table into a model.
  subroutine make_body(model, position, name, table, young, poisson)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position in the model's list.
    integer, intent(in) :: position
    !> Name of the body.
    character(*), intent(in) :: name
    !> Rows m, V, x, v, active, as in a points file. (columns, n)
    real(wp), intent(in) :: table(:, :)
    !> Young's modulus; without it the body has no material. [Pa]
    real(wp), intent(in), optional :: young
    !> Poisson ratio; 0 when left out.
    real(wp), intent(in), optional :: poisson
    type(default_points_t) :: points
    type(default_nodes_t) :: nodes
    type(isotropic_linear_elasticity_t) :: material
    type(properties_t) :: nothing
    type(error_t), allocatable :: error
    real(wp) :: nu
    integer :: i

    call points%init_from_table(model%grid, table, name, [(i, i=1, size(table, 2))], error)
    call nodes%init(model%kin, nothing, error)
    allocate (default_body_t :: model%bodies(position)%body)
    associate (body => model%bodies(position)%body)
      body%id = position - 1
      body%name = name
      allocate (body%points, source=points)
      allocate (body%nodes, source=nodes)
      if (.not. present(young)) return
      nu = 0.0_wp
      if (present(poisson)) nu = poisson
      call material%set(model%kin, young, nu)
      allocate (body%material, source=material)
    end associate
  end subroutine make_body

  !> Table of points at the centres of equal boxes: a block at rest.
  subroutine lattice_table(kin, lower, spacing, counts, density, table)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Lower corner of the block. [m]
    real(wp), intent(in) :: lower(3)
    !> Side of a box. [m]
    real(wp), intent(in) :: spacing
    !> Boxes in each direction; those of unused directions are not used.
    integer, intent(in) :: counts(3)
    !> Density. [kg/m3]
    real(wp), intent(in) :: density
    !> Rows m, V, x, v, active. (columns, n)
    real(wp), allocatable, intent(out) :: table(:, :)
    integer :: n(3), i, j, k, p
    real(wp) :: centre(3)

    n = 1
    n(:kin%dim) = counts(:kin%dim)
    allocate (table(3 + 2*kin%nvel, product(n)))
    table = 0.0_wp
    table(size(table, 1), :) = 1.0_wp
    p = 0
    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          p = p + 1
          centre = lower + spacing*(real([i, j, k], wp) - 0.5_wp)
          table(2, p) = spacing**kin%dim
          table(1, p) = density*table(2, p)
          table(3:2 + kin%dim, p) = centre(:kin%dim)
        end do
      end do
    end do
  end subroutine lattice_table

  !> A table with another velocity of all points.
  pure function moving(table, velocity) result(faster)
    !> Rows m, V, x, v, active. (columns, n)
    real(wp), intent(in) :: table(:, :)
    !> Velocity; as many components as the table has are used. [m/s]
    real(wp), intent(in) :: velocity(3)
    !> The table with it. (columns, n)
    real(wp) :: faster(size(table, 1), size(table, 2))
    integer :: c, nvel

    faster = table
    nvel = (size(table, 1) - 3)/2
    do c = 1, nvel
      faster(2 + nvel + c, :) = velocity(c)
    end do
  end function moving

end module mpm_model_fixture
