!> Modes within the space of some shapes.
!>
!> Where rock has no mass, some shapes have hardly any, and frequencies above those of the others by
!> many orders of magnitude, whose round-off would hide the others. So the inverse is solved for,
!> with Cholesky's factor of the stiffness: its largest values are the lowest frequencies.
module shape_modes
  use column_products, only: multiply_columns
  use dense_products, only: transposed_times
  use errors, only: error_type
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use pivoted_cholesky, only: factorise_kept, pivoted_factor, solve_half, solve_rest
  use step_system, only: dam_system
  use symmetric_modes, only: find_modes
  implicit none
  private
  public :: find_shape_modes

  !> A shape is left out if the others leave so little of its stiffness.
  real(rk), parameter :: noise_share = 1.0e-13_rk

contains

  !> The modes in ascending order: Psi times a column of `rotation` has unit mass. Shapes without
  !> mass have none.
  subroutine find_shape_modes(system, stiffness, shapes, frequency, rotation, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: stiffness(:) !< values of K, positive definite on the shapes
    real(rk), intent(in) :: shapes(:, :) !< (num_free, shapes) Psi
    real(rk), allocatable, intent(out) :: frequency(:) !< (modes) squared, circular [1/s2]
    real(rk), allocatable, intent(out) :: rotation(:, :) !< (shapes, modes)
    type(error_type), allocatable, intent(out) :: error
    type(pivoted_factor) :: factor
    real(rk), allocatable :: own(:, :), mass(:, :), half(:, :), flexibility(:), vector(:, :)
    integer :: k, n
    own = product_of(system%matrix, stiffness, shapes)
    mass = product_of(system%mass_pattern, system%mass_entries, shapes)
    call factorise_kept(own, [(noise_share*own(k, k), k=1, size(own, 1))], factor)
    n = size(factor%kept)
    half = mass(factor%kept, factor%kept)
    call solve_half(factor, half)
    half = transpose(half)
    call solve_half(factor, half)
    call find_modes(0.5_rk*(half + transpose(half)), flexibility, vector, error)
    if (allocated(error)) return
    vector = vector(:, n:1:-1)
    flexibility = flexibility(n:1:-1)
    call solve_rest(factor, vector)
    n = 0
    if (size(flexibility) > 0) n = count(flexibility > noise_share*flexibility(1))
    frequency = 1.0_rk/flexibility(:n)
    allocate (rotation(size(shapes, 2), n), source=0.0_rk)
    do k = 1, n
      rotation(factor%kept, k) = sqrt(frequency(k))*vector(:, k)
    end do
  end subroutine find_shape_modes

  !> Psi^T A Psi.
  function product_of(matrix, values, shapes) result(product)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:) !< A
    real(rk), intent(in) :: shapes(:, :) !< (num_free, shapes)
    real(rk), allocatable :: product(:, :) !< (shapes, shapes)
    real(rk), allocatable :: work(:, :)
    allocate (work, mold=shapes)
    call multiply_columns(matrix, values, shapes, work)
    product = transposed_times(shapes, work)
    product = 0.5_rk*(product + transpose(product))
  end function product_of
end module shape_modes
