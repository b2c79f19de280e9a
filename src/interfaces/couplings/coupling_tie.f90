!> The exact tie of two faces whose meshes differ: a mortar constraint with dual multipliers,
!> condensed (different_meshes.md, 13.3). Each node of the slave face with a multiplier follows the
!> master face,
!>   u(a) = sum_m w_m u(m),   w the weights of mortar_projection.
!>
!> A slave node has no multiplier in a direction in which a support of any step holds it, or an
!> earlier tie makes it follow others; nor if it is also a node of the master face; nor if the
!> master face or a node without multiplier follows it, directly or through others. The dual
!> function of such a node is added to those of its neighbours on each facet.
module coupling_tie
  use dam_mesh, only: node_tie
  use eliminated_rows, only: row_guest
  use kinds, only: rk
  use mortar_projection, only: project
  use mortar_balance, only: mortar_rows
  use surface_facets, only: mark_corners
  use surface_segments, only: facet_set, segment_set
  use write_text, only: as_text
  implicit none
  private
  public :: exact_tie, build_tie_rows, find_bound

  !> A tie without springs: slave nodes follow the master face.
  type, extends(row_guest) :: exact_tie
  contains
    procedure :: describe
  end type exact_tie

contains

  !> The tie in the summary of the model.
  function describe(self) result(text)
    class(exact_tie), intent(in) :: self
    character(:), allocatable :: text
    text = 'TIE, exact: '//as_text(size(self%rows%node))//' nodes follow'
  end function describe

  !> The rows of a tie. Directions with multipliers at the same nodes share rows.
  subroutine build_tie_rows(x, slave, master, segments, is_fixed, earlier, tie, is_bare)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments
    logical, intent(in) :: is_fixed(:, :) !< (3, nodes) by a support in any step
    type(node_tie), intent(in) :: earlier(:) !< earlier ties of the deck
    type(node_tie), intent(inout) :: tie !< the caller sets its name
    logical, allocatable, intent(out) :: is_bare(:) !< (slave facets) lies on no master facet
    type(mortar_rows) :: rows
    logical :: is_bound(size(x, 2), 3), together(3)
    integer :: i, j
    tie%node = [integer ::]
    tie%first = [1]
    tie%item = [integer ::]
    tie%weight = [real(rk) ::]
    allocate (tie%is_tied(3, 0))
    allocate (is_bare(size(slave%node, 2)), source=.true.)
    do i = 1, 3
      call find_bound(i, slave, master, is_fixed(i, :), earlier, is_bound(:, i))
    end do
    do i = 1, 3
      do j = 1, 3
        together(j) = all(is_bound(:, j) .eqv. is_bound(:, i))
      end do
      if (any(together(:i - 1))) cycle
      call project(x, slave, master, segments, is_bound(:, i), rows, merges_planes=.true.)
      call add_rows(rows, together, tie)
      is_bare = is_bare .and. rows%is_bare
    end do
  end subroutine build_tie_rows

  !> Appends the rows of some directions.
  pure subroutine add_rows(rows, directions, tie)
    type(mortar_rows), intent(in) :: rows
    logical, intent(in) :: directions(3)
    type(node_tie), intent(inout) :: tie
    integer :: num_before
    num_before = size(tie%item)
    tie%node = [tie%node, rows%node]
    tie%is_tied = reshape([tie%is_tied, spread(directions, 2, rows%num_rows())], &
                          [3, size(tie%node)])
    tie%first = [tie%first, num_before + rows%first(2:)]
    tie%item = [tie%item, rows%item]
    tie%weight = [tie%weight, rows%weight]
  end subroutine add_rows

  !> The slave nodes without a multiplier in one direction.
  pure subroutine find_bound(direction, slave, master, is_fixed, earlier, is_bound)
    integer, intent(in) :: direction !< 1..3
    type(facet_set), intent(in) :: slave, master
    logical, intent(in) :: is_fixed(:) !< (nodes) in this direction
    type(node_tie), intent(in) :: earlier(:)
    logical, intent(out) :: is_bound(:) !< (nodes)
    integer, allocatable :: row(:, :)
    logical, allocatable :: is_slave(:), is_followed(:)
    call list_followers(direction, earlier, size(is_fixed), row)
    is_slave = mark_corners(size(is_fixed), slave)
    is_bound = is_slave .and. (is_fixed .or. row(1, :) > 0)
    is_followed = mark_corners(size(is_fixed), master) .or. is_bound
    call mark_followed(earlier, row, is_followed)
    is_bound = is_slave .and. is_followed
  end subroutine find_bound

  !> The place where each node is tied: (1) the tie, 0 for none, and (2) its row.
  pure subroutine list_followers(direction, ties, num_nodes, row)
    integer, intent(in) :: direction, num_nodes
    type(node_tie), intent(in) :: ties(:)
    integer, allocatable, intent(out) :: row(:, :) !< (2, nodes)
    integer :: t, k
    allocate (row(2, num_nodes), source=0)
    do t = 1, size(ties)
      do k = 1, size(ties(t)%node)
        if (ties(t)%is_tied(direction, k)) row(:, ties(t)%node(k)) = [t, k]
      end do
    end do
  end subroutine list_followers

  !> Marks all nodes that the marked nodes follow, directly or through others.
  pure subroutine mark_followed(ties, row, is_followed)
    type(node_tie), intent(in) :: ties(:)
    integer, intent(in) :: row(:, :) !< (2, nodes)
    logical, intent(inout) :: is_followed(:) !< (nodes)
    integer, allocatable :: stack(:)
    integer :: top, node, k
    top = count(is_followed)
    allocate (stack(size(is_followed)))
    stack(:top) = pack([(node, node=1, size(is_followed))], is_followed)
    do while (top > 0)
      node = stack(top)
      top = top - 1
      if (row(1, node) == 0) cycle
      associate (tie => ties(row(1, node)))
        do k = tie%first(row(2, node)), tie%first(row(2, node) + 1) - 1
          if (is_followed(tie%item(k))) cycle
          is_followed(tie%item(k)) = .true.
          top = top + 1
          stack(top) = tie%item(k)
        end do
      end associate
    end do
  end subroutine mark_followed
end module coupling_tie
