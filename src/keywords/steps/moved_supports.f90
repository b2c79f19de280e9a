!> *BOUNDARY, TYPE=ACCELERATION: supports that all have one acceleration are the motion of the base.
module moved_supports
  use applied_load, only: load
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use enter_load, only: put_load
  use kinds, only: rk
  use load_base_motion, only: base_motion
  use model_draft, only: draft, moved_direction
  use record_units, only: repeats_unit
  use write_text, only: as_text
  implicit none
  private
  public :: note_acceleration, close_accelerations, end_accelerations

contains

  !> Notes an acceleration of nodes; the nodes are held, since motion is relative to the base.
  subroutine note_acceleration(this, line, nodes, dof, value, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    integer, intent(in) :: nodes(:), dof, history !< positions of nodes, direction, amplitude
    real(rk), intent(in) :: value !< factor of the amplitude [m/s2]
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call model%supports%put(nodes, dof, 0.0_rk, 0)
    if (history == 0) return
    associate (now => model%moved(dof))
      if (.not. allocated(now%moves)) then
        allocate (now%moves(model%problem%mesh%num_nodes), source=.false.)
        now%value = value
        now%history = history
        now%spot = model%here(line)
      else if (now%history /= history .or. abs(now%value - value) > 0.0_rk) then
        call this%fault_at(faults, line, 1, 'supports of direction '//as_text(dof)//' have '// &
                           'different accelerations', 'one acceleration for all supports', &
                           first=model%cards(now%spot%card)%place())
      end if
      now%moves(nodes) = .true.
    end associate
    if (repeats_unit(trim(model%record_unit(history)), value)) then
      call this%fault_at(faults, line, 4, 'UNIT turns the record into m/s2 already; the factor '// &
                         this%text_at(line, 4)//' would do it twice', 'a factor that scales it')
      return
    end if
    if (abs(model%record_factor(history) - 1.0_rk) <= 0.0_rk .or. &
        abs(value - 1.0_rk) <= 0.0_rk) return
    call this%fault_at(faults, line, 4, 'the file of the record names its unit; the factor '// &
                       this%text_at(line, 4)//' is ambiguous', 'UNIT in *AMPLITUDE, or 1')
  end subroutine note_acceleration

  !> *BOUNDARY, OP=NEW ends the accelerations of the supports of earlier steps.
  subroutine end_accelerations(model)
    type(draft), intent(inout) :: model
    integer :: dof
    do dof = 1, size(model%is_shaken)
      if (model%is_shaken(dof)) call end_acceleration(model, dof)
    end do
  end subroutine end_accelerations

  subroutine end_acceleration(model, dof)
    type(draft), intent(inout) :: model
    integer, intent(in) :: dof !< direction
    integer :: ended
    call model%active_loads%take_over('BASE MOTION', as_text(dof), 'another motion', 0.0_rk, 0, &
                                      ended)
    model%is_shaken(dof) = .false.
  end subroutine end_acceleration

  !> Displacements replace an acceleration of an earlier step: at all supports of the direction,
  !> which cannot move in different ways.
  subroutine replace_acceleration(model, dof, faults)
    type(draft), intent(inout) :: model
    integer, intent(in) :: dof !< direction
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, given, left
    associate (table => model%supports)
      given = findloc(table%is_set(dof, :) .and. table%is_new(dof, :), .true., dim=1)
      left = findloc(table%is_set(dof, :) .and. .not. table%is_new(dof, :), .true., dim=1)
    end associate
    if (given == 0) return
    if (left == 0) then
      call end_acceleration(model, dof)
      return
    end if
    do i = model%current, model%step_origin%card, -1
      if (model%cards(i)%keyword /= 'BOUNDARY') cycle
      call model%cards(i)%fault( &
        faults, 'node '//as_text(model%problem%mesh%node_id(given))//' has a displacement in '// &
        'direction '//as_text(dof)//', node '//as_text(model%problem%mesh%node_id(left))// &
        ' has the acceleration of an earlier step', 'one motion for all supports of a '// &
        'direction: displacements of all of them end the acceleration, as OP=NEW does')
      return
    end do
  end subroutine replace_acceleration

  !> Makes loads of the accelerations at the end of the step, when all its supports are known.
  subroutine close_accelerations(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: dof
    do dof = 1, size(model%moved)
      if (.not. allocated(model%moved(dof)%moves)) then
        if (model%is_shaken(dof)) call replace_acceleration(model, dof, faults)
        cycle
      end if
      call close_direction(model%moved(dof), dof, model, faults)
      model%moved(dof) = moved_direction()
    end do
  end subroutine close_accelerations

  subroutine close_direction(moved, dof, model, faults)
    type(moved_direction), intent(in) :: moved
    integer, intent(in) :: dof
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(base_motion) :: shaking
    class(load), allocatable :: item
    integer :: stray
    associate (this => model%cards(moved%spot%card))
      stray = findloc(model%supports%is_set(dof, :) .and. .not. moved%moves, .true., dim=1)
      if (.not. model%now%procedure%has_inertia) then
        call this%fault_parameter(faults, 'TYPE', 'ACCELERATION has no effect in this step', &
                                  'a step *DYNAMIC')
      else if (stray > 0) then
        call this%fault_parameter(faults, 'TYPE', 'node '// &
                                  as_text(model%problem%mesh%node_id(stray))//' is held in '// &
                                  'direction '//as_text(dof)//' too, without this acceleration', &
                                  'one acceleration for all supports of a direction; else '// &
                                  'histories of displacements, TYPE=DISPLACEMENT')
      else
        call this%warn(faults, 'all supports in direction '//as_text(dof)//' have this '// &
                       'acceleration: it is the motion of the base (*BASE MOTION), and '// &
                       'results are relative to the base')
        shaking%kind = 'base motion'
        shaking%dof = dof
        allocate (item, source=shaking)
        call put_load(model, item, 'base motion '//as_text(dof), 'BASE MOTION', as_text(dof), '', &
                      moved%value, moved%history)
        model%is_shaken(dof) = .true.
      end if
    end associate
  end subroutine close_direction
end module moved_supports
