!> *USER MATERIAL and *DEPVAR: a material whose law is a UMAT of the user.
module keywords_user_material
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use finish_user_materials, only: user_material
  use keyword_handler, only: keyword_list, pass_definitions
  use keyword_spec, only: keyword, field, kind_choice, kind_flag, kind_integer, kind_real, &
                          kind_text
  use keywords_material, only: claim_card
  use kinds, only: rk
  use model_draft, only: draft, find_material_request
  use write_text, only: as_text
  implicit none
  private
  public :: add_user_material

  character, parameter :: nl = new_line('a')
  integer, parameter :: constants_of_line = 8
  integer, parameter :: most_variables = 1000000 !< more at one point are a slip

contains

  subroutine add_user_material(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_user_material, read_user_material, pass_definitions)
    call list%add(describe_depvar, read_depvar, pass_definitions)
  end subroutine add_user_material

  subroutine describe_user_material(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'USER MATERIAL'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'The law of the material is a UMAT of the user, which --umat names on the '// &
                   'command line: keyway --umat law.for job.inp. The data are its constants '// &
                   '(PROPS), at most 8 a line. The name of the material arrives as CMNAME. The '// &
                   'keyword replaces *ELASTIC.'
    spec%example = '*MATERIAL, NAME=STEEL'//nl//'*USER MATERIAL, CONSTANTS=3'//nl// &
                   '210e9, 0.3, 355e6'//nl//'*DEPVAR'//nl//'7'
    allocate (spec%parameters, source=[ &
              field('CONSTANTS', kind_integer, 'number of constants', is_required=.true., &
                    lowest=0.0_rk), &
              field('UNSYMM', kind_flag, 'DDSDDE is used as the UMAT returns it; without '// &
                    'UNSYMM it is symmetrised'), &
              field('TYPE', kind_choice, 'kind of law, without coupling to temperature', &
                    default='MECHANICAL', choices='MECHANICAL', &
                    instead='the law has no coupling to temperature')])
    spec%repeats_columns = .true.
    allocate (spec%columns, source=[ &
              field('constant', kind_real, 'constant of the law (PROPS)', default='0')])
  end subroutine describe_user_material

  subroutine read_user_material(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_request(model, i)
    select type (now => model%material_requests(i)%item)
    type is (user_material)
      call claim_card(this, model, now%spot, faults)
      now%constants%is_unsymmetric = this%has('UNSYMM')
      call read_constants(this, now%constants%values, faults)
    end select
  end subroutine read_user_material

  !> Reads the constants, at most 8 a line. If all are given they count in sequence. Else lines that
  !> end in a comma have empty fields up to the eighth, which are zero.
  subroutine read_constants(this, values, faults)
    type(card), intent(in) :: this
    real(rk), allocatable, intent(out) :: values(:)
    type(diagnostic_list), intent(inout) :: faults
    integer :: line, i, num_given, num_wanted, place
    logical :: is_in_sequence
    num_wanted = this%integer('CONSTANTS')
    num_given = sum([(this%num_fields(line), line=1, this%num_lines)])
    is_in_sequence = num_given == num_wanted .or. .not. fills_lines(this, num_wanted)
    allocate (values(max(min(num_wanted, constants_of_line*this%num_lines), 0)), source=0.0_rk)
    place = 0
    do line = 1, this%num_lines
      if (this%num_fields(line) > constants_of_line) then
        call this%fault_at(faults, line, constants_of_line + 1, 'found '// &
                           as_text(this%num_fields(line))//' constants', 'at most 8 a line')
        return
      end if
      if (.not. is_in_sequence) place = constants_of_line*(line - 1)
      do i = 1, this%num_fields(line)
        place = place + 1
        if (place <= size(values)) values(place) = this%real_at(line, i)
      end do
    end do
    if (num_given == num_wanted .or. .not. is_in_sequence) return
    call this%fault_parameter(faults, 'CONSTANTS', 'CONSTANTS='//as_text(num_wanted)//', but '// &
                              as_text(num_given)//' constants follow', 'the same number')
  end subroutine read_constants

  !> Whether the lines hold the constants once their empty fields count: a short line ends in a
  !> comma.
  pure logical function fills_lines(this, num_wanted)
    type(card), intent(in) :: this
    integer, intent(in) :: num_wanted
    integer :: line, num_here
    fills_lines = num_wanted <= constants_of_line*this%num_lines .and. &
                  num_wanted > constants_of_line*(this%num_lines - 1)
    if (.not. fills_lines) return
    do line = 1, this%num_lines
      num_here = min(constants_of_line, num_wanted - constants_of_line*(line - 1))
      fills_lines = fills_lines .and. this%num_fields(line) <= num_here
      if (this%num_fields(line) < num_here) then
        fills_lines = fills_lines .and. this%ends_in_comma(line)
      end if
    end do
  end function fills_lines

  subroutine describe_depvar(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'DEPVAR'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Number of state variables of a user material (NSTATV); results call them '// &
                   'SDV1, SDV2 and so on. Lines that name them (number, name, text) may follow.'
    spec%example = '*DEPVAR'//nl//'7'
    spec%fewest_lines = 1
    spec%checks_own_data = .true.
    allocate (spec%columns, source=[ &
              field('number', kind_integer, 'number of state variables; in further lines the '// &
                    'number of the variable that is named', &
                    is_required=.true.), &
              field('name', kind_text, 'name of a state variable'), &
              field('text', kind_text, 'description of the state variable')])
  end subroutine describe_depvar

  subroutine read_depvar(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, line, number
    call find_request(model, i)
    select type (now => model%material_requests(i)%item)
    type is (user_material)
      call claim_card(this, model, now%depvar, faults)
      number = this%integer_at(1, 1)
      if (this%num_fields(1) /= 1 .or. .not. this%is_integer_at(1, 1) .or. number < 0 .or. &
          number > most_variables) then
        call this%fault_at(faults, 1, 1, "found '"//this%text_at(1, 1)//"'", &
                           'the number of state variables, an integer from 0 to '// &
                           as_text(most_variables)//', alone in its line')
        return
      end if
      now%constants%num_variables = number
      do line = 2, this%num_lines
        number = this%integer_at(line, 1)
        if (number >= 1 .and. number <= now%constants%num_variables) cycle
        call this%fault_at(faults, line, 1, "found '"//this%text_at(line, 1)//"'", &
                           'the number of a state variable, 1 to '// &
                           as_text(now%constants%num_variables)//', and its name')
        return
      end do
    end select
    if (this%num_lines > 1) then
      call this%ignore(faults, 'the names have no effect: results call the state variables '// &
                       'SDV1, SDV2, ..')
    end if
  end subroutine read_depvar

  !> Position in model%material_requests of the user material that is being read.
  subroutine find_request(model, i)
    type(draft), intent(inout) :: model
    integer, intent(out) :: i
    call find_material_request(model, user_material(), i)
    select type (now => model%material_requests(i)%item)
    type is (user_material)
      now%constants%name = model%problem%materials(now%material)%name
    end select
  end subroutine find_request
end module keywords_user_material
