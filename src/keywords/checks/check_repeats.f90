!> Warns of values of a step that are given twice, and says which of them acts.
module check_repeats
  use deck_card, only: card
  use deck_scan, only: is_keyword, steps_of_cards
  use diagnostics, only: diagnostic_list
  use model_draft, only: draft
  implicit none
  private
  public :: warn_of_repeats

contains

  !> The deck must have no errors.
  subroutine warn_of_repeats(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: step(size(model%cards))
    integer :: i, j
    step = steps_of_cards(model%cards)
    do i = 1, size(step)
      if (step(i) == 0) cycle
      do j = i - 1, 1, -1
        if (step(j) /= step(i)) exit
        if (compare(model%cards(j), model%cards(i), faults)) exit
      end do
    end do
  end subroutine warn_of_repeats

  !> Warns where a card repeats an earlier one of its step; whether it does.
  logical function compare(old, new, faults) result(is_repeat)
    type(card), intent(in) :: old, new
    type(diagnostic_list), intent(inout) :: faults
    is_repeat = .false.
    if (.not. (allocated(old%spec%name) .and. allocated(new%spec%name))) return
    if (old%spec%name /= new%spec%name) return
    select case (new%spec%name)
    case ('CONTROLS')
      call compare_controls(old, new, faults, is_repeat)
    case ('DAMPING')
      is_repeat = old%has('MODAL') .eqv. new%has('MODAL')
      if (is_repeat) call new%warn(faults, 'a *DAMPING of this kind is given in this step '// &
                                   'already: the last one acts')
    case ('BASE MOTION')
      is_repeat = old%integer('DOF') == new%integer('DOF')
      if (is_repeat) call new%warn(faults, 'the base moves in direction '//new%word('DOF')// &
                                   ' in this step already: both motions add up')
    case ('RESTART')
      is_repeat = .true.
      call new%warn(faults, 'a *RESTART is given in this step already: the last one acts')
    case ('RESERVOIR')
      is_repeat = old%word('NAME') /= new%word('NAME') .and. &
                  old%word('SURFACE') == new%word('SURFACE')
      if (is_repeat) call new%warn(faults, "reservoir '"//old%text('NAME')//"' wets the "// &
                                   'surface in this step already: the water of both acts')
    case ('CLOAD', 'DLOAD', 'DSLOAD')
      is_repeat = are_equal(old, new)
      if (is_repeat) call new%warn(faults, 'the card stands in this step already, word for '// &
                                   'word: its loads act twice')
    case default
      continue ! the keyword has no second value, or a warning of its own
    end select
  end function compare

  !> Whether two cards of loads have the same parameters and data. Weight that acts twice has a
  !> warning of its own.
  logical function are_equal(old, new)
    type(card), intent(in) :: old, new
    integer :: i, j
    are_equal = size(old%parameters) == size(new%parameters) &
                .and. old%num_lines == new%num_lines .and. new%num_lines > 0
    do i = 1, size(new%parameters)
      associate (name => new%parameters(i)%name)
        if (are_equal) are_equal = old%has(name)
        if (are_equal) are_equal = old%word(name) == new%word(name)
      end associate
    end do
    do i = 1, new%num_lines
      if (are_equal) are_equal = old%num_fields(i) == new%num_fields(i)
      do j = 1, new%num_fields(i)
        if (.not. are_equal) return
        are_equal = old%word_at(i, j) == new%word_at(i, j) .and. new%word_at(i, j) /= 'GRAV'
      end do
    end do
  end function are_equal

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
        call new%warn(faults, name//' is given in this step already, '//old%text(name)// &
                      '; the last one acts, '//new%text(name))
      end associate
    end do
  end subroutine compare_controls
end module check_repeats
