!> Grids of any class by name, and one step of a body on them.
module mpm_grid_fixture
  use mpm_basis_checks_fixture, only: integrals, largest_errors
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t
  use mpm_explicit_usl, only: explicit_usl_t
  use mpm_grid, only: grid_t
  use mpm_grid_registry, only: create_grid
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t, make_kinematics, type_axisymmetric
  use mpm_model, only: model_t
  use mpm_model_fixture, only: lattice_table, make_body
  use mpm_properties, only: make_properties, properties_t
  use mpm_random_fixture, only: random_t
  use mpm_stencil, only: basis_hat, stencil_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: basis_errors, grid_failure, grid_text, make_any_grid, make_any_model, step_errors, &
            volume_errors
  public :: least_periods

  !> Cells of the grids of `grid_text`; enough for a stencil and its images to be told apart.
  integer, parameter :: least_periods(3) = [12, 11, 13]

contains

  !> A grid of a class from the text of its properties.
  subroutine make_any_grid(class_name, sim_type, text, grid, error)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Property lists.
    character(*), intent(in) :: text
    !> The grid.
    class(grid_t), allocatable, intent(out) :: grid
    !> Bad properties.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties

    call create_grid(class_name, grid, error)
    if (allocated(error)) return
    call grid%describe(description)
    call make_properties(description, sim_type, text, properties, error)
    if (.not. allocated(error)) call grid%init(make_kinematics(sim_type), properties, error)
  end subroutine make_any_grid

  !> Message of the error that properties give; empty when there is none.
  function grid_failure(class_name, sim_type, reals, integers) result(message)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Entries of the list of reals.
    character(*), intent(in) :: reals
    !> Entries of the list of integers.
    character(*), intent(in) :: integers
    !> The message.
    character(:), allocatable :: message
    class(grid_t), allocatable :: grid
    type(error_t), allocatable :: error

    call make_any_grid(class_name, sim_type, lists(reals, integers), grid, error)
    message = ''
    if (.not. allocated(error)) return
    message = error%message
    if (error%code /= err_input) message = 'wrong code: '//message
  end function grid_failure

  !> Text of two lists.
  pure function lists(reals, integers) result(text)
    !> Entries of the list of reals.
    character(*), intent(in) :: reals
    !> Entries of the list of integers.
    character(*), intent(in) :: integers
    !> The text.
    character(:), allocatable :: text

    text = 'properties = {'//reals//'}'//new_line('a')//'int-properties = {'//integers//'}'
  end function lists

  !> Properties of a grid of uneven cells that does not begin at 0.
  function grid_text(class_name, sim_type) result(text)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Property lists.
    character(:), allocatable :: text
    character(:), allocatable :: reals, integers
    character(*), parameter :: lengths(3) = ['2.4', '2.2', '3.9']
    character(*), parameter :: origins(3) = ['0.3 ', '-0.2', '0.1 ']
    character(1), parameter :: axes(3) = ['x', 'y', 'z']
    type(kinematics_t) :: kin
    integer :: d

    kin = make_kinematics(sim_type)
    reals = lengths(1)
    integers = to_text(least_periods(1))
    do d = 2, kin%dim
      reals = reals//', '//lengths(d)
      integers = integers//', '//to_text(least_periods(d))
    end do
    if (index(class_name, 'UGIMP') > 0) reals = reals//', 0.05'
    do d = 1, kin%dim
      if (class_name == 'CartesianCubic_Offset' .and. d == 1) then
        reals = reals//', r0 = 0.3'
      else
        reals = reals//', '//axes(d)//'0 = '//trim(origins(d))
      end if
    end do
    if (index(class_name, 'Custom') > 0) then
      ! Periodic along x and z; along y in TYPE 4, whose x is a radius.
      do d = 1, kin%dim
        integers = integers//', '//merge('1', '0', (d == 2) .eqv. (sim_type == type_axisymmetric))
      end do
    end if
    text = lists(reals, integers)
  end function grid_text

  !> Largest errors of the functions over all directions and TYPEs; see `largest_errors`.
  subroutine basis_errors(class_name, types, averaged, errors)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> TYPEs to look at.
    integer, intent(in) :: types(:)
    !> Average over the corners of boxes.
    logical, intent(in) :: averaged
    !> The errors; 1 when there is no such grid.
    real(wp), intent(out) :: errors(6)
    class(grid_t), allocatable :: grid
    type(stencil_t) :: stencil
    type(error_t), allocatable :: error
    real(wp) :: found(6), extent
    integer :: i, d, e

    errors = 0.0_wp
    do i = 1, size(types)
      call make_any_grid(class_name, types(i), grid_text(class_name, types(i)), grid, error)
      if (allocated(error)) then
        errors = 1.0_wp
        return
      end if
      do e = 1, merge(3, 1, averaged)
        ! The cells are 0.2 m wide and more: one, one and a half, two cells between the faces.
        extent = 0.05_wp*(e + 1)
        call grid%make_stencil(averaged, extent, stencil, error)
        do d = 1, stencil%dim
          call largest_errors(stencil, d, extent, found)
          errors = max(errors, found)
        end do
      end do
    end do
  end subroutine basis_errors

  !> Largest difference of a node volume from the product of the integrals, and of their sum from
  !! the volume of the box, relative to the cell and the box.
  subroutine volume_errors(class_name, sim_type, errors)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> The errors; 1 when there is no such grid.
    real(wp), intent(out) :: errors(2)
    class(grid_t), allocatable :: grid
    type(stencil_t) :: stencil
    type(error_t), allocatable :: error
    real(wp), allocatable :: line(:, :), moment(:)
    real(wp) :: lower(3), upper(3), volume, total, cell
    integer :: d, i, j, k, last(3)

    errors = 1.0_wp
    call make_any_grid(class_name, sim_type, grid_text(class_name, sim_type), grid, error)
    if (.not. allocated(error)) call grid%make_stencil(.false., 1.0_wp, stencil, error)
    if (allocated(error)) return
    allocate (line(0:maxval(stencil%n_cells), 3), source=1.0_wp)
    allocate (moment(0:maxval(stencil%n_cells)))
    do d = 1, stencil%dim
      call integrals(stencil, d, line(:stencil%n_cells(d), d), moment(:stencil%n_cells(d)))
    end do
    call grid%bounds(lower, upper)
    cell = product(stencil%h(:stencil%dim))
    last = merge(stencil%n_cells - 1, stencil%n_cells, stencil%periodic)
    errors = 0.0_wp
    total = 0.0_wp
    do k = 0, last(3)
      do j = 0, last(2)
        do i = 0, last(1)
          volume = grid%node_volume([i, j, k])
          total = total + volume
          errors(1) = max(errors(1), abs(volume/cell - line(i, 1)*line(j, 2)*line(k, 3)))
        end do
      end do
    end do
    volume = product(upper(:stencil%dim) - lower(:stencil%dim))
    errors(2) = abs(total - volume)/volume
  end subroutine volume_errors

  !> A model with a grid of a class, and one body of 4 points a direction with two points a cell
  !! at a lower corner of the box, over the seams of periodic directions.
  subroutine make_any_model(class_name, sim_type, text, young, model, error)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Properties of the grid.
    character(*), intent(in) :: text
    !> Young's modulus. [Pa]
    real(wp), intent(in) :: young
    !> The model.
    type(model_t), intent(out) :: model
    !> Bad properties.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: table(:, :)
    real(wp) :: corner(3), lower(3), upper(3)
    type(random_t) :: random
    integer :: p, nvel, periods(3)

    call make_any_grid(class_name, sim_type, text, model%grid, error)
    if (allocated(error)) return
    model%kin = model%grid%kin
    nvel = model%kin%nvel
    allocate (model%bodies(1), model%contacts(0))
    call model%grid%bounds(lower, upper)
    periods = model%grid%periods()
    corner = lower + merge(-0.17_wp, 0.01_wp, periods > 0)
    call lattice_table(model%kin, corner, 0.1_wp, [4, 4, 4], 1000.0_wp, table)
    do p = 1, size(table, 2)
      call random%fill(-1.0_wp, 1.0_wp, table(3 + nvel:2 + 2*nvel, p))
    end do
    call make_body(model, 1, 'body', table, young, 0.3_wp)
  end subroutine make_any_model

  !> What a step of a strained body without walls changes: the mass on the nodes from that of the
  !! points, momenta by the step, relative; and whether the points felt a force, which they must.
  subroutine step_errors(class_name, types, averaged, errors)
    !> Name of the class.
    character(*), intent(in) :: class_name
    !> TYPEs to look at.
    integer, intent(in) :: types(:)
    !> Average over the corners of boxes.
    logical, intent(in) :: averaged
    !> Mass, momentum; least change of a velocity relative to it. 1, 1, 0 upon failure.
    real(wp), intent(out) :: errors(3)
    type(model_t) :: model
    type(explicit_usl_t) :: solver
    type(error_t), allocatable :: error
    real(wp) :: before(3), after(3), fastest, scale
    real(wp), allocatable :: old(:, :)
    integer :: i, nvel, first, last

    errors = [0.0_wp, 0.0_wp, 1.0_wp]
    solver%averaged = averaged
    do i = 1, size(types)
      call make_any_model(class_name, types(i), grid_text(class_name, types(i)), 1.0e6_wp, model, &
                          error)
      if (.not. allocated(error)) call solver%start(model, error)
      if (.not. allocated(error)) call solver%step(model, 1.0e-4_wp, .false., error)
      if (allocated(error)) then
        errors = [1.0_wp, 1.0_wp, 0.0_wp]
        return
      end if
      ! The first step gave the points a stress, the second one feels it.
      associate (points => model%bodies(1)%body%points, nodes => model%bodies(1)%body%nodes)
        nvel = model%kin%nvel
        before(:nvel) = matmul(points%velocity, points%mass)
        allocate (old, source=points%velocity(:, points%slots()))
        call solver%step(model, 1.0e-4_wp, .false., error)
        if (allocated(error)) then
          errors = [1.0_wp, 1.0_wp, 0.0_wp]
          return
        end if
        after(:nvel) = matmul(points%velocity, points%mass)
        scale = sum(points%mass)
        errors(1) = max(errors(1), abs(sum(nodes%mass(:nodes%window%size())) - scale)/scale)
        ! TYPE 4: hoop stress and the turning basis change all but the axial momentum.
        first = merge(2, 1, types(i) == type_axisymmetric)
        last = merge(2, nvel, types(i) == type_axisymmetric)
        errors(2) = max(errors(2), maxval(abs(after(first:last) - before(first:last)))/scale)
        fastest = maxval(abs(points%velocity(:, points%slots()) - old))
        errors(3) = min(errors(3), fastest)
        deallocate (old)
      end associate
    end do
  end subroutine step_errors

end module mpm_grid_fixture
