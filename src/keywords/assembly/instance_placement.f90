!> Where an instance stands: a translation, then a rotation about an axis through two points.
module instance_placement
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use small_matrix, only: cross_product
  implicit none
  private
  public :: placement, read_placement, placed

  real(rk), parameter :: pi = acos(-1.0_rk)
  real(rk), parameter :: quarters(4) = [0.0_rk, 1.0_rk, 0.0_rk, -1.0_rk] !< sines of 0, 90, .. deg

  type :: placement
    logical :: moves = .false. !< the instance does not stand where its part does
    real(rk) :: shift(3) = 0.0_rk !< translation [m]
    real(rk) :: point(3) = 0.0_rk !< of the axis [m]
    real(rk) :: axis(3) = [0.0_rk, 0.0_rk, 1.0_rk] !< unit vector
    real(rk) :: cosine = 1.0_rk, sine = 0.0_rk !< of the angle
  end type placement

contains

  !> Reads the lines of *INSTANCE: translation, then axis and angle. A first line of 7 numbers is
  !> the rotation.
  subroutine read_placement(this, place, faults)
    type(card), intent(in) :: this
    type(placement), intent(out) :: place
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, i, num_before
    num_before = faults%num_errors
    do line = 1, this%num_lines
      do i = 1, this%num_fields(line)
        if (this%is_real_at(line, i) .or. this%is_empty_at(line, i)) cycle
        call this%fault_at(faults, line, i, "found '"//this%text_at(line, i)//"'", 'a number')
      end do
      if (faults%num_errors > num_before) cycle
      if (line == 1 .and. this%num_fields(line) <= 3) then
        do i = 1, 3
          place%shift(i) = this%real_at(line, i)
        end do
      else if (this%num_fields(line) == 7 .and. (line == 2 .or. this%num_lines == 1)) then
        call read_rotation(this, line, place, faults)
      else
        call this%fault_at(faults, line, 0, 'neither a translation nor a rotation', &
                           'x, y, z in the first line; two points of the axis and an angle '// &
                           'in degrees, 7 numbers, in the second')
      end if
    end do
    place%moves = maxval(abs(place%shift)) > 0.0_rk .or. abs(place%sine) > 0.0_rk .or. &
                  place%cosine < 1.0_rk
  end subroutine read_placement

  !> Reads two points of the axis and the angle.
  subroutine read_rotation(this, line, place, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(placement), intent(inout) :: place
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: angle
    integer :: i
    do i = 1, 3
      place%point(i) = this%real_at(line, i)
      place%axis(i) = this%real_at(line, i + 3) - place%point(i)
    end do
    if (norm2(place%axis) <= 0.0_rk) then
      call this%fault_at(faults, line, 4, 'the two points of the axis are one', &
                         'two points that differ')
      return
    end if
    place%axis = place%axis/norm2(place%axis)
    angle = modulo(this%real_at(line, 7), 360.0_rk)
    place%cosine = cos(angle*pi/180)
    place%sine = sin(angle*pi/180)
    i = nint(angle/90)
    if (abs(angle - 90*i) > 0.0_rk) return
    place%cosine = quarters(modulo(i + 1, 4) + 1) ! quarter turns without round-off
    place%sine = quarters(modulo(i, 4) + 1)
  end subroutine read_rotation

  !> The point of an instance that a point of its part becomes.
  pure function placed(place, x) result(moved)
    type(placement), intent(in) :: place
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: moved(3)
    real(rk) :: arm(3)
    arm = x + place%shift - place%point
    moved = place%point + place%cosine*arm + place%sine*cross_product(place%axis, arm) + &
            (1 - place%cosine)*dot_product(place%axis, arm)*place%axis
  end function placed
end module instance_placement
