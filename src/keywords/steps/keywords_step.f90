!> *STEP, *END STEP and the procedures *STATIC, *DYNAMIC, *FREQUENCY.
module keywords_step
  use check_accuracy, only: set_accuracy_limits
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list, place
  use finish_step, only: close_step, open_step
  use integrator_catalogue, only: list_procedures, list_schemes, procedure_named
  use keyword_spec, only: keyword, field, kind_choice, kind_flag, kind_integer, kind_real, &
                          kind_word
  use keywords_other, only: add_idle_parameters, add_refused_parameter
  use kinds, only: rk
  use moved_supports, only: close_accelerations
  use model_draft, only: draft
  use other_step_words, only: add_words_of_dynamic, add_words_of_static, add_words_of_step, &
                              check_application, check_step_amplitude, has_faulty_procedure
  use step_plan, only: step_procedure
  use write_text, only: as_text
  implicit none
  private
  public :: describe_step, describe_end_step, describe_static, describe_dynamic, describe_frequency
  public :: read_step, read_end_step, read_static, read_dynamic, read_frequency

  character, parameter :: nl = new_line('a')
  character(*), parameter :: reduced = 'REDUCED' !< scheme
  !> Of a dynamic step, in any unit. Matrices hold the density over its square, which is infinite
  !> below 1e-154.
  real(rk), parameter :: least_increment = 1.0e-60_rk

contains

  subroutine describe_step(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'STEP'
    spec%family = 'step'
    spec%place = 'model'
    spec%meaning = 'Opens a step. Loads, supports and requests for output stay from step to '// &
                   'step until changed; envelopes are recorded in the steps that request '// &
                   'them. Lines of text may follow.'
    spec%example = '*STEP, NAME=GRAVITY'//nl//'*STATIC'//nl//'..'//nl//'*END STEP'
    spec%checks_own_data = .true.
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the step', default='STEP-<number>'), &
              field('INC', kind_integer, 'largest number of increments', default='100000'), &
              field('NLGEOM', kind_choice, 'geometric nonlinearity: strains and rotations are '// &
                    'small; YES needs --small-strain', choices='NO | YES', may_be_bare=.true., &
                    instead='strains and rotations are small'), &
              field('PERTURBATION', kind_flag, 'of Abaqus: a step *FREQUENCY')])
    spec%parameters(2)%lowest = 1
    call add_words_of_step(spec)
  end subroutine describe_step

  subroutine read_step(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (model%is_in_step) then
      call this%fault(faults, 'a step inside a step', '*END STEP before it', &
                      first=model%cards(model%step_origin%card)%place())
      return
    end if
    call open_step(model)
    model%holds_motion = model%active_loads%holds('BASE MOTION')
    if (this%has('NAME')) model%now%name = this%word('NAME')
    model%now%max_increments = this%integer('INC')
    if (this%has('NLGEOM') .and. this%word('NLGEOM') /= 'NO') then
      call judge_large_strain(this, model, faults)
    end if
  end subroutine read_step

  !> NLGEOM=YES: large strains are not available; the user may ask for small strains.
  subroutine judge_large_strain(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (model%options%takes_small_strain) then
      call this%warn(faults, 'strains and rotations are small (--small-strain): NLGEOM=YES has '// &
                     'no effect')
    else
      call this%fault_parameter(faults, 'NLGEOM', 'large strains and rotations are not available', &
                                'NLGEOM=NO, or the option --small-strain if they are small')
    end if
  end subroutine judge_large_strain

  subroutine describe_end_step(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'END STEP'
    spec%family = 'step'
    spec%place = 'step'
    spec%meaning = 'Closes a step.'
    spec%example = '*END STEP'
    spec%most_lines = 0
  end subroutine describe_end_step

  subroutine read_end_step(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (model%now%procedure%name == '') then
      if (.not. has_faulty_procedure(model)) call this%fault( &
        faults, 'the step has no procedure', list_procedures()//' in the step')
    end if
    call check_base_motion(model, faults)
    call check_perturbation(model, faults)
    call check_step_amplitude(model, faults)
    call close_accelerations(model, faults)
    call check_joint_forces(model, faults)
    call set_accuracy_limits(model, faults)
    if (model%holds_motion .and. model%now%procedure%has_inertia) then
      call model%cards(model%step_origin%card)%warn( &
        faults, 'the base motion of an earlier step continues at its last value')
    end if
    call close_step(model)
  end subroutine read_end_step

  !> Linear perturbations about a state are *FREQUENCY alone.
  subroutine check_perturbation(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (opened => model%cards(model%step_origin%card), name => model%now%procedure%name)
      if (.not. opened%has('PERTURBATION') .or. name == 'FREQUENCY' .or. name == '') return
      call opened%fault_parameter(faults, 'PERTURBATION', 'PERTURBATION goes with *FREQUENCY', &
                                  'a step without PERTURBATION for *'//trim(name))
    end associate
  end subroutine check_perturbation

  !> Only a dynamic step has the inertia that the motion of the base acts on.
  subroutine check_base_motion(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (model%now%procedure%has_inertia .or. model%now%procedure%name == '') return
    do i = model%step_origin%card, model%current
      if (.not. is_keyword(model%cards(i), 'BASE MOTION')) cycle
      call model%cards(i)%fault(faults, 'has no effect in a step *'// &
                                trim(model%now%procedure%name), 'a step *DYNAMIC')
    end do
  end subroutine check_base_motion

  !> Warns at the end of the step: *CONTROLS may precede the procedure that names the scheme.
  subroutine check_joint_forces(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (model%now%procedure%uses_alpha .or. .not. model%now%procedure%has_inertia) return
    do i = model%step_origin%card, model%current
      if (.not. model%cards(i)%has('JOINT FORCES')) cycle
      call model%cards(i)%warn(faults, 'JOINT FORCES has no effect with SCHEME='// &
                               trim(model%now%procedure%scheme))
    end do
  end subroutine check_joint_forces

  subroutine describe_static(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'STATIC'
    spec%family = 'step'
    spec%place = 'step'
    spec%meaning = 'Static analysis; loads ramp over the step. The increment is reduced where '// &
                   'the iteration does not converge, and grows after quick convergence. One '// &
                   'that was reduced also grows after some that have converged slowly.'
    spec%example = '*STATIC'//nl//'0.1, 1.'
    spec%most_lines = 1
    allocate (spec%parameters, source=[ &
              field('DIRECT', kind_flag, 'increments of fixed size')])
    call add_refused_parameter(spec, 'RIKS', 'displacements in place of loads (*BOUNDARY, '// &
                               'AMPLITUDE): the step follows its loads, not a path beyond '// &
                               'their peak')
    call add_refused_parameter(spec, 'STABILIZE', '*STATIC without STABILIZE, or a *DYNAMIC '// &
                               'step with damping: a static step has no viscous forces')
    allocate (spec%columns, source=[ &
              field('first increment', kind_real, 'size of the first increment', 's', &
                    'the duration, without DIRECT at most the largest'), &
              field('duration', kind_real, 'duration of the step', 's', '1'), &
              field('smallest', kind_real, 'smallest increment', 's', &
                    '1e-5 of the duration, at most 1e-3 of the first increment'), &
              field('largest', kind_real, 'largest increment', 's', 'the duration')])
    spec%columns%lowest = 0.0_rk ! 0 is the default, as in CalculiX
    call add_words_of_static(spec)
  end subroutine describe_static

  subroutine want_positive(spec)
    type(keyword), intent(inout) :: spec
    spec%columns%lowest = 0.0_rk
    spec%columns%excludes_lowest = .true.
  end subroutine want_positive

  subroutine read_static(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call begin_procedure(this, 'STATIC', model, faults)
    model%now%duration = 1.0_rk
    if (is_given(this, 2)) model%now%duration = this%real_at(1, 2)
    model%now%first_increment = model%now%duration
    if (is_given(this, 4) .and. .not. model%now%is_direct) then
      model%now%first_increment = min(model%now%duration, this%real_at(1, 4))
    end if
    if (is_given(this, 1)) model%now%first_increment = this%real_at(1, 1)
    model%now%largest_increment = model%now%duration
    call read_limits(this, model, faults)
  end subroutine read_static

  subroutine describe_dynamic(spec)
    type(keyword), intent(out) :: spec
    character(:), allocatable :: schemes, first
    spec%name = 'DYNAMIC'
    spec%family = 'step'
    spec%place = 'step'
    spec%meaning = 'Dynamic analysis; loads act with their full value from the start of the '// &
                   'step. The first dynamic step starts from the last static state, with the '// &
                   'acceleration that balances its forces. HHT is the method of Hilber, '// &
                   'Hughes & Taylor; with ALPHA=0 it is Newmark''s trapezoidal rule, which '// &
                   'can feed energy into stiff joints.'
    spec%example = '*DYNAMIC, ALPHA=-0.05'//nl//'0.01, 10.'
    spec%fewest_lines = 1
    spec%most_lines = 1
    schemes = list_schemes('DYNAMIC')
    first = schemes(:index(schemes//' ', ' ') - 1)
    allocate (spec%parameters, source=[ &
              field('DIRECT', kind_flag, 'increments of fixed size'), &
              field('SCHEME', kind_choice, 'method of time integration', &
                    default=first, choices=schemes), &
              field('ALPHA', kind_real, 'numerical damping of HHT', default='-0.05', &
                    lowest=-1.0_rk/3.0_rk, highest=0.0_rk), &
              field('REDUCED', kind_flag, 'HHT with a reduced model of linear elastic solids '// &
                    'with joints, the same as SCHEME=REDUCED: modes, and the static response '// &
                    'of the rest'), &
              field('ACCURACY', kind_real, 'with REDUCED: error of the openings of joints '// &
                    'that the modes may leave, over the largest opening', &
                    default='0.02 with REDUCED', &
                    lowest=0.0_rk, highest=0.5_rk, excludes_lowest=.true.), &
              field('MODES', kind_integer, 'with REDUCED: number of modes, in place of as many '// &
                    'as ACCURACY needs', lowest=1.0_rk)])
    call add_refused_parameter(spec, 'EXPLICIT', '*DYNAMIC without EXPLICIT, with an increment '// &
                               'of a tenth of the shortest period of interest')
    allocate (spec%columns, source=[ &
              field('increment', kind_real, 'size of an increment', 's', is_required=.true.), &
              field('duration', kind_real, 'duration of the step', 's', is_required=.true.), &
              field('smallest', kind_real, 'smallest increment after reductions', 's', &
                    '1e-3 of the increment'), &
              field('largest', kind_real, 'largest increment', 's', 'the increment')])
    call want_positive(spec)
    spec%columns([1, 3])%lowest = least_increment
    call add_words_of_dynamic(spec)
  end subroutine describe_dynamic

  subroutine read_dynamic(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call begin_procedure(this, 'DYNAMIC', model, faults)
    call check_application(this, faults)
    call choose_scheme(this, model, faults)
    model%now%alpha = this%real('ALPHA')
    call read_reduction(this, model, faults)
    model%now%first_increment = this%real_at(1, 1)
    model%now%duration = this%real_at(1, 2)
    model%now%largest_increment = model%now%first_increment
    call read_limits(this, model, faults)
  end subroutine read_dynamic

  !> The scheme that the card names. An unknown one has been reported as a wrong choice.
  subroutine choose_scheme(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(step_procedure) :: found
    found = procedure_named('DYNAMIC', this%word('SCHEME'))
    if (this%has('REDUCED')) found = procedure_named('DYNAMIC', reduced)
    if (found%name == '') return
    model%now%procedure = found
    if (found%uses_alpha .or. .not. this%has('ALPHA')) return
    call this%fault_parameter(faults, 'ALPHA', 'has no effect with SCHEME='//trim(found%scheme), &
                              'ALPHA with SCHEME=HHT only')
  end subroutine choose_scheme

  !> What the card says of a reduced model.
  subroutine read_reduction(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (this%has('ACCURACY')) model%now%reduced%accuracy = this%real('ACCURACY')
    if (this%has('MODES')) model%now%reduced%num_modes = this%integer('MODES')
    if (model%now%procedure%scheme == reduced) return
    if (this%has('ACCURACY')) then
      call this%fault_parameter(faults, 'ACCURACY', 'has no effect', 'ACCURACY with REDUCED only')
    end if
    if (this%has('MODES')) then
      call this%fault_parameter(faults, 'MODES', 'has no effect', 'MODES with REDUCED only')
    end if
  end subroutine read_reduction

  subroutine describe_frequency(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'FREQUENCY'
    spec%family = 'step'
    spec%place = 'step'
    spec%meaning = 'Lowest frequencies and modes, with the added mass of the water, closed '// &
                   'joints and undamaged elements.'
    spec%example = '*FREQUENCY'//nl//'10'
    spec%fewest_lines = 1
    spec%most_lines = 1
    allocate (spec%columns, source=[ &
              field('modes', kind_integer, 'number of modes', is_required=.true., &
                    lowest=1.0_rk), &
              field('lower bound', kind_real, 'of other programs, no effect', 'Hz'), &
              field('upper bound', kind_real, 'of other programs, no effect', 'Hz'), &
              field('shift', kind_real, 'of other programs, no effect'), &
              field('block size', kind_real, 'of other programs, no effect'), &
              field('block steps', kind_real, 'of other programs, no effect')])
    call add_idle_parameters(spec, [character(17) :: 'SOLVER', 'STORAGE', 'EIGENSOLVER', 'SIM', &
                                    'NORMALIZATION', 'ACOUSTIC COUPLING'])
  end subroutine describe_frequency

  subroutine read_frequency(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call begin_procedure(this, 'FREQUENCY', model, faults)
    model%now%num_modes = this%integer_at(1, 1)
    if (this%num_fields(1) > 1) then
      call this%warn_at(faults, 1, 2, 'bounds and further numbers have no effect: the lowest '// &
                        'modes are computed')
    end if
    model%now%duration = 0.0_rk
  end subroutine read_frequency

  !> A step has one procedure.
  subroutine begin_procedure(this, procedure, model, faults)
    type(card), intent(in) :: this
    character(*), intent(in) :: procedure
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(place) :: spot
    if (model%now%procedure%name /= '') then
      call this%fault(faults, &
                      'the step already has a procedure: *'//trim(model%now%procedure%name), &
                      'one procedure in a step')
    end if
    model%now%procedure = procedure_named(procedure)
    spot = this%place()
    model%now%line = spot%line
    model%current_procedure = model%current
    model%now%is_direct = this%has('DIRECT')
  end subroutine begin_procedure

  !> True if the data line has a value in the field.
  pure logical function is_given(this, field)
    type(card), intent(in) :: this
    integer, intent(in) :: field
    is_given = .false.
    if (this%num_lines > 0) is_given = this%real_at(1, field) > 0.0_rk
  end function is_given

  !> Smallest and largest increment, which DIRECT does without, and whether all sizes agree.
  subroutine read_limits(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (now => model%now)
      now%smallest_increment = now%default_smallest()
      if (.not. now%is_direct) then
        if (is_given(this, 3)) now%smallest_increment = this%real_at(1, 3)
        if (is_given(this, 4)) now%largest_increment = this%real_at(1, 4)
      end if
      if (now%first_increment > now%duration) then
        call this%fault_at(faults, 1, 1, 'the increment is longer than the step', &
                           'at most the duration, '//as_text(now%duration)//' s')
      else if (now%smallest_increment > now%first_increment) then
        call this%fault_at(faults, 1, 3, 'the smallest increment is larger than the first', &
                           'at most '//as_text(now%first_increment)//' s')
      else if (now%largest_increment < now%first_increment) then
        call this%fault_at(faults, 1, 4, 'the largest increment is smaller than the first', &
                           'at least '//as_text(now%first_increment)//' s')
      else if (now%is_direct .or. now%largest_increment <= now%first_increment) then
        call compare_with_inc(this, model, faults)
      end if
    end associate
  end subroutine read_limits

  !> Warns if increments that cannot grow do not fit into INC.
  subroutine compare_with_inc(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk), parameter :: round_off = 1.0e-9_rk ! of the quotient, far above its own
    real(rk) :: num_needed
    if (model%now%first_increment <= 0.0_rk) return ! reported
    num_needed = model%now%duration/max(model%now%first_increment, 1.0e-9_rk*model%now%duration)
    if (num_needed <= (1.0_rk + round_off)*model%now%max_increments) return
    num_needed = real(ceiling((1.0_rk - round_off)*num_needed), rk)
    call this%warn(faults, 'the step needs '//as_text(num_needed)//' increments, but *STEP, '// &
                   'INC='// &
                   as_text(model%now%max_increments)//' ends the step earlier')
  end subroutine compare_with_inc
end module keywords_step
