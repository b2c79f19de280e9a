!> Thermal strains at the points of solids, for results: strain E is the sum of the strain that the
!> law gets and of the expansion.
module thermal_recovery
  use analysis_state, only: state
  use kinds, only: rk
  use problem_definition, only: problem
  use thermal_strains, only: expands, find_thermal_strains
  implicit none
  private
  public :: has_expansion, take_thermal, add_expansion

contains

  !> Whether a block of elements of one material has thermal strains.
  pure logical function has_expansion(model, now, elements)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: elements(:) !< positions
    has_expansion = .false.
    if (allocated(now%heat%reference)) has_expansion = expands(model, elements(1))
  end function has_expansion

  !> Takes the thermal strain from B u of a block of elements of one kind and one material.
  subroutine take_thermal(model, now, elements, strain)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(inout) :: strain(:, :, :) !< (6, points, elements)
    real(rk) :: expansion(size(strain, 2), size(strain, 3))
    real(rk) :: thermal(6, size(strain, 2), size(strain, 3))
    if (.not. has_expansion(model, now, elements)) return
    call find_thermal_strains(model, now%heat, elements, expansion, thermal)
    strain = strain - thermal
  end subroutine take_thermal

  !> Adds the expansion to the strains of a block of elements of one kind and one material.
  subroutine add_expansion(model, now, elements, strain)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(inout) :: strain(:, :, :) !< (6, points, elements)
    real(rk) :: expansion(size(strain, 2), size(strain, 3))
    real(rk) :: thermal(6, size(strain, 2), size(strain, 3))
    integer :: i
    if (.not. has_expansion(model, now, elements)) return
    call find_thermal_strains(model, now%heat, elements, expansion, thermal)
    do i = 1, 3
      strain(i, :, :) = strain(i, :, :) + expansion
    end do
  end subroutine add_expansion
end module thermal_recovery
