!> What holds nodes of a problem together besides its elements.
module held_together
  use problem_definition, only: problem
  use row_tables, only: row_table
  implicit none
  private
  public :: list_groups

contains

  !> The nodes of each point of joints and segment of springs, and each node of a tie with what it
  !> follows.
  subroutine list_groups(scene, groups)
    type(problem), intent(in) :: scene
    type(row_table), intent(out) :: groups
    integer :: j, k
    do j = 1, size(scene%joints)
      associate (now => scene%joints(j))
        do k = 1, now%num_points
          call groups%append(now%node(now%first(k):now%first(k + 1) - 1))
        end do
      end associate
    end do
    do j = 1, size(scene%ties)
      associate (tie => scene%ties(j))
        do k = 1, size(tie%node)
          call groups%append([tie%node(k), tie%master(tie%first(k):tie%first(k + 1) - 1)])
        end do
      end associate
    end do
    do j = 1, size(scene%couplings)
      associate (springs => scene%couplings(j))
        do k = 1, size(springs%node, 2)
          call groups%append(springs%node(:, k))
        end do
      end associate
    end do
    call groups%finish()
  end subroutine list_groups
end module held_together
