!> Worked example of a material law: its keyword *VON MISES, beside *ELASTIC.
module keywords_von_mises
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_handler, only: keyword_list, pass_definitions
  use keyword_spec, only: field, keyword, kind_real
  use keywords_material, only: claim_card
  use kinds, only: rk
  use material_von_mises, only: make_von_mises
  use model_draft, only: draft, find_material_request, material_request, origin
  implicit none
  private
  public :: add_von_mises

  character, parameter :: nl = new_line('a')

  !> What the card says; the elastic constants may follow in the deck.
  type, extends(material_request) :: von_mises_request
    type(origin) :: spot
    real(rk) :: yield = 0.0_rk, hardening = 0.0_rk !< [Pa]
  contains
    procedure :: complete
  end type von_mises_request

contains

  !> Adds the keyword to the list of all keywords.
  subroutine add_von_mises(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_von_mises, read_von_mises, pass_definitions)
  end subroutine add_von_mises

  subroutine describe_von_mises(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'VON MISES'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Plasticity of von Mises with linear isotropic hardening, beside *ELASTIC.'
    spec%example = '*ELASTIC'//nl//'210e9, 0.3'//nl//'*VON MISES'//nl//'235e6, 2e9'
    spec%fewest_lines = 1
    spec%most_lines = 1
    allocate (spec%columns, source=[ &
              field('yield stress', kind_real, 'yield stress in uniaxial tension', 'Pa', &
                    is_required=.true., lowest=0.0_rk, excludes_lowest=.true.), &
              field('hardening', kind_real, 'slope over the equivalent plastic strain', 'Pa', &
                    default='0', lowest=0.0_rk)])
  end subroutine describe_von_mises

  subroutine read_von_mises(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_material_request(model, von_mises_request(), i)
    select type (now => model%material_requests(i)%item)
    type is (von_mises_request)
      call claim_card(this, model, now%spot, faults)
      now%yield = this%real_at(1, 1)
      now%hardening = this%real_at(1, 2)
    end select
  end subroutine read_von_mises

  !> Makes the law from both cards of the material.
  subroutine complete(self, model, faults)
    class(von_mises_request), intent(inout) :: self
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%problem%materials(self%material))
      if (now%young > 0.0_rk) then
        deallocate (now%law)
        allocate (now%law, source=make_von_mises(now%young, now%poisson, self%yield, &
                                                 self%hardening))
      else
        call model%cards(self%spot%card)%fault( &
          faults, "material '"//now%name//"' has no *ELASTIC", 'this keyword beside *VON MISES')
      end if
    end associate
  end subroutine complete
end module keywords_von_mises
