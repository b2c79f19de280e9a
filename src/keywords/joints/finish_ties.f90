!> Builds the ties after the whole deck is read, since they depend on the supports of all steps.
module finish_ties
  use coupling_tie, only: build_tie_rows, exact_tie
  use cover_checks, only: keep_cover
  use dam_mesh, only: node_tie
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
  use tie_supports, only: collect_supports, report_releases, support_steps
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
    type(support_steps) :: supports
    type(node_tie), allocatable :: ties(:)
    integer, allocatable :: adjusting(:)
    integer :: i, k, num_before, num_guests, used
    if (size(model%ties) == 0) return
    allocate (adjusting(0), ties(size(model%ties)))
    used = 0
    call collect_supports(model, supports)
    do i = 1, size(model%ties)
      num_before = used
      num_guests = size(model%problem%guests)
      call build_tie(model%ties(i), supports, ties(:used), model, faults)
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

  !> Builds the tie of one pair of surfaces.
  subroutine build_tie(request, supports, earlier, model, faults)
    type(tie_request), intent(in) :: request
    type(support_steps), intent(in) :: supports
    type(node_tie), intent(in) :: earlier(:) !< of the requests before
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    class(guest), allocatable :: item
    type(exact_tie) :: tie
    type(coupling), allocatable :: springs
    logical, allocatable :: is_bare(:)
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
      call build_tie_rows(problem%mesh%x, slave, master, segments, supports%first > 0, earlier, &
                          tie%rows, is_bare)
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
      call report_releases(place, slave, master, is_bare, supports, earlier, model, faults)
    end associate
    allocate (item, source=tie)
    call add_guest(model, item)
  end subroutine build_tie

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
