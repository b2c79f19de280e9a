!> Strength and damage of concrete over plastic strain, in tension and in compression.
!>
!> The deck gives them over inelastic strain, or over the opening w of a crack. The knots are the
!> rows of both tables; knot i is at the plastic strain (paper_notes.md, 11)
!>     w_i/l - c_i,  c_i = d_i/(1 - d_i) sigma_i/E,
!> with the width l of the crack band (1 for tables over strain). Between knots the nominal strength
!> and the damage are linear in plastic strain, beyond the last knot constant. The effective
!> strength is sigma/(1 - d) (paper_notes.md, 9).
!>
!> With damage c is nonlinear in w, so that a curve linear in plastic strain is not linear in the
!> opening, and the energy of a crack would depend on l. Curves over openings therefore have knots
!> between the rows, on straight lines over w where the width of the band admits it.
module damage_curves
  use damage_constants, only: concrete_constants
  use kinds, only: rk
  implicit none
  private
  public :: strength_curve, curve_value, make_tension_curve, make_compression_curve
  public :: place_knots, value_of_curve, row_below, noticeable_strain, smallest_strength

  !> Smallest strength of a curve, as a fraction of the first. At zero strength beta of Eq. 23 is
  !> undefined and the yield surface encloses nothing. The extra energy of a crack is at most a
  !> thousandth of f_t times its opening.
  real(rk), parameter :: smallest_strength = 1.0e-3_rk
  !> Smallest plastic part of an inelastic strain. Tables of pure damage, with all knots at zero,
  !> remain functions of plastic strain; their rows are exact to this fraction.
  real(rk), parameter :: smallest_plastic_share = 1.0e-5_rk
  real(rk), parameter :: same_row = 1.0e-9_rk !< closer abscissae (relative) are one row
  !> Knots for a change of 1 in sigma/f_t or in damage, for curves over openings with damage. For
  !> linear softening to zero with a final damage of 0.9, in half the widest band, the error of the
  !> dissipated energy is 33 % with two rows alone, and 0.1 % with these knots.
  integer, parameter :: knots_over_unit = 32
  !> A crack counts as open from this share of the opening G/f_t, with the area G under the curve.
  !> It has then dissipated at most this share of G, unless the curve rises above f_t.
  real(rk), parameter :: noticeable_share = 1.0e-3_rk

  !> Rows of strength and damage tables, over the abscissa of the deck.
  type :: strength_curve
    real(rk), allocatable :: abscissa(:) !< inelastic strain, or opening [m]
    real(rk), allocatable :: recoverable(:) !< c_i, its part recovered in unloading
    real(rk), allocatable :: strength(:) !< nominal [Pa]
    real(rk), allocatable :: damage(:)
    real(rk) :: longest = huge(1.0_rk) !< widest admissible band, by the rows [m]
    !> Widest band in which the curve is straight over the opening between the rows [m]
    real(rk) :: longest_straight = huge(1.0_rk)
    !> Widest band in which the plastic strain increases from knot to knot, by more than least [m]
    real(rk) :: widest_regular = 0.0_rk
    integer :: steepest = 0 !< the knot that limits the band
    logical :: turns_back = .false. !< in a wider band the strain would decrease
    !> Over openings: the row below the opening of a noticeable crack, and the part of the interval
    !> above it; 0 without
    integer :: noticeable_row = 0
    real(rk) :: noticeable_part = 0.0_rk
  end type strength_curve

  !> The curve at a plastic strain, with derivatives.
  type :: curve_value
    real(rk) :: strength = 0.0_rk, strength_slope = 0.0_rk !< effective [Pa]
    real(rk) :: damage = 0.0_rk, damage_slope = 0.0_rk
  end type curve_value

contains

  !> Tension; the tables must be free of faults.
  pure subroutine make_tension_curve(constants, curve)
    type(concrete_constants), intent(in) :: constants
    type(strength_curve), intent(out) :: curve
    real(rk) :: linear(2, 2)
    logical :: has_openings
    has_openings = constants%stiffening /= 'STRAIN'
    if (constants%stiffening == 'GFI') then
      linear(:, 1) = [constants%tension(1, 1), 0.0_rk]
      linear(:, 2) = [smallest_strength*constants%tension(1, 1), (1.0_rk - smallest_strength) &
                      *2.0_rk*constants%tension(2, 1)/constants%tension(1, 1)]
      call unite_rows(linear, constants%tension_damage, constants%young, has_openings, curve)
    else
      call unite_rows(constants%tension, constants%tension_damage, constants%young, &
                      has_openings, curve)
    end if
  end subroutine make_tension_curve

  !> Compression; the tables must be free of faults.
  pure subroutine make_compression_curve(constants, curve)
    type(concrete_constants), intent(in) :: constants
    type(strength_curve), intent(out) :: curve
    call unite_rows(constants%compression, constants%compression_damage, constants%young, &
                    .false., curve)
  end subroutine make_compression_curve

  !> Unites the rows of two tables, with linear interpolation in each table.
  pure subroutine unite_rows(strength, damage, young, has_openings, curve)
    real(rk), intent(in) :: strength(:, :) !< (2, rows) sigma [Pa], abscissa
    real(rk), intent(in), allocatable :: damage(:, :) !< (2, rows) d, abscissa; unallocated: d = 0
    real(rk), intent(in) :: young !< E_0 [Pa]
    logical, intent(in) :: has_openings !< linear in w between the rows
    type(strength_curve), intent(out) :: curve
    integer :: i
    curve%abscissa = strength(2, :)
    if (allocated(damage)) call merge_abscissae(damage(2, :), curve%abscissa)
    allocate (curve%damage(size(curve%abscissa)), source=0.0_rk)
    curve%strength = [(value_of_table(strength, curve%abscissa(i)), i=1, size(curve%abscissa))]
    curve%strength = max(curve%strength, smallest_strength*strength(1, 1))
    if (allocated(damage)) then
      curve%damage = [(value_of_table(damage, curve%abscissa(i)), i=1, size(curve%abscissa))]
    end if
    call find_recoverable(curve, young)
    if (has_openings) then
      call limit_band(curve, young, curve%longest, curve%steepest, curve%turns_back)
      if (allocated(damage)) call add_knots(curve)
      call find_recoverable(curve, young)
      call limit_band(curve, young, curve%longest_straight)
      call find_noticeable(curve)
    end if
    call find_regular(curve)
  end subroutine unite_rows

  !> c_i.
  pure subroutine find_recoverable(curve, young)
    type(strength_curve), intent(inout) :: curve
    real(rk), intent(in) :: young !< E_0 [Pa]
    curve%recoverable = curve%damage/(1.0_rk - curve%damage)*curve%strength/young
  end subroutine find_recoverable

  !> Finds `widest_regular`, for the final knots.
  pure subroutine find_regular(curve)
    type(strength_curve), intent(inout) :: curve
    real(rk) :: opening, returned
    integer :: i
    curve%widest_regular = huge(1.0_rk)
    do i = 2, size(curve%abscissa)
      opening = curve%abscissa(i) - curve%abscissa(i - 1)
      returned = curve%recoverable(i) - curve%recoverable(i - 1)
      if (returned <= 0.0_rk) cycle
      curve%widest_regular = min(curve%widest_regular, &
                                 (1.0_rk - 2.0_rk*smallest_plastic_share)*opening/returned)
    end do
  end subroutine find_regular

  !> Adds new abscissae to an ascending list.
  pure subroutine merge_abscissae(new, list)
    real(rk), intent(in) :: new(:)
    real(rk), allocatable, intent(inout) :: list(:)
    integer :: i, before
    do i = 1, size(new)
      if (any(abs(list - new(i)) <= same_row*abs(new(i)))) cycle
      before = count(list < new(i))
      list = [list(:before), new(i), list(before + 1:)]
    end do
  end subroutine merge_abscissae

  !> Divides the intervals between rows equally, into changes of at most 1/knots_over_unit of the
  !> first strength and of a damage of 1.
  pure subroutine add_knots(curve)
    type(strength_curve), intent(inout) :: curve
    integer :: parts(2:size(curve%abscissa)) !< of the interval before each row
    real(rk), dimension(size(curve%abscissa)) :: abscissa, strength, damage
    real(rk) :: share, change
    integer :: i, k, knot, steepest
    steepest = curve%steepest
    abscissa = curve%abscissa
    strength = curve%strength
    damage = curve%damage
    do i = 2, size(abscissa)
      change = max(abs(strength(i) - strength(i - 1))/strength(1), damage(i) - damage(i - 1))
      parts(i) = max(1, ceiling(change*knots_over_unit))
    end do
    deallocate (curve%abscissa, curve%strength, curve%damage)
    knot = 1 + sum(parts)
    allocate (curve%abscissa(knot), curve%strength(knot), curve%damage(knot))
    curve%abscissa(1) = abscissa(1)
    curve%strength(1) = strength(1)
    curve%damage(1) = damage(1)
    knot = 1
    do i = 2, size(abscissa)
      do k = 1, parts(i)
        knot = knot + 1
        share = real(k, rk)/parts(i)
        curve%abscissa(knot) = mix(abscissa(i - 1:i), share)
        curve%strength(knot) = mix(strength(i - 1:i), share)
        curve%damage(knot) = mix(damage(i - 1:i), share)
      end do
      if (i == steepest) curve%steepest = knot
    end do
  end subroutine add_knots

  !> Finds where a crack has opened noticeably (see noticeable_share).
  pure subroutine find_noticeable(curve)
    type(strength_curve), intent(inout) :: curve
    real(rk) :: opening
    integer :: n
    n = size(curve%abscissa)
    if (n == 1) return
    associate (w => curve%abscissa, s => curve%strength)
      opening = noticeable_share*0.5_rk/s(1)*sum((s(2:) + s(:n - 1))*(w(2:) - w(:n - 1)))
      curve%noticeable_row = min(count(w <= opening), n - 1)
      curve%noticeable_part = (opening - w(curve%noticeable_row)) &
                              /(w(curve%noticeable_row + 1) - w(curve%noticeable_row))
    end associate
  end subroutine find_noticeable

  !> Plastic strain where a crack has opened noticeably.
  pure real(rk) function noticeable_strain(curve, knots) result(strain)
    type(strength_curve), intent(in) :: curve
    real(rk), intent(in) :: knots(:) !< from place_knots
    strain = 0.0_rk
    if (curve%noticeable_row == 0) return
    strain = mix(knots(curve%noticeable_row:curve%noticeable_row + 1), curve%noticeable_part)
  end function noticeable_strain

  !> Linear interpolation between two values.
  pure real(rk) function mix(ends, share)
    real(rk), intent(in) :: ends(2), share !< 0: first, 1: second value
    mix = (1.0_rk - share)*ends(1) + share*ends(2)
  end function mix

  !> Linear between the rows, constant outside.
  pure real(rk) function value_of_table(table, abscissa) result(value)
    real(rk), intent(in) :: table(:, :) !< (2, rows) ordinate, abscissa
    real(rk), intent(in) :: abscissa
    integer :: i, n
    n = size(table, 2)
    i = count(table(2, :) <= abscissa)
    if (i == 0) then
      value = table(1, 1)
    else if (i == n) then
      value = table(1, n)
    else
      value = table(1, i) + (table(1, i + 1) - table(1, i)) &
              *(abscissa - table(2, i))/(table(2, i + 1) - table(2, i))
    end if
  end function value_of_table

  !> Widest crack band of a curve over openings [m]. In a wider band the strain w/l + sigma/E would
  !> decrease from one row or knot to the next (snap-back), or the plastic strain would decrease
  !> (paper_notes.md, 11). For linear softening without damage the limit is 2 E G_f/f_t^2.
  pure subroutine limit_band(curve, young, longest, steepest, turns_back)
    type(strength_curve), intent(in) :: curve
    real(rk), intent(in) :: young !< E_0 [Pa]
    real(rk), intent(out) :: longest !< huge: no limit
    integer, intent(out), optional :: steepest !< the row or knot that limits the band, 0 for none
    logical, intent(out), optional :: turns_back !< in a wider band the strain would decrease
    real(rk) :: opening, lost, returned
    integer :: i
    longest = huge(1.0_rk)
    if (present(steepest)) steepest = 0
    if (present(turns_back)) turns_back = .false.
    do i = 2, size(curve%abscissa)
      opening = curve%abscissa(i) - curve%abscissa(i - 1)
      lost = (curve%strength(i - 1) - curve%strength(i))/young
      returned = max(lost, curve%recoverable(i) - curve%recoverable(i - 1))
      if (returned <= 0.0_rk) cycle
      if (opening/returned >= longest) cycle
      longest = opening/returned
      if (present(steepest)) steepest = i
      if (present(turns_back)) turns_back = lost >= returned
    end do
  end subroutine limit_band

  !> Plastic strain of the knots in a band of width l. If l exceeds the widest band, all strengths
  !> are multiplied by f = sqrt(longest/l) and all openings by 1/f, which keeps the energy.
  pure subroutine place_knots(curve, length, knots, factor)
    type(strength_curve), intent(in) :: curve
    real(rk), intent(in) :: length !< l [m]; 1 for tables over strain
    real(rk), intent(out) :: knots(:) !< (knots)
    real(rk), intent(out) :: factor !< f; 1 in admissible bands
    real(rk) :: width, scale, least
    integer :: i
    factor = 1.0_rk
    if (length > curve%longest) factor = sqrt(curve%longest/length)
    width = min(length, curve%longest)
    scale = factor/width
    knots = scale*curve%abscissa - factor*curve%recoverable
    if (width <= curve%widest_regular) then
      knots(1) = 0.0_rk
      return
    end if
    least = smallest_plastic_share*scale
    do i = size(knots) - 1, 1, -1
      knots(i) = min(knots(i), knots(i + 1))
    end do
    knots(1) = 0.0_rk
    do i = 2, size(knots)
      knots(i) = max(knots(i), knots(i - 1) &
                     + least*(curve%abscissa(i) - curve%abscissa(i - 1)))
    end do
  end subroutine place_knots

  !> Effective strength and damage at a plastic strain.
  pure subroutine value_of_curve(curve, knots, factor, plastic, row, value)
    type(strength_curve), intent(in) :: curve
    real(rk), intent(in) :: knots(:), factor !< from place_knots
    real(rk), intent(in) :: plastic !< strain, not negative
    integer, intent(inout) :: row !< of the knot below; on entry a guess, at least 1
    type(curve_value), intent(out) :: value
    real(rk) :: strength, strength_slope, step, inverse
    row = row_below(knots, plastic, row)
    strength = curve%strength(row)
    value%damage = curve%damage(row)
    strength_slope = 0.0_rk
    if (row < size(knots)) then
      step = 1.0_rk/(knots(row + 1) - knots(row))
      strength_slope = (curve%strength(row + 1) - strength)*step
      value%damage_slope = (curve%damage(row + 1) - value%damage)*step
      strength = strength + strength_slope*(plastic - knots(row))
      value%damage = value%damage + value%damage_slope*(plastic - knots(row))
    end if
    inverse = 1.0_rk/(1.0_rk - value%damage)
    value%strength = strength*factor*inverse
    value%strength_slope = (strength_slope + strength*inverse*value%damage_slope)*factor*inverse
  end subroutine value_of_curve

  !> The last row with a knot at or below a plastic strain, the first one if there is none: the
  !> guess, or by bisection without branches, which processors would predict wrongly.
  pure integer function row_below(knots, plastic, guess) result(row)
    real(rk), intent(in) :: knots(:) !< ascending
    real(rk), intent(in) :: plastic
    integer, intent(in) :: guess
    integer :: num_left, half
    row = guess
    if (knots(guess) <= plastic) then
      if (guess == size(knots)) return
      if (knots(guess + 1) > plastic) return
    end if
    row = 1
    num_left = size(knots)
    do while (num_left > 1)
      half = num_left/2
      row = merge(row + half, row, knots(row + half) <= plastic)
      num_left = num_left - half
    end do
  end function row_below
end module damage_curves
