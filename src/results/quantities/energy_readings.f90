!> The energy balance as a row of numbers.
module energy_readings
  use kinds, only: rk
  use analysis_state, only: energy_balance
  use problem_definition, only: problem
  implicit none
  private
  public :: energy_columns, energy_row

contains

  !> Names of the columns of `energy_row`; models with stages or temperatures have more.
  pure function energy_columns(model) result(names)
    type(problem), intent(in) :: model
    character(:), allocatable :: names
    names = 'external,kinetic,strain,damping,friction,fracture,crushing,numerical,'
    if (model%stages%is_there_any()) names = names//'stages,'
    if (model%heat%is_there_any()) names = names//'temperature,'
    names = names//'error'
  end function energy_columns

  !> Energies since the start of the analysis [J], and the error of the balance.
  pure function energy_row(model, balance) result(row)
    type(problem), intent(in) :: model
    type(energy_balance), intent(in) :: balance
    real(rk), allocatable :: row(:)
    row = [balance%external, balance%kinetic, balance%strain, balance%damping, balance%friction, &
           balance%fracture, balance%crushing, balance%numerical]
    if (model%stages%is_there_any()) row = [row, balance%stages]
    if (model%heat%is_there_any()) row = [row, balance%temperature]
    row = [row, balance%error]
  end function energy_row
end module energy_readings
