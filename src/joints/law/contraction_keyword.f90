!> What *JOINT LAW takes with TYPE=CONTRACTION.
module contraction_keyword
  use keyword_spec, only: field, keyword_variant, kind_real
  use kinds, only: rk
  implicit none
  private
  public :: describe_contraction

contains

  pure subroutine describe_contraction(entry)
    type(keyword_variant), intent(out) :: entry
    entry%name = 'CONTRACTION'
    entry%meaning = 'A contraction joint. Closed, it is elastic (KN, KT) with Coulomb '// &
                    'friction. Bonded, it holds until the normal traction reaches the '// &
                    'tensile strength, which is then lost for good. Open, it carries nothing. '// &
                    'PENETRATION repeats each increment with a contact pressure that is '// &
                    'carried on, until no point in contact is deeper than PENETRATION (or '// &
                    'further apart while pressed). KN is then E/h of the softer side, h the '// &
                    'depth of its elements, and KT is E/THICKNESS/(2(1+nu)), unless given; a '// &
                    'larger KN takes fewer repetitions. With a tensile strength KN is '// &
                    'E/THICKNESS with PENETRATION, too.'
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
              field('THICKNESS', kind_real, 'gives KN from E when KN is not given', 'm', '0.02', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('GAP', kind_real, 'opening at the start', 'm', '0', lowest=0.0_rk), &
              field('PENETRATION', kind_real, 'largest penetration of points in contact '// &
                    '(augmented Lagrangian); KN then only leads the iteration', 'm', &
                    'pressure/KN', lowest=0.0_rk, excludes_lowest=.true.)])
  end subroutine describe_contraction
end module contraction_keyword
