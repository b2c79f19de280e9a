!> Consistent tangent of plastic-damage concrete (theory.md, 11.7): derivative of the stress at the
!> end of an increment by the strain there.
!>
!> The return map at constant multiplier x is differentiated in closed form, and x by F(x) = 0. S is
!> parallel to its trial value, so that principal values enter by their directions alone; equal
!> values need no special case. Rows are derivatives of one quantity by the six strains.
!>
!> The width of the crack band is taken as constant. In the increment of the first crack, in an
!> element that is not a cube, it depends on the direction of the crack.
module damage_tangent
  use damage_increment, only: increment_result
  use damage_model, only: concrete_model, stiffness_of
  use kinds, only: rk
  implicit none
  private
  public :: has_regular_flow, effective_tangent, share_row

  !> Least dF/dx for a tangent, over its value in perfect plasticity; below, the branch is too
  !> steep.
  real(rk), parameter :: smallest_rate = 1.0e-6_rk

contains

  !> Whether a consistent tangent exists: increment in one part, F decreasing at its end.
  pure logical function has_regular_flow(model, increment)
    type(concrete_model), intent(in) :: model
    type(increment_result), intent(in) :: increment
    has_regular_flow = increment%num_parts == 1
    if (increment%has_yielded) then
      has_regular_flow = has_regular_flow .and. &
                         increment%flow%f_rate < -3.0_rk*smallest_rate*model%shear
    end if
  end function has_regular_flow

  !> Derivatives of the effective stress without viscosity, and of both measures of plastic strain.
  pure subroutine effective_tangent(model, increment, tangent, measure_rows)
    type(concrete_model), intent(in) :: model
    type(increment_result), intent(in) :: increment !< has_regular_flow
    real(rk), intent(out) :: tangent(6, 6) !< [Pa]
    real(rk), intent(out) :: measure_rows(6, 2)
    real(rk) :: q_trial(6), q(6), p(6), x(6), ratio
    integer :: i
    measure_rows = 0.0_rk
    if (.not. increment%has_yielded) then
      call stiffness_of(model, tangent)
      return
    end if
    q_trial = 3.0_rk*model%shear*increment%shape
    q = q_trial/increment%flow%stiffening
    p = [-model%bulk, -model%bulk, -model%bulk, 0.0_rk, 0.0_rk, 0.0_rk]
    ratio = 1.0_rk/(1.0_rk + 3.0_rk*model%shear*increment%flow%x/increment%flow%radius)
    call differentiate_flow(model, increment, ratio, measure_rows, x)
    q = q + increment%flow%q_rate*x - ratio*q_trial
    p = p + model%bulk*model%tan_dilation*x
    do i = 1, 6
      tangent(:, i) = increment%shape*q(i)
      tangent(1:3, i) = tangent(1:3, i) - p(i)
      tangent(i, i) = tangent(i, i) + model%shear*ratio
    end do
    do i = 1, 3
      tangent(i, i) = tangent(i, i) + model%shear*ratio
      tangent(1:3, i) = tangent(1:3, i) - 2.0_rk/3.0_rk*model%shear*ratio
    end do
  end subroutine effective_tangent

  !> Rows of both measures and of the multiplier.
  pure subroutine differentiate_flow(model, increment, ratio, measures, x)
    type(concrete_model), intent(in) :: model
    type(increment_result), intent(in) :: increment
    real(rk), intent(in) :: ratio !< q/q_tr
    real(rk), intent(out) :: measures(6, 2), x(6)
    real(rk) :: deviator(6, 3), q(6), p(6), share(6), slope, turn, excess(6)
    integer :: i
    associate (flow => increment%flow, trial => increment%trial)
      q = 3.0_rk*model%shear/flow%stiffening*increment%shape
      p = [-model%bulk, -model%bulk, -model%bulk, 0.0_rk, 0.0_rk, 0.0_rk]
      share = -sum(flow%share_by)*p
      do i = 1, 3
        deviator(:, i) = 2.0_rk*model%shear*ratio*deviator_of_axis(increment%axes(:, i)) &
                         + trial%shape(i)*(1.0_rk - ratio*flow%stiffening)*q
        share = share + flow%share_by(i)*deviator(:, i)
      end do
      ! Flow n_i = slope S_i + tan(psi)/3 with slope = 3/2/sqrt(a^2 + q^2).
      slope = 1.5_rk/flow%radius
      turn = slope*(flow%q/flow%radius)**2
      measures(:, 1) = flow%x*(flow%largest_flow*share &
                               + flow%share*(slope*deviator(:, 1) - turn*trial%shape(1)*q))
      measures(:, 2) = -flow%x*flow%smallest_flow*share
      if (flow%smallest_flow > 0.0_rk) then
        measures(:, 2) = measures(:, 2) - flow%x*(1.0_rk - flow%share) &
                         *(slope*deviator(:, 3) - turn*trial%shape(3)*q)
      end if
      excess = flow%f%by_q*q + flow%f%by_p*p + flow%f%by_largest*(deviator(:, 1) - p) &
               + flow%f%by_tension*flow%tension%strength_slope*measures(:, 1) &
               + flow%f%by_compression*flow%compression%strength_slope*measures(:, 2)
      x = -excess/flow%f_rate
      measures(:, 1) = measures(:, 1) + flow%measure_rates(1)*x
      measures(:, 2) = measures(:, 2) + flow%measure_rates(2)*x
    end associate
  end subroutine differentiate_flow

  !> Deviator of n n^T, in the order of a stress.
  pure function deviator_of_axis(axis) result(deviator)
    real(rk), intent(in) :: axis(3)
    real(rk) :: deviator(6)
    deviator(1:3) = axis**2 - 1.0_rk/3.0_rk
    deviator(4) = axis(1)*axis(2)
    deviator(5) = axis(1)*axis(3)
    deviator(6) = axis(2)*axis(3)
  end function deviator_of_axis

  !> Row of the weight r, from its derivatives by principal stresses and the tangent of the stress.
  pure function share_row(share_by, axes, tangent) result(row)
    real(rk), intent(in) :: share_by(3) !< [1/Pa]
    real(rk), intent(in) :: axes(3, 3) !< principal directions of the stress
    real(rk), intent(in) :: tangent(6, 6) !< [Pa]
    real(rk) :: row(6)
    real(rk) :: by_stress(6)
    integer :: i
    by_stress = 0.0_rk
    do i = 1, 3
      by_stress(1:3) = by_stress(1:3) + share_by(i)*axes(:, i)**2
      by_stress(4:6) = by_stress(4:6) &
                       + 2.0_rk*share_by(i)*axes([1, 1, 2], i)*axes([2, 3, 3], i)
    end do
    row = matmul(by_stress, tangent)
  end function share_row
end module damage_tangent
