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
  use rigid_blocks, only: add_supports, block_set, find_tied_parts, join_blocks
  use symmetric_modes, only: find_modes
  use tie_resistance, only: add_resistance, list_resistance, part_resistance, scale_parts, &
                            unite_held
  use write_text, only: as_text
  implicit none
  private
  public :: verify_tied_parts

  !> Bodies of parts that ties hold to each other by hinges alone, or not at all; more are not
  !> checked: the modes of 100 bodies take 0.3 s, and the cost grows with the cube.
  integer, parameter :: most_bodies = 100
  !> Of the largest, in squares. A chain of 100 bodies has 1e-10, round-off 1e-15.
  real(rk), parameter :: least_resistance = 1.0e-12_rk
  !> A smaller share of a part in the free motions, squared, is round-off.
  real(rk), parameter :: no_share = 1.0e-6_rk

contains

  !> Reports the first static or *FREQUENCY step in which a part is free.
  subroutine verify_tied_parts(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(node_tie), allocatable :: ties(:)
    type(block_set) :: parts, bodies
    type(part_resistance), allocatable :: list(:)
    type(error_type), allocatable :: error
    real(rk), allocatable :: by_ties(:, :), matrix(:, :), checked(:, :)
    real(rk), allocatable :: resistance(:), motions(:, :)
    integer, allocatable :: node(:), direction(:), body_of(:)
    integer :: i, num_free
    call ties_of(model%problem%guests, ties)
    if (size(ties) == 0) return
    call find_tied_parts(model%problem, parts)
    if (parts%num_blocks < 2) return
    if (.not. all(have_elements(parts, ties))) return ! nodes without elements may pass on motions
    call list_resistance(parts, model%problem%mesh%x, ties, list, error)
    if (allocated(error)) return
    call unite_held(list, parts%num_blocks, body_of, error)
    if (allocated(error)) return
    call join_blocks(model%problem%mesh, parts, body_of, bodies)
    if (bodies%num_blocks > most_bodies) return
    allocate (by_ties(6*bodies%num_blocks, 6*bodies%num_blocks), source=0.0_rk)
    call add_resistance(bodies, body_of, list, by_ties)
    checked = 0.0_rk*by_ties
    do i = 1, size(model%problem%steps)
      if (model%problem%steps(i)%procedure%has_inertia) cycle
      matrix = by_ties
      call supports_of_step(model%problem, model%problem%steps(i), node, direction)
      call add_supports(bodies, model%problem%mesh%x, node, direction, matrix)
      call hold_absent(model, i, parts, body_of, matrix)
      call scale_parts(matrix)
      if (all(abs(matrix - checked) <= 0.0_rk)) cycle
      checked = matrix
      call find_modes(matrix, resistance, motions, error)
      if (allocated(error)) return
      num_free = count(resistance <= least_resistance*maxval(resistance))
      if (num_free == 0) cycle
      call fault_part(model, i, bodies, motions(:, :num_free), faults)
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

  !> Parts that *MODEL CHANGE has taken out in a step do not move, nor do bodies with such parts.
  subroutine hold_absent(model, number, parts, body_of, matrix)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(block_set), intent(in) :: parts
    integer, intent(in) :: body_of(:) !< (parts)
    real(rk), intent(inout) :: matrix(:, :) !< (6*bodies, 6*bodies)
    logical :: is_there(parts%num_blocks)
    integer :: b, e, k
    if (.not. allocated(model%problem%stages%is_absent)) return
    is_there = .false.
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (model%problem%stages%is_absent(e, number)) cycle
        b = parts%block_of(mesh%nodes(1, e))
        if (b > 0) is_there(b) = .true.
      end do
    end associate
    do b = 1, parts%num_blocks
      if (is_there(b)) cycle
      do k = 6*body_of(b) - 5, 6*body_of(b)
        matrix(k, k) = matrix(k, k) + 1.0_rk
      end do
    end do
  end subroutine hold_absent

  !> Reports the part with the largest share in the free motions.
  subroutine fault_part(model, number, bodies, motions, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(block_set), intent(in) :: bodies
    real(rk), intent(in) :: motions(:, :) !< (6*bodies, motions) orthonormal
    type(diagnostic_list), intent(inout) :: faults
    type(error_type), allocatable :: error
    real(rk), allocatable :: share(:), motion(:, :)
    character(:), allocatable :: text
    integer :: b, free, first
    free = 1
    do b = 2, bodies%num_blocks
      ! Of equal shares, which differ by round-off, the first.
      if (norm2(motions(6*b - 5:6*b, :)) > (1.0_rk + no_share) &
          *norm2(motions(6*free - 5:6*free, :))) free = b
    end do
    associate (own => motions(6*free - 5:6*free, :))
      call find_modes(matmul(own, transpose(own)), share, motion, error)
    end associate
    if (allocated(error)) return
    first = findloc(share > no_share, .true., 1)
    if (first == 6) then
      text = 'the block can '//freedom_text(bodies, free, motion(:, 6:))
    else ! the axes of several motions are any of their space
      text = 'the block has '//as_text(7 - first)//' free motions'
    end if
    call model%cards(model%procedure_card(number))%fault( &
      faults, block_name(model%problem, bodies, free)//' is free to move: '//text// &
      ', which ties, equations and supports do not prevent', &
      'ties over faces, not along one line, or supports of this part')
  end subroutine fault_part
end module verify_ties
