!> Drives the results layer by hand over a small dam that cracks: a block of eight points, one of
!> one point and a wedge of concrete on elastic rock; damage is set, not computed. The files are
!> read by tests/results/test_damage_files.py.
program test_damage_files
  use dam_mesh, only: named_set, surface
  use integrator_catalogue, only: procedure_named
  use kinds, only: rk
  use errors, only: error_type
  use diagnostics, only: diagnostic_list
  use step_plan, only: step, print_request, field_request
  use print_kinds, only: prints_of_elements
  use material_law, only: start_points
  use material_elastic, only: elastic_law
  use material_points, only: fracture_energy, crushing_energy
  use inelastic_blocks, only: list_inelastic_blocks
  use problem_definition, only: problem
  use analysis_state, only: state
  use file_system, only: make_folder
  use result_files, only: result_folder
  use hand_law, only: by_hand, set_elastic
  use testing, only: test_log, check
  implicit none
  character(*), parameter :: deck = 'cracked dam.inp'
  integer, parameter :: num_increments = 3
  type(test_log) :: log
  type(problem) :: model
  type(result_folder) :: results
  type(error_type), allocatable :: error
  type(diagnostic_list) :: remarks
  type(state) :: now
  character(500) :: folder
  integer :: increment
  log%suite = 'damage_files'
  folder = 'damage of the unit test'
  if (command_argument_count() > 0) call get_command_argument(1, folder)
  call make_model()
  call results%costs%open()
  call results%log%open(.true., error)
  call make_folder(trim(folder), error)
  call results%prepare(model, trim(folder), remarks, error)
  call check_success(error, 'results are prepared')
  call results%open(model, error)
  call check_success(error, 'results open')
  do increment = 1, num_increments
    call set_state(increment)
    call results%increment_done(model, now, error)
    call check_success(error, 'an increment is written')
  end do
  call results%finish(model, now, 'finished', '', error)
  call check_success(error, 'results close')
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Nodes at x = 0, 1 (fastest), y = 0, 2, 4, z = -1, 0, 3; ridge over the first block at z = 5.
  subroutine make_model()
    type(by_hand) :: law
    integer :: i, n
    model%deck_file = deck
    associate (mesh => model%mesh)
      mesh%num_nodes = 20
      mesh%num_elements = 4
      allocate (mesh%x(3, 20))
      do n = 1, 18
        mesh%x(:, n) = real([mod(n - 1, 2), 2*mod((n - 1)/2, 3), 0], rk)
      end do
      mesh%x(3, 1:6) = -1.0_rk
      mesh%x(3, 13:18) = 3.0_rk
      mesh%x(:, 19) = [0.0_rk, 0.0_rk, 5.0_rk]
      mesh%x(:, 20) = [0.0_rk, 2.0_rk, 5.0_rk]
      mesh%node_id = [(10*n, n=1, 20)]
      mesh%element_id = [10, 20, 40, 50]
      mesh%element_type = ['C3D8  ', 'C3D8R ', 'C3D8B ', 'C3D8  ']
      mesh%nodes = reshape([7, 8, 10, 9, 13, 14, 16, 15, 9, 10, 12, 11, 15, 16, 18, 17, &
                            13, 14, 16, 15, 19, 19, 20, 20, 1, 2, 4, 3, 7, 8, 10, 9], [8, 4])
      mesh%material_of_element = [1, 1, 1, 2]
      mesh%section_of_element = [1, 1, 1, 2]
    end associate
    law%num_state = 8
    law%is_nonlinear = .true.
    allocate (model%materials(2), model%joints(0), model%loads(0), model%amplitudes(0), &
              model%guests(0), &
              model%initial_values(0), model%node_sets(0))
    model%materials(1)%name = 'CONCRETE'
    model%materials(1)%density = 2400.0_rk
    model%materials(1)%law = law
    model%materials(2)%name = 'ROCK'
    model%materials(2)%law = elastic_law(young=20.0e9_rk, poisson=0.2_rk)
    model%element_sets = [named_set('BODY', [1, 2, 3, 4])]
    model%surfaces = [surface('WATER', [1, 2], [6, 6])]
    model%upstream_surface = 1
    call list_inelastic_blocks(model%mesh, model%materials, model%inelastic)
    call make_step()
    allocate (now%u(3, 20), source=0.0_rk)
    allocate (now%joints(0), now%points(size(model%inelastic)))
    do i = 1, size(model%inelastic)
      call start_points(law, model%inelastic(i)%points, now%points(i))
    end do
  end subroutine make_model

  !> Everything at every increment.
  subroutine make_step()
    type(step) :: plan
    plan%name = 'cracking'
    plan%procedure = procedure_named('STATIC')
    allocate (plan%fixities(0), plan%loads(0))
    plan%prints = [print_request(prints_of_elements, 'BODY', [1, 2, 3, 4], [integer ::], &
                                 ['S       ', 'PE      ', 'DAMAGET ', 'SDV     '], 1)]
    plan%outputs = [field_request(['U       ', 'S       ', 'E       ', 'PE      ', 'DAMAGET ', &
                                   'DAMAGEC ', 'SDV     '], 1)]
    plan%envelope = ['DAMAGET ', 'DAMAGEC ', 'S1      ']
    allocate (model%steps(1))
    model%steps(1) = plan
  end subroutine make_step

  !> e33 = 1e-4 t. From increment 2 on element 10 is cracked, d = 0.1 q at its point q and plastic
  !> e22 = 1e-3; from 3 on element 20 too, 0.95 in tension and 0.25 in compression. No stress there.
  subroutine set_state(increment)
    integer, intent(in) :: increment
    integer :: i, q
    now%step = 1
    now%increment = increment
    now%is_last_of_step = increment == num_increments
    now%total_time = 0.5_rk*increment
    now%step_time = now%total_time
    now%u(3, :) = 1.0e-4_rk*now%total_time*model%mesh%x(3, :)
    call set_elastic(model, now)
    do i = 1, size(model%inelastic)
      associate (points => now%points(i), element => model%inelastic(i)%points%element(1))
        if (element == 10 .and. increment >= 2) then
          points%is_elastic = .false.
          points%internal(1, :) = [(0.1_rk*q, q=1, 8)]
          points%internal(4, :) = 1.0e-3_rk
          points%energy(crushing_energy, :) = 50.0_rk
        else if (element == 20 .and. increment >= 3) then
          points%is_elastic = .false.
          points%internal(1, :) = 0.95_rk
          points%internal(2, :) = 0.25_rk
          points%energy(fracture_energy, :) = 100.0_rk
        end if
        do q = 1, size(points%is_elastic)
          if (.not. points%is_elastic(q)) points%stress(:, q) = 0.0_rk
        end do
      end associate
    end do
  end subroutine set_state

  !> No failure.
  subroutine check_success(error, what)
    type(error_type), allocatable, intent(in) :: error
    character(*), intent(in) :: what
    logical :: has_failed
    has_failed = allocated(error)
    if (has_failed) print '(a)', error%message
    call check(log, has_failed .eqv. .false., what)
  end subroutine check_success
end program test_damage_files
