!> Shapes of a reduced model, made orthogonal (theory.md, 7.4).
module shape_orthogonality
  use column_products, only: multiply_columns
  use dense_products, only: subtract_times, transposed_times
  use global_vectors, only: dot
  use kinds, only: rk
  use step_system, only: dam_system
  implicit none
  private
  public :: orthonormalise, orthonormalise_all

  !> A shape whose part beyond the others is less than this of its own size is left out, and one
  !> that loses half of this part when it is made orthogonal again: the part is round-off.
  real(rk), parameter :: least_part = 1.0e-9_rk, least_rest = 0.5_rk
  !> A shape of which massless solids have left less than this of its size is round-off: what the
  !> factor of K + h M leaves of a shape in the massless solids alone.
  real(rk), parameter :: least_left = 1.0e-6_rk
  integer, parameter :: block_size = 16 !< shapes at once, for products of matrices

contains

  !> Makes shapes orthogonal to each other with K + s M and their size one, which it was before
  !> massless solids followed the others. Those of which little is left are taken out.
  subroutine orthonormalise_all(system, shift, shapes)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: shift !< s [1/s2]
    real(rk), allocatable, intent(inout) :: shapes(:, :) !< (num_free, shapes)
    real(rk), allocatable :: measure(:), block(:, :), product(:, :)
    integer :: first, num_kept
    measure = system%stiffness + shift*system%mass
    num_kept = 0
    do first = 1, size(shapes, 2), block_size
      block = shapes(:, first:min(first + block_size - 1, size(shapes, 2)))
      allocate (product, mold=block)
      call multiply_columns(system%matrix, measure, block, product)
      call separate_twice(system, measure, shapes(:, :num_kept), least_left, block, product)
      deallocate (product)
      shapes(:, num_kept + 1:num_kept + size(block, 2)) = block
      num_kept = num_kept + size(block, 2)
    end do
    shapes = shapes(:, :num_kept)
  end subroutine orthonormalise_all

  !> Makes the shapes of a block orthogonal to the others and to each other with the stiffness,
  !> twice against round-off, and their size one. Shapes without a part beyond the others are taken
  !> out.
  subroutine orthonormalise(system, measure, others, block)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: measure(:) !< values of the stiffness
    real(rk), intent(in), contiguous :: others(:, :) !< (num_free, shapes)
    real(rk), allocatable, intent(inout) :: block(:, :) !< (num_free, shapes)
    real(rk), allocatable :: product(:, :) ! stiffness times the block
    real(rk) :: length
    integer :: k
    allocate (product, mold=block)
    call multiply_columns(system%matrix, measure, block, product)
    do k = 1, size(block, 2)
      length = sqrt(max(0.0_rk, dot(block(:, k), product(:, k))))
      if (.not. length > 0.0_rk) cycle
      block(:, k) = block(:, k)/length
      product(:, k) = product(:, k)/length
    end do
    call separate_twice(system, measure, others, least_part, block, product)
  end subroutine orthonormalise

  !> Makes the shapes of a block orthogonal to the others and to each other, twice against
  !> round-off, and their size one. Those with a part of less than `least` beyond the others are
  !> taken out.
  subroutine separate_twice(system, measure, others, least, block, product)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: measure(:) !< values of the stiffness
    real(rk), intent(in), contiguous :: others(:, :) !< (num_free, shapes)
    real(rk), intent(in) :: least
    real(rk), allocatable, intent(inout) :: block(:, :) !< (num_free, shapes)
    real(rk), allocatable, intent(inout) :: product(:, :) !< stiffness times the block
    integer :: pass
    do pass = 1, 2
      call subtract_times(others, transposed_times(others, product), block)
      call multiply_columns(system%matrix, measure, block, product)
      call separate(merge(least, least_rest, pass == 1), block, product)
    end do
  end subroutine separate_twice

  !> Makes the shapes of a block orthogonal to each other and their size one. Those that are not
  !> longer than `least` then are taken out.
  subroutine separate(least, block, product)
    real(rk), intent(in) :: least
    real(rk), allocatable, intent(inout) :: block(:, :), product(:, :) !< and its forces
    real(rk) :: length
    integer :: k, j, n
    n = 0
    do k = 1, size(block, 2)
      do j = 1, n
        associate (part => dot(product(:, j), block(:, k)))
          block(:, k) = block(:, k) - part*block(:, j)
          product(:, k) = product(:, k) - part*product(:, j)
        end associate
      end do
      length = sqrt(max(0.0_rk, dot(block(:, k), product(:, k))))
      if (.not. length > least) cycle
      n = n + 1
      block(:, n) = block(:, k)/length
      product(:, n) = product(:, k)/length
    end do
    block = block(:, :n)
    product = product(:, :n)
  end subroutine separate
end module shape_orthogonality
