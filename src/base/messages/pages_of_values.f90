!> Pages on messages: values and words of a card.
module pages_of_values
  use message_pages, only: page_list
  implicit none
  private
  public :: add_pages_of_values

contains

  !> Adds all pages of this module, in the order in which their signs are looked for.
  subroutine add_pages_of_values(list)
    type(page_list), intent(inout) :: list
    call pages_from_excludes(list)
  end subroutine add_pages_of_values

  subroutine pages_from_excludes(list)
    type(page_list), intent(inout) :: list
    call list%add('excludes', &
                  'exclude each other|has both|not both|goes with|go with|does not belong '// &
                  'to|has no meaning|not go with|is given with |a history for a file|several '// &
                  'materials|expected either |has ADJUST|a joint with a GAP|in a step *|the '// &
                  'model has a *TIE|the model has an *INTERFACE|is LUMPED|MASS=LUMPED|a second '// &
                  'inelastic law|ends the step earlier', &
                  'Two choices contradict each other, or one of them has no meaning beside the '// &
                  'other.', &
                  'Keep the one that was meant. keyway --keywords NAME says what goes with '// &
                  'what.', &
                  '*DYNAMIC, DIRECT with ACCURACY', &
                  'one of the two')
    call list%add('missing-value', &
                  'is missing|heading is empty|no file is named|has no value|without |is given '// &
                  'without|does not say whether|has no temperatures|an empty field|'// &
                  'has neither|LENGTH is not given|a history without', &
                  'The keyword needs a parameter, a field or a word that the card does not '// &
                  'have.', &
                  'Add what the message asks for; keyway --keywords NAME shows an example.', &
                  '*AMPLITUDE, NAME=A, INPUT=a.txt, FORMAT=VALUES', &
                  'the same with DT=0.01')
    call list%add('number-of-fields', &
                  'data line| fields|nodes; expected| temperatures; expected| constants; '// &
                  'expected|nodes on an element|an odd number of values|the file holds|as many '// &
                  'nodes as|components; expected', &
                  'A data line, a card or a file has more or fewer values than expected: a '// &
                  'comma too many or too few, a comma in place of a decimal point, a line '// &
                  'that broke in the middle.', &
                  'Count the fields of the line: commas separate numbers, so that 0,2 is two '// &
                  'of them. A line that goes on ends with a comma.', &
                  '*ELEMENT; 1, 2, 3, 4, 5, 6, 7, 8', &
                  '1, then eight nodes')
    call list%add('not-ascending', &
                  'that ascend| after ', &
                  'The rows of a table must ascend: times, temperatures, strains.', &
                  'Sort the rows, and look for a missing sign or exponent.', &
                  '0., 0.; 2., 1.; 1., 0.', &
                  '0., 0.; 1., 0.; 2., 1.')
    call list%add('wrong-value', &
                  'found |longer than the step|a name of |no range of |takes no value|which is '// &
                  'no name|the two points|neither a translation|expected |BY ITSELF', &
                  'A value is not of the kind, or not in the range, that the message '// &
                  'describes: a letter O for a zero, a unit behind a number, a word that is no '// &
                  'choice.', &
                  'Write what the message describes after "expected". Numbers have a decimal '// &
                  'point and no unit.', &
                  '31 GPa, 0.2', &
                  '31e9, 0.2')
  end subroutine pages_from_excludes
end module pages_of_values
