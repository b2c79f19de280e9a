!> Nodes on the upstream and on the downstream face of the dam.
!>
!> Upstream is the surface of the reservoir. Downstream are the outer faces of the dam that face
!> away from the nearest upstream facet and are not covered by joints or ties. The dam is the part
!> with mass where the rock has none; otherwise the sections with the surface of the reservoir.
module dam_faces
  use kinds, only: rk
  use dam_mesh, only: fe_mesh, surface
  use mesh_faces, only: face_nodes, face_vector, face_centre, find_exterior
  use covered_faces, only: mark_joined
  use element_catalogue, only: is_solid
  use problem_definition, only: problem
  implicit none
  private
  public :: dam_skin, find_dam_faces

  !> Largest cosine between the normals of a downstream face and of the nearest upstream facet.
  real(rk), parameter :: largest_cosine = -0.3_rk

  type :: dam_skin
    logical :: is_known = .false. !< there is a reservoir
    logical, allocatable :: is_upstream(:), is_downstream(:) !< (nodes)
  end type dam_skin

contains

  !> Marks the nodes of both faces; none where the problem has no reservoir.
  subroutine find_dam_faces(model, skin)
    type(problem), intent(in) :: model
    type(dam_skin), intent(out) :: skin
    type(surface) :: outside, downstream
    integer, allocatable :: body(:)
    allocate (skin%is_upstream(model%mesh%num_nodes), source=.false.)
    allocate (skin%is_downstream(model%mesh%num_nodes), source=.false.)
    skin%is_known = model%upstream_surface > 0
    if (.not. skin%is_known) return
    associate (upstream => model%surfaces(model%upstream_surface))
      call mark_nodes(model%mesh, upstream, skin%is_upstream)
      call list_dam_elements(model, upstream, body)
      call find_exterior(model%mesh, body, outside)
      call keep_downstream(model, outside, upstream, downstream)
      call mark_nodes(model%mesh, downstream, skin%is_downstream)
    end associate
  end subroutine find_dam_faces

  !> Marks the nodes of a surface.
  subroutine mark_nodes(mesh, faces, is_marked)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: faces
    logical, intent(inout) :: is_marked(:)
    integer :: i
    do i = 1, size(faces%element)
      is_marked(face_nodes(mesh, faces%element(i), faces%face(i))) = .true.
    end do
  end subroutine mark_nodes

  !> The solid elements of the dam.
  subroutine list_dam_elements(model, upstream, body)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: upstream
    integer, allocatable, intent(out) :: body(:)
    logical, allocatable :: has_mass(:), is_dam(:)
    integer :: e
    allocate (has_mass(model%mesh%num_elements), source=.false.)
    do e = 1, model%mesh%num_elements
      if (.not. is_solid(model%mesh%element_type(e))) cycle
      if (model%mesh%material_of_element(e) == 0) cycle
      has_mass(e) = model%materials(model%mesh%material_of_element(e))%density > 0.0_rk
    end do
    is_dam = is_solid(model%mesh%element_type)
    if (any(has_mass) .and. any(is_dam .and. .not. has_mass)) then
      is_dam = has_mass
    else
      do e = 1, model%mesh%num_elements
        is_dam(e) = is_dam(e) .and. any(model%mesh%section_of_element(upstream%element) == &
                                        model%mesh%section_of_element(e))
      end do
    end if
    body = pack([(e, e=1, model%mesh%num_elements)], is_dam)
  end subroutine list_dam_elements

  !> Keeps the outer faces that face away from the nearest upstream facet.
  subroutine keep_downstream(model, outside, upstream, downstream)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: outside, upstream
    type(surface), intent(out) :: downstream
    logical, allocatable :: is_covered(:), is_kept(:)
    real(rk), allocatable :: centre(:, :), normal(:, :)
    real(rk) :: here(3), outward(3)
    integer :: i, nodes(4), nearest
    call mark_joined(model, outside, is_covered)
    allocate (centre(3, size(upstream%element)), normal(3, size(upstream%element)))
    do i = 1, size(upstream%element)
      nodes = face_nodes(model%mesh, upstream%element(i), upstream%face(i))
      centre(:, i) = face_centre(model%mesh, nodes)
      normal(:, i) = unit_vector(face_vector(model%mesh%x(:, nodes)))
    end do
    is_kept = .not. is_covered
    do i = 1, size(outside%element)
      if (is_covered(i)) cycle
      nodes = face_nodes(model%mesh, outside%element(i), outside%face(i))
      here = face_centre(model%mesh, nodes)
      outward = unit_vector(face_vector(model%mesh%x(:, nodes)))
      nearest = nearest_point(centre, here)
      is_kept(i) = dot_product(outward, normal(:, nearest)) < largest_cosine
    end do
    downstream%element = pack(outside%element, is_kept)
    downstream%face = pack(outside%face, is_kept)
  end subroutine keep_downstream

  !> Position of the nearest point; of the first where several are equally near.
  pure integer function nearest_point(points, here) result(nearest)
    real(rk), intent(in) :: points(:, :), here(3)
    integer :: i
    real(rk) :: distance, least
    nearest = 1
    least = huge(least)
    do i = 1, size(points, 2)
      distance = (points(1, i) - here(1))**2 + (points(2, i) - here(2))**2 + &
                 (points(3, i) - here(3))**2
      if (distance >= least) cycle
      least = distance
      nearest = i
    end do
  end function nearest_point

  !> Unit vector along a vector; zero for a zero vector.
  pure function unit_vector(vector) result(direction)
    real(rk), intent(in) :: vector(3)
    real(rk) :: direction(3)
    direction = vector/max(norm2(vector), tiny(1.0_rk))
  end function unit_vector
end module dam_faces
