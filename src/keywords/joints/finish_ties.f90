!> Builds the ties after the whole deck is read, since they depend on the supports of all steps.
module finish_ties
  use coupling_tie, only: build_tie_rows, exact_tie
  use cover_checks, only: keep_cover
  use dam_mesh, only: node_tie
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use errors, only: error_type
  use facet_segments, only: find_segments
  use finish_interfaces, only: append_coupling
  use guest_list, only: ties_of
  use guest_type, only: guest
  use kinds, only: rk
  use model_draft, only: add_guest, draft, tie_request
  use node_dofs, only: num_directions, zero_vectors
  use surface_coupling, only: build_coupling, coupling
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set, segment_set, surface_cover
  use tie_motion, only: follow_ties
  use write_text, only: as_text
  implicit none
  private
  public :: complete_ties

  !> Initial values of slave nodes are reported if they differ from the tied values by more than
  !> this fraction of the largest; the round-off of the projection is far below.
  real(rk), parameter :: equal_values = 1.0e-9_rk

  !> A tie whose nodes follow more others on average is reported: a master ten times as fine makes
  !> the factor a hundred times as expensive (different_meshes.md, 13.3). A node of a finer slave
  !> follows 4 to 9 others, of a slave coarser by 3 it follows 49.
  integer, parameter :: most_followed = 50

contains

  !> Builds all ties in the order of the deck. Surfaces, sections and steps have been checked.
  subroutine complete_ties(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable :: is_fixed(:, :), is_always(:, :)
    type(node_tie), allocatable :: ties(:)
    integer, allocatable :: adjusting(:)
    integer :: i, k, num_before, num_guests, used
    if (size(model%ties) == 0) return
    allocate (adjusting(0), ties(size(model%ties)))
    used = 0
    call collect_supports(model, is_fixed, is_always)
    do i = 1, size(model%ties)
      num_before = used
      num_guests = size(model%problem%guests)
      call build_tie(model%ties(i), is_fixed, is_always, ties(:used), model, faults)
      if (faults%has_errors()) return
      do k = num_guests + 1, size(model%problem%guests) ! springs add none
        call model%problem%guests(k)%item%add_ties(ties, used)
      end do
      if (model%ties(i)%adjusts) adjusting = [adjusting, (k, k=num_before + 1, used)]
    end do
    call adjust_nodes(ties(adjusting), model, faults)
    call check_initial_values(.false., model, faults)
    if (.not. faults%has_errors()) call check_initial_values(.true., model, faults)
  end subroutine complete_ties

  !> Moves nodes to the places that the ties give: any motion that is linear in space, such as a
  !> rotation, then agrees with the ties.
  subroutine adjust_nodes(ties, model, faults)
    type(node_tie), intent(in) :: ties(:)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(error_type), allocatable :: error
    call follow_ties(ties, model%problem%mesh%x, error)
    if (.not. allocated(error)) return
    call model%cards(model%ties(1)%spot%card)%fault(faults, 'the ties: '//error%message)
  end subroutine adjust_nodes

  !> Collects the supports of all steps: a node has the same multipliers in all steps, so that a
  !> state continues from step to step.
  subroutine collect_supports(model, is_fixed, is_always)
    type(draft), intent(in) :: model
    logical, allocatable, intent(out) :: is_fixed(:, :) !< (3, nodes) in any step
    logical, allocatable, intent(out) :: is_always(:, :) !< (3, nodes) in all steps
    logical, allocatable :: is_now(:, :)
    integer :: s, k
    allocate (is_fixed(num_directions, model%problem%mesh%num_nodes), source=.false.)
    allocate (is_always(num_directions, model%problem%mesh%num_nodes), source=.true.)
    allocate (is_now(num_directions, model%problem%mesh%num_nodes))
    do s = 1, size(model%problem%steps)
      is_now = .false.
      associate (fixities => model%problem%steps(s)%fixities)
        do k = 1, size(fixities)
          is_now(fixities(k)%dof, fixities(k)%node) = .true.
        end do
      end associate
      is_fixed = is_fixed .or. is_now
      is_always = is_always .and. is_now
    end do
  end subroutine collect_supports

  !> Builds the tie of one pair of surfaces.
  subroutine build_tie(request, is_fixed, is_always, earlier, model, faults)
    type(tie_request), intent(in) :: request
    logical, intent(in) :: is_fixed(:, :), is_always(:, :) !< (3, nodes) by supports
    type(node_tie), intent(in) :: earlier(:) !< of the requests before
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    class(guest), allocatable :: item
    type(exact_tie) :: tie
    type(coupling), allocatable :: springs
    logical, allocatable :: is_idle(:, :)
    associate (problem => model%problem, place => model%cards(request%spot%card))
      call list_surface_facets(problem%mesh, problem%surfaces(request%slave), slave)
      call list_surface_facets(problem%mesh, problem%surfaces(request%master), master)
      if (request%stiffness > 0.0_rk) then
        allocate (springs)
        call build_coupling(problem%mesh%x, slave, master, request%stiffness, request%name, 'TIE', &
                            springs, cover)
        call append_coupling(model, springs)
      else
        call find_segments(problem%mesh%x, slave, master, segments, cover)
      end if
      if (cover%covered_area <= 0.0_rk) then
        call place%fault_at(faults, request%spot%line, 1, 'the surfaces do not lie on each other', &
                            'two surfaces that face each other')
        return
      end if
      call keep_cover(place, request%name, 'TIE', cover, .false., request%adjusts, model, faults)
      if (cover%largest_gap > request%tolerance) then
        call place%warn(faults, 'the faces lie up to '//as_text(cover%largest_gap)// &
                        ' apart and are tied there too', 'at most the POSITION TOLERANCE')
      end if
      if (request%stiffness > 0.0_rk) return
      tie%name = request%name
      tie%kind = 'tie'
      tie%rows%name = request%name
      call build_tie_rows(problem%mesh%x, slave, master, segments, is_fixed, earlier, tie%rows, &
                          is_idle)
      if (size(tie%rows%node) == 0) then
        call place%fault_at(faults, request%spot%line, 1, 'the tie constrains no node: '// &
                            'supports or earlier ties hold every node of the slave surface', &
                            'slave and master exchanged')
        return
      end if
      if (size(tie%rows%item) > most_followed*size(tie%rows%node)) then
        call place%warn(faults, 'a node of the slave surface follows '// &
                        as_text(size(tie%rows%item)/size(tie%rows%node))//' others in the '// &
                        'mean, which makes large and dense equations', 'the finer surface as slave')
      end if
      call report_idle(place, slave%node, is_idle, is_always, model, faults)
    end associate
    allocate (item, source=tie)
    call add_guest(model, item)
  end subroutine build_tie

  !> Reports facets that transmit no force because supports of some steps or earlier ties hold all
  !> their corners. Supports that act in all steps carry the force.
  subroutine report_idle(place, corner, is_idle, is_always, model, faults)
    type(card), intent(in) :: place
    integer, intent(in) :: corner(:, :) !< (4, slave facets)
    logical, intent(in) :: is_idle(:, :) !< (3, slave facets)
    logical, intent(in) :: is_always(:, :) !< (3, nodes)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: f, i, num_idle, worst
    num_idle = 0
    worst = 0
    do f = 1, size(corner, 2)
      if (.not. any([(is_idle(i, f) .and. .not. all(is_always(i, corner(:, f))), i=1, 3)])) cycle
      num_idle = num_idle + 1
      if (worst == 0) worst = f
    end do
    if (num_idle == 0) return
    call place%warn(faults, &
                    as_text(num_idle)//' of '//as_text(size(corner, 2))//' slave facets '// &
                    'transmit no force: supports of some step or earlier ties hold all their '// &
                    'corners, the first at node '// &
                    as_text(model%problem%mesh%node_id(corner(1, worst))), &
                    'more facets across, or slave and master exchanged')
  end subroutine report_idle

  !> Reports initial values of tied nodes that contradict the ties.
  subroutine check_initial_values(is_velocity, model, faults)
    logical, intent(in) :: is_velocity !< else displacements
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk), allocatable :: given(:, :), taken(:, :)
    logical, allocatable :: is_given(:, :)
    type(error_type), allocatable :: error
    type(node_tie), allocatable :: ties(:)
    character(:), allocatable :: kind, values
    integer :: i, worst(2)
    given = zero_vectors(model%problem%mesh%num_nodes)
    allocate (is_given(num_directions, model%problem%mesh%num_nodes), source=.false.)
    do i = 1, size(model%problem%initial_values)
      associate (item => model%problem%initial_values(i))
        if (item%is_velocity .neqv. is_velocity) cycle
        given(item%dof, item%node) = item%value
        is_given(item%dof, item%node) = .true.
      end associate
    end do
    if (.not. any(is_given)) return
    taken = given
    call ties_of(model%problem%guests, ties)
    call follow_ties(ties, taken, error)
    if (allocated(error)) then
      call model%cards(model%ties(1)%spot%card)%fault(faults, 'the ties: '//error%message)
      return
    end if
    worst = maxloc(abs(taken - given), mask=is_given)
    if (abs(taken(worst(1), worst(2)) - given(worst(1), worst(2))) &
        <= equal_values*maxval(abs(given))) return
    kind = trim(merge('velocity    ', 'displacement', is_velocity))
    values = as_text(taken(worst(1), worst(2)))//', not '//as_text(given(worst(1), worst(2)))
    call model%cards(model%ties(1)%spot%card)%warn( &
      faults, 'node '//as_text(model%problem%mesh%node_id(worst(2)))//' follows others; its '// &
      'initial '//kind//' along '//'xyz' (worst(1):worst(1))//' is '//values//' as given')
  end subroutine check_initial_values
end module finish_ties
