!> Thermal expansion of a material, the same in all directions (theory.md, 16).
module thermal_expansion
  use kinds, only: rk
  implicit none
  private
  public :: expansion_table, expands_alike

  !> The mean coefficient between a zero temperature and the present one, as in Abaqus and
  !> CalculiX: linear between the temperatures of a table, constant outside.
  type :: expansion_table
    real(rk) :: zero = 0.0_rk !< temperature from which the coefficients count [K]
    real(rk), allocatable :: alpha(:) !< [1/K]
    real(rk), allocatable :: temperature(:) !< of each, ascending; size 1: alpha is constant [K]
  contains
    procedure :: between
    procedure, private :: from_zero
  end type expansion_table

contains

  !> Strain from a reference temperature to the present one.
  elemental real(rk) function between(self, reference, temperature) result(strain)
    class(expansion_table), intent(in) :: self
    real(rk), intent(in) :: reference !< without strain [K]
    real(rk), intent(in) :: temperature !< [K]
    if (size(self%alpha) == 1) then
      strain = self%alpha(1)*(temperature - reference)
    else
      strain = self%from_zero(temperature) - self%from_zero(reference)
    end if
  end function between

  !> Strain from the zero temperature.
  pure real(rk) function from_zero(self, temperature) result(strain)
    class(expansion_table), intent(in) :: self
    real(rk), intent(in) :: temperature !< [K]
    real(rk) :: alpha, share
    integer :: k
    associate (t => self%temperature, a => self%alpha)
      k = count(t <= temperature)
      if (k == 0) then
        alpha = a(1)
      else if (k == size(t)) then
        alpha = a(k)
      else
        share = (temperature - t(k))/(t(k + 1) - t(k))
        alpha = a(k) + share*(a(k + 1) - a(k))
      end if
    end associate
    strain = alpha*(temperature - self%zero)
  end function from_zero

  !> Whether two materials have the same thermal expansion, or none.
  pure logical function expands_alike(first, second)
    type(expansion_table), intent(in), allocatable :: first, second
    expands_alike = allocated(first) .eqv. allocated(second)
    if (.not. (expands_alike .and. allocated(first))) return
    expands_alike = size(first%alpha) == size(second%alpha)
    if (.not. expands_alike) return
    expands_alike = all(abs(first%alpha - second%alpha) <= 0.0_rk)
    if (size(first%alpha) == 1) return
    expands_alike = expands_alike .and. abs(first%zero - second%zero) <= 0.0_rk .and. &
                    all(abs(first%temperature - second%temperature) <= 0.0_rk)
  end function expands_alike
end module thermal_expansion
