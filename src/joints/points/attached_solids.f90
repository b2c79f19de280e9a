!> The solids behind the sides of joint faces, and which sides are there in a stage (*MODEL CHANGE).
!>
!> Several solids may lie behind one side: they take the place of each other in stages, and one of
!> them is enough.
module attached_solids
  use growing_lists, only: append, make_room
  implicit none
  private
  public :: solid_list, sides_there

  !> Pairs of a side and a solid behind it.
  type :: solid_list
    integer :: num_sides = 0
    integer :: num = 0 !< pairs
    integer, allocatable :: side(:) !< 1 .. num_sides
    integer, allocatable :: solid(:) !< position in the mesh
  contains
    procedure :: note
  end type solid_list

  interface solid_list
    procedure :: one_each
  end interface solid_list

contains

  !> Sides with one solid each.
  pure function one_each(solids) result(list)
    integer, intent(in) :: solids(:) !< (sides) position in the mesh
    type(solid_list) :: list
    integer :: s
    list%num_sides = size(solids)
    list%num = size(solids)
    list%side = [(s, s=1, size(solids))]
    list%solid = solids
  end function one_each

  !> Adds a solid behind a side.
  pure subroutine note(self, side, solid)
    class(solid_list), intent(inout) :: self
    integer, intent(in) :: side, solid
    call make_room(self%side, self%num, 1)
    call append(self%solid, self%num, solid)
    self%side(self%num) = side
  end subroutine note

  !> Whether one of the solids behind each side is there; a side without solids is always there.
  pure function sides_there(list, is_absent) result(is_there)
    type(solid_list), intent(in) :: list
    logical, intent(in) :: is_absent(:) !< (elements)
    logical :: is_there(list%num_sides)
    integer :: i
    is_there = .true.
    do i = 1, list%num
      is_there(list%side(i)) = .false.
    end do
    do i = 1, list%num
      associate (side => list%side(i))
        is_there(side) = is_there(side) .or. .not. is_absent(list%solid(i))
      end associate
    end do
  end function sides_there
end module attached_solids
