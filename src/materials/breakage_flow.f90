!> The plastic step of breakage mechanics: from a trial state to the yield surface.
!!
!! The flow is followed in pieces, each with the direction at its start, over which B and the
!! porosity change little. Where the surface is near there is one piece, and the multiplier at which
!! the yield is 0 is found by inverse interpolation, for many points in step; the few points that
!! this does not find are done one by one.
module mpm_breakage_flow
  use mpm_bracket, only: bracket_t
  use mpm_breakage, only: breakage_t, n_level, n_state, of_c, of_es, of_ev, of_free, of_j, of_s, &
                          of_y, width
  use mpm_breakage_ray, only: direct, move, n_ray, of_far, slopes
  use mpm_kinds, only: wp
  implicit none
  private
  public :: flow

  !> Yield up to which a state counts as elastic.
  real(wp), parameter :: tolerance = 1.0e-11_wp
  !> Values in step of a search.
  integer, parameter :: lockstep = 5
  !> Elastic strain, over that of the trial state, that counts as none.
  real(wp), parameter :: vanished = 1.0e-8_wp
  !> Size of the shear part of Be, which is near 1, that is lost in rounding, and over that of all
  !! strain: squared, as it is in the yield, it is less than the tolerance.
  real(wp), parameter :: unresolved = 4.0_wp*epsilon(1.0_wp), slight = 1.0e-10_wp
  !> Directions of flow until a step counts as failed.
  integer, parameter :: patience = 2000

contains

  !> Bring trial states back to the yield surface along directions of flow.
  !!
  !! In each piece all points that flow are treated in step, then those that need another one.
  pure subroutine flow(law, n, state, level, good)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> Number of states, at most `width`.
    integer, intent(in) :: n
    !> The states, trial ones on entry.
    real(wp), intent(inout) :: state(width, n_state)
    !> What is known of them; on exit only what the stress is made of, and the yield.
    real(wp), intent(inout) :: level(width, n_level)
    !> Whether a state was found. (n)
    logical, intent(out) :: good(n)
    integer, parameter :: used(4) = [of_y, of_ev, of_s, of_c]
    real(wp) :: from(width, n_state), known(width, n_level), next(width, n_state)
    real(wp) :: rest(width, n_level), ray(width, n_ray), start(n)
    integer :: list(n), hit(n), keep(n), m, c, i, k, hits, left, piece
    logical :: found(n), lost(n)

    good = .true.
    m = 0
    do i = 1, n
      if (.not. level(i, of_y) > tolerance) cycle
      m = m + 1
      list(m) = i
    end do
    start = strain2(level(:n, of_j), level(:n, of_ev))
    call take(n_state, n, m, list, state, from)
    call take(n_level, n, m, list, level, known)
    do piece = 1, patience
      if (m == 0) return
      call search(law, m, from, known, ray, next, found(:m), lost(:m))
      hits = 0
      left = 0
      do k = 1, m
        if (found(k)) then
          hits = hits + 1
          hit(hits) = k
        else if (piece < patience .and. lost(k) .and. &
                 .not. faint(known(k, of_j), known(k, of_ev), start(list(k)))) then
          left = left + 1
          keep(left) = k
        else
          i = list(k)
          call flow_alone(law, start(i), k, from, i, state, level, good(i))
        end if
      end do
      if (hits == n) then
        state(:n, :) = next(:n, :)
        do c = 1, size(used)
          level(:n, used(c)) = known(:n, used(c))
        end do
        return
      end if
      do c = 1, n_state
        do k = 1, hits
          state(list(hit(k)), c) = next(hit(k), c)
        end do
      end do
      do c = 1, size(used)
        do k = 1, hits
          level(list(hit(k)), used(c)) = known(hit(k), used(c))
        end do
      end do
      call take(n_state, m, left, keep, next, from)
      if (left < m) then
        call take(n_level, m, left, keep, known, rest)
        known(:left, :) = rest(:left, :)
      end if
      list(:left) = list(keep(:left))
      m = left
    end do
  end subroutine flow

  !> Take rows of an array.
  pure subroutine take(columns, n, m, list, source, rows)
    !> Number of columns.
    integer, intent(in) :: columns
    !> Number of rows there are.
    integer, intent(in) :: n
    !> Number of rows to take.
    integer, intent(in) :: m
    !> The rows.
    integer, intent(in) :: list(m)
    !> The array.
    real(wp), intent(in) :: source(width, columns)
    !> The rows, one after the other.
    real(wp), intent(out) :: rows(width, columns)
    integer :: c, k

    do c = 1, columns
      if (m == n) then
        rows(:n, c) = source(:n, c)
      else
        do k = 1, m
          rows(k, c) = source(list(k), c)
        end do
      end if
    end do
  end subroutine take

  !> Square of the size of the elastic strain Be - I.
  elemental function strain2(j, ev) result(square)
    !> J.
    real(wp), intent(in) :: j
    !> ev.
    real(wp), intent(in) :: ev
    !> The square.
    real(wp) :: square

    square = 4.0_wp*(j + ev**2/3.0_wp)
  end function strain2

  !> Whether there is so little strain, or shear, that it counts as none.
  pure function faint(j, ev, start)
    !> J.
    real(wp), intent(in) :: j
    !> ev.
    real(wp), intent(in) :: ev
    !> Square of the size of the strain of the trial state.
    real(wp), intent(in) :: start
    !> Whether it is.
    logical :: faint

    faint = strain2(j, ev) < vanished**2*start .or. &
            4.0_wp*j <= max(unresolved**2, slight**2*strain2(j, ev))
  end function faint

  !> Bring one state back, in as many pieces as it takes.
  pure subroutine flow_alone(law, start, k, from, i, states, levels, good)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> Square of the size of the strain of the trial state.
    real(wp), intent(in) :: start
    !> Its row in `from`.
    integer, intent(in) :: k
    !> States of which it is one.
    real(wp), intent(in) :: from(width, n_state)
    !> Its row in `states` and `levels`.
    integer, intent(in) :: i
    !> States, of which one is set.
    real(wp), intent(inout) :: states(width, n_state)
    !> What is known of them.
    real(wp), intent(inout) :: levels(width, n_level)
    !> Whether a state was found.
    logical, intent(out) :: good
    real(wp) :: state(width, n_state), level(width, n_level), next(width, n_state), shear
    logical :: found
    integer :: piece

    state(1, :) = from(k, :)
    good = .true.
    do piece = 1, patience
      call law%evaluate(1, state, level)
      shear = 2.0_wp*sqrt(level(1, of_j))
      if (level(1, of_y) <= tolerance) then
        exit
      else if (strain2(level(1, of_j), level(1, of_ev)) < vanished**2*start) then
        ! Contraction has taken all of the pressure, and with it the strength.
        state(1, :6) = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      else if (shear > 0.0_wp .and. faint(level(1, of_j), level(1, of_ev), start)) then
        ! Hardly any pressure, and one unit in the last place of shear is more than it bears, or
        ! hardly any shear, of which each piece would take a half.
        state(1, :3) = sum(state(1, :3))/3.0_wp
        state(1, 4:6) = 0.0_wp
      else
        call follow(law, state, level, next, found)
        state(1, :) = next(1, :)
        if (found) exit
      end if
      good = piece < patience
    end do
    states(i, :) = state(1, :)
    levels(i, :) = level(1, :)
  end subroutine flow_alone

  !> Go along a direction of flow to the yield surface, or as far as it may be followed.
  pure subroutine follow(law, state, level, next, found)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> The state.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of it, and of the next one on exit.
    real(wp), intent(inout) :: level(width, n_level)
    !> The state there.
    real(wp), intent(out) :: next(width, n_state)
    !> Whether it does not yield.
    logical, intent(out) :: found
    real(wp) :: ray(width, n_ray), start
    logical :: at_once(1), lost(1)
    type(bracket_t) :: bracket

    start = level(1, of_y)
    call search(law, 1, state, level, ray, next, at_once, lost)
    found = at_once(1)
    if (found) return
    if (.not. lost(1)) call try(law, state, ray, ray(1, of_far), next, level)
    found = level(1, of_y) <= tolerance
    if (.not. found) return
    call bracket%start(0.0_wp, start, ray(1, of_far), min(level(1, of_y), -tolerance))
    do while (.not. bracket%done .and. bracket%n < 200)
      call try(law, state, ray, bracket%x, next, level)
      if (abs(level(1, of_y)) <= tolerance) exit
      call bracket%take(level(1, of_y))
    end do
    ! Strains near nothing have too few digits for the tolerance: the end that does not yield.
    if (level(1, of_y) > tolerance) call try(law, state, ray, bracket%b, next, level)
  end subroutine follow

  !> One state some way along its direction of flow.
  pure subroutine try(law, state, ray, way, next, level)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> The state.
    real(wp), intent(in) :: state(width, n_state)
    !> Its direction of flow.
    real(wp), intent(in) :: ray(width, n_ray)
    !> The multiplier.
    real(wp), intent(in) :: way
    !> The state there.
    real(wp), intent(inout) :: next(width, n_state)
    !> What is known of it.
    real(wp), intent(inout) :: level(width, n_level)
    real(wp) :: x(width)

    x(1) = way
    call move(1, state, ray, x, next)
    call law%evaluate(1, next, level)
  end subroutine try

  !> Look for the yield surface along the directions of flow: Newton's rule, and then inverse
  !! interpolation of all values, those of y/sqrt(1 + y/4), which is straighter than y under shear.
  pure subroutine search(law, n, state, level, ray, next, found, lost)
    !> Constants.
    class(breakage_t), intent(in) :: law
    !> Number of states.
    integer, intent(in) :: n
    !> The states.
    real(wp), intent(in) :: state(width, n_state)
    !> What is known of them, and of the next ones on exit.
    real(wp), intent(inout) :: level(width, n_level)
    !> Their directions of flow.
    real(wp), intent(out) :: ray(width, n_ray)
    !> The states on the surface, where they are found.
    real(wp), intent(out) :: next(width, n_state)
    !> Whether they are found. (n)
    logical, intent(out) :: found(n)
    !> Whether the next states are at the ends of the ways that may be followed, and yield. (n)
    logical, intent(out) :: lost(n)
    real(wp) :: path(width, 3), slope(width), x(width), y(width, -1:lockstep)
    real(wp) :: column(width, 0:lockstep), fresh(width), way, apart, ahead
    integer :: i, j, k

    call direct(law, n, state, level, ray, path)
    call slopes(law, n, state, level, ray, path, slope)
    do i = 1, n
      y(i, 0) = level(i, of_y)/sqrt(1.0_wp + 0.25_wp*level(i, of_y))
      y(i, -1) = y(i, 0)
      ! Without a slope the way is beyond the largest one.
      way = level(i, of_y)*((1.0_wp + 0.25_wp*level(i, of_y))/(1.0_wp + 0.125_wp*level(i, of_y)))
      way = way/max(-slope(i), 0.5_wp*way/ray(i, of_far))
      x(i) = min(way, ray(i, of_far))
      column(i, 0) = 0.0_wp
      column(i, 1) = way
    end do
    do k = 1, lockstep
      call move(n, state, ray, x, next)
      call law%evaluate(n, next, level)
      call judge(n, level, x, ray(:, of_far), y(:, k), found, lost)
      if (k == lockstep .or. all(found .or. lost)) exit
      ! Neville's rule: column j has the interpolations of j + 1 values, the first one twice.
      fresh(:n) = x(:n)
      do j = 1, k + 1
        do i = 1, n
          apart = y(i, k) - y(i, k - j)
          apart = merge(apart, 1.0_wp, abs(apart) > epsilon(1.0_wp)*tolerance)
          way = fresh(i) + y(i, k)*((column(i, j - 1) - fresh(i))/apart)
          column(i, j - 1) = fresh(i)
          fresh(i) = way
        end do
      end do
      column(:n, k + 1) = fresh(:n)
      do i = 1, n
        ahead = 0.5_wp + sign(0.5_wp, fresh(i) - tiny(1.0_wp))
        x(i) = min(ahead*fresh(i) + (1.0_wp - ahead)*ray(i, of_far), ray(i, of_far))
      end do
    end do
  end subroutine search

  !> Which states are on the yield surface, and how far from it the others are.
  !!
  !! Be is near 1, and rounded. With |ev| = x and the share w of shear in the yield, this changes
  !! the yield by up to eps (6/x + w/es): p grows at most as x**5, the factor c of the stress as
  !! x**2, q as c es, and the errors are at most 3 eps/8 in x and eps/4 in es. Where this is more
  !! than the tolerance, the middle of the range below the surface is aimed at, so that the state
  !! does not yield.
  pure subroutine judge(n, level, way, far, distance, found, lost)
    !> Number of states.
    integer, intent(in) :: n
    !> What is known of them.
    real(wp), intent(in) :: level(width, n_level)
    !> Their multipliers.
    real(wp), intent(in) :: way(width)
    !> The largest ones.
    real(wp), intent(in) :: far(width)
    !> y/sqrt(1 + y/4) of the yield less its aim, or 0 for those that stay where they are.
    real(wp), intent(out) :: distance(width)
    !> Whether they are on the surface. (n)
    logical, intent(out) :: found(n)
    !> Whether they are at the end of the way, and yield. (n)
    logical, intent(out) :: lost(n)
    real(wp), parameter :: least = tiny(1.0_wp)
    real(wp) :: noise, y, off, ended
    integer :: i

    do i = 1, n
      y = level(i, of_y)
      noise = max(0.0_wp, 1.0_wp + y - level(i, of_free))/max(level(i, of_es), least)
      noise = epsilon(1.0_wp)*(6.0_wp/max(-level(i, of_ev), least) + noise)
      noise = max(tolerance, noise)
      off = abs(2.0_wp*y + (noise - tolerance)) - (noise + tolerance)
      ! Factors that are 0 or 1, since conditions would make the loop branch.
      ended = (0.5_wp + sign(0.5_wp, way(i) - far(i)))*(0.5_wp + sign(0.5_wp, y - tolerance))
      y = y + 0.5_wp*(noise - tolerance)
      distance(i) = (0.5_wp + sign(0.5_wp, off))*(1.0_wp - ended)*y/sqrt(1.0_wp + 0.25_wp*y)
      found(i) = off <= 0.0_wp
      lost(i) = ended > 0.5_wp
    end do
  end subroutine judge

end module mpm_breakage_flow
