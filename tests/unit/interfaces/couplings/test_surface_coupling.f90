!> Springs between two faces: their energy for motions whose distance is known (Eq. 8).
program test_surface_coupling
  use kinds, only: rk
  use surface_coupling, only: build_coupling, coupling
  use surface_segments, only: facet_set, surface_cover
  use testing, only: check, check_close, test_log
  use two_faces, only: even_lines, graded_lines, grid_face, rotation_about, turn
  implicit none
  type(test_log) :: log
  real(rk), allocatable :: x(:, :), u(:)
  type(facet_set) :: slave, master
  type(coupling) :: springs
  type(surface_cover) :: cover
  integer :: n

  log%suite = 'surface_coupling'
  call grid_face(graded_lines(5, 4.0_rk), even_lines(3, 0.0_rk, 1.0_rk), 0.0_rk, .true., x, slave)
  n = size(x, 2)
  call grid_face(even_lines(4, 0.0_rk, 1.0_rk), even_lines(5, 0.0_rk, 1.0_rk), 0.0_rk, .false., &
                 x, master)
  u = 2.0_rk + 3.0_rk*x(1, :) - x(2, :)
  call turn(rotation_about([1.0_rk, 0.4_rk, -0.2_rk], 0.8_rk), [2.0_rk, 0.0_rk, 1.0_rk], x)
  call build_coupling(x, slave, master, 5.0_rk, 'I', 'INTERFACE', springs, cover)
  call check(log, springs%name == 'I' .and. springs%keyword == 'INTERFACE', 'its names')
  call check_close(log, springs%stiffness, 5.0_rk, 0.0_rk, 'its stiffness')
  call check_close(log, energy(u), 0.0_rk, 1.0e-13_rk, 'one linear field on both faces: no force')
  u(n + 1:) = u(n + 1:) - 2.0_rk
  call check_close(log, energy(u), 4.0_rk, 1.0e-12_rk, 'apart by 2: its square')
  u(n + 1:) = 0.0_rk
  ! int (2 + 3 x - y)^2 over the unit square: mean 3, variances 9/12 and 1/12.
  call check_close(log, energy(u), 9.0_rk + 10.0_rk/12.0_rk, 1.0e-12_rk, 'a linear distance')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Sum of u (int N^T N dA) u over the segments: int (distance)^2 dA.
  real(rk) function energy(u)
    real(rk), intent(in) :: u(:) !< (nodes) displacement in one direction
    integer :: s
    energy = 0.0_rk
    do s = 1, size(springs%node, 2)
      energy = energy + dot_product(u(springs%node(:, s)), &
                                    matmul(springs%product(:, :, s), u(springs%node(:, s))))
    end do
  end function energy
end program test_surface_coupling
