!> Fills values one after the other with numbers that all differ.
module counted_values
  use kinds, only: rk
  implicit none
  private
  public :: fill

  !> Counts on, and fills a value or an array with the numbers.
  interface fill
    module procedure fill_real, fill_reals_1, fill_reals_2, fill_reals_3, fill_integer, &
      fill_integers_1, fill_logical, fill_logicals_1
  end interface fill

contains

  !> n + 1/3.
  subroutine fill_real(x, n)
    real(rk), intent(out) :: x
    integer, intent(inout) :: n
    n = n + 1
    x = n + 1.0_rk/3.0_rk
  end subroutine fill_real

  !> A list.
  subroutine fill_reals_1(x, n)
    real(rk), intent(out) :: x(:)
    integer, intent(inout) :: n
    integer :: i
    do i = 1, size(x)
      call fill(x(i), n)
    end do
  end subroutine fill_reals_1

  !> A table.
  subroutine fill_reals_2(x, n)
    real(rk), intent(out) :: x(:, :)
    integer, intent(inout) :: n
    integer :: i
    do i = 1, size(x, 2)
      call fill(x(:, i), n)
    end do
  end subroutine fill_reals_2

  !> A block.
  subroutine fill_reals_3(x, n)
    real(rk), intent(out) :: x(:, :, :)
    integer, intent(inout) :: n
    integer :: i
    do i = 1, size(x, 3)
      call fill(x(:, :, i), n)
    end do
  end subroutine fill_reals_3

  !> n.
  subroutine fill_integer(x, n)
    integer, intent(out) :: x
    integer, intent(inout) :: n
    n = n + 1
    x = n
  end subroutine fill_integer

  !> A list.
  subroutine fill_integers_1(x, n)
    integer, intent(out) :: x(:)
    integer, intent(inout) :: n
    integer :: i
    do i = 1, size(x)
      call fill(x(i), n)
    end do
  end subroutine fill_integers_1

  !> True: the default is false.
  subroutine fill_logical(x, n)
    logical, intent(out) :: x
    integer, intent(inout) :: n
    n = n + 1
    x = .true.
  end subroutine fill_logical

  !> True and false by turns.
  subroutine fill_logicals_1(x, n)
    logical, intent(out) :: x(:)
    integer, intent(inout) :: n
    integer :: i
    n = n + 1
    x = [(mod(i, 2) == 1, i=1, size(x))]
  end subroutine fill_logicals_1
end module counted_values
