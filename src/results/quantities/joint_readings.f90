!> Joints in the results: opening, slip and pressure at the points, opening on the nodes.
module joint_readings
  use kinds, only: rk
  use joint_law, only: absent_points, joint_state
  use joint_opening, only: opening_of
  use joint_points, only: dam_joint
  use problem_definition, only: problem
  use analysis_state, only: state
  use dam_faces, only: dam_skin
  use extremes, only: extremes_by_face, note_values
  implicit none
  private
  public :: joint_record, open_joint_record, note_joint, gap_in_mesh
  public :: opening_at_points, opening_at_nodes, reading_names

  !> Names of the components of `joint_record%largest_now`.
  character(*), parameter :: reading_names = 'opening,slip,pressure'

  !> Maxima of one joint since the start, and its points on the faces of the dam.
  type :: joint_record
    logical, allocatable :: is_upstream(:), is_downstream(:) !< (points)
    type(extremes_by_face) :: opening, slip, pressure
    real(rk) :: largest_now(3) = 0.0_rk !< opening [m], slip [m] and pressure [Pa] of this increment
    real(rk) :: penetration = 0.0_rk !< largest [m]
    type(extremes_by_face) :: water !< not found where the joint has no water
  end type joint_record

contains

  !> Signed opening of each point: jump plus gap, positive when open; zero where an element behind
  !> the point is absent [m].
  pure function opening_at_points(now) result(opening)
    type(joint_state), intent(in) :: now
    real(rk) :: opening(size(now%gap))
    opening = opening_of(now%jump(1, :), now%gap)
    where (absent_points(now)) opening = 0.0_rk
  end function opening_at_points

  !> Signed opening on the nodes of all joints, on both sides; zero on other nodes [m]. A node takes
  !> the mean of its points, weighted by area. A slave node has one point (at a kink one for each
  !> plane); a master node has the points that are projected onto it. Negative weights of a mortar
  !> projection are left out: no node exceeds the largest point. Absent points take no part.
  pure function opening_at_nodes(model, now) result(opening)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk) :: opening(model%mesh%num_nodes)
    real(rk) :: total(model%mesh%num_nodes)
    real(rk), allocatable :: of_points(:)
    logical, allocatable :: is_absent(:)
    integer :: j, p, k
    real(rk) :: share
    opening = 0.0_rk
    total = 0.0_rk
    do j = 1, size(model%joints)
      of_points = opening_at_points(now%joints(j))
      is_absent = absent_points(now%joints(j))
      associate (joint => model%joints(j))
        do p = 1, joint%num_points
          if (is_absent(p)) cycle
          do k = joint%first(p), joint%first(p + 1) - 1
            share = joint%weight(k)*joint%area(p)
            if (k >= joint%first_master(p)) share = -share
            if (share <= 0.0_rk) cycle
            opening(joint%node(k)) = opening(joint%node(k)) + share*of_points(p)
            total(joint%node(k)) = total(joint%node(k)) + share
          end do
        end do
      end associate
    end do
    where (total > 0.0_rk) opening = opening/total
  end function opening_at_nodes

  !> An empty record. A point lies on a face of the dam when its node does. The node of a Gauss
  !> point is that with the largest shape function. JOINT8 elements use the nodes of both sides,
  !> surfaces those of the slave side: points of a coarse master node may be far away from the node.
  !> Where no slave node lies on a face (the rock under a dam), the master side is used.
  subroutine open_joint_record(joint, skin, record)
    type(dam_joint), intent(in) :: joint
    type(dam_skin), intent(in) :: skin
    type(joint_record), intent(out) :: record
    integer :: slave(joint%num_points), master(joint%num_points), p
    do p = 1, joint%num_points
      associate (k => joint%first_master(p))
        associate (first => joint%first(p))
          slave(p) = joint%node(first - 1 + maxloc(joint%weight(first:k - 1), dim=1))
        end associate
        master(p) = joint%node(k - 1 + minloc(joint%weight(k:joint%first(p + 1) - 1), dim=1))
      end associate
    end do
    record%is_upstream = skin%is_upstream(slave)
    record%is_downstream = skin%is_downstream(slave)
    if (joint%is_matching) then
      record%is_upstream = record%is_upstream .or. skin%is_upstream(master)
      record%is_downstream = record%is_downstream .or. skin%is_downstream(master)
    else if (.not. any(record%is_upstream .or. record%is_downstream)) then
      record%is_upstream = is_master_on(joint, skin%is_upstream)
      record%is_downstream = is_master_on(joint, skin%is_downstream)
    end if
  end subroutine open_joint_record

  !> True where the master weight of a point on the marked nodes exceeds half the largest such
  !> weight. An absolute threshold of 0.5 would find no point under large slave facets.
  pure function is_master_on(joint, is_marked) result(is_on)
    type(dam_joint), intent(in) :: joint
    logical, intent(in) :: is_marked(:) !< (nodes)
    logical :: is_on(joint%num_points)
    real(rk) :: part(joint%num_points)
    integer :: p
    do p = 1, joint%num_points
      associate (first => joint%first_master(p), last => joint%first(p + 1) - 1)
        part(p) = -sum(joint%weight(first:last), mask=is_marked(joint%node(first:last)))
      end associate
    end do
    is_on = part > max(0.5_rk*maxval(part), 0.0_rk)
  end function is_master_on

  !> The largest distance of the faces as meshed, with the gap of the law [m].
  pure real(rk) function gap_in_mesh(joint) result(gap)
    type(dam_joint), intent(in) :: joint
    gap = joint%law%gap
    if (size(joint%clearance) > 0) gap = gap + maxval(joint%clearance)
  end function gap_in_mesh

  !> Records one increment: opening (0 while closed), length of the slip, closing pressure and
  !> penetration of the faces.
  subroutine note_joint(record, joint, now, time)
    type(joint_record), intent(inout) :: record
    type(dam_joint), intent(in) :: joint
    type(joint_state), intent(in) :: now
    real(rk), intent(in) :: time !< total time [s]
    real(rk), dimension(size(now%gap)) :: opening, slip, pressure
    opening = opening_at_points(now)
    record%penetration = max(record%penetration, -minval(opening))
    opening = max(0.0_rk, opening)
    slip = hypot(now%slip(1, :), now%slip(2, :))
    pressure = max(0.0_rk, -now%traction(1, :))
    call note(record%opening, opening)
    call note(record%slip, slip)
    call note(record%pressure, pressure)
    if (allocated(now%water)) call note(record%water, now%water)
    record%largest_now = max(0.0_rk, [maxval(opening), maxval(slip), maxval(pressure)])

  contains

    !> Updates the extremes of one quantity.
    subroutine note(largest, values)
      type(extremes_by_face), intent(inout) :: largest
      real(rk), intent(in) :: values(:)
      call note_values(largest, values, joint%x, record%is_upstream, record%is_downstream, time, &
                       wants_smallest=.false.)
    end subroutine note
  end subroutine note_joint
end module joint_readings
