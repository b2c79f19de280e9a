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
  use global_vectors, only: dot, norm, largest_entry, multiply, diagonal
  use analysis_state, only: vibration_mode
  use assemble_forces, only: inertia_force
  use linear_solver, only: equation_solver
  use arpack, only: lanczos
  use ranks, only: num_ranks, starts_of_ranks, this_rank
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: list_massive, find_modes, solve_modes, estimate_modes, num_massive, points_down

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

  !> Free unknowns with mass; where vectors are divided the own ones of this rank.
  function list_massive(matrix, mass) result(massive)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    integer, allocatable :: massive(:)
    real(rk) :: d(matrix%num_total)
    integer :: j
    call diagonal(matrix, mass, d)
    massive = pack([(j, j=1, matrix%num_free)], d(:matrix%num_free) > 0.0_rk &
                   .and. matrix%part%owns(matrix%num_free))
  end function list_massive

  !> Number of free unknowns with mass: the most modes there can be.
  integer function num_massive(matrix, mass)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    real(rk) :: number(1)
    number = size(list_massive(matrix, mass))
    call matrix%part%add_shares(number)
    num_massive = nint(number(1))
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
    integer :: most
    most = num_massive(matrix, mass)
    if (most < num_modes) then
      call refuse(num_modes, most, error)
      return
    end if
    allocate (lambda(num_modes), phi(matrix%num_free, num_modes))
    if (most <= max(few, num_modes + 1)) then
      call condense(matrix, mass, solver, most, lambda, phi, error)
    else
      call lanczos(matrix, mass, solver, min(2*num_modes + 10, most), tolerance, lambda, phi, error)
    end if
    if (.not. allocated(error)) call sort_modes(matrix%part, lambda, phi)
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
  subroutine condense(matrix, mass, solver, num_rows, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: num_rows !< unknowns with mass
    real(rk), intent(out) :: lambda(:), phi(:, :)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: g(:, :), m(:, :), mu(:), work(:)
    integer, allocatable :: unknown(:)
    integer :: k, n, status
    n = num_rows
    allocate (mu(n), work(70*n))
    call place_massive(matrix, mass, n, unknown)
    call condense_mass(matrix, mass, solver, unknown, g, m, error)
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
      call spread_mode(matrix, mass, solver, unknown, sqrt(lambda(k))*m(:, n + 1 - k), lambda(k), &
                       phi(:, k:k), error)
      if (allocated(error)) return
    end do
  end subroutine condense

  !> Unknowns with mass in the rows of the dense problem, rank by rank; 0 for those that other ranks
  !> own.
  subroutine place_massive(matrix, mass, num_rows, unknown)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    integer, intent(in) :: num_rows
    integer, allocatable, intent(out) :: unknown(:) !< (rows)
    integer, allocatable :: own(:)
    integer :: first(num_ranks() + 1), before
    own = list_massive(matrix, mass)
    first = starts_of_ranks(size(own))
    before = merge(first(this_rank() + 1), 0, matrix%part%is_divided)
    allocate (unknown(num_rows), source=0)
    unknown(before + 1:before + size(own)) = own
  end subroutine place_massive

  !> The vector with some values in the unknowns with mass.
  subroutine spread_massive(matrix, unknown, values, x)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: unknown(:) !< (rows)
    real(rk), intent(in) :: values(:) !< (rows)
    real(rk), contiguous, intent(out) :: x(:) !< (num_total)
    x = 0.0_rk
    x(pack(unknown, unknown > 0)) = pack(values, unknown > 0)
    if (matrix%part%is_divided) call matrix%part%add(x)
  end subroutine spread_massive

  !> Flexibility and mass of the unknowns with mass.
  subroutine condense_mass(matrix, mass, solver, unknown, g, m, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: unknown(:) !< (rows)
    real(rk), allocatable, intent(out) :: g(:, :), m(:, :) !< (rows, rows)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: x(:, :), y(:)
    integer, allocatable :: rows(:)
    integer :: k, i
    allocate (g(size(unknown), size(unknown)), m(size(unknown), size(unknown)), source=0.0_rk)
    allocate (x(matrix%num_total, 1), y(matrix%num_total))
    rows = pack([(k, k=1, size(unknown))], unknown > 0)
    do k = 1, size(unknown)
      call spread_massive(matrix, unknown, [(merge(1.0_rk, 0.0_rk, i == k), i=1, size(unknown))], &
                          x(:, 1))
      call multiply(matrix, mass, x(:, 1), y)
      m(rows, k) = y(unknown(rows))
      call solver%solve(x(:matrix%num_free, :), error)
      if (allocated(error)) return
      g(rows, k) = x(unknown(rows), 1)
    end do
    call matrix%part%add_shares(g)
    call matrix%part%add_shares(m)
  end subroutine condense_mass

  !> All components of a mode from those with mass: phi = lambda K^-1 M phi.
  subroutine spread_mode(matrix, mass, solver, unknown, part, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    integer, intent(in) :: unknown(:) !< (rows)
    real(rk), intent(in) :: part(:), lambda
    real(rk), intent(out) :: phi(:, :) !< (num_free, 1)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: x(:), y(:)
    allocate (x(matrix%num_total), y(matrix%num_total))
    call spread_massive(matrix, unknown, lambda*part, x)
    call multiply(matrix, mass, x, y)
    phi(:, 1) = y(:matrix%num_free)
    call solver%solve(phi, error)
  end subroutine spread_mode

  !> Ascending; the largest component of each mode is positive.
  subroutine sort_modes(part, lambda, phi)
    type(unknown_part), intent(in) :: part
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
      if (points_down(part, swap)) phi(:, k) = -swap
      deallocate (swap)
    end do
  end subroutine sort_modes

  !> Whether the entry with the largest magnitude is negative.
  logical function points_down(part, x)
    type(unknown_part), intent(in) :: part
    real(rk), intent(in) :: x(:)
    if (part%is_divided) then
      points_down = largest_entry(part, -x) > largest_entry(part, x)
    else
      points_down = x(maxloc(abs(x), 1)) < 0.0_rk
    end if
  end function points_down

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
      associate (part => matrix%part)
        residual = norm(part, elastic - lambda(k)*inertia)/norm(part, elastic)
        noise = min(roundoff*norm(part, d*x)/norm(part, elastic), largest_noise)
      end associate
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
      modes(k)%effective_mass = [(dot(matrix%part, q, force(:, i))**2, i=1, num_directions)]
      modes(k)%shape = zero_vectors(numbers%num_nodes)
      call numbers%expand(q, modes(k)%shape)
    end do
  end subroutine describe_modes
end module eigen_modes
