!> The program.
program keyway
  use kinds, only: rk
  implicit none
  write (*, '(a,i0)') 'keyway ', kind(1.0_rk)
end program keyway
