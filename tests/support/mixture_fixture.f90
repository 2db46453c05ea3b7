!> Grains and fluid that fill the same box, for mixtures.
module mpm_mixture_fixture
  use mpm_contact, only: contact_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_steps, only: locate_points, map_to_nodes
  use mpm_kinds, only: wp
  use mpm_material_fixture, only: material_point_t
  use mpm_model, only: model_t
  use mpm_model_fixture, only: lattice_table, make_body, make_model, moving
  use mpm_properties, only: make_properties, properties_t
  implicit none
  private
  public :: give_material, is_inner, make_mixture, map_bodies, set_up_contact
  public :: packing, rho_fluid, rho_grain

  !> Densities of the materials. [kg/m3]
  real(wp), parameter :: rho_grain = 2500.0_wp, rho_fluid = 1000.0_wp
  !> Packing fraction of the grains.
  real(wp), parameter :: packing = 0.6_wp

contains

  !> Bodies `sand` and `water` between 1 m and 5 m in all directions of a grid of 1 m, mapped.
  subroutine make_mixture(sim_type, v_grains, v_fluid, model, more)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Velocity of the grains. [m/s]
    real(wp), intent(in) :: v_grains(3)
    !> Velocity of the fluid. [m/s]
    real(wp), intent(in) :: v_fluid(3)
    !> The model.
    type(model_t), intent(out) :: model
    !> Room for further bodies; none when left out.
    integer, intent(in), optional :: more
    real(wp), allocatable :: table(:, :)
    integer :: n

    n = 2
    if (present(more)) n = 2 + more
    call make_model(sim_type, [6.0_wp, 6.0_wp, 6.0_wp], [6, 6, 6], n, 0, model)
    call lattice_table(model%kin, [1.0_wp, 1.0_wp, 1.0_wp], 0.5_wp, [8, 8, 8], &
                       packing*rho_grain, table)
    call make_body(model, 1, 'sand', moving(table, v_grains))
    call lattice_table(model%kin, [1.0_wp, 1.0_wp, 1.0_wp], 0.5_wp, [8, 8, 8], &
                       (1.0_wp - packing)*rho_fluid, table)
    call make_body(model, 2, 'water', moving(table, v_fluid))
    if (n == 2) call map_bodies(model)
  end subroutine make_mixture

  !> Map all bodies to their nodes with plain hats.
  subroutine map_bodies(model)
    !> The model.
    type(model_t), intent(inout) :: model
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, size(model%bodies)
      call locate_points(model, i, .false., error)
      call map_to_nodes(model%bodies(i)%body, 1, error)
    end do
  end subroutine map_bodies

  !> Whether all cells around a node are full.
  pure function is_inner(dim, node) result(inner)
    !> Directions of the grid.
    integer, intent(in) :: dim
    !> Grid indices.
    integer, intent(in) :: node(3)
    !> Whether they are.
    logical :: inner

    inner = all(node(:dim) > 1 .and. node(:dim) < 5)
  end function is_inner

  !> Set up a contact from text.
  subroutine set_up_contact(model, text, contact, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> Property lists as in a config.
    character(*), intent(in) :: text
    !> The contact, as it was made.
    class(contact_t), intent(inout) :: contact
    !> Bad properties or bodies.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties

    call contact%describe(description)
    call make_properties(description, model%kin%sim_type, text, properties, error)
    if (allocated(error)) return
    call contact%init(model%grid, model%bodies, properties, error)
  end subroutine set_up_contact

  !> Give a body a material, made from text that must be right.
  subroutine give_material(model, position, class_name, text)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: position
    !> Class of the material.
    character(*), intent(in) :: class_name
    !> Property lists as in a config.
    character(*), intent(in) :: text
    type(material_point_t) :: point

    call point%make(class_name, model%kin%sim_type, text, 1000.0_wp)
    if (len(point%failure) > 0) error stop 'bad material'
    associate (body => model%bodies(position)%body, points => model%bodies(position)%body%points)
      if (allocated(body%material)) deallocate (body%material)
      allocate (body%material, source=point%material)
      deallocate (points%history)
      allocate (points%history(body%material%n_history, points%n))
      call body%material%start(points%n, points%x, points%mass, points%volume, points%history)
    end associate
  end subroutine give_material

end module mpm_mixture_fixture
