!> Rows of the summary of a model, and words that several of them have.
module summary_rows
  use problem_definition, only: problem
  implicit none
  private
  public :: clock_name, name_of_base, row, unit

  integer, parameter :: name_width = 24

contains

  !> '  name    value'.
  pure function row(name, value) result(text)
    character(*), intent(in) :: name, value
    character(:), allocatable :: text
    text = '  '//name//repeat(' ', max(1, name_width - len(name)))//value
  end function row

  !> A unit of SI, '' where the deck is in other units.
  pure function unit(model, name)
    type(problem), intent(in) :: model
    character(*), intent(in) :: name !< with a blank before
    character(:), allocatable :: unit
    unit = name
    if (model%sign_of_units /= '') unit = ''
  end function unit

  !> The stiffness that BETA multiplies.
  pure function name_of_base(is_current) result(text)
    logical, intent(in) :: is_current
    character(:), allocatable :: text
    text = trim(merge('CURRENT', 'INITIAL', is_current))
  end function name_of_base

  !> The clock of an amplitude or of a table.
  pure function clock_name(uses_total_time) result(text)
    logical, intent(in) :: uses_total_time
    character(:), allocatable :: text
    text = trim(merge('total time', 'step time ', uses_total_time))
  end function clock_name
end module summary_rows
