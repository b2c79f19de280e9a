!> The pattern against a dense matrix: entries, product, diagonal, the full pattern, joints.
program test_matrix_pattern
  use dam_mesh, only: node_tie
  use kinds, only: rk
  use errors, only: error_type
  use row_tables, only: row_table
  use testing, only: test_log, check, check_close
  use node_dofs, only: displacement_dofs
  use dof_numbering, only: numbering, linear_links, number_unknowns
  use jump_links, only: nodal_points, link_nodes, pairs_of_nodes
  use matrix_pattern, only: pattern, position_of, multiply, diagonal, full_pattern, &
                            spread_values, drop_zeros, add_thin
  use pattern_builder, only: build_pattern
  use joint_stiffness, only: add_joint_stiffness
  use scatter_matrix, only: scatter_nodes
  implicit none
  type(test_log) :: log
  type(numbering) :: numbers
  type(pattern) :: lower, full
  log%suite = 'matrix_pattern'
  call make_model()
  call entries()
  call products()
  call joints()
  call triples()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
contains

  !> Two cells of three nodes (1 2 3 and 4 5 6), joined by a point of the pair (4, 3), and a point
  !> that sees the nodes 1, 2 and 5, 6; node 1 is partly fixed.
  subroutine make_model()
    type(linear_links) :: links
    type(nodal_points) :: points
    type(node_tie) :: ties(0)
    type(row_table) :: cells
    type(error_type), allocatable :: error
    logical :: is_used(6), is_fixed(3, 6)
    real(rk) :: r(3, 3)
    r = reshape([0.6_rk, -0.8_rk, 0.0_rk, 0.8_rk, 0.6_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], [3, 3])
    is_used = .true.
    is_fixed = .false.
    is_fixed(2, 1) = .true.
    call pairs_of_nodes([4], [3], reshape(r, [3, 3, 1]), points)
    call link_nodes(displacement_dofs(6), points, ties, is_used, is_fixed, links, error)
    call number_unknowns(displacement_dofs(6), is_used, is_fixed, links, numbers, error)
    cells%first = [1, 4, 7, 9, 13]
    cells%item = [1, 2, 3, 4, 5, 6, 3, 4, 1, 2, 5, 6]
    call build_pattern(numbers, cells, lower)
    call full_pattern(lower, full)
  end subroutine make_model

  subroutine entries()
    integer :: j
    logical :: is_sorted
    call check(log, lower%num_free == 17 .and. lower%num_total == 18, '12 + 2 + 3 free, 1 fixed')
    call check(log, position_of(lower, 9, 3) > 0, 'nodes 2 and 5 meet at the wide point')
    call check(log, position_of(lower, 17, 1) == 0, 'node 1 does not meet the jump')
    is_sorted = .true.
    do j = 1, 18
      associate (rows => lower%row(lower%column_start(j):lower%column_start(j + 1) - 1))
        is_sorted = is_sorted .and. rows(1) == j .and. all(rows(2:) > rows(:size(rows) - 1))
        is_sorted = is_sorted .and. lower%free_entries(j) == count(rows <= 17)
      end associate
      associate (rows => full%row(full%column_start(j):full%column_start(j + 1) - 1))
        is_sorted = is_sorted .and. all(rows(2:) > rows(:size(rows) - 1)) .and. any(rows == j)
      end associate
    end do
    call check(log, is_sorted, 'rows ascend, the diagonal is there')
  end subroutine entries

  subroutine products()
    real(rk), allocatable :: values(:), full_values(:), thin_values(:), sums(:)
    real(rk) :: q(18), y(18), z(18), d(18), dense(18, 18)
    type(pattern) :: thin
    integer :: j, k
    allocate (values, source=[(sin(real(k, rk)), k=1, size(lower%row))])
    allocate (full_values(size(full%row)))
    call spread_values(lower, values, full, full_values)
    dense = 0.0_rk
    do j = 1, 18
      do k = lower%column_start(j), lower%column_start(j + 1) - 1
        dense(lower%row(k), j) = values(k)
        dense(j, lower%row(k)) = values(k)
      end do
    end do
    q = [(cos(2.0_rk*k), k=1, 18)]
    call multiply(lower, values, q, y)
    call multiply(full, full_values, q, z)
    call check_close(log, norm2(y - matmul(dense, q)), 0.0_rk, 1.0e-14_rk*norm2(dense), 'A q')
    call check_close(log, norm2(z - y), 0.0_rk, 1.0e-14_rk*norm2(dense), 'A q of the full pattern')
    call diagonal(full, full_values, d)
    call check(log, all(abs(d - [(dense(j, j), j=1, 18)]) <= 0.0_rk), 'diagonal')
    values(1) = 0.0_rk
    values(2::3) = 0.0_rk
    call multiply(lower, values, q, y)
    call drop_zeros(lower, values, thin, thin_values)
    call multiply(thin, thin_values, q, z)
    call check(log, all(abs(z - y) <= 1.0e-14_rk*norm2(dense)), 'A q without its zeros')
    call check(log, size(thin_values) < size(values), 'zeros are dropped')
    call check(log, all(thin%row(thin%column_start(:18)) == [(j, j=1, 18)]), 'not on the diagonal')
    sums = -3.0_rk*values
    call add_thin(3.0_rk, thin, thin_values, lower, sums)
    call check(log, all(abs(sums) <= 0.0_rk), 'all entries without the zeros, at their places')
  end subroutine products

  subroutine joints()
    real(rk), allocatable :: values(:), full_values(:)
    real(rk) :: tangent(3, 3, 2), q(18), y(18), r(18), b(3, 18, 2)
    ! Point 1 sees the jump; each row of point 2 sees nodes 2 and 5, not in order.
    integer, parameter :: start(7) = [1, 2, 3, 4, 6, 8, 11]
    integer, parameter :: unknown(10) = [15, 16, 17, 9, 3, 4, 10, 11, 5, 3]
    real(rk), parameter :: coefficient(10) = [1.0_rk, 1.0_rk, 1.0_rk, 0.6_rk, -0.6_rk, 0.8_rk, &
                                              -0.8_rk, 0.5_rk, -1.0_rk, 0.3_rk], area(2) = [2, 3]
    logical, parameter :: is_here(2) = .true.
    integer :: k, i
    b = 0.0_rk
    do k = 1, 10
      i = count(start <= k)
      b(1 + mod(i - 1, 3), unknown(k), 1 + (i - 1)/3) = coefficient(k)
    end do
    q = [(cos(2.0_rk*k), k=1, 18)]
    tangent = reshape([(sin(real(k, rk)), k=1, 18)], [3, 3, 2])
    allocate (full_values(size(full%row)), values(size(lower%row)))
    full_values = 0.0_rk
    call add_joint_stiffness(start, unknown, coefficient, area, is_here, tangent, full, full_values)
    call multiply(full, full_values, q, y)
    call check_close(log, norm2(y - product_of(b, area, tangent, q)), 0.0_rk, 1.0e-14_rk, &
                     'B^T (area D B q)')
    values = 0.0_rk
    call add_joint_stiffness(start, unknown, coefficient, area, is_here, tangent, lower, values)
    call multiply(lower, values, q, r)
    do k = 1, 2
      tangent(:, :, k) = 0.5_rk*(tangent(:, :, k) + transpose(tangent(:, :, k)))
    end do
    call check_close(log, norm2(r - product_of(b, area, tangent, q)), 0.0_rk, 1.0e-14_rk, &
                     'the symmetric part')
  end subroutine joints

  !> B^T (area D B q) with dense matrices.
  pure function product_of(b, area, d, q) result(f)
    real(rk), intent(in) :: b(3, 18, 2), area(2), d(3, 3, 2), q(18)
    real(rk) :: f(18)
    integer :: p
    f = 0.0_rk
    do p = 1, 2
      f = f + area(p)*matmul(matmul(d(:, :, p), matmul(b(:, :, p), q)), b(:, :, p))
    end do
  end function product_of

  !> Matrices of nodes in any order, in the lower triangle and in the full pattern: the first takes
  !> the way of three unknowns a node where no dof is fixed or dependent.
  subroutine triples()
    integer, parameter :: cells(3, 5) = reshape([3, 2, 1, 2, 3, 1, 6, 5, 4, 2, 6, 5, 1, 6, 2], &
                                                [3, 5])
    real(rk), allocatable :: half(:), whole(:), spread_half(:)
    real(rk) :: k(9, 9)
    integer :: c, i, j
    allocate (half(size(lower%row)), whole(size(full%row)), source=0.0_rk)
    allocate (spread_half(size(full%row)))
    do c = 1, size(cells, 2)
      do j = 1, 9
        do i = 1, 9
          k(i, j) = sin(real(c + i*j, rk)) + cos(real(c*(i + j), rk))
        end do
      end do
      call scatter_nodes(numbers, cells(:, c), k, lower, half)
      call scatter_nodes(numbers, cells(:, c), k, full, whole)
      call scatter_nodes(numbers, cells(1:1, c), k(:3, :3), lower, half)
      call scatter_nodes(numbers, cells(1:1, c), k(:3, :3), full, whole)
    end do
    call spread_values(lower, half, full, spread_half)
    ! Sums of up to 20 terms of size 2.
    call check_close(log, maxval(abs(spread_half - whole)), 0.0_rk, 1.0e-14_rk, 'nodes')
    call check(log, maxval(abs(whole)) > 1.0_rk, 'entries')
  end subroutine triples
end program test_matrix_pattern
