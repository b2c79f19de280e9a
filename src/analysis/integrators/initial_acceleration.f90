!> Initial acceleration of a dynamic step: M a = r on the free unknowns (theory.md, 7.1).
!>
!> With mass everywhere, M scaled by its diagonal is well conditioned: conjugate gradients need some
!> tens of products and no factor. Else massless_acceleration solves the constrained form.
module initial_acceleration
  use kinds, only: rk
  use ranks, only: is_true_everywhere
  use matrix_pattern, only: pattern
  use global_vectors, only: dot, largest_entry, multiply, diagonal
  implicit none
  private
  public :: find_acceleration, find_massive

  integer, parameter :: most_products = 1000
  real(rk), parameter :: tolerance = 1.0e-13_rk !< of the residual, in the norm of the scaled M
  real(rk), parameter :: massless = 1.0e-12_rk !< diagonal over its largest entry

contains

  !> Solves M a = r by conjugate gradients scaled by the diagonal. Stops where M has no mass.
  subroutine find_acceleration(matrix, mass, r, a, is_definite)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk), intent(out) :: a(:) !< (num_total) zero on prescribed unknowns [m/s2]
    logical, intent(out) :: is_definite !< `a` is the solution
    real(rk), allocatable, dimension(:) :: scale, rest, z, p, product
    real(rk) :: size_of_rest, first_size, last_size, curvature
    integer :: i
    a = 0.0_rk
    call invert_diagonal(matrix, mass, scale)
    is_definite = is_true_everywhere(all(scale(:matrix%num_free) > 0.0_rk))
    if (.not. is_definite) return
    rest = merge(r, 0.0_rk, scale > 0.0_rk)
    z = scale*rest
    p = z
    allocate (product(size(r)))
    size_of_rest = dot(matrix%part, rest, z)
    first_size = size_of_rest
    do i = 1, most_products
      is_definite = size_of_rest <= tolerance**2*first_size
      if (is_definite) return
      call multiply(matrix, mass, p, product)
      product = merge(product, 0.0_rk, scale > 0.0_rk)
      curvature = dot(matrix%part, p, product)
      if (curvature <= massless*dot(matrix%part, p/max(scale, tiny(1.0_rk)), p)) return
      a = a + size_of_rest/curvature*p
      rest = rest - size_of_rest/curvature*product
      z = scale*rest
      last_size = size_of_rest
      size_of_rest = dot(matrix%part, rest, z)
      p = z + size_of_rest/last_size*p
    end do
  end subroutine find_acceleration

  !> 1/diagonal; zero where there is no mass, and on prescribed unknowns.
  subroutine invert_diagonal(matrix, mass, scale)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    real(rk), allocatable, intent(out) :: scale(:) !< (num_total) [1/kg]
    logical, allocatable :: is_massive(:)
    allocate (scale(matrix%num_total))
    call diagonal(matrix, mass, scale)
    call find_massive(matrix, scale, is_massive)
    scale = merge(1.0_rk/merge(scale, 1.0_rk, is_massive), 0.0_rk, is_massive)
  end subroutine invert_diagonal

  !> Marks the free unknowns with mass.
  subroutine find_massive(matrix, diagonal_of_mass, is_massive)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: diagonal_of_mass(:) !< (num_total) [kg]
    logical, allocatable, intent(out) :: is_massive(:) !< (num_total)
    real(rk) :: own(size(diagonal_of_mass))
    own = diagonal_of_mass
    own(matrix%num_free + 1:) = 0.0_rk
    allocate (is_massive, source=own > massless*largest_entry(matrix%part, own))
  end subroutine find_massive
end module initial_acceleration
