!> *EXPANSION.
module keywords_expansion
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword, field, kind_choice, kind_real
  use kinds, only: rk
  use model_draft, only: draft
  use thermal_expansion, only: expansion_table
  use write_text, only: as_text
  implicit none
  private
  public :: describe_expansion, read_expansion

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_expansion(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'EXPANSION'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Thermal expansion, the same in all directions. Strain counts from the '// &
                   'initial temperature (*INITIAL CONDITIONS, TYPE=TEMPERATURE), or from that '// &
                   'at which an element appears (*MODEL CHANGE). A table over temperature has '// &
                   'mean coefficients from ZERO on, linear between its temperatures, constant '// &
                   'outside; with one coefficient ZERO has no effect.'
    spec%example = '*EXPANSION'//nl//'1e-5'
    spec%fewest_lines = 1
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'kind of expansion', default='ISO', &
                    choices='ISO | ISOTROPIC'), &
              field('ZERO', kind_real, 'temperature from which the coefficients of a table '// &
                    'count', 'K', '0')])
    allocate (spec%columns, source=[ &
              field('alpha', kind_real, 'coefficient of expansion', '1/K', is_required=.true., &
                    lowest=0.0_rk), &
              field('temperature', kind_real, 'of the coefficient', 'K')])
  end subroutine describe_expansion

  subroutine read_expansion(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(expansion_table) :: table
    integer :: line
    associate (now => model%problem%materials(model%num_materials))
      if (allocated(now%expansion)) then
        call this%fault(faults, "material '"//now%name//"' already has an *EXPANSION", 'one only')
        return
      end if
      table%zero = this%real('ZERO')
      table%alpha = [(this%real_at(line, 1), line=1, this%num_lines)]
      table%temperature = [(this%real_at(line, 2), line=1, this%num_lines)]
      if (this%num_lines == 0) return
      call check_temperatures(this, table, faults)
      allocate (now%expansion, source=table)
    end associate
  end subroutine read_expansion

  !> The lines of a table have temperatures that ascend.
  subroutine check_temperatures(this, table, faults)
    type(card), intent(in) :: this
    type(expansion_table), intent(in) :: table
    type(diagnostic_list), intent(inout) :: faults
    integer :: line
    do line = 2, this%num_lines
      if (this%is_empty_at(line, 2) .or. this%is_empty_at(1, 2)) then
        call this%fault_at(faults, line, 2, 'a coefficient without temperature', &
                           'alpha, temperature in every line of a table')
        return
      else if (table%temperature(line) <= table%temperature(line - 1)) then
        call this%fault_at(faults, line, 2, 'temperature '//as_text(table%temperature(line))// &
                           ' after '//as_text(table%temperature(line - 1)), &
                           'temperatures that ascend')
        return
      end if
    end do
  end subroutine check_temperatures
end module keywords_expansion
