!> Numbers are read as a whole or not at all, and correctly rounded.
program test_parse_text
  use kinds, only: rk
  use parse_text, only: parse_integer, parse_real, single_blanks, upper_case, without_blanks
  use testing, only: check, check_text, repeat_chance, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'parse_text'
  call repeat_chance(1)
  call good_reals()
  call broken_reals()
  call rounding()
  call integers()
  call words()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The word is this very number.
  subroutine expect(word, number)
    character(*), intent(in) :: word
    real(rk), intent(in) :: number
    real(rk) :: value
    logical :: is_number
    call parse_real(word, value, is_number)
    call check(log, is_number .and. abs(value - number) <= 0.0_rk, word//' is a number')
  end subroutine expect

  !> The statement should not hold.
  subroutine check_not(is_true, what)
    logical, intent(in) :: is_true
    character(*), intent(in) :: what
    logical :: is_false
    is_false = .not. is_true
    call check(log, is_false, what)
  end subroutine check_not

  !> Spellings people use.
  subroutine good_reals()
    call expect('1', 1.0_rk)
    call expect('1.', 1.0_rk)
    call expect('.5', 0.5_rk)
    call expect('-.5', -0.5_rk)
    call expect('+2', 2.0_rk)
    call expect('1e3', 1000.0_rk)
    call expect('1E+3', 1000.0_rk)
    call expect('1.D+3', 1000.0_rk)
    call expect('1d-3', 0.001_rk)
    call expect(' 7 ', 7.0_rk)
    call expect(achar(9)//'7'//achar(9), 7.0_rk)
    call expect('0', 0.0_rk)
    call expect('-0.000', 0.0_rk)
    call expect('0e999', 0.0_rk)
    call expect('000012.5000', 12.5_rk)
    call expect('1e0000000000000000002', 100.0_rk)
    call expect('0.00000000000000000000000000000000000000001e41', 1.0_rk)
    call expect('100000000000000000000000000000000000000000e-41', 1.0_rk)
    call expect('2.2E10', 2.2e10_rk)
  end subroutine good_reals

  !> Words that only look like numbers.
  subroutine broken_reals()
    character(12), parameter :: words(34) = [ &
                                '31 GPa      ', 'NaN         ', 'nan         ', 'Inf         ', &
                                '-inf        ', 'infinity    ', '            ', '.           ', &
                                '-           ', '+           ', 'e3          ', '.e3         ', &
                                '1e          ', '1e+         ', '1d          ', '1.2.3       ', &
                                '1,5         ', '--1         ', '+-1         ', '1-          ', &
                                '0x10        ', '1_8         ', '1e3.        ', '1e1e1       ', &
                                '1 2         ', '1/2         ', '2*3         ', 'E           ', &
                                '1e999       ', '-1e308      ', '1e-400      ', '1f3         ', &
                                "1'          ", '1;          ']
    real(rk) :: value
    logical :: is_number
    integer :: i
    do i = 1, size(words)
      call parse_real(trim(words(i)), value, is_number)
      call check_not(is_number, "'"//trim(words(i))//"' is no number")
    end do
    call parse_real('1'//achar(0), value, is_number)
    call check_not(is_number, 'a zero byte is no digit')
    call parse_real('', value, is_number)
    call check_not(is_number, 'nothing is no number')
  end subroutine broken_reals

  !> Random numbers written with 17 digits come back to the last bit, with 9 and 15 as well.
  subroutine rounding()
    character(40) :: word
    character(8), parameter :: styles(3) = ['(es24.8 ', '(es24.14', '(es24.16']
    real(rk) :: chance(2), number, value, expected
    logical :: is_number, is_same
    integer :: i, style, num_wrong
    num_wrong = 0
    do i = 1, 20000
      call random_number(chance)
      number = (chance(1) - 0.5_rk)*10.0_rk**(int(600*chance(2)) - 300)
      style = 1 + mod(i, 3)
      write (word, trim(styles(style))//'e3)') number
      read (word, *) expected
      call parse_real(word, value, is_number)
      is_same = is_number .and. abs(value - expected) <= 0.0_rk
      if (style == 3) is_same = is_same .and. abs(value - number) <= 0.0_rk
      if (.not. is_same) num_wrong = num_wrong + 1
    end do
    call check(log, num_wrong == 0, 'every number comes back as it was written')
    call expect('9007199254740993', 9007199254740992.0_rk)
    call expect('0.1000000000000000055511151231257827021181583404541015625', 0.1_rk)
    call expect('123456789012345678901234567890', 1.2345678901234568e29_rk)
  end subroutine rounding

  !> Integers.
  subroutine integers()
    character(12), parameter :: broken(10) = [ &
                                '1.          ', '1e3         ', '            ', '-           ', &
                                '2147483648  ', '99999999999 ', '1 2         ', 'a           ', &
                                '1a          ', '+-1         ']
    integer :: value, i
    logical :: is_integer
    call parse_integer(' -12 ', value, is_integer)
    call check(log, is_integer .and. value == -12, '-12')
    call parse_integer('+0012', value, is_integer)
    call check(log, is_integer .and. value == 12, '+0012')
    call parse_integer('2147483647', value, is_integer)
    call check(log, is_integer .and. value == huge(1), 'the largest')
    do i = 1, size(broken)
      call parse_integer(trim(broken(i)), value, is_integer)
      call check_not(is_integer, "'"//trim(broken(i))//"' is no integer")
    end do
  end subroutine integers

  !> Upper case and blanks.
  subroutine words()
    call check_text(log, upper_case('dAm-1_z{'), 'DAM-1_Z{', 'upper case')
    call check_text(log, single_blanks('  el '//achar(9)//'  file '), 'el file', 'single blanks')
    call check_text(log, without_blanks(' el '//achar(9)//' file '), 'elfile', 'without blanks')
    call check_text(log, single_blanks(''), '', 'nothing')
  end subroutine words
end program test_parse_text
