!> Displacements that follow others exactly: relations that the numbering eliminates. Ties and
!> equations of the deck extend this guest and say what their relations are.
module eliminated_rows
  use dam_mesh, only: node_tie
  use guest_type, only: guest
  use row_tables, only: row_table
  implicit none
  private
  public :: row_guest

  type, extends(guest), abstract :: row_guest
    type(node_tie) :: rows
  contains
    procedure :: add_bonds
    procedure :: add_ties
  end type row_guest

contains

  !> Each node that follows, with the nodes that it follows.
  subroutine add_bonds(self, groups)
    class(row_guest), intent(in) :: self
    type(row_table), intent(inout) :: groups
    integer :: k
    associate (rows => self%rows)
      do k = 1, size(rows%node)
        call groups%append([rows%node(k), rows%item(rows%first(k):rows%first(k + 1) - 1)])
      end do
    end associate
  end subroutine add_bonds

  !> Adds the rows to the ties of the model.
  subroutine add_ties(self, ties, used)
    class(row_guest), intent(in) :: self
    type(node_tie), intent(inout) :: ties(:)
    integer, intent(inout) :: used !< relations in use
    used = used + 1
    ties(used) = self%rows
  end subroutine add_ties
end module eliminated_rows
