!> Walls with friction on all faces of the grid.
module mpm_cartesian_frictional_box
  use mpm_box_faces, only: axis_of
  use mpm_box_wall, only: wall_free_slip, wall_friction, wall_periodic
  use mpm_cartesian_box_custom, only: cartesian_box_custom_t
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_grid, only: grid_t
  use mpm_kinds, only: wp
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: cartesian_frictional_box_t

  !> Coulomb friction with one coefficient on all faces.
  type, extends(cartesian_box_custom_t) :: cartesian_frictional_box_t
  contains
    procedure, nopass :: describe => frictional_box_describe
    procedure :: init => frictional_box_init
  end type cartesian_frictional_box_t

contains

  !> Purpose and properties of the class.
  subroutine frictional_box_describe(description)
    !> The description.
    type(description_t), intent(out) :: description

    call description%init('boundary', 'CartesianFrictionalBox', &
                          'Coulomb friction on every face of the grid: the velocity normal to a &
                          &face is 0 on it, and what moves along it is held back.', &
                          'Coulomb friction as in Bardenhagen, Brackbill and Sulsky, CMAME 187 &
                          &(2000) 529-541', &
                          '    boundary-class = "CartesianFrictionalBox"'//new_line('a')// &
                          '    boundary-props = {0.3}   # mu')
    call description%add_real('mu', '-', 'coefficient of friction', lower=0.0_wp)
    call description%add_integer('unilateral', '1: the walls only push, and take the momentum &
                                 &that they stop from the points; 0: as mpm_3d', default=0, &
                                 lower=0, upper=1, by_name=.true.)
    call description%add_note('The same as code 2 of CartesianBoxCustom on all faces.')
    call description%add_note('Friction is at most mu times the force that stops the body''s own &
                              &closing motion, forces of contacts left out, and acts on all motion &
                              &that is left. The walls also hold a body that leaves them, and what &
                              &their nodes stop stays in the points: friction is not mu times the &
                              &impulse on the body. With unilateral = 1 it is, to round-off.')
    call description%add_note('The axis r = 0 of TYPE 4 is no wall: radial velocity and swirl are &
                              &0 there, and nothing rubs (mpm_3d: friction).')
    call description%add_note('Directions in which the grid is periodic have no walls.')
    call description%add_note('The faces are those of the grid, wherever its lower corner is; &
                              &mpm_3d takes coordinate 0 as the lower face. The forces that push a &
                              &body to a wall include hoop stress, which mpm_3d forgets.')
    call description%add_note('The field bc_nodal_mask, which mpm_3d does not have here, is 2 for &
                              &a component that a lower face rules, -2 on upper faces, 1 on the &
                              &axis.')
  end subroutine frictional_box_describe

  !> Put a wall on each face.
  subroutine frictional_box_init(self, grid, points, properties, error)
    !> The boundary.
    class(cartesian_frictional_box_t), intent(inout) :: self
    !> The grid.
    class(grid_t), intent(in) :: grid
    !> Points of the body; left as they are.
    class(points_t), intent(inout) :: points
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The grid is not Cartesian.
    type(error_t), allocatable, intent(out) :: error
    integer :: face

    associate (unused => points)
    end associate
    call self%faces%init(grid, 'CartesianFrictionalBox', error)
    if (allocated(error)) return
    if (allocated(self%walls)) deallocate (self%walls)
    allocate (self%walls(self%faces%n))
    do face = 1, self%faces%n
      associate (wall => self%walls(face))
        wall%code = wall_friction
        if (self%faces%is_axis(face)) wall%code = wall_free_slip
        if (self%faces%periodic(axis_of(face))) wall%code = wall_periodic
        wall%friction = properties%real('mu')
        wall%unilateral = properties%integer('unilateral') == 1
      end associate
    end do
  end subroutine frictional_box_init

end module mpm_cartesian_frictional_box
