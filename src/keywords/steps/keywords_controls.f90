!> *CONTROLS and *DAMPING of a step.
module keywords_controls
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use equilibrium_catalogue, only: names_of_joint_solvers
  use keyword_spec, only: keyword, field, kind_choice, kind_flag, kind_integer, kind_real
  use keywords_material, only: base_of_damping
  use keywords_other, only: add_idle_parameters
  use kinds, only: rk
  use model_draft, only: draft
  use step_plan, only: step_damping
  implicit none
  private
  public :: describe_controls, describe_step_damping, read_controls, read_step_damping

  !> Of Abaqus and CalculiX; data lines go with PARAMETERS.
  character(10), parameter :: idle(3) = ['PARAMETERS', 'ANALYSIS  ', 'RESET     ']

contains

  subroutine describe_controls(spec)
    type(keyword), intent(out) :: spec
    character(:), allocatable :: joint_solvers
    joint_solvers = 'AUTO | '//names_of_joint_solvers()
    spec%name = 'CONTROLS'
    spec%family = 'step'
    spec%place = 'step'
    spec%meaning = 'Tolerances of the iteration, from this step on. With ACCURACY increments '// &
                   'are powers of two of the first increment, from an eighth of it to four '// &
                   'times it, but no longer than the samples of the motion, unless *DYNAMIC '// &
                   'names the smallest and the largest.'
    spec%example = '*CONTROLS, RESIDUAL=1e-8, ITERATIONS=25'//new_line('a')// &
                   '*CONTROLS, ACCURACY=0.02'
    allocate (spec%parameters, source=[ &
              field('RESIDUAL', kind_real, 'residual over the reference force', '', &
                    '1e-6', lowest=0.0_rk, highest=1.0_rk, excludes_lowest=.true.), &
              field('INCREMENT', kind_real, 'last correction over the increment', '', '1e-6', &
                    lowest=0.0_rk, highest=1.0_rk, excludes_lowest=.true.), &
              field('ITERATIONS', kind_integer, 'most iterations of an attempt before the '// &
                    'increment is cut; five times as many with a constant matrix of the '// &
                    'solids (TANGENT); those on joints go on while they gain, and start '// &
                    'again after sweeps over the points', &
                    default='15', lowest=1.0_rk, highest=1.0e4_rk), &
              field('ACCURACY', kind_real, 'error of displacements in time, over the largest '// &
                    'displacement: the increments of *DYNAMIC follow its estimate; 0: they do '// &
                    'not', default='0', &
                    lowest=0.0_rk, highest=0.5_rk), &
              field('ERROR ESTIMATE', kind_choice, 'errors that the run estimates for its '// &
                    'summary (docs/accuracy.md)', default='ON', choices='ON | OFF'), &
              field('JOINT SOLVER', kind_choice, 'iterate on the joints alone (condensed) or '// &
                    'on everything (full Newton, which factors the matrix in each iteration '// &
                    'and takes many times as long)', default='AUTO', &
                    choices=joint_solvers), &
              field('PRECISION', kind_choice, 'of the factor of the matrix that is kept: with '// &
                    'SINGLE it takes half the memory, and solves are refined in double '// &
                    'precision until the residual is admissible; with MIXED it takes half '// &
                    'as much memory again, for a copy in single precision, which solves for '// &
                    'what changes from increment to increment of *DYNAMIC while its errors '// &
                    'are admissible; neither with JOINT SOLVER=FULL nor with '// &
                    'TANGENT=CONSISTENT, MIXED not with *DAMPING, MODAL', &
                    default='DOUBLE', choices='DOUBLE | SINGLE | MIXED'), &
              field('JOINT FORCES', kind_choice, 'weight of joint forces in time: the impulse '// &
                    'of the end of the step, as the bulk, or end of the step', &
                    default='IMPLICIT', choices='IMPLICIT | HHT | END'), &
              field('TANGENT', kind_choice, 'tangent of inelastic solids: consistent '// &
                    '(unsymmetric, factored in each iteration, which takes many times as '// &
                    'long), secant, or elastic with many cheap iterations', default='AUTO', &
                    choices='AUTO | CONSISTENT | SECANT | ELASTIC')])
    call add_idle_parameters(spec, idle)
  end subroutine describe_controls

  subroutine read_controls(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (size(this%parameters) == 0) then
      call this%warn(faults, 'the keyword has no effect: it has no parameter', &
                     'at least one parameter')
    end if
    if (this%num_lines > 0 .and. .not. this%has('PARAMETERS')) then
      call this%fault_at(faults, 1, 0, 'found a data line', 'parameters of the keyword only')
    end if
    associate (controls => model%now%controls)
      if (this%has('RESIDUAL')) controls%residual_tolerance = this%real('RESIDUAL')
      if (this%has('INCREMENT')) controls%increment_tolerance = this%real('INCREMENT')
      if (this%has('ITERATIONS')) controls%max_iterations = this%integer('ITERATIONS')
      if (this%has('ACCURACY')) controls%accuracy = this%real('ACCURACY')
      if (this%has('ERROR ESTIMATE')) then
        controls%estimates_errors = this%word('ERROR ESTIMATE') == 'ON'
      end if
      if (this%has('JOINT SOLVER')) controls%joint_solver = this%word('JOINT SOLVER')
      if (this%has('PRECISION')) controls%precision = this%word('PRECISION')
      if (this%has('JOINT FORCES')) controls%joint_forces = this%word('JOINT FORCES')
      if (this%has('TANGENT')) controls%tangent = this%word('TANGENT')
    end associate
  end subroutine read_controls

  subroutine describe_step_damping(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'DAMPING'
    spec%family = 'step'
    spec%place = 'step'
    spec%meaning = 'Damping of the whole model, in addition to that of the materials, from '// &
                   'this step on: Rayleigh damping by one ratio at two frequencies, or with '// &
                   'MODAL one ratio for each of the lowest modes of the undamaged model with '// &
                   'closed joints and for nothing else. Both kinds may act together; RATIO=0 '// &
                   'ends one. Where *BOUNDARY moves the supports, the part of Rayleigh damping '// &
                   'that is proportional to the mass damps absolute velocities, those of a '// &
                   'rigid motion too; with *BASE MOTION velocities are relative to the base.'
    spec%example = '*DAMPING, RATIO=0.05, F1=2., F2=10.'//new_line('a')// &
                   '*DAMPING, MODAL, RATIO=0.05, MODES=20'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('RATIO', kind_real, 'part of critical damping', is_required=.true., &
                    lowest=0.0_rk, highest=1.0_rk, excludes_highest=.true.), &
              field('F1', kind_real, 'lower frequency of Rayleigh damping', 'Hz', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              field('F2', kind_real, 'upper frequency of Rayleigh damping', 'Hz', &
                    lowest=0.0_rk, excludes_lowest=.true.), &
              base_of_damping(), &
              field('MODAL', kind_flag, 'the ratio is that of modes'), &
              field('MODES', kind_integer, 'number of damped modes; those with the frequency '// &
                    'of the last one are damped, too', lowest=1.0_rk), &
              field('HIGHEST', kind_real, 'highest frequency of damped modes, in place of '// &
                    'MODES', 'Hz', lowest=0.0_rk, excludes_lowest=.true.)])
  end subroutine describe_step_damping

  subroutine read_step_damping(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (this%has('MODAL')) then
      call read_modal_damping(this, model%now%damping, faults)
    else
      call read_rayleigh_damping(this, model%now%damping, faults)
    end if
  end subroutine read_step_damping

  !> The ratio at two frequencies.
  subroutine read_rayleigh_damping(this, damping, faults)
    type(card), intent(in) :: this
    type(step_damping), intent(inout) :: damping
    type(diagnostic_list), intent(inout) :: faults
    call refuse_parameters(this, [character(7) :: 'MODES', 'HIGHEST'], 'with MODAL only', faults)
    if (abs(this%real('RATIO')) <= 0.0_rk .and. .not. (this%has('F1') .or. this%has('F2'))) then
      damping%ratio = 0.0_rk
      return
    end if
    if (.not. (this%has('F1') .and. this%has('F2'))) then
      call this%fault(faults, 'parameter '//trim(merge('F2', 'F1', this%has('F1')))// &
                      ' is missing', 'F1 and F2 [Hz] of Rayleigh damping, or MODAL')
      return
    end if
    damping%ratio = this%real('RATIO')
    damping%f1 = this%real('F1')
    damping%f2 = this%real('F2')
    damping%is_current = this%word('BASE') == 'CURRENT'
    if (damping%f2 > damping%f1) return
    call this%fault_parameter(faults, 'F2', "found '"//this%text('F2')//"'", &
                              'a frequency above F1 [Hz]')
  end subroutine read_rayleigh_damping

  !> The ratio of modes.
  subroutine read_modal_damping(this, damping, faults)
    type(card), intent(in) :: this
    type(step_damping), intent(inout) :: damping
    type(diagnostic_list), intent(inout) :: faults
    call refuse_parameters(this, [character(4) :: 'F1', 'F2', 'BASE'], 'without MODAL only', faults)
    damping%modal_ratio = this%real('RATIO')
    damping%num_modes = 0
    damping%highest = 0.0_rk
    if (this%has('MODES')) damping%num_modes = this%integer('MODES')
    if (this%has('HIGHEST')) damping%highest = this%real('HIGHEST')
    if (this%has('MODES') .neqv. this%has('HIGHEST')) return
    if (.not. damping%modal_ratio > 0.0_rk .and. .not. this%has('MODES')) return
    call this%fault(faults, 'MODAL has '//trim(merge('both MODES and HIGHEST     ', &
                                                     'neither MODES nor HIGHEST  ', &
                                                     this%has('MODES'))), &
                    'MODES=number of modes, or HIGHEST=frequency [Hz]')
  end subroutine read_modal_damping

  !> Errors for parameters of the other kind of damping.
  subroutine refuse_parameters(this, names, where, faults)
    type(card), intent(in) :: this
    character(*), intent(in) :: names(:), where
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(names)
      if (.not. this%has(trim(names(i)))) cycle
      call this%fault_parameter(faults, trim(names(i)), trim(names(i))//' has no meaning here', &
                                trim(names(i))//' '//where)
    end do
  end subroutine refuse_parameters
end module keywords_controls
