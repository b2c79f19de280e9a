!> Checks the length of concrete elements against the longest crack band (theory.md, (11.12)).
module concrete_widths
  use concrete_request, only: concrete_cards
  use damage_checks, only: find_longest_band, is_too_long, stiffening_table, &
                           straight_band, table_fault
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use element_sizes, only: measure_widths
  use kinds, only: rk
  use model_draft, only: draft
  use number_ranges, only: as_ranges
  use sorted_lists, only: sorted_unique
  use write_text, only: as_text
  implicit none
  private
  public :: check_widths

contains

  !> Compares the elements of a material with the widest crack band that its tables admit, and
  !> returns the range of their widths. Elements that are too long make one fault, or one warning if
  !> LONG ELEMENTS lowers their strength.
  subroutine check_widths(given, model, faults, smallest, largest)
    type(concrete_cards), intent(in) :: given !< whose tables are free of faults
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk), intent(out) :: smallest, largest !< [m]; smallest > largest without elements
    integer, allocatable :: elements(:)
    real(rk), allocatable :: least(:), most(:)
    type(table_fault) :: limit
    real(rk) :: longest
    integer :: i
    associate (mesh => model%problem%mesh)
      elements = pack([(i, i=1, mesh%num_elements)], is_solid(mesh%element_type) &
                      .and. mesh%material_of_element == given%material)
      allocate (least(size(elements)), most(size(elements)))
      call measure_widths(mesh, elements, least, most)
    end associate
    smallest = minval(least)
    largest = maxval(most)
    elements = model%problem%mesh%element_id(elements)
    call find_longest_band(given%constants, longest, limit)
    if (.not. any(is_too_long(most, longest))) then
      call warn_of_curve(given, model, elements, most, faults)
    else if (given%constants%lowers_strength) then
      call warn_of_strength(given, model, elements, most, longest, faults)
    else
      call fault_length(given, model, elements, most, longest, faults)
    end if
  end subroutine check_widths

  !> Names the longest element and the row of the table that does not admit it.
  subroutine fault_length(given, model, elements, width, longest, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    integer, intent(in) :: elements(:) !< user's numbers
    real(rk), intent(in) :: width(:), longest !< [m]
    type(diagnostic_list), intent(inout) :: faults
    type(table_fault) :: limit
    character(:), allocatable :: problem, remedy
    real(rk) :: same
    integer :: worst, card
    call find_longest_band(given%constants, same, limit)
    worst = maxloc(width, 1)
    problem = 'element '//as_text(elements(worst))//' has a length of '//as_text(width(worst))//': '
    card = given%stiffening%card
    remedy = '; or LONG ELEMENTS=LOWER STRENGTH'
    if (limit%keyword == stiffening_table) then
      problem = problem//'its unloading would release more energy than its crack dissipates '// &
                '(snap-back)'
    else
      card = given%tension_damage%card
      remedy = '; or a smaller damage'//remedy
      problem = problem//'in it the plastic strain opening/length - d/(1 - d) sigma/E '// &
                'decreases'
    end if
    call model%cards(card)%fault_at(faults, limit%row, 0, problem//other_elements(width, longest), &
                                    'at most '//as_text(longest)//', '//limit%expected//remedy)
  end subroutine fault_length

  !> How many other elements are too long.
  function other_elements(width, longest) result(text)
    real(rk), intent(in) :: width(:), longest !< [m]
    character(:), allocatable :: text
    integer :: num_others
    num_others = count(is_too_long(width, longest)) - 1
    text = ''
    if (num_others == 1) text = '; 1 more is too long'
    if (num_others > 1) text = '; '//as_text(num_others)//' more are too long'
  end function other_elements

  !> Elements in which the stress falls below the straight line between two rows of the tables.
  subroutine warn_of_curve(given, model, elements, width, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    integer, intent(in) :: elements(:) !< user's numbers
    real(rk), intent(in) :: width(:) !< [m]
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: longest
    integer :: worst
    longest = straight_band(given%constants)
    if (.not. any(is_too_long(width, longest))) return
    worst = maxloc(width, 1)
    call model%cards(given%tension_damage%card)%warn( &
      faults, 'element '//as_text(elements(worst))//' has a length of '// &
      as_text(width(worst))//': in it the plastic strain opening/length - d/(1 - d) sigma/E '// &
      'would decrease between two rows, where the stress therefore falls below the table'// &
      other_elements(width, longest), 'at most '//as_text(longest)//'; or a smaller damage')
  end subroutine warn_of_curve

  !> Lists the elements that crack below the strength of the table.
  subroutine warn_of_strength(given, model, elements, width, longest, faults)
    type(concrete_cards), intent(in) :: given
    type(draft), intent(in) :: model
    integer, intent(in) :: elements(:) !< user's numbers
    real(rk), intent(in) :: width(:), longest !< [m]
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: touched(:)
    integer :: worst
    touched = sorted_unique(pack(elements, is_too_long(width, longest)))
    worst = maxloc(width, 1)
    call model%cards(given%stiffening%card)%warn( &
      faults, as_text(size(touched))//' of '//as_text(size(elements))//' elements are longer '// &
      'than '//as_text(longest)//' and crack at a lower strength with the same energy, '// &
      'element '//as_text(elements(worst))//' with a length of '//as_text(width(worst))// &
      ' at a strength of '//as_text(given%constants%tension(1, 1)*sqrt(longest/width(worst)))// &
      ': elements '//as_ranges(touched))
  end subroutine warn_of_strength
end module concrete_widths
