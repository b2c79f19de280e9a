!> What the results say of a joint: opening, slip and pressure at its points, and on its nodes.
module joint_readings
  use kinds, only: rk
  use joint_law, only: joint_state
  use joint_points, only: joint
  use problem_definition, only: problem
  use analysis_state, only: state
  use dam_faces, only: dam_skin
  use extremes, only: extremes_by_face, note_values
  implicit none
  private
  public :: joint_record, open_joint_record, note_joint
  public :: opening_at_points, opening_at_nodes

  !> The maxima of one joint since the start, and which of its points lie on which face.
  type :: joint_record
    logical, allocatable :: is_upstream(:), is_downstream(:) !< (points)
    type(extremes_by_face) :: opening, slip, pressure
  end type joint_record

contains

  !> Signed opening of each point: jump and gap, positive when open [m].
  pure function opening_at_points(now) result(opening)
    type(joint_state), intent(in) :: now
    real(rk) :: opening(size(now%gap))
    opening = now%jump(1, :) + now%gap
  end function opening_at_points

  !> Signed opening on the nodes of all joints, on both sides; zero on other nodes [m]. A node of
  !> several points takes their mean by area.
  pure function opening_at_nodes(scene, now) result(opening)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    real(rk) :: opening(scene%mesh%num_nodes)
    real(rk) :: weight(scene%mesh%num_nodes)
    integer :: j, p, k
    real(rk) :: share
    opening = 0.0_rk
    weight = 0.0_rk
    do j = 1, size(scene%joints)
      associate (item => scene%joints(j))
        do p = 1, item%num_points
          do k = item%first(p), item%first(p + 1) - 1
            share = abs(item%weight(k))*item%area(p)
            opening(item%node(k)) = opening(item%node(k)) &
                                    + share*(now%joints(j)%jump(1, p) + now%joints(j)%gap(p))
            weight(item%node(k)) = weight(item%node(k)) + share
          end do
        end do
      end associate
    end do
    where (weight > 0.0_rk) opening = opening/weight
  end function opening_at_nodes

  !> An empty record. A point lies on a face of the dam when the node nearest to it, on either side,
  !> does: at a Gauss point the node with the largest shape function.
  subroutine open_joint_record(item, skin, record)
    type(joint), intent(in) :: item
    type(dam_skin), intent(in) :: skin
    type(joint_record), intent(out) :: record
    integer :: p, k, slave, master
    allocate (record%is_upstream(item%num_points), record%is_downstream(item%num_points))
    do p = 1, item%num_points
      k = item%first_master(p)
      slave = item%node(item%first(p) - 1 + maxloc(item%weight(item%first(p):k - 1), dim=1))
      master = item%node(k - 1 + minloc(item%weight(k:item%first(p + 1) - 1), dim=1))
      record%is_upstream(p) = skin%is_upstream(master) .or. skin%is_upstream(slave)
      record%is_downstream(p) = skin%is_downstream(master) .or. skin%is_downstream(slave)
    end do
  end subroutine open_joint_record

  !> Takes note of one increment: opening (0 while closed), slip (its length) and closing pressure.
  subroutine note_joint(record, item, now, time)
    type(joint_record), intent(inout) :: record
    type(joint), intent(in) :: item
    type(joint_state), intent(in) :: now
    real(rk), intent(in) :: time !< total time [s]
    call note(record%opening, max(0.0_rk, opening_at_points(now)))
    call note(record%slip, hypot(now%slip(1, :), now%slip(2, :)))
    call note(record%pressure, max(0.0_rk, -now%traction(1, :)))

  contains

    !> The largest of each.
    subroutine note(largest, values)
      type(extremes_by_face), intent(inout) :: largest
      real(rk), intent(in) :: values(:)
      call note_values(largest, values, item%x, record%is_upstream, record%is_downstream, time, &
                       wants_smallest=.false.)
    end subroutine note
  end subroutine note_joint
end module joint_readings
