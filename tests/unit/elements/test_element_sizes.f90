!> Widths that crack bands can have in elements of several shapes.
program test_element_sizes
  use dam_mesh, only: fe_mesh
  use element_sizes, only: measure_widths
  use gauss_rules, only: hex_point
  use kinds, only: rk
  use shape_hex8, only: corner
  use testing, only: check_close, test_log
  implicit none
  real(rk), parameter :: roundoff = 1.0e-14_rk !< a few operations on numbers near 1
  type(test_log) :: log

  log%suite = 'element_sizes'
  call brick_and_taper(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A brick of 1 x 2 x 5 has its shortest and its longest edge, whatever its formulation. One whose
  !> height goes linearly from 1 to 3 along x has at its points those of the map
  !> x = xi, y = eta, z = zeta (2 + xi)/2: edges (2, 0, zeta), (0, 2, 0), (0, 0, 2 + xi).
  subroutine brick_and_taper(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    real(rk) :: smallest(3), largest(3), point
    integer :: i
    mesh%num_elements = 3
    mesh%num_nodes = 16
    mesh%element_type = ['C3D8    ', 'C3D8R   ', 'C3D8    ']
    mesh%nodes = reshape([[(i, i=1, 8)], [(i, i=1, 8)], [(i, i=9, 16)]], [8, 3])
    allocate (mesh%x(3, 16))
    do i = 1, 8
      mesh%x(:, i) = 0.5_rk*corner(:, i)*[1.0_rk, 2.0_rk, 5.0_rk]
      mesh%x(:, 8 + i) = [corner(1, i), corner(2, i), &
                          corner(3, i)*(2.0_rk + corner(1, i))/2.0_rk]
    end do
    call measure_widths(mesh, [1, 2, 3], smallest, largest)
    call check_close(log, smallest(1), 1.0_rk, 25.0_rk*roundoff, 'brick, across')
    call check_close(log, largest(1), 5.0_rk, 5.0_rk*roundoff, 'brick, along')
    call check_close(log, largest(2), 5.0_rk, 5.0_rk*roundoff, 'brick, one point')
    point = hex_point(1, 2) ! 1/sqrt(3)
    call check_close(log, largest(3), largest_of(2.0_rk, point, 2.0_rk + point), roundoff*10.0_rk, &
                     'taper')
  end subroutine brick_and_taper

  !> Larger singular value of [[a, 0], [b, c]].
  pure real(rk) function largest_of(a, b, c)
    real(rk), intent(in) :: a, b, c
    real(rk) :: square
    square = a**2 + b**2 + c**2
    largest_of = sqrt(0.5_rk*(square + sqrt(square**2 - 4.0_rk*(a*c)**2)))
  end function largest_of
end program test_element_sizes
