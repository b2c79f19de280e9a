!> Adds the springs between faces of different meshes to K (Eq. 8; different_meshes.md, 13.4), so
!> that its products and the strain energy hold them.
module coupling_stiffness
  use kinds, only: rk
  use node_dofs, only: num_directions
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use scatter_matrix, only: scatter_nodes
  use surface_coupling, only: coupling
  implicit none
  private
  public :: add_coupling_stiffness

  integer, parameter :: num_nodes = 8 !< of two facets
  integer, parameter :: num_dofs = num_directions*num_nodes

contains

  !> K = K + k int N^T N dA, segment by segment, the same in the three directions.
  subroutine add_coupling_stiffness(numbers, springs, matrix, values)
    type(numbering), intent(in) :: numbers
    type(coupling), intent(in) :: springs
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:) !< [N/m]
    real(rk) :: k(num_dofs, num_dofs)
    integer :: s, i
    k = 0.0_rk
    do s = 1, size(springs%node, 2)
      do i = 1, num_directions
        k(i::num_directions, i::num_directions) = springs%stiffness*springs%product(:, :, s)
      end do
      call scatter_nodes(numbers, springs%node(:, s), k, matrix, values)
    end do
  end subroutine add_coupling_stiffness
end module coupling_stiffness
