!> Yield stress over the equivalent plastic strain: a table, linear between its rows and constant
!> past the last one (theory.md, 17.1).
module yield_curve
  use kinds, only: rk
  implicit none
  private
  public :: hardening_curve

  type :: hardening_curve
    real(rk), allocatable :: strain(:) !< equivalent plastic strain, from 0, ascending
    real(rk), allocatable :: stress(:) !< yield stress in uniaxial tension of each row [Pa]
  contains
    procedure :: find_flow
    procedure :: value_at
    procedure :: work_between
    procedure :: slope_of
  end type hardening_curve

contains

  !> Yield stress at an equivalent plastic strain [Pa].
  pure real(rk) function value_at(self, strain) result(stress)
    class(hardening_curve), intent(in) :: self
    real(rk), intent(in) :: strain
    integer :: k
    k = row_at(self, strain)
    stress = self%stress(k) + self%slope_of(k)*(strain - self%strain(k))
  end function value_at

  !> Last row at or below a strain.
  pure integer function row_at(self, strain) result(k)
    class(hardening_curve), intent(in) :: self
    real(rk), intent(in) :: strain
    k = 1
    do while (k < size(self%strain))
      if (self%strain(k + 1) > strain) return
      k = k + 1
    end do
  end function row_at

  !> Slope of the segment above a row; 0 past the last one [Pa].
  pure real(rk) function slope_of(self, row) result(slope)
    class(hardening_curve), intent(in) :: self
    integer, intent(in) :: row
    slope = 0.0_rk
    if (row >= size(self%strain)) return
    slope = (self%stress(row + 1) - self%stress(row))/(self%strain(row + 1) - self%strain(row))
  end function slope_of

  !> The growth of the equivalent plastic strain at which a stress that falls by `fall` times the
  !> growth meets the curve, segment by segment. All slopes must exceed -`fall`: then the growth is
  !> unique. It is not positive while the stress is below the curve.
  pure subroutine find_flow(self, start, stress, fall, growth, slope)
    class(hardening_curve), intent(in) :: self
    real(rk), intent(in) :: start !< equivalent plastic strain before
    real(rk), intent(in) :: stress !< without further flow [Pa]
    real(rk), intent(in) :: fall !< three shear moduli [Pa]
    real(rk), intent(out) :: growth
    real(rk), intent(out) :: slope !< of the curve where they meet [Pa]
    integer :: k
    do k = row_at(self, start), size(self%strain)
      slope = self%slope_of(k)
      growth = (stress - self%stress(k) - slope*(start - self%strain(k)))/(fall + slope)
      if (k == size(self%strain)) return
      if (start + growth <= self%strain(k + 1)) return
    end do
  end subroutine find_flow

  !> Area below the curve between two strains: plastic work per volume [J/m3].
  pure real(rk) function work_between(self, from, to) result(work)
    class(hardening_curve), intent(in) :: self
    real(rk), intent(in) :: from, to
    real(rk) :: left, right
    integer :: k
    work = 0.0_rk
    left = from
    do k = row_at(self, from), size(self%strain)
      right = to
      if (k < size(self%strain)) right = min(to, self%strain(k + 1))
      work = work + (right - left)*(self%stress(k) + self%slope_of(k)* &
                                    (0.5_rk*(left + right) - self%strain(k)))
      if (right >= to) return
      left = right
    end do
  end function work_between
end module yield_curve
