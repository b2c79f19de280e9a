!> Loads in the equations: reduced forces, added mass, acceleration of the base.
module assemble_forces
  use kinds, only: rk
  use guest_type, only: guest
  use problem_definition, only: problem
  use node_dofs, only: zero_vectors
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use global_vectors, only: multiply
  implicit none
  private
  public :: assemble_force, rigid_translation, inertia_force

contains

  !> T^T f of one guest at factor 1.
  subroutine assemble_force(model, item, numbers, force)
    type(problem), intent(in) :: model
    class(guest), intent(in) :: item
    type(numbering), intent(in) :: numbers
    real(rk), intent(out) :: force(:) !< (num_total) [N]
    real(rk), allocatable :: nodal(:, :), density(:)
    nodal = zero_vectors(model%mesh%num_nodes)
    allocate (density(model%mesh%num_elements))
    density = 0.0_rk
    where (model%mesh%material_of_element > 0)
      density = model%materials(max(model%mesh%material_of_element, 1))%density
    end where
    call item%add_force(model%mesh, density, nodal)
    call numbers%reduce(nodal, force)
  end subroutine assemble_force

  !> Unknowns of a unit translation of the whole model, supports included; jumps are zero.
  pure subroutine rigid_translation(numbers, direction, r)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: direction !< 1..3
    real(rk), intent(out) :: r(:) !< (num_total)
    integer :: first_jump
    first_jump = numbers%num_free - numbers%num_jumps + 1
    r = merge(1.0_rk, 0.0_rk, numbers%direction == direction)
    r(first_jump:numbers%num_free) = 0.0_rk
  end subroutine rigid_translation

  !> -M r: the force of a unit acceleration of the base in a direction.
  subroutine inertia_force(numbers, matrix, mass, direction, force)
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values, added mass included
    integer, intent(in) :: direction !< 1..3
    real(rk), intent(out) :: force(:) !< (num_total) [kg]
    real(rk), allocatable :: r(:)
    allocate (r(numbers%num_total))
    call rigid_translation(numbers, direction, r)
    call multiply(matrix, mass, r, force)
    force = -force
  end subroutine inertia_force
end module assemble_forces
