!> Times of the linear parts on a curved plate: bench_linear ACROSS ALONG OVER BLOCKS.
program bench_linear
  use kinds, only: rk, long
  use errors, only: error_type
  use problem_definition, only: problem
  use row_tables, only: row_table
  use step_plan, only: step_fixity
  use analysis_state, only: vibration_mode
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use matrix_pattern, only: pattern, multiply, position_of
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use pattern_builder, only: list_cells, build_pattern
  use assemble_elements, only: assemble_stiffness, assemble_mass
  use blas_threads, only: restart_with_fast_libraries
  use nested_dissection, only: dissect
  use solver_cholmod, only: cholmod_solver
  use eigen_modes, only: find_modes
  use arch_model, only: make_arch
  implicit none
  type(problem), target :: model
  type(step_fixity), allocatable :: fixities(:)
  type(numbering) :: numbers
  type(guest_reference), allocatable :: guests(:)
  type(row_table) :: cells
  type(pattern) :: matrix
  type(error_type), allocatable :: error
  type(vibration_mode), allocatable :: modes(:)
  type(cholmod_solver) :: solver, other
  real(rk), allocatable :: stiffness(:), mass(:), q(:, :), y(:)
  integer, allocatable :: order(:)
  integer(long) :: start
  real(rk) :: cpu_start
  integer :: sizes(4), k, j
  character(20) :: word
  call restart_with_fast_libraries(0)
  do k = 1, 4
    call get_command_argument(k, word)
    read (word, *) sizes(k)
  end do
  call make_arch(sizes(1), sizes(2), sizes(3), sizes(4), model, fixities)
  call begin()
  call number_step(model%mesh, model%joints, model%guests, fixities, numbers, error)
  call note('number')
  call guests_of_model(model, guests)
  call list_cells(model%mesh, guests, cells)
  call build_pattern(numbers, cells, matrix)
  call note('pattern')
  write (*, '(a,3(1x,i0))') 'free, jumps, entries:', numbers%num_free, numbers%num_jumps, &
    size(matrix%row)
  call assemble_stiffness(model, numbers, matrix, stiffness, error)
  call note('stiffness')
  do j = numbers%num_free - numbers%num_jumps + 1, numbers%num_free
    k = position_of(matrix, j, j)
    stiffness(k) = stiffness(k) + 1.0e11_rk
  end do
  call assemble_mass(model, numbers, matrix, mass, error)
  call note('mass')
  call dissect(matrix, order, error)
  call note('dissect')
  call solver%analyse(matrix, error)
  call note('analyse')
  call solver%factorise(matrix, stiffness, error)
  if (allocated(error)) error stop 'factor'
  call note('factor')
  call solver%factorise(matrix, stiffness, error)
  call note('factor again')
  call show_statistics(solver)
  allocate (q(numbers%num_total, 32), y(numbers%num_total))
  q = 1.0_rk
  call begin()
  do k = 1, 10
    call multiply(matrix, stiffness, q(:, 1), y)
  end do
  call note('10 multiply')
  call solver%solve(q(:numbers%num_free, :1), error)
  call begin()
  do k = 1, 10
    call solver%solve(q(:numbers%num_free, :1), error)
  end do
  call note('10 solves')
  q = 1.0_rk
  call solver%solve(q(:numbers%num_free, :), error)
  call note('solve of 32 columns')
  call find_modes(matrix, numbers, stiffness, mass, solver, 10, modes, error)
  if (allocated(error)) error stop 'modes'
  call note('10 modes')
  write (*, '(a,10f8.3)') 'Hz ', modes%hz
  other%uses_own_order = .true.
  call begin()
  call other%analyse(matrix, error)
  call note('analyse, order of CHOLMOD')
  call show_statistics(other)
contains

  subroutine begin()
    call system_clock(start)
    call cpu_time(cpu_start)
  end subroutine begin

  !> Seconds since the last note, of the clock and of all processors.
  subroutine note(what)
    character(*), intent(in) :: what
    integer(long) :: now, rate
    real(rk) :: cpu
    call system_clock(now, rate)
    call cpu_time(cpu)
    write (*, '(2f9.4,2a)') real(now - start, rk)/real(rate, rk), cpu - cpu_start, ' s  ', what
    call begin()
  end subroutine note

  subroutine show_statistics(which)
    type(cholmod_solver), intent(in) :: which
    real(rk) :: entries, bytes, peak
    call which%statistics(entries, bytes, peak)
    write (*, '(a,f9.2,a,2f9.1)') 'L ', entries*1.0e-6_rk, ' million entries; MB, peak MB', &
      bytes*1.0e-6_rk, peak*1.0e-6_rk
  end subroutine show_statistics
end program bench_linear
