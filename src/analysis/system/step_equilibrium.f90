!> Chooses the solver of equilibrium of a step and reports parts of the model without support.
module step_equilibrium
  use kinds, only: rk, long
  use errors, only: error_type, raise, system_failed
  use instance_list, only: own_name_of_node
  use problem_definition, only: problem
  use step_plan, only: step
  use global_vectors, only: multiply
  use solver_catalogue, only: make_solver, symmetric_solver
  use equilibrium, only: equilibrium_solver
  use equilibrium_linear, only: linear_equilibrium
  use equilibrium_catalogue, only: condensed_solver, full_solver, make_joint_solver
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use ranks, only: is_true_everywhere, share_error
  use run_ledger, only: ledger
  use step_system, only: dam_system
  use write_text, only: as_text
  implicit none
  private
  public :: make_equilibrium, prepare_equilibrium, factorise_closed, set_modal_damping
  public :: add_moving_supports

  !> Dense matrices of 8*(3*points)^2 bytes at a time where joints are not separators in groups: the
  !> compliances with closed and open joints and the matrix between them. The Schur block is extra,
  !> where jumps are unknowns.
  integer, parameter :: num_dense = 3

  !> Stiffness of closed contact without penetration, over those of its law: frequencies differ by
  !> some 1e-4 from those of rigid contact.
  real(rk), parameter :: closed_over_normal = 1.0e3_rk, closed_over_slip = 1.0e2_rk

contains

  !> Linear without joints, else by *CONTROLS, JOINT SOLVER. Only full Newton combines joints with
  !> an unsymmetric tangent of the solids.
  subroutine make_equilibrium(plan, system, is_symmetric, balance, error)
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    logical, intent(in) :: is_symmetric !< the tangent of the solids
    class(equilibrium_solver), allocatable, intent(out) :: balance
    type(error_type), allocatable, intent(out) :: error
    character(len(plan%controls%joint_solver)) :: name
    name = plan%controls%joint_solver
    if (name == 'AUTO') name = condensed_solver
    if (.not. is_symmetric) name = full_solver
    if (system%operator%num_points == 0) then
      allocate (linear_equilibrium :: balance)
    else
      call make_joint_solver(trim(name), balance)
    end if
    balance%controls = plan%controls
    balance%part = system%matrix%part
    if (.not. plan%procedure%has_inertia .and. plan%controls%precision == 'MIXED') then
      balance%controls%precision = 'DOUBLE'
    end if
    associate (matrix => system%matrix)
      if (.not. (allocated(matrix%group) .or. matrix%orders_freely) .or. name /= condensed_solver &
          .or. size(system%modal, 2) > 0) call check_memory(system%operator%num_points, error)
    end associate
    call share_error(error)
    if (allocated(error)) return
    call make_solver(symmetric_solver, balance%factor, error, system%matrix%is_shared)
    if (allocated(error)) return
    call balance%factor%analyse(system%matrix, error)
  end subroutine make_equilibrium

  !> Checks that the memory of the dense matrices of the joints is available, by allocating and
  !> freeing it.
  subroutine check_memory(num_points, error)
    integer, intent(in) :: num_points !< of all joints
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable, volatile :: room(:) ! volatile: compilers would omit it
    integer(long) :: most
    integer :: status
    most = num_dense*(3_long*num_points)**2
    allocate (room(most), stat=status)
    if (status == 0) then
      if (most > 0) room(1) = 0.0_rk
      deallocate (room)
    else
      call raise(error, 'not enough memory: the dense matrices of '//as_text(num_points)// &
                 ' points of joints take '//as_text(max(1, nint(8.0e-9_rk*most)))//' GB; use '// &
                 'a coarser mesh at the joints, or take the coarser '// &
                 'surface as slave', system_failed)
    end if
  end subroutine check_memory

  !> Factors K_eff; a singular matrix is reported by node and direction.
  subroutine prepare_equilibrium(model, system, values, weight, balance, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight !< of the joint forces
    class(equilibrium_solver), intent(inout) :: balance
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: cause
    integer :: node
    call balance%prepare_matrix(system%matrix, values, weight, model%joints, system%operator, cause)
    if (.not. allocated(cause)) return
    if (balance%factor%failed_unknown > 0) then
      node = system%numbers%node(balance%factor%failed_unknown)
      call raise(error, 'the stiffness matrix is singular at '// &
                 system%numbers%describe(balance%factor%failed_unknown, model%mesh%node_id)// &
                 own_name_of_node(model%outside, model%instances, model%mesh%node_id(node))// &
                 ': a part of the model is free to move; add supports, or connect the part by '// &
                 'common nodes, a tie or a joint', cause%exit_code)
    else
      call move_alloc(cause, error)
    end if
  end subroutine prepare_equilibrium

  !> Factors K with closed joints.
  subroutine factorise_closed(model, system, costs, closed, balance, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(ledger), intent(in) :: costs
    real(rk), allocatable, intent(out) :: closed(:) !< values of the matrix
    type(linear_equilibrium), intent(out) :: balance
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: reference(:, :)
    call reference_stiffness(model%joints, system%operator, reference)
    call stiffen_contact(model, system, reference)
    allocate (closed, source=system%stiffness)
    call system%operator%add_stiffness(closed_tangent(reference), system%matrix, closed)
    call costs%start('analyse', 'structure', 'solver')
    call make_solver(symmetric_solver, balance%factor, error, system%matrix%is_shared)
    if (.not. allocated(error)) call balance%factor%analyse(system%matrix, error)
    call costs%stop()
    if (allocated(error)) return
    balance%costs = costs
    balance%part = system%matrix%part
    call prepare_equilibrium(model, system, closed, 1.0_rk, balance, error)
  end subroutine factorise_closed

  !> Contact without penetration has a stiffness that controls its iteration alone. Closed, it is
  !> far stiffer.
  subroutine stiffen_contact(model, system, stiffness)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(inout) :: stiffness(:, :) !< (3, points) [Pa/m]
    integer :: j
    do j = 1, size(model%joints)
      if (.not. model%joints(j)%law%penetration > 0.0_rk) cycle
      associate (first => system%operator%first_point(j), &
                 last => system%operator%first_point(j + 1) - 1)
        stiffness(1, first:last) = max(closed_over_normal*stiffness(1, first:last), &
                                       closed_over_slip*stiffness(2, first:last))
      end associate
    end do
  end subroutine stiffen_contact

  !> Gives modal damping to the solver; acts from `prepare_equilibrium` on.
  subroutine set_modal_damping(system, factor, balance)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: factor !< of C in K_eff [1/s]
    class(equilibrium_solver), intent(inout) :: balance
    if (size(system%modal, 2) == 0) return
    balance%low_rank = sqrt(factor)*system%modal(:system%matrix%num_free, :)
  end subroutine set_modal_damping

  !> Subtracts the forces of moving supports on the free unknowns from the right-hand side.
  subroutine add_moving_supports(system, values, x, rhs)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: x(:) !< (num_total) zero except at the supports
    real(rk), intent(inout) :: rhs(:) !< (free unknowns)
    real(rk), allocatable :: product(:)
    if (is_true_everywhere(.not. any(abs(x) > 0.0_rk))) return
    allocate (product(size(x)))
    call multiply(system%matrix, values, x, product)
    rhs = rhs - product(:size(rhs))
  end subroutine add_moving_supports
end module step_equilibrium
