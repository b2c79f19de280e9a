!> The acceleration that a dynamic step starts with: M a = r on the free unknowns.
!>
!> M is well conditioned once scaled by its diagonal, so conjugate gradients need some tens of
!> products and no factor. Unknowns without mass (a massless foundation) get no acceleration.
module initial_acceleration
  use kinds, only: rk
  use errors, only: error_type, raise
  use matrix_pattern, only: pattern, multiply, diagonal
  implicit none
  private
  public :: find_acceleration

  integer, parameter :: most_products = 1000
  real(rk), parameter :: tolerance = 1.0e-13_rk !< of the residual, in the norm of the scaled M
  real(rk), parameter :: massless = 1.0e-12_rk !< diagonal over its largest entry

contains

  !> Solves M a = r by conjugate gradients scaled with the diagonal.
  subroutine find_acceleration(matrix, mass, r, a, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk), intent(out) :: a(:) !< (num_total) zero on prescribed and massless unknowns [m/s2]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable, dimension(:) :: scale, rest, z, p, product
    real(rk) :: size_of_rest, first_size, last_size, curvature
    integer :: i
    a = 0.0_rk
    call invert_diagonal(matrix, mass, scale)
    rest = merge(r, 0.0_rk, scale > 0.0_rk)
    z = scale*rest
    p = z
    allocate (product(size(r)))
    size_of_rest = dot_product(rest, z)
    first_size = size_of_rest
    do i = 1, most_products
      if (size_of_rest <= tolerance**2*first_size) return
      call multiply(matrix, mass, p, product)
      product = merge(product, 0.0_rk, scale > 0.0_rk)
      curvature = dot_product(p, product)
      ! A direction without mass (added mass along one normal only) has no acceleration.
      if (curvature <= massless*dot_product(p/max(scale, tiny(1.0_rk)), p)) return
      a = a + size_of_rest/curvature*p
      rest = rest - size_of_rest/curvature*product
      z = scale*rest
      last_size = size_of_rest
      size_of_rest = dot_product(rest, z)
      p = z + size_of_rest/last_size*p
    end do
    call raise(error, 'no acceleration to start with: the mass matrix is not positive definite')
  end subroutine find_acceleration

  !> 1/diagonal; zero where there is no mass, and on prescribed unknowns.
  subroutine invert_diagonal(matrix, mass, scale)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    real(rk), allocatable, intent(out) :: scale(:) !< (num_total) [1/kg]
    real(rk) :: largest
    integer :: i
    allocate (scale(matrix%num_total))
    call diagonal(matrix, mass, scale)
    scale(matrix%num_free + 1:) = 0.0_rk
    largest = maxval(scale)
    do i = 1, matrix%num_total
      if (scale(i) > massless*largest) then
        scale(i) = 1.0_rk/scale(i)
      else
        scale(i) = 0.0_rk
      end if
    end do
  end subroutine invert_diagonal
end module initial_acceleration
