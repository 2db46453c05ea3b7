!> A body that starts with the pressure of a fluid at rest.
module mpm_hydrostatic_body
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_initial_stress, only: assign_pressure
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: hydrostatic_body_t

  !> A body under the pressure of its own weight.
  type, extends(body_t) :: hydrostatic_body_t
  contains
    procedure, nopass :: describe => hydrostatic_body_describe
    procedure :: init => hydrostatic_body_init
  end type hydrostatic_body_t

contains

  !> Purpose and properties of the class.
  subroutine hydrostatic_body_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('body', 'HydrostaticBody', &
                          'A body that starts with the pressure p = rho g depth of a fluid at &
                          &rest, given to the points through the material.', &
                          'elementary', &
                          'body'//nl//'{'//nl//'    class = "HydrostaticBody"'//nl// &
                          '    name = "block_0"'//nl// &
                          '    properties = {9.81, 1000}   # g, rho'//nl// &
                          '    point-file = "block_0.points"'//nl// &
                          '    point-class = "DefaultPoints"'//nl// &
                          '    node-class = "DefaultNodes"'//nl// &
                          '    material-class = "IsotropicLinearElasticity"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3}'//nl//'}')
    call description%add_real('surface', 'm', 'distance of the free surface above the highest &
                              &point; half of the distance of the points puts it where the &
                              &material ends', default=0.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_real('load', '-', 'g [m/s2], downwards along the last direction of the &
                              &grid, and the effective density rho [kg/m3]; or the components of &
                              &gravity along the directions of the grid, and rho', &
                              is_list=.true.)
    call description%add_note('The free surface lies at the highest point, half of the distance of &
                              &the points below the end of the material, unless "surface" raises &
                              &it; mpm_3d has no such choice.')
    call description%add_note('TYPE 1: the two numbers are the component of gravity along x and &
                              &rho, so that gravity downwards, which is the -x direction, is &
                              &negative.')
  end subroutine hydrostatic_body_describe

  !> Give all points their pressure.
  subroutine hydrostatic_body_init(self, grid, properties, error)
    !> The body.
    class(hydrostatic_body_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A list of the wrong length, no gravity, or no material that takes a pressure.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: load(:), height(:)
    real(wp) :: gravity(3), g
    integer :: dim, d

    dim = grid%kin%dim
    allocate (load, source=properties%reals('load'))
    gravity = 0.0_wp
    if (size(load) == dim + 1) then
      gravity(:dim) = load(:dim)
    else if (size(load) == 2) then
      gravity(dim) = -load(1)
    else
      call properties%reject('load', to_text(size(load))//' numbers', error, &
                             'give g and rho, or '//to_text(dim)// &
                             ' components of gravity and rho')
      return
    end if
    g = norm2(gravity)
    if (.not. load(size(load)) >= 0.0_wp) then
      call properties%reject('load', 'the density is negative', error, 'give the density last')
      return
    end if
    allocate (height(self%points%n), source=0.0_wp)
    ! g times the height; no gravity, no pressure.
    do d = 1, dim
      height = height - gravity(d)*self%points%x(d, :)
    end do
    height = maxval(height) + g*properties%real('surface') - height
    call assign_pressure(self, load(size(load))*height, error)
  end subroutine hydrostatic_body_init

end module mpm_hydrostatic_body
