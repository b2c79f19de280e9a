!> Principal values of many tensors in the copy for this processor (cmake/WideCopies.cmake). Both
!> copies give the same numbers to round-off.
module principal_loops
  use kinds, only: rk
  use processor_features, only: has_wide_registers
  use recovery_plans, only: fewest_for_threads
  use tensor6, only: find_principal_values
  use tensor6_wide, only: find_wide => find_principal_values
  implicit none
  private
  public :: find_principals, fill_principals, principals

contains

  !> The values of some tensors, on the thread of the caller.
  subroutine find_principals(num_tensors, tensors, values)
    integer, intent(in) :: num_tensors
    real(rk), intent(in) :: tensors(6, num_tensors)
    real(rk), intent(out) :: values(3, num_tensors) !< the largest first
    if (has_wide_registers()) then
      call find_wide(num_tensors, tensors, values)
    else
      call find_principal_values(num_tensors, tensors, values)
    end if
  end subroutine find_principals

  !> The same by several threads.
  subroutine fill_principals(num_tensors, tensors, values)
    integer, intent(in) :: num_tensors
    real(rk), intent(in) :: tensors(6, num_tensors)
    real(rk), intent(out) :: values(3, num_tensors) !< the largest first
    integer, parameter :: part = 512 !< that one thread takes
    integer :: first, n
    !$omp parallel do default(none) shared(num_tensors, tensors, values) private(n) &
    !$omp schedule(static) if (num_tensors > fewest_for_threads)
    do first = 1, num_tensors, part
      n = min(part, num_tensors - first + 1)
      call find_principals(n, tensors(:, first:first + n - 1), values(:, first:first + n - 1))
    end do
    !$omp end parallel do
  end subroutine fill_principals

  !> The same as a function.
  function principals(tensor) result(values)
    real(rk), intent(in), contiguous :: tensor(:, :) !< (6, n)
    real(rk) :: values(3, size(tensor, 2)) !< the largest first
    call fill_principals(size(tensor, 2), tensor, values)
  end function principals
end module principal_loops
