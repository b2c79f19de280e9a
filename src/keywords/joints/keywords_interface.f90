!> *INTERFACE.
module keywords_interface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword, field, kind_real, kind_word
  use kinds, only: rk
  use model_draft, only: draft, interface_request
  use named_things, only: elements_of_set, find_surface
  use write_text, only: as_text
  implicit none
  private
  public :: describe_interface, read_interface

contains

  subroutine describe_interface(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'INTERFACE'
    spec%family = 'joint'
    spec%place = 'model'
    spec%meaning = 'Couples the IFACE4 quadrilaterals of a set (separate nodes without '// &
                   'mass) to a surface of solids whose mesh may differ, by springs of '// &
                   'STIFFNESS per area on the true overlap of the facets. JOINT8 elements may '// &
                   'then stand between the quadrilaterals and another body. Area without a '// &
                   'partner, gaps and overlaps are reported.'
    spec%example = '*INTERFACE, NAME=I1, ELSET=QUADS, SURFACE=FINE_SIDE'
    spec%most_lines = 0
    allocate (spec%columns(0))
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the interface', is_required=.true.), &
              field('ELSET', kind_word, 'its IFACE4 elements', is_required=.true.), &
              field('SURFACE', kind_word, 'the surface of solids', is_required=.true.), &
              field('STIFFNESS', kind_real, 'of the springs', 'Pa/m', &
                    'E of the solid behind SURFACE, as a number', lowest=0.0_rk, &
                    excludes_lowest=.true.)])
  end subroutine describe_interface

  subroutine read_interface(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(interface_request) :: new
    integer :: i
    new%name = this%word('NAME')
    new%stiffness = this%real('STIFFNESS')
    new%spot = model%here(0)
    do i = 1, size(model%interfaces)
      if (model%interfaces(i)%name /= new%name) cycle
      call this%fault_parameter(faults, 'NAME', "interface '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%interfaces(i)%spot%card)%place())
    end do
    call find_surface(this, model, faults, new%surface)
    call elements_of_set(this, 'ELSET', model, faults, new%elements)
    call claim_elements(this, new%elements, model, faults)
    model%interfaces = [model%interfaces, new]
  end subroutine read_interface

  !> The elements of an interface: IFACE4 of no other interface. Empty after a fault.
  subroutine claim_elements(this, elements, model, faults)
    type(card), intent(in) :: this
    integer, allocatable, intent(inout) :: elements(:) !< positions
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, e, earlier
    do i = 1, size(elements)
      e = elements(i)
      if (model%problem%mesh%element_type(e) /= 'IFACE4') then
        call this%fault_parameter(faults, 'ELSET', 'element '// &
                                  as_text(model%problem%mesh%element_id(e))//' is a '// &
                                  trim(model%problem%mesh%element_type(e)), &
                                  'a set of IFACE4 elements')
        elements = [integer ::]
        return
      end if
      earlier = model%interface_of_element(e)
      if (earlier > 0) then
        call this%fault_parameter(faults, 'ELSET', 'element '// &
                                  as_text(model%problem%mesh%element_id(e))// &
                                  ' belongs to another interface', &
                                  'one interface for each element', &
                                  first=model%cards(model%interfaces(earlier)%spot%card)%place())
        elements = [integer ::]
        return
      end if
      model%interface_of_element(e) = size(model%interfaces) + 1
    end do
  end subroutine claim_elements
end module keywords_interface
