!> The energy balance as a row of numbers.
module energy_readings
  use kinds, only: rk
  use analysis_state, only: energy_balance
  implicit none
  private
  public :: energy_columns, energy_row

  !> Names of the columns of `energy_row`.
  character(*), parameter :: energy_columns = 'external,kinetic,strain,damping,friction,'// &
                             'fracture,crushing,numerical,error'
  integer, parameter :: num_columns = 9

contains

  !> Energies since the start of the analysis [J], and the error of the balance.
  pure function energy_row(balance) result(row)
    type(energy_balance), intent(in) :: balance
    real(rk) :: row(num_columns)
    row = [balance%external, balance%kinetic, balance%strain, balance%damping, balance%friction, &
           balance%fracture, balance%crushing, balance%numerical, balance%error]
  end function energy_row
end module energy_readings
