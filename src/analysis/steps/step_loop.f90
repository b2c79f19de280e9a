!> Runs the steps of a problem one after the other. This loop serves all procedures: it chooses,
!> cuts, accepts and reports increments. The integrator of the step computes the trial state.
module step_loop
  use kinds, only: rk
  use error_in_time, only: make_norm, motion_norm, note_error_in_time
  use errors, only: error_type, raise, system_failed
  use problem_definition, only: problem
  use step_plan, only: step
  use block_answers, only: gather_points
  use analysis_state, only: last_matrix, reduction_status, state, time_accuracy
  use step_control, only: increment_control, start_control
  use increment_listener, only: listener
  use equilibrium, only: balance_outcome, is_dropped
  use solver_petsc, only: method_text
  use step_loads, only: step_time
  use joint_water, only: record_uplift
  use matrix_pattern, only: pattern
  use modal_errors, only: modal_error
  use motion_parts, only: take_own_motion
  use path_sampling, only: sample_paths
  use ranks, only: is_first_rank
  use integrator_type, only: integrator
  use stage_entry, only: enter_stage, show_stage
  use integrator_catalogue, only: make_integrator
  use step_report, only: check_count, close_increment, count_increment, line_of_cut, report_failure
  use tangent_choice, only: choose_tangents, tangent
  use user_increments, only: begin_user_increment
  use warming, only: warm
  implicit none
  private
  public :: run_all_steps

  !> The current increment.
  type :: attempt
    type(state), allocatable :: trial
    type(step_time) :: when !< its end
    type(balance_outcome) :: outcome
    type(increment_control) :: control !< before the first cut of the increment
    type(motion_norm), allocatable :: norm !< of the error in time; only where needed
  end type attempt

contains

  !> Runs all steps. A loaded state continues where it was saved. On an error `now` is the last
  !> converged state; the listener has it.
  subroutine run_all_steps(model, now, results, error)
    type(problem), intent(inout) :: model !< its mesh takes the elements of each stage
    type(state), allocatable, intent(inout) :: now !< as `start_analysis` makes it, or loaded
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    class(integrator), allocatable :: method
    integer :: i
    if (now%step > 0) call show_stage(model, now%step)
    call take_own_motion(model, now)
    do i = first_step(now), size(model%steps)
      call make_integrator(model%steps(i)%procedure, method)
      if (i == now%step .and. now%has_opened_step) then
        call reopen_step(model, model%steps(i), method, now, results, error)
      else
        call enter_stage(model, i, now, error)
        if (allocated(error)) return
        call enter_step(i, model%steps(i), now)
        call method%open_step(model, model%steps(i), now, results, error)
      end if
      if (allocated(error)) return
      now%has_opened_step = .true.
      if (method%system%matrix%is_shared) then
        call results%log%say("step '"//model%steps(i)%name//"': "// &
                             method_of_step(model, model%steps(i), method%system%matrix))
      end if
      call run_increments(model, model%steps(i), method, now, results, error)
      if (allocated(error)) return
      call report_iterations(model%steps(i), method, results)
      call method%close_step(model, model%steps(i), now, results, error)
      if (allocated(error)) return
    end do
  end subroutine run_all_steps

  !> The number of equations and how several processes solve them.
  function method_of_step(model, plan, matrix) result(text)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(pattern), intent(in) :: matrix !< with a layout
    character(:), allocatable :: text
    type(tangent), allocatable :: choices(:)
    choices = choose_tangents(model, plan)
    text = method_text(matrix%layout)
    if (.not. all(choices%is_symmetric())) text = text//', unsymmetric tangents by MUMPS'
  end function method_of_step

  !> Says what the solves of a step have taken, and how they were done, where the solver says it.
  subroutine report_iterations(plan, method, results)
    type(step), intent(in) :: plan
    class(integrator), intent(in) :: method
    class(listener), intent(inout) :: results
    character(:), allocatable :: text
    if (.not. allocated(method%solids%solver)) return
    if (.not. allocated(method%solids%solver%factor)) return
    text = method%solids%solver%factor%describe_iterations()
    if (text /= '') call results%log%say("step '"//plan%name//"': "//text)
    text = method%solids%solver%repeated%describe()
    if (text /= '') call results%log%say("step '"//plan%name//"': "//text)
  end subroutine report_iterations

  !> The step that a state goes on with: the one that it is in, unless the state is its end.
  pure integer function first_step(now)
    type(state), intent(in) :: now
    first_step = max(1, now%step)
    if (now%is_last_of_step) first_step = now%step + 1
  end function first_step

  !> Sets the counters of a step to its start, and keeps what later increments need of the start.
  subroutine enter_step(number, plan, now)
    integer, intent(in) :: number
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    integer :: k
    now%step = number
    now%increment = 0
    now%iterations = 0
    now%cutbacks = 0
    now%step_time = 0.0_rk
    now%increment_size = 0.0_rk
    now%residual = 0.0_rk
    now%has_opened_step = .false.
    now%is_last_of_step = .false.
    now%step_start = now%total_time
    now%matrix = last_matrix()
    now%reduction = reduction_status()
    now%accuracy = time_accuracy()
    now%timing = modal_error()
    associate (fixed => plan%fixities)
      now%support_start = [(now%u(fixed(k)%dof, fixed(k)%node), k=1, size(fixed))]
    end associate
  end subroutine enter_step

  !> Opens a step for a state that was loaded, of its start or its middle. The integrator builds the
  !> equations with supports where they stood at the start of the step. What the integrator computes
  !> of motion and energies belongs to a start: the loaded state replaces it.
  subroutine reopen_step(model, plan, method, now, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(inout) :: method
    type(state), allocatable, intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(state), allocatable :: loaded
    integer :: k
    loaded = now
    if (fits(plan, loaded)) then
      do k = 1, size(plan%fixities)
        now%u(plan%fixities(k)%dof, plan%fixities(k)%node) = loaded%support_start(k)
      end do
      call method%open_step(model, plan, now, results, error)
      if (allocated(error)) return
      if (size(now%motion%q) == size(loaded%motion%q) &
          .and. now%num_unknowns == loaded%num_unknowns) then
        call move_alloc(loaded, now)
        call method%resume(now, error)
        if (.not. allocated(error)) then
          call restore_matrix(model, plan, method, now, results, error)
        end if
        return
      end if
    end if
    call raise(error, "the loaded state does not belong to step '"//plan%name//"' of this "// &
               'model: supports, ties or the procedure of the step are others', system_failed)
  end subroutine reopen_step

  !> Factors the matrix that the loaded increment has ended with, and takes the blocks of the
  !> compliance of joints that it had.
  subroutine restore_matrix(model, plan, method, now, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(inout) :: method
    type(state), intent(in) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    if (now%matrix%increment_size > 0.0_rk) then
      call method%start_increment(model, plan, now%matrix%increment_size, results, error)
      if (allocated(error)) return
    end if
    associate (solids => method%solids)
      solids%matrix%number = now%matrix%number
      if (solids%has_inelastic()) then
        call solids%matrix%restore(model, method%system, solids%values, solids%weight, &
                                   solids%solver, now%matrix, error)
        if (allocated(error)) return
      end if
      if (now%matrix%has_all_blocks) then
        call solids%solver%take_all_blocks(error)
      end if
    end associate
  end subroutine restore_matrix

  !> Whether a loaded state has what its step needs to go on.
  pure logical function fits(plan, loaded)
    type(step), intent(in) :: plan
    type(state), intent(in) :: loaded
    fits = allocated(loaded%support_start) .and. allocated(loaded%motion%q)
    if (.not. fits) return
    fits = size(loaded%support_start) == size(plan%fixities) &
           .and. (allocated(loaded%motion%inertia) .eqv. plan%procedure%has_inertia)
  end function fits

  !> Increments to the end of a step.
  subroutine run_increments(model, plan, method, now, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(inout) :: method
    type(state), allocatable, intent(inout) :: now !< converged
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(attempt) :: next
    if (plan%procedure%finds_modes) return
    next%when = step_time(is_dynamic=plan%procedure%has_inertia, start=now%step_start, &
                          duration=plan%duration)
    if (now%increment == 0) call start_control(plan, plan%procedure%has_inertia, now%control)
    if (plan%follows_accuracy()) then
      allocate (next%norm)
      call make_norm(method%system, next%norm)
    end if
    next%trial = now
    next%control = now%control
    do while (now%step_time < plan%duration)
      call check_count(plan, now, error)
      if (allocated(error)) return
      call try_increment(model, plan, method, now, next, results, error)
      if (allocated(error)) return
      if (next%outcome%has_converged) then
        call accept(model, plan, method, now, next, results, error)
      else if (is_dropped(method%solids%solver%controls)) then
        now%control = next%control
        call results%increment_dropped(model, now, error)
      else
        call cut(model, plan, method, now, next, error)
        if (.not. allocated(error)) then
          call results%log%note(line_of_cut(model, method%system, next%outcome, now))
        end if
      end if
      if (allocated(error)) return
    end do
  end subroutine run_increments

  !> One attempt at the next increment.
  subroutine try_increment(model, plan, method, now, next, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(inout) :: method
    type(state), intent(in) :: now
    type(attempt), intent(inout) :: next
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: size
    size = now%control%next_size(now%step_time)
    call next%when%set_end(now%step_time, size)
    call begin_user_increment(model, now, size, error)
    if (allocated(error)) return
    call method%start_increment(model, plan, size, results, error)
    if (allocated(error)) return
    call method%solids%open_increment(now, size)
    method%solids%solver%controls%may_be_dropped = .true.
    next%trial%increment_status = now%increment_status
    call warm(model, plan, next%when, now, next%trial, method%system, results%costs)
    call method%advance(model, next%when, now, next%trial, results, next%outcome, error)
  end subroutine try_increment

  !> The trial becomes the converged state.
  subroutine accept(model, plan, method, now, next, results, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(inout) :: method
    type(state), allocatable, intent(inout) :: now
    type(attempt), intent(inout) :: next
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    associate (trial => next%trial, groups => method%system%groups)
      call record_uplift(model, plan%loads, groups, next%when, trial%joints, results%costs)
      call method%solids%matrix%store(trial%matrix)
      trial%matrix%has_all_blocks = method%solids%solver%has_all_blocks
      call trial%control%accept(method%solids%effort(next%outcome%own_iterations()))
      if (allocated(next%norm)) call follow_error(plan, now, next, results)
      if (method%solids%has_inelastic()) then
        call results%costs%start('recover', 'inelastic solids', 'inelastic')
        call gather_points(model%inelastic, trial%points)
        call results%costs%stop()
        call follow_law(model, plan, method, now, trial, results)
      end if
      call count_increment(plan, next%when, next%outcome, trial)
      call method%store_state(model, next%when, trial, results, error)
    end associate
    if (allocated(error)) return
    call swap(now, next%trial)
    next%control = now%control
    call close_increment(model, now, results, error)
  end subroutine accept

  !> What the laws of solids leave open within the increment. A step without estimates forgets the
  !> twins: they would miss its increments.
  subroutine follow_law(model, plan, method, now, trial, results)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(in) :: method
    type(state), intent(inout) :: now, trial
    class(listener), intent(inout) :: results
    if (.not. plan%controls%estimates_errors) then
      if (allocated(now%twins)) deallocate (now%twins)
      if (allocated(trial%twins)) deallocate (trial%twins)
      trial%path%num_points = 0
      return
    end if
    if (.not. is_first_rank()) return ! it has all points
    call results%costs%start('estimate', 'law', 'output')
    call move_alloc(now%twins, trial%twins)
    call sample_paths(model, method%solids%time, now%points, trial%points, trial%twins, trial%path)
    call results%costs%stop()
  end subroutine follow_law

  !> The estimated error in time chooses the size of the next increment.
  subroutine follow_error(plan, now, next, results)
    type(step), intent(in) :: plan
    type(state), intent(in) :: now
    type(attempt), intent(inout) :: next
    class(listener), intent(inout) :: results
    integer :: doublings
    call results%costs%start('estimate', 'increments', 'output')
    call note_error_in_time(plan, next%norm, next%when%increment, now, next%trial, doublings)
    call next%trial%control%follow_error(next%when%now, doublings)
    call results%costs%stop()
  end subroutine follow_error

  !> Cuts the increment, or ends the run, at once where even the smallest increment is hopeless.
  subroutine cut(model, plan, method, now, next, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    class(integrator), intent(in) :: method
    type(state), intent(inout) :: now
    type(attempt), intent(in) :: next
    type(error_type), allocatable, intent(out) :: error
    type(step_time) :: least
    logical :: gives_up
    call now%control%cut(next%when%increment, next%outcome%size_ratio, gives_up)
    if (.not. gives_up .and. now%control%cuts_in_a_row == 1) then
      least = next%when
      call least%set_end(now%step_time, now%control%least_size())
      gives_up = method%is_hopeless(model, plan, least, now)
      if (gives_up) then
        now%control%size = 0.0_rk ! below the smallest, which the message then names
        now%control%cutbacks = now%control%cutbacks - 1
      end if
    end if
    if (.not. gives_up) return
    call report_failure(model, method%system, next%outcome, now, error)
    if (allocated(next%outcome%failure)) return
    call method%explain_failure(model, plan, next%when, now, next%trial, error)
  end subroutine cut

  !> Swaps two states without a copy.
  subroutine swap(now, trial)
    type(state), allocatable, intent(inout) :: now, trial
    type(state), allocatable :: other
    call move_alloc(now, other)
    call move_alloc(trial, now)
    call move_alloc(other, trial)
  end subroutine swap
end module step_loop
