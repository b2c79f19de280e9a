!> The block "damage" of job.json.
module damage_json
  use damage_readings, only: damage_record, damage_extreme, levels
  use json_writer, only: json_text
  implicit none
  private
  public :: put_damage

contains

  !> Writes the block where a law of the model has damage.
  subroutine put_damage(json, record)
    type(json_text), intent(inout) :: json
    type(damage_record), intent(in) :: record
    integer :: i
    if (.not. record%is_present) return
    call json%open_object('damage')
    call put_largest(json, 'DAMAGET', record%tension)
    call put_largest(json, 'DAMAGEC', record%compression)
    call json%open_array('damaged_volume')
    do i = 1, size(levels)
      call json%open_object()
      call json%put_real(levels(i), 'at_least')
      call json%put_real(record%volume(i), 'volume')
      call json%put_integer(record%elements(i), 'elements')
      call json%close_object()
    end do
    call json%close_array()
    call json%open_object('inelastic')
    call json%put_real(record%inelastic_volume, 'volume')
    call json%put_integer(record%inelastic_elements, 'elements')
    call json%close_object()
    call json%open_object('dissipated')
    call json%put_real(record%cracking, 'cracking')
    call json%put_real(record%crushing, 'crushing')
    call json%close_object()
    call json%put_real(record%created, 'created')
    call json%close_object()
  end subroutine put_damage

  !> The largest damage; place and time only where there is damage.
  subroutine put_largest(json, name, largest)
    type(json_text), intent(inout) :: json
    character(*), intent(in) :: name
    type(damage_extreme), intent(in) :: largest
    call json%open_object(name)
    call json%put_real(largest%at%value, 'value')
    if (largest%at%is_found) then
      call json%put_real(largest%at%time, 'time')
      call json%put_reals(largest%at%x, 'x')
      call json%put_integer(largest%element, 'element')
      call json%put_integer(largest%point, 'point')
    end if
    call json%close_object()
  end subroutine put_largest
end module damage_json
