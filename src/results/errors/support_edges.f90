!> Where supports that hold all directions end: places inside such a support have finite stresses,
!> its edges have not (theory.md, 14.6).
module support_edges
  use dam_mesh, only: element_is_there, fe_mesh
  use element_catalogue, only: is_solid
  use kinds, only: rk
  use mesh_faces, only: count_corners, face_nodes, face_vector
  use problem_definition, only: problem
  implicit none
  private
  public :: directions_held, is_inside_support

  real(rk), parameter :: near = 1.0e-6_rk !< of the size of the model: the same place
  real(rk), parameter :: along = 0.999_rk !< cosine of the angle between a normal and an axis
  integer, parameter :: most_faces = 192 !< three of each of 64 solids at one place

contains

  !> The directions that supports hold at the nodes of a place, in any step.
  function directions_held(model, x) result(is_held)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: x(3) !< [m]
    logical :: is_held(3)
    real(rk) :: reach
    integer :: i, k
    is_held = .false.
    reach = reach_of(model%mesh)
    do i = 1, size(model%steps)
      associate (fixed => model%steps(i)%fixities)
        do k = 1, size(fixed)
          if (any(abs(model%mesh%x(:, fixed(k)%node) - x) > reach)) cycle
          is_held(fixed(k)%dof) = .true.
        end do
      end associate
    end do
  end function directions_held

  !> Distance of nodes at one place [m].
  pure real(rk) function reach_of(mesh)
    type(fe_mesh), intent(in) :: mesh
    reach_of = near*maxval(maxval(mesh%x, dim=2) - minval(mesh%x, dim=2))
  end function reach_of

  !> Whether no free face touches a place: each outer face there is held in all directions, or along
  !> its normal as in a plane of symmetry.
  logical function is_inside_support(model, x) result(is_inside)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: x(3) !< a node [m]
    integer :: corner(4, most_faces), i, num_faces
    real(rk) :: centre(3, most_faces), reach
    reach = reach_of(model%mesh)
    call list_faces(model%mesh, x, reach, corner, centre, num_faces)
    is_inside = num_faces > 0
    do i = 1, num_faces
      if (count(all(abs(centre(:, :num_faces) - spread(centre(:, i), 2, num_faces)) <= reach, &
                    dim=1)) > 1) cycle
      is_inside = is_inside .and. is_face_held(model, corner(:, i))
    end do
  end function is_inside_support

  !> The faces of solids with a corner at a place.
  subroutine list_faces(mesh, x, reach, corner, centre, num_faces)
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: x(3), reach !< [m]
    integer, intent(out) :: corner(4, most_faces) !< positions of nodes
    real(rk), intent(out) :: centre(3, most_faces) !< [m]
    integer, intent(out) :: num_faces
    logical :: is_here(8)
    integer :: e, f, nodes(4)
    num_faces = 0
    do e = 1, mesh%num_elements
      if (.not. is_solid(mesh%element_type(e)) .or. .not. element_is_there(mesh, e)) cycle
      associate (corners => mesh%x(:, mesh%nodes(:, e)))
        if (any(x < minval(corners, dim=2) - reach .or. x > maxval(corners, dim=2) + reach)) cycle
        is_here = all(abs(corners - spread(x, 2, 8)) <= reach, dim=1)
      end associate
      if (.not. any(is_here)) cycle
      do f = 1, 6
        nodes = face_nodes(mesh, e, f)
        if (count_corners(nodes) < 3) cycle
        if (.not. any(all(abs(mesh%x(:, nodes) - spread(x, 2, 4)) <= reach, dim=1))) cycle
        if (num_faces == most_faces) return
        num_faces = num_faces + 1
        corner(:, num_faces) = nodes
        centre(:, num_faces) = sum(mesh%x(:, nodes), dim=2)/4.0_rk
      end do
    end do
  end subroutine list_faces

  !> Whether the corners of a face are held in all directions, or along its normal.
  logical function is_face_held(model, nodes) result(is_held)
    type(problem), intent(in) :: model
    integer, intent(in) :: nodes(4)
    logical :: in_all(3), here(3)
    real(rk) :: normal(3)
    integer :: a, d
    in_all = .true.
    do a = 1, 4
      here = directions_held(model, model%mesh%x(:, nodes(a)))
      in_all = in_all .and. here
    end do
    normal = face_vector(model%mesh%x(:, nodes))
    d = maxloc(abs(normal), dim=1)
    is_held = all(in_all) .or. (in_all(d) .and. abs(normal(d)) >= along*norm2(normal))
  end function is_face_held
end module support_edges
