!> Builds the pattern of the matrices from the couplings of the nodes.
!>
!> A cell is a list of nodes that are coupled with each other: a solid element, a point of a joint,
!> or a segment of springs between faces. Unknowns are handled in groups (those of one node, one
!> jump), which keeps this fast.
module pattern_builder
  use dam_mesh, only: fe_mesh, is_assembled_here
  use guest_list, only: list_guest_cells
  use guest_type, only: guest_reference
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use ranks, only: this_rank
  use row_tables, only: row_table, transpose_rows
  use sorted_lists, only: sorted_unique
  implicit none
  private
  public :: build_pattern, list_cells

  integer, parameter :: longest_short = 64 !< neighbours; a node of a solid has 26

contains

  !> Cells of a model: its solid elements and the cells of its guests, those of this rank.
  subroutine list_cells(mesh, guests, cells, losing)
    type(fe_mesh), intent(in) :: mesh
    type(guest_reference), intent(in) :: guests(:)
    type(row_table), intent(out) :: cells
    !> Elements whose loss of stiffness this rank finds; another one may have their stiffness
    integer, intent(in), optional :: losing(:)
    integer :: e, k, rank
    rank = this_rank()
    do e = 1, mesh%num_elements
      if (.not. is_assembled_here(mesh, rank, e)) cycle
      call cells%append(pack(mesh%nodes(:, e), mesh%nodes(:, e) > 0))
    end do
    if (present(losing)) then
      do k = 1, size(losing)
        if (is_assembled_here(mesh, rank, losing(k))) cycle
        if (mesh%material_of_element(losing(k)) <= 0) cycle
        call cells%append(mesh%nodes(:, losing(k)))
      end do
    end if
    call list_guest_cells(guests, cells)
    call cells%finish()
  end subroutine list_cells

  !> Lower triangle of the couplings by all cells.
  subroutine build_pattern(numbers, cells, matrix)
    type(numbering), intent(in) :: numbers
    type(row_table), intent(in) :: cells
    type(pattern), intent(out) :: matrix
    integer, allocatable :: group(:), first_unknown(:)
    type(row_table) :: groups_of_cell, cells_of_group, neighbours
    call group_unknowns(numbers, group, first_unknown)
    call list_groups(numbers, cells, group, size(first_unknown) - 1, groups_of_cell)
    call transpose_rows(groups_of_cell, size(first_unknown) - 1, cells_of_group)
    call list_neighbours(groups_of_cell, cells_of_group, neighbours)
    matrix%num_free = numbers%num_free
    matrix%num_total = numbers%num_total
    matrix%num_last = numbers%num_last
    call expand_groups(first_unknown, neighbours, matrix)
  end subroutine build_pattern

  !> Groups of unknowns with equal couplings: consecutive, of one node and one class.
  pure subroutine group_unknowns(numbers, group, first_unknown)
    type(numbering), intent(in) :: numbers
    integer, allocatable, intent(out) :: group(:) !< (unknowns)
    integer, allocatable, intent(out) :: first_unknown(:) !< (groups + 1)
    integer :: j, num_groups, first_jump, first_last
    allocate (group(numbers%num_total), first_unknown(numbers%num_total + 1))
    num_groups = 0
    first_jump = numbers%num_free - numbers%num_jumps + 1
    first_last = numbers%num_free - numbers%num_last + 1
    do j = 1, numbers%num_total
      if (starts_group(j)) then
        num_groups = num_groups + 1
        first_unknown(num_groups) = j
      end if
      group(j) = num_groups
    end do
    first_unknown(num_groups + 1) = numbers%num_total + 1
    first_unknown = first_unknown(:num_groups + 1)
  contains
    pure logical function starts_group(j)
      integer, intent(in) :: j
      starts_group = j == 1 .or. j == first_last .or. j == first_jump &
                     .or. j == numbers%num_free + 1
      if (starts_group) return
      starts_group = numbers%node(j) /= numbers%node(j - 1) &
                     .or. numbers%direction(j) <= numbers%direction(j - 1)
    end function starts_group
  end subroutine group_unknowns

  !> Groups of each cell through T, each once.
  subroutine list_groups(numbers, cells, group, num_groups, groups_of_cell)
    type(numbering), intent(in) :: numbers
    type(row_table), intent(in) :: cells
    integer, intent(in) :: group(:), num_groups
    type(row_table), intent(out) :: groups_of_cell
    integer, allocatable :: last_cell(:)
    integer :: c, pass, num_items
    allocate (groups_of_cell%first(size(cells%first)), last_cell(num_groups))
    do pass = 1, 2
      last_cell = 0
      num_items = 0
      do c = 1, size(cells%first) - 1
        groups_of_cell%first(c) = num_items + 1
        call add_groups(cells%item(cells%first(c):cells%first(c + 1) - 1))
      end do
      groups_of_cell%first(size(cells%first)) = num_items + 1
      if (pass == 1) allocate (groups_of_cell%item(num_items))
    end do
  contains
    !> Adds the groups of the current cell; the first pass only counts.
    subroutine add_groups(nodes)
      integer, intent(in) :: nodes(:)
      integer :: n, k, g
      do n = 1, size(nodes)
        do k = numbers%node_start(nodes(n)), numbers%node_start(nodes(n) + 1) - 1
          g = group(numbers%unknown(k))
          if (last_cell(g) == c) cycle
          last_cell(g) = c
          num_items = num_items + 1
          if (pass == 2) groups_of_cell%item(num_items) = g
        end do
      end do
    end subroutine add_groups
  end subroutine list_groups

  !> Groups with higher numbers in a common cell, for each group, ascending.
  subroutine list_neighbours(groups_of_cell, cells_of_group, neighbours)
    type(row_table), intent(in) :: groups_of_cell, cells_of_group
    type(row_table), intent(out) :: neighbours
    integer, allocatable :: last_group(:)
    integer :: g, pass, num_items
    allocate (neighbours%first(size(cells_of_group%first)), last_group(size(cells_of_group%first)))
    do pass = 1, 2
      last_group = 0
      num_items = 0
      do g = 1, size(cells_of_group%first) - 1
        neighbours%first(g) = num_items + 1
        call add_neighbours(cells_of_group%item(cells_of_group%first(g): &
                                                cells_of_group%first(g + 1) - 1))
        if (pass == 2) call sort(neighbours%item(neighbours%first(g):num_items))
      end do
      neighbours%first(size(neighbours%first)) = num_items + 1
      if (pass == 1) allocate (neighbours%item(num_items))
    end do
  contains
    !> Adds the neighbours of the current group; the first pass only counts.
    subroutine add_neighbours(cells)
      integer, intent(in) :: cells(:) !< with this group
      integer :: c, k, other
      do c = 1, size(cells)
        do k = groups_of_cell%first(cells(c)), groups_of_cell%first(cells(c) + 1) - 1
          other = groups_of_cell%item(k)
          if (other <= g .or. last_group(other) == g) cycle
          last_group(other) = g
          num_items = num_items + 1
          if (pass == 2) neighbours%item(num_items) = other
        end do
      end do
    end subroutine add_neighbours
  end subroutine list_neighbours

  !> Sorts a short list by insertion, a long one by merging.
  pure subroutine sort(list)
    integer, intent(inout) :: list(:) !< each item once
    integer :: i, k, item
    if (size(list) > longest_short) then
      list = sorted_unique(list)
      return
    end if
    do i = 2, size(list)
      item = list(i)
      do k = i - 1, 1, -1
        if (list(k) <= item) exit
        list(k + 1) = list(k)
      end do
      list(k + 1) = item
    end do
  end subroutine sort

  !> Writes the pattern of unknowns from that of groups.
  subroutine expand_groups(first_unknown, neighbours, matrix)
    integer, intent(in) :: first_unknown(:)
    type(row_table), intent(in) :: neighbours
    type(pattern), intent(inout) :: matrix
    integer :: g, j, k, i, pass, num_entries
    allocate (matrix%column_start(matrix%num_total + 1), matrix%free_entries(matrix%num_total))
    allocate (matrix%alike(matrix%num_total))
    do pass = 1, 2
      num_entries = 0
      matrix%free_entries = 0
      do g = 1, size(first_unknown) - 1
        do j = first_unknown(g), first_unknown(g + 1) - 1
          matrix%column_start(j) = num_entries + 1
          matrix%alike(j) = first_unknown(g + 1) - j
          call add_rows(j, first_unknown(g + 1) - 1)
          do k = neighbours%first(g), neighbours%first(g + 1) - 1
            i = neighbours%item(k)
            call add_rows(first_unknown(i), first_unknown(i + 1) - 1)
          end do
        end do
      end do
      matrix%column_start(matrix%num_total + 1) = num_entries + 1
      if (pass == 1) allocate (matrix%row(num_entries))
    end do
  contains
    !> Adds consecutive rows to the current column.
    subroutine add_rows(first, last)
      integer, intent(in) :: first, last
      integer :: row
      if (pass == 2) then
        do row = first, last
          matrix%row(num_entries + 1 + row - first) = row
        end do
      end if
      num_entries = num_entries + last - first + 1
      if (last <= matrix%num_free) then
        matrix%free_entries(j) = matrix%free_entries(j) + last - first + 1
      end if
    end subroutine add_rows
  end subroutine expand_groups
end module pattern_builder
