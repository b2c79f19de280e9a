!> Time of the envelopes S1 and DAMAGET of an increment over one solve, for shares of cracked
!> elements: bench_envelopes ACROSS ALONG OVER BLOCKS. The bench sets the state of the points.
program bench_envelopes
  use integrator_catalogue, only: procedure_named
  use kinds, only: rk, long
  use errors, only: error_type
  use problem_definition, only: problem
  use row_tables, only: row_table
  use step_plan, only: step, step_fixity
  use analysis_state, only: state
  use material_law, only: start_points
  use inelastic_blocks, only: list_inelastic_blocks
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use matrix_pattern, only: pattern
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use pattern_builder, only: list_cells, build_pattern
  use assemble_elements, only: assemble_stiffness
  use blas_threads, only: restart_with_fast_libraries
  use solver_cholmod, only: cholmod_solver
  use run_records, only: run_record
  use arch_model, only: make_arch
  use hand_law, only: by_hand, set_elastic
  implicit none
  real(rk), parameter :: shares(5) = [0.0_rk, 0.01_rk, 0.05_rk, 0.3_rk, 1.0_rk]
  integer, parameter :: repeats = 20, warm_up = 4 !< increments; the operator is made in the third
  type(problem), target :: model
  type(step_fixity), allocatable :: fixities(:)
  type(state) :: now
  real(rk) :: solve
  integer :: sizes(4), k
  character(20) :: word
  call restart_with_fast_libraries(0)
  do k = 1, 4
    call get_command_argument(k, word)
    read (word, *) sizes(k)
  end do
  call make_arch(sizes(1), sizes(2), sizes(3), sizes(4), model, fixities)
  solve = time_of_solve()
  write (*, '(i0,a,f8.4,a)') model%mesh%num_elements, ' elements, one solve ', solve, ' s'
  call prepare()
  do k = 1, size(shares)
    call crack(shares(k))
    call report(shares(k))
  end do

contains

  !> Seconds of one solve with the stiffness of the model.
  real(rk) function time_of_solve() result(seconds)
    type(numbering) :: numbers
    type(guest_reference), allocatable :: guests(:)
    type(row_table) :: cells
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(error_type), allocatable :: error
    real(rk), allocatable :: stiffness(:), q(:, :)
    real(rk) :: start
    integer :: i
    deallocate (model%joints)
    allocate (model%joints(0))
    call number_step(model%mesh, model%joints, model%guests, fixities, numbers, error)
    call guests_of_model(model, guests)
    call list_cells(model%mesh, guests, cells)
    call build_pattern(numbers, cells, matrix)
    call assemble_stiffness(model, numbers, matrix, stiffness, error)
    call solver%analyse(matrix, error)
    call solver%factorise(matrix, stiffness, error)
    if (allocated(error)) error stop 'factor'
    allocate (q(numbers%num_free, 1), source=1.0_rk)
    call solver%solve(q, error)
    start = wall()
    do i = 1, repeats
      call solver%solve(q, error)
    end do
    seconds = (wall() - start)/repeats
  end function time_of_solve

  !> Gives the model a law with a history, and a step with both envelopes.
  subroutine prepare()
    type(by_hand) :: law
    type(step) :: plan
    integer :: i
    law%num_state = 11
    law%is_nonlinear = .true.
    deallocate (model%materials(1)%law)
    allocate (model%materials(1)%law, source=law)
    model%mesh%section_of_element = 1
    allocate (model%surfaces(0))
    call list_inelastic_blocks(model%mesh, model%materials, model%inelastic)
    plan%name = 'bench'
    plan%procedure = procedure_named('STATIC')
    plan%envelope = ['S1      ', 'DAMAGET ']
    allocate (model%steps(1))
    model%steps(1) = plan
    allocate (now%u(3, model%mesh%num_nodes), now%points(size(model%inelastic)))
    allocate (now%joints(0))
    call random_number(now%u)
    now%step = 1
    do i = 1, size(model%inelastic)
      call start_points(law, model%inelastic(i)%points, now%points(i))
    end do
    call set_elastic(model, now)
  end subroutine prepare

  !> Cracks whole blocks of 16 elements, since neighbours of cracked elements crack.
  subroutine crack(share)
    real(rk), intent(in) :: share
    integer :: i
    do i = 1, size(now%points)
      if (i > share*size(now%points)) exit
      now%points(i)%is_elastic = .false.
      now%points(i)%internal(1, :) = 0.9_rk
    end do
  end subroutine crack

  !> Prints the seconds of an increment's envelopes, and their ratio to one solve.
  subroutine report(share)
    real(rk), intent(in) :: share
    type(run_record) :: record
    real(rk) :: start, seconds
    integer :: i
    call record%open(model)
    call record%begin_step(model, 1)
    do i = 1, warm_up
      call record%note(model, now)
    end do
    start = wall()
    do i = 1, repeats
      call record%note(model, now)
    end do
    seconds = (wall() - start)/repeats
    write (*, '(a,f5.0,a,f8.4,a,f6.2,a)') 'cracked ', 100.0_rk*share, ' %: ', seconds, ' s, ', &
      seconds/solve, ' solves'
  end subroutine report

  !> The clock [s].
  real(rk) function wall() result(seconds)
    integer(long) :: ticks, rate
    call system_clock(ticks, rate)
    seconds = real(ticks, rk)/real(rate, rk)
  end function wall
end program bench_envelopes
