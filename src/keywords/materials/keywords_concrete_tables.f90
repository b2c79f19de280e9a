!> The tables of concrete: *CONCRETE COMPRESSION HARDENING, *CONCRETE TENSION STIFFENING,
!> *CONCRETE COMPRESSION DAMAGE, *CONCRETE TENSION DAMAGE.
module keywords_concrete_tables
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use finish_concrete, only: concrete_material
  use keyword_handler, only: keyword_list, pass_definitions
  use keyword_spec, only: keyword, field, kind_choice, kind_real
  use keywords_concrete, only: describe_plasticity, find_concrete, no_dependencies, &
                               read_plasticity
  use keywords_material, only: claim_card
  use kinds, only: rk
  use model_draft, only: draft
  implicit none
  private
  public :: add_concrete

  character, parameter :: nl = new_line('a')

contains

  !> All keywords of concrete.
  subroutine add_concrete(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_plasticity, read_plasticity, pass_definitions)
    call list%add(describe_hardening, read_hardening, pass_definitions)
    call list%add(describe_stiffening, read_stiffening, pass_definitions)
    call list%add(describe_crushing, read_crushing, pass_definitions)
    call list%add(describe_cracking, read_cracking, pass_definitions)
  end subroutine add_concrete

  !> Sets the entries that the four tables share.
  subroutine describe_table(spec, ordinate, abscissa)
    type(keyword), intent(inout) :: spec
    type(field), intent(in) :: ordinate, abscissa
    spec%family = 'material'
    spec%place = 'material'
    spec%fewest_lines = 1
    spec%no_further = no_dependencies
    spec%temperature_column = 3
    allocate (spec%columns, source=[ordinate, abscissa])
  end subroutine describe_table

  !> Reads the rows of a card.
  subroutine read_table(this, table)
    type(card), intent(in) :: this
    real(rk), allocatable, intent(out) :: table(:, :) !< (2, rows): ordinate, abscissa
    integer :: row
    allocate (table(2, this%num_lines))
    do row = 1, this%num_lines
      table(:, row) = [this%real_at(row, 1), this%real_at(row, 2)]
    end do
  end subroutine read_table

  subroutine describe_hardening(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CONCRETE COMPRESSION HARDENING'
    spec%meaning = 'Strength in uniaxial compression over inelastic strain, both positive; '// &
                   'constant past the last row. The inelastic strain is the strain of the '// &
                   'test less stress/E; it is 0 in the first row. One row gives a constant '// &
                   'strength.'
    spec%example = '*CONCRETE COMPRESSION HARDENING'//nl//'18.3e6, 0.'//nl//'27.6e6, 1.0e-3'//nl// &
                   '3.2e6, 5.0e-3'
    call describe_table(spec, field('sigma_c', kind_real, 'strength', 'Pa', is_required=.true., &
                                    lowest=0.0_rk), &
                        field('strain', kind_real, 'inelastic strain eps - sigma/E', &
                              is_required=.true., lowest=0.0_rk))
    spec%temperature_column = 4 ! below a rate
    allocate (spec%parameters(0))
  end subroutine describe_hardening

  subroutine read_hardening(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_concrete(model, i)
    select type (one => model%material_requests(i)%item)
    type is (concrete_material)
      call read_table(this, one%given%constants%compression)
      call claim_card(this, model, one%given%hardening, faults)
    end select
  end subroutine read_hardening

  subroutine describe_stiffening(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CONCRETE TENSION STIFFENING'
    spec%meaning = 'Strength in uniaxial tension after cracking, constant past the last row. '// &
                   'Over cracking strain (the paper''s Table 1) the energy of a crack grows '// &
                   'with the size of the elements. Over the opening of the crack, or with f_t '// &
                   'and G_f (linear, zero at the opening 2 G_f/f_t), the energy does not '// &
                   'depend on the mesh: strain = opening/length, the length of the element '// &
                   'across the crack. Then no element may be longer than 2 E G_f/f_t^2, nor '// &
                   'longer than E over the steepest slope of the table. A longer element '// &
                   'would break with less energy than the table gives (theory 11.5).'
    spec%example = '*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT'//nl//'2.5e6, 0.'//nl// &
                   '0.83e6, 0.06e-3'//nl//'0.05e6, 0.28e-3'
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'abscissa of the table', &
                    default='STRAIN', choices='STRAIN | DISPLACEMENT | GFI'), &
              field('LONG ELEMENTS', kind_choice, 'treatment of elements that are too long: '// &
                    'an error, or a lower strength with the '// &
                    'same energy and a warning', &
                    default='ERROR', choices='ERROR | LOWER STRENGTH')])
    call describe_table(spec, field('sigma_t', kind_real, 'strength (f_t with GFI)', 'Pa', &
                                    is_required=.true., lowest=0.0_rk), &
                        field('abscissa', kind_real, 'cracking strain eps - sigma/E, opening '// &
                              '[m] with DISPLACEMENT, G_f [N/m] with GFI', &
                              is_required=.true., lowest=0.0_rk))
    spec%temperature_column = 4 ! below a rate
  end subroutine describe_stiffening

  subroutine read_stiffening(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_concrete(model, i)
    select type (one => model%material_requests(i)%item)
    type is (concrete_material)
      associate (now => one%given%constants)
        call read_table(this, now%tension)
        now%stiffening = this%word('TYPE')
        now%lowers_strength = this%word('LONG ELEMENTS') /= 'ERROR'
        if (now%stiffening == 'GFI' .and. this%num_lines > 1) then
          call this%fault_at(faults, 2, 0, 'a second row with TYPE=GFI', 'one row: f_t, G_f')
          one%given%is_right = .false.
        else if (now%stiffening == 'STRAIN' .and. this%has('LONG ELEMENTS')) then
          call this%warn(faults, 'LONG ELEMENTS has no effect: TYPE=STRAIN does not use the '// &
                         'length of elements')
        end if
      end associate
      call claim_card(this, model, one%given%stiffening, faults)
    end select
  end subroutine read_stiffening

  subroutine describe_crushing(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CONCRETE COMPRESSION DAMAGE'
    spec%meaning = 'Loss of stiffness in uniaxial compression over inelastic strain (Eq. 15); '// &
                   'constant past the last row. Without this table crushing does not reduce '// &
                   'the stiffness.'
    spec%example = '*CONCRETE COMPRESSION DAMAGE, TENSION RECOVERY=0'//nl//'0., 0.'//nl// &
                   '0.25, 1.0e-3'//nl//'0.8, 5.0e-3'
    allocate (spec%parameters, source=[ &
              field('TENSION RECOVERY', kind_real, 'w_t of Eq. 16: fraction of the stiffness '// &
                    'lost by crushing that recovers in tension', &
                    default='0', lowest=0.0_rk, &
                    highest=1.0_rk)])
    call describe_table(spec, damage_column('d_c'), &
                        field('strain', kind_real, 'inelastic strain eps - sigma/E', &
                              is_required=.true., lowest=0.0_rk))
  end subroutine describe_crushing

  !> Damage d, 0 <= d < 1: the remaining stiffness is (1 - d) E.
  pure type(field) function damage_column(name)
    character(*), intent(in) :: name
    damage_column = field(name, kind_real, 'damage', is_required=.true., lowest=0.0_rk, &
                          highest=1.0_rk, excludes_highest=.true.)
  end function damage_column

  subroutine read_crushing(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_concrete(model, i)
    select type (one => model%material_requests(i)%item)
    type is (concrete_material)
      call read_table(this, one%given%constants%compression_damage)
      one%given%constants%tension_recovery = this%real('TENSION RECOVERY')
      call claim_card(this, model, one%given%compression_damage, faults)
    end select
  end subroutine read_crushing

  subroutine describe_cracking(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CONCRETE TENSION DAMAGE'
    spec%meaning = 'Loss of stiffness in uniaxial tension over cracking strain, or over the '// &
                   'opening of the crack (Eq. 15); constant past the last row. The length of '// &
                   'the element converts openings into strains as in *CONCRETE TENSION '// &
                   'STIFFENING. Without this table cracking does not reduce the stiffness. '// &
                   'The plastic strain, cracking strain - d/(1 - d) sigma/E, must not '// &
                   'decrease from row to row (paper_notes.md, 11).'
    spec%example = '*CONCRETE TENSION DAMAGE, TYPE=DISPLACEMENT'//nl//'0., 0.'//nl// &
                   '0.6, 0.06e-3'//nl//'0.95, 0.28e-3'
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'abscissa of the table', &
                    default='STRAIN', choices='STRAIN | DISPLACEMENT'), &
              field('COMPRESSION RECOVERY', kind_real, 'w_c of Eq. 16: fraction of the '// &
                    'stiffness lost by cracking that '// &
                    'recovers in compression', &
                    default='1', lowest=0.0_rk, &
                    highest=1.0_rk)])
    call describe_table(spec, damage_column('d_t'), &
                        field('abscissa', kind_real, 'cracking strain eps - sigma/E, or '// &
                              'opening [m] with DISPLACEMENT', is_required=.true., lowest=0.0_rk))
  end subroutine describe_cracking

  subroutine read_cracking(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_concrete(model, i)
    select type (one => model%material_requests(i)%item)
    type is (concrete_material)
      call read_table(this, one%given%constants%tension_damage)
      one%given%constants%tension_damage_type = this%word('TYPE')
      one%given%constants%compression_recovery = this%real('COMPRESSION RECOVERY')
      call claim_card(this, model, one%given%tension_damage, faults)
    end select
  end subroutine read_cracking
end module keywords_concrete_tables
