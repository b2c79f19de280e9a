!> A material at one point along the path of a test; every increment gives a row.
module material_path
  use errors, only: error_type, raise
  use kinds, only: rk
  use material_law, only: stress_law, start_points
  use material_points, only: point_set, point_state, time_increment
  use material_tests, only: material_test, test_leg
  use umat_loader, only: user_library, at_increment_end, at_increment_start
  use point_increment, only: point_control, increment_outcome, solve_increment
  use write_text, only: as_text
  implicit none
  private
  public :: path_record, follow_path

  real(rk), parameter :: smallest_part = 2.0_rk**(-14) !< of an increment that is cut
  !> Calls of the law in an increment with all its parts, and those that each increment adds. Ten
  !> are usual.
  integer, parameter :: most_calls = 20000, mean_calls = 200
  character(8), parameter :: strain_names(6) = ['E11     ', 'E22     ', 'E33     ', &
                                                'gamma 12', 'gamma 13', 'gamma 23']
  character(3), parameter :: stress_names(6) = ['S11', 'S22', 'S33', 'S12', 'S13', 'S23']

  !> Results row by row; each row takes the place of a point in the state.
  type :: path_record
    integer :: num_rows = 0 !< in use; the first is the initial state
    integer, allocatable :: leg(:), increment(:), iterations(:)
    real(rk), allocatable :: time(:) !< total [s]
    real(rk), allocatable :: work(:) !< of the stresses so far [J/m3]
    type(point_state) :: state
  end type path_record

  !> The point and its progress.
  type :: traveller
    type(point_set) :: points
    type(point_state) :: old !< converged
    real(rk) :: tangent(6, 6, 1) = 0.0_rk !< at `old`; elastic at the start of a leg [Pa]
    real(rk) :: work = 0.0_rk !< [J/m3]
    real(rk) :: largest = 0.0_rk !< stress so far [Pa]
    type(time_increment) :: time
    integer :: iterations = 0 !< calls of the law since the last row
    integer :: calls_left = most_calls !< of the law, before the test stops
    type(user_library), pointer :: umat => null() !< its UEXTERNALDB is called in each increment
  end type traveller

contains

  !> Follows all legs. After an error the rows so far are kept.
  subroutine follow_path(law, test, record, error, umat)
    class(stress_law), intent(in) :: law
    type(material_test), intent(in) :: test
    type(path_record), intent(out) :: record
    type(error_type), allocatable, intent(out) :: error
    type(user_library), pointer, intent(in), optional :: umat !< null where there is none
    type(traveller) :: now
    integer :: i
    call start_point(law, test, now)
    if (present(umat)) now%umat => umat
    call open_record(now, 1 + sum(test%legs%num_increments), record)
    call add_row(now, 0, 0, record)
    do i = 1, size(test%legs)
      call follow_leg(law, test, i, now, record, error)
      if (allocated(error)) exit
    end do
    call trim_record(record)
  end subroutine follow_path

  !> Initial state of the point, in the middle of a cube.
  subroutine start_point(law, test, now)
    class(stress_law), intent(in) :: law
    type(material_test), intent(in) :: test
    type(traveller), intent(out) :: now
    integer :: i
    associate (points => now%points)
      points%num_points = 1
      points%element = [1]
      points%number = [1]
      points%length = [test%length]
      points%widest = [test%length]
      allocate (points%x(3, 1), points%edges(3, 3, 1), source=0.0_rk)
      do i = 1, 3
        points%edges(i, i, 1) = test%length
      end do
    end associate
    call start_points(law, now%points, now%old)
  end subroutine start_point

  !> Follows one leg, increment by increment.
  subroutine follow_leg(law, test, number, now, record, error)
    class(stress_law), intent(in) :: law
    type(material_test), intent(in) :: test
    integer, intent(in) :: number !< of the leg
    type(traveller), intent(inout) :: now
    type(path_record), intent(inout) :: record
    type(error_type), allocatable, intent(out) :: error
    type(point_state) :: start
    type(increment_outcome) :: outcome
    real(rk) :: started_at
    integer :: i
    ! A leg may reverse: with the tangent of a softening branch a stress would stay on that branch.
    call law%elastic_stiffness(now%tangent(:, :, 1))
    start = now%old
    started_at = now%time%total_time
    now%time%step = number
    now%time%increment = 0
    associate (leg => test%legs(number))
      do i = 1, leg%num_increments
        now%calls_left = min(most_calls, now%calls_left + mean_calls)
        call advance_point(law, test, start, [i - 1, i], now, outcome, error)
        if (allocated(error)) return
        if (.not. outcome%has_converged) then
          call describe_failure(test, number, i, outcome, now, error)
          return
        end if
        now%time%total_time = started_at + leg%duration*i/leg%num_increments
        call add_row(now, number, i, record)
      end do
    end associate
  end subroutine follow_leg

  !> One increment of a leg, cut where necessary.
  subroutine advance_point(law, test, start, bounds, now, outcome, error)
    class(stress_law), intent(in) :: law
    type(material_test), intent(in) :: test
    type(point_state), intent(in) :: start !< of the leg
    integer, intent(in) :: bounds(2) !< numbers of finished increments before and after
    type(traveller), intent(inout) :: now
    type(increment_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error !< of a UMAT that stops
    type(point_state) :: new
    real(rk) :: tangent(6, 6, 1), at, part, leg_start
    logical :: is_last
    associate (leg => test%legs(now%time%step))
      leg_start = now%time%total_time - leg%duration*bounds(1)/leg%num_increments
      at = 0.0_rk
      part = 1.0_rk
      do
        is_last = part >= 1.0_rk - at
        if (is_last) part = 1.0_rk - at
        now%time%step_time = leg%duration*(bounds(1) + at)/leg%num_increments
        now%time%total_time = leg_start + now%time%step_time
        now%time%size = leg%duration*part/leg%num_increments
        now%time%increment = now%time%increment + 1
        call notify_user(at_increment_start, now, error)
        if (allocated(error)) return
        tangent = now%tangent
        call solve_increment(law, now%points, now%time, &
                             control_at(test, leg, start, (bounds(1) + at + part)/ &
                                        leg%num_increments, now%largest), &
                             now%old, new, tangent, outcome)
        now%iterations = now%iterations + outcome%iterations
        now%calls_left = now%calls_left - outcome%iterations
        if (outcome%has_converged) then
          call accept_point(new, tangent, now)
          call notify_user(at_increment_end, now, error)
          if (is_last .or. allocated(error)) return
          at = at + part
          part = 2.0_rk*part
        else
          part = part*outcome%size_ratio
          now%time%increment = now%time%increment - 1
          if (part < smallest_part) return
        end if
        if (now%calls_left < 0) then
          call give_up(outcome)
          return
        end if
      end do
    end associate
  end subroutine advance_point

  !> Ends an increment whose parts stay small.
  subroutine give_up(outcome)
    type(increment_outcome), intent(inout) :: outcome
    outcome%has_converged = .false.
    if (len(outcome%message) > 0) return
    outcome%message = 'more than '//as_text(most_calls)//' calls of the law, in ever smaller '// &
                      'parts of increments; take smaller targets, or more INCREMENTS'
  end subroutine give_up

  !> Calls UEXTERNALDB of a UMAT at a moment.
  subroutine notify_user(moment, now, error)
    integer, intent(in) :: moment
    type(traveller), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: passed
    if (.not. associated(now%umat)) return
    passed = merge(now%time%size, 0.0_rk, moment == at_increment_end)
    call now%umat%call_external(moment, [now%time%step_time, now%time%total_time] + passed, &
                                now%time%size, now%time%step, now%time%increment, error)
  end subroutine notify_user

  !> Prescribed components at a part of the leg.
  pure function control_at(test, leg, start, part, largest) result(control)
    type(material_test), intent(in) :: test
    type(test_leg), intent(in) :: leg
    type(point_state), intent(in) :: start !< of the leg
    real(rk), intent(in) :: part !< 0 to 1
    real(rk), intent(in) :: largest !< stress so far [Pa]
    type(point_control) :: control
    real(rk) :: first(6), last(6)
    first = start%strain(:, 1)
    where (leg%is_stress) first = start%stress(:, 1) - leg%share*start%stress(1, 1)
    last = merge(first, leg%target, leg%is_held)
    control%is_stress = leg%is_stress
    control%share = leg%share
    control%value = (1.0_rk - part)*first + part*last
    control%tolerance = test%tolerance
    control%largest = largest
  end function control_at

  !> Accepts the trial state as converged.
  subroutine accept_point(new, tangent, now)
    type(point_state), intent(in) :: new
    real(rk), intent(in) :: tangent(6, 6, 1)
    type(traveller), intent(inout) :: now
    now%work = now%work + 0.5_rk*sum((now%old%stress + new%stress)*(new%strain - now%old%strain))
    now%largest = max(now%largest, maxval(abs(new%stress)))
    now%old = new
    now%tangent = tangent
  end subroutine accept_point

  !> Error that names the end of the path and its cause.
  subroutine describe_failure(test, number, increment, outcome, now, error)
    type(material_test), intent(in) :: test
    integer, intent(in) :: number, increment !< of the leg and in it
    type(increment_outcome), intent(in) :: outcome
    type(traveller), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: text
    integer :: i !< component
    i = test%driven
    if (i == 0) i = maxloc(abs(now%old%stress(:, 1)), 1)
    text = 'test '//test%name//' stops in leg '//as_text(number)//', increment '// &
           as_text(increment)//' of '//as_text(test%legs(number)%num_increments)//' ('// &
           trim(strain_names(i))//' '//as_text(now%old%strain(i, 1))//', '//stress_names(i)// &
           ' '//as_text(now%old%stress(i, 1))//' before it): '
    if (len(outcome%message) > 0) then
      text = text//outcome%message
    else
      text = text//'no strains give the prescribed stresses'//remedy_of(test, test%legs(number))
    end if
    call raise(error, text)
  end subroutine describe_failure

  !> What to do where no strains give the prescribed stresses; '' for a leg without them.
  pure function remedy_of(test, leg) result(text)
    type(material_test), intent(in) :: test
    type(test_leg), intent(in) :: leg
    character(:), allocatable :: text
    text = ''
    if (.not. any(leg%is_stress)) return
    if (test%driven == 0) then
      text = '; beyond a peak prescribe a strain (E in place of S in the component that softens)'
    else if (leg%is_stress(test%driven)) then
      text = '; beyond a peak prescribe a strain (CONTROL=STRAIN)'
    else
      text = '; the curve turns back here: take a smaller LENGTH'
    end if
  end function remedy_of

  subroutine open_record(now, num_rows, record)
    type(traveller), intent(in) :: now
    integer, intent(in) :: num_rows
    type(path_record), intent(out) :: record
    allocate (record%leg(num_rows), record%increment(num_rows), record%iterations(num_rows))
    allocate (record%time(num_rows), record%work(num_rows))
    associate (state => record%state, one => now%old)
      allocate (state%strain(6, num_rows), state%stress(6, num_rows))
      allocate (state%internal(size(one%internal, 1), num_rows))
      allocate (state%energy(size(one%energy, 1), num_rows), state%gradient(3, 3, 0))
      allocate (state%is_elastic(num_rows))
    end associate
  end subroutine open_record

  !> Records the present state of the point.
  subroutine add_row(now, leg, increment, record)
    type(traveller), intent(inout) :: now
    integer, intent(in) :: leg, increment
    type(path_record), intent(inout) :: record
    record%num_rows = record%num_rows + 1
    associate (row => record%num_rows, state => record%state)
      record%leg(row) = leg
      record%increment(row) = increment
      record%iterations(row) = now%iterations
      record%time(row) = now%time%total_time
      record%work(row) = now%work
      state%strain(:, row) = now%old%strain(:, 1)
      state%stress(:, row) = now%old%stress(:, 1)
      state%internal(:, row) = now%old%internal(:, 1)
      state%energy(:, row) = now%old%energy(:, 1)
      state%is_elastic(row) = now%old%is_elastic(1)
    end associate
    now%iterations = 0
  end subroutine add_row

  !> Removes the unused rows.
  subroutine trim_record(record)
    type(path_record), intent(inout) :: record
    integer :: n
    n = record%num_rows
    record%leg = record%leg(:n)
    record%increment = record%increment(:n)
    record%iterations = record%iterations(:n)
    record%time = record%time(:n)
    record%work = record%work(:n)
    associate (state => record%state)
      state%strain = state%strain(:, :n)
      state%stress = state%stress(:, :n)
      state%internal = state%internal(:, :n)
      state%energy = state%energy(:, :n)
      state%is_elastic = state%is_elastic(:n)
    end associate
  end subroutine trim_record
end module material_path
