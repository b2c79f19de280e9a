!> The cards that move the base: *BASE MOTION, and *BOUNDARY, TYPE=ACCELERATION.
module base_motion_cards
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use node_dofs, only: num_directions
  implicit none
  private
  public :: moves_base, is_acceleration, directions_of_motion

contains

  !> Whether a card moves the base.
  pure logical function moves_base(this)
    type(card), intent(in) :: this
    moves_base = is_keyword(this, 'BASE MOTION') .or. is_acceleration(this)
  end function moves_base

  !> Whether a card is *BOUNDARY, TYPE=ACCELERATION, another way to write a motion of the base.
  pure logical function is_acceleration(this)
    type(card), intent(in) :: this
    is_acceleration = .false.
    if (is_keyword(this, 'BOUNDARY')) is_acceleration = this%word('TYPE') == 'ACCELERATION'
  end function is_acceleration

  !> Directions in which a card moves the base.
  pure function directions_of_motion(this) result(moves)
    type(card), intent(in) :: this
    logical :: moves(num_directions)
    integer :: line, first, last
    moves = .false.
    if (is_keyword(this, 'BASE MOTION')) moves(this%integer('DOF')) = .true.
    if (.not. is_acceleration(this)) return
    do line = 1, this%num_lines
      if (.not. this%is_integer_at(line, 2)) cycle ! a name, which has no value
      first = this%integer_at(line, 2)
      last = first
      if (.not. this%is_empty_at(line, 3)) last = this%integer_at(line, 3)
      moves(max(1, first):min(num_directions, last)) = .true.
    end do
  end function directions_of_motion
end module base_motion_cards
