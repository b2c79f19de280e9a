!> Motions of blocks in words.
program test_block_motion
  use block_motion, only: freedom_text, motion_text
  use kinds, only: rk
  use rigid_blocks, only: block_set
  use testing, only: check_text, test_log
  implicit none
  type(test_log) :: log
  type(block_set) :: blocks
  real(rk), parameter :: s = sqrt(0.5_rk)
  real(rk) :: skew(6, 2)

  log%suite = 'block_motion'
  blocks%num_blocks = 1
  blocks%centre = reshape([1.0_rk, 2.0_rk, 3.0_rk], [3, 1])
  blocks%radius = [2.0_rk]
  call check_text(log, motion_text(blocks, 1, [0.0_rk, -3.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk]), &
                  'move along -y', 'a translation')
  call check_text(log, motion_text(blocks, 1, [0.6_rk, 0.0_rk, 0.8_rk, 0.0_rk, 0.0_rk, 0.0_rk]), &
                  'move along (0.6, 0, 0.8)', 'a skew one')
  ! w = (0, 0, 1), v = w x (centre - place) with the place (1, 1, 0).
  call check_text(log, motion_text(blocks, 1, [-1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 2.0_rk]), &
                  'rotate about the axis z through (1, 1, 3)', 'a rotation')
  call check_text(log, motion_text(blocks, 1, [-1.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 0.0_rk, 2.0_rk]), &
                  'rotate about the axis z through (1, 1, 3) and move along it', 'a screw')
  call check_text(log, freedom_text(blocks, 1, unit_vectors([1, 2, 6])), &
                  'move along x, y and rotate about the axis z through (1, 2, 3)', 'sliding')
  call check_text(log, freedom_text(blocks, 1, unit_vectors([3])), 'move along z', 'one way')
  call check_text(log, freedom_text(blocks, 1, unit_vectors([1, 2, 3])), 'move along x, y, z', &
                  'all directions')
  skew = unit_vectors([1, 2])
  skew([1, 3], 1) = s
  call check_text(log, freedom_text(blocks, 1, skew), &
                  'move in the plane normal to (0.707, 0, -0.707)', 'a skew plane')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Columns of the unit matrix.
  function unit_vectors(which) result(basis)
    integer, intent(in) :: which(:)
    real(rk) :: basis(6, size(which))
    integer :: k
    basis = 0.0_rk
    do k = 1, size(which)
      basis(which(k), k) = 1.0_rk
    end do
  end function unit_vectors
end program test_block_motion
