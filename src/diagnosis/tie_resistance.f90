!> What ties and equations resist of the motions of rigid parts.
!>
!> A tie has a matrix of the parts that it touches alone. In this matrix the motions of all parts
!> are taken about the middle of the tie: parts that move as one have the same motion.
module tie_resistance
  use body_parts, only: root_of, unite
  use dam_mesh, only: node_tie
  use errors, only: error_type
  use kinds, only: rk
  use rigid_blocks, only: add_tie, block_set
  use row_tables, only: group_by_key, row_table
  use small_matrix, only: cross_product
  use sorted_lists, only: sorted_unique
  use symmetric_modes, only: find_modes
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: part_resistance, list_resistance, unite_held, add_resistance, scale_parts

  !> Of the largest, in squares, in the middle of a tie and over its extent: the rows of mortar ties
  !> along a line are exact to 1e-9; a tie of one row of facets, 1:100, has 1e-4.
  real(rk), parameter :: least_of_tie = 1.0e-7_rk
  !> A tie of more parts is taken in pieces: the modes of its matrix cost the cube of the number.
  integer, parameter :: most_together = 20

  !> The matrix sum row^T row of a tie or of some of its rows.
  type :: part_resistance
    integer, allocatable :: part(:) !< that the rows touch, ascending
    real(rk) :: centre(3) = 0.0_rk !< of all motions [m]
    real(rk) :: radius = 1.0_rk !< of rotations [m]
    real(rk), allocatable :: matrix(:, :) !< (6*touched parts, 6*touched parts)
  end type part_resistance

contains

  !> Lists what ties and equations resist. A tie that nearly lies on a line or in a point counts as
  !> one that does. Equations, which may be far apart, are taken as they are.
  subroutine list_resistance(parts, x, ties, list, error)
    type(block_set), intent(in) :: parts
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(node_tie), intent(in) :: ties(:)
    type(part_resistance), allocatable, intent(out) :: list(:)
    type(error_type), allocatable, intent(out) :: error
    type(row_table) :: pieces(size(ties))
    type(block_set) :: near
    integer :: i, k, used
    do i = 1, size(ties)
      call cut_tie(parts, ties(i), pieces(i))
    end do
    allocate (list(sum([(pieces(i)%num_rows(), i=1, size(ties))])))
    allocate (near%block_of(size(x, 2)), source=0)
    used = 0
    do i = 1, size(ties)
      do k = 1, pieces(i)%num_rows()
        used = used + 1
        call build_piece(parts, x, ties(i), pieces(i)%row(k), near, list(used))
        if (allocated(ties(i)%item_direction)) cycle
        call drop_weak(list(used)%matrix, error)
        if (allocated(error)) return
      end do
    end do
  end subroutine list_resistance

  !> Sorts the rows of equations, and of a tie of many parts, by the parts that they touch.
  subroutine cut_tie(parts, tie, pieces)
    type(block_set), intent(in) :: parts
    type(node_tie), intent(in) :: tie
    type(row_table), intent(out) :: pieces !< rows of the tie in each piece
    type(text_numbers) :: names
    character(:), allocatable :: name
    integer, allocatable :: touched(:)
    integer :: key(size(tie%node)), i, k
    key = 1
    touched = touched_parts(parts, tie, [(i, i=1, size(tie%node))])
    if (allocated(tie%item_direction) .or. size(touched) > most_together) then
      do i = 1, size(tie%node)
        touched = touched_parts(parts, tie, [i])
        name = ''
        do k = 1, size(touched)
          name = name//as_text(touched(k))//','
        end do
        call names%find_or_add(name, key(i))
      end do
    end if
    call group_by_key(key, maxval([0, key]), pieces)
  end subroutine cut_tie

  !> The parts with nodes of some rows.
  pure function touched_parts(parts, tie, rows) result(touched)
    type(block_set), intent(in) :: parts
    type(node_tie), intent(in) :: tie
    integer, intent(in) :: rows(:)
    integer, allocatable :: touched(:)
    touched = sorted_unique(parts%block_of(nodes_of_rows(tie, rows)))
    touched = pack(touched, touched > 0)
  end function touched_parts

  !> The nodes of some rows: those that follow, then those that they follow.
  pure function nodes_of_rows(tie, rows) result(nodes)
    type(node_tie), intent(in) :: tie
    integer, intent(in) :: rows(:)
    integer, allocatable :: nodes(:)
    integer :: i, used
    allocate (nodes(size(rows) + sum(tie%first(rows + 1) - tie%first(rows))))
    nodes(:size(rows)) = tie%node(rows)
    used = size(rows)
    do i = 1, size(rows)
      associate (first => tie%first(rows(i)), last => tie%first(rows(i) + 1) - 1)
        nodes(used + 1:used + last - first + 1) = tie%item(first:last)
        used = used + last - first + 1
      end associate
    end do
  end function nodes_of_rows

  !> The matrix of some rows.
  subroutine build_piece(parts, x, tie, rows, near, piece)
    type(block_set), intent(in) :: parts
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(node_tie), intent(in) :: tie
    integer, intent(in) :: rows(:)
    type(block_set), intent(inout) :: near !< block_of is zero
    type(part_resistance), intent(out) :: piece
    integer, allocatable :: nodes(:)
    integer :: k, m
    nodes = nodes_of_rows(tie, rows)
    piece%part = touched_parts(parts, tie, rows)
    piece%centre = sum(x(:, tie%node(rows)), dim=2)/size(rows)
    piece%radius = maxval([(norm2(x(:, nodes(k)) - piece%centre), k=1, size(nodes)), &
                           tiny(1.0_rk)])
    m = size(piece%part)
    near%num_blocks = m
    near%centre = spread(piece%centre, 2, m)
    near%radius = spread(piece%radius, 1, m)
    do k = 1, size(nodes)
      near%block_of(nodes(k)) = findloc(piece%part, parts%block_of(nodes(k)), 1)
    end do
    allocate (piece%matrix(6*m, 6*m), source=0.0_rk)
    call add_tie(near, x, tie, rows, piece%matrix)
    near%block_of(nodes) = 0
  end subroutine build_piece

  !> Takes out the motions that a tie hardly resists.
  subroutine drop_weak(matrix, error)
    real(rk), intent(inout) :: matrix(:, :) !< symmetric
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: resistance(:), motion(:, :)
    call find_modes(matrix, resistance, motion, error)
    if (allocated(error)) return
    where (resistance <= least_of_tie*maxval(resistance)) resistance = 0.0_rk
    matrix = matmul(motion, spread(resistance, 2, size(resistance))*transpose(motion))
  end subroutine drop_weak

  !> Unites parts that a tie between them holds in all six directions: they are one body.
  subroutine unite_held(list, num_parts, body_of, error)
    type(part_resistance), intent(in) :: list(:)
    integer, intent(in) :: num_parts
    integer, allocatable, intent(out) :: body_of(:) !< (parts)
    type(error_type), allocatable, intent(out) :: error
    integer :: parent(num_parts), number(num_parts), i, k
    logical :: has_changed, is_held
    integer, allocatable :: root(:)
    parent = [(i, i=1, num_parts)]
    has_changed = .true.
    do while (has_changed)
      has_changed = .false.
      do i = 1, size(list)
        root = [(root_of(parent, list(i)%part(k)), k=1, size(list(i)%part))]
        if (size(sorted_unique(root)) /= 2) cycle
        call check_held(list(i)%matrix, root == minval(root), is_held, error)
        if (allocated(error)) return
        if (.not. is_held) cycle
        call unite(parent, minval(root), maxval(root))
        has_changed = .true.
      end do
    end do
    number = 0
    allocate (body_of(num_parts))
    do i = 1, num_parts
      k = root_of(parent, i)
      if (number(k) == 0) number(k) = maxval(number) + 1
      body_of(i) = number(k)
    end do
  end subroutine unite_held

  !> Whether a tie between two bodies holds one to the other, and nothing else.
  subroutine check_held(matrix, is_first, is_held, error)
    real(rk), intent(in) :: matrix(:, :) !< (6*parts, 6*parts)
    logical, intent(in) :: is_first(:) !< (parts) of the first body
    logical, intent(out) :: is_held
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: first(6, 6), both(6, 6), block(6, 6)
    real(rk), allocatable :: resistance(:), motion(:, :)
    integer :: a, b
    first = 0.0_rk
    both = 0.0_rk
    do b = 1, size(is_first)
      do a = 1, size(is_first)
        block = matrix(6*a - 5:6*a, 6*b - 5:6*b)
        both = both + block
        if (is_first(a) .and. is_first(b)) first = first + block
      end do
    end do
    is_held = .false.
    call find_modes(first, resistance, motion, error)
    if (allocated(error)) return
    is_held = resistance(1) > least_of_tie*resistance(6) .and. &
              maxval(abs(both)) <= least_of_tie*resistance(6)
  end subroutine check_held

  !> Adds what ties resist of the motions of bodies to a matrix.
  subroutine add_resistance(bodies, body_of, list, matrix)
    type(block_set), intent(in) :: bodies
    integer, intent(in) :: body_of(:) !< (parts)
    type(part_resistance), intent(in) :: list(:)
    real(rk), intent(inout) :: matrix(:, :) !< (6*bodies, 6*bodies)
    real(rk), allocatable :: to_near(:, :)
    integer, allocatable :: touched(:), place(:)
    integer :: i, k, b
    do i = 1, size(list)
      touched = sorted_unique(body_of(list(i)%part))
      allocate (to_near(size(list(i)%matrix, 1), 6*size(touched)), source=0.0_rk)
      do k = 1, size(list(i)%part)
        b = findloc(touched, body_of(list(i)%part(k)), 1)
        to_near(6*k - 5:6*k, 6*b - 5:6*b) = &
          moved_centre(list(i)%centre - bodies%centre(:, touched(b)), &
                       bodies%radius(touched(b)), list(i)%radius)
      end do
      place = [((6*touched(b) - 6 + k, k=1, 6), b=1, size(touched))]
      matrix(place, place) = matrix(place, place) + &
                             matmul(transpose(to_near), matmul(list(i)%matrix, to_near))
      deallocate (to_near)
    end do
  end subroutine add_resistance

  !> The motion of a part about another centre: v + w x d, and w, both as lengths.
  pure function moved_centre(d, radius, near_radius) result(matrix)
    real(rk), intent(in) :: d(3) !< from the centre of the part to the other one [m]
    real(rk), intent(in) :: radius, near_radius !< of rotations [m]
    real(rk) :: matrix(6, 6), axis(3)
    integer :: k
    matrix = 0.0_rk
    do k = 1, 3
      axis = 0.0_rk
      axis(k) = 1.0_rk
      matrix(k, k) = 1.0_rk
      matrix(:3, 3 + k) = cross_product(axis, d)/radius
      matrix(3 + k, 3 + k) = near_radius/radius
    end do
  end function moved_centre

  !> Divides rows and columns of each part by the size of its own block: numbers of supports and of
  !> rows do not count.
  pure subroutine scale_parts(matrix)
    real(rk), intent(inout) :: matrix(:, :) !< (6*parts, 6*parts)
    real(rk) :: scale(size(matrix, 1)), trace
    integer :: b, k
    do b = 1, size(scale)/6
      trace = sum([(matrix(k, k), k=6*b - 5, 6*b)])
      scale(6*b - 5:6*b) = 1.0_rk
      if (trace > 0.0_rk) scale(6*b - 5:6*b) = 1.0_rk/sqrt(trace)
    end do
    matrix = spread(scale, 2, size(scale))*matrix*spread(scale, 1, size(scale))
  end subroutine scale_parts
end module tie_resistance
