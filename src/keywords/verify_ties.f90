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

  !> Most bodies that are checked: the modes of 100 take 0.3 s, and the cost grows with the cube.
  integer, parameter :: most_bodies = 100
  !> Of the largest, in squares. A chain of 100 bodies has 1e-10, round-off 1e-15.
  real(rk), parameter :: least_resistance = 1.0e-12_rk
  !> A smaller share of a part in the free motions, squared, is round-off.
  real(rk), parameter :: no_share = 1.0e-6_rk

  !> Parts of the model, and bodies of parts that ties and equations hold to each other in all
  !> directions.
  type :: tied_bodies
    type(block_set) :: parts, bodies
    integer, allocatable :: body_of(:) !< (parts)
    logical, allocatable :: is_unsure(:) !< (parts) nodes without elements may hold them
    real(rk), allocatable :: resistance(:, :) !< (6*bodies, 6*bodies) of ties and equations
  end type tied_bodies

contains

  !> Reports the first static or *FREQUENCY step in which a part is free.
  subroutine verify_tied_parts(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(node_tie), allocatable :: ties(:)
    type(tied_bodies) :: tied
    type(error_type), allocatable :: error
    integer :: first
    first = findloc(model%problem%steps%procedure%has_inertia, .false., 1)
    if (first == 0) return
    call ties_of(model%problem%guests, ties)
    if (size(ties) == 0) return
    call find_tied_parts(model%problem, tied%parts)
    if (tied%parts%num_blocks < 2) return
    call unite_parts(model, ties, tied, error)
    if (allocated(error)) return
    if (tied%bodies%num_blocks > most_bodies) then
      call model%cards(model%procedure_card(first))%warn( &
        faults, 'ties and equations leave '//as_text(tied%bodies%num_blocks)//' separate '// &
        'parts; the check for parts that are free to move is left out above '// &
        as_text(most_bodies)//' parts: see to their supports')
      return
    end if
    call verify_steps(model, tied, faults)
  end subroutine verify_tied_parts

  !> Unites the parts that ties hold in all directions, and finds what ties resist of the motions of
  !> the bodies.
  subroutine unite_parts(model, ties, tied, error)
    type(draft), intent(in) :: model
    type(node_tie), intent(in) :: ties(:)
    type(tied_bodies), intent(inout) :: tied !< with its parts
    type(error_type), allocatable, intent(out) :: error
    type(part_resistance), allocatable :: list(:)
    integer :: n
    call find_unsure(tied%parts, ties, tied%is_unsure)
    call list_resistance(tied%parts, model%problem%mesh%x, ties, list, error)
    if (allocated(error)) return
    call unite_held(list, tied%parts%num_blocks, tied%body_of, error)
    if (allocated(error)) return
    call join_blocks(model%problem%mesh, tied%parts, tied%body_of, tied%bodies)
    if (tied%bodies%num_blocks > most_bodies) return
    n = 6*tied%bodies%num_blocks
    allocate (tied%resistance(n, n), source=0.0_rk)
    call add_resistance(tied%bodies, tied%body_of, list, tied%resistance)
  end subroutine unite_parts

  !> Parts in rows with a node without elements: such a node may hold them, or pass on motions.
  subroutine find_unsure(parts, ties, is_unsure)
    type(block_set), intent(in) :: parts
    type(node_tie), intent(in) :: ties(:)
    logical, allocatable, intent(out) :: is_unsure(:) !< (parts)
    integer, allocatable :: touched(:)
    integer :: t, i
    allocate (is_unsure(parts%num_blocks), source=.false.)
    do t = 1, size(ties)
      associate (tie => ties(t))
        do i = 1, size(tie%node)
          touched = parts%block_of([tie%node(i), tie%item(tie%first(i):tie%first(i + 1) - 1)])
          if (any(touched == 0)) is_unsure(pack(touched, touched > 0)) = .true.
        end do
      end associate
    end do
  end subroutine find_unsure

  !> Reports the first step without inertia in which a body is free.
  subroutine verify_steps(model, tied, faults)
    type(draft), intent(in) :: model
    type(tied_bodies), intent(in) :: tied
    type(diagnostic_list), intent(inout) :: faults
    type(error_type), allocatable :: error
    real(rk), allocatable :: matrix(:, :), checked(:, :), resistance(:), motions(:, :)
    integer, allocatable :: node(:), direction(:)
    integer :: i, num_free
    checked = 0.0_rk*tied%resistance
    do i = 1, size(model%problem%steps)
      if (model%problem%steps(i)%procedure%has_inertia) cycle
      matrix = tied%resistance
      call supports_of_step(model%problem, model%problem%steps(i), node, direction)
      call add_supports(tied%bodies, model%problem%mesh%x, node, direction, matrix)
      call hold_bodies(tied, tied%is_unsure .or. are_absent(model, i, tied%parts), matrix)
      call scale_parts(matrix)
      if (all(abs(matrix - checked) <= 0.0_rk)) cycle
      checked = matrix
      call find_modes(matrix, resistance, motions, error)
      if (allocated(error)) return
      num_free = count(resistance <= least_resistance*maxval(resistance))
      if (num_free == 0) cycle
      call fault_part(model, i, tied%bodies, motions(:, :num_free), faults)
      return
    end do
  end subroutine verify_steps

  !> Parts that *MODEL CHANGE has taken out in a step.
  pure function are_absent(model, number, parts) result(is_absent)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(block_set), intent(in) :: parts
    logical :: is_absent(parts%num_blocks)
    integer :: b, e
    is_absent = .false.
    if (.not. allocated(model%problem%stages%is_absent)) return
    is_absent = .true.
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (model%problem%stages%is_absent(e, number)) cycle
        b = parts%block_of(mesh%nodes(1, e))
        if (b > 0) is_absent(b) = .false.
      end do
    end associate
  end function are_absent

  !> Holds the bodies of some parts in all directions: they are not reported.
  subroutine hold_bodies(tied, is_held, matrix)
    type(tied_bodies), intent(in) :: tied
    logical, intent(in) :: is_held(:) !< (parts)
    real(rk), intent(inout) :: matrix(:, :) !< (6*bodies, 6*bodies)
    integer :: b, k
    do b = 1, size(is_held)
      if (.not. is_held(b)) cycle
      do k = 6*tied%body_of(b) - 5, 6*tied%body_of(b)
        matrix(k, k) = matrix(k, k) + 1.0_rk
      end do
    end do
  end subroutine hold_bodies

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
