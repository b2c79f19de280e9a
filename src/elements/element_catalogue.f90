!> The single list of elements: names in the deck, numbers of nodes, descriptions.
module element_catalogue
  use element_formulation, only: solid_element
  use element_hex8, only: full_hexahedron
  use element_hex8_bbar, only: bbar_hexahedron
  use element_hex8_incompatible, only: incompatible_hexahedron
  use element_hex8_reduced, only: reduced_hexahedron
  implicit none
  private
  public :: element_kind, element_kinds, find_element_kind, is_solid, make_solid

  !> One row of the list.
  type :: element_kind
    character(8) :: name !< TYPE of *ELEMENT
    integer :: num_nodes
    logical :: is_solid !< has a formulation, takes a *SOLID SECTION
    character(64) :: meaning
  end type element_kind

  type(element_kind), parameter :: element_kinds(6) = [ &
                                   element_kind('C3D8', 8, .true., &
                                                '8-node solid, full 2 x 2 x 2 integration'), &
                                   element_kind('C3D8B', 8, .true., &
                                                '8-node solid, mean volume strain (B-bar)'), &
                                   element_kind('C3D8I', 8, .true., &
                                                '8-node solid, incompatible modes'), &
                                   element_kind('C3D8R', 8, .true., &
                                                '8-node solid, one point, hourglass control'), &
                                   element_kind('JOINT8', 8, .false., &
                                                'two coincident faces: master 1-4, slave 5-8'), &
                                   element_kind('IFACE4', 4, .false., &
                                                'interface quadrilateral with its own nodes')]

contains

  !> Row of the list, 0 when there is no such element.
  pure integer function find_element_kind(name) result(row)
    character(*), intent(in) :: name !< upper case
    do row = size(element_kinds), 1, -1
      if (element_kinds(row)%name == name) return
    end do
  end function find_element_kind

  !> Whether elements of this name are solids.
  elemental logical function is_solid(name)
    character(*), intent(in) :: name !< upper case
    integer :: row
    row = find_element_kind(name)
    is_solid = .false.
    if (row > 0) is_solid = element_kinds(row)%is_solid
  end function is_solid

  !> Makes the formulation of a solid; stays unallocated when `name` is not a solid.
  subroutine make_solid(name, element)
    character(*), intent(in) :: name !< upper case
    class(solid_element), allocatable, intent(out) :: element
    select case (name)
    case ('C3D8')
      allocate (full_hexahedron :: element)
      element%has_plain_strain = .true.
    case ('C3D8B')
      allocate (bbar_hexahedron :: element)
    case ('C3D8I')
      allocate (incompatible_hexahedron :: element)
      element%has_small_jumps = .true. ! the modes follow bending
    case ('C3D8R')
      allocate (reduced_hexahedron :: element)
      element%num_points = 1
      element%has_small_jumps = .true. ! one point shows no bending
    case default
      return
    end select
    element%name = name
  end subroutine make_solid
end module element_catalogue
