!> What holds nodes of a problem together besides its elements.
module held_together
  use body_parts, only: node_groups
  use problem_definition, only: problem
  implicit none
  private
  public :: list_groups

contains

  !> The nodes of each point of joints and segment of springs, and each node of a tie with what it
  !> follows.
  subroutine list_groups(scene, groups)
    type(problem), intent(in) :: scene
    type(node_groups), intent(out) :: groups
    integer :: j, k, num_groups, num_nodes
    num_groups = sum(scene%joints%num_points)
    num_nodes = sum([(size(scene%joints(j)%node), j=1, size(scene%joints))])
    do j = 1, size(scene%ties)
      num_groups = num_groups + size(scene%ties(j)%node)
      num_nodes = num_nodes + size(scene%ties(j)%node) + size(scene%ties(j)%master)
    end do
    do j = 1, size(scene%couplings)
      num_groups = num_groups + size(scene%couplings(j)%node, 2)
      num_nodes = num_nodes + size(scene%couplings(j)%node)
    end do
    allocate (groups%first(num_groups + 1), groups%node(num_nodes))
    groups%first(1) = 1
    num_groups = 0
    do j = 1, size(scene%joints)
      do k = 1, scene%joints(j)%num_points
        call add(scene%joints(j)%node(scene%joints(j)%first(k):scene%joints(j)%first(k + 1) - 1))
      end do
    end do
    do j = 1, size(scene%ties)
      associate (tie => scene%ties(j))
        do k = 1, size(tie%node)
          call add([tie%node(k), tie%master(tie%first(k):tie%first(k + 1) - 1)])
        end do
      end associate
    end do
    do j = 1, size(scene%couplings)
      associate (springs => scene%couplings(j))
        do k = 1, size(springs%node, 2)
          call add(springs%node(:, k))
        end do
      end associate
    end do
  contains
    !> One more group.
    subroutine add(nodes)
      integer, intent(in) :: nodes(:)
      num_groups = num_groups + 1
      groups%first(num_groups + 1) = groups%first(num_groups) + size(nodes)
      groups%node(groups%first(num_groups):groups%first(num_groups + 1) - 1) = nodes
    end subroutine add
  end subroutine list_groups
end module held_together
