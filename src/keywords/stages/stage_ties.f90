!> Ties of faces that are absent although all their nodes have other elements (theory.md, 15.1).
!>
!> A tie holds while its nodes have elements: it would hold a face where a solid is absent.
module stage_ties
  use dam_mesh, only: nodes_of_elements
  use diagnostics, only: diagnostic_list
  use facet_segments, only: find_segments
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use model_draft, only: draft, tie_request
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set, segment_set, surface_cover
  use write_text, only: as_text
  implicit none
  private
  public :: check_tied_faces

  !> Corners closer than this, over the size of the facet, are one place (as in element_joint8).
  real(rk), parameter :: coincidence = 1.0e-4_rk

contains

  !> Reports the ties that hold a face of an absent solid.
  subroutine check_tied_faces(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (.not. allocated(model%ties)) return
    do i = 1, size(model%ties)
      call check_tie(model, model%ties(i), faults)
    end do
  end subroutine check_tied_faces

  !> Reports the first face and step of a tie. Faces of equal meshes are held by their neighbours.
  subroutine check_tie(model, request, faults)
    type(draft), intent(in) :: model
    type(tie_request), intent(in) :: request
    type(diagnostic_list), intent(inout) :: faults
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    logical, allocatable :: has_solid(:)
    integer :: step, s, lost
    associate (mesh => model%problem%mesh, plan => model%problem%stages)
      call list_surface_facets(mesh, model%problem%surfaces(request%slave), slave)
      call list_surface_facets(mesh, model%problem%surfaces(request%master), master)
      call find_segments(mesh%x, slave, master, segments, cover)
      do step = 1, size(plan%is_absent, 2)
        has_solid = nodes_of_elements(mesh, mesh%material_of_element > 0 &
                                      .and. .not. plan%is_absent(:, step))
        do s = 1, segments%num_segments
          associate (one => segments%slave(s), other => segments%master(s))
            lost = 0
            if (plan%is_absent(master%element(other), step)) lost = master%element(other)
            if (plan%is_absent(slave%element(one), step)) lost = slave%element(one)
            if (lost == 0) cycle
            if (.not. all(has_solid([slave%node(:, one), master%node(:, other)]))) cycle
            if (are_equal(mesh%x(:, slave%node(:, one)), mesh%x(:, master%node(:, other)))) cycle
          end associate
          call report(model, request, lost, step, faults)
          return
        end do
      end do
    end associate
  end subroutine check_tie

  !> Whether each corner of a facet lies on one of the other.
  pure logical function are_equal(x, y)
    real(rk), intent(in) :: x(3, 4), y(3, 4) !< [m]
    real(rk) :: nearest(4)
    integer :: a, b
    do a = 1, 4
      nearest(a) = minval([(norm2(x(:, a) - y(:, b)), b=1, 4)])
    end do
    are_equal = maxval(nearest) <= coincidence*sqrt(norm2(face_vector(x)))
  end function are_equal

  !> The fault of a tie.
  subroutine report(model, request, element, step, faults)
    type(draft), intent(in) :: model
    type(tie_request), intent(in) :: request
    integer, intent(in) :: element, step !< the absent solid, and when
    type(diagnostic_list), intent(inout) :: faults
    associate (place => model%cards(request%spot%card))
      call place%fault_at(faults, max(1, request%spot%line), 1, 'the tie does not go with '// &
                          '*MODEL CHANGE: in step '//as_text(step)//' element '// &
                          as_text(model%problem%mesh%element_id(element))//' is absent, and '// &
                          'the tie would hold its face, all of whose nodes have other elements', &
                          '*JOINT between the surfaces, or surfaces without this face')
    end associate
  end subroutine report
end module stage_ties
