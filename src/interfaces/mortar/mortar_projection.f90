!> The mortar projection of one face onto the nodes of another whose mesh differs
!> (different_meshes.md, 13.2).
!>
!> Row a belongs to node a of the slave face. Its displacement relative to the master face is
!>   u(node(a)) - sum_k weight(k) u(item(k)),   k = first(a) .. first(a + 1) - 1,
!> weights (1/A_a) int phi_a N_m dA with the dual functions phi of mortar_facet and the area
!> A_a = int N_a dA.
!> The weights add up to 1, and a linear field is exact if the faces coincide.
module mortar_projection
  use joint_points, only: share_a_plane
  use kinds, only: rk
  use mortar_balance, only: balance_weights, mortar_rows
  use mortar_facet, only: facet_extent, facet_part, integrate_facet, share_bound
  use row_tables, only: group_by_key, row_table
  use segment_quadrature, only: segment_points
  use surface_segments, only: facet_set, segment_set
  implicit none
  private
  public :: mortar_rows, project

  !> Faces coincide, up to the rounding of a mesher, if their distance is below this fraction of a
  !> facet. Between other faces no weights transmit a constant stress exactly.
  real(rk), parameter :: touching = 1.0e-6_rk

  !> Weights below this are round-off of the orthogonality of phi and N; the largest weight of the
  !> row takes their sum.
  real(rk), parameter :: no_weight = 1.0e-13_rk

  !> Rows during assembly.
  type :: gathering
    integer :: num_rows = 0
    integer, allocatable :: newest(:) !< (nodes) last row of each node, 0 for none
    integer, allocatable :: next(:) !< (rows) the previous row of the same node
    integer :: num_terms = 0
    integer, allocatable :: row(:), node(:) !< (terms)
    real(rk), allocatable :: value(:) !< (terms) [m2]
    real(rk), allocatable :: target_force(:, :) !< (3, nodes) of a unit pressure [m2]
  end type gathering

contains

  !> Makes the rows. A slave node without cover has no row. A node whose facets' normals differ by
  !> more than 30 degrees has a row for each plane, unless planes are merged (ties: one per node).
  !>
  !> Bound slave nodes have no row: on each facet their dual functions are added to those of the
  !> other nodes (Wohlmuth's modification), whose rows then hold weights of the bound nodes.
  subroutine project(x, slave, master, segments, is_bound, rows, merges_planes)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    type(segment_set), intent(in) :: segments
    logical, intent(in) :: is_bound(:) !< (nodes) slave nodes without multiplier
    type(mortar_rows), intent(out) :: rows
    logical, intent(in), optional :: merges_planes !< default: not
    type(gathering) :: gathered
    type(facet_part) :: part
    type(segment_points) :: points
    type(row_table) :: segments_of_facet
    integer, allocatable :: own(:), partners(:, :)
    logical :: splits
    integer :: f
    splits = .true.
    if (present(merges_planes)) splits = .not. merges_planes
    call group_by_key(segments%slave(:segments%num_segments), size(slave%node, 2), &
                      segments_of_facet)
    call open_rows(size(x, 2), size(slave%node, 2), segments%num_segments, rows, gathered)
    do f = 1, size(slave%node, 2)
      own = segments_of_facet%row(f)
      if (size(own) == 0) cycle
      call integrate_facet(x, slave, master, segments, own, points, part)
      if (part%is_bare) cycle
      rows%is_bare(f) = .false.
      partners = master%node(:, segments%master(own))
      call add_facet(part, partners, is_bound, splits, &
                     smallest_extent(x, slave%node(:, f), partners), rows, gathered)
    end do
    call close_rows(gathered, rows)
    if (all(abs(rows%gap) <= touching*rows%facet_size)) then
      call balance_weights(x, gathered%target_force, maxval(abs(rows%gap)/rows%facet_size), rows)
    end if
  end subroutine project

  !> Allocates the largest possible number of rows and terms.
  subroutine open_rows(num_nodes, num_facets, num_segments, rows, gathered)
    integer, intent(in) :: num_nodes, num_facets, num_segments
    type(mortar_rows), intent(inout) :: rows
    type(gathering), intent(out) :: gathered
    integer :: most_terms
    most_terms = 16*num_segments + 4*num_facets
    allocate (gathered%newest(num_nodes), gathered%next(4*num_facets), source=0)
    allocate (gathered%row(most_terms), gathered%node(most_terms), gathered%value(most_terms))
    allocate (rows%node(4*num_facets), rows%area(4*num_facets), rows%normal(3, 4*num_facets))
    allocate (gathered%target_force(3, num_nodes), source=0.0_rk)
    allocate (rows%gap(4*num_facets), rows%facet_size(4*num_facets))
    allocate (rows%is_bare(num_facets), source=.true.)
  end subroutine open_rows

  !> Adds the integrals of one facet to the rows of its free corners.
  subroutine add_facet(part, masters, is_bound, splits, extent, rows, gathered)
    type(facet_part), intent(in) :: part
    integer, intent(in) :: masters(:, :) !< (4, segments) nodes
    logical, intent(in) :: is_bound(:) !< (nodes)
    logical, intent(in) :: splits !< planes have rows of their own
    real(rk), intent(in) :: extent !< of the smallest facet here [m]
    type(mortar_rows), intent(inout) :: rows
    type(gathering), intent(inout) :: gathered
    real(rk) :: share(4, 4)
    logical :: corner_is_bound(4)
    integer :: a, b, n, row, s, m
    n = part%num_corners
    corner_is_bound = .true.
    corner_is_bound(:n) = is_bound(part%node(:n))
    call share_bound(part, corner_is_bound, share)
    if (all(corner_is_bound)) return
    call add_pressed(part, masters, corner_is_bound, gathered%target_force)
    do a = 1, n
      if (corner_is_bound(a)) cycle
      share(a, a) = 1.0_rk
      call find_row(part%node(a), part%normal(:, a), splits, rows, gathered, row)
      rows%area(row) = rows%area(row) + part%diagonal(a)
      rows%normal(:, row) = rows%normal(:, row) + part%normal(:, a)
      rows%gap(row) = rows%gap(row) + dot_product(share(a, :), part%gap)
      rows%facet_size(row) = min(rows%facet_size(row), extent)
      do s = 1, size(part%coupling, 3)
        do m = 1, 4
          call add_term(row, masters(m, s), dot_product(share(a, :), part%coupling(:, m, s)))
        end do
      end do
      do b = 1, n
        if (corner_is_bound(b)) call add_term(row, part%node(b), -share(a, b)*part%diagonal(b))
      end do
    end do
  contains
    !> Adds a term to a row; terms of one node are summed at the end.
    subroutine add_term(at, node, value)
      integer, intent(in) :: at, node
      real(rk), intent(in) :: value !< [m2]
      if (.not. abs(value) > 0.0_rk) return
      gathered%num_terms = gathered%num_terms + 1
      gathered%row(gathered%num_terms) = at
      gathered%node(gathered%num_terms) = node
      gathered%value(gathered%num_terms) = value
    end subroutine add_term
  end subroutine add_facet

  !> Adds the forces of a unit pressure at the master nodes and, with opposite sign, at the bound
  !> slave nodes.
  pure subroutine add_pressed(part, masters, corner_is_bound, force)
    type(facet_part), intent(in) :: part
    integer, intent(in) :: masters(:, :) !< (4, segments) nodes
    logical, intent(in) :: corner_is_bound(4)
    real(rk), intent(inout) :: force(:, :) !< (3, nodes) [m2]
    integer :: s, m, b
    do s = 1, size(masters, 2)
      do m = 1, 4
        force(:, masters(m, s)) = force(:, masters(m, s)) + part%pressed(:, m, s)
      end do
    end do
    do b = 1, part%num_corners
      if (corner_is_bound(b)) force(:, part%node(b)) = force(:, part%node(b)) - part%normal(:, b)
    end do
  end subroutine add_pressed

  !> The row of a node in the plane of a normal; a missing row is added.
  subroutine find_row(node, normal, splits, rows, gathered, row)
    integer, intent(in) :: node
    real(rk), intent(in) :: normal(3) !< of any length
    logical, intent(in) :: splits
    type(mortar_rows), intent(inout) :: rows
    type(gathering), intent(inout) :: gathered
    integer, intent(out) :: row
    row = gathered%newest(node)
    do while (row > 0)
      if (.not. splits) return
      if (share_a_plane(rows%normal(:, row), normal)) return
      row = gathered%next(row)
    end do
    gathered%num_rows = gathered%num_rows + 1
    row = gathered%num_rows
    gathered%next(row) = gathered%newest(node)
    gathered%newest(node) = row
    rows%node(row) = node
    rows%area(row) = 0.0_rk
    rows%normal(:, row) = 0.0_rk
    rows%gap(row) = 0.0_rk
    rows%facet_size(row) = huge(1.0_rk)
  end subroutine find_row

  !> Cuts the rows to size, divides them by their areas and adds up terms of one node.
  subroutine close_rows(gathered, rows)
    type(gathering), intent(inout) :: gathered
    type(mortar_rows), intent(inout) :: rows
    type(row_table) :: terms
    integer, allocatable :: at(:)
    integer :: n, a, i, k, used, node
    n = gathered%num_rows
    rows%node = rows%node(:n)
    rows%area = rows%area(:n)
    rows%gap = rows%gap(:n)/rows%area
    rows%facet_size = rows%facet_size(:n)
    rows%pressed = rows%normal(:, :n)
    rows%normal = rows%normal(:, :n)/spread(norm2(rows%normal(:, :n), dim=1), 1, 3)
    call group_by_key(gathered%row(:gathered%num_terms), n, terms)
    allocate (rows%first(n + 1), rows%item(gathered%num_terms), rows%weight(gathered%num_terms))
    allocate (at(size(gathered%newest)), source=0)
    used = 0
    rows%first(1) = 1
    do a = 1, n
      do i = terms%first(a), terms%first(a + 1) - 1
        node = gathered%node(terms%item(i))
        k = at(node)
        if (k < rows%first(a)) then
          used = used + 1
          k = used
          at(node) = k
          rows%item(k) = node
          rows%weight(k) = 0.0_rk
        end if
        rows%weight(k) = rows%weight(k) + gathered%value(terms%item(i))/rows%area(a)
      end do
      at(rows%item(rows%first(a):used)) = 0
      call drop_round_off(rows%first(a), used, rows)
      rows%first(a + 1) = used + 1
    end do
    rows%item = rows%item(:used)
    rows%weight = rows%weight(:used)
  end subroutine close_rows

  !> Removes the weights of one row that are round-off.
  pure subroutine drop_round_off(first, last, rows)
    integer, intent(in) :: first
    integer, intent(inout) :: last
    type(mortar_rows), intent(inout) :: rows
    integer :: k, used, largest
    real(rk) :: dropped
    used = first - 1
    dropped = 0.0_rk
    do k = first, last
      if (abs(rows%weight(k)) < no_weight) then
        dropped = dropped + rows%weight(k)
      else
        used = used + 1
        rows%item(used) = rows%item(k)
        rows%weight(used) = rows%weight(k)
      end if
    end do
    last = used
    if (last < first) return
    largest = first - 1 + maxloc(abs(rows%weight(first:last)), dim=1)
    rows%weight(largest) = rows%weight(largest) + dropped
  end subroutine drop_round_off

  !> The shortest side of the facets that meet here [m].
  pure real(rk) function smallest_extent(x, own, masters) result(extent)
    real(rk), intent(in) :: x(:, :) !< (3, nodes)
    integer, intent(in) :: own(4), masters(:, :) !< (4, facets) corners
    integer :: f
    extent = facet_extent(x(:, own))
    do f = 1, size(masters, 2)
      extent = min(extent, facet_extent(x(:, masters(:, f))))
    end do
  end function smallest_extent
end module mortar_projection
