!> The state of a run, saved to a store and taken back.
!!
!! Each object has a group with the name of its class and what its `save` puts there.
module mpm_state
  use mpm_configurable, only: configurable_t
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, raise
  use mpm_kinds, only: wp
  use mpm_model, only: model_t
  use mpm_monitor, only: monitor_t
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  use mpm_store, only: store_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: restore_state, save_state

contains

  !> Save the state of a run between two steps.
  subroutine save_state(store, model, driver, solver, serializer, monitor)
    !> Where to; `failure` tells whether it went well.
    class(store_t), intent(inout) :: store
    !> The model.
    type(model_t), intent(in) :: model
    !> The loop over time.
    class(configurable_t), intent(in) :: driver
    !> The solver.
    class(solver_t), intent(in) :: solver
    !> The serializer.
    class(serializer_t), intent(in) :: serializer
    !> What is told of the run.
    class(monitor_t), intent(in) :: monitor
    integer :: i

    call store%enter('model')
    call store%put('type', model%kin%sim_type)
    call store%put('t_start', model%t_start)
    call store%put('dt', model%dt)
    call store%put('time', model%time)
    call store%put('last_dt', model%last_dt)
    call store%put('step', model%step)
    call store%put('t_counted', model%t_counted)
    call store%put('step_counted', model%step_counted)
    call store%put('bodies', size(model%bodies))
    call store%put('contacts', size(model%contacts))
    call store%leave()
    call save_object(store, 'driver', driver)
    call save_object(store, 'solver', solver)
    call save_object(store, 'serializer', serializer)
    call save_object(store, 'grid', model%grid)
    do i = 1, size(model%bodies)
      call store%enter('body_'//to_text(i - 1))
      associate (body => model%bodies(i)%body)
        call store%put('name', body%name)
        call save_object(store, 'body', body)
        call save_object(store, 'points', body%points)
        call save_object(store, 'nodes', body%nodes)
        if (allocated(body%material)) call save_object(store, 'material', body%material)
        if (allocated(body%boundary)) call save_object(store, 'boundary', body%boundary)
      end associate
      call store%leave()
    end do
    do i = 1, size(model%contacts)
      call save_object(store, 'contact_'//to_text(i - 1), model%contacts(i)%contact)
    end do
    call store%enter('monitor')
    call monitor%save(store)
    call store%leave()
  end subroutine save_state

  !> Save an object and the name of its class.
  subroutine save_object(store, name, object)
    !> Where to.
    class(store_t), intent(inout) :: store
    !> Name of its group.
    character(*), intent(in) :: name
    !> The object.
    class(configurable_t), intent(in) :: object
    type(description_t) :: description

    call object%describe(description)
    call store%enter(name)
    call store%put('class', description%name)
    call object%save(store)
    call store%leave()
  end subroutine save_object

  !> Take back the state of a run.
  subroutine restore_state(store, model, driver, solver, serializer, monitor)
    !> Where from; `failure` tells whether it went well.
    class(store_t), intent(inout) :: store
    !> The model, started.
    type(model_t), intent(inout) :: model
    !> The loop over time.
    class(configurable_t), intent(inout) :: driver
    !> The solver, started.
    class(solver_t), intent(inout) :: solver
    !> The serializer.
    class(serializer_t), intent(inout) :: serializer
    !> What is told of the run.
    class(monitor_t), intent(inout) :: monitor
    character(:), allocatable :: name
    integer :: i

    call store%enter('model')
    call restore_model(store, model)
    call store%leave()
    call restore_object(store, 'driver', driver)
    call restore_object(store, 'solver', solver)
    call restore_object(store, 'serializer', serializer)
    call restore_object(store, 'grid', model%grid)
    do i = 1, size(model%bodies)
      if (allocated(store%failure)) return
      call store%enter('body_'//to_text(i - 1))
      associate (body => model%bodies(i)%body)
        call store%get('name', name)
        if (name /= body%name) call refuse(store, 'body '//to_text(i - 1)//' is "'//body%name// &
                                           '", but "'//name//'" was saved')
        call restore_object(store, 'body', body)
        call restore_object(store, 'points', body%points)
        call restore_object(store, 'nodes', body%nodes)
        if (allocated(body%material)) call restore_object(store, 'material', body%material)
        if (allocated(body%boundary)) call restore_object(store, 'boundary', body%boundary)
      end associate
      call store%leave()
    end do
    do i = 1, size(model%contacts)
      call restore_object(store, 'contact_'//to_text(i - 1), model%contacts(i)%contact)
    end do
    call store%enter('monitor')
    call monitor%restore(store)
    call store%leave()
    call serializer%resume(model)
  end subroutine restore_state

  !> Take back time and steps.
  subroutine restore_model(store, model)
    !> Where from.
    class(store_t), intent(inout) :: store
    !> The model, started.
    type(model_t), intent(inout) :: model
    real(wp) :: t_start, dt, counted
    integer :: sim_type, n_bodies, n_contacts

    sim_type = 0
    n_bodies = 0
    n_contacts = 0
    t_start = 0.0_wp
    dt = 0.0_wp
    call store%get('type', sim_type)
    call store%get('t_start', t_start)
    call store%get('dt', dt)
    call store%get('time', model%time)
    call store%get('last_dt', model%last_dt)
    call store%get('step', model%step)
    call store%get('t_counted', model%t_counted)
    call store%get('step_counted', model%step_counted)
    call store%get('bodies', n_bodies)
    call store%get('contacts', n_contacts)
    if (allocated(store%failure)) return
    if (sim_type /= model%kin%sim_type) then
      call refuse(store, 'TYPE is '//to_text(model%kin%sim_type)//', but '//to_text(sim_type)// &
                  ' was saved')
    else if (abs(t_start - model%t_start) > 0.0_wp) then
      call refuse(store, 'the start time is '//to_text(model%t_start)//' s, but '// &
                  to_text(t_start)//' s was saved')
    else if (n_bodies /= size(model%bodies) .or. n_contacts /= size(model%contacts)) then
      call refuse(store, 'the numbers of bodies and contacts are not those that were saved')
    end if
    ! Steps are counted from here when they do not go on as they were counted so far.
    counted = model%t_start + model%t_counted + real(model%step - model%step_counted, wp)*dt
    if (abs(dt - model%dt) > 0.0_wp .or. abs(counted - model%time) > 1.0e-6_wp*dt) then
      model%t_counted = model%time - model%t_start
      model%step_counted = model%step
    end if
  end subroutine restore_model

  !> Take back an object, which must be of the class that was saved.
  subroutine restore_object(store, name, object)
    !> Where from.
    class(store_t), intent(inout) :: store
    !> Name of its group.
    character(*), intent(in) :: name
    !> The object.
    class(configurable_t), intent(inout) :: object
    type(description_t) :: description
    character(:), allocatable :: class

    call object%describe(description)
    call store%enter(name)
    call store%get('class', class)
    if (class /= description%name) then
      call refuse(store, name//' is "'//description%name//'", but "'//class//'" was saved')
    end if
    if (.not. allocated(store%failure)) call object%restore(store)
    call store%leave()
  end subroutine restore_object

  !> The failure of a config that is not that of the run that was saved.
  subroutine refuse(store, message)
    !> The store.
    class(store_t), intent(inout) :: store
    !> What is different.
    character(*), intent(in) :: message

    if (allocated(store%failure)) return
    call raise(store%failure, err_input, message, file=store%path, &
               hint='a run goes on with the objects that it had; their numbers may be changed')
  end subroutine refuse

end module mpm_state
