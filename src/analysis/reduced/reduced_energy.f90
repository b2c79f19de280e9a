!> The energy balance of a reduced model (theory.md, 7.3 and 7.4): the items of energy_account, from
!> the modes and the ports.
module reduced_energy
  use analysis_state, only: modal_motion, state
  use dense_products, only: times_vector
  use energy_account, only: find_error
  use global_vectors, only: work
  use guest_histories, only: sum_work
  use guest_history, only: stored_work
  use hht_scheme, only: hht
  use joint_forces, only: gather_tractions
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use mixed_products, only: mixed_times, mixed_transposed_times
  use problem_definition, only: problem
  use reduced_basis, only: reduced_model
  use reduced_increment, only: find_rates, port_forces, to_parts
  implicit none
  private
  public :: add_reduced_work

contains

  !> Adds the work of an increment.
  subroutine add_reduced_work(model, basis, operator, scheme, factors, before, after)
    type(problem), intent(in) :: model
    type(reduced_model), intent(in) :: basis
    type(jump_operator), intent(in) :: operator
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: factors(:, :) !< (loads, 2) beyond the start, at both ends
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(stored_work) :: old_stores, stores
    real(rk) :: external, damping, strain, inertial
    real(rk) :: viscous(basis%num_modes, 2) ! at both ends
    call sum_work(model, before, old_stores)
    call sum_work(model, after, stores)
    associate (old => before%motion%modal, new => after%motion%modal, energy => after%energy)
      call find_response(basis, scheme, old, new)
      external = external_work(basis, old, new, factors)
      viscous(:, 1) = times_vector(basis%damping, old%rate)
      viscous(:, 2) = times_vector(basis%damping, new%rate)
      damping = work(new%y - old%y, viscous(:, 1), viscous(:, 2)) &
                + work(new%rest - old%rest, basis%rest_damping*old%port_rate, &
                       basis%rest_damping*new%port_rate)
      strain = stored_strain(basis, new) - stored_strain(basis, old)
      inertial = inertial_work(basis, operator, scheme, factors, before, after, viscous)
      energy%external = energy%external + external
      energy%damping = energy%damping + damping
      energy%strain = energy%strain + strain + stores%stored - old_stores%stored
      energy%kinetic = energy%kinetic + kinetic(basis, new) - kinetic(basis, old)
      energy%friction = stores%friction
      energy%fracture = stores%fracture
      energy%crushing = stores%crushing
      energy%numerical = energy%numerical + external - damping - strain - inertial &
                         - (stores%stored - old_stores%stored + stores%friction &
                            - old_stores%friction + stores%fracture - old_stores%fracture) &
                         - newmark_excess(basis, scheme, old, new)
      call find_error(energy)
    end associate
  end subroutine add_reduced_work

  !> Response of the rest at the end, from that at the start and the forces of the ports.
  subroutine find_response(basis, scheme, old, new)
    type(reduced_model), intent(in) :: basis
    type(hht), intent(in) :: scheme
    type(modal_motion), intent(in) :: old
    type(modal_motion), intent(inout) :: new
    integer :: first, n
    n = size(basis%residual_read, 1)
    do first = 1, size(new%port), n
      new%rest(first:first + n - 1) = &
        mixed_times(basis%residual_read(:, first:first + n - 1), new%port(first:first + n - 1))
    end do
    call find_rates(scheme, old%rest, old%rest_rate, old%rest_acceleration, new%rest, &
                    new%rest_rate, new%rest_acceleration)
  end subroutine find_response

  !> Displacement of a port in the rest.
  pure real(rk) function rest_at(basis, rest, row)
    type(reduced_model), intent(in) :: basis
    real(rk), intent(in) :: rest(:) !< (columns of P R P^T)
    integer, intent(in) :: row !< port
    rest_at = sum(rest(row::size(basis%path, 1)))
  end function rest_at

  !> Work of the loads, those at the start of the step included.
  real(rk) function external_work(basis, old, new, factors)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: old, new
    real(rk), intent(in) :: factors(:, :) !< (loads, 2) beyond the start
    real(rk) :: mean(size(factors, 1)), step(basis%num_modes)
    integer :: n, k, row
    n = size(old%start_factor)
    mean = 0.5_rk*(factors(:, 1) + factors(:, 2))
    mean(:n) = mean(:n) + old%start_factor
    mean(n + 1:) = 0.0_rk
    step = new%y - old%y
    external_work = 0.0_rk
    do k = 1, size(mean)
      row = size(basis%path, 1) - size(mean) + k
      external_work = external_work + mean(k)*(rest_at(basis, new%rest - old%rest, row) &
                                               + dot_product(basis%path(row, :), step))
    end do
  end function external_work

  !> Strain energy of the solids beyond that at the start of the step. The last load is the internal
  !> force there.
  real(rk) function stored_strain(basis, modal)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: modal
    integer :: last
    last = size(basis%path, 1)
    stored_strain = rest_at(basis, modal%rest, last) + sum(basis%path(last, :)*modal%y) &
                    + 0.5_rk*(sum(basis%lambda*modal%y**2) &
                              + sum(basis%rest_stiffness*modal%port*modal%rest))
  end function stored_strain

  !> Kinetic energy.
  pure real(rk) function kinetic(basis, modal)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: modal
    kinetic = 0.5_rk*(sum(modal%rate**2) + sum(basis%rest_mass*modal%port_rate*modal%rest_rate))
  end function kinetic

  !> Work of the inertia forces as the balance gives them, joints by their laws. At the start they
  !> are those of the motion, which satisfied its balance.
  real(rk) function inertial_work(basis, operator, scheme, factors, before, after, viscous)
    type(reduced_model), intent(in) :: basis
    type(jump_operator), intent(in) :: operator
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: factors(:, :) !< (loads, 2)
    type(state), intent(in) :: before, after
    real(rk), intent(in) :: viscous(:, :) !< (modes, 2) damping forces at both ends
    real(rk) :: traction(3, operator%num_points), force(size(basis%path, 1))
    call gather_tractions(operator, after%joints, traction)
    force = port_forces(operator, scheme, factors, before%motion, traction)
    associate (old => before%motion%modal, new => after%motion%modal, &
               bulk => 1.0_rk + scheme%alpha, beta => basis%rest_damping, &
               share => basis%rest_stiffness)
      inertial_work = work(new%y - old%y, old%acceleration, &
                           scheme%alpha*(basis%lambda*old%y + viscous(:, 1)) &
                           - bulk*(basis%lambda*new%y + viscous(:, 2)) &
                           + mixed_transposed_times(basis%path_read, force)) &
                      + work(new%rest - old%rest, basis%rest_mass*old%port_acceleration, &
                             to_parts(basis, force) - bulk*(share*new%port + beta*new%port_rate) &
                             + scheme%alpha*(share*old%port + beta*old%port_rate))
    end associate
  end function inertial_work

  !> Change of the kinetic energy beyond du . M (mean acceleration) (7.4).
  pure real(rk) function newmark_excess(basis, scheme, old, new) result(excess)
    type(reduced_model), intent(in) :: basis
    type(hht), intent(in) :: scheme
    type(modal_motion), intent(in) :: old, new
    excess = excess_of(new%y - old%y, old%acceleration, new%acceleration, old%acceleration, &
                       new%acceleration) &
             + excess_of(new%rest - old%rest, basis%rest_mass*old%port_acceleration, &
                         basis%rest_mass*new%port_acceleration, old%rest_acceleration, &
                         new%rest_acceleration)
  contains
    !> For displacements, accelerations and inertia forces at both ends.
    pure real(rk) function excess_of(dx, a0, a1, force0, force1)
      real(rk), intent(in) :: dx(:), a0(:), a1(:), force0(:), force1(:)
      associate (g => scheme%gamma - 0.5_rk, b => scheme%beta - 0.5_rk*scheme%gamma)
        excess_of = g*sum(dx*(a1 - a0)) &
                    - b*scheme%dt**2*(0.5_rk*sum((a1 - a0)*(force0 + force1)) &
                                      + g*sum((a1 - a0)*(force1 - force0)))
      end associate
    end function excess_of
  end function newmark_excess
end module reduced_energy
