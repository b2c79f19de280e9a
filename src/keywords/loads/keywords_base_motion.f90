!> *BASE MOTION.
module keywords_base_motion
  use applied_load, only: load
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use enter_load, only: put_load
  use keyword_spec, only: keyword, field, kind_choice, kind_integer, kind_real, kind_word
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use model_draft, only: draft
  use named_things, only: find_amplitude
  use record_units, only: find_further_scale
  use write_text, only: as_text
  implicit none
  private
  public :: describe_base_motion, read_base_motion

contains

  subroutine describe_base_motion(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'BASE MOTION'
    spec%family = 'load'
    spec%place = 'step'
    spec%meaning = 'Acceleration of the base, the same everywhere. Results are relative to the '// &
                   'base; the added mass of the water is included. The motion continues in '// &
                   'later dynamic steps: a history over step time keeps its last value. In '// &
                   'a *STATIC step it does not act. A second '// &
                   'motion in one direction adds in the same step, and replaces in a later one.'
    spec%example = '*BASE MOTION, DOF=1, AMPLITUDE=QUAKE'
    spec%most_lines = 0
    allocate (spec%parameters, source=[ &
              field('DOF', kind_integer, 'direction', is_required=.true., &
                    lowest=1.0_rk, highest=3.0_rk), &
              field('AMPLITUDE', kind_word, 'history of the acceleration', is_required=.true.), &
              field('SCALE', kind_real, 'factor that gives the history in m/s2', '', '1'), &
              field('TYPE', kind_choice, 'what the history is', default='ACCELERATION', &
                    choices='ACCELERATION')])
  end subroutine describe_base_motion

  subroutine read_base_motion(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(base_motion) :: shaking
    class(load), allocatable :: item
    real(rk) :: scale
    integer :: history
    call find_amplitude(this, model, faults, history)
    if (history == 0) return
    call find_further_scale(this, trim(model%record_unit(history)), &
                            model%record_factor(history), faults, scale)
    if (.not. abs(scale) > 0.0_rk) then
      call this%warn(faults, 'the keyword has no effect: SCALE is zero', 'a factor other than 0')
    end if
    shaking%kind = 'base motion'
    shaking%dof = this%integer('DOF')
    allocate (item, source=shaking)
    call put_load(model, item, 'base motion '//as_text(this%integer('DOF')), 'BASE MOTION', &
                  as_text(this%integer('DOF')), '', scale, history)
    where ([1, 2, 3] == shaking%dof) model%is_shaken = .false. ! *BOUNDARY does not end this motion
  end subroutine read_base_motion
end module keywords_base_motion
