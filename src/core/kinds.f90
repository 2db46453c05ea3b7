!> Numeric kinds of the whole program; no other module names a kind.
module mpm_kinds
  use, intrinsic :: iso_fortran_env, only: int32, int64, real64
  implicit none
  private
  public :: ip, lp, wp

  !> Working precision of every physical quantity.
  integer, parameter :: wp = real64
  !> Indices and counts of points, nodes and cells.
  integer, parameter :: ip = int32
  !> Byte counts and products of counts that may exceed `huge(1_ip)`.
  integer, parameter :: lp = int64

end module mpm_kinds
