!> A simulation with all its objects.
module mpm_job
  use mpm_checkpoints, only: checkpoints_t
  use mpm_driver, only: driver_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: lp
  use mpm_model, only: model_t
  use mpm_monitor, only: monitor_t
  use mpm_phase_clock, only: phase_setup
  use mpm_run_text, only: run_text
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  use omp_lib, only: omp_get_max_threads
  implicit none
  private
  public :: job_t

  !> Everything that a run needs.
  type :: job_t
    !> The config.
    character(:), allocatable :: config
    !> Grid, bodies and contacts.
    type(model_t) :: model
    !> The loop over time.
    class(driver_t), allocatable :: driver
    !> One step.
    class(solver_t), allocatable :: solver
    !> Frames.
    class(serializer_t), allocatable :: serializer
    !> Checkpoints.
    type(checkpoints_t) :: checkpoints
    !> Whether the run goes on from a checkpoint.
    logical :: goes_on = .false.
  contains
    !> Bring the model to its start: body forces, bases, first mapping.
    procedure :: start => job_start
    !> Run to the stop time.
    procedure :: run => job_run
    !> Memory of the points and nodes.
    procedure :: memory => job_memory
  end type job_t

contains

  !> Bring the model to its start: body forces, bases, first mapping.
  subroutine job_start(self, error)
    !> The job, configured.
    class(job_t), intent(inout) :: self
    !> Bodies that driver or solver can't take.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    self%model%time = self%model%t_start
    if (self%model%threads == 0) self%model%threads = self%solver%threads
    if (self%model%threads == 0) self%model%threads = omp_get_max_threads()
    if (self%solver%timed .and. .not. self%model%clock%on) then
      call self%model%clock%start(phase_setup)
    end if
    do i = 1, size(self%model%bodies)
      call self%model%bodies(i)%body%points%sign()
      self%model%bodies(i)%body%points%body_force = self%driver%body_force(self%model%kin)
    end do
    call self%driver%prepare(self%model, error)
    if (allocated(error)) return
    call self%solver%start(self%model, error)
    if (.not. allocated(error)) call self%driver%after_start(self%model)
    do i = 1, size(self%model%bodies)
      call self%serializer%ask(self%model%bodies(i)%body%points)
    end do
    if (.not. allocated(error)) call self%serializer%check(self%model, error)
    if (.not. allocated(error)) return
    if (len(error%file) == 0) error%file = self%config
  end subroutine job_start

  !> Run to the stop time.
  subroutine job_run(self, monitor, error)
    !> The job, started.
    class(job_t), intent(inout) :: self
    !> What is told of the run.
    class(monitor_t), intent(inout) :: monitor
    !> The simulation went bad, or output failed.
    type(error_t), allocatable, intent(out) :: error
    integer :: i

    if (allocated(self%checkpoints%text)) then
      self%serializer%config_text = self%checkpoints%text
      self%serializer%run = run_text(self%model, self%checkpoints%text, self%checkpoints%overrides)
    end if
    call self%serializer%open(self%model, error)
    if (.not. allocated(error)) call self%serializer%name_run(self%model, self%goes_on, error)
    if (allocated(error)) return
    call self%serializer%history%open(self%model, error)
    if (allocated(error)) return
    call self%checkpoints%begin(self%model, self%serializer, error)
    if (allocated(error)) return
    do i = 1, size(self%model%bodies)
      if (self%goes_on) exit
      call self%model%bodies(i)%body%points%write_table(error)
      if (allocated(error)) return
    end do
    do i = 1, size(self%model%bodies)
      call self%model%bodies(i)%body%points%use_huge_pages()
    end do
    call self%driver%run(self%model, self%solver, self%serializer, monitor, error, &
                         self%checkpoints)
    call self%serializer%finish(self%model)
  end subroutine job_run

  !> Bytes held by the points and nodes of all bodies.
  pure function job_memory(self) result(bytes)
    !> The job, started.
    class(job_t), intent(in) :: self
    !> Bytes.
    integer(lp) :: bytes
    integer :: i

    bytes = 0
    do i = 1, size(self%model%bodies)
      associate (body => self%model%bodies(i)%body)
        bytes = bytes + body%points%memory() + body%nodes%memory()
      end associate
    end do
  end function job_memory

end module mpm_job
