!> Errors where ties and equations do not hold a part of the model, as a tie along one line: the
!> part can turn about it. The check of supports takes tied parts for one rigid body.
module verify_ties
  use block_motion, only: block_name, freedom_text
  use dam_mesh, only: node_tie
  use diagnostics, only: diagnostic_list
  use errors, only: error_type
  use guest_list, only: supports_of_step, ties_of
  use kinds, only: rk
  use model_draft, only: draft
  use rigid_blocks, only: add_supports, add_tie, block_set, find_tied_parts
  use symmetric_modes, only: find_modes
  implicit none
  private
  public :: verify_tied_parts

  integer, parameter :: most_parts = 100 !< more are not checked
  !> Of the largest, in squares: a tie over a patch of 1e-4 of its part counts as one over a point.
  !> The rows of mortar ties are not exact along a line, and leave some 1e-9.
  real(rk), parameter :: least_resistance = 1.0e-8_rk
  !> A smaller share of a part in the free motions, squared, is round-off.
  real(rk), parameter :: no_share = 1.0e-6_rk

contains

  !> Reports the first static or *FREQUENCY step in which a part is free.
  subroutine verify_tied_parts(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(node_tie), allocatable :: ties(:)
    type(block_set) :: parts
    type(error_type), allocatable :: error
    real(rk), allocatable :: by_ties(:, :), own(:, :), matrix(:, :), resistance(:), motions(:, :)
    integer, allocatable :: node(:), direction(:)
    integer :: i, num_free
    call ties_of(model%problem%guests, ties)
    if (size(ties) == 0) return
    call find_tied_parts(model%problem, parts)
    if (parts%num_blocks < 2 .or. parts%num_blocks > most_parts) return
    if (.not. all(have_elements(parts, ties))) return ! nodes without elements may pass on motions
    allocate (by_ties(6*parts%num_blocks, 6*parts%num_blocks), source=0.0_rk)
    allocate (own, source=by_ties)
    do i = 1, size(ties)
      own = 0.0_rk
      call add_tie(parts, model%problem%mesh%x, ties(i), own)
      by_ties = by_ties + own/max(1, size(ties(i)%node))
    end do
    do i = 1, size(model%problem%steps)
      if (model%problem%steps(i)%procedure%has_inertia) cycle
      call supports_of_step(model%problem, model%problem%steps(i), node, direction)
      matrix = 0.0_rk*by_ties
      call add_supports(parts, model%problem%mesh%x, node, direction, matrix)
      matrix = by_ties + matrix/max(1, size(node))
      call find_modes(matrix, resistance, motions, error)
      if (allocated(error)) return
      num_free = count(resistance <= least_resistance*maxval(resistance))
      if (num_free == 0) cycle
      call fault_part(model, i, parts, motions(:, :num_free), faults)
      return
    end do
  end subroutine verify_tied_parts

  !> Whether all nodes of a tie belong to elements.
  elemental logical function have_elements(parts, tie)
    type(block_set), intent(in) :: parts
    type(node_tie), intent(in) :: tie
    have_elements = all(parts%block_of(tie%node) > 0) &
                    .and. all(parts%block_of(tie%item(:tie%first(size(tie%node) + 1) - 1)) > 0)
  end function have_elements

  !> Reports the part with the largest share in the free motions.
  subroutine fault_part(model, number, parts, motions, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(block_set), intent(in) :: parts
    real(rk), intent(in) :: motions(:, :) !< (6*parts, motions) orthonormal
    type(diagnostic_list), intent(inout) :: faults
    type(error_type), allocatable :: error
    real(rk), allocatable :: share(:), motion(:, :)
    integer :: b, free
    free = 1
    do b = 2, parts%num_blocks
      if (norm2(motions(6*b - 5:6*b, :)) > norm2(motions(6*free - 5:6*free, :))) free = b
    end do
    associate (own => motions(6*free - 5:6*free, :))
      call find_modes(matmul(own, transpose(own)), share, motion, error)
    end associate
    if (allocated(error)) return
    call model%cards(model%procedure_card(number))%fault( &
      faults, block_name(model%problem, parts, free)//' can '// &
      freedom_text(parts, free, motion(:, findloc(share > no_share, .true., 1):))// &
      ': ties, equations and supports do not prevent this motion', &
      'ties over faces, not along one line, or supports of this part')
  end subroutine fault_part
end module verify_ties
