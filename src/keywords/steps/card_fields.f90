!> The fields that a card of an output keyword names, in our words or those of Abaqus and CalculiX.
!> Words that are no field of the keyword are noted as ignored input: such cards never stop a run.
module card_fields
  use card_reader, only: field_reader
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use field_text, only: with_commas
  use nearest_words, only: nearest_choice
  use step_plan, only: field_name_length
  implicit none
  private
  public :: take_fields, field_of_word

  !> A word of another program and the field that holds it.
  type :: synonym
    character(7) :: word
    character(field_name_length) :: field
  end type synonym

  !> Strains are small here: logarithmic (LE) and nominal ones (NE) are E.
  type(synonym), parameter :: synonyms(*) = [ &
                              synonym('UT', 'U'), synonym('VT', 'V'), synonym('AT', 'A'), &
                              synonym('RT', 'RF'), synonym('LE', 'E'), synonym('NE', 'E'), &
                              synonym('MAXPS', 'SP'), synonym('COPEN', 'OPENING'), &
                              synonym('CDIS', 'OPENING'), synonym('CDISP', 'OPENING'), &
                              synonym('NT', 'TEMP'), synonym('NT11', 'TEMP'), &
                              synonym('SENER', 'ENER')]

  character(*), parameter :: vectors = 'U | V | A | RF | SP', axes = '1 | 2 | 3'
  character(*), parameter :: tensors = 'S | E | LE | NE | THE | PE', &
                             planes = '11 | 22 | 33 | 12 | 13 | 23'

  !> A word of another program that is no field, and what to take for it.
  type :: missing_field
    character(7) :: word
    character(24) :: instead
  end type missing_field

  type(missing_field), parameter :: missing_fields(*) = [ &
                                    missing_field('ME', 'E less THE'), &
                                    missing_field('EE', 'E less THE and PE'), &
                                    missing_field('CEEQ', 'none: there is no creep')]

contains

  !> Each field that the card names, once. Without data lines they are `default`.
  subroutine take_fields(this, choices, default, faults, fields)
    type(card), intent(in) :: this
    character(*), intent(in) :: choices !< of the keyword, 'U | V'
    character(*), intent(in) :: default !< a field; '' for none
    type(diagnostic_list), intent(inout) :: faults
    character(field_name_length), allocatable, intent(out) :: fields(:)
    type(field_reader) :: reader
    character(:), allocatable :: word, unknown, nearest
    unknown = ''
    nearest = ''
    allocate (fields(0))
    do while (reader%advance(this))
      if (this%is_empty_at(reader%line, reader%field)) cycle
      word = this%word_at(reader%line, reader%field)
      if (.not. is_among(field_of_word(word), choices)) then
        unknown = unknown//', '//word
        if (len(nearest) == 0) nearest = way_out(word, choices)
      else if (.not. any(fields == field_of_word(word))) then
        fields = [character(field_name_length) :: fields, field_of_word(word)]
      end if
    end do
    if (len(unknown) > 0) then
      call this%ignore(faults, 'not written: '//unknown(3:)//'; expected '// &
                       with_commas(choices)//nearest)
    else if (size(fields) == 0 .and. len(default) > 0) then
      fields = [character(field_name_length) :: default]
    end if
  end subroutine take_fields

  !> What to take for a word that is no field: '; for ME: E less THE', or a field of nearly the same
  !> spelling; '' for none.
  pure function way_out(word, choices) result(text)
    character(*), intent(in) :: word, choices
    character(:), allocatable :: text
    integer :: i
    do i = 1, size(missing_fields)
      if (missing_fields(i)%word /= word) cycle
      text = '; for '//word//': '//trim(missing_fields(i)%instead)
      return
    end do
    text = nearest_choice(word, choices)
    if (len(text) > 0) text = "; did you mean '"//text//"'?"
  end function way_out

  !> Our word for a field, or for the field of a component: E for LE11.
  pure function field_of_word(word) result(own)
    character(*), intent(in) :: word
    character(:), allocatable :: own
    integer :: i, last
    own = word
    last = verify(word, '0123456789', back=.true.)
    associate (stem => word(:last), component => word(last + 1:))
      if (is_among(stem, vectors) .and. is_among(component, axes)) own = stem
      if (is_among(stem, tensors) .and. is_among(component, planes)) own = stem
      if (stem == 'SDV') own = stem
    end associate
    do i = 1, size(synonyms)
      if (synonyms(i)%word == own) then
        own = trim(synonyms(i)%field)
        return
      end if
    end do
  end function field_of_word

  !> Whether a word is one of the choices.
  pure logical function is_among(word, choices)
    character(*), intent(in) :: word, choices
    is_among = index('| '//choices//' |', '| '//word//' |') > 0
  end function is_among
end module card_fields
