!> Opens a step with the settings of the previous one, and closes it.
module finish_step
  use keywords_temperature, only: forget_heats, keep_heats
  use kinds, only: rk
  use load_point, only: point_load
  use model_draft, only: add_load, draft, kept_support
  use node_dofs, only: num_directions
  use step_plan, only: output_rhythm, step, step_fixity, step_load
  use write_text, only: as_text
  use applied_load, only: load
  implicit none
  private
  public :: open_step, close_step

contains

  !> Opens a step with requests, controls and damping of the previous step.
  subroutine open_step(model)
    type(draft), intent(inout) :: model
    type(step) :: new
    integer :: num
    num = model%num_steps
    new%name = 'STEP-'//as_text(num + 1)
    model%current_procedure = model%current
    allocate (new%prints(0), new%outputs(0), new%envelope(0))
    if (num > 0) then
      associate (before => model%problem%steps(num))
        new%prints = before%prints
        new%outputs = before%outputs
        new%controls = before%controls
        new%checkpoint_frequency = before%checkpoint_frequency
        new%damping = before%damping
      end associate
    end if
    if (model%next_checkpoint_frequency >= 0) then
      new%checkpoint_frequency = model%next_checkpoint_frequency
      model%next_checkpoint_frequency = -1
    end if
    model%now = new
    call keep_heats(model)
    model%step_origin = model%here(0)
    model%is_in_step = .true.
    model%supports%is_new = .false.
    if (num == 0) model%last_supports = model%supports
    model%has_new_nodal = .false.
    model%has_new_elemental = .false.
    model%rhythm = output_rhythm()
    model%output_is_history = .false.
    model%prints_given = .false.
  end subroutine open_step

  !> Stores all active loads and supports and advances the load book.
  subroutine close_step(model)
    type(draft), intent(inout) :: model
    logical :: is_perturbation
    real(rk) :: end_time
    call set_frequencies(model)
    call collect_point_forces(model)
    call collect_fixities(model)
    call note_kept_supports(model)
    model%now%loads = [model%now%loads, model%active_loads%loads_of_step()]
    is_perturbation = model%now%procedure%finds_modes
    if (is_perturbation) call forget_heats(model)
    end_time = model%total_time + model%now%duration
    associate (histories => model%problem%amplitudes, duration => model%now%duration)
      call model%active_loads%end_step(histories, duration, end_time, is_perturbation)
      call model%supports%end_step(histories, duration, end_time, is_perturbation)
      call model%point_forces%end_step(histories, duration, end_time, is_perturbation)
    end associate
    if (.not. is_perturbation) model%last_supports = model%supports
    model%total_time = end_time
    model%num_steps = model%num_steps + 1
    model%problem%steps(model%num_steps) = model%now
    model%procedure_card = [model%procedure_card, model%current_procedure]
    model%is_in_step = .false.
  end subroutine close_step

  !> Increments between the outputs of requests whose cards give times or numbers: by the increment
  !> of each step.
  subroutine set_frequencies(model)
    type(draft), intent(inout) :: model
    integer :: i
    associate (now => model%now)
      if (.not. now%first_increment > 0.0_rk) return
      do i = 1, size(now%outputs)
        if (is_timed(now%outputs(i)%rhythm)) now%outputs(i)%frequency = &
          now%outputs(i)%rhythm%increments_between(now%duration, now%first_increment)
      end do
      do i = 1, size(now%prints)
        if (is_timed(now%prints(i)%rhythm)) now%prints(i)%frequency = &
          now%prints(i)%rhythm%increments_between(now%duration, now%first_increment)
      end do
    end associate
  end subroutine set_frequencies

  !> Whether a card gives times or a number of outputs.
  pure logical function is_timed(rhythm)
    type(output_rhythm), intent(in) :: rhythm
    is_timed = rhythm%most > 0 .or. rhythm%interval > 0.0_rk
  end function is_timed

  subroutine collect_fixities(model)
    type(draft), intent(inout) :: model
    integer :: node, dof, used
    allocate (model%now%fixities(count(model%supports%is_set)))
    used = 0
    do node = 1, size(model%supports%is_set, 2)
      do dof = 1, num_directions
        if (.not. model%supports%is_set(dof, node)) cycle
        used = used + 1
        model%now%fixities(used) = step_fixity(node, dof, model%supports%value(dof, node), &
                                               model%supports%history(dof, node))
      end do
    end do
  end subroutine collect_fixities

  !> Notes a support that *FREQUENCY steps before this step have changed and its cards do not give.
  subroutine note_kept_supports(model)
    type(draft), intent(inout) :: model
    integer :: found(2)
    logical :: is_held, was_held
    if (model%now%procedure%finds_modes) return
    associate (table => model%supports)
      found = findloc(table%differs(model%last_supports) .and. .not. table%is_new, .true.)
      if (found(1) == 0) return
      is_held = table%is_set(found(1), found(2))
      was_held = model%last_supports%is_set(found(1), found(2))
      model%kept_supports = [model%kept_supports, &
                             kept_support(model%num_steps + 1, found(2), found(1), is_held, &
                                          is_held .and. was_held)]
    end associate
  end subroutine note_kept_supports

  !> Point forces without amplitude become two loads of the step: the initial forces, with a factor
  !> that falls to 0, and the final forces, with a factor that rises to 1. Forces with an amplitude
  !> become one load for each amplitude, which replaces the initial forces at once.
  subroutine collect_point_forces(model)
    type(draft), intent(inout) :: model
    real(rk), allocatable :: force(:, :), previous(:, :)
    logical :: has_forces(model%num_amplitudes)
    integer :: history
    allocate (model%now%loads(0))
    associate (table => model%point_forces)
      if (.not. any(table%is_set .or. abs(table%previous) > 0.0_rk)) return
      force = merge(table%value, 0.0_rk, table%history == 0)
      previous = merge(table%previous, 0.0_rk, table%history == 0)
      if (all(abs(force - previous) <= 0.0_rk)) then
        call add_forces(model, force, 1.0_rk, 1.0_rk, 0)
      else
        call add_forces(model, previous, 1.0_rk, 0.0_rk, 0)
        call add_forces(model, force, 0.0_rk, 1.0_rk, 0)
      end if
    end associate
    has_forces = model%point_forces%follows(model%num_amplitudes)
    do history = 1, size(has_forces)
      if (.not. has_forces(history)) cycle
      force = merge(model%point_forces%value, 0.0_rk, model%point_forces%history == history)
      call add_forces(model, force, 0.0_rk, 1.0_rk, history)
    end do
  end subroutine collect_point_forces

  !> Adds a load of point forces to the model and to the step.
  subroutine add_forces(model, force, start_factor, end_factor, history)
    type(draft), intent(inout) :: model
    real(rk), intent(in) :: force(:, :) !< (3, nodes) [N]
    real(rk), intent(in) :: start_factor, end_factor
    integer, intent(in) :: history !< amplitude, 0 for none
    type(point_load) :: forces
    class(load), allocatable :: item
    logical, allocatable :: is_loaded(:)
    integer :: i
    is_loaded = any(abs(force) > 0.0_rk, dim=1)
    if (.not. any(is_loaded)) return
    forces%kind = 'point load'
    forces%nodes = pack([(i, i=1, size(force, 2))], is_loaded)
    forces%force = force(:, forces%nodes)
    allocate (item, source=forces)
    call add_load(model, item, 'point forces', 'CLOAD', &
                  'step '//as_text(model%num_steps + 1))
    model%now%loads = [model%now%loads, &
                       step_load(model%num_loads, start_factor, end_factor, history)]
  end subroutine add_forces
end module finish_step
