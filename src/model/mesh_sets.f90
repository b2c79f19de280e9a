!> Named sets of nodes and elements, and surfaces made of element faces.
module mesh_sets
  implicit none
  private
  public :: named_set, surface, find_set, find_surface

  !> A set of nodes or elements: positions in the mesh, ascending, each once.
  type :: named_set
    character(:), allocatable :: name !< upper case
    integer, allocatable :: members(:)
  end type named_set

  !> A surface: faces S1..S6 of solid elements (CalculiX numbering, see mesh_faces).
  type :: surface
    character(:), allocatable :: name !< upper case
    integer, allocatable :: element(:) !< element positions
    integer, allocatable :: face(:) !< 1..6
  end type surface

contains

  !> Position of the set called `name` (upper case), 0 when there is none.
  pure integer function find_set(sets, name) result(found)
    type(named_set), intent(in) :: sets(:)
    character(*), intent(in) :: name
    integer :: i
    found = 0
    do i = 1, size(sets)
      if (sets(i)%name == name) found = i
    end do
  end function find_set

  !> Position of the surface called `name` (upper case), 0 when there is none.
  pure integer function find_surface(surfaces, name) result(found)
    type(surface), intent(in) :: surfaces(:)
    character(*), intent(in) :: name
    integer :: i
    found = 0
    do i = 1, size(surfaces)
      if (surfaces(i)%name == name) found = i
    end do
  end function find_surface
end module mesh_sets
