!> Strains and stresses at the points of the solid elements, and the corners in the mean of a node.
!>
!> Elastic solids: eps = B u with the element's own operator, sigma = D eps less the thermal strain.
!> Solids of inelastic blocks: strain and stress of their states. A wedge is a hexahedron with
!> repeated nodes.
module stress_recovery
  use dam_mesh, only: element_is_there
  use kinds, only: rk
  use element_formulation, only: solid_element
  use element_catalogue, only: is_solid, make_solid
  use node_dofs, only: gather_vectors
  use problem_definition, only: problem
  use shape_hex8, only: hex8_dofs
  use slope_products, only: find_slopes, find_symmetric_gradient
  use analysis_state, only: state
  use thermal_recovery, only: add_expansion, take_thermal
  implicit none
  private
  public :: recovery_plan, make_recovery_plan, recover_points, recover_some, copy_states
  public :: max_points, recover_expansions
  public :: operators_of_block, motion_of_element, fewest_for_threads

  integer, parameter :: max_points = 8 !< most integration points of an element
  !> Nodes or solids from which loops of results take several threads. Threads that wait are woken
  !> up for each loop, which takes up to 30 ms on a busy machine; one thread needs less for fewer.
  integer, parameter :: fewest_for_threads = 2000
  integer, parameter :: block_size = 32 !< elements; their operators fit into the cache of a core

  !> One kind of element of a list.
  type :: formulation_slot
    class(solid_element), allocatable :: item
  end type formulation_slot

  !> Elements of one formulation and one material, recovered in one call.
  type :: element_block
    integer :: formulation = 0, material = 0
    integer, allocatable :: solids(:) !< positions in the list of solids
    logical :: is_inelastic = .false. !< the points have states
  end type element_block

  !> Data of the mesh; made at the first request for stresses.
  type :: recovery_plan
    integer :: num_solids = 0
    integer, allocatable :: element_of_solid(:), solid_of_element(:) !< 0: not a solid
    integer, allocatable :: num_points(:) !< (solids)
    integer, allocatable :: inelastic_block(:) !< (solids) position of the block; 0: elastic
    integer, allocatable :: points_before(:) !< (solids) points of the block before the solid
    type(formulation_slot), allocatable :: formulations(:)
    type(element_block), allocatable :: blocks(:)
    integer, allocatable :: node_start(:) !< (nodes + 1) where a node's corners start
    integer, allocatable :: corner(:) !< 8 (solid - 1) + corner, of the lowest section at the node
  end type recovery_plan

contains

  !> Lists the solids, sorts them into blocks and links nodes to corners.
  subroutine make_recovery_plan(model, plan)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(out) :: plan
    integer :: e, s
    plan%element_of_solid = pack([(e, e=1, model%mesh%num_elements)], &
                                 is_solid(model%mesh%element_type))
    plan%num_solids = size(plan%element_of_solid)
    allocate (plan%solid_of_element(model%mesh%num_elements), source=0)
    do s = 1, plan%num_solids
      plan%solid_of_element(plan%element_of_solid(s)) = s
    end do
    call find_states(model, plan)
    call sort_into_blocks(model, plan)
    call link_corners(model, plan)
  end subroutine make_recovery_plan

  !> Finds block and points of the solids with states.
  subroutine find_states(model, plan)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(inout) :: plan
    integer :: i, e, s
    allocate (plan%inelastic_block(plan%num_solids), source=0)
    allocate (plan%points_before(plan%num_solids), source=0)
    if (.not. allocated(model%inelastic)) return
    do i = 1, size(model%inelastic)
      do e = 1, size(model%inelastic(i)%elements)
        s = plan%solid_of_element(model%inelastic(i)%elements(e))
        plan%inelastic_block(s) = i
        plan%points_before(s) = (e - 1)*model%inelastic(i)%points_of_element
      end do
    end do
  end subroutine find_states

  !> Sorts the solids into blocks of one formulation and one material.
  subroutine sort_into_blocks(model, plan)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(inout) :: plan
    character(8), allocatable :: names(:)
    integer, allocatable :: kind_of(:), group(:)
    integer :: s, kind, m, first, last, num_blocks
    allocate (names(0), kind_of(plan%num_solids), plan%num_points(plan%num_solids))
    do s = 1, plan%num_solids
      associate (name => model%mesh%element_type(plan%element_of_solid(s)))
        if (.not. any(names == name)) names = [character(8) :: names, name]
        kind_of(s) = findloc(names, name, dim=1)
      end associate
    end do
    allocate (plan%formulations(size(names)))
    do kind = 1, size(names)
      call make_solid(names(kind), plan%formulations(kind)%item)
    end do
    do s = 1, plan%num_solids
      plan%num_points(s) = plan%formulations(kind_of(s))%item%num_points
    end do
    allocate (plan%blocks(plan%num_solids/block_size + size(names)*size(model%materials)))
    num_blocks = 0
    do kind = 1, size(names)
      do m = 1, size(model%materials)
        group = pack([(s, s=1, plan%num_solids)], kind_of == kind .and. &
                     model%mesh%material_of_element(plan%element_of_solid) == m)
        do first = 1, size(group), block_size
          last = min(size(group), first + block_size - 1)
          num_blocks = num_blocks + 1
          plan%blocks(num_blocks) = element_block(kind, m, group(first:last), &
                                                  plan%inelastic_block(group(first)) > 0)
        end do
      end do
    end do
    plan%blocks = plan%blocks(:num_blocks)
  end subroutine sort_into_blocks

  !> For each node, lists the corners in its mean: those of the lowest section at the node.
  subroutine link_corners(model, plan)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(inout) :: plan
    integer, allocatable :: lowest_section(:), next(:)
    integer :: s, a, node, section, n
    allocate (lowest_section(model%mesh%num_nodes), source=huge(1))
    allocate (plan%node_start(model%mesh%num_nodes + 1), source=0)
    do s = 1, plan%num_solids
      section = model%mesh%section_of_element(plan%element_of_solid(s))
      if (.not. element_is_there(model%mesh, plan%element_of_solid(s))) cycle
      do a = 1, 8
        node = model%mesh%nodes(a, plan%element_of_solid(s))
        lowest_section(node) = min(lowest_section(node), section)
      end do
    end do
    allocate (plan%corner(8*plan%num_solids), source=0)
    call visit_corners(counting=.true.)
    plan%node_start(1) = 1
    do n = 1, model%mesh%num_nodes
      plan%node_start(n + 1) = plan%node_start(n) + plan%node_start(n + 1)
    end do
    next = plan%node_start
    call visit_corners(counting=.false.)

  contains

    !> Counts or stores the corners.
    subroutine visit_corners(counting)
      logical, intent(in) :: counting
      do s = 1, plan%num_solids
        if (.not. element_is_there(model%mesh, plan%element_of_solid(s))) cycle
        section = model%mesh%section_of_element(plan%element_of_solid(s))
        do a = 1, 8
          node = model%mesh%nodes(a, plan%element_of_solid(s))
          if (section /= lowest_section(node)) cycle
          if (counting) then
            plan%node_start(node + 1) = plan%node_start(node + 1) + 1
          else
            plan%corner(next(node)) = 8*(s - 1) + a
            next(node) = next(node) + 1
          end if
        end do
      end do
    end subroutine visit_corners
  end subroutine link_corners

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

  !> Strain, stress or both of one block, or of a part of it. An absent array is not passed on: its
  !> bounds are undefined.
  subroutine recover_part(model, plan, part, now, strain, stress)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(element_block), intent(in) :: part
    type(state), intent(in) :: now
    real(rk), intent(inout), optional :: strain(:, :, :), stress(:, :, :)
    real(rk), allocatable :: found(:, :, :)
    real(rk) :: d(6, 6)
    integer :: k, q
    if (part%is_inelastic) then
      if (present(strain)) call copy_states(plan, now, part%solids, strain=strain)
      if (present(stress)) call copy_states(plan, now, part%solids, stress=stress)
    else
      call model%materials(part%material)%law%elastic_stiffness(d)
      call find_strains(model, plan, part, now, d, found)
      do k = 1, size(part%solids)
        if (present(strain)) strain(:, :size(found, 2), part%solids(k)) = found(:, :, k)
        if (.not. present(stress)) cycle
        do q = 1, size(found, 2)
          stress(:, q, part%solids(k)) = matmul(d, found(:, q, k))
        end do
      end do
    end if
    if (present(strain)) call add_expansions(model, plan, part, now, strain)
  end subroutine recover_part

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
