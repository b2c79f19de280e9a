!> Time of the element matrices, per element, on one thread.
program bench_elements
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use element_matrices, only: consistent_masses, stiffness_matrices
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use shape_hex8, only: corner
  implicit none
  integer, parameter :: block = 64, repeats = 400
  character(8), parameter :: names(4) = ['C3D8    ', 'C3D8B   ', 'C3D8I   ', 'C3D8R   ']
  class(solid_element), allocatable :: element
  type(elastic_law) :: law
  real(rk) :: d(6, 6), x(3, 8, block), ke(24, 24, block), mass(8, 8, block), total, start
  integer :: status(block), i, r

  law = elastic_law(young=25.0e9_rk, poisson=0.2_rk)
  call law%elastic_stiffness(d)
  do i = 1, block
    x(:, :, i) = corner + 0.1_rk*sin(real(i, rk)*reshape([(real(r, rk), r=1, 24)], [3, 8]))
  end do
  total = 0.0_rk
  do i = 1, 4
    call make_solid(trim(names(i)), element)
    call cpu_time(start)
    do r = 1, repeats
      call stiffness_matrices(element, x, d, ke, status)
      total = total + ke(1, 1, 1)
    end do
    call report('stiffness '//names(i), start)
  end do
  call cpu_time(start)
  do r = 1, repeats
    call consistent_masses(x, 2400.0_rk, mass)
    total = total + mass(1, 1, 1)
  end do
  call report('consistent mass', start)
  if (total < 0.0_rk) error stop 1

contains

  !> Prints the time per element since `start`.
  subroutine report(what, start)
    character(*), intent(in) :: what
    real(rk), intent(in) :: start
    real(rk) :: now
    call cpu_time(now)
    write (*, '(a24,f8.2,a)') what, 1.0e6_rk*(now - start)/(block*repeats), ' us per element'
  end subroutine report
end program bench_elements
