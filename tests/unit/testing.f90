!> A test is a subroutine that calls `check`; the runner prints each failure and a closing line.
module testing
  use kinds, only: rk
  implicit none
  private
  public :: test_log, check, check_close, check_text, repeat_chance

  type :: test_log
    character(:), allocatable :: suite
    integer :: passed = 0, failed = 0
  end type test_log

contains

  !> Counts one assertion.
  subroutine check(log, is_right, what)
    type(test_log), intent(inout) :: log
    logical, intent(in) :: is_right
    character(*), intent(in) :: what !< the statement that should hold
    if (is_right) then
      log%passed = log%passed + 1
    else
      log%failed = log%failed + 1
      write (*, '(4a)') 'FAILED ', log%suite, ': ', what
    end if
  end subroutine check

  !> |found - expected| <= tolerance, NaN fails.
  subroutine check_close(log, found, expected, tolerance, what)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: found, expected, tolerance
    character(*), intent(in) :: what
    character(120) :: numbers
    write (numbers, '(3(a,es16.9))') ': found ', found, ', expected ', expected, ' +- ', tolerance
    call check(log, abs(found - expected) <= tolerance, what//trim(numbers))
  end subroutine check_close

  !> Equal texts.
  subroutine check_text(log, found, expected, what)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: found, expected, what
    call check(log, found == expected, what//": found '"//found//"', expected '"//expected//"'")
  end subroutine check_text

  !> Lets random_number give the same numbers in every run (gfortran starts it anew in each run).
  subroutine repeat_chance(start)
    integer, intent(in) :: start !< another start, other numbers
    integer :: i, n
    call random_seed(size=n)
    call random_seed(put=[(start + 7919*i, i=1, n)])
  end subroutine repeat_chance
end module testing
