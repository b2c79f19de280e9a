!> Products of a symmetric matrix with one, two or eight vectors (symmetric_product.c).
!>
!> The matrix is its lower triangle by columns, the diagonal first. The entries of an unknown in all
!> vectors are side by side. All procedures give y = A x.
module symmetric_product
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  private
  public :: keyway_multiply_one, keyway_multiply_two, keyway_multiply_eight

  interface
    pure subroutine keyway_multiply_one(unknowns, entries, start, alike, row, value, x, y) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), intent(in), value :: unknowns, entries
      integer(c_int), intent(in) :: start(unknowns + 1), alike(unknowns), row(entries)
      real(c_double), intent(in) :: value(entries)
      real(c_double), intent(in) :: x(unknowns)
      real(c_double), intent(out) :: y(unknowns)
    end subroutine keyway_multiply_one

    pure subroutine keyway_multiply_two(unknowns, entries, start, alike, row, value, x, y) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), intent(in), value :: unknowns, entries
      integer(c_int), intent(in) :: start(unknowns + 1), alike(unknowns), row(entries)
      real(c_double), intent(in) :: value(entries)
      real(c_double), intent(in) :: x(2, unknowns)
      real(c_double), intent(out) :: y(2, unknowns)
    end subroutine keyway_multiply_two

    pure subroutine keyway_multiply_eight(unknowns, entries, start, alike, row, value, x, y) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), intent(in), value :: unknowns, entries
      integer(c_int), intent(in) :: start(unknowns + 1), alike(unknowns), row(entries)
      real(c_double), intent(in) :: value(entries)
      real(c_double), intent(in) :: x(8, unknowns)
      real(c_double), intent(out) :: y(8, unknowns)
    end subroutine keyway_multiply_eight
  end interface
end module symmetric_product
