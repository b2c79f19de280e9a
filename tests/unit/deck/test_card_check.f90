!> Messages about cards that do not agree with their specification, letter by letter.
program test_card_check
  use card_check, only: check_card
  use card_match, only: match_card
  use deck_card, only: card
  use deck_lexer, only: read_cards
  use diagnostic_text, only: text_of_errors, text_of_warnings
  use diagnostics, only: diagnostic_list
  use keyword_help, only: describe_keyword, list_keywords
  use keyword_spec, only: choices_of, field, find_spec, keyword, keyword_variant, kind_choice, &
                          kind_flag, kind_integer, kind_real, kind_reference, kind_text, &
                          kind_word, later, without_effect
  use kinds, only: rk
  use testing, only: check, check_close, check_text, test_log
  implicit none
  character, parameter :: lf = achar(10)
  character(*), parameter :: at = 'check_test.inp:'
  type(keyword), allocatable :: specs(:)
  type(test_log) :: log
  log%suite = 'card_check'
  call make_specs(specs)
  call good_cards()
  call broken_numbers()
  call broken_parameters()
  call broken_counts()
  call repeated_columns()
  call names_of_keywords()
  call many_faults()
  call variants_of_a_keyword()
  call reference_pages()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A few keywords that take all kinds of things.
  subroutine make_specs(specs)
    type(keyword), allocatable, intent(out) :: specs(:)
    character(:), allocatable :: types
    allocate (specs(8))
    specs(1) = keyword(name='ELASTIC', meaning='Linear elasticity (Eq. 1). More of it.', &
                       family='material', place='material', example='*ELASTIC'//lf//'22e9, 0.2', &
                       fewest_lines=1, most_lines=1, &
                       parameters=[field('TYPE', kind_choice, 'kind of elasticity', &
                                         default='ISOTROPIC', choices='ISOTROPIC | ISO')], &
                       columns=[field('E', kind_real, "Young's modulus", 'Pa', &
                                      is_required=.true., lowest=0.0_rk, excludes_lowest=.true.), &
                                field('nu', kind_real, "Poisson's ratio", default='0.2', &
                                      lowest=-1.0_rk, highest=0.5_rk, excludes_lowest=.true., &
                                      excludes_highest=.true.)])
    specs(2) = keyword(name='NSET', meaning='Names nodes.', family='mesh', fewest_lines=1, &
                       repeats_columns=.true., columns=[field('node', kind_reference, 'a node')], &
                       parameters=[field('NSET', kind_word, 'name of the set', &
                                         is_required=.true.), &
                                   field('GENERATE', kind_flag, 'ids from, to, step')])
    specs(3) = keyword(name='AMPLITUDE', meaning='A history.', family='load', &
                       repeats_columns=.true., fewest_lines=1, &
                       parameters=[field('NAME', kind_word, 'its name', is_required=.true.), &
                                   field('INPUT', kind_text, 'a file'), &
                                   field('DT', kind_real, 'time step', 's', lowest=0.0_rk)], &
                       columns=[field('time', kind_real, 'time', 's', is_required=.true.), &
                                field('value', kind_real, 'factor', is_required=.true.)])
    specs(4) = keyword(name='END STEP', meaning='Closes a step.', family='step', most_lines=0)
    specs(5) = keyword(name='RESTART', meaning='Checkpoints.', family='output', status=later)
    specs(6) = keyword(name='PREPRINT', meaning='Echo.', family='output', status=without_effect)
    specs(7) = keyword(name='CLOAD', meaning='Forces.', family='load', fewest_lines=1, &
                       columns=[field('node', kind_reference, 'a node', is_required=.true.), &
                                field('dof', kind_integer, 'direction', lowest=1.0_rk, &
                                      highest=3.0_rk, is_required=.true.), &
                                field('force', kind_real, 'force', 'N', default='0')])
    specs(8) = keyword(name='LAW', meaning='A law.', family='joint', most_lines=0, &
                       chooser='TYPE', &
                       variants=[keyword_variant('STIFF', 'It holds.', &
                                                 [field('K', kind_real, 'stiffness', &
                                                        default='5')]), &
                                 keyword_variant('SOFT', 'It gives.', &
                                                 [field('K', kind_real, 'stiffness'), &
                                                  field('G', kind_real, 'energy', &
                                                        is_required=.true.)])])
    types = choices_of(specs(8)%variants)
    specs(8)%parameters = [field('TYPE', kind_choice, 'which', default='STIFF', choices=types), &
                           field('NAME', kind_word, 'its name')]
  end subroutine make_specs

  !> Reads a deck from a text and checks all its cards.
  subroutine check_deck(text, cards, faults)
    character(*), intent(in) :: text
    type(card), allocatable, intent(out) :: cards(:)
    type(diagnostic_list), intent(out) :: faults
    integer :: unit, i, found
    logical :: is_right
    open (newunit=unit, file='check_test.inp', access='stream', form='unformatted', &
          status='replace', action='write')
    write (unit) text
    close (unit)
    call read_cards('check_test.inp', specs, cards, faults)
    do i = 1, size(cards)
      call match_card(cards(i), specs, faults, found)
      if (found > 0) call check_card(cards(i), specs(found), faults, is_right)
    end do
    open (newunit=unit, file='check_test.inp', action='read')
    close (unit, status='delete')
  end subroutine check_deck

  !> The headline of the only fault of a deck.
  subroutine expect(deck, message)
    character(*), intent(in) :: deck, message
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    character(:), allocatable :: text
    call check_deck(deck, cards, faults)
    text = text_of_errors(faults)
    call check(log, faults%num_errors == 1, 'one fault: '//message)
    call check_text(log, text(:index(text//lf, lf) - 1), message, 'its message')
  end subroutine expect

  !> What is right passes, defaults are filled in.
  subroutine good_cards()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call check_deck('*elastic'//lf//'22e9'//lf//'*Elastic, type = iso'//lf//'1.,0.3,,'//lf// &
                    '*NSET, NSET=a, GENERATE'//lf//'1, 2, 3, base'//lf//'*endstep'//lf// &
                    '*PREPRINT, ECHO=YES'//lf//'*CLOAD'//lf//'"a b", 1'//lf, cards, faults)
    call check(log,.not. faults%has_errors(), 'no faults: '//text_of_errors(faults))
    call check_text(log, cards(1)%word('TYPE'), 'ISOTROPIC', 'default of a parameter')
    call check_close(log, cards(1)%real_at(1, 2), 0.2_rk, 0.0_rk, 'default of a column')
    call check_close(log, cards(6)%real_at(1, 3), 0.0_rk, 0.0_rk, 'default of another')
    call check_text(log, text_of_warnings(faults), &
                    at//'8: *PREPRINT: warning: has no effect here', 'a keyword without effect')
  end subroutine good_cards

  !> Words that are no numbers, and numbers out of range.
  subroutine broken_numbers()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call check_deck('*ELASTIC'//lf//'31 GPa, 0.2', cards, faults)
    call check_text(log, text_of_errors(faults), at// &
                    "2: *ELASTIC: found '31 GPa'; expected Young's modulus, a number > 0 [Pa]"// &
                    lf//'    2 | 31 GPa, 0.2'//lf//'      | ^^^^^^', 'the message of the contract')
    call expect('*ELASTIC'//lf//'0, 0.2', at// &
                "2: *ELASTIC: found '0'; expected Young's modulus, a number > 0 [Pa]")
    call expect('*ELASTIC'//lf//'1, 0.5', at//"2: *ELASTIC: found '0.5'; expected Poisson's "// &
                'ratio, a number > -1 and < 0.5')
    call expect('*ELASTIC'//lf//'NaN', at// &
                "2: *ELASTIC: found 'NaN'; expected Young's modulus, a number > 0 [Pa]")
    call expect('*CLOAD'//lf//'1, 4, 1', at// &
                "2: *CLOAD: found '4'; expected direction, an integer from 1 to 3")
    call expect('*CLOAD'//lf//'1, 1., 1', at// &
                "2: *CLOAD: found '1.'; expected direction, an integer from 1 to 3")
    call expect('*CLOAD'//lf//'1', at// &
                '2: *CLOAD: dof is missing; expected direction, an integer from 1 to 3')
    call expect('*CLOAD'//lf//',2', at// &
                '2: *CLOAD: node is missing; expected a node, an id or the name of a set')
    call expect('*CLOAD'//lf//'1 2 3, 1, x y', at//"2: *CLOAD: found 'x y'; expected force, "// &
                'a number [N]')
  end subroutine broken_numbers

  !> Parameters that are unknown, missing, empty or wrong.
  subroutine broken_parameters()
    call expect('*ELASTIC, TIPE=ISO'//lf//'1', at// &
                "1: *ELASTIC: unknown parameter 'TIPE'; expected TYPE; did you mean 'TYPE'?")
    call expect('*ELASTIC, TYPE=ISOTROPC'//lf//'1', at//"1: *ELASTIC: TYPE: found 'ISOTROPC'; "// &
                "expected one of ISOTROPIC, ISO; did you mean 'ISOTROPIC'?")
    call expect('*ELASTIC, TYPE='//lf//'1', at//'1: *ELASTIC: TYPE has no value; expected one '// &
                'of ISOTROPIC, ISO')
    call expect('*ELASTIC, TYPE'//lf//'1', at//'1: *ELASTIC: TYPE has no value; expected one '// &
                'of ISOTROPIC, ISO')
    call expect('*NSET'//lf//'1', at//'1: *NSET: parameter NSET is missing; expected NSET = '// &
                'name of the set, a name')
    call expect('*NSET, NSET=a, GENERATE=YES'//lf//'1', at//'1: *NSET: GENERATE takes no '// &
                'value; expected GENERATE alone')
    call expect('*AMPLITUDE, NAME=a, DT=-1'//lf//'1,2', at// &
                "1: *AMPLITUDE: DT: found '-1'; expected time step, a number >= 0 [s]")
    call expect('*END STEP, NOW', at// &
                "1: *END STEP: unknown parameter 'NOW'; expected no parameters")
  end subroutine broken_parameters

  !> Too few and too many.
  subroutine broken_counts()
    call expect('*ELASTIC', at//'1: *ELASTIC: found no data line; expected 1 data line: E, nu')
    call expect('*NSET, NSET=a', at// &
                '1: *NSET: found no data line; expected at least 1 data line: node, ..')
    call expect('*ELASTIC'//lf//'1'//lf//'2'//lf//'x', at// &
                '3: *ELASTIC: found 3 data lines; expected at most 1 data line')
    call expect('*END STEP'//lf//'1', at// &
                '2: *END STEP: found 1 data line; expected no data lines')
    call expect('*ELASTIC'//lf//'1, 0.2, 3', at// &
                '2: *ELASTIC: found 3 fields; expected at most 2: E, nu')
  end subroutine broken_counts

  !> Groups of columns that repeat in a line.
  subroutine repeated_columns()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    call check_deck('*AMPLITUDE, NAME=a'//lf//'0,0,1,1,2,2'//lf//'3,3', cards, faults)
    call check(log,.not. faults%has_errors(), 'pairs in a line')
    call expect('*AMPLITUDE, NAME=a'//lf//'0,0,1', at// &
                '2: *AMPLITUDE: value is missing; expected factor, a number')
    call expect('*AMPLITUDE, NAME=a'//lf//'0,0,1,1x', at// &
                "2: *AMPLITUDE: found '1x'; expected factor, a number")
  end subroutine repeated_columns

  !> Keywords that are not known or can do nothing.
  subroutine names_of_keywords()
    call check(log, find_spec(specs, 'ENDSTEP') == 4, 'blanks in keywords do not count')
    call check(log, find_spec(specs, 'EN D STEP') == 4, 'wherever they are')
    call check(log, find_spec(specs, 'END') == 0, 'no prefixes')
    call expect('*ELASTIK'//lf//'1', at//"1: *ELASTIK: unknown keyword; did you mean '*ELASTIC'?")
    call expect('*XYZ'//lf//'1', at//'1: *XYZ: unknown keyword')
    call expect('*RESTART, WRITE', at//'1: *RESTART: not available yet')
    call expect('*', at//"1: no keyword after the '*'; expected a keyword, or '**' for a comment")
    call expect('*ELASTIC TYPE=ISO'//lf//'1', at//'1: *ELASTIC TYPE=ISO: unknown keyword with '// &
                'a "="; expected a comma between the keyword and its parameters')
  end subroutine names_of_keywords

  !> All faults are reported, at most twenty in full.
  subroutine many_faults()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    character(:), allocatable :: text
    call check_deck('*ELASTIC, TIPE=X, TYPE=Y'//lf//'a, b'//lf//'*FOO'//lf, cards, faults)
    call check(log, faults%num_errors == 5, 'five faults at once')
    call check_deck('*CLOAD'//lf//repeat('1, 1, x'//lf, 100), cards, faults)
    call check(log, faults%num_errors == 100 .and. faults%num_kept == 20, 'a hundred faults')
    text = text_of_errors(faults)
    call check_text(log, text(index(text, lf, back=.true.) + 1:), &
                    "and 80 more in lines 22 to 101: *CLOAD: found '..'", 'the last line')
  end subroutine many_faults

  !> What a card may hold depends on the variant that it selects.
  subroutine variants_of_a_keyword()
    type(card), allocatable :: cards(:)
    type(diagnostic_list) :: faults
    character(:), allocatable :: text
    logical :: is_known
    call check_deck('*LAW'//lf//'*LAW, TYPE=SOFT, G=3', cards, faults)
    call check(log,.not. faults%has_errors(), 'no faults: '//text_of_errors(faults))
    call check_close(log, cards(1)%real('K'), 5.0_rk, 0.0_rk, 'default of the first variant')
    call check_close(log, cards(2)%real('K'), 0.0_rk, 0.0_rk, 'the second has no default')
    call check_close(log, cards(2)%real('G'), 3.0_rk, 0.0_rk, 'parameter of the second')
    call expect('*LAW, G=3', at//"1: *LAW: unknown parameter 'G'; expected one of TYPE, K, NAME")
    call expect('*LAW, TYPE=SOFT', at//'1: *LAW: parameter G is missing; expected G = energy, '// &
                'a number')
    call expect('*LAW, TYPE=STIF, K=1, G=3', at//"1: *LAW: TYPE: found 'STIF'; expected "// &
                "one of STIFF, SOFT; did you mean 'STIFF'?")
    call describe_keyword(specs, 'LAW', text, is_known)
    call check_text(log, text, '*LAW'//lf//'  A law.'//lf//lf//'Parameters'//lf// &
                    '  TYPE               which; one of STIFF, SOFT; default STIFF'//lf// &
                    '  NAME               its name; a name'//lf//lf// &
                    'With TYPE=STIFF'//lf//'  It holds.'//lf//lf// &
                    '  K                  stiffness; a number; default 5'//lf//lf// &
                    'With TYPE=SOFT'//lf//'  It gives.'//lf//lf// &
                    '  K                  stiffness; a number'//lf// &
                    '  G                  energy; a number; required'//lf//lf// &
                    'No data lines', 'page of variants')
  end subroutine variants_of_a_keyword

  !> The reference is made of the same specifications.
  subroutine reference_pages()
    character(:), allocatable :: text
    logical :: is_known
    call describe_keyword(specs, '* elastic', text, is_known)
    call check(log, is_known, 'known keyword')
    call check_text(log, text, '*ELASTIC  (in a material)'//lf// &
                    '  Linear elasticity (Eq. 1). More of it.'//lf//lf//'Parameters'//lf// &
                    '  TYPE               kind of elasticity; one of ISOTROPIC, ISO; '// &
                    'default ISOTROPIC'//lf//lf//'Data lines: 1'//lf// &
                    "  E                  Young's modulus; a number > 0 [Pa]; required"//lf// &
                    "  nu                 Poisson's ratio; a number > -1 and < 0.5; default 0.2"// &
                    lf//lf//'Example'//lf//'  *ELASTIC'//lf//'  22e9, 0.2', 'page')
    call describe_keyword(specs, 'CLOUD', text, is_known)
    call check(log,.not. is_known, 'unknown keyword')
    call check_text(log, text, "unknown keyword '*CLOUD'; expected a name of keyway "// &
                    "--keywords; did you mean '*CLOAD'?", 'its message')
    text = list_keywords(specs)
    call check(log, index(text, 'MATERIAL'//lf//'  *ELASTIC                         '// &
                          'Linear elasticity (Eq. 1)'//lf) == 1, 'list')
    call check(log, index(text, 'Checkpoints (not available yet)') > 0, 'remark')
  end subroutine reference_pages
end program test_card_check
