!> The history of a run: a table of sums over bodies, contact impulses and probes, a row at a time.
module mpm_history
  use mpm_body, only: body_t
  use mpm_contact_force, only: sum_contact_force
  use mpm_description, only: description_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_exact_number, only: exact_text
  use mpm_history_file, only: history_file_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: axis_name, kinematics_t
  use mpm_model, only: model_t
  use mpm_probe, only: probe_slot_t
  use mpm_properties, only: properties_t
  use mpm_store, only: store_t
  use mpm_stress_work, only: recoverable_energy, stress_work_t
  use mpm_strings, only: append_text, string_t, to_text
  implicit none
  private
  public :: add_history_properties, history_t

  !> Rows of sums over the bodies. Without a rate nothing is computed.
  type :: history_t
    !> Rows per unit of time; 0 for no history. [1/s]
    real(wp) :: rate = 0.0_wp
    !> Rows have the energy that each body has dissipated.
    logical :: dissipation = .false.
    !> Probes in the order of the config.
    type(probe_slot_t), allocatable :: probes(:)
    !> The table.
    type(history_file_t) :: file
    !> Number of the next row that is due, 0 before the first.
    integer(lp), private :: next = 0
    !> Impulses on the first bodies of the contacts. [N s] (nvel, contacts)
    real(wp), allocatable, private :: impulse(:, :)
    !> Work of the stresses of each body; not allocated unless asked for. (bodies)
    type(stress_work_t), allocatable, private :: work(:)
    !> Whether the state was restored.
    logical, private :: restored = .false.
  contains
    !> Take rate and place from the properties.
    procedure :: init => history_init
    !> Whether there is a history.
    procedure :: is_on => history_is_on
    !> Start the table, or go on in it, and write the row of the start.
    procedure :: open => history_open
    !> The end of a step.
    procedure :: advance => history_advance
    !> Save what the next rows depend on.
    procedure :: save => history_save
    !> Take it back.
    procedure :: restore => history_restore
    procedure, private :: header => history_header
    procedure, private :: write_row => history_write_row
  end type history_t

contains

  !> Add the properties of a history.
  subroutine add_history_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_real('history_rate', '1/s', 'rows of the history per unit of time; 0: no &
                              &history', default=0.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_integer('history_dissipation', '1: the history has the energy that each &
                                 &body has dissipated, which takes the work of the stresses in &
                                 &every step', default=0, lower=0, upper=1, by_name=.true.)
    call description%add_note('history_rate: <frame_folder>/<run_name>.history.csv gets sums over &
                              &the bodies, impulses of contacts and what probes measure.')
  end subroutine add_history_properties

  !> Take rate and place from the properties.
  subroutine history_init(self, properties, folder, name)
    !> The history.
    class(history_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Folder of the table.
    character(*), intent(in) :: folder
    !> Start of its name.
    character(*), intent(in) :: name

    self%rate = properties%real('history_rate')
    self%dissipation = properties%integer('history_dissipation') == 1
    call self%file%place(folder, name//'.history.csv')
    if (.not. allocated(self%probes)) allocate (self%probes(0))
  end subroutine history_init

  !> Whether there is a history.
  pure function history_is_on(self) result(is_on)
    !> The history.
    class(history_t), intent(in) :: self
    !> Whether rows are written.
    logical :: is_on

    is_on = self%rate > 0.0_wp
  end function history_is_on

  !> Start the table, or go on in it behind the last row before the checkpoint.
  subroutine history_open(self, model, error)
    !> The history.
    class(history_t), intent(inout) :: self
    !> The model at its start, or restored.
    type(model_t), intent(inout) :: model
    !> The table can't be written.
    type(error_t), allocatable, intent(out) :: error
    logical :: fresh
    integer :: i

    if (.not. self%is_on()) return
    if (.not. self%restored) then
      allocate (self%impulse(model%kin%nvel, size(model%contacts)), source=0.0_wp)
    end if
    if (self%dissipation) then
      fresh = .not. allocated(self%work)
      if (fresh) allocate (self%work(size(model%bodies)))
      do i = 1, size(model%bodies)
        associate (body => model%bodies(i)%body)
          if (fresh) self%work(i)%stored = recoverable_energy(body)
          if (allocated(body%material)) call self%work(i)%begin(body%points)
        end associate
      end do
    end if
    call self%file%open(self%header(model), error)
    if (allocated(error)) return
    if (self%restored) then
      self%next = passed(model, self%rate) + 1
    else
      call self%write_row(model, error)
    end if
  end subroutine history_open

  !> The end of a step: add what is summed over steps, and write a row when one is due.
  subroutine history_advance(self, model, error)
    !> The history, opened.
    class(history_t), intent(inout) :: self
    !> The model at the end of the step.
    type(model_t), intent(in) :: model
    !> The table can't be written.
    type(error_t), allocatable, intent(out) :: error
    real(wp) :: force(model%kin%nvel)
    logical :: known
    integer :: i

    do i = 1, size(model%contacts)
      call sum_contact_force(model%contacts(i)%contact, model%bodies, force, known)
      self%impulse(:, i) = self%impulse(:, i) + model%last_kick*force
    end do
    if (self%dissipation) then
      do i = 1, size(model%bodies)
        associate (body => model%bodies(i)%body)
          if (.not. (body%active .and. allocated(body%material))) cycle
          call self%work(i)%add_step(body%points, model%last_dt)
        end associate
      end do
    end if
    if (passed(model, self%rate) >= self%next) call self%write_row(model, error)
  end subroutine history_advance

  !> How often the interval between rows has passed since the start.
  pure function passed(model, rate) result(times)
    !> The model.
    type(model_t), intent(in) :: model
    !> Rows per unit of time. [1/s]
    real(wp), intent(in) :: rate
    !> Whole intervals.
    integer(lp) :: times

    ! A time that a step reaches up to rounding counts.
    times = int(min(1.0e18_wp, (model%time - model%t_start + 1.0e-6_wp*model%last_dt)*rate), lp)
  end function passed

  !> Names of the columns.
  function history_header(self, model) result(text)
    !> The history.
    class(history_t), intent(in) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> One line.
    character(:), allocatable :: text
    type(string_t), allocatable :: names(:)
    real(wp) :: force(model%kin%nvel)
    logical :: known
    integer :: i, k

    text = 'time'
    do i = 1, size(model%bodies)
      call body_columns(model%bodies(i)%body, model%kin, self%dissipation, names)
      do k = 1, size(names)
        text = text//','//quoted(model%bodies(i)%body%name//'.'//names(k)%text)
      end do
    end do
    do i = 1, size(model%contacts)
      call sum_contact_force(model%contacts(i)%contact, model%bodies, force, known)
      if (.not. known) cycle
      do k = 1, model%kin%nvel
        text = text//','//quoted(contact_name(model, i)//'.impulse_'//axis_name(model%kin, k))
      end do
    end do
    do i = 1, size(self%probes)
      call self%probes(i)%probe%columns(model%kin, names)
      do k = 1, size(names)
        text = text//','//quoted(self%probes(i)%probe%name//'.'//names(k)%text)
      end do
    end do
  end function history_header

  !> Names of the columns of a body.
  subroutine body_columns(body, kin, dissipation, names)
    !> The body.
    class(body_t), intent(in) :: body
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Whether there are dissipated energies.
    logical, intent(in) :: dissipation
    !> Without that of the body.
    type(string_t), allocatable, intent(out) :: names(:)
    integer :: a

    allocate (names(0))
    call append_text(names, 'mass')
    do a = 1, kin%dim
      call append_text(names, 'centre_'//axis_name(kin, a))
    end do
    do a = 1, kin%nvel
      call append_text(names, 'momentum_'//axis_name(kin, a))
    end do
    call append_text(names, 'kinetic_energy')
    if (.not. allocated(body%material)) return
    call append_text(names, 'strain_energy')
    if (dissipation) call append_text(names, 'dissipated_energy')
  end subroutine body_columns

  !> Name of a contact; one without a name of its own has its number.
  pure function contact_name(model, position) result(name)
    !> The model.
    type(model_t), intent(in) :: model
    !> Position in its list.
    integer, intent(in) :: position
    !> The name.
    character(:), allocatable :: name
    integer :: i

    name = ''
    if (allocated(model%contacts(position)%contact%name)) then
      name = trim(model%contacts(position)%contact%name)
    end if
    do i = 1, position - 1
      if (.not. allocated(model%contacts(i)%contact%name)) cycle
      if (trim(model%contacts(i)%contact%name) == name) name = ''
    end do
    if (len(name) == 0) name = 'contact_'//to_text(position - 1)
  end function contact_name

  !> A name as a field of the table: within quotes where it has commas or quotes.
  pure function quoted(name) result(text)
    !> The name.
    character(*), intent(in) :: name
    !> The field.
    character(:), allocatable :: text
    integer :: i

    text = name
    if (scan(name, ',"'//achar(10)//achar(13)) == 0) return
    text = '"'
    do i = 1, len(name)
      if (name(i:i) == '"') text = text//'"'
      text = text//name(i:i)
    end do
    text = text//'"'
  end function quoted

  !> Write a row of the present.
  subroutine history_write_row(self, model, error)
    !> The history.
    class(history_t), intent(inout) :: self
    !> The state.
    type(model_t), intent(in) :: model
    !> The table can't be written.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: text
    type(string_t), allocatable :: names(:)
    real(wp), allocatable :: values(:)
    real(wp) :: force(model%kin%nvel)
    logical :: known
    integer :: i

    text = exact_text(model%time)
    do i = 1, size(model%bodies)
      call sum_body(model%bodies(i)%body, model%kin, values)
      text = text//joined(values)
      if (.not. (self%dissipation .and. allocated(model%bodies(i)%body%material))) cycle
      text = text//joined([self%work(i)%dissipated(values(size(values)))])
    end do
    do i = 1, size(model%contacts)
      call sum_contact_force(model%contacts(i)%contact, model%bodies, force, known)
      if (known) text = text//joined(self%impulse(:, i))
    end do
    do i = 1, size(self%probes)
      call self%probes(i)%probe%columns(model%kin, names)
      deallocate (values)
      allocate (values(size(names)))
      call self%probes(i)%probe%sample(model, values)
      text = text//joined(values)
    end do
    call self%file%append(text, error)
    self%next = passed(model, self%rate) + 1
  end subroutine history_write_row

  !> Mass, centre, momentum, kinetic and, with a material, strain energy of a body.
  subroutine sum_body(body, kin, values)
    !> The body.
    class(body_t), intent(in) :: body
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> The numbers, those of points inside the grid.
    real(wp), allocatable, intent(out) :: values(:)
    real(wp) :: mass, first(kin%dim), momentum(kin%nvel), kinetic
    integer :: p

    mass = 0.0_wp
    first = 0.0_wp
    momentum = 0.0_wp
    kinetic = 0.0_wp
    associate (points => body%points)
      do p = 1, points%n_inside
        mass = mass + points%mass(p)
        first = first + points%mass(p)*points%x(:, p)
        momentum = momentum + points%mass(p)*points%velocity(:, p)
        kinetic = kinetic + 0.5_wp*points%mass(p)*dot_product(points%velocity(:, p), &
                                                              points%velocity(:, p))
      end do
    end associate
    if (mass > 0.0_wp) first = first/mass
    values = [mass, first, momentum, kinetic]
    if (allocated(body%material)) values = [values, recoverable_energy(body)]
  end subroutine sum_body

  !> Numbers as the fields of a row, with a comma in front of each.
  pure function joined(values) result(text)
    !> The numbers.
    real(wp), intent(in) :: values(:)
    !> The fields.
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(values)
      text = text//','//exact_text(values(i))
    end do
  end function joined

  !> Save what the next rows depend on.
  subroutine history_save(self, store)
    !> The history.
    class(history_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store
    type(description_t) :: description
    integer :: i

    if (.not. (self%is_on() .and. allocated(self%impulse))) return
    call store%enter('history')
    call self%file%save(store)
    if (size(self%impulse) > 0) call store%put('impulse', self%impulse)
    if (allocated(self%work)) then
      call store%put('work', [(self%work(i)%done, i=1, size(self%work))])
      call store%put('stored', [(self%work(i)%stored, i=1, size(self%work))])
    end if
    do i = 1, size(self%probes)
      call store%enter('probe_'//to_text(i - 1))
      call self%probes(i)%probe%describe(description)
      call store%put('class', description%name)
      call self%probes(i)%probe%save(store)
      call store%leave()
    end do
    call store%leave()
  end subroutine history_save

  !> Take back what the next rows depend on; a history that was not saved begins anew.
  subroutine history_restore(self, store)
    !> The history.
    class(history_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store
    real(wp), allocatable :: done(:), stored(:)
    logical :: has_work
    integer :: i

    if (.not. self%is_on()) return
    if (.not. store%has('history')) return
    call store%enter('history')
    self%restored = .true.
    call self%file%restore(store)
    allocate (self%impulse(0, 0))
    if (store%has('impulse')) call store%get('impulse', self%impulse)
    has_work = self%dissipation
    if (has_work) has_work = store%has('work')
    if (has_work) then
      call store%get('work', done)
      call store%get('stored', stored)
      if (.not. allocated(store%failure)) then
        allocate (self%work(size(done)))
        self%work%done = done
        self%work%stored = stored
      end if
    end if
    do i = 1, size(self%probes)
      if (.not. allocated(store%failure)) call restore_probe(self%probes(i), i, store)
    end do
    call store%leave()
  end subroutine history_restore

  !> Take back a probe, which must be of the class that was saved.
  subroutine restore_probe(slot, position, store)
    !> The probe.
    type(probe_slot_t), intent(inout) :: slot
    !> Position in the list of probes.
    integer, intent(in) :: position
    !> Where from.
    class(store_t), intent(inout) :: store
    type(description_t) :: description
    character(:), allocatable :: class
    logical :: same

    call slot%probe%describe(description)
    same = store%has('probe_'//to_text(position - 1))
    if (same) then
      call store%enter('probe_'//to_text(position - 1))
      call store%get('class', class)
      same = class == description%name
      if (same) call slot%probe%restore(store)
      call store%leave()
    end if
    if (same .or. allocated(store%failure)) return
    call raise(store%failure, err_input, 'probe "'//slot%probe%name//'" was not saved', &
               file=store%path, hint='a run goes on with the probes that it had')
  end subroutine restore_probe

end module mpm_history
