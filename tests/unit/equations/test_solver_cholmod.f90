!> CHOLMOD on a box of springs: solutions, refactoring, several columns, the failing unknown.
program test_solver_cholmod
  use kinds, only: rk
  use errors, only: error_type
  use factor_top, only: top_of_factor
  use testing, only: test_log, check, check_close
  use matrix_pattern, only: pattern, multiply, position_of
  use solver_cholmod, only: cholmod_solver
  use dense_factor, only: solve_lower, solve_lower_transposed
  use spring_box, only: make_box
  implicit none
  type(test_log) :: log
  log%suite = 'solver_cholmod'
  call solutions()
  call halves()
  call tops()
  call failures()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  subroutine solutions()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), q(:, :), b(:, :), one(:, :)
    integer, allocatable :: order(:)
    integer :: j, pass
    call make_box(matrix, values, 30)
    call solver%analyse(matrix, error)
    call check(log, allocated(error) .eqv. .false., 'analyse')
    order = solver%order
    call check(log, all(order(matrix%num_free - 29:) > matrix%num_free - 30), 'jumps stay last')
    do pass = 1, 2
      values = values*pass
      call solver%factorise(matrix, values, error)
      call check(log, allocated(error) .eqv. .false., 'factorise')
      allocate (q(matrix%num_total, 40), b(matrix%num_free, 40))
      q = reshape([(sin(real(j, rk)), j=1, size(q))], shape(q))
      q(matrix%num_free + 1:, :) = 0.0_rk
      do j = 1, size(q, 2)
        call product_of_free(matrix, values, q(:, j), b(:, j))
      end do
      one = b(:, :1)
      call solver%solve(b, error)
      call check_close(log, maxval(abs(b - q(:matrix%num_free, :))), 0.0_rk, 1.0e-11_rk, 'K^-1 K q')
      ! A single right-hand side has a substitution of its own.
      call solver%solve(one, error)
      call check_close(log, maxval(abs(one - q(:matrix%num_free, :1))), 0.0_rk, 1.0e-11_rk, &
                       'K^-1 K q of one right-hand side')
      deallocate (q, b)
    end do
  end subroutine solutions

  !> Forward substitution, jumps from the Schur block, forces on the jumps, backward substitution:
  !> the result is that of one solve with all forces.
  subroutine halves()
    integer, parameter :: num_jumps = 30
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), whole(:, :), half(:), lower(:, :), end_of_half(:)
    real(rk) :: later(num_jumps)
    integer, allocatable :: unknown(:)
    integer :: j
    logical :: is_there
    call make_box(matrix, values, num_jumps)
    call solver%analyse(matrix, error)
    call solver%factorise(matrix, values, error)
    call solver%take_schur_block(matrix%num_free - 1, lower, unknown, is_there)
    call check(log, is_there .eqv. .false., 'other unknowns are not in their order')
    call solver%take_schur_block(num_jumps, lower, unknown, is_there)
    call check(log, is_there .and. minval(unknown) == matrix%num_free - num_jumps + 1, 'the end')
    half = [(cos(real(j, rk)), j=1, matrix%num_free)]
    later = [(sin(2.0_rk*j), j=1, num_jumps)]
    whole = reshape(half, [matrix%num_free, 1])
    call solver%solve(whole, error)
    call solver%forward_substitute(half, error)
    end_of_half = half(matrix%num_free - num_jumps + 1:)
    call solve_lower_transposed(lower, end_of_half)
    call check_close(log, maxval(abs(end_of_half - whole(unknown, 1))), 0.0_rk, 1.0e-12_rk, &
                     'jumps by half a solve')
    whole = 0.0_rk
    whole(:, 1) = [(cos(real(j, rk)), j=1, matrix%num_free)]
    whole(unknown, 1) = whole(unknown, 1) + later
    call solver%solve(whole, error)
    call solve_lower(lower, later)
    half(matrix%num_free - num_jumps + 1:) = half(matrix%num_free - num_jumps + 1:) + later
    call solver%backward_substitute(half, error)
    call check_close(log, maxval(abs(half - whole(:, 1))), 0.0_rk, 1.0e-12_rk, 'two halves')
  end subroutine halves

  !> Groups of unknowns as separators: the order, substitution with the top of the factor; against
  !> whole solves.
  subroutine tops()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(top_of_factor) :: top
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), whole(:, :), half(:), x(:), force(:)
    integer, allocatable :: group(:), one(:), two(:), place(:)
    integer :: j
    call make_box(matrix, values, 0)
    ! Unknowns 3 k - 2 .. 3 k of node k; two planes of nodes across the box are groups.
    group = [(merge(1, merge(2, 0, mod((j - 1)/3, 6) == 4), mod((j - 1)/3, 6) == 1), &
              j=1, matrix%num_free)]
    matrix%group = group
    matrix%jump = [integer ::]
    matrix%joined = [integer ::]
    one = pack([(j, j=1, matrix%num_free)], group == 1)
    two = pack([(j, j=1, matrix%num_free)], group == 2)
    call solver%analyse(matrix, error)
    call solver%factorise(matrix, values, error)
    place = solver%order
    place(solver%order) = [(j, j=1, matrix%num_free)]
    call check(log, maxval(place(one)) - minval(place(one)) == size(one) - 1 .or. &
               maxval(place(two)) - minval(place(two)) == size(two) - 1, 'a group stays together')
    call solver%take_top([one, two], top)
    call check(log, top%is_there, 'the top')
    half = [(cos(real(j, rk)), j=1, matrix%num_free)]
    whole = reshape(half, [matrix%num_free, 1])
    allocate (force(matrix%num_free), x(matrix%num_free), source=0.0_rk)
    force(two) = 1.0_rk
    whole(:, 1) = whole(:, 1) + force
    call solver%solve(whole, error)
    call solver%forward_substitute(half, error)
    call top%add_forces(force, half, error)
    call check(log,.not. allocated(error), 'forces on the top')
    call top%solve_for_top(half, x, error)
    call check(log,.not. allocated(error), 'a solve on the top')
    call check_close(log, maxval(abs(x([one, two]) - whole([one, two], 1))), 0.0_rk, 1.0e-12_rk, &
                     'unknowns of the top')
    call tops_without_memory(top, force, half, x)
    call solver%backward_substitute(half, error)
    call check_close(log, maxval(abs(half - whole(:, 1))), 0.0_rk, 1.0e-12_rk, 'all unknowns')
    call inverses(solver, top, one, two)
  end subroutine tops

  !> Solves on the top that ask for more memory than there is.
  subroutine tops_without_memory(top, force, half, x)
    type(top_of_factor), intent(in) :: top
    real(rk), intent(in) :: force(:), half(:), x(:)
    type(top_of_factor) :: huge_top
    type(error_type), allocatable :: error
    real(rk) :: y(size(x))
    huge_top = top
    huge_top%num_free = -1 ! 2^64 bytes
    y = half
    call huge_top%add_forces(force, y, error)
    call check(log, allocated(error), 'no memory for forces on the top')
    y = x
    call huge_top%solve_for_top(half, y, error)
    call check(log, allocated(error), 'no memory for a solve on the top')
  end subroutine tops_without_memory

  !> Entries of the inverse with the unknowns of two groups, against whole solves.
  subroutine inverses(solver, top, one, two)
    type(cholmod_solver), intent(inout) :: solver
    type(top_of_factor), intent(in) :: top
    integer, intent(in) :: one(:), two(:)
    type(error_type), allocatable :: error
    real(rk), allocatable :: whole(:, :), block(:, :)
    integer :: j, missing
    logical :: has_failed
    call top%start_inverse(has_failed)
    call top%expect(one)
    call top%expect(two)
    if (.not. has_failed) call top%invert_for([one, two], has_failed)
    call check(log,.not. has_failed, 'inverse')
    allocate (whole(top%num_free, size(two)), source=0.0_rk)
    do j = 1, size(two)
      whole(two(j), j) = 1.0_rk
    end do
    call solver%solve(whole, error)
    allocate (block(size(two), size(two)))
    call top%inverse_block(two, two, block, missing)
    call check(log, missing == 0, 'all entries of a group')
    call check_close(log, maxval(abs(block - whole(two, :)))/maxval(abs(block)), 0.0_rk, &
                     1.0e-12_rk, 'entries of a group')
    deallocate (block)
    allocate (block(size(one), size(two)))
    call top%inverse_block(one, two, block, missing)
    call check(log, missing == 0, 'all entries between neighbours')
    call check_close(log, maxval(abs(block - whole(one, :)))/maxval(abs(block)), 0.0_rk, &
                     1.0e-12_rk, 'entries between neighbours')
    call top%release(one)
    call top%release(two)
    call top%inverse_block(one, two, block, missing)
    call check(log, missing == size(block), 'entries that nothing needs are not held')
    call top%forget_inverse()
  end subroutine inverses

  !> The free part of K q.
  subroutine product_of_free(matrix, values, q, b)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:), q(:)
    real(rk), intent(out) :: b(:)
    real(rk) :: y(size(q))
    call multiply(matrix, values, q, y)
    b = y(:size(b))
  end subroutine product_of_free

  subroutine failures()
    type(pattern) :: matrix
    type(cholmod_solver) :: solver
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:)
    integer :: k
    call make_box(matrix, values, 0)
    call solver%analyse(matrix, error)
    k = position_of(matrix, 77, 77)
    values(k) = -1.0_rk
    call solver%factorise(matrix, values, error)
    call check(log, allocated(error) .and. solver%failed_unknown == 77, 'a negative pivot is named')
    call make_box(matrix, values, 0)
    ! Unknown 5 is cut off from the others.
    values(matrix%column_start(5):matrix%column_start(6) - 1) = 0.0_rk
    do k = 1, 4
      if (position_of(matrix, 5, k) > 0) values(position_of(matrix, 5, k)) = 0.0_rk
    end do
    call solver%factorise(matrix, values, error)
    call check(log, allocated(error) .and. solver%failed_unknown == 5, 'a floating one is named')
  end subroutine failures
end program test_solver_cholmod
