!> Loss of stiffness of inelastic solids, A = sum w B^T (D - C) B with the tangents C of the laws.
!> The tangent of the solids is K - A (theory.md, 12).
module inelastic_stiffness
  use kinds, only: rk
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use inelastic_blocks, only: inelastic_block
  use inelastic_forces, only: block_answer, has_many_elements
  use scatter_matrix, only: scatter_nodes
  implicit none
  private
  public :: lost_stiffness

  integer, parameter :: batch = 64 !< blocks whose element matrices are stored at a time

contains

  !> A from the tangents of the last update, the part of the blocks of this rank. A symmetric
  !> pattern takes the lower triangle and needs symmetric tangents.
  subroutine lost_stiffness(model, numbers, answers, matrix, values)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(block_answer), intent(in) :: answers(:)
    type(pattern), intent(in) :: matrix
    real(rk), intent(out) :: values(:) !< of the pattern [N/m]
    real(rk), allocatable :: ke(:, :, :, :)
    integer :: first, last, i, e, largest
    values = 0.0_rk
    largest = 0
    do i = 1, size(answers)
      largest = max(largest, size(answers(i)%has_excess))
    end do
    allocate (ke(hex8_dofs, hex8_dofs, largest, batch))
    do first = 1, size(answers), batch
      last = min(first + batch - 1, size(answers))
      !$omp parallel do schedule(dynamic) default(none) shared(model, answers, ke, first, last) &
      !$omp if (has_many_elements(answers))
      do i = first, last
        call integrate_block(model, model%inelastic(i), answers(i), ke(:, :, :, i - first + 1))
      end do
      !$omp end parallel do
      do i = first, last
        do e = 1, size(answers(i)%has_excess)
          if (.not. answers(i)%has_excess(e)) cycle
          call scatter_nodes(numbers, model%mesh%nodes(:, model%inelastic(i)%elements(e)), &
                             ke(:, :, e, i - first + 1), matrix, values)
        end do
      end do
    end do
  end subroutine lost_stiffness

  !> Matrices of the elements of a block, where they have an initial-stress force.
  subroutine integrate_block(model, part, answer, ke)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    type(block_answer), intent(in) :: answer
    real(rk), intent(inout) :: ke(:, :, :) !< (24, 24, elements)
    real(rk) :: d(6, 6), lost(6, 6), b(6, hex8_dofs)
    integer :: e, q
    call model%materials(part%material)%law%elastic_stiffness(d)
    do e = 1, size(part%elements)
      if (.not. answer%has_excess(e)) cycle
      ke(:, :, e) = 0.0_rk
      do q = 1, part%points_of_element
        lost = part%weight(q, e)*(d - answer%tangent(:, :, (e - 1)*part%points_of_element + q))
        if (.not. any(abs(lost) > 0.0_rk)) cycle
        call part%find_operator(e, q, b)
        call add_point(lost, b, ke(:, :, e))
      end do
    end do
  end subroutine integrate_block

  !> k = k + B^T C B.
  pure subroutine add_point(c, b, k)
    real(rk), intent(in) :: c(6, 6), b(6, hex8_dofs)
    real(rk), intent(inout) :: k(hex8_dofs, hex8_dofs)
    real(rk) :: bt(hex8_dofs, 6), cb(6)
    integer :: i, j
    bt = transpose(b)
    do j = 1, hex8_dofs
      cb = c(:, 1)*b(1, j)
      do i = 2, 6
        cb = cb + c(:, i)*b(i, j)
      end do
      do i = 1, 6
        k(:, j) = k(:, j) + bt(:, i)*cb(i)
      end do
    end do
  end subroutine add_point
end module inelastic_stiffness
