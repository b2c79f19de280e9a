!> Pages on messages: how the text of a deck is read.
module pages_of_decks
  use message_pages, only: page_list
  implicit none
  private
  public :: add_pages_of_decks

contains

  !> Adds all pages of this module, in the order in which their signs are looked for.
  subroutine add_pages_of_decks(list)
    type(page_list), intent(inout) :: list
    call pages_from_unknown_keyword(list)
    call pages_from_unit_of_record(list)
  end subroutine add_pages_of_decks

  subroutine pages_from_unknown_keyword(list)
    type(page_list), intent(inout) :: list
    call list%add('unknown-keyword', &
                  'unknown keyword|no keyword after', &
                  'A line begins with * and a word that is no keyword: a misspelling, or a '// &
                  'keyword of another program. A missing comma after the keyword gives the '// &
                  'same message.', &
                  'Take the word after "did you mean". keyway --keywords lists all keywords; '// &
                  'docs/compatibility.md says what becomes of keywords of other programs.', &
                  '*ELASTICITY', &
                  '*ELASTIC')
    call list%add('unknown-parameter', &
                  'unknown parameter', &
                  'The keyword has no parameter of this name. A parameter that was passed over '// &
                  'in silence could change the answer, so it is an error.', &
                  'Take one of the parameters that the message lists; keyway --keywords NAME '// &
                  'says what each of them means.', &
                  '*STEP, NGEOM=NO', &
                  '*STEP, NLGEOM=NO')
    call list%add('outside-its-place', &
                  'is outside |is in a part|is in an instance|begins in a part|inside a '// &
                  'step|inside a part|not directly in|nothing is open here|is not closed|in '// &
                  'all steps|before the first step|already has a procedure|so it is no '// &
                  'keyword of|no step follows', &
                  'The keyword stands where it has no meaning: a property outside a material, '// &
                  'a load outside a step, a part that is still open.', &
                  'Move the card to the place that the message names. Properties follow '// &
                  '*MATERIAL; loads, procedures and output stand between *STEP and *END STEP.', &
                  '*DENSITY above *MATERIAL', &
                  '*MATERIAL, NAME=CONCRETE; then *DENSITY')
    call list%add('incomplete-deck', &
                  'the deck ends without|the deck is empty|has no procedure|has no meaning '// &
                  'without a step|nothing acts', &
                  'Something that every deck needs is missing: nodes, a step, a procedure in a '// &
                  'step, a load, a test.', &
                  'Add the card that the message names. docs/tutorials/first_dam.md has a '// &
                  'small deck that is complete.', &
                  '*STEP and *END STEP alone', &
                  '*STEP; *STATIC; loads; *END STEP')
    call list%add('unreadable-file', &
                  'cannot read|includes itself|levels of *INCLUDE|cannot open|the file has no '// &
                  'numbers|the file has no temperatures', &
                  'A file that the deck names does not exist, may not be read, or holds no '// &
                  'numbers.', &
                  'Paths are relative to the file that names them. The message ends with the '// &
                  'reason that the system gives.', &
                  '*INCLUDE, INPUT=mesh.inp', &
                  'the file mesh.inp beside the deck')
  end subroutine pages_from_unknown_keyword

  subroutine pages_from_unit_of_record(list)
    type(page_list), intent(inout) :: list
    call list%add('unit-of-record', &
                  'name the unit|names a unit|names the unit|turns the record into|as the '// &
                  'conversion of the', &
                  'A file of a recorded motion says, or does not say, in which unit its '// &
                  'accelerations are, and the deck says something that could mean two things.', &
                  'Give UNIT in *AMPLITUDE (G, M/S2 or CM/S2), and keep SCALE for what scales '// &
                  'the record in m/s2.', &
                  'SCALE=9.81', &
                  'UNIT=G')
    call list%add('not-available', &
                  'not available|is not supported|are not supported|'// &
                  'no such numerical damping|no implicit Euler|of this step grow by', &
                  'Keyway knows the keyword or the choice and does not have it. Input that is '// &
                  'not understood is never passed over.', &
                  'Take what the message offers in its place, or leave the card out. '// &
                  'docs/compatibility.md lists what is not there.', &
                  '*TRANSFORM', &
                  'supports and forces along the global axes')
    call list%add('reduced-model', &
                  'reduced model|without REDUCED|*DYNAMIC, REDUCED|is the solver of', &
                  'A step with *DYNAMIC, REDUCED holds linear elastic solids with joints on '// &
                  'fixed supports. The deck has more: cracking concrete, equations, moving '// &
                  'supports, elements that are absent in the step, temperatures that change in '// &
                  'it. Stages and temperatures in steps before it are possible. As a warning: '// &
                  'the model is less accurate than ACCURACY, or its estimate may be wrong, '// &
                  'because bonds of joints break.', &
                  'Leave REDUCED out. The full model takes everything.', &
                  '*DYNAMIC, REDUCED, DIRECT', &
                  '*DYNAMIC, DIRECT')
    call list%add('needs-umat', &
                  'no UMAT is given|*USER MATERIAL|constants follow|constants;|state '// &
                  'variable|a *DEPVAR already|material '''' also has an', &
                  'A material with *USER MATERIAL takes its law from a subroutine UMAT. The '// &
                  'program has no UMAT, or its constants or state variables do not fit.', &
                  'Start with --umat FILE; CONSTANTS is the number of values that follow, '// &
                  'eight a line; *DEPVAR the number of state variables. docs/umat.md has a '// &
                  'whole example.', &
                  'keyway bar.inp', &
                  'keyway --umat law.f90 bar.inp')
  end subroutine pages_from_unit_of_record
end module pages_of_decks
