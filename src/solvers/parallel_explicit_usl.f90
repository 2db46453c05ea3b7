!> The name under which mpm_3d runs ExplicitUSL on threads of its own.
module mpm_parallel_explicit_usl
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_explicit_solver, only: add_explicit_properties
  use mpm_explicit_usl, only: explicit_usl_t
  use mpm_properties, only: properties_t
  implicit none
  private
  public :: parallel_explicit_usl_t

  !> ExplicitUSL with a number of threads.
  type, extends(explicit_usl_t) :: parallel_explicit_usl_t
  contains
    procedure, nopass :: describe => parallel_explicit_usl_describe
    procedure :: init => parallel_explicit_usl_init
  end type parallel_explicit_usl_t

contains

  !> Purpose and properties of the class.
  subroutine parallel_explicit_usl_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('solver', 'ParallelExplicitUSL', &
                          'ExplicitUSL, with a number of threads of its own: for configs of &
                          &mpm_3d, as every solver runs on the threads of the job.', &
                          'Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196', &
                          'solver'//nl//'{'//nl//'    class = "ParallelExplicitUSL"'//nl// &
                          '    int-properties = {1, 1, 2}   # cpdi, contact, threads'//nl//'}')
    call add_explicit_properties(description, has_threads=.true., has_debug=.true.)
    call description%add_note('--threads of the command line and threads of the job go before &
                              &threads here. Results are those of ExplicitUSL, to the last bit, &
                              &for any number (mpm_3d: they depend on it, and TYPE 4 crashes).')
  end subroutine parallel_explicit_usl_describe

  !> Set up from the properties.
  subroutine parallel_explicit_usl_init(self, properties, error)
    !> The solver.
    class(parallel_explicit_usl_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> As of ExplicitUSL.
    type(error_t), allocatable, intent(out) :: error

    self%threads = properties%integer('threads')
    self%timed = properties%integer('debug') == 1
    call self%explicit_usl_t%init(properties, error)
  end subroutine parallel_explicit_usl_init

end module mpm_parallel_explicit_usl
