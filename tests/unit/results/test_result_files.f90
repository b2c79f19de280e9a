!> Drives the results layer by hand over a small dam with a joint: two blocks and a wedge of
!> concrete on rock without mass, a uniform strain that grows with time. The files are read by
!> tests/results/test_result_files.py; here only what Fortran can see is checked.
program test_result_files
  use dam_mesh, only: named_set, surface
  use integrator_catalogue, only: procedure_named
  use kinds, only: rk
  use errors, only: error_type
  use diagnostics, only: diagnostic_list, place, severity_ignored, severity_warning
  use step_plan, only: step, print_request, field_request
  use print_kinds, only: prints_of_elements, prints_of_joints, prints_of_nodes
  use material_elastic, only: elastic_law
  use joint_contraction, only: contraction_law
  use joint_points, only: draw_elements, list_faces
  use problem_definition, only: problem
  use analysis_state, only: state, vibration_mode
  use file_system, only: make_folder
  use result_files, only: result_folder
  use testing, only: test_log, check, check_close
  implicit none

  character(*), parameter :: deck = 'hand driven.inp'
  type(test_log) :: log
  type(problem) :: model
  type(result_folder) :: results
  character(500) :: folder
  log%suite = 'result_files'
  folder = 'results of the unit test'
  if (command_argument_count() > 0) call get_command_argument(1, folder)
  call make_model(model)
  call run(model, results)
  call check_maxima(results)
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Mesh, materials, joint, sets and steps.
  subroutine make_model(model)
    type(problem), intent(out) :: model
    model%deck_file = deck
    call make_mesh(model)
    call make_materials(model)
    call make_joint(model)
    allocate (model%loads(0), model%amplitudes(0), model%initial_values(0))
    model%node_sets = [named_set('TOP', [13, 14, 19, 20])]
    model%element_sets = [named_set('TWO/BLOCKS', [1, 2])]
    model%surfaces = [surface('WATER', [1, 2], [6, 6])]
    model%upstream_surface = 1
    call make_steps(model)
  end subroutine make_model

  !> Nodes at x = 0, 1 (fastest), y = 0, 2 | 2, 4, z = -1 (first block only), 0, 3; ridge at z = 5.
  subroutine make_mesh(model)
    type(problem), intent(inout) :: model
    real(rk), parameter :: x(3, 22) = reshape(real([ &
                                                   0, 0, -1, 1, 0, -1, 0, 2, -1, 1, 2, -1, &
                                                   0, 0, 0, 1, 0, 0, 0, 2, 0, 1, 2, 0, &
                                                   0, 2, 0, 1, 2, 0, 0, 4, 0, 1, 4, 0, &
                                                   0, 0, 3, 1, 0, 3, 0, 2, 3, 1, 2, 3, &
                                                   0, 2, 3, 1, 2, 3, 0, 4, 3, 1, 4, 3, &
                                                   0, 0, 5, 0, 2, 5], rk), [3, 22])
    integer :: n
    associate (mesh => model%mesh)
      mesh%num_nodes = 22
      mesh%num_elements = 5
      mesh%node_id = [(10*n, n=1, 22)]
      mesh%x = x
      mesh%element_id = [10, 20, 30, 40, 50]
      mesh%element_type = ['C3D8  ', 'C3D8R ', 'JOINT8', 'C3D8B ', 'C3D8  ']
      mesh%nodes = reshape([5, 6, 8, 7, 13, 14, 16, 15, 9, 10, 12, 11, 17, 18, 20, 19, &
                            7, 8, 16, 15, 9, 10, 18, 17, 13, 14, 16, 15, 21, 21, 22, 22, &
                            1, 2, 4, 3, 5, 6, 8, 7], [8, 5])
      mesh%material_of_element = [1, 1, 0, 1, 2]
      mesh%section_of_element = [1, 1, 0, 1, 2]
    end associate
  end subroutine make_mesh

  !> Concrete and massless rock of the same stiffness.
  subroutine make_materials(model)
    type(problem), intent(inout) :: model
    integer :: m
    allocate (model%materials(2))
    model%materials(1)%name = 'CONCRETE'
    model%materials(1)%density = 2400.0_rk
    model%materials(1)%beta = 1.0e-3_rk
    model%materials(2)%name = 'ROCK'
    do m = 1, 2
      model%materials(m)%law = elastic_law(young=20.0e9_rk, poisson=0.0_rk)
    end do
  end subroutine make_materials

  !> Four points between the blocks.
  subroutine make_joint(model)
    type(problem), intent(inout) :: model
    integer :: p
    allocate (model%joints(1), model%guests(0))
    associate (item => model%joints(1))
      item%name = 'MIDDLE'
      item%kind = 'joint'
      allocate (item%law, source=contraction_law(name='LAW', gap=1.0e-4_rk))
      call list_faces(reshape([9, 10, 18, 17], [1, 4]), reshape([7, 8, 16, 15], [1, 4]), &
                      reshape([1.0_rk], [1, 4], pad=[1.0_rk]), item)
      call draw_elements(model%mesh, [3], [-1], item)
      item%x = model%mesh%x(:, [7, 8, 16, 15])
      allocate (item%area(4), source=0.75_rk)
      allocate (item%rotation(3, 3, 4), source=0.0_rk)
      do p = 1, 4
        item%rotation(1, 2, p) = 1.0_rk
        item%rotation(2, 1, p) = -1.0_rk
        item%rotation(3, 3, p) = 1.0_rk
      end do
    end associate
  end subroutine make_joint

  !> A static step, a dynamic one that prints every second increment, and one for frequencies.
  subroutine make_steps(model)
    type(problem), intent(inout) :: model
    type(step) :: plan
    type(print_request) :: nodes, elements, points
    nodes = print_request(prints_of_nodes, 'TOP', [13, 14], [integer ::], &
                          ['U   ', 'RF  ', 'SDV '], 1)
    elements = print_request(prints_of_elements, 'TWO/BLOCKS', [1, 2], [integer ::], &
                             ['S ', 'SP'], 1)
    points = print_request(prints_of_joints, 'MIDDLE', [1], [15], ['OPENING'], 1)
    plan%name = 'dead weight'
    plan%procedure = procedure_named('STATIC')
    allocate (plan%fixities(0), plan%loads(0))
    plan%prints = [nodes, elements, points]
    plan%outputs = [field_request(['U ', 'V ', 'S '], 1), field_request(['SP', 'PE'], 1)]
    plan%envelope = ['S1      ', 'OPENING ', 'DAMAGET ']
    allocate (model%steps(3))
    model%steps(1) = plan
    nodes = print_request(prints_of_nodes, 'TOP', [14, 20], [integer ::], ['V'], 2)
    points%near_nodes = [integer ::]
    plan%name = 'earthquake'
    plan%procedure = procedure_named('DYNAMIC')
    plan%prints = [nodes, points]
    plan%outputs = [field_request(['U      ', 'V      ', 'RF     ', 'E      ', 'OPENING'], 2)]
    plan%envelope = ['S1      ', 'S3      ', 'U       ', 'OPENING ']
    model%steps(2) = plan
    model%steps(3)%name = 'shapes'
    model%steps(3)%procedure = procedure_named('FREQUENCY')
    allocate (model%steps(3)%fixities(0))
  end subroutine make_steps

  !> The calls a solver would make.
  subroutine run(model, results)
    type(problem), intent(in) :: model
    type(result_folder), intent(inout) :: results
    type(error_type), allocatable :: error
    type(vibration_mode) :: modes(2)
    type(state) :: now
    type(diagnostic_list) :: remarks
    integer :: i
    call remarks%add(severity_ignored, place(deck, 7, 1, 9, 'PREPRINT', ''), 'no effect here')
    call remarks%add(severity_warning, place(deck, 8, 1, 9, 'NODE', ''), 'odd "name"')
    call results%costs%open()
    call results%log%open(.true., error)
    call make_folder(trim(folder), error)
    call results%prepare(model, trim(folder), remarks, error)
    call check_success(error, 'results are prepared')
    call results%open(model, error)
    call check_success(error, 'results open')
    do i = 1, 2
      call announce(results, model, 1, i, 0.5_rk*i, i == 2)
    end do
    do i = 0, 3
      call announce(results, model, 2, i, 1.0_rk + 0.1_rk*i, i == 3)
    end do
    do i = 1, 2
      modes(i)%hz = 2.5_rk*i
      modes(i)%effective_mass = [1.0_rk, 2.0_rk, 3.0_rk]
      modes(i)%shape = model%mesh%x*i
    end do
    call results%modes_found(model, 3, modes, error)
    call check_success(error, 'modes are written')
    call results%finish(model, now, 'finished', '', error)
    call check_success(error, 'results close')
  end subroutine run

  !> One increment: e11 = 1e-3 t, e33 = -2e-3 t, g12 = 1e-3 t; the joint opens with height.
  subroutine announce(results, model, number, increment, time, is_last)
    type(result_folder), intent(inout) :: results
    type(problem), intent(in) :: model
    integer, intent(in) :: number, increment
    real(rk), intent(in) :: time
    logical, intent(in) :: is_last
    type(state) :: now
    type(error_type), allocatable :: error
    now%step = number
    now%increment = increment
    now%iterations = 2
    now%is_last_of_step = is_last
    now%total_time = time
    now%step_time = time - (number - 1)
    now%energy%error = 1.0e-4_rk*increment
    allocate (now%u(3, 22), source=0.0_rk)
    now%u(1, :) = 1.0e-3_rk*time*(model%mesh%x(1, :) + model%mesh%x(2, :))
    now%u(3, :) = -2.0e-3_rk*time*model%mesh%x(3, :)
    now%reaction = now%u
    if (number == 2) now%v = now%u/time
    if (number == 2) now%a = 0.0_rk*now%u
    allocate (now%joints(1))
    call model%joints(1)%law%start_state(model%joints(1)%clearance, now%joints(1))
    now%joints(1)%jump(1, :) = 1.0e-3_rk*(time*model%joints(1)%x(3, :) - 1.0_rk)
    now%joints(1)%slip(2, :) = -1.0e-3_rk*time*model%joints(1)%x(1, :)
    now%joints(1)%traction(1, :) = -1.0e6_rk*model%joints(1)%x(1, :)
    call results%increment_done(model, now, error)
    call check_success(error, 'an increment is written')
  end subroutine announce

  !> No failure.
  subroutine check_success(error, what)
    type(error_type), allocatable, intent(in) :: error
    character(*), intent(in) :: what
    logical :: has_failed
    has_failed = allocated(error)
    if (has_failed) print '(a)', error%message
    call check(log, has_failed .eqv. .false., what)
  end subroutine check_success

  !> Extremes with time and place.
  subroutine check_maxima(results)
    type(result_folder), intent(in) :: results
    associate (found => results%record%joints(1))
      call check_close(log, found%opening%at(1)%value, 3.0e-3_rk, 1.0e-15_rk, 'opening anywhere')
      call check_close(log, found%slip%at(3)%value, 1.3e-3_rk, 1.0e-15_rk, 'slip downstream')
      call check_close(log, found%slip%at(2)%value, 0.0_rk, 0.0_rk, 'slip upstream')
      call check_close(log, found%pressure%at(1)%time, 0.5_rk, 0.0_rk, 'first time of pressure')
    end associate
    associate (skin => results%record%skin)
      call check(log, all(skin%is_upstream([5, 7, 13, 15, 9, 11, 17, 19])), 'upstream nodes')
      call check(log, count(skin%is_upstream) == 8, 'no other upstream node')
      call check(log, all(skin%is_downstream([6, 8, 14, 16, 10, 12, 18, 20])), 'downstream nodes')
      call check(log, count(skin%is_downstream(1:4)) == 0, 'rock is not downstream')
    end associate
  end subroutine check_maxima
end program test_result_files
