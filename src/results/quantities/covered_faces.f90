!> Outer faces of solids that are covered: by JOINT8 elements, joints on surfaces, ties and
!> interfaces. These faces are not a free surface, although no second element shares them.
module covered_faces
  use kinds, only: rk
  use dam_mesh, only: fe_mesh, surface
  use mesh_faces, only: face_nodes, face_vector, mark_covered
  use guest_type, only: guest
  use joint_points, only: dam_joint
  use problem_definition, only: problem
  use row_tables, only: row_table
  implicit none
  private
  public :: mark_joined

  !> Least cosine between the normal of a covered face and the normal of the joint at its nodes. A
  !> key of one element has all its nodes in the joint, but not all its faces. At the corner of
  !> three faces the cosine of the mean normal with each is 1/sqrt(3).
  real(rk), parameter :: least_cosine = 0.5_rk

contains

  !> Marks the faces of a skin that are covered, fully or in part.
  subroutine mark_joined(model, skin, is_covered)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: skin
    logical, allocatable, intent(out) :: is_covered(:) !< (faces of the skin)
    integer :: i
    call mark_covered(model%mesh, skin, is_covered)
    do i = 1, size(model%joints)
      if (.not. model%joints(i)%is_matching) call mark_joint(model, skin, i, is_covered)
    end do
    do i = 1, size(model%guests)
      call mark_between(model%mesh, skin, coupled_nodes(model%guests(i)%item), is_covered)
    end do
  end subroutine mark_joined

  !> Marks the faces along a joint whose nodes all belong to the joint.
  subroutine mark_joint(model, skin, number, is_covered)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: skin
    integer, intent(in) :: number !< of the joint
    logical, intent(inout) :: is_covered(:) !< (faces of the skin)
    real(rk) :: normal(3, model%mesh%num_nodes), outward(3), along(4)
    integer :: i, nodes(4)
    call add_normals(model%joints(number), normal)
    do i = 1, size(skin%element)
      nodes = face_nodes(model%mesh, skin%element(i), skin%face(i))
      outward = face_vector(model%mesh%x(:, nodes))
      along = abs(matmul(outward, normal(:, nodes)))
      if (any(along <= 0.0_rk)) cycle
      if (all(along >= least_cosine*norm2(outward)*norm2(normal(:, nodes), dim=1))) then
        is_covered(i) = .true.
      end if
    end do
  end subroutine mark_joint

  !> Mean normal of a joint at each node of both its faces; zero at other nodes.
  pure subroutine add_normals(joint, normal)
    type(dam_joint), intent(in) :: joint
    real(rk), intent(out) :: normal(:, :) !< (3, nodes) of any length
    integer :: p, k
    normal = 0.0_rk
    do p = 1, joint%num_points
      do k = joint%first(p), joint%first(p + 1) - 1
        normal(:, joint%node(k)) = normal(:, joint%node(k)) &
                                   + abs(joint%weight(k))*joint%area(p)*joint%rotation(1, :, p)
      end do
    end do
  end subroutine add_normals

  !> Nodes that a guest connects.
  function coupled_nodes(item) result(nodes)
    class(guest), intent(in) :: item
    integer, allocatable :: nodes(:)
    type(row_table) :: cells
    integer :: i
    call item%add_bonds(cells)
    call cells%finish()
    allocate (nodes(0))
    if (any(cells%first(2:) - cells%first(:cells%num_rows()) > 1)) then
      nodes = [(cells%row(i), i=1, cells%num_rows())]
    end if
  end function coupled_nodes

  !> Marks the faces whose nodes all belong to a tie or an interface.
  subroutine mark_between(mesh, skin, nodes, is_covered)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: skin
    integer, intent(in) :: nodes(:)
    logical, intent(inout) :: is_covered(:) !< (faces of the skin)
    logical :: is_joined(mesh%num_nodes)
    integer :: i
    is_joined = .false.
    is_joined(nodes) = .true.
    do i = 1, size(skin%element)
      if (all(is_joined(face_nodes(mesh, skin%element(i), skin%face(i))))) is_covered(i) = .true.
    end do
  end subroutine mark_between
end module covered_faces
