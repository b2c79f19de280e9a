!> The error that the mesh leaves in the stresses: the stress of the elements compared with a
!> smooth stress (theory.md, 14.1).
!>
!> The smooth stress has one value for each node and kind of material, the mean of the corners
!> there, and the shape functions of the element between the nodes. It may jump between materials
!> whose stiffness or thermal expansion differ.
module stress_error
  use kinds, only: rk
  use dam_mesh, only: fe_mesh
  use hex8_slopes, only: slopes_at_points
  use material_law, only: material
  use problem_definition, only: problem
  use shape_hex8, only: corners_from_points, corner_of_point, hex8_dofs, point_shape
  use small_matrix, only: solve_dense
  use analysis_state, only: state
  use recovery_plans, only: fewest_for_threads, max_points, recovery_plan
  use stress_recovery, only: motion_of_element
  use tensor6, only: sum_tensors
  use thermal_expansion, only: expands_alike
  implicit none
  private
  public :: smoothing_plan, make_smoothing_plan, average_patches, defect_of_solid
  public :: energy_of_stresses, repeat_single_points, add_hourglass_energy, hides_error

  !> Share of the strain energy in solids without neighbours above which nothing is known of the
  !> error: a stress that jumps to no other one has no defect. Below, what is missed is small
  !> against the other uncertainty of the estimate, a factor of two.
  real(rk), parameter :: most_alone = 0.05_rk

  !> A patch is a node with the solids of one kind of material around it.
  type :: smoothing_plan
    integer :: num_patches = 0
    integer, allocatable :: patch(:, :) !< (8, solids)
    logical, allocatable :: is_alone(:) !< (solids) in all its patches: its stress is its own mean
    real(rk), allocatable :: volume(:, :) !< (points, solids) [m3]
    real(rk), allocatable :: compliance(:, :, :) !< (6, 6, materials) [1/Pa]
  end type smoothing_plan

contains

  !> Numbers the patches, and finds volumes and compliances.
  subroutine make_smoothing_plan(model, plan, smoothing)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(out) :: smoothing
    real(rk) :: slope(8, 3, 8), x(3, 8)
    integer :: s, status
    call invert_stiffness(model, smoothing%compliance)
    call number_patches(model%mesh, plan, kinds_of_materials(model%materials, &
                                                             smoothing%compliance), smoothing)
    allocate (smoothing%volume(max_points, plan%num_solids))
    !$omp parallel do default(none) shared(model, plan, smoothing) private(slope, x, status) &
    !$omp schedule(static) if (plan%num_solids > fewest_for_threads)
    do s = 1, plan%num_solids
      x = model%mesh%x(:, model%mesh%nodes(:, plan%element_of_solid(s)))
      call slopes_at_points(x, slope, smoothing%volume(:, s), status)
    end do
    !$omp end parallel do
  end subroutine make_smoothing_plan

  !> The first material with the elastic stiffness and thermal expansion of each material: stresses
  !> do not jump between elastic materials of one kind.
  pure function kinds_of_materials(materials, compliance) result(kind_of)
    type(material), intent(in) :: materials(:)
    real(rk), intent(in) :: compliance(:, :, :) !< (6, 6, materials) [1/Pa]
    integer :: kind_of(size(materials))
    integer :: m, k
    do m = 1, size(materials)
      do k = 1, m
        if (any(abs(compliance(:, :, k) - compliance(:, :, m)) > 0.0_rk)) cycle
        if (expands_alike(materials(k)%expansion, materials(m)%expansion)) exit
      end do
      kind_of(m) = min(k, m)
    end do
  end function kinds_of_materials

  !> Numbers the pairs of node and kind of material: the patches of a node form a chain.
  subroutine number_patches(mesh, plan, kind_of_material, smoothing)
    type(fe_mesh), intent(in) :: mesh
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: kind_of_material(:) !< (materials)
    type(smoothing_plan), intent(inout) :: smoothing
    integer, allocatable :: first(:), next(:), kind_of(:)
    integer :: s, a, e, p
    allocate (smoothing%patch(8, plan%num_solids))
    allocate (first(mesh%num_nodes), next(8*plan%num_solids), kind_of(8*plan%num_solids), source=0)
    do s = 1, plan%num_solids
      e = plan%element_of_solid(s)
      do a = 1, 8
        p = first(mesh%nodes(a, e))
        do while (p > 0)
          if (kind_of(p) == kind_of_element(e)) exit
          p = next(p)
        end do
        if (p == 0) then
          smoothing%num_patches = smoothing%num_patches + 1
          p = smoothing%num_patches
          kind_of(p) = kind_of_element(e)
          next(p) = first(mesh%nodes(a, e))
          first(mesh%nodes(a, e)) = p
        end if
        smoothing%patch(a, s) = p
      end do
    end do
    call find_lone_solids(smoothing)
  contains
    !> The kind of material of a solid; those that are absent have one of their own.
    pure integer function kind_of_element(element)
      integer, intent(in) :: element
      kind_of_element = -1
      associate (m => mesh%material_of_element(element))
        if (m > 0) kind_of_element = kind_of_material(m)
      end associate
    end function kind_of_element
  end subroutine number_patches

  !> Marks the solids that share no patch with another one.
  pure subroutine find_lone_solids(smoothing)
    type(smoothing_plan), intent(inout) :: smoothing
    integer :: last(smoothing%num_patches), s
    logical :: is_shared(smoothing%num_patches)
    last = 0
    is_shared = .false.
    do s = 1, size(smoothing%patch, 2)
      associate (own => smoothing%patch(:, s))
        is_shared(own) = is_shared(own) .or. (last(own) /= 0 .and. last(own) /= s)
        last(own) = s
      end associate
    end do
    smoothing%is_alone = [(.not. any(is_shared(smoothing%patch(:, s))), &
                           s=1, size(smoothing%patch, 2))]
  end subroutine find_lone_solids

  !> Whether solids without neighbours have too much of the energy for an estimate. Of two fields of
  !> stresses it is the root of the product of their shares: it bounds that of their common energy.
  pure logical function hides_error(smoothing, first, second)
    type(smoothing_plan), intent(in) :: smoothing
    real(rk), intent(in) :: first(:), second(:) !< (solids) energies of the fields [J]
    associate (is_alone => smoothing%is_alone)
      hides_error = sqrt(sum(first, mask=is_alone))*sqrt(sum(second, mask=is_alone)) > &
                    most_alone*sqrt(sum(first))*sqrt(sum(second))
    end associate
  end function hides_error

  !> The elastic compliance of each material; zero for materials of joints alone.
  subroutine invert_stiffness(model, compliance)
    type(problem), intent(in) :: model
    real(rk), allocatable, intent(out) :: compliance(:, :, :)
    real(rk) :: d(6, 6), unit(6, 6)
    logical :: is_singular
    integer :: m, i
    unit = 0.0_rk
    do i = 1, 6
      unit(i, i) = 1.0_rk
    end do
    allocate (compliance(6, 6, size(model%materials)), source=0.0_rk)
    do m = 1, size(model%materials)
      if (.not. allocated(model%materials(m)%law)) cycle
      call model%materials(m)%law%elastic_stiffness(d)
      call solve_dense(d, unit, compliance(:, :, m), is_singular)
      if (is_singular) compliance(:, :, m) = 0.0_rk
    end do
  end subroutine invert_stiffness

  !> Repeats the stress of elements with one point at the other points.
  pure subroutine repeat_single_points(plan, stress)
    type(recovery_plan), intent(in) :: plan
    real(rk), intent(inout) :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    integer :: s
    do s = 1, plan%num_solids
      if (plan%num_points(s) == 1) stress(:, 2:, s) = spread(stress(:, 1, s), 2, max_points - 1)
    end do
  end subroutine repeat_single_points

  !> The stress between the values of patches less the stress of the element, at 2 x 2 x 2 points
  !> of a solid.
  pure function defect_of_solid(smoothing, smooth, solid, stress) result(defect)
    type(smoothing_plan), intent(in) :: smoothing
    real(rk), intent(in) :: smooth(:, :) !< (6, patches) [Pa]
    integer, intent(in) :: solid !< position in the plan
    real(rk), intent(in) :: stress(6, max_points) !< of the element [Pa]
    real(rk) :: defect(6, max_points) !< [Pa]
    real(rk) :: at_corner(6, 8)
    at_corner = smooth(:, smoothing%patch(:, solid))
    call sum_tensors(8, at_corner, point_shape, 8, defect)
    defect = defect - stress
  end function defect_of_solid

  !> The mean of the corners in each patch.
  subroutine average_patches(plan, smoothing, stress, is_bounded, smooth)
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    real(rk), intent(in), contiguous :: stress(:, :, :)
    logical, intent(in) :: is_bounded(:)
    real(rk), allocatable, intent(out) :: smooth(:, :) !< (6, patches) [Pa]
    real(rk) :: to_corner(max_points, 8), at_corner(6, 8)
    integer, allocatable :: num_corners(:)
    integer :: s, a
    to_corner = transpose(corners_from_points())
    allocate (smooth(6, smoothing%num_patches), source=0.0_rk)
    allocate (num_corners(smoothing%num_patches), source=0)
    do s = 1, plan%num_solids
      if (is_bounded(s)) then
        at_corner = stress(:, corner_of_point, s)
      else
        call sum_tensors(8, stress(:, :, s), to_corner, 8, at_corner)
      end if
      do a = 1, 8
        associate (p => smoothing%patch(a, s))
          smooth(:, p) = smooth(:, p) + at_corner(:, a)
          num_corners(p) = num_corners(p) + 1
        end associate
      end do
    end do
    do a = 1, smoothing%num_patches
      smooth(:, a) = smooth(:, a)/num_corners(a)
    end do
  end subroutine average_patches

  !> The integral of sigma : D^-1 : sigma over each solid: of its stress or, where a smooth stress
  !> is given, of the difference of the two.
  subroutine energy_of_stresses(model, plan, smoothing, stress, energy, smooth)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    real(rk), intent(in) :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    real(rk), intent(out) :: energy(:) !< (solids) [J]
    real(rk), intent(in), optional :: smooth(:, :) !< (6, patches) [Pa]
    real(rk) :: compliance(6, 6), strain(6), own(6, max_points)
    integer :: s, q, m, j
    !$omp parallel do default(none) shared(model, plan, smoothing, stress, smooth, energy) &
    !$omp private(compliance, strain, own, q, m, j) schedule(static) &
    !$omp if (plan%num_solids > fewest_for_threads)
    do s = 1, plan%num_solids
      m = model%mesh%material_of_element(plan%element_of_solid(s))
      energy(s) = 0.0_rk
      if (m == 0) cycle
      compliance = smoothing%compliance(:, :, m)
      own = stress(:, :, s)
      if (present(smooth)) own = defect_of_solid(smoothing, smooth, s, own)
      do q = 1, max_points
        strain = 0.0_rk
        do j = 1, 6
          strain = strain + compliance(:, j)*own(j, q)
        end do
        energy(s) = energy(s) + smoothing%volume(q, s)*sum(own(:, q)*strain)
      end do
    end do
    !$omp end parallel do
  end subroutine energy_of_stresses

  !> Adds the work of the hourglass control of elements with one point: no stress shows it.
  subroutine add_hourglass_energy(model, plan, now, energy)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    real(rk), intent(inout) :: energy(:) !< (solids) [J]
    real(rk) :: d(6, 6), x(3, 8, 1), ke(hex8_dofs, hex8_dofs, 1), moved(hex8_dofs)
    integer :: i, k, s
    do i = 1, size(plan%blocks)
      associate (part => plan%blocks(i))
        if (plan%formulations(part%formulation)%item%num_points > 1) cycle
        call model%materials(part%material)%law%elastic_stiffness(d)
        do k = 1, size(part%solids)
          s = part%solids(k)
          x(:, :, 1) = model%mesh%x(:, model%mesh%nodes(:, plan%element_of_solid(s)))
          moved = motion_of_element(model, now, plan%element_of_solid(s))
          ke = 0.0_rk
          call plan%formulations(part%formulation)%item%add_stabilisation(x, d, ke)
          energy(s) = energy(s) + max(0.0_rk, dot_product(moved, matmul(ke(:, :, 1), moved)))
        end do
      end associate
    end do
  end subroutine add_hourglass_energy
end module stress_error
