!> A cone below a peak: a pile of sand at its angle of repose.
module mpm_sand_pile
  use mpm_description, only: description_t, types_with_dim
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_part, only: part_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: sand_pile_t

  !> Directions in the names of properties.
  character(1), parameter :: axes(3) = ['x', 'y', 'z']

  !> The positions that lie below the peak by more than mu times their distance from its axis.
  type, extends(part_t) :: sand_pile_t
    !> Peak, unused components 0. [m]
    real(wp) :: peak(3) = 0.0_wp
    !> Slope of the sides.
    real(wp) :: mu = 0.0_wp
    !> Direction of the height.
    integer :: up = 3
  contains
    procedure, nopass :: describe => sand_pile_describe
    procedure :: init => sand_pile_init
    procedure :: contains => sand_pile_contains
    procedure :: bounds => sand_pile_bounds
  end type sand_pile_t

contains

  !> Purpose and properties of the class.
  subroutine sand_pile_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')
    integer :: d

    call description%init('part', 'SandPile', &
                          'A pile below a peak: h - peak_h < -mu s, with h the last direction of &
                          &the grid and s the distance from the peak in the other directions.', &
                          'The generator texts of mpm_3d v3', &
                          'part'//nl//'{'//nl//'    class = "SandPile"'//nl// &
                          '    properties = {0.5, 0.4, 0.6}   # peak_x, peak_y, mu'//nl//'}')
    do d = 1, 3
      call description%add_real('peak_'//axes(d), 'm', 'peak along '//axes(d), &
                                types=types_with_dim(d))
    end do
    call description%add_real('mu', '-', 'slope of the sides, the tangent of the angle of repose', &
                              lower=0.0_wp)
    call description%add_note('The surface itself does not belong to the pile. TYPE 1 has no &
                              &sides: all that lies below the peak belongs to it.')
  end subroutine sand_pile_describe

  !> Set the shape from its properties.
  subroutine sand_pile_init(self, kin, properties, error)
    !> The part.
    class(sand_pile_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Never set: the bounds of the properties suffice.
    type(error_t), allocatable, intent(out) :: error
    integer :: d

    do d = 1, kin%dim
      self%peak(d) = properties%real('peak_'//axes(d))
    end do
    self%mu = properties%real('mu')
    self%up = kin%dim
  end subroutine sand_pile_init

  !> Whether a position is below the sides of the pile.
  pure function sand_pile_contains(self, x) result(inside)
    !> The part.
    class(sand_pile_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is inside.
    logical :: inside
    integer :: up

    up = size(x)
    inside = x(up) - self%peak(up) < -self%mu*norm2(x(:up - 1) - self%peak(:up - 1))
  end function sand_pile_contains

  !> The box above height 0, where lattices begin, and below the peak.
  pure subroutine sand_pile_bounds(self, lower, upper)
    !> The part.
    class(sand_pile_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    real(wp) :: height, half

    height = max(0.0_wp, self%peak(self%up))
    half = huge(1.0_wp)
    if (height/half < self%mu) half = height/self%mu
    ! Halves, whose sums can't overflow.
    lower = 2.0_wp*max(-0.5_wp*huge(1.0_wp), 0.5_wp*self%peak - 0.5_wp*half)
    upper = 2.0_wp*min(0.5_wp*huge(1.0_wp), 0.5_wp*self%peak + 0.5_wp*half)
    lower(self%up) = 0.0_wp
    upper(self%up) = height
  end subroutine sand_pile_bounds

end module mpm_sand_pile
