!> Checks after a call of a UMAT: results are finite, and nothing was written past STATEV.
module umat_guards
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: long, rk
  use umat_interface, only: umat_arguments
  use write_text, only: as_text
  implicit none
  private
  public :: guarded_state, fault_of_call, has_cholesky_factor, largest_asymmetry, size_of_guard

  integer, parameter :: size_of_guard = 256 !< words before and behind the state variables
  !> A number that no law writes by chance.
  real(rk), parameter :: guard_word = -7.236514893620175e183_rk

  !> State variables between guard words.
  type :: guarded_state
    real(rk), allocatable :: room(:)
    logical :: is_marked = .false. !< the guard words are set
  contains
    procedure :: fill
    procedure :: values
    procedure :: is_intact
    procedure :: fault => fault_of_state
  end type guarded_state

contains

  pure subroutine fill(self, variables)
    class(guarded_state), intent(inout) :: self
    real(rk), intent(in) :: variables(:)
    integer :: n
    n = size(variables)
    if (allocated(self%room)) then
      if (size(self%room) /= n + 2*size_of_guard) deallocate (self%room)
    end if
    if (.not. allocated(self%room)) then
      allocate (self%room(n + 2*size_of_guard))
      self%is_marked = .false.
    end if
    if (.not. self%is_marked) self%room = guard_word
    self%is_marked = .true.
    self%room(size_of_guard + 1:size_of_guard + n) = variables
  end subroutine fill

  pure function values(self) result(variables)
    class(guarded_state), intent(in) :: self
    real(rk) :: variables(size(self%room) - 2*size_of_guard)
    variables = self%room(size_of_guard + 1:size(self%room) - size_of_guard)
  end function values

  !> '' if all state variables are finite and the guard words are unchanged.
  pure function fault_of_state(self) result(fault)
    class(guarded_state), intent(in) :: self
    character(:), allocatable :: fault
    integer :: i, n
    n = size(self%room) - 2*size_of_guard
    fault = ''
    if (.not. self%is_intact()) then
      fault = 'the routine writes outside of its '//as_text(n)//' state variables (STATEV); '// &
              'set their number by *DEPVAR'
      return
    end if
    i = first_not_finite(self%room(size_of_guard + 1:size_of_guard + n))
    if (i > 0) fault = 'STATEV('//as_text(i)//') is not a number'
  end function fault_of_state

  !> Whether nothing was written before and behind the values.
  pure logical function is_intact(self)
    class(guarded_state), intent(in) :: self
    integer :: n
    n = size(self%room) - 2*size_of_guard
    is_intact = all(is_guard(self%room(:size_of_guard))) .and. &
                all(is_guard(self%room(size_of_guard + n + 1:)))
  end function is_intact

  !> Compares bits: a comparison with NaN would trap.
  pure elemental logical function is_guard(word)
    real(rk), intent(in) :: word
    is_guard = transfer(word, 0_long) == transfer(guard_word, 0_long)
  end function is_guard

  !> '' for a valid result.
  pure function fault_of_call(now, variables) result(fault)
    type(umat_arguments), intent(in) :: now
    type(guarded_state), intent(in) :: variables
    character(:), allocatable :: fault
    integer :: i
    fault = variables%fault()
    if (len(fault) > 0) return
    i = first_not_finite(now%stress)
    if (i > 0) then
      fault = 'STRESS('//as_text(i)//') is not a number'
      return
    end if
    i = first_not_finite(reshape(now%ddsdde, [36]))
    if (i > 0) then
      fault = 'DDSDDE('//as_text(1 + mod(i - 1, 6))//','//as_text(1 + (i - 1)/6)// &
              ') is not a number'
    else if (first_not_finite([now%sse, now%spd, now%scd]) > 0) then
      fault = 'SSE, SPD or SCD is not a number'
    else if (.not. ieee_is_finite(now%pnewdt) .or. now%pnewdt <= 0.0_rk) then
      fault = 'PNEWDT is not a positive number'
    end if
  end function fault_of_call

  !> Position of the first NaN or infinite value, 0 for none.
  pure integer function first_not_finite(values) result(position)
    real(rk), intent(in) :: values(:)
    position = findloc(ieee_is_finite(values), .false., 1)
  end function first_not_finite

  !> Largest difference to the transpose, over the largest entry.
  pure real(rk) function largest_asymmetry(matrix) result(share)
    real(rk), intent(in) :: matrix(6, 6)
    real(rk) :: largest
    largest = maxval(abs(matrix))
    share = 0.0_rk
    if (largest > 0.0_rk) share = maxval(abs(matrix - transpose(matrix)))/largest
  end function largest_asymmetry

  !> Whether a symmetric matrix is positive definite.
  pure logical function has_cholesky_factor(matrix) result(is_positive)
    real(rk), intent(in) :: matrix(6, 6)
    real(rk) :: lower(6, 6), pivot
    integer :: i, j
    lower = 0.0_rk
    is_positive = .false.
    do j = 1, 6
      pivot = matrix(j, j) - sum(lower(j, :j - 1)**2)
      if (.not. pivot > epsilon(1.0_rk)*abs(matrix(j, j))) return
      lower(j, j) = sqrt(pivot)
      do i = j + 1, 6
        lower(i, j) = (matrix(i, j) - dot_product(lower(i, :j - 1), lower(j, :j - 1)))/lower(j, j)
      end do
    end do
    is_positive = .true.
  end function has_cholesky_factor
end module umat_guards
