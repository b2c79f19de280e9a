!> Warns of solids that are nearly without mass in a motion, and of dampings that a reduced model
!> does not have.
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

  !> Two dampings of massless solids, or of solids with mass, of which a reduced model holds one.
  subroutine warn_of_dampings(model, s, is_used, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: s !< step
    logical, intent(in) :: is_used(:) !< (materials) by elements
    type(diagnostic_list), intent(inout) :: faults
    integer :: pair(2)
    pair = two_dampings(model, is_used .and. .not. model%problem%materials%density > 0.0_rk)
    if (pair(2) > 0) then
      call model%cards(model%procedure_card(s))%warn( &
        faults, 'BETA of the massless materials '//values_of(model, pair)//': REDUCED gives '// &
        'all massless solids one damping, and its estimate does not contain this error', &
        'one BETA for massless materials, or *DYNAMIC without REDUCED')
    end if
    pair = two_dampings(model, is_used .and. model%problem%materials%density > 0.0_rk)
    if (pair(2) == 0) return
    call model%cards(model%procedure_card(s))%warn( &
      faults, 'BETA of the materials '//values_of(model, pair)//': REDUCED leaves out the '// &
      'damping that couples its modes with the rest, and its estimate does not contain this '// &
      'error', &
      'one BETA for all materials with mass, or *DYNAMIC without REDUCED')
  end subroutine warn_of_dampings

  !> The first two of some materials whose BETA differs; zero where all have one.
  pure function two_dampings(model, is_asked) result(pair)
    type(draft), intent(in) :: model
    logical, intent(in) :: is_asked(:) !< (materials)
    integer :: pair(2)
    integer :: i
    pair = 0
    do i = 1, size(is_asked)
      if (.not. is_asked(i)) cycle
      if (pair(1) == 0) pair(1) = i
      associate (now => model%problem%materials(i)%beta, &
                 other => model%problem%materials(pair(1))%beta)
        if (abs(now - other) <= same_damping*max(now, other)) cycle
      end associate
      pair(2) = i
      return
    end do
  end function two_dampings

  !> 'ROCK and DAM is 0.004 and 0.001'.
  pure function values_of(model, pair) result(text)
    type(draft), intent(in) :: model
    integer, intent(in) :: pair(2) !< materials
    character(:), allocatable :: text
    associate (one => model%problem%materials(pair(1)), two => model%problem%materials(pair(2)))
      text = one%name//' and '//two%name//' is '//as_text(one%beta)//' and '//as_text(two%beta)
    end associate
  end function values_of
end module check_light_solids
