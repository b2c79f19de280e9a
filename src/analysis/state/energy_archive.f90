!> Saves and loads the energy balance. tests/tools/test_archives.py compares the procedures with the
!> type.
module energy_archive
  use archive_type, only: archive
  use analysis_state, only: energy_balance
  implicit none
  private
  public :: save_energy, load_energy

contains

  !> Writes the energies.
  subroutine save_energy(energy, file)
    type(energy_balance), intent(in) :: energy
    class(archive), intent(inout) :: file
    call file%put('external', energy%external)
    call file%put('kinetic', energy%kinetic)
    call file%put('strain', energy%strain)
    call file%put('damping', energy%damping)
    call file%put('friction', energy%friction)
    call file%put('fracture', energy%fracture)
    call file%put('crushing', energy%crushing)
    call file%put('left_cracking', energy%left_cracking)
    call file%put('left_crushing', energy%left_crushing)
    call file%put('left_created', energy%left_created)
    call file%put('numerical', energy%numerical)
    call file%put('stages', energy%stages)
    call file%put('temperature', energy%temperature)
    call file%put('initial', energy%initial)
    call file%put('error', energy%error)
    call file%put('largest', energy%largest)
  end subroutine save_energy

  !> Reads the energies.
  subroutine load_energy(energy, file)
    type(energy_balance), intent(inout) :: energy
    class(archive), intent(inout) :: file
    call file%get('external', energy%external)
    call file%get('kinetic', energy%kinetic)
    call file%get('strain', energy%strain)
    call file%get('damping', energy%damping)
    call file%get('friction', energy%friction)
    call file%get('fracture', energy%fracture)
    call file%get('crushing', energy%crushing)
    call file%get('left_cracking', energy%left_cracking)
    call file%get('left_crushing', energy%left_crushing)
    call file%get('left_created', energy%left_created)
    call file%get('numerical', energy%numerical)
    call file%get('stages', energy%stages)
    call file%get('temperature', energy%temperature)
    call file%get('initial', energy%initial)
    call file%get('error', energy%error)
    call file%get('largest', energy%largest)
  end subroutine load_energy
end module energy_archive
