!> Temperatures of the nodes during a step, and what follows from them: the thermal strains at the
!> points of inelastic solids and the thermal force of the system (theory.md, 16).
module warming
  use amplitudes, only: amplitude, amplitude_at
  use analysis_state, only: state
  use heat_plan, only: heat_rule
  use inelastic_blocks, only: inelastic_block
  use kinds, only: rk
  use material_points, only: point_state
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use step_loads, only: step_time
  use step_plan, only: step
  use step_system, only: build_thermal_force, dam_system
  use thermal_strains, only: expands, find_temperatures, find_thermal_strains, heat_field
  implicit none
  private
  public :: start_heat, take_references, heat_points, warm

contains

  !> The initial temperatures, at which elements have no thermal strain.
  subroutine start_heat(model, now)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now
    logical, allocatable :: is_new(:)
    if (.not. model%heat%is_there_any()) return
    now%heat%temperature = model%heat%initial
    if (model%heat%has_expansion) then
      allocate (now%heat%reference(8, model%mesh%num_elements), source=0.0_rk)
      allocate (is_new(model%mesh%num_elements), source=.true.)
      call take_references(model, is_new, now)
    end if
    call heat_points(model, now)
  end subroutine start_heat

  !> The present temperature of their nodes becomes the reference of elements that come.
  subroutine take_references(model, is_new, now)
    type(problem), intent(in) :: model
    logical, intent(in) :: is_new(:) !< (elements)
    type(state), intent(inout) :: now
    integer :: e
    if (.not. allocated(now%heat%reference)) return
    do e = 1, model%mesh%num_elements
      if (.not. (is_new(e) .and. expands(model, e))) cycle
      now%heat%reference(:, e) = now%heat%temperature(model%mesh%nodes(:, e))
    end do
  end subroutine take_references

  !> Temperatures at the end of an increment, and what follows from them.
  subroutine warm(model, plan, when, before, after, system, costs)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when !< the end of the increment
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    integer :: i
    if (.not. allocated(before%heat%temperature)) return
    after%heat = before%heat
    call find_node_temperatures(model, plan, when, before%heat%temperature, after%heat%temperature)
    if (all(abs(after%heat%temperature - before%heat%temperature) <= 0.0_rk)) then
      do i = 1, size(after%points)
        call copy_heat(before%points(i), after%points(i))
      end do
      if (allocated(before%motion%thermal)) then
        system%thermal_force = before%motion%thermal
        system%thermal_energy = before%motion%thermal_energy
      end if
    else
      call heat_points(model, after)
      call build_thermal_force(model, after, system, costs)
    end if
    call system%set_thermal(after%motion)
  end subroutine warm

  !> Copies temperature and thermal strain of the points of a block.
  pure subroutine copy_heat(from, to)
    type(point_state), intent(in) :: from
    type(point_state), intent(inout) :: to
    if (from%is_elsewhere()) return
    to%temperature = from%temperature
    if (allocated(from%thermal)) to%thermal = from%thermal
  end subroutine copy_heat

  !> Temperatures of the nodes by the rules of a step. Nodes without a rule keep theirs, or return
  !> to their initial temperature.
  pure subroutine find_node_temperatures(model, plan, when, before, temperature)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(step_time), intent(in) :: when
    real(rk), intent(in) :: before(:) !< (nodes) at the start of the increment [K]
    real(rk), intent(inout) :: temperature(:) !< (nodes) at its end [K]
    real(rk) :: share
    integer :: r
    share = 1.0_rk ! final values act at once in a dynamic step
    if (.not. when%is_dynamic) then
      share = when%increment/(max(0.0_rk, when%duration - when%now) + when%increment)
    end if
    if (plan%restores_temperature) then
      temperature = before + share*(model%heat%initial - before)
    end if
    if (.not. allocated(plan%heats)) return
    do r = 1, size(plan%heats)
      associate (rule => plan%heats(r))
        if (size(rule%time) == 0 .and. rule%amplitude == 0) then
          temperature(rule%nodes) = before(rule%nodes) &
                                    + share*(rule%value(1, :) - before(rule%nodes))
        else
          temperature(rule%nodes) = values_at(rule, model%amplitudes, when)
        end if
      end associate
    end do
  end subroutine find_node_temperatures

  !> Temperatures of a rule that follows a clock.
  pure function values_at(rule, histories, when) result(values)
    type(heat_rule), intent(in) :: rule
    type(amplitude), intent(in) :: histories(:)
    type(step_time), intent(in) :: when
    real(rk) :: values(size(rule%nodes)) !< [K]
    real(rk) :: clock, share
    integer :: k
    if (rule%amplitude > 0) then
      associate (own => histories(rule%amplitude))
        values = amplitude_at(own, when%clock(own%uses_total_time))*rule%value(1, :)
      end associate
      return
    end if
    clock = when%clock(rule%uses_total_time)
    k = count(rule%time <= clock)
    if (k == 0) then
      values = rule%value(1, :)
    else if (k == size(rule%time)) then
      values = rule%value(k, :)
    else
      share = (clock - rule%time(k))/(rule%time(k + 1) - rule%time(k))
      values = rule%value(k, :) + share*(rule%value(k + 1, :) - rule%value(k, :))
    end if
  end function values_at

  !> Temperatures and thermal strains at the points of all inelastic solids.
  subroutine heat_points(model, now)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now
    integer :: i
    if (.not. allocated(now%heat%temperature)) return
    !$omp parallel do schedule(dynamic) default(none) shared(model, now)
    do i = 1, size(now%points)
      if (now%points(i)%is_elsewhere()) cycle
      call heat_block(model, model%inelastic(i), now%heat, now%points(i))
    end do
    !$omp end parallel do
  end subroutine heat_points

  !> Temperatures and thermal strains at the points of one block; absent elements have none.
  subroutine heat_block(model, part, heat, own)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    type(heat_field), intent(in) :: heat
    type(point_state), intent(inout) :: own
    real(rk), dimension(part%points_of_element, size(part%elements)) :: temperature, expansion
    real(rk) :: strain(6, part%points_of_element, size(part%elements))
    integer :: n
    n = size(temperature)
    temperature = 0.0_rk
    if (model%mesh%material_of_element(part%elements(1)) > 0) then
      call find_temperatures(model, heat, part%elements, temperature)
    end if
    own%temperature = reshape(temperature, [n])
    if (.not. allocated(model%materials(part%material)%expansion)) return
    if (.not. allocated(heat%reference)) return
    strain = 0.0_rk
    if (expands(model, part%elements(1))) then
      call find_thermal_strains(model, heat, part%elements, expansion, strain)
    end if
    own%thermal = reshape(strain, [6, n])
  end subroutine heat_block
end module warming
