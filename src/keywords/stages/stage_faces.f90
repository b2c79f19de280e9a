!> The parts of joints whose faces come and go with their solids (theory.md, 15.1).
!>
!> With points at nodes, a part is built as a joint of its faces alone; its points are found among
!> those of the complete joint by their slave node and their normal. A Gauss point belongs to one
!> face, and comes and goes with it.
module stage_faces
  use attached_solids, only: sides_there, solid_list
  use coupling_joint, only: lay_node_points
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list
  use element_joint8, only: build_joint_points, solids_behind
  use errors, only: error_type
  use facet_segments, only: find_segments
  use finish_joints, only: farthest_contact, farthest_gap, followers
  use joint_points, only: dam_joint, point_rows, stage_parts
  use kinds, only: rk
  use model_draft, only: draft
  use stage_plan, only: classes_of
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set, segment_set, surface_cover
  implicit none
  private
  public :: complete_parts

  !> The faces of a joint: JOINT8 elements, or segments between two surfaces.
  type :: face_list
    integer :: num_faces = 0
    integer, allocatable :: element(:) !< (faces) JOINT8 elements
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(solid_list) :: behind !< the solids of both sides of each face
    integer, allocatable :: part(:) !< (faces) which of them come and go together
  end type face_list

contains

  !> Gives parts to the joints with faces that are absent in some step. The nodes of such a face may
  !> have other elements, so that they do not say whether its points are there.
  subroutine complete_parts(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(face_list) :: faces
    type(stage_parts) :: parts
    integer :: j
    if (.not. allocated(model%problem%stages%is_absent)) return
    do j = 1, size(model%problem%joints)
      call list_faces(model, j, faces)
      call number_parts(model%problem%stages%is_absent, faces, parts)
      call warn_of_idle_grout(model, j, parts, faults)
      if (all(parts%is_there)) cycle
      if (model%problem%joints(j)%is_nodal) then
        call share_areas(model, j, faces, parts)
        if (allocated(faces%segments%slave)) call list_rows(model, j, faces, parts)
      else
        call assign_areas(model%problem%joints(j), faces, parts)
      end if
      model%problem%joints(j)%parts = parts
    end do
  end subroutine complete_parts

  !> Grout in a step in which no point of the joint is there.
  subroutine warn_of_idle_grout(model, number, parts, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    type(stage_parts), intent(in) :: parts
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, s
    s = 0
    do i = 1, size(model%cards)
      if (is_keyword(model%cards(i), 'STEP')) s = s + 1
      if (.not. is_keyword(model%cards(i), 'GROUT')) cycle
      if (model%cards(i)%word('JOINT') /= model%joints(number)%name) cycle
      if (any(parts%is_there(:, s))) cycle
      call model%cards(i)%warn(faults, 'all points of the joint are absent in this step, '// &
                               'so that the card has no effect', &
                               'a *GROUT in a step in which both sides are there')
    end do
  end subroutine warn_of_idle_grout

  !> The faces of a joint and the solids behind them.
  subroutine list_faces(model, number, faces)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    type(face_list), intent(out) :: faces
    type(surface_cover) :: cover
    integer :: s
    associate (request => model%joints(number), mesh => model%problem%mesh)
      if (request%slave == 0) then
        faces%element = request%elements
        faces%num_faces = size(faces%element)
        faces%behind = solids_behind(mesh, faces%element)
        return
      end if
      call list_surface_facets(mesh, model%problem%surfaces(request%slave), faces%slave)
      call list_surface_facets(mesh, model%problem%surfaces(request%master), faces%master)
      call find_segments(mesh%x, faces%slave, faces%master, faces%segments, cover, &
                         merge(farthest_gap, farthest_contact, request%is_measured))
      faces%num_faces = faces%segments%num_segments
      faces%behind = solid_list( &
                     [(faces%slave%element(faces%segments%slave(s)), &
                       faces%master%element(faces%segments%master(s)), s=1, faces%num_faces)])
    end associate
  end subroutine list_faces

  !> Numbers the faces so that those of one part come and go together.
  subroutine number_parts(is_absent, faces, parts)
    logical, intent(in) :: is_absent(:, :) !< (elements, steps)
    type(face_list), intent(inout) :: faces
    type(stage_parts), intent(out) :: parts
    logical :: lacks(faces%num_faces, size(is_absent, 2)), is_there(2*faces%num_faces)
    integer :: f, s
    do s = 1, size(is_absent, 2)
      is_there = sides_there(faces%behind, is_absent(:, s))
      lacks(:, s) = .not. (is_there(1::2) .and. is_there(2::2))
    end do
    faces%part = classes_of(lacks)
    allocate (parts%is_there(maxval([0, faces%part]), size(is_absent, 2)))
    do f = 1, size(faces%part)
      parts%is_there(faces%part(f), :) = .not. lacks(f, :)
    end do
  end subroutine number_parts

  !> The area of each part at each point.
  subroutine share_areas(model, number, faces, parts)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    type(face_list), intent(in) :: faces
    type(stage_parts), intent(inout) :: parts
    type(dam_joint) :: alone
    integer :: i, p, whole
    allocate (parts%area(size(parts%is_there, 1), model%problem%joints(number)%num_points), &
              source=0.0_rk)
    do i = 1, size(parts%is_there, 1)
      call build_alone(model, number, faces, faces%part == i, alone)
      do p = 1, alone%num_points
        whole = place_of(alone, p, model%problem%joints(number))
        if (whole > 0) parts%area(i, whole) = parts%area(i, whole) + alone%area(p)
      end do
    end do
  end subroutine share_areas

  !> The area of a Gauss point is that of the part of its face.
  pure subroutine assign_areas(joint, faces, parts)
    type(dam_joint), intent(in) :: joint
    type(face_list), intent(in) :: faces
    type(stage_parts), intent(inout) :: parts
    integer :: p
    allocate (parts%area(size(parts%is_there, 1), joint%num_points), source=0.0_rk)
    do p = 1, joint%num_points
      parts%area(faces%part(joint%face(p)), p) = joint%area(p)
    end do
  end subroutine assign_areas

  !> A joint of some of the faces.
  subroutine build_alone(model, number, faces, is_chosen, alone)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    type(face_list), intent(in) :: faces
    logical, intent(in) :: is_chosen(:) !< (faces)
    type(dam_joint), intent(out) :: alone
    type(error_type), allocatable :: error
    type(segment_set) :: segments
    logical, allocatable :: is_bare(:)
    associate (mesh => model%problem%mesh)
      if (allocated(faces%element)) then ! the complete joint was built without an error
        call build_joint_points(mesh, pack(faces%element, is_chosen), .true., alone, error)
      else
        call choose_segments(faces%segments, is_chosen, segments)
        call lay_node_points(mesh%x, faces%slave, faces%master, segments, &
                             followers(model, faces%slave), model%joints(number)%is_measured, &
                             alone, is_bare)
      end if
    end associate
  end subroutine build_alone

  !> Some of the segments.
  pure subroutine choose_segments(all_of_them, is_chosen, segments)
    type(segment_set), intent(in) :: all_of_them
    logical, intent(in) :: is_chosen(:) !< (segments)
    type(segment_set), intent(out) :: segments
    integer, allocatable :: vertices(:)
    integer :: s, v
    segments%farthest = all_of_them%farthest
    segments%num_segments = count(is_chosen)
    segments%slave = pack(all_of_them%slave(:size(is_chosen)), is_chosen)
    segments%master = pack(all_of_them%master(:size(is_chosen)), is_chosen)
    segments%first_vertex = [1]
    allocate (vertices(0))
    do s = 1, size(is_chosen)
      if (.not. is_chosen(s)) cycle
      vertices = [vertices, (v, v=all_of_them%first_vertex(s), all_of_them%first_vertex(s + 1) - 1)]
      segments%first_vertex = [segments%first_vertex, size(vertices) + 1]
    end do
    segments%vertex = all_of_them%vertex(:, vertices)
    segments%vertex_shape = all_of_them%vertex_shape(:, vertices)
  end subroutine choose_segments

  !> The point of a joint with the slave node, the first master node of a pair, and the nearest
  !> normal of a point of a part; 0 for none.
  pure integer function place_of(part, p, joint) result(place)
    type(dam_joint), intent(in) :: part, joint
    integer, intent(in) :: p !< point of the part
    real(rk) :: nearest, cosine
    integer :: q
    place = 0
    nearest = -2.0_rk
    do q = 1, joint%num_points
      if (joint%node(joint%first(q)) /= part%node(part%first(p))) cycle
      if (joint%is_matching) then
        if (joint%node(joint%first_master(q)) /= part%node(part%first_master(p))) cycle
      end if
      cosine = dot_product(joint%rotation(1, :, q), part%rotation(1, :, p))
      if (cosine <= nearest) cycle
      nearest = cosine
      place = q
    end do
  end function place_of

  !> The nodes and weights of the points in each step: those of a joint of the faces that are there.
  subroutine list_rows(model, number, faces, parts)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    type(face_list), intent(in) :: faces
    type(stage_parts), intent(inout) :: parts
    type(dam_joint) :: alone
    integer :: s, earlier, n
    allocate (parts%rows(size(parts%is_there, 2)), parts%rows_of_step(size(parts%is_there, 2)))
    n = 0
    do s = 1, size(parts%is_there, 2)
      do earlier = 1, s
        if (all(parts%is_there(:, earlier) .eqv. parts%is_there(:, s))) exit
      end do
      if (earlier < s) then
        parts%rows_of_step(s) = parts%rows_of_step(earlier)
        cycle
      end if
      n = n + 1
      parts%rows_of_step(s) = n
      call build_alone(model, number, faces, parts%is_there(faces%part, s), alone)
      call replace_rows(alone, model%problem%joints(number), parts%rows(n))
    end do
    parts%rows = parts%rows(:n)
  end subroutine list_rows

  !> The nodes of the points of a part; points without one keep those of the complete joint.
  subroutine replace_rows(part, joint, rows)
    type(dam_joint), intent(in) :: part, joint
    type(point_rows), intent(out) :: rows
    integer :: own(joint%num_points), p, q, n
    own = 0
    do p = 1, part%num_points
      q = place_of(part, p, joint)
      if (q > 0) own(q) = p
    end do
    rows%first = joint%first
    rows%first_master = joint%first_master
    n = size(part%node) + size(joint%node)
    allocate (rows%node(n), rows%weight(n))
    do q = 1, joint%num_points
      if (own(q) > 0) then
        call take(part, own(q))
      else
        call take(joint, q)
      end if
    end do
    n = rows%first(joint%num_points + 1) - 1
    rows%node = rows%node(:n)
    rows%weight = rows%weight(:n)
  contains
    !> Point p of a joint becomes point q.
    subroutine take(from, p)
      type(dam_joint), intent(in) :: from
      integer, intent(in) :: p
      integer :: length
      length = from%first(p + 1) - from%first(p)
      associate (start => rows%first(q))
        rows%node(start:start + length - 1) = from%node(from%first(p):from%first(p + 1) - 1)
        rows%weight(start:start + length - 1) = from%weight(from%first(p):from%first(p + 1) - 1)
        rows%first_master(q) = start + from%first_master(p) - from%first(p)
        rows%first(q + 1) = start + length
      end associate
    end subroutine take
  end subroutine replace_rows
end module stage_faces
