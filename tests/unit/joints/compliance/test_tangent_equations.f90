!> Newton's linear equations with the compliance in blocks: products and solutions against dense
!> ones, for chains of joints with points that are closed, slide or are open; groups of points.
program test_tangent_equations
  use block_compliance, only: compliance_blocks, take_blocks
  use dense_factor, only: factorise_dense, lu_factor, solve_factored
  use kinds, only: rk
  use omp_lib, only: omp_set_num_threads
  use point_groups, only: divide, group_list, group_points
  use tangent_equations, only: joint_tangent
  use testing, only: check, check_close, test_log
  implicit none

  integer, parameter :: points = 480, joints = 3, n = 3*points
  real(rk), parameter :: k = 5.0e10_rk ! of a point [N/m]
  type(test_log) :: log
  type(group_list) :: groups
  real(rk), allocatable :: dense(:, :)

  log%suite = 'tangent_equations'
  call points_are_grouped(log)
  allocate (dense(n, n))
  call make_structure(groups, dense)
  call products_agree(log)
  call solutions_agree(log)
  call rough_blocks_serve(log)
  call kept_factors_serve(log)
  call small_blocks_are_left_out(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Small joints are put together, a joint of 1000 points is cut where it is longest.
  subroutine points_are_grouped(log)
    type(test_log), intent(inout) :: log
    type(group_list) :: list
    real(rk) :: x(3, 1100)
    integer :: p, g
    do p = 1, size(x, 2)
      x(:, p) = [0.1_rk*mod(p, 7), 0.0_rk, real(mod(37*p, 1100), rk)]
    end do
    call group_points([1, 51, 101, 1101], x, list)
    call check(log, list%num_groups == 5, 'two joints together, four patches')
    call check(log, all(list%point(list%first(1):list%first(2) - 1) == [(p, p=1, 100)]), 'first')
    do g = 2, 4
      call check(log, maxval(x(3, members(list, g))) <= minval(x(3, members(list, g + 1))), &
                 'patches follow one another')
    end do
    call check(log, sum(list%point) == 1100*1101/2 .and. size(list%row) == 3300, 'every point once')
    call check(log,.not. list%is_divided() .and. list%is_here(5), 'one rank has all groups')
    call divide(2, list)
    call check(log, all(list%rank == [0, 0, 1, 0, 1]), 'two ranks: 600 and 500 points')
  end subroutine points_are_grouped

  !> Points of a group.
  pure function members(list, group)
    type(group_list), intent(in) :: list
    integer, intent(in) :: group
    integer :: members(list%first(group + 1) - list%first(group))
    members = list%point(list%first(group):list%first(group + 1) - 1)
  end function members

  !> Joints of equal points in a row; a force moves near points more than far ones.
  subroutine make_structure(list, closed)
    type(group_list), intent(out) :: list
    real(rk), intent(out) :: closed(:, :) !< G with the springs of closed joints [m/N]
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :)
    real(rk) :: x(3, points), distance
    integer :: p, q, i, per_joint
    per_joint = points/joints
    do p = 1, points
      x(:, p) = [40.0_rk*((p - 1)/per_joint), real(mod(p - 1, per_joint)/10, rk), &
                 real(mod(p - 1, 10), rk)]
    end do
    call group_points([(1 + i*per_joint, i=0, joints)], x, list)
    closed = 0.0_rk
    do q = 1, points
      do p = 1, points
        distance = norm2((x(:, p) - x(:, q))*[0.5_rk, 1.0_rk, 1.0_rk])
        do i = 1, 3
          closed(3*p - 3 + i, 3*q - 3 + i) = 1.0e-9_rk*exp(-0.25_rk*distance)
        end do
        if (p /= q) closed(3*p - 2, 3*q - 1) = 0.1_rk*closed(3*p - 2, 3*q - 2)
        if (p /= q) closed(3*p - 1, 3*q - 2) = 0.1_rk*closed(3*p - 2, 3*q - 2)
      end do
    end do
    matrix = k*closed
    do i = 1, n
      matrix(i, i) = matrix(i, i) + 1.0_rk
    end do
    call factorise_dense(matrix, factor)
    call solve_factored(factor, closed)
  end subroutine make_structure

  !> The product in blocks, with any number of threads.
  subroutine products_agree(log)
    type(test_log), intent(inout) :: log
    type(compliance_blocks) :: blocks
    real(rk) :: x(n), y(n), again(n)
    integer :: i
    call take_blocks(dense, spread(1.0_rk/k, 1, n), groups, 0.0_rk, blocks)
    call check(log, blocks%left_out <= 0.0_rk, 'all blocks')
    call check(log, blocks%num_entries() == (n*n + n*n/joints)/2, 'each block between groups once')
    x = [(cos(0.7_rk*i), i=1, n)]
    call blocks%product(x, y)
    call check_close(log, maxval(abs(y - matmul(dense, x)))/maxval(abs(y)), 0.0_rk, 1.0e-13_rk, &
                     'full vector')
    where (modulo([(i, i=1, n)], 5) > 1) x = 0.0_rk
    call omp_set_num_threads(1)
    call blocks%product(x, y)
    call omp_set_num_threads(2)
    call blocks%product(x, again)
    call check_close(log, maxval(abs(y - matmul(dense, x)))/maxval(abs(y)), 0.0_rk, 1.0e-13_rk, &
                     'a fifth of the rows')
    call check(log,.not. any(abs(y - again) > 0.0_rk), 'the same with one and two threads')
  end subroutine products_agree

  !> Tangents of points in turn closed, open and sliding with friction.
  pure function tangents(start) result(tangent)
    integer, intent(in) :: start
    real(rk) :: tangent(3, 3, points)
    integer :: p, i
    tangent = 0.0_rk
    do p = 1, points
      if (mod(p/9 + start, 3) == 0) cycle
      tangent(1, 1, p) = k
      if (mod(p/9 + start, 3) == 1) tangent(2:3, 1, p) = -0.6_rk*k*[0.8_rk, 0.6_rk]
      do i = 2, 3
        if (mod(p/9 + start, 3) == 2) tangent(i, i, p) = k
      end do
    end do
  end function tangents

  !> d = r + G D d.
  function dense_solution(tangent, response) result(d)
    real(rk), intent(in) :: tangent(:, :, :), response(:)
    real(rk) :: d(n)
    type(lu_factor) :: factor
    real(rk), allocatable :: matrix(:, :), b(:, :)
    real(rk) :: change(3, 3)
    integer :: p, i
    allocate (matrix(n, n))
    do p = 1, points
      change = -tangent(:, :, p)
      do i = 1, 3
        change(i, i) = change(i, i) + k
      end do
      matrix(:, 3*p - 2:3*p) = -matmul(dense(:, 3*p - 2:3*p), change)
    end do
    do i = 1, n
      matrix(i, i) = matrix(i, i) + 1.0_rk
    end do
    b = reshape(response, [n, 1])
    call factorise_dense(matrix, factor)
    call solve_factored(factor, b)
    d = b(:, 1)
  end function dense_solution

  !> GMRES against the dense factor; what it leaves is as small as asked for, and stated.
  subroutine solutions_agree(log)
    type(test_log), intent(inout) :: log
    type(compliance_blocks) :: blocks
    type(joint_tangent) :: tangent
    real(rk) :: response(n), d(n), rest(n), expected(n), rough(n), excess(n), moved(n)
    integer :: i
    call take_blocks(dense, spread(1.0_rk/k, 1, n), groups, 0.0_rk, blocks)
    response = [(1.0e-3_rk*cos(0.3_rk*i), i=1, n)]
    expected = dense_solution(tangents(0), response)
    call tangent%set_tangent(blocks, spread([k, k, k], 2, points), spread(1.0_rk, 1, points), &
                             tangents(0))
    call tangent%solve(blocks, response, 1.0e-13_rk, 0.0_rk, d, rest)
    call check_close(log, norm2(d - expected)/norm2(expected), 0.0_rk, 1.0e-10_rk, 'solution')
    call tangent%solve(blocks, response, 1.0e-2_rk, 0.0_rk, rough, rest)
    call check(log, norm2(rest) < 1.01e-2_rk*k*norm2(response), 'the tolerance is met')
    excess = closed_excess(rough) - rest
    call blocks%product(excess, moved)
    call check_close(log, norm2(rough - response - moved)/norm2(rough), 0.0_rk, 1.0e-12_rk, &
                     'the structure is in equilibrium')
  end subroutine solutions_agree

  !> Blocks with rough products: what the equations leave is as small as asked for, and stated.
  subroutine rough_blocks_serve(log)
    type(test_log), intent(inout) :: log
    type(compliance_blocks) :: blocks
    type(joint_tangent) :: tangent
    real(rk) :: response(n), d(n), rest(n), excess(n), moved(n), tolerance
    integer :: i, digits
    call take_blocks(dense, spread(1.0_rk/k, 1, n), groups, 5.0e-10_rk, blocks)
    response = [(1.0e-3_rk*cos(0.3_rk*i), i=1, n)]
    call tangent%set_tangent(blocks, spread([k, k, k], 2, points), spread(1.0_rk, 1, points), &
                             tangents(0))
    do digits = 2, 8, 3
      tolerance = 10.0_rk**(-digits)
      call tangent%solve(blocks, response, tolerance, 0.0_rk, d, rest)
      ! 1.5 is what tangent_equations admits; |D r| <= 1.2 k |r| by friction.
      call check(log, norm2(rest) <= 1.8_rk*tolerance*k*norm2(response), 'rough: tolerance')
      excess = closed_excess(d) - rest
      call blocks%product(excess, moved)
      call check_close(log, norm2(d - response - moved)/norm2(d), 0.0_rk, 1.0e-6_rk, &
                       'rough: equilibrium')
    end do
  end subroutine rough_blocks_serve

  !> D d for the first tangents.
  pure function closed_excess(d) result(excess)
    real(rk), intent(in) :: d(:)
    real(rk) :: excess(n), tangent(3, 3, points)
    integer :: p
    tangent = tangents(0)
    do p = 1, points
      excess(3*p - 2:3*p) = k*d(3*p - 2:3*p) - matmul(tangent(:, :, p), d(3*p - 2:3*p))
    end do
  end function closed_excess

  !> Factors of other tangents are replaced or serve as they are.
  subroutine kept_factors_serve(log)
    type(test_log), intent(inout) :: log
    type(compliance_blocks) :: blocks
    type(joint_tangent) :: tangent
    real(rk) :: response(n), d(n), rest(n), expected(n), nearly(3, 3, points)
    integer :: i
    call take_blocks(dense, spread(1.0_rk/k, 1, n), groups, 0.0_rk, blocks)
    response = [(1.0e-3_rk*sin(0.4_rk*i), i=1, n)]
    nearly = tangents(1)
    nearly(2, 1, :) = 0.95_rk*nearly(2, 1, :)
    call tangent%set_tangent(blocks, spread([k, k, k], 2, points), spread(1.0_rk, 1, points), &
                             tangents(0))
    call tangent%set_tangent(blocks, spread([k, k, k], 2, points), spread(1.0_rk, 1, points), &
                             tangents(1))
    call tangent%set_tangent(blocks, spread([k, k, k], 2, points), spread(1.0_rk, 1, points), &
                             nearly)
    call tangent%solve(blocks, response, 1.0e-13_rk, 0.0_rk, d, rest)
    expected = dense_solution(nearly, response)
    call check_close(log, norm2(d - expected)/norm2(expected), 0.0_rk, 1.0e-10_rk, 'near tangent')
    tangent%is_single = .true.
    tangent%is_first = .true.
    nearly(2, 1, :) = 0.5_rk*nearly(2, 1, :)
    call tangent%set_tangent(blocks, spread([k, k, k], 2, points), spread(1.0_rk, 1, points), &
                             nearly)
    call tangent%solve(blocks, response, 1.0e-13_rk, 0.0_rk, d, rest)
    expected = dense_solution(nearly, response)
    call check_close(log, norm2(d - expected)/norm2(expected), 0.0_rk, 1.0e-10_rk, 'single')
  end subroutine kept_factors_serve

  !> The coupling of the outer joints is below that of neighbours.
  subroutine small_blocks_are_left_out(log)
    type(test_log), intent(inout) :: log
    type(compliance_blocks) :: blocks
    real(rk) :: next
    call take_blocks(dense, spread(1.0_rk/k, 1, n), groups, 0.0_rk, blocks)
    next = blocks%block(1, 2)%coupling
    call check(log, blocks%block(1, 3)%coupling < 0.5_rk*next .and. next < 1.0_rk, 'couplings')
    call take_blocks(dense, spread(1.0_rk/k, 1, n), groups, 0.9_rk*next, blocks)
    call check(log, blocks%has_block(1, 2) .and. .not. blocks%has_block(3, 1), &
               'neighbours remain')
    call check(log, blocks%left_out > 0.0_rk, 'not complete')
  end subroutine small_blocks_are_left_out
end program test_tangent_equations
