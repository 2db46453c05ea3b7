!> Walls on the tagged sides of a mesh.
module mpm_general_custom_boundary
  use mpm_boundary, only: boundary_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: type_3d, type_axisymmetric
  use mpm_mesh_grid, only: mesh_grid_t, most_tags
  use mpm_nodes, only: nodes_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, string_t, to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: general_custom_boundary_t

  !> Codes of sides: free, given velocity, free slip.
  integer, parameter :: code_free = -1, code_velocity = 0, code_slip = 1
  !> Tag of the nodes on the y axis of mpm_3d.
  integer, parameter :: axis_tag = 255

  !> A rule for each tag.
  type, extends(boundary_t) :: general_custom_boundary_t
    private
    !> Nodes that a rule holds, from 0. (n)
    integer, allocatable :: node(:)
    !> Tag of each of them, for frames. (n)
    integer, allocatable :: tag(:)
    !> Whether the velocity is given, and not only without component along normals. (n)
    logical, allocatable :: is_given(:)
    !> The velocity. [m/s] (nvel, n)
    real(wp), allocatable :: velocity(:, :)
    !> Directions along which a node does not move: unit vectors across each other, or 0.
    !! (nvel, 3, n)
    real(wp), allocatable :: normal(:, :, :)
  contains
    procedure, nopass :: describe => general_custom_boundary_describe
    procedure :: init => general_custom_boundary_init
    procedure :: apply => general_custom_boundary_apply
    procedure :: prescribe => general_custom_boundary_prescribe
    procedure :: write_fields => general_custom_boundary_write_fields
    procedure, private :: hold_node
  end type general_custom_boundary_t

contains

  !> Purpose and properties of the class.
  subroutine general_custom_boundary_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('boundary', 'GeneralCustomBoundary', &
                          'A rule for each tag of the sides of a mesh: free, a given velocity, or &
                          &free slip.', &
                          'The tags of mpm_3d v3', &
                          '    boundary-class = "GeneralCustomBoundary"'//nl// &
                          '    # the number of codes, then those of the tags 0, 1, 2 ...'//nl// &
                          '    boundary-int-props = {5, -1, 1, 0, -1, -1}'//nl// &
                          '    # a vector for each tag: none, normal, velocity, none, none'//nl// &
                          '    boundary-props = {0, 0,  -1, 0,  0, 0,  0, 0,  0, 0}')
    call description%add_real('vectors', 'm/s', 'a vector for each code, as many components as the &
                              &grid has directions: velocity (0), normal of any length (1)', &
                              is_list=.true.)
    call description%add_integer('n', 'number of codes; the tags are 0 to n - 1', default=0, &
                                 lower=0)
    call description%add_integer('codes', 'of each tag: -1 free, 0 given velocity, 1 free slip', &
                                 is_list=.true.)
    call description%add_string('flags', 'USE_Y_AXIS_ROTATION (TYPE 3): nodes on the y axis do not &
                                &leave it', is_list=.true.)
    call description%add_note('Code 0: the nodes move with the vector, whatever acts on them. Code &
                              &1: they do not move along the vector, which need not be of length &
                              &1, and move freely across it (mpm_3d: forces across it are deleted, &
                              &and those along it stay).')
    call description%add_note('A node with several tags obeys all of them: it does not move along &
                              &any of the normals, and a given velocity counts before all else &
                              &(mpm_3d: the last tag of the file counts).')
    call description%add_note('Tags without a code are free, and the program says so once. Other &
                              &codes are errors (mpm_3d: velocity 0).')
    call description%add_note('TYPE 4: nodes on the axis r = 0 are held along r and theta.')
    call description%add_note('The field bc_tags has the tag of nodes that are held, 255 for the &
                              &axis, and -1 elsewhere.')
  end subroutine general_custom_boundary_describe

  !> Find the nodes and their rules.
  subroutine general_custom_boundary_init(self, grid, points, properties, error)
    !> The boundary.
    class(general_custom_boundary_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body; tell of tags without a code.
    class(points_t), intent(inout) :: points
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A grid without tags, or lists that do not fit together.
    type(error_t), allocatable, intent(out) :: error
    integer, allocatable :: codes(:)
    real(wp), allocatable :: vectors(:, :)
    logical :: with_axis

    select type (grid)
    class is (mesh_grid_t)
      if (allocated(grid%tags)) then
        call read_rules(grid, properties, codes, vectors, with_axis, error)
        if (allocated(error)) return
        call find_nodes(self, grid, codes, vectors, with_axis)
        call tell_free_tags(grid, size(codes), points)
        return
      end if
    class default
    end select
    call properties%reject('n', 'GeneralCustomBoundary needs a mesh with tags', error, &
                           'use TriangularGridLinear or TetrahedralGridLinear, or a box such as &
                           &CartesianBoxCustom')
  end subroutine general_custom_boundary_init

  !> Read and check the lists.
  subroutine read_rules(grid, properties, codes, vectors, with_axis, error)
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Code of each tag, from 0. (n)
    integer, allocatable, intent(out) :: codes(:)
    !> Vector of each tag; normals have length 1. (dim, n)
    real(wp), allocatable, intent(out) :: vectors(:, :)
    !> Whether nodes on the y axis stay there.
    logical, intent(out) :: with_axis
    !> Lists that do not fit together.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    real(wp), allocatable :: given(:)
    integer :: i, n

    with_axis = .false.
    codes = properties%integers('codes')
    given = properties%reals('vectors')
    n = properties%integer('n')
    associate (dim => grid%kin%dim)
      allocate (vectors(dim, size(codes)), source=0.0_wp)
      if (n /= size(codes)) then
        call properties%reject('n', to_text(n)//' codes are announced, but there are '// &
                               to_text(size(codes)), error, 'the first integer is the number of &
                               &those that follow')
        return
      end if
      if (size(given) /= dim*n .and. (size(given) > 0 .or. any(codes /= code_free))) then
        call properties%reject('vectors', to_text(n)//' codes need '//to_text(dim*n)// &
                               ' numbers, but there are '//to_text(size(given)), error, &
                               'give '//to_text(dim)//' for each code, zeros where it needs none')
        return
      end if
      if (size(given) > 0) vectors = reshape(given, [dim, n])
    end associate
    do i = 1, n
      if (codes(i) < code_free .or. codes(i) > code_slip) then
        call properties%reject('codes', 'there is no code '//to_text(codes(i)), error, &
                               'use -1 (free), 0 (given velocity) or 1 (free slip)')
        return
      end if
      if (codes(i) /= code_slip) cycle
      if (.not. norm2(vectors(:, i)) > 0.0_wp) then
        call properties%reject('vectors', 'the normal of tag '//to_text(i - 1)//' is 0', error, &
                               'code 1 needs the normal of the side')
        return
      end if
      vectors(:, i) = vectors(:, i)/norm2(vectors(:, i))
    end do
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      with_axis = flags(i)%text == 'USE_Y_AXIS_ROTATION'
      if (with_axis .and. grid%kin%sim_type == type_3d) cycle
      if (with_axis) then
        call properties%reject('flags', 'USE_Y_AXIS_ROTATION is for TYPE 3', error, 'remove it')
      else
        call properties%reject('flags', 'there is no flag "'//excerpt(flags(i)%text)//'"', error, &
                               'the only flag is USE_Y_AXIS_ROTATION')
      end if
      return
    end do
  end subroutine read_rules

  !> List the nodes that are held.
  subroutine find_nodes(self, grid, codes, vectors, with_axis)
    !> The boundary.
    class(general_custom_boundary_t), intent(inout) :: self
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    !> Code of each tag, from 0. (n)
    integer, intent(in) :: codes(:)
    !> Vector of each tag. (dim, n)
    real(wp), intent(in) :: vectors(:, :)
    !> Whether nodes on the y axis stay there.
    logical, intent(in) :: with_axis
    integer :: pass, n, i

    do pass = 1, 2
      n = 0
      do i = 1, grid%mesh%n_nodes
        if (.not. is_held(grid, codes, with_axis, i)) cycle
        n = n + 1
        if (pass == 2) call self%hold_node(grid, codes, vectors, with_axis, i, n)
      end do
      if (pass == 2) exit
      associate (nvel => grid%kin%nvel)
        allocate (self%node(n), self%tag(n), self%is_given(n))
        allocate (self%velocity(nvel, n), self%normal(nvel, 3, n), source=0.0_wp)
      end associate
    end do
  end subroutine find_nodes

  !> Whether a node has a rule.
  pure function is_held(grid, codes, with_axis, node)
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    !> Code of each tag, from 0. (n)
    integer, intent(in) :: codes(:)
    !> Whether nodes on the y axis stay there.
    logical, intent(in) :: with_axis
    !> The node, from 1.
    integer, intent(in) :: node
    !> Whether it has.
    logical :: is_held
    integer :: k

    is_held = on_axis(grid, with_axis, node)
    do k = 1, most_tags
      associate (tag => grid%tags(k, node))
        if (tag < 0 .or. tag >= size(codes)) cycle
        is_held = is_held .or. codes(tag + 1) /= code_free
      end associate
    end do
  end function is_held

  !> Whether a node is on the axis: r = 0 in TYPE 4, or the y axis.
  pure function on_axis(grid, with_axis, node)
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    !> Whether nodes on the y axis stay there.
    logical, intent(in) :: with_axis
    !> The node, from 1.
    integer, intent(in) :: node
    !> Whether it is, up to a millionth of the least height of a cell.
    logical :: on_axis

    on_axis = .false.
    associate (x => grid%mesh%x(:, node), near => 1.0e-6_wp*grid%mesh%h)
      if (grid%kin%sim_type == type_axisymmetric) on_axis = abs(x(1)) <= near
      if (with_axis) on_axis = abs(x(1)) <= near .and. abs(x(3)) <= near
    end associate
  end function on_axis

  !> Set the rule of a node.
  subroutine hold_node(self, grid, codes, vectors, with_axis, node, n)
    !> The boundary.
    class(general_custom_boundary_t), intent(inout) :: self
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    !> Code of each tag, from 0. (n)
    integer, intent(in) :: codes(:)
    !> Vector of each tag. (dim, n)
    real(wp), intent(in) :: vectors(:, :)
    !> Whether nodes on the y axis stay there.
    logical, intent(in) :: with_axis
    !> The node, from 1.
    integer, intent(in) :: node
    !> Its position among those that are held.
    integer, intent(in) :: n
    real(wp) :: direction(grid%kin%nvel)
    integer :: k, known

    self%node(n) = node - 1
    self%is_given(n) = .false.
    known = 0
    do k = 1, most_tags
      associate (tag => grid%tags(k, node), dim => grid%kin%dim)
        if (tag < 0 .or. tag >= size(codes)) cycle
        if (codes(tag + 1) == code_free) cycle
        if (codes(tag + 1) == code_velocity) then
          self%is_given(n) = .true.
          self%velocity(:dim, n) = vectors(:, tag + 1)
        else
          direction = 0.0_wp
          direction(:dim) = vectors(:, tag + 1)
          call add_normal(direction, self%normal(:, :, n), known)
        end if
        self%tag(n) = tag
      end associate
    end do
    if (.not. on_axis(grid, with_axis, node)) return
    self%tag(n) = axis_tag
    do k = 1, 3, 2
      direction = 0.0_wp
      direction(k) = 1.0_wp
      call add_normal(direction, self%normal(:, :, n), known)
    end do
  end subroutine hold_node

  !> Add a direction to a set of unit vectors across each other.
  pure subroutine add_normal(direction, normal, known)
    !> Unit vector.
    real(wp), intent(in) :: direction(:)
    !> The set.
    real(wp), intent(inout) :: normal(:, :)
    !> Number of vectors in it.
    integer, intent(inout) :: known
    !> Two sides are one plane when their normals differ by less.
    real(wp), parameter :: parallel = 1.0e-6_wp
    real(wp) :: rest(size(direction))
    integer :: k

    rest = direction
    do k = 1, known
      rest = rest - normal(:, k)*dot_product(normal(:, k), rest)
    end do
    if (norm2(rest) <= parallel) return
    known = known + 1
    normal(:, known) = rest/norm2(rest)
  end subroutine add_normal

  !> Let the points of the body tell of tags that have no code.
  subroutine tell_free_tags(grid, n, points)
    !> The grid.
    class(mesh_grid_t), intent(in) :: grid
    !> Number of codes.
    integer, intent(in) :: n
    !> The points.
    class(points_t), intent(inout) :: points
    character(:), allocatable :: text
    integer :: tag, next

    text = ''
    tag = n - 1
    do
      next = minval(grid%tags, mask=grid%tags > tag)
      if (.not. any(grid%tags > tag)) exit
      tag = next
      if (len(text) > 0) text = text//', '
      if (len(text) > 60) then
        text = text//'...'
        exit
      end if
      text = text//to_text(tag)
    end do
    if (len(text) == 0 .or. allocated(points%remark)) return
    points%remark = 'GeneralCustomBoundary has no code for these tags of the mesh, whose sides are &
                    &free: '//text
  end subroutine tell_free_tags

  !> Give the nodes the forces that hold them.
  subroutine general_custom_boundary_apply(self, grid, points, nodes, dt)
    !> The boundary.
    class(general_custom_boundary_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(in) :: points
    !> Nodes of the body: momentum at the start of the step, all forces.
    class(nodes_t), intent(inout) :: nodes
    !> Time step. [s]
    real(wp), intent(in) :: dt
    integer :: i, k, n

    associate (unused => grid, unused_points => points)
    end associate
    do i = 1, size(self%node)
      if (.not. nodes%window%holds([self%node(i), 0, 0])) cycle
      n = nodes%window%index([self%node(i), 0, 0])
      if (.not. nodes%mass(n) > 0.0_wp) cycle
      if (self%is_given(i)) then
        nodes%force(:, n) = (nodes%mass(n)*self%velocity(:, i) - nodes%momentum(:, n))/dt
        nodes%increment(:, n) = 0.0_wp
        cycle
      end if
      do k = 1, size(self%normal, 2)
        associate (normal => self%normal(:, k, i))
          nodes%force(:, n) = nodes%force(:, n) - normal*dot_product( &
                              normal, nodes%momentum(:, n)/dt + nodes%force(:, n))
          nodes%increment(:, n) = nodes%increment(:, n) &
                                  - normal*dot_product(normal, nodes%increment(:, n))
        end associate
      end do
    end do
  end subroutine general_custom_boundary_apply

  !> Give the nodes the velocities that the walls prescribe.
  subroutine general_custom_boundary_prescribe(self, window, still, velocity)
    !> The boundary.
    class(general_custom_boundary_t), intent(in) :: self
    !> Nodes that have memory.
    type(window_t), intent(in) :: window
    !> Take 0 for the velocity of walls that move.
    logical, intent(in) :: still
    !> Nodal velocities. [m/s] (nvel, nn)
    real(wp), intent(inout) :: velocity(:, :)
    integer :: i, k, n

    do i = 1, size(self%node)
      if (.not. window%holds([self%node(i), 0, 0])) cycle
      n = window%index([self%node(i), 0, 0])
      if (self%is_given(i)) then
        velocity(:, n) = 0.0_wp
        if (.not. still) velocity(:, n) = self%velocity(:, i)
        cycle
      end if
      do k = 1, size(self%normal, 2)
        velocity(:, n) = velocity(:, n) - self%normal(:, k, i) &
                         *dot_product(self%normal(:, k, i), velocity(:, n))
      end do
    end do
  end subroutine general_custom_boundary_prescribe

  !> Send the tags of the nodes that are held.
  subroutine general_custom_boundary_write_fields(self, grid, nodes, writer)
    !> The boundary.
    class(general_custom_boundary_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Nodes of the body.
    class(nodes_t), intent(in) :: nodes
    !> Receiver of nodal fields.
    class(field_writer_t), intent(inout) :: writer
    real(wp), allocatable :: tag(:)
    type(window_t) :: whole

    associate (unused => nodes)
    end associate
    whole = grid%whole()
    allocate (tag(whole%size()), source=-1.0_wp)
    tag(self%node + 1) = real(self%tag, wp)
    call writer%scalar('bc_tags', tag, whole)
  end subroutine general_custom_boundary_write_fields

end module mpm_general_custom_boundary
