!> Tensor utilities for UMATs, with names and meanings of their interface: ROTSIG, SINV,
!> SPRINC, SPRIND. Direct components come first, then 12, 13, 23; a kind of 1 means stress (tensor
!> shear), 2 strain (engineering shear).
module umat_utilities
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use tensor6, only: principal_axes
  implicit none
  private
  public :: rotsig, sinv, sprinc, sprind

  integer, parameter :: strain_kind = 2
  integer, parameter :: row_of_shear(3) = [1, 1, 2], column_of_shear(3) = [2, 3, 3]

contains

  !> The tensor rotated by R: R T R^T.
  subroutine rotsig(s, r, sprime, lstr, ndi, nshr) bind(c, name='rotsig_')
    integer(c_int), intent(in) :: lstr !< 1 stress, 2 strain
    integer(c_int), intent(in) :: ndi, nshr !< direct and shear components
    real(c_double), intent(in) :: s(ndi + nshr), r(3, 3)
    real(c_double), intent(out) :: sprime(ndi + nshr)
    sprime = components(matmul(r, matmul(matrix_of(s, lstr, ndi), transpose(r))), lstr, ndi, nshr)
  end subroutine rotsig

  !> Mean stress and the equivalent stress of von Mises.
  subroutine sinv(stress, sinv1, sinv2, ndi, nshr) bind(c, name='sinv_')
    integer(c_int), intent(in) :: ndi, nshr
    real(c_double), intent(in) :: stress(ndi + nshr)
    real(c_double), intent(out) :: sinv1 !< trace/3
    real(c_double), intent(out) :: sinv2 !< sqrt(3/2 s:s) of the deviator s
    real(c_double) :: deviator(3, 3)
    integer :: i
    deviator = matrix_of(stress, 1, ndi)
    sinv1 = (deviator(1, 1) + deviator(2, 2) + deviator(3, 3))/3.0_c_double
    do i = 1, 3
      deviator(i, i) = deviator(i, i) - sinv1
    end do
    sinv2 = sqrt(1.5_c_double*sum(deviator**2))
  end subroutine sinv

  !> Principal values, the largest first.
  subroutine sprinc(s, ps, lstr, ndi, nshr) bind(c, name='sprinc_')
    integer(c_int), intent(in) :: lstr !< 1 stress, 2 strain
    integer(c_int), intent(in) :: ndi, nshr
    real(c_double), intent(in) :: s(ndi + nshr)
    real(c_double), intent(out) :: ps(3)
    real(c_double) :: an(3, 3)
    call sprind(s, ps, an, lstr, ndi, nshr)
  end subroutine sprinc

  !> Principal values, the largest first, and their directions.
  subroutine sprind(s, ps, an, lstr, ndi, nshr) bind(c, name='sprind_')
    integer(c_int), intent(in) :: lstr !< 1 stress, 2 strain
    integer(c_int), intent(in) :: ndi, nshr
    real(c_double), intent(in) :: s(ndi + nshr)
    real(c_double), intent(out) :: ps(3)
    real(c_double), intent(out) :: an(3, 3) !< row k is the unit vector of ps(k)
    real(c_double) :: matrix(3, 3), axes(3, 3)
    matrix = matrix_of(s, lstr, ndi)
    call principal_axes([matrix(1, 1), matrix(2, 2), matrix(3, 3), matrix(1, 2), matrix(1, 3), &
                         matrix(2, 3)], ps, axes)
    an = transpose(axes)
  end subroutine sprind

  !> The tensor as a matrix; missing components are zero.
  pure function matrix_of(s, lstr, ndi) result(matrix)
    real(c_double), intent(in) :: s(:)
    integer, intent(in) :: lstr, ndi
    real(c_double) :: matrix(3, 3), factor
    integer :: i
    factor = merge(0.5_c_double, 1.0_c_double, lstr == strain_kind)
    matrix = 0.0_c_double
    do i = 1, ndi
      matrix(i, i) = s(i)
    end do
    do i = 1, size(s) - ndi
      matrix(row_of_shear(i), column_of_shear(i)) = factor*s(ndi + i)
      matrix(column_of_shear(i), row_of_shear(i)) = factor*s(ndi + i)
    end do
  end function matrix_of

  !> The matrix as components.
  pure function components(matrix, lstr, ndi, nshr) result(s)
    real(c_double), intent(in) :: matrix(3, 3)
    integer, intent(in) :: lstr, ndi, nshr
    real(c_double) :: s(ndi + nshr)
    integer :: i
    do i = 1, ndi
      s(i) = matrix(i, i)
    end do
    do i = 1, nshr
      s(ndi + i) = matrix(row_of_shear(i), column_of_shear(i))
    end do
    if (lstr == strain_kind) s(ndi + 1:) = 2.0_c_double*s(ndi + 1:)
  end function components
end module umat_utilities
