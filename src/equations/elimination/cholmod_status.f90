!> What statuses of CHOLMOD mean.
module cholmod_status
  implicit none
  private
  public :: plan_failure, too_large

  integer, parameter :: too_large = -3 !< numbers of 32 bits do not count the entries of the factor

contains

  !> Why a factor is not planned.
  pure function plan_failure(status) result(text)
    integer, intent(in) :: status !< of CHOLMOD, not 0
    character(:), allocatable :: text
    if (status == too_large) then
      text = 'the factor of the stiffness has more than 2^31 entries; use several processes '// &
             '(docs/large_models.md)'
    else
      text = 'no memory to plan the factor of the stiffness'
    end if
  end function plan_failure
end module cholmod_status
