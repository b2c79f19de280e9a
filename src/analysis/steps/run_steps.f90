!> Runs the steps of a problem one after the other; the state goes from each to the next.
module run_steps
  use kinds, only: rk
  use errors, only: error_type, raise
  use problem_definition, only: problem
  use analysis_state, only: state
  use increment_listener, only: listener
  use time_static, only: run_static
  use time_hht, only: run_dynamic
  use time_frequency, only: run_frequency
  implicit none
  private
  public :: run_all_steps

contains

  !> Runs all steps. On an error `now` is the last state that converged; the listener has had it.
  subroutine run_all_steps(scene, now, results, error)
    type(problem), intent(in) :: scene
    type(state), intent(inout) :: now !< as `start_analysis` makes it
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, size(scene%steps)
      now%step = i
      now%increment = 0
      now%iterations = 0
      now%cutbacks = 0
      now%step_time = 0.0_rk
      now%increment_size = 0.0_rk
      now%residual = 0.0_rk
      now%is_last_of_step = .false.
      associate (plan => scene%steps(i))
        select case (plan%procedure)
        case ('STATIC')
          call run_static(scene, plan, now, results, error)
        case ('DYNAMIC')
          call run_dynamic(scene, plan, now, results, error)
        case ('FREQUENCY')
          call run_frequency(scene, plan, now, results, error)
        case default
          call raise(error, "step '"//plan%name//"' has no procedure")
        end select
      end associate
      if (allocated(error)) return
    end do
  end subroutine run_all_steps
end module run_steps
