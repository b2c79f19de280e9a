!> Names of procedures for messages.
program test_integrator_catalogue
  use integrator_catalogue, only: list_procedures, list_schemes
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'integrator_catalogue'
  call check(log, list_procedures() == '*STATIC, *DYNAMIC or *FREQUENCY', 'each procedure once')
  call check(log, index(list_schemes('DYNAMIC'), ' | ') > 0, 'several schemes of one procedure')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_integrator_catalogue
