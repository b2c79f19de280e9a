!> Keywords that are known and not available yet: each is an error at its place in the deck.
module keywords_later
  use keyword_handler, only: keyword_list
  use keyword_spec, only: later
  implicit none
  private
  public :: add_later_keywords

contains

  !> Keywords of Abaqus and CalculiX.
  subroutine add_later_keywords(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: family = 'other programs'
    call add_later(list, 'PART', family, 'model', 'Opens a part.')
    call add_later(list, 'END PART', family, 'model', 'Closes a part.')
    call add_later(list, 'ASSEMBLY', family, 'model', 'Opens the assembly of parts.')
    call add_later(list, 'END ASSEMBLY', family, 'model', 'Closes the assembly of parts.')
    call add_later(list, 'INSTANCE', family, 'model', 'Places a part in the assembly.')
    call add_later(list, 'END INSTANCE', family, 'model', 'Closes an instance.')
    call add_later(list, 'EQUATION', family, 'model', 'Linear equations between displacements.')
    call add_later(list, 'CONTACT PAIR', family, 'model', 'Contact of two surfaces, as a joint.')
    call add_later(list, 'SURFACE INTERACTION', family, 'model', 'Names a law of contact.')
    call add_later(list, 'SURFACE BEHAVIOR', family, 'model', 'Normal law of contact.')
    call add_later(list, 'FRICTION', family, 'model', 'Friction of contact.')
    call add_later(list, 'PLASTIC', family, 'material', 'Metal plasticity.')
    call add_later(list, 'EXPANSION', family, 'material', 'Thermal expansion.')
    call add_later(list, 'TEMPERATURE', family, 'step', 'Temperatures of nodes [K].')
    call add_later(list, 'PARAMETER', family, 'model', 'Names for numbers of the deck.')
    call add_later(list, 'RIGID BODY', family, 'model', 'Makes a part rigid.')
    call add_later(list, 'MPC', family, 'model', 'Constraints between nodes.')
    call add_later(list, 'COUPLING', family, 'model', 'Couples a surface to a node.')
    call add_later(list, 'TRANSFORM', family, 'model', 'Axes of nodes.')
    call add_later(list, 'ORIENTATION', family, 'model', 'Axes of a material.')
  end subroutine add_later_keywords

  !> Adds a keyword without a handler.
  subroutine add_later(list, name, family, place, meaning)
    type(keyword_list), intent(inout) :: list
    character(*), intent(in) :: name, family, place, meaning
    list%num_keywords = list%num_keywords + 1
    associate (spec => list%specs(list%num_keywords))
      spec%name = name
      spec%family = family
      spec%place = place
      spec%meaning = meaning
      spec%example = ''
      spec%status = later
      allocate (spec%parameters(0), spec%columns(0))
    end associate
  end subroutine add_later
end module keywords_later
