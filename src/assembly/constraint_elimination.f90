!> The dependent dofs of a step: where joints, later ties and equations, meet the numbering.
module constraint_elimination
  use kinds, only: rk
  use errors, only: error_type
  use dam_mesh, only: mesh
  use joint_points, only: joint
  use step_plan, only: step_fixity
  use dof_numbering, only: numbering, linear_links, number_unknowns
  use jump_links, only: link_pairs
  implicit none
  private
  public :: number_step

contains

  !> Numbers the unknowns of a step from its elements, its joints and its supports.
  subroutine number_step(model, joints, fixities, numbers, error)
    type(mesh), intent(in) :: model
    type(joint), intent(in) :: joints(:)
    type(step_fixity), intent(in) :: fixities(:)
    type(numbering), intent(out) :: numbers
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_used(:), is_fixed(:, :)
    integer, allocatable :: slave(:), master(:)
    real(rk), allocatable :: rotation(:, :, :)
    type(linear_links) :: links
    integer :: e, k
    allocate (is_used(model%num_nodes), is_fixed(3, model%num_nodes))
    is_used = .false.
    do e = 1, model%num_elements
      if (model%material_of_element(e) == 0) cycle
      do k = 1, size(model%nodes, 1)
        if (model%nodes(k, e) > 0) is_used(model%nodes(k, e)) = .true.
      end do
    end do
    is_fixed = .false.
    do k = 1, size(fixities)
      is_fixed(fixities(k)%dof, fixities(k)%node) = .true.
    end do
    call list_pairs(joints, slave, master, rotation)
    call link_pairs(slave, master, rotation, is_used, is_fixed, links)
    call number_unknowns(is_used, is_fixed, links, numbers, error)
  end subroutine number_step

  !> The pairs of the joints that are integrated at nodes, joint by joint, point by point.
  subroutine list_pairs(joints, slave, master, rotation)
    type(joint), intent(in) :: joints(:)
    integer, allocatable, intent(out) :: slave(:), master(:)
    real(rk), allocatable, intent(out) :: rotation(:, :, :)
    integer :: j, p, num_pairs
    num_pairs = 0
    do j = 1, size(joints)
      if (joints(j)%is_nodal) num_pairs = num_pairs + joints(j)%num_points
    end do
    allocate (slave(num_pairs), master(num_pairs), rotation(3, 3, num_pairs))
    num_pairs = 0
    do j = 1, size(joints)
      if (.not. joints(j)%is_nodal) cycle
      do p = 1, joints(j)%num_points
        num_pairs = num_pairs + 1
        slave(num_pairs) = joints(j)%node(joints(j)%first(p))
        master(num_pairs) = joints(j)%node(joints(j)%first_master(p))
        rotation(:, :, num_pairs) = joints(j)%rotation(:, :, p)
      end do
    end do
  end subroutine list_pairs
end module constraint_elimination
