!> Frequencies and modes: K phi = (2 pi f)^2 M phi by shift-invert at zero.
!>
!> M may be singular (massless rock, jumps of light joints). With few unknowns with mass the problem
!> is condensed on them and solved as a dense one, else by the Lanczos method.
module eigen_modes
  use kinds, only: rk
  use errors, only: error_type, raise
  use node_dofs, only: num_directions, zero_vectors
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use global_vectors, only: norm, distance, multiply, diagonal
  use analysis_state, only: vibration_mode
  use assemble_forces, only: inertia_force
  use linear_solver, only: equation_solver
  use arpack, only: lanczos
  implicit none
  private
  public :: list_massive, find_modes, solve_modes, estimate_modes, num_massive

  !> Of the iteration: of results, and of estimates.
  real(rk), parameter :: accurate = 1.0e-13_rk, rough = 1.0e-6_rk
  integer, parameter :: few = 200 !< most unknowns with mass for the dense problem
  real(rk), parameter :: smallest_share = 1.0e-12_rk !< smallest 1/f^2 of a mode, over the largest
  !> |K phi - w^2 M phi| over |K phi|, and the most where round-off is larger
  real(rk), parameter :: largest_residual = 1.0e-6_rk, largest_noise = 0.1_rk
  !> Round-off of the residual over |diag(K) phi|. Measured in thin plates and beams, up to 1000:1:
  !> 20 of the machine precision or less; the frequencies agree to 1e-5 there.
  real(rk), parameter :: roundoff = 100.0_rk*epsilon(1.0_rk)
  real(rk), parameter :: two_pi = 2.0_rk*acos(-1.0_rk)

  interface
    subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
      import :: rk
      implicit none
      integer, intent(in) :: itype, n, lda, ldb, lwork
      character, intent(in) :: jobz, uplo
      real(rk), intent(inout) :: a(lda, n), b(ldb, n)
      real(rk), intent(out) :: w(n), work(lwork)
      integer, intent(out) :: info
    end subroutine dsygv
  end interface

contains

  !> Computes the lowest modes, ascending, with unit modal mass and their effective masses.
  subroutine find_modes(matrix, numbers, stiffness, mass, solver, num_modes, modes, error)
    type(pattern), intent(in) :: matrix
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: stiffness(:) !< values of K, closed joints included
    real(rk), intent(in) :: mass(:) !< values of M, added mass included
    class(equation_solver), intent(inout) :: solver !< holds the factor of `stiffness`
    integer, intent(in) :: num_modes
    type(vibration_mode), allocatable, intent(out) :: modes(:)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: lambda(:), phi(:, :)
    call solve_modes(matrix, stiffness, mass, solver, num_modes, lambda, phi, error)
    if (.not. allocated(error)) call describe_modes(matrix, numbers, mass, lambda, phi, modes)
  end subroutine find_modes

  !> Free unknowns with mass.
  function list_massive(matrix, mass) result(massive)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    integer, allocatable :: massive(:)
    real(rk) :: d(matrix%num_total)
    integer :: j
    call diagonal(matrix, mass, d)
    allocate (massive, source=pack([(j, j=1, matrix%num_free)], d(:matrix%num_free) > 0.0_rk))
  end function list_massive

  !> Number of free unknowns with mass: the most modes there can be.
  integer function num_massive(matrix, mass)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    num_massive = size(list_massive(matrix, mass))
  end function num_massive

  !> The lowest modes in the unknowns, ascending, with unit modal mass.
  subroutine solve_modes(matrix, stiffness, mass, solver, num_modes, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: stiffness(:) !< values of K, closed joints included
    real(rk), intent(in) :: mass(:) !< values of M, added mass included
    class(equation_solver), intent(inout) :: solver !< holds the factor of `stiffness`
    integer, intent(in) :: num_modes
    real(rk), allocatable, intent(out) :: lambda(:) !< (modes) squared circular frequency [1/s2]
    real(rk), allocatable, intent(out) :: phi(:, :) !< (num_free, modes)
    type(error_type), allocatable, intent(out) :: error
    call find_lowest(matrix, mass, solver, num_modes, accurate, lambda, phi, error)
    if (allocated(error)) return
    call check_residuals(matrix, stiffness, mass, lambda, phi, error)
  end subroutine solve_modes

  !> The same for estimates: two thirds of the work, frequencies to 12 digits, shapes to 6.
  subroutine estimate_modes(matrix, mass, solver, num_modes, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M, added mass included
    class(equation_solver), intent(inout) :: solver !< holds the factor of K
    integer, intent(in) :: num_modes
    real(rk), allocatable, intent(out) :: lambda(:) !< (modes) squared circular frequency [1/s2]
    real(rk), allocatable, intent(out) :: phi(:, :) !< (num_free, modes)
    type(error_type), allocatable, intent(out) :: error
    call find_lowest(matrix, mass, solver, num_modes, rough, lambda, phi, error)
  end subroutine estimate_modes

  !> The lowest modes, by one of two methods.
  subroutine find_lowest(matrix, mass, solver, num_modes, tolerance, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: num_modes
    real(rk), intent(in) :: tolerance !< of the iteration
    real(rk), allocatable, intent(out) :: lambda(:), phi(:, :)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: massive(:)
    massive = list_massive(matrix, mass)
    if (size(massive) < num_modes) then
      call refuse(num_modes, size(massive), error)
      return
    end if
    allocate (lambda(num_modes), phi(matrix%num_free, num_modes))
    if (size(massive) <= max(few, num_modes + 1)) then
      call condense(matrix, mass, solver, massive, lambda, phi, error)
    else
      call lanczos(matrix, mass, solver, min(2*num_modes + 10, size(massive)), tolerance, lambda, &
                   phi, error)
    end if
    if (.not. allocated(error)) call sort_modes(lambda, phi)
  end subroutine find_lowest

  !> Error: more modes are requested than exist.
  subroutine refuse(num_modes, num_massive, error)
    integer, intent(in) :: num_modes, num_massive
    type(error_type), allocatable, intent(out) :: error
    character(120) :: text
    write (text, '(2(i0,a))') num_modes, ' modes are requested, but only ', num_massive, &
      ' free degrees of freedom have mass'
    call raise(error, trim(text))
  end subroutine refuse

  !> Dense: G M y = y/lambda with G the flexibility of the unknowns with mass.
  subroutine condense(matrix, mass, solver, massive, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: massive(:)
    real(rk), intent(out) :: lambda(:), phi(:, :)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: g(:, :), m(:, :), mu(:), work(:)
    integer :: k, n, status
    n = size(massive)
    allocate (mu(n), work(70*n))
    call condense_mass(matrix, mass, solver, massive, g, m, error)
    if (allocated(error)) return
    ! The vectors overwrite m and are scaled to y^T G^-1 y = 1, so that y^T M y = mu.
    call dsygv(3, 'V', 'L', n, m, n, g, n, mu, work, size(work), status)
    if (status /= 0) then
      call raise(error, 'the dense eigenvalue problem failed')
    else if (mu(n - size(lambda) + 1) < smallest_share*mu(n)) then
      call refuse(size(lambda), count(mu >= smallest_share*mu(n)), error)
    end if
    if (allocated(error)) return
    do k = 1, size(lambda)
      lambda(k) = 1.0_rk/mu(n + 1 - k)
      call spread_mode(matrix, mass, solver, massive, sqrt(lambda(k))*m(:, n + 1 - k), lambda(k), &
                       phi(:, k:k), error)
      if (allocated(error)) return
    end do
  end subroutine condense

  !> Flexibility and mass of the unknowns with mass.
  subroutine condense_mass(matrix, mass, solver, massive, g, m, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: massive(:)
    real(rk), allocatable, intent(out) :: g(:, :), m(:, :) !< (massive, massive)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: x(:, :), y(:)
    integer :: k
    allocate (g(size(massive), size(massive)), m(size(massive), size(massive)))
    allocate (x(matrix%num_total, 1), y(matrix%num_total))
    do k = 1, size(massive)
      x = 0.0_rk
      x(massive(k), 1) = 1.0_rk
      call multiply(matrix, mass, x(:, 1), y)
      m(:, k) = y(massive)
      call solver%solve(x(:matrix%num_free, :), error)
      if (allocated(error)) return
      g(:, k) = x(massive, 1)
    end do
  end subroutine condense_mass

  !> All components of a mode from those with mass: phi = lambda K^-1 M phi.
  subroutine spread_mode(matrix, mass, solver, massive, part, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: massive(:)
    real(rk), intent(in) :: part(:), lambda
    real(rk), intent(out) :: phi(:, :) !< (num_free, 1)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: x(:), y(:)
    allocate (x(matrix%num_total), y(matrix%num_total))
    x = 0.0_rk
    x(massive) = lambda*part
    call multiply(matrix, mass, x, y)
    phi(:, 1) = y(:matrix%num_free)
    call solver%solve(phi, error)
  end subroutine spread_mode

  !> Ascending; the largest component of each mode is positive.
  pure subroutine sort_modes(lambda, phi)
    real(rk), intent(inout) :: lambda(:), phi(:, :)
    real(rk), allocatable :: swap(:)
    real(rk) :: lowest
    integer :: k, other
    do k = 1, size(lambda)
      other = k - 1 + minloc(lambda(k:), 1)
      lowest = lambda(other)
      lambda(other) = lambda(k)
      lambda(k) = lowest
      allocate (swap(size(phi, 1)), source=phi(:, other))
      phi(:, other) = phi(:, k)
      phi(:, k) = swap
      if (swap(maxloc(abs(swap), 1)) < 0.0_rk) phi(:, k) = -swap
      deallocate (swap)
    end do
  end subroutine sort_modes

  !> Error if a mode does not satisfy its equation. In a slender body the forces of an element are
  !> many times K phi: their round-off is the residual that can be had.
  subroutine check_residuals(matrix, stiffness, mass, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: stiffness(:), mass(:), lambda(:), phi(:, :)
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(matrix%num_total) :: x, elastic, inertia, d
    character(120) :: text
    real(rk) :: residual, noise
    integer :: k
    call diagonal(matrix, stiffness, d)
    x = 0.0_rk
    do k = 1, size(lambda)
      x(:matrix%num_free) = phi(:, k)
      call multiply(matrix, stiffness, x, elastic)
      call multiply(matrix, mass, x, inertia)
      elastic(matrix%num_free + 1:) = 0.0_rk
      inertia(matrix%num_free + 1:) = 0.0_rk
      residual = distance(elastic, lambda(k)*inertia)/norm(elastic)
      noise = min(roundoff*norm(d*x)/norm(elastic), largest_noise)
      if (residual <= max(largest_residual, noise)) cycle
      write (text, '(a,i0,2(a,es8.1))') 'mode ', k, ' does not satisfy its equation: residual ', &
        residual, ' of its forces, expected at most ', max(largest_residual, noise)
      call raise(error, trim(text))
      return
    end do
  end subroutine check_residuals

  !> Frequencies, shapes on the nodes, effective masses (phi^T M r)^2.
  subroutine describe_modes(matrix, numbers, mass, lambda, phi, modes)
    type(pattern), intent(in) :: matrix
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: mass(:), lambda(:), phi(:, :)
    type(vibration_mode), allocatable, intent(out) :: modes(:)
    real(rk), allocatable :: force(:, :), q(:)
    integer :: k, i
    allocate (modes(size(lambda)), force(matrix%num_total, num_directions), q(matrix%num_total))
    do i = 1, num_directions
      call inertia_force(numbers, matrix, mass, i, force(:, i))
    end do
    q = 0.0_rk
    do k = 1, size(lambda)
      q(:matrix%num_free) = phi(:, k)
      modes(k)%hz = sqrt(lambda(k))/two_pi
      modes(k)%effective_mass = matmul(q, force)**2
      modes(k)%shape = zero_vectors(numbers%num_nodes)
      call numbers%expand(q, modes(k)%shape)
    end do
  end subroutine describe_modes
end module eigen_modes
