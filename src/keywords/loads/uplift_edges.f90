!> The edges of a joint at the loads of a reservoir (*JOINT LAW, UPLIFT), in each stage.
!>
!> A stage of a joint is the set of its facets whose solids are there (*MODEL CHANGE). Interim faces
!> have their own edges, and faces of absent solids have none.
module uplift_edges
  use dam_mesh, only: fe_mesh, surface
  use attached_solids, only: solid_list, sides_there
  use element_joint8, only: solids_behind
  use joint_rim, only: area_of_facets, face_rim, find_rim
  use kinds, only: rk
  use load_reservoir, only: reservoir_load
  use mesh_faces, only: face_nodes
  use model_draft, only: draft
  use step_plan, only: step_before, step_load
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set
  implicit none
  private
  public :: joint_stage, list_stages, first_that_reaches, loads_at_edges

  !> A joint in steps that have the same of its solids and of the solids behind the reservoir.
  type :: joint_stage
    integer, allocatable :: slave(:, :), master(:, :) !< (4, facets) nodes; facets that are there
    type(face_rim), allocatable :: rims(:) !< (loads) edges at each load of the reservoir
  end type joint_stage

  !> The complete faces of a joint, and the solids behind their facets.
  type :: joint_faces
    integer, allocatable :: slave(:, :), master(:, :) !< (4, facets) nodes
    type(solid_list) :: behind_slave, behind_master
  end type joint_faces

contains

  !> The stages of a joint, and the stage of each step. Without *MODEL CHANGE there is one.
  subroutine list_stages(model, j, lake_name, stages, of_step)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    character(*), intent(in) :: lake_name
    type(joint_stage), allocatable, intent(out) :: stages(:)
    integer, intent(out) :: of_step(:) !< (steps)
    type(joint_faces) :: faces
    logical, allocatable :: is_absent(:, :) !< (elements, stages)
    integer :: s
    call list_faces(model, j, faces)
    call number_stages(model, relevant_solids(model, faces, lake_name), of_step, is_absent)
    allocate (stages(size(is_absent, 2)))
    do s = 1, size(stages)
      stages(s)%slave = faces_there(faces%slave, faces%behind_slave, is_absent(:, s))
      stages(s)%master = faces_there(faces%master, faces%behind_master, is_absent(:, s))
      call list_edges(model, lake_name, is_absent(:, s), stages(s))
    end do
  end subroutine list_stages

  !> The facets whose solids are there. JOINT8 elements need solids on both sides.
  pure function faces_there(facets, behind, is_absent) result(there)
    integer, intent(in) :: facets(:, :) !< (4, facets) nodes
    type(solid_list), intent(in) :: behind
    logical, intent(in) :: is_absent(:) !< (elements)
    integer, allocatable :: there(:, :) !< (4, facets that are there)
    logical :: is_there(behind%num_sides)
    integer :: f, sides
    is_there = sides_there(behind, is_absent)
    sides = behind%num_sides/max(1, size(facets, 2))
    there = facets(:, pack([(f, f=1, size(facets, 2))], &
                           [(all(is_there(sides*(f - 1) + 1:sides*f)), f=1, size(facets, 2))]))
  end function faces_there

  !> Facets of both faces of a joint.
  subroutine list_faces(model, j, faces)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    type(joint_faces), intent(out) :: faces
    type(facet_set) :: facets
    associate (mesh => model%problem%mesh, request => model%joints(j))
      if (request%slave == 0) then
        faces%slave = mesh%nodes(5:8, request%elements)
        faces%master = mesh%nodes(1:4, request%elements)
        faces%behind_slave = solids_behind(mesh, request%elements)
        faces%behind_master = faces%behind_slave
        return
      end if
      call list_surface_facets(mesh, model%problem%surfaces(request%slave), facets)
      faces%slave = facets%node
      faces%behind_slave = solid_list(facets%element)
      call list_surface_facets(mesh, model%problem%surfaces(request%master), facets)
      faces%master = facets%node
      faces%behind_master = solid_list(facets%element)
    end associate
  end subroutine list_faces

  !> Marks the solids behind a joint and behind the surfaces of a reservoir.
  function relevant_solids(model, faces, lake_name) result(is_relevant)
    type(draft), intent(in) :: model
    type(joint_faces), intent(in) :: faces
    character(*), intent(in) :: lake_name
    logical :: is_relevant(model%problem%mesh%num_elements)
    integer :: i
    is_relevant = .false.
    is_relevant(faces%behind_slave%solid(:faces%behind_slave%num)) = .true.
    is_relevant(faces%behind_master%solid(:faces%behind_master%num)) = .true.
    do i = 1, model%num_loads
      select type (lake => model%problem%loads(i)%item)
      type is (reservoir_load)
        if (lake%target == lake_name) is_relevant(lake%faces%element) = .true.
      end select
    end do
  end function relevant_solids

  !> Numbers the steps by the relevant solids that are there.
  subroutine number_stages(model, is_relevant, of_step, is_absent)
    type(draft), intent(in) :: model
    logical, intent(in) :: is_relevant(:) !< (elements)
    integer, intent(out) :: of_step(:) !< (steps)
    logical, allocatable, intent(out) :: is_absent(:, :) !< (elements, stages)
    logical, allocatable :: lacks(:, :) !< (relevant elements, steps)
    integer, allocatable :: first_step(:)
    integer :: e, s, k
    if (.not. allocated(model%problem%stages%is_absent)) then
      of_step = 1
      allocate (is_absent(size(is_relevant), 1), source=.false.)
      return
    end if
    allocate (first_step(0))
    lacks = model%problem%stages%is_absent(pack([(e, e=1, size(is_relevant))], is_relevant), :)
    do s = 1, size(of_step)
      do k = 1, size(first_step)
        if (all(lacks(:, s) .eqv. lacks(:, first_step(k)))) exit
      end do
      if (k > size(first_step)) first_step = [first_step, s]
      of_step(s) = k
    end do
    is_absent = model%problem%stages%is_absent(:, first_step)
  end subroutine number_stages

  !> The edges of a stage at each load of a reservoir. The edge upstream is empty where the surface
  !> of the load does not meet the joint, and for other loads.
  subroutine list_edges(model, lake_name, is_absent, stage)
    type(draft), intent(in) :: model
    character(*), intent(in) :: lake_name
    logical, intent(in) :: is_absent(:) !< (elements)
    type(joint_stage), intent(inout) :: stage
    logical, allocatable :: is_wet(:)
    integer :: i
    allocate (stage%rims(model%num_loads))
    do i = 1, model%num_loads
      associate (rim => stage%rims(i))
        allocate (rim%upstream(2, 0), rim%downstream(2, 0))
        select type (lake => model%problem%loads(i)%item)
        type is (reservoir_load)
          if (lake%target /= lake_name) cycle
          call mark_surface(model%problem%mesh, lake%faces, is_absent, is_wet)
          call choose_rim(model%problem%mesh%x, stage, is_wet, rim)
        end select
      end associate
    end do
  end subroutine list_edges

  !> Marks the nodes of the faces of a surface whose solids are there.
  subroutine mark_surface(mesh, faces, is_absent, is_wet)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: faces
    logical, intent(in) :: is_absent(:) !< (elements)
    logical, allocatable, intent(out) :: is_wet(:) !< (nodes)
    integer :: i
    allocate (is_wet(mesh%num_nodes), source=.false.)
    do i = 1, size(faces%element)
      if (is_absent(faces%element(i))) cycle
      is_wet(face_nodes(mesh, faces%element(i), faces%face(i))) = .true.
    end do
  end subroutine mark_surface

  !> The rim of the smaller face; of the larger one if the reservoir's surface does not touch the
  !> smaller one.
  subroutine choose_rim(x, stage, is_wet, rim)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(joint_stage), intent(in) :: stage
    logical, intent(in) :: is_wet(:) !< (nodes)
    type(face_rim), intent(out) :: rim
    real(rk), parameter :: roundoff = 1.0e-9_rk
    associate (slave => stage%slave, master => stage%master)
      if (area_of_facets(x, slave) <= area_of_facets(x, master)*(1.0_rk + roundoff)) then
        call find_rim(x, slave, is_wet, rim)
        if (size(rim%upstream) == 0) call find_rim(x, master, is_wet, rim)
      else
        call find_rim(x, master, is_wet, rim)
        if (size(rim%upstream) == 0) call find_rim(x, slave, is_wet, rim)
      end if
    end associate
  end subroutine choose_rim

  !> The first load whose surface meets the joint; 0: there is none.
  pure integer function first_that_reaches(rims) result(first)
    type(face_rim), intent(in) :: rims(:) !< (loads)
    do first = 1, size(rims)
      if (reaches(rims(first))) return
    end do
    first = 0
  end function first_that_reaches

  !> The load of UPLIFT's reservoir whose surface gives the edges at the start and at the end of
  !> each step, in the stage of the step; the first one of those with equal edges. A load without
  !> pressure, or one that does not meet the joint, leaves the edges as they were. 0: no surface
  !> meets the joint in this stage.
  function loads_at_edges(model, stages, stage_of_step) result(at_edge)
    type(draft), intent(in) :: model
    type(joint_stage), intent(in) :: stages(:)
    integer, intent(in) :: stage_of_step(:) !< (steps)
    integer :: at_edge(2, size(stage_of_step))
    integer :: s, i, before, last(size(stage_of_step))
    do s = 1, size(stage_of_step)
      before = step_before(model%problem%steps, s)
      associate (rims => stages(stage_of_step(s))%rims, rules => model%problem%steps(s)%loads)
        last(s) = 0
        if (before > 0) last(s) = last(before)
        last(s) = in_this_stage(rims, last(s))
        at_edge(1, s) = first_equal(rims, last(s))
        do i = 1, size(rules)
          if (is_at_edge(model, rims, rules(i))) last(s) = rules(i)%load
        end do
        at_edge(2, s) = first_equal(rims, last(s))
        if (before == 0) at_edge(1, s) = at_edge(2, s)
      end associate
    end do
  end function loads_at_edges

  !> The load itself, or the first one that meets the joint where the load does not.
  pure integer function in_this_stage(rims, load) result(chosen)
    type(face_rim), intent(in) :: rims(:) !< (loads)
    integer, intent(in) :: load !< 0 for none
    chosen = first_that_reaches(rims)
    if (load == 0) return
    if (reaches(rims(load))) chosen = load
  end function in_this_stage

  !> Whether a load of a step gives the joint its edges: it has water, and its surface meets the
  !> joint.
  pure logical function is_at_edge(model, rims, rule)
    type(draft), intent(in) :: model
    type(face_rim), intent(in) :: rims(:) !< (loads) at the reservoir
    type(step_load), intent(in) :: rule
    is_at_edge = .false.
    if (rule%load > size(rims) .or. abs(rule%end_factor) <= 0.0_rk) return
    if (.not. reaches(rims(rule%load))) return
    select type (lake => model%problem%loads(rule%load)%item)
    type is (reservoir_load)
      is_at_edge = lake%is_hydrostatic
    end select
  end function is_at_edge

  !> Whether the surface of a load meets the joint.
  pure logical function reaches(rim)
    type(face_rim), intent(in) :: rim
    reaches = size(rim%upstream) > 0
  end function reaches

  !> The first load with the same edges; 0 for 0.
  pure integer function first_equal(rims, load) result(first)
    type(face_rim), intent(in) :: rims(:) !< (loads)
    integer, intent(in) :: load
    do first = 1, load - 1
      if (size(rims(first)%upstream) /= size(rims(load)%upstream)) cycle
      if (all(rims(first)%upstream == rims(load)%upstream)) return
    end do
    first = load
  end function first_equal
end module uplift_edges
