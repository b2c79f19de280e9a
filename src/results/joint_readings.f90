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
  pure function opening_at_points(item, now) result(opening)
    type(joint), intent(in) :: item
    type(joint_state), intent(in) :: now
    real(rk) :: opening(item%num_points)
    opening = now%jump(1, :) + item%law%gap
  end function opening_at_points

  !> Signed opening on the nodes of all joints, on both sides; zero on other nodes [m]. A node of
  !> several points takes their mean by area.
  pure function opening_at_nodes(scene, now) result(opening)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    real(rk) :: opening(scene%mesh%num_nodes)
    real(rk) :: weight(scene%mesh%num_nodes)
    integer :: j, p, a
    real(rk) :: at_point, share
    opening = 0.0_rk
    weight = 0.0_rk
    do j = 1, size(scene%joints)
      associate (item => scene%joints(j))
        do p = 1, item%num_points
          at_point = now%joints(j)%jump(1, p) + item%law%gap
          do a = 1, size(item%master, 1)
            share = item%shape(a, p)*item%area(p)
            opening(item%master(a, p)) = opening(item%master(a, p)) + share*at_point
            weight(item%master(a, p)) = weight(item%master(a, p)) + share
            opening(item%slave(a, p)) = opening(item%slave(a, p)) + share*at_point
            weight(item%slave(a, p)) = weight(item%slave(a, p)) + share
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
    integer :: p, a
    allocate (record%is_upstream(item%num_points), record%is_downstream(item%num_points))
    do p = 1, item%num_points
      a = maxloc(item%shape(:, p), dim=1)
      record%is_upstream(p) = skin%is_upstream(item%master(a, p)) .or. &
                              skin%is_upstream(item%slave(a, p))
      record%is_downstream(p) = skin%is_downstream(item%master(a, p)) .or. &
                                skin%is_downstream(item%slave(a, p))
    end do
  end subroutine open_joint_record

  !> Takes note of one increment: opening (0 while closed), slip (its length) and closing pressure.
  subroutine note_joint(record, item, now, time)
    type(joint_record), intent(inout) :: record
    type(joint), intent(in) :: item
    type(joint_state), intent(in) :: now
    real(rk), intent(in) :: time !< total time [s]
    call note(record%opening, max(0.0_rk, opening_at_points(item, now)))
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
