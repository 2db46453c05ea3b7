!> Which components exist in each simulation TYPE, and in which order they are stored.
!!
!! | TYPE | motion | dim | nvel | stress | velocity gradient |
!! |---|---|---|---|---|---|
!! | 1 | uniaxial strain | 1 | 1 | xx yy zz | xx |
!! | 2 | plane strain | 2 | 2 | xx yy zz xy | xx xy yx yy |
!! | 3 | three-dimensional | 3 | 3 | xx yy zz xy yz zx | xx xy xz yx yy yz zx zy zz |
!! | 4 | axisymmetric with twist | 2 | 3 | rr zz tt rz zt tr | rr rz zr zz tr tz rt tt |
!! | 5 | plane with out-of-plane motion | 2 | 3 | xx yy zz xy yz zx | xx xy yx yy zx zy |
!!
!! Nothing is stored or computed for a component that the TYPE does not have.
module mpm_kinematics
  use mpm_kinds, only: wp
  implicit none
  private
  public :: axis_name, expand_gradient, expand_stress, kinematics_t, make_kinematics
  public :: type_1d, type_3d, type_axisymmetric, type_out_of_plane, type_plane_strain

  !> Uniaxial strain.
  integer, parameter :: type_1d = 1
  !> Plane strain.
  integer, parameter :: type_plane_strain = 2
  !> Three-dimensional.
  integer, parameter :: type_3d = 3
  !> Axisymmetric with twist; components r, z, theta.
  integer, parameter :: type_axisymmetric = 4
  !> Two-dimensional grid with out-of-plane motion.
  integer, parameter :: type_out_of_plane = 5

  !> Component counts of one simulation TYPE.
  type :: kinematics_t
    !> Simulation TYPE, 1 to 5.
    integer :: sim_type = type_3d
    !> Dimensions of the grid and components of a position.
    integer :: dim = 3
    !> Components of velocity, displacement, force.
    integer :: nvel = 3
    !> Stored components of the stress.
    integer :: nstress = 6
    !> Stored components of the velocity gradient.
    integer :: ngrad = 9
  end type kinematics_t

contains

  !> Component counts of a simulation TYPE.
  pure function make_kinematics(sim_type) result(kin)
    !> 1 to 5.
    integer, intent(in) :: sim_type
    !> Its component counts.
    type(kinematics_t) :: kin
    integer, parameter :: dims(5) = [1, 2, 3, 2, 2]
    integer, parameter :: nvels(5) = [1, 2, 3, 3, 3]
    integer, parameter :: nstresses(5) = [3, 4, 6, 6, 6]
    integer, parameter :: ngrads(5) = [1, 4, 9, 8, 6]

    kin%sim_type = sim_type
    kin%dim = dims(sim_type)
    kin%nvel = nvels(sim_type)
    kin%nstress = nstresses(sim_type)
    kin%ngrad = ngrads(sim_type)
  end function make_kinematics

  !> Name of a component of vectors.
  pure function axis_name(kin, component) result(name)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Component, from 1.
    integer, intent(in) :: component
    !> `x`, `y`, `z`; in TYPE 4 `r`, `z`, `theta`.
    character(:), allocatable :: name
    character(*), parameter :: plain(3) = ['x', 'y', 'z']
    character(*), parameter :: round(3) = [character(5) :: 'r', 'z', 'theta']

    name = plain(component)
    if (kin%sim_type == type_axisymmetric) name = trim(round(component))
  end function axis_name

  !> Full tensor of stored stress components.
  pure function expand_stress(stress) result(tensor)
    !> Stored components in the order xx yy zz xy yz zx, the last ones left out. (nstress)
    real(wp), intent(in) :: stress(:)
    !> Symmetric tensor.
    real(wp) :: tensor(3, 3)
    real(wp) :: s(6)

    s = 0.0_wp
    s(:size(stress)) = stress
    tensor = reshape([s(1), s(4), s(6), s(4), s(2), s(5), s(6), s(5), s(3)], [3, 3])
  end function expand_stress

  !> Full tensor of stored velocity gradient components.
  pure function expand_gradient(kin, gradient) result(tensor)
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Stored components in the order of the table above. (ngrad)
    real(wp), intent(in) :: gradient(:)
    !> L_ab = d v_a / d x_b.
    real(wp) :: tensor(3, 3)
    integer :: a

    tensor = 0.0_wp
    do a = 1, kin%nvel
      tensor(a, :kin%dim) = gradient((a - 1)*kin%dim + 1:a*kin%dim)
    end do
    if (kin%sim_type == type_axisymmetric) then
      tensor(1, 3) = gradient(7)
      tensor(3, 3) = gradient(8)
    end if
  end function expand_gradient

end module mpm_kinematics
