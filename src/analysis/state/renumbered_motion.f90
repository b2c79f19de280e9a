!> Motion and forces at the end of a step in the unknowns of the next step, whose supports are
!> others (theory.md, 7.1, "Steps in a row").
module renumbered_motion
  use analysis_state, only: motion
  use constraint_elimination, only: number_step
  use dof_numbering, only: numbering
  use errors, only: error_type
  use kinds, only: rk
  use problem_definition, only: problem
  use ranks, only: is_true_everywhere
  use step_plan, only: step_before, step_fixity
  implicit none
  private
  public :: renumber

  !> Difference of two coefficients that are the same.
  real(rk), parameter :: same_coefficient = 1.0e-12_rk

contains

  !> Puts the motion of the step before into the order of the new unknowns. A support that has gone
  !> leaves its reaction as a load, so that the forces of the old step stay in balance: joints act
  !> by the tractions t* that they pass on. Where other displacements depend on others than before,
  !> nothing is left of the old motion.
  subroutine renumber(model, number, numbers, passed_on, last)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    type(numbering), intent(in) :: numbers !< of the step
    real(rk), intent(in) :: passed_on(:) !< (num_total) forces of the joints by t* [N]
    type(motion), intent(inout) :: last !< at the end of the step before
    type(numbering) :: old
    type(motion) :: none
    type(error_type), allocatable :: error
    integer, allocatable :: place(:)
    integer :: before
    before = step_before(model%steps, number)
    if (before == 0 .or. .not. allocated(last%viscous_rate)) return
    if (model%steps(number)%changes_stage) return
    if (has_same_supports(model%steps(before)%fixities, model%steps(number)%fixities)) return
    call number_step(model%mesh, model%joints, model%guests, model%steps(before)%fixities, old, &
                     error)
    if (.not. allocated(error) .and. old%num_total == size(last%q)) then
      call match(old, numbers, place)
    end if
    if (is_true_everywhere(allocated(place))) then
      call take_places(place, last)
      call release_supports(place > old%num_free, passed_on, last)
    else
      last = none
    end if
  end subroutine renumber

  !> Whether two steps hold the same displacements.
  pure logical function has_same_supports(old, new) result(is_same)
    type(step_fixity), intent(in) :: old(:), new(:)
    is_same = size(old) == size(new)
    if (is_same) is_same = all(old%node == new%node .and. old%dof == new%dof)
  end function has_same_supports

  !> The old unknown of each new one; not allocated where some unknowns have no counterpart, or
  !> displacements depend on others than before.
  subroutine match(old, new, place)
    type(numbering), intent(in) :: old, new
    integer, allocatable, intent(out) :: place(:) !< (num_total)
    logical :: is_same
    if (old%num_total /= new%num_total .or. size(old%unknown) /= size(new%unknown)) return
    place = new%places_in(old)
    is_same = all(place > 0) .and. all(old%row_start == new%row_start)
    if (is_same) is_same = all(place(new%unknown) == old%unknown) &
                           .and. all(abs(new%coefficient - old%coefficient) <= same_coefficient)
    if (.not. is_same) deallocate (place)
  end subroutine match

  !> Adds the reactions to the loads.
  pure subroutine release_supports(was_held, passed_on, last)
    logical, intent(in) :: was_held(:) !< (num_total)
    real(rk), intent(in) :: passed_on(:) !< (num_total) [N]
    type(motion), intent(inout) :: last
    where (was_held)
      last%external = last%internal + passed_on + last%viscous + last%inertia
      last%balanced = last%inertia
    end where
    if (.not. allocated(last%carried_correction)) return
    where (was_held) last%carried_correction = 0.0_rk ! the motion of a support does not have it
  end subroutine release_supports

  !> Reorders all vectors over the unknowns.
  pure subroutine take_places(place, last)
    integer, intent(in) :: place(:) !< (num_total)
    type(motion), intent(inout) :: last
    last%q = last%q(place)
    last%v = last%v(place)
    last%a = last%a(place)
    last%external = last%external(place)
    last%elastic = last%elastic(place)
    last%internal = last%internal(place)
    last%contact = last%contact(place)
    last%balanced = last%balanced(place)
    last%viscous = last%viscous(place)
    last%viscous_rate = last%viscous_rate(place)
    last%momentum = last%momentum(place)
    last%inertia = last%inertia(place)
    if (allocated(last%residual)) deallocate (last%residual) ! small; the free unknowns are others
    if (allocated(last%last_a)) last%last_a = last%last_a(place)
    if (allocated(last%lost_damping)) last%lost_damping = last%lost_damping(place)
    if (allocated(last%carried_correction)) then
      last%carried_correction = last%carried_correction(place)
    end if
  end subroutine take_places
end module renumbered_motion
