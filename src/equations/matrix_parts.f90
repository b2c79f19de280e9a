!> Parts of a symmetric matrix: the rows near some unknowns. What is outside does not move.
module matrix_parts
  use kinds, only: rk
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: neighbour_lists, list_neighbours, grow_part, take_part

  !> The other unknowns in the row of each free unknown.
  type :: neighbour_lists
    integer, allocatable :: start(:) !< (num_free + 1)
    integer, allocatable :: neighbour(:)
  end type neighbour_lists

contains

  !> Both triangles of the free part.
  pure subroutine list_neighbours(matrix, lists)
    type(pattern), intent(in) :: matrix !< symmetric
    type(neighbour_lists), intent(out) :: lists
    integer, allocatable :: next(:)
    integer :: i, j, k
    associate (n => matrix%num_free)
      allocate (next(n), source=0)
      allocate (lists%start(n + 1))
      do j = 1, n
        do k = matrix%column_start(j), matrix%column_start(j) + matrix%free_entries(j) - 1
          i = matrix%row(k)
          if (i == j) cycle
          next(i) = next(i) + 1
          next(j) = next(j) + 1
        end do
      end do
      lists%start(1) = 1
      do j = 1, n
        lists%start(j + 1) = lists%start(j) + next(j)
        next(j) = lists%start(j) - 1
      end do
      allocate (lists%neighbour(lists%start(n + 1) - 1))
      do j = 1, n
        do k = matrix%column_start(j), matrix%column_start(j) + matrix%free_entries(j) - 1
          i = matrix%row(k)
          if (i == j) cycle
          next(i) = next(i) + 1
          lists%neighbour(next(i)) = j
          next(j) = next(j) + 1
          lists%neighbour(next(j)) = i
        end do
      end do
    end associate
  end subroutine list_neighbours

  !> The unknowns within some layers of neighbours of the seed, ascending.
  subroutine grow_part(lists, seed, layers, unknown)
    type(neighbour_lists), intent(in) :: lists
    integer, intent(in) :: seed(:)
    integer, intent(in) :: layers
    integer, allocatable, intent(out) :: unknown(:)
    logical, allocatable :: is_inside(:)
    integer, allocatable :: list(:)
    integer :: first, last, layer, i, k
    allocate (is_inside(size(lists%start) - 1), source=.false.)
    allocate (list(size(is_inside)))
    last = 0
    do i = 1, size(seed)
      call take(seed(i))
    end do
    first = 1
    do layer = 1, layers
      k = last
      do i = first, k
        call take_all(lists%neighbour(lists%start(list(i)):lists%start(list(i) + 1) - 1))
      end do
      first = k + 1
    end do
    unknown = pack([(i, i=1, size(is_inside))], is_inside)
  contains
    !> Takes an unknown, once.
    subroutine take(one)
      integer, intent(in) :: one
      if (is_inside(one)) return
      is_inside(one) = .true.
      last = last + 1
      list(last) = one
    end subroutine take

    !> Takes some unknowns.
    subroutine take_all(some)
      integer, intent(in) :: some(:)
      integer :: m
      do m = 1, size(some)
        call take(some(m))
      end do
    end subroutine take_all
  end subroutine grow_part

  !> The matrix of some unknowns.
  pure subroutine take_part(matrix, values, unknown, part, part_values)
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), intent(in) :: values(:)
    integer, intent(in) :: unknown(:) !< ascending
    type(pattern), intent(out) :: part
    real(rk), allocatable, intent(out) :: part_values(:)
    integer, allocatable :: place(:)
    integer :: j, k, pass, used
    allocate (place(matrix%num_free), source=0)
    place(unknown) = [(j, j=1, size(unknown))]
    part%num_free = size(unknown)
    part%num_total = size(unknown)
    allocate (part%column_start(size(unknown) + 1), part%free_entries(size(unknown)))
    do pass = 1, 2
      used = 0
      do j = 1, size(unknown)
        part%column_start(j) = used + 1
        do k = matrix%column_start(unknown(j)), &
          matrix%column_start(unknown(j)) + matrix%free_entries(unknown(j)) - 1
          if (place(matrix%row(k)) == 0) cycle
          used = used + 1
          if (pass == 1) cycle
          part%row(used) = place(matrix%row(k))
          part_values(used) = values(k)
        end do
        part%free_entries(j) = used + 1 - part%column_start(j)
      end do
      part%column_start(size(unknown) + 1) = used + 1
      if (pass == 1) allocate (part%row(used), part_values(used))
    end do
  end subroutine take_part
end module matrix_parts
