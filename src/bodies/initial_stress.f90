!> Stresses that bodies have when they start.
module mpm_initial_stress
  use mpm_body, only: body_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_kinds, only: wp
  use mpm_stencil, only: block_size
  use mpm_strings, only: to_text
  implicit none
  private
  public :: assign_pressure, assign_stress

contains

  !> Give each point a pressure, through the material of the body.
  subroutine assign_pressure(body, pressure, error)
    !> The body.
    class(body_t), intent(inout) :: body
    !> Pressures in storage order. [Pa] (n)
    real(wp), intent(in) :: pressure(:)
    !> No material, or one that can't have such a pressure.
    type(error_t), allocatable, intent(out) :: error
    integer :: first, last, bad

    call need_material(body, error)
    if (allocated(error) .or. body%points%is_revived) return
    associate (points => body%points)
      do first = 1, points%n, block_size
        last = min(first + block_size - 1, points%n)
        call body%material%assign_pressure(last - first + 1, pressure(first:last), &
                                           points%mass(first:last), points%volume(first:last), &
                                           points%stress(:, first:last), &
                                           points%history(:, first:last), bad)
        if (bad == 0) cycle
        bad = first + bad - 1
        call raise_refusal(body, bad, 'a pressure of '//to_text(pressure(bad), 6)//' Pa', error)
        return
      end do
    end associate
  end subroutine assign_pressure

  !> Give all points the same stress, through the material of the body.
  subroutine assign_stress(body, stress, error)
    !> The body.
    class(body_t), intent(inout) :: body
    !> Stress, components as those of the points. [Pa] (nstress)
    real(wp), intent(in) :: stress(:)
    !> No material, or one that can't have such a stress.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: target(size(stress), block_size)
    integer :: first, last, bad

    call need_material(body, error)
    if (allocated(error) .or. body%points%is_revived) return
    target = spread(stress, 2, block_size)
    associate (points => body%points)
      do first = 1, points%n, block_size
        last = min(first + block_size - 1, points%n)
        call body%material%assign_stress(last - first + 1, target(:, :last - first + 1), &
                                         points%mass(first:last), points%volume(first:last), &
                                         points%stress(:, first:last), &
                                         points%history(:, first:last), bad)
        if (bad == 0) cycle
        call raise_refusal(body, first + bad - 1, 'this stress', error)
        return
      end do
    end associate
  end subroutine assign_stress

  !> A body without a material has nothing that a stress could be assigned to.
  subroutine need_material(body, error)
    !> The body.
    class(body_t), intent(in) :: body
    !> Set when there is no material.
    type(error_t), allocatable, intent(out) :: error

    if (allocated(body%material)) return
    call raise(error, err_input, 'body "'//body%name//'" needs a material for its initial stress', &
               hint='add material-class, or take the class DefaultBody')
  end subroutine need_material

  !> A point that can't have its stress.
  subroutine raise_refusal(body, slot, what, error)
    !> The body.
    class(body_t), intent(in) :: body
    !> Storage slot of the point.
    integer, intent(in) :: slot
    !> What was asked for.
    character(*), intent(in) :: what
    !> The error.
    type(error_t), allocatable, intent(inout) :: error

    call raise(error, err_input, 'the material of body "'//body%name//'" cannot have '//what// &
               ' at point '//to_text(body%points%id(slot)), &
               hint='see mpm3d --describe of the material for the stresses that it admits')
  end subroutine raise_refusal

end module mpm_initial_stress
