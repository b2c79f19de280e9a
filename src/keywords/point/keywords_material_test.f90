!> *MATERIAL TEST.
module keywords_material_test
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use file_system, only: safe_name
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_word
  use kinds, only: rk
  use material_test_legs, only: read_legs
  use material_tests, only: material_test
  use model_draft, only: draft
  use named_things, only: find_material
  implicit none
  private
  public :: describe_material_test, read_material_test

  character, parameter :: nl = new_line('a')
  character(*), parameter :: test_types = 'UNIAXIAL | BIAXIAL | TRIAXIAL | OEDOMETER | '// &
                             'SHEAR | HYDROSTATIC | GENERAL'
  !> Of a leg and of a test: every increment is a row of the result.
  real(rk), parameter :: most_increments = 1.0e6_rk, most_cycles = 1.0e5_rk

contains

  subroutine describe_material_test(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'MATERIAL TEST'
    spec%family = 'material'
    spec%place = 'model'
    spec%meaning = 'Drives one material point along a path of strains and stresses. keyway '// &
                   '--material job.inp runs the test and writes job_material_NAME.csv. A test '// &
                   'needs no nodes, elements or steps; an analysis ignores it. A data line is '// &
                   'a leg: a straight path from the present state to the target. Several '// &
                   'lines make cycles. A softening branch needs strain control.'// &
                   kinds_in_words()
    spec%example = '*MATERIAL TEST, NAME=PULL, TYPE=UNIAXIAL, LENGTH=0.5'//nl//'2e-3'//nl// &
                   '*MATERIAL TEST, NAME=CYCLES, TYPE=UNIAXIAL, INCREMENTS=50'//nl// &
                   '0.4e-3'//nl//'-2e-3, 200'//nl//'1e-3'//nl// &
                   '*MATERIAL TEST, NAME=KUPFER, TYPE=BIAXIAL, RATIO=0.52'//nl//'-5e-3'//nl// &
                   '*MATERIAL TEST, NAME=CORE, TYPE=GENERAL'//nl// &
                   'SSSEEE, -1e6, -1e6, -1e6, 0., 0., 0., 10'//nl// &
                   'ESSEEE, -0.01, , , , , , 200'
    spec%fewest_lines = 1
    spec%checks_own_data = .true.
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the test and of its file', is_required=.true.), &
              field('MATERIAL', kind_word, 'the material', default='the only one of the deck'), &
              field('TYPE', kind_choice, 'kind of test', default='UNIAXIAL', &
                    choices=test_types), &
              field('CONTROL', kind_choice, 'quantity of the targets; not with GENERAL', &
                    default='STRAIN', choices='STRAIN | STRESS'), &
              field('RATIO', kind_real, 'S22 over S11, with BIAXIAL'), &
              field('CONFINEMENT', kind_real, 'pressure on the sides, with TRIAXIAL', 'Pa', &
                    lowest=0.0_rk), &
              field('LENGTH', kind_real, 'side of the cube that the point represents: width '// &
                    'of its crack band', &
                    'm', '1', lowest=0.0_rk, excludes_lowest=.true.), &
              field('INCREMENTS', kind_integer, 'increments of a leg whose line gives none', &
                    default='100', lowest=1.0_rk, highest=most_increments), &
              field('TIME', kind_real, 'duration of a leg whose line gives none', 's', '1', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('CYCLES', kind_integer, 'number of repetitions of the data lines', &
                    default='1', lowest=1.0_rk, highest=most_cycles), &
              field('TOLERANCE', kind_real, 'tolerance of stresses, over the largest stress '// &
                    'so far', &
                    default='1e-9', lowest=0.0_rk, highest=0.01_rk, excludes_lowest=.true.)])
    allocate (spec%columns, source=[ &
              field('target', kind_real, 'strain from -10 to 10, or stress [Pa], at the end '// &
                    'of the leg', &
                    is_required=.true.), &
              field('increments', kind_integer, 'number of equal increments of the leg, one '// &
                    'row of results each; INCREMENTS if empty', &
                    lowest=1.0_rk), &
              field('time', kind_real, 'duration of the leg, for laws that depend on time; '// &
                    'TIME if empty', &
                    's', lowest=0.0_rk, excludes_lowest=.true.)])
  end subroutine describe_material_test

  !> One line for each kind of test.
  pure function kinds_in_words() result(text)
    character(:), allocatable :: text
    text = nl//'UNIAXIAL: E11; all other stresses zero.'//nl// &
           'BIAXIAL: E11; S22 = RATIO times S11, all other stresses zero.'//nl// &
           'TRIAXIAL: first the pressure CONFINEMENT on all sides, then E11 at constant S22 '// &
           'and S33.'// &
           nl//'OEDOMETER: E11; all other strains zero.'//nl// &
           'SHEAR: gamma 12; all other stresses zero.'//nl// &
           'HYDROSTATIC: E11 = E22 = E33; no shear.'//nl// &
           'With CONTROL=STRESS the targets of all these are S11 (SHEAR: S12).'//nl// &
           'GENERAL: each component has its own target. The data lines are control, 11, 22, '// &
           '33, 12, 13, 23, increments, time; the control is six letters, E for a strain and '// &
           'S for a stress: ESSSSS. An empty control repeats that of the line before. An '// &
           'empty component keeps its value.'
  end function kinds_in_words

  subroutine read_material_test(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(material_test) :: new
    integer :: i
    new%name = this%word('NAME')
    new%kind = this%word('TYPE')
    new%length = this%real('LENGTH')
    new%tolerance = this%real('TOLERANCE')
    new%driven = 1
    if (new%kind == 'SHEAR') new%driven = 4
    if (new%kind == 'GENERAL') new%driven = 0
    do i = 1, size(model%problem%tests)
      if (safe_name(model%problem%tests(i)%name) /= safe_name(new%name)) cycle ! one file each
      call this%fault_parameter(faults, 'NAME', "test '"//this%text('NAME')// &
                                "' is defined twice", 'a name that is used once', &
                                first=model%cards(model%test_origin(i)%card)%place())
    end do
    call choose_material(this, model, faults, new%material)
    call check_parameters(this, faults)
    call read_legs(this, faults, new%legs)
    model%problem%tests = [model%problem%tests, new]
    model%test_origin = [model%test_origin, model%here(0)]
    if (model%options%is_for_tests) return
    call this%ignore(faults, 'has no effect in an analysis; keyway --material runs it')
  end subroutine read_material_test

  !> The material that the card names, or the only material of the deck.
  subroutine choose_material(this, model, faults, found)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer, intent(out) :: found !< 0 after a fault
    found = 0
    if (this%has('MATERIAL')) then
      call find_material(this, model, faults, found)
    else if (model%num_materials == 1) then
      found = 1
    else if (model%num_materials == 0) then
      call this%fault(faults, 'the deck has no material', '*MATERIAL and its properties')
    else
      call this%fault(faults, 'the deck has several materials', 'MATERIAL=<name of one>')
    end if
  end subroutine choose_material

  !> Reports parameters that belong to another kind of test.
  subroutine check_parameters(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    call check_use('RATIO', 'BIAXIAL', 'RATIO=<S22 over S11>')
    call check_use('CONFINEMENT', 'TRIAXIAL', 'CONFINEMENT=<pressure on the sides> [Pa]')
    if (this%word('CONTROL') == 'STRESS' .and. this%word('TYPE') == 'GENERAL') then
      call this%fault_parameter(faults, 'CONTROL', 'CONTROL does not belong to TYPE=GENERAL', &
                                'the control of each component in the data lines')
    end if

  contains

    !> Reports a parameter that the test does not take, or that the test lacks.
    subroutine check_use(name, kind, wanted)
      character(*), intent(in) :: name, kind, wanted
      if (this%has(name) .eqv. this%word('TYPE') == kind) return
      if (this%has(name)) then
        call this%fault_parameter(faults, name, name//' does not belong to TYPE='// &
                                  this%word('TYPE'), &
                                  'TYPE='//kind//' with '//name)
      else
        call this%fault(faults, kind//' without '//name, wanted)
      end if
    end subroutine check_use
  end subroutine check_parameters
end module keywords_material_test
