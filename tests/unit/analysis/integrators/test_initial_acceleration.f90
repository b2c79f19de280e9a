!> M a = r: with mass everywhere, and in the constrained form where directions have no mass.
program test_initial_acceleration
  use kinds, only: rk
  use errors, only: error_type
  use testing, only: test_log, check, check_close
  use matrix_pattern, only: pattern
  use initial_acceleration, only: find_acceleration
  use massless_acceleration, only: find_constrained_acceleration, find_weight
  implicit none
  type(test_log) :: log
  log%suite = 'initial_acceleration'
  call test_definite()
  call test_water_along_normal()
  call test_mass_on_joint()
  call test_free_part()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> A mass matrix of one node; none where a second node has no mass.
  subroutine test_definite()
    real(rk), parameter :: known(3) = [1.0_rk, -2.0_rk, 0.5_rk]
    real(rk), parameter :: solid(6) = [4.0_rk, 1.0_rk, 0.5_rk, 3.0_rk, 0.2_rk, 2.0_rk]
    real(rk) :: a(6)
    type(pattern) :: matrix
    logical :: is_definite
    call fill_pattern(matrix)
    call find_acceleration(matrix, [solid, solid], [matmul(full(solid), known), &
                                                    2*matmul(full(solid), known)], a, is_definite)
    call check(log, is_definite, 'a definite mass')
    call check_close(log, maxval(abs(a - [known, 2*known])), 0.0_rk, 1.0e-12_rk, 'its solution')
    call find_acceleration(matrix, [solid, 0*solid], [known, known], a, is_definite)
    call check(log,.not. is_definite, 'a node without mass')
  end subroutine test_definite

  !> Two nodes: a solid, and one that moves water along its normal n only, on springs k in all
  !> directions. Across n the springs take the force; along n it accelerates the water.
  subroutine test_water_along_normal()
    real(rk), parameter :: n(3) = [2.0_rk, -1.0_rk, 2.0_rk]/3.0_rk, k = 3.0e5_rk
    real(rk), parameter :: solid(6) = [4.0_rk, 1.0_rk, 0.5_rk, 3.0_rk, 0.2_rk, 2.0_rk]
    real(rk), parameter :: known(3) = [1.0_rk, -2.0_rk, 0.5_rk]
    real(rk), parameter :: springs(6) = k*[1, 0, 0, 1, 0, 1]
    type(pattern) :: matrix
    type(error_type), allocatable :: error
    real(rk) :: a(6), r(6)
    integer :: worst
    call fill_pattern(matrix)
    r(:3) = matmul(full(solid), known)
    r(4:) = 5.0_rk*n + 1.0e3_rk*[1.0_rk, 2.0_rk, 0.0_rk] ! the latter stands on n
    call solve(matrix, [solid, lower(spread(n, 2, 3)*spread(n, 1, 3))], [springs, springs], r, a, &
               worst, error)
    call check(log, worst == 0 .and. .not. allocated(error), 'there is an acceleration')
    ! Round-off of the force across n, 2e3 N, over eps k: 1e-16*2e3/1e-5 = 2e-8.
    call check_close(log, maxval(abs(a(:3) - known)), 0.0_rk, 1.0e-9_rk, 'where there is mass')
    call check_close(log, maxval(abs(a(4:) - 5.0_rk*n)), 0.0_rk, 1.0e-7_rk, 'along the normal')
  end subroutine test_water_along_normal

  !> A mass on a joint on a massless spring, q the top of the spring and d the jump: the slave, with
  !> the mass, moves by q + d. Force f acts on the mass and g on the spring.
  subroutine test_mass_on_joint()
    real(rk), parameter :: m = 2.0_rk, k_rock = 3.0e6_rk, k_joint = 5.0e9_rk
    real(rk), parameter :: f = 7.0_rk, g = -4.0_rk
    real(rk) :: a(2), of_mass
    type(pattern) :: matrix
    type(error_type), allocatable :: error
    integer :: worst
    call fill_small(matrix)
    call solve(matrix, [m, m, m], [k_rock, 0.0_rk, k_joint], [f + g, f], a, worst, error)
    call check(log, worst == 0 .and. .not. allocated(error), 'a mass on a joint')
    ! Static balance of the spring shares g between ground and joint.
    of_mass = (f + g*k_joint/(k_rock + k_joint))/m
    ! Round-off 1e-16 over eps k_rock/(m k_joint) = 6e-9.
    call check_close(log, sum(a), of_mass, 1.0e-7_rk, 'acceleration of the mass')
    call check_close(log, a(1), of_mass*k_joint/(k_rock + k_joint), 1.0e-7_rk, 'of the spring')
    call check_close(log, a(2), of_mass*k_rock/(k_rock + k_joint), 1.0e-7_rk, 'of the joint')
  end subroutine test_mass_on_joint

  !> A massless part that nothing holds is named.
  subroutine test_free_part()
    real(rk) :: a(2)
    type(pattern) :: matrix
    type(error_type), allocatable :: error
    integer :: worst
    call fill_small(matrix)
    call solve(matrix, [0.0_rk, 0.0_rk, 1.0_rk], [0.0_rk, 0.0_rk, 1.0_rk], [1.0_rk, 1.0_rk], a, &
               worst, error)
    call check(log, allocated(error), 'a free part is an error')
    call check(log, worst == 1, 'the free part has a name')
  end subroutine test_free_part

  !> The constrained form with the weight that the program takes.
  subroutine solve(matrix, mass, stiffness, r, a, worst, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:), stiffness(:), r(:)
    real(rk), intent(out) :: a(:)
    integer, intent(out) :: worst
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: eps
    call find_weight(matrix, mass, stiffness, eps)
    call find_constrained_acceleration(matrix, mass, mass + eps*stiffness, r, r, a, worst, error)
  end subroutine solve

  !> The full matrix of a lower triangle.
  pure function full(triangle) result(square)
    real(rk), intent(in) :: triangle(6)
    real(rk) :: square(3, 3)
    integer :: i, j, k
    k = 0
    do j = 1, 3
      do i = j, 3
        k = k + 1
        square(i, j) = triangle(k)
        square(j, i) = triangle(k)
      end do
    end do
  end function full

  !> The lower triangle of a full matrix.
  pure function lower(square) result(triangle)
    real(rk), intent(in) :: square(3, 3)
    real(rk) :: triangle(6)
    integer :: i, j
    triangle = [((square(i, j), i=j, 3), j=1, 3)]
  end function lower

  !> Two nodes of three unknowns that are not coupled.
  subroutine fill_pattern(matrix)
    type(pattern), intent(out) :: matrix
    matrix%num_free = 6
    matrix%num_total = 6
    matrix%column_start = [1, 4, 6, 7, 10, 12, 13]
    matrix%row = [1, 2, 3, 2, 3, 3, 4, 5, 6, 5, 6, 6]
    matrix%free_entries = [3, 2, 1, 3, 2, 1]
    matrix%alike = matrix%free_entries
  end subroutine fill_pattern

  !> Two coupled unknowns.
  subroutine fill_small(matrix)
    type(pattern), intent(out) :: matrix
    matrix%num_free = 2
    matrix%num_total = 2
    matrix%column_start = [1, 3, 4]
    matrix%row = [1, 2, 2]
    matrix%free_entries = [2, 1]
    matrix%alike = matrix%free_entries
  end subroutine fill_small
end program test_initial_acceleration
