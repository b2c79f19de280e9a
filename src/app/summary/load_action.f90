!> What a load does in a step, for the summary of a model: its factor, the sum of point forces, and
!> the peak of a motion.
module load_action
  use amplitudes, only: one_g
  use check_motions, only: find_peak
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use load_point, only: point_load
  use problem_definition, only: problem
  use step_plan, only: span_of_step, step_load
  use summary_rows, only: unit
  use write_text, only: as_text
  implicit none
  private
  public :: action_of_load

contains

  !> 'factor 0 to 9.81', 'factor 2 times amplitude RAMP', with the sum of point forces, or the peak
  !> of a base motion.
  pure function action_of_load(model, number, work) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(step_load), intent(in) :: work
    character(:), allocatable :: text
    text = factor_of(model, number, work)//sum_of_forces(model, work)// &
           peak_of_motion(model, number, work)
  end function action_of_load

  !> ', sum of the forces 0 0 -4e6 N, loaded nodes: 4' of point forces, '' of other loads.
  pure function sum_of_forces(model, work) result(text)
    type(problem), intent(in) :: model
    type(step_load), intent(in) :: work
    character(:), allocatable :: text
    integer :: i
    text = ''
    select type (forces => model%loads(work%load)%item)
    type is (point_load)
      text = ', sum of the forces'
      do i = 1, size(forces%force, 1)
        text = text//' '//as_text(sum(forces%force(i, :)))
      end do
      text = text//unit(model, ' N')//', loaded nodes: '//as_text(size(forces%nodes))
    end select
  end function sum_of_forces

  !> The factor: that of an amplitude, a ramp, or one that changes at once where there is inertia.
  pure function factor_of(model, number, work) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(step_load), intent(in) :: work
    character(:), allocatable :: text
    text = 'factor '//as_text(work%end_factor)
    if (work%amplitude > 0) then
      text = text//' times amplitude '//model%amplitudes(work%amplitude)%name
    else if (.not. model%steps(number)%procedure%has_inertia) then
      text = 'factor '//as_text(work%start_factor)//' to '//as_text(work%end_factor)
    else if (abs(work%end_factor - work%start_factor) > 0.0_rk) then
      text = text//' from the start, '//as_text(work%start_factor)//' before'
    end if
  end function factor_of

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
end module load_action
