!> Drag between grains and the fluid in their pores.
module mpm_pore_drag
  use mpm_kinds, only: wp
  implicit none
  private
  public :: pore_drag_t

  !> The law of a drag.
  type :: pore_drag_t
    !> Diameter d of the grains. [m]
    real(wp) :: diameter = 0.0_wp
    !> Viscosity eta of the fluid. [Pa s]
    real(wp) :: viscosity = 0.0_wp
    !> Density of the fluid, for the Reynolds number. [kg/m3]
    real(wp) :: density = 0.0_wp
    !> Carman and Kozeny; otherwise Beetstra et al.
    logical :: carman_kozeny = .false.
  contains
    !> Force per relative velocity.
    procedure :: coefficient => pore_drag_coefficient
    !> Force of the fluid against the grains over a step.
    procedure :: force => pore_drag_force
  end type pore_drag_t

contains

  !> Force per relative velocity.
  !!
  !! Carman-Kozeny: C = 180 V (1 - n)**2 eta/(n d**2). Beetstra: C = 18 V (1 - n) eta n F/d**2 with
  !!
  !!     n F = 10 (1 - n)/n + n**3 (1 + 1.5 sqrt(1 - n))
  !!           + 0.413 Re/(24 n) (1/n + 3 n (1 - n) + 8.4 Re**-0.343)
  !!             /(1 + 10**(3 (1 - n)) Re**-(1/2 + 2 (1 - n))),
  !!
  !! where Re = n |v| rho d/eta; the powers of Re are put so that Re = 0 is no exception.
  pure function pore_drag_coefficient(self, porosity, volume, speed) result(c)
    !> The law.
    class(pore_drag_t), intent(in) :: self
    !> Porosity n.
    real(wp), intent(in) :: porosity
    !> Volume V of the mixture. [m3]
    real(wp), intent(in) :: volume
    !> Size of the relative velocity. [m/s]
    real(wp), intent(in) :: speed
    !> The coefficient. [N s/m]
    real(wp) :: c
    real(wp) :: phi, re, power, fast

    phi = 1.0_wp - porosity
    c = 18.0_wp*volume*phi*self%viscosity/self%diameter**2
    if (self%carman_kozeny) then
      c = c*10.0_wp*phi/porosity
      return
    end if
    re = porosity*speed*self%density*self%diameter/self%viscosity
    fast = 0.0_wp
    if (re > 0.0_wp) then
      power = re**(0.5_wp + 2.0_wp*phi)
      fast = ((1.0_wp/porosity + 3.0_wp*porosity*phi)*re + 8.4_wp*re**0.657_wp)*power &
             /(power + 10.0_wp**(3.0_wp*phi))
    end if
    c = c*(10.0_wp*phi/porosity + porosity**3*(1.0_wp + 1.5_wp*sqrt(phi)) &
           + 0.413_wp/(24.0_wp*porosity)*fast)
  end function pore_drag_coefficient

  !> Force of the fluid against the grains over a step: C times their relative velocity at its end.
  !!
  !! With the relative velocity w of the start and no other force the end has w/(1 + dt C (1/m_s +
  !! 1/m_f)), which has the sign of w for any dt.
  pure function pore_drag_force(self, porosity, volume, dt, grains, fluid, slip) result(force)
    !> The law.
    class(pore_drag_t), intent(in) :: self
    !> Porosity.
    real(wp), intent(in) :: porosity
    !> Volume of the mixture. [m3]
    real(wp), intent(in) :: volume
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> Mass of the grains. [kg]
    real(wp), intent(in) :: grains
    !> Mass of the fluid. [kg]
    real(wp), intent(in) :: fluid
    !> Velocity of the grains less that of the fluid. [m/s]
    real(wp), intent(in) :: slip(:)
    !> Force on the fluid; its opposite acts on the grains. [N]
    real(wp) :: force(size(slip))
    real(wp) :: c

    c = self%coefficient(porosity, volume, norm2(slip))
    ! The smaller mass is the one that may be tiny.
    associate (light => min(grains, fluid), heavy => max(grains, fluid))
      force = c*light/(light + dt*c*(1.0_wp + light/heavy))*slip
    end associate
  end function pore_drag_force

end module mpm_pore_drag
