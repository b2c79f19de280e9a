!> The single list of materials: the keyword that brings each in, and its maker.
module material_catalogue
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use material_law, only: stress_law
  implicit none
  private
  public :: make_stress_law

contains

  !> Makes the law of a keyword out of its constants; stays unallocated when it is not in the list.
  subroutine make_stress_law(keyword, constants, law)
    character(*), intent(in) :: keyword !< upper case, without the star
    real(rk), intent(in) :: constants(:) !< in the order of the keyword: E [Pa], nu
    class(stress_law), allocatable, intent(out) :: law
    select case (keyword)
    case ('ELASTIC')
      law = elastic_law(young=constants(1), poisson=constants(2))
    case default
      return
    end select
  end subroutine make_stress_law
end module material_catalogue
