!> The role `material`: the stress that a motion causes.
module mpm_material
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: material_t

  !> A constitutive law.
  !!
  !! `update_stress` gets whole blocks of points as arrays and never changes the object, so that
  !! threads may share it. A trial update is a call on a copy of the stress.
  type, abstract, extends(configurable_t) :: material_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
  contains
    !> Set the constants.
    procedure(init_i), deferred :: init
    !> Advance the stress of a block of points over one step.
    procedure(update_stress_i), deferred :: update_stress
    !> Largest wave speed in a block of points.
    procedure(wave_speed_i), deferred :: wave_speed
    !> Recoverable energy of a block of points.
    procedure(strain_energy_i), deferred :: strain_energy
  end type material_t

  abstract interface
    !> Set the constants.
    subroutine init_i(self, kin, properties, error)
      import :: error_t, kinematics_t, material_t, properties_t
      implicit none
      !> The material.
      class(material_t), intent(inout) :: self
      !> Component counts.
      type(kinematics_t), intent(in) :: kin
      !> Checked properties.
      type(properties_t), intent(in) :: properties
      !> Constants that do not fit together.
      type(error_t), allocatable, intent(out) :: error
    end subroutine init_i

    !> Advance the stress of a block of points over one step.
    pure subroutine update_stress_i(self, n, dt, gradient, mass, volume, stress, first_bad)
      import :: material_t, wp
      implicit none
      !> The material.
      class(material_t), intent(in) :: self
      !> Number of points.
      integer, intent(in) :: n
      !> Time step. [s]
      real(wp), intent(in) :: dt
      !> Velocity gradients of the step, components as in `kinematics_t`. [1/s] (ngrad, n)
      real(wp), intent(in) :: gradient(self%kin%ngrad, n)
      !> Masses. [kg] (n)
      real(wp), intent(in) :: mass(n)
      !> Volumes at the end of the step. [m3] (n)
      real(wp), intent(in) :: volume(n)
      !> Cauchy stresses, of the start of the step on entry, of its end on exit. [Pa] (nstress, n)
      real(wp), intent(inout) :: stress(self%kin%nstress, n)
      !> First point for which there is no stress; 0 when there is none.
      integer, intent(out) :: first_bad
    end subroutine update_stress_i

    !> Largest wave speed in a block of points.
    pure function wave_speed_i(self, n, mass, volume, stress) result(speed)
      import :: material_t, wp
      implicit none
      !> The material.
      class(material_t), intent(in) :: self
      !> Number of points.
      integer, intent(in) :: n
      !> Masses. [kg] (n)
      real(wp), intent(in) :: mass(n)
      !> Volumes. [m3] (n)
      real(wp), intent(in) :: volume(n)
      !> Cauchy stresses. [Pa] (nstress, n)
      real(wp), intent(in) :: stress(self%kin%nstress, n)
      !> Largest speed of a longitudinal wave. [m/s]
      real(wp) :: speed
    end function wave_speed_i

    !> Recoverable energy of a block of points.
    pure function strain_energy_i(self, n, mass, volume, stress) result(energy)
      import :: material_t, wp
      implicit none
      !> The material.
      class(material_t), intent(in) :: self
      !> Number of points.
      integer, intent(in) :: n
      !> Masses. [kg] (n)
      real(wp), intent(in) :: mass(n)
      !> Volumes. [m3] (n)
      real(wp), intent(in) :: volume(n)
      !> Cauchy stresses. [Pa] (nstress, n)
      real(wp), intent(in) :: stress(self%kin%nstress, n)
      !> Sum over the points. [J]
      real(wp) :: energy
    end function strain_energy_i
  end interface

end module mpm_material
