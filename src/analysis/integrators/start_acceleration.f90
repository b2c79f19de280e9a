!> The acceleration that a dynamic step starts with, with or without mass everywhere.
module start_acceleration
  use kinds, only: rk
  use errors, only: error_type, raise, system_failed
  use global_vectors, only: norm
  use problem_definition, only: problem
  use analysis_state, only: state
  use joint_law, only: joint_state, state_open
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use step_system, only: dam_system
  use initial_acceleration, only: find_acceleration
  use massless_acceleration, only: find_constrained_acceleration, find_weight, leave_out_fast
  use massless_solids, only: has_massless
  use matrix_pattern, only: pattern
  use ranks, only: largest_of_ranks, text_of_rank, this_rank
  use step_plan, only: step
  implicit none
  private
  public :: find_start

  !> Growth of the share of stiffness from one trial to the next, and trials. A static force on
  !> massless parts leaves round-off that falls with the square of the share; the iteration grows.
  real(rk), parameter :: growth = 10.0_rk
  integer, parameter :: most_trials = 4
  !> Circular frequency times increment above which motions start as those without mass do. A motion
  !> whose period is two increments has pi.
  real(rk), parameter :: fastest_motion = 30.0_rk

contains

  !> Acceleration of all unknowns under the forces r. Open points of joints hold nothing; where a
  !> massless part has no other hold, all points are taken as closed, as they are in K_eff.
  subroutine find_start(model, system, plan, now, r, a, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(step), intent(in) :: plan
    type(state), intent(in) :: now !< at the start of the step
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk), intent(out) :: a(:) !< (num_total) [m/s2]
    type(error_type), allocatable, intent(out) :: error
    logical :: is_definite
    is_definite = .false.
    ! M of solids without mass may have a diagonal of masses, of joints and ties, and be singular.
    if (.not. has_massless(model)) call find_acceleration(system%matrix, system%mass, r, a, &
                                                          is_definite)
    if (is_definite) return
    a = 0.0_rk
    if (is_balanced(system%matrix, plan, now, r)) return
    call find_constrained(model, system, plan%first_increment, now, r, a, error)
  end subroutine find_start

  !> The same where parts have no mass.
  subroutine find_constrained(model, system, dt, now, r, a, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: dt !< first increment [s]
    type(state), intent(in) :: now !< at the start of the step
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk), intent(inout) :: a(:) !< (num_total) [m/s2]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: stiffness(:)
    character(:), allocatable :: place
    real(rk) :: eps
    logical :: leaves_open
    integer :: trial, worst
    call find_weight(system%matrix, system%mass, system%stiffness, eps)
    if (.not. eps > 0.0_rk) return ! no mass anywhere
    leaves_open = .true.
    do
      call add_closed_joints(model, system, now%joints, leaves_open, stiffness)
      do trial = 1, most_trials
        call find_constrained_acceleration(system%matrix, system%mass, system%mass &
                                           + growth**(trial - 1)*eps*stiffness, &
                                           now%motion%external, r, a, worst, error)
        if (is_final(worst, error)) exit
        if (allocated(error)) exit ! a part is free, whatever the share
      end do
      if (is_final(worst, error) .or. .not. leaves_open) exit
      leaves_open = .false.
    end do
    if (.not. is_final(worst, error)) then
      place = text_of_place(model, system, worst)
      if (place /= '') call name_place(place, error) ! else the error of a divided matrix
    else if (.not. allocated(error)) then
      call leave_out_fast(system%matrix, system%mass, (dt/fastest_motion)**2, stiffness, a, error)
    end if
  end subroutine find_constrained

  !> The place of an unknown in words, from the rank that has it; '' where none has one.
  function text_of_place(model, system, unknown) result(text)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    integer, intent(in) :: unknown !< -1 on other ranks
    character(:), allocatable :: text
    integer :: rank
    text = ''
    if (unknown > 0) text = system%numbers%describe(unknown, model%mesh%node_id)
    rank = largest_of_ranks(merge(this_rank(), -1, unknown > 0))
    if (rank >= 0) text = text_of_rank(rank, text)
  end function text_of_place

  !> Whether other joints would not help: an acceleration is found, or the system has failed. A
  !> divided matrix that is singular has an error without a place.
  pure logical function is_final(worst, error)
    integer, intent(in) :: worst !< unknown of the place, 0 for none, -1 on another rank
    type(error_type), allocatable, intent(in) :: error
    is_final = worst == 0
    if (allocated(error)) is_final = error%exit_code == system_failed
  end function is_final

  !> Whether the forces balance as well as an increment of the step must balance them: what is left
  !> is the residual of the step before, and not worth a factor. The first increment balances it.
  !> Without loads massless parts that nothing holds would not be found.
  logical function is_balanced(matrix, plan, now, r)
    type(pattern), intent(in) :: matrix
    type(step), intent(in) :: plan
    type(state), intent(in) :: now !< at the start of the step
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk) :: size_of_load, size_of_rest, largest
    associate (n => matrix%num_free, part => matrix%part)
      size_of_load = norm(part, now%motion%external(:n))
      size_of_rest = norm(part, r(:n))
      largest = max(size_of_load, now%largest_force)
    end associate
    is_balanced = size_of_load > 0.0_rk &
                  .and. size_of_rest <= plan%controls%residual_tolerance*largest
  end function is_balanced

  !> Error: a massless part that nothing holds, or an iteration that does not converge.
  subroutine name_place(place, error)
    character(*), intent(in) :: place
    type(error_type), allocatable, intent(inout) :: error !< allocated: P cannot be factored
    logical :: is_free
    is_free = allocated(error)
    if (is_free) deallocate (error)
    if (is_free) then
      call raise(error, 'no initial acceleration at '//place//': a part without mass is free '// &
                 'to move; add supports, connect the part by a tie or a joint, or give its '// &
                 'material a *DENSITY')
    else
      call raise(error, 'no initial acceleration: the iteration does not converge at '//place// &
                 '; give massless parts a small *DENSITY')
    end if
  end subroutine name_place

  !> Values of K with the joints.
  subroutine add_closed_joints(model, system, joints, leaves_open, stiffness)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(joint_state), intent(in) :: joints(:)
    logical, intent(in) :: leaves_open !< open points have no stiffness
    real(rk), allocatable, intent(out) :: stiffness(:)
    real(rk), allocatable :: k(:, :)
    integer :: j
    call reference_stiffness(model%joints, system%operator, k)
    do j = 1, merge(size(joints), 0, leaves_open)
      associate (first => system%operator%first_point(j), &
                 last => system%operator%first_point(j + 1) - 1)
        where (spread(joints(j)%status == state_open, 1, 3)) k(:, first:last) = 0.0_rk
      end associate
    end do
    stiffness = system%stiffness
    call system%operator%add_stiffness(closed_tangent(k), system%matrix, stiffness)
  end subroutine add_closed_joints
end module start_acceleration
