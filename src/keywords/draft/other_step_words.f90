!> Parameters of Abaqus on *STEP, *STATIC and *DYNAMIC whose usual values are what happens here, and
!> procedures of other programs.
module other_step_words
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use integrator_catalogue, only: is_near_procedure
  use keyword_spec, only: field, keyword, kind_choice
  use keywords_other, only: add_idle_parameters
  use keywords_refused, only: is_refused_procedure
  use model_draft, only: draft
  implicit none
  private
  public :: add_words_of_step, add_words_of_static, add_words_of_dynamic
  public :: check_application, check_step_amplitude, has_faulty_procedure

contains

  subroutine add_words_of_step(spec)
    type(keyword), intent(inout) :: spec
    spec%parameters = [spec%parameters, &
                       field('AMPLITUDE', kind_choice, 'of Abaqus: how loads without an '// &
                             'amplitude grow; a *STATIC step has RAMP, a *DYNAMIC step STEP', &
                             choices='RAMP | STEP')]
    call add_idle_parameters(spec, [character(13) :: 'UNSYMM', 'SOLVER', 'EXTRAPOLATION', &
                                    'CONVERT SDI'])
  end subroutine add_words_of_step

  subroutine add_words_of_static(spec)
    type(keyword), intent(inout) :: spec
    call add_idle_parameters(spec, [character(13) :: 'SOLVER', 'ALLSDTOL', 'CONTINUE', 'FACTOR'])
  end subroutine add_words_of_static

  subroutine add_words_of_dynamic(spec)
    type(keyword), intent(inout) :: spec
    spec%parameters = [spec%parameters, &
                       field('APPLICATION', kind_choice, 'of Abaqus: TRANSIENT FIDELITY is '// &
                             'what happens here, the others are refused', &
                             choices='TRANSIENT FIDELITY | MODERATE DISSIPATION | QUASI-STATIC'), &
                       field('TIME INTEGRATOR', kind_choice, 'of Abaqus: HHT-TF is what '// &
                             'happens here, the others are refused', &
                             choices='HHT-TF | HHT-MD | BWE')]
    call add_idle_parameters(spec, [character(20) :: 'SOLVER', 'NOHAF', 'HAFTOL', &
                                    'HALFINC SCALE FACTOR', 'INITIAL', 'NO HAFTOL', 'IMPACT', &
                                    'SINGULAR MASS'])
  end subroutine add_words_of_dynamic

  !> Reports an APPLICATION or a TIME INTEGRATOR with other damping than the method here.
  subroutine check_application(this, faults)
    type(card), intent(in) :: this
    type(diagnostic_list), intent(inout) :: faults
    character(*), parameter :: names(2) = [character(15) :: 'APPLICATION', 'TIME INTEGRATOR']
    integer :: i
    do i = 1, size(names)
      if (.not. this%has(trim(names(i)))) cycle
      select case (this%word(trim(names(i))))
      case ('MODERATE DISSIPATION', 'HHT-MD')
        call this%fault_parameter(faults, trim(names(i)), 'no such numerical damping', &
                                  'ALPHA=-0.3333 for the largest numerical damping')
      case ('QUASI-STATIC', 'BWE')
        call this%fault_parameter(faults, trim(names(i)), 'no implicit Euler method', &
                                  '*STATIC for slow loads')
      case default
        call this%ignore(faults, trim(names(i))//' has no effect here')
      end select
    end do
  end subroutine check_application

  !> Reports *STEP, AMPLITUDE at the end of a step whose loads grow otherwise.
  subroutine check_step_amplitude(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: usual
    associate (opened => model%cards(model%step_origin%card))
      if (.not. opened%has('AMPLITUDE')) return
      usual = 'RAMP'
      if (model%now%procedure%has_inertia) usual = 'STEP'
      if (opened%word('AMPLITUDE') == usual) then
        call opened%ignore(faults, 'AMPLITUDE has no effect here')
      else
        call opened%fault_parameter(faults, 'AMPLITUDE', 'the loads of this step grow by '// &
                                    usual, 'an *AMPLITUDE for the loads')
      end if
    end associate
  end subroutine check_step_amplitude

  !> Whether a card of the step, whose fault is reported, is a procedure: a refused one, or one that
  !> is misspelt.
  logical function has_faulty_procedure(model)
    type(draft), intent(in) :: model
    integer :: i
    has_faulty_procedure = .false.
    do i = model%step_origin%card, model%current
      associate (name => model%cards(i)%keyword)
        if (is_refused_procedure(name) .or. is_near_procedure(name)) has_faulty_procedure = .true.
      end associate
    end do
  end function has_faulty_procedure
end module other_step_words
