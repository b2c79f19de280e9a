!> The motion in the unknowns of a step, with the forces that belong to it.
!>
!> Two of them exist, converged and trial: accepting an increment is one copy of the trial, cutting
!> it back leaves the converged one as it is.
module motion_state
  use kinds, only: rk
  use joint_law, only: joint_state
  use joint_points, only: joint, apart
  use dof_numbering, only: numbering
  use analysis_state, only: state
  use material_points, only: point_state
  use joint_operator, only: jump_operator
  use joint_forces, only: gather_tractions
  implicit none
  private
  public :: motion, start_motion, show_motion, compress, sum_contact, solid_force

  type :: motion
    real(rk), allocatable :: q(:), v(:), a(:) !< (num_total) [m], [m/s], [m/s2]
    real(rk), allocatable :: stiffness(:) !< diagonal of K [N/m]
    real(rk), allocatable :: external(:) !< f [N]
    real(rk), allocatable :: elastic(:) !< K q [N]
    real(rk), allocatable :: elastic_rate(:), elastic_jerk(:) !< K v [N/s], K a [N/s2]
    real(rk), allocatable :: viscous(:) !< C v [N]
    real(rk), allocatable :: viscous_rate(:) !< C a [N/s]
    real(rk), allocatable :: momentum(:) !< M v [N s]
    real(rk), allocatable :: inertia(:) !< M a [N]
    real(rk), allocatable :: balanced(:) !< M a as the balance of forces gives it [N]
    real(rk), allocatable :: contact(:) !< B^T (area t) by the laws of the joints [N]
    real(rk), allocatable :: carried(:, :) !< (3, points) t* of the implicit impulse [Pa]
    real(rk), allocatable :: jump_rate(:, :) !< (3, points) of the last increment [m/s]
    type(joint_state), allocatable :: joints(:)
    type(point_state), allocatable :: points(:) !< (blocks) of inelastic solids
    !> K q less the forces of the solids [N]; size 0 where all solids are elastic
    real(rk), allocatable :: released(:)
    real(rk) :: largest_force = 0.0_rk !< so far; kept where solids are inelastic [N]
  end type motion

contains

  !> The motion that the nodes are in, in the unknowns of a step; forces are zero.
  subroutine start_motion(numbers, joints, now, moving)
    type(numbering), intent(in) :: numbers
    type(joint), intent(in) :: joints(:)
    type(state), intent(in) :: now
    type(motion), intent(out) :: moving
    integer :: n
    n = numbers%num_total
    allocate (moving%q(n), moving%v(n), moving%a(n))
    call compress(numbers, joints, now%u, moving%q)
    call compress(numbers, joints, now%v, moving%v)
    call compress(numbers, joints, now%a, moving%a)
    moving%joints = now%joints
    moving%points = now%points
    moving%largest_force = now%largest_force
    allocate (moving%released(merge(n, 0, size(now%points) > 0)), source=0.0_rk)
    call set_exact_jumps(numbers, joints, moving)
    allocate (moving%external(n), moving%elastic(n), moving%elastic_rate(n), &
              moving%elastic_jerk(n), moving%viscous(n), moving%viscous_rate(n), &
              moving%momentum(n), moving%inertia(n), moving%balanced(n), moving%contact(n), &
              source=0.0_rk)
    allocate (moving%carried(3, sum(joints%num_points)), &
              moving%jump_rate(3, sum(joints%num_points)), source=0.0_rk)
  end subroutine start_motion

  !> The unknowns of a nodal field: q with T q = u.
  subroutine compress(numbers, joints, u, q)
    type(numbering), intent(in) :: numbers
    type(joint), intent(in) :: joints(:)
    real(rk), intent(in) :: u(:, :) !< (3, nodes)
    real(rk), intent(out) :: q(:) !< (num_total)
    integer :: k, j, p, pair, first
    do k = 1, numbers%num_total
      q(k) = u(numbers%direction(k), numbers%node(k))
    end do
    pair = 0
    do j = 1, size(joints)
      if (.not. joints(j)%is_nodal) cycle
      do p = 1, joints(j)%num_points
        pair = pair + 1
        first = numbers%first_jump(pair)
        if (first == 0) cycle
        q(first:first + 2) = matmul(joints(j)%rotation(:, :, p), apart(joints(j), p, u))
      end do
    end do
  end subroutine compress

  !> Jumps as the joints know them, without the digits that the difference of two nodes loses.
  subroutine set_exact_jumps(numbers, joints, moving)
    type(numbering), intent(in) :: numbers
    type(joint), intent(in) :: joints(:)
    type(motion), intent(inout) :: moving
    integer :: j, p, pair, first
    pair = 0
    do j = 1, size(joints)
      if (.not. joints(j)%is_nodal) cycle
      do p = 1, joints(j)%num_points
        pair = pair + 1
        first = numbers%first_jump(pair)
        if (first > 0) moving%q(first:first + 2) = moving%joints(j)%jump(:, p)
      end do
    end do
  end subroutine set_exact_jumps

  !> The forces of the joints by their laws, B^T (area t).
  subroutine sum_contact(operator, moving)
    type(jump_operator), intent(in) :: operator
    type(motion), intent(inout) :: moving
    real(rk) :: traction(3, operator%num_points)
    call gather_tractions(operator, moving%joints, traction)
    moving%contact = 0.0_rk
    call operator%add_forces(traction, moving%contact)
  end subroutine sum_contact

  !> The size of the forces of the solids, K q less what they have released [N].
  pure real(rk) function solid_force(moving) result(force)
    type(motion), intent(in) :: moving
    if (size(moving%released) > 0) then
      force = norm2(moving%elastic - moving%released)
    else
      force = norm2(moving%elastic)
    end if
  end function solid_force

  !> Writes the motion back to the nodes; reactions are the out-of-balance of prescribed unknowns.
  subroutine show_motion(numbers, moving, now)
    type(numbering), intent(in) :: numbers
    type(motion), intent(in) :: moving
    type(state), intent(inout) :: now
    integer :: k
    call numbers%expand(moving%q, now%u)
    call numbers%expand(moving%v, now%v)
    call numbers%expand(moving%a, now%a)
    now%reaction = 0.0_rk
    do k = numbers%num_free + 1, numbers%num_total
      now%reaction(numbers%direction(k), numbers%node(k)) = &
        moving%inertia(k) + moving%viscous(k) + moving%elastic(k) + moving%contact(k) &
        - moving%external(k)
    end do
    now%joints = moving%joints
    if (size(moving%points) == 0) return
    do k = numbers%num_free + 1, numbers%num_total
      associate (held => now%reaction(numbers%direction(k), numbers%node(k)))
        held = held - moving%released(k)
      end associate
    end do
    now%points = moving%points
    now%largest_force = moving%largest_force
  end subroutine show_motion
end module motion_state
