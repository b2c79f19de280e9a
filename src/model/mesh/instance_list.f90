!> Instances of parts that the deck has: what of the numbers of its nodes and elements is theirs.
module instance_list
  implicit none
  private
  public :: mesh_instance

  type :: mesh_instance
    character(:), allocatable :: name, part !< upper case
    integer :: nodes_added = 0 !< to the numbers of nodes in the part
    integer :: elements_added = 0 !< to the numbers of elements in the part
  end type mesh_instance
end module instance_list
