!> Two skew elements, clamped at one end: displacements as CalculiX 2.20 has them.
!>
!> The elements are parallelepipeds. On other shapes C3D8 still agrees; CalculiX's C3D8I leaves out
!> the ratio of determinants of Taylor's modes and its C3D8R the first two directions of the
!> hourglass vectors, so that neither passes the patch test there (docs/studies).
program test_against_calculix
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use element_matrices, only: stiffness_matrices
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use testing, only: check, check_close, test_log
  implicit none

  interface
    subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: rk
      implicit none
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      real(rk), intent(inout) :: a(36, 36), b(36)
      integer, intent(out) :: info
    end subroutine dposv
  end interface

  character(8), parameter :: names(3) = ['C3D8    ', 'C3D8I   ', 'C3D8R   ']
  !> Displacement of the last node, printed with seven digits.
  real(rk), parameter :: found(3, 3) = reshape([-2.294886e-3_rk, -1.307376e-3_rk, 9.559307e-3_rk, &
                                                -4.200514e-3_rk, -4.791836e-3_rk, 1.903984e-2_rk, &
                                                -6.039768e-2_rk, -6.195523e-2_rk, 2.563746e-1_rk], &
                                               [3, 3])
  type(test_log) :: log
  integer :: i

  log%suite = 'against_calculix'
  do i = 1, 3
    call skew_cantilever(names(i), found(:, i), log)
  end do
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> E = 25 GPa, nu = 0.3, four forces of 1 MN upwards at the free end.
  subroutine skew_cantilever(name, expected, log)
    character(*), intent(in) :: name
    real(rk), intent(in) :: expected(3)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    type(elastic_law) :: law
    real(rk) :: d(6, 6), x(3, 12), corners(3, 8, 2), ke(24, 24, 2), k(36, 36), u(36)
    integer :: nodes(8), dof(24), status(2), e, i, j, l, n, info
    n = 0
    do i = 0, 2
      do j = 0, 1
        do l = 0, 1
          n = n + 1
          x(:, n) = [1.5_rk*i + 0.2_rk*j, j + 0.3_rk*l, l + 0.1_rk*i]
        end do
      end do
    end do
    do e = 1, 2
      nodes = 4*(e - 1) + [1, 5, 7, 3, 2, 6, 8, 4]
      corners(:, :, e) = x(:, nodes)
    end do
    law = elastic_law(young=25.0e9_rk, poisson=0.3_rk)
    call law%elastic_stiffness(d)
    call make_solid(trim(name), element)
    call stiffness_matrices(element, corners, d, ke, status)
    k = 0.0_rk
    do e = 1, 2
      do i = 1, 3
        dof(i::3) = 3*(4*(e - 1) + [1, 5, 7, 3, 2, 6, 8, 4]) - 3 + i
      end do
      k(dof, dof) = k(dof, dof) + ke(:, :, e)
    end do
    k(:12, :) = 0.0_rk
    k(:, :12) = 0.0_rk
    do i = 1, 12
      k(i, i) = 1.0_rk
    end do
    u = 0.0_rk
    u(27::3) = 1.0e6_rk
    call dposv('U', 36, 1, k, 36, u, 36, info)
    call check(log, info == 0, name//': solved')
    do i = 1, 3
      call check_close(log, u(33 + i), expected(i), 0.6e-6_rk*abs(expected(i)), name//': tip')
    end do
  end subroutine skew_cantilever
end program test_against_calculix
