!> How many threads a loop is worth.
module mpm_threads
  implicit none
  private
  public :: useful_threads

  !> Points or nodes that a thread must have to be worth its synchronisation.
  integer, parameter :: grain = 2000

contains

  !> Threads for an amount of work; the results of the program do not depend on their number.
  pure function useful_threads(threads, items) result(n)
    !> Threads at hand.
    integer, intent(in) :: threads
    !> Points or nodes to visit.
    integer, intent(in) :: items
    !> Threads to use, at least 1.
    integer :: n

    n = max(1, min(threads, items/grain))
  end function useful_threads

end module mpm_threads
