!> *RESTART.
module keywords_restart
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: field, keyword, kind_flag, kind_integer
  use keywords_other, only: add_idle_parameters, add_refused_parameter
  use kinds, only: rk
  use model_draft, only: draft
  implicit none
  private
  public :: describe_restart, read_restart

contains

  subroutine describe_restart(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'RESTART'
    spec%family = 'output'
    spec%place = 'anywhere'
    spec%meaning = 'Writes checkpoints from this step on, or from the next one where it stands '// &
                   'outside a step: after every FREQUENCY-th increment and at the end of a '// &
                   'step. keyway --continue goes on from the last one. Two are kept.'
    spec%example = '*RESTART, WRITE, FREQUENCY=20'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('WRITE', kind_flag, 'writes checkpoints'), &
              field('FREQUENCY', kind_integer, 'every so many increments; 0: none', default='1', &
                    lowest=0.0_rk)])
    allocate (spec%columns(0))
    call add_idle_parameters(spec, ['OVERLAY        ', 'NUMBER INTERVAL', 'TIME MARKS     '])
    call add_refused_parameter(spec, 'READ', 'the same deck without this card, and the option '// &
                               '--continue: a run goes on from its own checkpoint')
    spec%asks_for_output = .true.
  end subroutine describe_restart

  subroutine read_restart(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (.not. this%has('WRITE')) then
      call this%ignore(faults, 'has no effect: there is no WRITE')
      return
    else if (.not. model%is_in_step) then
      model%next_checkpoint_frequency = this%integer('FREQUENCY')
      return
    end if
    model%now%checkpoint_frequency = this%integer('FREQUENCY')
    if (model%now%checkpoint_frequency <= model%now%max_increments) return
    call this%warn(faults, 'FREQUENCY is larger than *STEP, INC: checkpoints are written at '// &
                   'the end of steps only')
  end subroutine read_restart
end module keywords_restart
