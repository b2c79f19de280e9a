!> Warns of requested fields that the model does not have, at the first request of each field.
module check_requests
  use card_fields, only: field_of_word
  use card_reader, only: field_reader
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use field_table, only: ending_of_points, find_field, list_fields
  use field_type, only: at_joints, by_heat, by_law, result_field
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
    type(result_field), allocatable :: table(:)
    character(:), allocatable :: reason
    character(:), allocatable :: name
    logical, allocatable :: is_reported(:)
    integer :: i, f
    call list_fields(table)
    allocate (is_reported(size(table)), source=.false.)
    do i = 1, size(model%cards)
      associate (request => model%cards(i))
        if (.not. any(request%keyword == requests)) cycle
        reader = field_reader()
        do while (reader%advance(request))
          name = field_of_word(request%word_at(reader%line, reader%field))
          f = find_field(table, name)
          if (is_of_points(request)) f = max(f, find_field(table, name//ending_of_points))
          if (f == 0) cycle
          if (is_reported(f)) cycle
          reason = why_missing(model, table(f), request%keyword)
          if (len(reason) == 0) cycle
          is_reported(f) = .true.
          call request%warn(faults, reason)
        end do
      end associate
    end do
  end subroutine warn_of_missing_fields

  !> Is it *ENVELOPE, POSITION=POINTS?
  logical function is_of_points(request)
    type(card), intent(in) :: request
    is_of_points = .false.
    if (request%keyword == 'ENVELOPE') is_of_points = request%word('POSITION') == 'POINTS'
  end function is_of_points

  !> The warning; '' where the model has the field. *EL FILE may request openings of any model.
  function why_missing(model, item, keyword) result(reason)
    type(draft), intent(in) :: model
    type(result_field), intent(in) :: item
    character(*), intent(in) :: keyword
    character(:), allocatable :: reason
    reason = ''
    if (item%is_in(model%problem)) return
    if (item%place == at_joints .and. keyword == 'ENVELOPE') then
      reason = 'the model has no joints; '//item%name//' is not written'
    else if (item%provider == by_law) then
      reason = 'no material of the model has '//item%name//'; it is not written'
    else if (item%provider == by_heat) then
      reason = 'the model has no '//item%meaning//'; '//item%name//' is not written'
    end if
  end function why_missing
end module check_requests
