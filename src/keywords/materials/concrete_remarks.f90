!> Warnings about unusual constants of a concrete, and a summary of the constants in one line.
module concrete_remarks
  use concrete_request, only: concrete_cards
  use damage_checks, only: find_longest_band, stiffening_table, table_fault
  use damage_constants, only: concrete_constants
  use damage_model, only: concrete_model, largest_safe_dilation, make_concrete_model
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_constants, describe_concrete

  real(rk), parameter :: usual_strain = 1.0e-4_rk !< f_t/E of concrete
  real(rk), parameter :: degree = acos(-1.0_rk)/180.0_rk

contains

  !> Warns of constants that are allowed but probably a mistake.
  subroutine warn_of_constants(given, model, faults)
    type(concrete_cards), intent(in) :: given !< whose tables are free of faults
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    call warn_of_units(given, model, faults)
    call warn_of_dilation(given, model, faults)
    call warn_of_steep_strain(given, model, faults)
  end subroutine warn_of_constants

  !> Concrete of any quality cracks at a strain of about 1e-4 (f_t 1 to 5 MPa, E 15 to 45 GPa); at a
  !> strain far from it the strength and the modulus have different units.
  subroutine warn_of_units(given, model, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: strain
    strain = given%constants%tension(1, 1)/given%constants%young
    if (strain > 0.01_rk*usual_strain .and. strain < 100.0_rk*usual_strain) return
    call model%cards(given%stiffening%card)%warn( &
      faults, 'the concrete cracks at a strain f_t/E of '//as_text(strain), 'about '// &
      as_text(usual_strain)//' for concrete; f_t and E must have the same unit')
  end subroutine warn_of_units

  !> On the tensile meridian of Eq. 19 (s_1 = 2/3 q - p) q (1 + 2/3 gamma) = (3 alpha + gamma) p +
  !> (1 - alpha) c: where the slope of this line is less than tan psi, q - p tan psi is negative
  !> above some pressure. The work of plastic flow is then negative, too.
  subroutine warn_of_dilation(given, model, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(concrete_model) :: kernel
    real(rk) :: slope, pressure
    call make_concrete_model(given%constants, kernel)
    slope = largest_safe_dilation(given%constants%biaxial_ratio, given%constants%meridian_ratio)
    if (kernel%tan_dilation <= slope) return
    pressure = (1.0_rk - kernel%alpha)*maxval(given%constants%compression(1, :)) &
               /(1.0_rk + 2.0_rk*kernel%gamma/3.0_rk)/(kernel%tan_dilation - slope)
    call model%cards(given%plasticity%card)%warn( &
      faults, 'plastic flow would create energy under a mean pressure above '// &
      as_text(pressure), 'a dilation of at most '//as_text(atan(slope)/degree)// &
      ' deg with these fb0/fc0 and Kc')
  end subroutine warn_of_dilation

  !> Warns of a table over strain whose stress falls so steeply that a test snaps back.
  subroutine warn_of_steep_strain(given, model, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(concrete_constants) :: as_openings
    type(table_fault) :: limit
    real(rk) :: longest
    if (given%constants%stiffening /= 'STRAIN') return
    as_openings = given%constants
    as_openings%stiffening = 'DISPLACEMENT' ! of a band 1 m wide
    if (allocated(as_openings%tension_damage)) deallocate (as_openings%tension_damage)
    call find_longest_band(as_openings, longest, limit)
    if (longest >= 1.0_rk) return
    call model%cards(given%stiffening%card)%warn( &
      faults, 'the stress falls by more than E times the increase of inelastic strain in row '// &
      as_text(limit%row)//': a test under strain control skips this part of the table')
  end subroutine warn_of_steep_strain

  !> The summary: strengths, energy of a crack and widths of the crack bands.
  function describe_concrete(constants, smallest, largest) result(text)
    type(concrete_constants), intent(in) :: constants !< whose tables are free of faults
    real(rk), intent(in) :: smallest, largest !< widths of crack bands in its elements [m]
    character(:), allocatable :: text
    type(table_fault) :: limit
    real(rk) :: longest
    text = 'cracks at '//as_text(constants%tension(1, 1))//' Pa, '
    if (constants%stiffening == 'STRAIN') then
      text = text//as_text(area_under(constants%tension))//' J/m3'
    else if (constants%stiffening == 'GFI') then
      text = text//as_text(constants%tension(2, 1))//' N/m'
    else
      text = text//as_text(area_under(constants%tension))//' N/m'
    end if
    call find_longest_band(constants, longest, limit)
    if (limit%row > 0) text = text//', in elements up to '//as_text(longest)//' m'
    text = text//'; crushes from '//as_text(constants%compression(1, 1))//' Pa'
    if (smallest > largest) return
    text = text//'; its elements are '//as_text(smallest)//' to '//as_text(largest)//' m long'
  end function describe_concrete

  !> Area under a table, to its last row.
  pure real(rk) function area_under(table) result(area)
    real(rk), intent(in) :: table(:, :) !< (2, rows) ordinate, abscissa
    integer :: n
    n = size(table, 2)
    area = sum(0.5_rk*(table(1, 2:n) + table(1, :n - 1))*(table(2, 2:n) - table(2, :n - 1)))
  end function area_under
end module concrete_remarks
