!> *ELASTIC.
module keywords_elastic
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_handler, only: keyword_list, pass_definitions
  use keyword_spec, only: keyword, field, kind_choice, kind_real
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use model_draft, only: draft
  implicit none
  private
  public :: add_elastic

  character, parameter :: nl = new_line('a')

contains

  subroutine add_elastic(list)
    type(keyword_list), intent(inout) :: list
    call list%add(describe_elastic, read_elastic, pass_definitions)
  end subroutine add_elastic

  subroutine describe_elastic(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'ELASTIC'
    spec%family = 'material'
    spec%place = 'material'
    spec%meaning = 'Linear elasticity, the same in all directions.'
    spec%example = '*ELASTIC'//nl//'22e9, 0.167'
    spec%fewest_lines = 1
    spec%most_lines = 1
    spec%temperature_column = 3
    allocate (spec%parameters, source=[ &
              field('TYPE', kind_choice, 'kind of elasticity', default='ISOTROPIC', &
                    choices='ISOTROPIC | ISO')])
    allocate (spec%columns, source=[ &
              field('E', kind_real, 'Young''s modulus', 'Pa', is_required=.true., &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('nu', kind_real, 'Poisson''s ratio', default='0', lowest=-1.0_rk, &
                    highest=0.5_rk, excludes_lowest=.true., excludes_highest=.true.)])
  end subroutine describe_elastic

  subroutine read_elastic(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%problem%materials(model%num_materials))
      if (allocated(now%law)) then
        call this%fault(faults, "material '"//now%name//"' already has an *ELASTIC", 'one only')
        return
      end if
      now%young = this%real_at(1, 1)
      now%poisson = this%real_at(1, 2)
      allocate (now%law, source=elastic_law(young=now%young, poisson=now%poisson))
    end associate
  end subroutine read_elastic
end module keywords_elastic
