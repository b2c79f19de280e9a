!> Nodes on the upstream and on the downstream face of the dam.
!>
!> Upstream is the surface of the reservoir. Downstream are the outer faces of the dam that face
!> away from the nearest upstream facet and are not covered by joints or ties. The dam is the part
!> with mass where the rock has none; otherwise the sections with the surface of the reservoir, and
!> those behind them: a facing is not the dam. A facing that joints or ties hold is not recognised.
module dam_faces
  use kinds, only: rk
  use dam_mesh, only: fe_mesh, surface
  use mesh_faces, only: face_nodes, face_vector, face_centre, find_exterior, &
                        face_table, open_table, insert_face, find_face
  use covered_faces, only: mark_joined
  use element_catalogue, only: is_solid
  use problem_definition, only: problem
  implicit none
  private
  public :: dam_skin, find_dam_faces

  !> Largest cosine between the normals of a downstream face and of the nearest upstream facet.
  real(rk), parameter :: largest_cosine = -0.3_rk

  !> Part of the area of the back of the dam that may lie against other sections, as at a key in
  !> the rock. Of a facing all of it does, of a dam on rock with mass little.
  real(rk), parameter :: largest_hidden_part = 0.5_rk

  type :: dam_skin
    logical :: is_known = .false. !< there is a reservoir
    logical, allocatable :: is_dam(:) !< (elements) none where there is no reservoir
    logical, allocatable :: is_upstream(:), is_downstream(:) !< (nodes)
  end type dam_skin

contains

  !> Marks the nodes of both faces; none where the problem has no reservoir.
  subroutine find_dam_faces(model, skin)
    type(problem), intent(in) :: model
    type(dam_skin), intent(out) :: skin
    type(surface) :: downstream
    allocate (skin%is_dam(model%mesh%num_elements), source=.false.)
    allocate (skin%is_upstream(model%mesh%num_nodes), source=.false.)
    allocate (skin%is_downstream(model%mesh%num_nodes), source=.false.)
    skin%is_known = model%upstream_surface > 0
    if (.not. skin%is_known) return
    associate (upstream => model%surfaces(model%upstream_surface))
      call mark_nodes(model%mesh, upstream, skin%is_upstream)
      call mark_dam(model, upstream, skin%is_dam)
      call list_downstream(model, upstream, skin%is_dam, downstream)
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

  !> Marks the solid elements of the dam.
  subroutine mark_dam(model, upstream, is_dam)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: upstream
    logical, intent(inout) :: is_dam(:) !< (elements) all .false.
    logical :: has_mass(size(is_dam)), solid(size(is_dam))
    integer, allocatable :: next(:)
    integer :: e
    has_mass = .false.
    solid = is_solid(model%mesh%element_type)
    do e = 1, size(is_dam)
      if (.not. solid(e) .or. model%mesh%material_of_element(e) == 0) cycle
      has_mass(e) = model%materials(model%mesh%material_of_element(e))%density > 0.0_rk
    end do
    if (any(has_mass) .and. any(solid .and. .not. has_mass)) then
      is_dam = has_mass
      return
    end if
    next = upstream%element
    do while (size(next) > 0)
      call mark_sections(model%mesh, next, is_dam)
      is_dam = is_dam .and. solid
      call list_behind(model, upstream, is_dam, solid, next)
    end do
  end subroutine mark_dam

  !> Marks all elements that have the section of one of these.
  subroutine mark_sections(mesh, elements, is_marked)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: elements(:)
    logical, intent(inout) :: is_marked(:)
    logical :: is_wanted(0:maxval(mesh%section_of_element))
    is_wanted = .false.
    is_wanted(mesh%section_of_element(elements)) = .true.
    is_marked = is_marked .or. is_wanted(mesh%section_of_element)
  end subroutine mark_sections

  !> The solids behind the back of the dam where it is hidden by them for the most part, else none.
  subroutine list_behind(model, upstream, is_dam, solid, behind)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: upstream
    logical, intent(in) :: is_dam(:), solid(:) !< (elements)
    integer, allocatable, intent(out) :: behind(:) !< positions of elements
    type(surface) :: back
    real(rk), allocatable :: area(:)
    integer :: i
    behind = [integer ::]
    if (all(is_dam .or. .not. solid)) return
    call list_downstream(model, upstream, is_dam, back)
    allocate (area(size(back%element)))
    do i = 1, size(area)
      area(i) = norm2(face_vector(model%mesh%x(:, face_nodes(model%mesh, back%element(i), &
                                                             back%face(i)))))
    end do
    call find_neighbours(model%mesh, solid .and. .not. is_dam, back, behind)
    if (sum(pack(area, behind > 0)) <= largest_hidden_part*sum(area)) behind = 0
    behind = pack(behind, behind > 0)
  end subroutine list_behind

  !> The element of a group that shares each face; 0 for none.
  subroutine find_neighbours(mesh, is_member, faces, neighbour)
    type(fe_mesh), intent(in) :: mesh
    logical, intent(in) :: is_member(:) !< (elements)
    type(surface), intent(in) :: faces
    integer, allocatable, intent(out) :: neighbour(:) !< (faces)
    type(face_table) :: table
    integer :: owner(0:6*count(is_member)), e, face, number, i
    owner(0) = 0
    call open_table(mesh%num_nodes, 6*count(is_member), table)
    do e = 1, size(is_member)
      if (.not. is_member(e)) cycle
      do face = 1, 6
        call insert_face(table, face_nodes(mesh, e, face), number)
        owner(number) = e
      end do
    end do
    neighbour = [(owner(find_face(table, face_nodes(mesh, faces%element(i), faces%face(i)))), &
                  i=1, size(faces%element))]
  end subroutine find_neighbours

  !> The outer faces of the dam that are not covered and face away from the water.
  subroutine list_downstream(model, upstream, is_dam, downstream)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: upstream
    logical, intent(in) :: is_dam(:) !< (elements)
    type(surface), intent(out) :: downstream
    type(surface) :: outside
    integer :: e
    call find_exterior(model%mesh, pack([(e, e=1, size(is_dam))], is_dam), outside)
    call keep_downstream(model, outside, upstream, downstream)
  end subroutine list_downstream

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
