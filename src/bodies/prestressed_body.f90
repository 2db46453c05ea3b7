!> A body that starts under a uniform stress.
module mpm_prestressed_body
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_initial_stress, only: assign_stress
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: prestressed_body_t

  !> A body whose points all start with the same stress.
  type, extends(body_t) :: prestressed_body_t
  contains
    procedure, nopass :: describe => prestressed_body_describe
    procedure :: init => prestressed_body_init
  end type prestressed_body_t

contains

  !> Purpose and properties of the class.
  subroutine prestressed_body_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('body', 'PrestressedBody', &
                          'A body that starts under a uniform Cauchy stress.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'body'//nl//'{'//nl//'    class = "PrestressedBody"'//nl// &
                          '    name = "block_0"'//nl// &
                          '    properties = {-100, 0, 0, -100, 0, -100}   # xx xy xz yy yz zz'// &
                          nl//'    point-file = "block_0.points"'//nl// &
                          '    point-class = "DefaultPoints"'//nl// &
                          '    node-class = "DefaultNodes"'//nl// &
                          '    material-class = "IsotropicLinearElasticity"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3}'//nl//'}')
    call description%add_real('xx', 'Pa', 'normal stress along x (TYPE 4: r), tension positive')
    call description%add_real('xy', 'Pa', 'shear stress (TYPE 4: rz); not kept in TYPE 1')
    call description%add_real('xz', 'Pa', 'shear stress (TYPE 4: r theta); not kept in TYPE 1, 2')
    call description%add_real('yy', 'Pa', 'normal stress along y (TYPE 4: z)')
    call description%add_real('yz', 'Pa', 'shear stress (TYPE 4: z theta); not kept in TYPE 1, 2')
    call description%add_real('zz', 'Pa', 'normal stress along z (TYPE 4: theta)')
    call description%add_note('Shear stresses that the TYPE does not have must be 0. Laws whose &
                              &stress follows from density or deformation start with those that &
                              &belong to the stress.')
  end subroutine prestressed_body_describe

  !> Give all points their stress.
  subroutine prestressed_body_init(self, grid, properties, error)
    !> The body.
    class(prestressed_body_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A shear stress that the TYPE does not have, or no fitting material.
    type(error_t), allocatable, intent(out) :: error
    character(2), parameter :: names(6) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']
    real(wp) :: stress(6)
    integer :: i

    do i = 1, 6
      stress(i) = properties%real(names(i))
    end do
    do i = grid%kin%nstress + 1, 6
      if (abs(stress(i)) > 0.0_wp) then
        call properties%reject(names(i), 'this TYPE has no shear stress '//names(i), error, &
                               'give 0, or take a TYPE that has it')
        return
      end if
    end do
    call assign_stress(self, stress(:grid%kin%nstress), error)
  end subroutine prestressed_body_init

end module mpm_prestressed_body
