!> Assembled matrices of a small jointed arch: symmetry of threads, rigid motion, masses, damping.
program test_assemble_elements
  use, intrinsic :: iso_fortran_env, only: int64
  use omp_lib, only: omp_set_num_threads
  use kinds, only: rk
  use errors, only: error_type
  use row_tables, only: row_table
  use testing, only: test_log, check, check_close, check_text
  use problem_definition, only: problem
  use step_plan, only: step_fixity
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use matrix_pattern, only: pattern, multiply
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use pattern_builder, only: list_cells, build_pattern
  use assemble_elements, only: assemble_stiffness, assemble_mass, assemble_damping
  use scatter_matrix, only: scatter_blocks
  use assemble_forces, only: rigid_translation, inertia_force
  use damping_rayleigh, only: rayleigh_coefficients
  use arch_model, only: make_arch
  implicit none
  type(test_log) :: log
  type(problem), target :: model
  type(numbering) :: numbers
  type(pattern) :: matrix
  real(rk), allocatable :: stiffness(:), mass(:)
  log%suite = 'assemble_elements'
  call prepare()
  call threads()
  call rigid_motion()
  call energy_of_blocks()
  call masses()
  call damping()
  call bad_element()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  subroutine prepare()
    type(step_fixity), allocatable :: fixities(:)
    type(guest_reference), allocatable :: guests(:)
    type(row_table) :: cells
    type(error_type), allocatable :: error
    call make_arch(2, 3, 4, 3, model, fixities)
    call number_step(model%mesh, model%joints, model%guests, fixities, numbers, error)
    call check(log, allocated(error) .eqv. .false., 'numbering')
    call check(log, numbers%num_jumps == 2*3*12, 'a jump for every pair')
    call guests_of_model(model, guests)
    call list_cells(model%mesh, guests, cells)
    call build_pattern(numbers, cells, matrix)
  end subroutine prepare

  subroutine threads()
    real(rk), allocatable :: again(:)
    type(error_type), allocatable :: error
    call omp_set_num_threads(1)
    call assemble_stiffness(model, numbers, matrix, stiffness, error)
    call check(log, allocated(error) .eqv. .false., 'stiffness')
    call omp_set_num_threads(2)
    call assemble_stiffness(model, numbers, matrix, again, error)
    call check(log, all(transfer(again, [1_int64]) == transfer(stiffness, [1_int64])), &
               'one and two threads agree to the last bit')
    call assemble_mass(model, numbers, matrix, mass, error)
  end subroutine threads

  !> A translation of everything, supports included, leaves no forces.
  subroutine rigid_motion()
    real(rk), allocatable :: r(:), y(:)
    integer :: i
    allocate (r(numbers%num_total), y(numbers%num_total))
    do i = 1, 3
      call rigid_translation(numbers, i, r)
      call multiply(matrix, stiffness, r, y)
      call check_close(log, maxval(abs(y)), 0.0_rk, 1.0e-12_rk*maxval(stiffness), 'K r = 0')
    end do
  end subroutine rigid_motion

  !> Jumps are other unknowns of the same motions: the energy is that of the separate blocks.
  subroutine energy_of_blocks()
    real(rk), allocatable :: q(:), y(:), u(:, :)
    integer :: k
    allocate (q(numbers%num_total), y(numbers%num_total), u(3, model%mesh%num_nodes))
    q = [(sin(real(k, rk)), k=1, numbers%num_total)]
    call numbers%expand(q, u)
    call multiply(matrix, stiffness, q, y)
    call check_close(log, dot_product(q, y), energy(u), 1.0e-12_rk*dot_product(q, y), &
                     'q K q is the energy of the elements')
  end subroutine energy_of_blocks

  !> Sum of u K_e u without joints: the same blocks, numbered separately.
  real(rk) function energy(u)
    real(rk), intent(in) :: u(:, :)
    type(problem) :: apart
    type(step_fixity), allocatable :: fixities(:)
    type(numbering) :: own
    type(pattern) :: own_matrix
    type(row_table) :: cells
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), q(:), y(:)
    call make_arch(2, 3, 4, 3, apart, fixities)
    call number_step(apart%mesh, apart%joints(:0), apart%guests, fixities(:0), own, error)
    call list_cells(apart%mesh, [guest_reference ::], cells)
    call build_pattern(own, cells, own_matrix)
    call assemble_stiffness(apart, own, own_matrix, values, error)
    allocate (q(own%num_total), y(own%num_total))
    q = reshape(u, [size(u)])
    call multiply(own_matrix, values, q, y)
    energy = dot_product(q, y)
  end function energy

  subroutine masses()
    type(error_type), allocatable :: error
    real(rk), allocatable :: lumped(:), force(:), r(:), blocks(:, :, :)
    real(rk) :: total(2)
    integer :: pass
    allocate (force(numbers%num_total), r(numbers%num_total))
    call rigid_translation(numbers, 2, r)
    do pass = 1, 2
      model%has_lumped_mass = pass == 2
      call assemble_mass(model, numbers, matrix, lumped, error)
      call inertia_force(numbers, matrix, lumped, 2, force)
      total(pass) = -dot_product(r, force)
    end do
    model%has_lumped_mass = .false.
    call check_close(log, total(1), total(2), 1.0e-9_rk*total(1), 'both masses have one total')
    allocate (blocks(3, 3, model%mesh%num_nodes))
    blocks = 0.0_rk
    blocks(2, 2, 7) = 5.0e6_rk
    blocks(2, 2, 100) = 3.0e6_rk
    call scatter_blocks(numbers, blocks, matrix, lumped)
    call inertia_force(numbers, matrix, lumped, 2, force)
    call check_close(log, -dot_product(r, force), total(2) + 8.0e6_rk, 1.0e-9_rk*total(1), &
                     'added mass counts')
  end subroutine masses

  subroutine damping()
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:)
    real(rk) :: alpha, beta, w
    call rayleigh_coefficients(0.05_rk, 2.0_rk, 8.0_rk, alpha, beta)
    w = 4.0_rk*acos(-1.0_rk)
    call check_close(log, alpha/(2.0_rk*w) + beta*w/2.0_rk, 0.05_rk, 1.0e-15_rk, 'ratio at f1')
    w = 4.0_rk*w
    call check_close(log, alpha/(2.0_rk*w) + beta*w/2.0_rk, 0.05_rk, 1.0e-15_rk, 'ratio at f2')
    model%materials(1)%alpha = 1.0_rk
    call assemble_damping(model, numbers, alpha, beta, matrix, values, error)
    model%materials(1)%alpha = 0.0_rk
    values = values - (alpha + 1.0_rk)*mass - beta*stiffness
    call check_close(log, maxval(abs(values)), 0.0_rk, 1.0e-13_rk*beta*maxval(stiffness), &
                     'C = alpha M + beta K')
  end subroutine damping

  subroutine bad_element()
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:)
    model%mesh%nodes([1, 5], 9) = model%mesh%nodes([5, 1], 9)
    call assemble_stiffness(model, numbers, matrix, values, error)
    call check(log, allocated(error), 'an inverted element is an error')
    if (allocated(error)) call check_text(log, error%message(:10), 'element 9:', 'it is named')
  end subroutine bad_element
end program test_assemble_elements
