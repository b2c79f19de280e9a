!> What the mesh changes in a result: the defects of the stresses, weighted by those under the unit
!> force of the result (theory.md, 14.2). Elastic solids without temperatures.
module dual_weighting
  use dam_mesh, only: element_is_there
  use hex8_slopes, only: slopes_at_points, strains_of_slopes
  use kinds, only: rk
  use node_dofs, only: gather_vectors
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use fitted_stress, only: fit_stress, make_patch_fit, patch_fit
  use stress_error, only: average_patches, defect_of_solid, energy_of_stresses, hides_error, &
                          smoothing_plan
  use recovery_plans, only: fewest_for_threads, max_points, recovery_plan
  use tensor6, only: sum_tensors
  implicit none
  private
  public :: weigh_defects, weigh_own_defects

  !> What one field of displacements gives at 2 x 2 x 2 points of the solids, and its smooth
  !> stresses. One or two fields are in memory together.
  type :: point_fields
    real(rk), allocatable :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    !> (6, max_points, solids) strain of the element less that of its displacements: incompatible
    !> modes, and what mean strains leave out; not allocated where no element has any
    real(rk), allocatable :: added(:, :, :)
    real(rk), allocatable :: averaged(:, :) !< (6, patches) means of corners, where needed [Pa]
    real(rk), allocatable :: fitted(:, :) !< (6, patches) where fits are wanted [Pa]
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
    type(point_fields) :: own, dual
    type(patch_fit) :: fit
    logical :: is_fitted(plan%num_solids), takes_fits, takes_means
    integer :: k
    call find_fitted(plan, is_fitted)
    takes_fits = any(wants_fit) .and. any(is_fitted)
    takes_means = .not. (all(wants_fit) .and. all(is_fitted))
    if (takes_fits) call make_patch_fit(model%mesh, plan, smoothing, fit)
    call find_field(model, plan, smoothing, fit, u(:, :, 1), [takes_fits, takes_means], own)
    do k = 1, size(change)
      takes_fits = wants_fit(k) .and. any(is_fitted)
      takes_means = .not. (wants_fit(k) .and. all(is_fitted))
      call find_field(model, plan, smoothing, fit, u(:, :, k + 1), [takes_fits, takes_means], dual)
      change(k) = sum(products(model, plan, smoothing, is_fitted .and. wants_fit(k), own, dual)) &
                  + hourglass_work(model, plan, u(:, :, 1), u(:, :, k + 1))
      is_known(k) = shows_error(model, plan, smoothing, own, dual)
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
    type(point_fields) :: own
    type(patch_fit) :: fit
    integer :: k
    call make_patch_fit(model%mesh, plan, smoothing, fit)
    do k = 1, size(change)
      call find_field(model, plan, smoothing, fit, u(:, :, k), [.true., .false.], own)
      change(k) = sum(products(model, plan, smoothing, spread(.true., 1, plan%num_solids), own, &
                               own)) &
                  + hourglass_work(model, plan, u(:, :, k), u(:, :, k))
      is_known(k) = shows_error(model, plan, smoothing, own, own)
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
    call energy_of_stresses(model, plan, smoothing, first%stress, of_first)
    call energy_of_stresses(model, plan, smoothing, second%stress, of_second)
    shows_error = .not. hides_error(smoothing, of_first, of_second)
  end function shows_error

  !> What a field of displacements gives at the points of the solids, and its smooth stresses.
  subroutine find_field(model, plan, smoothing, fit, u, wants, own)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(in) :: fit !< where a fit is wanted
    real(rk), intent(in) :: u(:, :) !< (3, nodes)
    logical, intent(in) :: wants(2) !< the fit; the means of corners
    type(point_fields), intent(out) :: own
    integer :: i
    allocate (own%stress(6, max_points, plan%num_solids), source=0.0_rk)
    if (.not. all([(plan%formulations(i)%item%has_plain_strain, &
                    i=1, size(plan%formulations))])) allocate (own%added, source=own%stress)
    !$omp parallel do default(none) shared(model, plan, u, own) schedule(dynamic, 4) &
    !$omp if (model%mesh%num_nodes > fewest_for_threads)
    do i = 1, size(plan%blocks)
      if (plan%formulations(plan%blocks(i)%formulation)%item%has_plain_strain) then
        call recover_plain_block(model, plan, i, u, own%stress)
      else
        call recover_block(model, plan, i, u, own)
      end if
    end do
    !$omp end parallel do
    if (wants(1)) call fit_stress(model%mesh, plan, smoothing, fit, own%stress, own%fitted)
    if (.not. wants(2)) return
    call average_patches(plan, smoothing, own%stress, spread(.false., 1, plan%num_solids), &
                         own%averaged)
  end subroutine find_field

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

  !> Stresses of the elements of one block whose strain is that of their displacements.
  subroutine recover_plain_block(model, plan, block, u, stress)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: block
    real(rk), intent(in) :: u(:, :) !< (3, nodes)
    real(rk), contiguous, intent(inout) :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    real(rk) :: d(6, 6), slope(8, 3, 8), weight(8), strain(6, max_points)
    integer :: i, s, status
    associate (part => plan%blocks(block))
      call model%materials(part%material)%law%elastic_stiffness(d)
      do i = 1, size(part%solids)
        s = part%solids(i)
        associate (nodes => model%mesh%nodes(:, plan%element_of_solid(s)))
          call slopes_at_points(model%mesh%x(:, nodes), slope, weight, status)
          call strains_of_slopes(slope, gather_vectors(u, nodes), strain)
          call sum_tensors(6, d, strain, 8, stress(:, :, s))
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
    real(rk), intent(in) :: u(:, :) !< (3, nodes)
    type(point_fields), intent(inout) :: own
    real(rk) :: d(6, 6), slope(8, 3, 8), weight(8), compatible(6, max_points)
    real(rk) :: moved(hex8_dofs, 1)
    real(rk), allocatable :: strain(:, :, :)
    integer :: i, q, s, status
    associate (part => plan%blocks(block), kind => plan%formulations)
      call model%materials(part%material)%law%elastic_stiffness(d)
      allocate (strain(6, kind(part%formulation)%item%num_points, 1))
      do i = 1, size(part%solids)
        s = part%solids(i)
        associate (nodes => model%mesh%nodes(:, plan%element_of_solid(s)))
          moved(:, 1) = gather_vectors(u, nodes)
          call kind(part%formulation)%item%find_strains(model%mesh%x(:, nodes), d, moved, strain)
          call slopes_at_points(model%mesh%x(:, nodes), slope, weight, status)
        end associate
        call strains_of_slopes(slope, moved(:, 1), compatible)
        do q = 1, max_points
          own%added(:, q, s) = strain(:, min(q, size(strain, 2)), 1)
        end do
        call sum_tensors(6, d, own%added(:, :, s), 8, own%stress(:, :, s))
        own%added(:, :, s) = own%added(:, :, s) - compatible
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
    real(rk), dimension(6, max_points) :: a, b, added_a, added_b
    integer :: s, m
    !$omp parallel do default(none) private(m, a, b, added_a, added_b) schedule(static) &
    !$omp if (plan%num_solids > fewest_for_threads) &
    !$omp shared(model, plan, smoothing, is_fitted, first, second, work)
    do s = 1, plan%num_solids
      work(s) = 0.0_rk
      m = model%mesh%material_of_element(plan%element_of_solid(s))
      if (m == 0 .or. .not. element_is_there(model%mesh, plan%element_of_solid(s))) cycle
      call defect_of_field(smoothing, first, s, is_fitted(s), a, added_a)
      call defect_of_field(smoothing, second, s, is_fitted(s), b, added_b)
      work(s) = product_of(smoothing%compliance(:, :, m), smoothing%volume(:, s), a, b, added_a, &
                           added_b)
    end do
    !$omp end parallel do
  end function products

  !> The defect of a field and its added strain in one solid.
  pure subroutine defect_of_field(smoothing, own, solid, is_fitted, defect, added)
    type(smoothing_plan), intent(in) :: smoothing
    type(point_fields), intent(in) :: own
    integer, intent(in) :: solid !< position in the plan
    logical, intent(in) :: is_fitted !< the defect from the fitted stress
    real(rk), intent(out) :: defect(6, max_points) !< [Pa]
    real(rk), intent(out) :: added(6, max_points)
    if (is_fitted) then
      defect = defect_of_solid(smoothing, own%fitted, solid, own%stress(:, :, solid))
    else
      defect = defect_of_solid(smoothing, own%averaged, solid, own%stress(:, :, solid))
    end if
    added = 0.0_rk
    if (allocated(own%added)) added = own%added(:, :, solid)
  end subroutine defect_of_field

  !> The products of one solid, summed over its points [J].
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
