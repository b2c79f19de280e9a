!> The energy balance of a reduced model (theory.md, 7.3 and 7.4): the items of energy_account, from
!> the modes and the ports.
module reduced_energy
  use analysis_state, only: modal_motion, state
  use energy_account, only: find_error
  use global_vectors, only: work
  use guest_histories, only: sum_work
  use guest_history, only: stored_work
  use hht_scheme, only: hht
  use joint_forces, only: gather_tractions
  use joint_operator, only: jump_operator
  use kinds, only: rk
  use problem_definition, only: problem
  use reduced_basis, only: reduced_model
  use reduced_increment, only: modal_forces, port_forces
  implicit none
  private
  public :: add_reduced_work

  !> Responses of the rest to the forces that it follows, and to their rates, at one time.
  type :: rest_response
    real(rk), allocatable :: x(:), rate(:), acceleration(:) !< (ports)
  end type rest_response

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
    type(rest_response) :: first, last
    real(rk) :: external, damping, strain, inertial
    call sum_work(model, before, old_stores)
    call sum_work(model, after, stores)
    associate (old => before%motion%modal, new => after%motion%modal, energy => after%energy)
      first = respond(basis, old)
      last = respond(basis, new)
      external = external_work(basis, old, new, first, last, factors)
      damping = work(new%y - old%y, matmul(basis%damping, old%rate), &
                     matmul(basis%damping, new%rate)) &
                + basis%residual_damping*work(last%x - first%x, old%port_rate, new%port_rate)
      strain = stored_strain(basis, new, last) - stored_strain(basis, old, first)
      inertial = inertial_work(basis, operator, scheme, factors, before, after, last%x - first%x)
      energy%external = energy%external + external
      energy%damping = energy%damping + damping
      energy%strain = energy%strain + strain + stores%stored - old_stores%stored
      energy%kinetic = energy%kinetic + kinetic(basis, new, last) - kinetic(basis, old, first)
      energy%friction = stores%friction
      energy%fracture = stores%fracture
      energy%crushing = stores%crushing
      energy%numerical = energy%numerical + external - damping - strain - inertial &
                         - (stores%stored - old_stores%stored + stores%friction &
                            - old_stores%friction + stores%fracture - old_stores%fracture) &
                         - newmark_excess(basis, scheme, old, new, first, last)
      call find_error(energy)
    end associate
  end subroutine add_reduced_work

  !> Responses of the rest.
  function respond(basis, modal) result(response)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: modal
    type(rest_response) :: response
    response%x = matmul(basis%residual, modal%port)
    response%rate = matmul(basis%residual, modal%port_rate)
    response%acceleration = matmul(basis%residual, modal%port_acceleration)
  end function respond

  !> Work of the loads, those at the start of the step included.
  real(rk) function external_work(basis, old, new, first, last, factors)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: old, new
    type(rest_response), intent(in) :: first, last
    real(rk), intent(in) :: factors(:, :) !< (loads, 2) beyond the start
    real(rk) :: mean(size(factors, 1)), path(size(first%x))
    integer :: n
    n = size(old%start_factor)
    mean = 0.5_rk*(factors(:, 1) + factors(:, 2))
    mean(:n) = mean(:n) + old%start_factor
    mean(n + 1:) = 0.0_rk
    path = last%x - first%x + matmul(basis%path, new%y - old%y)
    external_work = sum(mean*path(size(path) - size(mean) + 1:))
  end function external_work

  !> Strain energy of the solids beyond that at the start of the step. The last load is the internal
  !> force there.
  real(rk) function stored_strain(basis, modal, rest)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: modal
    type(rest_response), intent(in) :: rest
    integer :: last
    last = size(rest%x)
    stored_strain = rest%x(last) + sum(basis%path(last, :)*modal%y) &
                    + 0.5_rk*(sum(basis%lambda*modal%y**2) + sum(modal%port*rest%x))
  end function stored_strain

  !> Kinetic energy.
  pure real(rk) function kinetic(basis, modal, rest)
    type(reduced_model), intent(in) :: basis
    type(modal_motion), intent(in) :: modal
    type(rest_response), intent(in) :: rest
    kinetic = 0.5_rk*(sum(modal%rate**2) + basis%residual_mass*sum(modal%port_rate*rest%rate))
  end function kinetic

  !> Work of the inertia forces as the balance gives them, joints by their laws. At the start they
  !> are those of the motion, which satisfied its balance.
  real(rk) function inertial_work(basis, operator, scheme, factors, before, after, moved)
    type(reduced_model), intent(in) :: basis
    type(jump_operator), intent(in) :: operator
    type(hht), intent(in) :: scheme
    real(rk), intent(in) :: factors(:, :) !< (loads, 2)
    type(state), intent(in) :: before, after
    real(rk), intent(in) :: moved(:) !< (ports) by the rest [m]
    real(rk) :: traction(3, operator%num_points), force(size(moved))
    call gather_tractions(operator, after%joints, traction)
    force = port_forces(operator, scheme, factors, before%motion, traction)
    associate (old => before%motion%modal, new => after%motion%modal, &
               bulk => 1.0_rk + scheme%alpha, beta => basis%residual_damping)
      inertial_work = work(new%y - old%y, old%acceleration, &
                           bulk*modal_forces(basis, new) - scheme%alpha*modal_forces(basis, old) &
                           + matmul(force, basis%path)) &
                      + work(moved, basis%residual_mass*old%port_acceleration, &
                             force - bulk*(new%port + beta*new%port_rate) &
                             + scheme%alpha*(old%port + beta*old%port_rate))
    end associate
  end function inertial_work

  !> Change of the kinetic energy beyond du . M (mean acceleration) (7.4).
  pure real(rk) function newmark_excess(basis, scheme, old, new, first, last) result(excess)
    type(reduced_model), intent(in) :: basis
    type(hht), intent(in) :: scheme
    type(modal_motion), intent(in) :: old, new
    type(rest_response), intent(in) :: first, last
    excess = excess_of(new%y - old%y, old%acceleration, new%acceleration, old%acceleration, &
                       new%acceleration) &
             + basis%residual_mass*excess_of(last%x - first%x, old%port_acceleration, &
                                             new%port_acceleration, first%acceleration, &
                                             last%acceleration)
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
