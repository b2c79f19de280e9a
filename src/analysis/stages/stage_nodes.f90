!> Where nodes start when elements come (theory.md, 15.1): ties and equations that begin to hold
!> move nothing.
module stage_nodes
  use constraint_elimination, only: keep_present
  use errors, only: error_type
  use global_vectors, only: dot
  use guest_list, only: ties_of
  use dam_mesh, only: node_tie
  use dof_numbering, only: linear_links
  use kinds, only: rk
  use node_dofs, only: as_dofs, as_field, dof_map, displacement_dofs
  use problem_definition, only: problem
  use tie_motion, only: follow_links, link_ties
  implicit none
  private
  public :: place_nodes

  !> A smaller sum of weights makes no mean.
  real(rk), parameter :: least_weight = 1.0e-6_rk

  !> Relations of which some begin to hold.
  type :: new_links
    type(linear_links) :: links
    logical, allocatable :: is_moved(:) !< (links) has a dof that comes
    logical, allocatable :: is_old(:) !< (links) its dependent dof has been there
    logical, allocatable :: is_free(:) !< (dofs) comes, and neither depends nor is held
  contains
    procedure :: gather_moved
  end type new_links

contains

  !> Displacements of nodes that come, and the change of those that have been there.
  !>
  !> A node that comes starts without displacement, a dependent one where the others place it. Old
  !> nodes that follow new ones: the new ones start so that the old ones stay, in the sense of least
  !> squares. What then is left moves the old nodes.
  subroutine place_nodes(model, number, was_absent, u, change, error)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    logical, intent(in) :: was_absent(:) !< (nodes)
    real(rk), intent(inout) :: u(:, :) !< (3, nodes) [m]
    real(rk), intent(out) :: change(:, :) !< (3, nodes) of nodes that have been there [m]
    type(error_type), allocatable, intent(out) :: error
    type(node_tie), allocatable :: ties(:)
    type(new_links) :: found
    type(dof_map) :: dofs
    real(rk), allocatable :: q(:), placed(:, :)
    integer :: node
    change = 0.0_rk
    do node = 1, size(u, 2)
      if (model%mesh%is_node_absent(node)) u(:, node) = 0.0_rk
    end do
    call ties_of(model%guests, ties)
    call keep_present(model%mesh, ties)
    dofs = displacement_dofs(size(u, 2))
    call link_ties(dofs, ties, found%links, error)
    if (allocated(error)) return
    call mark_dofs(model, number, dofs, was_absent, found)
    q = as_dofs(u)
    if (any(found%is_moved .and. found%is_old)) call start_new_nodes(found, q)
    call follow_links(found%links, found%is_moved, q)
    placed = as_field(q)
    do node = 1, size(u, 2)
      if (.not. was_absent(node)) change(:, node) = placed(:, node) - u(:, node)
    end do
    u = placed
  end subroutine place_nodes

  !> Which dofs come, and which relations they move.
  subroutine mark_dofs(model, number, dofs, was_absent, found)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(dof_map), intent(in) :: dofs
    logical, intent(in) :: was_absent(:) !< (nodes)
    type(new_links), intent(inout) :: found
    logical :: is_moved(dofs%num_dofs)
    integer :: k
    is_moved = was_absent(dofs%node) .and. .not. model%mesh%is_node_absent(dofs%node)
    found%is_free = is_moved
    associate (links => found%links, fixed => model%steps(number)%fixities)
      found%is_free(dofs%dof_of(fixed%node, fixed%dof)) = .false.
      found%is_free(links%dof(:links%num_links)) = .false.
      allocate (found%is_moved(links%num_links), found%is_old(links%num_links))
      do k = 1, links%num_links
        associate (dof => links%dof(k), terms => links%term(links%first(k):links%first(k + 1) - 1))
          found%is_old(k) = .not. is_moved(dof)
          found%is_moved(k) = is_moved(dof) .or. any(is_moved(terms))
          is_moved(dof) = found%is_moved(k)
        end associate
      end do
    end associate
  end subroutine mark_dofs

  !> The transpose of `follow_links`: forces of dependent dofs go to the others.
  pure subroutine gather_moved(self, f)
    class(new_links), intent(in) :: self
    real(rk), intent(inout) :: f(:) !< (dofs)
    integer :: k, t
    associate (links => self%links)
      do k = links%num_links, 1, -1
        if (.not. self%is_moved(k)) cycle
        do t = links%first(k), links%first(k + 1) - 1
          f(links%term(t)) = f(links%term(t)) + links%coefficient(t)*f(links%dof(k))
        end do
        f(links%dof(k)) = 0.0_rk
      end do
    end associate
  end subroutine gather_moved

  !> Starts the free dofs that come so that old dofs that follow them stay where they are: by
  !> conjugate gradients for the least squares (CGLS, Bjorck 1996, 7.4.1), from the mean of the old
  !> dofs that follow each of them, which is right where all old nodes have moved alike.
  subroutine start_new_nodes(found, q)
    type(new_links), intent(in) :: found
    real(rk), intent(inout) :: q(:) !< (dofs)
    real(rk), dimension(size(q)) :: apart, slope, direction, moved
    logical :: is_follower(size(q))
    real(rk) :: now, first, before, step
    integer :: i
    is_follower = .false.
    associate (links => found%links)
      is_follower(pack(links%dof(:links%num_links), found%is_moved .and. found%is_old)) = .true.
    end associate
    call find_slope(merge(q, 0.0_rk, is_follower), slope)
    call find_slope(merge(1.0_rk, 0.0_rk, is_follower), moved)
    where (moved > least_weight) q = slope/moved
    moved = q
    call follow_links(found%links, found%is_moved, moved)
    apart = merge(q - moved, 0.0_rk, is_follower)
    call find_slope(apart, slope)
    direction = slope
    now = dot(slope, slope)
    first = now
    do i = 1, 2*count(found%is_free)
      ! Round-off of displacements: what is left moves the old nodes.
      if (.not. now > epsilon(1.0_rk)**2*first) exit
      moved = direction
      call follow_links(found%links, found%is_moved, moved)
      moved = merge(moved, 0.0_rk, is_follower)
      step = now/dot(moved, moved)
      q = q + step*direction
      apart = apart - step*moved
      before = now
      call find_slope(apart, slope)
      now = dot(slope, slope)
      direction = slope + now/before*direction
    end do
  contains
    !> The steepest descent of the squares in the free dofs.
    subroutine find_slope(apart, slope)
      real(rk), intent(in) :: apart(:)
      real(rk), intent(out) :: slope(:)
      slope = apart
      call found%gather_moved(slope)
      slope = merge(slope, 0.0_rk, found%is_free)
    end subroutine find_slope
  end subroutine start_new_nodes
end module stage_nodes
