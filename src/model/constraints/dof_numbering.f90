!> The numbering of unknowns: every dof is a combination of unknowns, u = T q.
!>
!> Most dofs are unknowns themselves. A dependent dof (the slave side of a joint or of a tie, the
!> first of an equation) is a combination of others and of jumps. Free unknowns come first,
!> prescribed ones after them. The last free unknowns are those of the joints: dofs at points
!> without a jump, then the jumps. Nodes without any element have unknowns only where
!> other dofs depend on them.
module dof_numbering
  use kinds, only: rk
  use errors, only: error_type, raise
  use node_dofs, only: dof_map
  use joint_rows, only: axis_of, jump_names
  implicit none
  private
  public :: numbering, linear_links, number_unknowns

  !> Dependent dofs: dof(k) = sum of coefficient*term, dofs as in `dof_map`. A term may itself be
  !> dependent only if its link stands earlier in the list.
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
    integer :: num_last = 0 !< free unknowns of joints, jumps included
    integer :: num_jumps = 0 !< the last of these
    type(dof_map) :: dofs !< rows of T
    integer, allocatable :: row_start(:) !< (dofs + 1) first entry of each row of T
    integer, allocatable :: node_start(:) !< (nodes + 1) first entry of the rows of each node
    integer, allocatable :: unknown(:) !< columns of T
    real(rk), allocatable :: coefficient(:) !< values of T
    integer, allocatable :: node(:) !< (num_total) node of each unknown
    integer, allocatable :: direction(:) !< (num_total) component of the node; of a jump: n, s1, s2
    integer, allocatable :: first_jump(:) !< (points) first unknown of a point's jump, 0 for none
  contains
    procedure :: expand, add_expanded, expand_prescribed, restrict
    procedure :: reduce, add_reduced, unknown_of, places_in, describe
  end type numbering

contains

  !> Numbers the unknowns of a mesh. Fails when a dof is both fixed and dependent.
  subroutine number_unknowns(dofs, is_used, is_fixed, links, numbers, error)
    type(dof_map), intent(in) :: dofs
    logical, intent(in) :: is_used(:) !< (nodes) belongs to an element
    logical, intent(in) :: is_fixed(:, :) !< (components, nodes) prescribed
    type(linear_links), intent(in) :: links !< dependent dofs
    type(numbering), intent(out) :: numbers
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: own(:), link(:)
    numbers%dofs = dofs
    call find_links(dofs, is_fixed, links, link, error)
    if (allocated(error)) return
    call number_own(is_used, is_fixed, link, links, numbers, own)
    call resolve_rows(links, own, link, numbers, error)
  end subroutine number_unknowns

  !> The link of each dof, 0 for none.
  subroutine find_links(dofs, is_fixed, links, link, error)
    type(dof_map), intent(in) :: dofs
    logical, intent(in) :: is_fixed(:, :)
    type(linear_links), intent(in) :: links
    integer, allocatable, intent(out) :: link(:) !< (dofs)
    type(error_type), allocatable, intent(out) :: error
    integer :: k
    allocate (link(dofs%num_dofs))
    link = 0
    do k = 1, links%num_links
      if (is_fixed(dofs%component_of(links%dof(k)), dofs%node(links%dof(k)))) then
        call raise(error, 'a degree of freedom is both fixed and dependent on others')
        return
      end if
      link(links%dof(k)) = k
    end do
  end subroutine find_links

  !> Numbers the independent dofs and the jumps.
  subroutine number_own(is_used, is_fixed, link, links, numbers, own)
    logical, intent(in) :: is_used(:), is_fixed(:, :)
    integer, intent(in) :: link(:)
    type(linear_links), intent(in) :: links
    type(numbering), intent(inout) :: numbers
    integer, allocatable, intent(out) :: own(:) !< (dofs) unknown of each dof, 0 for none
    logical, allocatable :: is_last(:), is_held(:), is_there(:)
    integer :: k, first, first_last
    allocate (own(size(link)), numbers%node(size(link) + links%num_jumps))
    allocate (numbers%direction(size(link) + links%num_jumps))
    own = 0
    numbers%num_nodes = size(is_used)
    numbers%num_jumps = links%num_jumps
    call find_last(numbers%dofs, links, is_last)
    allocate (is_held(size(link)))
    do k = 1, size(link)
      is_held(k) = is_fixed(numbers%dofs%component_of(k), numbers%dofs%node(k))
    end do
    is_there = is_used(numbers%dofs%node)
    do k = 1, links%num_terms
      if (links%term(k) > 0) is_there(links%term(k)) = .true.
    end do
    call number_where(is_there,.not. (is_held .or. is_last), link, numbers, own)
    first_last = numbers%num_total
    call number_where(is_there, is_last .and. .not. is_held, link, numbers, own)
    first = numbers%num_total
    do k = 1, links%num_jumps
      numbers%node(first + k) = links%jump_node(k)
      numbers%direction(first + k) = axis_of(k)
    end do
    numbers%num_total = first + links%num_jumps
    numbers%num_free = numbers%num_total
    numbers%num_last = numbers%num_free - first_last
    numbers%first_jump = [integer ::]
    if (allocated(links%first_jump)) then
      numbers%first_jump = merge(links%first_jump + first, 0, links%first_jump > 0)
    end if
    call number_where(is_there, is_held, link, numbers, own)
    numbers%node = numbers%node(:numbers%num_total)
    numbers%direction = numbers%direction(:numbers%num_total)
  end subroutine number_own

  !> Marks the dofs numbered last: those of the marked nodes, or the dofs that these follow.
  pure subroutine find_last(dofs, links, is_last)
    type(dof_map), intent(in) :: dofs
    type(linear_links), intent(in) :: links
    logical, allocatable, intent(out) :: is_last(:) !< (dofs)
    integer :: k, t
    allocate (is_last(dofs%num_dofs), source=.false.)
    if (.not. allocated(links%is_last)) return
    is_last = links%is_last(dofs%node)
    do k = links%num_links, 1, -1
      if (.not. is_last(links%dof(k))) cycle
      do t = links%first(k), links%first(k + 1) - 1
        if (links%term(t) > 0) is_last(links%term(t)) = .true.
      end do
    end do
  end subroutine find_last

  !> Numbers the independent dofs that are there, where `wanted` holds, node by node.
  pure subroutine number_where(is_there, wanted, link, numbers, own)
    logical, intent(in) :: is_there(:) !< (dofs)
    logical, intent(in) :: wanted(:) !< (dofs)
    integer, intent(in) :: link(:)
    type(numbering), intent(inout) :: numbers
    integer, intent(inout) :: own(:)
    integer :: dof
    do dof = 1, size(wanted)
      if (.not. (is_there(dof) .and. wanted(dof)) .or. link(dof) > 0) cycle
      numbers%num_total = numbers%num_total + 1
      numbers%node(numbers%num_total) = numbers%dofs%node(dof)
      numbers%direction(numbers%num_total) = numbers%dofs%component_of(dof)
      own(dof) = numbers%num_total
    end do
  end subroutine number_where

  !> Fills the rows of T: links first, in their order, so that chains of links are resolved.
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
    numbers%node_start = numbers%row_start(numbers%dofs%first)
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

  !> Expresses every link in unknowns. Fails if a term has no unknown.
  subroutine resolve_links(links, own, link, before_jumps, start, unknown, coefficient, error)
    type(linear_links), intent(in) :: links
    integer, intent(in) :: own(:), link(:)
    integer, intent(in) :: before_jumps !< number of unknowns before the first jump
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
    !> Adds a term to the current row, whose end is start(k + 1).
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

  !> u = T q. A field has the first components of each node: 3 rows hold the displacements, a fourth
  !> row holds the fourth component, zero at nodes without it.
  pure subroutine expand(self, q, u)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(out) :: u(:, :) !< (components, nodes)
    u = 0.0_rk
    call self%add_expanded(q, u)
  end subroutine expand

  !> u = u + T q.
  pure subroutine add_expanded(self, q, u)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(inout) :: u(:, :) !< (components, nodes)
    integer :: node, i, k, dof
    do node = 1, self%num_nodes
      do i = 1, min(size(u, 1), self%dofs%first(node + 1) - self%dofs%first(node))
        dof = self%dofs%first(node) + i - 1
        do k = self%row_start(dof), self%row_start(dof + 1) - 1
          u(i, node) = u(i, node) + self%coefficient(k)*q(self%unknown(k))
        end do
      end do
    end do
  end subroutine add_expanded

  !> The entries of prescribed unknowns as a field, zero elsewhere: reactions from forces.
  pure subroutine expand_prescribed(self, r, u)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: r(self%num_free + 1:) !< (prescribed unknowns)
    real(rk), intent(out) :: u(:, :) !< (components, nodes)
    integer :: k
    u = 0.0_rk
    do k = self%num_free + 1, self%num_total
      if (self%direction(k) <= size(u, 1)) u(self%direction(k), self%node(k)) = r(k)
    end do
  end subroutine expand_prescribed

  !> The unknowns of a field, the inverse of `expand` except for jumps, which become zero because a
  !> field does not hold them.
  pure subroutine restrict(self, u, q)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: u(:, :) !< (components, nodes)
    real(rk), intent(out) :: q(:) !< (num_total) zero for components not in the field
    integer :: k
    do k = 1, self%num_total
      q(k) = 0.0_rk
      if (.not. is_jump(self, k) .and. self%direction(k) <= size(u, 1)) then
        q(k) = u(self%direction(k), self%node(k))
      end if
    end do
  end subroutine restrict

  !> r = T^T f.
  pure subroutine reduce(self, f, r)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: f(:, :) !< (components, nodes)
    real(rk), intent(out) :: r(:) !< (num_total)
    r = 0.0_rk
    call self%add_reduced(f, r)
  end subroutine reduce

  !> r = r + T^T f.
  pure subroutine add_reduced(self, f, r)
    class(numbering), intent(in) :: self
    real(rk), intent(in) :: f(:, :) !< (components, nodes)
    real(rk), intent(inout) :: r(:) !< (num_total)
    integer :: node, i, k, dof
    do node = 1, self%num_nodes
      do i = 1, min(size(f, 1), self%dofs%first(node + 1) - self%dofs%first(node))
        dof = self%dofs%first(node) + i - 1
        do k = self%row_start(dof), self%row_start(dof + 1) - 1
          r(self%unknown(k)) = r(self%unknown(k)) + self%coefficient(k)*f(i, node)
        end do
      end do
    end do
  end subroutine add_reduced

  !> The unknown of a component of a node, 0 if the node belongs to no element or the component
  !> depends on others.
  pure integer function unknown_of(self, node, component) result(unknown)
    class(numbering), intent(in) :: self
    integer, intent(in) :: node, component
    integer :: first, next
    first = self%row_start(self%dofs%dof_of(node, component))
    next = self%row_start(self%dofs%dof_of(node, component) + 1)
    unknown = 0
    if (next /= first + 1) return
    if (self%node(self%unknown(first)) == node .and. .not. is_jump(self, self%unknown(first)) &
        .and. self%direction(self%unknown(first)) == component) unknown = self%unknown(first)
  end function unknown_of

  !> The unknown of another numbering of the same model for each own one, 0 for none.
  pure function places_in(self, other) result(place)
    class(numbering), intent(in) :: self
    type(numbering), intent(in) :: other
    integer :: place(self%num_total)
    integer :: k, p
    place = 0
    do p = 1, size(self%first_jump)
      if (min(self%first_jump(p), other%first_jump(p)) == 0) cycle
      place(self%first_jump(p):self%first_jump(p) + 2) = [(other%first_jump(p) + k, k=0, 2)]
    end do
    do k = 1, self%num_total
      if (place(k) == 0) place(k) = other%unknown_of(self%node(k), self%direction(k))
    end do
  end function places_in

  pure logical function is_jump(numbers, unknown)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: unknown
    is_jump = unknown > numbers%num_free - numbers%num_jumps .and. unknown <= numbers%num_free
  end function is_jump

  !> An unknown as text for the user: 'node 12, displacement along z', 'joint slip 1 at node 12'.
  pure function describe(self, unknown, node_id) result(text)
    class(numbering), intent(in) :: self
    integer, intent(in) :: unknown
    integer, intent(in) :: node_id(:) !< (nodes) the user's numbers
    character(:), allocatable :: text
    character(40) :: numbers
    if (is_jump(self, unknown)) then
      write (numbers, '(a,i0)') ' at node ', node_id(self%node(unknown))
      text = trim(jump_names(self%direction(unknown)))//trim(numbers)
    else
      write (numbers, '(a,i0,a)') 'node ', node_id(self%node(unknown)), ', '
      text = trim(numbers)//' '//trim(self%dofs%components(self%direction(unknown))%name)
    end if
  end function describe
end module dof_numbering
