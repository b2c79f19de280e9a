!> Saves and loads the vectors of the integrators. Every component of the types has a line in each
!> procedure of a pair; tests/tools/test_archives.py compares them with the types.
module motion_archive
  use archive_type, only: archive
  use analysis_state, only: motion, modal_motion
  implicit none
  private
  public :: save_motion, load_motion

contains

  !> Writes the vectors of the integrator that are allocated.
  subroutine save_motion(own, file)
    type(motion), intent(in) :: own
    class(archive), intent(inout) :: file
    call file%put('q', own%q)
    call file%put('v', own%v)
    call file%put('a', own%a)
    call file%put('external', own%external)
    call file%put('elastic', own%elastic)
    call file%put('thermal', own%thermal)
    call file%put('thermal_energy', own%thermal_energy)
    call file%put('internal', own%internal)
    call file%put('contact', own%contact)
    call file%put('balanced', own%balanced)
    call file%put('viscous', own%viscous)
    call file%put('viscous_rate', own%viscous_rate)
    call file%put('lost_damping', own%lost_damping)
    call file%put('correction', own%correction)
    call file%put('carried_correction', own%carried_correction)
    call file%put('momentum', own%momentum)
    call file%put('inertia', own%inertia)
    call file%put('residual', own%residual)
    call file%put('last_a', own%last_a)
    call file%put('acceleration_ratio', own%acceleration_ratio)
    call file%put('last_ratio', own%last_ratio)
    call file%put('slope', own%slope)
    call file%put('bend', own%bend)
    call file%put('release', own%release)
    call file%put('carried', own%carried)
    call file%put('jump_rate', own%jump_rate)
    call file%open_group('modal')
    call save_modal(own%modal, file)
    call file%close_group()
  end subroutine save_motion

  !> Reads the vectors of the integrator that are allocated.
  subroutine load_motion(own, file)
    type(motion), intent(inout) :: own
    class(archive), intent(inout) :: file
    type(motion) :: none
    integer :: extent(1)
    own = none
    call file%get('q', own%q)
    extent = 0
    if (allocated(own%q)) extent = shape(own%q)
    call file%get('v', own%v, extent)
    call file%get('a', own%a, extent)
    call file%get('external', own%external, extent)
    call file%get('elastic', own%elastic, extent)
    call file%get('thermal', own%thermal, extent)
    call file%get('thermal_energy', own%thermal_energy)
    call file%get('internal', own%internal, extent)
    call file%get('contact', own%contact, extent)
    call file%get('balanced', own%balanced, extent)
    call file%get('viscous', own%viscous, extent)
    call file%get('viscous_rate', own%viscous_rate, extent)
    call file%get('lost_damping', own%lost_damping, extent)
    call file%get('correction', own%correction, extent)
    call file%get('carried_correction', own%carried_correction, extent)
    call file%get('momentum', own%momentum, extent)
    call file%get('inertia', own%inertia, extent)
    call file%get('residual', own%residual)
    call file%get('last_a', own%last_a, extent)
    call file%get('acceleration_ratio', own%acceleration_ratio)
    call file%get('last_ratio', own%last_ratio)
    call file%get('slope', own%slope, extent)
    call file%get('bend', own%bend, extent)
    call file%get('release', own%release, extent)
    call file%get('carried', own%carried)
    call file%get('jump_rate', own%jump_rate)
    call file%open_group('modal')
    call load_modal(own%modal, file)
    call file%close_group()
  end subroutine load_motion

  !> Writes the motion of a reduced model.
  subroutine save_modal(own, file)
    type(modal_motion), intent(in) :: own
    class(archive), intent(inout) :: file
    call file%put('start', own%start)
    call file%put('start_traction', own%start_traction)
    call file%put('start_factor', own%start_factor)
    call file%put('y', own%y)
    call file%put('rate', own%rate)
    call file%put('acceleration', own%acceleration)
    call file%put('port', own%port)
    call file%put('port_rate', own%port_rate)
    call file%put('port_acceleration', own%port_acceleration)
    call file%put('rest', own%rest)
    call file%put('rest_rate', own%rest_rate)
    call file%put('rest_acceleration', own%rest_acceleration)
    call file%put('is_expanded', own%is_expanded)
  end subroutine save_modal

  !> Reads the motion of a reduced model.
  subroutine load_modal(own, file)
    type(modal_motion), intent(inout) :: own
    class(archive), intent(inout) :: file
    call file%get('start', own%start)
    call file%get('start_traction', own%start_traction)
    call file%get('start_factor', own%start_factor)
    call file%get('y', own%y)
    call file%get('rate', own%rate)
    call file%get('acceleration', own%acceleration)
    call file%get('port', own%port)
    call file%get('port_rate', own%port_rate)
    call file%get('port_acceleration', own%port_acceleration)
    call file%get('rest', own%rest)
    call file%get('rest_rate', own%rest_rate)
    call file%get('rest_acceleration', own%rest_acceleration)
    call file%get('is_expanded', own%is_expanded)
  end subroutine load_modal
end module motion_archive
