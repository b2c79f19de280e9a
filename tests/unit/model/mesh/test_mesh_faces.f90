!> Faces of elements: outward normals, the skin of bodies, degenerate faces, joints.
program test_mesh_faces
  use kinds, only: rk
  use dam_mesh, only: fe_mesh, surface
  use mesh_faces, only: count_corners, face_centre, face_nodes, face_vector, find_exterior, &
                        mark_covered
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'mesh_faces'
  call faces_point_outward(log)
  call two_cubes_have_ten_faces(log)
  call wedge_has_five_faces(log)
  call joint_covers_faces(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Unit cubes in a row along x, each with four nodes of its own per section.
  subroutine row_of_cubes(num_cubes, mesh)
    integer, intent(in) :: num_cubes
    type(fe_mesh), intent(out) :: mesh
    integer :: e, i
    mesh%num_nodes = 4*(num_cubes + 1)
    mesh%num_elements = num_cubes
    allocate (mesh%x(3, mesh%num_nodes), mesh%nodes(8, num_cubes))
    allocate (mesh%element_type(num_cubes))
    mesh%element_type = 'C3D8'
    do i = 0, num_cubes
      mesh%x(:, 4*i + 1:4*i + 4) = reshape(real([i, 0, 0, i, 1, 0, i, 1, 1, i, 0, 1], rk), [3, 4])
    end do
    do e = 1, num_cubes
      mesh%nodes(:, e) = [(4*e - 4 + i, i=1, 8)]
    end do
  end subroutine row_of_cubes

  subroutine faces_point_outward(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    real(rk) :: vector(3), arm(3)
    integer :: face, nodes(4)
    call row_of_cubes(1, mesh)
    do face = 1, 6
      nodes = face_nodes(mesh, 1, face)
      vector = face_vector(mesh%x(:, nodes))
      arm = face_centre(mesh, nodes) - 0.5_rk
      call check_close(log, dot_product(vector, arm), 0.5_rk, 1.0e-14_rk, 'outward normal')
    end do
  end subroutine faces_point_outward

  subroutine two_cubes_have_ten_faces(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(surface) :: skin
    call row_of_cubes(2, mesh)
    call find_exterior(mesh, [1, 2], skin)
    call check(log, size(skin%element) == 10, 'two cubes have ten faces')
    call check(log, count(skin%element == 1) == 5, 'five faces each')
    call find_exterior(mesh, [2], skin)
    call check(log, size(skin%element) == 6, 'one of them has six')
  end subroutine two_cubes_have_ten_faces

  subroutine wedge_has_five_faces(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(surface) :: skin
    integer :: i, corners
    call row_of_cubes(1, mesh)
    mesh%nodes(:, 1) = [1, 2, 3, 3, 5, 6, 7, 7]
    call find_exterior(mesh, [1], skin)
    call check(log, size(skin%element) == 5, 'a wedge has five faces')
    corners = 0
    do i = 1, size(skin%face)
      corners = corners + count_corners(face_nodes(mesh, 1, skin%face(i)))
    end do
    call check(log, corners == 18, 'two triangles and three quadrilaterals')
  end subroutine wedge_has_five_faces

  !> Two cubes with a joint in between: the joint covers one face of each.
  subroutine joint_covers_faces(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(surface) :: skin
    logical, allocatable :: is_covered(:)
    call row_of_cubes(3, mesh)
    mesh%element_type(2) = 'JOINT8'
    call find_exterior(mesh, [1, 3], skin)
    call mark_covered(mesh, skin, is_covered)
    call check(log, size(skin%element) == 12, 'two bodies')
    call check(log, count(is_covered) == 2, 'one covered face each')
  end subroutine joint_covers_faces
end program test_mesh_faces
