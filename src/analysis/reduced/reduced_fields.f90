!> The motion of a reduced model in all unknowns, for results: one solve.
module reduced_fields
  use analysis_state, only: state
  use amplitudes, only: amplitude
  use errors, only: error_type
  use global_vectors, only: multiply
  use kinds, only: rk
  use reduced_basis, only: reduced_model, residual_response
  use reduced_ports, only: static_solvers
  use state_transfer, only: sum_contact
  use step_loads, only: external_force, step_time
  use step_system, only: dam_system
  implicit none
  private
  public :: expand_motion

contains

  !> Fills displacements, rates and forces.
  subroutine expand_motion(basis, system, solvers, amplitudes, when, now, error)
    type(reduced_model), intent(in) :: basis
    type(dam_system), intent(in) :: system
    type(static_solvers), intent(inout) :: solvers
    type(amplitude), intent(in) :: amplitudes(:)
    type(step_time), intent(in) :: when
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: x(system%matrix%num_free, 3)
    associate (own => now%motion, modal => now%motion%modal, n => system%matrix%num_free)
      call residual_response(system, solvers, basis, &
                             reshape([modal%port, modal%port_rate, modal%port_acceleration], &
                                     [size(modal%port), 3]), x, error)
      if (allocated(error)) return
      own%q = modal%start
      own%q(:n) = own%q(:n) + x(:, 1) + matmul(basis%mode, modal%y)
      own%v = 0.0_rk
      own%v(:n) = x(:, 2) + matmul(basis%mode, modal%rate)
      own%a = 0.0_rk
      own%a(:n) = x(:, 3) + matmul(basis%mode, modal%acceleration)
      call external_force(system%groups, amplitudes, when, own%external)
      call system%find_elastic(own%q, own%elastic)
      own%internal = own%elastic
      call multiply(system%mass_pattern, system%mass_entries, own%v, own%momentum)
      call multiply(system%mass_pattern, system%mass_entries, own%a, own%inertia)
      own%balanced = own%inertia
      call system%find_damping_force(own%v, own%viscous)
      call sum_contact(system%operator, now)
      modal%is_expanded = .true.
    end associate
  end subroutine expand_motion
end module reduced_fields
