!> Modes of a jointed arch: Lanczos against the dense way, effective masses, singular M.
program test_eigen_modes
  use kinds, only: rk
  use errors, only: error_type
  use row_tables, only: row_table
  use testing, only: test_log, check, check_close, check_text
  use problem_definition, only: problem
  use step_plan, only: step_fixity
  use analysis_state, only: vibration_mode
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use matrix_pattern, only: pattern, position_of
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use pattern_builder, only: list_cells, build_pattern
  use assemble_elements, only: assemble_stiffness, assemble_mass
  use scatter_matrix, only: scatter_blocks
  use solver_cholmod, only: cholmod_solver
  use eigen_modes, only: find_modes
  use arch_model, only: make_arch
  implicit none
  type(test_log) :: log
  type(problem), target :: model
  type(numbering) :: numbers
  type(pattern) :: matrix
  type(cholmod_solver) :: solver
  real(rk), allocatable :: stiffness(:), mass(:)
  type(vibration_mode), allocatable :: modes(:), lowest(:)
  log%suite = 'eigen_modes'
  call prepare()
  call arch_modes()
  call few_masses()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> The joints are held by springs of 1e11 N/m on each jump.
  subroutine prepare()
    type(step_fixity), allocatable :: fixities(:)
    type(guest_reference), allocatable :: guests(:)
    type(row_table) :: cells
    type(error_type), allocatable :: error
    integer :: j, k
    call make_arch(1, 3, 6, 2, model, fixities)
    call number_step(model%mesh, model%joints, model%guests, fixities, numbers, error)
    call guests_of_model(model, guests)
    call list_cells(model%mesh, guests, cells)
    call build_pattern(numbers, cells, matrix)
    call assemble_stiffness(model, numbers, matrix, stiffness, error)
    call assemble_mass(model, numbers, matrix, mass, error)
    do j = numbers%num_free - numbers%num_jumps + 1, numbers%num_free
      k = position_of(matrix, j, j)
      stiffness(k) = stiffness(k) + 1.0e11_rk
    end do
    call solver%analyse(matrix, error)
    call solver%factorise(matrix, stiffness, error)
    call check(log, allocated(error) .eqv. .false., 'factor')
  end subroutine prepare

  !> All modes are found in the dense way, a few by Lanczos.
  subroutine arch_modes()
    type(error_type), allocatable :: error
    real(rk) :: total
    integer :: i
    call find_modes(matrix, numbers, stiffness, mass, solver, numbers%num_free, modes, error)
    call check(log, allocated(error) .eqv. .false., 'all modes of a small model')
    if (allocated(error)) return
    total = 2400.0_rk*150.0_rk*1.745_rk*100.0_rk*19.0_rk
    do i = 1, 3
      call check(log, sum(modes%effective_mass(i)) < total, 'effective masses stay below the mass')
      call check(log, sum(modes%effective_mass(i)) > 0.7_rk*total, 'and reach most of it')
    end do
    call check(log, all(modes(2:)%hz >= modes(:size(modes) - 1)%hz), 'ascending')
    call find_modes(matrix, numbers, stiffness, mass, solver, 4, lowest, error)
    do i = 1, 4
      call check_close(log, lowest(i)%hz, modes(i)%hz, 1.0e-10_rk*modes(i)%hz, 'Lanczos and dense')
    end do
    call check_close(log, maxval(abs(lowest(3)%shape - modes(3)%shape)), 0.0_rk, &
                     1.0e-7_rk*maxval(abs(modes(3)%shape)), 'shapes')
    call find_modes(matrix, numbers, stiffness, mass, solver, 1000, modes, error)
    call check(log, allocated(error), 'more modes than unknowns is an error')
    if (allocated(error)) call check_text(log, error%message, '1000 modes are requested, but '// &
                                          'only 288 free degrees of freedom have mass', 'message')
  end subroutine arch_modes

  !> One node of a massless arch carries all the mass: f from its flexibility.
  subroutine few_masses()
    type(error_type), allocatable :: error
    real(rk), allocatable :: unit(:, :), blocks(:, :, :)
    integer :: node, unknown
    node = model%mesh%num_nodes
    unknown = findloc(numbers%node == 30 .and. numbers%direction == 2, .true., 1)
    mass = 0.0_rk
    allocate (blocks(3, 3, node), unit(numbers%num_free, 1))
    blocks = 0.0_rk
    blocks(2, 2, 30) = 1.0e6_rk
    call scatter_blocks(numbers, blocks, matrix, mass)
    call find_modes(matrix, numbers, stiffness, mass, solver, 1, modes, error)
    call check(log, allocated(error) .eqv. .false., 'a single mass')
    if (allocated(error)) return
    unit = 0.0_rk
    unit(unknown, 1) = 1.0_rk
    call solver%solve(unit, error)
    call check_close(log, (2.0_rk*acos(-1.0_rk)*modes(1)%hz)**2*1.0e6_rk*unit(unknown, 1), 1.0_rk, &
                     1.0e-12_rk, 'w^2 m G = 1')
    call check_close(log, modes(1)%effective_mass(2), 1.0e6_rk, 1.0e-3_rk, 'all of it takes part')
    call check_close(log, modes(1)%shape(2, 30), 1.0e-3_rk, 1.0e-12_rk, 'unit modal mass')
    call find_modes(matrix, numbers, stiffness, mass, solver, 2, modes, error)
    call check(log, allocated(error), 'there is no second mode')
  end subroutine few_masses
end program test_eigen_modes
