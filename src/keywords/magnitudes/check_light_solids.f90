!> Warns of solids that are nearly without mass in a motion, and of dampings of massless solids that
!> a reduced model does not have.
module check_light_solids
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: warn_of_light_solids

  !> Density over that of the heaviest solid. Wood beside steel has 0.05. At 1e-3 the periods of the
  !> solid are 30 times as short as those of the others, below any increment of an earthquake.
  real(rk), parameter :: least_share = 1.0e-3_rk
  !> Difference of two dampings, over the larger one, that counts.
  real(rk), parameter :: same_damping = 1.0e-6_rk

contains

  !> The deck must have no errors.
  subroutine warn_of_light_solids(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_used(size(model%problem%materials))
    integer :: i, s
    if (.not. any(model%problem%steps%procedure%has_inertia)) return
    is_used = .false.
    do i = 1, size(model%problem%mesh%material_of_element)
      associate (material => model%problem%mesh%material_of_element(i))
        if (material > 0) is_used(material) = .true.
      end associate
    end do
    call warn_of_densities(model, is_used, faults)
    do s = 1, size(model%problem%steps)
      if (model%problem%steps(s)%procedure%scheme /= 'REDUCED') cycle
      call warn_of_dampings(model, s, is_used, faults)
    end do
  end subroutine warn_of_light_solids

  !> Small densities in place of none.
  subroutine warn_of_densities(model, is_used, faults)
    type(draft), intent(in) :: model
    logical, intent(in) :: is_used(:) !< (materials) by elements
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: heaviest
    integer :: i
    heaviest = maxval([0.0_rk, model%problem%materials%density], mask=[.true., is_used])
    do i = 1, size(is_used)
      associate (now => model%problem%materials(i))
        if (.not. is_used(i) .or. .not. now%density > 0.0_rk) cycle
        if (now%density >= least_share*heaviest) cycle
        call model%cards(model%material_origin(i)%card)%warn( &
          faults, 'the density of '//now%name//', '//as_text(now%density)//', is '// &
          as_short_text(now%density/heaviest)//' times that of the heaviest solid: sudden '// &
          'loads and supports that go give such a light solid any motion', &
          'no *DENSITY for a solid without mass')
      end associate
    end do
  end subroutine warn_of_densities

  !> Massless solids of a reduced model have one damping together.
  subroutine warn_of_dampings(model, s, is_used, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    logical, intent(in) :: is_used(:) !< (materials) by elements
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, first
    first = 0
    do i = 1, size(is_used)
      if (.not. is_used(i) .or. model%problem%materials(i)%density > 0.0_rk) cycle
      if (first == 0) first = i
      associate (now => model%problem%materials(i), other => model%problem%materials(first))
        if (abs(now%beta - other%beta) <= same_damping*max(now%beta, other%beta)) cycle
        call model%cards(model%procedure_card(s))%warn( &
          faults, 'BETA of the massless materials '//other%name//' and '//now%name//' is '// &
          as_text(other%beta)//' and '//as_text(now%beta)//': REDUCED gives all '// &
          'massless solids one damping, and its estimate does not contain this error', &
          'one BETA for massless materials, or *DYNAMIC without REDUCED')
        return
      end associate
    end do
  end subroutine warn_of_dampings
end module check_light_solids
