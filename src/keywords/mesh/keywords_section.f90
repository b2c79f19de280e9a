!> *SOLID SECTION.
module keywords_section
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use keyword_spec, only: keyword, field, kind_choice, kind_real, kind_word
  use model_draft, only: draft, section_request
  use named_things, only: elements_of_set, find_material
  use write_text, only: as_text
  implicit none
  private
  public :: describe_solid_section, read_solid_section, echo_mass

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_solid_section(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'SOLID SECTION'
    spec%family = 'material'
    spec%place = 'model'
    spec%meaning = 'Gives the solid elements of a set their material. Stresses are averaged at '// &
                   'nodes within a section, never across sections; where two sections meet, '// &
                   'the one defined first is used. The whole model has one kind of mass.'
    spec%example = '*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE'
    spec%most_lines = 1
    allocate (spec%parameters, source=[ &
              field('ELSET', kind_word, 'the elements', is_required=.true.), &
              field('MATERIAL', kind_word, 'their material', is_required=.true.), &
              field('MASS', kind_choice, 'mass matrix of the whole model, that of the sections '// &
                    'with MASS', default='CONSISTENT', choices='CONSISTENT | LUMPED'), &
              field('CONTROLS', kind_word, 'of Abaqus', has_no_effect=.true.)])
    allocate (spec%columns, source=[ &
              field('thickness', kind_real, 'thickness, not used for solids')])
  end subroutine describe_solid_section

  subroutine read_solid_section(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(section_request) :: new
    integer :: num_material
    call find_material(this, model, faults, num_material)
    call elements_of_set(this, 'ELSET', model, faults, new%elements)
    call choose_mass(this, model, faults)
    if (this%num_lines > 0) then
      if (.not. this%is_empty_at(1, 1)) then
        call this%warn_at(faults, 1, 1, 'the thickness has no effect on solids')
      end if
    end if
    new%material = this%word('MATERIAL')
    new%spot = model%here(0)
    model%num_sections = model%num_sections + 1
    model%sections(model%num_sections) = new
    call give_material(this, new%elements, num_material, model, faults)
  end subroutine read_solid_section

  !> Checks that all sections give the same MASS. One without it has that of the others, which may
  !> not be meant where it is not the usual one.
  subroutine choose_mass(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (.not. this%has('MASS')) then
      if (model%problem%has_lumped_mass) call this%warn( &
        faults, 'MASS=LUMPED of another section acts on these elements, too', &
        'MASS in all sections')
      return
    end if
    if (allocated(model%mass_kind)) then
      if (model%mass_kind /= this%word('MASS')) then
        call this%fault_parameter(faults, 'MASS', 'the mass of another section is '// &
                                  model%mass_kind, 'one kind of mass in the whole model')
      end if
    else if (model%num_sections > 0 .and. this%word('MASS') == 'LUMPED') then
      call this%warn(faults, 'MASS=LUMPED acts on the elements of all sections', &
                     'MASS in all sections')
    end if
    model%mass_kind = this%word('MASS')
    model%problem%has_lumped_mass = model%mass_kind == 'LUMPED'
  end subroutine choose_mass

  !> Sections without MASS have that of the others in the echo of the deck, too.
  subroutine echo_mass(model)
    type(draft), intent(inout) :: model
    integer :: i, k
    if (.not. model%problem%has_lumped_mass) return
    do i = 1, size(model%cards)
      if (.not. is_keyword(model%cards(i), 'SOLID SECTION')) cycle
      associate (parameters => model%cards(i)%spec%parameters)
        do k = 1, size(parameters)
          if (parameters(k)%name == 'MASS') parameters(k)%default = model%mass_kind
        end do
      end associate
    end do
  end subroutine echo_mass

  subroutine give_material(this, elements, num_material, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: elements(:), num_material
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, e, earlier
    associate (mesh => model%problem%mesh)
      do i = 1, size(elements)
        e = elements(i)
        if (.not. is_solid(mesh%element_type(e))) then
          call this%fault_parameter(faults, 'ELSET', 'element '//as_text(mesh%element_id(e))// &
                                    ' is a '//trim(mesh%element_type(e)), &
                                    'a set of solid elements')
          return
        end if
        earlier = mesh%section_of_element(e)
        if (earlier > 0) then
          call this%fault_parameter(faults, 'ELSET', 'element '//as_text(mesh%element_id(e))// &
                                    ' already has a section', 'one section for each element', &
                                    first=model%cards(model%sections(earlier)%spot%card)%place())
          return
        end if
        mesh%section_of_element(e) = model%num_sections
        mesh%material_of_element(e) = num_material
      end do
    end associate
  end subroutine give_material
end module keywords_section
