!> Named sets of nodes and elements, and surfaces made of element faces.
module mesh_sets
  implicit none
  private
  public :: named_set, surface

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
end module mesh_sets
