!> Momentum and energy of the bodies of a model.
module mpm_energy
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  implicit none
  private
  public :: energy_t, measure

  !> Sums over all active bodies.
  type :: energy_t
    !> Momentum; component by component as the TYPE has them. [kg m/s]
    real(wp) :: momentum(3) = 0.0_wp
    !> Sum of m |v|, the scale of momenta. [kg m/s]
    real(wp) :: momentum_scale = 0.0_wp
    !> Kinetic energy. [J]
    real(wp) :: kinetic = 0.0_wp
    !> Recoverable energy of the materials. [J]
    real(wp) :: strain = 0.0_wp
    !> Potential energy in the body force, 0 where the motion starts. [J]
    real(wp) :: potential = 0.0_wp
  contains
    !> Sum of the three energies.
    procedure :: total => energy_total
  end type energy_t

contains

  !> Momentum and energy of a model; points that left the grid do not count.
  pure subroutine measure(model, energy)
    !> The model.
    type(model_t), intent(in) :: model
    !> Its momentum and energy.
    type(energy_t), intent(out) :: energy
    integer :: i, p, n, nvel

    nvel = model%kin%nvel
    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        if (.not. body%active) cycle
        n = body%points%n_inside
        do p = 1, n
          associate (m => body%points%mass(p), v => body%points%velocity(:, p))
            energy%momentum(:nvel) = energy%momentum(:nvel) + m*v
            energy%momentum_scale = energy%momentum_scale + m*norm2(v)
            energy%kinetic = energy%kinetic + 0.5_wp*m*dot_product(v, v)
            energy%potential = energy%potential - m*dot_product(body%points%body_force(:nvel), &
                                                                body%points%displacement(:, p))
          end associate
        end do
        if (.not. allocated(body%material)) cycle
        energy%strain = energy%strain + &
                        body%material%strain_energy(n, body%points%mass(:n), &
                                                    body%points%volume(:n), &
                                                    body%points%stress(:, :n), &
                                                    body%points%history(:, :n))
      end associate
    end do
  end subroutine measure

  !> Sum of kinetic, strain and potential energy.
  pure function energy_total(self) result(total)
    !> The energies.
    class(energy_t), intent(in) :: self
    !> Their sum. [J]
    real(wp) :: total

    total = self%kinetic + self%strain + self%potential
  end function energy_total

end module mpm_energy
