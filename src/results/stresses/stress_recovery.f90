!> Strains and stresses at the points of the solid elements.
!>
!> Elastic solids: eps = B u with the element's own operator, sigma = D eps less the thermal strain.
!> Solids of inelastic blocks: strain and stress of their states. A wedge is a hexahedron with
!> repeated nodes.
module stress_recovery
  use kinds, only: rk
  use node_dofs, only: gather_vectors
  use principal_loops, only: find_principals
  use problem_definition, only: problem
  use recovery_plans, only: element_block, fewest_for_threads, recovery_plan
  use shape_hex8, only: hex8_dofs
  use slope_products, only: find_slopes, find_symmetric_gradient
  use analysis_state, only: state
  use thermal_recovery, only: add_expansion, take_thermal
  implicit none
  private
  public :: recover_points, recover_some, recover_principals, copy_states, recover_expansions
  public :: operators_of_block, motion_of_element

contains

  !> Strain, stress or both at the points of all solids; one thread a block.
  subroutine recover_points(model, plan, now, strain, stress)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    real(rk), intent(inout), optional :: strain(:, :, :) !< (6, max_points, solids)
    real(rk), intent(inout), optional :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    integer :: i
    !$omp parallel do default(none) shared(model, plan, now, strain, stress) &
    !$omp schedule(dynamic, 4) if (model%mesh%num_nodes > fewest_for_threads)
    do i = 1, size(plan%blocks)
      call recover_part(model, plan, plan%blocks(i), now, strain, stress)
    end do
    !$omp end parallel do
  end subroutine recover_points

  !> Stress at the points of some solids; the values of others remain.
  subroutine recover_some(model, plan, now, is_wanted, stress)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    logical, intent(in) :: is_wanted(:) !< (solids)
    real(rk), intent(inout) :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    type(element_block) :: part
    integer :: i
    do i = 1, size(plan%blocks)
      if (.not. any(is_wanted(plan%blocks(i)%solids))) cycle
      part = plan%blocks(i)
      part%solids = pack(part%solids, is_wanted(part%solids))
      call recover_part(model, plan, part, now, stress=stress)
    end do
  end subroutine recover_some

  !> Principal stresses at the points of all solids, without an array of their stresses; one thread
  !> a block.
  subroutine recover_principals(model, plan, now, values)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    real(rk), intent(inout) :: values(:, :, :) !< (3, max_points, solids) the largest first [Pa]
    integer :: i
    !$omp parallel do default(none) shared(model, plan, now, values) schedule(dynamic, 4) &
    !$omp if (model%mesh%num_nodes > fewest_for_threads)
    do i = 1, size(plan%blocks)
      call principals_of_part(model, plan, plan%blocks(i), now, values)
    end do
    !$omp end parallel do
  end subroutine recover_principals

  !> Principal stresses of one block.
  subroutine principals_of_part(model, plan, part, now, values)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(inout) :: values(:, :, :) !< (3, max_points, solids) [Pa]
    real(rk), allocatable :: stress(:, :, :)
    integer :: k, n, before
    if (.not. part%is_inelastic) call find_elastic_stress(model, plan, part, now, stress)
    do k = 1, size(part%solids)
      associate (s => part%solids(k))
        n = plan%num_points(s)
        if (part%is_inelastic) then
          before = plan%points_before(s)
          call find_principals(n, now%points(plan%inelastic_block(s))%stress(:, before + 1: &
                                                                             before + n), &
                               values(:, :n, s))
        else
          call find_principals(n, stress(:, :, k), values(:, :n, s))
        end if
      end associate
    end do
  end subroutine principals_of_part

  !> Strain, stress or both of one block, or of a part of it. An absent array is not passed on: its
  !> bounds are undefined.
  subroutine recover_part(model, plan, part, now, strain, stress)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(inout), optional :: strain(:, :, :), stress(:, :, :)
    real(rk), allocatable :: found(:, :, :), found_stress(:, :, :)
    integer :: k
    if (part%is_inelastic) then
      if (present(strain)) call copy_states(plan, now, part%solids, strain=strain)
      if (present(stress)) call copy_states(plan, now, part%solids, stress=stress)
    else
      call find_elastic_stress(model, plan, part, now, found_stress, found)
      do k = 1, size(part%solids)
        if (present(strain)) strain(:, :size(found, 2), part%solids(k)) = found(:, :, k)
        if (present(stress)) stress(:, :size(found, 2), part%solids(k)) = found_stress(:, :, k)
      end do
    end if
    if (present(strain)) call add_expansions(model, plan, part, now, strain)
  end subroutine recover_part

  !> Stress of one elastic block, and the strain that gives it.
  subroutine find_elastic_stress(model, plan, part, now, stress, strain)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), allocatable, intent(out) :: stress(:, :, :) !< (6, points, solids of the block) [Pa]
    real(rk), allocatable, intent(out), optional :: strain(:, :, :) !< (6, points, solids)
    real(rk), allocatable :: found(:, :, :)
    real(rk) :: d(6, 6)
    integer :: k, q
    call model%materials(part%material)%law%elastic_stiffness(d)
    call find_strains(model, plan, part, now, d, found)
    allocate (stress, mold=found)
    do k = 1, size(found, 3)
      do q = 1, size(found, 2)
        stress(:, q, k) = matmul(d, found(:, q, k))
      end do
    end do
    if (present(strain)) call move_alloc(found, strain)
  end subroutine find_elastic_stress

  !> Strain, stress or both of solids with states.
  subroutine copy_states(plan, now, solids, strain, stress)
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    integer, intent(in) :: solids(:) !< of inelastic blocks
    real(rk), intent(inout), optional :: strain(:, :, :), stress(:, :, :)
    integer :: k, n, first, last
    do k = 1, size(solids)
      n = plan%num_points(solids(k))
      first = plan%points_before(solids(k)) + 1
      last = plan%points_before(solids(k)) + n
      associate (points => now%points(plan%inelastic_block(solids(k))))
        if (present(strain)) strain(:, :n, solids(k)) = points%strain(:, first:last)
        if (present(stress)) stress(:, :n, solids(k)) = points%stress(:, first:last)
      end associate
    end do
  end subroutine copy_states

  !> Adds the expansions to the strains of one block.
  subroutine add_expansions(model, plan, part, now, strain)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(inout) :: strain(:, :, :) !< (6, max_points, solids)
    real(rk), allocatable :: own(:, :, :)
    integer :: n
    if (.not. allocated(now%heat%reference)) return
    n = plan%formulations(part%formulation)%item%num_points
    own = strain(:, :n, part%solids)
    call add_expansion(model, now, plan%element_of_solid(part%solids), own)
    strain(:, :n, part%solids) = own
  end subroutine add_expansions

  !> The expansions at the points of all solids.
  subroutine recover_expansions(model, plan, now, strain)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    real(rk), intent(out) :: strain(:, :, :) !< (6, max_points, solids)
    integer :: i
    strain = 0.0_rk
    !$omp parallel do default(none) shared(model, plan, now, strain) schedule(dynamic, 4) &
    !$omp if (model%mesh%num_nodes > fewest_for_threads)
    do i = 1, size(plan%blocks)
      call add_expansions(model, plan, plan%blocks(i), now, strain)
    end do
    !$omp end parallel do
  end subroutine recover_expansions

  !> Strains of one elastic block that give stress.
  subroutine find_strains(model, plan, part, now, d, strain)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(in) :: d(6, 6) !< [Pa]
    real(rk), allocatable, intent(out) :: strain(:, :, :) !< (6, points, solids of the block)
    associate (formulation => plan%formulations(part%formulation)%item)
      allocate (strain(6, formulation%num_points, size(part%solids)))
      if (formulation%has_plain_strain) then
        call find_plain_strains(model, plan, part, now, strain)
      else
        call find_general_strains(model, plan, part, now, d, strain)
      end if
    end associate
    call take_thermal(model, now, plan%element_of_solid(part%solids), strain)
  end subroutine find_strains

  !> Strains of elements whose strain is the symmetric gradient.
  subroutine find_plain_strains(model, plan, part, now, strain)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(out) :: strain(:, :, :) !< (6, points, solids of the block)
    real(rk) :: slope(8, 3, 8), weight(8)
    integer :: k, e, status
    do k = 1, size(part%solids)
      e = plan%element_of_solid(part%solids(k))
      call find_slopes(model%mesh%x(:, model%mesh%nodes(:, e)), slope, weight, status)
      call find_symmetric_gradient(slope, motion_of_element(model, now, e), strain(:, :, k))
    end do
  end subroutine find_plain_strains

  !> Strains of other elements.
  subroutine find_general_strains(model, plan, part, now, d, strain)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(in) :: d(6, 6) !< [Pa]
    real(rk), contiguous, intent(out) :: strain(:, :, :) !< (6, points, solids of the block)
    real(rk) :: moved(hex8_dofs, 1)
    integer :: k, e
    do k = 1, size(part%solids)
      e = plan%element_of_solid(part%solids(k))
      moved(:, 1) = motion_of_element(model, now, e)
      call plan%formulations(part%formulation)%item%find_strains( &
        model%mesh%x(:, model%mesh%nodes(:, e)), d, moved, strain(:, :, k:k))
    end do
  end subroutine find_general_strains

  !> Displacements of the nodes of an element since it appeared without stress.
  pure function motion_of_element(model, now, element) result(moved)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: element !< position
    real(rk) :: moved(hex8_dofs) !< [m]
    moved = gather_vectors(now%u, model%mesh%nodes(:, element))
    if (allocated(now%origin)) moved = moved - now%origin(:, element)
  end function motion_of_element

  !> Strain operators of the elements of a block at their points, and the elastic stiffness.
  subroutine operators_of_block(model, plan, part, b, d)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    real(rk), allocatable, intent(out) :: b(:, :, :, :) !< (6, 24, points, elements) [1/m]
    real(rk), intent(out) :: d(6, 6) !< [Pa]
    real(rk), allocatable :: x(:, :, :), weight(:, :)
    integer, allocatable :: status(:)
    integer :: k, n, points
    n = size(part%solids)
    points = plan%formulations(part%formulation)%item%num_points
    allocate (b(6, hex8_dofs, points, n), weight(points, n), x(3, 8, n), status(n))
    do k = 1, n
      x(:, :, k) = model%mesh%x(:, model%mesh%nodes(:, plan%element_of_solid(part%solids(k))))
    end do
    call model%materials(part%material)%law%elastic_stiffness(d)
    call plan%formulations(part%formulation)%item%strain_operator(x, d, b, weight, status)
  end subroutine operators_of_block
end module stress_recovery
