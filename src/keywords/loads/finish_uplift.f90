!> The water in joints (*JOINT LAW, UPLIFT): a separate load for each *RESERVOIR named, active in
!> the same steps with the same factors.
module finish_uplift
  use applied_load, only: load
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use load_reservoir, only: reservoir_load
  use load_uplift, only: fill_dry, fill_linear, fill_open, uplift_load
  use model_draft, only: add_load, draft, law_of_joint, law_request
  use named_things, only: longest_name
  use nearest_words, only: nearest_word
  use step_plan, only: step_load
  use uplift_edges, only: first_that_reaches, joint_stage, list_stages, loads_at_edges
  implicit none
  private
  public :: complete_uplift

  !> Whose water it is, and where the diagram ends.
  type :: water_source
    integer :: lake = 0 !< load that is the reservoir
    integer :: edge = 0 !< load of UPLIFT's reservoir whose surface gives the edges
    logical :: is_tail = .false. !< the reservoir is that of TAIL WATER
  end type water_source

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
      call fill_joint(model, j, model%laws(i), faults)
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

  !> Adds the loads of one joint.
  subroutine fill_joint(model, j, request, faults)
    type(draft), intent(inout) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(diagnostic_list), intent(inout) :: faults
    type(joint_stage), allocatable :: stages(:)
    integer :: of_step(size(model%problem%steps)), k
    if (request%uplift == '') return
    call list_stages(model, j, request%uplift, stages, of_step)
    if (all([(first_that_reaches(stages(k)%rims), k=1, size(stages))] == 0)) then
      call fault_no_edge(model, j, request, faults)
      return
    end if
    call add_uplift(model, j, request, stages, of_step, faults)
    if (request%tail_water /= '') call add_tail_water(model, j, request, stages, of_step, faults)
  end subroutine fill_joint

  !> One load for each load of the reservoir, in any step, and each stage of the joint. There is no
  !> pressure where the surface of the reservoir does not meet the joint.
  subroutine add_uplift(model, j, request, stages, of_step, faults)
    type(draft), intent(inout) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(joint_stage), intent(in) :: stages(:)
    integer, intent(in) :: of_step(:) !< (steps) stage
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_dry(size(stages))
    integer :: i, k
    do i = 1, size(stages(1)%rims)
      if (.not. is_of_reservoir(model, i, request%uplift)) cycle
      is_dry = [(size(stages(k)%rims(i)%upstream) == 0, k=1, size(stages))]
      call add_dry(model, j, request, i, spread(is_dry(of_step), 1, 2))
      do k = 1, size(stages)
        if (is_dry(k)) cycle
        call add_water(model, j, request, stages(k), water_source(i, i, .false.), &
                       spread(of_step == k, 1, 2), faults)
        if (faults%has_errors()) return
      end do
    end do
  end subroutine add_uplift

  !> A load without pressure: the results show a dry joint where the reservoir acts.
  subroutine add_dry(model, j, request, lake, holds)
    type(draft), intent(inout) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    integer, intent(in) :: lake !< load that is the reservoir
    logical, intent(in) :: holds(:, :) !< (start and end, steps) the surface does not meet the joint
    type(uplift_load) :: nothing
    if (.not. acts_in(model, lake, holds)) return
    nothing%wet_joint = j
    nothing%kind = 'uplift'
    call fill_dry(model%problem%mesh, model%problem%joints(j), nothing)
    call enter_water(model, lake, nothing, request%profile, holds)
  end subroutine add_dry

  !> The diagram of the tail water ends at the upstream edge, which moves where the reservoir
  !> upstream gets another surface: one load for each load of the tail water, each edge and each
  !> stage.
  subroutine add_tail_water(model, j, request, stages, of_step, faults)
    type(draft), intent(inout) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(joint_stage), intent(in) :: stages(:)
    integer, intent(in) :: of_step(:) !< (steps) stage
    type(diagnostic_list), intent(inout) :: faults
    integer :: at_edge(2, size(of_step)), i, k, edge
    at_edge = loads_at_edges(model, stages, of_step)
    do i = 1, size(stages(1)%rims)
      if (.not. is_of_reservoir(model, i, request%tail_water)) cycle
      do k = 1, size(stages)
        do edge = 1, size(stages(k)%rims)
          call add_water(model, j, request, stages(k), water_source(i, edge, .true.), &
                         at_edge == edge .and. spread(of_step == k, 1, 2), faults)
          if (faults%has_errors()) return
        end do
      end do
    end do
  end subroutine add_tail_water

  !> Whether a load is one of a reservoir.
  pure logical function is_of_reservoir(model, number, lake_name) result(is_one)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the load
    character(*), intent(in) :: lake_name
    is_one = .false.
    select type (lake => model%problem%loads(number)%item)
    type is (reservoir_load)
      is_one = lake%target == lake_name
    end select
  end function is_of_reservoir

  !> Whether a load acts at the start or at the end of one of some steps.
  pure logical function acts_in(model, load, is_meant) result(acts)
    type(draft), intent(in) :: model
    integer, intent(in) :: load
    logical, intent(in) :: is_meant(:, :) !< (start and end, steps)
    integer :: s
    acts = .false.
    do s = 1, size(is_meant, 2)
      associate (rules => model%problem%steps(s)%loads)
        acts = acts .or. any(rules%load == load .and. &
                             ((is_meant(1, s) .and. abs(rules%start_factor) > 0.0_rk) .or. &
                              (is_meant(2, s) .and. abs(rules%end_factor) > 0.0_rk)))
      end associate
    end do
  end function acts_in

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

  !> Adds one load of water, where it acts.
  subroutine add_water(model, j, request, stage, from, holds, faults)
    type(draft), intent(inout) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(joint_stage), intent(in) :: stage
    type(water_source), intent(in) :: from
    logical, intent(in) :: holds(:, :) !< (start and end, steps) stage and edges of the load
    type(diagnostic_list), intent(inout) :: faults
    type(uplift_load) :: water
    if (.not. acts_in(model, from%lake, holds)) return
    call fill_water(model, j, request, stage, from, water, faults)
    if (faults%has_errors()) return
    call enter_water(model, from%lake, water, request%profile, holds)
  end subroutine add_water

  !> The pressures at the points of the joint.
  subroutine fill_water(model, j, request, stage, from, water, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: j !< joint
    type(law_request), intent(in) :: request
    type(joint_stage), intent(in) :: stage
    type(water_source), intent(in) :: from
    type(uplift_load), intent(out) :: water
    type(diagnostic_list), intent(inout) :: faults
    associate (place => model%cards(model%joints(j)%spot%card), rim => stage%rims(from%edge), &
               joint => model%problem%joints(j))
      if (size(rim%downstream) == 0 .and. request%profile == 'LINEAR') then
        call place%fault(faults, "joint '"//joint%name//"' has no edge opposite to the one at "// &
                         "reservoir '"//request%uplift//"'", 'a downstream edge, or PROFILE=OPEN')
        return
      end if
      water%wet_joint = j
      water%kind = 'uplift'
      select type (lake => model%problem%loads(from%lake)%item)
      type is (reservoir_load)
        if (request%profile == 'OPEN') then
          call fill_open(model%problem%mesh, joint, rim, stage%slave, lake, water)
        else
          call fill_linear(model%problem%mesh, joint, rim, lake, from%is_tail, water)
        end if
      end select
    end associate
  end subroutine fill_water

  !> Adds the load to the problem, active in the steps in which the reservoir is active and the
  !> stage and the edges of the joint are those of the load. Where the edges change the old load
  !> ends and the new one begins, as where a reservoir is replaced. A stage changes at once, at the
  !> start of its step (theory.md, 15.1).
  subroutine enter_water(model, lake, water, profile, holds)
    type(draft), intent(inout) :: model
    integer, intent(in) :: lake !< load that is the reservoir
    type(uplift_load), intent(in) :: water
    character(*), intent(in) :: profile
    logical, intent(in) :: holds(:, :) !< (start and end, steps) stage and edges of the load
    class(load), allocatable :: item
    type(step_load) :: rule
    character(:), allocatable :: name
    integer :: s, i
    allocate (item, source=water)
    name = model%problem%loads(lake)%item%target
    associate (wet => model%problem%joints(water%wet_joint)%name)
      call add_load(model, item, 'water of '//name//' in joint '//wet//' ('//profile//')', &
                    'JOINT LAW', name)
    end associate
    do s = 1, size(holds, 2)
      if (.not. any(holds(:, s))) cycle
      associate (step => model%problem%steps(s))
        do i = 1, size(step%loads)
          if (step%loads(i)%load /= lake) cycle
          rule = step%loads(i)
          rule%load = model%num_loads
          if (.not. holds(1, s)) rule%start_factor = 0.0_rk
          if (.not. holds(2, s)) rule%end_factor = 0.0_rk
          if (max(abs(rule%start_factor), abs(rule%end_factor)) <= 0.0_rk) cycle
          step%loads = [step%loads, rule]
        end do
      end associate
    end do
  end subroutine enter_water
end module finish_uplift
