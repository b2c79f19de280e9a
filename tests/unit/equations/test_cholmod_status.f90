!> Words for statuses of CHOLMOD.
program test_cholmod_status
  use cholmod_status, only: plan_failure, too_large
  use testing, only: check_text, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'cholmod_status'
  call check_text(log, plan_failure(-2), 'no memory to plan the factor of the stiffness', &
                  'CHOLMOD_OUT_OF_MEMORY')
  call check_text(log, plan_failure(too_large), 'the factor of the stiffness has more than '// &
                  '2^31 entries; use several processes (docs/large_models.md)', 'too large')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_cholmod_status
