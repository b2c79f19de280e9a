!> Damping that cracks have lost: with *DAMPING, BASE=CURRENT the part of C that is proportional to
!> the stiffness follows the damaged stiffness (theory.md, (5.2)):
!>
!>   C_current v = C v - sum w B^T beta (1 - omega) D eps_dot
!>
!> summed over the points that are not elastic. omega is the stiffness factor of the law at the
!> start of the increment. The sum is between 0 and C, so that the iteration with the matrix of the
!> undamaged solids contracts.
module lost_damping
  use damping_rayleigh, only: rayleigh_coefficients
  use increment_balance, only: increment_task
  use inelastic_blocks, only: inelastic_block
  use inelastic_forces, only: add_elements, block_answer, has_many_elements
  use kinds, only: rk
  use material_points, only: point_state
  use node_dofs, only: gather_vectors
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use step_system, only: dam_system
  use step_plan, only: step
  implicit none
  private
  public :: damping_loss

  type :: damping_loss
    real(rk), allocatable :: beta(:) !< (materials) of the damaged stiffness [s]; without any: none
    real(rk), allocatable :: force(:) !< (num_total) lost damping force of the last iterate [N]
  contains
    procedure :: open => choose_factors
    procedure :: is_same
    procedure :: add_force
  end type damping_loss

contains

  !> Opens a step.
  subroutine choose_factors(self, model, plan)
    class(damping_loss), intent(out) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    real(rk) :: alpha, of_step
    of_step = 0.0_rk
    if (plan%damping%ratio > 0.0_rk .and. plan%damping%is_current) then
      call rayleigh_coefficients(plan%damping%ratio, plan%damping%f1, plan%damping%f2, alpha, &
                                 of_step)
    end if
    if (.not. allocated(model%inelastic)) return
    self%beta = of_step + merge(model%materials%beta, 0.0_rk, model%materials%damps_current)
    if (size(model%inelastic) == 0 .or. .not. any(self%beta > 0.0_rk)) deallocate (self%beta)
  end subroutine choose_factors

  !> Whether a step loses the damping that another one loses.
  logical function is_same(self, model, other)
    class(damping_loss), intent(in) :: self
    type(problem), intent(in) :: model
    type(step), intent(in) :: other
    type(damping_loss) :: loss
    call loss%open(model, other)
    is_same = allocated(self%beta) .and. allocated(loss%beta)
    if (is_same) is_same = all(abs(self%beta - loss%beta) <= 0.0_rk)
  end function is_same

  !> Adds the lost damping force to the initial-stress force. Where the answers have tangents the
  !> loss of damping is added to them as a loss of stiffness.
  subroutine add_force(self, model, system, task, old, answers, excess)
    class(damping_loss), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(increment_task), intent(in) :: task !< with its velocities and a trial `x`
    type(point_state), intent(in) :: old(:) !< (blocks) converged
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    real(rk), intent(inout) :: excess(:) !< (num_total) [N]
    real(rk) :: v(3, system%numbers%num_nodes), force(3, system%numbers%num_nodes)
    integer :: i
    if (.not. allocated(self%beta)) return
    call system%numbers%expand(task%velocity + task%velocity_of_x*task%x, v)
    !$omp parallel do schedule(dynamic) default(none) shared(self, model, task, v, old, answers) &
    !$omp if (has_many_elements(answers))
    do i = 1, size(answers)
      call sum_block(model, model%inelastic(i), self%beta(model%inelastic(i)%material), v, &
                     task%velocity_of_x, old(i), answers(i))
    end do
    !$omp end parallel do
    force = 0.0_rk
    do i = 1, size(answers)
      if (.not. allocated(answers(i)%lost)) cycle
      call add_elements(model, i, answers(i)%lost, answers(i)%has_excess, force)
    end do
    self%force = excess ! for its size
    call system%numbers%reduce(force, self%force)
    call system%matrix%part%add(self%force)
    excess = excess + self%force
  end subroutine add_force

  !> The elements of one block; `answer%lost` is not allocated where nothing is lost.
  subroutine sum_block(model, part, beta, v, velocity_of_x, old, answer)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    real(rk), intent(in) :: beta !< [s]
    real(rk), intent(in) :: v(:, :) !< (3, nodes) [m/s]
    real(rk), intent(in) :: velocity_of_x !< [1/s]
    type(point_state), intent(in) :: old
    type(block_answer), intent(inout) :: answer
    real(rk) :: factor(part%points%num_points), loss, moved(hex8_dofs)
    real(rk) :: rate(6, part%points_of_element), stress(part%points_of_element, 6)
    integer :: e, q, p
    if (allocated(answer%lost)) deallocate (answer%lost)
    if (beta <= 0.0_rk .or. .not. part%is_here() .or. all(old%is_elastic)) return
    allocate (answer%lost(hex8_dofs, size(part%elements)), source=0.0_rk)
    call model%materials(part%material)%law%find_stiffness_factors(old, factor)
    do e = 1, size(part%elements)
      moved = gather_vectors(v, model%mesh%nodes(:, part%elements(e)))
      call part%find_strains(e, moved, rate)
      stress = 0.0_rk
      do q = 1, part%points_of_element
        p = (e - 1)*part%points_of_element + q
        loss = beta*(1.0_rk - factor(p))
        if (old%is_elastic(p) .or. loss <= 0.0_rk) cycle
        stress(q, :) = part%weight(q, e)*loss*matmul(part%d, rate(:, q))
        answer%has_excess(e) = .true.
        if (size(answer%tangent, 3) == 0) cycle
        answer%tangent(:, :, p) = answer%tangent(:, :, p) - velocity_of_x*loss*part%d
      end do
      call part%add_forces(e, stress, answer%lost(:, e))
    end do
  end subroutine sum_block
end module lost_damping
