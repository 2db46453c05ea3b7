!> Many runs of a swimming body, each with other muscles.
module mpm_fish_random_sample_driver
  use mpm_body, only: body_t
  use mpm_body_list, only: find_body
  use mpm_description, only: description_t
  use mpm_driver, only: driver_t
  use mpm_errors, only: err_input, error_t, raise
  use mpm_exact_number, only: exact_text
  use mpm_files, only: directory_of
  use mpm_fish, only: fish_t
  use mpm_hashed_random, only: random_number_of
  use mpm_history_file, only: history_file_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: kinematics_t
  use mpm_model, only: model_t
  use mpm_points, only: points_t
  use mpm_properties, only: properties_t
  use mpm_serializer, only: serializer_t
  use mpm_solver, only: solver_t
  use mpm_store, only: store_t
  use mpm_strings, only: to_text
  implicit none
  private
  public :: add_sample_notes, add_sample_properties, fish_random_sample_driver_t

  !> Columns of the table.
  character(*), parameter :: header = &
    'sample,alpha_h,alpha_a,alpha_t,beta_h,beta_a,beta_t,gamma_h,gamma_a,gamma_t,'// &
    'displacement_x,displacement_y'

  !> The points of a body at the start of a run.
  type :: start_t
    !> The points.
    class(points_t), allocatable :: points
    !> Whether the body is active.
    logical :: active = .true.
  end type start_t

  !> Runs from the same start, one behind the other, with muscles drawn at random.
  type, extends(driver_t) :: fish_random_sample_driver_t
    !> Ends of the ranges of alpha, beta, gamma. (2, 3)
    real(wp) :: ranges(2, 3) = 0.0_wp
    !> Number of runs.
    integer :: n_samples = 0
    !> Seed of the random numbers.
    integer :: seed = 1
    !> Number of the present run, from 1.
    integer :: sample = 1
    !> Runs that are in the table.
    integer :: n_done = 0
    !> Position of the fish in the model's list.
    integer :: fish = 0
    !> The table.
    type(history_file_t) :: file
    !> The properties, until the bodies exist.
    type(properties_t) :: properties
    !> Whether the table has been begun in this run.
    logical, private :: is_open = .false.
    !> Whether the next step is the first of another run.
    logical, private :: returns = .false.
    !> Whether the fish has the muscles of the present run.
    logical, private :: has_muscles = .false.
    !> The bodies at the start. (bodies)
    type(start_t), allocatable, private :: start(:)
  contains
    procedure, nopass :: describe => fish_random_sample_driver_describe
    procedure :: init => fish_random_sample_driver_init
    procedure :: body_force => fish_random_sample_driver_body_force
    procedure :: prepare => fish_random_sample_driver_prepare
    procedure :: after_start => fish_random_sample_driver_after_start
    procedure :: before_step => fish_random_sample_driver_before_step
    procedure :: next_step => fish_random_sample_driver_next_step
    procedure :: plan => fish_random_sample_driver_plan
    procedure :: save => fish_random_sample_driver_save
    procedure :: restore => fish_random_sample_driver_restore
    !> Draw the muscles of a run.
    procedure :: draw => fish_random_sample_driver_draw
    procedure, private :: write_line
    procedure, private :: go_back
    procedure, private :: give_muscles
  end type fish_random_sample_driver_t

contains

  !> Purpose and properties of the class.
  subroutine fish_random_sample_driver_describe(description)
    !> The description.
    type(description_t), intent(out) :: description
    character(*), parameter :: nl = new_line('a')

    call description%init('driver', 'FishRandomSampleDriver', &
                          'Runs of a body of the material Fish from the same start, each with &
                          &muscles drawn at random from ranges, and a table of how far it swam. No &
                          &gravity.', &
                          'Random numbers: Fishman and Moore, SIAM J. Sci. Stat. Comput. 7 (1986) &
                          &24-45', &
                          'driver'//nl//'{'//nl//'    class = "FishRandomSampleDriver"'//nl// &
                          '    # t_stop, ranges of alpha, beta, gamma'//nl// &
                          '    properties = {1, 0, 0.05, 3, 7, 0, 3.14}'//nl// &
                          '    int-properties = {2, seed = 7}   # samples'//nl// &
                          '    str-properties = {"samples.csv", "block_0"}'//nl//'}')
    call add_sample_properties(description)
    call description%add_string('output_file', 'file for the table, relative to the working &
                                &directory')
    call description%add_string('body', 'name of the fish', default='')
    call add_sample_notes(description)
    call description%add_note('alpha, beta and gamma of head, abdomen and tail are drawn &
                              &independently, each uniform in its range.')
  end subroutine fish_random_sample_driver_describe

  !> Add the properties of drivers that draw muscles, but for strings.
  subroutine add_sample_properties(description)
    !> The description.
    type(description_t), intent(inout) :: description
    character(*), parameter :: names(3) = [character(5) :: 'alpha', 'beta', 'gamma']
    character(*), parameter :: meanings(3) = &
      [character(34) :: 'logarithm of the largest stretch', 'angular frequency', 'phase']
    character(*), parameter :: units(3) = [character(3) :: '-', '1/s', '-']
    integer :: i

    call description%add_real('t_stop', 's', 'stop time of each run')
    do i = 1, 3
      call description%add_real(trim(names(i))//'_min', trim(units(i)), &
                                trim(meanings(i))//': least')
      call description%add_real(trim(names(i))//'_max', trim(units(i)), &
                                trim(meanings(i))//': largest')
    end do
    call description%add_integer('samples', 'number of runs', lower=1)
    call description%add_integer('id', 'the fish by its number, from 0, when no name is given', &
                                 default=-1, lower=0)
    call description%add_integer('seed', 'seed of the random numbers', default=1, by_name=.true.)
  end subroutine add_sample_properties

  !> Add the remarks of drivers that draw muscles.
  subroutine add_sample_notes(description)
    !> The description.
    type(description_t), intent(inout) :: description

    call description%add_note('Each line of the table has the number of the run, its nine numbers, &
                              &and the mean displacement of the fish, weighted by mass.')
    call description%add_note('Samples are a function of seed and number of the run (mpm_3d: of &
                              &the clock). Contacts begin anew in each run (mpm_3d: they go on).')
    call description%add_note('Frames and history show the first run.')
  end subroutine add_sample_notes

  !> Set up from the properties.
  subroutine fish_random_sample_driver_init(self, properties, error)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> A range that ends before it begins, or a file without a name.
    type(error_t), allocatable, intent(out) :: error
    character(*), parameter :: names(3) = [character(5) :: 'alpha', 'beta', 'gamma']
    character(:), allocatable :: path
    integer :: i, slash

    self%t_stop = properties%real('t_stop')
    do i = 1, 3
      self%ranges(:, i) = [properties%real(trim(names(i))//'_min'), &
                           properties%real(trim(names(i))//'_max')]
      if (self%ranges(2, i) >= self%ranges(1, i)) cycle
      call properties%reject(trim(names(i))//'_max', 'the range of '//trim(names(i))// &
                             ' ends before it begins', error, 'give the smaller number first')
      return
    end do
    self%n_samples = properties%integer('samples')
    self%seed = properties%integer('seed')
    self%properties = properties
    path = properties%string('output_file')
    slash = index(path, '/', back=.true.)
    if (len_trim(path(slash + 1:)) == 0) then
      call properties%reject('output_file', 'the output file has no name', error, &
                             'for example "samples.csv"')
      return
    end if
    call self%file%place(directory_of(path), path(slash + 1:))
  end subroutine fish_random_sample_driver_init

  !> None.
  pure function fish_random_sample_driver_body_force(self, kin) result(b)
    !> The driver.
    class(fish_random_sample_driver_t), intent(in) :: self
    !> Component counts.
    type(kinematics_t), intent(in) :: kin
    !> Acceleration. [m/s2]
    real(wp) :: b(3)

    associate (unused => self, unused_kin => kin)
    end associate
    b = 0.0_wp
  end function fish_random_sample_driver_body_force

  !> Find the fish.
  subroutine fish_random_sample_driver_prepare(self, model, error)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    !> No such body, or one of another material.
    type(error_t), allocatable, intent(out) :: error

    call find_body(model%bodies, self%properties, 'body', 'id', self%fish, error)
    if (allocated(error)) return
    if (allocated(model%bodies(self%fish)%body%material)) then
      select type (material => model%bodies(self%fish)%body%material)
      type is (fish_t)
        return
      end select
    end if
    call raise(error, err_input, 'body "'//model%bodies(self%fish)%body%name// &
               '" is no fish', hint='it needs material-class = "Fish"')
  end subroutine fish_random_sample_driver_prepare

  !> Keep the bodies as they are at the start.
  subroutine fish_random_sample_driver_after_start(self, model)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    integer :: i

    if (self%n_samples == 1) return
    allocate (self%start(size(model%bodies)))
    do i = 1, size(model%bodies)
      allocate (self%start(i)%points, source=model%bodies(i)%body%points)
      self%start(i)%active = model%bodies(i)%body%active
    end do
  end subroutine fish_random_sample_driver_after_start

  !> Go back to the start before the first step of a run, and give the fish its muscles.
  subroutine fish_random_sample_driver_before_step(self, model)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(inout) :: model

    if (self%returns) call self%go_back(model)
    if (.not. self%has_muscles) call self%give_muscles(model%bodies(self%fish)%body)
  end subroutine fish_random_sample_driver_before_step

  !> Bring the model to its start.
  subroutine go_back(self, model)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(inout) :: model
    class(points_t), allocatable :: points
    integer :: i

    do i = 1, size(model%bodies)
      associate (body => model%bodies(i)%body)
        allocate (points, source=self%start(i)%points)
        points%needs_gradient = body%points%needs_gradient
        if (allocated(body%points%gradient) .and. .not. allocated(points%gradient)) then
          allocate (points%gradient(points%kin%ngrad, points%n), source=0.0_wp)
        end if
        if (allocated(body%points%shear_rate) .and. .not. allocated(points%shear_rate)) then
          allocate (points%shear_rate(points%n), source=0.0_wp)
        end if
        call move_alloc(points, body%points)
        body%active = self%start(i)%active
      end associate
    end do
    model%time = model%t_start
    model%t_counted = 0.0_wp
    model%step_counted = model%step
    model%last_dt = 0.0_wp
    self%returns = .false.
    self%has_muscles = .false.
  end subroutine go_back

  !> Give the fish the muscles of the present run.
  subroutine give_muscles(self, body)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The fish.
    class(body_t), intent(inout) :: body
    real(wp) :: values(9)

    values = self%draw(self%sample)
    select type (material => body%material)
    type is (fish_t)
      material%amplitude = values(1:3)
      material%frequency = values(4:6)
      material%phase = values(7:9)
    end select
    self%has_muscles = .true.
  end subroutine give_muscles

  !> Draw the muscles of a run: alpha, beta and gamma of head, abdomen, tail.
  pure function fish_random_sample_driver_draw(self, sample) result(values)
    !> The driver.
    class(fish_random_sample_driver_t), intent(in) :: self
    !> Number of the run.
    integer, intent(in) :: sample
    !> The numbers.
    real(wp) :: values(9)
    integer :: i
    real(wp) :: part

    do i = 1, 9
      part = random_number_of(self%seed, int(sample, lp), int(i, lp), 0_lp)
      associate (range => self%ranges(:, (i + 2)/3))
        values(i) = range(1) + part*(range(2) - range(1))
      end associate
    end do
  end function fish_random_sample_driver_draw

  !> Choose the next step; at the end of a run write its line and begin the next one.
  subroutine fish_random_sample_driver_next_step(self, model, solver, serializer, dt, t_next, error)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The model at the start of the step.
    type(model_t), intent(in) :: model
    !> The solver, for its stable steps.
    class(solver_t), intent(in) :: solver
    !> The serializer, for the time of the next frame.
    class(serializer_t), intent(in) :: serializer
    !> Length of the step; 0 when the last run has reached its end. [s]
    real(wp), intent(out) :: dt
    !> Time at the end of the step. [s]
    real(wp), intent(out) :: t_next
    !> The table can't be written.
    type(error_t), allocatable, intent(out) :: error
    integer(lp) :: steps

    associate (unused => solver, unused_serializer => serializer)
    end associate
    steps = self%step_count(model)
    dt = model%dt
    t_next = model%t_start + model%t_counted + &
             real(model%step + 1 - model%step_counted, wp)*model%dt
    if (model%step + 1 == steps) then
      t_next = self%t_stop
      dt = t_next - model%time
    else if (model%step >= steps) then
      t_next = model%time
      dt = 0.0_wp
      if (self%n_done < self%sample) call self%write_line(model, error)
      if (allocated(error) .or. self%sample >= self%n_samples) return
      self%sample = self%sample + 1
      self%returns = .true.
      dt = min(model%dt, self%t_stop - model%t_start)
      t_next = model%t_start + dt
    end if
  end subroutine fish_random_sample_driver_next_step

  !> Write the line of the present run, which has ended.
  subroutine write_line(self, model, error)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> The model at the end of the run.
    type(model_t), intent(in) :: model
    !> The table can't be written.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: line
    real(wp) :: values(11)
    integer :: k, a

    if (.not. self%is_open) then
      call self%file%open(header, error)
      if (allocated(error)) return
      self%is_open = .true.
    end if
    values = 0.0_wp
    values(:9) = self%draw(self%sample)
    associate (points => model%bodies(self%fish)%body%points, &
               n => model%bodies(self%fish)%body%points%n_inside)
      do a = 1, 2
        if (n == 0) exit
        values(9 + a) = dot_product(points%mass(:n), points%displacement(a, :n))/ &
                        sum(points%mass(:n))
      end do
    end associate
    line = to_text(self%sample)
    do k = 1, size(values)
      line = line//','//exact_text(values(k))
    end do
    call self%file%append(line, error)
    if (.not. allocated(error)) self%n_done = self%sample
  end subroutine write_line

  !> Number of steps of all runs.
  subroutine fish_random_sample_driver_plan(self, model, solver, steps, exact)
    !> The driver.
    class(fish_random_sample_driver_t), intent(in) :: self
    !> The model at its start.
    type(model_t), intent(in) :: model
    !> The solver, started, for its stable steps.
    class(solver_t), intent(in) :: solver
    !> Number of steps, at least 0.
    integer(lp), intent(out) :: steps
    !> Whether it is no estimate.
    logical, intent(out) :: exact
    type(model_t) :: anew

    associate (unused => solver)
    end associate
    anew%t_start = model%t_start
    anew%dt = model%dt
    steps = self%step_count(model) + int(self%n_samples - self%sample, lp)*self%step_count(anew)
    exact = .true.
  end subroutine fish_random_sample_driver_plan

  !> Save which run it is, how far the table has come, and the start that other runs go back to.
  subroutine fish_random_sample_driver_save(self, store)
    !> The driver.
    class(fish_random_sample_driver_t), intent(in) :: self
    !> Where to.
    class(store_t), intent(inout) :: store
    integer :: i

    call store%put('sample', self%sample)
    call store%put('done', self%n_done)
    call self%file%save(store)
    if (.not. allocated(self%start)) return
    do i = 1, size(self%start)
      call store%enter('start_'//to_text(i - 1))
      call store%put('active', self%start(i)%active)
      call self%start(i)%points%save(store)
      call store%leave()
    end do
  end subroutine fish_random_sample_driver_save

  !> Take back which run it is, how far the table has come, and the start.
  subroutine fish_random_sample_driver_restore(self, store)
    !> The driver.
    class(fish_random_sample_driver_t), intent(inout) :: self
    !> Where from.
    class(store_t), intent(inout) :: store
    integer :: i

    call store%get('sample', self%sample)
    call store%get('done', self%n_done)
    call self%file%restore(store)
    if (.not. allocated(self%start)) return
    do i = 1, size(self%start)
      call store%enter('start_'//to_text(i - 1))
      call store%get('active', self%start(i)%active)
      call self%start(i)%points%restore(store)
      call store%leave()
    end do
  end subroutine fish_random_sample_driver_restore

end module mpm_fish_random_sample_driver
