!> Joints at the start of a step in a model that is built in stages (theory.md, 15): points that
!> come and go, points that grow with their parts, and grout.
!>
!> A joint keeps the relative displacement of its nodes at the zero of its law.
module stage_joints
  use joint_law, only: joint_state, phase_absent, phase_contact, phase_full, takes_grout
  use joint_parts, only: changes_parts, part_area, point_is_there
  use joint_points, only: dam_joint, relative_displacement
  use kinds, only: rk
  use problem_definition, only: problem
  use step_plan, only: step
  implicit none
  private
  public :: start_phases, move_points, shift_points, fill_joints, harden_pressed

contains

  !> Phases and origins of the joints of the complete model; joints to be grouted are in contact.
  subroutine start_phases(model, joints)
    type(problem), intent(in) :: model
    type(joint_state), intent(inout) :: joints(:)
    integer :: j
    do j = 1, size(joints)
      if (.not. allocated(model%stages%is_absent) .and. first_phase(model, j) == phase_full) cycle
      allocate (joints(j)%origin(3, model%joints(j)%num_points), source=0.0_rk)
      allocate (joints(j)%phase(model%joints(j)%num_points), source=first_phase(model, j))
      if (first_phase(model, j) == phase_contact) joints(j)%is_broken = .true.
      if (.not. allocated(model%joints(j)%parts)) cycle
      allocate (joints(j)%part_origin(3, size(model%joints(j)%parts%area, 1), &
                                      model%joints(j)%num_points), source=0.0_rk)
    end do
  end subroutine start_phases

  !> The phase of points that appear.
  pure integer function first_phase(model, joint) result(phase)
    type(problem), intent(in) :: model
    integer, intent(in) :: joint
    phase = phase_full
    if (allocated(model%stages%is_grouted)) then
      if (model%stages%is_grouted(joint)) phase = phase_contact
    end if
  end function first_phase

  !> Points of joints that come, go, grow or shrink. The mesh is that of the new step.
  subroutine move_points(model, number, u, joints)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the step
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: joints(:)
    integer :: j
    do j = 1, size(joints)
      if (allocated(joints(j)%part_origin)) then
        call move_parts(model%joints(j), number, joints(j))
        call follow_rows(model%joints(j), u, joints(j))
      end if
      call renew_points_of(model, j, u, joints(j))
    end do
  end subroutine move_points

  !> Points that are there keep their jumps where their nodes are given other displacements.
  subroutine shift_points(model, change, joints)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: change(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: joints(:)
    real(rk) :: shift(3)
    integer :: j, p
    do j = 1, size(joints)
      associate (joint => model%joints(j), own => joints(j))
        do p = 1, joint%num_points
          if (own%phase(p) == phase_absent) cycle
          shift = matmul(joint%rotation(:, :, p), relative_displacement(joint, p, change))
          call move_origin(p, shift, own)
        end do
      end associate
    end do
  end subroutine shift_points

  !> Points of a joint that come or go start anew; their energies dissipated so far remain.
  subroutine renew_points_of(model, number, u, own)
    type(problem), intent(in) :: model
    integer, intent(in) :: number !< of the joint
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: own
    type(joint_state) :: fresh
    logical :: is_there
    integer :: p
    associate (joint => model%joints(number))
      call joint%law%start_state(joint%clearance, fresh)
      do p = 1, joint%num_points
        is_there = point_is_there(model%mesh, joint, p)
        if (is_there .eqv. own%phase(p) /= phase_absent) cycle
        call renew_point(fresh, p, own)
        own%phase(p) = phase_absent
        own%origin(:, p) = 0.0_rk
        if (is_there) then
          own%phase(p) = first_phase(model, number)
          own%is_broken(p) = own%is_broken(p) .or. own%phase(p) == phase_contact
          own%origin(:, p) = matmul(joint%rotation(:, :, p), relative_displacement(joint, p, u))
        end if
        if (allocated(own%part_origin)) then
          own%part_origin(:, :, p) = spread(own%origin(:, p), 2, size(own%part_origin, 2))
        end if
      end do
    end associate
  end subroutine renew_points_of

  !> Points that act and whose parts change: a part that comes has no stress now, a part that goes
  !> takes its share of the traction along. The energies dissipated so far remain.
  subroutine move_parts(joint, number, own)
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: number !< of the step
    type(joint_state), intent(inout) :: own
    type(joint_state) :: old
    real(rk) :: tangent(3, 3, joint%num_points)
    logical :: is_moved(joint%num_points)
    integer :: p
    is_moved = .false.
    do p = 1, joint%num_points
      if (own%phase(p) == phase_absent) cycle
      if (part_area(joint, number, p) <= 0.0_rk) cycle
      is_moved(p) = changes_parts(joint, number, p)
      if (is_moved(p)) call move_zero(joint, number, p, own)
    end do
    if (.not. any(is_moved)) return
    own%num_openings = 0
    old = own
    call joint%law%update(old%jump, old, own, tangent)
    do p = 1, joint%num_points
      if (is_moved(p)) then
        own%friction_work(p) = old%friction_work(p)
        own%fracture_work(p) = old%fracture_work(p)
      else
        call restore_point(old, p, own)
      end if
    end do
  end subroutine move_parts

  !> The zero of a point becomes the mean of the zeros of its parts over the area. The multiplier of
  !> contact without penetration stays on the parts that stay.
  subroutine move_zero(joint, number, p, own)
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: number, p !< step and point
    type(joint_state), intent(inout) :: own
    real(rk) :: k(3), zero(3), now(3), area, share, stays
    logical :: was_there
    integer :: i
    call joint%law%reference_stiffness(k)
    now = own%origin(:, p) + own%traction(:, p)/k
    if (own%traction(1, p) < 0.0_rk) now(1) = now(1) - own%shift(p)
    zero = 0.0_rk
    area = 0.0_rk
    stays = 0.0_rk
    do i = 1, size(own%part_origin, 2)
      was_there = .true.
      if (number > 1) was_there = joint%parts%is_there(i, number - 1)
      share = joint%parts%area(i, p)
      if (was_there) area = area + share
      if (.not. joint%parts%is_there(i, number)) cycle
      if (.not. was_there) own%part_origin(:, i, p) = now
      if (was_there) stays = stays + share
      zero = zero + share*own%part_origin(:, i, p)
    end do
    zero = zero/joint%area(p)
    own%jump(:, p) = own%jump(:, p) + own%origin(:, p) - zero
    own%origin(:, p) = zero
    own%shift(p) = own%shift(p)*stays/joint%area(p)
    own%friction_work(p) = own%friction_work(p)*area/joint%area(p)
    own%fracture_work(p) = own%fracture_work(p)*area/joint%area(p)
  end subroutine move_zero

  !> Between different meshes the nodes of a point change with its parts: the origins move so that
  !> its jump stays.
  subroutine follow_rows(joint, u, own)
    type(dam_joint), intent(in) :: joint
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    type(joint_state), intent(inout) :: own
    real(rk) :: change(3)
    integer :: p
    if (.not. allocated(joint%parts%rows)) return
    do p = 1, joint%num_points
      if (own%phase(p) == phase_absent) cycle
      change = matmul(joint%rotation(:, :, p), relative_displacement(joint, p, u)) &
               - own%origin(:, p) - own%jump(:, p)
      call move_origin(p, change, own)
    end do
  end subroutine follow_rows

  !> Moves the zero of a point, and those of its parts.
  pure subroutine move_origin(p, change, own)
    integer, intent(in) :: p
    real(rk), intent(in) :: change(3) !< [m]
    type(joint_state), intent(inout) :: own
    own%origin(:, p) = own%origin(:, p) + change
    if (.not. allocated(own%part_origin)) return
    own%part_origin(:, :, p) = own%part_origin(:, :, p) &
                               + spread(change, 2, size(own%part_origin, 2))
  end subroutine move_origin

  !> Copies what the law sets.
  pure subroutine restore_point(old, p, own)
    type(joint_state), intent(in) :: old
    integer, intent(in) :: p
    type(joint_state), intent(inout) :: own
    own%jump(:, p) = old%jump(:, p)
    own%traction(:, p) = old%traction(:, p)
    own%slip(:, p) = old%slip(:, p)
    own%is_broken(p) = old%is_broken(p)
    own%status(p) = old%status(p)
    own%internal(:, p) = old%internal(:, p)
    own%friction_work(p) = old%friction_work(p)
    own%fracture_work(p) = old%fracture_work(p)
  end subroutine restore_point

  !> Copies what a point is at the start, but for the energies dissipated.
  pure subroutine renew_point(fresh, p, own)
    type(joint_state), intent(in) :: fresh
    integer, intent(in) :: p
    type(joint_state), intent(inout) :: own
    own%gap(p) = fresh%gap(p)
    own%shift(p) = fresh%shift(p)
    own%jump(:, p) = fresh%jump(:, p)
    own%traction(:, p) = fresh%traction(:, p)
    own%slip(:, p) = fresh%slip(:, p)
    own%is_broken(p) = fresh%is_broken(p)
    own%status(p) = fresh%status(p)
    own%num_openings(p) = 0
    own%internal(:, p) = fresh%internal(:, p)
  end subroutine renew_point

  !> Grout at the start of its step fills the points that are not intact then. Without pressure it
  !> hardens at once.
  subroutine fill_joints(model, plan, joints)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(joint_state), intent(inout) :: joints(:)
    integer :: g
    if (.not. allocated(plan%grouts)) return
    do g = 1, size(plan%grouts)
      associate (grout => plan%grouts(g))
        associate (own => joints(grout%joint))
          if (grout%pressure > 0.0_rk) then
            own%is_pressed = takes_grout(own)
          else
            call harden(model%joints(grout%joint), 0.0_rk, takes_grout(own), own)
          end if
        end associate
      end associate
    end do
  end subroutine fill_joints

  !> Grout with pressure hardens at the end of its step, in the points that it has filled: those
  !> that broke later hold none.
  subroutine harden_pressed(model, plan, joints)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan !< the step before
    type(joint_state), intent(inout) :: joints(:)
    integer :: g
    if (.not. allocated(plan%grouts)) return
    do g = 1, size(plan%grouts)
      associate (grout => plan%grouts(g))
        if (grout%pressure <= 0.0_rk) cycle
        associate (own => joints(grout%joint))
          call harden(model%joints(grout%joint), grout%pressure, own%is_pressed, own)
          deallocate (own%is_pressed)
        end associate
      end associate
    end do
  end subroutine harden_pressed

  !> The zero of the law moves so that the springs of the law carry what faces and grout carry now:
  !> an open point without pressure has its zero where it is. Contact without penetration carries
  !> the pressure by its multiplier.
  subroutine harden(joint, pressure, takes, own)
    type(dam_joint), intent(in) :: joint
    real(rk), intent(in) :: pressure !< of the grout [Pa]
    logical, intent(in) :: takes(:) !< (points) hold grout
    type(joint_state), intent(inout) :: own
    type(joint_state) :: old, fresh
    real(rk) :: tangent(3, 3, joint%num_points), jump(3, joint%num_points), k(3)
    integer :: p
    call joint%law%start_state(spread(-joint%law%gap, 1, joint%num_points), old)
    old%phase = own%phase
    where (takes) old%phase = phase_full
    call joint%law%reference_stiffness(k)
    jump = spread(1.0_rk/k, 2, joint%num_points)*own%traction
    jump(1, :) = jump(1, :) - pressure/k(1)
    if (joint%law%penetration > 0.0_rk) then
      where (old%is_broken) old%shift = min(0.0_rk, jump(1, :))
      jump(1, :) = jump(1, :) - old%shift
    end if
    fresh = old
    call joint%law%update(jump, old, fresh, tangent)
    do p = 1, joint%num_points
      if (.not. takes(p)) cycle
      call move_origin(p, own%jump(:, p) - jump(:, p), own)
      call renew_point(fresh, p, own)
      own%phase(p) = phase_full
    end do
  end subroutine harden
end module stage_joints
