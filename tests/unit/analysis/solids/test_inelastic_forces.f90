!> Released forces and lost stiffness of solids against finite differences, in one thread and two.
program test_inelastic_forces
  use kinds, only: rk
  use omp_lib, only: omp_set_num_threads
  use errors, only: error_type
  use problem_definition, only: problem
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use matrix_pattern, only: pattern, full_pattern, multiply
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use pattern_builder, only: list_cells, build_pattern
  use material_law, only: start_points
  use material_elastic, only: elastic_law
  use material_points, only: point_state, time_increment, secant_tangent, consistent_tangent
  use inelastic_forces, only: block_answer, open_answers, update_points, recall_points, &
                              sum_excess, find_failure
  use inelastic_stiffness, only: lost_stiffness
  use guest_history, only: stored_work
  use node_dofs, only: zero_vectors
  use row_tables, only: row_table
  use step_plan, only: step_fixity
  use row_model, only: make_row
  use softening_law, only: damage_law, put_law
  use testing, only: test_log, check, check_close
  use unknown_parts, only: unknown_part
  implicit none

  type(test_log) :: log
  type(problem), target :: model
  type(numbering) :: numbers
  type(unknown_part) :: part
  type(pattern) :: matrix, full
  type(point_state), allocatable :: old(:), new(:)
  type(block_answer), allocatable :: answers(:)
  integer, parameter :: num_boxes = 40

  log%suite = 'inelastic_forces'
  call make_model()
  call elastic_points_release_nothing(log)
  call tangent_follows_differences(log)
  call secant_gives_excess_force(log)
  call threads_do_not_matter(log)
  call states_are_recalled(log)
  call absent_blocks_release_nothing(log)
  call failure_names_the_point(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A crooked row of 40 boxes of one soft material, three blocks.
  subroutine make_model()
    type(guest_reference), allocatable :: guests(:)
    type(row_table) :: cells
    type(error_type), allocatable :: error
    integer :: i
    call make_row([(real(i, rk), i=0, num_boxes)], 1.0_rk, 1.0_rk, &
                  spread(3.0e10_rk, 1, num_boxes), spread(0.0_rk, 1, num_boxes), model)
    model%mesh%x = model%mesh%x + 0.1_rk*sin(reshape([(37.0_rk*i, i=1, size(model%mesh%x))], &
                                                     shape(model%mesh%x)))
    model%mesh%material_of_element = 1
    call put_law(damage_law(elastic=elastic_law(young=3.0e10_rk, poisson=0.2_rk)), [1], model)
    call number_step(model%mesh, model%joints, model%guests, [step_fixity(node=1, dof=1)], &
                     numbers, error)
    call guests_of_model(model, guests)
    call list_cells(model%mesh, guests, cells)
    call build_pattern(numbers, cells, matrix)
    call full_pattern(matrix, full)
    allocate (old(size(model%inelastic)))
    do i = 1, size(old)
      call start_points(model%materials(1)%law, model%inelastic(i)%points, old(i))
    end do
    new = old
    call open_answers(model%inelastic, answers)
  end subroutine make_model

  !> Unknowns of a rough field whose strains are some times `size`.
  function field(size_of_strain) result(q)
    real(rk), intent(in) :: size_of_strain
    real(rk) :: q(numbers%num_total)
    integer :: i
    q = size_of_strain*[(cos(11.0_rk*i), i=1, numbers%num_total)]
  end function field

  !> Initial-stress force at q, from the state `old`.
  subroutine find_excess(q, tangent, excess)
    real(rk), intent(in) :: q(:)
    integer, intent(in) :: tangent
    real(rk), intent(out) :: excess(:)
    real(rk) :: u(3, model%mesh%num_nodes)
    real(rk), allocatable :: no_origin(:, :)
    call numbers%expand(q, u)
    call update_points(model, u, no_origin, time_increment(tangent=tangent), old, new, answers)
    call sum_excess(model, numbers, part, answers, zero_vectors(model%mesh%num_nodes), excess)
  end subroutine find_excess

  subroutine elastic_points_release_nothing(log)
    type(test_log), intent(inout) :: log
    real(rk) :: excess(numbers%num_total), values(size(matrix%row))
    call find_excess(field(1.0e-5_rk), consistent_tangent, excess)
    call lost_stiffness(model, numbers, answers, matrix, values)
    call check(log, size(model%inelastic) == 3, 'three blocks')
    call check(log, all(abs(excess) <= 0.0_rk), 'no force')
    call check(log, all(abs(values) <= 0.0_rk), 'no stiffness lost')
  end subroutine elastic_points_release_nothing

  !> A h = (R(q + h) - R(q - h))/2 but for h^2 and round-off.
  subroutine tangent_follows_differences(log)
    type(test_log), intent(inout) :: log
    real(rk), dimension(numbers%num_total) :: q, h, excess, above, below, product
    real(rk) :: values(size(full%row))
    integer :: i
    q = field(3.0e-4_rk)
    h = 1.0e-9_rk*[(sin(5.0_rk*i), i=1, size(h))]
    call find_excess(q + h, consistent_tangent, above)
    call find_excess(q - h, consistent_tangent, below)
    call find_excess(q, consistent_tangent, excess)
    call lost_stiffness(model, numbers, answers, full, values)
    call multiply(full, values, h, product)
    call check(log, norm2(excess) > 1.0e6_rk, 'there is something to test')
    ! Round-off of a difference of forces of 1e7 N over 1e2 N: 1e-16*1e5; kinks none with this q.
    call check_close(log, norm2(product - 0.5_rk*(above - below))/norm2(product), 0.0_rk, &
                     1.0e-8_rk, 'consistent tangent')
  end subroutine tangent_follows_differences

  !> Without plastic strain the secant stiffness lost gives the excess force.
  subroutine secant_gives_excess_force(log)
    type(test_log), intent(inout) :: log
    real(rk), dimension(numbers%num_total) :: q, excess, product
    real(rk) :: values(size(matrix%row))
    q = field(3.0e-4_rk)
    call find_excess(q, secant_tangent, excess)
    call lost_stiffness(model, numbers, answers, matrix, values)
    call multiply(matrix, values, q, product)
    call check_close(log, norm2(product - excess)/norm2(excess), 0.0_rk, 1.0e-12_rk, &
                     'secant stiffness times displacement')
  end subroutine secant_gives_excess_force

  !> The same digits with one thread and with two.
  subroutine threads_do_not_matter(log)
    type(test_log), intent(inout) :: log
    real(rk) :: one(numbers%num_total), two(numbers%num_total)
    real(rk) :: first(size(full%row)), second(size(full%row))
    call omp_set_num_threads(1)
    call find_excess(field(3.0e-4_rk), consistent_tangent, one)
    call lost_stiffness(model, numbers, answers, full, first)
    call omp_set_num_threads(2)
    call find_excess(field(3.0e-4_rk), consistent_tangent, two)
    call lost_stiffness(model, numbers, answers, full, second)
    call check(log, all(abs(one - two) <= 0.0_rk), 'forces do not depend on the threads')
    call check(log, all(abs(first - second) <= 0.0_rk), 'nor does the stiffness')
  end subroutine threads_do_not_matter

  !> Forces of a converged state, and its energies, without a law.
  subroutine states_are_recalled(log)
    type(test_log), intent(inout) :: log
    type(block_answer), allocatable :: others(:)
    type(stored_work) :: total
    integer :: i
    real(rk), dimension(numbers%num_total) :: excess, recalled
    call find_excess(field(3.0e-4_rk), secant_tangent, excess)
    call open_answers(model%inelastic, others)
    call recall_points(model, new, others)
    call sum_excess(model, numbers, part, others, zero_vectors(model%mesh%num_nodes), recalled)
    call check(log, all(abs(excess - recalled) <= 0.0_rk), 'excess forces are recalled')
    do i = 1, size(new)
      call model%inelastic(i)%add_work(new(i), total)
    end do
    ! Linear elastic-damage: stored - 1/2 eps D eps = -1/2 u . excess.
    call check_close(log, total%stored, -0.5_rk*dot_product(field(3.0e-4_rk), excess), &
                     1.0e-12_rk*abs(total%stored), 'stored energy')
    call check(log, total%fracture > 0.0_rk .and. total%crushing <= 0.0_rk, 'dissipated')
  end subroutine states_are_recalled

  !> A block that is absent has neither forces nor tangents, also where its law says that it is not
  !> elastic, as a UMAT does.
  subroutine absent_blocks_release_nothing(log)
    type(test_log), intent(inout) :: log
    type(problem) :: apart
    type(block_answer), allocatable :: others(:)
    type(point_state) :: states(size(old))
    real(rk), allocatable :: no_origin(:, :)
    real(rk) :: u(3, model%mesh%num_nodes)
    integer :: i
    apart = model
    states = new
    do i = 1, size(states)
      states(i)%is_elastic(:) = .false.
    end do
    allocate (apart%mesh%is_absent(num_boxes), source=.false.)
    apart%mesh%is_absent(apart%inelastic(1)%elements) = .true.
    call open_answers(apart%inelastic, others)
    call recall_points(apart, states, others)
    call check(log,.not. any(others(1)%has_excess), 'nothing is recalled of an absent block')
    call check(log, any(others(2)%has_excess), 'the others are recalled')
    call numbers%expand(field(3.0e-4_rk), u)
    call update_points(apart, u, no_origin, time_increment(tangent=consistent_tangent), old, &
                       states, others)
    call check(log,.not. any(others(1)%has_excess), 'an absent block has no tangents')
    call check(log, all(abs(others(1)%force) <= 0.0_rk), 'an absent block has no forces')
  end subroutine absent_blocks_release_nothing

  subroutine failure_names_the_point(log)
    type(test_log), intent(inout) :: log
    character(:), allocatable :: why
    real(rk) :: size_ratio, excess(numbers%num_total)
    call find_failure(model, answers, size_ratio, why)
    call check(log,.not. allocated(why), 'no failure')
    call put_law(damage_law(elastic=elastic_law(young=3.0e10_rk), largest_strain=2.0e-4_rk), [1], &
                 model)
    call find_excess(field(3.0e-4_rk), secant_tangent, excess)
    call find_failure(model, answers, size_ratio, why)
    call check(log, allocated(why), 'a failure')
    if (.not. allocated(why)) return
    call check(log, index(why, 'material SOFT, element 1, point ') == 1 .and. &
               index(why, ': strained too far') > 0, 'names material, element, point: '//why)
  end subroutine failure_names_the_point
end program test_inelastic_forces
