!> Operations that need all entries of a global vector: products, norms, sums, A x.
!>
!> A global vector has one entry for each unknown, or three for each point of the joints. All
!> higher rooms take their scalar products, norms, extremes and matrix products from here.
!>
!> Products with a shared matrix are summed over the ranks (large_models.md, 2). A vector over
!> points is whole on every rank. A vector over unknowns may be divided: `part` has the unknowns of
!> this rank, and each counts once. Sums and multiples of vectors need no exchange and are array
!> expressions of the caller. The functions are not pure, because an exchange is not.
module global_vectors
  use kinds, only: rk
  use matrix_pattern, only: pattern, multiply_local => multiply, diagonal_local => diagonal
  use ranks, only: of_all_ranks
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: dot, norm, distance, length, total, work, largest_entry, multiply, diagonal
  public :: num_free_in_all

  !> Scalar product x . y.
  interface dot
    module procedure dot_of_vectors, dot_of_parts
  end interface dot

  !> Euclidean norm by `norm2`, which scales and can neither overflow nor underflow.
  interface norm
    module procedure norm_of_vector, norm_of_field, norm_of_parts
  end interface norm

  !> sqrt(x . x) by one sum of squares: quicker than `norm`, but overflows above 1e154. The two
  !> results differ by round-off.
  interface length
    module procedure length_of_vector, length_of_parts
  end interface length

  !> du . (f0 + f1)/2: the work of the mean of two forces.
  interface work
    module procedure work_of_vectors, work_of_parts
  end interface work

  !> Sum of all entries.
  interface total
    module procedure total_of_vector, total_of_parts
  end interface total

  !> The largest entry; -huge for an empty vector.
  interface largest_entry
    module procedure largest_of_vector, largest_of_parts
  end interface largest_entry

  !> Norm of a difference, by `norm2`.
  interface distance
    module procedure distance_of_vectors, distance_of_fields
  end interface distance

contains

  !> Scalar product of whole vectors.
  real(rk) function dot_of_vectors(x, y) result(dot)
    real(rk), intent(in) :: x(:), y(:) !< of one size
    dot = dot_product(x, y)
  end function dot_of_vectors

  !> Scalar product of vectors over unknowns.
  real(rk) function dot_of_parts(part, x, y, skipped) result(dot)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:), y(:) !< of one size
    integer, intent(in), optional :: skipped !< unknowns before the first entry
    integer, allocatable :: run(:, :)
    integer :: k
    if (.not. part%is_divided) then
      dot = dot_product(x, y)
      return
    end if
    run = part%runs_within(size(x), skipped)
    dot = 0.0_rk
    do k = 1, size(run, 2)
      dot = dot + dot_product(x(run(1, k):run(2, k)), y(run(1, k):run(2, k)))
    end do
    dot = sum(of_all_ranks(dot))
  end function dot_of_parts

  !> sqrt(x . x).
  real(rk) function norm_of_vector(x) result(norm)
    real(rk), intent(in) :: x(:)
    norm = norm2(x)
  end function norm_of_vector

  !> Norm of a vector over unknowns.
  real(rk) function norm_of_parts(part, x, skipped) result(norm)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:)
    integer, intent(in), optional :: skipped !< unknowns before the first entry
    integer, allocatable :: run(:, :)
    integer :: k
    if (.not. part%is_divided) then
      norm = norm2(x)
      return
    end if
    run = part%runs_within(size(x), skipped)
    norm = norm2(of_all_ranks(norm2([(norm2(x(run(1, k):run(2, k))), k=1, size(run, 2))])))
  end function norm_of_parts

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

  !> The work of whole vectors.
  real(rk) function work_of_vectors(du, f0, f1) result(work)
    real(rk), intent(in) :: du(:), f0(:), f1(:) !< of one size
    integer :: i
    work = 0.0_rk
    do i = 1, size(du)
      work = work + du(i)*(f0(i) + f1(i))
    end do
    work = 0.5_rk*work
  end function work_of_vectors

  !> The work of vectors over unknowns.
  real(rk) function work_of_parts(part, du, f0, f1, skipped) result(work)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: du(:), f0(:), f1(:) !< of one size
    integer, intent(in), optional :: skipped !< unknowns before the first entry
    integer, allocatable :: run(:, :)
    integer :: k
    if (.not. part%is_divided) then
      work = work_of_vectors(du, f0, f1)
      return
    end if
    run = part%runs_within(size(du), skipped)
    work = 0.0_rk
    do k = 1, size(run, 2)
      associate (i => run(1, k), j => run(2, k))
        work = work + work_of_vectors(du(i:j), f0(i:j), f1(i:j))
      end associate
    end do
    work = sum(of_all_ranks(work))
  end function work_of_parts

  !> sqrt(x . x) of a whole vector.
  real(rk) function length_of_vector(x) result(length)
    real(rk), intent(in) :: x(:)
    length = sqrt(dot_product(x, x))
  end function length_of_vector

  !> sqrt(x . x) of a vector over unknowns.
  real(rk) function length_of_parts(part, x, skipped) result(length)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:)
    integer, intent(in), optional :: skipped !< unknowns before the first entry
    length = sqrt(dot_of_parts(part, x, x, skipped))
  end function length_of_parts

  !> Sum of a whole vector.
  real(rk) function total_of_vector(x) result(total)
    real(rk), intent(in) :: x(:)
    total = sum(x)
  end function total_of_vector

  !> Sum of a vector over unknowns.
  real(rk) function total_of_parts(part, x) result(total)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:)
    integer, allocatable :: run(:, :)
    integer :: k
    if (.not. part%is_divided) then
      total = sum(x)
      return
    end if
    run = part%runs_within(size(x))
    total = 0.0_rk
    do k = 1, size(run, 2)
      total = total + sum(x(run(1, k):run(2, k)))
    end do
    total = sum(of_all_ranks(total))
  end function total_of_parts

  !> The largest entry of a whole vector.
  real(rk) function largest_of_vector(x) result(largest)
    real(rk), intent(in) :: x(:)
    largest = maxval(x)
  end function largest_of_vector

  !> The largest entry of a vector over unknowns.
  real(rk) function largest_of_parts(part, x) result(largest)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:)
    largest = maxval(x)
    if (part%is_divided) largest = maxval(of_all_ranks(largest))
  end function largest_of_parts

  !> Free unknowns of all ranks, each once.
  integer function num_free_in_all(matrix) result(number)
    type(pattern), intent(in) :: matrix
    integer, allocatable :: run(:, :)
    number = matrix%num_free
    if (.not. matrix%part%is_divided) return
    run = matrix%part%runs_within(matrix%num_free)
    number = nint(sum(of_all_ranks(real(sum(run(2, :) - run(1, :) + 1), rk))))
  end function num_free_in_all

  !> y = A x over all unknowns, prescribed ones included.
  subroutine multiply(matrix, values, x, y)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of A
    real(rk), intent(in) :: x(:) !< (num_total)
    real(rk), contiguous, intent(out) :: y(:) !< (num_total)
    call multiply_local(matrix, values, x, y)
    if (matrix%is_shared) call matrix%part%add(y)
  end subroutine multiply

  !> The diagonal of A.
  subroutine diagonal(matrix, values, d)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< of A
    real(rk), contiguous, intent(out) :: d(:) !< (num_total)
    call diagonal_local(matrix, values, d)
    if (matrix%is_shared) call matrix%part%add(d)
  end subroutine diagonal
end module global_vectors
