!> Supports of slave nodes of ties: what they take out of a tie, and the warning of it.
!>
!> A slave node has the same multipliers in all steps. A support of one step therefore opens the tie
!> of its node and direction in every step. A support that acts in all steps carries the force.
module tie_supports
  use coupling_tie, only: find_bound
  use dam_mesh, only: node_tie
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  use node_dofs, only: num_directions
  use surface_segments, only: facet_set
  use write_text, only: as_text
  implicit none
  private
  public :: support_steps, collect_supports, report_releases

  !> When supports hold each degree of freedom.
  type :: support_steps
    integer, allocatable :: first(:, :) !< (3, nodes) first step with a support, 0 for none
    logical, allocatable :: is_always(:, :) !< (3, nodes) a support in all steps
  end type support_steps

contains

  !> Collects the supports of all steps.
  pure subroutine collect_supports(model, supports)
    type(draft), intent(in) :: model
    type(support_steps), intent(out) :: supports
    logical, allocatable :: is_now(:, :)
    integer :: s, k
    allocate (supports%first(num_directions, model%problem%mesh%num_nodes), source=0)
    allocate (supports%is_always(num_directions, model%problem%mesh%num_nodes), source=.true.)
    allocate (is_now(num_directions, model%problem%mesh%num_nodes))
    do s = 1, size(model%problem%steps)
      is_now = .false.
      associate (fixities => model%problem%steps(s)%fixities)
        do k = 1, size(fixities)
          is_now(fixities(k)%dof, fixities(k)%node) = .true.
        end do
      end associate
      where (is_now .and. supports%first == 0) supports%first = s
      supports%is_always = supports%is_always .and. is_now
    end do
  end subroutine collect_supports

  !> Warns of slave nodes that supports of some steps release, or else of facets that transmit no
  !> force because earlier ties and supports hold all their corners.
  subroutine report_releases(place, slave, master, is_bare, supports, earlier, model, faults)
    type(card), intent(in) :: place !< *TIE
    type(facet_set), intent(in) :: slave, master
    logical, intent(in) :: is_bare(:) !< (slave facets) lies on no facet of the master
    type(support_steps), intent(in) :: supports
    type(node_tie), intent(in) :: earlier(:) !< earlier ties of the deck
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_bound(num_directions, size(supports%first, 2))
    logical :: is_released(num_directions, size(supports%first, 2))
    logical :: is_idle(num_directions, size(is_bare))
    character(:), allocatable :: idle
    call find_released(slave, master, is_bare, supports, earlier, is_bound, is_released)
    call find_idle(slave%node, is_bare, is_bound, supports%is_always, is_idle)
    idle = as_text(count(any(is_idle, dim=1)))//' of '//as_text(size(is_bare))// &
           ' slave facets transmit no force in '//in_words(any(is_idle, dim=2))
    if (any(is_released)) then
      idle = '; '//idle
      if (.not. any(is_idle)) idle = ''
      call place%warn(faults, release_in_words(model, supports, is_released)//idle, &
                      'supports that act in all steps, or slave and master exchanged')
    else if (any(is_idle)) then
      call place%warn(faults, idle//': earlier ties hold all their corners, the first at node '// &
                      as_text(model%problem%mesh%node_id( &
                              slave%node(1, findloc(any(is_idle, dim=1), .true., dim=1)))), &
                      'more facets across, or slave and master exchanged')
    end if
  end subroutine report_releases

  !> The slave nodes without multipliers, and those of them that have none because of a support that
  !> acts in some steps alone. Nodes beside the master face would have none in any case.
  pure subroutine find_released(slave, master, is_bare, supports, earlier, is_bound, is_released)
    type(facet_set), intent(in) :: slave, master
    logical, intent(in) :: is_bare(:) !< (slave facets)
    type(support_steps), intent(in) :: supports
    type(node_tie), intent(in) :: earlier(:)
    logical, intent(out) :: is_bound(:, :), is_released(:, :) !< (3, nodes)
    logical :: is_opposite(size(supports%first, 2)), stays_bound(size(supports%first, 2))
    integer :: i, f
    is_opposite = .false.
    do f = 1, size(is_bare)
      if (.not. is_bare(f)) is_opposite(slave%node(:, f)) = .true.
    end do
    do i = 1, num_directions
      call find_bound(i, slave, master, supports%first(i, :) > 0, earlier, is_bound(i, :))
      call find_bound(i, slave, master, supports%is_always(i, :), earlier, stays_bound)
      is_released(i, :) = is_opposite .and. is_bound(i, :) .and. .not. stays_bound
    end do
  end subroutine find_released

  !> The facets that transmit no force: no corner has a multiplier, and not all have supports in all
  !> steps, which carry the force.
  pure subroutine find_idle(corner, is_bare, is_bound, is_always, is_idle)
    integer, intent(in) :: corner(:, :) !< (4, slave facets) nodes
    logical, intent(in) :: is_bare(:) !< (slave facets)
    logical, intent(in) :: is_bound(:, :), is_always(:, :) !< (3, nodes)
    logical, intent(out) :: is_idle(:, :) !< (3, slave facets)
    integer :: f
    do f = 1, size(is_bare)
      is_idle(:, f) = .not. is_bare(f) .and. all(is_bound(:, corner(:, f)), dim=2) &
                      .and. .not. all(is_always(:, corner(:, f)), dim=2)
    end do
  end subroutine find_idle

  !> 'node 109 of the slave surface is not tied in direction x in any step: ...'.
  function release_in_words(model, supports, is_released) result(text)
    type(draft), intent(in) :: model
    type(support_steps), intent(in) :: supports
    logical, intent(in) :: is_released(:, :) !< (3, nodes)
    character(:), allocatable :: text
    integer :: num_released, first
    num_released = count(any(is_released, dim=1))
    first = findloc(any(is_released, dim=1), .true., dim=1)
    if (num_released > 1) then
      text = as_text(num_released)//' nodes of the slave surface, the first '// &
             as_text(model%problem%mesh%node_id(first))//', are not tied in '// &
             in_words(any(is_released, dim=2))//' in any step: supports hold them'
    else
      text = 'node '//as_text(model%problem%mesh%node_id(first))//' of the slave surface is '// &
             'not tied in '//in_words(any(is_released, dim=2))//' in any step: a support holds it'
    end if
    text = text//' in step '//as_text(minval(supports%first, mask=is_released))// &
           ' and not in every step; a tie is the same in every step'
  end function release_in_words

  !> 'direction x', 'directions x and y', 'directions x, y and z'.
  pure function in_words(directions) result(text)
    logical, intent(in) :: directions(:) !< (3)
    character(:), allocatable :: text
    character(*), parameter :: axes = 'xyz'
    integer :: i, left
    left = count(directions)
    text = 'direction'
    if (left > 1) text = text//'s'
    do i = 1, size(directions)
      if (.not. directions(i)) cycle
      text = text//' '//axes(i:i)
      left = left - 1
      if (left == 1) text = text//' and'
      if (left > 1) text = text//','
    end do
  end function in_words
end module tie_supports
