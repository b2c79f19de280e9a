!> Operations that need all entries of a global vector: products, norms, sums, A x.
!>
!> A global vector has one entry for each unknown, or three for each point of the joints. All
!> higher rooms take their scalar products, norms, extremes and matrix products from here.
!>
!> A vector is whole on every rank, a shared matrix is not: products with the matrix are summed over
!> the ranks (large_models.md, 2). If vectors are divided too, this module is where an exchange
!> completes products and norms: entries on the border of two parts count once. Sums and multiples
!> of vectors need no exchange and are array expressions of the caller. The functions are not pure,
!> because an exchange is not.
module global_vectors
  use kinds, only: rk
  use matrix_pattern, only: pattern, multiply_local => multiply, diagonal_local => diagonal
  use ranks, only: add_over_ranks
  implicit none
  private
  public :: dot, norm, distance, length, total, work, largest_entry, multiply, diagonal

  !> Euclidean norm by `norm2`, which scales and can neither overflow nor underflow.
  interface norm
    module procedure norm_of_vector, norm_of_field
  end interface norm

  !> Norm of a difference, by `norm2`.
  interface distance
    module procedure distance_of_vectors, distance_of_fields
  end interface distance

contains

  !> Scalar product x . y.
  real(rk) function dot(x, y)
    real(rk), intent(in) :: x(:), y(:) !< of one size
    dot = dot_product(x, y)
  end function dot

  !> sqrt(x . x).
  real(rk) function norm_of_vector(x) result(norm)
    real(rk), intent(in) :: x(:)
    norm = norm2(x)
  end function norm_of_vector

  !> Norm of a field.
  real(rk) function norm_of_field(x) result(norm)
    real(rk), intent(in) :: x(:, :) !< (components, nodes or points)
    norm = norm2(x)
  end function norm_of_field

  !> sqrt((x - y) . (x - y)), without an array for the difference.
  real(rk) function distance_of_vectors(x, y) result(distance)
    real(rk), intent(in) :: x(:), y(:) !< of one size
    distance = norm2(x - y)
  end function distance_of_vectors

  !> Norm of the difference of two fields.
  real(rk) function distance_of_fields(x, y) result(distance)
    real(rk), intent(in) :: x(:, :), y(:, :) !< (components, nodes or points)
    distance = norm2(x - y)
  end function distance_of_fields

  !> du . (f0 + f1)/2: the work of the mean of two forces.
  real(rk) function work(du, f0, f1)
    real(rk), intent(in) :: du(:), f0(:), f1(:) !< of one size
    integer :: i
    work = 0.0_rk
    do i = 1, size(du)
      work = work + du(i)*(f0(i) + f1(i))
    end do
    work = 0.5_rk*work
  end function work

  !> sqrt(x . x) by one sum of squares: quicker than `norm`, but overflows above 1e154. The two
  !> results differ by round-off.
  real(rk) function length(x)
    real(rk), intent(in) :: x(:)
    length = sqrt(dot_product(x, x))
  end function length

  !> Sum of all entries.
  real(rk) function total(x)
    real(rk), intent(in) :: x(:)
    total = sum(x)
  end function total

  !> The largest entry; -huge for an empty vector.
  real(rk) function largest_entry(x)
    real(rk), intent(in) :: x(:)
    largest_entry = maxval(x)
  end function largest_entry

  !> y = A x over all unknowns, prescribed ones included.
  subroutine multiply(matrix, values, x, y)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of A
    real(rk), intent(in) :: x(:) !< (num_total)
    real(rk), contiguous, intent(out) :: y(:) !< (num_total)
    call multiply_local(matrix, values, x, y)
    if (matrix%is_shared) call add_over_ranks(y)
  end subroutine multiply

  !> The diagonal of A.
  subroutine diagonal(matrix, values, d)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of A
    real(rk), contiguous, intent(out) :: d(:) !< (num_total)
    call diagonal_local(matrix, values, d)
    if (matrix%is_shared) call add_over_ranks(d)
  end subroutine diagonal
end module global_vectors
