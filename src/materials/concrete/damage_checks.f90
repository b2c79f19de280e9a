!> Faults in the tables of concrete, by table and row.
module damage_checks
  use damage_constants, only: concrete_constants
  use damage_curves, only: make_compression_curve, make_tension_curve, strength_curve
  use kinds, only: rk
  use write_text, only: as_text
  implicit none
  private
  public :: table_fault, find_table_faults, find_longest_band, straight_band, is_too_long
  public :: stiffening_table, tension_damage_table, hardening_table, compression_damage_table

  !> The tables, by their keywords.
  character(*), parameter :: stiffening_table = 'CONCRETE TENSION STIFFENING'
  character(*), parameter :: tension_damage_table = 'CONCRETE TENSION DAMAGE'
  character(*), parameter :: hardening_table = 'CONCRETE COMPRESSION HARDENING'
  character(*), parameter :: compression_damage_table = 'CONCRETE COMPRESSION DAMAGE'

  !> Relative tolerance of comparisons, for rounded numbers in a deck.
  real(rk), parameter :: rounding = 1.0e-9_rk

  !> One fault of a table.
  type :: table_fault
    character(:), allocatable :: keyword !< of the table, upper case, without the star
    integer :: row = 0 !< line of its data, 0: the keyword line
    integer :: field = 0 !< of that line: 1 ordinate, 2 abscissa, 0 both
    character(:), allocatable :: problem !< cause
    character(:), allocatable :: expected !< the admissible value
  end type table_fault

contains

  !> Finds all faults that do not depend on the size of the elements.
  subroutine find_table_faults(constants, faults)
    type(concrete_constants), intent(in) :: constants !< tension and compression allocated
    type(table_fault), allocatable, intent(out) :: faults(:) !< size 0: none
    type(strength_curve) :: curve
    allocate (faults(0))
    if (constants%stiffening == 'GFI') then
      call check_fracture_energy(constants%tension, faults)
    else
      call check_strength(stiffening_table, constants%tension, faults)
    end if
    call check_strength(hardening_table, constants%compression, faults)
    call check_damage(tension_damage_table, constants%tension_damage, faults)
    call check_damage(compression_damage_table, constants%compression_damage, faults)
    call check_types(constants, faults)
    if (size(faults) > 0) return
    call check_compression_strength(constants, faults)
    call make_compression_curve(constants, curve)
    call check_plastic_strain(curve, hardening_table, constants%compression, &
                              compression_damage_table, constants%compression_damage, faults)
    if (constants%stiffening /= 'STRAIN') return
    call make_tension_curve(constants, curve)
    call check_plastic_strain(curve, stiffening_table, constants%tension, tension_damage_table, &
                              constants%tension_damage, faults)
  end subroutine find_table_faults

  !> The widest crack band of tables over openings, and the row that limits it. The tables must be
  !> free of faults. Tables over strain have no limit.
  subroutine find_longest_band(constants, longest, limit)
    type(concrete_constants), intent(in) :: constants
    real(rk), intent(out) :: longest !< [m]; huge: no limit
    type(table_fault), intent(out) :: limit !< table, row, and the rule in `expected`
    type(strength_curve) :: curve
    call make_tension_curve(constants, curve)
    longest = curve%longest
    limit%keyword = stiffening_table
    limit%problem = 'no limit'
    limit%expected = ''
    if (curve%steepest == 0) return
    limit%problem = 'no band wider than '//as_text(longest)
    if (constants%stiffening == 'GFI' .and. curve%turns_back) then
      limit%row = 1
      limit%expected = '2 E G_f/f_t^2'
    else if (curve%turns_back) then
      limit%row = row_of(constants%tension, curve%abscissa(curve%steepest))
      limit%expected = 'E times the opening over the stress lost from the row before'
    else
      limit%keyword = tension_damage_table
      limit%row = row_of(constants%tension_damage, curve%abscissa(curve%steepest))
      limit%expected = 'E times the opening over the increase of d/(1 - d) sigma from the row '// &
                       'before'
    end if
  end subroutine find_longest_band

  !> Whether a length is above the longest one, which may be huge: by more than round-off.
  elemental logical function is_too_long(length, longest)
    real(rk), intent(in) :: length, longest !< [m]
    is_too_long = length*(1.0_rk - rounding) > longest
  end function is_too_long

  !> The widest crack band in which the stress falls straight over the opening between the rows of
  !> tables over openings [m]. In a wider one the plastic strain would decrease between two rows:
  !> it stands still there, and the stress is below the line. The tables must be free of faults.
  real(rk) function straight_band(constants)
    type(concrete_constants), intent(in) :: constants
    type(strength_curve) :: curve
    call make_tension_curve(constants, curve)
    straight_band = curve%longest_straight
  end function straight_band

  !> sigma and its abscissa: starts above zero at zero, nowhere negative, abscissa increasing.
  subroutine check_strength(keyword, table, faults)
    character(*), intent(in) :: keyword
    real(rk), intent(in) :: table(:, :)
    type(table_fault), allocatable, intent(inout) :: faults(:)
    integer :: i
    if (.not. table(1, 1) > 0.0_rk) then
      call add_fault(keyword, 1, 1, 'found '//as_text(table(1, 1)), 'a first strength > 0', faults)
    end if
    do i = 2, size(table, 2)
      if (table(1, i) >= 0.0_rk) cycle
      call add_fault(keyword, i, 1, 'found '//as_text(table(1, i)), 'a strength >= 0', faults)
    end do
    call check_abscissa(keyword, table(2, :), faults)
  end subroutine check_strength

  !> One row: f_t and G_f.
  subroutine check_fracture_energy(table, faults)
    real(rk), intent(in) :: table(:, :)
    type(table_fault), allocatable, intent(inout) :: faults(:)
    if (.not. table(1, 1) > 0.0_rk) then
      call add_fault(stiffening_table, 1, 1, 'found '//as_text(table(1, 1)), &
                     'a strength f_t > 0', faults)
    end if
    if (.not. table(2, 1) > 0.0_rk) then
      call add_fault(stiffening_table, 1, 2, 'found '//as_text(table(2, 1)), &
                     'a fracture energy G_f > 0', faults)
    end if
    if (size(table, 2) > 1) then
      call add_fault(stiffening_table, 2, 0, 'a second row with TYPE=GFI', 'one row: f_t, G_f', &
                     faults)
    end if
  end subroutine check_fracture_energy

  !> d and its abscissa: starts at zero, below 1, not decreasing.
  subroutine check_damage(keyword, table, faults)
    character(*), intent(in) :: keyword
    real(rk), allocatable, intent(in) :: table(:, :) !< unallocated: no damage, no fault
    type(table_fault), allocatable, intent(inout) :: faults(:)
    integer :: i
    if (.not. allocated(table)) return
    if (abs(table(1, 1)) > 0.0_rk) then
      call add_fault(keyword, 1, 1, 'found '//as_text(table(1, 1)), 'a first damage of 0', faults)
    end if
    do i = 2, size(table, 2)
      if (.not. table(1, i) < 1.0_rk) then
        call add_fault(keyword, i, 1, 'found '//as_text(table(1, i)), 'a damage below 1', faults)
      else if (table(1, i) < table(1, i - 1)) then
        call add_fault(keyword, i, 1, 'found '//as_text(table(1, i))//' after '// &
                       as_text(table(1, i - 1)), 'a damage that does not decrease', faults)
      end if
    end do
    call check_abscissa(keyword, table(2, :), faults)
  end subroutine check_damage

  !> The abscissa must start at zero and increase.
  subroutine check_abscissa(keyword, abscissa, faults)
    character(*), intent(in) :: keyword
    real(rk), intent(in) :: abscissa(:)
    type(table_fault), allocatable, intent(inout) :: faults(:)
    integer :: i
    if (abs(abscissa(1)) > 0.0_rk) then
      call add_fault(keyword, 1, 2, 'found '//as_text(abscissa(1)), '0 in the first row: the '// &
                     'table starts at the onset of inelastic strain or opening', faults)
    end if
    do i = 2, size(abscissa)
      if (abscissa(i) > abscissa(i - 1)) cycle
      call add_fault(keyword, i, 2, 'found '//as_text(abscissa(i)), 'more than '// &
                     as_text(abscissa(i - 1))//' of the row before', faults)
    end do
  end subroutine check_abscissa

  !> Both tables of tension must be over strain, or both over openings.
  subroutine check_types(constants, faults)
    type(concrete_constants), intent(in) :: constants
    type(table_fault), allocatable, intent(inout) :: faults(:)
    character(:), allocatable :: wanted
    if (.not. allocated(constants%tension_damage)) return
    wanted = 'DISPLACEMENT'
    if (constants%stiffening == 'STRAIN') wanted = 'STRAIN'
    if (constants%tension_damage_type == wanted) return
    call add_fault(tension_damage_table, 0, 0, 'TYPE='//trim(constants%tension_damage_type)// &
                   ' does not go with TYPE='//trim(constants%stiffening)//' of *'// &
                   stiffening_table, 'TYPE='//wanted, faults)
  end subroutine check_types

  !> beta of Eq. 23 must not be negative when concrete first yields.
  subroutine check_compression_strength(constants, faults)
    type(concrete_constants), intent(in) :: constants
    type(table_fault), allocatable, intent(inout) :: faults(:)
    real(rk) :: smallest
    smallest = constants%tension(1, 1)*(3.0_rk*constants%biaxial_ratio - 2.0_rk) &
               /constants%biaxial_ratio
    if (constants%compression(1, 1) >= smallest*(1.0_rk - rounding)) return
    call add_fault(hardening_table, 1, 1, 'found '//as_text(constants%compression(1, 1))// &
                   ' with a strength in tension of '//as_text(constants%tension(1, 1)), &
                   'at least '//as_text(smallest)//', where beta of Eq. 23 is 0', faults)
  end subroutine check_compression_strength

  !> The plastic strain must not decrease from knot to knot (paper_notes.md, 11); abscissae are
  !> strains.
  subroutine check_plastic_strain(curve, strength_keyword, strength, damage_keyword, damage, faults)
    type(strength_curve), intent(in) :: curve
    character(*), intent(in) :: strength_keyword, damage_keyword
    real(rk), intent(in) :: strength(:, :)
    real(rk), allocatable, intent(in) :: damage(:, :)
    type(table_fault), allocatable, intent(inout) :: faults(:)
    type(table_fault) :: place
    real(rk) :: plastic, before
    integer :: i
    before = 0.0_rk
    do i = 2, size(curve%abscissa)
      plastic = curve%abscissa(i) - curve%recoverable(i)
      if (plastic < before - rounding*curve%abscissa(i)) then
        call find_row(curve%abscissa(i), strength_keyword, strength, damage_keyword, damage, place)
        call add_fault(place%keyword, place%row, 0, 'the plastic strain (inelastic strain - '// &
                       'd/(1 - d) sigma/E) falls from '//as_text(before)//' to '// &
                       as_text(plastic)//' at the inelastic strain '// &
                       as_text(curve%abscissa(i)), 'one that does not decrease: a smaller '// &
                       'damage or a larger inelastic strain', faults)
      end if
      before = plastic
    end do
  end subroutine check_plastic_strain

  !> The table row of a knot: that of the damage table where both have one.
  subroutine find_row(abscissa, strength_keyword, strength, damage_keyword, damage, place)
    real(rk), intent(in) :: abscissa
    character(*), intent(in) :: strength_keyword, damage_keyword
    real(rk), intent(in) :: strength(:, :)
    real(rk), allocatable, intent(in) :: damage(:, :)
    type(table_fault), intent(inout) :: place !< its keyword and row are set
    place%keyword = strength_keyword
    place%row = row_of(strength, abscissa)
    if (.not. allocated(damage)) return
    if (minval(abs(damage(2, :) - abscissa)) > rounding*abscissa) return
    place%keyword = damage_keyword
    place%row = row_of(damage, abscissa)
  end subroutine find_row

  !> The row at an abscissa, else the next one; the last row beyond the end.
  pure integer function row_of(table, abscissa)
    real(rk), intent(in) :: table(:, :)
    real(rk), intent(in) :: abscissa
    row_of = min(count(table(2, :) < abscissa*(1.0_rk - rounding)) + 1, size(table, 2))
  end function row_of

  !> Appends to the list.
  subroutine add_fault(keyword, row, field, problem, expected, faults)
    character(*), intent(in) :: keyword
    integer, intent(in) :: row, field
    character(*), intent(in) :: problem, expected
    type(table_fault), allocatable, intent(inout) :: faults(:)
    type(table_fault), allocatable :: longer(:)
    integer :: i
    allocate (longer(size(faults) + 1))
    do i = 1, size(faults)
      longer(i) = faults(i)
    end do
    longer(size(longer)) = table_fault(keyword, row, field, problem, expected)
    call move_alloc(longer, faults)
  end subroutine add_fault
end module damage_checks
