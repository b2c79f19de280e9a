!> Eigenvalues and eigenvectors of a small symmetric matrix (LAPACK).
module symmetric_modes
  use errors, only: error_type, raise, system_failed
  use kinds, only: rk
  implicit none
  private
  public :: find_modes, null_space

  !> Eigenvalues below this fraction of the largest one count as zero.
  real(rk), parameter :: rank_tolerance = 1.0e-10_rk

  interface
    subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
      import :: rk
      implicit none
      character, intent(in) :: jobz, uplo
      integer, intent(in) :: n, lda, lwork
      real(rk), intent(inout) :: a(lda, n)
      real(rk), intent(out) :: w(n), work(lwork)
      integer, intent(out) :: info
    end subroutine dsyev
  end interface

contains

  !> Eigenvalues in ascending order and orthonormal eigenvectors.
  subroutine find_modes(matrix, values, vectors, error)
    real(rk), intent(in) :: matrix(:, :) !< symmetric
    real(rk), allocatable, intent(out) :: values(:)
    real(rk), allocatable, intent(out) :: vectors(:, :) !< by columns
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: work(:)
    integer :: n, info
    n = size(matrix, 1)
    vectors = matrix
    allocate (values(n), work(max(1, 34*n)))
    info = 0
    if (n > 0) call dsyev('V', 'U', n, vectors, n, values, work, size(work), info)
    if (info /= 0) then
      call raise(error, 'LAPACK (dsyev) does not find the eigenvalues of a symmetric matrix', &
                 system_failed)
    end if
  end subroutine find_modes

  !> An orthonormal basis of the null space of a positive semidefinite matrix.
  subroutine null_space(matrix, vectors, error)
    real(rk), intent(in) :: matrix(:, :) !< symmetric
    real(rk), allocatable, intent(out) :: vectors(:, :) !< by columns
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: values(:), all_vectors(:, :)
    integer :: n
    call find_modes(matrix, values, all_vectors, error)
    if (allocated(error)) return
    n = 0
    if (size(values) > 0) n = count(values <= rank_tolerance*max(values(size(values)), &
                                                                 tiny(1.0_rk)))
    vectors = all_vectors(:, :n)
  end subroutine null_space
end module symmetric_modes
