!> What the mesh changes in a result: the defects of the stresses, weighted by those under the unit
!> force of the result (theory.md, 14.2). Elastic solids without temperatures.
module dual_weighting
  use dam_mesh, only: element_is_there
  use hex8_slopes, only: slopes_at_points, strains_of_slopes
  use kinds, only: rk
  use node_dofs, only: gather_vectors
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use fitted_stress, only: fitted_defect, make_patch_fit, patch_fit
  use stress_error, only: energy_of_stresses, hides_error, smoothing_plan, stress_defect
  use stress_recovery, only: recovery_plan, max_points, fewest_for_threads
  use tensor6, only: sum_tensors
  implicit none
  private
  public :: weigh_defects, weigh_own_defects

  !> What one field of displacements gives at 2 x 2 x 2 points of the solids.
  type :: point_fields
    real(rk), allocatable :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    !> (6, max_points, solids) strain of the element less that of its displacements: incompatible
    !> modes, and what mean strains leave out
    real(rk), allocatable :: added(:, :, :)
    real(rk), allocatable :: averaged(:, :, :) !< means of corners less own stress [Pa]
    real(rk), allocatable :: fitted(:, :, :) !< fitted less own stress, where fits are wanted [Pa]
  end type point_fields

contains

  !> The change of each result by the mesh: the true result less the computed one, as far as smooth
  !> stresses show it.
  subroutine weigh_defects(model, plan, smoothing, u, wants_fit, change, is_known)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    !> (3, nodes, 1 + results) displacements [m], then those under each unit force [m/N]
    real(rk), intent(in) :: u(:, :, :)
    logical, intent(in) :: wants_fit(:) !< (results) fitted stresses in elements that need them
    real(rk), intent(out) :: change(:) !< (results) [m]
    logical, intent(out) :: is_known(:) !< (results) not where solids without neighbours count
    type(point_fields) :: own(size(u, 3))
    logical :: is_fitted(plan%num_solids)
    integer :: k
    call find_fitted(plan, is_fitted)
    call find_fields(model, plan, smoothing, u, [any(wants_fit), wants_fit] .and. any(is_fitted), &
                     all(wants_fit) .and. all(is_fitted), own)
    do k = 1, size(change)
      change(k) = sum(products(model, plan, smoothing, is_fitted .and. wants_fit(k), own(1), &
                               own(k + 1))) &
                  + hourglass_work(model, plan, u(:, :, 1), u(:, :, k + 1))
      is_known(k) = shows_error(model, plan, smoothing, own(1), own(k + 1))
    end do
  end subroutine weigh_defects

  !> The same where the displacements are those under the forces of the result itself, with fitted
  !> stresses in all elements.
  subroutine weigh_own_defects(model, plan, smoothing, u, change, is_known)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    real(rk), intent(in) :: u(:, :, :) !< (3, nodes, results) displacements
    real(rk), intent(out) :: change(:) !< (results) force times displacement
    logical, intent(out) :: is_known(:) !< (results) not where solids without neighbours count
    type(point_fields) :: own(size(u, 3))
    logical :: is_fitted(plan%num_solids)
    integer :: k
    is_fitted = .true.
    call find_fields(model, plan, smoothing, u, spread(.true., 1, size(u, 3)), .true., own)
    do k = 1, size(change)
      change(k) = sum(products(model, plan, smoothing, is_fitted, own(k), own(k))) &
                  + hourglass_work(model, plan, u(:, :, k), u(:, :, k))
      is_known(k) = shows_error(model, plan, smoothing, own(k), own(k))
    end do
  end subroutine weigh_own_defects

  !> Whether the defects of two fields show their error: not where solids without neighbours have
  !> much of the energy.
  logical function shows_error(model, plan, smoothing, first, second)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(point_fields), intent(in) :: first, second
    real(rk), dimension(plan%num_solids) :: of_first, of_second
    shows_error = .not. any(smoothing%is_alone)
    if (shows_error) return
    call energy_of_stresses(model, plan, smoothing, first%stress, first%stress, of_first)
    call energy_of_stresses(model, plan, smoothing, second%stress, second%stress, of_second)
    shows_error = .not. hides_error(smoothing, of_first, of_second)
  end function shows_error

  !> What fields of displacements give at the points of the solids.
  subroutine find_fields(model, plan, smoothing, u, wants_fit, is_all_fitted, own)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    real(rk), intent(in) :: u(:, :, :) !< (3, nodes, fields)
    logical, intent(in) :: wants_fit(:) !< (fields)
    logical, intent(in) :: is_all_fitted !< no means of corners are needed
    type(point_fields), intent(inout) :: own(:) !< (fields)
    integer :: i, k
    do k = 1, size(own)
      allocate (own(k)%stress(6, max_points, plan%num_solids), source=0.0_rk)
      allocate (own(k)%added, source=own(k)%stress)
    end do
    !$omp parallel do default(none) shared(model, plan, u, own) schedule(dynamic, 4) &
    !$omp if (model%mesh%num_nodes > fewest_for_threads)
    do i = 1, size(plan%blocks)
      if (plan%formulations(plan%blocks(i)%formulation)%item%has_plain_strain) then
        call recover_plain_block(model, plan, i, u, own)
      else
        call recover_block(model, plan, i, u, own)
      end if
    end do
    !$omp end parallel do
    call smooth_stresses(model, plan, smoothing, wants_fit, is_all_fitted, own)
  end subroutine find_fields

  !> The solids that need fitted stresses: means at corners would hide their error.
  subroutine find_fitted(plan, is_fitted)
    type(recovery_plan), intent(in) :: plan
    logical, intent(out) :: is_fitted(:) !< (solids)
    integer :: i
    is_fitted = .false.
    do i = 1, size(plan%blocks)
      associate (element => plan%formulations(plan%blocks(i)%formulation)%item)
        is_fitted(plan%blocks(i)%solids) = element%has_small_jumps
      end associate
    end do
  end subroutine find_fitted

  !> Smooth stresses less those of the elements.
  subroutine smooth_stresses(model, plan, smoothing, wants_fit, is_all_fitted, own)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    logical, intent(in) :: wants_fit(:) !< (fields)
    logical, intent(in) :: is_all_fitted !< no means of corners are needed
    type(point_fields), intent(inout) :: own(:)
    type(patch_fit) :: fit
    integer :: k
    if (any(wants_fit)) call make_patch_fit(model%mesh, plan, smoothing, fit)
    do k = 1, size(own)
      if (.not. is_all_fitted) then
        allocate (own(k)%averaged, mold=own(k)%stress)
        call stress_defect(plan, smoothing, own(k)%stress, spread(.false., 1, plan%num_solids), &
                           own(k)%averaged)
      end if
      if (.not. wants_fit(k)) cycle
      allocate (own(k)%fitted, mold=own(k)%stress)
      call fitted_defect(model%mesh, plan, smoothing, fit, own(k)%stress, own(k)%fitted)
    end do
  end subroutine smooth_stresses

  !> Stresses of the elements of one block whose strain is that of their displacements.
  subroutine recover_plain_block(model, plan, block, u, own)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: block
    real(rk), intent(in) :: u(:, :, :) !< (3, nodes, fields)
    type(point_fields), intent(inout) :: own(:)
    real(rk) :: d(6, 6), slope(8, 3, 8), weight(8), strain(6, max_points), moved(hex8_dofs)
    integer :: i, k, s, status
    associate (part => plan%blocks(block))
      call model%materials(part%material)%law%elastic_stiffness(d)
      do i = 1, size(part%solids)
        s = part%solids(i)
        associate (nodes => model%mesh%nodes(:, plan%element_of_solid(s)))
          call slopes_at_points(model%mesh%x(:, nodes), slope, weight, status)
          do k = 1, size(own)
            moved = gather_vectors(u(:, :, k), nodes)
            call strains_of_slopes(slope, moved, strain)
            call sum_tensors(6, d, strain, 8, own(k)%stress(:, :, s))
          end do
        end associate
      end do
    end associate
  end subroutine recover_plain_block

  !> Stresses and added strains of the elements of one block, from all displacements. One point
  !> stands for all.
  subroutine recover_block(model, plan, block, u, own)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: block
    real(rk), intent(in) :: u(:, :, :) !< (3, nodes, fields)
    type(point_fields), intent(inout) :: own(:)
    real(rk) :: d(6, 6), slope(8, 3, 8), weight(8), compatible(6, max_points)
    real(rk) :: moved(hex8_dofs, size(own))
    real(rk), allocatable :: strain(:, :, :)
    integer :: i, k, q, s, status
    associate (part => plan%blocks(block), kind => plan%formulations)
      call model%materials(part%material)%law%elastic_stiffness(d)
      allocate (strain(6, kind(part%formulation)%item%num_points, size(own)))
      do i = 1, size(part%solids)
        s = part%solids(i)
        associate (nodes => model%mesh%nodes(:, plan%element_of_solid(s)))
          do k = 1, size(own)
            moved(:, k) = gather_vectors(u(:, :, k), nodes)
          end do
          call kind(part%formulation)%item%find_strains(model%mesh%x(:, nodes), d, moved, strain)
          call slopes_at_points(model%mesh%x(:, nodes), slope, weight, status)
        end associate
        do k = 1, size(own)
          call strains_of_slopes(slope, moved(:, k), compatible)
          do q = 1, max_points
            own(k)%added(:, q, s) = strain(:, min(q, size(strain, 2)), k)
          end do
          call sum_tensors(6, d, own(k)%added(:, :, s), 8, own(k)%stress(:, :, s))
          own(k)%added(:, :, s) = own(k)%added(:, :, s) - compatible
        end do
      end do
    end associate
  end subroutine recover_block

  !> The products of the defects of two fields in each solid, and of the added strains of each with
  !> the defect of the other [J].
  function products(model, plan, smoothing, is_fitted, first, second) result(work)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    logical, intent(in) :: is_fitted(:) !< (solids)
    type(point_fields), intent(in) :: first, second
    real(rk) :: work(plan%num_solids)
    integer :: s, m
    !$omp parallel do default(none) private(m) schedule(static) &
    !$omp if (plan%num_solids > fewest_for_threads) &
    !$omp shared(model, plan, smoothing, is_fitted, first, second, work)
    do s = 1, plan%num_solids
      work(s) = 0.0_rk
      m = model%mesh%material_of_element(plan%element_of_solid(s))
      if (m == 0 .or. .not. element_is_there(model%mesh, plan%element_of_solid(s))) cycle
      if (is_fitted(s)) then
        work(s) = product_of(smoothing%compliance(:, :, m), smoothing%volume(:, s), &
                             first%fitted(:, :, s), second%fitted(:, :, s), &
                             first%added(:, :, s), second%added(:, :, s))
      else
        work(s) = product_of(smoothing%compliance(:, :, m), smoothing%volume(:, s), &
                             first%averaged(:, :, s), second%averaged(:, :, s), &
                             first%added(:, :, s), second%added(:, :, s))
      end if
    end do
    !$omp end parallel do
  end function products

  !> The same of one solid, summed over its points.
  pure real(rk) function product_of(compliance, volume, a, b, added_a, added_b) result(work)
    real(rk), intent(in) :: compliance(6, 6) !< [1/Pa]
    real(rk), intent(in) :: volume(max_points) !< [m3]
    real(rk), intent(in) :: a(6, max_points), b(6, max_points) !< defects [Pa]
    real(rk), intent(in) :: added_a(6, max_points), added_b(6, max_points) !< strains
    real(rk) :: strain(6)
    integer :: q, j
    work = 0.0_rk
    do q = 1, max_points
      strain = added_b(:, q)
      do j = 1, 6
        strain = strain + compliance(:, j)*b(j, q)
      end do
      work = work + volume(q)*(sum(a(:, q)*strain) + sum(added_a(:, q)*b(:, q)))
    end do
  end function product_of

  !> The work of the hourglass forces of one field along the other [J].
  real(rk) function hourglass_work(model, plan, first, second) result(work)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    real(rk), intent(in) :: first(:, :), second(:, :) !< (3, nodes)
    real(rk) :: d(6, 6), ke(hex8_dofs, hex8_dofs, 1), x(3, 8, 1)
    integer :: i, k
    work = 0.0_rk
    do i = 1, size(plan%blocks)
      associate (part => plan%blocks(i), kinds => plan%formulations)
        if (kinds(part%formulation)%item%num_points > 1) cycle
        call model%materials(part%material)%law%elastic_stiffness(d)
        do k = 1, size(part%solids)
          associate (nodes => model%mesh%nodes(:, plan%element_of_solid(part%solids(k))))
            x(:, :, 1) = model%mesh%x(:, nodes)
            ke = 0.0_rk
            call kinds(part%formulation)%item%add_stabilisation(x, d, ke)
            work = work + dot_product(gather_vectors(first, nodes), &
                                      matmul(ke(:, :, 1), gather_vectors(second, nodes)))
          end associate
        end do
      end associate
    end do
  end function hourglass_work
end module dual_weighting
