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
    real(rk), allocatable :: expansion(:, :), thermal(:, :, :)
    if (.not. has_expansion(model, now, elements)) return
    call find_both(model, now, elements, size(strain, 2), expansion, thermal)
    strain = strain - thermal
  end subroutine take_thermal

  !> Adds the expansion to the strains of a block of elements of one kind and one material.
  subroutine add_expansion(model, now, elements, strain)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: elements(:) !< positions
    real(rk), intent(inout) :: strain(:, :, :) !< (6, points, elements)
    real(rk), allocatable :: expansion(:, :), thermal(:, :, :)
    integer :: i
    if (.not. has_expansion(model, now, elements)) return
    call find_both(model, now, elements, size(strain, 2), expansion, thermal)
    do i = 1, 3
      strain(i, :, :) = strain(i, :, :) + expansion
    end do
  end subroutine add_expansion

  !> Expansion and thermal strain of a block of elements that expand: models without have no memory
  !> of them.
  subroutine find_both(model, now, elements, num_points, expansion, thermal)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: elements(:) !< positions
    integer, intent(in) :: num_points !< of an element
    real(rk), allocatable, intent(out) :: expansion(:, :) !< (points, elements)
    real(rk), allocatable, intent(out) :: thermal(:, :, :) !< (6, points, elements)
    allocate (expansion(num_points, size(elements)), thermal(6, num_points, size(elements)))
    call find_thermal_strains(model, now%heat, elements, expansion, thermal)
  end subroutine find_both
end module thermal_recovery
