!> Root of a function between two points where its signs differ, asked for value by value.
!!
!! The rule of false position with Illinois weights, and a bisection whenever three values have not
!! halved the interval.
module mpm_bracket
  use mpm_kinds, only: wp
  implicit none
  private
  public :: bracket_t

  !> An interval that holds a root.
  type :: bracket_t
    !> Ends.
    real(wp) :: a = 0.0_wp, b = 0.0_wp
    !> Values there, those of an end that stays made smaller.
    real(wp) :: fa = 0.0_wp, fb = 0.0_wp
    !> Where the next value is wanted; at the end the root.
    real(wp) :: x = 0.0_wp
    !> Values taken.
    integer :: n = 0
    !> Width at the last check.
    real(wp) :: width = 0.0_wp
    !> Which end moved last: -1 a, 1 b.
    integer :: moved = 0
    !> The interval can't shrink further, or a value was 0.
    logical :: done = .false.
  contains
    !> Begin.
    procedure :: start => bracket_start
    !> Take the value at `x` and choose the next `x`.
    procedure :: take => bracket_take
  end type bracket_t

contains

  !> Begin with an interval and the values at its ends, of which one may be 0.
  pure subroutine bracket_start(self, a, fa, b, fb)
    !> The bracket.
    class(bracket_t), intent(inout) :: self
    !> One end.
    real(wp), intent(in) :: a
    !> Value there.
    real(wp), intent(in) :: fa
    !> Other end.
    real(wp), intent(in) :: b
    !> Value there, of the other sign.
    real(wp), intent(in) :: fb

    self%a = a
    self%fa = fa
    self%b = b
    self%fb = fb
    self%n = 0
    self%moved = 0
    self%width = abs(b - a)
    self%done = .false.
    call choose(self)
  end subroutine bracket_start

  !> Take the value at `x` and choose the next `x`.
  pure subroutine bracket_take(self, f)
    !> The bracket.
    class(bracket_t), intent(inout) :: self
    !> Value at `x`.
    real(wp), intent(in) :: f

    self%n = self%n + 1
    if (.not. abs(f) > 0.0_wp) then
      self%done = .true.
      return
    end if
    if ((f > 0.0_wp) .eqv. (self%fa > 0.0_wp)) then
      self%a = self%x
      self%fa = f
      if (self%moved == -1) self%fb = 0.5_wp*self%fb
      self%moved = -1
    else
      self%b = self%x
      self%fb = f
      if (self%moved == 1) self%fa = 0.5_wp*self%fa
      self%moved = 1
    end if
    call choose(self)
  end subroutine bracket_take

  !> Choose where the next value is wanted.
  pure subroutine choose(self)
    !> The bracket.
    class(bracket_t), intent(inout) :: self
    real(wp) :: middle

    middle = self%a + 0.5_wp*(self%b - self%a)
    if (mod(self%n, 3) == 2) then
      if (abs(self%b - self%a) > 0.5_wp*self%width) then
        self%width = abs(self%b - self%a)
        self%x = middle
        self%done = abs(self%b - self%a) <= 2.0_wp*epsilon(1.0_wp)*max(abs(self%a), abs(self%b))
        return
      end if
      self%width = abs(self%b - self%a)
    end if
    self%x = self%a - self%fa*((self%b - self%a)/(self%fb - self%fa))
    if (.not. (self%x - self%a)*(self%x - self%b) < 0.0_wp) self%x = middle
    self%done = abs(self%b - self%a) <= 2.0_wp*epsilon(1.0_wp)*max(abs(self%a), abs(self%b))
  end subroutine choose

end module mpm_bracket
