!> Warns of histories that do not act as they stand: over before the step, zero, too fine for its
!> increments, in units of acceleration on loads.
module check_histories
  use amplitudes, only: amplitude, amplitude_at
  use check_idle_steps, only: first_displacement
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use base_motion_cards, only: moves_base
  use model_draft, only: draft
  use named_things, only: find_amplitude
  use step_control, only: increment_control, start_control
  use step_plan, only: span_of_step
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_histories

  real(rk), parameter :: round_off = 1.0e-9_rk
  real(rk), parameter :: seen_share = 0.9_rk !< of the peak: less is a warning
  real(rk), parameter :: rounded = 0.01_rk !< of a spacing, by times with few digits
  integer, parameter :: most_samples = 10000000

  !> What the increments of a step see of a history.
  type :: view_of_history
    integer :: amplitude = 0, step = 0
    logical :: is_seen = .false. !< the increments are not too many to look at
    real(rk) :: peak = 0.0_rk !< the largest value of the history in the step
    logical :: is_finest = .false. !< *CONTROLS, ACCURACY chooses the increments
    real(rk) :: smallest = 0.0_rk, largest = 0.0_rk !< increment [s]
    real(rk) :: seen = 0.0_rk !< the largest value at their ends
    !> The largest increment that has grown beyond the time between the values within it, 0 for
    !> none, and that time [s]
    real(rk) :: coarse = 0.0_rk, spacing = 0.0_rk
  end type view_of_history

contains

  !> The deck must have no errors.
  subroutine warn_of_histories(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards))
    type(view_of_history) :: view
    integer :: i, a, coarse
    step = steps_of_cards(model%cards)
    coarse = 0
    do i = 1, size(step)
      if (is_keyword(model%cards(i), 'STEP')) cycle ! RAMP or STEP
      if (.not. model%cards(i)%has('AMPLITUDE')) cycle
      if (is_keyword(model%cards(i), 'BOUNDARY')) then
        if (first_displacement(model%cards(i)) == 0) then
          call model%cards(i)%warn(faults, 'AMPLITUDE has no effect: all displacements are zero')
          cycle
        end if
      end if
      if (step(i) == 0) cycle
      if (model%problem%steps(step(i))%procedure%finds_modes) cycle
      call find_amplitude(model%cards(i), model, faults, a)
      if (a == 0) cycle
      call warn_of_span(model%cards(i), model, step(i), model%problem%amplitudes(a), faults)
      if (view%amplitude /= a .or. view%step /= step(i)) call look_at(model, step(i), a, view)
      if (view%is_seen) call warn_of_increments(model%cards(i), model, view, coarse, faults)
      if (.not. moves_base(model%cards(i))) call warn_of_unit(model%cards(i), model, a, faults)
    end do
  end subroutine warn_of_histories

  !> A history that is constant over its step, because it is over before or begins after it.
  subroutine warn_of_span(this, model, s, record, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(amplitude), intent(in) :: record
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: clock
    real(rk) :: span(2)
    if (all(abs(record%value) <= 0.0_rk)) then
      call this%warn(faults, "all values of amplitude '"//this%text('AMPLITUDE')//"' are zero")
      return
    end if
    if (size(record%time) == 1) return
    span = span_of_step(model%problem%steps, s, record%uses_total_time)
    clock = trim(merge('total time', 'step time ', record%uses_total_time))
    associate (first => record%time(1), last => record%time(size(record%time)))
      if (last <= span(1)*(1.0_rk + round_off)) then
        call this%warn(faults, "amplitude '"//this%text('AMPLITUDE')//"' ends at "// &
                       as_text(last)//' s, before the step begins at '//as_text(span(1))// &
                       ' s ('//clock//'): its last value acts, '// &
                       as_text(record%value(size(record%value))))
      else if (first >= span(2)*(1.0_rk - round_off)) then
        call this%warn(faults, "amplitude '"//this%text('AMPLITUDE')//"' begins at "// &
                       as_text(first)//' s, after the step has ended at '//as_text(span(2))// &
                       ' s ('//clock//'): its first value acts, '//as_text(record%value(1)))
      end if
    end associate
  end subroutine warn_of_span

  !> What a step sees of a history. Increments are taken to grow as they do where each converges
  !> quickly.
  subroutine look_at(model, s, a, view)
    type(draft), intent(in) :: model
    integer, intent(in) :: s, a !< step and amplitude
    type(view_of_history), intent(out) :: view
    type(increment_control) :: control
    real(rk) :: span(2)
    view%amplitude = a
    view%step = s
    associate (plan => model%problem%steps(s), record => model%problem%amplitudes(a))
      view%is_seen = plan%duration/plan%first_increment <= real(most_samples, rk)
      if (.not. view%is_seen) return
      span = span_of_step(model%problem%steps, s, record%uses_total_time)
      view%peak = maxval(abs(record%value), &
                         mask=record%time >= span(1) .and. record%time <= span(2))
      call start_control(plan, plan%procedure%has_inertia, control)
      view%is_finest = control%finest > 0.0_rk
      if (view%is_finest) control%size = control%finest
      call walk_increments(record, span(1), control, view)
    end associate
  end subroutine look_at

  !> A peak between the increments does not act. One warning in a step says that the increments grow
  !> beyond the spacing of a motion.
  subroutine warn_of_increments(this, model, view, coarse, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(view_of_history), intent(in) :: view
    integer, intent(inout) :: coarse !< the last step that was warned of, 0 for none
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: sizes
    if (view%seen >= seen_share*view%peak) then
      if (coarse == view%step .or. view%is_finest .or. view%coarse <= 0.0_rk) return
      if (.not. model%problem%steps(view%step)%procedure%has_inertia) return
      if (.not. (is_keyword(this, 'BASE MOTION') .or. is_keyword(this, 'BOUNDARY'))) return
      coarse = view%step
      call warn_of_growth(this, view%coarse, view%spacing, faults)
      return
    end if
    sizes = as_text(view%smallest)
    if (view%largest > view%smallest*(1.0_rk + round_off)) then
      sizes = sizes//' to '//as_text(view%largest)
    end if
    call this%warn(faults, 'increments of '//sizes//" s miss the peak of the history '"// &
                   this%text('AMPLITUDE')//"': "//as_text(view%seen)//' at their ends, '// &
                   as_text(view%peak)//' in the history', 'increments that end near the peak')
  end subroutine warn_of_increments

  !> Goes through the increments of a step.
  pure subroutine walk_increments(record, start, control, view)
    type(amplitude), intent(in) :: record
    real(rk), intent(in) :: start !< of the step on the clock of the history [s]
    type(increment_control), intent(inout) :: control !< at the start of the step
    type(view_of_history), intent(inout) :: view !< of the step, so far empty
    real(rk) :: t, size, spacing
    integer :: first
    view%smallest = control%size
    view%seen = abs(amplitude_at(record, start))
    first = 1
    t = 0.0_rk
    do while (t < control%duration*(1.0_rk - round_off))
      size = control%next_size(t)
      call find_spacing(record, start + t, start + t + size, first, spacing)
      t = t + size
      view%largest = max(view%largest, size)
      view%seen = max(view%seen, abs(amplitude_at(record, start + t)))
      if (size > spacing*(1.0_rk + rounded) .and. size > view%coarse &
          .and. view%smallest <= spacing*(1.0_rk + rounded)) then
        view%coarse = size
        view%spacing = spacing
      end if
      call control%accept(1)
    end do
  end subroutine walk_increments

  !> The shortest time between values within an increment: half the time from the value before to
  !> the value after, for a jump is no sampling.
  pure subroutine find_spacing(record, start, end, first, spacing)
    type(amplitude), intent(in) :: record
    real(rk), intent(in) :: start, end !< of the increment, on the clock of the history [s]
    integer, intent(inout) :: first !< value that may matter; grows with the increments
    real(rk), intent(out) :: spacing !< huge for none [s]
    real(rk) :: half
    integer :: i
    spacing = 0.5_rk*huge(1.0_rk) ! the caller adds round-off
    do i = first, size(record%time) - 2
      half = 0.5_rk*(record%time(i + 2) - record%time(i))
      if (record%time(i + 2) <= start + rounded*half) then
        first = i + 1
      else if (record%time(i) >= end - rounded*half) then
        exit
      else
        spacing = min(spacing, half)
      end if
    end do
  end subroutine find_spacing

  !> Increments that grow until they leave out values of a motion.
  subroutine warn_of_growth(this, largest, spacing, faults)
    type(card), intent(in) :: this
    real(rk), intent(in) :: largest, spacing !< increment, and time between values [s]
    type(diagnostic_list), intent(inout) :: faults
    call this%warn(faults, 'increments grow to '//as_text(largest)//' s, beyond the '// &
                   as_text(spacing)//" s between values of the history '"// &
                   this%text('AMPLITUDE')//"': they leave out values", 'a largest increment of '// &
                   as_text(spacing)//' s or less, DIRECT, or ACCURACY of *CONTROLS')
  end subroutine warn_of_growth

  !> The values of a record of acceleration were turned into m/s2.
  subroutine warn_of_unit(this, model, a, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: a !< amplitude
    type(diagnostic_list), intent(inout) :: faults
    logical :: has_unit
    has_unit = abs(model%record_factor(a) - 1.0_rk) > 0.0_rk .or. model%record_unit(a) /= ''
    if (has_unit) call this%warn(faults, "amplitude '"//this%text('AMPLITUDE')//"' is a record "// &
                                 'of acceleration: its values in m/s2 scale the load')
  end subroutine warn_of_unit
end module check_histories
