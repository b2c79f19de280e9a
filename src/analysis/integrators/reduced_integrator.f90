!> Dynamic steps with a reduced model of the linear structure (theory.md, 7.4): modes of the open
!> structure and the static response of the rest; the joints keep all their points.
module reduced_integrator
  use analysis_state, only: modal_motion, motion, reduction_status, state
  use dynamic_step, only: build_dynamic_step
  use energy_account, only: open_account
  use equilibrium, only: balance_outcome
  use errors, only: error_type, raise
  use global_vectors, only: dot, multiply, norm
  use hht_scheme, only: make_scheme
  use increment_listener, only: listener
  use integrator_type, only: integrator
  use joint_forces, only: gather_tractions
  use kinds, only: rk
  use massless_solids, only: has_massless
  use opening_error, only: count_broken
  use problem_definition, only: problem
  use reduced_basis, only: build_basis, reduced_model
  use reduced_energy, only: add_reduced_work
  use reduced_estimate, only: estimate_error
  use reduced_fields, only: expand_motion
  use reduced_increment, only: load_factors, modal_forces, take_reduced_increment
  use reduced_limits, only: refuse_size
  use reduced_nodes, only: find_followed, followed_nodes
  use reduced_ports, only: static_solvers
  use reduced_resume, only: resume_modes
  use reduced_scheme, only: reduced_matrices
  use reduced_shapes, only: find_shapes
  use solver_catalogue, only: make_solver, symmetric_solver
  use state_transfer, only: store_motion
  use step_equilibrium, only: make_equilibrium
  use step_loads, only: external_force, step_time
  use step_plan, only: step
  use step_system, only: dam_system
  use unknown_layout, only: direct_solver
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: make_reduced

  type, extends(integrator) :: reduced_method
    type(reduced_model) :: basis
    type(reduced_matrices) :: matrices !< of the present increment size
    type(followed_nodes) :: followed
    real(rk), allocatable :: force_norm(:) !< (loads) [N]
    type(static_solvers) :: solvers !< the first one is that of `solids`, which has none then
  contains
    procedure :: open_step
    procedure :: resume
    procedure :: start_increment
    procedure :: advance
    procedure :: store_state
  end type reduced_method

  !> Smallest shift of the stiffness, times the square of an increment: a period of 2000 increments.
  real(rk), parameter :: smallest_shift = 1.0e-5_rk

  !> Forces that are not balanced at the start of a step, over the internal forces, below which they
  !> are the remainder of an iteration.
  real(rk), parameter :: balanced_share = 1.0e-4_rk

  !> Modes of the first model, most modes, and growth from one model to the next.
  integer, parameter :: first_guess = 120, most_modes = 800
  real(rk), parameter :: least_growth = 1.3_rk, most_growth = 2.5_rk
  !> The error falls at least as quickly as this power of the number of modes.
  real(rk), parameter :: decay = 1.5_rk
  !> Unknowns for each mode from which on increments of the reduced model take less time than those
  !> of the full one, with few joints.
  integer, parameter :: worth_reducing = 20
  real(rk), parameter :: two_pi = 2.0_rk*acos(-1.0_rk)
  real(rk), parameter :: not_known = -1.0_rk !< an estimate that is not made

contains

  !> The method, before it has a step.
  subroutine make_reduced(method)
    class(integrator), allocatable, intent(out) :: method
    allocate (reduced_method :: method)
  end subroutine make_reduced

  !> Builds the equations of the step, then the reduced model.
  subroutine open_step(self, model, plan, now, results, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(modal_motion) :: loaded
    type(motion) :: last
    if (now%has_opened_step) loaded = now%motion%modal
    call build_dynamic_step(model, plan, self%system, self%solids, now, last, results, error)
    if (allocated(error)) return
    now%motion%modal = loaded
    ! Several ranks: shapes need all digits of their solves.
    if (self%system%matrix%is_shared) self%system%matrix%layout%solver = direct_solver
    call make_equilibrium(plan, self%system, .true., self%solids%solver, error)
    if (allocated(error)) return
    self%solids%solver%costs = results%costs
    call refuse_size(self%system, now, error)
    if (allocated(error)) return
    call take_solvers(self, model, results, error)
    if (allocated(error)) return
    call start_modal(self, model, plan, now)
    call build_model(self, model, plan, now, results, error)
    if (allocated(error)) return
    call find_followed(plan, self%system, self%basis, now%motion%modal%start, self%solvers, &
                       self%followed, error)
    if (allocated(error) .or. now%has_opened_step) return
    call open_account(model, self%system, now, now%total_time <= 0.0_rk, plan%changes_stage)
    call store_motion(model%mesh, self%system%numbers, now)
    call results%report_increment(model, now, error)
  end subroutine open_step

  !> Takes the motion of a checkpoint.
  subroutine resume(self, now, error)
    class(reduced_method), intent(inout) :: self
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    call resume_modes(self%basis, self%system, self%solvers, now, error)
  end subroutine resume

  !> Takes the solver of the step, and makes another one for massless solids where there are some.
  subroutine take_solvers(self, model, results, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    class(listener), intent(in) :: results
    type(error_type), allocatable, intent(out) :: error
    call move_alloc(self%solids%solver%factor, self%solvers%whole)
    self%solvers%costs = results%costs
    if (.not. has_massless(model)) return
    call make_solver(symmetric_solver, self%solvers%held, error, self%system%matrix%is_shared)
    if (allocated(error)) return
    call self%solvers%held%analyse(self%system%matrix, error)
  end subroutine take_solvers

  !> Where the step starts from, its loads and its forces that are not balanced. A continued run has
  !> the start in its state.
  subroutine start_modal(self, model, plan, now)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    type(step_time) :: when
    real(rk) :: contact(self%system%matrix%num_total)
    integer :: k, n
    when = step_time(is_dynamic=.true., start=now%step_start, duration=plan%duration)
    n = size(self%system%groups)
    associate (own => now%motion, modal => now%motion%modal, system => self%system)
      if (.not. allocated(modal%start)) then
        modal%start = own%q
        allocate (modal%start_traction(3, system%operator%num_points))
        call gather_tractions(system%operator, now%joints, modal%start_traction)
        if (allocated(own%carried)) modal%start_traction = own%carried
        allocate (modal%start_factor(n), source=0.0_rk)
        associate (factor => load_factors(system%groups, model%amplitudes, when, &
                                          modal%start_factor))
          modal%start_factor = factor(:n)
        end associate
      end if
      call external_force(system%groups, model%amplitudes, when, own%external)
      call system%find_elastic(modal%start, own%elastic)
      self%basis%start_traction = modal%start_traction
      contact = 0.0_rk
      call system%operator%add_forces(modal%start_traction, contact)
      allocate (self%basis%force(system%matrix%num_total, n + 2))
      do k = 1, n
        self%basis%force(:, k) = system%groups(k)%force
      end do
      self%basis%force(:, n + 1) = own%external - own%elastic - contact
      self%basis%force(:, n + 2) = own%elastic
      self%basis%force(system%matrix%num_free + 1:, n + 1:) = 0.0_rk ! reactions of supports
      self%force_norm = [(norm(self%basis%force(:, k)), k=1, n + 2)]
      self%basis%starts_balanced = self%force_norm(n + 1) <= balanced_share*self%force_norm(n + 2)
      now%largest_force = max(norm(own%external), norm(own%elastic), norm(contact))
      own%contact = contact
    end associate
  end subroutine start_modal

  !> Builds the reduced model, with more and more modes until the estimate of its error meets the
  !> accuracy. A continued run has as many as its state. Where the deck has the number of modes and
  !> ERROR ESTIMATE is OFF, the runs of the estimate are left out.
  subroutine build_model(self, model, plan, now, results, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: estimate
    integer :: wanted
    wanted = plan%reduced%num_modes
    if (wanted == 0) wanted = first_guess
    if (now%has_opened_step) wanted = now%reduction%num_shapes
    do
      call build_basis_of(self, model, plan, wanted, results, error)
      if (allocated(error) .or. now%has_opened_step) return
      call start_modes(self, now)
      estimate = not_known
      if (plan%reduced%num_modes == 0 .or. plan%controls%estimates_errors) then
        call results%costs%start('estimate', 'reduced model', 'solver')
        call estimate_error(model, plan, self%system, self%basis, now, estimate)
        call results%costs%stop()
      end if
      now%reduction = reduction_status(wanted, self%basis%num_modes, &
                                       sqrt(maxval(self%basis%lambda))/two_pi, estimate, &
                                       count_broken(now%joints))
      call say_model(now%reduction, size(model%joints) > 0, plan%reduced%accuracy, results)
      if (plan%reduced%num_modes > 0 .or. estimate <= plan%reduced%accuracy) exit
      if (wanted >= most_modes .or. self%basis%num_shapes < wanted) exit
      wanted = min(most_modes, grown(wanted, estimate/plan%reduced%accuracy))
    end do
    if (estimate < 1.0_rk .or. plan%reduced%num_modes > 0) then
      call note_size(self%system%matrix%num_free, self%basis%num_modes, results)
      return
    end if
    call raise(error, 'no reduced model follows the step: its openings are not known within '// &
               '100 %, or it finds no equilibrium; take *DYNAMIC without REDUCED')
  end subroutine build_model

  !> More modes, for an error that shall be smaller by a factor.
  pure integer function grown(num_modes, factor)
    integer, intent(in) :: num_modes
    real(rk), intent(in) :: factor
    grown = ceiling(num_modes*min(most_growth, max(least_growth, factor**(1.0_rk/decay))))
  end function grown

  !> Builds the model with a number of shapes.
  subroutine build_basis_of(self, model, plan, wanted, results, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    integer, intent(in) :: wanted
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(reduced_model) :: fresh
    real(rk), allocatable :: shapes(:, :)
    fresh%force = self%basis%force
    fresh%start_traction = self%basis%start_traction
    fresh%starts_balanced = self%basis%starts_balanced
    fresh%shift = smallest_shift/plan%first_increment**2
    call find_shapes(model, self%system, loads_of_shapes(self), wanted, self%solvers, shapes, &
                     fresh%shift, error)
    if (allocated(error)) return
    call results%costs%start('reduce', 'structure', 'solver')
    call build_basis(self%system, plan%first_increment, shapes, self%solvers, fresh, error)
    call results%costs%stop()
    self%basis = fresh
  end subroutine build_basis_of

  !> Writes number of modes, highest frequency and estimate to the log.
  subroutine say_model(reduction, has_joints, accuracy, results)
    type(reduction_status), intent(in) :: reduction
    logical, intent(in) :: has_joints !< openings are measured, else displacements
    real(rk), intent(in) :: accuracy
    class(listener), intent(inout) :: results
    character(:), allocatable :: text
    text = 'reduced model  modes '//as_text(reduction%num_modes)//'  highest '// &
           as_short_text(reduction%highest)//' Hz'
    if (reduction%estimate >= 0.0_rk) then
      text = text//'  estimated error '//as_short_text(100.0_rk*reduction%estimate)// &
             ' % of the largest '//trim(merge('opening     ', 'displacement', has_joints))// &
             '  wanted '//as_short_text(100.0_rk*accuracy)//' %'
    end if
    call results%log%say(text)
  end subroutine say_model

  !> Says in the log where the full model is hardly larger than the reduced one.
  subroutine note_size(num_unknowns, num_modes, results)
    integer, intent(in) :: num_unknowns, num_modes
    class(listener), intent(inout) :: results
    if (num_unknowns >= worth_reducing*num_modes) return
    call results%log%note('reduced model: '//as_text(num_modes)//' modes for '// &
                          as_text(num_unknowns)//' unknowns; *DYNAMIC without REDUCED may take '// &
                          'less time')
  end subroutine note_size

  !> Forces that the shapes start with: loads that may change, forces that are not balanced at the
  !> start, and one that no symmetry of the dam leaves out.
  function loads_of_shapes(self) result(loads)
    class(reduced_method), intent(in) :: self
    real(rk), allocatable :: loads(:, :) !< (num_free, loads)
    real(rk), dimension(self%system%matrix%num_total) :: any_motion, inertia
    integer :: k, n, free
    n = size(self%system%groups)
    free = self%system%matrix%num_free
    any_motion = [(1.0_rk + 0.5_rk*sin(1.7_rk*k) + 0.25_rk*cos(0.13_rk*k), &
                   k=1, size(any_motion))]
    call multiply(self%system%matrix, self%system%mass, any_motion, inertia)
    allocate (loads(free, 0))
    loads = reshape(inertia(:free), [free, 1])
    do k = n + 1, 1, -1
      if (k <= n) then
        if (self%system%groups(k)%rule%amplitude == 0) cycle
      else if (self%basis%starts_balanced) then
        cycle
      end if
      loads = reshape([self%basis%force(:free, k), loads], [free, size(loads, 2) + 1])
    end do
  end function loads_of_shapes

  !> The modes at the start of the step.
  subroutine start_modes(self, now)
    class(reduced_method), intent(in) :: self
    type(state), intent(inout) :: now
    integer :: k
    associate (own => now%motion, modal => now%motion%modal, basis => self%basis, &
               system => self%system, n => self%system%matrix%num_free)
      call multiply(system%matrix, system%mass, own%v, own%momentum)
      modal%y = [(0.0_rk, k=1, basis%num_modes)]
      modal%rate = [(dot(own%momentum(:n), basis%mode(:, k)), k=1, basis%num_modes)]
      modal%acceleration = modal_forces(basis, modal) &
                           + basis%path(size(basis%path, 1) - 1, :) ! forces that are not balanced
      modal%port = [(0.0_rk, k=1, size(basis%residual, 2))]
      modal%port_rate = modal%port
      modal%port_acceleration = modal%port
      modal%rest = modal%port
      modal%rest_rate = modal%port
      modal%rest_acceleration = modal%port
      modal%is_expanded = .true.
      own%carried = modal%start_traction
      if (.not. allocated(own%jump_rate)) own%jump_rate = 0.0_rk*own%carried
      own%v(:n) = matmul(basis%mode, modal%rate)
      own%a(:n) = matmul(basis%mode, modal%acceleration)
      call multiply(system%matrix, system%mass, own%v, own%momentum)
      call multiply(system%matrix, system%mass, own%a, own%inertia)
      call system%find_damping_force(own%v, own%viscous)
    end associate
  end subroutine start_modes

  !> Forms the reduced matrices when the size of the increment has changed.
  subroutine start_increment(self, model, plan, dt, results, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: dt
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    if (self%matrices%scheme%is_for(dt)) return
    call self%solids%matrix%start_elastic(dt)
    call results%costs%start('reduce', 'structure', 'solver')
    call self%matrices%prepare(self%basis, &
                               make_scheme(plan%alpha, dt, plan%controls%joint_forces), &
                               model%joints, self%system%operator)
    call results%costs%stop()
  end subroutine start_increment

  !> One increment. A signal waits for its end, where the motion of all unknowns is found.
  subroutine advance(self, model, when, before, after, results, outcome, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    class(listener), intent(inout) :: results
    type(balance_outcome), intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: factors(size(self%force_norm), 2)
    type(step_time) :: start
    start = when
    start%now = when%now - when%increment
    self%solids%solver%controls%may_be_dropped = .false.
    call results%costs%start('iterate', 'structure', 'solver')
    associate (groups => self%system%groups, first => before%motion%modal%start_factor)
      factors(:, 1) = load_factors(groups, model%amplitudes, start, first)
      factors(:, 2) = load_factors(groups, model%amplitudes, when, first)
    end associate
    after%largest_force = max(before%largest_force, maxval(abs(factors(:, 2))*self%force_norm))
    call take_reduced_increment(self%basis, self%matrices, model, &
                                self%solids%solver%controls, factors, before, after, outcome)
    call results%costs%stop()
    if (.not. outcome%has_converged) return
    call results%costs%start('recover', 'energy', 'solver')
    call add_reduced_work(model, self%basis, self%system%operator, self%matrices%scheme, factors, &
                          before, after)
    call results%costs%stop()
  end subroutine advance

  !> The motion of the nodes, where results need it.
  subroutine store_state(self, model, when, now, results, error)
    class(reduced_method), intent(inout) :: self
    type(problem), intent(in) :: model
    type(step_time), intent(in) :: when
    type(state), intent(inout) :: now
    class(listener), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call self%followed%store(now)
    if (.not. results%needs_motion(model, now)) return
    call results%costs%start('expand', 'structure', 'solver')
    call expand_motion(self%basis, self%system, self%solvers, model%amplitudes, when, now, error)
    if (.not. allocated(error)) call store_motion(model%mesh, self%system%numbers, now)
    call results%costs%stop()
  end subroutine store_state
end module reduced_integrator
