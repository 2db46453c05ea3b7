!> The grains of a mixture whose loose packings rest under pressure.
module mpm_slurry_granular_phase_w_under_compaction
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  use mpm_slurry_granular_phase, only: add_slurry_properties, slurry_granular_phase_t
  implicit none
  private
  public :: slurry_granular_phase_w_under_compaction_t

  !> As `slurry_granular_phase_t`, with pressure at rest from the loosest packing phi_c on.
  type, extends(slurry_granular_phase_t) :: slurry_granular_phase_w_under_compaction_t
  contains
    procedure, nopass :: describe => with_under_compaction_describe
    procedure :: init => with_under_compaction_init
  end type slurry_granular_phase_w_under_compaction_t

contains

  !> Purpose and properties of the class.
  subroutine with_under_compaction_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('material', 'SlurryGranularPhase_wUnderCompaction', &
                          'As SlurryGranularPhase; packings looser than critical may rest under &
                          &pressure, contract when sheared and can liquefy.', &
                          'Baumgarten and Kamrin, J. Fluid Mech. 861 (2019) 721-764', &
                          '    material-class = "SlurryGranularPhase_wUnderCompaction"'//nl// &
                          '    material-props = {E = 1e6, nu = 0.3, mu_1 = 0.3819, mu_2 = 0.6435, &
                          &a = 1.23,'//nl// &
                          '                      b = 0.3085, K_3 = 0.5, K_4 = 0, phi_m = 0.585, &
                          &rho_s = 2700,'//nl// &
                          '                      eta_0 = 1e-3, d = 1e-3, rho_f = 1000, &
                          &phi_c = 0.55}')
    call add_slurry_properties(description)
    call description%add_real('phi_c', '-', 'loosest packing fraction at rest, at most phi_m', &
                              above=0.0_wp, upper=1.0_wp)
    call description%add_note('Static liquefaction, mu_1 < K_3 (phi_m - phi), keeps the pressure; &
                              &mpm_3d deletes it. The plastic step can then have three solutions; &
                              &its search starts from the rate and pressure of the last step.')
  end subroutine with_under_compaction_describe

  !> Set the constants from the properties.
  subroutine with_under_compaction_init(self, kin, properties, error)
    !> The material.
    class(slurry_granular_phase_w_under_compaction_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> As of the other grains, or phi_c above phi_m.
    type(error_t), allocatable, intent(out) :: error

    call self%slurry_granular_phase_t%init(kin, properties, error)
    if (allocated(error)) return
    self%law%gate = properties%real('phi_c')
    if (self%law%gate <= self%law%critical) return
    call properties%reject('phi_c', 'phi_c is above phi_m', error, 'the loosest packing at rest is &
                           &looser than the critical one')
  end subroutine with_under_compaction_init

end module mpm_slurry_granular_phase_w_under_compaction
