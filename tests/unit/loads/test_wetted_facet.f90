!> Facets cut by the water level, against closed forms.
program test_wetted_facet
  use kinds, only: rk
  use testing, only: check_close, test_log
  use wetted_facet, only: water_body, wet_facet, integrate_wet_part
  implicit none
  type(test_log) :: log

  log%suite = 'wetted_facet'
  call upright_square(log)
  call tilted_trapezoid(log)
  call diamond_on_its_corner(log)
  call triangle(log)
  call dry_and_level(log)
  call collapsed(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A square 1 x 1 wetted up to h: force h**2/2, moment h**3/6 about the bottom, root 2/3 h**1.5.
  subroutine upright_square(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: x(3, 4) = reshape(real([0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1], rk), [3, 4])
    type(wet_facet) :: wet
    real(rk) :: h
    integer :: i
    do i = 1, 4
      h = 0.3_rk*i
      call integrate_wet_part(x, water_body(level=h), wet)
      if (h > 1.0_rk) then
        call check_close(log, sum(wet%head(1, :)), h - 0.5_rk, 1.0e-14_rk, 'force under water')
        call check_close(log, sum(wet%root), (h**1.5_rk - (h - 1.0_rk)**1.5_rk)/1.5_rk, &
                         1.0e-14_rk, 'root under water')
        call check_close(log, sum(wet%root*x(3, :)), 0.4_rk*(h**2.5_rk - 0.2_rk**2.5_rk)*(-1.0_rk) &
                         + h*(h**1.5_rk - 0.2_rk**1.5_rk)/1.5_rk, 1.0e-14_rk, 'moment of the root')
      else
        call check_close(log, sum(wet%area(1, :)), h, 1.0e-14_rk, 'wetted area')
        call check_close(log, sum(wet%head(1, :)), h**2/2.0_rk, 1.0e-14_rk, 'force')
        call check_close(log, sum(wet%head(1, :)*x(3, :)), h**3/6.0_rk, 1.0e-14_rk, 'moment')
        call check_close(log, sum(wet%root), h**1.5_rk/1.5_rk, 1.0e-14_rk, 'root')
      end if
    end do
    call integrate_wet_part(x, water_body(level=0.9_rk, bed=0.4_rk), wet)
    call check_close(log, sum(wet%area(1, :)), 0.5_rk, 1.0e-14_rk, 'cut by the bed')
    call check_close(log, sum(wet%head(1, :)), 0.125_rk, 1.0e-14_rk, 'force above the bed')
  end subroutine upright_square

  !> A trapezoid in a tilted plane, cut askew: force and moments against sums over strips.
  subroutine tilted_trapezoid(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: flat(2, 4) = reshape([0.0_rk, 0.0_rk, 3.0_rk, 0.2_rk, 2.2_rk, 1.5_rk, &
                                                 0.4_rk, 1.1_rk], [2, 4])
    real(rk), parameter :: e1(3) = [0.8_rk, 0.0_rk, 0.6_rk], e2(3) = [-0.36_rk, 0.8_rk, 0.48_rk]
    real(rk), parameter :: level = 1.2_rk
    type(wet_facet) :: wet
    real(rk) :: x(3, 4), s, low, high, bottom, top, slice, force, moment(2)
    integer :: i, j
    integer, parameter :: strips = 3000
    x = spread(e1, 2, 4)*spread(flat(1, :), 1, 3) + spread(e2, 2, 4)*spread(flat(2, :), 1, 3)
    call integrate_wet_part(x, water_body(level=level), wet)
    force = 0.0_rk
    moment = 0.0_rk
    do i = 1, strips
      s = 3.0_rk*(i - 0.5_rk)/strips
      call section(flat, s, low, high)
      high = min(high, (level - 0.6_rk*s)/0.48_rk)
      if (high <= low) cycle
      do j = 1, 2
        bottom = 0.5_rk*(low + high) + (j - 1.5_rk)*(high - low)/sqrt(3.0_rk)
        top = level - 0.6_rk*s - 0.48_rk*bottom
        slice = 0.5_rk*top*(high - low)*3.0_rk/strips
        force = force + slice
        moment = moment + slice*[s, bottom]
      end do
    end do
    call check_close(log, norm2(sum(wet%head, 2)), force, 3.0e-6_rk, 'force on the cut facet')
    do i = 1, 2
      call check_close(log, norm2(matmul(wet%head, flat(i, :))), moment(i), 3.0e-6_rk, &
                       'moment on the cut facet')
    end do
  end subroutine tilted_trapezoid

  !> Lower and upper boundary of a convex quadrilateral at the abscissa s.
  subroutine section(flat, s, low, high)
    real(rk), intent(in) :: flat(2, 4), s
    real(rk), intent(out) :: low, high
    real(rk) :: a(2), b(2), y
    integer :: i
    low = huge(low)
    high = -huge(high)
    do i = 1, 4
      a = flat(:, i)
      b = flat(:, mod(i, 4) + 1)
      if ((a(1) - s)*(b(1) - s) > 0.0_rk) cycle
      y = a(2) + (s - a(1))/(b(1) - a(1))*(b(2) - a(2))
      low = min(low, y)
      high = max(high, y)
    end do
  end subroutine section

  !> A square on its corner, wetted to half its height: integral of y over a triangle, h = 1.
  subroutine diamond_on_its_corner(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: x(3, 4) = reshape(real([0, 0, 0, 0, 1, 1, 0, 0, 2, 0, -1, 1], rk), &
                                             [3, 4])
    type(wet_facet) :: wet
    call integrate_wet_part(x, water_body(level=1.0_rk), wet)
    call check_close(log, sum(wet%area(1, :)), 1.0_rk, 1.0e-14_rk, 'half of it')
    call check_close(log, sum(wet%head(1, :)), 1.0_rk/3.0_rk, 1.0e-14_rk, 'force')
    call check_close(log, sum(wet%root), 2.0_rk*(2.0_rk/3.0_rk - 0.4_rk), 1.0e-14_rk, 'root')
    call check_close(log, sum(wet%root*x(3, :)), 32.0_rk/105.0_rk, 1.0e-14_rk, 'its moment')
  end subroutine diamond_on_its_corner

  !> A facet with a repeated node, tip up, wetted to half its height.
  subroutine triangle(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: x(3, 4) = reshape(real([0, 0, 0, 0, 2, 0, 0, 1, 2, 0, 1, 2], rk), [3, 4])
    type(wet_facet) :: wet
    call integrate_wet_part(x, water_body(level=1.0_rk), wet)
    call check_close(log, sum(wet%area(1, :)), 1.5_rk, 1.0e-14_rk, 'area')
    call check_close(log, sum(wet%head(1, :)), 1.0_rk - 1.0_rk/6.0_rk, 1.0e-14_rk, 'force')
    call check_close(log, sum(wet%head(1, :)*x(2, :)), 1.0_rk - 1.0_rk/6.0_rk, 1.0e-14_rk, 'middle')
    call check_close(log, sum(wet%root), 2.0_rk/3.0_rk + 0.4_rk, 1.0e-14_rk, 'root')
  end subroutine triangle

  !> Above the level, and a horizontal floor at a depth.
  subroutine dry_and_level(log)
    type(test_log), intent(inout) :: log
    real(rk), parameter :: x(3, 4) = reshape(real([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], rk), [3, 4])
    type(wet_facet) :: wet
    call integrate_wet_part(x, water_body(level=-0.1_rk), wet)
    call check_close(log, maxval(abs(wet%head)) + maxval(abs(wet%area)), 0.0_rk, 0.0_rk, 'dry')
    call integrate_wet_part(x, water_body(level=0.0_rk), wet)
    call check_close(log, sum(wet%root), 0.0_rk, 0.0_rk, 'at the level')
    call integrate_wet_part(x, water_body(level=4.0_rk), wet)
    call check_close(log, sum(wet%root), 2.0_rk, 1.0e-14_rk, 'floor')
  end subroutine dry_and_level

  !> A facet that has collapsed to a line, as a face of a wedge may, takes no load.
  subroutine collapsed(log)
    type(test_log), intent(inout) :: log
    type(wet_facet) :: wet
    real(rk) :: a(3), b(3), x(3, 4), largest
    integer :: i
    a = [0.1_rk, 0.37_rk, 3.0_rk]
    b = [1.3_rk, 0.2_rk, 3.37_rk]
    largest = 0.0_rk
    do i = 1, 60
      x = reshape([a, b, b, a], [3, 4])
      call integrate_wet_part(x, water_body(level=2.97_rk + 0.0071_rk*i), wet)
      largest = max(largest, maxval(abs(wet%head)), maxval(abs(wet%area)), maxval(abs(wet%root)))
      x = reshape([a, a, b, b], [3, 4])
      call integrate_wet_part(x, water_body(level=2.97_rk + 0.0071_rk*i, bed=3.1_rk), wet)
      largest = max(largest, maxval(abs(wet%head)), maxval(abs(wet%area)), maxval(abs(wet%root)))
      if (.not. largest <= 1.0_rk) exit ! not a number
    end do
    call check_close(log, largest, 0.0_rk, 1.0e-15_rk, 'nothing on a line')
  end subroutine collapsed
end program test_wetted_facet
