!> The properties of ImprovedQuadraturePoints: a quadrature rule and a position rule.
!!
!! mpm_3d reads them by position, in an order that depends on the rules and the flags. That order is
!! kept for entries without a name; every one of them has a name, too.
module mpm_quadrature_settings
  use mpm_description, only: description_t
  use mpm_errors, only: error_t
  use mpm_kinds, only: wp
  use mpm_properties, only: properties_t
  use mpm_strings, only: excerpt, nearest_name, string_t, to_text
  implicit none
  private
  public :: add_quadrature_properties, quadrature_settings_t
  public :: avoid_a_void, newton_shift, no_correction, speed_shift, sph_shift, strain_shift

  !> Position rules, as a config numbers them.
  integer, parameter :: no_correction = 0, avoid_a_void = 1, sph_shift = 2, strain_shift = 3, &
                        speed_shift = 4, newton_shift = 5

  !> Names of the reals.
  character(14), parameter :: real_names(11) = &
    [character(14) :: 'scale', 'r', 'merge', 'buffer', 'C', 'h', 'alpha', 'tolerance', &
     'wall_buffer', 'velocity_limit', 'strain_limit']
  !> Positions in `real_names`.
  integer, parameter :: at_scale = 1, at_r = 2, at_merge = 3, at_buffer = 4, at_c = 5, at_h = 6, &
                        at_alpha = 7, at_tolerance = 8, at_wall = 9, at_velocity = 10, &
                        at_strain = 11
  !> The reals of each position rule in the order of entries without names, then 0. (3, rule)
  integer, parameter :: rule_reals(3, 0:5) = reshape( &
                        [0, 0, 0, at_r, at_merge, at_buffer, at_r, at_c, 0, at_h, at_alpha, 0, &
                         at_h, at_alpha, 0, at_h, at_alpha, at_tolerance], [3, 6])
  !> Values of reals that need not be given; those below 0 must be given where a rule asks for them.
  real(wp), parameter :: defaults(11) = [1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, &
                                         -1.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
  !> Reals that may be 0.
  logical, parameter :: may_vanish(11) = [.false., .false., .true., .true., .true., .false., &
                                          .true., .true., .true., .false., .false.]
  !> Flags.
  character(22), parameter :: flag_names(5) = &
    [character(22) :: 'X_PERIODIC', 'USE_WALL_BUFFER', 'NO_VELOCITY_CORRECTION', &
     'USE_VELOCITY_LIMITER', 'USE_STRAIN_LIMITER']
  !> Position rules that know each flag. (rule, flag)
  logical, parameter :: flag_rules(0:5, 5) = reshape( &
    [.false., .true., .true., .true., .true., .true., .false., .true., .true., .true., .true., &
     .true., .false., .false., .true., .true., .true., .true., .false., .false., .false., .false., &
     .false., .true., .false., .false., .false., .false., .false., .true.], [6, 5])
  !> The real that belongs to each flag, or 0.
  integer, parameter :: flag_reals(5) = [0, at_wall, 0, at_velocity, at_strain]

  !> The quadrature rule, the position rule and their numbers.
  type :: quadrature_settings_t
    !> 0 standard, 1 uGIMP, 2 cpGIMP, 3 CPDI, 4 CPDI2.
    integer :: quadrature = 0
    !> Side of the boxes of quadrature 1 over that of the cube of the point's volume.
    real(wp) :: scale = 1.0_wp
    !> Folder for the corners of the boxes; empty when there is none.
    character(:), allocatable :: folder
    !> Position rule.
    integer :: rule = no_correction
    !> Steps from one correction to the next, rules 1 and 2.
    integer :: skip = 1
    !> Most iterations in a step, rule 5.
    integer :: max_iterations = 10
    !> Selects a sequence of random directions, rule 1.
    integer :: seed = 0
    !> Radius of a point, rules 1 and 2. [m]
    real(wp) :: r = 0.0_wp
    !> Distance over r below which two points are merged, rule 1.
    real(wp) :: merge = 0.0_wp
    !> Points in reserve over the points of the table, rule 1.
    real(wp) :: buffer = 0.0_wp
    !> Factor of the shift, rule 2.
    real(wp) :: c = 0.0_wp
    !> Length of the grid, rules 3 to 5. [m]
    real(wp) :: h = 0.0_wp
    !> Factor of the shift, rules 3 to 5.
    real(wp) :: alpha = 0.0_wp
    !> Overshoot at which the iteration ends, rule 5.
    real(wp) :: tolerance = 0.0_wp
    !> Distance from the walls within which no point is moved or inserted. [m]
    real(wp) :: wall_buffer = 0.0_wp
    !> Keep points away from walls.
    logical :: keeps_off_walls = .false.
    !> The config says that the grid is periodic along x.
    logical :: x_periodic = .false.
    !> Points that are moved take the velocity of the field there.
    logical :: corrects_velocity = .true.
    !> Longest shift over the way of the point in the step; 0 without a limit.
    real(wp) :: velocity_limit = 0.0_wp
    !> Longest shift over the strain of the point's box in the step; 0 without a limit.
    real(wp) :: strain_limit = 0.0_wp
  contains
    !> Take all numbers from the properties.
    procedure :: read => quadrature_settings_read
    procedure, private :: read_integers
    procedure, private :: read_flags
    procedure, private :: read_reals
    procedure, private :: take_reals
  end type quadrature_settings_t

contains

  !> Describe the properties.
  subroutine add_quadrature_properties(description)
    !> The description, started.
    type(description_t), intent(inout) :: description

    call add_reals(description)
    call description%add_integer('quadrature', '0: functions at the point; 1: uGIMP; 2: cpGIMP; 3: &
                                 &CPDI; 4: CPDI2', lower=0, upper=4)
    call description%add_integer('position', '0: positions as they are; 1: avoid-a-void; 2: shift &
                                 &as in SPH; 3, 4, 5: delta-correction by strain, by displacement, &
                                 &by Newton''s method', default=no_correction, lower=0, upper=5)
    call description%add_integer('skip', 'rules 1, 2: steps from one correction to the next', &
                                 default=1, lower=1, by_name=.true.)
    call description%add_integer('max_iterations', 'rule 5: most iterations in a step', &
                                 default=10, lower=1, by_name=.true.)
    call description%add_integer('remember_element', 'accepted as in mpm_3d; has no effect on &
                                 &Cartesian grids', default=0, lower=0, upper=1, by_name=.true.)
    call description%add_integer('seed', 'rule 1: selects the random directions', default=0, &
                                 by_name=.true.)
    call description%add_integer('integers', 'entries without names: skip (position rules 1, 2) or &
                                 &max_iterations (rule 5), then remember_element', is_list=.true.)
    call description%add_string('output_folder', 'folder for the corners of the points'' boxes, &
                                &quadratures 1 to 4; without it they are not written', default='')
    call description%add_string('flags', 'X_PERIODIC: the grid must be periodic along x (rules 1 &
                                &to 5); USE_WALL_BUFFER: corrections stay off walls (1 to 5); &
                                &NO_VELOCITY_CORRECTION: points keep their velocity when they are &
                                &moved (2 to 5); USE_VELOCITY_LIMITER, USE_STRAIN_LIMITER: bounds &
                                &of the shift (5)', is_list=.true.)
  end subroutine add_quadrature_properties

  !> Describe the reals.
  subroutine add_reals(description)
    !> The description, started.
    type(description_t), intent(inout) :: description

    call description%add_real('scale', '-', 'quadrature 1: side of a box over that of the cube of &
                              &the point''s volume', default=1.0_wp, above=0.0_wp, by_name=.true.)
    call description%add_real('r', 'm', 'rules 1, 2: radius of a point', default=-1.0_wp, &
                              above=0.0_wp, by_name=.true.)
    call description%add_real('merge', '-', 'rule 1: points closer than merge r become one', &
                              default=-1.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_real('buffer', '-', 'rule 1: points in reserve, over the number of points &
                              &of the table', default=-1.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_real('C', '-', 'rule 2: factor of the shift', default=-1.0_wp, &
                              lower=0.0_wp, by_name=.true.)
    call description%add_real('h', 'm', 'rules 3, 4: length of the shift, the spacing of the grid; &
                              &rule 5: longest shift', default=-1.0_wp, above=0.0_wp, &
                              by_name=.true.)
    call description%add_real('alpha', '-', 'rules 3, 4, 5: factor of the shift', &
                              default=-1.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_real('tolerance', '-', 'rule 5: overshoot of a node that needs no shift', &
                              default=-1.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_real('wall_buffer', 'm', 'distance from walls that corrections keep; &
                              &rule 2: r', default=0.0_wp, lower=0.0_wp, by_name=.true.)
    call description%add_real('velocity_limit', '-', 'rule 5: longest shift over |v| dt', &
                              default=1.0_wp, above=0.0_wp, by_name=.true.)
    call description%add_real('strain_limit', '-', 'rule 5: longest shift over |L| dt V^(1/d)', &
                              default=1.0_wp, above=0.0_wp, by_name=.true.)
    call description%add_real('reals', '-', 'entries without names: scale (quadrature 1, whenever &
                              &there are such entries); those of the position rule: r, merge, &
                              &buffer (1), r, C (2), h, alpha (3, 4), h, alpha, tolerance (5); &
                              &then one for each flag that takes one, in the order of the flags', &
                              is_list=.true.)
  end subroutine add_reals

  !> Take all numbers from the properties.
  subroutine quadrature_settings_read(self, properties, error)
    !> The settings.
    class(quadrature_settings_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Entries that the rules do not ask for, or that are missing.
    type(error_t), allocatable, intent(out) :: error
    integer, allocatable :: sequence(:)

    self%quadrature = properties%integer('quadrature')
    self%rule = properties%integer('position')
    self%folder = properties%string('output_folder')
    self%seed = properties%integer('seed')
    call self%read_integers(properties, error)
    if (.not. allocated(error)) call self%read_flags(properties, sequence, error)
    if (.not. allocated(error)) call self%read_reals(properties, sequence, error)
  end subroutine quadrature_settings_read

  !> Take the integers behind the two rules.
  subroutine read_integers(self, properties, error)
    !> The settings.
    class(quadrature_settings_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Entries that the rule does not ask for.
    type(error_t), allocatable, intent(out) :: error
    character(16) :: names(2)
    integer, allocatable :: values(:)
    integer :: i, n
    logical :: is_flag

    n = 1
    names(1) = 'remember_element'
    if (self%rule == avoid_a_void .or. self%rule == sph_shift .or. self%rule == newton_shift) then
      n = 2
      names(2) = names(1)
      names(1) = merge('max_iterations', 'skip          ', self%rule == newton_shift)
    end if
    if (properties%given('skip') .and. names(1) /= 'skip') then
      call reject_stranger(properties, 'skip', 'position rules 1 and 2', error)
    else if (properties%given('max_iterations') .and. names(1) /= 'max_iterations') then
      call reject_stranger(properties, 'max_iterations', 'position rule 5', error)
    else if (properties%given('seed') .and. self%rule /= avoid_a_void) then
      call reject_stranger(properties, 'seed', 'position rule 1', error)
    end if
    if (allocated(error)) return
    self%skip = properties%integer('skip')
    self%max_iterations = properties%integer('max_iterations')
    allocate (values, source=properties%integers('integers'))
    if (size(values) > n) then
      call properties%reject('integers', to_text(size(values) + 2)//' integers without names, but &
                             &these rules take at most '//to_text(n + 2), error, &
                             'in this order: quadrature, position'//list_of(names(:n)))
      return
    end if
    do i = 1, size(values)
      is_flag = names(i) == 'remember_element'
      if (properties%given(trim(names(i)))) then
        call reject_twice(properties, 'integers', trim(names(i)), error)
      else if (values(i) < merge(0, 1, is_flag) .or. (is_flag .and. values(i) > 1)) then
        call properties%reject('integers', trim(names(i))//' = '//to_text(values(i))//' is out of &
                               &bounds', error, 'in this order: quadrature, position'// &
                               list_of(names(:n)))
      end if
      if (allocated(error)) return
      if (names(i) == 'skip') self%skip = values(i)
      if (names(i) == 'max_iterations') self%max_iterations = values(i)
    end do
  end subroutine read_integers

  !> Take the flags, and find the order of the reals.
  subroutine read_flags(self, properties, sequence, error)
    !> The settings.
    class(quadrature_settings_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The reals that these rules and flags take, as positions in the list of names.
    integer, allocatable, intent(out) :: sequence(:)
    !> A flag that there is not, or that the rule does not know.
    type(error_t), allocatable, intent(out) :: error
    type(string_t), allocatable :: flags(:)
    integer :: i, k

    allocate (sequence(0))
    if (self%quadrature == 1) sequence = [at_scale]
    sequence = [sequence, pack(rule_reals(:, self%rule), rule_reals(:, self%rule) > 0)]
    if (any([(flag_names(k) == self%folder, k=1, size(flag_names))])) then
      call properties%reject('output_folder', 'the first string is the output folder, not a flag', &
                             error, '{"", "'//self%folder//'"}   or   {flags = "'// &
                             self%folder//'"}')
      return
    end if
    call properties%strings('flags', flags)
    do i = 1, size(flags)
      do k = size(flag_names), 1, -1
        if (flag_names(k) == flags(i)%text) exit
      end do
      call check_flag(self%rule, properties, flags(i)%text, k, error)
      if (allocated(error)) return
      if (k == 1) self%x_periodic = .true.
      if (k == 2) self%keeps_off_walls = .true.
      if (k == 3) self%corrects_velocity = .false.
      if (k == 4) self%velocity_limit = defaults(at_velocity)
      if (k == 5) self%strain_limit = defaults(at_strain)
      if (flag_reals(k) == 0 .or. (k == 2 .and. self%rule == sph_shift)) cycle
      if (all(sequence /= flag_reals(k))) sequence = [sequence, flag_reals(k)]
    end do
  end subroutine read_flags

  !> Refuse a flag that there is not, or that the rule does not know.
  subroutine check_flag(rule, properties, flag, k, error)
    !> Position rule.
    integer, intent(in) :: rule
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The flag.
    character(*), intent(in) :: flag
    !> Its position in the list of flags, or 0.
    integer, intent(in) :: k
    !> What is wrong with it.
    type(error_t), allocatable, intent(inout) :: error
    type(string_t) :: known(size(flag_names))
    character(:), allocatable :: near
    integer :: i

    if (k == 0) then
      do i = 1, size(flag_names)
        known(i)%text = trim(flag_names(i))
      end do
      near = nearest_name(flag, known)
      if (len(near) > 0) near = 'did you mean "'//near//'"?   '
      call properties%reject('flags', 'there is no flag "'//excerpt(flag)//'"', error, &
                             near//'(mpm3d --describe ImprovedQuadraturePoints)')
    else if (.not. flag_rules(rule, k)) then
      call reject_stranger(properties, 'flags', 'other position rules than '//to_text(rule), &
                           error, flag)
    end if
  end subroutine check_flag

  !> Take the reals.
  subroutine read_reals(self, properties, sequence, error)
    !> The settings.
    class(quadrature_settings_t), intent(inout) :: self
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The reals that rules and flags take, in order.
    integer, intent(in) :: sequence(:)
    !> Entries that are missing, given twice or not asked for.
    type(error_t), allocatable, intent(out) :: error
    real(wp), allocatable :: in_order(:)
    real(wp) :: values(size(real_names))
    logical :: by_name(size(real_names))
    integer :: i, k

    allocate (in_order, source=properties%reals('reals'))
    values = defaults
    do k = 1, size(real_names)
      by_name(k) = properties%given(trim(real_names(k)))
      if (by_name(k)) values(k) = properties%real(trim(real_names(k)))
      if (.not. by_name(k) .or. any(sequence == k) .or. takes_by_name(self%rule, k)) cycle
      call reject_stranger(properties, trim(real_names(k)), 'other rules', error)
      return
    end do
    if (size(in_order) > size(sequence)) then
      call properties%reject('reals', to_text(size(in_order))//' reals without names, but these &
                             &rules and flags take '//to_text(size(sequence)), error, &
                             order_hint(sequence))
      return
    end if
    do i = 1, size(in_order)
      k = sequence(i)
      if (by_name(k)) then
        call reject_twice(properties, 'reals', trim(real_names(k)), error)
        return
      end if
      values(k) = in_order(i)
      if (values(k) > 0.0_wp .or. (may_vanish(k) .and. values(k) >= 0.0_wp)) cycle
      call properties%reject('reals', trim(real_names(k))//' = '//to_text(values(k))//' is out of &
                             &bounds: '//trim(merge('at least 0', 'above 0   ', may_vanish(k))), &
                             error, order_hint(sequence))
      return
    end do
    do i = 1, size(sequence)
      k = sequence(i)
      if (values(k) >= 0.0_wp) cycle
      call properties%reject('reals', 'position rule '//to_text(self%rule)//' needs "'// &
                             trim(real_names(k))//'" in its list of reals', error, &
                             order_hint(sequence))
      return
    end do
    call self%take_reals(values, by_name)
  end subroutine read_reals

  !> Whether a real may be given by its name without the flag that it belongs to.
  pure function takes_by_name(rule, k) result(takes)
    !> Position rule.
    integer, intent(in) :: rule
    !> Position in the list of names.
    integer, intent(in) :: k
    !> Whether it may.
    logical :: takes
    integer :: f

    takes = .false.
    do f = 1, size(flag_reals)
      if (flag_reals(f) == k) takes = flag_rules(rule, f)
    end do
  end function takes_by_name

  !> Keep the reals; a bound that is given by name is used, with or without its flag.
  pure subroutine take_reals(self, values, by_name)
    !> The settings, with flags.
    class(quadrature_settings_t), intent(inout) :: self
    !> Values or defaults of all reals.
    real(wp), intent(in) :: values(:)
    !> Whether they are given by their names.
    logical, intent(in) :: by_name(:)

    self%scale = values(at_scale)
    self%r = values(at_r)
    self%merge = values(at_merge)
    self%buffer = values(at_buffer)
    self%c = values(at_c)
    self%h = values(at_h)
    self%alpha = values(at_alpha)
    self%tolerance = values(at_tolerance)
    self%wall_buffer = values(at_wall)
    if (self%rule == sph_shift .and. .not. by_name(at_wall)) self%wall_buffer = self%r
    self%keeps_off_walls = self%keeps_off_walls .or. by_name(at_wall)
    if (self%velocity_limit > 0.0_wp .or. by_name(at_velocity)) then
      self%velocity_limit = values(at_velocity)
    end if
    if (self%strain_limit > 0.0_wp .or. by_name(at_strain)) self%strain_limit = values(at_strain)
  end subroutine take_reals

  !> Names behind one another, each with a comma in front.
  pure function list_of(names) result(text)
    !> The names.
    character(*), intent(in) :: names(:)
    !> The text.
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(names)
      text = text//', '//trim(names(i))
    end do
  end function list_of

  !> The order of the reals in words.
  pure function order_hint(sequence) result(text)
    !> The reals, as positions in the list of names.
    integer, intent(in) :: sequence(:)
    !> One line.
    character(:), allocatable :: text

    if (size(sequence) == 0) then
      text = 'these rules take no reals'
    else
      text = list_of(real_names(sequence))
      text = 'in this order: '//text(3:)//'; or by name: {'// &
             trim(real_names(sequence(size(sequence))))//' = ...}'
    end if
    text = text//'   (mpm3d --describe ImprovedQuadraturePoints)'
  end function order_hint

  !> Refuse an entry that belongs to other rules.
  subroutine reject_stranger(properties, name, owners, error, flag)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> Name of the entry.
    character(*), intent(in) :: name
    !> Where it belongs.
    character(*), intent(in) :: owners
    !> The error to fill.
    type(error_t), allocatable, intent(inout) :: error
    !> The flag that is meant; `name` when left out.
    character(*), intent(in), optional :: flag
    character(:), allocatable :: shown

    shown = name
    if (present(flag)) shown = flag
    call properties%reject(name, '"'//shown//'" is for '//owners, error, 'remove it, or choose &
                           &another rule   (mpm3d --describe ImprovedQuadraturePoints)')
  end subroutine reject_stranger

  !> Refuse an entry that is given by name and by position.
  subroutine reject_twice(properties, list, name, error)
    !> Checked properties.
    type(properties_t), intent(in) :: properties
    !> The list of entries by position.
    character(*), intent(in) :: list
    !> Name of the entry.
    character(*), intent(in) :: name
    !> The error to fill.
    type(error_t), allocatable, intent(inout) :: error

    call properties%reject(list, 'property "'//name//'" is given twice', error, &
                           'keep either the positional or the named entry')
  end subroutine reject_twice

end module mpm_quadrature_settings
