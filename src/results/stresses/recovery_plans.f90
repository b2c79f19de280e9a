!> Data of the mesh for the recovery of stresses: solids in blocks of one kind and one material, and
!> the corners in the mean of a node.
module recovery_plans
  use dam_mesh, only: element_is_there
  use element_catalogue, only: is_solid, make_solid
  use element_formulation, only: solid_element
  use problem_definition, only: problem
  implicit none
  private
  public :: recovery_plan, element_block, make_recovery_plan, max_points, fewest_for_threads

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
end module recovery_plans
