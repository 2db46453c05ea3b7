!> A wall of its own kind on each face of the grid.
module mpm_cartesian_box_custom
  use mpm_boundary, only: boundary_t
  use mpm_box_faces, only: axis_names, axis_of, box_faces_t, face_names, is_lower
  use mpm_box_rules, only: apply_rules, hold_increment, node_rules, prescribe
  use mpm_box_wall, only: box_wall_t, read_walls, wall_bounded, wall_free, wall_friction, &
                          wall_traction
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_axisymmetric
  use mpm_nodes, only: nodes_t
  use mpm_point_maps, only: map_volume
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_stencil, only: basis_hat, stencil_t
  use mpm_window, only: window_t
  implicit none
  private
  public :: cartesian_box_custom_t

  !> One rule for each face, chosen by its code; classes that extend it choose the codes themselves.
  type, extends(boundary_t) :: cartesian_box_custom_t
    !> The faces.
    type(box_faces_t) :: faces
    !> What each of them does. (faces%n)
    type(box_wall_t), allocatable :: walls(:)
  contains
    procedure, nopass :: describe => custom_describe
    procedure :: init => custom_init
    procedure :: generate => custom_generate
    procedure :: apply => custom_apply
    procedure :: prescribe => custom_prescribe
    procedure :: write_fields => custom_write_fields
  end type cartesian_box_custom_t

contains

  !> Purpose and properties of the class.
  subroutine custom_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    integer :: face

    call description%init('boundary', 'CartesianBoxCustom', &
                          'A wall of its own kind on each face of the grid: free, no slip, free &
                          &slip, friction, periodic, driven, or loaded by a traction.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196; Coulomb friction &
                          &as in Bardenhagen, Brackbill and Sulsky, CMAME 187 (2000) 529-541', &
                          '    boundary-class = "CartesianBoxCustom"'//nl// &
                          '    boundary-int-props = {1, 1, 2, 4}         # -x, +x, -y, +y'//nl// &
                          '    boundary-props = {0.3, 1.0, 0.0, 0.0}     # mu; V_x, V_y, -')
    do face = 1, 6
      call description%add_integer(trim(face_names(face)), 'wall at the '// &
                                   trim(merge('lower', 'upper', is_lower(face)))//' '// &
                                   axis_names(axis_of(face))//' face: -1 free, 0 no slip, 1 free &
                                   &slip, 2 friction, 3 periodic, 4 driven, 5 traction, 6 driven &
                                   &with bounded traction', lower=wall_free, upper=wall_bounded, &
                                   types=types_with_dim(axis_of(face)))
    end do
    call description%add_integer('unilateral', '1: walls of code 2 only push, and take the &
                                 &momentum that they stop from the points; 0: as mpm_3d', &
                                 default=0, lower=0, upper=1, by_name=.true.)
    call description%add_real('values', 'by code', 'what the codes take, face by face: 2: mu [-]; &
                              &4: velocity V [m/s], 3 entries; 5: traction t [Pa], 3 entries; &
                              &6: V [m/s] and the largest traction tau_max [Pa], 4 entries', &
                              any_real=.true., is_list=.true.)
    call add_notes(description)
  end subroutine custom_describe

  !> Remarks on the rules, and on what differs from mpm_3d.
  subroutine add_notes(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_note('Codes 4 and 5 take 3 entries and code 6 takes 4 in every TYPE: &
                              &first the components that velocities have, for code 6 then &
                              &tau_max, then entries that are not used.')
    call description%add_note('Code 2: the normal component is 0; friction is at most mu times &
                              &the force that stops the body''s own closing motion, forces of &
                              &contacts left out, and acts on all motion that is left. Such a &
                              &wall also holds a body that leaves, and what its nodes stop stays &
                              &in the points: friction is not mu times the impulse on the body. &
                              &With unilateral = 1 it is, to round-off.')
    call description%add_note('Code 4 holds every component at V. Code 5 loads the part of the &
                              &face that is filled with points; NaN in place of a component of t &
                              &fixes that component. Code 6 stops the normal component, then &
                              &drives the node towards V with at most tau_max.')
    call description%add_note('Nodes of several faces: faces act in the order x, y, z. Code 0 &
                              &fixes all components; codes 1 and 2 rule their normal component, &
                              &code -1 frees it. Codes 4, 5 and 6 replace what earlier &
                              &directions said, but not where their normal component is fixed; a &
                              &later code 0 replaces them. So one traction alone acts on an edge &
                              &of two faces with code 5, that of the later direction.')
    call description%add_note('Code 1 on the axis r = 0 of TYPE 4 also fixes the swirl, and what &
                              &other faces say does not change that.')
    call description%add_note('TYPE 4: the area that codes 5 and 6 load on faces of constant z is &
                              &that of the points, per radian, so that a uniform traction &
                              &balances a uniform stress.')
    call description%add_note('Code 3 needs both faces of the direction and a grid that is &
                              &periodic in it, which moves the points; such a grid takes only &
                              &codes 3 and -1 there.')
    call description%add_note('bc_nodal_mask: 0 no rule, 1 fixed, -1 free, 2 friction, 3 &
                              &periodic, 4, 5, 6 as the code; 2, 4, 5, 6 are negative on upper &
                              &faces. Nodes without memory show 0.')
    call description%add_note('mpm_3d lets the friction of one face act on others, uses one mu &
                              &and one tau_max for all faces, forgets hoop stress in code 2, &
                              &fixes tangential components in code 6, uses one area for all &
                              &nodes of codes 5 and 6, and ignores unknown codes.')
  end subroutine add_notes

  !> Read the walls.
  subroutine custom_init(self, grid, points, properties, error)
    !> The boundary.
    class(cartesian_box_custom_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body; left as they are.
    class(points_t), intent(inout) :: points
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The grid, the codes and the values do not fit together.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => points)
    end associate
    call self%faces%init(grid, 'CartesianBoxCustom', error)
    if (allocated(error)) return
    call read_walls(self%faces, properties, self%walls, error)
    if (allocated(error)) return
  end subroutine custom_init

  !> Keep the body's own normal forces at walls with friction, find the filled area of loaded ones.
  subroutine custom_generate(self, grid, points, nodes)
    !> The boundary.
    class(cartesian_box_custom_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> Nodes of the body: mass, momentum, internal and body forces.
    class(nodes_t), intent(in) :: nodes
    integer :: face

    associate (unused => grid)
    end associate
    do face = 1, self%faces%n
      self%walls(face)%part = self%faces%part(face, nodes%window)
      select case (self%walls(face)%code)
      case (wall_friction)
        call keep_own_force(axis_of(face), nodes, self%walls(face))
      case (wall_traction, wall_bounded)
        call fill_area(self%faces, face, points, self%walls(face))
      case default
        cycle
      end select
    end do
  end subroutine custom_generate

  !> Keep the normal component of the forces at a wall.
  subroutine keep_own_force(axis, nodes, wall)
    !> Direction normal to the wall.
    integer, intent(in) :: axis
    !> Nodes of the body.
    class(nodes_t), intent(in) :: nodes
    !> The wall.
    type(box_wall_t), intent(inout) :: wall
    integer :: hi(3), i, j, k

    call resize(wall%own_force, wall%part%size())
    hi = wall%part%hi()
    do k = wall%part%lo(3), hi(3)
      do j = wall%part%lo(2), hi(2)
        do i = wall%part%lo(1), hi(1)
          wall%own_force(wall%part%index([i, j, k])) = &
            nodes%force(axis, nodes%window%index([i, j, k]))
        end do
      end do
    end do
  end subroutine keep_own_force

  !> Area of a wall at its nodes, times the fraction that is filled with points.
  !!
  !! For hats the fraction is sum_p N_i V_p over the integral of N_i, which is 1 where points fill
  !! the cells evenly. On faces of constant z in TYPE 4 the area is that of the points, sum_p N_i
  !! V_p over half a cell: it belongs to the nodal masses and forces, so that a uniform traction
  !! balances a uniform stress, which the exact integral of r does not.
  !!
  !! The sums of smoother functions next to a wall differ from their integrals. They give the
  !! distribution of the area over the nodes, which belongs to masses and forces; hats give its sum.
  subroutine fill_area(faces, face, points, wall)
    !> The faces.
    type(box_faces_t), intent(in) :: faces
    !> Face of the wall.
    integer, intent(in) :: face
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> The wall.
    type(box_wall_t), intent(inout) :: wall
    real(wp), allocatable :: by_basis(:)
    logical :: around_axis

    call resize(wall%filled_area, wall%part%size())
    if (size(wall%filled_area) == 0) return
    if (points%stencil%kind == basis_hat) then
      call fill_hats(faces, face, points, wall)
      return
    end if
    around_axis = faces%kin%sim_type == type_axisymmetric .and. axis_of(face) == 1
    call map_volume(points, wall%part, around_axis, wall%filled_area, by_hats=.true.)
    wall%filled_area = wall%filled_area/(0.5_wp*faces%h(axis_of(face)))
    if (around_axis) then
      wall%filled_area = merge(faces%lower(1), faces%upper(1), is_lower(face))*wall%filled_area
    end if
    allocate (by_basis(size(wall%filled_area)))
    call map_volume(points, wall%part, around_axis, by_basis)
    if (sum(by_basis) > 0.0_wp) then
      wall%filled_area = by_basis*(sum(wall%filled_area)/sum(by_basis))
    end if
  end subroutine fill_area

  !> The area of a wall by hats.
  subroutine fill_hats(faces, face, points, wall)
    !> The faces.
    type(box_faces_t), intent(in) :: faces
    !> Face of the wall.
    integer, intent(in) :: face
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> The wall.
    type(box_wall_t), intent(inout) :: wall
    integer :: hi(3), node(3), i, j, k, n

    if (faces%kin%sim_type == type_axisymmetric .and. axis_of(face) == 2) then
      call map_volume(points, wall%part, .false., wall%filled_area)
      wall%filled_area = wall%filled_area/(0.5_wp*faces%h(2))
      return
    end if
    call map_volume(points, wall%part, .true., wall%filled_area)
    hi = wall%part%hi()
    do k = wall%part%lo(3), hi(3)
      do j = wall%part%lo(2), hi(2)
        do i = wall%part%lo(1), hi(1)
          node = [i, j, k]
          n = wall%part%index(node)
          wall%filled_area(n) = faces%area(face, node)*wall%filled_area(n)/ &
                                hat_volume(points%stencil, node)
        end do
      end do
    end do
  end subroutine fill_hats

  !> Integral of the hat of a node over the grid (TYPE 4: over the meridian plane).
  pure function hat_volume(stencil, node) result(volume)
    !> Basis, for the cells.
    type(stencil_t), intent(in) :: stencil
    !> Grid indices of the node, from 0.
    integer, intent(in) :: node(3)
    !> Product over the directions of h, of h/2 at walls. [m3]
    real(wp) :: volume
    integer :: d

    volume = 1.0_wp
    do d = 1, stencil%dim
      volume = volume*stencil%h(d)
      if (stencil%periodic(d)) cycle
      if (node(d) == 0 .or. node(d) == stencil%n_cells(d)) volume = 0.5_wp*volume
    end do
  end function hat_volume

  !> Give an array a length, unless it has it.
  subroutine resize(values, n)
    !> The array.
    real(wp), allocatable, intent(inout) :: values(:)
    !> Its length.
    integer, intent(in) :: n

    if (allocated(values)) then
      if (size(values) == n) return
      deallocate (values)
    end if
    allocate (values(n))
  end subroutine resize

  !> Apply the walls to the nodes of all faces.
  subroutine custom_apply(self, grid, points, nodes, dt)
    !> The boundary.
    class(cartesian_box_custom_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> Nodes of the body: momentum at the start of the step, all forces.
    class(nodes_t), intent(inout) :: nodes
    !> Time step. [s]
    real(wp), intent(in) :: dt
    integer :: face, hi(3), node(3), i, j, k, n

    associate (unused => grid, unused_points => points)
    end associate
    do face = 1, self%faces%n
      associate (part => self%walls(face)%part)
        hi = part%hi()
        do k = part%lo(3), hi(3)
          do j = part%lo(2), hi(2)
            do i = part%lo(1), hi(1)
              node = [i, j, k]
              if (self%faces%first(node) /= face) cycle
              n = nodes%window%index(node)
              call apply_rules(self%faces, self%walls, node, dt, nodes%mass(n), &
                               nodes%velocity(:, n), nodes%momentum(:, n), nodes%force(:, n))
              if (all(abs(nodes%increment(:, n)) <= 0.0_wp)) cycle
              call hold_increment(node_rules(self%faces, self%walls, node), nodes%increment(:, n))
            end do
          end do
        end do
      end associate
    end do
  end subroutine custom_apply

  !> Give components that walls prescribe their values on the nodes of all faces.
  subroutine custom_prescribe(self, window, still, velocity)
    !> The boundary.
    class(cartesian_box_custom_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Take 0 for the velocity of walls that move, as for a difference of two velocities.
    logical, intent(in) :: still
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)
    type(window_t) :: part
    integer :: face, hi(3), node(3), i, j, k

    do face = 1, self%faces%n
      part = self%faces%part(face, window)
      hi = part%hi()
      do k = part%lo(3), hi(3)
        do j = part%lo(2), hi(2)
          do i = part%lo(1), hi(1)
            node = [i, j, k]
            if (self%faces%first(node) /= face) cycle
            call prescribe(self%faces, self%walls, node, still, velocity(:, window%index(node)))
          end do
        end do
      end do
    end do
  end subroutine custom_prescribe

  !> Send the rule of each component.
  subroutine custom_write_fields(self, grid, nodes, writer)
    !> The boundary.
    class(cartesian_box_custom_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Nodes of the body.
    class(nodes_t), intent(in) :: nodes
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: mask(:, :)
    type(window_t) :: part
    integer :: face, hi(3), rules(3), nvel, i, j, k

    associate (unused => grid)
    end associate
    nvel = self%faces%kin%nvel
    allocate (mask(nvel, nodes%window%size()), source=0.0_wp)
    do face = 1, self%faces%n
      part = self%faces%part(face, nodes%window)
      hi = part%hi()
      do k = part%lo(3), hi(3)
        do j = part%lo(2), hi(2)
          do i = part%lo(1), hi(1)
            rules = node_rules(self%faces, self%walls, [i, j, k])
            mask(:, nodes%window%index([i, j, k])) = real(rules(:nvel), wp)
          end do
        end do
      end do
    end do
    call writer%vector('bc_nodal_mask', mask, nodes%window)
  end subroutine custom_write_fields

end module mpm_cartesian_box_custom
