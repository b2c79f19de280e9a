!> The constants of a joint law as the deck gives them, before any law is made of them.
module joint_constants
  use kinds, only: rk
  implicit none
  private
  public :: law_constants

  type :: law_constants
    character(:), allocatable :: name !< upper case
    character(:), allocatable :: kind !< one of the catalogue's, upper case
    real(rk) :: normal_stiffness = 0.0_rk !< k_n [Pa/m]; 0: from the solid
    real(rk) :: tangent_stiffness = 0.0_rk !< k_t [Pa/m]; 0: from the solid
    real(rk) :: strength = 0.0_rk !< q_on [Pa]
    real(rk) :: friction = 0.0_rk !< mu
    real(rk) :: cohesion = 0.0_rk !< c of the closed joint [Pa]
    real(rk) :: thickness = 0.02_rk !< for the default of k_n [m]; paper_notes.md, 3
    real(rk) :: gap = 0.0_rk !< initial gap [m]
    real(rk) :: penetration = 0.0_rk !< allowed to points in contact [m]; 0: by their stiffness
  contains
    procedure :: needs_solid
    procedure :: complete_stiffness
    procedure :: asks_for_layer
  end type law_constants

contains

  !> Whether a stiffness is still to come from the solid on the slave side.
  pure logical function needs_solid(self)
    class(law_constants), intent(in) :: self
    needs_solid = min(self%normal_stiffness, self%tangent_stiffness) <= 0.0_rk
  end function needs_solid

  !> Whether k_n is only to lead the iteration to contact without penetration
  !> (different_meshes.md, 13.5): it is then the stiffness of a layer of elements. A bonded joint
  !> works with k_n itself.
  pure logical function asks_for_layer(self)
    class(law_constants), intent(in) :: self
    asks_for_layer = self%penetration > 0.0_rk .and. self%normal_stiffness <= 0.0_rk &
                     .and. self%strength <= 0.0_rk
  end function asks_for_layer

  !> k_n = E/thickness and k_t = k_n/(2 (1 + nu)) where the deck gave none (paper_notes.md, 3). k_t
  !> stands for the joint itself also where k_n does not (different_meshes.md, 13.5).
  pure subroutine complete_stiffness(self, young, poisson)
    class(law_constants), intent(inout) :: self
    real(rk), intent(in) :: young !< of the solid on the slave side [Pa]
    real(rk), intent(in) :: poisson
    if (self%normal_stiffness <= 0.0_rk) self%normal_stiffness = young/self%thickness
    if (self%tangent_stiffness > 0.0_rk) return
    self%tangent_stiffness = self%normal_stiffness/(2.0_rk*(1.0_rk + poisson))
    if (self%penetration > 0.0_rk) then
      self%tangent_stiffness = young/self%thickness/(2.0_rk*(1.0_rk + poisson))
    end if
  end subroutine complete_stiffness
end module joint_constants
