!> JSON: nesting, commas, escapes, no NaN.
program test_json_writer
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use kinds, only: rk
  use json_writer, only: json_text
  use testing, only: test_log, check_text
  implicit none
  type(test_log) :: log
  log%suite = 'json_writer'
  call test_nesting(log)
  call test_escapes(log)
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Objects, arrays, numbers, and null in place of NaN.
  subroutine test_nesting(log)
    type(test_log), intent(inout) :: log
    type(json_text) :: json
    character, parameter :: nl = new_line('a')
    call json%open_object()
    call json%put_integer(3, 'n')
    call json%open_array('list')
    call json%put_text('a')
    call json%put_real(ieee_value(1.0_rk, ieee_quiet_nan))
    call json%close_array()
    call json%open_object('empty')
    call json%close_object()
    call json%put_reals([0.5_rk, -2.0_rk], 'x')
    call json%close_object()
    call check_text(log, json%contents(), '{'//nl//'  "n": 3,'//nl//'  "list": ['//nl// &
                    '    "a",'//nl//'    null'//nl//'  ],'//nl//'  "empty": {},'//nl// &
                    '  "x": [5.000000000000E-001, -2.000000000000E+000]'//nl//'}'//nl, 'document')
  end subroutine test_nesting

  !> Quotes, backslashes, control characters, UTF-8, and bytes of Latin-1, which become UTF-8.
  subroutine test_escapes(log)
    type(test_log), intent(inout) :: log
    type(json_text) :: json
    character(*), parameter :: umlaut = char(195)//char(188)
    call json%put_text('a"b'//achar(92)//achar(9)//umlaut//char(252)//'z')
    call check_text(log, json%contents(), '"a'//achar(92)//'"b'//achar(92)//achar(92)// &
                    achar(92)//'u0009'//umlaut//umlaut//'z"'//new_line('a'), 'string')
  end subroutine test_escapes
end program test_json_writer
