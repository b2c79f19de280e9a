!> KN of a joint law that asks for contact without penetration and names none
!> (different_meshes.md, 13.5).
module contact_defaults
  use element_sizes, only: depth_behind
  use joint_constants, only: law_constants
  use kinds, only: rk
  use problem_definition, only: problem
  implicit none
  private
  public :: take_layer_stiffness

contains

  !> k_n = E/h of the softest layer of elements on either side, h their depth behind the joint.
  !> Where no solid has an E nothing is set.
  subroutine take_layer_stiffness(scene, solid, facet, law)
    type(problem), intent(in) :: scene
    integer, intent(in) :: solid(:) !< (facets) position of the element behind each, 0 for none
    integer, intent(in) :: facet(:, :) !< (4, facets) nodes of both sides
    type(law_constants), intent(inout) :: law
    real(rk) :: young, softest
    integer :: i
    softest = huge(1.0_rk)
    do i = 1, size(solid)
      if (solid(i) == 0) cycle
      young = scene%materials(scene%mesh%material_of_element(solid(i)))%young
      if (young <= 0.0_rk) cycle
      softest = min(softest, young/depth_behind(scene%mesh, solid(i), facet(:, i)))
    end do
    if (softest < huge(1.0_rk)) law%normal_stiffness = softest
  end subroutine take_layer_stiffness
end module contact_defaults
