!> *MATERIAL, *DENSITY, *DAMPING of a material.
module keywords_material
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword, field, kind_choice, kind_real, kind_word
  use kinds, only: rk
  use model_draft, only: draft, origin
  use write_text, only: as_text
  implicit none
  private
  public :: describe_material, describe_density, describe_material_damping
  public :: read_material, read_density, read_material_damping
  public :: base_of_damping, claim_card

  character, parameter :: nl = new_line('a')

contains

  subroutine describe_material(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'MATERIAL'
    spec%family = 'material'
    spec%place = 'model'
    spec%meaning = 'Opens a material; the keywords of its properties follow.'
    spec%example = '*MATERIAL, NAME=CONCRETE'//nl//'*DENSITY'//nl//'2400.'//nl//'*ELASTIC'//nl// &
                   '22e9, 0.167'//nl//'*DAMPING, ALPHA=0.6, BETA=0.002'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the material', is_required=.true.)])
  end subroutine describe_material

  subroutine read_material(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: name
    integer :: earlier
    name = this%word('NAME')
    model%num_materials = model%num_materials + 1
    model%problem%materials(model%num_materials)%name = name
    model%material_origin(model%num_materials) = model%here(0)
    earlier = model%material_of_name%find(name)
    if (earlier > 0) then
      call this%fault_parameter(faults, 'NAME', "material '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%material_origin(earlier)%card)%place())
      name = name//nl//as_text(model%num_materials) ! the table numbers all materials
    end if
    call model%material_of_name%find_or_add(name, earlier)
  end subroutine read_material

  subroutine describe_density(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'DENSITY'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Mass per volume. A material without it is massless (a foundation).'
    spec%example = '*DENSITY'//nl//'2400.'
    spec%fewest_lines = 1
    spec%most_lines = 1
    spec%temperature_column = 2
    allocate (spec%columns, source=[ &
              field('density', kind_real, 'mass per volume', 'kg/m3', is_required=.true., &
                    lowest=0.0_rk)])
  end subroutine describe_density

  subroutine read_density(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%problem%materials(model%num_materials))
      if (now%density > 0.0_rk) then
        call this%fault(faults, "material '"//now%name//"' already has a *DENSITY", 'one only')
      end if
      now%density = this%real_at(1, 1)
    end associate
  end subroutine read_density

  subroutine describe_material_damping(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'DAMPING'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Rayleigh damping of the material: ALPHA times its mass and BETA times its '// &
                   'elastic stiffness. It never acts across a joint nor on the water.'
    spec%example = '*DAMPING, ALPHA=0.6, BETA=0.002'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('ALPHA', kind_real, 'factor of the mass', '1/s', '0', lowest=0.0_rk), &
              field('BETA', kind_real, 'factor of the stiffness', 's', '0', lowest=0.0_rk), &
              base_of_damping()])
  end subroutine describe_material_damping

  !> BASE of both *DAMPING keywords.
  function base_of_damping() result(base)
    type(field) :: base
    base = field('BASE', kind_choice, 'the stiffness that damps: that of the undamaged solids, '// &
                 'or that of the solids with their present damage', default='INITIAL', &
                 choices='INITIAL | CURRENT')
  end function base_of_damping

  subroutine read_material_damping(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%problem%materials(model%num_materials))
      if (now%alpha > 0.0_rk .or. now%beta > 0.0_rk) then
        call this%fault(faults, "material '"//now%name//"' already has a *DAMPING", 'one only')
      end if
      now%alpha = this%real('ALPHA')
      now%beta = this%real('BETA')
      now%damps_current = this%word('BASE') == 'CURRENT'
    end associate
  end subroutine read_material_damping

  !> Stores the place of a keyword of the material; reports a second keyword of this kind.
  subroutine claim_card(this, model, spot, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(origin), intent(inout) :: spot !< of the keyword in its material
    type(diagnostic_list), intent(inout) :: faults
    if (spot%card > 0) then
      associate (now => model%problem%materials(model%num_materials))
        call this%fault(faults, "material '"//now%name//"' already has a *"// &
                        this%spec%name, 'one only', first=model%cards(spot%card)%place())
      end associate
    else
      spot = model%here(0)
    end if
  end subroutine claim_card
end module keywords_material
