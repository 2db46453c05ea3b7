!> A body that starts as its points file says.
module mpm_default_body
  use mpm_body, only: body_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: default_body_t

  !> A body without initial stress.
  type, extends(body_t) :: default_body_t
  contains
    procedure, nopass :: describe => default_body_describe
    procedure :: init => default_body_init
  end type default_body_t

contains

  !> Purpose and properties of the class.
  subroutine default_body_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('body', 'DefaultBody', &
                          'A body that starts as its points file says, free of stress.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'body'//nl//'{'//nl//'    class = "DefaultBody"'//nl// &
                          '    name = "block_0"'//nl//'    point-file = "block_0.points"'//nl// &
                          '    point-class = "DefaultPoints"'//nl// &
                          '    node-class = "DefaultNodes"'//nl// &
                          '    material-class = "IsotropicLinearElasticity"'//nl// &
                          '    material-props = {E = 1e5, nu = 0.3}'//nl// &
                          '    boundary-class = "CartesianBox"'//nl//'}')
    call description%add_note('A body without a material keeps its stress, one without a boundary &
                              &feels no walls.')
  end subroutine default_body_describe

  !> Nothing to add to what the points say.
  subroutine default_body_init(self, grid, properties, error)
    !> The body.
    class(default_body_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties: the class has none.
    type(properties_t), intent(in) :: properties
    !> Never set.
    type(error_t), allocatable, intent(out) :: error

    associate (unused => self, unused_grid => grid, unused_properties => properties)
    end associate
  end subroutine default_body_init

end module mpm_default_body
