!> The edges of a joint at the loads of a reservoir (*JOINT LAW, UPLIFT).
module uplift_edges
  use dam_mesh, only: surface
  use joint_rim, only: area_of_facets, face_rim, find_rim
  use kinds, only: rk
  use load_reservoir, only: reservoir_load
  use mesh_faces, only: face_nodes
  use model_draft, only: draft
  use problem_definition, only: problem
  use step_plan, only: step_before
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set
  implicit none
  private
  public :: list_edges, first_that_reaches, edges_of_steps, list_faces

contains

  !> The edges of the joint at each load of a reservoir. The edge upstream is empty where the
  !> surface of the load does not meet the joint, and for other loads.
  subroutine list_edges(model, j, lake_name, rims)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    character(*), intent(in) :: lake_name
    type(face_rim), allocatable, intent(out) :: rims(:) !< (loads)
    integer, allocatable :: slave(:, :), master(:, :)
    logical, allocatable :: is_wet(:)
    integer :: i
    call list_faces(model, j, slave, master)
    allocate (rims(model%num_loads))
    do i = 1, model%num_loads
      allocate (rims(i)%upstream(2, 0), rims(i)%downstream(2, 0))
      select type (lake => model%problem%loads(i)%item)
      type is (reservoir_load)
        if (lake%target /= lake_name) cycle
        call mark_surface(model%problem, lake%faces, is_wet)
        call choose_rim(model%problem%mesh%x, slave, master, is_wet, rims(i))
      end select
    end do
  end subroutine list_edges

  !> The first load whose surface meets the joint; 0: there is none.
  pure integer function first_that_reaches(rims) result(first)
    type(face_rim), intent(in) :: rims(:) !< (loads)
    do first = 1, size(rims)
      if (reaches(rims(first))) return
    end do
    first = 0
  end function first_that_reaches

  !> The load of UPLIFT's reservoir whose edges hold at the end of each step, the first one of
  !> those with equal edges. A load without pressure, or one that does not meet the joint, leaves
  !> the edges as they were. One of the loads must meet the joint.
  function edges_of_steps(model, rims) result(edge)
    type(draft), intent(in) :: model
    type(face_rim), intent(in) :: rims(:) !< (loads)
    integer :: edge(size(model%problem%steps))
    integer :: s, i, before
    do s = 1, size(edge)
      before = step_before(model%problem%steps, s)
      edge(s) = first_that_reaches(rims)
      if (before > 0) edge(s) = edge(before)
      do i = 1, size(model%problem%steps(s)%loads)
        associate (rule => model%problem%steps(s)%loads(i))
          if (rule%load > size(rims) .or. abs(rule%end_factor) <= 0.0_rk) cycle
          if (.not. reaches(rims(rule%load))) cycle
          select type (lake => model%problem%loads(rule%load)%item)
          type is (reservoir_load)
            if (lake%is_hydrostatic) edge(s) = first_equal(rims, rule%load)
          end select
        end associate
      end do
    end do
  end function edges_of_steps

  !> Whether the surface of a load meets the joint.
  pure logical function reaches(rim)
    type(face_rim), intent(in) :: rim
    reaches = size(rim%upstream) > 0
  end function reaches

  !> The first load with the same edges.
  pure integer function first_equal(rims, load) result(first)
    type(face_rim), intent(in) :: rims(:) !< (loads)
    integer, intent(in) :: load
    do first = 1, load - 1
      if (size(rims(first)%upstream) /= size(rims(load)%upstream)) cycle
      if (all(rims(first)%upstream == rims(load)%upstream)) return
    end do
    first = load
  end function first_equal

  !> Marks the nodes of a surface.
  subroutine mark_surface(model, faces, is_wet)
    type(problem), intent(in) :: model
    type(surface), intent(in) :: faces
    logical, allocatable, intent(out) :: is_wet(:) !< (nodes)
    integer :: i
    allocate (is_wet(model%mesh%num_nodes), source=.false.)
    do i = 1, size(faces%element)
      is_wet(face_nodes(model%mesh, faces%element(i), faces%face(i))) = .true.
    end do
  end subroutine mark_surface

  !> Facets of both faces of a joint.
  subroutine list_faces(model, j, slave, master)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    integer, allocatable, intent(out) :: slave(:, :), master(:, :) !< (4, facets) nodes
    type(facet_set) :: facets
    associate (mesh => model%problem%mesh, request => model%joints(j))
      if (request%slave == 0) then
        slave = mesh%nodes(5:8, request%elements)
        master = mesh%nodes(1:4, request%elements)
        return
      end if
      call list_surface_facets(mesh, model%problem%surfaces(request%slave), facets)
      slave = facets%node
      call list_surface_facets(mesh, model%problem%surfaces(request%master), facets)
      master = facets%node
    end associate
  end subroutine list_faces

  !> The rim of the smaller face; of the larger one if the reservoir's surface does not touch the
  !> smaller one.
  subroutine choose_rim(x, slave, master, is_wet, rim)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    integer, intent(in) :: slave(:, :), master(:, :) !< (4, facets)
    logical, intent(in) :: is_wet(:) !< (nodes)
    type(face_rim), intent(out) :: rim
    real(rk), parameter :: roundoff = 1.0e-9_rk
    if (area_of_facets(x, slave) <= area_of_facets(x, master)*(1.0_rk + roundoff)) then
      call find_rim(x, slave, is_wet, rim)
      if (size(rim%upstream) == 0) call find_rim(x, master, is_wet, rim)
    else
      call find_rim(x, master, is_wet, rim)
      if (size(rim%upstream) == 0) call find_rim(x, slave, is_wet, rim)
    end if
  end subroutine choose_rim
end module uplift_edges
