!> Thermal strains at the points of solid elements: the one place that forces, laws and recovery
!> see (theory.md, 16).
module thermal_strains
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use kinds, only: rk
  use problem_definition, only: problem
  implicit none
  private
  public :: heat_field, find_thermal_strains, find_temperatures, expands

  !> Temperatures of a state.
  type :: heat_field
    real(rk), allocatable :: temperature(:) !< (nodes); with *TEMPERATURE only [K]
    !> (8, elements) temperature of the nodes at which an element has no thermal strain, where a
    !> material expands [K]
    real(rk), allocatable :: reference(:, :)
  end type heat_field

contains

  !> Whether the element of a position is there and its material expands.
  pure logical function expands(model, element)
    type(problem), intent(in) :: model
    integer, intent(in) :: element
    integer :: material
    material = model%mesh%material_of_element(element)
    expands = .false.
    if (material > 0) expands = allocated(model%materials(material)%expansion)
  end function expands

  !> Strains of a block of elements of one kind and one material that expands.
  subroutine find_thermal_strains(model, heat, elements, expansion, strain)
    type(problem), intent(in) :: model
    type(heat_field), intent(in) :: heat
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(out) :: expansion(:, :) !< (points, elements) in all directions
    real(rk), intent(out) :: strain(:, :, :) !< (6, points, elements) that is taken from B u
    real(rk) :: nodal(8, size(elements))
    integer :: e
    associate (table => model%materials(model%mesh%material_of_element(elements(1)))%expansion)
      do e = 1, size(elements)
        nodal(:, e) = table%between(heat%reference(:, elements(e)), &
                                    heat%temperature(model%mesh%nodes(:, elements(e))))
      end do
    end associate
    call spread_to_points(model, elements, nodal, expansion, strain)
  end subroutine find_thermal_strains

  !> Temperatures at the points of a block of elements of one kind and one material.
  subroutine find_temperatures(model, heat, elements, temperature)
    type(problem), intent(in) :: model
    type(heat_field), intent(in) :: heat
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(out) :: temperature(:, :) !< (points, elements) [K]
    real(rk) :: nodal(8, size(elements)), unused(6, size(temperature, 1), size(elements))
    integer :: e
    do e = 1, size(elements)
      nodal(:, e) = heat%temperature(model%mesh%nodes(:, elements(e)))
    end do
    call spread_to_points(model, elements, nodal, temperature, unused)
  end subroutine find_temperatures

  !> Values of nodes at the points, as the formulation of the elements takes them.
  subroutine spread_to_points(model, elements, nodal, expansion, strain)
    type(problem), intent(in) :: model
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(in) :: nodal(:, :) !< (8, elements)
    real(rk), intent(out) :: expansion(:, :) !< (points, elements)
    real(rk), intent(out) :: strain(:, :, :) !< (6, points, elements)
    class(solid_element), allocatable :: formulation
    real(rk) :: x(3, 8, size(elements)), d(6, 6)
    integer :: e
    do e = 1, size(elements)
      x(:, :, e) = model%mesh%x(:, model%mesh%nodes(:, elements(e)))
    end do
    call make_solid(model%mesh%element_type(elements(1)), formulation)
    call model%materials(model%mesh%material_of_element(elements(1)))%law%elastic_stiffness(d)
    call formulation%thermal_strain(x, d, nodal, expansion, strain)
  end subroutine spread_to_points
end module thermal_strains
