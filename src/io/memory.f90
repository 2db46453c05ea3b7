!> Memory of the machine.
module mpm_memory
  use mpm_kinds, only: lp
  implicit none
  private
  public :: available_memory

contains

  !> Bytes that new arrays can take without swapping; huge where the system does not tell.
  function available_memory() result(bytes)
    !> `MemAvailable` of `/proc/meminfo` on Linux.
    integer(lp) :: bytes
    character(*), parameter :: key = 'MemAvailable:'
    character(200) :: line
    integer(lp) :: kibibytes
    integer :: unit, status

    bytes = huge(bytes)
    open (newunit=unit, file='/proc/meminfo', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, key) /= 1) cycle
      read (line(len(key) + 1:), *, iostat=status) kibibytes
      if (status == 0) bytes = 1024_lp*kibibytes
      exit
    end do
    close (unit)
  end function available_memory

end module mpm_memory
