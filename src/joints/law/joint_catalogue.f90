!> The single list of joint laws: TYPE of *JOINT LAW, and its maker. A new law is a file of its own
!> and one line in each of the two places here.
module joint_catalogue
  use joint_constants, only: law_constants
  use joint_contraction, only: contraction_law
  use joint_law, only: traction_law
  implicit none
  private
  public :: joint_law_kinds, make_joint_law

  !> What TYPE may be, as the specification of the keyword shows it; the first is the default.
  character(*), parameter :: joint_law_kinds = 'CONTRACTION'

contains

  !> Makes the law of completed constants; stays unallocated when its kind is not in the list.
  subroutine make_joint_law(constants, law)
    type(law_constants), intent(in) :: constants
    class(traction_law), allocatable, intent(out) :: law
    select case (constants%kind)
    case ('CONTRACTION')
      allocate (law, source=contraction_law( &
                name=constants%name, gap=constants%gap, penetration=constants%penetration, &
                normal_stiffness=constants%normal_stiffness, &
                tangent_stiffness=constants%tangent_stiffness, strength=constants%strength, &
                friction=constants%friction, cohesion=constants%cohesion))
    case default
      return
    end select
  end subroutine make_joint_law
end module joint_catalogue
