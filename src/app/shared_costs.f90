!> Divides work that is done for several effects at once by their numbers of points.
module shared_costs
  use kinds, only: rk
  use problem_definition, only: problem
  use run_ledger, only: ledger
  implicit none
  private
  public :: share_costs

contains

  !> Divides the work on all joints among the joints, and the work on all inelastic solids among
  !> their materials.
  subroutine share_costs(model, costs)
    type(problem), intent(in) :: model
    type(ledger), intent(in) :: costs
    real(rk) :: num_points(size(model%materials))
    integer :: b, i, width
    width = maxval([(len(model%joints(i)%name), i=1, size(model%joints)), &
                    (len(model%materials(i)%name), i=1, size(model%materials)), 1])
    num_points = 0.0_rk
    if (allocated(model%inelastic)) then
      do b = 1, size(model%inelastic)
        associate (solids => model%inelastic(b))
          num_points(solids%material) = num_points(solids%material) &
                                        + real(solids%num_points(), rk)
        end associate
      end do
    end if
    call costs%share('joints', 'joint', joint_names(), real(model%joints%num_points, rk))
    call costs%share('inelastic solids', 'inelastic', &
                     pack(material_names(), num_points > 0.0_rk), &
                     pack(num_points, num_points > 0.0_rk))

  contains

    !> Names of the joints.
    function joint_names() result(names)
      character(width) :: names(size(model%joints))
      integer :: j
      do j = 1, size(names)
        names(j) = model%joints(j)%name
      end do
    end function joint_names

    !> Names of the materials.
    function material_names() result(names)
      character(width) :: names(size(model%materials))
      integer :: m
      do m = 1, size(names)
        names(m) = model%materials(m)%name
      end do
    end function material_names
  end subroutine share_costs
end module shared_costs
