!> How wide the crack bands in solid elements can be.
module element_widths
  use crack_band, only: extreme_widths
  use dam_mesh, only: mesh
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use gauss_rules, only: hex_point
  use kinds, only: rk
  use shape_hex8, only: edges_at
  implicit none
  private
  public :: measure_widths

contains

  !> Smallest and largest width that a band can have at the integration points of solid elements,
  !> whatever the direction of the crack.
  subroutine measure_widths(body, elements, smallest, largest)
    type(mesh), intent(in) :: body
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(out) :: smallest(:), largest(:) !< (elements) [m]
    class(solid_element), allocatable :: formulation
    real(rk) :: x(3, 8), least, most
    integer :: i, q
    do i = 1, size(elements)
      call need_formulation(body%element_type(elements(i)), formulation)
      x = body%x(:, body%nodes(:, elements(i)))
      smallest(i) = huge(1.0_rk)
      largest(i) = 0.0_rk
      do q = 1, formulation%num_points
        if (formulation%num_points == 1) then
          call extreme_widths(edges_at(x, [0.0_rk, 0.0_rk, 0.0_rk]), least, most)
        else
          call extreme_widths(edges_at(x, hex_point(:, q)), least, most)
        end if
        smallest(i) = min(smallest(i), least)
        largest(i) = max(largest(i), most)
      end do
    end do
  end subroutine measure_widths

  !> Makes the formulation of a kind unless it is the one at hand.
  subroutine need_formulation(kind, formulation)
    character(*), intent(in) :: kind
    class(solid_element), allocatable, intent(inout) :: formulation
    if (allocated(formulation)) then
      if (formulation%name == kind) return
    end if
    call make_solid(kind, formulation)
  end subroutine need_formulation
end module element_widths
