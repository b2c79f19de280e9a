!> The water in joints (*JOINT LAW, UPLIFT): a separate load for each *RESERVOIR named, active in
!> the same steps with the same factors.
module finish_uplift
  use applied_load, only: load
  use dam_mesh, only: surface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use joint_rim, only: area_of_facets, face_rim, find_rim
  use kinds, only: rk
  use load_reservoir, only: reservoir_load
  use load_uplift, only: fill_linear, fill_open, uplift_load
  use mesh_faces, only: face_nodes
  use model_draft, only: add_load, draft, law_of_joint, law_request
  use named_things, only: longest_name
  use nearest_words, only: nearest_word
  use problem_definition, only: problem
  use step_plan, only: step_load
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set
  implicit none
  private
  public :: complete_uplift

contains

  !> Adds the loads of uplift. All joints must be built.
  subroutine complete_uplift(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, j
    do i = 1, size(model%laws)
      call check_names(model, i, faults)
    end do
    if (faults%has_errors()) return
    do j = 1, size(model%joints)
      i = law_of_joint(model, j)
      call fill_joint(model, j, model%laws(i), model%laws(i)%uplift, .false., faults)
      call fill_joint(model, j, model%laws(i), model%laws(i)%tail_water, .true., faults)
    end do
  end subroutine complete_uplift

  !> Checks that the reservoirs of a law exist and have hydrostatic pressure.
  subroutine check_names(model, law, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: law !< position
    type(diagnostic_list), intent(inout) :: faults
    associate (request => model%laws(law), place => model%cards(model%laws(law)%spot%card))
      call check_name(model, place, 'UPLIFT', request%uplift, faults)
      call check_name(model, place, 'TAIL WATER', request%tail_water, faults)
    end associate
  end subroutine check_names

  !> Checks one name of a reservoir; '' is none.
  subroutine check_name(model, place, parameter_name, wanted, faults)
    type(draft), intent(in) :: model
    type(card), intent(in) :: place
    character(*), intent(in) :: parameter_name
    character(*), intent(in) :: wanted !< upper case
    type(diagnostic_list), intent(inout) :: faults
    character(longest_name) :: known(model%num_loads)
    logical :: is_found, presses
    integer :: i, n
    if (wanted == '') return
    n = 0
    is_found = .false.
    presses = .false.
    do i = 1, model%num_loads
      select type (lake => model%problem%loads(i)%item)
      type is (reservoir_load)
        n = n + 1
        known(n) = lake%target
        is_found = is_found .or. lake%target == wanted
        presses = presses .or. (lake%target == wanted .and. lake%is_hydrostatic)
      end select
    end do
    if (.not. is_found) then
      call place%fault_parameter(faults, parameter_name, "there is no reservoir '"// &
                                 place%text(parameter_name)//"'", &
                                 'the NAME of a *RESERVOIR in one of the steps', &
                                 nearest_word(wanted, known(:n)))
    else if (.not. presses) then
      call place%warn(faults, parameter_name//" has no effect: reservoir '"// &
                      place%text(parameter_name)//"' has HYDROSTATIC=NO")
    end if
  end subroutine check_name

  !> Adds the loads of one joint: one for each load of the reservoir, in any step. A reservoir whose
  !> surface grows from step to step has no pressure in the joint until its surface reaches it.
  subroutine fill_joint(model, j, request, lake_name, is_tail, faults)
    type(draft), intent(inout) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    character(*), intent(in) :: lake_name !< '' for none
    logical, intent(in) :: is_tail !< the reservoir is that of TAIL WATER
    type(diagnostic_list), intent(inout) :: faults
    type(uplift_load) :: water
    type(face_rim) :: reached, rim
    logical :: is_dry
    integer :: i, num_before
    if (lake_name == '') return
    call find_edges(model, j, request%uplift, 0, reached)
    if (size(reached%upstream) == 0) then
      if (.not. is_tail) call fault_no_edge(model, j, request, faults)
      return
    end if
    num_before = model%num_loads
    do i = 1, num_before
      select type (lake => model%problem%loads(i)%item)
      type is (reservoir_load)
        if (lake%target /= lake_name) cycle
        rim = reached
        if (.not. is_tail) call find_edges(model, j, lake_name, i, rim)
        is_dry = size(rim%upstream) == 0
        if (is_dry) rim = reached
        call fill_water(model, j, request, rim, lake, is_tail, water, faults)
      class default
        cycle
      end select
      if (faults%has_errors()) return
      if (is_dry) call water%remove_pressure()
      call enter_water(model, i, water, request%profile, lake_name)
    end do
  end subroutine fill_joint

  !> No surface of the reservoir meets the joint.
  subroutine fault_no_edge(model, j, request, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(diagnostic_list), intent(inout) :: faults
    call model%cards(model%joints(j)%spot%card)%fault( &
      faults, "reservoir '"//request%uplift//"' (UPLIFT of law '"//request%law%name// &
      "') does not reach joint '"//model%problem%joints(j)%name// &
      "': its surface has no edge in common with the joint", &
      'a SURFACE of the *RESERVOIR that ends at the edge of the joint')
  end subroutine fault_no_edge

  !> The edges of the joint: upstream where the surface of one load of UPLIFT's reservoir meets the
  !> joint, or of the first load that does. The edge upstream is empty where none does.
  subroutine find_edges(model, j, lake_name, only, rim)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    character(*), intent(in) :: lake_name !< of UPLIFT, also for the tail water
    integer, intent(in) :: only !< load, 0: any of the reservoir
    type(face_rim), intent(out) :: rim
    integer, allocatable :: slave(:, :), master(:, :)
    logical, allocatable :: is_wet(:)
    integer :: i
    call list_faces(model, j, slave, master)
    allocate (rim%upstream(2, 0), rim%downstream(2, 0))
    do i = 1, model%num_loads
      if (only > 0 .and. i /= only) cycle
      select type (lake => model%problem%loads(i)%item)
      type is (reservoir_load)
        if (lake%target /= lake_name) cycle
        call mark_surface(model%problem, lake%faces, is_wet)
        call choose_rim(model%problem%mesh%x, slave, master, is_wet, rim)
        if (size(rim%upstream) > 0) return
      end select
    end do
  end subroutine find_edges

  !> The pressures at the points of the joint.
  subroutine fill_water(model, j, request, rim, lake, is_tail, water, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(face_rim), intent(in) :: rim
    type(reservoir_load), intent(in) :: lake
    logical, intent(in) :: is_tail
    type(uplift_load), intent(out) :: water
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: slave(:, :), master(:, :)
    associate (place => model%cards(model%joints(j)%spot%card), joint => model%problem%joints(j))
      if (size(rim%downstream) == 0 .and. request%profile == 'LINEAR') then
        call place%fault(faults, "joint '"//joint%name//"' has no edge opposite to the one at "// &
                         "reservoir '"//request%uplift//"'", 'a downstream edge, or PROFILE=OPEN')
        return
      end if
      water%wet_joint = j
      water%kind = 'uplift'
      if (request%profile == 'OPEN') then
        call list_faces(model, j, slave, master)
        call fill_open(model%problem%mesh, joint, rim, slave, lake, water)
      else
        call fill_linear(model%problem%mesh, joint, rim, lake, is_tail, water)
      end if
    end associate
  end subroutine fill_water

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

  !> Adds the load to the problem, active in the steps in which the reservoir is active.
  subroutine enter_water(model, lake, water, profile, lake_name)
    type(draft), intent(inout) :: model
    integer, intent(in) :: lake !< load that is the reservoir
    type(uplift_load), intent(in) :: water
    character(*), intent(in) :: profile, lake_name
    class(load), allocatable :: item
    type(step_load) :: rule
    integer :: s, i
    allocate (item, source=water)
    associate (wet => model%problem%joints(water%wet_joint))
      call add_load(model, item, 'water of '//lake_name//' in joint '//wet%name//' ('//profile// &
                    ')', 'JOINT LAW', lake_name)
    end associate
    do s = 1, size(model%problem%steps)
      associate (step => model%problem%steps(s))
        do i = 1, size(step%loads)
          if (step%loads(i)%load /= lake) cycle
          rule = step%loads(i)
          rule%load = model%num_loads
          step%loads = [step%loads, rule]
        end do
      end associate
    end do
  end subroutine enter_water
end module finish_uplift
