!> Warns of values of a step that are given twice, and says which of them acts.
module check_repeats
  use base_motion_cards, only: directions_of_motion, is_acceleration, moves_base
  use deck_card, only: card
  use deck_scan, only: steps_of_cards
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  use node_dofs, only: num_directions
  use text_buffers, only: text_buffer
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_repeats

  character, parameter :: nl = new_line('a')

contains

  !> The deck must have no errors.
  subroutine warn_of_repeats(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(text_numbers) :: keys
    character(:), allocatable :: key
    integer :: step(size(model%cards))
    integer :: before(size(step)), last(size(step)) !< cards of one key, 0 for none
    integer :: i, j, k
    step = steps_of_cards(model%cards)
    last = 0
    do i = 1, size(step)
      if (step(i) == 0) cycle
      key = key_of(model%cards(i))
      if (len(key) == 0) cycle
      call keys%find_or_add(as_text(step(i))//key, k)
      before(i) = last(k)
      last(k) = i
      j = before(i)
      do while (j > 0)
        if (compare(model%cards(j), model%cards(i), faults)) exit
        j = before(j)
      end do
    end do
    call warn_of_motions(model, step, faults)
  end subroutine warn_of_repeats

  !> Motions of the base in one direction in one step add up. The accelerations of all supports are
  !> one motion, whatever the number of their cards.
  subroutine warn_of_motions(model, step, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: step(:) !< of each card, 0: before the first
    type(diagnostic_list), intent(inout) :: faults
    logical, dimension(num_directions) :: moves, is_moved, is_moved_by_supports
    integer :: i, dof, present
    present = 0
    is_moved = .false.
    is_moved_by_supports = .false.
    do i = 1, size(step)
      if (step(i) == 0) cycle
      if (step(i) /= present) then
        present = step(i)
        is_moved = .false.
        is_moved_by_supports = .false.
      end if
      if (.not. moves_base(model%cards(i))) cycle
      moves = directions_of_motion(model%cards(i))
      if (is_acceleration(model%cards(i))) then
        moves = moves .and. .not. is_moved_by_supports
        is_moved_by_supports = is_moved_by_supports .or. moves
      end if
      do dof = 1, num_directions
        if (moves(dof) .and. is_moved(dof)) then
          call model%cards(i)%warn(faults, 'the base moves in direction '//as_text(dof)// &
                                   ' in this step already: both motions add up')
        end if
      end do
      is_moved = is_moved .or. moves
    end do
  end subroutine warn_of_motions

  !> What cards have in common of which one may repeat the other; '' for cards without repeats.
  function key_of(this) result(key)
    type(card), intent(in) :: this
    character(:), allocatable :: key
    key = ''
    if (.not. allocated(this%spec%name)) return
    select case (this%spec%name)
    case ('CONTROLS', 'DAMPING', 'RESTART')
      key = nl//this%spec%name
    case ('RESERVOIR')
      key = nl//this%spec%name//nl//this%word('SURFACE')
    case ('CLOAD', 'DLOAD', 'DSLOAD')
      key = load_key(this)
    case default
      continue ! the keyword has no second value, or a warning of its own
    end select
  end function key_of

  !> Parameters and data of a card of loads, '' without data and for weight: weight that acts twice
  !> has a warning of its own.
  function load_key(this) result(key)
    type(card), intent(in) :: this
    character(:), allocatable :: key
    type(text_buffer) :: words
    integer :: i, j
    key = ''
    if (this%num_lines == 0) return
    call words%add(nl//this%spec%name)
    do i = 1, size(this%spec%parameters)
      associate (name => this%spec%parameters(i)%name)
        if (this%has(name)) call words%add(nl//name//'='//this%word(name))
      end associate
    end do
    do i = 1, this%num_lines
      call words%add(nl)
      do j = 1, this%num_fields(i)
        if (this%word_at(i, j) == 'GRAV') return
        call words%add(','//this%word_at(i, j))
      end do
    end do
    key = words%contents()
  end function load_key

  !> Warns where a card repeats an earlier one of its step; whether it does.
  logical function compare(old, new, faults) result(is_repeat)
    type(card), intent(in) :: old, new
    type(diagnostic_list), intent(inout) :: faults
    is_repeat = .true.
    select case (new%spec%name)
    case ('CONTROLS')
      call compare_controls(old, new, faults, is_repeat)
    case ('DAMPING')
      is_repeat = old%has('MODAL') .eqv. new%has('MODAL')
      if (is_repeat) call new%warn(faults, 'a *DAMPING of this kind is given in this step '// &
                                   'already: the last one acts')
    case ('RESTART')
      call new%warn(faults, 'a *RESTART is given in this step already: the last one acts')
    case ('RESERVOIR')
      is_repeat = old%word('NAME') /= new%word('NAME')
      if (is_repeat) call new%warn(faults, "reservoir '"//old%text('NAME')//"' wets the "// &
                                   'surface in this step already: the water of both acts')
    case default ! loads
      call new%warn(faults, 'the card stands in this step already, word for '// &
                    'word: its loads act twice')
    end select
  end function compare

  subroutine compare_controls(old, new, faults, is_repeat)
    type(card), intent(in) :: old, new
    type(diagnostic_list), intent(inout) :: faults
    logical, intent(out) :: is_repeat
    integer :: i
    is_repeat = .false.
    do i = 1, size(new%spec%parameters)
      associate (name => new%spec%parameters(i)%name)
        if (.not. (old%has(name) .and. new%has(name))) cycle
        is_repeat = .true.
        call new%warn(faults, 'this step already has '//name//'='//old%text(name)// &
                      '; the later value '//new%text(name)//' is used')
      end associate
    end do
  end subroutine compare_controls
end module check_repeats
