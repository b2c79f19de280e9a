!> RECOVERY=ENERGY: effective stress in two parts, the closest point of no tension in the energy
!> norm and the rest (theory.md, (11.3a)).
!>
!> The closest point is that of no-tension materials (Del Piero, Meccanica 24 (1989) 150-162); the
!> split by it: Freddi & Royer-Carfagni, J. Mech. Phys. Solids 58 (2010) 1154-1174; Wu & Cervera,
!> Int. J. Solids Struct. 139-140 (2018). Both parts are orthogonal in energy, so that
!>     left_t psi_t + left_c psi_c
!> is a free energy: its derivative is the stress, and a closed loop of strain at constant damage
!> does no work.
module damage_split
  use damage_curves, only: curve_value, value_of_curve
  use damage_model, only: concrete_model, placed_curves, stiffness_of
  use kinds, only: rk
  implicit none
  private
  public :: energy_split, stiffness_left, split_stress, left_after, nominal_stress
  public :: stiffness_of_split, tension_at

  !> The part without tension of an effective stress, in its principal directions.
  type :: energy_split
    real(rk) :: pressed(3) = 0.0_rk !< principal values of the part without tension [Pa]
    real(rk) :: normal(3, 3) = 0.0_rk !< their derivatives by principal elastic strains [Pa]
    !> Differences of these values over differences of the strains: 12, 13, 23 [Pa]
    real(rk) :: shear(3) = 0.0_rk
    real(rk) :: energy(2) = 0.0_rk !< psi_t, psi_c: of the rest and of the part without tension
  end type energy_split

  !> Fractions of the stiffness that are left in both parts.
  type :: stiffness_left
    real(rk) :: value(2) = 1.0_rk !< left_t, left_c
    real(rk) :: by_damage(2, 2) = 0.0_rk !< (part, damage) derivatives by d_t, d_c
  end type stiffness_left

contains

  !> Splits an effective stress. The four cases have no, one, two or three principal directions in
  !> which the strain opens. Where cases meet, values are continuous and derivatives jump.
  pure subroutine split_stress(model, s, split)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: s(3) !< principal effective stresses, the largest first [Pa]
    type(energy_split), intent(out) :: split
    real(rk) :: e(3), nu, plane, gap(2:3), opening
    nu = model%poisson
    e = ((1.0_rk + nu)*s - nu*sum(s))/model%young
    if (s(1) <= 0.0_rk) then
      split%pressed = s
      split%normal = model%bulk - 2.0_rk/3.0_rk*model%shear
      split%normal(1, 1) = split%normal(1, 1) + 2.0_rk*model%shear
      split%normal(2, 2) = split%normal(1, 1)
      split%normal(3, 3) = split%normal(1, 1)
      split%shear = 2.0_rk*model%shear
    else if (e(2) + nu*e(3) <= 0.0_rk) then
      plane = model%young/(1.0_rk - nu**2)
      gap = -[e(2) + nu*e(3), e(3) + nu*e(2)]
      split%pressed(2:3) = -plane*gap
      split%normal(2:3, 2:3) = plane*nu
      split%normal(2, 2) = plane
      split%normal(3, 3) = plane
      ! e_1 - e_i = (opening + gap_i)/(1 - nu); opening > 0, so that equal strains need no limit.
      opening = s(1)*(1.0_rk + nu)*(1.0_rk - 2.0_rk*nu)/model%young
      split%shear(1:2) = 2.0_rk*model%shear*gap/(opening + gap)
      split%shear(3) = 2.0_rk*model%shear
    else if (e(3) < 0.0_rk) then
      split%pressed(3) = model%young*e(3)
      split%normal(3, 3) = model%young
      split%shear(2:3) = -split%pressed(3)/(e(1:2) - e(3)) ! e_1, e_2 > -nu e_3
    end if
    split%energy(2) = 0.5_rk*dot_product(split%pressed, e)
    split%energy(1) = 0.5_rk*dot_product(s, e) - split%energy(2)
  end subroutine split_stress

  !> What both damages leave. With d_t alone, and with d_c alone, uniaxial tests have the stiffness
  !> of Eqs. 15-16: in tension with free lateral contraction part c = 2 nu^2/(1 - nu) of the energy
  !> is in the part without tension, and left_t makes up for it.
  pure elemental subroutine left_after(model, tension, compression, left)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: tension, compression !< d_t, d_c
    type(stiffness_left), intent(out) :: left
    real(rk) :: c, a, b, soft_t, soft_c, own, own_rate
    c = 2.0_rk*model%poisson**2/(1.0_rk - model%poisson)
    soft_t = 1.0_rk - model%tension_recovery
    soft_c = 1.0_rk - model%compression_recovery
    a = 1.0_rk - tension
    b = 1.0_rk - soft_c*tension
    own = (1.0_rk - c)*a*b/(b - c*a)
    own_rate = -own**2/(1.0_rk - c)*(1.0_rk/a**2 - c*soft_c/b**2)
    left%value = [own*(1.0_rk - soft_t*compression), b*(1.0_rk - compression)]
    left%by_damage(1, :) = [own_rate*(1.0_rk - soft_t*compression), -own*soft_t]
    left%by_damage(2, :) = [-soft_c*(1.0_rk - compression), -b]
  end subroutine left_after

  !> left_t sigma_t + left_c sigma_c.
  pure function nominal_stress(stress, axes, split, left) result(nominal)
    real(rk), intent(in) :: stress(6), axes(3, 3) !< effective [Pa], its principal directions
    type(energy_split), intent(in) :: split
    real(rk), intent(in) :: left(2)
    real(rk) :: nominal(6)
    integer :: i
    nominal = left(1)*stress
    do i = 1, 3
      nominal = nominal + (left(2) - left(1))*split%pressed(i)*product_of(axes(:, i), axes(:, i))
    end do
  end function nominal_stress

  !> Derivative of the nominal stress by the elastic strain at constant damage: symmetric, positive
  !> definite while anything is left of both parts.
  pure subroutine stiffness_of_split(model, axes, split, left, stiffness)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: axes(3, 3)
    type(energy_split), intent(in) :: split
    real(rk), intent(in) :: left(2)
    real(rk), intent(out) :: stiffness(6, 6) !< [Pa]
    real(rk) :: products(6, 3)
    integer, parameter :: first(3) = [1, 1, 2], second(3) = [2, 3, 3]
    integer :: i, j
    call stiffness_of(model, stiffness)
    stiffness = left(1)*stiffness
    do i = 1, 3
      products(:, i) = product_of(axes(:, i), axes(:, i))
    end do
    do i = 1, 3
      do j = 1, 3
        call add_dyad((left(2) - left(1))*split%normal(i, j), products(:, i), products(:, j), &
                      stiffness)
      end do
    end do
    do i = 1, 3
      products(:, i) = product_of(axes(:, first(i)), axes(:, second(i)))
      call add_dyad(2.0_rk*(left(2) - left(1))*split%shear(i), products(:, i), products(:, i), &
                    stiffness)
    end do
  end subroutine stiffness_of_split

  !> Adds factor u v^T.
  pure subroutine add_dyad(factor, u, v, matrix)
    real(rk), intent(in) :: factor, u(6), v(6)
    real(rk), intent(inout) :: matrix(6, 6)
    integer :: k
    do k = 1, 6
      matrix(:, k) = matrix(:, k) + factor*v(k)*u
    end do
  end subroutine add_dyad

  !> The symmetric part of a b^T, in the order of a stress.
  pure function product_of(a, b) result(tensor)
    real(rk), intent(in) :: a(3), b(3)
    real(rk) :: tensor(6)
    tensor(1:3) = a*b
    tensor(4:6) = 0.5_rk*(a([1, 1, 2])*b([2, 3, 3]) + a([2, 3, 3])*b([1, 1, 2]))
  end function product_of

  !> Effective strength and damage in tension at a plastic strain.
  !>
  !> With RECOVERY=ENERGY the effective stress of a cracked bar with free sides has lateral tension,
  !> k = nu/(1 - nu) (1 - left_t/left_c) of the axial one. The strength is the one at which this
  !> state yields (Eq. 19, uncrushed), so that the bar carries the stress of the table.
  pure subroutine tension_at(model, placed, plastic, row, value)
    type(concrete_model), intent(in) :: model
    type(placed_curves), intent(in) :: placed
    real(rk), intent(in) :: plastic !< kappa_t
    integer, intent(inout) :: row !< as in value_of_curve
    type(curve_value), intent(out) :: value
    type(stiffness_left) :: left
    real(rk) :: axial, axial_slope, k, k_slope, weight, inverse
    call value_of_curve(model%tension, placed%tension, placed%factor, plastic, row, value)
    if (.not. model%splits_energy) return
    call left_after(model, value%damage, 0.0_rk, left)
    associate (l => left%value, l_slope => left%by_damage(:, 1)*value%damage_slope)
      ! Axial effective stress: that of the curve has the nominal one over 1 - d_t.
      axial = value%strength*(1.0_rk - value%damage)/l(1)
      axial_slope = (value%strength_slope*(1.0_rk - value%damage) &
                     - value%strength*value%damage_slope - axial*l_slope(1))/l(1)
      weight = model%poisson/(1.0_rk - model%poisson)*(1.0_rk - 2.0_rk*model%alpha) &
               /((1.0_rk - model%alpha)*model%compression%strength(1))
      k = weight*(1.0_rk - l(1)/l(2))
      k_slope = weight*(l(1)*l_slope(2)/l(2) - l_slope(1))/l(2)
    end associate
    inverse = 1.0_rk/(1.0_rk + k*axial)
    value%strength = axial*inverse
    value%strength_slope = (axial_slope - axial**2*k_slope)*inverse**2
  end subroutine tension_at
end module damage_split
