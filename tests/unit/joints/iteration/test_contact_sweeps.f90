!> Sweeps of Gauss-Seidel over points in contact: the forces of four coupled points, one of which
!> opens, one sticks, one slides and one is bonded, agree with contact, friction and the compliance.
program test_contact_sweeps
  use block_compliance, only: compliance_blocks
  use contact_scaling, only: open_group
  use contact_sweeps, only: swept_points, sweep_contacts
  use joint_forces, only: joint_field
  use kinds, only: rk
  use point_groups, only: group_list, single_group
  use testing, only: check, check_close, test_log
  implicit none

  integer, parameter :: n = 4
  real(rk), parameter :: k = 1.0e10_rk ! of the joint, all directions [Pa/m]
  real(rk), parameter :: friction = 0.5_rk, share = 2.0_rk ! weight*area [m2]
  type(test_log) :: log

  log%suite = 'contact_sweeps'
  call forces_agree_with_the_law(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  subroutine forces_agree_with_the_law(log)
    type(test_log), intent(inout) :: log
    type(swept_points) :: points
    type(joint_field) :: field
    type(compliance_blocks) :: blocks
    type(group_list) :: groups
    type(open_group) :: opened(1)
    real(rk) :: c(3*n, 3*n), w(3*n, 3*n), closed(3, n), force(3, n), d(3, n), missing(3, n)
    integer :: i, j
    do i = 1, 3*n
      do j = 1, 3*n
        c(i, j) = 1.0e-9_rk*exp(-0.8_rk*abs(i - j)) ! positive definite
      end do
    end do
    w = c
    do i = 1, 3*n
      w(i, i) = w(i, i) + 1.0_rk/(share*k)
    end do
    points%share = spread(share, 1, n)
    allocate (points%spring(3, n), source=1.0_rk/(share*k))
    points%friction = spread(friction, 1, n)
    points%cohesion = spread(0.0_rk, 1, n)
    points%is_bonded = [.false., .false., .false., .true.]
    field%gap = spread(0.0_rk, 1, n)
    allocate (points%slip(2, n), field%scale%own(2, n), source=0.0_rk)
    do i = 1, n
      j = 3*i
      field%scale%own(1, i) = 1.0_rk/(share*w(j - 2, j - 2))
      field%scale%own(2, i) = 1.0_rk/(share*(w(j, j) + w(j - 1, j)))
    end do
    ! Closed joints: one point is pulled, one pressed, one pushed along the joint.
    closed = reshape([1.0e-4_rk, 2.0e-5_rk, 0.0_rk, -1.0e-4_rk, 1.0e-5_rk, 2.0e-5_rk, &
                      -1.0e-4_rk, 1.5e-4_rk, -1.0e-4_rk, 8.0e-5_rk, 5.0e-5_rk, -4.0e-5_rk], &
                     [3, n])
    force = 0.0_rk
    call single_group(n, groups)
    call blocks%start(groups)
    opened(1)%compliance = c
    call sweep_contacts(blocks, opened, points, closed, 400, force, field)
    missing = share*k*closed - force
    d = reshape(matmul(w, reshape(missing, [3*n])), [3, n])
    associate (force_size => maxval(abs(force)), d_size => maxval(abs(d)))
      call check_close(log, maxval(abs(field%multiplier - force/share)), 0.0_rk, 0.0_rk, 'traction')
      call check_close(log, maxval(abs(field%jump - d - force/(share*k))), 0.0_rk, &
                       1.0e-10_rk*d_size, 'jumps follow from the forces')
      call check_close(log, maxval(abs(force(:, 1))), 0.0_rk, 0.0_rk, 'open: no force')
      call check(log, d(1, 1) > 0.0_rk, 'open')
      call check_close(log, maxval(abs(d(:, 2))), 0.0_rk, 1.0e-9_rk*d_size, 'sticks')
      call check(log, force(1, 2) < 0.0_rk .and. &
                 norm2(force(2:3, 2)) < -friction*force(1, 2), 'within the cone')
      call check_close(log, maxval(abs(d(:, 4))), 0.0_rk, 1.0e-9_rk*d_size, 'bonded')
      call check(log, force(1, 4) > 0.0_rk, 'bonded in tension')
      call check_close(log, d(1, 3), 0.0_rk, 1.0e-9_rk*d_size, 'closed')
      call check_close(log, norm2(force(2:3, 3)), -friction*force(1, 3), 1.0e-9_rk*force_size, &
                       'slides: on the cone')
      call check_close(log, dot_product(d(2:3, 3), force(2:3, 3)), &
                       norm2(d(2:3, 3))*norm2(force(2:3, 3)), 1.0e-7_rk*d_size*force_size, &
                       'slips along its friction')
    end associate
  end subroutine forces_agree_with_the_law
end program test_contact_sweeps
