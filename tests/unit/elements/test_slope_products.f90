!> Strains and forces of a distorted hexahedron: a field with constant gradient is exact, forces are
!> the transpose of strains, and both copies agree.
program test_slope_products
  use hex8_slopes, only: add_forces_of_slopes, slopes_at_points, strains_of_slopes
  use kinds, only: rk
  use shape_hex8, only: hex8_dofs
  use slope_products, only: add_forces_of_stress, find_symmetric_gradient
  use testing, only: check_close, repeat_chance, test_log
  implicit none
  real(rk), parameter :: cube(3, 8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
                                               0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])
  real(rk), parameter :: roundoff = 1.0e-13_rk !< of sums of some hundred numbers of about 1
  type(test_log) :: log
  real(rk) :: x(3, 8), slope(8, 3, 8), weight(8), u(hex8_dofs), gradient(3, 3), exact(6)
  real(rk) :: strain(6, 8), plain(6, 8), stress(8, 6), force(hex8_dofs), other(hex8_dofs)
  integer :: status, q
  log%suite = 'slope_products'
  call repeat_chance(1)
  call random_number(x)
  x = cube + 0.2_rk*x
  call slopes_at_points(x, slope, weight, status)
  if (status /= 0) error stop 2
  call random_number(gradient)
  u = reshape(matmul(gradient, x), [hex8_dofs])
  exact = [gradient(1, 1), gradient(2, 2), gradient(3, 3), gradient(1, 2) + gradient(2, 1), &
           gradient(1, 3) + gradient(3, 1), gradient(2, 3) + gradient(3, 2)]
  call find_symmetric_gradient(slope, u, strain)
  call check_close(log, maxval(abs(strain - spread(exact, 2, 8))), 0.0_rk, roundoff, 'gradient')
  call random_number(u)
  call find_symmetric_gradient(slope, u, strain)
  call strains_of_slopes(slope, u, plain)
  call check_close(log, maxval(abs(strain - plain)), 0.0_rk, roundoff, 'both copies, strain')
  call random_number(stress)
  force = 1.0_rk
  call add_forces_of_stress(slope, stress, force)
  other = 1.0_rk
  call add_forces_of_slopes(slope, stress, other)
  call check_close(log, maxval(abs(force - other)), 0.0_rk, roundoff, 'both copies, forces')
  call check_close(log, dot_product(force - 1.0_rk, u), &
                   sum([(dot_product(stress(q, :), strain(:, q)), q=1, 8)]), &
                   100.0_rk*roundoff, 'transpose')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_slope_products
