!> *CONTROLS, ACCURACY at the end of its step: where it has no meaning, and between which sizes
!> increments may vary.
module check_accuracy
  use amplitudes, only: spacing_of, spacing_of_times
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use step_plan, only: step_load
  implicit none
  private
  public :: set_accuracy_limits

  !> Increments that the estimated error may choose, over the first increment.
  real(rk), parameter :: finest_ratio = 0.125_rk, longest_ratio = 4.0_rk
  real(rk), parameter :: round_off = 1.0e-6_rk !< of a sampling interval
  character(*), parameter :: reduced = 'REDUCED' !< scheme

contains

  !> *CONTROLS may precede the procedure: the step is checked at its end.
  subroutine set_accuracy_limits(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_named
    integer :: i
    is_named = .false.
    do i = model%step_origin%card, model%current
      if (.not. model%cards(i)%keyword == 'CONTROLS') cycle
      if (.not. model%cards(i)%has('ACCURACY')) cycle
      is_named = .true.
      if (model%cards(i)%real('ACCURACY') > 0.0_rk) call refuse(model, model%cards(i), faults)
    end do
    associate (now => model%now)
      if (now%procedure%scheme == reduced .and. now%controls%accuracy > 0.0_rk) then
        if (.not. is_named) call model%cards(model%current_procedure)%warn( &
          faults, 'ACCURACY of *CONTROLS of an earlier step has no effect on a reduced model, '// &
          'which is tried with one increment', 'ACCURACY=0 in this step, or no REDUCED')
        now%controls%accuracy = 0.0_rk
      end if
      if (.not. now%follows_accuracy()) return
      now%finest_increment = finest_ratio*now%first_increment
      if (is_given(model, 3)) now%finest_increment = now%smallest_increment
      if (is_given(model, 4)) return
      now%largest_increment = max(now%finest_increment, &
                                  min(longest_ratio*now%first_increment, &
                                      (1.0_rk + round_off)*shortest_sample(model)))
    end associate
  end subroutine set_accuracy_limits

  !> Errors where no estimate could choose the size.
  subroutine refuse(model, given, faults)
    type(draft), intent(in) :: model
    type(card), intent(in) :: given
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%now)
      if (now%procedure%name == '') return
      if (.not. now%procedure%has_inertia) then
        call given%fault_parameter(faults, 'ACCURACY', 'ACCURACY has no meaning in a step *'// &
                                   trim(now%procedure%name)//', which has no error in time', &
                                   'ACCURACY in a step *DYNAMIC')
      else if (now%procedure%scheme == reduced) then
        call given%fault_parameter(faults, 'ACCURACY', 'ACCURACY and *DYNAMIC, REDUCED exclude '// &
                                   'each other: a reduced model is tried with one increment', &
                                   'no REDUCED, or no ACCURACY of *CONTROLS (half the '// &
                                   'increment shows its error)')
      else if (now%is_direct) then
        call given%fault_parameter(faults, 'ACCURACY', 'ACCURACY and *DYNAMIC, DIRECT exclude '// &
                                   'each other: DIRECT fixes the increment', &
                                   'no DIRECT, or no ACCURACY')
      end if
    end associate
  end subroutine refuse

  !> Whether the procedure names the smallest (3) or the largest (4) increment.
  pure logical function is_given(model, column)
    type(draft), intent(in) :: model
    integer, intent(in) :: column
    is_given = .false.
    associate (own => model%cards(model%current_procedure))
      if (own%num_lines > 0) is_given = .not. own%is_empty_at(1, column)
    end associate
  end function is_given

  !> The shortest sampling interval of the amplitudes and temperatures of the step.
  pure real(rk) function shortest_sample(model) result(shortest)
    type(draft), intent(in) :: model
    type(step_load), allocatable :: loads(:)
    logical :: is_used(model%num_amplitudes)
    integer :: i
    shortest = 0.5_rk*huge(1.0_rk) ! the caller adds round-off
    loads = model%active_loads%loads_of_step()
    is_used = model%supports%follows(size(is_used)) .or. model%point_forces%follows(size(is_used))
    is_used(pack(loads%amplitude, loads%amplitude > 0)) = .true.
    if (allocated(model%now%heats)) then
      do i = 1, size(model%now%heats)
        associate (rule => model%now%heats(i))
          if (rule%amplitude > 0) is_used(rule%amplitude) = .true.
          shortest = min(shortest, spacing_of_times(rule%time))
        end associate
      end do
    end if
    do i = 1, size(is_used)
      if (is_used(i)) shortest = min(shortest, spacing_of(model%problem%amplitudes(i)))
    end do
  end function shortest_sample
end module check_accuracy
