!> Factors of I - D G for each group of joint points, on the rows where the tangent differs from
!> k_ref. They are kept as long as the tangent of the group changes little.
module tangent_factors
  use block_compliance, only: compliance_blocks
  use dense_factor, only: lu_factor, factorise_dense, solve_factored
  use single_factor, only: single_lu, factorise_single, solve_single
  use joint_rows, only: num_axes, row_of, point_of, axis_of
  use kinds, only: rk
  implicit none
  private
  public :: group_factor, update_factor, solve_group, apply_change

  type :: group_factor
    logical :: is_there = .false.
    logical :: is_exact = .false. !< D is that of the factor
    integer, allocatable :: row(:) !< rows of the group with D not zero
    real(rk), allocatable :: change(:, :, :) !< (3, 3, points) D at the factor [N/m]
    type(lu_factor) :: factor
    type(single_lu) :: single !< in place of `factor` where it preconditions
  end type group_factor

contains

  !> Factors a group anew where other rows are changed than in its factor, or D differs by more than
  !> a share of its largest entry at a point.
  subroutine update_factor(blocks, group, all_changes, share, is_single, self)
    type(compliance_blocks), intent(in) :: blocks
    integer, intent(in) :: group
    real(rk), intent(in) :: all_changes(:, :, :) !< (3, 3, points) D [N/m]
    real(rk), intent(in) :: share !< of D that may differ
    logical, intent(in) :: is_single !< single precision is enough
    type(group_factor), intent(inout) :: self
    real(rk), allocatable :: change(:, :, :), matrix(:, :)
    integer, allocatable :: row(:)
    change = all_changes(:, :, blocks%groups%members(group))
    call list_rows(change, row)
    if (self%is_there) then
      self%is_exact = is_near(self, row, change, 0.0_rk)
      if (self%is_exact) return
      if (is_near(self, row, change, share)) return
    end if
    self%is_exact = .true.
    self%row = row
    self%change = change
    call form_matrix(blocks%block(group, group)%values, row, change, matrix)
    self%single%is_there = .false.
    if (is_single) call factorise_single(matrix, self%single)
    self%is_there = self%single%is_there
    if (self%is_there) return
    call factorise_dense(matrix, self%factor)
    self%is_there = .not. self%factor%is_singular
  end subroutine update_factor

  !> Rows where D is not zero.
  pure subroutine list_rows(change, row)
    real(rk), intent(in) :: change(:, :, :) !< (3, 3, points) [N/m]
    integer, allocatable, intent(out) :: row(:)
    integer :: p, i, num_rows
    allocate (row(num_axes*size(change, 3)))
    num_rows = 0
    do p = 1, size(change, 3)
      do i = 1, num_axes
        if (.not. any(abs(change(i, :, p)) > 0.0_rk)) cycle
        num_rows = num_rows + 1
        row(num_rows) = row_of(p, i)
      end do
    end do
    row = row(:num_rows)
  end subroutine list_rows

  !> Whether a factor fits rows and changes.
  pure logical function is_near(self, row, change, share)
    type(group_factor), intent(in) :: self
    integer, intent(in) :: row(:)
    real(rk), intent(in) :: change(:, :, :) !< (3, 3, points) [N/m]
    real(rk), intent(in) :: share
    integer :: p
    is_near = size(row) == size(self%row)
    if (is_near) is_near = all(row == self%row)
    if (.not. is_near) return
    do p = 1, size(change, 3)
      is_near = maxval(abs(change(:, :, p) - self%change(:, :, p))) &
                <= share*maxval(abs(change(:, :, p)))
      if (.not. is_near) return
    end do
  end function is_near

  !> I - D G on some rows.
  subroutine form_matrix(compliance, row, change, matrix)
    real(rk), intent(in) :: compliance(:, :) !< G of the group [m/N]
    integer, intent(in) :: row(:)
    real(rk), intent(in) :: change(:, :, :) !< (3, 3, points) [N/m]
    real(rk), allocatable, intent(out) :: matrix(:, :)
    real(rk) :: d(num_axes, size(row))
    integer :: k, l, first(size(row))
    do k = 1, size(row)
      d(:, k) = -change(axis_of(row(k)), :, point_of(row(k)))
    end do
    first = row_of(point_of(row), 1)
    allocate (matrix(size(row), size(row)))
    do l = 1, size(row)
      associate (g => compliance(:, row(l)))
        do k = 1, size(row)
          matrix(k, l) = d(1, k)*g(first(k)) + d(2, k)*g(first(k) + 1) + d(3, k)*g(first(k) + 2)
        end do
      end associate
      matrix(l, l) = matrix(l, l) + 1.0_rk
    end do
  end subroutine form_matrix

  !> Solves for the rows of a group, in place; other rows are zero.
  subroutine solve_group(self, x)
    type(group_factor), intent(in) :: self
    real(rk), intent(inout) :: x(:) !< (rows of the group)
    real(rk) :: z(size(self%row), 1)
    z(:, 1) = x(self%row)
    if (self%single%is_there) then
      call solve_single(self%single, z(:, 1))
    else
      call solve_factored(self%factor, z)
    end if
    x = 0.0_rk
    x(self%row) = z(:, 1)
  end subroutine solve_group

  !> D x at all points.
  pure function apply_change(change, x) result(product)
    real(rk), intent(in) :: change(:, :, :) !< (3, 3, points) [N/m]
    real(rk), intent(in) :: x(:) !< (rows) [m]
    real(rk) :: product(size(x)) !< [N]
    integer :: p, row
    do p = 1, size(change, 3)
      row = row_of(p, 1)
      product(row:row + 2) = x(row)*change(:, 1, p) + x(row + 1)*change(:, 2, p) &
                             + x(row + 2)*change(:, 3, p)
    end do
  end function apply_change
end module tangent_factors
