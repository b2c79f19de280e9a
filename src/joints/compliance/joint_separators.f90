!> Where the unknowns of joints stand in the order of elimination: few at its end. Of many in
!> statics each group is one separator: the jumps and the displacements that they add to. In motion
!> joints see so little of each other that the order need not keep many of them together.
module joint_separators
  use dof_numbering, only: numbering
  use joint_operator, only: jump_operator
  use point_groups, only: group_list, group_points
  implicit none
  private
  public :: find_separators, fits_the_end

  !> Up to so many unknowns of joints stay together at the end of the factor. The compliance is then
  !> known as a whole: in statics joints see each other far, and the iteration may not converge
  !> without the blocks between distant ones.
  integer, parameter :: most_in_motion = 4500, most_in_statics = 9000

contains

  !> Whether the unknowns of joints are few enough for the end of the factor, which is dense.
  pure logical function fits_the_end(operator, num_free, has_inertia)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    logical, intent(in) :: has_inertia
    logical, allocatable :: is_of_joint(:) ! points of a facet share its nodes
    integer :: k
    fits_the_end = .true.
    if (size(operator%unknown) == 0) return
    allocate (is_of_joint(num_free), source=.false.)
    do k = 1, size(operator%unknown)
      if (operator%unknown(k) <= num_free) is_of_joint(operator%unknown(k)) = .true.
    end do
    fits_the_end = count(is_of_joint) <= merge(most_in_motion, most_in_statics, has_inertia)
  end function fits_the_end

  !> Group of each free unknown, 0 for none.
  subroutine find_separators(numbers, operator, group, jump, joined)
    type(numbering), intent(in) :: numbers
    type(jump_operator), intent(in) :: operator
    integer, allocatable, intent(out) :: group(:) !< (num_free)
    integer, allocatable, intent(out) :: jump(:), joined(:) !< pairs: a jump adds to a displacement
    type(group_list) :: groups
    integer :: g, r, k
    call group_points(operator%first_point, operator%x, groups)
    allocate (group(numbers%num_free), source=0)
    do g = 1, groups%num_groups
      do r = groups%first_row(g), groups%first_row(g + 1) - 1
        do k = operator%row_start(groups%row(r)), operator%row_start(groups%row(r) + 1) - 1
          if (operator%unknown(k) > numbers%num_free) cycle
          if (group(operator%unknown(k)) == 0) group(operator%unknown(k)) = g
        end do
      end do
    end do
    call add_joined(numbers, group, jump, joined)
  end subroutine find_separators

  !> Adds the displacements that jumps add to.
  pure subroutine add_joined(numbers, group, jump, joined)
    type(numbering), intent(in) :: numbers
    integer, intent(inout) :: group(:) !< (num_free)
    integer, allocatable, intent(out) :: jump(:), joined(:) !< (pairs)
    integer, allocatable :: jumps(:), others(:)
    integer :: dof, k, first_jump, used
    first_jump = numbers%num_free - numbers%num_jumps + 1
    allocate (jump(0), joined(0))
    used = 0
    do dof = 1, size(numbers%row_start) - 1
      associate (unknown => numbers%unknown(numbers%row_start(dof):numbers%row_start(dof + 1) - 1))
        jumps = pack(unknown, unknown >= first_jump .and. unknown <= numbers%num_free)
        if (size(jumps) == 0) cycle
        others = pack(unknown, unknown < first_jump)
      end associate
      where (group(others) == 0) group(others) = group(jumps(1))
      do k = 1, size(jumps)
        call append(spread(jumps(k), 1, size(others)), used, jump)
        call append(others, used, joined)
        used = used + size(others)
      end do
    end do
    jump = jump(:used)
    joined = joined(:used)
  end subroutine add_joined

  !> Adds items behind the used ones of a list with room.
  pure subroutine append(items, used, list)
    integer, intent(in) :: items(:), used
    integer, allocatable, intent(inout) :: list(:)
    if (used + size(items) > size(list)) list = [list, spread(0, 1, size(list) + size(items))]
    list(used + 1:used + size(items)) = items
  end subroutine append
end module joint_separators
