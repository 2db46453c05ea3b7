!> The role `probe`: what is told of one place in the rows of a history.
module mpm_probe
  use mpm_body, only: body_slot_t
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_model, only: model_t
  use mpm_properties, only: properties_t
  use mpm_strings, only: string_t
  implicit none
  private
  public :: hat, hat_area, probe_slot_t, probe_t

  !> A probe.
  type, abstract, extends(configurable_t) :: probe_t
    !> Unique name, the start of its columns.
    character(:), allocatable :: name
  contains
    !> Find the bodies and the place.
    procedure(init_i), deferred :: init
    !> Names of its columns.
    procedure(columns_i), deferred :: columns
    !> Values of its columns.
    procedure(sample_i), deferred :: sample
  end type probe_t

  !> A probe in a list of probes.
  type :: probe_slot_t
    !> The probe.
    class(probe_t), allocatable :: probe
  end type probe_slot_t

  abstract interface
    !> Find the bodies and the place.
    subroutine init_i(self, grid, bodies, properties, error)
      import :: body_slot_t, error_t, grid_t, probe_t, properties_t
      implicit none
      !> The probe.
      class(probe_t), intent(inout) :: self
      !> The grid.
      class(grid_t), intent(in) :: grid
      !> All bodies of the job, at their start.
      type(body_slot_t), intent(in) :: bodies(:)
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> No such body or place.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Names of the columns, without that of the probe.
    subroutine columns_i(self, kin, names)
      import :: kinematics_t, probe_t, string_t
      implicit none
      !> The probe.
      class(probe_t), intent(in) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> The names.
      type(string_t), allocatable, intent(out) :: names(:)
    end subroutine columns_i

    !> Values of the columns.
    subroutine sample_i(self, model, values)
      import :: model_t, probe_t, wp
      implicit none
      !> The probe.
      class(probe_t), intent(in) :: self
      !> The state.
      type(model_t), intent(in) :: model
      !> One for each column; NaN where there is nothing to measure.
      real(wp), intent(out) :: values(:)
    end subroutine sample_i
  end interface

contains

  !> The hat function: 1 at 0, 0 from -1 and 1 on.
  elemental function hat(s) result(weight)
    !> Distance in cells.
    real(wp), intent(in) :: s
    !> Weight.
    real(wp) :: weight

    weight = max(0.0_wp, 1.0_wp - abs(s))
  end function hat

  !> Area below the hat function to the left of a place.
  elemental function hat_area(s) result(area)
    !> Distance from the middle in cells.
    real(wp), intent(in) :: s
    !> From 0 to 1.
    real(wp) :: area

    area = 0.5_wp*(1.0_wp + min(s, 0.0_wp))**2
    if (s > 0.0_wp) area = 1.0_wp - 0.5_wp*(1.0_wp - min(s, 1.0_wp))**2
    if (s < -1.0_wp) area = 0.0_wp
  end function hat_area

end module mpm_probe
