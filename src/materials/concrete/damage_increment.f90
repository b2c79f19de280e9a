!> One increment of strain of plastic-damage concrete without viscosity: plastic strain, kappa_t,
!> kappa_c and the effective stress.
module damage_increment
  use crack_band, only: band_width
  use damage_model, only: concrete_model, place_curves, placed_curves
  use damage_return, only: find_flow, flow_by, flow_state, trial_state
  use kinds, only: rk
  use tensor6, only: principal_axes, second_invariant, trace
  implicit none
  private
  public :: plastic_state, increment_result, integrate_increment, elastic_stress
  public :: deviator_of, yield_tolerance

  integer, parameter :: max_parts = 64
  real(rk), parameter :: yield_tolerance = 1.0e-11_rk !< of F over the strength in compression

  !> History of concrete without viscosity.
  type :: plastic_state
    real(rk) :: strain(6) = 0.0_rk !< plastic, engineering shear
    real(rk) :: measures(2) = 0.0_rk !< kappa_t, kappa_c
    !> Of the crack band [m]; 0 before the first crack. That of the present crack until kappa_t is
    !> noticeable, kept from then on.
    real(rk) :: width = 0.0_rk
  end type plastic_state

  !> End of an increment, with the data for the tangent.
  type :: increment_result
    type(plastic_state) :: state
    real(rk) :: stress(6) = 0.0_rk !< effective [Pa]
    logical :: has_yielded = .false.
    logical :: has_converged = .true.
    integer :: num_parts = 1 !< of the increment
    real(rk) :: trial_excess = 0.0_rk !< F of the trial state [Pa]
    real(rk) :: shape(6) = 0.0_rk !< S_tr/q_tr
    real(rk) :: axes(3, 3) = 0.0_rk !< principal directions, if requested
    type(trial_state) :: trial
    type(flow_state) :: flow
  end type increment_result

contains

  !> D strain.
  pure function elastic_stress(model, strain) result(stress)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: strain(6)
    real(rk) :: stress(6)
    stress(1:3) = 2.0_rk*model%shear*strain(1:3) &
                  + (model%bulk - 2.0_rk/3.0_rk*model%shear)*(strain(1) + strain(2) + strain(3))
    stress(4:6) = model%shear*strain(4:6)
  end function elastic_stress

  !> Integrates the increment at once; if the return map fails, in 2, 4, ... equal parts of the
  !> strain. A root always exists (see damage_return); smaller parts help where round-off of a very
  !> large trial stress exceeds a strength near zero.
  pure subroutine integrate_increment(model, before, strain, edges, old, placed, end_state)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: before(6), strain(6) !< at both ends of the increment
    real(rk), intent(in) :: edges(3, 3) !< of the element, columns [m]
    type(plastic_state), intent(in) :: old
    type(placed_curves), intent(inout) :: placed
    type(increment_result), intent(out) :: end_state
    type(plastic_state) :: start
    real(rk) :: target_strain(6)
    integer :: num_parts, part
    num_parts = 1
    do while (num_parts <= max_parts)
      start = old
      do part = 1, num_parts
        target_strain = before + (strain - before)*part/num_parts
        call integrate_part(model, target_strain, edges, start, placed, end_state)
        if (.not. end_state%has_converged) exit
        start = end_state%state
      end do
      end_state%num_parts = num_parts
      if (end_state%has_converged) return
      num_parts = 2*num_parts
    end do
  end subroutine integrate_increment

  !> Integrates a part of an increment.
  pure subroutine integrate_part(model, strain, edges, old, placed, end_state)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: strain(6) !< at the end of the part
    real(rk), intent(in) :: edges(3, 3)
    type(plastic_state), intent(in) :: old
    type(placed_curves), intent(inout) :: placed
    type(increment_result), intent(out) :: end_state
    real(rk) :: principal(3), deviator(6), width
    associate (trial => end_state%trial, flow => end_state%flow)
      end_state%state = old
      end_state%stress = elastic_stress(model, strain - old%strain)
      trial%p = -trace(end_state%stress)/3.0_rk
      trial%measures = old%measures
      deviator = deviator_of(end_state%stress)
      trial%q = sqrt(3.0_rk*second_invariant(deviator))
      call principal_axes(deviator, principal, end_state%axes)
      if (trial%q > 0.0_rk) then
        end_state%shape = deviator/trial%q
        trial%shape = principal/trial%q
      end if
      width = old%width
      if (width <= 0.0_rk) width = band_width(edges, end_state%axes(:, 1))
      call try_width(model, width, placed, end_state)
      if (.not. end_state%has_yielded) return
      if (revises_width(placed, old)) then
        width = band_width(edges, end_state%axes(:, 1))
        call try_width(model, width, placed, end_state)
        if (.not. end_state%has_yielded) then
          width = old%width ! whose damage the point has
          call place_curves(model, width, placed)
          call flow_by(model, placed, trial, 0.0_rk, flow)
          return
        end if
      end if
      call find_flow(model, placed, trial, flow, end_state%has_converged)
      call take_flow(model, width, end_state)
    end associate
  end subroutine integrate_part

  !> F of the trial state in a band of some width.
  pure subroutine try_width(model, width, placed, end_state)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: width !< [m]
    type(placed_curves), intent(inout) :: placed
    type(increment_result), intent(inout) :: end_state
    call place_curves(model, width, placed)
    associate (flow => end_state%flow)
      call flow_by(model, placed, end_state%trial, 0.0_rk, flow)
      end_state%trial_excess = flow%f%value
      end_state%has_converged = abs(flow%f%value) < huge(width) ! not for NaN
      end_state%has_yielded = end_state%has_converged &
                              .and. flow%f%value > yield_tolerance*flow%compression%strength
    end associate
  end subroutine try_width

  !> Whether a point that yields takes the width of its present direction: its crack is not
  !> noticeable yet. Crushing under a tension of nothing, or of round-off, makes such cracks.
  pure logical function revises_width(placed, old)
    type(placed_curves), intent(in) :: placed !< for the old width
    type(plastic_state), intent(in) :: old
    revises_width = old%width > 0.0_rk .and. old%measures(1) < placed%noticeable
  end function revises_width

  !> The deviator, with a trace of zero to round-off of its own size. In nearly hydrostatic states
  !> round-off of the pressure would otherwise change the volume of the flow.
  pure function deviator_of(stress) result(deviator)
    real(rk), intent(in) :: stress(6)
    real(rk) :: deviator(6)
    deviator = stress
    deviator(1:3) = deviator(1:3) - trace(stress)/3.0_rk
    deviator(1:3) = deviator(1:3) - trace(deviator)/3.0_rk
  end function deviator_of

  !> Adds the flow to the plastic strain.
  pure subroutine take_flow(model, width, end_state)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: width
    type(increment_result), intent(inout) :: end_state
    real(rk) :: direction(6)
    associate (flow => end_state%flow, state => end_state%state)
      direction(1:3) = 1.5_rk*flow%q/flow%radius*end_state%shape(1:3) + model%tan_dilation/3.0_rk
      direction(4:6) = 3.0_rk*flow%q/flow%radius*end_state%shape(4:6)
      state%strain = state%strain + flow%x*direction
      state%measures = flow%measures
      if (state%measures(1) > 0.0_rk) state%width = width
      end_state%stress = flow%q*end_state%shape
      end_state%stress(1:3) = end_state%stress(1:3) - flow%p
    end associate
  end subroutine take_flow
end module damage_increment
