!> Peaks of the base motions of a step, for the summary of a model.
module motion_peaks
  use amplitudes, only: one_g
  use check_motions, only: find_peak
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use problem_definition, only: problem
  use step_plan, only: span_of_step, step_load
  use write_text, only: as_text
  implicit none
  private
  public :: peak_of_motion

contains

  !> ', peak 3.07 m/s2 = 0.313 g at t = 2.14 s' of a base motion that acts, without units where the
  !> deck is not in metres and seconds; '' of other loads.
  pure function peak_of_motion(model, number, work) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(step_load), intent(in) :: work
    character(:), allocatable :: text
    real(rk) :: peak, at
    text = ''
    select type (motion => model%loads(work%load)%item)
    type is (base_motion)
      if (.not. model%steps(number)%procedure%has_inertia) then
        text = ', without effect in this step: no inertia'
        return
      else if (work%amplitude == 0) then
        text = ', constant '//in_units(model, abs(work%end_factor))
        return
      end if
      associate (record => model%amplitudes(work%amplitude))
        call find_peak(record, span_of_step(model%steps, number, record%uses_total_time), peak, at)
        peak = abs(work%end_factor)*peak
        text = ', peak '//in_units(model, peak)//' at t = '//as_text(at)//' s'
      end associate
    end select
  end function peak_of_motion

  !> '3.07 m/s2 = 0.313 g'; '3070' where the deck is not in metres and seconds.
  pure function in_units(model, acceleration) result(text)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: acceleration !< [m/s2]
    character(:), allocatable :: text
    character(24) :: room
    text = as_text(acceleration)
    if (model%has_other_acceleration) return
    write (room, '(f0.4)') acceleration/one_g
    text = trim(room)
    if (text(1:1) == '.') text = '0'//text
    text = as_text(acceleration)//' m/s2 = '//text//' g'
  end function in_units
end module motion_peaks
