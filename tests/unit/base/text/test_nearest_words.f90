!> 'Did you mean' helps where a word is near and is silent elsewhere.
program test_nearest_words
  use nearest_words, only: nearest_choice, nearest_word, word_distance
  use testing, only: check, check_text, test_log
  implicit none
  character(13), parameter :: known(7) = [ &
                              'NODE         ', 'NSET         ', 'ELSET        ', &
                              'ELEMENT      ', 'BOUNDARY     ', 'SOLID SECTION', &
                              'E            ']
  type(test_log) :: log
  log%suite = 'nearest_words'
  call check(log, word_distance('NODE', 'NODE') == 0, 'same')
  call check(log, word_distance('NODE', 'NDOE') == 1, 'swapped')
  call check(log, word_distance('', 'NODE') == 4, 'from nothing')
  call check(log, word_distance('KITTEN', 'SITTING') == 3, 'the classic')
  call check_text(log, nearest_word('nodes', known), 'NODE', 'one letter more, any case')
  call check_text(log, nearest_word('ELEMNET', known), 'ELEMENT', 'two letters swapped')
  call check_text(log, nearest_word('BOUNDRY', known), 'BOUNDARY', 'a letter left out')
  call check_text(log, nearest_word('SOLID SECTOIN', known), 'SOLID SECTION', 'two words')
  call check_text(log, nearest_word('STEP', known), '', 'far')
  call check_text(log, nearest_word('X', known), '', 'one letter is never near')
  call check_text(log, nearest_word('EX', known), '', 'nor is a word that keeps nothing of it')
  call check_text(log, nearest_word('', known), '', 'nothing')
  call check_text(log, nearest_choice('westergard', 'NONE | WESTERGAARD'), 'WESTERGAARD', 'choices')
  call check_text(log, nearest_choice('YESS', 'YES|NO'), 'YES', 'choices without blanks')
  call check_text(log, nearest_choice('ON', 'YES | NO'), '', 'two letters of another meaning')
  call check_text(log, nearest_word('J2', ['J1', 'K3']), 'J1', 'names of two letters')
  call check_text(log, nearest_choice('MAYBE', 'YES | NO'), '', 'far from every choice')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1
end program test_nearest_words
