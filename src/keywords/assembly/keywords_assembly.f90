!> *PART, *ASSEMBLY, *INSTANCE and the keywords that close them. They have no handlers: the model is
!> made flat before its cards are handled (flatten_assembly).
module keywords_assembly
  use keyword_spec, only: field, keyword, kind_real, kind_word
  implicit none
  private
  public :: describe_part, describe_end_part, describe_assembly, describe_end_assembly
  public :: describe_instance, describe_end_instance

  character, parameter :: nl = new_line('a')
  character(*), parameter :: example = '*PART, NAME=BLOCK'//nl//'*NODE'//nl//'..'//nl// &
                             '*END PART'//nl//'*ASSEMBLY, NAME=DAM'//nl// &
                             '*INSTANCE, NAME=BLOCK-1, PART=BLOCK'//nl//'*END INSTANCE'//nl// &
                             '*INSTANCE, NAME=BLOCK-2, PART=BLOCK'//nl//'15., 0., 0.'//nl// &
                             '*END INSTANCE'//nl//'*END ASSEMBLY'

contains

  subroutine describe_part(spec)
    type(keyword), intent(out) :: spec
    call set_common(spec, 'PART', 'Opens a part: nodes, elements, sets, surfaces and sections '// &
                    'with numbers and names of its own. A part acts where an *INSTANCE places it.')
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the part', is_required=.true.)])
  end subroutine describe_part

  subroutine describe_end_part(spec)
    type(keyword), intent(out) :: spec
    call set_common(spec, 'END PART', 'Closes a part.')
  end subroutine describe_end_part

  subroutine describe_assembly(spec)
    type(keyword), intent(out) :: spec
    call set_common(spec, 'ASSEMBLY', 'Opens the assembly: the instances of the parts, sets '// &
                    'and surfaces of several instances, joints and ties between them. Outside '// &
                    'the instances INSTANCE.SET is a set or surface, and INSTANCE.12 a node or '// &
                    'element, of an instance.')
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the assembly, not used')])
  end subroutine describe_assembly

  subroutine describe_end_assembly(spec)
    type(keyword), intent(out) :: spec
    call set_common(spec, 'END ASSEMBLY', 'Closes the assembly.')
  end subroutine describe_end_assembly

  subroutine describe_instance(spec)
    type(keyword), intent(out) :: spec
    call set_common(spec, 'INSTANCE', 'Places a part in the assembly: first moved by a vector, '// &
                    'then rotated about an axis through two points. Nodes and elements keep '// &
                    'their numbers where no other instance has them; else a round number is '// &
                    'added to all of an instance, which a warning and job.json name. Mesh and '// &
                    'sections may also follow here in place of the part.')
    spec%most_lines = 2
    spec%checks_own_data = .true.
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the instance', is_required=.true.), &
              field('PART', kind_word, 'the part', is_required=.true.)])
    allocate (spec%columns, source=[ &
              field('x', kind_real, 'translation; in the second line: a point of the axis, ', &
                    'm', '0'), &
              field('y', kind_real, 'translation, or of the point', 'm', '0'), &
              field('z', kind_real, 'translation, or of the point', 'm', '0'), &
              field('x2', kind_real, 'second line: another point of the axis', 'm'), &
              field('y2', kind_real, 'of this point', 'm'), &
              field('z2', kind_real, 'of this point', 'm'), &
              field('angle', kind_real, 'rotation, right-handed about the direction from the '// &
                    'first point to the other', 'degrees')])
  end subroutine describe_instance

  subroutine describe_end_instance(spec)
    type(keyword), intent(out) :: spec
    call set_common(spec, 'END INSTANCE', 'Closes an instance.')
  end subroutine describe_end_instance

  subroutine set_common(spec, name, meaning)
    type(keyword), intent(inout) :: spec
    character(*), intent(in) :: name, meaning
    spec%name = name
    spec%meaning = meaning
    spec%family = 'mesh'
    spec%place = 'model'
    spec%example = '*'//name
    if (name == 'PART' .or. name == 'ASSEMBLY' .or. name == 'INSTANCE') spec%example = example
    spec%most_lines = 0
  end subroutine set_common
end module keywords_assembly
