!> What a job is about to do, for people.
module mpm_job_report
  use mpm_console, only: put_line
  use mpm_job, only: job_t
  use mpm_kinds, only: lp, wp
  use mpm_memory, only: available_memory, size_text
  use mpm_strings, only: counted, to_text
  use mpm_window, only: window_t
  implicit none
  private
  public :: report_job

contains

  !> Print sizes, memory, time step and its limits, and what will be written.
  subroutine report_job(job)
    !> The job, started.
    type(job_t), intent(in) :: job
    character(*), parameter :: kinds(5) = &
      [character(28) :: 'uniaxial strain', 'plane strain', '3D', 'axisymmetric', &
       '2D with out-of-plane motion']
    character(*), parameter :: shares(5) = &
      [character(18) :: 'm2 of section', 'm of depth', '', 'radian', 'm of depth']
    type(window_t) :: whole
    character(:), allocatable :: text
    real(wp) :: lower(3), upper(3), intervals
    integer(lp) :: steps, memory
    integer(lp) :: frames
    logical :: exact
    integer :: dim, points, i

    dim = job%model%kin%dim
    whole = job%model%grid%whole()
    call job%model%grid%bounds(lower, upper)
    call job%driver%plan(job%model, job%solver, steps, exact)
    call line('config:  '//job%config//'   TYPE '//to_text(job%model%kin%sim_type)//' ('// &
              trim(kinds(job%model%kin%sim_type))//')')
    if (len_trim(shares(job%model%kin%sim_type)) > 0) then
      call line('units:   mass, force and energy per '//trim(shares(job%model%kin%sim_type)))
    end if
    call line('grid:    '//cells_of(job, whole%n(:dim) - 1)//' cells, '//to_text(whole%size())// &
              ' nodes, '//box(lower(:dim), upper(:dim)))
    call report_bodies(job, exact)
    call line('contacts: '//to_text(size(job%model%contacts)))
    memory = job%memory()
    points = 0
    do i = 1, size(job%model%bodies)
      points = points + job%model%bodies(i)%body%points%n
    end do
    call line('memory:  '//to_text(real(memory, wp)/1.0e6_wp, 3)//' MB for points and nodes, '// &
              to_text(nint(real(memory, wp)/real(max(1, points), wp)))//' bytes a point, of '// &
              limit_text(job%model%memory_limit, memory))
    text = ' s, dt = '//to_text(job%model%dt)//' s, '//counted(steps, 'step')
    if (.not. exact) then
      text = ' s, dt at most '//to_text(job%model%dt)//' s, about '//counted(steps, 'step')
    end if
    call line('time:    t = '//to_text(job%model%t_start)//' to '//to_text(job%driver%t_stop)//text)
    frames = 1
    if (job%serializer%rate > 0.0_wp) then
      intervals = (job%driver%t_stop - job%model%t_start)*job%serializer%rate + 1.0e-6_wp
      ! Steps that are not of one length end at every frame's time.
      if (exact) intervals = min(real(steps, wp), intervals)
      frames = frames + int(max(0.0_wp, intervals), lp)
    end if
    call line('frames:  '//to_text(frames)//' in '//job%serializer%destination())
    associate (history => job%serializer%history)
      if (history%is_on()) then
        call line('history: '//to_text(history%rate)//' rows a second in '//history%file%path// &
                  ', '//counted(size(history%probes), 'probe'))
      end if
    end associate
  end subroutine report_job

  !> How much memory points and nodes may take.
  function limit_text(limit, used) result(text)
    !> Most bytes in all; 0 for what the machine has.
    integer(lp), intent(in) :: limit
    !> Bytes in use.
    integer(lp), intent(in) :: used
    !> Size and where it comes from.
    character(:), allocatable :: text

    if (limit > 0) then
      text = size_text(limit)//' (--max-memory)'
    else
      text = size_text(available_memory() + used)//' (of this machine)'
    end if
  end function limit_text

  !> A line for each body.
  subroutine report_bodies(job, fixed_step)
    !> The job, started.
    type(job_t), intent(in) :: job
    !> Whether dt is kept as it is configured.
    logical, intent(in) :: fixed_step
    character(:), allocatable :: text
    real(wp) :: speed, limit
    integer :: i

    text = ''
    do i = 1, size(job%model%bodies)
      associate (body => job%model%bodies(i)%body)
        text = 'body:    '//to_text(body%id)//' "'//body%name//'", '// &
               counted(body%points%n, 'point')
        if (body%points%n_inside < body%points%n) then
          text = text//' ('//to_text(body%points%n - body%points%n_inside)//' inactive)'
        end if
        text = text//', mass '//to_text(sum(body%points%mass(:body%points%n_inside)))//' kg'
        call job%solver%stable_step(job%model, i, speed, limit)
        if (speed > 0.0_wp) then
          text = text//', wave speed '//to_text(speed)//' m/s, stable step '//to_text(limit)//' s'
          if (fixed_step .and. job%model%dt > limit) text = text//' (BELOW dt)'
        end if
        if (.not. body%active) text = text//', not yet active'
        call line(text)
      end associate
    end do
  end subroutine report_bodies

  !> Print a line.
  subroutine line(text)
    !> The line.
    character(*), intent(in) :: text

    call put_line(text)
  end subroutine line

  !> The cells of the grid: as many in each direction, or in all on a mesh.
  pure function cells_of(job, counts) result(text)
    !> The job.
    type(job_t), intent(in) :: job
    !> Distances of the last nodes in each direction from the first one.
    integer, intent(in) :: counts(:)
    !> The text.
    character(:), allocatable :: text

    text = sizes(counts)
    if (product(counts) /= job%model%grid%cell_count()) then
      text = to_text(job%model%grid%cell_count())
    end if
  end function cells_of

  !> Counts as `20 x 30`.
  pure function sizes(counts) result(text)
    !> The counts.
    integer, intent(in) :: counts(:)
    !> The text.
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(counts)
      if (i > 1) text = text//' x '
      text = text//to_text(counts(i))
    end do
  end function sizes

  !> A box as `[0, 1] x [0, 2] m`.
  pure function box(lower, upper) result(text)
    !> Lower corner. [m]
    real(wp), intent(in) :: lower(:)
    !> Upper corner. [m]
    real(wp), intent(in) :: upper(:)
    !> The text.
    character(:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(lower)
      if (i > 1) text = text//' x '
      text = text//'['//to_text(lower(i))//', '//to_text(upper(i))//']'
    end do
    text = text//' m'
  end function box

end module mpm_job_report
