!> A reduced step that goes on from a checkpoint (theory.md, 7.4).
!>
!> The model is built anew. With other threads or ranks round-off may change signs of modes, turn
!> modes of one frequency, or leave out another shape: modal displacements of the checkpoint are
!> then those of another model. They are found anew from the motion of the nodes.
module reduced_resume
  use analysis_state, only: state
  use column_products, only: multiply_columns
  use dense_products, only: times, transposed_times
  use errors, only: error_type
  use kinds, only: rk
  use reduced_basis, only: reduced_model, residual_response
  use reduced_ports, only: static_solvers
  use step_system, only: dam_system
  implicit none
  private
  public :: resume_modes

  !> A difference of motions, over the largest of a motion, that is round-off: the model is that of
  !> the checkpoint.
  real(rk), parameter :: round_off = 1.0e-11_rk

contains

  !> Keeps the modal motion of the checkpoint where the model gives its displacements, velocities
  !> and accelerations; otherwise finds it. Modes are orthogonal with K + s M:
  !>
  !>   (Lambda + s) y = Phi^T (K + s M) (u - u_0 - R P^T w)
  subroutine resume_modes(basis, system, solvers, now, error)
    type(reduced_model), intent(in) :: basis
    type(dam_system), intent(in) :: system
    type(static_solvers), intent(inout) :: solvers
    type(state), intent(inout) :: now !< of the checkpoint
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: moved(:, :), force(:, :), y(:, :)
    real(rk) :: largest(3)
    integer :: n
    now%reduction%num_modes = basis%num_modes
    n = system%matrix%num_free
    allocate (moved(n, 3))
    associate (own => now%motion, modal => now%motion%modal)
      call residual_response(system, solvers, basis, &
                             reshape([modal%port, modal%port_rate, modal%port_acceleration], &
                                     [size(modal%port), 3]), moved, error)
      if (allocated(error)) return
      associate (u => reshape([own%q(:n) - modal%start(:n), own%v(:n), own%a(:n)], [n, 3]))
        largest = max(maxval(abs(u), 1), maxval(abs(moved), 1))
        moved = u - moved
      end associate
      if (size(modal%y) == basis%num_modes) then
        y = reshape([modal%y, modal%rate, modal%acceleration], [basis%num_modes, 3])
        if (all(maxval(abs(times(basis%mode, y) - moved), 1) <= round_off*largest)) return
      end if
      allocate (force, mold=moved)
      call multiply_columns(system%matrix, system%stiffness + basis%shift*system%mass, moved, force)
      y = transposed_times(basis%mode, force)
      modal%y = y(:, 1)/(basis%lambda + basis%shift)
      modal%rate = y(:, 2)/(basis%lambda + basis%shift)
      modal%acceleration = y(:, 3)/(basis%lambda + basis%shift)
    end associate
  end subroutine resume_modes
end module reduced_resume
