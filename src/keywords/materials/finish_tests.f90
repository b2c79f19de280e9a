!> What `keyway --material` needs of a deck: tests, laws for their materials, and a length of which
!> a law that knows crack openings can make a strain.
module finish_tests
  use damage_checks, only: find_longest_band, table_fault
  use diagnostics, only: diagnostic_list
  use finish_concrete, only: complete_concretes
  use finish_user_materials, only: complete_user_materials
  use kinds, only: rk
  use model_draft, only: concrete_request, draft
  use write_text, only: as_text
  implicit none
  private
  public :: complete_tests

contains

  !> Checks the tests; mesh and steps may be missing.
  subroutine complete_tests(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (size(model%cards) == 0) return
    call complete_concretes(model, faults)
    call complete_user_materials(model, faults)
    if (size(model%scene%tests) == 0 .and. .not. faults%has_errors()) then
      call model%cards(size(model%cards))%fault(faults, 'the deck ends without a test', &
                                                '*MATERIAL TEST')
    end if
    do i = 1, size(model%scene%tests)
      call check_law(model, i, faults)
    end do
    if (faults%has_errors()) return
    do i = 1, size(model%scene%tests)
      call check_length(model, i, faults)
    end do
  end subroutine complete_tests

  !> The material of a test has a law.
  subroutine check_law(model, number, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the test
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    i = model%scene%tests(number)%material
    if (i == 0) return ! told
    if (allocated(model%scene%materials(i)%law)) return
    if (any(model%scene%tests(:number - 1)%material == i)) return ! told
    if (any(model%concretes%material == i)) return ! told there
    if (any(model%user_materials%material == i)) return ! told there
    call model%cards(model%material_origin(i)%card)%fault( &
      faults, "material '"//model%scene%materials(i)%name//"' has no stiffness", '*ELASTIC')
  end subroutine check_law

  !> A concrete whose tables hold openings has a length, and one that does not snap back.
  subroutine check_length(model, number, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the test
    type(diagnostic_list), intent(inout) :: faults
    type(table_fault) :: limit
    real(rk) :: longest
    integer :: i
    associate (test => model%scene%tests(number), &
               place => model%cards(model%test_origin(number)%card))
      i = findloc(model%concretes%material, test%material, dim=1)
      if (i == 0) return
      if (.not. uses_length(model%concretes(i))) return
      if (.not. place%has('LENGTH')) then
        call place%warn(faults, "LENGTH is not given and turns the openings of '"// &
                        model%scene%materials(test%material)%name//"' into strains: 1 is taken", &
                        'LENGTH, the side of an element [m]')
      end if
      call find_longest_band(model%concretes(i)%constants, longest, limit)
      if (test%length <= longest) return
      if (model%concretes(i)%constants%lowers_strength) then
        call place%warn(faults, 'in a length of '//as_text(test%length)//' m the concrete '// &
                        'cracks at a lower strength, with the same energy', &
                        'at most '//as_text(longest)//' m for its own strength')
        return
      end if
      call place%fault_parameter(faults, 'LENGTH', 'the concrete snaps back in a length of '// &
                                 as_text(test%length)//' m', 'at most '//as_text(longest)// &
                                 ' m: '//limit%expected)
    end associate
  end subroutine check_length

  !> A table of the concrete is over openings, or G_f makes it.
  pure logical function uses_length(given)
    type(concrete_request), intent(in) :: given
    uses_length = given%constants%stiffening /= 'STRAIN' .or. &
                  given%constants%tension_damage_type /= 'STRAIN' .and. &
                  allocated(given%constants%tension_damage)
  end function uses_length
end module finish_tests
