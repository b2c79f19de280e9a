!> *TIE.
module keywords_tie
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: field, keyword, kind_choice, kind_real, kind_word
  use keywords_other, only: add_idle_parameters
  use kinds, only: rk
  use model_draft, only: draft, tie_request
  use named_things, only: find_surface_at
  implicit none
  private
  public :: describe_tie, read_tie

contains

  subroutine describe_tie(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'TIE'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Ties surfaces whose meshes may differ, in all directions. Without '// &
                   'STIFFNESS the nodes of the slave surface follow the master surface '// &
                   'exactly, as mean values over the true overlap of the facets (a dual '// &
                   'mortar method). The finer side is usually the better slave, and the '// &
                   'cheaper one. If the face itself bends and the meshes differ by 1:2 or '// &
                   'more, tractions are smoother with the coarser slave. If *BOUNDARY of '// &
                   'any step or an earlier tie prescribes a direction of a slave node, this '// &
                   'tie leaves that direction free. With STIFFNESS, springs '// &
                   'connect the faces. Parts of the slave surface without '// &
                   'partner stay free.'
    spec%example = '*TIE, NAME=BLOCK1_TO_ROCK'//new_line('a')//'BLOCK1_BASE, ROCK_TOP'
    spec%fewest_lines = 1
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the tie', is_required=.true.), &
              field('STIFFNESS', kind_real, 'of springs between the faces', 'Pa/m', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('ADJUST', kind_choice, 'moves slave nodes onto the master surface before '// &
                    'the analysis: between faces with gaps (curved ones) a rotation then '// &
                    'causes no stress', default='NO', choices='YES | NO'), &
              field('POSITION TOLERANCE', kind_real, 'a warning where the faces lie further '// &
                    'apart; they are tied all the same', 'm', lowest=0.0_rk), &
              field('TYPE', kind_choice, 'discretisation: here both are the mortar method', &
                    default='SURFACE TO SURFACE', &
                    choices='SURFACE TO SURFACE | NODE TO SURFACE')])
    allocate (spec%columns, source=[ &
              field('slave', kind_word, 'slave surface, usually the finer one', &
                    is_required=.true.), &
              field('master', kind_word, 'master surface', is_required=.true.)])
    call add_idle_parameters(spec, [character(16) :: 'NO ROTATION', 'NO THICKNESS', &
                                    'CONSTRAINT RATIO'])
  end subroutine describe_tie

  subroutine read_tie(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(tie_request) :: new
    integer :: line, i
    new%name = this%word('NAME')
    new%stiffness = this%real('STIFFNESS')
    new%adjusts = this%word('ADJUST') == 'YES'
    if (this%has('POSITION TOLERANCE')) new%tolerance = this%real('POSITION TOLERANCE')
    if (new%adjusts .and. this%has('STIFFNESS')) then
      call this%fault_parameter(faults, 'ADJUST', 'ADJUST has no effect on springs', &
                                'ADJUST without STIFFNESS')
    end if
    do i = 1, size(model%ties)
      if (model%ties(i)%name /= new%name) cycle
      if (model%ties(i)%spot%card == model%current) cycle
      call this%fault_parameter(faults, 'NAME', "tie '"//this%text('NAME')//"' is defined twice", &
                                'a name that is used once', &
                                first=model%cards(model%ties(i)%spot%card)%place())
      exit
    end do
    do line = 1, this%num_lines
      new%spot = model%here(line)
      call find_surface_at(this, line, model, faults, new%slave)
      call find_surface_at(this, line, model, faults, new%master, field=2)
      if (new%slave > 0 .and. new%slave == new%master) then
        call this%fault_at(faults, line, 2, 'the master surface is the slave surface', &
                           'another surface')
      end if
      call check_pair(this, line, new, model, faults)
      model%ties = [model%ties, new]
    end do
  end subroutine read_tie

  !> Refuses two ties of the same surfaces: their springs would add up.
  subroutine check_pair(this, line, new, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    type(tie_request), intent(in) :: new
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (min(new%slave, new%master) == 0) return
    do i = 1, size(model%ties)
      associate (other => model%ties(i))
        if (min(other%slave, other%master) /= min(new%slave, new%master)) cycle
        if (max(other%slave, other%master) /= max(new%slave, new%master)) cycle
        call this%fault_at(faults, line, 1, "tie '"//other%name//"' holds these two surfaces "// &
                           'already', 'one tie for two surfaces', &
                           first=model%cards(other%spot%card)%place())
      end associate
      return
    end do
  end subroutine check_pair
end module keywords_tie
