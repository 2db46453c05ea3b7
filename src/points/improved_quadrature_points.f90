!> Points with a choice of quadratures, whose positions can be corrected.
module mpm_improved_quadrature_points
  use mpm_default_points, only: default_points_t
  use mpm_description, only: description_t
  use mpm_document, only: value_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_properties, only: properties_t
  use mpm_quadrature_settings, only: add_quadrature_properties, no_correction, &
                                     quadrature_settings_t
  implicit none
  private
  public :: improved_quadrature_points_t

  !> Points from a table, with the settings of their quadrature and of their corrections.
  type, extends(default_points_t) :: improved_quadrature_points_t
    !> The rules.
    type(quadrature_settings_t) :: settings
  contains
    procedure, nopass :: describe => improved_quadrature_points_describe
    procedure :: init => improved_quadrature_points_init
    procedure :: averages => improved_quadrature_points_averages
  end type improved_quadrature_points_t

contains

  !> Purpose and properties of the class.
  subroutine improved_quadrature_points_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('points', 'ImprovedQuadraturePoints', &
                          'Points as those of DefaultPoints, with a choice of quadratures (uGIMP, &
                          &cpGIMP, CPDI, CPDI2) and of corrections of their positions.', &
                          'Baumgarten and Kamrin, IJNME 124 (2023) 2449-2497', &
                          '    point-class = "ImprovedQuadraturePoints"'//nl// &
                          '    point-file = "block.points"'//nl// &
                          '    point-int-props = {0}')
    call add_quadrature_properties(description)
    call description%add_note('The table is that of DefaultPoints. The solver''s flag cpdi has no &
                              &effect on these points.')
  end subroutine improved_quadrature_points_describe

  !> Read the points.
  subroutine improved_quadrature_points_init(self, grid, properties, point_file, config_file, error)
    !> The points.
    class(improved_quadrature_points_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The table.
    type(value_t), intent(in) :: point_file
    !> The config, beside which a relative path is looked for.
    character(*), intent(in) :: config_file
    !> A missing or bad table, or entries that do not fit together.
    type(error_t), allocatable, intent(out) :: error

    call self%settings%read(properties, error)
    if (allocated(error)) return
    if (self%settings%quadrature > 0) then
      call properties%reject('quadrature', 'quadrature 1 to 4 are not connected yet', error, &
                             'use quadrature 0')
    else if (self%settings%rule /= no_correction) then
      call properties%reject('position', 'position rules 1 to 5 are not connected yet', error, &
                             'use position 0')
    end if
    if (allocated(error)) return
    call self%default_points_t%init(grid, properties, point_file, config_file, error)
  end subroutine improved_quadrature_points_init

  !> The quadrature rule decides, not the solver.
  pure function improved_quadrature_points_averages(self, cpdi) result(averages)
    !> The points.
    class(improved_quadrature_points_t), intent(in) :: self
    !> What the solver asks for.
    logical, intent(in) :: cpdi
    !> Whether the functions are averaged over the corners of the points' boxes.
    logical :: averages

    associate (unused => cpdi)
    end associate
    averages = self%settings%quadrature == 1
  end function improved_quadrature_points_averages

end module mpm_improved_quadrature_points
