!> Model of plastic-damage concrete: derived constants and curves.
module damage_model
  use damage_constants, only: concrete_constants
  use damage_curves, only: make_compression_curve, make_tension_curve, noticeable_strain, &
                           place_knots, strength_curve
  use kinds, only: rk
  implicit none
  private
  public :: concrete_model, placed_curves, make_concrete_model, place_curves, stiffness_of
  public :: largest_safe_dilation

  real(rk), parameter :: degree = acos(-1.0_rk)/180.0_rk

  !> Constants of Eqs. 14-25; theory.md, 11.
  type :: concrete_model
    real(rk) :: young = 0.0_rk, poisson = 0.0_rk !< E_0 [Pa], nu
    real(rk) :: shear = 0.0_rk, bulk = 0.0_rk !< mu, K [Pa]
    real(rk) :: alpha = 0.0_rk, gamma = 0.0_rk !< of Eq. 19
    real(rk) :: tan_dilation = 0.0_rk !< tan psi of Eq. 25
    real(rk) :: rounding = 0.0_rk !< a of Eq. 25 [Pa]; see rounding_of
    real(rk) :: tension_recovery = 0.0_rk, compression_recovery = 1.0_rk !< w_t, w_c of Eq. 16
    logical :: recovers_by_sign = .false. !< r of Eq. 17
    logical :: splits_energy = .false. !< RECOVERY=ENERGY: see damage_split
    real(rk) :: viscosity = 0.0_rk !< [s]
    logical :: by_opening = .false. !< the curve in tension depends on the crack band
    type(strength_curve) :: tension, compression
  end type concrete_model

  !> Plastic strains of the knots of both curves for one width of the crack band; the caller keeps
  !> them from point to point.
  type :: placed_curves
    real(rk) :: width = -1.0_rk !< of the band [m]; negative: not placed yet
    real(rk) :: factor = 1.0_rk !< of the strength in tension, below 1 in too wide a band
    real(rk) :: rounding = 0.0_rk !< a of Eq. 25 with that strength [Pa]
    real(rk) :: noticeable = 0.0_rk !< kappa_t from which a crack keeps its width
    real(rk), allocatable :: tension(:), compression(:)
  end type placed_curves

contains

  !> Makes the model from constants whose tables are free of faults.
  pure subroutine make_concrete_model(constants, model)
    type(concrete_constants), intent(in) :: constants
    type(concrete_model), intent(out) :: model
    real(rk) :: b, k
    b = constants%biaxial_ratio
    k = constants%meridian_ratio
    model%young = constants%young
    model%poisson = constants%poisson
    model%shear = constants%young/(2.0_rk*(1.0_rk + constants%poisson))
    model%bulk = constants%young/(3.0_rk*(1.0_rk - 2.0_rk*constants%poisson))
    model%alpha = (b - 1.0_rk)/(2.0_rk*b - 1.0_rk)
    model%gamma = 3.0_rk*(1.0_rk - k)/(2.0_rk*k - 1.0_rk)
    model%tan_dilation = tan(constants%dilation*degree)
    model%tension_recovery = constants%tension_recovery
    model%compression_recovery = constants%compression_recovery
    model%recovers_by_sign = constants%recovery == 'SIGN'
    model%splits_energy = constants%recovery == 'ENERGY'
    model%viscosity = constants%viscosity
    model%by_opening = constants%stiffening /= 'STRAIN'
    call make_tension_curve(constants, model%tension)
    call make_compression_curve(constants, model%compression)
    model%rounding = rounding_of(model, constants%offset)
  end subroutine make_concrete_model

  !> Places the curves for a width of the crack band, if it has changed.
  pure subroutine place_curves(model, width, placed)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: width !< [m]; any positive number for tables over strain
    type(placed_curves), intent(inout) :: placed
    real(rk) :: used, whole
    used = 1.0_rk
    if (model%by_opening) used = width
    if (abs(placed%width - used) <= 0.0_rk) return
    if (.not. allocated(placed%tension)) then
      allocate (placed%tension(size(model%tension%abscissa)))
      allocate (placed%compression(size(model%compression%abscissa)))
      call place_knots(model%compression, 1.0_rk, placed%compression, whole)
    end if
    call place_knots(model%tension, used, placed%tension, placed%factor)
    placed%rounding = placed%factor*model%rounding
    placed%noticeable = noticeable_strain(model%tension, placed%tension)
    placed%width = used
  end subroutine place_curves

  !> D, the undamaged stiffness.
  pure subroutine stiffness_of(model, d)
    type(concrete_model), intent(in) :: model
    real(rk), intent(out) :: d(6, 6) !< [Pa]
    integer :: i
    d = 0.0_rk
    d(1:3, 1:3) = model%bulk - 2.0_rk/3.0_rk*model%shear
    do i = 1, 3
      d(i, i) = d(i, i) + 2.0_rk*model%shear
      d(i + 3, i + 3) = model%shear
    end do
  end subroutine stiffness_of

  !> a of Eq. 25, xi sigma_10 tan psi, limited so that the work of flow, q^2/sqrt(a^2 + q^2) - p tan
  !> psi, is not negative at the end of the curves: with a larger a the flow at the apex would
  !> generate energy. The limit is active only where an effective strength is below about a third of
  !> xi sigma_10. Its effect is small: a changes the flow near the hydrostatic axis alone.
  !>
  !> With a principal tension under pressure q >= 3/2 p, and q >= (1 + alpha) t by Eq. 19, or
  !> (1 - alpha) c where beta is kept at zero. Without a principal tension q exceeds p tan psi by
  !> (1 - alpha) c/(1 + 2/3 gamma) at least (see largest_safe_dilation).
  pure real(rk) function rounding_of(model, offset) result(rounding)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: offset !< xi
    real(rk) :: tension, compression, steepness
    rounding = offset*model%tension%strength(1)*model%tan_dilation
    steepness = model%tan_dilation/1.5_rk
    if (steepness >= 1.0_rk) return
    tension = minval(model%tension%strength/(1.0_rk - model%tension%damage))
    compression = minval(model%compression%strength/(1.0_rk - model%compression%damage))
    rounding = min(rounding, (1.0_rk - model%alpha)*compression &
                   /(1.0_rk + 2.0_rk/3.0_rk*model%gamma), &
                   sqrt(1.0_rk - steepness**2)/steepness &
                   *min((1.0_rk + model%alpha)*tension, (1.0_rk - model%alpha)*compression))
  end function rounding_of

  !> Largest tan psi for which flow never generates energy: the smaller of 3/2, the least q/p of
  !> states with a principal tension, and the least slope q/p of the yield surface under high
  !> pressure, on the tensile meridian (s_1 = -p + 2 q/3 in Eq. 19). With this limit and the a of
  !> rounding_of the work of flow, q^2/sqrt(a^2 + q^2) - p tan psi, is not negative.
  pure real(rk) function largest_safe_dilation(biaxial_ratio, meridian_ratio) result(tangent)
    real(rk), intent(in) :: biaxial_ratio !< f_b0/f_c0
    real(rk), intent(in) :: meridian_ratio !< K_c
    real(rk) :: alpha, gamma
    alpha = (biaxial_ratio - 1.0_rk)/(2.0_rk*biaxial_ratio - 1.0_rk)
    gamma = 3.0_rk*(1.0_rk - meridian_ratio)/(2.0_rk*meridian_ratio - 1.0_rk)
    tangent = min(1.5_rk, (3.0_rk*alpha + gamma)/(1.0_rk + 2.0_rk/3.0_rk*gamma))
  end function largest_safe_dilation
end module damage_model
