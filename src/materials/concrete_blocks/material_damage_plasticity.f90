!> Plastic-damage concrete (paper, section 3; theory.md, 11) as a material of the deck, with the
!> internal variables of damage_history.
module material_damage_plasticity
  use damage_checks, only: find_table_faults, table_fault
  use damage_constants, only: concrete_constants
  use damage_increment, only: elastic_stress
  use damage_history, only: last_backbone, last_damage, last_measure, last_strain, pack_history, &
                            unpack_history, width_row
  use damage_loops, only: find_plain_stresses, has_plain_stress, screen_adjacent
  use damage_model, only: concrete_model, make_concrete_model, placed_curves, stiffness_of
  use damage_point, only: update_point
  use damage_states, only: point_answer, point_history, point_motion
  use damage_work, only: complete_energies
  use errors, only: deck_is_wrong, error_type, raise
  use kinds, only: rk
  use material_law, only: stress_law
  use material_points, only: created_energy, crushing_energy, fracture_energy, no_tangent, &
                             point_set, point_state, secant_tangent, stored_energy, &
                             time_increment, update_report
  use write_text, only: as_text
  implicit none
  private
  public :: concrete_law, make_concrete_law

  type, extends(stress_law) :: concrete_law
    type(concrete_model) :: model
  contains
    procedure :: elastic_stiffness
    procedure :: update
    procedure :: read_field
    procedure :: find_stiffness_factors
  end type concrete_law

contains

  !> Makes the law from constants; an error if their tables have faults.
  subroutine make_concrete_law(constants, law, error)
    type(concrete_constants), intent(in) :: constants
    type(concrete_law), intent(out) :: law
    type(error_type), allocatable, intent(out) :: error
    type(table_fault), allocatable :: faults(:)
    call find_table_faults(constants, faults)
    if (size(faults) > 0) then
      call raise(error, '*'//faults(1)%keyword//', row '//as_text(faults(1)%row)//': '// &
                 faults(1)%problem//'; expected '//faults(1)%expected, deck_is_wrong)
      return
    end if
    call make_concrete_model(constants, law%model)
    law%is_nonlinear = .true.
    law%defers_energy = .true.
    law%has_switch = constants%recovery == 'SIGN'
    law%has_free_energy = law%model%splits_energy
    law%num_state = num_state_of(constants%viscosity)
  end subroutine make_concrete_law

  !> Number of internal variables of a point.
  pure integer function num_state_of(viscosity)
    real(rk), intent(in) :: viscosity !< [s]
    num_state_of = merge(last_backbone, width_row, viscosity > 0.0_rk)
  end function num_state_of

  !> Undamaged stiffness.
  pure subroutine elastic_stiffness(self, d)
    class(concrete_law), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    call stiffness_of(self%model, d)
  end subroutine elastic_stiffness

  !> Updates virgin points that are certainly elastic at once, the others one by one. Stresses alone
  !> start from trial states of all others at once.
  subroutine update(self, points, time, old, new, tangent, report)
    class(concrete_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    type(point_motion) :: motion
    type(point_answer) :: answer
    type(placed_curves) :: placed
    real(rk), dimension(points%num_points) :: factor, stored
    real(rk) :: d(6, 6)
    logical, dimension(points%num_points) :: has_answer, has_energy, is_new
    integer :: i
    if (time%is_updated .and. has_plain_stress(self%model)) then
      call add_energies(self%model, points,.not. new%is_elastic, old, new)
      return
    end if
    factor = 1.0_rk
    if (self%model%tension%longest < huge(1.0_rk)) then
      factor = min(1.0_rk, sqrt(self%model%tension%longest/points%widest))
    end if
    has_answer = .false.
    if (allocated(time%stays)) has_answer = time%stays
    call screen_runs(self%model,.not. has_answer, factor, old, new, stored)
    motion%time = time%size
    motion%wants_tangent = time%tangent /= no_tangent
    motion%is_secant = time%tangent == secant_tangent
    motion%holds_switch = time%holds_switches
    motion%wants_energy = time%wants_energy
    if (motion%wants_tangent) call self%elastic_stiffness(d)
    do i = 1, points%num_points
      if (has_answer(i)) cycle
      has_answer(i) = new%is_elastic(i) .and. old%is_elastic(i)
      if (.not. has_answer(i)) cycle
      new%energy(stored_energy, i) = stored(i)
      if (motion%wants_tangent) tangent(:, :, i) = d
    end do
    has_energy = has_answer
    if (has_plain_stress(self%model) .and. .not. motion%wants_tangent) then
      call find_plain_stresses(self%model, points, old, placed, new, has_answer)
      is_new = has_answer .and. .not. (has_energy .or. new%is_elastic)
      if (motion%wants_energy) call add_energies(self%model, points, is_new, old, new)
    end if
    do i = 1, points%num_points
      if (has_answer(i)) cycle
      has_energy(i) = motion%wants_energy
      motion%edges = points%edges(:, :, i)
      call yield_point(self%model, motion, i, old, placed, new, answer)
      if (motion%wants_tangent) tangent(:, :, i) = answer%tangent
      if (answer%has_converged .or. report%failed_point > 0) cycle
      report%failed_point = i
      report%message = 'no convergence of concrete at a point, for a change of strain of '// &
                       as_text(maxval(abs(new%strain(:, i) - old%strain(:, i))))// &
                       ' in the increment'
    end do
    call store_elastic_energies(has_energy, new)
  end subroutine update

  !> Energies of points that have turned out to be elastic: those of others are completed later.
  pure subroutine store_elastic_energies(has_energy, new)
    logical, intent(in) :: has_energy(:) !< (points)
    type(point_state), intent(inout) :: new
    integer :: i
    do i = 1, size(has_energy)
      if (has_energy(i) .or. .not. new%is_elastic(i)) cycle
      new%energy(stored_energy, i) = 0.5_rk*dot_product(new%stress(:, i), new%strain(:, i))
    end do
  end subroutine store_elastic_energies

  !> Energies of points that have yielded or cracked, and whose stress and history are known.
  pure subroutine add_energies(model, points, is_wanted, old, new)
    type(concrete_model), intent(in) :: model
    type(point_set), intent(in) :: points
    logical, intent(in) :: is_wanted(:) !< (points)
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new !< with stresses and histories
    type(point_motion) :: motion
    type(point_history) :: before, after
    type(point_answer) :: answer
    type(placed_curves) :: placed
    integer :: i
    do i = 1, points%num_points
      if (.not. is_wanted(i)) cycle
      if (model%splits_energy .and. .not. flows(old%internal(:, i), new%internal(:, i))) then
        new%energy(stored_energy, i) = 0.5_rk*dot_product(new%stress(:, i), new%strain(:, i) &
                                                          - new%internal(:last_strain, i))
        cycle
      end if
      motion%before = old%strain(:, i)
      motion%strain = new%strain(:, i)
      motion%edges = points%edges(:, :, i)
      call unpack_history(old%internal(:, i), before)
      call unpack_history(new%internal(:, i), after)
      answer = point_answer(stress=new%stress(:, i))
      call complete_energies(model, motion, before, after, placed, answer)
      call take_energies(answer, old%energy(:, i), new%energy(:, i))
    end do
  end subroutine add_energies

  !> Whether the plastic strain of a point has changed.
  pure logical function flows(old, new)
    real(rk), intent(in) :: old(:), new(:) !< internal variables at both ends of the increment
    flows = any(abs(new(:last_strain) - old(:last_strain)) > 0.0_rk)
  end function flows

  !> Writes the energies at the end of an increment.
  pure subroutine take_energies(answer, old, new)
    type(point_answer), intent(in) :: answer
    real(rk), intent(in) :: old(:) !< (num_energies) [J/m3]
    real(rk), intent(inout) :: new(:) !< (num_energies) [J/m3]
    new(stored_energy) = answer%stored
    new(fracture_energy) = old(fracture_energy) + answer%fracture
    new(crushing_energy) = old(crushing_energy) + answer%crushing
    new(created_energy) = old(created_energy) + answer%created
  end subroutine take_energies

  !> Screens the points that change, in runs of adjacent ones; they begin with the old history.
  pure subroutine screen_runs(model, changes, factor, old, new, stored)
    type(concrete_model), intent(in) :: model
    logical, intent(in) :: changes(:) !< (points)
    real(rk), intent(in) :: factor(:) !< (points) as in screen_adjacent
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new !< all is set but strains
    real(rk), intent(inout) :: stored(:) !< (points) [J/m3]
    integer :: first, last
    last = 0
    do
      first = last + findloc(changes(last + 1:), .true., 1)
      if (first == last) return
      last = findloc(changes(first:), .false., 1)
      last = merge(size(changes), first + last - 2, last == 0)
      call copy_values((last - first + 1)*size(old%internal, 1), old%internal(1, first), &
                       new%internal(1, first))
      call copy_values((last - first + 1)*size(old%energy, 1), old%energy(1, first), &
                       new%energy(1, first))
      call screen_adjacent(model, factor(first:last), new%strain(:, first:last), &
                           new%stress(:, first:last), stored(first:last), &
                           new%is_elastic(first:last))
    end do
  end subroutine screen_runs

  !> Copies adjacent numbers.
  pure subroutine copy_values(num_values, from, to)
    integer, intent(in) :: num_values
    real(rk), intent(in) :: from(num_values)
    real(rk), intent(inout) :: to(num_values)
    to = from
  end subroutine copy_values

  !> Updates a point that may yield or has yielded.
  pure subroutine yield_point(model, motion, i, old, placed, new, answer)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(inout) :: motion !< on entry without strains
    integer, intent(in) :: i !< point
    type(point_state), intent(in) :: old
    type(placed_curves), intent(inout) :: placed
    type(point_state), intent(inout) :: new
    type(point_answer), intent(out) :: answer
    type(point_history) :: before, after
    motion%before = old%strain(:, i)
    motion%strain = new%strain(:, i)
    motion%stored = old%energy(stored_energy, i)
    call unpack_history(old%internal(:, i), before)
    call update_point(model, motion, before, placed, after, answer)
    call pack_history(after, new%internal(:, i))
    new%stress(:, i) = answer%stress
    new%is_elastic(i) = answer%is_elastic
    call take_energies(answer, old%energy(:, i), new%energy(:, i))
  end subroutine yield_point

  !> PE, DAMAGET, DAMAGEC, SDV.
  subroutine read_field(self, name, state, values)
    class(concrete_law), intent(in) :: self
    character(*), intent(in) :: name
    type(point_state), intent(in) :: state
    real(rk), allocatable, intent(out) :: values(:, :)
    select case (name)
    case ('PE')
      values = state%internal(:last_strain, :)
    case ('DAMAGET')
      values = state%internal(last_measure + 1:last_measure + 1, :)
    case ('DAMAGEC')
      values = state%internal(last_damage:last_damage, :)
    case ('SDV')
      values = state%internal(:self%num_state, :)
    case default
      return
    end select
  end subroutine read_field

  !> Norm of the stress over that of the effective stress. At zero stress the factor is 1.
  subroutine find_stiffness_factors(self, state, factor)
    class(concrete_law), intent(in) :: self
    type(point_state), intent(in) :: state
    real(rk), intent(out) :: factor(:)
    real(rk) :: effective
    integer :: i
    do i = 1, size(factor)
      factor(i) = 1.0_rk
      if (state%is_elastic(i)) cycle
      effective = size_of(elastic_stress(self%model, state%strain(:, i) &
                                         - state%internal(:last_strain, i)))
      if (effective > 0.0_rk) factor(i) = min(1.0_rk, size_of(state%stress(:, i))/effective)
    end do
  end subroutine find_stiffness_factors

  !> Norm of a stress tensor, the same in all axes: shear stresses stand in it twice [Pa].
  pure real(rk) function size_of(stress)
    real(rk), intent(in) :: stress(6) !< 11, 22, 33, 12, 13, 23 [Pa]
    size_of = sqrt(sum(stress(:3)**2) + 2.0_rk*sum(stress(4:)**2))
  end function size_of
end module material_damage_plasticity
