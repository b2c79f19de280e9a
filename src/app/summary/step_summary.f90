!> The steps of a model as text: procedure, stages, temperatures, loads and requests.
module step_summary
  use heat_plan, only: heat_rule
  use kinds, only: rk
  use load_action, only: action_of_load
  use print_kinds, only: kinds_of_prints
  use problem_definition, only: problem
  use step_plan, only: step, step_controls, step_damping, step_load
  use summary_rows, only: clock_name, name_of_base, row, unit
  use text_buffers, only: text_buffer
  use write_text, only: as_text
  implicit none
  private
  public :: summary_of_steps

  character, parameter :: nl = new_line('a')

contains

  !> A section for each step.
  pure function summary_of_steps(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text !< lines with new_line between them, and before the first
    type(text_buffer) :: lines
    integer :: i, j
    do i = 1, size(model%steps)
      associate (now => model%steps(i))
        call lines%add(nl//'Step '//as_text(i)//' '//now%name//nl//procedure_of(now)// &
                       elements_of(model, i)//grouts_of(model, now)//nl// &
                       row('supports', as_text(size(now%fixities))//' degrees of freedom')// &
                       temperatures_of(model, i))
        do j = 1, size(now%loads)
          call lines%add(nl//work_of(model, i, now%loads(j)))
        end do
        call lines%add(requests_of(now))
      end associate
    end do
    text = lines%contents()
  end function summary_of_steps

  !> Elements that come and go at the start of a step.
  pure function elements_of(model, number) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    character(:), allocatable :: text
    logical, allocatable :: was_absent(:)
    text = ''
    if (.not. model%stages%changes_elements(number)) return
    associate (is_absent => model%stages%is_absent)
      allocate (was_absent(size(is_absent, 1)), source=.false.)
      if (number > 1) was_absent = is_absent(:, number - 1)
      text = nl//row('model change', as_text(count(was_absent .and. .not. is_absent(:, number)))// &
                     ' elements added, '// &
                     as_text(count(is_absent(:, number) .and. .not. was_absent))// &
                     ' removed, '//as_text(count(.not. is_absent(:, number)))//' in the step')
    end associate
  end function elements_of

  !> Joints that are grouted in a step.
  pure function grouts_of(model, now) result(text)
    type(problem), intent(in) :: model
    type(step), intent(in) :: now
    character(:), allocatable :: text
    integer :: i
    text = ''
    if (.not. allocated(now%grouts)) return
    do i = 1, size(now%grouts)
      text = text//nl//row('grout', model%joints(now%grouts(i)%joint)%name)
      if (now%grouts(i)%pressure > 0.0_rk) then
        text = text//', pressure '//as_text(now%grouts(i)%pressure)//unit(model, ' Pa')
      end if
    end do
  end function grouts_of

  !> Temperatures that act in a step, also those of earlier steps that go on.
  pure function temperatures_of(model, number) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    character(:), allocatable :: text
    integer :: i
    text = ''
    associate (now => model%steps(number))
      if (now%restores_temperature) text = nl//row('temperature', 'nodes without a row return '// &
                                                   'to their initial temperature')
      if (.not. allocated(now%heats)) return
      do i = 1, size(now%heats)
        text = text//nl//row('temperature', heat_of(model, number, now%heats(i)))
      end do
    end associate
  end function temperatures_of

  !> '120 nodes: -5 to 3 at the end of the step'.
  pure function heat_of(model, number, rule) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(heat_rule), intent(in) :: rule
    character(:), allocatable :: text
    text = as_text(size(rule%nodes))//' nodes: '//as_text(minval(rule%value))
    if (maxval(rule%value) > minval(rule%value)) text = text//' to '//as_text(maxval(rule%value))
    if (rule%amplitude > 0) then
      text = text//' times amplitude '//model%amplitudes(rule%amplitude)%name
    else if (size(rule%time) > 0) then
      text = text//', table from '//as_text(rule%time(1))//' to '// &
             as_text(rule%time(size(rule%time)))//' s of the '//clock_name(rule%uses_total_time)
    else
      text = text//' at the end of the step'
    end if
    if (rule%step < number) text = text//', as in step '//as_text(rule%step)
  end function heat_of

  !> A load that is active in a step.
  pure function work_of(model, number, work) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(step_load), intent(in) :: work
    character(:), allocatable :: text
    text = row('load '//as_text(work%load), model%loads(work%load)%item%name//': '// &
               action_of_load(model, number, work))
  end function work_of

  pure function procedure_of(now) result(text)
    type(step), intent(in) :: now
    character(:), allocatable :: text
    text = trim(now%procedure%name)
    if (now%procedure%finds_modes) then
      text = row(text, as_text(now%num_modes)//' modes')
      return
    end if
    text = row(text, 'duration '//as_text(now%duration)//' s, increment '// &
               as_text(now%first_increment)//' s ('//as_text(now%smallest_increment)//' to '// &
               as_text(now%largest_increment)//')')
    if (now%is_direct) text = text//', fixed'
    if (now%procedure%has_inertia) text = text//', SCHEME '//trim(now%procedure%scheme)
    if (now%procedure%uses_alpha) text = text//', ALPHA '//as_text(now%alpha)
    text = text//reduction_of(now)//nl// &
           row('controls', controls_of(now%controls))//damping_of(now%damping)
  end function procedure_of

  !> The modes of *DYNAMIC, REDUCED.
  pure function reduction_of(now) result(text)
    type(step), intent(in) :: now
    character(:), allocatable :: text
    text = ''
    if (now%procedure%scheme /= 'REDUCED') return
    text = nl//row('reduced model', 'ACCURACY '//as_text(now%reduced%accuracy))
    if (now%reduced%num_modes > 0) text = nl//row('reduced model', 'MODES '// &
                                                  as_text(now%reduced%num_modes))
  end function reduction_of

  !> ACCURACY where it is asked for, all other controls always.
  pure function controls_of(now) result(text)
    type(step_controls), intent(in) :: now
    character(:), allocatable :: text
    text = 'RESIDUAL '//as_text(now%residual_tolerance)//', INCREMENT '// &
           as_text(now%increment_tolerance)//', ITERATIONS '//as_text(now%max_iterations)// &
           ', JOINT SOLVER '//trim(now%joint_solver)//', JOINT FORCES '//trim(now%joint_forces)// &
           ', TANGENT '//trim(now%tangent)//', PRECISION '//trim(now%precision)// &
           ', ERROR ESTIMATE '//trim(merge('ON ', 'OFF', now%estimates_errors))
    if (now%accuracy > 0.0_rk) text = text//', ACCURACY '//as_text(now%accuracy)
  end function controls_of

  pure function damping_of(now) result(text)
    type(step_damping), intent(in) :: now
    character(:), allocatable :: text
    text = ''
    if (now%ratio > 0.0_rk) then
      text = nl//row('damping', 'RATIO '//as_text(now%ratio)//' at '//as_text(now%f1)//' and '// &
                     as_text(now%f2)//' Hz, BASE '//name_of_base(now%is_current))
    end if
    if (.not. now%modal_ratio > 0.0_rk) return
    text = text//nl//row('modal damping', 'RATIO '//as_text(now%modal_ratio)//', ')
    if (now%num_modes > 0) then
      text = text//'MODES '//as_text(now%num_modes)
    else
      text = text//'HIGHEST '//as_text(now%highest)//' Hz'
    end if
  end function damping_of

  pure function requests_of(now) result(text)
    type(step), intent(in) :: now
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(now%prints)
      text = text//nl//row('print', trim(kinds_of_prints(now%prints(i)%kind)%subject)//' '// &
                           now%prints(i)%name//':'//words(now%prints(i)%fields)//' every '// &
                           as_text(now%prints(i)%frequency))
    end do
    do i = 1, size(now%outputs)
      text = text//nl//row('fields', trim(adjustl(words(now%outputs(i)%fields)))//' every '// &
                           as_text(now%outputs(i)%frequency))
    end do
    if (size(now%envelope) > 0) text = text//nl//row('envelope', trim(adjustl(words(now%envelope))))
  end function requests_of

  !> Words with blanks between.
  pure function words(list) result(text)
    character(*), intent(in) :: list(:)
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(list)
      text = text//' '//trim(list(i))
    end do
  end function words
end module step_summary
