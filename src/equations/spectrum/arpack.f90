!> The largest eigenvalues of K^-1 M by ARPACK (Lanczos with implicit restarts, inner product M).
module arpack
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

  ! The arguments are those of ARPACK.
  ! allow(assumed-size)
  interface
    subroutine dsaupd(ido, bmat, n, which, nev, tol, resid, ncv, v, ldv, iparam, ipntr, workd, &
                      workl, lworkl, info)
      import :: rk
      implicit none
      integer, intent(inout) :: ido, iparam(11), ipntr(11), info
      character(*), intent(in) :: bmat, which
      integer, intent(in) :: n, nev, ncv, ldv, lworkl
      real(rk), intent(in) :: tol
      real(rk), intent(inout) :: resid(*), v(ldv, *), workd(*), workl(*)
    end subroutine dsaupd

    subroutine dseupd(rvec, howmny, select, d, z, ldz, sigma, bmat, n, which, nev, tol, resid, &
                      ncv, v, ldv, iparam, ipntr, workd, workl, lworkl, info)
      import :: rk
      implicit none
      logical, intent(in) :: rvec
      character(*), intent(in) :: howmny, bmat, which
      integer, intent(in) :: ldz, n, nev, ncv, ldv, lworkl
      logical, intent(inout) :: select(*)
      real(rk), intent(inout) :: d(*), z(ldz, *), resid(*), v(ldv, *), workd(*), workl(*)
      real(rk), intent(in) :: sigma, tol
      integer, intent(inout) :: iparam(11), ipntr(11), info
    end subroutine dseupd
  end interface

  !> Data that ARPACK needs between its requests.
  type :: workspace
    integer :: parameters(11) = 0, places(11) = 0
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
    real(rk), intent(out) :: lambda(:) !< (modes) [1/s2]
    real(rk), intent(out) :: phi(:, :) !< (num_free, modes)
    type(error_type), allocatable, intent(out) :: error
    type(workspace) :: work
    integer :: k, n, request, status
    n = matrix%num_free
    allocate (work%residual(n), work%basis(n, num_basis), work%vectors(3*n))
    allocate (work%small(num_basis*(num_basis + 8)))
    ! A fixed start makes runs reproducible; it has symmetric and antisymmetric parts.
    work%residual(:) = [(1.0_rk + 0.5_rk*sin(1.7_rk*k) + 0.25_rk*cos(0.13_rk*k), k=1, n)]
    work%parameters(1) = exact_shifts
    work%parameters(3) = most_restarts
    work%parameters(7) = shift_and_invert
    request = 0
    status = 1
    do while (request /= done)
      call dsaupd(request, 'G', n, 'LM', size(lambda), tolerance, work%residual, num_basis, &
                  work%basis, n, work%parameters, work%places, work%vectors, work%small, &
                  size(work%small), status)
      call apply_request(request, matrix, mass, solver, work, error)
      if (allocated(error)) return
    end do
    if (status == 0) call extract_modes(n, num_basis, tolerance, work, lambda, phi, status)
    if (status /= 0) call raise_failure(status, error)
  end subroutine lanczos

  !> Computes the product that ARPACK requests.
  subroutine apply_request(request, matrix, mass, solver, work, error)
    integer, intent(in) :: request
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    type(workspace), intent(inout) :: work
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: x(:), y(:, :)
    integer :: n
    n = matrix%num_free
    if (all(request /= [first_product, product, product_of_mass])) return
    allocate (x(matrix%num_total), y(matrix%num_total, 1))
    x(n + 1:) = 0.0_rk
    if (request == product) then
      y(:n, 1) = work%vectors(work%places(3):work%places(3) + n - 1)
    else
      x(:n) = work%vectors(work%places(1):work%places(1) + n - 1)
      call multiply(matrix, mass, x, y(:, 1))
    end if
    if (request /= product_of_mass) call solver%solve(y(:n, :), error)
    work%vectors(work%places(2):work%places(2) + n - 1) = y(:n, 1)
  end subroutine apply_request

  !> Computes the eigenvectors from the Lanczos vectors.
  subroutine extract_modes(n, num_basis, tolerance, work, lambda, phi, status)
    integer, intent(in) :: n, num_basis
    real(rk), intent(in) :: tolerance
    type(workspace), intent(inout) :: work
    real(rk), intent(out) :: lambda(:), phi(:, :)
    integer, intent(out) :: status
    logical :: choice(num_basis)
    status = 0
    choice = .false.
    call dseupd(.true., 'A', choice, lambda, phi, n, 0.0_rk, 'G', n, 'LM', size(lambda), &
                tolerance, work%residual, num_basis, work%basis, n, work%parameters, &
                work%places, work%vectors, work%small, size(work%small), status)
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
