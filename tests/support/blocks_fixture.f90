!> Two blocks side by side, for contacts.
module mpm_blocks_fixture
  use mpm_contact, only: contact_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_steps, only: locate_points, map_to_nodes
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_model_fixture, only: lattice_table, make_body, make_model, moving
  use mpm_properties, only: make_properties, properties_t
  implicit none
  private
  public :: make_blocks, make_contact, map_all, meeting, node_state, total_force

  !> Column of nodes where the blocks touch.
  integer, parameter :: meeting = 4

contains

  !> Blocks `left` and `right` that touch at x = 4 on a grid of 1 m, mapped to their nodes.
  subroutine make_blocks(sim_type, v_1, v_2, model)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Velocity of the left block. [m/s]
    real(wp), intent(in) :: v_1(3)
    !> Velocity of the right block. [m/s]
    real(wp), intent(in) :: v_2(3)
    !> The model; densities are 1 and 3 kg/m3.
    type(model_t), intent(out) :: model
    real(wp), allocatable :: table(:, :)

    call make_model(sim_type, [8.0_wp, 4.0_wp, 4.0_wp], [8, 4, 4], 2, 0, model)
    call lattice_table(model%kin, [2.0_wp, 1.0_wp, 1.0_wp], 0.5_wp, [4, 4, 4], 1.0_wp, table)
    call make_body(model, 1, 'left', moving(table, v_1))
    call lattice_table(model%kin, [4.0_wp, 1.0_wp, 1.0_wp], 0.5_wp, [4, 4, 4], 3.0_wp, table)
    call make_body(model, 2, 'right', moving(table, v_2))
    call map_all(model)
  end subroutine make_blocks

  !> Map all bodies to their nodes with plain hats.
  subroutine map_all(model)
    !> The model.
    type(model_t), intent(inout) :: model
    type(error_t), allocatable :: error
    integer :: i

    do i = 1, size(model%bodies)
      call locate_points(model, i, .false., error)
      call map_to_nodes(model%bodies(i)%body, 1, error)
    end do
  end subroutine map_all

  !> A contact set up from text.
  subroutine make_contact(model, text, contact, error)
    !> The model.
    type(model_t), intent(in) :: model
    !> Property lists as in a config.
    character(*), intent(in) :: text
    !> The contact; its class is that of the argument.
    class(contact_t), intent(out) :: contact
    !> Bad properties or bodies.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties

    call contact%describe(description)
    call make_properties(description, model%kin%sim_type, text, properties, error)
    if (allocated(error)) return
    call contact%init(model%grid, model%bodies, properties, error)
  end subroutine make_contact

  !> Mass, momentum and force of a body at a node.
  subroutine node_state(model, body, node, mass, momentum, force)
    !> The model.
    type(model_t), intent(in) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: body
    !> Grid indices of the node, from 0.
    integer, intent(in) :: node(3)
    !> Mass. [kg]
    real(wp), intent(out) :: mass
    !> Momentum at the start of the step. [kg m/s]
    real(wp), intent(out) :: momentum(:)
    !> Force. [N]
    real(wp), intent(out) :: force(:)
    integer :: i

    associate (nodes => model%bodies(body)%body%nodes)
      i = nodes%window%index(node)
      mass = nodes%mass(i)
      momentum = nodes%momentum(:, i)
      force = nodes%force(:, i)
    end associate
  end subroutine node_state

  !> Sum of all nodal forces of all bodies.
  function total_force(model) result(total)
    !> The model.
    type(model_t), intent(in) :: model
    !> The sum. [N]
    real(wp) :: total(model%kin%nvel)
    integer :: i

    total = 0.0_wp
    do i = 1, size(model%bodies)
      associate (nodes => model%bodies(i)%body%nodes)
        total = total + sum(nodes%force(:, :nodes%window%size()), dim=2)
      end associate
    end do
  end function total_force

end module mpm_blocks_fixture
