!> Faces of elements: outward normals, the skin of bodies, degenerate faces, joints.
program test_mesh_faces
  use kinds, only: rk
  use dam_mesh, only: mesh, surface
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
  subroutine row_of_cubes(num_cubes, model)
    integer, intent(in) :: num_cubes
    type(mesh), intent(out) :: model
    integer :: e, i
    model%num_nodes = 4*(num_cubes + 1)
    model%num_elements = num_cubes
    allocate (model%x(3, model%num_nodes), model%nodes(8, num_cubes))
    allocate (model%element_type(num_cubes))
    model%element_type = 'C3D8'
    do i = 0, num_cubes
      model%x(:, 4*i + 1:4*i + 4) = reshape(real([i, 0, 0, i, 1, 0, i, 1, 1, i, 0, 1], rk), [3, 4])
    end do
    do e = 1, num_cubes
      model%nodes(:, e) = [(4*e - 4 + i, i=1, 8)]
    end do
  end subroutine row_of_cubes

  subroutine faces_point_outward(log)
    type(test_log), intent(inout) :: log
    type(mesh) :: model
    real(rk) :: vector(3), arm(3)
    integer :: face, nodes(4)
    call row_of_cubes(1, model)
    do face = 1, 6
      nodes = face_nodes(model, 1, face)
      vector = face_vector(model%x(:, nodes))
      arm = face_centre(model, nodes) - 0.5_rk
      call check_close(log, dot_product(vector, arm), 0.5_rk, 1.0e-14_rk, 'outward normal')
    end do
  end subroutine faces_point_outward

  subroutine two_cubes_have_ten_faces(log)
    type(test_log), intent(inout) :: log
    type(mesh) :: model
    type(surface) :: skin
    call row_of_cubes(2, model)
    call find_exterior(model, [1, 2], skin)
    call check(log, size(skin%element) == 10, 'two cubes have ten faces')
    call check(log, count(skin%element == 1) == 5, 'five faces each')
    call find_exterior(model, [2], skin)
    call check(log, size(skin%element) == 6, 'one of them has six')
  end subroutine two_cubes_have_ten_faces

  subroutine wedge_has_five_faces(log)
    type(test_log), intent(inout) :: log
    type(mesh) :: model
    type(surface) :: skin
    integer :: i, corners
    call row_of_cubes(1, model)
    model%nodes(:, 1) = [1, 2, 3, 3, 5, 6, 7, 7]
    call find_exterior(model, [1], skin)
    call check(log, size(skin%element) == 5, 'a wedge has five faces')
    corners = 0
    do i = 1, size(skin%face)
      corners = corners + count_corners(face_nodes(model, 1, skin%face(i)))
    end do
    call check(log, corners == 18, 'two triangles and three quadrilaterals')
  end subroutine wedge_has_five_faces

  !> Two cubes with a joint in between: the joint covers one face of each.
  subroutine joint_covers_faces(log)
    type(test_log), intent(inout) :: log
    type(mesh) :: model
    type(surface) :: skin
    logical, allocatable :: is_covered(:)
    call row_of_cubes(3, model)
    model%element_type(2) = 'JOINT8'
    call find_exterior(model, [1, 3], skin)
    call mark_covered(model, skin, is_covered)
    call check(log, size(skin%element) == 12, 'two bodies')
    call check(log, count(is_covered) == 2, 'one covered face each')
  end subroutine joint_covers_faces
end program test_mesh_faces
