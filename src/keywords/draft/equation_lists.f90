!> The equations of the deck, as *EQUATION and *MPC give them: the sum of coefficient times
!> displacement is zero, and the first term depends on the others.
module equation_lists
  use growing_lists, only: append, make_room
  use kinds, only: rk
  implicit none
  private
  public :: equation_list

  !> Equation i has the terms first(i) to first(i + 1) - 1.
  type :: equation_list
    integer :: num = 0
    integer, allocatable :: first(:)
    integer, allocatable :: node(:), direction(:) !< of the terms
    real(rk), allocatable :: coefficient(:) !< of the terms
    integer, allocatable :: card(:), line(:) !< place of each equation
  contains
    procedure :: add
  end type equation_list

contains

  !> Adds an equation.
  subroutine add(self, node, direction, coefficient, card, line)
    class(equation_list), intent(inout) :: self
    integer, intent(in) :: node(:), direction(:)
    real(rk), intent(in) :: coefficient(:)
    integer, intent(in) :: card, line
    integer :: used
    if (self%num == 0) self%first = [1]
    used = self%first(self%num + 1) - 1
    call append(self%node, used, node)
    used = self%first(self%num + 1) - 1
    call append(self%direction, used, direction)
    used = self%first(self%num + 1) - 1
    call make_room(self%coefficient, used, size(coefficient))
    self%coefficient(used + 1:used + size(coefficient)) = coefficient
    used = self%num
    call append(self%card, used, card)
    used = self%num
    call append(self%line, used, line)
    self%num = used
    call append(self%first, used, self%first(used) + size(node))
  end subroutine add
end module equation_lists
