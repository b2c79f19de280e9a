!> Element types of other programs that are refused: what they are, and what to mesh instead.
module element_advice
  use parse_text, only: parse_integer
  implicit none
  private
  public :: advise, num_nodes_of_type

  character(*), parameter :: hexahedra = 'linear hexahedra C3D8, C3D8B, C3D8I or C3D8R: mesh again '
  character(*), parameter :: first_order = hexahedra//'with elements of the first order '// &
                             '(Abaqus/CAE: Linear; Gmsh: Mesh.ElementOrder = 1)'
  character(*), parameter :: solids = 'solids C3D8, C3D8B, C3D8I or C3D8R in their place'
  character(*), parameter :: water = '*RESERVOIR in place of elements of water, with ADDED '// &
                             'MASS=WESTERGAARD for its inertia'
  character(*), parameter :: rock = 'solids of rock without a *DENSITY in their place, held at '// &
                             'their outer faces'

contains

  !> What a type is, and what to take instead; '' for a type that is not known. The longest
  !> prefix stands first.
  subroutine advise(name, what, instead)
    character(*), intent(in) :: name !< TYPE of *ELEMENT, upper case
    character(:), allocatable, intent(out) :: what !< 'a wedge'
    character(:), allocatable, intent(out) :: instead
    what = ''
    instead = ''
    call take('C3D20', 'a hexahedron of 20 nodes', first_order)
    call take('C3D27', 'a hexahedron of 27 nodes', first_order)
    call take('C3D15', 'a wedge of 15 nodes', first_order)
    call take('C3D10', 'a tetrahedron of 10 nodes', hexahedra//'without tetrahedra')
    call take('C3D4', 'a tetrahedron', hexahedra//'without tetrahedra')
    call take('C3D5', 'a pyramid', hexahedra//'without pyramids')
    call take('C3D6', 'a wedge', 'C3D8 with the nodes 1, 2, 3, 3, 4, 5, 6, 6 of the wedge')
    call take('C3D8', 'another hexahedron of 8 nodes', 'C3D8, C3D8B, C3D8I or C3D8R')
    call take('AC', 'an acoustic element', water)
    call take('CIN', 'an infinite element', rock)
    call take('F3D', 'a fluid element', water)
    call take('FC3D', 'a fluid element', water)
    call take('EC3D', 'an element of a flowing material', 'C3D8, C3D8B, C3D8I or C3D8R')
    call take('Q3D', 'an element with temperatures and currents', &
              'C3D8 and temperatures of nodes, *TEMPERATURE')
    call take('DC3D', 'an element of heat alone', 'C3D8 and temperatures of nodes, *TEMPERATURE')
    call take('T3D', 'a truss', solids//'; bars of a mesh without a section are left out')
    call take('CPS', 'an element in a plane', solids)
    call take('CPE', 'an element in a plane', solids)
    call take('CAX', 'an axisymmetric element', solids)
    call take('M3D', 'a membrane', solids)
    call take('SC', 'a continuum shell', solids)
    call take('SPRING', 'a spring', '*JOINT LAW with KN and KT, or solids')
    call take('DASHPO', 'a dashpot', '*DAMPING of a material or of the step')
    call take('MASS', 'a mass', 'solids with a *DENSITY in its place')
    call take('GAP', 'a gap', '*CONTACT PAIR or *JOINT on two surfaces')
    call take('COH3D', 'a cohesive element', 'JOINT8 with the same nodes, and *JOINT')
    call take('R3D', 'a rigid element', 'solids 1000 times as stiff in its place')
    call take('B3', 'a beam', solids)
    call take('B2', 'a beam', solids)
    if (scan(name, '34689') == 2) call take('S', 'a shell', solids)

  contains

    !> The words for types that begin so; the first ones are kept.
    subroutine take(prefix, its_name, its_place)
      character(*), intent(in) :: prefix, its_name, its_place
      if (what /= '' .or. index(name, prefix) /= 1) return
      what = its_name
      instead = its_place
    end subroutine take
  end subroutine advise

  !> Nodes of an element by the digits of its type: C3D20R has 20, S4 has 4; `otherwise` without.
  pure integer function num_nodes_of_type(name, otherwise) result(num_nodes)
    character(*), intent(in) :: name !< upper case
    integer, intent(in) :: otherwise
    character(*), parameter :: digits = '0123456789'
    integer :: first, last
    logical :: is_integer
    num_nodes = otherwise
    first = index(name, '3D') + 2
    if (first == 2) first = scan(name, digits)
    if (first == 0 .or. first > len(name)) return
    last = first - 2 + verify(name(first:)//' ', digits)
    if (last < first) return
    call parse_integer(name(first:last), num_nodes, is_integer)
    if (name(1:1) == 'B') num_nodes = 2 + modulo(num_nodes + 1, 2) ! B31 two, B32 three nodes
    num_nodes = min(max(num_nodes, 1), 27)
  end function num_nodes_of_type
end module element_advice
