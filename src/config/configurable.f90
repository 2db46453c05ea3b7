!> The root of every class that a config can name.
module mpm_configurable
  use mpm_description, only: description_t
  implicit none
  private
  public :: configurable_t

  !> A class that a config can name.
  type, abstract :: configurable_t
  contains
    !> Fill in the class's description of itself.
    procedure(describe_i), deferred, nopass :: describe
  end type configurable_t

  abstract interface
    !> Fill in the class's description of itself.
    subroutine describe_i(description)
      import :: description_t
      implicit none
      !> Purpose and properties of the class.
      type(description_t), intent(out) :: description
    end subroutine describe_i
  end interface

end module mpm_configurable
