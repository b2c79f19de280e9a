!> Where the unknowns of joints stand in the order of elimination.
program test_joint_separators
  use joint_operator, only: jump_operator
  use joint_separators, only: fits_the_end
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'joint_separators'
  call count_each_unknown_once(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Points of a facet share its nodes: four points of four nodes each have 16 entries in each
  !> direction, and 4 unknowns. 9000 unknowns fit in statics, 4500 in motion, however many points
  !> see them. Prescribed unknowns come after the free ones and do not count.
  subroutine count_each_unknown_once(log)
    type(test_log), intent(inout) :: log
    integer, parameter :: num_free = 20000
    type(jump_operator) :: operator
    integer :: i
    operator%unknown = [(spread(i, 1, 16), i=1, 9000), (i, i=num_free + 1, num_free + 500)]
    call check(log, fits_the_end(operator, num_free, .false.), '9000 in statics')
    call check(log,.not. fits_the_end(operator, num_free, .true.), '9000 in motion')
    operator%unknown = [operator%unknown, 9001]
    call check(log,.not. fits_the_end(operator, num_free, .false.), '9001 in statics')
    operator%unknown = operator%unknown(:16*4500)
    call check(log, fits_the_end(operator, num_free, .true.), '4500 in motion')
  end subroutine count_each_unknown_once
end program test_joint_separators
