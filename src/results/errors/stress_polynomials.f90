!> Linear and quadratic stresses, fitted by least squares to the points of solids or to their means
!> (theory.md, 14.6).
module stress_polynomials
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use shape_hex8, only: point_shape
  use small_matrix, only: solve_dense
  use stress_fields, only: recovered_fields
  use recovery_plans, only: max_points
  implicit none
  private
  public :: stress_polynomial, linear_terms, quadratic_terms

  integer, parameter :: linear_terms = 4, quadratic_terms = 10 !< 1, x, y, z, their products
  !> Added to the squares of all terms but 1, over the number of points: a direction in which all
  !> points are level has none.
  real(rk), parameter :: share = 1.0e-9_rk

  !> The normal equations of a fit, and after `solve` its coefficients.
  type :: stress_polynomial
    integer :: num_terms = linear_terms
    real(rk) :: origin(3) = 0.0_rk, length = 1.0_rk !< of the coordinates of its terms [m]
    real(rk) :: normal(quadratic_terms, quadratic_terms) = 0.0_rk
    real(rk) :: found(quadratic_terms, 6) = 0.0_rk !< sums of stresses; then coefficients [Pa]
    integer :: num_points = 0
    real(rk), allocatable :: points(:, :) !< (terms, num_points or more) terms at the points
  contains
    procedure :: add_solid, solve, value_at, growth_at
    procedure, private :: terms_at, ridged, keep_point
  end type stress_polynomial

contains

  !> The terms at a place.
  pure function terms_at(self, x) result(terms)
    class(stress_polynomial), intent(in) :: self
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: terms(quadratic_terms), d(3)
    d = (x - self%origin)/self%length
    terms(:linear_terms) = [1.0_rk, d]
    terms(linear_terms + 1:) = [d(1)*d, d(2)*d(2:), d(3)*d(3)]
  end function terms_at

  !> Adds the points of a solid, or its mean.
  pure subroutine add_solid(self, mesh, stresses, solid, by_means)
    class(stress_polynomial), intent(inout) :: self
    type(fe_mesh), intent(in) :: mesh
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: solid
    logical, intent(in) :: by_means
    real(rk) :: x(3, max_points), stress(6, max_points), own(quadratic_terms)
    integer :: c, k, n, q, num_points
    num_points = stresses%plan%num_points(solid)
    stress(:, :num_points) = stresses%point_stress(:, :num_points, solid)
    associate (corners => mesh%x(:, mesh%nodes(:, stresses%plan%element_of_solid(solid))))
      if (by_means .or. num_points == 1) then
        x(:, 1) = sum(corners, dim=2)/max_points
        stress(:, 1) = sum(stress(:, :num_points), dim=2)/num_points
        num_points = 1
      else
        x = matmul(corners, point_shape)
      end if
    end associate
    n = self%num_terms
    do q = 1, num_points
      own = self%terms_at(x(:, q))
      call self%keep_point(own)
      do k = 1, n
        self%normal(:n, k) = self%normal(:n, k) + own(:n)*own(k)
      end do
      do c = 1, 6
        self%found(:n, c) = self%found(:n, c) + own(:n)*stress(c, q)
      end do
    end do
  end subroutine add_solid

  !> Keeps the terms at a point.
  pure subroutine keep_point(self, own)
    class(stress_polynomial), intent(inout) :: self
    real(rk), intent(in) :: own(:) !< (terms)
    real(rk) :: more(quadratic_terms, 2*self%num_points + max_points)
    if (.not. allocated(self%points)) allocate (self%points(quadratic_terms, 0))
    if (self%num_points == size(self%points, 2)) then
      more(:, :self%num_points) = self%points
      self%points = more
    end if
    self%num_points = self%num_points + 1
    self%points(:, self%num_points) = own
  end subroutine keep_point

  !> Finds the coefficients; the mean alone where the points do not determine them.
  subroutine solve(self)
    class(stress_polynomial), intent(inout) :: self
    real(rk) :: sums(self%num_terms, 6), coefficients(self%num_terms, 6)
    logical :: is_singular
    integer :: n
    n = self%num_terms
    sums = self%found(:n, :)
    call solve_dense(self%ridged(), sums, coefficients, is_singular)
    if (is_singular) then
      coefficients = 0.0_rk
      coefficients(1, :) = sums(1, :)/self%normal(1, 1)
    end if
    self%found(:n, :) = coefficients
  end subroutine solve

  !> The matrix of the normal equations.
  pure function ridged(self) result(matrix)
    class(stress_polynomial), intent(in) :: self
    real(rk) :: matrix(self%num_terms, self%num_terms)
    integer :: k
    matrix = self%normal(:self%num_terms, :self%num_terms)
    do k = 2, self%num_terms
      matrix(k, k) = matrix(k, k) + share*self%normal(1, 1)
    end do
  end function ridged

  !> How much differences of the stresses from the fit grow at a place: the norm of the weights that
  !> the stresses have in its value there.
  real(rk) function growth_at(self, x) result(growth)
    class(stress_polynomial), intent(in) :: self
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: own(quadratic_terms), way(self%num_terms, 1)
    logical :: is_singular
    integer :: n
    n = self%num_terms
    own = self%terms_at(x)
    call solve_dense(self%ridged(), reshape(own(:n), [n, 1]), way, is_singular)
    growth = huge(1.0_rk)
    if (.not. is_singular) growth = norm2(matmul(way(:, 1), self%points(:n, :self%num_points)))
  end function growth_at

  !> The stress of the fit at a place, once it is solved.
  pure function value_at(self, x) result(stress)
    class(stress_polynomial), intent(in) :: self
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: stress(6) !< [Pa]
    real(rk) :: own(quadratic_terms)
    own = self%terms_at(x)
    stress = matmul(own(:self%num_terms), self%found(:self%num_terms, :))
  end function value_at
end module stress_polynomials
