!> A state whose components all have values of their own; tests/tools/test_archives.py sees to it.
module full_state
  use counted_values, only: fill
  use analysis_state, only: state, increment_status, energy_balance, last_matrix, motion, &
                            modal_motion, reduction_status, time_accuracy
  use step_control, only: increment_control
  use joint_law, only: joint_state
  use material_points, only: point_state
  use thermal_strains, only: heat_field
  use modal_errors, only: modal_error
  use path_errors, only: path_error
  use path_twins, only: twin_points
  implicit none
  private
  public :: make_full_state

contains

  !> Three nodes, two joints of two points, five points of solids, guests with and without history.
  subroutine make_full_state(now)
    type(state), allocatable, intent(out) :: now
    type(point_state) :: points
    integer :: n, i
    n = 0
    allocate (now)
    call fill_status(now%increment_status, n)
    allocate (now%u(3, 3), now%v(3, 3), now%a(3, 3), now%reaction(3, 3), now%support_start(2))
    call fill(now%u, n)
    call fill(now%v, n)
    call fill(now%a, n)
    call fill(now%reaction, n)
    call fill(now%support_start, n)
    allocate (now%origin(24, 2))
    call fill(now%origin, n)
    call fill_heat(now%heat, n)
    call fill_matrix(now%matrix, n)
    call fill_motion(now%motion, n)
    allocate (now%joints(2), now%points(1), now%guests(2), now%twins(2))
    do i = 1, 2
      call fill_joint(now%joints(i), n)
    end do
    call fill_points(now%points(1), n)
    call fill_points(points, n)
    allocate (now%guests(2)%item, source=points)
    call fill_twins(now%twins(2), n)
  end subroutine make_full_state

  !> Temperatures.
  subroutine fill_heat(heat, n)
    type(heat_field), intent(inout) :: heat
    integer, intent(inout) :: n
    allocate (heat%temperature(3), heat%reference(8, 2))
    call fill(heat%temperature, n)
    call fill(heat%reference, n)
  end subroutine fill_heat

  !> Where the analysis is.
  subroutine fill_status(status, n)
    type(increment_status), intent(inout) :: status
    integer, intent(inout) :: n
    call fill(status%step, n)
    call fill(status%increment, n)
    call fill(status%iterations, n)
    call fill(status%augmentations, n)
    call fill(status%cutbacks, n)
    call fill(status%num_unknowns, n)
    call fill(status%has_held_switches, n)
    call fill(status%has_opened_step, n)
    call fill(status%is_last_of_step, n)
    call fill(status%is_stop, n)
    call fill(status%step_time, n)
    call fill(status%total_time, n)
    call fill(status%increment_size, n)
    call fill(status%step_start, n)
    call fill(status%joint_condition, n)
    call fill(status%residual, n)
    call fill(status%largest_force, n)
    call fill_energy(status%energy, n)
    call fill_control(status%control, n)
    call fill_reduction(status%reduction, n)
    call fill_accuracy(status%accuracy, n)
    call fill_timing(status%timing, n)
    call fill_path(status%path, n)
  end subroutine fill_status

  !> Energies.
  subroutine fill_energy(energy, n)
    type(energy_balance), intent(inout) :: energy
    integer, intent(inout) :: n
    call fill(energy%external, n)
    call fill(energy%kinetic, n)
    call fill(energy%strain, n)
    call fill(energy%damping, n)
    call fill(energy%friction, n)
    call fill(energy%fracture, n)
    call fill(energy%crushing, n)
    call fill(energy%left_cracking, n)
    call fill(energy%left_crushing, n)
    call fill(energy%left_created, n)
    call fill(energy%numerical, n)
    call fill(energy%stages, n)
    call fill(energy%temperature, n)
    call fill(energy%initial, n)
    call fill(energy%error, n)
    call fill(energy%largest, n)
  end subroutine fill_energy

  !> Error in time as modes show it.
  subroutine fill_timing(timing, n)
    type(modal_error), intent(inout) :: timing
    integer, intent(inout) :: n
    allocate (timing%exact(2), timing%rate(2), timing%drive(2), timing%error(2), timing%carried(2))
    allocate (timing%square(2, 2), timing%product(2), timing%at_most(2), timing%mesh_at_most(2))
    allocate (timing%stiffening(2), timing%softer(2), timing%softer_rate(2), timing%carried_rate(2))
    call fill(timing%exact, n)
    call fill(timing%stiffening, n)
    call fill(timing%softer, n)
    call fill(timing%softer_rate, n)
    call fill(timing%mesh_at_largest, n)
    call fill(timing%mesh_at_most, n)
    call fill(timing%rate, n)
    call fill(timing%drive, n)
    call fill(timing%carried, n)
    call fill(timing%carried_rate, n)
    call fill(timing%error, n)
    call fill(timing%most, n)
    call fill(timing%motion, n)
    call fill(timing%largest, n)
    call fill(timing%at_largest, n)
    call fill(timing%square, n)
    call fill(timing%product, n)
    call fill(timing%at_most, n)
    call fill(timing%opening, n)
    call fill(timing%lost, n)
    call fill(timing%changes, n)
    call fill(timing%held, n)
    call fill(timing%num_broken, n)
    call fill(timing%num_lost, n)
  end subroutine fill_timing

  !> Error of the laws within increments.
  subroutine fill_path(path, n)
    type(path_error), intent(inout) :: path
    integer, intent(inout) :: n
    call fill(path%num_found, n)
    call fill(path%num_points, n)
    call fill(path%dissipated, n)
    call fill(path%difference, n)
    call fill(path%stress, n)
  end subroutine fill_path

  !> Twins of the five points of the block.
  subroutine fill_twins(twins, n)
    type(twin_points), intent(inout) :: twins
    integer, intent(inout) :: n
    allocate (twins%block(5), twins%point(5))
    call fill(twins%block, n)
    call fill(twins%point, n)
    call fill_points(twins%at, n)
  end subroutine fill_twins

  !> Error in time.
  subroutine fill_accuracy(accuracy, n)
    type(time_accuracy), intent(inout) :: accuracy
    integer, intent(inout) :: n
    call fill(accuracy%num_known, n)
    call fill(accuracy%size, n)
    call fill(accuracy%size_before, n)
    call fill(accuracy%largest, n)
    call fill(accuracy%mean_rate, n)
    call fill(accuracy%held_rate, n)
    call fill(accuracy%velocity_square, n)
    call fill(accuracy%acceleration_square, n)
    call fill(accuracy%third_square, n)
    call fill(accuracy%error, n)
    call fill(accuracy%largest_error, n)
    call fill(accuracy%damped, n)
    call fill(accuracy%kinetic, n)
  end subroutine fill_accuracy

  !> Size of increments.
  subroutine fill_control(control, n)
    type(increment_control), intent(inout) :: control
    integer, intent(inout) :: n
    call fill(control%size, n)
    call fill(control%last_size, n)
    call fill(control%smallest, n)
    call fill(control%largest, n)
    call fill(control%first, n)
    call fill(control%finest, n)
    call fill(control%duration, n)
    call fill(control%growth, n)
    call fill(control%easy_needed, n)
    call fill(control%is_direct, n)
    call fill(control%easy_so_far, n)
    call fill(control%cuts_in_a_row, n)
    call fill(control%cutbacks, n)
    call fill(control%steady_so_far, n)
    call fill(control%steady_needed, n)
    call fill(control%has_tried, n)
  end subroutine fill_control

  !> Vectors of the integrator.
  subroutine fill_motion(own, n)
    type(motion), intent(inout) :: own
    integer, intent(inout) :: n
    allocate (own%q(4), own%v(4), own%a(4), own%external(4), own%elastic(4), own%internal(4), &
              own%contact(4), own%balanced(4), own%viscous(4), own%viscous_rate(4), &
              own%lost_damping(4), own%correction(4), own%carried_correction(4), own%slope(4), &
              own%momentum(4), own%inertia(4), own%carried(3, 4), own%jump_rate(3, 4), &
              own%bend(4), own%release(4), own%thermal(4), own%last_a(4), &
              own%residual(3))
    call fill(own%q, n)
    call fill(own%v, n)
    call fill(own%a, n)
    call fill(own%external, n)
    call fill(own%elastic, n)
    call fill(own%internal, n)
    call fill(own%contact, n)
    call fill(own%balanced, n)
    call fill(own%viscous, n)
    call fill(own%viscous_rate, n)
    call fill(own%lost_damping, n)
    call fill(own%correction, n)
    call fill(own%carried_correction, n)
    call fill(own%momentum, n)
    call fill(own%inertia, n)
    call fill(own%residual, n)
    call fill(own%last_a, n)
    call fill(own%acceleration_ratio, n)
    call fill(own%last_ratio, n)
    call fill(own%slope, n)
    call fill(own%bend, n)
    call fill(own%release, n)
    call fill(own%thermal, n)
    call fill(own%thermal_energy, n)
    call fill(own%carried, n)
    call fill(own%jump_rate, n)
    call fill_modal(own%modal, n)
  end subroutine fill_motion

  !> Motion of a reduced model.
  subroutine fill_modal(own, n)
    type(modal_motion), intent(inout) :: own
    integer, intent(inout) :: n
    allocate (own%start(4), own%start_traction(3, 4), own%start_factor(2), own%y(3), own%rate(3), &
              own%acceleration(3), own%port(5), own%port_rate(5), own%port_acceleration(5), &
              own%rest(5), own%rest_rate(5), own%rest_acceleration(5))
    call fill(own%start, n)
    call fill(own%start_traction, n)
    call fill(own%start_factor, n)
    call fill(own%y, n)
    call fill(own%rate, n)
    call fill(own%acceleration, n)
    call fill(own%port, n)
    call fill(own%port_rate, n)
    call fill(own%port_acceleration, n)
    call fill(own%rest, n)
    call fill(own%rest_rate, n)
    call fill(own%rest_acceleration, n)
    own%is_expanded = .true.
  end subroutine fill_modal

  !> What is known of a reduced model.
  subroutine fill_reduction(reduction, n)
    type(reduction_status), intent(inout) :: reduction
    integer, intent(inout) :: n
    call fill(reduction%num_shapes, n)
    call fill(reduction%num_modes, n)
    call fill(reduction%highest, n)
    call fill(reduction%estimate, n)
    call fill(reduction%num_broken, n)
  end subroutine fill_reduction

  !> The last matrix.
  subroutine fill_matrix(matrix, n)
    type(last_matrix), intent(inout) :: matrix
    integer, intent(inout) :: n
    call fill(matrix%number, n)
    matrix%is_elastic = .false.
    matrix%is_symmetric = .false.
    call fill(matrix%has_all_blocks, n)
    call fill(matrix%increment_size, n)
    allocate (matrix%lost(5))
    call fill(matrix%lost, n)
  end subroutine fill_matrix

  !> History of a joint.
  subroutine fill_joint(history, n)
    type(joint_state), intent(inout) :: history
    integer, intent(inout) :: n
    allocate (history%gap(2), history%shift(2), history%jump(3, 2), history%traction(3, 2), &
              history%slip(2, 2), history%is_broken(2), history%status(2), &
              history%num_openings(2), history%friction_work(2), history%fracture_work(2), &
              history%internal(2, 2), history%water(2), history%lets_water_in(2), &
              history%origin(3, 2), history%phase(2), history%is_pressed(2), &
              history%part_origin(3, 2, 2))
    call fill(history%gap, n)
    call fill(history%shift, n)
    call fill(history%jump, n)
    call fill(history%traction, n)
    call fill(history%slip, n)
    call fill(history%is_broken, n)
    call fill(history%status, n)
    call fill(history%num_openings, n)
    call fill(history%friction_work, n)
    call fill(history%fracture_work, n)
    call fill(history%internal, n)
    call fill(history%water, n)
    call fill(history%lets_water_in, n)
    call fill(history%origin, n)
    call fill(history%phase, n)
    call fill(history%is_pressed, n)
    call fill(history%part_origin, n)
  end subroutine fill_joint

  !> Points of a block.
  subroutine fill_points(points, n)
    type(point_state), intent(inout) :: points
    integer, intent(inout) :: n
    allocate (points%strain(6, 5), points%stress(6, 5), points%internal(7, 5), &
              points%energy(3, 5), points%gradient(3, 3, 5), points%is_elastic(5), &
              points%temperature(5), points%thermal(6, 5))
    call fill(points%strain, n)
    call fill(points%stress, n)
    call fill(points%internal, n)
    call fill(points%energy, n)
    call fill(points%gradient, n)
    call fill(points%is_elastic, n)
    call fill(points%temperature, n)
    call fill(points%thermal, n)
  end subroutine fill_points
end module full_state
