!> The largest eigenvalues of K^-1 M by ARPACK (Lanczos with implicit restarts, inner product M).
module arpack
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use kinds, only: rk
  use errors, only: error_type, raise
  use matrix_pattern, only: pattern
  use global_vectors, only: multiply
  use linear_solver, only: equation_solver
  implicit none
  private
  public :: lanczos

  integer, parameter :: most_restarts = 300

  !> Values of `request`, from the manual of ARPACK.
  integer, parameter :: first_product = -1, product = 1, product_of_mass = 2, done = 99
  integer, parameter :: shift_and_invert = 3, exact_shifts = 1

  ! The arguments are those of ARPACK's dsaupd and dseupd; where vectors are divided among ranks,
  ! those of PARPACK with the own entries of each rank.
  interface
    subroutine keyway_iterate_arpack(is_divided, request, n, nev, tolerance, residual, ncv, v, &
                                     iparam, ipntr, workd, workl, lworkl, info) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: is_divided, n, nev, ncv, lworkl
      real(c_double), value :: tolerance
      integer(c_int), intent(inout) :: request, iparam(11), ipntr(11), info
      real(c_double), intent(inout) :: residual(n), v(n, ncv), workd(3*n), workl(lworkl)
    end subroutine keyway_iterate_arpack

    subroutine keyway_extract_arpack(is_divided, choice, d, z, n, nev, tolerance, residual, ncv, &
                                     v, iparam, ipntr, workd, workl, lworkl, info) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: is_divided, n, nev, ncv, lworkl
      real(c_double), value :: tolerance
      integer(c_int), intent(inout) :: choice(ncv), iparam(11), ipntr(11), info
      real(c_double), intent(inout) :: d(nev), z(n, nev)
      real(c_double), intent(inout) :: residual(n), v(n, ncv), workd(3*n), workl(lworkl)
    end subroutine keyway_extract_arpack
  end interface

  !> Data that ARPACK needs between its requests.
  type :: workspace
    integer(c_int) :: parameters(11) = 0, places(11) = 0, is_divided = 0
    integer(c_int) :: n = 0 !< entries of a vector on this rank, at least 1
    integer, allocatable :: own(:) !< their unknowns; a rank without one has an entry that is zero
    real(rk), allocatable :: residual(:), basis(:, :), vectors(:), small(:)
  end type workspace

contains

  !> The lowest eigenvalues of K phi = lambda M phi and vectors with phi^T M phi = 1.
  subroutine lanczos(matrix, mass, solver, num_basis, tolerance, lambda, phi, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    class(equation_solver), intent(inout) :: solver !< holds the factor of K
    integer, intent(in) :: num_basis !< Lanczos vectors, more than eigenvalues wanted
    real(rk), intent(in) :: tolerance !< of |K^-1 M phi - phi/lambda| over |phi|/lambda, norm of M
    real(rk), contiguous, intent(out) :: lambda(:) !< (modes) [1/s2]
    real(rk), intent(out) :: phi(:, :) !< (num_free, modes)
    type(error_type), allocatable, intent(out) :: error
    type(workspace) :: work
    integer(c_int) :: request, status
    call open_workspace(matrix, num_basis, work)
    request = 0
    status = 1
    do while (request /= done)
      call keyway_iterate_arpack(work%is_divided, request, work%n, size(lambda, kind=c_int), &
                                 tolerance, work%residual, int(num_basis, c_int), work%basis, &
                                 work%parameters, work%places, work%vectors, work%small, &
                                 size(work%small, kind=c_int), status)
      call apply_request(request, matrix, mass, solver, work, error)
      if (allocated(error)) return
    end do
    if (status == 0) call extract_modes(matrix, tolerance, work, lambda, phi, status)
    if (status /= 0) call raise_failure(int(status), error)
  end subroutine lanczos

  !> Vectors of the own unknowns, and the start of the iteration.
  subroutine open_workspace(matrix, num_basis, work)
    type(pattern), intent(in) :: matrix
    integer, intent(in) :: num_basis
    type(workspace), intent(out) :: work
    integer, allocatable :: number(:) ! of each own unknown, on all ranks together
    integer :: k
    work%is_divided = merge(1_c_int, 0_c_int, matrix%part%is_divided)
    work%own = pack([(k, k=1, matrix%num_free)], matrix%part%owns(matrix%num_free))
    work%n = max(1_c_int, size(work%own, kind=c_int))
    associate (n => int(work%n))
      allocate (work%residual(n), work%basis(n, num_basis), work%vectors(3*n))
      allocate (work%small(num_basis*(num_basis + 8)))
      ! A fixed start makes runs reproducible; it has symmetric and antisymmetric parts.
      work%residual(:) = 0.0_rk
      number = [(k, k=1, size(work%own))]
      if (matrix%part%is_divided) number = matrix%layout%row(work%own) + 1
      work%residual(:size(number)) = 1.0_rk + 0.5_rk*sin(1.7_rk*number) &
                                     + 0.25_rk*cos(0.13_rk*number)
    end associate
    work%parameters(1) = exact_shifts
    work%parameters(3) = most_restarts
    work%parameters(7) = shift_and_invert
  end subroutine open_workspace

  !> Computes the product that ARPACK requests.
  subroutine apply_request(request, matrix, mass, solver, work, error)
    integer(c_int), intent(in) :: request
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    type(workspace), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: x(:), y(:, :)
    if (all(request /= [first_product, product, product_of_mass])) return
    allocate (x(matrix%num_total), y(matrix%num_total, 1))
    if (request == product) then
      call spread_own(matrix, work, work%vectors(work%places(3):), y(:, 1))
    else
      call spread_own(matrix, work, work%vectors(work%places(1):), x)
      call multiply(matrix, mass, x, y(:, 1))
    end if
    if (request /= product_of_mass) call solver%solve(y(:matrix%num_free, :), error)
    associate (first => work%places(2), answer => work%vectors)
      answer(first:first + work%n - 1) = 0.0_rk
      answer(first:first + size(work%own) - 1) = y(work%own, 1)
    end associate
  end subroutine apply_request

  !> A vector in all unknowns of this rank from the own entries of all ranks.
  subroutine spread_own(matrix, work, own, x)
    type(pattern), intent(in) :: matrix
    type(workspace), intent(in) :: work
    real(rk), intent(in) :: own(:) !< the first entries of it
    real(rk), contiguous, intent(out) :: x(:) !< (num_total)
    x = 0.0_rk
    x(work%own) = own(:size(work%own))
    if (matrix%part%is_divided) call matrix%part%add(x)
  end subroutine spread_own

  !> Computes the eigenvectors from the Lanczos vectors.
  subroutine extract_modes(matrix, tolerance, work, lambda, phi, status)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: tolerance
    type(workspace), intent(inout) :: work
    real(rk), contiguous, intent(out) :: lambda(:)
    real(rk), intent(out) :: phi(:, :) !< (num_free, modes)
    integer(c_int), intent(out) :: status
    integer(c_int) :: choice(size(work%basis, 2))
    real(rk) :: own(work%n, size(lambda)), x(matrix%num_total)
    integer :: k
    status = 0
    choice = 0
    lambda = 0.0_rk
    own = 0.0_rk
    call keyway_extract_arpack(work%is_divided, choice, lambda, own, work%n, &
                               size(lambda, kind=c_int), tolerance, work%residual, &
                               size(work%basis, 2, kind=c_int), work%basis, work%parameters, &
                               work%places, work%vectors, work%small, &
                               size(work%small, kind=c_int), status)
    do k = 1, size(lambda)
      call spread_own(matrix, work, own(:, k), x)
      phi(:, k) = x(:matrix%num_free)
    end do
    if (status == 0 .and. work%parameters(5) < size(lambda)) status = 1
  end subroutine extract_modes

  !> Raises the error of a status of ARPACK.
  subroutine raise_failure(status, error)
    integer, intent(in) :: status !< of ARPACK
    type(error_type), allocatable, intent(out) :: error
    character(80) :: text
    if (status == 1) then
      call raise(error, 'the frequencies did not converge')
    else
      write (text, '(a,i0,a)') 'ARPACK could not find the frequencies (info ', status, ')'
      call raise(error, trim(text))
    end if
  end subroutine raise_failure
end module arpack
