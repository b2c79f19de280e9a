!> *CONCRETE DAMAGED PLASTICITY, and parts common to all *CONCRETE keywords.
module keywords_concrete
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use finish_concrete, only: concrete_material
  use keyword_spec, only: keyword, field, kind_choice, kind_real
  use keywords_material, only: claim_card
  use kinds, only: rk
  use model_draft, only: draft, find_material_request
  implicit none
  private
  public :: describe_plasticity, read_plasticity, find_concrete, no_dependencies

  character, parameter :: nl = new_line('a')

  !> Abaqus allows further columns in its tables. This reason refuses them.
  character(*), parameter :: no_dependencies = &
                             'the law depends on no rate, temperature or field variable'

  !> In uniaxial tension the lateral plastic strain is negative for tan psi < 3/2, from (11.7) with
  !> a = 0: -1/2 + tan psi/3 < 0. Above this angle a crack would also open sideways.
  real(rk), parameter :: largest_dilation = 56.3_rk ! [deg], atan(3/2) = 56.31

contains

  subroutine describe_plasticity(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'CONCRETE DAMAGED PLASTICITY'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Concrete that cracks and crushes: yield surface, flow and recovery of the '// &
                   'plastic-damage law of Lubliner, Lee and Fenves (theory 11, paper Eqs '// &
                   '14-25). Needs *ELASTIC, *CONCRETE COMPRESSION HARDENING and *CONCRETE '// &
                   'TENSION STIFFENING in the same material; the two damage tables are '// &
                   'optional. An empty field takes its default.'
    spec%example = '*MATERIAL, NAME=CONCRETE'//nl//'*DENSITY'//nl//'2400.'//nl//'*ELASTIC'//nl// &
                   '25e9, 0.167'//nl//'*CONCRETE DAMAGED PLASTICITY'//nl// &
                   '32.5, 0.1, 1.16, 0.667'//nl//'*CONCRETE COMPRESSION HARDENING'//nl// &
                   '30e6, 0.'//nl//'*CONCRETE TENSION STIFFENING, TYPE=GFI'//nl//'2.5e6, 200.'
    spec%fewest_lines = 1
    spec%most_lines = 1
    spec%no_further = no_dependencies
    spec%temperature_column = 6
    allocate (spec%parameters, source=[ &
              field('RECOVERY', kind_choice, 'fraction of tension in a stress state (r of Eq. '// &
                    '17): the continuous weight of Lee and Fenves, '// &
                    'or the discontinuous switch of the paper; or ENERGY: '// &
                    'a split of the stress that creates no energy', &
                    default='LEE-FENVES', choices='LEE-FENVES | SIGN | ENERGY'), &
              field('REF LENGTH', kind_real, 'of Abaqus, where it turns openings of the damage '// &
                    'into strains; here the length of each element does', 'm', lowest=0.0_rk, &
                    excludes_lowest=.true.)])
    allocate (spec%columns, source=[ &
              field('dilation', kind_real, 'dilation angle psi (Eq. 25); above atan 3/2 a '// &
                    'crack would also open sideways', &
                    'deg', is_required=.true., &
                    lowest=0.0_rk, highest=largest_dilation, excludes_lowest=.true., &
                    excludes_highest=.true.), &
              field('offset', kind_real, 'eccentricity of the flow potential (xi of Eq. 25), '// &
                    'which rounds its apex', &
                    default='0.1', lowest=0.0_rk, excludes_lowest=.true.), &
              field('fb0/fc0', kind_real, 'equibiaxial over uniaxial compressive strength '// &
                    '(alpha of Eq. 19)', default='1.16', lowest=1.0_rk), &
              field('Kc', kind_real, 'tensile over compressive meridian (gamma of Eq. 19)', &
                    default='0.6666666666666667', lowest=0.5_rk, highest=1.0_rk, &
                    excludes_lowest=.true.), &
              field('viscosity', kind_real, 'relaxation time of Duvaut and Lions', 's', '0', &
                    lowest=0.0_rk)])
  end subroutine describe_plasticity

  subroutine read_plasticity(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (this%has('REF LENGTH')) then
      call this%ignore(faults, 'REF LENGTH has no effect: the length of each element turns an '// &
                       'opening into a strain, also for the damage')
    end if
    call find_concrete(model, i)
    select type (one => model%material_requests(i)%item)
    type is (concrete_material)
      associate (now => one%given%constants)
        now%dilation = this%real_at(1, 1)
        now%offset = this%real_at(1, 2)
        now%biaxial_ratio = this%real_at(1, 3)
        now%meridian_ratio = this%real_at(1, 4)
        now%viscosity = this%real_at(1, 5)
        now%recovery = this%word('RECOVERY')
      end associate
      call claim_card(this, model, one%given%plasticity, faults)
    end select
  end subroutine read_plasticity

  !> Position in model%material_requests of the concrete that is being read.
  subroutine find_concrete(model, i)
    type(draft), intent(inout) :: model
    integer, intent(out) :: i
    call find_material_request(model, concrete_material(), i)
    select type (one => model%material_requests(i)%item)
    type is (concrete_material)
      one%given%is_right = one%given%is_right .and. model%is_right
    end select
  end subroutine find_concrete
end module keywords_concrete
