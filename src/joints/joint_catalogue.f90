!> The single list of joint laws: name and maker.
module joint_catalogue
  use joint_contraction, only: contraction_law
  use joint_law, only: traction_law
  implicit none
  private
  public :: joint_law_kinds, make_joint_law

  character(16), parameter :: joint_law_kinds(1) = ['CONTRACTION     ']

contains

  !> Makes a law with its defaults; stays unallocated when it is not in the list.
  subroutine make_joint_law(kind, law)
    character(*), intent(in) :: kind !< upper case
    class(traction_law), allocatable, intent(out) :: law
    select case (kind)
    case ('CONTRACTION')
      allocate (contraction_law :: law)
    case default
      return
    end select
  end subroutine make_joint_law
end module joint_catalogue
