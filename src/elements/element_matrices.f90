!> Matrices and vectors of blocks of solid elements, the same for all formulations.
!>
!> A call takes a block of elements of one material, say 64.
module element_matrices
  use kinds, only: rk
  use element_formulation, only: solid_element, strains_of_element
  use hex8_slopes, only: slopes_at_points, stiffness_of_slopes
  use shape_hex8, only: hex8_dofs, point_shape
  implicit none
  private
  public :: stiffness_matrices, consistent_masses, nodal_volumes, stress_forces

  !> Elements whose operators fit into the first-level cache (tools/bench/bench_elements).
  integer, parameter :: chunk = 4

contains

  !> K = sum w B^T D B (+ hourglass control) of each element of a block.
  subroutine stiffness_matrices(element, x, d, ke, status)
    class(solid_element), intent(in) :: element
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness [Pa]
    real(rk), contiguous, intent(out) :: ke(:, :, :) !< (24, 24, elements), symmetric [N/m]
    integer, intent(out) :: status(:) !< (elements) 0, or the worst corner when a Jacobian is <= 0
    integer :: e
    if (element%has_plain_strain) then
      call plain_stiffness(x, d, ke, status)
    else
      call general_stiffness(element, x, d, ke, status)
    end if
    do e = 1, size(x, 3)
      if (status(e) /= 0) ke(:, :, e) = 0.0_rk
    end do
  end subroutine stiffness_matrices

  !> K of elements whose strain is the symmetric gradient.
  pure subroutine plain_stiffness(x, d, ke, status)
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: d(6, 6) !< [Pa]
    real(rk), contiguous, intent(out) :: ke(:, :, :) !< (24, 24, elements) [N/m]
    integer, intent(out) :: status(:)
    real(rk) :: slope(8, 3, 8), weight(8)
    integer :: e
    do e = 1, size(x, 3)
      call slopes_at_points(x(:, :, e), slope, weight, status(e))
      call stiffness_of_slopes(slope, weight, d, ke(:, :, e))
    end do
  end subroutine plain_stiffness

  !> K from the strain operators.
  subroutine general_stiffness(element, x, d, ke, status)
    class(solid_element), intent(in) :: element
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: d(6, 6) !< [Pa]
    real(rk), contiguous, intent(out) :: ke(:, :, :) !< (24, 24, elements) [N/m]
    integer, intent(out) :: status(:)
    real(rk), allocatable :: b(:, :, :, :), weight(:, :)
    integer :: e, i, n
    allocate (b(6, hex8_dofs, element%num_points, chunk), weight(element%num_points, chunk))
    do e = 1, size(x, 3), chunk
      n = min(chunk, size(x, 3) - e + 1)
      call element%strain_operator(x(:, :, e:e + n - 1), d, b(:, :, :, :n), weight(:, :n), &
                                   status(e:e + n - 1))
      do i = 1, n
        call integrate_stiffness(element%num_points, b(:, :, :, i), d, weight(:, i), &
                                 ke(:, :, e + i - 1))
      end do
    end do
    call element%add_stabilisation(x, d, ke)
  end subroutine general_stiffness

  !> K of one element as one product of 24 x 6p and 6p x 24, columns in groups of eight below the
  !> diagonal.
  pure subroutine integrate_stiffness(num_points, b, d, weight, k)
    integer, intent(in) :: num_points
    real(rk), intent(in) :: b(6, hex8_dofs, num_points)
    real(rk), intent(in) :: d(6, 6), weight(num_points)
    real(rk), intent(out) :: k(hex8_dofs, hex8_dofs)
    real(rk) :: bt(hex8_dofs, 6*num_points), wdb(hex8_dofs, 6*num_points)
    integer :: q, i, j, row
    do q = 1, num_points
      row = 6*(q - 1)
      do i = 1, 6
        bt(:, row + i) = b(i, :, q)
      end do
      do i = 1, 6
        wdb(:, row + i) = weight(q)*(bt(:, row + 1)*d(1, i) + bt(:, row + 2)*d(2, i) &
                                     + bt(:, row + 3)*d(3, i) + bt(:, row + 4)*d(4, i) &
                                     + bt(:, row + 5)*d(5, i) + bt(:, row + 6)*d(6, i))
      end do
    end do
    call multiply_columns(6*num_points, bt, wdb, k)
    do j = 2, hex8_dofs
      k(:j - 1, j) = k(j, :j - 1)
    end do
  end subroutine integrate_stiffness

  !> K = A C^T for a symmetric result: columns 1-8 whole, the others below the diagonal blocks.
  pure subroutine multiply_columns(inner, a, c, k)
    integer, intent(in) :: inner
    real(rk), intent(in) :: a(hex8_dofs, inner), c(hex8_dofs, inner)
    real(rk), intent(out) :: k(hex8_dofs, hex8_dofs)
    integer, parameter :: group = 8
    real(rk) :: acc(group, 4)
    integer :: i, j, m, l
    do i = 1, hex8_dofs, group
      do j = 1, i + group - 1, 4
        acc = 0.0_rk
        do m = 1, inner
          do l = 1, 4
            acc(:, l) = acc(:, l) + a(i:i + group - 1, m)*c(j + l - 1, m)
          end do
        end do
        k(i:i + group - 1, j:j + 3) = acc
      end do
    end do
  end subroutine multiply_columns

  !> rho * integral of N_a N_b over each element, equal in the three directions.
  pure subroutine consistent_masses(x, density, mass)
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), intent(in) :: density !< [kg/m3]
    real(rk), contiguous, intent(out) :: mass(:, :, :) !< (8, 8, elements) [kg]
    real(rk) :: slope(8, 3, 8), weight(8), n(8)
    integer :: e, q, a, status
    mass = 0.0_rk
    do e = 1, size(x, 3)
      call slopes_at_points(x(:, :, e), slope, weight, status)
      do q = 1, 8
        n = point_shape(:, q)
        do a = 1, 8
          mass(:, a, e) = mass(:, a, e) + (density*weight(q)*n(a))*n
        end do
      end do
    end do
  end subroutine consistent_masses

  !> Integral of N_a over each element: the nodes' shares of the volume. Times rho it is the lumped
  !> mass (row sums, never negative), times rho g the consistent weight.
  pure subroutine nodal_volumes(x, volume)
    real(rk), contiguous, intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    real(rk), contiguous, intent(out) :: volume(:, :) !< (8, elements) [m3]
    real(rk) :: slope(8, 3, 8), weight(8)
    integer :: e, q, status
    volume = 0.0_rk
    do e = 1, size(x, 3)
      call slopes_at_points(x(:, :, e), slope, weight, status)
      do q = 1, 8
        volume(:, e) = volume(:, e) + weight(q)*point_shape(:, q)
      end do
    end do
  end subroutine nodal_volumes

  !> f = sum w B^T sigma of each element (without hourglass forces).
  pure subroutine stress_forces(b, weight, stress, force)
    real(rk), contiguous, intent(in) :: b(:, :, :, :) !< (6, 24, points, elements) [1/m]
    real(rk), contiguous, intent(in) :: weight(:, :) !< (points, elements) [m3]
    real(rk), contiguous, intent(in) :: stress(:, :, :) !< (6, points, elements) [Pa]
    real(rk), contiguous, intent(out) :: force(:, :) !< (24, elements) [N]
    integer :: e, q, i
    force = 0.0_rk
    do e = 1, size(b, 4)
      do q = 1, size(b, 3)
        do i = 1, hex8_dofs
          force(i, e) = force(i, e) + weight(q, e)*sum(b(:, i, q, e)*stress(:, q, e))
        end do
      end do
    end do
  end subroutine stress_forces
end module element_matrices
