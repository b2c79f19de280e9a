!> The order of elimination: nested dissection on the graph of nodes, the unknowns of joints last.
!>
!> Consecutive unknowns that are coupled with the same others (those of one node) are one vertex,
!> weighted by their number. The last unknowns are the jumps and the dofs at points without jumps.
!> The end of the factor is the factor of the Schur complement onto these unknowns. Where they are
!> many, they are separators in groups instead.
module nested_dissection
  use errors, only: error_type, raise, system_failed
  use group_dissection, only: dissect_graph, dissect_groups, vertex_graph
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: dissect

contains

  !> Orders the free unknowns of a symmetric pattern: order(k) is eliminated as the k-th.
  subroutine dissect(matrix, order, error)
    type(pattern), intent(in) :: matrix
    integer, allocatable, intent(out) :: order(:) !< (num_free)
    type(error_type), allocatable, intent(out) :: error
    type(vertex_graph) :: graph
    integer, allocatable :: first(:), vertex_order(:)
    integer :: v, j, k, num_plain, status
    num_plain = matrix%num_free
    if (.not. allocated(matrix%group)) num_plain = num_plain - matrix%num_last
    call find_vertices(matrix, num_plain, first)
    call build_graph(matrix, first, graph%start, graph%neighbour)
    graph%weight = first(2:) - first(:size(first) - 1)
    allocate (vertex_order(size(graph%weight)))
    if (allocated(matrix%group)) then
      graph%group = matrix%group(first(:size(graph%weight)))
      call dissect_groups(graph, vertex_order, status)
    else
      call dissect_graph(graph, vertex_order, status)
    end if
    if (status /= 0) then
      call raise(error, 'METIS could not order the unknowns', system_failed)
      return
    end if
    allocate (order(matrix%num_free))
    k = 0
    do v = 1, size(vertex_order)
      do j = first(vertex_order(v)), first(vertex_order(v) + 1) - 1
        k = k + 1
        order(k) = j
      end do
    end do
    order(num_plain + 1:) = [(j, j=num_plain + 1, matrix%num_free)]
  end subroutine dissect

  !> First unknown of each vertex, and one entry after the last.
  pure subroutine find_vertices(matrix, num_plain, first)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: num_plain !< unknowns to order
    integer, allocatable, intent(out) :: first(:)
    integer :: j, num_vertices
    allocate (first(num_plain + 1))
    num_vertices = 0
    do j = 1, num_plain
      if (j > 1) then
        if (are_alike(matrix, j)) cycle
      end if
      num_vertices = num_vertices + 1
      first(num_vertices) = j
    end do
    first(num_vertices + 1) = num_plain + 1
    first = first(:num_vertices + 1)
  end subroutine find_vertices

  !> Whether column j holds the same rows below the diagonal as the column before.
  pure logical function are_alike(matrix, j)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: j !< > 1
    integer :: here, before, length
    here = matrix%column_start(j)
    before = matrix%column_start(j - 1)
    length = matrix%free_entries(j)
    are_alike = matrix%free_entries(j - 1) == length + 1
    if (are_alike .and. allocated(matrix%group)) are_alike = matrix%group(j) == matrix%group(j - 1)
    if (are_alike) then
      are_alike = all(matrix%row(before + 1:before + length) == matrix%row(here:here + length - 1))
    end if
  end function are_alike

  !> Both triangles of the graph of vertices, 0-based, without loops.
  subroutine build_graph(matrix, first, start, neighbour)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: first(:)
    integer, allocatable, intent(out) :: start(:), neighbour(:)
    integer, allocatable :: vertex(:), next(:)
    integer :: v, num_vertices, pass
    num_vertices = size(first) - 1
    allocate (vertex(first(num_vertices + 1) - 1), next(num_vertices), start(num_vertices + 1))
    do v = 1, num_vertices
      vertex(first(v):first(v + 1) - 1) = v
    end do
    next = 0
    do pass = 1, 2
      do v = 1, num_vertices
        call add_edges(v)
      end do
      if (pass == 2) exit
      start(1) = 0
      do v = 1, num_vertices
        start(v + 1) = start(v) + next(v)
      end do
      next(:) = start(:num_vertices)
      allocate (neighbour(start(num_vertices + 1)))
    end do
  contains
    !> The edges from a vertex to higher ones, in both directions; counted in the first pass.
    subroutine add_edges(v)
      integer, intent(in) :: v
      integer :: k, other, last
      last = v
      associate (begin => matrix%column_start(first(v)))
        do k = begin, begin + matrix%free_entries(first(v)) - 1
          if (matrix%row(k) > size(vertex)) exit
          other = vertex(matrix%row(k))
          if (other == last) cycle
          last = other
          next(v) = next(v) + 1
          next(other) = next(other) + 1
          if (pass == 1) cycle
          neighbour(next(v)) = other - 1
          neighbour(next(other)) = v - 1
        end do
      end associate
    end subroutine add_edges
  end subroutine build_graph
end module nested_dissection
