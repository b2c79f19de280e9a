!> Requests for fields that nothing of the model has: a warning each, where the deck asks first.
module check_requests
  use card_reader, only: field_reader
  use diagnostics, only: diagnostic_list
  use law_fields, only: is_field_of_law, width_of_field
  use model_draft, only: draft
  implicit none
  private
  public :: warn_of_missing_fields

  !> Keywords that name fields of materials.
  character(14), parameter :: requests(5) = ['EL FILE       ', 'NODE FILE     ', 'ELEMENT OUTPUT', &
                                             'EL PRINT      ', 'ENVELOPE      ']

contains

  !> The problem must be complete, with its inelastic blocks.
  subroutine warn_of_missing_fields(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(field_reader) :: reader
    character(8), allocatable :: told(:)
    character(8) :: word
    integer :: i
    allocate (told(0))
    do i = 1, size(model%cards)
      associate (request => model%cards(i))
        if (.not. any(request%keyword == requests)) cycle
        reader = field_reader()
        do while (reader%advance(request))
          word = request%word_at(reader%line, reader%field)
          if (any(told == word)) cycle
          if (word == 'OPENING' .and. request%keyword == 'ENVELOPE' &
              .and. size(model%scene%joints) == 0) then
            told = [character(8) :: told, word]
            call request%warn(faults, 'the model has no joints; OPENING is not written')
          end if
          if (.not. is_field_of_law(word)) cycle
          if (width_of_field(model%scene, trim(word)) > 0) cycle
          told = [character(8) :: told, word]
          call request%warn(faults, 'no material of the model has '//trim(word)// &
                            '; it is not written')
        end do
      end associate
    end do
  end subroutine warn_of_missing_fields
end module check_requests
