!> The list of joint laws: TYPE of *JOINT LAW. The reader, the help and the messages are made from
!> it. A new law is a file of its own, and here its `use` and its line in `list_joint_laws`.
module joint_catalogue
  use joint_contraction, only: contraction_law
  use joint_law, only: traction_law
  use keyword_spec, only: keyword_variant
  implicit none
  private
  public :: describe_joint_laws, make_joint_law

  integer, parameter :: most_laws = 20

  !> A law without constants.
  type :: law_entry
    class(traction_law), allocatable :: law
  end type law_entry

  !> The laws; one line each.
  type :: law_list
    integer :: num_laws = 0
    type(law_entry) :: entries(most_laws)
  contains
    procedure :: add
  end type law_list

contains

  !> The list itself; the first law is the default.
  subroutine list_joint_laws(laws)
    type(law_list), intent(out) :: laws
    call laws%add(contraction_law())
  end subroutine list_joint_laws

  subroutine add(self, law)
    class(law_list), intent(inout) :: self
    class(traction_law), intent(in) :: law
    self%num_laws = self%num_laws + 1
    allocate (self%entries(self%num_laws)%law, source=law)
  end subroutine add

  !> The keyword entries of the laws, in the order of the list.
  subroutine describe_joint_laws(entries)
    type(keyword_variant), allocatable, intent(out) :: entries(:)
    type(law_list) :: laws
    integer :: i
    call list_joint_laws(laws)
    allocate (entries(laws%num_laws))
    do i = 1, laws%num_laws
      call laws%entries(i)%law%describe(entries(i))
    end do
  end subroutine describe_joint_laws

  !> A law without constants; it stays unallocated where no law has the name.
  subroutine make_joint_law(name, law)
    character(*), intent(in) :: name !< TYPE, upper case
    class(traction_law), allocatable, intent(out) :: law
    type(law_list) :: laws
    type(keyword_variant) :: entry
    integer :: i
    call list_joint_laws(laws)
    do i = 1, laws%num_laws
      call laws%entries(i)%law%describe(entry)
      if (entry%name == name) allocate (law, source=laws%entries(i)%law)
    end do
  end subroutine make_joint_law
end module joint_catalogue
