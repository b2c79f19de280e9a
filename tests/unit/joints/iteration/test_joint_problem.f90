!> Sizes of the files of joint problems.
program test_joint_problem
  use joint_problem, only: triangle_size
  use kinds, only: long
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'joint_problem'
  call check(log, triangle_size(3) == 6_long, 'three rows')
  ! 46341*46342 is more than 2^31; 65536 rows are the first whose triangle is.
  call check(log, triangle_size(46341) == 1073767311_long, 'twice the triangle is large')
  call check(log, triangle_size(65535) <= huge(1), 'the largest triangle of a file')
  call check(log, triangle_size(65536) == 2147516416_long, 'a triangle that is too large')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_joint_problem
