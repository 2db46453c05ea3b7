!> The role `material`: the stress that a motion causes.
module mpm_material
  use mpm_configurable, only: configurable_t
  use mpm_errors, only: error_t
  use mpm_field_writer, only: field_writer_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_nodes, only: nodes_t
  use mpm_partner, only: partner_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: material_t

  !> A constitutive law.
  !!
  !! `update_stress` gets whole blocks of points as arrays and never changes the object, so that
  !! threads may share it. What a law remembers of a point besides the stress is a column of
  !! `history`, which the points keep. A trial update is a call on copies of stress and history.
  type, abstract, extends(configurable_t) :: material_t
    !> Component counts of the job.
    type(kinematics_t) :: kin
    !> Numbers that a point remembers besides its stress; set by `init`.
    integer :: n_history = 0
    !> Another body that `observe` looks at.
    type(partner_t) :: partner
  contains
    !> Set the constants.
    procedure(init_i), deferred :: init
    !> Advance the stress of a block of points over one step.
    procedure(update_stress_i), deferred :: update_stress
    !> Largest wave speed in a block of points.
    procedure(wave_speed_i), deferred :: wave_speed
    !> Recoverable energy of a block of points.
    procedure(strain_energy_i), deferred :: strain_energy
    !> The memory of points that have not moved yet.
    procedure :: start => material_start
    !> Give points a stress that they keep at rest.
    procedure :: assign_stress => material_assign_stress
    !> Give points a pressure and leave the deviator.
    procedure :: assign_pressure => material_assign_pressure
    !> TYPE 4: express tensors of the memory in the basis of the moved points.
    procedure :: turn_history => material_turn_history
    !> Ask the points to keep what `correct` needs.
    procedure :: prepare => material_prepare
    !> Correct the positions of the points at the end of a step.
    procedure :: correct => material_correct
    !> Largest diffusivity of momentum in a block of points.
    procedure :: diffusivity => material_diffusivity
    !> Density and friction of grains, of laws that describe some.
    procedure :: grains => material_grains
    !> Take from another body what the memory of the points has of it.
    procedure :: observe => material_observe
    !> Send the fields of the memory when a frame is written.
    procedure :: write_fields => material_write_fields
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
    pure subroutine update_stress_i(self, n, dt, gradient, mass, volume, stress, history, &
                                    first_bad)
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
      !> What the points remember, of the start of the step on entry, of its end on exit.
      !> (n_history, n)
      real(wp), intent(inout) :: history(self%n_history, n)
      !> First point for which there is no stress; 0 when there is none.
      integer, intent(out) :: first_bad
    end subroutine update_stress_i

    !> Largest wave speed in a block of points.
    pure function wave_speed_i(self, n, mass, volume, stress, history) result(speed)
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
      !> What the points remember. (n_history, n)
      real(wp), intent(in) :: history(self%n_history, n)
      !> Largest speed of a longitudinal wave. [m/s]
      real(wp) :: speed
    end function wave_speed_i

    !> Recoverable energy of a block of points.
    pure function strain_energy_i(self, n, mass, volume, stress, history) result(energy)
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
      !> What the points remember. (n_history, n)
      real(wp), intent(in) :: history(self%n_history, n)
      !> Sum over the points. [J]
      real(wp) :: energy
    end function strain_energy_i
  end interface

contains

  !> The memory of points that have not moved yet: 0.
  pure subroutine material_start(self, n, x, mass, volume, history)
    !> The material.
    class(material_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Positions. [m] (dim, n)
    real(wp), intent(in) :: x(self%kin%dim, n)
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> What the points remember. (n_history, n)
    real(wp), intent(out) :: history(self%n_history, n)

    associate (unused => x, unused_mass => mass, unused_volume => volume)
    end associate
    history = 0.0_wp
  end subroutine material_start

  !> Give points a stress that they keep at rest; doing so twice is doing so once.
  !!
  !! A law whose stress follows from density and memory changes these; its points keep the part of
  !! the stress that it admits. The space that the points fill stays.
  pure subroutine material_assign_stress(self, n, target, mass, volume, stress, history, first_bad)
    !> The material.
    class(material_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Stresses that are asked for. [Pa] (nstress, n)
    real(wp), intent(in) :: target(self%kin%nstress, n)
    !> Masses. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> What the points remember. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that can't have its stress; 0 when there is none.
    integer, intent(out) :: first_bad

    associate (unused => mass, unused_volume => volume, unused_history => history)
    end associate
    first_bad = 0
    stress = target
  end subroutine material_assign_stress

  !> Give points a pressure and leave the deviator.
  pure subroutine material_assign_pressure(self, n, pressure, mass, volume, stress, history, &
                                           first_bad)
    !> The material.
    class(material_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Pressures. [Pa] (n)
    real(wp), intent(in) :: pressure(n)
    !> Masses. [kg] (n)
    real(wp), intent(inout) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Cauchy stresses. [Pa] (nstress, n)
    real(wp), intent(inout) :: stress(self%kin%nstress, n)
    !> What the points remember. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)
    !> First point that can't have its pressure; 0 when there is none.
    integer, intent(out) :: first_bad
    real(wp) :: target(self%kin%nstress, n), change
    integer :: p

    do p = 1, n
      change = pressure(p) + (stress(1, p) + stress(2, p) + stress(3, p))/3.0_wp
      target(:, p) = stress(:, p)
      target(1:3, p) = target(1:3, p) - change
    end do
    call self%assign_stress(n, target, mass, volume, stress, history, first_bad)
  end subroutine material_assign_pressure

  !> TYPE 4: numbers that are no tensors stay.
  pure subroutine material_turn_history(self, n, dt, gradient, history)
    !> The material.
    class(material_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Velocity gradients of the step. [1/s] (ngrad, n)
    real(wp), intent(in) :: gradient(self%kin%ngrad, n)
    !> What the points remember. (n_history, n)
    real(wp), intent(inout) :: history(self%n_history, n)

    associate (unused => dt, unused_gradient => gradient, unused_history => history)
    end associate
  end subroutine material_turn_history

  !> Largest diffusivity of momentum in a block of points: 0 without viscosity.
  pure function material_diffusivity(self, n, mass, volume) result(diffusivity)
    !> The material.
    class(material_t), intent(in) :: self
    !> Number of points.
    integer, intent(in) :: n
    !> Masses. [kg] (n)
    real(wp), intent(in) :: mass(n)
    !> Volumes. [m3] (n)
    real(wp), intent(in) :: volume(n)
    !> Factor of the largest second derivative of a velocity. [m2/s]
    real(wp) :: diffusivity

    associate (unused => self, unused_mass => mass, unused_volume => volume)
    end associate
    diffusivity = 0.0_wp
  end function material_diffusivity

  !> Ask the points to keep what `correct` needs, when they are set up: most laws need nothing.
  subroutine material_prepare(self, points)
    !> The material.
    class(material_t), intent(in) :: self
    !> The points.
    class(points_t), intent(inout) :: points

    associate (unused => self, unused_points => points)
    end associate
  end subroutine material_prepare

  !> Correct the positions of the points: most laws leave them where their motion takes them.
  subroutine material_correct(self, grid, points, dt, threads)
    !> The material.
    class(material_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> The points, moved.
    class(points_t), intent(inout) :: points
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    !> Number of threads.
    integer, intent(in) :: threads

    associate (unused => self, unused_grid => grid, unused_points => points, unused_dt => dt, &
               unused_threads => threads)
    end associate
  end subroutine material_correct

  !> Density and friction of grains: most laws describe none.
  pure subroutine material_grains(self, density, friction)
    !> The material.
    class(material_t), intent(in) :: self
    !> Density of the grains themselves; 0 of other materials. [kg/m3]
    real(wp), intent(out) :: density
    !> Largest ratio of shear stress to pressure at rest.
    real(wp), intent(out) :: friction

    associate (unused => self)
    end associate
    density = 0.0_wp
    friction = 0.0_wp
  end subroutine material_grains

  !> Take from another body what the memory of the points has of it: most laws know of none.
  !!
  !! Called in each step, when the nodes of all bodies have the velocities from which strain rates
  !! will be formed, and points have not moved; only for laws that asked for a partner.
  subroutine material_observe(self, grid, points, nodes, remapped, threads, other_points, &
                              other_nodes)
    !> The material.
    class(material_t), intent(in) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body.
    class(points_t), intent(inout) :: points
    !> Their nodes.
    class(nodes_t), intent(in) :: nodes
    !> Strain rates will be formed from the velocities of the second mapping.
    logical, intent(in) :: remapped
    !> Number of threads.
    integer, intent(in) :: threads
    !> Points of the other body; left out while it is not active.
    class(points_t), intent(in), optional :: other_points
    !> Their nodes.
    class(nodes_t), intent(in), optional :: other_nodes

    associate (unused => self, unused_grid => grid, unused_points => points, &
               unused_nodes => nodes, unused_remapped => remapped, unused_threads => threads)
    end associate
    if (present(other_points) .and. present(other_nodes)) return
  end subroutine material_observe

  !> Send the fields of the memory when a frame is written: none.
  subroutine material_write_fields(self, n, mass, volume, stress, history, writer)
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
    !> What the points remember. (n_history, n)
    real(wp), intent(in) :: history(self%n_history, n)
    !> Receiver of point fields.
    class(field_writer_t), intent(inout) :: writer

    associate (unused => writer, unused_mass => mass, unused_volume => volume, &
               unused_stress => stress, unused_history => history)
    end associate
  end subroutine material_write_fields

end module mpm_material
