!> Nonlinear block Gauss-Seidel over the points of joints (Jean 1999; Acary, Bremond & Huber 2018):
!> finds which points are closed and which slide where Newton's iteration cycles.
!>
!> With open joints the structure has the compliance C, with the joints' own springs
!> W = C + 1/(weight*area*k_ref). The part of the jumps that the springs leave, openings and slips,
!> is d = W (f_closed - f), with f the forces of the points, f_closed those of closed joints. A
!> sweep visits all points and gives each the force for which its d agrees with contact and friction
!> while the other forces of its group stay, and the d of other groups. Several groups are visited
!> in turn, each until its forces change little: block Gauss-Seidel on the d of groups, with the
!> matrix W^-1. With one sweep over each group it diverges where groups see each other strongly.
module contact_sweeps
  use block_compliance, only: compliance_blocks
  use contact_scaling, only: open_group
  use coupling_block, only: add_product
  use global_vectors, only: distance
  use joint_forces, only: joint_field
  use joint_iteration, only: joint_increment
  use joint_law, only: is_bare, state_bonded
  use joint_rows, only: num_axes, row_of
  use kinds, only: rk
  use ranks, only: add_over_ranks
  implicit none
  private
  public :: swept_points, gather_points, sweep_contacts

  !> What the sweeps need of all points of all joints, in one row.
  type :: swept_points
    real(rk), allocatable :: share(:) !< weight*area [m2]
    real(rk), allocatable :: spring(:, :) !< (3, points) compliance of the joint's springs [m/N]
    real(rk), allocatable :: friction(:) !< mu
    real(rk), allocatable :: cohesion(:) !< c [Pa]
    real(rk), allocatable :: slip(:, :) !< (2, points) converged [m]
    logical, allocatable :: is_bonded(:)
  end type swept_points

  !> Sweeps over a group among several, at most, and the change of its forces over that of the first
  !> one that ends them.
  integer, parameter :: most_visits = 20
  real(rk), parameter :: settled = 0.02_rk

contains

  !> Limits of friction by the laws; bonded points are those of the last evaluation.
  subroutine gather_points(now, weight, points)
    type(joint_increment), intent(in) :: now
    real(rk), intent(in) :: weight !< of the joint forces
    type(swept_points), intent(out) :: points
    real(rk) :: strength
    integer :: j, p, first, last
    points%share = weight*now%operator%area
    points%spring = 1.0_rk/(spread(points%share, 1, 3)*now%k_ref)
    associate (n => now%operator%num_points)
      allocate (points%friction(n), points%cohesion(n), points%slip(2, n), points%is_bonded(n))
    end associate
    do j = 1, size(now%joints)
      first = now%operator%first_point(j)
      last = now%operator%first_point(j + 1) - 1
      if (last < first) cycle
      call now%joints(j)%law%limits(points%friction(first), points%cohesion(first), strength)
      points%friction(first:last) = points%friction(first)
      points%cohesion(first:last) = points%cohesion(first)
      do p = first, last
        if (is_bare(now%old(j), p - first + 1)) points%cohesion(p) = 0.0_rk
      end do
      points%slip(:, first:last) = now%old(j)%slip
      points%is_bonded(first:last) = now%new(j)%status == state_bonded
    end do
  end subroutine gather_points

  !> Sweeps forwards and backwards in turn. On return `field%jump` and `field%multiplier` hold the
  !> jumps and tractions found.
  subroutine sweep_contacts(blocks, opened, points, closed_jump, num_sweeps, force, field)
    type(compliance_blocks), intent(in) :: blocks !< G
    type(open_group), intent(in) :: opened(:) !< (groups) C
    type(swept_points), intent(in) :: points
    real(rk), intent(in) :: closed_jump(:, :) !< (3, points) with closed, sticking joints [m]
    integer, intent(in) :: num_sweeps
    real(rk), intent(inout) :: force(:, :) !< (3, points) f [N]
    type(joint_field), intent(inout) :: field
    real(rk) :: d(3, size(force, 2))
    integer :: sweep, visit, g
    d = 0.0_rk
    do sweep = 1, num_sweeps
      do visit = 1, size(opened)
        g = visit
        if (mod(sweep, 2) == 0) g = size(opened) + 1 - visit
        if (blocks%groups%is_here(g)) then
          if (size(opened) > 1 .or. sweep == 1) then
            call find_rest(blocks, opened(g), g, points, closed_jump, force, d)
          end if
          call settle_group(opened(g)%compliance, blocks%groups%members(g), points, &
                            merge(1, most_visits, size(opened) == 1), mod(sweep, 2) == 1, &
                            force, d, field)
        end if
        if (blocks%groups%is_divided()) call share_group(blocks, g, force, d)
      end do
    end do
    field%multiplier = force/spread(points%share, 1, 3)
    field%jump = d + points%spring*force
  end subroutine sweep_contacts

  !> Gives all ranks the forces and the d of a group.
  subroutine share_group(blocks, group, force, d)
    type(compliance_blocks), intent(in) :: blocks
    integer, intent(in) :: group
    real(rk), intent(inout) :: force(:, :), d(:, :) !< (3, points) [N], [m]
    real(rk), allocatable :: both(:, :)
    associate (point => blocks%groups%members(group))
      allocate (both(6, size(point)), source=0.0_rk)
      if (blocks%groups%is_here(group)) then
        both(:3, :) = force(:, point)
        both(4:, :) = d(:, point)
      end if
      call add_over_ranks(both)
      force(:, point) = both(:3, :)
      d(:, point) = both(4:, :)
    end associate
  end subroutine share_group

  !> d of a group from its forces and the d of other groups. Other joints carry the forces of closed
  !> ones less d/spring.
  subroutine find_rest(blocks, opened, group, points, closed_jump, force, d)
    type(compliance_blocks), intent(in) :: blocks
    type(open_group), intent(in) :: opened
    integer, intent(in) :: group
    type(swept_points), intent(in) :: points
    real(rk), intent(in) :: closed_jump(:, :) !< (3, points) [m]
    real(rk), intent(in) :: force(:, :) !< (3, points) [N]
    real(rk), intent(inout) :: d(:, :) !< (3, points) [m]
    real(rk) :: missing(size(opened%compliance, 1)), answer(size(missing)), spring(size(missing))
    integer :: k
    associate (groups => blocks%groups, point => blocks%groups%members(group))
      spring = reshape(points%spring(:, point), shape(spring))
      answer = reshape(closed_jump(:, point), shape(answer))
      do k = 1, groups%num_groups
        if (k == group .or. .not. blocks%has_block(group, k)) cycle
        associate (other => groups%members(k))
          call blocks%add_block(group, k, &
                                reshape(d(:, other)/points%spring(:, other), [3*size(other)]), &
                                answer, .false.)
        end associate
      end do
      missing = answer/spring - reshape(force(:, point), shape(missing))
      answer = spring*missing
      call add_product(opened%compliance, missing, .false., answer)
      d(:, point) = reshape(answer, [3, size(point)])
    end associate
  end subroutine find_rest

  !> Sweeps over a group until its forces change little.
  subroutine settle_group(compliance, point, points, most, is_forward, force, d, field)
    real(rk), intent(in) :: compliance(:, :) !< C (rows, rows) of the group [m/N]
    integer, intent(in) :: point(:) !< of the group
    type(swept_points), intent(in) :: points
    integer, intent(in) :: most !< sweeps
    logical, intent(in) :: is_forward !< the first sweep
    real(rk), intent(inout) :: force(:, :) !< (3, points) [N]
    real(rk), intent(inout) :: d(:, :) !< (3, points) [m]
    type(joint_field), intent(in) :: field
    real(rk) :: before(3, size(point)), change, first
    integer :: k
    do k = 1, most
      before = force(:, point)
      call sweep_group(compliance, point, points, is_forward .eqv. mod(k, 2) == 1, force, d, field)
      change = distance(force(:, point), before)
      if (k == 1) first = change
      if (change <= settled*first) return
    end do
  end subroutine settle_group

  !> Visits the points of a group.
  subroutine sweep_group(compliance, point, points, is_forward, force, d, field)
    real(rk), intent(in) :: compliance(:, :) !< C (rows, rows) of the group [m/N]
    integer, intent(in) :: point(:) !< of the group
    type(swept_points), intent(in) :: points
    logical, intent(in) :: is_forward
    real(rk), intent(inout) :: force(:, :) !< (3, points) [N]
    real(rk), intent(inout) :: d(:, :) !< (3, points) [m]
    type(joint_field), intent(in) :: field
    real(rk) :: rest(size(compliance, 1)), change(3), block(num_axes, num_axes)
    integer :: visit, k, p, row
    rest = reshape(d(:, point), shape(rest))
    do visit = 1, size(point)
      k = merge(visit, size(point) + 1 - visit, is_forward)
      p = point(k)
      row = row_of(k, 1)
      ! A copy: gfortran 12 passes a section named by `associate` as if it were contiguous.
      block = compliance(row:row + num_axes - 1, row:row + num_axes - 1)
      associate (own => rest(row:row + num_axes - 1))
        change = local_force(block, own, force(:, p), p, points, field) - force(:, p)
        if (.not. any(abs(change) > 0.0_rk)) cycle
        force(:, p) = force(:, p) + change
        own = own - points%spring(:, p)*change
      end associate
      rest = rest - change(1)*compliance(:, row) - change(2)*compliance(:, row + 1) &
             - change(3)*compliance(:, row + 2)
    end do
    d(:, point) = reshape(rest, [3, size(point)])
  end subroutine sweep_group

  !> Force of one point: bonded, d = 0; else the projection of the pressure, then of the friction,
  !> by one step each.
  pure function local_force(block, d, force, p, points, field) result(answer)
    real(rk), intent(in) :: block(3, 3) !< C [m/N]
    real(rk), intent(in) :: d(3) !< [m]
    real(rk), intent(in) :: force(3) !< [N]
    integer, intent(in) :: p !< the point
    type(swept_points), intent(in) :: points
    type(joint_field), intent(in) :: field
    real(rk) :: answer(3)
    real(rk) :: rest(3), limit, trial(2)
    integer :: i
    answer = force
    if (points%is_bonded(p)) then
      rest = d
      do i = 1, 3
        answer(i) = force(i) + rest(i)/(block(i, i) + points%spring(i, p))
        rest = rest - block(:, i)*(answer(i) - force(i))
      end do
      return
    end if
    answer(1) = force(1) + (d(1) + field%gap(p))/(block(1, 1) + points%spring(1, p))
    if (answer(1) >= 0.0_rk) then
      answer = 0.0_rk
      return
    end if
    trial = d(2:3) + block(2:3, 1)*(force(1) - answer(1)) - points%slip(:, p)
    trial = force(2:3) + points%share(p)*field%scale%own(2, p)*trial
    limit = points%share(p)*points%cohesion(p) - points%friction(p)*answer(1)
    answer(2:3) = trial*min(1.0_rk, limit/max(norm2(trial), tiny(limit)))
  end function local_force
end module contact_sweeps
