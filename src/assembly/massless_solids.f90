!> Solids without mass, as the rock of most dams.
module massless_solids
  use kinds, only: rk
  use problem_definition, only: problem
  implicit none
  private
  public :: has_massless

contains

  !> Whether solids have no mass.
  pure logical function has_massless(model)
    type(problem), intent(in) :: model
    integer :: e
    has_massless = .false.
    do e = 1, size(model%mesh%material_of_element)
      associate (material => model%mesh%material_of_element(e))
        if (material < 1) cycle
        has_massless = .not. model%materials(material)%density > 0.0_rk
      end associate
      if (has_massless) return
    end do
  end function has_massless
end module massless_solids
