!> The parameters of *JOINT LAW with TYPE=CONTRACTION.
module contraction_keyword
  use deck_card, only: card
  use keyword_spec, only: field, keyword_variant, kind_real
  use kinds, only: rk
  implicit none
  private
  public :: describe_contraction, stiffness_of_thickness

  character, parameter :: nl = new_line('a')

contains

  pure subroutine describe_contraction(entry)
    type(keyword_variant), intent(out) :: entry
    entry%name = 'CONTRACTION'
    entry%meaning = 'A contraction joint.'//nl// &
                    'Bonded: elastic with KN and KT until the normal traction reaches TENSILE '// &
                    'STRENGTH. The strength is then lost for good.'//nl// &
                    'Closed: elastic with KN and KT, with Coulomb friction.'//nl// &
                    'Open: no traction.'//nl// &
                    'PENETRATION: each increment is repeated with an updated contact pressure '// &
                    'until no point in contact penetrates deeper than PENETRATION and no point '// &
                    'under pressure is open by more than PENETRATION.'//nl// &
                    'KN with PENETRATION: only controls the convergence; a larger KN '// &
                    'takes fewer repetitions. The default is 50 E/h of the softer side, h '// &
                    'the depth of its elements, and E/THICKNESS with a tensile strength.'//nl// &
                    'KT with PENETRATION: the default is E/THICKNESS/(2(1+nu)).'
    allocate (entry%parameters, source=[ &
              field('KN', kind_real, 'normal stiffness', 'Pa/m', 'E/THICKNESS of the slave side', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('KT', kind_real, 'tangential stiffness', 'Pa/m', 'KN/(2(1+nu))', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('TENSILE STRENGTH', kind_real, 'normal traction at first opening', 'Pa', &
                    '0', lowest=0.0_rk), &
              field('FRICTION', kind_real, 'Coulomb coefficient', '', '0', lowest=0.0_rk), &
              field('COHESION', kind_real, 'shear strength without pressure', 'Pa', '0', &
                    lowest=0.0_rk), &
              field('THICKNESS', kind_real, 'thickness that gives KN from E when KN is not '// &
                    'given', 'm', '0.02', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('GAP', kind_real, 'opening at the start', 'm', '0', lowest=0.0_rk), &
              field('PENETRATION', kind_real, 'largest penetration of points in contact '// &
                    '(augmented Lagrangian)', 'm', &
                    'pressure/KN', lowest=0.0_rk, excludes_lowest=.true.)])
  end subroutine describe_contraction

  !> The stiffness that THICKNESS gives: 'KN' and what follows from it, 'KT', or '' for none.
  pure function stiffness_of_thickness(this) result(name)
    type(card), intent(in) :: this
    character(:), allocatable :: name
    name = ''
    if (this%has('PENETRATION') .and. .not. this%has('KT')) name = 'KT'
    if (this%has('KN')) return
    if (.not. this%has('PENETRATION') .or. this%real('TENSILE STRENGTH') > 0.0_rk) name = 'KN'
  end function stiffness_of_thickness
end module contraction_keyword
