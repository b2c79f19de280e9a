!> Motion of a rigid block in words: 'move along x', 'rotate about the axis y through (0, 0, 1)'.
module block_motion
  use errors, only: error_type
  use kinds, only: rk
  use problem_definition, only: problem
  use rigid_blocks, only: block_set
  use small_matrix, only: cross_product
  use sorted_lists, only: contains_position
  use symmetric_modes, only: find_modes
  use write_text, only: as_text
  implicit none
  private
  public :: block_name, motion_text, freedom_text

  !> Smaller rotations and components are not reported, as a fraction of the motion.
  real(rk), parameter :: negligible = 1.0e-3_rk
  character, parameter :: axis_name(3) = ['x', 'y', 'z']

contains

  !> 'the block with element 12 of set LEFT': lowest element, smallest set with this element.
  function block_name(model, blocks, b) result(text)
    type(problem), intent(in) :: model
    type(block_set), intent(in) :: blocks
    integer, intent(in) :: b !< block
    character(:), allocatable :: text
    integer :: i, best
    text = 'the block with element '//as_text(model%mesh%element_id(blocks%example(b)))
    if (.not. allocated(model%element_sets)) return
    best = 0
    associate (sets => model%element_sets)
      do i = 1, size(sets)
        if (.not. contains_position(sets(i)%members, blocks%example(b))) cycle
        if (best == 0) best = i
        if (size(sets(i)%members) < size(sets(best)%members)) best = i
      end do
      if (best > 0) text = text//' of set '//sets(best)%name
    end associate
  end function block_name

  !> A motion and its sense.
  pure function motion_text(blocks, b, motion) result(text)
    type(block_set), intent(in) :: blocks
    integer, intent(in) :: b !< block
    real(rk), intent(in) :: motion(6) !< v, radius*w
    character(:), allocatable :: text
    real(rk) :: v(3), w(3), along
    v = motion(1:3)
    w = motion(4:6)/blocks%radius(b)
    if (norm2(motion(4:6)) <= negligible*norm2(v)) then
      text = 'move along '//direction_text(v, .true.)
      return
    end if
    text = 'rotate about '//axis_text(blocks, b, v, w, .true.)
    along = dot_product(v, w)/norm2(w)
    if (abs(along) > negligible*norm2(motion)) text = text//' and move along it'
  end function motion_text

  !> All motions of a space, without sense: 'move along x, y and rotate about the axis z ..'.
  function freedom_text(blocks, b, basis) result(text)
    type(block_set), intent(in) :: blocks
    integer, intent(in) :: b !< block
    real(rk), intent(in) :: basis(:, :) !< (6, motions) orthonormal
    character(:), allocatable :: text
    real(rk), allocatable :: rotation_size(:), mix(:, :), motion(:, :)
    character(:), allocatable :: rotations
    type(error_type), allocatable :: error
    integer :: k, num_moves
    text = 'move'
    call find_modes(matmul(transpose(basis(4:6, :)), basis(4:6, :)), rotation_size, mix, error)
    if (allocated(error)) return
    motion = matmul(basis, mix)
    num_moves = count(sqrt(max(rotation_size, 0.0_rk)) <= negligible)
    text = moves_text(motion(1:3, :num_moves))
    rotations = ''
    do k = num_moves + 1, size(motion, 2)
      rotations = rotations//', '//axis_text(blocks, b, motion(1:3, k), &
                                             motion(4:6, k)/blocks%radius(b), .false.)
    end do
    if (len(rotations) == 0) return
    if (text /= '') text = text//' and '
    text = text//'rotate about '//rotations(3:)
  end function freedom_text

  !> 'move along x, y'. Two skew directions are described by the direction across them.
  pure function moves_text(directions) result(text)
    real(rk), intent(in) :: directions(:, :) !< (3, directions) orthonormal
    character(:), allocatable :: text
    real(rk) :: held(3)
    integer :: i
    text = ''
    select case (size(directions, 2))
    case (0)
      return
    case (1)
      text = 'move along '//direction_text(directions(:, 1), .false.)
    case (2)
      held = cross_product(directions(:, 1), directions(:, 2))
      if (maxval(abs(held)) < 1.0_rk - negligible**2) then
        text = 'move in the plane normal to '//direction_text(held, .false.)
        return
      end if
      do i = 1, 3
        if (abs(held(i)) <= negligible) text = text//', '//axis_name(i)
      end do
      text = 'move along '//text(3:)
    case default
      text = 'move along x, y, z'
    end select
  end function moves_text

  !> 'x', '-x' or '(0.6, 0, 0.8)'.
  pure function direction_text(direction, has_sense) result(text)
    real(rk), intent(in) :: direction(3) !< of any length
    logical, intent(in) :: has_sense !< the sign is part of the text
    character(:), allocatable :: text
    real(rk) :: unit(3)
    integer :: i
    unit = direction/max(norm2(direction), tiny(1.0_rk))
    i = maxloc(abs(unit), 1)
    if (.not. has_sense .and. unit(i) < 0.0_rk) unit = -unit
    if (norm2(unit) - abs(unit(i)) < 0.5_rk*negligible**2) then
      text = axis_name(i)
      if (unit(i) < 0.0_rk) text = '-'//text
    else
      text = place_text(unit, negligible)
    end if
  end function direction_text

  !> 'the axis z through (1, 2, 0)': the point of the axis nearest to the centre of the block.
  pure function axis_text(blocks, b, v, w, has_sense) result(text)
    type(block_set), intent(in) :: blocks
    integer, intent(in) :: b !< block
    real(rk), intent(in) :: v(3), w(3) !< velocity of the centre, rotation
    logical, intent(in) :: has_sense
    character(:), allocatable :: text
    real(rk) :: place(3), unit
    place = blocks%centre(:, b) + cross_product(w, v)/max(dot_product(w, w), tiny(1.0_rk))
    unit = 10.0_rk**(floor(log10(max(maxval(abs(place)), blocks%radius(b)))) - 3)
    text = 'the axis '//direction_text(w, has_sense)//' through '//place_text(place, unit)
  end function axis_text

  !> '(1, 2.5, 0)'.
  pure function place_text(x, unit) result(text)
    real(rk), intent(in) :: x(3)
    real(rk), intent(in) :: unit !< of rounding
    character(:), allocatable :: text
    real(rk) :: rounded
    integer :: i
    text = '('
    do i = 1, 3
      rounded = anint(x(i)/unit)*unit
      text = text//as_text(merge(rounded, 0.0_rk, abs(rounded) > 0.0_rk)) ! no -0
      if (i < 3) text = text//', '
    end do
    text = text//')'
  end function place_text
end module block_motion
