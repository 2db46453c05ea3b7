!> The name under which mpm_3d runs ExplicitUSL on the threads of the job.
module mpm_thread_pool_explicit_usl
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_solver, only: add_explicit_properties
  use mpm_explicit_usl, only: explicit_usl_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: thread_pool_explicit_usl_t

  !> ExplicitUSL.
  type, extends(explicit_usl_t) :: thread_pool_explicit_usl_t
  contains
    procedure, nopass :: describe => thread_pool_explicit_usl_describe
    procedure :: init => thread_pool_explicit_usl_init
  end type thread_pool_explicit_usl_t

contains

  !> Purpose and properties of the class.
  subroutine thread_pool_explicit_usl_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('solver', 'ThreadPoolExplicitUSL', &
                          'ExplicitUSL on the threads of the job: for configs of mpm_3d, as every &
                          &solver does so.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'solver'//nl//'{'//nl//'    class = "ThreadPoolExplicitUSL"'//nl// &
                          '    int-properties = {1, 1}   # cpdi, contact'//nl//'}')
    call add_explicit_properties(description, has_threads=.false., has_debug=.true.)
    call description%add_note('The number of threads is that of the command line or the job, all &
                              &of the machine when there is none (mpm_3d: one). Results are those &
                              &of ExplicitUSL, to the last bit, for any number.')
  end subroutine thread_pool_explicit_usl_describe

  !> Set up from the properties.
  subroutine thread_pool_explicit_usl_init(self, properties, error)
    !> The solver.
    class(thread_pool_explicit_usl_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> As of ExplicitUSL.
    type(error_t), allocatable, intent(out) :: error

    self%timed = properties%integer('debug') == 1
    call self%explicit_usl_t%init(properties, error)
  end subroutine thread_pool_explicit_usl_init

end module mpm_thread_pool_explicit_usl
