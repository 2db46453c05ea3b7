!> All that lies below a sine wave.
module mpm_sine_wave
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_kinematics, only: kinematics_t
  use mpm_part, only: part_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: sine_wave_t

  !> Two pi.
  real(wp), parameter :: two_pi = 8.0_wp*atan(1.0_wp)

  !> The positions with y - y0 <= amplitude sin(2 pi (x - x0)/wavelength).
  type, extends(part_t) :: sine_wave_t
    !> Amplitude; negative for a wave that starts downwards. [m]
    real(wp) :: amplitude = 0.0_wp
    !> Wavelength. [m]
    real(wp) :: wavelength = 1.0_wp
    !> Where the wave rises through its mean height, and that height. [m]
    real(wp) :: origin(2) = 0.0_wp
  contains
    procedure, nopass :: describe => sine_wave_describe
    procedure :: init => sine_wave_init
    procedure :: contains => sine_wave_contains
    procedure :: bounds => sine_wave_bounds
  end type sine_wave_t

contains

  !> Purpose and properties of the class.
  subroutine sine_wave_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('part', 'SineWave', &
                          'All that lies below a sine wave: &
                          &y - y0 <= amplitude sin(2 pi (x - x0)/wavelength).', &
                          'The generator texts of mpm_3d v3', &
                          'part'//nl//'{'//nl//'    class = "SineWave"'//nl// &
                          '    # amplitude, wavelength, x0, y0'//nl// &
                          '    properties = {0.05, 1.0, 0.0, 0.5}'//nl//'}')
    call description%add_real('amplitude', 'm', 'height of the crests above the mean')
    call description%add_real('wavelength', 'm', 'distance between crests', above=0.0_wp)
    call description%add_real('x0', 'm', 'where the wave rises through its mean')
    call description%add_real('y0', 'm', 'mean height of the wave')
    call description%add_note('Not in TYPE 1, which has no height. In TYPE 3 the wave is the same &
                              &for every z.')
  end subroutine sine_wave_describe

  !> Set the shape from its properties.
  subroutine sine_wave_init(self, kin, properties, error)
    !> The part.
    class(sine_wave_t), intent(inout) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> TYPE 1.
    type(error_t), allocatable, intent(out) :: error

    if (kin%dim < 2) then
      call properties%reject('amplitude', 'a SineWave does not exist in TYPE 1: it has no height', &
                             error, 'use a Box or a Ball')
      return
    end if
    self%amplitude = properties%real('amplitude')
    self%wavelength = properties%real('wavelength')
    self%origin = [properties%real('x0'), properties%real('y0')]
  end subroutine sine_wave_init

  !> Whether a position is below the wave or on it.
  pure function sine_wave_contains(self, x) result(inside)
    !> The part.
    class(sine_wave_t), intent(in) :: self
    !> Position. [m] (dim)
    real(wp), intent(in) :: x(:)
    !> Whether it is inside.
    logical :: inside

    inside = x(2) - self%origin(2) <= &
             self%amplitude*sin(two_pi*((x(1) - self%origin(1))/self%wavelength))
  end function sine_wave_contains

  !> All that is not above the crests.
  pure subroutine sine_wave_bounds(self, lower, upper)
    !> The part.
    class(sine_wave_t), intent(in) :: self
    !> Lower corner. [m]
    real(wp), intent(out) :: lower(3)
    !> Upper corner. [m]
    real(wp), intent(out) :: upper(3)

    lower = -huge(1.0_wp)
    upper = huge(1.0_wp)
    ! Halves, whose sum can't overflow.
    upper(2) = 2.0_wp*min(0.5_wp*huge(1.0_wp), 0.5_wp*self%origin(2) + 0.5_wp*abs(self%amplitude))
  end subroutine sine_wave_bounds

end module mpm_sine_wave
