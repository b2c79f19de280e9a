!> A tree of boxes over facets: finds the facets near a box in O(log n) each.
!>
!> Each node is halved at the median of its longest axis. A selection finds the median in linear
!> time, so that building takes O(n log n) for any order of the facets. The tree is complete: node
!> i has the children 2 i and 2 i + 1.
module facet_search
  use growing_lists, only: append, make_room
  use kinds, only: rk
  implicit none
  private
  public :: box_tree, build_tree, find_boxes

  !> Most facets of a leaf.
  integer, parameter :: leaf_size = 4

  type :: box_tree
    integer :: num_leaves = 0 !< a power of two
    integer, allocatable :: order(:) !< facets, leaf by leaf
    integer, allocatable :: first(:), last(:) !< (tree nodes) their part of `order`
    real(rk), allocatable :: low(:, :), high(:, :) !< (3, tree nodes) [m]
    real(rk), allocatable :: box_low(:, :), box_high(:, :) !< (3, facets) [m]
  end type box_tree

contains

  !> Builds the tree over given boxes.
  pure subroutine build_tree(low, high, tree)
    real(rk), intent(in) :: low(:, :), high(:, :) !< (3, boxes) [m]
    type(box_tree), intent(out) :: tree
    real(rk), allocatable :: centre(:, :)
    integer :: i, num
    num = size(low, 2)
    tree%box_low = low
    tree%box_high = high
    centre = 0.5_rk*(low + high)
    tree%num_leaves = 1
    do while (tree%num_leaves*leaf_size < num)
      tree%num_leaves = 2*tree%num_leaves
    end do
    allocate (tree%first(2*tree%num_leaves - 1), tree%last(2*tree%num_leaves - 1))
    allocate (tree%low(3, 2*tree%num_leaves - 1), tree%high(3, 2*tree%num_leaves - 1))
    tree%order = [(i, i=1, num)]
    tree%first(1) = 1
    tree%last(1) = num
    do i = 1, 2*tree%num_leaves - 1
      call fill_node(tree, i, centre)
    end do
  end subroutine build_tree

  !> The box of a node, and the halves of a node that is no leaf.
  pure subroutine fill_node(tree, i, centre)
    type(box_tree), intent(inout) :: tree
    integer, intent(in) :: i !< tree node
    real(rk), intent(in) :: centre(:, :) !< (3, facets)
    integer :: first, last, middle, k
    first = tree%first(i)
    last = tree%last(i)
    tree%low(:, i) = huge(1.0_rk)
    tree%high(:, i) = -huge(1.0_rk)
    do k = first, last
      tree%low(:, i) = min(tree%low(:, i), tree%box_low(:, tree%order(k)))
      tree%high(:, i) = max(tree%high(:, i), tree%box_high(:, tree%order(k)))
    end do
    if (i >= tree%num_leaves) return
    middle = (first + last)/2
    if (last > first) then
      call split(centre(maxloc(tree%high(:, i) - tree%low(:, i), 1), :), middle - first + 1, &
                 tree%order(first:last))
    end if
    tree%first(2*i) = first
    tree%last(2*i) = middle
    tree%first(2*i + 1) = middle + 1
    tree%last(2*i + 1) = last
  end subroutine fill_node

  !> Orders a list so that its first `half` members have the smallest keys (quickselect).
  pure subroutine split(key, half, list)
    real(rk), intent(in) :: key(:) !< of all facets
    integer, intent(in) :: half
    integer, intent(inout) :: list(:)
    integer :: low, high, i, j, keep
    real(rk) :: pivot
    low = 1
    high = size(list)
    do while (low < high)
      pivot = middle_of(key(list(low)), key(list((low + high)/2)), key(list(high)))
      i = low
      j = high
      do while (i <= j)
        do while (key(list(i)) < pivot)
          i = i + 1
        end do
        do while (key(list(j)) > pivot)
          j = j - 1
        end do
        if (i <= j) then
          keep = list(i)
          list(i) = list(j)
          list(j) = keep
          i = i + 1
          j = j - 1
        end if
      end do
      if (half <= j) then
        high = j
      else if (half >= i) then
        low = i
      else
        return
      end if
    end do
  end subroutine split

  pure real(rk) function middle_of(a, b, c)
    real(rk), intent(in) :: a, b, c
    middle_of = max(min(a, b), min(max(a, b), c))
  end function middle_of

  !> The facets whose boxes meet a box.
  pure subroutine find_boxes(tree, low, high, num, found)
    type(box_tree), intent(in) :: tree
    real(rk), intent(in) :: low(3), high(3) !< [m]
    integer, intent(out) :: num !< how many
    integer, allocatable, intent(inout) :: found(:) !< (at least num); grows
    integer :: stack(64), depth, i, k
    num = 0
    call make_room(found, num, 0)
    depth = 1
    stack(1) = 1
    do while (depth > 0)
      i = stack(depth)
      depth = depth - 1
      if (any(tree%low(:, i) > high) .or. any(tree%high(:, i) < low)) cycle
      if (i < tree%num_leaves) then
        stack(depth + 1:depth + 2) = [2*i + 1, 2*i]
        depth = depth + 2
        cycle
      end if
      do k = tree%first(i), tree%last(i)
        if (any(tree%box_low(:, tree%order(k)) > high)) cycle
        if (any(tree%box_high(:, tree%order(k)) < low)) cycle
        call append(found, num, tree%order(k))
      end do
    end do
  end subroutine find_boxes
end module facet_search
