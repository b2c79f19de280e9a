!> Compares values and arrays bit by bit, for tests of what saves and loads them.
module same_values
  use kinds, only: rk, long
  use testing, only: check, test_log
  implicit none
  private
  public :: compare

  !> Two values of one kind and rank.
  interface compare
    module procedure compare_real, compare_integer, compare_logical, compare_reals_1, &
      compare_reals_2, compare_reals_3, compare_integers_1, compare_logicals_1
  end interface compare

contains

  !> A real, bit by bit.
  subroutine compare_real(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    real(rk), intent(in) :: a, b
    call check(log, transfer(a, 0_long) == transfer(b, 0_long), what)
  end subroutine compare_real

  !> An integer.
  subroutine compare_integer(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    integer, intent(in) :: a, b
    call check(log, a == b, what)
  end subroutine compare_integer

  !> A logical.
  subroutine compare_logical(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    logical, intent(in) :: a, b
    call check(log, a .eqv. b, what)
  end subroutine compare_logical

  !> An array of reals, bit by bit.
  subroutine compare_reals_1(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    real(rk), allocatable, intent(in) :: a(:), b(:)
    call check(log, allocated(a) .eqv. allocated(b), what//': allocated')
    if (.not. allocated(a) .or. .not. allocated(b)) return
    call check(log, all(shape(a) == shape(b)), what//': shape')
    if (any(shape(a) /= shape(b))) return
    call check(log, all(transfer(a, [0_long]) == transfer(b, [0_long])), what)
  end subroutine compare_reals_1

  !> An array of reals, bit by bit.
  subroutine compare_reals_2(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    real(rk), allocatable, intent(in) :: a(:, :), b(:, :)
    call check(log, allocated(a) .eqv. allocated(b), what//': allocated')
    if (.not. allocated(a) .or. .not. allocated(b)) return
    call check(log, all(shape(a) == shape(b)), what//': shape')
    if (any(shape(a) /= shape(b))) return
    call check(log, all(transfer(a, [0_long]) == transfer(b, [0_long])), what)
  end subroutine compare_reals_2

  !> An array of reals, bit by bit.
  subroutine compare_reals_3(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    real(rk), allocatable, intent(in) :: a(:, :, :), b(:, :, :)
    call check(log, allocated(a) .eqv. allocated(b), what//': allocated')
    if (.not. allocated(a) .or. .not. allocated(b)) return
    call check(log, all(shape(a) == shape(b)), what//': shape')
    if (any(shape(a) /= shape(b))) return
    call check(log, all(transfer(a, [0_long]) == transfer(b, [0_long])), what)
  end subroutine compare_reals_3

  !> A list of integers.
  subroutine compare_integers_1(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    integer, allocatable, intent(in) :: a(:), b(:)
    call check(log, allocated(a) .eqv. allocated(b), what//': allocated')
    if (.not. allocated(a) .or. .not. allocated(b)) return
    call check(log, size(a) == size(b), what//': size')
    if (size(a) == size(b)) call check(log, all(a == b), what)
  end subroutine compare_integers_1

  !> A list of logicals.
  subroutine compare_logicals_1(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    logical, allocatable, intent(in) :: a(:), b(:)
    call check(log, allocated(a) .eqv. allocated(b), what//': allocated')
    if (.not. allocated(a) .or. .not. allocated(b)) return
    call check(log, size(a) == size(b), what//': size')
    if (size(a) == size(b)) call check(log, all(a .eqv. b), what)
  end subroutine compare_logicals_1
end module same_values
