!> Initial acceleration of a dynamic step: M a = r on the free unknowns.
!>
!> M scaled by its diagonal is well conditioned, so conjugate gradients need some tens of products
!> and no factor. Unknowns without mass (a massless foundation) have no acceleration. Added mass
!> acts along the normal of a massless node; across the normal M is singular in directions that are
!> not unknowns. There conjugate gradients would diverge, and the least-squares solution of
!> smallest norm is taken.
module initial_acceleration
  use kinds, only: rk
  use errors, only: error_type, raise
  use matrix_pattern, only: pattern
  use global_vectors, only: dot, norm, largest_entry, multiply, diagonal
  implicit none
  private
  public :: find_acceleration

  integer, parameter :: most_products = 1000
  real(rk), parameter :: tolerance = 1.0e-13_rk !< of the residual, in the norm of the scaled M
  real(rk), parameter :: massless = 1.0e-12_rk !< diagonal over its largest entry

contains

  !> Solves M a = r in the directions with mass.
  subroutine find_acceleration(matrix, mass, node, r, a, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    integer, intent(in) :: node(:) !< (num_total) that each unknown belongs to
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk), intent(out) :: a(:) !< (num_total) zero on prescribed and massless unknowns [m/s2]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: scale(:)
    logical :: is_solved, is_semidefinite
    call invert_diagonal(matrix, mass, scale)
    call solve_definite(matrix, mass, scale, r, a, is_solved, is_semidefinite)
    if (is_semidefinite) then
      call scale_nodes(matrix, mass, node, scale)
      call solve_semidefinite(matrix, mass, scale, r, a, is_solved)
    end if
    if (is_solved) return
    call raise(error, 'no initial acceleration: the mass matrix is not positive definite')
  end subroutine find_acceleration

  !> Conjugate gradients scaled by the diagonal; stops at a direction without mass.
  subroutine solve_definite(matrix, mass, scale, r, a, is_solved, is_semidefinite)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:), scale(:), r(:)
    real(rk), intent(out) :: a(:)
    logical, intent(out) :: is_solved, is_semidefinite
    real(rk), allocatable, dimension(:) :: rest, z, p, product
    real(rk) :: size_of_rest, first_size, last_size, curvature
    integer :: i
    a = 0.0_rk
    rest = merge(r, 0.0_rk, scale > 0.0_rk)
    z = scale*rest
    p = z
    allocate (product(size(r)))
    size_of_rest = dot(rest, z)
    first_size = size_of_rest
    is_semidefinite = .false.
    do i = 1, most_products
      is_solved = size_of_rest <= tolerance**2*first_size
      if (is_solved) return
      call multiply(matrix, mass, p, product)
      product = merge(product, 0.0_rk, scale > 0.0_rk)
      curvature = dot(p, product)
      is_semidefinite = curvature <= massless*dot(p/max(scale, tiny(1.0_rk)), p)
      if (is_semidefinite) return
      a = a + size_of_rest/curvature*p
      rest = rest - size_of_rest/curvature*product
      z = scale*rest
      last_size = size_of_rest
      size_of_rest = dot(rest, z)
      p = z + size_of_rest/last_size*p
    end do
  end subroutine solve_definite

  !> Least squares |S (M a - r)| by conjugate gradients on the normal equations, with a = S y and
  !> the shortest y.
  subroutine solve_semidefinite(matrix, mass, s, r, a, is_solved)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    real(rk), intent(in) :: s(:) !< (num_total) diagonal of S
    real(rk), intent(in) :: r(:)
    real(rk), intent(out) :: a(:)
    logical, intent(out) :: is_solved
    real(rk), allocatable, dimension(:) :: y, rest, gradient, p, product
    real(rk) :: slope, last_slope, step, smallest_slope
    integer :: i
    allocate (y(size(r)), gradient(size(r)), product(size(r)))
    y = 0.0_rk
    rest = s*r
    smallest_slope = (tolerance*norm(rest))**2
    call multiply_scaled(rest, gradient)
    p = gradient
    slope = dot(gradient, gradient)
    do i = 1, most_products
      is_solved = slope <= smallest_slope
      if (is_solved) exit
      call multiply_scaled(p, product)
      step = slope/dot(product, product)
      y = y + step*p
      rest = rest - step*product
      call multiply_scaled(rest, gradient)
      last_slope = slope
      slope = dot(gradient, gradient)
      p = gradient + slope/last_slope*p
    end do
    a = s*y
  contains
    !> S M S x.
    subroutine multiply_scaled(x, answer)
      real(rk), intent(in) :: x(:)
      real(rk), intent(out) :: answer(:)
      call multiply(matrix, mass, s*x, answer)
      answer = s*answer
    end subroutine multiply_scaled
  end subroutine solve_semidefinite

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
    largest = largest_entry(scale)
    do i = 1, matrix%num_total
      if (scale(i) > massless*largest) then
        scale(i) = 1.0_rk/scale(i)
      else
        scale(i) = 0.0_rk
      end if
    end do
  end subroutine invert_diagonal

  !> 1/sqrt of the mass of a node, equal in all its directions, so that scaling keeps right angles;
  !> zero on nodes without mass and on prescribed unknowns.
  subroutine scale_nodes(matrix, mass, node, scale)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    integer, intent(in) :: node(:) !< (num_total)
    real(rk), intent(out) :: scale(:) !< (num_total) [1/sqrt(kg)]
    real(rk), allocatable :: own(:), total(:)
    real(rk) :: smallest
    integer :: k
    allocate (own(matrix%num_total), total(maxval(node)))
    call diagonal(matrix, mass, own)
    total = 0.0_rk
    do k = 1, matrix%num_free
      total(node(k)) = total(node(k)) + own(k)
    end do
    smallest = massless*largest_entry(total)
    scale = 0.0_rk
    do k = 1, matrix%num_free
      if (total(node(k)) > smallest) scale(k) = 1.0_rk/sqrt(total(node(k)))
    end do
  end subroutine scale_nodes
end module initial_acceleration
