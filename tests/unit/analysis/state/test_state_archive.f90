!> States through an archive and back; runs that go on from a loaded state.
program test_state_archive
  use kinds, only: rk
  use errors, only: error_type
  use amplitudes, only: amplitude
  use problem_definition, only: problem
  use analysis_state, only: state
  use hdf5_archive, only: hdf5_store
  use initial_state, only: start_analysis
  use state_archive, only: save_state, load_state
  use step_loop, only: run_all_steps
  use joint_contraction, only: contraction_law
  use material_points, only: point_state
  use material_elastic, only: elastic_law
  use row_model, only: make_row, put_at_wall, shake_base, new_step, fix
  use softening_law, only: damage_law, put_law
  use full_state, only: make_full_state
  use state_recorder, only: recorder_of_states
  use same_states, only: compare_states
  use testing, only: test_log, check, check_text
  implicit none

  character(*), parameter :: path = 'test_state_archive.h5'
  real(rk), parameter :: young = 3.0e10_rk
  type(test_log) :: log

  log%suite = 'state_archive'
  call full_state_comes_back(log)
  call runs_go_on(log)
  call other_model_fails(log)
  call other_step_fails(log)
  call delete_file()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Saves a state.
  subroutine write_state(now, log)
    type(state), intent(in) :: now
    type(test_log), intent(inout) :: log
    type(hdf5_store) :: file
    type(error_type), allocatable :: error
    call file%create(path)
    call save_state(now, file, error)
    call check(log,.not. allocated(error), 'the state is saved')
    call file%close(error)
    call check(log,.not. allocated(error), 'the file is complete')
  end subroutine write_state

  !> Loads a state; `now` fixes the sizes.
  subroutine read_state(now, error)
    type(state), intent(inout) :: now
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: ignored
    type(hdf5_store) :: file
    call file%open(path)
    call load_state(now, file, error)
    call file%close(ignored)
  end subroutine read_state

  !> All components have values of their own.
  subroutine full_state_comes_back(log)
    type(test_log), intent(inout) :: log
    type(state), allocatable :: saved, now
    type(error_type), allocatable :: error
    call make_full_state(saved)
    call write_state(saved, log)
    allocate (now)
    allocate (now%u(3, 3), now%joints(2), now%points(1), now%guests(2))
    allocate (point_state :: now%guests(2)%item)
    allocate (now%joints(1)%gap(2), now%joints(2)%gap(2), source=0.0_rk)
    call read_state(now, error)
    call check(log,.not. allocated(error), 'the state is loaded')
    if (.not. allocated(error)) call compare_states(log, 'full state: ', saved, now)
  end subroutine full_state_comes_back

  !> Four boxes that crack, before a wall with a joint: pressed against it, then shaken.
  subroutine make_model(num_boxes, model)
    integer, intent(in) :: num_boxes
    type(problem), intent(out) :: model
    type(amplitude) :: pulse
    integer :: k, last(4)
    call make_row([(real(k, rk), k=0, num_boxes)], 0.5_rk, 0.5_rk, &
                  spread(young, 1, num_boxes), spread(2400.0_rk, 1, num_boxes), model)
    call put_at_wall(contraction_law(normal_stiffness=1.0e12_rk, tangent_stiffness=1.0e12_rk, &
                                     friction=0.5_rk), model)
    pulse%name = 'PULSE'
    pulse%time = [(0.001_rk*k, k=0, 60)]
    pulse%value = 400.0_rk*sin(300.0_rk*pulse%time)
    call shake_base(pulse, model)
    call new_step('STATIC', 0.125_rk, 1.0_rk, model)
    last = 4*num_boxes + [1, 2, 3, 4]
    call fix(last, 1, model)
    model%steps(1)%fixities%value = -5.0e-5_rk
    model%steps(1)%loads = model%steps(1)%loads(:0)
    call new_step('DYNAMIC', 5.0e-4_rk, 0.01_rk, model)
    model%steps(2)%fixities = model%steps(2)%fixities(:0)
    model%steps%alpha = -0.05_rk
    call put_law(damage_law(elastic=elastic_law(young=young, poisson=0.2_rk), threshold=3.0e-6_rk, &
                            slope=1.0e-4_rk), [(k, k=1, num_boxes)], model)
  end subroutine make_model

  !> The whole run, each of its states.
  subroutine run_model(model, whole, log)
    type(problem), intent(out) :: model
    type(recorder_of_states), intent(inout) :: whole
    type(test_log), intent(inout) :: log
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_model(4, model)
    call start_analysis(model, now, error)
    call run_all_steps(model, now, whole, error)
    call check(log,.not. allocated(error), 'the model runs')
    call check(log, now%energy%fracture > 1.0e-3_rk*now%energy%largest, 'solids crack')
    call check(log, any(abs(now%joints(1)%jump) > 0.0_rk), 'the joint moves')
  end subroutine run_model

  !> Saved in the middle of a static step, at its end, and in the middle of a dynamic step.
  subroutine runs_go_on(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder_of_states) :: whole
    integer :: k, num_tried(3)
    call run_model(model, whole, log)
    num_tried = 0
    do k = 1, size(whole%states)
      associate (saved => whole%states(k))
        if (saved%step == 1 .and. saved%increment == 3) then
          num_tried(1) = num_tried(1) + 1
          call goes_on(model, whole%states, k, 'static step: ', log)
        else if (saved%step == 1 .and. saved%is_last_of_step) then
          num_tried(2) = num_tried(2) + 1
          call goes_on(model, whole%states, k, 'end of a step: ', log)
        else if (saved%step == 2 .and. saved%increment == 7) then
          num_tried(3) = num_tried(3) + 1
          call goes_on(model, whole%states, k, 'dynamic step: ', log)
        end if
      end associate
    end do
    call check(log, all(num_tried == 1), 'each case is tried')
  end subroutine runs_go_on

  !> Saves a state, loads it into a new analysis and runs to the end: all states are the same.
  subroutine goes_on(model, states, k, what, log)
    type(problem), intent(inout) :: model
    type(state), intent(in) :: states(:) !< of the whole run
    integer, intent(in) :: k !< the one that is saved
    character(*), intent(in) :: what
    type(test_log), intent(inout) :: log
    type(recorder_of_states) :: rest
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    integer :: i
    call write_state(states(k), log)
    call start_analysis(model, now, error)
    call read_state(now, error)
    call check(log,.not. allocated(error), what//'the state is loaded')
    if (allocated(error)) return
    call compare_states(log, what//'loaded ', states(k), now)
    call run_all_steps(model, now, rest, error)
    call check(log,.not. allocated(error), what//'the run goes on')
    call check(log, size(rest%states) == size(states) - k, what//'as many increments')
    if (size(rest%states) /= size(states) - k) return
    do i = 1, size(rest%states)
      call compare_states(log, what, states(k + i), rest%states(i))
    end do
  end subroutine goes_on

  !> A model of another size.
  subroutine other_model_fails(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model, other
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_model(4, model)
    call start_analysis(model, now, error)
    call write_state(now, log)
    call make_model(3, other)
    call start_analysis(other, now, error)
    call read_state(now, error)
    call check(log, allocated(error), 'a model of another size is an error')
    if (.not. allocated(error)) return
    call check_text(log, error%message, "'test_state_archive.h5': /state/u is an array of 3 x "// &
                    '24, but of 3 x 20 in this model: the archive belongs to another model', &
                    'a model of another size')
  end subroutine other_model_fails

  !> A model of the same size whose step has other supports.
  subroutine other_step_fails(log)
    type(test_log), intent(inout) :: log
    type(problem) :: model
    type(recorder_of_states) :: whole, rest
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call run_model(model, whole, log)
    now = whole%states(3)
    model%steps(1)%fixities = model%steps(1)%fixities(:2)
    call run_all_steps(model, now, rest, error)
    call check(log, allocated(error), 'a step with other supports is an error')
    if (.not. allocated(error)) return
    call check_text(log, error%message, "the loaded state does not belong to step 'Step' of "// &
                    'this model: supports, ties or the procedure of the step are others', &
                    'a step with other supports')
  end subroutine other_step_fails

  !> Takes the file of the test away.
  subroutine delete_file()
    integer :: unit
    open (newunit=unit, file=path, status='old')
    close (unit, status='delete')
  end subroutine delete_file
end program test_state_archive
