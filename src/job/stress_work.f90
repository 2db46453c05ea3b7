!> Work of the stresses of a body, step by step.
module mpm_stress_work
  use mpm_body, only: body_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: expand_gradient, expand_stress
  use mpm_points, only: points_t
  implicit none
  private
  public :: recoverable_energy, stress_work_t

  !> The work that stresses have done on a body: the sum over steps and points of
  !! dt (V T + V' T')/2 : L with the state at the start and at the end (') of a step.
  type :: stress_work_t
    !> The sum. [J]
    real(wp) :: done = 0.0_wp
    !> Recoverable energy when the sum began. [J]
    real(wp) :: stored = 0.0_wp
    !> Volume times stress at the start of the step, by position in the points file. [J]
    !! (nstress, n)
    real(wp), allocatable, private :: tension(:, :)
  contains
    !> Ask for velocity gradients, and remember the present stresses.
    procedure :: begin => stress_work_begin
    !> Add a step.
    procedure :: add_step => stress_work_add_step
    !> The part of the work that can't be had back.
    procedure :: dissipated => stress_work_dissipated
    procedure, private :: remember => stress_work_remember
  end type stress_work_t

contains

  !> Ask for the velocity gradients of every step, and remember the present stresses.
  subroutine stress_work_begin(self, points)
    !> The work.
    class(stress_work_t), intent(inout) :: self
    !> Points of the body.
    class(points_t), intent(inout) :: points

    points%needs_gradient = .true.
    if (.not. allocated(points%gradient)) then
      allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
    end if
    if (.not. allocated(self%tension)) then
      allocate (self%tension(points%kin%nstress, points%n), source=0.0_wp)
    end if
    call self%remember(points)
  end subroutine stress_work_begin

  !> Remember the present stresses.
  subroutine stress_work_remember(self, points)
    !> The work.
    class(stress_work_t), intent(inout) :: self
    !> Points of the body.
    class(points_t), intent(in) :: points
    integer :: p

    do p = 1, points%n_inside
      self%tension(:, points%id(p)) = points%volume(p)*points%stress(:, p)
    end do
  end subroutine stress_work_remember

  !> Add a step.
  subroutine stress_work_add_step(self, points, dt)
    !> The work.
    class(stress_work_t), intent(inout) :: self
    !> Points of the body at the end of the step, with the velocity gradients of the step.
    class(points_t), intent(in) :: points
    !> Length of the step. [s]
    real(wp), intent(in) :: dt
    real(wp) :: tension(size(points%stress, 1))
    integer :: p

    do p = 1, points%n_inside
      tension = 0.5_wp*(self%tension(:, points%id(p)) + points%volume(p)*points%stress(:, p))
      self%done = self%done + dt*sum(expand_stress(tension)* &
                                     expand_gradient(points%kin, points%gradient(:, p)))
    end do
    call self%remember(points)
  end subroutine stress_work_add_step

  !> The part of the work that can't be had back.
  pure function stress_work_dissipated(self, strain_energy) result(energy)
    !> The work.
    class(stress_work_t), intent(in) :: self
    !> Recoverable energy of the present. [J]
    real(wp), intent(in) :: strain_energy
    !> Work less the change of the recoverable energy. [J]
    real(wp) :: energy

    energy = self%done - (strain_energy - self%stored)
  end function stress_work_dissipated

  !> Recoverable energy of the points inside the grid; 0 without a material.
  pure function recoverable_energy(body) result(energy)
    !> The body.
    class(body_t), intent(in) :: body
    !> The energy. [J]
    real(wp) :: energy

    energy = 0.0_wp
    if (.not. allocated(body%material)) return
    associate (points => body%points, n => body%points%n_inside)
      energy = body%material%strain_energy(n, points%mass(:n), points%volume(:n), &
                                           points%stress(:, :n), points%history(:, :n))
    end associate
  end function recoverable_energy

end module mpm_stress_work
