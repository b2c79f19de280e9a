!> Small dense matrices: 2 x 2 and 3 x 3 in closed form, and Gauss elimination.
module small_matrix
  use kinds, only: rk
  implicit none
  private
  public :: cross_product, determinant3, invert3, outer_product, solve2, solve_dense

contains

  !> Determinant of a 3 x 3 matrix.
  pure real(rk) function determinant3(a) result(determinant)
    real(rk), intent(in) :: a(3, 3)
    determinant = dot_product(a(1, :), cross_product(a(2, :), a(3, :)))
  end function determinant3

  !> Inverse and determinant of a 3 x 3 matrix; the inverse is zero where the determinant is zero.
  pure subroutine invert3(a, inverse, determinant)
    real(rk), intent(in) :: a(3, 3)
    real(rk), intent(out) :: inverse(3, 3), determinant
    real(rk) :: row(3, 3), scale
    row = transpose(a)
    inverse(:, 1) = cross_product(row(:, 2), row(:, 3))
    inverse(:, 2) = cross_product(row(:, 3), row(:, 1))
    inverse(:, 3) = cross_product(row(:, 1), row(:, 2))
    determinant = dot_product(row(:, 1), inverse(:, 1))
    scale = 0.0_rk
    if (abs(determinant) > tiny(scale)) scale = 1.0_rk/determinant
    inverse = inverse*scale
  end subroutine invert3

  !> Solves A x = b for two unknowns by Cramer's rule; A must not be singular.
  pure function solve2(a, b) result(x)
    real(rk), intent(in) :: a(2, 2), b(2)
    real(rk) :: x(2)
    x = [a(2, 2)*b(1) - a(1, 2)*b(2), a(1, 1)*b(2) - a(2, 1)*b(1)] &
        /(a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1))
  end function solve2

  !> a x b
  pure function cross_product(a, b) result(product)
    real(rk), intent(in) :: a(3), b(3)
    real(rk) :: product(3)
    product(1) = a(2)*b(3) - a(3)*b(2)
    product(2) = a(3)*b(1) - a(1)*b(3)
    product(3) = a(1)*b(2) - a(2)*b(1)
  end function cross_product

  !> a b^T
  pure function outer_product(a, b) result(product)
    real(rk), intent(in) :: a(:), b(:)
    real(rk) :: product(size(a), size(b))
    integer :: j
    do j = 1, size(b)
      product(:, j) = a*b(j)
    end do
  end function outer_product

  !> Solves A X = B by elimination with row pivots.
  pure subroutine solve_dense(a, b, x, is_singular)
    real(rk), intent(in) :: a(:, :) !< n x n
    real(rk), intent(in) :: b(:, :) !< n x m
    real(rk), intent(out) :: x(:, :) !< n x m; undefined where the matrix is singular
    logical, intent(out) :: is_singular !< a pivot is zero
    real(rk) :: lu(size(a, 1), size(a, 1)), row(size(a, 1)), right(size(b, 2))
    integer :: n, i, k, pivot
    n = size(a, 1)
    is_singular = .false.
    lu = a
    x = b
    do k = 1, n
      pivot = k - 1 + maxloc(abs(lu(k:, k)), dim=1)
      is_singular = .not. abs(lu(pivot, k)) > 0.0_rk
      if (is_singular) return
      row = lu(pivot, :)
      lu(pivot, :) = lu(k, :)
      lu(k, :) = row
      right = x(pivot, :)
      x(pivot, :) = x(k, :)
      x(k, :) = right
      do i = k + 1, n
        row(1) = lu(i, k)/lu(k, k)
        lu(i, k + 1:) = lu(i, k + 1:) - row(1)*lu(k, k + 1:)
        x(i, :) = x(i, :) - row(1)*x(k, :)
      end do
    end do
    do k = n, 1, -1
      x(k, :) = x(k, :)/lu(k, k)
      do i = 1, k - 1
        x(i, :) = x(i, :) - lu(i, k)*x(k, :)
      end do
    end do
  end subroutine solve_dense
end module small_matrix
