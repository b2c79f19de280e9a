!> The kinds of printed histories. Cards, requests, names and columns of the files, and
!> `keyway --fields` are made from this list. A new kind is one line here, its keyword, and its rows
!> in `history_rows`.
module print_kinds
  implicit none
  private
  public :: print_kind, kinds_of_prints, file_pattern
  public :: prints_of_nodes, prints_of_elements, prints_of_joints

  type :: print_kind
    character(11) :: keyword !< without the star
    character(5) :: part !< of the name of the file
    character(5) :: subject !< parameter of the card: the set or joint that is printed
    character(5) :: chosen !< what its name stands for in the documentation of the files
    character(13) :: columns !< after step, increment and time; before the fields
    logical :: has_all_fields = .false. !< whichever fields the card names
  end type print_kind

  !> Positions in the list.
  integer, parameter :: prints_of_nodes = 1, prints_of_elements = 2, prints_of_joints = 3

  type(print_kind), parameter :: kinds_of_prints(3) = [ &
                                 print_kind('NODE PRINT', 'node', 'NSET', 'NSET', 'node'), &
                                 print_kind('EL PRINT', 'el', 'ELSET', 'ELSET', 'element,point'), &
                                 print_kind('JOINT PRINT', 'joint', 'JOINT', 'NAME', &
                                            'point,x,y,z', has_all_fields=.true.)]

contains

  !> Name of a file of this kind, as the documentation gives it.
  pure function file_pattern(kind) result(name)
    type(print_kind), intent(in) :: kind
    character(:), allocatable :: name
    name = 'job_'//trim(kind%part)//'_'//trim(kind%chosen)//'.csv'
  end function file_pattern
end module print_kinds
