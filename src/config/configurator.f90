!> From a config to a job: sections to objects, whatever their order in the file.
module mpm_configurator
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use mpm_bodies_reader, only: read_body
  use mpm_body_list, only: find_partners
  use mpm_configurable, only: configurable_t
  use mpm_contact_registry, only: create_contact
  use mpm_description, only: description_t
  use mpm_document, only: document_t, entry_t, section_t, value_t, value_to_integer, value_to_real
  use mpm_driver_registry, only: create_driver
  use mpm_errors, only: err_input, err_usage, error_t, raise
  use mpm_grid_registry, only: create_grid
  use mpm_job, only: job_t
  use mpm_kinds, only: lp, wp
  use mpm_kinematics, only: make_kinematics
  use mpm_memory, only: memory_left
  use mpm_object_reader, only: class_of, lacks, properties_of
  use mpm_override, only: parse_override
  use mpm_parser, only: parse_text
  use mpm_probe_registry, only: create_probe
  use mpm_probe, only: probe_slot_t
  use mpm_properties, only: properties_t
  use mpm_section_reader, only: check_keys, single_value
  use mpm_serializer_registry, only: create_serializer
  use mpm_solver_registry, only: create_solver
  use mpm_store, only: store_t
  use mpm_strings, only: excerpt, nearest_name, string_t, to_text
  use mpm_text_file, only: read_whole_file
  implicit none
  private
  public :: configure

  !> Sections that a config has, in the order of the manual.
  character(10), parameter :: section_names(8) = &
    [character(10) :: 'job', 'serializer', 'driver', 'solver', 'grid', 'body', 'contact', 'probe']
  !> How many of them a config needs, and how many can be there but once: the first ones.
  integer, parameter :: n_needed = 6, n_single = 5
  !> Keys of the sections of single objects.
  character(14), parameter :: object_keys(4) = &
    [character(14) :: 'class', 'properties', 'int-properties', 'str-properties']
  !> Steps of a run that no machine would finish.
  real(wp), parameter :: most_steps = 1.0e15_wp
  !> Bytes of a config, at most: there are 20 or more for each of its words.
  integer(lp), parameter :: most_text = 64*1024*1024
  !> Keys of a contact.
  character(14), parameter :: contact_keys(5) = [object_keys, 'name          ']

contains

  !> Build a job from a config.
  subroutine configure(path, overrides, job, error, text, memory_limit, store)
    !> The config.
    character(*), intent(in) :: path
    !> Texts `section.key=value` that take the place of what the config says.
    type(string_t), intent(in) :: overrides(:)
    !> The job; its model is not started.
    type(job_t), intent(out) :: job
    !> The first thing wrong with the config or the files that it names.
    type(error_t), allocatable, intent(out) :: error
    !> Text of the config, when it is not to be read from the file.
    character(*), intent(in), optional :: text
    !> Most bytes that points and nodes may take; 0 or left out for what the machine has.
    integer(lp), intent(in), optional :: memory_limit
    !> A checkpoint, from which points are taken in place of their files.
    class(store_t), intent(inout), optional :: store
    type(document_t) :: document
    integer :: i

    job%config = path
    if (present(memory_limit)) job%model%memory_limit = memory_limit
    job%checkpoints%config = path
    job%checkpoints%overrides = overrides
    if (present(text)) then
      job%checkpoints%text = text
    else
      call read_whole_file(path, job%checkpoints%text, error, most_text)
      if (allocated(error)) return
    end if
    call parse_text(job%checkpoints%text, path, document, error)
    if (allocated(error)) return
    if (document%is_empty()) then
      call raise(error, err_input, 'the config is empty', path, &
                 hint='it needs the sections job, serializer, driver, solver, grid and body')
      return
    end if
    do i = 1, size(overrides)
      call apply_override(overrides(i)%text, document, error)
      if (allocated(error)) return
    end do
    call check_sections(document, error)
    if (allocated(error)) return
    call read_job(document, job, error)
    if (allocated(error)) return
    call read_objects(document, job, error)
    if (allocated(error)) return
    call read_all_bodies(document, job, error, store)
    if (allocated(error)) return
    call read_contacts(document, job, error)
    if (allocated(error)) return
    call read_probes(document, job, error)
  end subroutine configure

  !> Known sections, each as often as it may occur.
  subroutine check_sections(document, error)
    !> The config.
    type(document_t), intent(in) :: document
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(string_t) :: known(size(section_names))
    character(:), allocatable :: near
    integer :: i, first

    if (size(document%entries) > 0) then
      call raise(error, err_input, 'key "'//excerpt(document%entries(1)%key)// &
                 '" outside of a section', document%path, document%entries(1)%line, &
                 'keys belong between the braces of a section such as job { }')
      return
    end if
    do i = 1, size(section_names)
      known(i)%text = trim(section_names(i))
    end do
    do i = 1, size(document%sections)
      associate (section => document%sections(i))
        if (.not. any(section_names == section%name)) then
          near = nearest_name(section%name, known)
          if (len(near) > 0) then
            near = 'did you mean "'//near//'"?'
          else
            near = 'sections: job, serializer, driver, solver, grid, body, contact, probe'
          end if
          call raise(error, err_input, 'unknown section "'//excerpt(section%name)//'"', &
                     document%path, section%line, near)
          return
        end if
        first = document%find_section(section%name)
        if (first < i .and. any(section_names(:n_single) == section%name)) then
          call raise(error, err_input, 'a second section "'//section%name//'"', document%path, &
                     section%line, 'the first stands in line '// &
                     to_text(document%sections(first)%line)//'; keep one')
          return
        end if
      end associate
    end do
    do i = 1, n_needed
      if (document%find_section(trim(section_names(i))) > 0) cycle
      call raise(error, err_input, 'section "'//trim(section_names(i))//'" is missing', &
                 document%path, hint='add '//trim(section_names(i))//' { ... }')
      return
    end do
  end subroutine check_sections

  !> Section `job`.
  subroutine read_job(document, job, error)
    !> The config.
    type(document_t), intent(in) :: document
    !> The job: TYPE, times and threads are set.
    type(job_t), intent(inout) :: job
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(value_t) :: value
    integer :: sim_type
    logical :: found, valid

    associate (section => document%sections(document%find_section('job')), model => job%model)
      call check_keys(section, document%path, &
                      [character(7) :: 't', 'dt', 'TYPE', 'threads'], error)
      if (allocated(error)) return
      call single_value(section, document%path, 'dt', value, found, error)
      if (allocated(error)) return
      if (.not. found) then
        call raise(error, err_input, 'job needs "dt"', document%path, section%line, &
                   'dt is the time step in seconds, for example: dt = 1e-3')
        return
      end if
      call value_to_real(value, model%dt, error)
      if (allocated(error)) return
      ! NaN is asked for first: a comparison with it would trap where traps are on.
      valid = ieee_is_finite(model%dt)
      if (valid) valid = model%dt > 0.0_wp
      if (.not. valid) then
        call raise(error, err_input, 'dt = '//excerpt(value%text)//' is not a time step', &
                   value%file, value%line, 'dt must be a finite number above 0')
        return
      end if
      call single_value(section, document%path, 't', value, found, error)
      if (allocated(error)) return
      if (found) then
        call value_to_real(value, model%t_start, error)
        if (allocated(error)) return
        if (.not. ieee_is_finite(model%t_start)) then
          call raise(error, err_input, 't = '//excerpt(value%text)//' is not a time', value%file, &
                     value%line, 't is the start time and must be a finite number')
          return
        end if
      end if
      call single_value(section, document%path, 'TYPE', value, found, error)
      if (allocated(error)) return
      sim_type = 3
      if (found) then
        call value_to_integer(value, sim_type, error)
        if (allocated(error)) return
        if (sim_type < 1 .or. sim_type > 5) then
          call raise(error, err_input, 'TYPE = '//value%text//' does not exist', value%file, &
                     value%line, '1: uniaxial strain, 2: plane strain, 3: 3D, 4: axisymmetric, &
                     &5: 2D with out-of-plane motion')
          return
        end if
      end if
      model%kin = make_kinematics(sim_type)
      call single_value(section, document%path, 'threads', value, found, error)
      if (allocated(error)) return
      model%threads = 0
      if (.not. found) return
      call value_to_integer(value, model%threads, error)
      if (allocated(error)) return
      if (model%threads < 0 .or. model%threads > 4096) then
        call raise(error, err_input, 'threads = '//value%text//' is out of bounds', value%file, &
                   value%line, 'threads is 1 to 4096, or 0 for what OMP_NUM_THREADS says')
      end if
    end associate
  end subroutine read_job

  !> Serializer, driver, solver and grid.
  subroutine read_objects(document, job, error)
    !> The config.
    type(document_t), intent(in) :: document
    !> The job: the four objects are set up.
    type(job_t), intent(inout) :: job
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class

    associate (path => document%path, kin => job%model%kin)
      associate (section => document%sections(document%find_section('serializer')))
        call class_of(section, path, 'class', object_keys, class, error)
        if (allocated(error)) return
        call create_serializer(class%text, job%serializer, error)
        if (lacks(error, class)) return
        call job%serializer%describe(description)
        call properties_of(section, '', 'properties', description, kin%sim_type, class, &
                           properties, error)
        if (allocated(error)) return
        call job%serializer%init(properties, error)
        if (lacks(error, class)) return
      end associate
      associate (section => document%sections(document%find_section('driver')))
        call class_of(section, path, 'class', object_keys, class, error)
        if (allocated(error)) return
        call create_driver(class%text, job%driver, error)
        if (lacks(error, class)) return
        call job%driver%describe(description)
        call properties_of(section, '', 'properties', description, kin%sim_type, class, &
                           properties, error)
        if (allocated(error)) return
        call job%driver%init(properties, error)
        if (lacks(error, class)) return
        if (.not. job%driver%t_stop > job%model%t_start) then
          call properties%reject('t_stop', 'the stop time '//to_text(job%driver%t_stop)// &
                                 ' s is not after the start time '// &
                                 to_text(job%model%t_start)//' s', error, &
                                 'the first property of the driver is the stop time')
          return
        end if
        ! Halves do not overflow, and neither side is a quotient by a tiny dt.
        if (0.5_wp*job%driver%t_stop - 0.5_wp*job%model%t_start > &
            0.5_wp*most_steps*min(job%model%dt, 1.0e290_wp)) then
          call properties%reject('t_stop', 'the run would take more than '// &
                                 to_text(most_steps)//' steps', error, &
                                 'use a larger dt or an earlier stop time')
          return
        end if
      end associate
      associate (section => document%sections(document%find_section('solver')))
        call class_of(section, path, 'class', object_keys, class, error)
        if (allocated(error)) return
        call create_solver(class%text, job%solver, error)
        if (lacks(error, class)) return
        call job%solver%describe(description)
        call properties_of(section, '', 'properties', description, kin%sim_type, class, &
                           properties, error)
        if (allocated(error)) return
        call job%solver%init(properties, error)
        if (lacks(error, class)) return
      end associate
      associate (section => document%sections(document%find_section('grid')))
        call class_of(section, path, 'class', object_keys, class, error)
        if (allocated(error)) return
        call create_grid(class%text, job%model%grid, error)
        if (lacks(error, class)) return
        call job%model%grid%describe(description)
        call properties_of(section, '', 'properties', description, kin%sim_type, class, &
                           properties, error)
        if (allocated(error)) return
        call job%model%grid%init(kin, properties, error)
        if (lacks(error, class)) return
      end associate
    end associate
  end subroutine read_objects

  !> The bodies in the order of the config.
  subroutine read_all_bodies(document, job, error, store)
    !> The config.
    type(document_t), intent(in) :: document
    !> The job: the bodies are set up.
    type(job_t), intent(inout) :: job
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    !> A checkpoint, from which points are taken in place of their files.
    class(store_t), intent(inout), optional :: store
    integer(lp) :: used
    integer :: i, j, s

    used = 0
    allocate (job%model%bodies(document%count_sections('body')))
    s = 0
    do i = 1, size(job%model%bodies)
      s = document%find_section('body', s)
      call read_body(document%sections(s), document%path, i - 1, job%model%grid, &
                     memory_left(job%model%memory_limit, used), job%model%bodies(i)%body, &
                     error, store)
      if (allocated(error)) return
      used = used + job%model%bodies(i)%body%points%memory()
      do j = 1, i - 1
        if (job%model%bodies(j)%body%name == job%model%bodies(i)%body%name) then
          call raise(error, err_input, 'a second body named "'// &
                     excerpt(job%model%bodies(i)%body%name)//'"', document%path, &
                     document%sections(s)%line, 'names of bodies are unique: choose another')
          return
        end if
      end do
    end do
    call find_partners(job%model%bodies, error)
  end subroutine read_all_bodies

  !> The contacts in the order of the config.
  subroutine read_contacts(document, job, error)
    !> The config.
    type(document_t), intent(in) :: document
    !> The job: the contacts are set up.
    type(job_t), intent(inout) :: job
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(value_t) :: class, name
    integer :: i, s
    logical :: found

    allocate (job%model%contacts(document%count_sections('contact')))
    s = 0
    do i = 1, size(job%model%contacts)
      s = document%find_section('contact', s)
      associate (section => document%sections(s), slot => job%model%contacts(i))
        call class_of(section, document%path, 'class', contact_keys, class, error)
        if (allocated(error)) return
        call single_value(section, document%path, 'name', name, found, error)
        if (allocated(error)) return
        call create_contact(class%text, slot%contact, error)
        if (lacks(error, class)) return
        slot%contact%name = name%text
        call slot%contact%describe(description)
        call properties_of(section, '', 'properties', description, job%model%kin%sim_type, class, &
                           properties, error)
        if (allocated(error)) return
        call slot%contact%init(job%model%grid, job%model%bodies, properties, error)
        if (lacks(error, class)) return
      end associate
    end do
  end subroutine read_contacts

  !> The probes in the order of the config.
  subroutine read_probes(document, job, error)
    !> The config.
    type(document_t), intent(in) :: document
    !> The job: the probes of its history are set up.
    type(job_t), intent(inout) :: job
    !> The first thing wrong.
    type(error_t), allocatable, intent(out) :: error
    type(description_t) :: description
    type(properties_t) :: properties
    type(probe_slot_t), allocatable :: probes(:)
    type(value_t) :: class, name
    integer :: i, j, s
    logical :: found

    allocate (probes(document%count_sections('probe')))
    s = 0
    do i = 1, size(probes)
      s = document%find_section('probe', s)
      associate (section => document%sections(s), slot => probes(i))
        call class_of(section, document%path, 'class', contact_keys, class, error)
        if (allocated(error)) return
        call single_value(section, document%path, 'name', name, found, error)
        if (allocated(error)) return
        call create_probe(class%text, slot%probe, error)
        if (lacks(error, class)) return
        if (.not. found) then
          call raise(error, err_input, 'a probe needs a "name"', document%path, section%line, &
                     'its columns in the history have it: name = "tip"')
          return
        end if
        slot%probe%name = name%text
        do j = 1, i - 1
          if (probes(j)%probe%name /= name%text) cycle
          call raise(error, err_input, 'a second probe named "'//excerpt(name%text)//'"', &
                     name%file, name%line, 'names of probes are unique: choose another')
          return
        end do
        call slot%probe%describe(description)
        call properties_of(section, '', 'properties', description, job%model%kin%sim_type, class, &
                           properties, error)
        if (allocated(error)) return
        call slot%probe%init(job%model%grid, job%model%bodies, properties, error)
        if (lacks(error, class)) return
        if (job%serializer%history%is_on()) cycle
        call raise(error, err_input, 'a probe writes to the history, and there is none', &
                   class%file, class%line, 'give the serializer a history_rate, for example &
                   &properties = {60, history_rate = 1000}')
        return
      end associate
    end do
    call move_alloc(probes, job%serializer%history%probes)
  end subroutine read_probes

  !> Put the values of an override in place of those of the config.
  subroutine apply_override(text, document, error)
    !> `section.key=value`.
    character(*), intent(in) :: text
    !> The config.
    type(document_t), intent(inout) :: document
    !> No such section, or bad syntax.
    type(error_t), allocatable, intent(out) :: error
    character(:), allocatable :: selector, key
    type(value_t), allocatable :: values(:)
    integer :: s, e

    call parse_override(text, selector, key, values, error)
    if (allocated(error)) return
    call select_section(document, selector, s)
    if (s == 0) then
      call raise(error, err_usage, '--set '//excerpt(text, 80)//': the config has no section "'// &
                 excerpt(selector)//'"', &
                 hint='write section.key=value; a body or contact is body.NAME or body.NUMBER')
      return
    end if
    associate (section => document%sections(s))
      e = section%find(key)
      if (e == 0) then
        call append_entry(section%entries, key, section%line)
        e = size(section%entries)
      end if
      call move_alloc(values, section%entries(e)%values)
      section%entries(e)%file = '--set '//excerpt(text, 80)
      section%entries(e)%line = 0
    end associate
  end subroutine apply_override

  !> The section that a selector means: `grid`, `body.block_0` or `body.0`.
  subroutine select_section(document, selector, s)
    !> The config.
    type(document_t), intent(in) :: document
    !> Section, perhaps with a point and a name or number from 0.
    character(*), intent(in) :: selector
    !> Its position, or 0.
    integer, intent(out) :: s
    character(:), allocatable :: name, which
    type(value_t) :: value
    type(error_t), allocatable :: error
    integer :: dot, number
    logical :: found

    dot = index(selector, '.')
    if (dot == 0) then
      s = document%find_section(selector)
      if (document%count_sections(selector) > 1) s = 0
      return
    end if
    name = selector(:dot - 1)
    which = selector(dot + 1:)
    number = 0
    s = document%find_section(name)
    do while (s > 0)
      call single_value(document%sections(s), document%path, 'name', value, found, error)
      if (found .and. value%text == which) return
      if (to_text(number) == which) return
      number = number + 1
      s = document%find_section(name, s)
    end do
  end subroutine select_section

  !> Append an entry without values.
  subroutine append_entry(entries, key, line)
    !> The entries.
    type(entry_t), allocatable, intent(inout) :: entries(:)
    !> Key of the new one.
    character(*), intent(in) :: key
    !> Its line.
    integer, intent(in) :: line
    type(entry_t), allocatable :: longer(:)

    allocate (longer(size(entries) + 1))
    longer(:size(entries)) = entries
    longer(size(longer))%key = key
    longer(size(longer))%line = line
    allocate (longer(size(longer))%values(0))
    call move_alloc(longer, entries)
  end subroutine append_entry

end module mpm_configurator
