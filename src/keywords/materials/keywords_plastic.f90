!> *PLASTIC: metal plasticity beside *ELASTIC.
module keywords_plastic
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_handler, only: keyword_list, pass_definitions
  use keyword_spec, only: field, keyword, kind_choice, kind_real
  use keywords_material, only: claim_card
  use keywords_other, only: add_refused_parameter
  use kinds, only: rk
  use material_metal, only: make_metal_law
  use model_draft, only: draft, find_material_request, has_request, material_request, origin
  use write_text, only: as_text
  use yield_curve, only: hardening_curve
  implicit none
  private
  public :: add_plastic

  character, parameter :: nl = new_line('a')

  !> The table; the elastic constants may follow in the deck.
  type, extends(material_request) :: metal_request
    type(origin) :: spot
    type(hardening_curve) :: curve
    logical :: is_right = .true. !< the table has no fault
  contains
    procedure :: complete
  end type metal_request

contains

  !> Adds the keyword to the list of all keywords.
  subroutine add_plastic(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_plastic, read_plastic, pass_definitions)
  end subroutine add_plastic

  subroutine describe_plastic(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'PLASTIC'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Metal plasticity beside *ELASTIC: the yield surface of von Mises with '// &
                   'isotropic hardening. The yield stress is linear between the rows and '// &
                   'constant past the last one. The first row has no plastic strain (theory 17).'
    spec%example = '*ELASTIC'//nl//'210e9, 0.3'//nl//'*PLASTIC'//nl//'235e6, 0.'//nl// &
                   '400e6, 0.1'
    spec%fewest_lines = 1
    spec%temperature_column = 3
    spec%no_further = 'the table does not depend on temperature'
    allocate (spec%parameters, source=[ &
              field('HARDENING', kind_choice, 'how the yield surface grows', &
                    default='ISOTROPIC', choices='ISOTROPIC')])
    call add_refused_parameter(spec, 'RATE', 'one *PLASTIC without RATE: the yield stress does '// &
                               'not depend on the rate')
    allocate (spec%columns, source=[ &
              field('yield stress', kind_real, 'in uniaxial tension', 'Pa', is_required=.true., &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('plastic strain', kind_real, 'equivalent plastic strain', default='0', &
                    lowest=0.0_rk)])
  end subroutine describe_plastic

  subroutine read_plastic(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    call find_material_request(model, metal_request(), i)
    select type (now => model%material_requests(i)%item)
    type is (metal_request)
      call claim_card(this, model, now%spot, faults)
      call read_curve(this, faults, now%curve, now%is_right)
    end select
  end subroutine read_plastic

  !> The rows; their strains must ascend from zero.
  subroutine read_curve(this, faults, curve, is_right)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    type(hardening_curve), intent(out) :: curve
    logical, intent(out) :: is_right
    integer :: row
    is_right = .true.
    allocate (curve%stress(this%num_lines), curve%strain(this%num_lines))
    do row = 1, this%num_lines
      curve%stress(row) = this%real_at(row, 1)
      curve%strain(row) = this%real_at(row, 2)
      if (row == 1) then
        if (.not. curve%strain(1) > 0.0_rk) cycle
        call this%fault_at(faults, 1, 2, 'the first row has a plastic strain of '// &
                           as_text(curve%strain(1)), '0, where yielding begins')
      else
        if (curve%strain(row) > curve%strain(row - 1)) cycle
        call this%fault_at(faults, row, 2, 'the plastic strain does not ascend', &
                           'more than '//as_text(curve%strain(row - 1)))
      end if
      is_right = .false.
    end do
  end subroutine read_curve

  !> Makes the law from both cards of the material.
  subroutine complete(self, model, faults)
    class(metal_request), intent(inout) :: self
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%problem%materials(self%material), &
               this => model%cards(self%spot%card))
      if (.not. now%young > 0.0_rk) then
        call this%fault(faults, "material '"//now%name//"' has no *ELASTIC", &
                        'this keyword beside *PLASTIC')
      else if (has_request(model, self%material)) then
        call this%fault(faults, "material '"//now%name//"' has a second inelastic law", &
                        'one of them')
      else if (self%is_right) then
        call check_slopes(this, self%curve, now%young/(2.0_rk*(1.0_rk + now%poisson)), faults)
        deallocate (now%law)
        allocate (now%law, source=make_metal_law(now%young, now%poisson, self%curve))
      end if
    end associate
  end subroutine complete

  !> A yield stress that falls faster than -3 G has no unique flow; one that falls at all localises
  !> in one row of elements.
  subroutine check_slopes(this, curve, shear, faults)
    type(card), intent(in) :: this
    type(hardening_curve), intent(in) :: curve
    real(rk), intent(in) :: shear !< modulus [Pa]
    type(diagnostic_list), intent(inout) :: faults
    integer :: row
    logical :: falls
    falls = .false.
    do row = 1, size(curve%stress) - 1
      falls = falls .or. curve%slope_of(row) < 0.0_rk
      if (curve%slope_of(row) > -3.0_rk*shear) cycle
      call this%fault_at(faults, row + 1, 1, 'the yield stress falls by '// &
                         as_text(-curve%slope_of(row))//' for a unit of plastic strain', &
                         'less than 3 G, '//as_text(3.0_rk*shear))
      return
    end do
    if (falls) then
      call this%warn(faults, 'the yield stress falls: the strain gathers in one row of '// &
                     'elements, and results depend on their size', 'a yield stress that rises')
    end if
  end subroutine check_slopes
end module keywords_plastic
