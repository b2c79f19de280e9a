!> Places where linear elasticity has no finite stress, found from the shape of the model alone
!> (theory.md, 14.6): re-entrant edges and corners, and edges of supports that hold all directions,
!> not the places inside such a support.
!> The stress there grows with every refinement of the mesh.
module singular_places
  use dam_mesh, only: element_is_there, fe_mesh
  use element_catalogue, only: is_solid
  use kinds, only: rk
  use problem_definition, only: problem
  use shape_hex8, only: derivative_at, edge_end, shape_at
  use small_matrix, only: cross_product, solve_dense
  use support_edges, only: directions_held, is_inside_support
  implicit none
  private
  public :: singular_nodes, is_singular, words_of_cause

  !> What makes a place singular.
  integer, parameter :: not_asked = 0, regular = 1, edge_of_support = 2, reentrant_edge = 3

  !> What has been found so far: the same node is asked for in many increments.
  type :: singular_nodes
    integer :: stage = -1 !< of the mesh
    integer, allocatable :: cause(:) !< (nodes)
  contains
    procedure :: cause_at
  end type singular_nodes

  real(rk), parameter :: pi = acos(-1.0_rk)
  real(rk), parameter :: near = 1.0e-4_rk !< of the diagonal of an element: the same place
  real(rk), parameter :: on_face = 1.0e-3_rk !< of a natural coordinate
  !> Solids that fill this much more than a half space are re-entrant: 207 degrees at an edge.
  !> Facets of a curved surface stay below.
  real(rk), parameter :: margin = 1.15_rk
  real(rk), parameter :: all_around = 0.97_rk !< of a full sphere: a place inside
  integer, parameter :: most_steps = 20 !< of Newton's method
  !> Distance of a point of the element from the place, over the distance of the same place, at
  !> which Newton's method has found it.
  real(rk), parameter :: near_enough = 1.0e-3_rk

contains

  !> Whether a cause makes a place singular.
  pure elemental logical function is_singular(cause)
    integer, intent(in) :: cause
    is_singular = cause > regular
  end function is_singular

  !> A cause in words; '' where the place is regular.
  pure function words_of_cause(cause) result(words)
    integer, intent(in) :: cause
    character(:), allocatable :: words
    words = ''
    if (cause == edge_of_support) words = 'at the edge of a support'
    if (cause == reentrant_edge) words = 'a re-entrant edge'
  end function words_of_cause

  !> What makes a node singular in the mesh of this stage.
  integer function cause_at(self, model, node) result(cause)
    class(singular_nodes), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: node
    if (self%stage /= model%mesh%stage) then
      if (.not. allocated(self%cause)) allocate (self%cause(model%mesh%num_nodes))
      self%cause = not_asked
      self%stage = model%mesh%stage
    end if
    if (self%cause(node) == not_asked) self%cause(node) = find_cause(model, model%mesh%x(:, node))
    cause = self%cause(node)
  end function cause_at

  !> What makes a place singular.
  integer function find_cause(model, x) result(cause)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: angle, whole
    integer :: held, n
    held = count(directions_held(model, x))
    cause = edge_of_support
    if (held == 3) then
      if (.not. is_inside_support(model, x)) return
      held = 0 ! supports inside a face of the model make no place singular
    end if
    cause = regular
    angle = angle_of_solids(model%mesh, x)
    do n = held, 0, -1
      whole = angle*2**n
      if (whole > (2.0_rk - all_around)*4.0_rk*pi) cycle ! the support is no plane of symmetry here
      if (whole > margin*2.0_rk*pi .and. whole < all_around*4.0_rk*pi) cause = reentrant_edge
      return
    end do
  end function find_cause

  !> The solid angle that all solids fill around a place, those across joints and ties included.
  real(rk) function angle_of_solids(mesh, x) result(angle)
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: corners(3, 8), reach
    integer :: e
    angle = 0.0_rk
    do e = 1, mesh%num_elements
      if (.not. is_solid(mesh%element_type(e))) cycle
      if (.not. element_is_there(mesh, e)) cycle
      corners = mesh%x(:, mesh%nodes(:, e))
      reach = near*norm2(maxval(corners, dim=2) - minval(corners, dim=2))
      if (any(x < minval(corners, dim=2) - reach)) cycle
      if (any(x > maxval(corners, dim=2) + reach)) cycle
      angle = angle + angle_of_element(corners, x, reach)
    end do
  end function angle_of_solids

  !> The solid angle that an element fills around a place; 0 where the place is outside.
  real(rk) function angle_of_element(corners, x, reach) result(angle)
    real(rk), intent(in) :: corners(3, 8) !< [m]
    real(rk), intent(in) :: x(3) !< [m]
    real(rk), intent(in) :: reach !< [m]
    real(rk) :: xi(3), slope(3, 3)
    logical :: is_found
    integer :: c, i
    do c = 1, 8
      if (norm2(corners(:, c) - x) > reach) cycle
      angle = angle_of_corner(corners, c, reach)
      return
    end do
    angle = 0.0_rk
    call find_natural(corners, x, reach, xi, is_found)
    if (.not. is_found .or. any(abs(xi) > 1.0_rk + on_face)) return
    slope = matmul(corners, derivative_at(xi))
    select case (count(abs(xi) > 1.0_rk - on_face))
    case (0)
      angle = 4.0_rk*pi
    case (1)
      angle = 2.0_rk*pi
    case (2)
      i = minloc(abs(xi), dim=1)
      angle = 2.0_rk*dihedral(slope(:, i), -sign(1.0_rk, xi(after(i)))*slope(:, after(i)), &
                              -sign(1.0_rk, xi(after(after(i))))*slope(:, after(after(i))))
    case default
      angle = 0.0_rk ! the far end of an edge without length
    end select
  contains
    !> The next direction, cyclically.
    pure integer function after(direction)
      integer, intent(in) :: direction
      after = mod(direction, 3) + 1
    end function after
  end function angle_of_element

  !> The angle between the half planes of two directions along an edge.
  pure real(rk) function dihedral(edge, a, b)
    real(rk), intent(in) :: edge(3), a(3), b(3)
    real(rk) :: p(3), q(3)
    p = a - edge*dot_product(a, edge)/dot_product(edge, edge)
    q = b - edge*dot_product(b, edge)/dot_product(edge, edge)
    dihedral = atan2(norm2(cross_product(p, q)), dot_product(p, q))
  end function dihedral

  !> The solid angle at a corner (van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125).
  !> Of corners that coincide in a wedge the first one counts.
  real(rk) function angle_of_corner(corners, c, reach) result(angle)
    real(rk), intent(in) :: corners(3, 8) !< [m]
    integer, intent(in) :: c
    real(rk), intent(in) :: reach !< [m]
    real(rk) :: edge(3, 3), length(3)
    integer :: i
    do i = 1, 3
      edge(:, i) = corners(:, end_of_edge(corners, c, i, reach)) - corners(:, c)
      length(i) = norm2(edge(:, i))
    end do
    angle = 2.0_rk*atan2(abs(dot_product(edge(:, 1), cross_product(edge(:, 2), edge(:, 3)))), &
                         product(length) + dot_product(edge(:, 1), edge(:, 2))*length(3) &
                         + dot_product(edge(:, 1), edge(:, 3))*length(2) &
                         + dot_product(edge(:, 2), edge(:, 3))*length(1))
  end function angle_of_corner

  !> The far end of an edge; where the edge has no length, that of the next edge of its face.
  pure integer function end_of_edge(corners, c, number, reach) result(far)
    real(rk), intent(in) :: corners(3, 8) !< [m]
    integer, intent(in) :: c, number
    real(rk), intent(in) :: reach !< [m]
    integer :: i, k, next
    far = edge_end(number, c)
    if (norm2(corners(:, far) - corners(:, c)) > reach) return
    do i = 1, 3
      next = edge_end(i, edge_end(number, c))
      if (norm2(corners(:, next) - corners(:, c)) <= reach) cycle
      if (all([(k == number .or. norm2(corners(:, next) - corners(:, edge_end(k, c))) > reach, &
                k=1, 3)])) far = next
    end do
  end function end_of_edge

  !> The natural coordinates of a place, by Newton's method.
  subroutine find_natural(corners, x, reach, xi, is_found)
    real(rk), intent(in) :: corners(3, 8) !< [m]
    real(rk), intent(in) :: x(3) !< [m]
    real(rk), intent(in) :: reach !< [m]
    real(rk), intent(out) :: xi(3)
    logical, intent(out) :: is_found
    real(rk) :: left(3, 1), step(3, 1)
    logical :: is_singular
    integer :: i
    xi = 0.0_rk
    is_found = .false.
    do i = 1, most_steps
      left(:, 1) = x - matmul(corners, shape_at(xi))
      is_found = norm2(left) <= near_enough*reach
      if (is_found) return
      call solve_dense(matmul(corners, derivative_at(xi)), left, step, is_singular)
      if (is_singular) return
      xi = max(-3.0_rk, min(3.0_rk, xi + step(:, 1)))
    end do
  end subroutine find_natural
end module singular_places
