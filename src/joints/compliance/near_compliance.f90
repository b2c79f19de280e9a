!> Compliance of the structure at the points of its joints, G = B K_0^-1 B^T, by factors of the
!> parts of K_0 near each group of points (theory.md, 8). The structure is held at the border of a
!> part.
!>
!> In an increment of motion inertia screens what is further away than some elements. What these
!> blocks leave out is made up for by solves with the whole K_0.
module near_compliance
  use, intrinsic :: iso_fortran_env, only: single => real32
  use block_compliance, only: compliance_blocks, own_size
  use errors, only: error_type
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use linear_solver, only: equation_solver
  use matrix_pattern, only: pattern
  use point_groups, only: group_list
  use ranks, only: add_over_ranks, is_true_everywhere, share_error
  use sorted_lists, only: place_in, sorted_unique
  implicit none
  private
  public :: find_near_rows

  !> Layers of elements around a group in the first part; each further part has twice as many.
  integer, parameter :: first_layers = 4
  !> Rows of the largest part, unless the first one has more.
  integer, parameter :: most_rows = 120000
  !> Change of some columns by the last layers, over these columns, that needs no more layers. The
  !> error is then its square where it falls exponentially.
  real(rk), parameter :: small_change = 1.0e-2_rk
  integer, parameter :: num_samples = 12 !< columns that are compared
  integer, parameter :: block_size = 64 !< right-hand sides solved at once

  !> The part of K_0 near a group.
  type :: near_part
    integer :: group = 0 !< of this rank, 0 for none
    integer, allocatable :: rows(:) !< rows of B of the group
    integer, allocatable :: moved(:) !< rows of B that move with the part
    real(rk), allocatable :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    integer, allocatable :: seed(:) !< free unknowns of the group
    integer, allocatable :: place(:) !< (free unknowns) row of the part, 0 for none
    integer :: num_rows = 0 !< of the part
  end type near_part

contains

  !> Computes rows of G; each rank those of its own groups. All ranks call it together.
  subroutine find_near_rows(factor, matrix, values, operator, spring, groups, blocks, error)
    class(equation_solver), intent(inout) :: factor !< of K_0, with parts
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< K_0
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    type(group_list), intent(in) :: groups
    type(compliance_blocks), intent(out) :: blocks
    type(error_type), allocatable, intent(out) :: error
    type(near_part) :: part
    real(rk) :: lengths(groups%num_groups, groups%num_groups), own(groups%num_groups)
    real(rk) :: change(groups%num_groups)
    integer :: g, round
    call blocks%start(groups)
    lengths = 0.0_rk
    own = 0.0_rk
    change = 0.0_rk
    round = 0
    do
      round = round + 1
      call start_part(operator, matrix%num_free, spring, groups, own_group(groups, round), part)
      g = part%group
      if (is_true_everywhere(g == 0)) exit
      call find_part(factor, matrix, values, operator, part, change(max(g, 1)), error)
      if (.not. allocated(error) .and. g > 0) then
        call find_group(factor, operator, groups, part, blocks, lengths(g, :), own(g), error)
      end if
      call share_error(error)
      if (allocated(error)) exit
    end do
    call factor%drop_patch()
    if (.not. allocated(error)) call share_sizes(lengths, own, change, blocks)
  end subroutine find_near_rows

  !> The group of this rank in a round; 0 for none.
  integer function own_group(groups, round) result(group)
    type(group_list), intent(in) :: groups
    integer, intent(in) :: round
    integer :: count
    count = 0
    do group = 1, groups%num_groups
      if (groups%is_here(group)) count = count + 1
      if (count == round) return
    end do
    group = 0
  end function own_group

  !> The sizes of all blocks, on all ranks; all know them already where there is one group.
  subroutine share_sizes(lengths, own, change, blocks)
    real(rk), contiguous, intent(inout) :: lengths(:, :) !< (groups, groups) norms of own rows
    real(rk), contiguous, intent(inout) :: own(:), change(:) !< (groups)
    type(compliance_blocks), intent(inout) :: blocks
    integer :: k
    if (blocks%groups%is_divided()) then
      call add_over_ranks(lengths)
      call add_over_ranks(own)
      call add_over_ranks(change)
    end if
    lengths = max(lengths, transpose(lengths))
    do k = 1, size(own)
      blocks%block(:, k)%coupling = lengths(:, k)/max(sqrt(own*own(k)), tiny(1.0_rk))
      blocks%block(k, k)%coupling = 1.0_rk
    end do
    blocks%left_out = maxval(change)
  end subroutine share_sizes

  !> The group of a part, before it has unknowns.
  subroutine start_part(operator, num_free, spring, groups, group, part)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    real(rk), intent(in) :: spring(:) !< (rows of all groups) [m/N]
    type(group_list), intent(in) :: groups
    integer, intent(in) :: group !< of this rank, 0 for none
    type(near_part), intent(out) :: part
    part%group = group
    part%rows = [integer ::]
    if (group > 0) part%rows = groups%rows(group)
    part%moved = [integer ::]
    part%spring = spring(part%rows)
    allocate (part%place(num_free), source=0)
    part%seed = unknowns_of(operator, num_free, part%rows)
  end subroutine start_part

  !> Grows the part of a group until further layers change little, or it is all of the structure,
  !> or would be too large. Ranks whose parts have grown enough wait for the others. A group without
  !> free unknowns has no part: its faces are held, or not there in this stage.
  subroutine find_part(factor, matrix, values, operator, part, change, error)
    class(equation_solver), intent(inout) :: factor
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< K_0
    type(jump_operator), intent(in) :: operator
    type(near_part), intent(inout) :: part
    real(rk), intent(inout) :: change !< of some columns by the last layers
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: unknown(:)
    real(rk), allocatable :: sample(:, :), last(:, :)
    logical :: is_large
    integer :: layers, most
    is_large = size(part%seed) == 0
    layers = first_layers
    most = huge(1)
    do
      call factor%take_patch(matrix, values, part%seed, layers, most, unknown, error)
      if (allocated(error)) return
      if (.not. is_large) is_large = size(unknown) == 0
      if (.not. is_large) then
        call place_unknowns(operator, unknown, part)
        call take_sample(factor, operator, part, sample, error)
        if (.not. allocated(error)) call judge_part(sample, last, change, is_large)
      end if
      call share_error(error)
      if (allocated(error)) return
      if (is_true_everywhere(is_large)) return
      if (is_large) part%seed = [integer ::]
      layers = 2*layers
      most = most_rows
    end do
  end subroutine find_part

  !> Whether some columns have hardly changed.
  subroutine judge_part(sample, last, change, is_large)
    real(rk), intent(in) :: sample(:, :) !< (rows, columns) [m/N]
    real(rk), allocatable, intent(inout) :: last(:, :) !< of the smaller part, then `sample`
    real(rk), intent(inout) :: change !< over the columns
    logical, intent(inout) :: is_large
    change = 1.0_rk
    if (allocated(last)) change = norm2(sample - last)/max(norm2(sample), tiny(1.0_rk))
    is_large = change <= small_change
    last = sample
  end subroutine judge_part

  !> Free unknowns in some rows of B.
  function unknowns_of(operator, num_free, rows) result(unknowns)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    integer, intent(in) :: rows(:)
    integer, allocatable :: unknowns(:)
    integer :: k, i
    unknowns = [((operator%unknown(k), k=operator%row_start(rows(i)), &
                  operator%row_start(rows(i) + 1) - 1), i=1, size(rows))]
    unknowns = sorted_unique(pack(unknowns, unknowns <= num_free))
  end function unknowns_of

  !> Where the unknowns stand in the part, and which jumps they move.
  subroutine place_unknowns(operator, unknown, part)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: unknown(:) !< of each row of the part, 0 for none
    type(near_part), intent(inout) :: part
    logical :: is_moved(size(operator%row_start) - 1)
    integer :: k, r
    part%num_rows = size(unknown)
    part%place = 0
    do k = 1, size(unknown)
      if (unknown(k) > 0) part%place(unknown(k)) = k
    end do
    do r = 1, size(is_moved)
      is_moved(r) = any([(place_of(part, operator%unknown(k)) > 0, k=operator%row_start(r), &
                          operator%row_start(r + 1) - 1)])
    end do
    part%moved = pack([(r, r=1, size(is_moved))], is_moved)
  end subroutine place_unknowns

  !> Row of an unknown in the part, 0 for none.
  pure integer function place_of(part, unknown) result(row)
    type(near_part), intent(in) :: part
    integer, intent(in) :: unknown
    row = 0
    if (unknown <= size(part%place)) row = part%place(unknown)
  end function place_of

  !> What the structure adds to the springs in some columns of the own block.
  subroutine take_sample(factor, operator, part, sample, error)
    class(equation_solver), intent(inout) :: factor
    type(jump_operator), intent(in) :: operator
    type(near_part), intent(in) :: part
    real(rk), allocatable, intent(out) :: sample(:, :) !< (rows, columns) [m/N]
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: chosen(:)
    real(rk), allocatable :: columns(:, :)
    integer :: n, i
    n = size(part%rows)
    chosen = [(1 + (i*(n - 1))/num_samples, i=0, min(n, num_samples) - 1)]
    call find_columns(factor, operator, part, part%rows(chosen), columns, error)
    if (allocated(error)) return
    call take_rows(columns, part%moved, part%rows, sample)
    do i = 1, size(chosen)
      sample(chosen(i), i) = sample(chosen(i), i) - part%spring(chosen(i))
    end do
  end subroutine take_sample

  !> The rows of G of a group: its own block, and those with groups that the part holds.
  subroutine find_group(factor, operator, groups, part, blocks, lengths, own, error)
    class(equation_solver), intent(inout) :: factor
    type(jump_operator), intent(in) :: operator
    type(group_list), intent(in) :: groups
    type(near_part), intent(in) :: part
    type(compliance_blocks), intent(inout) :: blocks
    real(rk), intent(out) :: lengths(:) !< (groups) norms of the blocks [m/N]
    real(rk), intent(out) :: own !< size of the own block [m/N]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: columns(:, :), values(:, :)
    integer :: k
    lengths = 0.0_rk
    own = 0.0_rk
    call find_columns(factor, operator, part, part%rows, columns, error)
    if (allocated(error)) return
    do k = 1, groups%num_groups
      call take_rows(columns, part%moved, groups%rows(k), values)
      lengths(k) = norm2(values)
      if (k == part%group) then
        blocks%block(k, k)%values = transpose(values)
      else if (lengths(k) > 0.0_rk) then
        blocks%block(part%group, k)%rounded = real(transpose(values), single)
      end if
    end do
    associate (block => blocks%block(part%group, part%group)%values)
      block = 0.5_rk*(block + transpose(block))
      own = own_size(block, part%spring)
    end associate
  end subroutine find_group

  !> Some rows of columns of G; rows that do not move with the part are zero.
  subroutine take_rows(columns, moved, rows, values)
    real(rk), intent(in) :: columns(:, :) !< (moved rows, columns)
    integer, intent(in) :: moved(:) !< ascending
    integer, intent(in) :: rows(:)
    real(rk), allocatable, intent(out) :: values(:, :) !< (rows, columns)
    integer :: i, k
    allocate (values(size(rows), size(columns, 2)), source=0.0_rk)
    if (size(moved) == 0) return
    do i = 1, size(rows)
      k = place_in(moved, rows(i))
      if (moved(k) == rows(i)) values(i, :) = columns(k, :)
    end do
  end subroutine take_rows

  !> Columns of G in the rows that move with the part.
  subroutine find_columns(factor, operator, part, rows, columns, error)
    class(equation_solver), intent(inout) :: factor
    type(jump_operator), intent(in) :: operator
    type(near_part), intent(in) :: part
    integer, intent(in) :: rows(:) !< the rows of B whose forces move the structure
    real(rk), allocatable, intent(out) :: columns(:, :) !< (moved rows, rows) [m/N]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    integer :: first, last, i, k, row
    allocate (columns(size(part%moved), size(rows)), source=0.0_rk)
    if (part%num_rows == 0) return
    do first = 1, size(rows), block_size
      last = min(first + block_size - 1, size(rows))
      allocate (b(part%num_rows, last - first + 1), source=0.0_rk)
      do i = first, last
        do k = operator%row_start(rows(i)), operator%row_start(rows(i) + 1) - 1
          row = place_of(part, operator%unknown(k))
          if (row > 0) b(row, i - first + 1) = operator%coefficient(k)
        end do
      end do
      call factor%solve_patch(b, error)
      if (allocated(error)) return
      do i = first, last
        call apply_rows(b(:, i - first + 1), columns(:, i))
      end do
      deallocate (b)
    end do
  contains
    !> B times a column over the part.
    subroutine apply_rows(x, product)
      real(rk), intent(in) :: x(:)
      real(rk), intent(inout) :: product(:) !< (moved rows)
      integer :: r, m, place
      do r = 1, size(product)
        do m = operator%row_start(part%moved(r)), operator%row_start(part%moved(r) + 1) - 1
          place = place_of(part, operator%unknown(m))
          if (place > 0) product(r) = product(r) + operator%coefficient(m)*x(place)
        end do
      end do
    end subroutine apply_rows
  end subroutine find_columns
end module near_compliance
