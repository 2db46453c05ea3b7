!> Collapse of a column of grains in a fluid, which starts under its own weight.
module mpm_column_collapse_driver
  use mpm_body_list, only: find_body
  use mpm_default_driver, only: default_driver_t
  use mpm_description, only: description_t
  use mpm_driver, only: standard_gravity
  use mpm_errors, only: error_t
  use mpm_initial_stress, only: assign_pressure
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: column_collapse_driver_t

  !> Standard gravity; two bodies start with hydrostatic pressures.
  type, extends(default_driver_t) :: column_collapse_driver_t
    !> The properties, until the bodies exist.
    type(properties_t), private :: properties
  contains
    procedure, nopass :: describe => column_collapse_driver_describe
    procedure :: init => column_collapse_driver_init
    procedure :: prepare => column_collapse_driver_prepare
  end type column_collapse_driver_t

contains

  !> Purpose and properties of the class.
  subroutine column_collapse_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'ColumnCollapseDriver', &
                          'As DefaultDriver; two bodies, grains and pore fluid, start with the &
                          &pressures of rest: rho_liquid g depth in the fluid, phi (rho_grain - &
                          &rho_liquid) g depth in the grains.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764', &
                          'driver'//nl//'{'//nl//'    class = "ColumnCollapseDriver"'//nl// &
                          '    properties = {1.0}   # t_stop'//nl//'}')
    call description%add_real('t_stop', 's', 'stop time')
    call description%add_real('rho_grain', 'kg/m3', 'density of the grains', default=0.0_wp, &
                              lower=0.0_wp)
    call description%add_real('phi', '-', 'packing fraction of the grains', default=0.0_wp, &
                              lower=0.0_wp, upper=1.0_wp)
    call description%add_real('rho_liquid', 'kg/m3', 'density of the fluid', default=0.0_wp, &
                              lower=0.0_wp)
    call description%add_integer('solid_id', 'the grains by their number, from 0, when no names &
                                 &are given', default=-1, lower=0)
    call description%add_integer('fluid_id', 'the fluid by its number', default=-1, lower=0)
    call description%add_string('solid', 'name of the grains', default='')
    call description%add_string('fluid', 'name of the fluid', default='')
    call description%add_note('Without densities no body gets a pressure. Depth counts from the &
                              &highest point of each body. In TYPE 4 and 5 mpm_3d finds no height &
                              &and assigns nothing, and in TYPE 5 it has no gravity.')
  end subroutine column_collapse_driver_describe

  !> Set up from the properties.
  subroutine column_collapse_driver_init(self, properties, error)
    !> The driver.
    class(column_collapse_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Some of the densities are missing.
    type(error_t), allocatable, intent(out) :: error

    call self%default_driver_t%init(properties, error)
    self%properties = properties
    if (properties%given('rho_grain') .eqv. properties%given('rho_liquid')) return
    call properties%reject('rho_grain', 'rho_grain, phi and rho_liquid belong together', error, &
                           'give all three, or t_stop alone')
  end subroutine column_collapse_driver_init

  !> Give grains and fluid their pressures.
  subroutine column_collapse_driver_prepare(self, model, error)
    !> The driver.
    class(column_collapse_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> There are no such bodies, or they can't have a pressure.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: grain, liquid
    integer :: solid, fluid

    if (.not. self%properties%given('rho_liquid')) return
    call find_body(model%bodies, self%properties, 'solid', 'solid_id', solid, error)
    if (allocated(error)) return
    call find_body(model%bodies, self%properties, 'fluid', 'fluid_id', fluid, error)
    if (allocated(error)) return
    grain = self%properties%real('rho_grain')
    liquid = self%properties%real('rho_liquid')
    call load_by_weight(model, fluid, liquid, error)
    if (allocated(error)) return
    call load_by_weight(model, solid, self%properties%real('phi')*(grain - liquid), error)
  end subroutine column_collapse_driver_prepare

  !> Give a body the pressure of a fluid at rest.
  subroutine load_by_weight(model, position, density, error)
    !> The model.
    type(model_t), intent(inout) :: model
    !> Position of the body in the model's list.
    integer, intent(in) :: position
    !> Effective density. [kg/m3]
    real(wp), intent(in) :: density
    !> The body can't have a pressure.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: height(:)

    associate (body => model%bodies(position)%body)
      allocate (height(body%points%n))
      height(:) = body%points%x(model%kin%dim, :)
      call assign_pressure(body, density*norm2(standard_gravity(model%kin))* &
                           (maxval(height) - height), error)
    end associate
  end subroutine load_by_weight

end module mpm_column_collapse_driver
