!> *RESERVOIR.
module keywords_reservoir
  use applied_load, only: load
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use enter_load, only: put_load
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_word
  use kinds, only: rk
  use load_reservoir, only: reservoir_load, wetted_area
  use model_draft, only: draft
  use named_things, only: find_surface
  use write_text, only: as_text
  implicit none
  private
  public :: describe_reservoir, read_reservoir

contains

  subroutine describe_reservoir(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'RESERVOIR'
    spec%family = 'load'
    spec%place = 'step'
    spec%meaning = 'Water on the wetted part of a surface: hydrostatic pressure and '// &
                   'Westergaard''s added mass. The mass, 7/8 rho sqrt(H h) per area along the '// &
                   'normal (H the depth of the reservoir, h of the point), takes part in the '// &
                   'inertia force of the base motion and has no weight. NORMAL keeps the '// &
                   'block m n n^T of each node, DIAGONAL its diagonal. The surface of the '// &
                   'first reservoir defines upstream and downstream in the results. The card '// &
                   'again, in a later step with the same NAME, replaces the water; with '// &
                   'HYDROSTATIC=NO and no ADDED MASS it empties the reservoir.'
    spec%example = '*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL=105., BED=0., '// &
                   'ADDED MASS=WESTERGAARD'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the reservoir', is_required=.true.), &
              field('SURFACE', kind_word, 'the wetted face', is_required=.true.), &
              field('LEVEL', kind_real, 'height of the water along UP', 'm', is_required=.true.), &
              field('BED', kind_real, 'height of the bottom along UP', 'm', is_required=.true.), &
              field('UP', kind_integer, 'axis that points up', default='3', lowest=1.0_rk, &
                    highest=3.0_rk), &
              field('DENSITY', kind_real, 'mass of the water', 'kg/m3', '1000', lowest=0.0_rk, &
                    excludes_lowest=.true.), &
              field('GRAVITY', kind_real, 'acceleration of gravity', 'm/s2', '9.81', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('HYDROSTATIC', kind_choice, 'pressure of the water', default='YES', &
                    choices='YES | NO'), &
              field('ADDED MASS', kind_choice, 'mass of the water', default='NONE', &
                    choices='NONE | WESTERGAARD'), &
              field('DIRECTION', kind_choice, 'how the added mass acts', default='DIAGONAL', &
                    choices='DIAGONAL | NORMAL')])
  end subroutine describe_reservoir

  subroutine read_reservoir(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(reservoir_load) :: lake
    class(load), allocatable :: item
    integer :: found
    call find_surface(this, model, faults, found)
    if (found == 0) return
    if (this%real('LEVEL') <= this%real('BED')) then
      call this%fault_parameter(faults, 'LEVEL', "found '"//this%text('LEVEL')//"'", &
                                'a level above BED, '//this%text('BED')//'; to empty '// &
                                'a reservoir of an earlier step give its card again with '// &
                                'HYDROSTATIC=NO')
      return
    end if
    lake%kind = 'reservoir'
    call lake%take_faces(model%problem%surfaces(found), model%problem%mesh)
    lake%water%level = this%real('LEVEL')
    lake%water%bed = this%real('BED')
    lake%water%up = this%integer('UP')
    lake%density = this%real('DENSITY')
    lake%gravity = this%real('GRAVITY')
    lake%is_hydrostatic = this%word('HYDROSTATIC') == 'YES'
    lake%has_added_mass = this%word('ADDED MASS') == 'WESTERGAARD'
    lake%is_diagonal = this%word('DIRECTION') == 'DIAGONAL'
    ! The fault of an empty surface is reported.
    if (size(lake%faces%element) == 0 .and. faults%has_errors()) return
    if (wetted_area(lake, model%problem%mesh) <= 0.0_rk) then
      call this%fault_parameter(faults, 'SURFACE', 'no face of the surface is wetted', &
                                'a surface with faces between BED, '//this%text('BED')// &
                                ', and LEVEL, '//this%text('LEVEL'))
      return
    end if
    if (model%problem%upstream_surface == 0) model%problem%upstream_surface = found
    allocate (item, source=lake)
    call put_load(model, item, 'reservoir '//this%word('NAME'), 'RESERVOIR', this%word('NAME'), &
                  pattern_of_card(this)//as_text(size(model%problem%surfaces(found)%element)), &
                  1.0_rk, 0)
  end subroutine read_reservoir

  !> All parameters as a text to compare: equal texts mean equal reservoirs.
  pure function pattern_of_card(this) result(text)
    type(card), intent(in) :: this
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(this%spec%parameters)
      text = text//this%word(this%spec%parameters(i)%name)//';'
    end do
  end function pattern_of_card
end module keywords_reservoir
