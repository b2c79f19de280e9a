!> Warns of base motions in another unit of acceleration or of time than the deck, and of those that
!> begin with a jump.
module check_motions
  use amplitudes, only: amplitude, amplitude_at
  use deck_units, only: gravity_of, has_other_length, has_milliseconds
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use base_motion_cards, only: is_acceleration
  use load_cards, only: load_card_list, target_of_motion
  use model_draft, only: draft
  use step_plan, only: span_of_step, step_load
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: find_peak, warn_of_motions

  !> Peaks of motions that are felt, up to more than any record has (3 g to 5 g) and small blocks in
  !> tests are given (30 g). A record in g or in m/s2 in a deck in mm has 1e-6 g to 1e-3 g, one in
  !> mm/s2 in a deck in m has 100 g and more.
  real(rk), parameter :: least_peak = 1.0e-3_rk, largest_peak = 50.0_rk
  !> Parts of the peak and of the time of a record that a step reaches: less with times in ms, where
  !> a step as long as the record reaches a thousandth. A step may end early on purpose.
  real(rk), parameter :: seen_share = 0.5_rk, passed_share = 2.0e-3_rk
  real(rk), parameter :: small_share = 0.01_rk !< of the peak: a first value that counts as zero

  !> What the steps see of a record.
  type :: view_of_record
    integer :: place = 0 !< first card *BASE MOTION, 0 for none
    real(rk) :: seen = 0.0_rk !< largest value in the steps
    real(rk) :: until = 0.0_rk !< end of the last step on the clock of the record [s]
  end type view_of_record

  !> Accelerations of the deck.
  type :: acceleration_unit
    real(rk) :: g = 0.0_rk !< of the earth; 0: not known
    logical :: is_other = .false. !< than m/s2
  end type acceleration_unit

contains

  !> The deck must have no errors. One warning of a kind for each record.
  subroutine warn_of_motions(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards !< of the deck
    type(diagnostic_list), intent(inout) :: faults
    type(view_of_record) :: views(size(model%problem%amplitudes))
    type(acceleration_unit) :: unit
    integer :: s, i
    unit%g = gravity_of(model%problem)
    unit%is_other = has_other_length(model%problem) .or. has_milliseconds(model%problem)
    do s = 1, size(model%problem%steps)
      if (.not. model%problem%steps(s)%procedure%has_inertia) cycle
      do i = 1, size(model%problem%steps(s)%loads)
        call look_at_load(model, cards, s, model%problem%steps(s)%loads(i), unit, views, faults)
      end do
    end do
    do i = 1, size(views)
      if (views(i)%place > 0) call warn_of_end(model, views(i), model%problem%amplitudes(i), faults)
    end do
  end subroutine warn_of_motions

  !> A load of a step, if it is a base motion.
  subroutine look_at_load(model, cards, s, work, unit, views, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    integer, intent(in) :: s !< step
    type(step_load), intent(in) :: work
    type(acceleration_unit), intent(in) :: unit
    type(view_of_record), intent(inout) :: views(:) !< (amplitudes)
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: peak, at, span(2)
    if (work%amplitude == 0) return
    select type (motion => model%problem%loads(work%load)%item)
    type is (base_motion)
      associate (record => model%problem%amplitudes(work%amplitude), view => views(work%amplitude))
        span = span_of_step(model%problem%steps, s, record%uses_total_time)
        call find_peak(record, span, peak, at)
        view%seen = max(view%seen, peak)
        view%until = max(view%until, span(2))
        if (view%place > 0) return
        view%place = cards%find('BASE MOTION', target_of_motion(motion%dof, record%name), s, &
                                otherwise=0)
        if (view%place == 0) return
        call warn_of_start(model, view%place, s, record, faults)
        call warn_of_peak(model, view%place, work, unit, record, faults)
      end associate
    end select
  end subroutine look_at_load

  !> A record that begins after the step, and not at zero: its first value acts from the start on.
  subroutine warn_of_start(model, place, s, record, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: place !< card
    integer, intent(in) :: s !< step
    type(amplitude), intent(in) :: record
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: span(2)
    span = span_of_step(model%problem%steps, s, record%uses_total_time)
    if (size(record%time) == 1) return
    if (record%time(1) <= span(1) .or. record%time(1) >= span(2)) return
    if (abs(record%value(1)) <= small_share*maxval(abs(record%value))) return
    call model%cards(place)%warn(faults, "the record '"//record%name//"' begins at "// &
                                 as_text(record%time(1))//' s with '// &
                                 as_text(record%value(1))//': this acceleration acts from the '// &
                                 'start of the step on', 'a first value of zero')
  end subroutine warn_of_start

  !> A peak that no earthquake has.
  subroutine warn_of_peak(model, place, work, unit, record, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: place !< card
    type(step_load), intent(in) :: work
    type(acceleration_unit), intent(in) :: unit
    type(amplitude), intent(in) :: record
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: factor
    real(rk) :: peak
    factor = 'a SCALE'
    if (is_acceleration(model%cards(place))) factor = 'a factor'
    if (unit%is_other .and. &
        (model%record_unit(work%amplitude) /= '' .or. &
         abs(model%record_factor(work%amplitude) - 1.0_rk) > 0.0_rk)) return ! check_units warns
    peak = abs(work%end_factor)*maxval(abs(record%value))
    if (unit%g <= 0.0_rk .or. peak <= 0.0_rk) return
    if (peak >= least_peak*unit%g .and. peak <= largest_peak*unit%g) return
    call model%cards(place)%warn(faults, "the peak of the motion '"//record%name//"' is "// &
                                 as_short_text(peak)//', which is '// &
                                 as_short_text(peak/unit%g)//' g with g = '//as_text(unit%g), &
                                 factor//' that turns the record into the unit of '// &
                                 'acceleration of the deck')
  end subroutine warn_of_peak

  !> A record whose largest values come after all steps.
  subroutine warn_of_end(model, view, record, faults)
    type(draft), intent(in) :: model
    type(view_of_record), intent(in) :: view
    type(amplitude), intent(in) :: record
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: text
    real(rk) :: ends_at
    integer :: i
    i = maxloc(abs(record%value), dim=1)
    ends_at = record%time(size(record%time))
    if (view%seen >= seen_share*abs(record%value(i))) return
    if (view%until >= passed_share*ends_at .or. record%time(i) <= view%until) return
    text = "the peak of the record '"//record%name//"', at "//as_text(record%time(i))//' s, '// &
           'does not act: the step ends at '//as_text(view%until)//' s, the record at '// &
           as_text(ends_at)//' s'
    call model%cards(view%place)%warn(faults, text, 'a record and a step with times in one '// &
                                      'unit, and a step that reaches the peak')
  end subroutine warn_of_end

  !> The largest value of a history within a step and at its start and end, between two values.
  pure subroutine find_peak(record, span, peak, at)
    type(amplitude), intent(in) :: record
    real(rk), intent(in) :: span(2) !< start and end of the step [s]
    real(rk), intent(out) :: peak, at !< size, and its time [s]
    integer :: i
    peak = -1.0_rk
    at = span(1)
    i = maxloc(abs(record%value), dim=1, mask=record%time >= span(1) .and. record%time <= span(2))
    if (i > 0) then
      peak = abs(record%value(i))
      at = record%time(i)
    end if
    do i = 1, size(span)
      if (abs(amplitude_at(record, span(i))) <= peak) cycle
      peak = abs(amplitude_at(record, span(i)))
      at = span(i)
    end do
  end subroutine find_peak
end module check_motions
