!> The name under which mpm_3d maps DefaultPoints on the threads of the job.
module mpm_thread_pool_points
  use mpm_default_points, only: add_points_properties, default_points_t
  use mpm_description, only: description_t
  implicit none
  private
  public :: thread_pool_points_t

  !> DefaultPoints.
  type, extends(default_points_t) :: thread_pool_points_t
  contains
    procedure, nopass :: describe => thread_pool_points_describe
  end type thread_pool_points_t

contains

  !> Purpose and properties of the class.
  subroutine thread_pool_points_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('points', 'ThreadPoolPoints', &
                          'DefaultPoints: for configs of mpm_3d, as all points are mapped on the &
                          &threads of the job.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          '    point-class = "ThreadPoolPoints"'//nl// &
                          '    point-file = "block.points"')
    call add_points_properties(description)
    call description%add_note('Results are those of DefaultPoints, to the last bit.')
  end subroutine thread_pool_points_describe

end module mpm_thread_pool_points
