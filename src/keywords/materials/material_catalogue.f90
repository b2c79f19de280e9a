!> The list of material laws: the main keyword of each law, and the procedure that adds its
!> keywords. A new law is a file with its type (below src/materials), a file with its keywords (in
!> this room), and here its `use` and its line in `list_laws`.
module material_catalogue
  use keyword_handler, only: keyword_list
  use keywords_concrete_tables, only: add_concrete
  use keywords_elastic, only: add_elastic
  use keywords_plastic, only: add_plastic
  use keywords_user_material, only: add_user_material
  implicit none
  private
  public :: add_material_laws, names_of_laws

  integer, parameter :: longest_keyword = 32, most_laws = 20

  type :: law_entry
    character(longest_keyword) :: keyword !< without the star
    procedure(keyword_adder), pointer, nopass :: add_keywords
  end type law_entry

  abstract interface
    !> Adds the keywords of a law.
    subroutine keyword_adder(list)
      import :: keyword_list
      implicit none
      type(keyword_list), intent(inout) :: list
    end subroutine keyword_adder
  end interface

contains

  !> The list itself.
  subroutine list_laws(laws, num_laws)
    type(law_entry), intent(out) :: laws(most_laws)
    integer, intent(out) :: num_laws
    num_laws = 0
    call add('ELASTIC', add_elastic)
    call add('PLASTIC', add_plastic)
    call add('USER MATERIAL', add_user_material)
    call add('CONCRETE DAMAGED PLASTICITY', add_concrete)
  contains
    subroutine add(keyword, add_keywords)
      character(*), intent(in) :: keyword
      procedure(keyword_adder) :: add_keywords
      num_laws = num_laws + 1
      laws(num_laws)%keyword = keyword
      laws(num_laws)%add_keywords => add_keywords
    end subroutine add
  end subroutine list_laws

  !> Adds the keywords of all laws.
  subroutine add_material_laws(list)
    type(keyword_list), intent(inout) :: list
    type(law_entry) :: laws(most_laws)
    integer :: num_laws, i
    call list_laws(laws, num_laws)
    do i = 1, num_laws
      call laws(i)%add_keywords(list)
    end do
  end subroutine add_material_laws

  !> 'one of *ELASTIC, *USER MATERIAL, ..', for messages.
  function names_of_laws() result(text)
    character(:), allocatable :: text
    type(law_entry) :: laws(most_laws)
    integer :: num_laws, i
    call list_laws(laws, num_laws)
    text = 'one of '
    do i = 1, num_laws
      if (i > 1) text = text//', '
      text = text//'*'//trim(laws(i)%keyword)
    end do
  end function names_of_laws
end module material_catalogue
