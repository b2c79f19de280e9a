!> The compliance G = B K_0^-1 B^T in blocks, from the entries of K_0^-1 in the pattern of the top
!> of its factor (theory.md, 8). Pairs of groups outside of this pattern have no block.
module selected_compliance
  use block_compliance, only: compliance_blocks, own_size
  use errors, only: error_type, raise, system_failed
  use factor_top, only: top_of_factor
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use point_groups, only: group_list
  use sorted_lists, only: sorted_unique, place_in
  implicit none
  private
  public :: select_compliance

  !> Unknowns of a group, and the columns of B over them.
  type :: group_unknowns
    integer, allocatable :: unknown(:) !< free ones, ascending
    integer, allocatable :: start(:) !< (rows + 1)
    integer, allocatable :: place(:) !< in `unknown`
    real(rk), allocatable :: coefficient(:)
  end type group_unknowns

contains

  !> Blocks that matter; `missing` entries of own blocks are outside of the pattern.
  subroutine select_compliance(top, operator, spring, groups, smallest, blocks, missing, error)
    type(top_of_factor), intent(in) :: top
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    type(group_list), intent(in) :: groups
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    type(compliance_blocks), intent(out) :: blocks
    integer, intent(out) :: missing
    type(error_type), allocatable, intent(out) :: error
    type(group_unknowns) :: of_group(groups%num_groups)
    real(rk) :: own(groups%num_groups)
    integer :: order(groups%num_groups), i, absent
    logical :: has_failed
    missing = 0
    call blocks%start(groups)
    do i = 1, groups%num_groups
      call list_unknowns(operator, groups, i, top%num_free, of_group(i))
    end do
    call top%start_inverse(has_failed)
    if (.not. has_failed) call order_groups(top, of_group, order)
    do i = 1, groups%num_groups
      if (has_failed) exit
      call top%invert_for(of_group(order(i))%unknown, has_failed)
      if (has_failed) exit
      call take_group(top, of_group, order(:i), spring, smallest, own, blocks, absent)
      has_failed = absent < 0
      if (has_failed) exit
      missing = missing + absent
      call top%release(of_group(order(i))%unknown)
    end do
    call top%forget_inverse()
    if (has_failed) call raise(error, 'no memory for the compliance of the joints', system_failed)
  end subroutine select_compliance

  !> Announces the use of the unknowns of all groups, and orders the groups as their entries are
  !> computed: those of the last supernodes first.
  subroutine order_groups(top, of_group, order)
    type(top_of_factor), intent(in) :: top
    type(group_unknowns), intent(in) :: of_group(:)
    integer, intent(out) :: order(:) !< (groups)
    integer :: first(size(order)), i
    do i = 1, size(order)
      call top%expect(of_group(i)%unknown)
      first(i) = top%first_supernode(of_group(i)%unknown)
    end do
    do i = 1, size(order)
      order(i) = maxloc(first, 1)
      first(order(i)) = -1
    end do
  end subroutine order_groups

  !> Takes the own block of the last of some groups, and its blocks with the others.
  subroutine take_group(top, of_group, some, spring, smallest, own, blocks, missing)
    type(top_of_factor), intent(in) :: top
    type(group_unknowns), intent(in) :: of_group(:)
    integer, intent(in) :: some(:) !< groups
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    real(rk), intent(inout) :: own(:) !< (groups) sizes of own blocks [m/N]
    type(compliance_blocks), intent(inout) :: blocks
    integer, intent(out) :: missing !< entries of the own block that are not there, -1: no memory
    real(rk), allocatable :: values(:, :)
    integer :: i, j, k, g, absent
    g = some(size(some))
    call take_block(top, of_group(g), of_group(g), values, missing)
    if (missing < 0) return
    own(g) = own_size(values, spring(blocks%groups%rows(g)))
    call blocks%put(g, g, 1.0_rk, values, 0.0_rk)
    do i = 1, size(some) - 1
      j = max(some(i), g)
      k = min(some(i), g)
      if (.not. are_known(top, of_group(j)%unknown, of_group(k)%unknown)) cycle
      call take_block(top, of_group(j), of_group(k), values, absent)
      if (absent < 0) then
        missing = absent
        return
      end if
      call blocks%put_coupling(j, k, sqrt(own(j))*sqrt(own(k)), values, smallest)
    end do
  end subroutine take_group

  !> Whether some entries of a block are in the pattern.
  logical function are_known(top, row, column)
    type(top_of_factor), intent(in) :: top
    integer, intent(in) :: row(:), column(:) !< unknowns
    integer :: missing
    real(rk) :: block(3, 3)
    are_known = size(row) > 3 .and. size(column) > 3
    if (.not. are_known) return
    call top%inverse_block(sample(row), sample(column), block, missing)
    are_known = missing < size(block)
  end function are_known

  !> First, middle and last of a list.
  pure function sample(list) result(some)
    integer, intent(in) :: list(:)
    integer :: some(3)
    some = [list(1), list((size(list) + 1)/2), list(size(list))]
  end function sample

  !> Unknowns of a group and B over them.
  subroutine list_unknowns(operator, groups, group, num_free, answer)
    type(jump_operator), intent(in) :: operator
    type(group_list), intent(in) :: groups
    integer, intent(in) :: group, num_free
    type(group_unknowns), intent(out) :: answer
    integer, allocatable :: all_unknowns(:)
    integer :: r, k, used, pass
    associate (rows => groups%rows(group))
      allocate (answer%start(size(rows) + 1))
      do pass = 1, 2
        used = 0
        do r = 1, size(rows)
          answer%start(r) = used + 1
          do k = operator%row_start(rows(r)), operator%row_start(rows(r) + 1) - 1
            if (operator%unknown(k) > num_free) cycle
            used = used + 1
            if (pass == 1) cycle
            all_unknowns(used) = operator%unknown(k)
            answer%coefficient(used) = operator%coefficient(k)
          end do
        end do
        answer%start(size(rows) + 1) = used + 1
        if (pass == 1) allocate (all_unknowns(used), answer%coefficient(used), answer%place(used))
      end do
    end associate
    answer%unknown = sorted_unique(all_unknowns)
    do k = 1, used
      answer%place(k) = place_in(answer%unknown, all_unknowns(k))
    end do
  end subroutine list_unknowns

  !> The block of G between two groups.
  subroutine take_block(top, to, from, values, missing)
    type(top_of_factor), intent(in) :: top
    type(group_unknowns), intent(in) :: to, from
    real(rk), allocatable, intent(out) :: values(:, :) !< (rows, rows) [m/N]
    integer, intent(out) :: missing !< entries outside of the pattern, -1: no memory
    real(rk), allocatable :: inverse(:, :), column(:)
    integer :: r, c, k
    allocate (inverse(size(to%unknown), size(from%unknown)), column(size(to%unknown)))
    allocate (values(size(to%start) - 1, size(from%start) - 1))
    call top%inverse_block(to%unknown, from%unknown, inverse, missing)
    if (missing < 0) return
    do c = 1, size(values, 2)
      column = 0.0_rk
      do k = from%start(c), from%start(c + 1) - 1
        column = column + from%coefficient(k)*inverse(:, from%place(k))
      end do
      do r = 1, size(values, 1)
        values(r, c) = 0.0_rk
        do k = to%start(r), to%start(r + 1) - 1
          values(r, c) = values(r, c) + to%coefficient(k)*column(to%place(k))
        end do
      end do
    end do
  end subroutine take_block
end module selected_compliance
