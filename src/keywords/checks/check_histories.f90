!> Warns of histories that do not act as they stand: over before the step, zero, too fine for its
!> increments, in units of acceleration on loads.
module check_histories
  use amplitudes, only: amplitude, amplitude_at, spacing_of
  use check_idle_steps, only: first_displacement
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use named_things, only: find_amplitude
  use step_control, only: increment_control, start_control
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_histories

  real(rk), parameter :: round_off = 1.0e-9_rk
  real(rk), parameter :: seen_share = 0.9_rk !< of the peak: less is a warning
  real(rk), parameter :: rounded = 0.01_rk !< of a spacing, by times with few digits
  integer, parameter :: most_samples = 10000000

contains

  !> The deck must have no errors.
  subroutine warn_of_histories(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards))
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
      call warn_of_increments(model%cards(i), model, step(i), model%problem%amplitudes(a), coarse, &
                              faults)
      if (.not. is_keyword(model%cards(i), 'BASE MOTION')) then
        call warn_of_unit(model%cards(i), model, a, faults)
      end if
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
    span = span_of_step(model, s, record)
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

  !> Start and end of a step on the clock of a history [s].
  pure function span_of_step(model, s, record) result(span)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(amplitude), intent(in) :: record
    real(rk) :: span(2)
    span = 0.0_rk
    if (record%uses_total_time) then
      span(1) = sum(model%problem%steps(:s - 1)%duration, &
                    mask=.not. model%problem%steps(:s - 1)%procedure%finds_modes)
    end if
    span(2) = span(1) + model%problem%steps(s)%duration
  end function span_of_step

  !> A peak between the increments does not act. Increments are taken to grow as they do where each
  !> converges quickly. One warning in a step says that they grow beyond the spacing of a motion.
  subroutine warn_of_increments(this, model, s, record, coarse, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    type(amplitude), intent(in) :: record
    integer, intent(inout) :: coarse !< the last step that was warned of, 0 for none
    type(diagnostic_list), intent(inout) :: faults
    type(increment_control) :: control
    character(:), allocatable :: sizes
    real(rk) :: span(2), peak, seen, t, smallest, largest
    span = span_of_step(model, s, record)
    peak = maxval(abs(record%value), mask=record%time >= span(1) .and. record%time <= span(2))
    associate (plan => model%problem%steps(s))
      if (plan%duration/plan%first_increment > real(most_samples, rk)) return
      call start_control(plan, plan%procedure%has_inertia, control)
      if (control%finest > 0.0_rk) control%size = control%finest ! with *CONTROLS, ACCURACY
      smallest = control%size
    end associate
    t = 0.0_rk
    largest = 0.0_rk
    seen = abs(amplitude_at(record, span(1)))
    do while (t < control%duration*(1.0_rk - round_off))
      largest = max(largest, control%next_size(t))
      t = t + control%next_size(t)
      seen = max(seen, abs(amplitude_at(record, span(1) + t)))
      call control%accept(1)
    end do
    if (seen >= seen_share*peak) then
      if (coarse == s .or. control%finest > 0.0_rk) return
      if (smallest > spacing_of(record)*(1.0_rk + rounded)) return
      if (largest <= spacing_of(record)*(1.0_rk + rounded)) return
      if (.not. model%problem%steps(s)%procedure%has_inertia) return
      if (.not. (is_keyword(this, 'BASE MOTION') .or. is_keyword(this, 'BOUNDARY'))) return
      coarse = s
      call warn_of_growth(this, largest, spacing_of(record), faults)
      return
    end if
    sizes = as_text(smallest)
    if (largest > smallest*(1.0_rk + round_off)) sizes = sizes//' to '//as_text(largest)
    call this%warn(faults, 'increments of '//sizes//" s miss the peak of the history '"// &
                   this%text('AMPLITUDE')//"': "//as_text(seen)//' at their ends, '// &
                   as_text(peak)//' in the history', 'increments that end near the peak')
  end subroutine warn_of_increments

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
    integer :: i
    has_unit = abs(model%record_factor(a) - 1.0_rk) > 0.0_rk
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'AMPLITUDE')) cycle
      if (model%cards(i)%word('NAME') /= this%word('AMPLITUDE')) cycle
      has_unit = has_unit .or. model%cards(i)%has('UNIT')
    end do
    if (has_unit) call this%warn(faults, "amplitude '"//this%text('AMPLITUDE')//"' is a record "// &
                                 'of acceleration: its values in m/s2 scale the load')
  end subroutine warn_of_unit
end module check_histories
