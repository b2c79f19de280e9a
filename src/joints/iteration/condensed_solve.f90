!> One solve of the condensed equilibrium (theory.md, 8): Newton's method on the jumps between
!> forward and backward substitution.
submodule(condensation) condensed_solve
  implicit none

  !> Most corrections for the blocks of G that are left out.
  integer, parameter :: most_passes = 25
  !> Passes in statics end where the drift of one from the fourth on is more than half of that
  !> before.
  integer, parameter :: patience = 4
  real(rk), parameter :: stalled = 0.5_rk
  !> Residual of a rough equilibrium, over the largest residual or the drift before: what the blocks
  !> of G that are left out change anyway, in statics and in time.
  real(rk), parameter :: rough_in_statics = 1.0e-2_rk, rough_in_time = 2.0e-4_rk
  !> A drift that is expected to be so small, over the admissible one, is not computed.
  real(rk), parameter :: sure_share = 0.1_rk
  !> The same for what is left out of G: the drift is some ten times as large.
  real(rk), parameter :: small_share = 0.01_rk
  !> Admissible residual of the response to a change of the joint forces, over this change. The
  !> blocks learn from the response: that to a small change needs as many digits as any other. A
  !> solve by iteration leaves a hundredth of an admissible residual.
  real(rk), parameter :: share_of_change = 1.0e-6_rk

  !> Passes of the iteration on jumps; each starts from the exact jumps at the forces of the last.
  type :: pass_history
    real(rk) :: rough = 0.0_rk !< residual of a rough equilibrium over the drift
    real(rk) :: drift(2) = 0.0_rk !< of the last pass and the one before
    logical :: has_stalled = .false.
    type(mixer) :: mixing !< Anderson's acceleration of the shift
    real(rk), allocatable :: shift(:) !< (rows) jumps by the blocks that are left out [m]
  end type pass_history

contains

  !> Newton's method on the jumps between forward and backward substitution, again while the
  !> blocks of G that are left out move the jumps. Without the Schur block it takes two full solves:
  !> one for the guess, one for the change.
  module subroutine solve_from(self, balance, joints, old, new, x, outcome, error)
    class(condensed_equilibrium), intent(inout), target :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in), target :: joints(:)
    type(joint_state), intent(in), target :: old(:)
    type(joint_state), intent(inout), target :: new(:)
    real(rk), intent(out) :: x(:)
    type(balance_outcome), intent(inout) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(joint_increment) :: now
    type(joint_field) :: start
    type(pass_history) :: passes
    real(rk), dimension(3, self%operator%num_points) :: excess, last_excess
    real(rk), allocatable :: half(:)
    integer :: pass, iterations
    iterations = outcome%iterations
    call now%view(self%controls, joints, self%operator, self%condensed%k_ref, old, new)
    call start_iteration(balance, self%condensed%scale, now)
    associate (k_ref => self%condensed%k_ref, operator => self%operator, field => now%field)
      last_excess = excess_traction(k_ref, field%jump, balance%offset, field%iterate)
      call begin_solve(self, balance, last_excess, half, x, error)
      if (allocated(error)) return
      call operator%jumps(x, field%response)
      field%response = field%response + balance%offset
      call start_passes(self, balance, passes)
      do pass = 1, most_passes
        call self%costs%start('iterate', 'joints', 'joint')
        if (self%controls%most_unsaved < huge(1)) start = field
        call iterate_on_jumps(self%condensed, now)
        call self%costs%stop()
        outcome = now%outcome
        if (outcome%iterations > self%controls%most_unsaved) then
          call save_increment(self, balance, joints, old, start, error)
          if (allocated(error)) return
        end if
        iterations = iterations + outcome%iterations
        outcome%iterations = iterations
        if (.not. outcome%has_converged) return
        excess = excess_traction(k_ref, field%jump, balance%offset, field%iterate)
        if (is_last_pass(self, passes)) exit
        call find_drift(self, balance, new, excess - last_excess, half, x, field, error)
        if (allocated(error)) return
        last_excess = excess
        if (field%drift <= self%admissible_drift() .and. .not. self%condensed%is_rough) exit
        passes%has_stalled = has_stalled(pass, passes, field)
        if (passes%has_stalled) exit
        call start_pass(self, field, passes)
        call linearise_again(self%condensed, now)
      end do
    end associate
    outcome%has_converged = pass <= most_passes .and. .not. passes%has_stalled
    if (.not. outcome%has_converged) then
      outcome%unmet = unmet_criterion(of_jumps, now%field%drift, self%admissible_drift())
    end if
    self%excess = excess
    call end_solve(self, balance%is_partial, excess - last_excess, half, x, error)
  end subroutine solve_from

  !> G as an operator takes the place of its blocks in products.
  subroutine connect_response(self, num_free)
    class(condensed_equilibrium), intent(inout), target :: self
    integer, intent(in) :: num_free !< unknowns
    if (.not. self%jumps%top%is_there) then
      self%solved%factor => self%factor
      self%solved%operator => self%operator
      self%solved%num_free = num_free
      self%solved%part = self%part
      self%condensed%blocks%exact => self%solved
      return
    end if
    self%response%jumps => self%jumps
    self%response%operator => self%operator
    self%response%num_total = num_free + self%num_held
    self%condensed%blocks%exact => self%response
  end subroutine connect_response

  !> Whether the drift hardly falls from pass to pass, as in statics where the blocks that are left
  !> out decide which points are open.
  pure logical function has_stalled(pass, passes, field)
    integer, intent(in) :: pass
    type(pass_history), intent(in) :: passes
    type(joint_field), intent(in) :: field
    has_stalled = field%is_static .and. pass >= patience &
                  .and. field%drift > stalled*passes%drift(1)
  end function has_stalled

  !> The first pass starts from the guess.
  subroutine start_passes(self, balance, passes)
    class(condensed_equilibrium), intent(inout), target :: self
    type(force_balance), intent(in) :: balance
    type(pass_history), intent(inout) :: passes
    if (self%uses_response) call connect_response(self, size(balance%rhs))
    self%condensed%keeps_factors = .false.
    self%condensed%rough_residual = 0.0_rk
    self%condensed%rough_share = 0.0_rk
    self%learns = .false.
    if (has_small_rest(self)) return
    self%learns = self%factor%has_patches() .and. .not. balance%is_static
    passes%rough = merge(rough_in_statics, rough_in_time, balance%is_static)
    self%condensed%rough_share = passes%rough
    allocate (passes%shift(size(self%condensed%k_ref)), source=0.0_rk)
  end subroutine start_passes

  !> The next pass starts from the exact jumps. Anderson's acceleration adds what further passes
  !> would change, unless the blocks have learned it.
  subroutine start_pass(self, field, passes)
    class(condensed_equilibrium), intent(inout) :: self
    type(joint_field), intent(inout) :: field !< its response is exact
    type(pass_history), intent(inout) :: passes
    real(rk), dimension(size(field%jump)) :: change, last
    if (.not. field%is_static) self%num_passes = self%num_passes + 1
    self%condensed%keeps_factors = .true.
    self%condensed%rough_share = 0.0_rk
    self%condensed%rough_residual = passes%rough*field%drift
    passes%drift = [field%drift, passes%drift(1)]
    if (self%learns) return
    change = reshape(field%response - field%jump, [size(change)])
    last = passes%shift
    call passes%mixing%advance(change, passes%shift)
    field%response = field%response + reshape(passes%shift - last - change, shape(field%response))
  end subroutine start_pass

  !> Whether no drift is left to be expected. The solution is checked for a drift in any case.
  logical function is_last_pass(self, passes)
    class(condensed_equilibrium), intent(in) :: self
    type(pass_history), intent(in) :: passes
    is_last_pass = has_small_rest(self)
    if (is_last_pass .or. self%condensed%is_rough) return
    associate (last => passes%drift(1), before => passes%drift(2))
      is_last_pass = 0.0_rk < before .and. last < before .and. &
                     last**2 <= sure_share*self%admissible_drift()*before
    end associate
  end function is_last_pass

  !> Whether what is left out of G moves the jumps less than a solution may drift.
  pure logical function has_small_rest(self)
    class(condensed_equilibrium), intent(in) :: self
    has_small_rest = associated(self%condensed%blocks%exact) .or. &
                     self%condensed%blocks%left_out <= small_share*self%admissible_drift()
  end function has_small_rest

  !> Saves an increment as a problem of its own (--save-joint-problems).
  subroutine save_increment(self, balance, joints, old, start, error)
    class(condensed_equilibrium), intent(in) :: self
    type(force_balance), intent(in) :: balance
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), intent(in) :: old(:)
    type(joint_field), intent(in) :: start !< of the iteration
    type(error_type), allocatable, intent(out) :: error
    type(saved_operator) :: common
    type(saved_problem) :: problem
    character(:), allocatable :: path
    path = free_path(self%controls%stem_of_problems)
    if (len(path) == 0) return
    common%weight = self%weight
    common%compliance = self%condensed%blocks%as_dense()
    common%operator = self%operator
    problem = saved_problem(self%controls, joints, old, balance, &
                            closed_response(self%condensed, self%operator%area, start))
    problem%balance%guess = start%jump
    problem%balance%guess_traction = start%multiplier
    call save_problem(path, common, problem, error)
  end subroutine save_increment

  !> Jumps by the Schur block or a solve after a pass, and how far they are from those of the blocks
  !> of G.
  subroutine find_drift(self, balance, new, change, half, x, field, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    type(joint_state), intent(in) :: new(:)
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), allocatable, intent(inout) :: half(:) !< (free unknowns) after forward substitution
    !> (all unknowns) solution with the last excess; with a Schur block its jumps alone
    real(rk), intent(inout) :: x(:)
    type(joint_field), intent(inout) :: field
    type(error_type), allocatable, intent(out) :: error
    call self%costs%start('correct', 'joints', 'joint')
    if (self%jumps%is_there) then
      call add_to_half(self, change, half, x, error)
      x = 0.0_rk
      if (.not. allocated(error)) call self%jumps%store_jumps(half, x, error)
      if (allocated(self%base)) x(:size(half)) = x(:size(half)) + self%base
    else
      call add_response(self, change, x, error)
    end if
    if (.not. allocated(error)) then
      call self%operator%jumps(x, field%response)
      field%response = field%response + balance%offset
      field%drift = self%jump_drift(balance, new, field%response - field%jump)
    end if
    call self%costs%stop()
  end subroutine find_drift

  !> Adds joint forces to a forward substitution.
  subroutine add_to_half(self, change, half, work, error)
    class(condensed_equilibrium), intent(in) :: self
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), intent(inout) :: half(:) !< (free unknowns) after forward substitution
    real(rk), intent(out) :: work(:) !< (all unknowns) forces [N]
    type(error_type), allocatable, intent(out) :: error
    work = 0.0_rk
    call self%operator%add_forces(self%weight*change, work)
    call self%jumps%add_jump_forces(work, half, error)
  end subroutine add_to_half

  !> Adds the response to a change of the joint forces by a solve.
  subroutine add_response(self, change, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), intent(inout) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: correction(size(x)), no_load(size(x) - self%num_held), share
    if (.not. any(abs(change) > 0.0_rk)) return
    no_load = 0.0_rk
    share = 1.0_rk
    if (self%learns .and. .not. self%exact%is_rounded()) share = share_of_change
    call respond(self, no_load, change, share, correction, error)
    if (allocated(error)) return
    x = x + correction
    if (self%learns) call learn(self, change, correction)
  end subroutine add_response

  !> The blocks learn what they leave out of the response to a change. Jumps of the response alone
  !> have more digits than the difference of two solutions.
  subroutine learn(self, change, response)
    class(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), intent(in) :: response(:) !< (all unknowns)
    real(rk), dimension(3, size(change, 2)) :: force, jump
    force = self%weight*change*spread(self%operator%area, 1, 3)
    call self%operator%jumps(response, jump)
    call self%condensed%blocks%learn(reshape(force, [size(force)]), reshape(jump, [size(jump)]))
  end subroutine learn

  !> Response to the guess: forward substitution and jumps, or all unknowns.
  subroutine begin_solve(self, balance, excess, half, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    type(force_balance), intent(in) :: balance
    real(rk), intent(in) :: excess(:, :) !< (3, points) [Pa]
    real(rk), allocatable, intent(out) :: half(:) !< (free unknowns) after forward substitution
    real(rk), intent(out) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%jumps%is_there) then
      call respond(self, balance%rhs, excess, 1.0_rk, x, error)
      return
    end if
    x = 0.0_rk
    call self%operator%add_forces(self%weight*excess, x)
    half = balance%rhs + x(:size(balance%rhs))
    call self%costs%start('solve forward', 'structure', 'solver')
    if (self%exact%is_rounded()) call subtract_base(self, half)
    if (self%repeated%is_there(self%factor)) then
      if (.not. balance%is_repeated) then
        call self%repeated%start(self%factor, self%admissible, half, error)
      end if
      if (.not. allocated(error)) call self%repeated%forward(self%factor, half, error)
    else
      call self%factor%forward_substitute(half, error)
    end if
    x = 0.0_rk
    if (.not. allocated(error)) call self%jumps%store_jumps(half, x, error)
    if (allocated(self%base)) x(:size(half)) = x(:size(half)) + self%base
    call self%costs%stop()
  end subroutine begin_solve

  !> Subtracts the forces of the base, which is predicted where there is no solution yet.
  subroutine subtract_base(self, b)
    type(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(inout) :: b(:) !< (free unknowns) [N]
    if (.not. allocated(self%base)) then
      allocate (self%base(size(b)), self%base_force(size(b)))
      call self%exact%predict(b, self%base, self%base_force)
    end if
    b = b - self%base_force
  end subroutine subtract_base

  !> All unknowns, with the change of the joint forces since the guess.
  subroutine end_solve(self, is_partial, change, half, x, error)
    class(condensed_equilibrium), intent(inout) :: self
    logical, intent(in) :: is_partial !< active unknowns alone
    real(rk), intent(in) :: change(:, :) !< (3, points) of the excess traction [Pa]
    real(rk), allocatable, intent(inout) :: half(:)
    real(rk), intent(inout) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (self%jumps%is_there) then
      call self%costs%start('solve backward', 'structure', 'solver')
      call add_to_half(self, change, half, x, error)
      x = 0.0_rk
      if (.not. allocated(error)) then
        if (self%repeated%is_there(self%factor)) then
          call self%repeated%backward(self%factor, half, is_partial, x(:size(half)), error)
        else
          call self%factor%backward_substitute(half, error)
          x(:size(half)) = half
        end if
      end if
      if (allocated(self%base)) x(:size(half)) = x(:size(half)) + self%base
      call self%costs%stop()
    else
      call add_response(self, change, x, error)
    end if
  end subroutine end_solve

  !> x = K_0^-1 (rhs + weight*B^T area*excess).
  subroutine respond(self, rhs, excess, share, x, error)
    type(condensed_equilibrium), intent(inout) :: self
    real(rk), intent(in) :: rhs(:) !< (free unknowns)
    real(rk), intent(in) :: excess(:, :) !< (3, points) [Pa]
    real(rk), intent(in) :: share !< most that the residual may be, over the forces
    real(rk), intent(out) :: x(:) !< (all unknowns)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    x = 0.0_rk
    call self%operator%add_forces(self%weight*excess, x)
    b = reshape(rhs + x(:size(rhs)), [size(rhs), 1])
    call self%costs%start('solve', 'structure', 'solver')
    call self%solve_with_factor(min(self%admissible, share*norm(self%part, b(:, 1))), b, error)
    call self%costs%stop()
    x = 0.0_rk
    x(:size(rhs)) = b(:, 1)
  end subroutine respond
end submodule condensed_solve
