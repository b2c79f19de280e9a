!> The program: command line, one analysis, exit code.
program keyway
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use blas_threads, only: restart_with_fast_libraries, warm_up_blas
  use check_deck, only: load_deck, report_model
  use cli, only: command_line, parse_command_line, print_answer
  use diagnostics, only: diagnostic_list
  use divided_run, only: adapt_options, assist_run, divide_problem
  use earlier_results, only: mark_earlier_results
  use errors, only: error_type
  use kinds, only: rk
  use message_help, only: named_message
  use omp_lib, only: omp_get_max_threads, omp_set_num_threads
  use problem_definition, only: problem
  use process_limits, only: end_trial, prepare_process, try_memory
  use ranks, only: end_ranks, is_alone, is_first_rank, is_true_everywhere, share_error, &
                   start_ranks
  use run_analysis, only: run_problem
  use run_ledger, only: ledger
  use run_lock, only: job_lock
  use run_material, only: run_tests
  use timer, only: wall_clock
  use umat_loader, only: keep_library
  use user_routines, only: close_user_routines
  implicit none

  interface
    !> C library: ends the program (`stop` would print its code).
    subroutine exit_program(code) bind(C, name='exit')
      import :: c_int
      implicit none
      integer(c_int), intent(in), value :: code
    end subroutine exit_program
  end interface

  type(command_line) :: options
  type(error_type), allocatable :: error
  type(problem), allocatable :: model
  type(diagnostic_list) :: remarks
  type(job_lock) :: lock
  character(:), allocatable :: echo
  type(ledger) :: costs
  integer(c_int) :: num_threads
  logical :: is_answered
  real(rk) :: started_at

  call prepare_process()
  started_at = wall_clock()
  call costs%open(started_at)
  call costs%start('start', 'program', 'run')
  call parse_command_line(options, error)
  if (.not. allocated(error) .and. len(options%deck) > 0) then
    call restart_with_fast_libraries(int(options%num_threads, c_int))
  end if
  call start_ranks()
  if (.not. allocated(error)) call adapt_options(options, error)
  call end_on(error)
  is_answered = .true.
  if (is_first_rank()) call print_answer(options, is_answered, error)
  call share_error(error)
  call end_on(error)
  if (is_true_everywhere(is_answered)) then
    call end_ranks(0_c_int)
    stop
  end if
  if (len(options%deck) == 0) then
    call keep_library(options%umat, error)
    call end_on(error)
    call end_ranks(0_c_int)
    stop
  end if
  if (options%num_threads > 0) call omp_set_num_threads(options%num_threads)
  num_threads = int(omp_get_max_threads(), c_int)
  call try_memory(num_threads)
  call warm_up_blas(num_threads)
  call end_trial()
  call costs%stop()
  call costs%start('read', 'deck', 'deck')
  call load_deck(options, lock, model, remarks, echo, error)
  call costs%stop()
  if (allocated(error)) then
    if (is_first_rank()) call mark_earlier_results(options, model, lock, error)
  end if
  call share_error(error)
  if (.not. allocated(error)) call divide_problem(options, model, remarks, error)
  call end_on(error)
  if (options%is_check) then
    if (is_first_rank()) call report_model(options, model, echo, costs, error)
  else if (options%is_material) then
    if (is_first_rank()) then
      call run_tests(model, options, remarks, echo, started_at, error)
    else
      call close_user_routines(model)
    end if
  else if (.not. is_first_rank()) then
    call assist_run(model, options, costs, error)
  else
    call run_problem(model, options, remarks, echo, costs, started_at, lock, error)
  end if
  call share_error(error)
  call end_on(error)
  call lock%give_back()
  call end_ranks(0_c_int)

contains

  !> Ends the program when there is an error.
  subroutine end_on(error)
    type(error_type), allocatable, intent(in) :: error
    logical :: speaks !< this rank, for all
    if (.not. allocated(error)) return
    call lock%give_back()
    speaks = is_first_rank()
    if (.not. speaks) speaks = is_alone()
    if (speaks .and. len(error%message) > 0) write (error_unit, '(a)') named_message(error%message)
    flush (output_unit)
    flush (error_unit)
    call end_ranks(int(error%exit_code, c_int))
    call exit_program(int(error%exit_code, c_int))
  end subroutine end_on
end program keyway
