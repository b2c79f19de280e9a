!> Compliance of the structure at the points of its joints, G = B K_0^-1 B^T, by solves.
module joint_compliance
  use block_compliance, only: compliance_blocks, exact_response, few_points, own_size, take_blocks
  use blas_threads, only: use_many_threads, use_one_thread
  use global_vectors, only: norm
  use kinds, only: rk
  use errors, only: error_type
  use joint_rows, only: num_rows
  use jump_block, only: jump_schur_block, schur_compliance
  use linear_solver, only: equation_solver
  use joint_operator, only: jump_operator
  use point_groups, only: group_list
  use ranks, only: add_over_ranks
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: find_all_blocks, find_compliance, solved_response

  integer, parameter :: block_size = 48 !< right-hand sides solved at once
  !> Residual of a solve by iteration for a product with G, over the forces. Springs of closed
  !> joints are hundreds of times as stiff as the structure: what the structure adds to their
  !> compliance needs some digits, too.
  real(rk), parameter :: residual_of_product = 1.0e-8_rk

  !> G as an operator: a solve for each product.
  type, extends(exact_response) :: solved_response
    class(equation_solver), pointer :: factor => null() !< of K_0
    type(jump_operator), pointer :: operator => null()
    integer :: num_free = 0
    type(unknown_part) :: part !< unknowns of this rank, where vectors are divided
  contains
    procedure :: respond
  end type solved_response

contains

  !> y = G x; zero after a failure.
  subroutine respond(self, x, y)
    class(solved_response), intent(inout) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    real(rk) :: b(self%num_free, 1)
    integer :: row
    y = 0.0_rk
    if (allocated(self%failure)) return
    b = 0.0_rk
    do row = 1, size(x)
      call spread_row(self%operator, row, x(row), b(:, 1))
    end do
    call self%factor%solve_within(residual_of_product*norm(self%part, b(:, 1)), b, self%failure)
    if (.not. allocated(self%failure)) call apply_rows(self%operator, b(:, 1), y)
  end subroutine respond

  !> Computes all of G, and keeps the blocks that matter.
  subroutine find_all_blocks(factor, jumps, operator, spring, groups, smallest, blocks, error)
    class(equation_solver), intent(inout) :: factor !< of K_0
    type(jump_schur_block), intent(in) :: jumps
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    type(group_list), intent(in) :: groups
    real(rk), intent(in) :: smallest !< coupling of a block that is kept
    type(compliance_blocks), intent(inout) :: blocks
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: dense(:, :)
    integer, allocatable :: place(:) ! of each row in `dense`; not allocated: all in order
    integer :: levels
    if (groups%is_divided()) then
      call find_own_rows(factor, operator, jumps%num_free, spring, groups, blocks, error)
      return
    end if
    if (jumps%is_there .and. .not. jumps%top%is_there) then
      if (operator%num_points > few_points) call use_many_threads(levels)
      call schur_compliance(jumps, operator, dense, place)
      if (operator%num_points > few_points) call use_one_thread(levels)
    else
      call find_compliance(factor, operator, jumps%num_free, dense, error)
      if (allocated(error)) return
    end if
    call take_blocks(dense, spring, groups, smallest, blocks, place)
  end subroutine find_all_blocks

  !> Computes G.
  subroutine find_compliance(factor, operator, num_free, compliance, error)
    class(equation_solver), intent(inout) :: factor !< of K_0
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    real(rk), allocatable, intent(out) :: compliance(:, :) !< (rows, rows) [m/N]
    type(error_type), allocatable, intent(out) :: error
    integer :: row
    call find_columns(factor, operator, num_free, [(row, row=1, num_rows(operator%num_points))], &
                      compliance, error)
    if (.not. allocated(error)) compliance = 0.5_rk*(compliance + transpose(compliance))
  end subroutine find_compliance

  !> Computes G in blocks; each rank keeps the rows of its own groups. All ranks solve together.
  subroutine find_own_rows(factor, operator, num_free, spring, groups, blocks, error)
    class(equation_solver), intent(inout) :: factor !< of K_0
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    real(rk), intent(in) :: spring(:) !< (rows) compliance of the joints' own springs [m/N]
    type(group_list), intent(in) :: groups
    type(compliance_blocks), intent(out) :: blocks
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: columns(:, :)
    real(rk) :: lengths(groups%num_groups, groups%num_groups), own(groups%num_groups)
    integer :: j, k
    call blocks%start(groups)
    lengths = 0.0_rk
    own = 0.0_rk
    do j = 1, groups%num_groups
      call find_columns(factor, operator, num_free, groups%rows(j), columns, error)
      if (allocated(error)) return
      if (.not. groups%is_here(j)) cycle
      do k = 1, groups%num_groups
        blocks%block(j, k)%values = transpose(columns(groups%rows(k), :))
        lengths(j, k) = norm2(blocks%block(j, k)%values)
      end do
      associate (block => blocks%block(j, j)%values)
        block = 0.5_rk*(block + transpose(block))
        own(j) = own_size(block, spring(groups%rows(j)))
      end associate
    end do
    call add_over_ranks(lengths)
    call add_over_ranks(own)
    do k = 1, groups%num_groups
      blocks%block(:, k)%coupling = lengths(:, k)/max(sqrt(own*own(k)), tiny(1.0_rk))
      blocks%block(k, k)%coupling = 1.0_rk
    end do
    blocks%left_out = 0.0_rk
  end subroutine find_own_rows

  !> Columns of G by solves with blocks of right-hand sides.
  subroutine find_columns(factor, operator, num_free, rows, columns, error)
    class(equation_solver), intent(inout) :: factor !< of K_0
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    integer, intent(in) :: rows(:) !< the rows of B whose forces move the structure
    real(rk), allocatable, intent(out) :: columns(:, :) !< (all rows, rows) [m/N]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    integer :: first, last, k
    allocate (columns(num_rows(operator%num_points), size(rows)))
    do first = 1, size(rows), block_size
      last = min(first + block_size - 1, size(rows))
      allocate (b(num_free, last - first + 1), source=0.0_rk)
      do k = first, last
        call spread_row(operator, rows(k), 1.0_rk, b(:, k - first + 1))
      end do
      call factor%solve(b, error)
      if (allocated(error)) return
      do k = first, last
        call apply_rows(operator, b(:, k - first + 1), columns(:, k))
      end do
      deallocate (b)
    end do
  end subroutine find_columns

  !> Adds the forces of one row of B to a column over the free unknowns.
  pure subroutine spread_row(operator, row, force, column)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: row
    real(rk), intent(in) :: force !< [N]
    real(rk), intent(inout) :: column(:) !< [N]
    integer :: k
    do k = operator%row_start(row), operator%row_start(row + 1) - 1
      associate (unknown => operator%unknown(k))
        if (unknown > size(column)) cycle
        column(unknown) = column(unknown) + operator%coefficient(k)*force
      end associate
    end do
  end subroutine spread_row

  !> B times a column over the free unknowns.
  pure subroutine apply_rows(operator, column, product)
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: column(:)
    real(rk), intent(out) :: product(:) !< (rows)
    integer :: row, k
    do row = 1, size(product)
      product(row) = 0.0_rk
      do k = operator%row_start(row), operator%row_start(row + 1) - 1
        if (operator%unknown(k) > size(column)) cycle
        product(row) = product(row) + operator%coefficient(k)*column(operator%unknown(k))
      end do
    end do
  end subroutine apply_rows
end module joint_compliance
