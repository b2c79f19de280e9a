!> Stress that makes the work of an increment equal to its energies (theory.md, (12.6)): of
!> laws whose stress is the derivative of a free energy, in dynamic steps.
!>
!> The mean s of the stresses at both ends of an increment does the work s : de. Where the strain
!> crosses the closure of a crack, or a crack grows, this is not the change W of stored and
!> dissipated energy. The discrete gradient of Gonzalez adds the least stress in the energy norm
!> that makes it so (O. Gonzalez, J. Nonlinear Sci. 6 (1996) 449-467):
!>
!>   ds = (W - s : de)/(de : D de) D de
!>
!> Its force, sum w B^T ds, acts with an impulse over the increment, like the forces of joints.
module conserving_stress
  use inelastic_blocks, only: inelastic_block
  use inelastic_forces, only: add_elements, block_answer, has_many_elements
  use kinds, only: rk
  use material_law, only: stress_law
  use material_points, only: consistent_tangent, crushing_energy, fracture_energy, no_tangent, &
                             point_state, stored_energy, time_increment, update_report
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use step_system, only: dam_system
  implicit none
  private
  public :: work_correction, point_work, correct_stress

  !> The square de : D de counts this fraction of the energies more: their change is round-off in
  !> increments that are so small.
  real(rk), parameter :: smallest_square = 1.0e-10_rk
  !> Step of differences of the energies, over the largest component of the increment of strain.
  real(rk), parameter :: difference = 1.0e-6_rk
  integer, parameter :: parts(3) = [stored_energy, fracture_energy, crushing_energy]

  type :: work_correction
    logical, allocatable :: has_energy(:) !< (blocks) by their laws; not allocated: none has
    real(rk) :: weight = 0.0_rk !< of its force, over that of the solids; 0: no correction
    real(rk), allocatable :: force(:) !< (num_total) of the last iterate [N]
  contains
    procedure :: open => choose_blocks
    procedure :: is_active
    procedure :: add_force
  end type work_correction

  !> The work of an increment at a point.
  type :: point_work
    real(rk) :: moved(6) = 0.0_rk !< strain of the increment, engineering shear
    real(rk) :: stress(6, 2) = 0.0_rk !< at both ends [Pa]
    real(rk) :: change = 0.0_rk !< of stored and dissipated energy [J/m3]
    real(rk) :: size = 0.0_rk !< of the energies: of their round-off [J/m3]
  end type point_work

contains

  !> Opens a dynamic step, or an increment of another size.
  subroutine choose_blocks(self, model, weight)
    class(work_correction), intent(inout) :: self
    type(problem), intent(in) :: model
    real(rk), intent(in) :: weight !< of its force, over that of the solids
    integer :: i
    self%weight = weight
    if (allocated(self%has_energy) .or. .not. allocated(model%inelastic)) return
    allocate (self%has_energy(size(model%inelastic)))
    do i = 1, size(self%has_energy)
      self%has_energy(i) = model%materials(model%inelastic(i)%material)%law%has_free_energy
    end do
    if (.not. any(self%has_energy)) deallocate (self%has_energy)
  end subroutine choose_blocks

  !> Whether the iteration needs energies.
  pure logical function is_active(self)
    class(work_correction), intent(in) :: self
    is_active = allocated(self%has_energy) .and. self%weight > 0.0_rk
  end function is_active

  !> Takes the weighted force from the initial-stress force. Consistent tangents get its derivative.
  subroutine add_force(self, model, system, time, old, new, answers, excess)
    class(work_correction), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old(:), new(:) !< (blocks) at both ends of the increment
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    real(rk), intent(inout) :: excess(:) !< (num_total) [N]
    real(rk) :: nodal(3, system%numbers%num_nodes)
    integer :: i
    if (.not. self%is_active()) return
    !$omp parallel do schedule(dynamic) default(none) &
    !$omp shared(self, model, time, old, new, answers) if (has_many_elements(answers))
    do i = 1, size(answers)
      if (.not. (self%has_energy(i) .and. model%inelastic(i)%is_here())) cycle
      associate (part => model%inelastic(i))
        call correct_block(model%materials(part%material)%law, part, time, self%weight, old(i), &
                           new(i), answers(i))
      end associate
    end do
    !$omp end parallel do
    nodal = 0.0_rk
    do i = 1, size(answers)
      if (.not. allocated(answers(i)%correction)) cycle
      call add_elements(model, i, answers(i)%correction, answers(i)%has_excess, nodal)
    end do
    self%force = excess ! for its size
    call system%numbers%reduce(nodal, self%force)
    call system%matrix%part%add(self%force)
    excess = excess - self%weight*self%force
  end subroutine add_force

  !> The elements of one block; `answer%correction` is not allocated where all points are elastic.
  subroutine correct_block(law, part, time, weight, old, new, answer)
    class(stress_law), intent(in) :: law
    type(inelastic_block), intent(in) :: part
    type(time_increment), intent(in) :: time
    real(rk), intent(in) :: weight
    type(point_state), intent(in) :: old, new
    type(block_answer), intent(inout) :: answer
    real(rk) :: stress(6), of_element(part%points_of_element, 6), slope(6, 6)
    real(rk), allocatable :: gradient(:, :)
    type(point_work) :: own
    integer :: e, q, p, last
    if (allocated(answer%correction)) deallocate (answer%correction)
    if (all(new%is_elastic)) return
    allocate (answer%correction(hex8_dofs, size(part%elements)), source=0.0_rk)
    if (time%tangent == consistent_tangent) then
      call differentiate_energy(law, part, time, old, new, gradient)
    end if
    do e = 1, size(part%elements)
      last = e*part%points_of_element
      if (all(new%is_elastic(last - part%points_of_element + 1:last))) cycle
      of_element = 0.0_rk
      do q = 1, part%points_of_element
        p = last - part%points_of_element + q
        if (new%is_elastic(p)) cycle
        own = work_at(old, new, p)
        call correct_stress(part%d, own, stress)
        of_element(q, :) = part%weight(q, e)*stress
        if (.not. allocated(gradient)) cycle
        call correct_stress(part%d, own, stress, answer%tangent(:, :, p), gradient(:, p), slope)
        answer%tangent(:, :, p) = answer%tangent(:, :, p) + weight*slope
      end do
      call part%add_forces(e, of_element, answer%correction(:, e))
    end do
  end subroutine correct_block

  !> Work and energies of an increment at point `p`.
  pure function work_at(old, new, p) result(own)
    type(point_state), intent(in) :: old, new
    integer, intent(in) :: p
    type(point_work) :: own
    own%moved = new%strain(:, p) - old%strain(:, p)
    own%stress(:, 1) = old%stress(:, p)
    own%stress(:, 2) = new%stress(:, p)
    own%change = sum(new%energy(parts, p) - old%energy(parts, p))
    own%size = sum(abs(new%energy(parts, p)) + abs(old%energy(parts, p)))
  end function work_at

  !> Derivatives of stored and dissipated energy by the strain at the end: the stress, where nothing
  !> is dissipated in the increment; else by differences, as flow and damage follow from many
  !> equations.
  subroutine differentiate_energy(law, part, time, old, new, gradient)
    class(stress_law), intent(in) :: law
    type(inelastic_block), intent(in) :: part
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old, new
    real(rk), allocatable, intent(out) :: gradient(:, :) !< (6, points) [Pa]
    type(point_state) :: moved
    type(time_increment) :: without_tangent
    type(update_report) :: report
    real(rk) :: step(part%points%num_points), unused(6, 6, 0)
    logical :: dissipates(part%points%num_points)
    integer :: k, p
    gradient = new%stress
    dissipates = abs(sum(new%energy(parts(2:), :) - old%energy(parts(2:), :), 1)) > 0.0_rk
    if (.not. any(dissipates)) return
    without_tangent = time
    without_tangent%tangent = no_tangent
    step = difference*maxval(abs(new%strain - old%strain), 1)
    do k = 1, 6
      moved = new
      moved%strain(k, :) = new%strain(k, :) + step
      call law%update(part%points, without_tangent, old, moved, unused, report)
      do p = 1, size(step)
        if (dissipates(p) .and. step(p) > 0.0_rk) then
          gradient(k, p) = sum(moved%energy(parts, p) - new%energy(parts, p))/step(p)
        end if
      end do
    end do
  end subroutine differentiate_energy

  !> The stress of one point, and its derivative by the strain at the end.
  pure subroutine correct_stress(d, own, stress, tangent, gradient, slope)
    real(rk), intent(in) :: d(6, 6) !< elastic stiffness [Pa]
    type(point_work), intent(in) :: own
    real(rk), intent(out) :: stress(6) !< [Pa]
    real(rk), intent(in), optional :: tangent(6, 6) !< derivative of the stress at the end [Pa]
    real(rk), intent(in), optional :: gradient(6) !< derivative of the energies [Pa]
    real(rk), intent(out), optional :: slope(6, 6) !< derivative of this stress [Pa]
    real(rk) :: direction(6), mean(6), square, factor, row(6)
    integer :: i
    direction = matmul(d, own%moved)
    mean = 0.5_rk*(own%stress(:, 1) + own%stress(:, 2))
    square = dot_product(own%moved, direction) + smallest_square*own%size
    factor = 0.0_rk
    if (square > 0.0_rk) factor = (own%change - dot_product(mean, own%moved))/square
    stress = factor*direction
    if (.not. present(slope)) return
    slope = factor*d
    if (square <= 0.0_rk) return
    row = gradient - mean - 0.5_rk*matmul(own%moved, tangent) - 2.0_rk*factor*direction
    do i = 1, 6
      slope(:, i) = slope(:, i) + direction*row(i)/square
    end do
  end subroutine correct_stress
end module conserving_stress
