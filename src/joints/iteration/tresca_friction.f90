!> Tresca friction: joints whose limit of friction is given, not that of their pressure. The forces
!> then minimise a convex function under these limits, so that their equilibrium always exists; with
!> friction in place of the given limits it is the fixed point of passes (theory.md, 8).
module tresca_friction
  use kinds, only: rk
  use joint_forces, only: joint_field
  implicit none
  private
  public :: update_bound, evaluate_tresca

contains

  !> Limits of friction by the pressures of the last iterate.
  pure subroutine update_bound(field)
    type(joint_field), intent(inout) :: field
    associate (own => field%tresca)
      own%bound = own%cohesion + own%friction*max(0.0_rk, -field%multiplier(1, :))
    end associate
  end subroutine update_bound

  !> Tractions, iterates and tangents of all points: contact in the augmented form of theory.md,
  !> 2.3, and friction with its limit, also where the point is open.
  pure subroutine evaluate_tresca(k_ref, field)
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    type(joint_field), intent(inout) :: field
    integer :: p, i
    field%tangent = 0.0_rk
    do p = 1, size(k_ref, 2)
      if (field%tresca%is_bonded(p)) then
        field%traction(:, p) = k_ref(:, p)*field%jump(:, p)
        field%iterate(:, p) = field%traction(:, p)
        do i = 1, 3
          field%tangent(i, i, p) = k_ref(i, p)
        end do
      else
        call press_point(p, k_ref(1, p), field)
        call rub_point(p, k_ref(2, p), field)
      end if
    end do
  end subroutine evaluate_tresca

  !> Contact of one point.
  pure subroutine press_point(p, k, field)
    integer, intent(in) :: p
    real(rk), intent(in) :: k !< k_n [Pa/m]
    type(joint_field), intent(inout) :: field
    real(rk) :: opening, scale
    opening = field%jump(1, p) + field%gap(p)
    scale = field%scale%own(1, p)
    field%traction(1, p) = k*min(0.0_rk, opening)
    field%iterate(1, p) = 0.0_rk
    if (field%multiplier(1, p)*(1.0_rk - scale/k) + scale*opening > 0.0_rk) return
    field%iterate(1, p) = k*opening
    field%tangent(1, 1, p) = k
  end subroutine press_point

  !> Friction of one point.
  pure subroutine rub_point(p, k, field)
    integer, intent(in) :: p
    real(rk), intent(in) :: k !< k_t [Pa/m]
    type(joint_field), intent(inout) :: field
    real(rk), dimension(2) :: slip, z, e, rest
    real(rk) :: bound, scale, size_of_z, ratio, softening
    bound = field%tresca%bound(p)
    scale = field%scale%own(2, p)
    slip = field%jump(2:3, p) - field%tresca%slip(:, p)
    field%traction(2:3, p) = k*slip*min(1.0_rk, bound/max(k*norm2(slip), tiny(k)))
    associate (multiplier => field%multiplier(2:3, p))
      z = multiplier*(1.0_rk - scale/k) + scale*slip
      size_of_z = norm2(z)
      if (size_of_z <= bound) then
        field%iterate(2:3, p) = k*slip
        field%tangent(2, 2, p) = k
        field%tangent(3, 3, p) = k
        return
      end if
      e = z/size_of_z
      ratio = bound/size_of_z
      softening = 1.0_rk/(1.0_rk - ratio*(1.0_rk - scale/k))
      rest = multiplier - dot_product(e, multiplier)*e
    end associate
    field%iterate(2:3, p) = bound*e + (1.0_rk - softening)*rest
    field%tangent(2, 2:3, p) = softening*ratio*scale*([1.0_rk, 0.0_rk] - e(1)*e)
    field%tangent(3, 2:3, p) = softening*ratio*scale*([0.0_rk, 1.0_rk] - e(2)*e)
  end subroutine rub_point
end module tresca_friction
