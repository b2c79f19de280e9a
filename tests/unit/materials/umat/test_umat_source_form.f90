!> Free or fixed form by what a source holds; each text is a case of one rule.
program test_umat_source_form
  use testing, only: check, test_log
  use umat_source_form, only: form_of_source, source_form
  implicit none
  type(test_log) :: log
  character, parameter :: more = achar(38) !< the ampersand
  character, parameter :: nl = new_line('a'), tab = achar(9), return = achar(13)

  log%suite = 'umat_source_form'
  call fixed(log, '      SUBROUTINE UMAT(A,'//nl//'     1 B)'//nl//'      END', 'column 6')
  call fixed(log, 'C     Comment that ends in '//more//nl//'      END', 'more in a comment')
  call fixed(log, '* Comment'//nl//'      X = 1'//nl, 'a star in column 1')
  call fixed(log, tab//'SUBROUTINE UMAT(A,'//nl//tab//'1 B)', 'tabs')
  call fixed(log, '      X = ''a b! '//more//''''//nl//'     '//more//' // ''c''', 'more in texts')
  call fixed(log, '   10 CONTINUE'//return//nl//'  100 FORMAT (A)'//return, 'labels, CRLF')
  call fixed(log, '      X = 1 ! goes on '//more//nl//'      Y = 2', 'more behind a !')
  call fixed(log, '!DIR$ NOFREEFORM'//nl//'x = 1 + '//more//nl//'2', 'by NOFREEFORM')
  call fixed(log, '', 'nothing')
  call free(log, 'subroutine umat(a, '//more//nl//'  b)', 'a line that goes on')
  call free(log, '      subroutine umat(a,'//repeat(' ', 50)//more//nl//'     '//more//'b)', &
            'a line of both forms')
  call free(log, '! text'//nl//'module laws'//nl//'end module', 'statements at the left')
  call free(log, '  x = 1'//return//nl//'  y = 2 '//more//'  ! and'//return//nl//'    + 3', 'CRLF')
  call free(log, '!DIR$ FREEFORM'//nl//'      x = 1', 'by FREEFORM')
  call free(log, '!DEC$ FREEFORM'//nl//'*'//nl, 'by the directive alone')
  call free(log, '  s = ''it''''s'' // '//more//nl//' ''x''', 'a quote in a text')
  call preprocessed(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  subroutine fixed(log, text, what)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: text, what
    type(source_form) :: form
    form = form_of_source(text)
    call check(log,.not. form%is_free, 'fixed form: '//what)
  end subroutine fixed

  subroutine free(log, text, what)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: text, what
    type(source_form) :: form
    form = form_of_source(text)
    call check(log, form%is_free, 'free form: '//what)
  end subroutine free

  subroutine preprocessed(log)
    type(test_log), intent(inout) :: log
    type(source_form) :: form
    form = form_of_source('      X = 1'//nl//'#include "more.inc"'//nl)
    call check(log, form%has_directives, 'an #include')
    form = form_of_source('      INCLUDE ''ABA_PARAM.INC'''//nl//'C # comment')
    call check(log,.not. form%has_directives, 'an INCLUDE of Fortran')
  end subroutine preprocessed
end program test_umat_source_form
