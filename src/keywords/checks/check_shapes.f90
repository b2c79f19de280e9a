!> Warns of solids whose nodes are probably not in the order, or not the nodes, that were meant:
!> different nodes at one place, one node twice, faces that are twisted.
module check_shapes
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use kinds, only: rk
  use mesh_faces, only: face_nodes
  use model_draft, only: draft
  use small_matrix, only: cross_product
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_shapes

  integer, parameter :: num_corners = 8
  real(rk), parameter :: round_off = 1.0e-12_rk !< of a length, over the largest coordinate
  !> Cosine of the angle of 60 degrees between both halves of a face. In an upright brick whose top
  !> face begins one node too late it is 0 and less; meshes of valleys stay below 30 degrees.
  real(rk), parameter :: cosine_of_twist = 0.5_rk

contains

  !> One warning for all elements with the same fault. The deck must have no errors.
  subroutine warn_of_shapes(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: first(3), num(3) !< elements: nodes at one place, one node twice, twisted faces
    integer :: e, kind
    first = 0
    num = 0
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (.not. is_solid(mesh%element_type(e))) cycle
        kind = kind_of_fault(model, e)
        if (kind == 0) cycle
        num(kind) = num(kind) + 1
        if (first(kind) == 0) first(kind) = e
      end do
    end associate
    do kind = 1, size(num)
      if (num(kind) > 0) call warn(model, kind, first(kind), num(kind), faults)
    end do
  end subroutine warn_of_shapes

  !> 1: different nodes at one place, 2: seven different nodes, 3: a twisted face, 0: none of these.
  pure integer function kind_of_fault(model, e) result(kind)
    type(draft), intent(in) :: model
    integer, intent(in) :: e !< position of the element
    integer :: face, pair(2), num_different
    call compare_nodes(model, e, num_different, pair)
    kind = 0
    if (pair(1) > 0) then
      kind = 1
    else if (num_different == num_corners - 1) then
      kind = 2
    else
      do face = 1, 6
        if (is_twisted(model%problem%mesh%x(:, face_nodes(model%problem%mesh, e, face)))) kind = 3
      end do
    end if
  end function kind_of_fault

  !> Counts the different nodes of an element, and finds two of them at the same place.
  pure subroutine compare_nodes(model, e, num_different, pair)
    type(draft), intent(in) :: model
    integer, intent(in) :: e !< position of the element
    integer, intent(out) :: num_different
    integer, intent(out) :: pair(2) !< zeros without such nodes
    real(rk) :: x(3, num_corners), tolerance
    logical :: is_repeated
    integer :: i, j
    num_different = 1
    pair = 0
    associate (nodes => model%problem%mesh%nodes(:, e))
      x = model%problem%mesh%x(:, nodes)
      tolerance = round_off*maxval(abs(x))
      do i = 2, num_corners
        is_repeated = .false.
        do j = 1, i - 1
          if (nodes(i) == nodes(j)) then
            is_repeated = .true.
          else if (all(abs(x(:, i) - x(:, j)) <= tolerance)) then
            pair = [nodes(j), nodes(i)]
          end if
        end do
        if (.not. is_repeated) num_different = num_different + 1
      end do
    end associate
  end subroutine compare_nodes

  !> Whether a diagonal divides a face into triangles whose normals differ by more than 60 degrees.
  !> A face with a repeated node is flat.
  pure logical function is_twisted(x)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    is_twisted = is_bent(x(:, 1), x(:, 2), x(:, 3), x(:, 4)) &
                 .or. is_bent(x(:, 2), x(:, 3), x(:, 4), x(:, 1))
  end function is_twisted

  !> The same for the diagonal from `a` to `c`.
  pure logical function is_bent(a, b, c, d)
    real(rk), intent(in) :: a(3), b(3), c(3), d(3) !< corners in order [m]
    real(rk) :: one(3), two(3)
    one = cross_product(b - a, c - a)
    two = cross_product(c - a, d - a)
    is_bent = dot_product(one, two) < cosine_of_twist*norm2(one)*norm2(two)
  end function is_bent

  subroutine warn(model, kind, e, num, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: kind
    integer, intent(in) :: e !< position of the first element
    integer, intent(in) :: num !< elements with this fault
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: text, expected
    integer :: pair(2), num_different
    associate (mesh => model%problem%mesh, spot => model%element_origin(e))
      select case (kind)
      case (1)
        call compare_nodes(model, e, num_different, pair)
        text = ' has two nodes at the same place: '//as_text(mesh%node_id(pair(1)))//' and '// &
               as_text(mesh%node_id(pair(2)))
        expected = 'eight different places, or the same node twice for a wedge'
      case (2)
        text = ' has seven different nodes: one node stands twice'
        expected = 'eight different nodes, or six for a wedge'
      case default
        text = ' has a twisted face: its two halves meet at more than 60 degrees'
        expected = 'nodes 1-4 around one face, 5-8 above them in the same order'
      end select
      text = 'element '//as_text(mesh%element_id(e))//text
      if (num > 1) text = text//'; '//as_text(num)//' elements in all'
      call model%cards(spot%card)%warn_at(faults, spot%line, 1, text, expected)
    end associate
  end subroutine warn
end module check_shapes
