!> Elements that take part in the iteration of an increment (theory.md, 12). A beam that is built in
!> at one end and rests on its other end is loaded in its middle. The end that is built in cracks
!> first and passes moment on to the middle, which begins to crack late: when the elements of the
!> increment have been chosen without it.
program test_changing_elements
  use kinds, only: rk
  use analysis_state, only: state
  use equilibrium, only: balance_outcome
  use errors, only: error_type
  use increment_balance, only: increment_task
  use initial_state, only: start_analysis
  use material_elastic, only: elastic_law
  use problem_definition, only: problem
  use row_model, only: fix, make_row, new_step
  use run_ledger, only: ledger
  use softening_law, only: damage_law, put_law
  use solid_iteration, only: solid_solver
  use state_transfer, only: start_motion
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium
  use step_system, only: build_loads, build_structure, dam_system
  use testing, only: check, check_close, test_log
  implicit none

  integer, parameter :: num_boxes = 10, middle_box = 6, most_iterations = 100
  real(rk), parameter :: young = 3.0e10_rk
  !> Strain in which strength falls: so slowly that the equilibrium is unique.
  real(rk), parameter :: slope = 1.0e-2_rk
  real(rk), parameter :: load = 1.0e5_rk !< on each node of the middle plane [N]

  !> One increment.
  type :: solved_increment
    type(solid_solver) :: solids
    type(increment_task) :: task
    type(balance_outcome) :: outcome
    type(state), allocatable :: after
  end type solved_increment

  type(test_log) :: log
  log%suite = 'changing_elements'
  call late_crack(log)
  call chosen_at_first(log)
  call late_failure(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The middle is 1 % stronger than what it bears while all is elastic, as in the first iterate.
  !> The choice must be enlarged by it; the solution is that of all elements.
  subroutine late_crack(log)
    type(test_log), intent(inout) :: log
    type(solved_increment) :: all_of_them, some, whole
    type(problem) :: model
    real(rk) :: root, middle
    call measure_elastic(root, middle)
    call make_beam(0.5_rk*root, 1.01_rk*middle, model)
    call solve(model, .false., .false., all_of_them)
    call solve(model, .true., .false., some)
    call solve(model, .true., .true., whole)
    call check(log, all_of_them%outcome%has_converged .and. some%outcome%has_converged &
               .and. whole%outcome%has_converged, 'equilibrium')
    call check(log,.not. all_of_them%solids%elements%is_made, 'all elements take part')
    call check(log, some%solids%elements%is_made, 'some elements are chosen')
    call check(log, has_cracked(some, middle_box), 'the middle cracks')
    associate (takes_part => some%solids%elements%takes_part)
      call check(log, takes_part(middle_box), &
                 'the middle takes part at the end')
      call check(log, takes_part(5) .and. takes_part(7), 'its neighbours do, too')
      call check(log,.not. (takes_part(4) .or. takes_part(8)), 'their neighbours do not')
    end associate
    call compare(log, some, all_of_them, 'with the laws of some elements')
    call compare(log, whole, all_of_them, 'with solves for some unknowns too')
  end subroutine late_crack

  !> A middle that stays elastic is not in the choice: it is the late crack that has enlarged it.
  subroutine chosen_at_first(log)
    type(test_log), intent(inout) :: log
    type(solved_increment) :: some
    type(problem) :: model
    real(rk) :: root, middle
    integer :: k
    call measure_elastic(root, middle)
    call make_beam(0.5_rk*root, 10.0_rk*middle, model)
    call solve(model, .true., .true., some)
    call check(log, some%outcome%has_converged, 'equilibrium of a cracked root')
    call check(log, all(some%solids%elements%takes_part .eqv. [(k <= 2, k=1, 10)]), &
               'the root and its neighbour take part')
  end subroutine chosen_at_first

  !> The middle, which takes no part, has no stress for its strain in equilibrium.
  subroutine late_failure(log)
    type(test_log), intent(inout) :: log
    type(solved_increment) :: some
    type(problem) :: model
    real(rk) :: root, middle
    call measure_elastic(root, middle)
    call make_beam(0.5_rk*root, 1.01_rk*middle, model, 1.005_rk*middle)
    call solve(model, .true., .true., some)
    call check(log,.not. some%outcome%has_converged, 'no equilibrium where a law fails late')
    call check(log, index(some%outcome%failure, 'strained too far') > 0, 'the reason')
  end subroutine late_failure

  !> Solutions differ by the tolerance, 1e-12 of the forces, times what softening makes of it.
  subroutine compare(log, one, other, text)
    type(test_log), intent(inout) :: log
    type(solved_increment), intent(in) :: one, other
    character(*), intent(in) :: text
    real(rk) :: largest
    integer :: i
    largest = maxval(abs(other%task%x))
    call check_close(log, maxval(abs(one%task%x - other%task%x)), 0.0_rk, 1.0e-9_rk*largest, &
                     'displacements '//text)
    do i = 1, size(other%after%points)
      associate (here => one%after%points(i), there => other%after%points(i))
        largest = maxval(abs(there%stress))
        call check_close(log, maxval(abs(here%stress - there%stress)), 0.0_rk, 1.0e-9_rk*largest, &
                         'stresses '//text)
        call check(log, all(here%is_elastic .eqv. there%is_elastic), 'the same points '//text)
      end associate
    end do
  end subroutine compare

  !> Largest tensile strains of the root and of the middle while nothing cracks.
  subroutine measure_elastic(root, middle)
    real(rk), intent(out) :: root, middle
    type(problem) :: model
    type(solved_increment) :: elastic
    call make_beam(1.0_rk, 1.0_rk, model)
    call solve(model, .false., .false., elastic)
    root = largest_strain(elastic, 1)
    middle = largest_strain(elastic, middle_box)
  end subroutine measure_elastic

  !> Of the points of a box, as damage_law measures it.
  real(rk) function largest_strain(increment, box)
    type(solved_increment), intent(in) :: increment
    integer, intent(in) :: box
    integer :: p
    largest_strain = 0.0_rk
    associate (strain => increment%after%points(box)%strain)
      do p = 1, size(strain, 2)
        largest_strain = max(largest_strain, norm2(max(0.0_rk, strain(1:3, p))))
      end do
    end associate
  end function largest_strain

  !> Whether a box has cracked; each box is a block of its own.
  logical function has_cracked(increment, box)
    type(solved_increment), intent(in) :: increment
    integer, intent(in) :: box
    has_cracked = .not. all(increment%after%points(box)%is_elastic)
  end function has_cracked

  !> Ten boxes of 1 m x 0.5 m x 0.5 m: root and middle with their strains at strength; the others do
  !> not reach theirs.
  subroutine make_beam(root, middle, model, largest)
    real(rk), intent(in) :: root, middle
    type(problem), intent(out) :: model
    real(rk), intent(in), optional :: largest !< strain of the middle
    type(damage_law) :: law
    type(elastic_law) :: elastic
    integer :: k
    call make_row([(real(k, rk), k=0, num_boxes)], 0.5_rk, 0.5_rk, spread(young, 1, num_boxes), &
                  spread(2400.0_rk, 1, num_boxes), model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    associate (controls => model%steps(1)%controls)
      controls%tangent = 'ELASTIC'
      controls%residual_tolerance = 1.0e-12_rk
      controls%max_iterations = most_iterations
    end associate
    do k = 1, 3
      call fix([1, 2, 3, 4], k, model)
    end do
    call fix(4*num_boxes + [1, 2], 2, model)
    call fix(4*num_boxes + [1, 2], 3, model)
    elastic = elastic_law(young=young)
    call put_law(damage_law(elastic=elastic, threshold=1.0_rk), [2, 3, 4, 5, 7, 8, 9, 10], &
                 model)
    call put_law(damage_law(elastic=elastic, threshold=root, slope=slope), [1], model)
    law = damage_law(elastic=elastic, threshold=middle, slope=slope)
    if (present(largest)) law%largest_strain = largest
    call put_law(law, [6], model)
  end subroutine make_beam

  !> The increment in which the middle plane is loaded.
  subroutine solve(model, may_choose, may_repeat, increment)
    type(problem), intent(inout) :: model
    logical, intent(in) :: may_choose !< the elements that take part
    logical, intent(in) :: may_repeat !< solves for active unknowns alone
    type(solved_increment), intent(out) :: increment
    type(dam_system) :: system
    type(state), allocatable :: now
    type(ledger) :: costs
    type(error_type), allocatable :: error
    associate (solids => increment%solids, task => increment%task)
      call start_analysis(model, now, error)
      call build_structure(model, model%steps(1), system, costs, error)
      call build_loads(model, model%steps(1), now%u, system, costs)
      call make_equilibrium(model%steps(1), system, .true., solids%solver, error)
      solids%solver%may_repeat = may_repeat
      call prepare_equilibrium(model, system, system%stiffness, 1.0_rk, solids%solver, error)
      call start_motion(system%numbers, model%joints, now, has_inertia=.false.)
      call solids%open(model, system, model%steps(1), now)
      solids%may_choose = may_choose
      call solids%open_increment(now, 1.0_rk)
      solids%values = system%stiffness
      allocate (increment%after, source=now)
      task%start = now%motion%q
      allocate (task%x(size(task%start)))
      call load_middle(system, task%balance%rhs)
      task%reference_force = norm2(task%balance%rhs)
      call solids%solve_increment(model, system, task, now, increment%after, increment%outcome, &
                                  error)
      call check(log,.not. allocated(error), 'no error')
    end associate
  end subroutine solve

  !> Forces of the load on the free unknowns.
  subroutine load_middle(system, rhs)
    type(dam_system), intent(in) :: system
    real(rk), allocatable, intent(out) :: rhs(:)
    real(rk) :: nodal(3, 4*(num_boxes + 1)), force(system%matrix%num_total)
    nodal = 0.0_rk
    nodal(3, 2*num_boxes + 1:2*num_boxes + 4) = -load
    call system%numbers%reduce(nodal, force)
    rhs = force(:system%matrix%num_free)
  end subroutine load_middle
end program test_changing_elements
