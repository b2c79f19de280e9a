!> Orders dependent dofs after those on which they depend.
module link_order
  use kinds, only: rk
  use errors, only: error_type, raise
  use dof_numbering, only: linear_links
  implicit none
  private
  public :: order_links

contains

  !> Orders the links so that each term is independent or stands earlier. Fails if a dof depends on
  !> itself, directly or through others, or depends on others twice.
  subroutine order_links(num_dofs, links, error)
    integer, intent(in) :: num_dofs
    type(linear_links), intent(inout) :: links
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: link(:), order(:)
    logical :: is_ordered
    call find_links(num_dofs, links, link, is_ordered, error)
    if (allocated(error) .or. is_ordered) return
    call sort(links, link, order, error)
    if (allocated(error)) return
    call rearrange(order, links)
  end subroutine order_links

  !> The link of each dof, 0 for none; and whether the links are in order already.
  subroutine find_links(num_dofs, links, link, is_ordered, error)
    integer, intent(in) :: num_dofs
    type(linear_links), intent(in) :: links
    integer, allocatable, intent(out) :: link(:) !< (dofs)
    logical, intent(out) :: is_ordered
    type(error_type), allocatable, intent(out) :: error
    integer :: k, t
    allocate (link(num_dofs), source=0)
    do k = 1, links%num_links
      if (link(links%dof(k)) > 0) then
        call raise(error, 'a degree of freedom depends on others twice')
        return
      end if
      link(links%dof(k)) = k
    end do
    is_ordered = .true.
    do k = 1, links%num_links
      do t = links%first(k), links%first(k + 1) - 1
        if (links%term(t) < 0) cycle
        if (link(links%term(t)) >= k) is_ordered = .false.
      end do
    end do
  end subroutine find_links

  !> Sorts depth first: a link is listed after all links on which it depends.
  subroutine sort(links, link, order, error)
    type(linear_links), intent(in) :: links
    integer, intent(in) :: link(:) !< (dofs)
    integer, allocatable, intent(out) :: order(:) !< (links)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: stack(:), next(:)
    logical, allocatable :: is_open(:), is_listed(:)
    integer :: k, top, other, num_listed
    allocate (order(links%num_links), stack(links%num_links), next(links%num_links))
    allocate (is_open(0:links%num_links), is_listed(0:links%num_links), source=.false.)
    num_listed = 0
    do k = 1, links%num_links
      if (is_listed(k)) cycle
      top = 0
      call push(k)
      do while (top > 0)
        call find_next(stack(top), other)
        if (is_open(other)) then
          call raise(error, 'degrees of freedom depend on each other in a circle')
          return
        else if (other > 0) then
          call push(other)
        else
          num_listed = num_listed + 1
          order(num_listed) = stack(top)
          is_listed(stack(top)) = .true.
          is_open(stack(top)) = .false.
          top = top - 1
        end if
      end do
    end do
  contains
    subroutine push(one)
      integer, intent(in) :: one
      top = top + 1
      stack(top) = one
      next(one) = links%first(one)
      is_open(one) = .true.
    end subroutine push

    !> The next link on which this one depends and that is not listed, 0 for none.
    subroutine find_next(one, needed)
      integer, intent(in) :: one
      integer, intent(out) :: needed
      integer :: t
      do t = next(one), links%first(one + 1) - 1
        if (links%term(t) < 0) cycle
        needed = link(links%term(t))
        if (needed == 0 .or. is_listed(needed)) cycle
        next(one) = t + 1
        return
      end do
      next(one) = links%first(one + 1)
      needed = 0
    end subroutine find_next
  end subroutine sort

  !> Reorders the links.
  subroutine rearrange(order, links)
    integer, intent(in) :: order(:)
    type(linear_links), intent(inout) :: links
    integer, allocatable :: dof(:), first(:), term(:)
    real(rk), allocatable :: coefficient(:)
    integer :: i, k, length
    dof = links%dof(order)
    allocate (first(size(order) + 1), term(links%num_terms), coefficient(links%num_terms))
    first(1) = 1
    do i = 1, size(order)
      k = links%first(order(i))
      length = links%first(order(i) + 1) - k
      first(i + 1) = first(i) + length
      term(first(i):first(i + 1) - 1) = links%term(k:k + length - 1)
      coefficient(first(i):first(i + 1) - 1) = links%coefficient(k:k + length - 1)
    end do
    call move_alloc(dof, links%dof)
    call move_alloc(first, links%first)
    call move_alloc(term, links%term)
    call move_alloc(coefficient, links%coefficient)
  end subroutine rearrange
end module link_order
