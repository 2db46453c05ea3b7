!> The root of every class that a config can name.
module mpm_configurable
  use mpm_description, only: description_t
  use mpm_store, only: store_t
  implicit none
  private
  public :: configurable_t

  !> A class that a config can name.
  type, abstract :: configurable_t
  contains
    !> Fill in the class's description of itself.
    procedure(describe_i), deferred, nopass :: describe
    !> Save what the next step depends on and `init` does not give.
    procedure :: save => configurable_save
    !> Take back what `save` has saved, after `init` and the start of the run.
    procedure :: restore => configurable_restore
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

contains

  !> Most classes have no state beside their properties.
  subroutine configurable_save(self, store)
    !> The object.
    class(configurable_t), intent(in) :: self
    !> Where to; its current group is the object's own.
    class(store_t), intent(inout) :: store

    associate (unused => self, unused_store => store)
    end associate
  end subroutine configurable_save

  !> Most classes have no state beside their properties.
  subroutine configurable_restore(self, store)
    !> The object, as `init` and the start of the run left it.
    class(configurable_t), intent(inout) :: self
    !> Where from; its current group is the object's own.
    class(store_t), intent(inout) :: store

    associate (unused => self, unused_store => store)
    end associate
  end subroutine configurable_restore

end module mpm_configurable
