!> The stiffness of the elements behind a joint: the default of KN for contact without penetration
!> (different_meshes.md, 13.5).
module contact_defaults
  use element_sizes, only: depth_behind
  use kinds, only: rk
  use problem_definition, only: problem
  implicit none
  private
  public :: softest_layer

contains

  !> E/h of the softest layer of elements on either side, h their depth behind the joint [Pa/m]; 0
  !> where no solid has an E.
  pure real(rk) function softest_layer(model, solid, facet) result(stiffness)
    type(problem), intent(in) :: model
    integer, intent(in) :: solid(:) !< (facets) position of the element behind each, 0 for none
    integer, intent(in) :: facet(:, :) !< (4, facets) nodes of both sides
    real(rk) :: young, depth, softest
    integer :: i
    softest = huge(1.0_rk)
    do i = 1, size(solid)
      if (solid(i) == 0) cycle
      young = model%materials(model%mesh%material_of_element(solid(i)))%young
      if (young <= 0.0_rk) cycle
      depth = depth_behind(model%mesh, solid(i), facet(:, i))
      if (depth > 0.0_rk) softest = min(softest, young/depth)
    end do
    stiffness = 0.0_rk
    if (softest < huge(1.0_rk)) stiffness = softest
  end function softest_layer
end module contact_defaults
