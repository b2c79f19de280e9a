!> Checks the shape of solids: the sign of their Jacobians.
module verify_elements
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use element_hex8, only: hex8_gradients
  use kinds, only: rk
  use model_draft, only: draft
  use shape_hex8, only: corner_fault
  use write_text, only: as_text
  implicit none
  private
  public :: refuse_inverted, warn_of_corners

contains

  !> The Jacobian must be positive at the integration points.
  subroutine refuse_inverted(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: e, corner
    do e = 1, model%problem%mesh%num_elements
      if (.not. is_solid(model%problem%mesh%element_type(e))) cycle
      corner = inverted_corner(model, e)
      if (corner > 0) call fault_jacobian(model, e, corner, faults)
    end do
  end subroutine refuse_inverted

  !> The corner at which a solid is inverted, 0 for a good solid.
  integer function inverted_corner(model, e) result(corner)
    type(draft), intent(in) :: model
    integer, intent(in) :: e !< position of the element
    real(rk) :: gradient(3, 8, 8), weight(8)
    associate (mesh => model%problem%mesh)
      call hex8_gradients(mesh%x(:, mesh%nodes(:, e)), gradient, weight, corner)
    end associate
  end function inverted_corner

  !> One warning for all solids whose Jacobian is positive at the integration points, but not at a
  !> corner.
  subroutine warn_of_corners(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: e, num_odd, first_odd
    num_odd = 0
    first_odd = 0
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (.not. is_solid(mesh%element_type(e))) cycle
        if (corner_fault(mesh%x(:, mesh%nodes(:, e))) == 0) cycle
        if (inverted_corner(model, e) > 0) cycle
        num_odd = num_odd + 1
        if (first_odd == 0) first_odd = e
      end do
    end associate
    if (num_odd > 0) call warn_of_corner(model, first_odd, num_odd, faults)
  end subroutine warn_of_corners

  !> Warns of the first element with a bad corner.
  subroutine warn_of_corner(model, e, num_odd, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: e !< position of the first element
    integer, intent(in) :: num_odd !< how many there are
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: others
    integer :: corner
    others = ''
    if (num_odd > 1) others = '; also '//as_text(num_odd - 1)//' more element'
    if (num_odd > 2) others = others//'s'
    associate (spot => model%element_origin(e), mesh => model%problem%mesh)
      corner = corner_fault(mesh%x(:, mesh%nodes(:, e)))
      call model%cards(spot%card)%warn(faults, 'element '//as_text(mesh%element_id(e))// &
                                       ' has a Jacobian that is zero or negative at corner '// &
                                       as_text(corner)//' (node '// &
                                       as_text(mesh%node_id(mesh%nodes(corner, e)))//')'//others)
    end associate
  end subroutine warn_of_corner

  subroutine fault_jacobian(model, e, corner, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: e !< position of the element
    integer, intent(in) :: corner !< 1..8
    type(diagnostic_list), intent(inout) :: faults
    associate (spot => model%element_origin(e), mesh => model%problem%mesh)
      call model%cards(spot%card)%fault_at(faults, spot%line, 1, 'element '// &
                                           as_text(mesh%element_id(e))// &
                                           ' is inverted or flat at corner '//as_text(corner)// &
                                           ' (node '// &
                                           as_text(mesh%node_id(mesh%nodes(corner, e)))//')', &
                                           'a positive Jacobian: nodes 1-4 of one face, '// &
                                           '5-8 of the opposite one above them')
    end associate
  end subroutine fault_jacobian
end module verify_elements
