!> Times of the work that dependent nodes increase, for the first step of a deck: bench_ties DECK.
program bench_ties
  use kinds, only: long, rk
  use errors, only: error_type
  use diagnostics, only: diagnostic_list
  use problem_definition, only: problem
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use matrix_pattern, only: pattern
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use pattern_builder, only: list_cells, build_pattern
  use joint_operator, only: jump_operator, build_jump_operator
  use assemble_elements, only: assemble_stiffness
  use read_deck, only: read_problem
  use row_tables, only: row_table
  implicit none
  type(problem), allocatable, target :: model
  type(diagnostic_list) :: faults
  type(numbering) :: numbers
  type(guest_reference), allocatable :: guests(:)
  type(row_table) :: cells
  type(pattern) :: matrix
  type(jump_operator) :: operator
  type(error_type), allocatable :: error
  real(rk), allocatable :: stiffness(:)
  character(:), allocatable :: echo
  character(400) :: path
  integer(long) :: start
  call get_command_argument(1, path)
  call system_clock(start)
  call read_problem(trim(path), model, faults, echo)
  if (faults%has_errors()) error stop 'the deck has faults'
  call note('read')
  call number_step(model%mesh, model%joints, model%guests, model%steps(1)%fixities, numbers, error)
  if (allocated(error)) error stop 'numbering'
  call note('number')
  call guests_of_model(model, guests)
  call list_cells(model%mesh, guests, cells)
  call build_pattern(numbers, cells, matrix)
  call note('pattern')
  call build_jump_operator(numbers, model%joints, operator)
  call note('joints')
  call assemble_stiffness(model, numbers, matrix, stiffness, error)
  call note('stiffness')
  write (*, '(a,4(1x,i0))') 'free, jumps, terms of T, entries:', numbers%num_free, &
    numbers%num_jumps, size(numbers%unknown), size(matrix%row)
contains
  !> Prints the time since the last note.
  subroutine note(what)
    character(*), intent(in) :: what
    integer(long) :: now, rate
    call system_clock(now, rate)
    write (*, '(a,t12,f9.3,a)') what, real(now - start, rk)/real(rate, rk), ' s'
    call system_clock(start)
  end subroutine note
end program bench_ties
