!> The parts of a joint that are there in each step of a model with *MODEL CHANGE (theory.md, 15.1).
!>
!> Faces of a joint whose solids come and go together are one part. The area of a point is the sum
!> over the parts that are there; between different meshes the weights of its nodes change, too.
module joint_parts
  use dam_mesh, only: fe_mesh, are_there
  use joint_points, only: dam_joint
  use kinds, only: rk
  implicit none
  private
  public :: show_parts, point_is_there, part_area, changes_parts

contains

  !> Sets areas and nodes of the points of a joint to those of a step. Points without area keep the
  !> nodes and the area of the complete joint, and are idle.
  pure subroutine show_parts(joint, step)
    type(dam_joint), intent(inout) :: joint
    integer, intent(in) :: step
    integer :: p
    if (.not. allocated(joint%parts)) return
    joint%is_idle = [(part_area(joint, step, p) <= 0.0_rk, p=1, joint%num_points)]
    do p = 1, joint%num_points
      if (joint%is_idle(p)) then
        joint%area(p) = sum(joint%parts%area(:, p))
      else
        joint%area(p) = part_area(joint, step, p)
      end if
    end do
    if (.not. allocated(joint%parts%rows)) return
    associate (rows => joint%parts%rows(joint%parts%rows_of_step(step)))
      joint%first = rows%first
      joint%first_master = rows%first_master
      joint%node = rows%node
      joint%weight = rows%weight
    end associate
  end subroutine show_parts

  !> Area of a point in a step [m2].
  pure real(rk) function part_area(joint, step, point) result(area)
    type(dam_joint), intent(in) :: joint !< with parts
    integer, intent(in) :: step, point
    area = sum(joint%parts%area(:, point), mask=joint%parts%is_there(:, step))
  end function part_area

  !> Whether the parts of a point at the start of a step differ from those of the step before. The
  !> complete joint comes before the first step.
  pure logical function changes_parts(joint, step, point)
    type(dam_joint), intent(in) :: joint !< with parts
    integer, intent(in) :: step, point
    logical :: differs(size(joint%parts%area, 1))
    differs = .not. joint%parts%is_there(:, step)
    if (step > 1) differs = joint%parts%is_there(:, step) .neqv. joint%parts%is_there(:, step - 1)
    changes_parts = any(differs .and. joint%parts%area(:, point) > 0.0_rk)
  end function changes_parts

  !> Whether a point acts in the present step: its nodes have elements, and it has an area.
  pure logical function point_is_there(mesh, joint, point) result(is_there)
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: point
    is_there = are_there(mesh, joint%node(joint%first(point):joint%first(point + 1) - 1))
    if (allocated(joint%is_idle)) is_there = is_there .and. .not. joint%is_idle(point)
  end function point_is_there
end module joint_parts
