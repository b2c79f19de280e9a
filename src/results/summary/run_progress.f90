!> The line on the progress of a run: where it stands, how long it has taken and will take.
module run_progress
  use analysis_state, only: state
  use kinds, only: rk
  use logging, only: run_log
  use problem_definition, only: problem
  use run_records, only: run_record
  use step_control, only: roundoff
  use step_plan, only: step
  use timer, only: wall_clock
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: progress_clock

  !> Through a pipe a line comes when this part of the run is done, or after this time [s].
  real(rk), parameter :: part_of_line = 0.05_rk, time_of_line = 60.0_rk

  !> Shares of the run, and the times that they have taken.
  type :: progress_clock
    private
    real(rk) :: opened_at = 0.0_rk !< wall clock at the start of the program [s]
    real(rk) :: step_opened_at = 0.0_rk !< wall clock at the start of the step, or where it goes on
    real(rk) :: step_opened_with = 0.0_rk !< part of the step that was done then
    integer :: step = 0
    real(rk) :: shown = -1.0_rk !< part of the run with the last line
    real(rk) :: shown_at = 0.0_rk !< wall clock [s]
  contains
    procedure :: open => open_clock
    procedure :: note
    procedure :: show
    procedure, private :: is_due, line, remaining
  end type progress_clock

contains

  !> The program has started.
  subroutine open_clock(self, started_at)
    class(progress_clock), intent(inout) :: self
    real(rk), intent(in) :: started_at !< wall clock [s]
    self%opened_at = started_at
  end subroutine open_clock

  !> Notes the time at which a step begins. `now` is before the first increment, or after the first
  !> one of a run that goes on.
  subroutine note(self, model, now)
    class(progress_clock), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (now%step == self%step) return
    self%step = now%step
    self%step_opened_at = wall_clock()
    self%step_opened_with = done_of_step(model%steps(now%step), now)
  end subroutine note

  !> Writes a line on an increment into the log, and one for the reader of stderr where one is due.
  subroutine show(self, model, now, record, log)
    class(progress_clock), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    type(run_log), intent(inout) :: log
    logical :: is_due
    call log%note(line_of_log(now))
    is_due = log%is_terminal
    if (.not. is_due) is_due = self%is_due(model, now)
    if (is_due) call log%progress(self%line(model, now, record))
  end subroutine show

  !> Whether a pipe gets a line for this increment: each part of the run, each minute, and the ends
  !> of steps.
  logical function is_due(self, model, now)
    class(progress_clock), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk) :: done
    done = done_of_run(model, now)
    is_due = now%is_last_of_step .or. self%shown < 0.0_rk .or. done >= self%shown + part_of_line
    if (.not. is_due) is_due = wall_clock() - self%shown_at >= time_of_line
    if (.not. is_due) return
    self%shown = done
    self%shown_at = wall_clock()
  end function is_due

  !> The line, the most important first: share of the step, times, largest opening, increment.
  function line(self, model, now, record)
    class(progress_clock), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    character(:), allocatable :: line
    real(rk) :: left
    left = self%remaining(model, now)
    associate (plan => model%steps(now%step))
      line = plan%name//'  '//percent(done_of_step(plan, now))// &
             ', '//time_in_words(wall_clock() - self%opened_at)//' elapsed'
      if (left >= 0.0_rk) line = line//', '//time_in_words(left)//' remaining'
      if (size(record%joints) > 0) line = line//', largest opening '//largest_opening(record)
      line = line//', time '//as_text(now%step_time)
      if (now%step > 1) line = line//' (total '//as_text(now%total_time)//')'
      line = line//', increment '//as_text(now%increment)//planned(plan, now)
    end associate
    line = line//', iterations '//as_text(now%iterations)
  end function line

  !> The line of the log: step, increment, time, iterations, residual, energy error.
  function line_of_log(now) result(line)
    type(state), intent(in) :: now
    character(:), allocatable :: line
    character(120) :: room
    write (room, '(a,i0,a,i0,a,i0,a,es8.1,a,es8.1)') 'step ', now%step, '  increment ', &
      now%increment, '  time '//as_text(now%total_time)//'  iterations ', now%iterations, &
      '  residual ', now%residual, '  energy error ', now%energy%error
    line = trim(room)
  end function line_of_log

  !> ' of 2000', where the increments of the step are all of one size.
  function planned(plan, now) result(text)
    type(step), intent(in) :: plan
    type(state), intent(in) :: now
    character(:), allocatable :: text
    text = ''
    if (now%cutbacks == 0 .and. plan%is_direct) text = ' of '//as_text(num_increments(plan))
  end function planned

  !> The largest opening of any joint so far.
  function largest_opening(record) result(text)
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    real(rk) :: largest
    integer :: j
    largest = 0.0_rk
    do j = 1, size(record%joints)
      associate (found => record%joints(j)%opening%at(1))
        if (found%is_found) largest = max(largest, found%value)
      end associate
    end do
    text = as_short_text(largest)
  end function largest_opening

  !> Time that the rest of the run takes, if its increments take as long as those of this step so
  !> far [s]; negative: not known yet.
  real(rk) function remaining(self, model, now)
    class(progress_clock), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk) :: done, increments
    remaining = -1.0_rk
    associate (plan => model%steps(now%step))
      done = done_of_step(plan, now) - self%step_opened_with
      if (done <= 0.0_rk) return
      increments = sum_of_increments(model, now%step + 1, size(model%steps)) &
                   + (1.0_rk - done_of_step(plan, now))*num_increments(plan)
      remaining = (wall_clock() - self%step_opened_at)*increments/(done*num_increments(plan))
    end associate
  end function remaining

  !> Part of the increments of the run that is done.
  pure real(rk) function done_of_run(model, now) result(done)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    associate (plan => model%steps(now%step))
      done = (sum_of_increments(model, 1, now%step - 1) &
              + done_of_step(plan, now)*num_increments(plan)) &
             /max(1.0_rk, sum_of_increments(model, 1, size(model%steps)))
    end associate
  end function done_of_run

  !> Part of a step that is done.
  pure real(rk) function done_of_step(plan, now) result(done)
    type(step), intent(in) :: plan
    type(state), intent(in) :: now
    done = 1.0_rk
    if (plan%duration > 0.0_rk) done = min(1.0_rk, now%step_time/plan%duration)
  end function done_of_step

  !> Planned increments of some steps; a *FREQUENCY step counts as one.
  pure real(rk) function sum_of_increments(model, first, last) result(total)
    type(problem), intent(in) :: model
    integer, intent(in) :: first, last !< steps
    integer :: i
    total = 0.0_rk
    do i = first, last
      total = total + num_increments(model%steps(i))
    end do
  end function sum_of_increments

  !> Increments of a step, all of the first size.
  pure integer function num_increments(plan)
    type(step), intent(in) :: plan
    num_increments = 1
    if (plan%procedure%finds_modes .or. plan%first_increment <= 0.0_rk) return
    num_increments = max(1, ceiling(min(plan%duration/plan%first_increment, 1.0e9_rk) - roundoff))
  end function num_increments

  !> '37 %'.
  function percent(part) result(text)
    real(rk), intent(in) :: part
    character(:), allocatable :: text
    text = as_text(floor(100.0_rk*part + 1.0e-6_rk))//' %'
  end function percent

  !> '0:42', '12:07', '3:05:00'.
  function time_in_words(seconds) result(text)
    real(rk), intent(in) :: seconds
    character(:), allocatable :: text
    character(32) :: room
    integer :: whole
    whole = nint(min(max(seconds, 0.0_rk), 1.0e9_rk))
    if (whole < 3600) then
      write (room, '(i0,a,i2.2)') whole/60, ':', mod(whole, 60)
    else
      write (room, '(i0,2(a,i2.2))') whole/3600, ':', mod(whole, 3600)/60, ':', mod(whole, 60)
    end if
    text = trim(room)
  end function time_in_words
end module run_progress
