!> Memory of the machine, and sizes that people write.
module mpm_memory
  use mpm_kinds, only: lp, wp
  use mpm_strings, only: to_text
  implicit none
  private
  public :: available_memory, memory_left, parse_size, size_text, way_to_more

  !> Largest size, so that sums of two of them can be stored. [byte]
  integer(lp), parameter :: largest = 4000000000000000000_lp

contains

  !> Bytes that new arrays can take without swapping; huge where the system does not tell.
  function available_memory() result(bytes)
    !> `MemAvailable` of `/proc/meminfo` on Linux, or the limit of the container if that is less.
    integer(lp) :: bytes
    integer(lp) :: kibibytes, limit

    bytes = largest
    call read_number('/proc/meminfo', 'MemAvailable:', kibibytes)
    if (kibibytes > 0) bytes = 1024_lp*kibibytes
    call read_number('/sys/fs/cgroup/memory.max', '', limit)
    if (limit > 0) bytes = min(bytes, limit)
    call read_number('/sys/fs/cgroup/memory/memory.limit_in_bytes', '', limit)
    if (limit > 0) bytes = min(bytes, limit)
  end function available_memory

  !> Bytes that are left of a limit.
  function memory_left(limit, used) result(bytes)
    !> Most bytes in all; 0 for what the machine has.
    integer(lp), intent(in) :: limit
    !> Bytes in use, which the machine has counted already.
    integer(lp), intent(in) :: used
    !> Bytes that new arrays can take.
    integer(lp) :: bytes

    if (limit > 0) then
      bytes = max(0_lp, limit - used)
    else
      bytes = available_memory()
    end if
  end function memory_left

  !> The number behind a key that starts a line of a file.
  subroutine read_number(path, key, number)
    !> The file.
    character(*), intent(in) :: path
    !> The key; '' for the first line.
    character(*), intent(in) :: key
    !> The number; 0 when there is none.
    integer(lp), intent(out) :: number
    character(200) :: line
    integer :: unit, status

    number = 0
    open (newunit=unit, file=path, status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, key) /= 1) cycle
      ! A limit may be the word "max".
      read (line(len(key) + 1:), *, iostat=status) number
      if (status /= 0) number = 0
      exit
    end do
    close (unit)
  end subroutine read_number

  !> Read a size such as `8G`, `1.5GB`, `512MiB` or `100000`.
  pure subroutine parse_size(text, bytes, valid)
    !> A number, perhaps with k, M, G or T (powers of 1000), Ki, Mi, Gi or Ti (of 1024), and B.
    character(*), intent(in) :: text
    !> The size.
    integer(lp), intent(out) :: bytes
    !> Whether the text is a size above 0.
    logical, intent(out) :: valid
    character(*), parameter :: letters = 'kMGT'
    real(wp) :: number, base
    integer :: last, power, status

    bytes = 0
    valid = .false.
    last = verify(text, '0123456789.') - 1
    if (last < 0) last = len(text)
    if (last == 0 .or. last > 18 .or. scan(text, '0123456789') == 0) return
    read (text(:last), *, iostat=status) number
    if (status /= 0) return
    base = 1000.0_wp
    power = 0
    associate (unit => text(last + 1:))
      if (len(unit) > 0) power = index(letters, unit(:1))
      if (power == 0 .and. len(unit) > 0) then
        if (unit(:1) == 'K') power = 1
      end if
      select case (unit(min(power, 1) + 1:))
      case ('', 'B')
        continue
      case ('i', 'iB')
        if (power == 0) return
        base = 1024.0_wp
      case default
        return
      end select
    end associate
    number = number*base**power
    valid = number >= 1.0_wp .and. number <= real(largest, wp)
    if (valid) bytes = int(number, lp)
  end subroutine parse_size

  !> A size for people.
  pure function size_text(bytes) result(text)
    !> The size.
    integer(lp), intent(in) :: bytes
    !> In MB or GB.
    character(:), allocatable :: text

    if (bytes < 1000000000_lp) then
      text = to_text(real(bytes, wp)/1.0e6_wp, 3)//' MB'
    else
      text = to_text(real(bytes, wp)/1.0e9_wp, 3)//' GB'
    end if
  end function size_text

  !> How to get more memory, as the end of a hint.
  pure function way_to_more() result(text)
    !> Part of a sentence.
    character(:), allocatable :: text

    text = 'allow more with --max-memory SIZE'
  end function way_to_more

end module mpm_memory
