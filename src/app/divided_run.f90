!> A run of several ranks. Rank 0 runs the analysis as the plain program does; the other ranks take
!> the same path with results that write nothing.
module divided_run
  use, intrinsic :: iso_fortran_env, only: error_unit
  use analysis_state, only: state, vibration_mode
  use block_parts, only: divide_blocks
  use cli, only: command_line
  use diagnostic_text, only: text_of_warnings
  use diagnostics, only: diagnostic_list, place, severity_warning
  use element_parts, only: divide_elements
  use errors, only: deck_is_wrong, error_type, keep_first, raise
  use file_system, only: base_name
  use increment_listener, only: listener
  use initial_state, only: start_analysis
  use node_parts, only: divide_nodes
  use omp_lib, only: omp_get_num_procs
  use problem_definition, only: problem
  use rank_balance, only: balance_of_ranks, gather_balance
  use ranks, only: is_first_rank, number_of_first_rank, num_ranks, num_ranks_here, share_error
  use run_checkpoint, only: load_chosen_state
  use run_ledger, only: ledger
  use step_loop, only: run_all_steps
  use stop_signals, only: outlive_signal
  use undivided_effects, only: refuse_undivided
  use unknown_layout, only: choose_solver
  use user_routines, only: end_user_routines
  implicit none
  private
  public :: adapt_options, divide_problem, assist_run, chosen_checkpoint

  !> Results of the ranks that write none.
  type, extends(listener) :: silent_listener
  contains
    procedure :: increment_done, modes_found
  end type silent_listener

contains

  !> Makes other ranks than the first silent, divides the processors of a machine among its ranks,
  !> and refuses what one process does.
  subroutine adapt_options(options, error)
    type(command_line), intent(inout) :: options
    type(error_type), allocatable, intent(out) :: error
    if (num_ranks() == 1) return
    if (.not. is_first_rank()) options%is_quiet = .true.
    if (options%num_threads == 0) options%num_threads = max(1, omp_get_num_procs() &
                                                            /num_ranks_here())
    if (options%most_unsaved == huge(1)) return
    call raise(error, 'keyway: --save-joint-problems works in one process only; start '// &
               'without mpiexec', deck_is_wrong)
  end subroutine adapt_options

  !> Gives each rank its elements, for a run; refuses what several ranks cannot do. One rank has the
  !> solvers of several where --solver asks for one.
  subroutine divide_problem(options, model, remarks, error)
    type(command_line), intent(in) :: options
    type(problem), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: remarks !< warnings of the deck
    type(error_type), allocatable, intent(out) :: error
    if (num_ranks() == 1 .and. options%solver == choose_solver) return
    model%equation_solver = options%solver
    if (options%is_material) return
    call refuse_undivided(model, error)
    if (.not. allocated(error)) call take_double_precision(options, model, remarks)
    if (.not. allocated(error) .and. .not. options%is_check) then
      call divide_elements(model%mesh, error)
      if (.not. allocated(error)) call divide_blocks(model%mesh, model%inelastic)
      if (.not. allocated(error)) call divide_nodes(model)
    end if
    call share_error(error)
  end subroutine divide_problem

  !> Steps with PRECISION=SINGLE or MIXED have factors in double precision, with a warning.
  subroutine take_double_precision(options, model, remarks)
    type(command_line), intent(in) :: options
    type(problem), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: remarks
    type(diagnostic_list) :: found
    type(place) :: spot
    integer :: i
    do i = 1, size(model%steps)
      associate (plan => model%steps(i))
        if (plan%controls%precision == 'DOUBLE' .or. plan%procedure%finds_modes) cycle
        spot%file = model%deck_file
        spot%line = plan%line
        spot%keyword = trim(plan%procedure%name)
        call found%add(severity_warning, spot, 'PRECISION='//trim(plan%controls%precision)// &
                       ' of *CONTROLS has no effect: the solvers of several processes work '// &
                       'in double precision', 'PRECISION=DOUBLE, or a run without mpiexec and '// &
                       '--solver')
        call remarks%add(severity_warning, spot, found%warnings(found%num_warnings)%problem, &
                         found%warnings(found%num_warnings)%expected)
        plan%controls%precision = 'DOUBLE'
      end associate
    end do
    if (found%num_warnings == 0 .or. options%is_quiet) return
    write (error_unit, '(a)') text_of_warnings(found, is_named=.true.)
  end subroutine take_double_precision

  !> The part of the ranks that write nothing in a run; the calls of `share_error` meet those of
  !> run_analysis.
  subroutine assist_run(model, options, costs, error)
    type(problem), intent(inout) :: model
    type(command_line), intent(in) :: options
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(silent_listener) :: results
    type(state), allocatable :: now
    type(error_type), allocatable :: failure
    type(balance_of_ranks) :: ignored
    logical :: is_old
    call outlive_signal()
    results%costs = costs
    results%log%is_quiet = .true.
    if (options%is_continued) then
      call start_analysis(model, now, error)
      call share_error(error)
      if (.not. allocated(error)) then
        is_old = chosen_checkpoint(.false.)
        call load_chosen_state(options%folder//'/'//base_name(model%deck_file), is_old, now, error)
        call share_error(error)
      end if
    end if
    call share_error(error)
    if (allocated(error)) return
    if (.not. allocated(now)) call start_analysis(model, now, error)
    if (.not. allocated(error)) call run_all_steps(model, now, results, error)
    call share_error(error)
    if (.not. allocated(error)) call gather_balance(costs, model%mesh%rank_of_element, ignored)
    call end_user_routines(model, now%total_time, results%log, failure)
    call keep_first(error, failure)
  end subroutine assist_run

  !> Whether the first rank goes on from the checkpoint before the last, on all ranks.
  logical function chosen_checkpoint(is_old) result(is_chosen)
    logical, intent(in) :: is_old !< the choice of the first rank
    is_chosen = number_of_first_rank(merge(1, 0, is_old)) == 1
  end function chosen_checkpoint

  !> Writes nothing.
  subroutine increment_done(self, model, now, error)
    class(silent_listener), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(error_type), allocatable, intent(out) :: error
    if (allocated(self%duals)) deallocate (self%duals)
  end subroutine increment_done

  !> Writes nothing.
  subroutine modes_found(self, model, step, modes, error)
    class(silent_listener), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(vibration_mode), intent(in) :: modes(:)
    type(error_type), allocatable, intent(out) :: error
  end subroutine modes_found
end module divided_run
