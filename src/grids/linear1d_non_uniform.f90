!> Hat functions on nodes with uneven distances, in one dimension.
module mpm_linear1d_non_uniform
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_hashed_random, only: random_number_of
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_mesh_grid, only: mesh_grid_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: linear1d_non_uniform_t

  !> Lines between nodes that were moved at random, or given.
  type, extends(mesh_grid_t) :: linear1d_non_uniform_t
  contains
    procedure, nopass :: describe => linear1d_non_uniform_describe
    procedure :: init => linear1d_non_uniform_init
  end type linear1d_non_uniform_t

contains

  !> Purpose and properties of the class.
  subroutine linear1d_non_uniform_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('grid', 'Linear1DNonUniform', &
                          'Linear functions on lines of different lengths; only in TYPE 1.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'grid'//nl//'{'//nl//'    class = "Linear1DNonUniform"'//nl// &
                          '    properties = {1.0}      # L'//nl// &
                          '    int-properties = {20}   # N'//nl//'}')
    call description%add_real('L', 'm', 'length of the grid, from 0 on', above=0.0_wp, &
                              upper=1.0e75_wp)
    call description%add_real('nodes', 'm', 'positions of the N - 1 inner nodes, ascending; when &
                              &left out they are random', is_list=.true.)
    call description%add_integer('N', 'number of cells', lower=1, upper=2**25)
    call description%add_integer('seed', 'which random positions', default=1, by_name=.true.)
    call description%add_note('Random positions: h (i - 1/4 + U/2), h = L/N, with U uniform in 0 &
                              &to 1, a function of the seed and of i (mpm_3d: the C library''s &
                              &numbers, without a seed).')
    call description%add_note('A point on a node belongs to the cell with the lower number &
                              &(mpm_3d: NaN).')
    call description%add_note('The transfers APIC and MLS, ImprovedQuadraturePoints and the &
                              &smoothing of strains need a Cartesian grid.')
  end subroutine linear1d_non_uniform_describe

  !> Build the grid from its properties.
  subroutine linear1d_non_uniform_init(self, kin, properties, error)
    !> The grid.
    class(linear1d_non_uniform_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Another TYPE than 1, or nodes that do not fit.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: x(:, :), given(:)
    integer, allocatable :: cell(:, :), kept(:)
    real(wp) :: length
    integer :: n, i, flat

    self%kin = kin
    if (kin%dim /= 1) then
      call properties%reject('L', 'Linear1DNonUniform is for TYPE 1, not '// &
                             to_text(kin%sim_type), error, 'use another grid, or set TYPE = 1')
      return
    end if
    length = properties%real('L')
    n = properties%integer('N')
    given = properties%reals('nodes')
    allocate (x(1, 0:n), cell(2, n))
    x(1, 0) = 0.0_wp
    x(1, n) = length
    if (size(given) > 0 .and. size(given) /= n - 1) then
      call properties%reject('nodes', to_text(n)//' cells have '//to_text(n - 1)// &
                             ' inner nodes, not '//to_text(size(given)), error, &
                             'give as many, or none')
      return
    end if
    do i = 1, n - 1
      if (size(given) > 0) then
        x(1, i) = given(i)
      else
        x(1, i) = length/real(n, wp)*(real(i, wp) - 0.25_wp + 0.5_wp*random_number_of( &
                                      properties%integer('seed'), int(i, lp), 0_lp, 0_lp))
      end if
    end do
    do i = 1, n
      cell(:, i) = [i, i + 1]
      if (x(1, i) > x(1, i - 1)) cycle
      call properties%reject('nodes', 'the nodes do not ascend from 0 to L: '// &
                             to_text(x(1, i - 1))//' comes before '//to_text(x(1, i)), error, &
                             'give inner nodes between 0 and L, from left to right')
      return
    end do
    call self%mesh%init(1, x, cell, [0.0_wp, 0.0_wp, 0.0_wp], .false., kept, flat)
    if (flat > 0) then
      call properties%reject('nodes', 'a cell has no length', error, 'give nodes farther apart')
    end if
  end subroutine linear1d_non_uniform_init

end module mpm_linear1d_non_uniform
