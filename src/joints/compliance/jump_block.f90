!> Schur block of the factor of K_0 = L L^T. The unknowns of the joints (jumps, and nodes of points
!> without jumps) are eliminated last. E, the last block of L, gives their Schur complement
!> S = E E^T. The compliance then needs no solves, and Newton's method on the jumps runs between
!> forward and backward substitution.
module jump_block
  use errors, only: error_type
  use block_compliance, only: exact_response
  use factor_top, only: top_of_factor
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use joint_rows, only: num_rows
  use linear_solver, only: equation_solver
  use joint_operator, only: jump_operator
  use dense_factor, only: invert_from_lower, solve_lower, solve_lower_transposed
  implicit none
  private
  public :: jump_schur_block, schur_response, extract_schur_block, schur_compliance

  type :: jump_schur_block
    logical :: is_there = .false.
    integer :: num_free = 0
    type(top_of_factor) :: top !< in the place of E
    real(rk), allocatable :: lower(:, :) !< E (last unknowns, last unknowns)
    integer, allocatable :: unknown(:) !< (last unknowns) of each row of E
  contains
    procedure :: store_jumps, add_jump_forces
  end type jump_schur_block

  !> G as an operator: forward and backward substitution in the Schur block.
  type, extends(exact_response) :: schur_response
    type(jump_schur_block), pointer :: jumps => null()
    type(jump_operator), pointer :: operator => null()
    integer :: num_total = 0 !< unknowns
  contains
    procedure :: respond
  end type schur_response

contains

  !> y = G x; zero after a failure.
  subroutine respond(self, x, y)
    class(schur_response), intent(inout) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(out) :: y(:) !< (rows) [m]
    real(rk) :: work(self%num_total), half(self%jumps%num_free), jump(3, self%operator%num_points)
    y = 0.0_rk
    if (allocated(self%failure)) return
    work = 0.0_rk
    half = 0.0_rk
    jump = reshape(x, shape(jump))/spread(self%operator%area, 1, 3)
    call self%operator%add_forces(jump, work)
    call self%jumps%add_jump_forces(work, half, self%failure)
    if (allocated(self%failure)) return
    work = 0.0_rk
    call self%jumps%store_jumps(half, work, self%failure)
    if (allocated(self%failure)) return
    call self%operator%jumps(work, jump)
    y = reshape(jump, shape(y))
  end subroutine respond

  !> Takes the top of the factor where the unknowns of joints are separators, else extracts E where
  !> all of them are eliminated last.
  subroutine extract_schur_block(factor, operator, matrix, jumps)
    class(equation_solver), intent(in) :: factor !< of K_0
    type(jump_operator), intent(in) :: operator
    type(pattern), intent(in) :: matrix
    type(jump_schur_block), intent(out) :: jumps
    jumps%num_free = matrix%num_free
    if (allocated(matrix%group)) then
      call factor%take_top(pack(operator%unknown, operator%unknown <= matrix%num_free), jumps%top)
      jumps%is_there = jumps%top%is_there
      return
    end if
    if (any(operator%unknown <= matrix%num_free - matrix%num_last)) return
    call factor%take_schur_block(matrix%num_last, jumps%lower, jumps%unknown, jumps%is_there)
  end subroutine extract_schur_block

  !> G = B S^-1 B^T. Where each row of B is one unknown, this is S^-1 in another order.
  subroutine schur_compliance(jumps, operator, compliance, place)
    type(jump_schur_block), intent(in) :: jumps
    type(jump_operator), intent(in) :: operator
    real(rk), allocatable, intent(out) :: compliance(:, :) !< (rows, rows) in some order [m/N]
    integer, allocatable, intent(out) :: place(:) !< (rows) of each row in `compliance`
    real(rk), allocatable :: inverse(:, :)
    integer :: place_of(jumps%num_free), i
    place_of = 0
    place_of(jumps%unknown) = [(i, i=1, size(jumps%unknown))]
    inverse = jumps%lower
    call invert_from_lower(inverse)
    if (selects_unknowns(operator, jumps%num_free)) then
      place = place_of(operator%unknown)
      call move_alloc(inverse, compliance)
    else
      place = [(i, i=1, num_rows(operator%num_points))]
      call apply_operator(operator, place_of, inverse, compliance)
    end if
  end subroutine schur_compliance

  !> Whether each row of B is one free unknown.
  pure logical function selects_unknowns(operator, num_free)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: num_free
    associate (rows => num_rows(operator%num_points))
      selects_unknowns = size(operator%unknown) == rows
      if (selects_unknowns) then
        selects_unknowns = all(operator%row_start(2:) - operator%row_start(:rows) == 1) .and. &
                           all(operator%unknown <= num_free) .and. &
                           .not. any(abs(operator%coefficient - 1.0_rk) > 0.0_rk)
      end if
    end associate
  end function selects_unknowns

  !> B S^-1 B^T.
  subroutine apply_operator(operator, place, inverse, compliance)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: place(:) !< (free unknowns) in the inverse
    real(rk), intent(in) :: inverse(:, :) !< S^-1
    real(rk), allocatable, intent(out) :: compliance(:, :) !< (rows, rows) [m/N]
    real(rk) :: column(size(inverse, 1))
    integer :: k, row
    allocate (compliance(num_rows(operator%num_points), num_rows(operator%num_points)))
    do row = 1, size(compliance, 2)
      column = 0.0_rk
      do k = operator%row_start(row), operator%row_start(row + 1) - 1
        if (operator%unknown(k) > size(place)) cycle
        column = column + operator%coefficient(k)*inverse(:, place(operator%unknown(k)))
      end do
      call apply_rows(operator, place, column, compliance(:, row))
    end do
  end subroutine apply_operator

  !> B times a column over the last unknowns.
  pure subroutine apply_rows(operator, place, column, product)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: place(:) !< (free unknowns) in the column
    real(rk), intent(in) :: column(:)
    real(rk), intent(out) :: product(:) !< (rows)
    integer :: row, k
    do row = 1, size(product)
      product(row) = 0.0_rk
      do k = operator%row_start(row), operator%row_start(row + 1) - 1
        if (operator%unknown(k) > size(place)) cycle
        product(row) = product(row) + operator%coefficient(k)*column(place(operator%unknown(k)))
      end do
    end do
  end subroutine apply_rows

  !> Stores the jumps that follow from a forward substitution.
  subroutine store_jumps(self, half, x, error)
    class(jump_schur_block), intent(in) :: self
    real(rk), intent(in) :: half(:) !< (free unknowns) after forward substitution
    real(rk), intent(inout) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: d(:)
    if (self%top%is_there) then
      call self%top%solve_for_top(half, x(:self%num_free), error)
      return
    end if
    allocate (d(size(self%unknown)))
    d = half(size(half) - size(d) + 1:)
    call solve_lower_transposed(self%lower, d)
    x(self%unknown) = d
  end subroutine store_jumps

  !> Adds forces on the jumps to a forward substitution.
  subroutine add_jump_forces(self, force, half, error)
    class(jump_schur_block), intent(in) :: self
    real(rk), intent(in) :: force(:) !< (all unknowns) [N]
    real(rk), intent(inout) :: half(:) !< (free unknowns) after forward substitution
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: f(:)
    if (self%top%is_there) then
      call self%top%add_forces(force(:self%num_free), half, error)
      return
    end if
    f = force(self%unknown)
    call solve_lower(self%lower, f)
    associate (last => half(size(half) - size(f) + 1:))
      last = last + f
    end associate
  end subroutine add_jump_forces
end module jump_block
