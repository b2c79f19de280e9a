!> The compliance of joints as an operator, by substitutions in the Schur block, against its blocks.
program test_jump_block
  use arch_model, only: make_heavy_arch
  use analysis_state, only: state
  use condensation, only: condensed_equilibrium
  use equilibrium, only: equilibrium_solver
  use errors, only: error_type
  use initial_state, only: start_analysis
  use joint_contraction, only: contraction_law
  use jump_block, only: schur_response
  use kinds, only: rk
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use step_equilibrium, only: make_equilibrium, prepare_equilibrium
  use step_system, only: build_structure, dam_system
  use testing, only: check, check_close, test_log
  implicit none

  type(test_log) :: log

  log%suite = 'jump_block'
  call compare()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Jumps by some forces on the joints of an arch.
  subroutine compare()
    type(problem), target :: model
    type(dam_system), target :: system
    type(ledger) :: costs
    type(error_type), allocatable :: error
    class(equilibrium_solver), allocatable, target :: solver
    type(schur_response) :: response
    real(rk), allocatable :: force(:), by_blocks(:), by_substitution(:)
    integer :: i
    call make_model(model)
    associate (plan => model%steps(1))
      call build_structure(model, plan, system, costs, error)
      if (.not. allocated(error)) call make_equilibrium(plan, system, .true., solver, error)
      if (.not. allocated(error)) then
        call prepare_equilibrium(model, system, system%stiffness, 1.0_rk, solver, error)
      end if
    end associate
    call check(log,.not. allocated(error), 'the matrix is factored')
    if (allocated(error)) return
    select type (solver)
    type is (condensed_equilibrium)
      response%jumps => solver%jumps
      response%operator => solver%operator
      response%num_total = system%matrix%num_total
      force = [(sin(1.7_rk*i), i=1, 3*system%operator%num_points)]
      allocate (by_blocks(size(force)), by_substitution(size(force)))
      call solver%condensed%blocks%product(force, by_blocks)
      call response%respond(force, by_substitution)
      call check(log, norm2(by_blocks) > 0.0_rk, 'the joints move')
      call check_close(log, norm2(by_substitution - by_blocks)/norm2(by_blocks), 0.0_rk, &
                       1.0e-11_rk, 'the same jumps')
    class default
      call check(log, .false., 'a condensed solver')
    end select
  end subroutine compare

  !> An arch with frictional joints under its weight.
  subroutine make_model(model)
    type(problem), intent(inout) :: model
    type(state), allocatable :: now
    type(error_type), allocatable :: error
    call make_heavy_arch(contraction_law(normal_stiffness=1.0e11_rk, &
                                         tangent_stiffness=4.0e10_rk, &
                                         friction=0.6_rk), model)
    call start_analysis(model, now, error)
  end subroutine make_model
end program test_jump_block
