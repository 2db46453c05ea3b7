!> Runs of small models by drivers.
module mpm_drive_fixture
  use mpm_description, only: description_t
  use mpm_driver, only: driver_t
  use mpm_errors, only: error_t
  use mpm_explicit_usl, only: explicit_usl_t
  use mpm_kinds, only: wp
  use mpm_log_serializer_fixture, only: log_serializer_t
  use mpm_model, only: model_t
  use mpm_model_fixture, only: lattice_table, make_body, make_model
  use mpm_monitor, only: monitor_t, quiet
  use mpm_properties, only: make_properties, properties_t
  implicit none
  private
  public :: drive, make_stones, set_up

contains

  !> A model with small blocks `a` and `b` at rest, apart from each other.
  subroutine make_stones(sim_type, t_start, dt, model)
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Start time. [s]
    real(wp), intent(in) :: t_start
    !> Time step. [s]
    real(wp), intent(in) :: dt
    !> The model.
    type(model_t), intent(out) :: model
    real(wp), allocatable :: table(:, :)

    call make_model(sim_type, [10.0_wp, 10.0_wp, 10.0_wp], [10, 10, 10], 2, 0, model)
    call lattice_table(model%kin, [2.0_wp, 5.0_wp, 5.0_wp], 0.5_wp, [2, 2, 2], 1.0_wp, table)
    call make_body(model, 1, 'a', table)
    call lattice_table(model%kin, [7.0_wp, 5.0_wp, 5.0_wp], 0.5_wp, [2, 2, 2], 1.0_wp, table)
    call make_body(model, 2, 'b', table)
    model%t_start = t_start
    model%time = t_start
    model%dt = dt
  end subroutine make_stones

  !> Set up a driver from property lists as in a config.
  subroutine set_up(driver, sim_type, text, error)
    !> The driver.
    class(driver_t), intent(inout) :: driver
    !> Simulation TYPE.
    integer, intent(in) :: sim_type
    !> Property lists.
    character(*), intent(in) :: text
    !> Bad properties.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties

    call driver%describe(description)
    call make_properties(description, sim_type, text, properties, error)
    if (allocated(error)) return
    call driver%init(properties, error)
  end subroutine set_up

  !> Run a model as a job does, without output.
  subroutine drive(driver, model, serializer, error)
    !> The driver, set up.
    class(driver_t), intent(inout) :: driver
    !> The model.
    type(model_t), intent(inout) :: model
    !> Remembers the frames.
    type(log_serializer_t), intent(inout) :: serializer
    !> What ended the run early.
    type(error_t), allocatable, intent(out) :: error
    type(explicit_usl_t) :: solver
    type(monitor_t) :: monitor
    integer :: i

    monitor%verbosity = quiet
    do i = 1, size(model%bodies)
      model%bodies(i)%body%points%body_force = driver%body_force(model%kin)
    end do
    call driver%prepare(model, error)
    if (allocated(error)) return
    call solver%start(model, error)
    if (allocated(error)) return
    call driver%after_start(model)
    call serializer%open(model, error)
    call driver%run(model, solver, serializer, monitor, error)
  end subroutine drive

end module mpm_drive_fixture
