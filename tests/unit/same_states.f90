!> Compares two states member by member and bit by bit. tests/tools/test_archives.py finds a
!> component that is missing here.
module same_states
  use step_control, only: increment_control
  use analysis_state, only: state, increment_status, energy_balance, last_matrix, motion, &
                            modal_motion, reduction_status, time_accuracy
  use guest_history, only: history_slot
  use joint_law, only: joint_state
  use material_points, only: point_state
  use modal_errors, only: modal_error
  use path_errors, only: path_error
  use path_twins, only: twin_points
  use same_values, only: compare
  use testing, only: test_log, check
  implicit none
  private
  public :: compare_states

contains

  !> Everything in two states.
  subroutine compare_states(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what !< before the names of the members
    type(state), intent(in) :: a, b
    integer :: i
    call compare_status(log, what, a%increment_status, b%increment_status)
    call compare(log, what//'u', a%u, b%u)
    call compare(log, what//'v', a%v, b%v)
    call compare(log, what//'a', a%a, b%a)
    call compare(log, what//'reaction', a%reaction, b%reaction)
    call compare(log, what//'support_start', a%support_start, b%support_start)
    call compare(log, what//'origin', a%origin, b%origin)
    call compare(log, what//'heat%temperature', a%heat%temperature, b%heat%temperature)
    call compare(log, what//'heat%reference', a%heat%reference, b%heat%reference)
    call compare_matrix(log, what//'matrix%', a%matrix, b%matrix)
    call compare_motion(log, what//'motion%', a%motion, b%motion)
    do i = 1, size(a%joints)
      call compare_joint(log, what//'joints%', a%joints(i), b%joints(i))
    end do
    do i = 1, size(a%points)
      call compare_points(log, what//'points%', a%points(i), b%points(i))
    end do
    do i = 1, size(a%guests)
      call compare_guests(log, what//'guests%', a%guests(i), b%guests(i))
    end do
    call check(log, allocated(a%twins) .eqv. allocated(b%twins), what//'twins')
    if (.not. (allocated(a%twins) .and. allocated(b%twins))) return
    do i = 1, size(a%twins)
      call compare_twins(log, what//'twins%', a%twins(i), b%twins(i))
    end do
  end subroutine compare_states

  !> Histories of guests: of type point_state where there are any.
  subroutine compare_guests(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(history_slot), intent(in) :: a, b
    call check(log, allocated(a%item) .eqv. allocated(b%item), what//'item')
    if (.not. (allocated(a%item) .and. allocated(b%item))) return
    select type (first => a%item)
    type is (point_state)
      select type (second => b%item)
      type is (point_state)
        call compare_points(log, what, first, second)
      end select
    end select
  end subroutine compare_guests

  !> Twins of points, if any.
  subroutine compare_twins(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(twin_points), intent(in) :: a, b
    call compare(log, what//'block', a%block, b%block)
    call compare(log, what//'point', a%point, b%point)
    if (a%num_twins() > 0) call compare_points(log, what//'at%', a%at, b%at)
  end subroutine compare_twins

  !> Where the analysis is.
  subroutine compare_status(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(increment_status), intent(in) :: a, b
    call compare(log, what//'step', a%step, b%step)
    call compare(log, what//'increment', a%increment, b%increment)
    call compare(log, what//'iterations', a%iterations, b%iterations)
    call compare(log, what//'augmentations', a%augmentations, b%augmentations)
    call compare(log, what//'cutbacks', a%cutbacks, b%cutbacks)
    call compare(log, what//'num_unknowns', a%num_unknowns, b%num_unknowns)
    call compare(log, what//'has_held_switches', a%has_held_switches, b%has_held_switches)
    call compare(log, what//'has_opened_step', a%has_opened_step, b%has_opened_step)
    call compare(log, what//'is_last_of_step', a%is_last_of_step, b%is_last_of_step)
    call compare(log, what//'is_stop', a%is_stop, b%is_stop)
    call compare(log, what//'step_time', a%step_time, b%step_time)
    call compare(log, what//'total_time', a%total_time, b%total_time)
    call compare(log, what//'increment_size', a%increment_size, b%increment_size)
    call compare(log, what//'step_start', a%step_start, b%step_start)
    call compare(log, what//'joint_condition', a%joint_condition, b%joint_condition)
    call compare(log, what//'residual', a%residual, b%residual)
    call compare(log, what//'largest_force', a%largest_force, b%largest_force)
    call compare_energy(log, what//'energy%', a%energy, b%energy)
    call compare_control(log, what//'control%', a%control, b%control)
    call compare_reduction(log, what//'reduction%', a%reduction, b%reduction)
    call compare_accuracy(log, what//'accuracy%', a%accuracy, b%accuracy)
    call compare_timing(log, what//'timing%', a%timing, b%timing)
    call compare_path(log, what//'path%', a%path, b%path)
  end subroutine compare_status

  !> Energies.
  subroutine compare_energy(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(energy_balance), intent(in) :: a, b
    call compare(log, what//'external', a%external, b%external)
    call compare(log, what//'kinetic', a%kinetic, b%kinetic)
    call compare(log, what//'strain', a%strain, b%strain)
    call compare(log, what//'damping', a%damping, b%damping)
    call compare(log, what//'friction', a%friction, b%friction)
    call compare(log, what//'fracture', a%fracture, b%fracture)
    call compare(log, what//'crushing', a%crushing, b%crushing)
    call compare(log, what//'left_cracking', a%left_cracking, b%left_cracking)
    call compare(log, what//'left_crushing', a%left_crushing, b%left_crushing)
    call compare(log, what//'left_created', a%left_created, b%left_created)
    call compare(log, what//'numerical', a%numerical, b%numerical)
    call compare(log, what//'stages', a%stages, b%stages)
    call compare(log, what//'temperature', a%temperature, b%temperature)
    call compare(log, what//'initial', a%initial, b%initial)
    call compare(log, what//'error', a%error, b%error)
    call compare(log, what//'largest', a%largest, b%largest)
  end subroutine compare_energy

  !> Error in time as modes show it.
  subroutine compare_timing(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(modal_error), intent(in) :: a, b
    call compare(log, what//'exact', a%exact, b%exact)
    call compare(log, what//'rate', a%rate, b%rate)
    call compare(log, what//'drive', a%drive, b%drive)
    call compare(log, what//'carried', a%carried, b%carried)
    call compare(log, what//'carried_rate', a%carried_rate, b%carried_rate)
    call compare(log, what//'error', a%error, b%error)
    call compare(log, what//'most', a%most, b%most)
    call compare(log, what//'motion', a%motion, b%motion)
    call compare(log, what//'largest', a%largest, b%largest)
    call compare(log, what//'at_largest', a%at_largest, b%at_largest)
    call compare(log, what//'stiffening', a%stiffening, b%stiffening)
    call compare(log, what//'softer', a%softer, b%softer)
    call compare(log, what//'softer_rate', a%softer_rate, b%softer_rate)
    call compare(log, what//'mesh_at_largest', a%mesh_at_largest, b%mesh_at_largest)
    call compare(log, what//'mesh_at_most', a%mesh_at_most, b%mesh_at_most)
    call compare(log, what//'square', a%square, b%square)
    call compare(log, what//'product', a%product, b%product)
    call compare(log, what//'at_most', a%at_most, b%at_most)
    call compare(log, what//'opening', a%opening, b%opening)
    call compare(log, what//'lost', a%lost, b%lost)
    call compare(log, what//'changes', a%changes, b%changes)
    call compare(log, what//'held', a%held, b%held)
    call compare(log, what//'num_broken', a%num_broken, b%num_broken)
    call compare(log, what//'num_lost', a%num_lost, b%num_lost)
  end subroutine compare_timing

  !> Error of the laws within increments.
  subroutine compare_path(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(path_error), intent(in) :: a, b
    call compare(log, what//'num_found', a%num_found, b%num_found)
    call compare(log, what//'num_points', a%num_points, b%num_points)
    call compare(log, what//'dissipated', a%dissipated, b%dissipated)
    call compare(log, what//'difference', a%difference, b%difference)
    call compare(log, what//'stress', a%stress, b%stress)
  end subroutine compare_path

  !> Error in time.
  subroutine compare_accuracy(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(time_accuracy), intent(in) :: a, b
    call compare(log, what//'num_known', a%num_known, b%num_known)
    call compare(log, what//'size', a%size, b%size)
    call compare(log, what//'size_before', a%size_before, b%size_before)
    call compare(log, what//'largest', a%largest, b%largest)
    call compare(log, what//'mean_rate', a%mean_rate, b%mean_rate)
    call compare(log, what//'held_rate', a%held_rate, b%held_rate)
    call compare(log, what//'velocity_square', a%velocity_square, b%velocity_square)
    call compare(log, what//'acceleration_square', a%acceleration_square, b%acceleration_square)
    call compare(log, what//'third_square', a%third_square, b%third_square)
    call compare(log, what//'error', a%error, b%error)
    call compare(log, what//'largest_error', a%largest_error, b%largest_error)
    call compare(log, what//'damped', a%damped, b%damped)
    call compare(log, what//'kinetic', a%kinetic, b%kinetic)
  end subroutine compare_accuracy

  !> Size of increments.
  subroutine compare_control(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(increment_control), intent(in) :: a, b
    call compare(log, what//'size', a%size, b%size)
    call compare(log, what//'last_size', a%last_size, b%last_size)
    call compare(log, what//'smallest', a%smallest, b%smallest)
    call compare(log, what//'largest', a%largest, b%largest)
    call compare(log, what//'first', a%first, b%first)
    call compare(log, what//'finest', a%finest, b%finest)
    call compare(log, what//'duration', a%duration, b%duration)
    call compare(log, what//'growth', a%growth, b%growth)
    call compare(log, what//'easy_needed', a%easy_needed, b%easy_needed)
    call compare(log, what//'is_direct', a%is_direct, b%is_direct)
    call compare(log, what//'easy_so_far', a%easy_so_far, b%easy_so_far)
    call compare(log, what//'cuts_in_a_row', a%cuts_in_a_row, b%cuts_in_a_row)
    call compare(log, what//'cutbacks', a%cutbacks, b%cutbacks)
    call compare(log, what//'steady_so_far', a%steady_so_far, b%steady_so_far)
    call compare(log, what//'steady_needed', a%steady_needed, b%steady_needed)
    call compare(log, what//'has_tried', a%has_tried, b%has_tried)
  end subroutine compare_control

  !> Vectors of the integrator.
  subroutine compare_motion(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(motion), intent(in) :: a, b
    call compare(log, what//'q', a%q, b%q)
    call compare(log, what//'v', a%v, b%v)
    call compare(log, what//'a', a%a, b%a)
    call compare(log, what//'external', a%external, b%external)
    call compare(log, what//'elastic', a%elastic, b%elastic)
    call compare(log, what//'internal', a%internal, b%internal)
    call compare(log, what//'contact', a%contact, b%contact)
    call compare(log, what//'balanced', a%balanced, b%balanced)
    call compare(log, what//'viscous', a%viscous, b%viscous)
    call compare(log, what//'viscous_rate', a%viscous_rate, b%viscous_rate)
    call compare(log, what//'lost_damping', a%lost_damping, b%lost_damping)
    call compare(log, what//'correction', a%correction, b%correction)
    call compare(log, what//'carried_correction', a%carried_correction, b%carried_correction)
    call compare(log, what//'momentum', a%momentum, b%momentum)
    call compare(log, what//'inertia', a%inertia, b%inertia)
    call compare(log, what//'residual', a%residual, b%residual)
    call compare(log, what//'last_a', a%last_a, b%last_a)
    call compare(log, what//'acceleration_ratio', a%acceleration_ratio, b%acceleration_ratio)
    call compare(log, what//'last_ratio', a%last_ratio, b%last_ratio)
    call compare(log, what//'slope', a%slope, b%slope)
    call compare(log, what//'bend', a%bend, b%bend)
    call compare(log, what//'release', a%release, b%release)
    call compare(log, what//'thermal', a%thermal, b%thermal)
    call compare(log, what//'thermal_energy', a%thermal_energy, b%thermal_energy)
    call compare(log, what//'carried', a%carried, b%carried)
    call compare(log, what//'jump_rate', a%jump_rate, b%jump_rate)
    call compare_modal(log, what//'modal%', a%modal, b%modal)
  end subroutine compare_motion

  !> Motion of a reduced model.
  subroutine compare_modal(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(modal_motion), intent(in) :: a, b
    call compare(log, what//'start', a%start, b%start)
    call compare(log, what//'start_traction', a%start_traction, b%start_traction)
    call compare(log, what//'start_factor', a%start_factor, b%start_factor)
    call compare(log, what//'y', a%y, b%y)
    call compare(log, what//'rate', a%rate, b%rate)
    call compare(log, what//'acceleration', a%acceleration, b%acceleration)
    call compare(log, what//'port', a%port, b%port)
    call compare(log, what//'port_rate', a%port_rate, b%port_rate)
    call compare(log, what//'port_acceleration', a%port_acceleration, b%port_acceleration)
    call compare(log, what//'rest', a%rest, b%rest)
    call compare(log, what//'rest_rate', a%rest_rate, b%rest_rate)
    call compare(log, what//'rest_acceleration', a%rest_acceleration, b%rest_acceleration)
    call compare(log, what//'is_expanded', a%is_expanded, b%is_expanded)
  end subroutine compare_modal

  !> What is known of a reduced model.
  subroutine compare_reduction(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(reduction_status), intent(in) :: a, b
    call compare(log, what//'num_shapes', a%num_shapes, b%num_shapes)
    call compare(log, what//'num_modes', a%num_modes, b%num_modes)
    call compare(log, what//'highest', a%highest, b%highest)
    call compare(log, what//'estimate', a%estimate, b%estimate)
    call compare(log, what//'num_broken', a%num_broken, b%num_broken)
  end subroutine compare_reduction

  !> The last matrix.
  subroutine compare_matrix(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(last_matrix), intent(in) :: a, b
    call compare(log, what//'number', a%number, b%number)
    call compare(log, what//'is_elastic', a%is_elastic, b%is_elastic)
    call compare(log, what//'is_symmetric', a%is_symmetric, b%is_symmetric)
    call compare(log, what//'increment_size', a%increment_size, b%increment_size)
    call compare(log, what//'has_all_blocks', a%has_all_blocks, b%has_all_blocks)
    call compare(log, what//'lost', a%lost, b%lost)
  end subroutine compare_matrix

  !> History of a joint.
  subroutine compare_joint(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(joint_state), intent(in) :: a, b
    call compare(log, what//'gap', a%gap, b%gap)
    call compare(log, what//'shift', a%shift, b%shift)
    call compare(log, what//'jump', a%jump, b%jump)
    call compare(log, what//'traction', a%traction, b%traction)
    call compare(log, what//'slip', a%slip, b%slip)
    call compare(log, what//'is_broken', a%is_broken, b%is_broken)
    call compare(log, what//'status', a%status, b%status)
    call compare(log, what//'num_openings', a%num_openings, b%num_openings)
    call compare(log, what//'friction_work', a%friction_work, b%friction_work)
    call compare(log, what//'fracture_work', a%fracture_work, b%fracture_work)
    call compare(log, what//'internal', a%internal, b%internal)
    call compare(log, what//'water', a%water, b%water)
    call compare(log, what//'lets_water_in', a%lets_water_in, b%lets_water_in)
    call compare(log, what//'origin', a%origin, b%origin)
    call compare(log, what//'phase', a%phase, b%phase)
    call compare(log, what//'is_pressed', a%is_pressed, b%is_pressed)
    call compare(log, what//'part_origin', a%part_origin, b%part_origin)
  end subroutine compare_joint

  !> Points of a block.
  subroutine compare_points(log, what, a, b)
    type(test_log), intent(inout) :: log
    character(*), intent(in) :: what
    type(point_state), intent(in) :: a, b
    call compare(log, what//'strain', a%strain, b%strain)
    call compare(log, what//'stress', a%stress, b%stress)
    call compare(log, what//'internal', a%internal, b%internal)
    call compare(log, what//'energy', a%energy, b%energy)
    call compare(log, what//'gradient', a%gradient, b%gradient)
    call compare(log, what//'is_elastic', a%is_elastic, b%is_elastic)
    call compare(log, what//'temperature', a%temperature, b%temperature)
    call compare(log, what//'thermal', a%thermal, b%thermal)
  end subroutine compare_points
end module same_states
