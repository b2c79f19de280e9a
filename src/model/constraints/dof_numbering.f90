!> The numbering of unknowns: every physical dof is a combination of unknowns, u = T q.
!>
!> Most dofs have an unknown of their own. A dependent dof (the slave side of a joint or of a tie,
!> later equations) is written through others and through jumps. Free unknowns come first,
!> prescribed ones after them. Last among the free are what the joints work in: dofs that points
!> without a jump see, then the jumps. Nodes without any element have no unknowns.
module dof_numbering
  use kinds, only: rk
  use errors, only: error_type, raise
  implicit none
  private
  public :: numbering, linear_links, number_unknowns

  !> Dependent dofs: dof(k) = sum of coefficient*term. A dof is 3*(node - 1) + direction. A term may
  !> depend on others only if their link stands earlier in the list.
  type :: linear_links
    integer :: num_links = 0, num_terms = 0
    integer, allocatable :: dof(:) !< (links) the dependent dof
    integer, allocatable :: first(:) !< (links + 1) first term of each link
    integer, allocatable :: term(:) !< a dof, or -k for jump unknown k
    real(rk), allocatable :: coefficient(:)
    integer :: num_jumps = 0 !< jump unknowns, three for each point that has them
    integer, allocatable :: first_jump(:) !< (points) first jump unknown of a point, 0 for none
    integer, allocatable :: jump_node(:) !< (jumps) the node that the jump separates from the rest
    logical, allocatable :: is_last(:) !< (nodes) ordered with the jumps; not allocated: none
  end type linear_links

  type :: numbering
    integer :: num_nodes = 0
    integer :: num_free = 0, num_total = 0 !< unknowns: free; free and prescribed
    integer :: num_last = 0 !< of the free ones: all that joints work in, jumps included
    integer :: num_jumps = 0 !< the last of these
    integer, allocatable :: row_start(:) !< (3*num_nodes + 1) rows of T: 3*(node - 1) + direction
    integer, allocatable :: unknown(:) !< columns of T
    real(rk), allocatable :: coefficient(:) !< values of T
    integer, allocatable :: node(:) !< (num_total) node of each unknown
    integer, allocatable :: direction(:) !< (num_total) 1..3: x, y, z; of a jump: n, s1, s2
    integer, allocatable :: first_jump(:) !< (points) first unknown of a point's jump, 0 for none
  contains
    procedure :: expand, add_expanded, reduce, add_reduced, describe
  end type numbering

contains

  !> Numbers the unknowns of a mesh. Fails when a dof is both fixed and dependent.
  subroutine number_unknowns(is_used, is_fixed, links, numbers, error)
    logical, intent(in) :: is_used(:) !< (nodes) belongs to an element
    logical, intent(in) :: is_fixed(:, :) !< (3, nodes) prescribed
    type(linear_links), intent(in) :: links !< dependent dofs
    type(numbering), intent(out) :: numbers
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: own(:), link(:)
    call find_links(is_fixed, links, link, error)
    if (allocated(error)) return
    call number_own(is_used, is_fixed, link, links, numbers, own)
    call resolve_rows(links, own, link, numbers, error)
  end subroutine number_unknowns

  !> The link that gives each dof, 0 for none.
  subroutine find_links(is_fixed, links, link, error)
    logical, intent(in) :: is_fixed(:, :)
    type(linear_links), intent(in) :: links
    integer, allocatable, intent(out) :: link(:) !< (3*nodes)
    type(error_type), allocatable, intent(out) :: error
    integer :: k, node, direction
    allocate (link(size(is_fixed)))
    link = 0
    do k = 1, links%num_links
      node = (links%dof(k) + 2)/3
      direction = links%dof(k) - 3*(node - 1)
      if (is_fixed(direction, node)) then
        call raise(error, 'a degree of freedom is both fixed and dependent on others')
        return
      end if
      link(links%dof(k)) = k
    end do
  end subroutine find_links

  !> Gives numbers to the dofs that have an unknown of their own, and to the jumps.
  subroutine number_own(is_used, is_fixed, link, links, numbers, own)
    logical, intent(in) :: is_used(:), is_fixed(:, :)
    integer, intent(in) :: link(:)
    type(linear_links), intent(in) :: links
    type(numbering), intent(inout) :: numbers
    integer, allocatable, intent(out) :: own(:) !< (3*nodes) unknown of each dof, 0 for none
    logical, allocatable :: is_last(:, :)
    integer :: k, first, first_last
    allocate (own(size(link)), numbers%node(size(link) + links%num_jumps))
    allocate (numbers%direction(size(link) + links%num_jumps))
    own = 0
    numbers%num_nodes = size(is_used)
    numbers%num_jumps = links%num_jumps
    call find_last(links, size(is_used), is_last)
    call number_where(is_used,.not. (is_fixed .or. is_last), link, numbers, own)
    first_last = numbers%num_total
    call number_where(is_used, is_last .and. .not. is_fixed, link, numbers, own)
    first = numbers%num_total
    do k = 1, links%num_jumps
      numbers%node(first + k) = links%jump_node(k)
      numbers%direction(first + k) = 1 + mod(k - 1, 3)
    end do
    numbers%num_total = first + links%num_jumps
    numbers%num_free = numbers%num_total
    numbers%num_last = numbers%num_free - first_last
    numbers%first_jump = [integer ::]
    if (allocated(links%first_jump)) then
      numbers%first_jump = merge(links%first_jump + first, 0, links%first_jump > 0)
    end if
    call number_where(is_used, is_fixed, link, numbers, own)
    numbers%node = numbers%node(:numbers%num_total)
    numbers%direction = numbers%direction(:numbers%num_total)
  end subroutine number_own

  !> The dofs that stand last: of nodes so marked, or what these follow.
  pure subroutine find_last(links, num_nodes, is_last)
    type(linear_links), intent(in) :: links
    integer, intent(in) :: num_nodes
    logical, allocatable, intent(out) :: is_last(:, :) !< (3, nodes)
    integer :: k, t
    allocate (is_last(3, num_nodes), source=.false.)
    if (.not. allocated(links%is_last)) return
    is_last = spread(links%is_last, 1, 3)
    do k = links%num_links, 1, -1
      if (.not. is_last(1 + mod(links%dof(k) - 1, 3), (links%dof(k) + 2)/3)) cycle
      do t = links%first(k), links%first(k + 1) - 1
        associate (term => links%term(t))
          if (term > 0) is_last(1 + mod(term - 1, 3), (term + 2)/3) = .true.
        end associate
      end do
    end do
  end subroutine find_last

  !> Numbers the independent dofs of used nodes where `wanted` holds, node by node.
  pure subroutine number_where(is_used, wanted, link, numbers, own)
    logical, intent(in) :: is_used(:), wanted(:, :)
    integer, intent(in) :: link(:)
    type(numbering), intent(inout) :: numbers
    integer, intent(inout) :: own(:)
    integer :: node, i, dof
    do node = 1, size(is_used)
      if (.not. is_used(node)) cycle
      do i = 1, 3
        dof = 3*(node - 1) + i
        if (.not. wanted(i, node) .or. link(dof) > 0) cycle
        numbers%num_total = numbers%num_total + 1
        numbers%node(numbers%num_total) = node
        numbers%direction(numbers%num_total) = i
        own(dof) = numbers%num_total
      end do
    end do
  end subroutine number_where

  !> Fills the rows of T: links first, in their order, so that chains resolve to the root.
  subroutine resolve_rows(links, own, link, numbers, error)
    type(linear_links), intent(in) :: links
    integer, intent(in) :: own(:), link(:)
    type(numbering), intent(inout) :: numbers
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: start(:), unknown(:)
    real(rk), allocatable :: coefficient(:)
    integer :: dof, k, length
    call resolve_links(links, own, link, numbers%num_free - links%num_jumps, start, unknown, &
                       coefficient, error)
    if (allocated(error)) return
    allocate (numbers%row_start(size(own) + 1))
    numbers%row_start(1) = 1
    do dof = 1, size(own)
      length = merge(1, 0, own(dof) > 0)
      if (link(dof) > 0) length = start(link(dof) + 1) - start(link(dof))
      numbers%row_start(dof + 1) = numbers%row_start(dof) + length
    end do
    allocate (numbers%unknown(numbers%row_start(size(own) + 1) - 1))
    allocate (numbers%coefficient(size(numbers%unknown)))
    do dof = 1, size(own)
      k = numbers%row_start(dof)
      length = numbers%row_start(dof + 1) - k
      if (link(dof) > 0) then
        numbers%unknown(k:k + length - 1) = unknown(start(link(dof)):start(link(dof) + 1) - 1)
        numbers%coefficient(k:k + length - 1) = &
          coefficient(start(link(dof)):start(link(dof) + 1) - 1)
      else if (own(dof) > 0) then
        numbers%unknown(k) = own(dof)
        numbers%coefficient(k) = 1.0_rk
      end if
    end do
  end subroutine resolve_rows

  !> Writes every link through unknowns. Fails when a term has no unknown.
  subroutine resolve_links(links, own, link, before_jumps, start, unknown, coefficient, error)
    type(linear_links), intent(in) :: links
    integer, intent(in) :: own(:), link(:)
    integer, intent(in) :: before_jumps !< unknowns in front of the first jump
    integer, allocatable, intent(out) :: start(:), unknown(:)
    real(rk), allocatable, intent(out) :: coefficient(:)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: place(:)
    integer :: k, t, term, s
    allocate (start(links%num_links + 1), unknown(4*links%num_terms))
    allocate (coefficient(4*links%num_terms))
    allocate (place(before_jumps + links%num_jumps + count(own > before_jumps)), source=0)
    start = 1
    do k = 1, links%num_links
      start(k + 1) = start(k)
      do t = links%first(k), links%first(k + 1) - 1
        term = links%term(t)
        if (term < 0) then
          call add_term(before_jumps - term, links%coefficient(t))
        else if (own(term) > 0) then
          call add_term(own(term), links%coefficient(t))
        else if (link(term) > 0 .and. link(term) < k) then
          do s = start(link(term)), start(link(term) + 1) - 1
            call add_term(unknown(s), links%coefficient(t)*coefficient(s))
          end do
        else
          call raise(error, 'a degree of freedom depends on a node without elements')
          return
        end if
      end do
      place(unknown(start(k):start(k + 1) - 1)) = 0
    end do
  contains
    !> Adds to the row under way, whose end is start(k + 1).
    subroutine add_term(column, value)
      integer, intent(in) :: column
      real(rk), intent(in) :: value
      if (abs(value) < tiny(1.0_rk)) return
      if (place(column) > 0) then
        coefficient(place(column)) = coefficient(place(column)) + value
        return
      end if
      if (start(k + 1) > size(unknown)) then
        unknown = [unknown, unknown]
        coefficient = [coefficient, coefficient]
      end if
      unknown(start(k + 1)) = column
      coefficient(start(k + 1)) = value
      place(column) = start(k + 1)
      start(k + 1) = start(k + 1) + 1
    end subroutine add_term
  end subroutine resolve_links

  !> u = T q.
  pure subroutine expand(self, q, u)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(out) :: u(:, :) !< (3, nodes)
    u = 0.0_rk
    call self%add_expanded(q, u)
  end subroutine expand

  !> u = u + T q.
  pure subroutine add_expanded(self, q, u)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(inout) :: u(:, :) !< (3, nodes)
    integer :: node, i, k
    do node = 1, self%num_nodes
      do i = 1, 3
        do k = self%row_start(3*node - 3 + i), self%row_start(3*node - 2 + i) - 1
          u(i, node) = u(i, node) + self%coefficient(k)*q(self%unknown(k))
        end do
      end do
    end do
  end subroutine add_expanded

  !> r = T^T f.
  pure subroutine reduce(self, f, r)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: f(:, :) !< (3, nodes)
    real(rk), intent(out) :: r(:) !< (num_total)
    r = 0.0_rk
    call self%add_reduced(f, r)
  end subroutine reduce

  !> r = r + T^T f.
  pure subroutine add_reduced(self, f, r)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: f(:, :) !< (3, nodes)
    real(rk), intent(inout) :: r(:) !< (num_total)
    integer :: node, i, k
    do node = 1, self%num_nodes
      do i = 1, 3
        do k = self%row_start(3*node - 3 + i), self%row_start(3*node - 2 + i) - 1
          r(self%unknown(k)) = r(self%unknown(k)) + self%coefficient(k)*f(i, node)
        end do
      end do
    end do
  end subroutine add_reduced

  !> An unknown in the user's words: 'node 12, direction 3' or 'joint slip 1 at node 12'.
  pure function describe(self, unknown, node_id) result(text)
    class(numbering), intent(in) :: self
    integer, intent(in) :: unknown
    integer, intent(in) :: node_id(:) !< (nodes) the user's numbers
    character(:), allocatable :: text
    character(13), parameter :: jumps(3) = ['joint opening', 'joint slip 1 ', 'joint slip 2 ']
    character(40) :: numbers
    if (unknown > self%num_free - self%num_jumps .and. unknown <= self%num_free) then
      write (numbers, '(a,i0)') ' at node ', node_id(self%node(unknown))
      text = trim(jumps(self%direction(unknown)))//trim(numbers)
    else
      write (numbers, '(a,i0,a,i0)') 'node ', node_id(self%node(unknown)), ', direction ', &
        self%direction(unknown)
      text = trim(numbers)
    end if
  end function describe
end module dof_numbering
