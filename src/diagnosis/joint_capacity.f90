!> Whether joints of any stiffness could balance given forces on rigid blocks: with pressure, with
!> tension up to the remaining strength, and with friction up to mu p + c.
!>
!> The admissible forces with the smallest unbalanced load are the nearest point of a convex set
!> (different_meshes.md, 13.7), found by projections with Nesterov's acceleration. Orthonormal rows
!> of the joints allow the largest step. If a part of the loads remains, no equilibrium exists (safe
!> theorem of limit analysis). Bonded points count with their full strength.
module joint_capacity
  use errors, only: error_type
  use kinds, only: rk
  use joint_rows, only: num_axes, row_of
  use symmetric_modes, only: find_modes
  implicit none
  private
  public :: point_limits, best_forces, find_best_forces

  !> Admissible forces of one point.
  type :: point_limits
    real(rk) :: friction = 0.0_rk !< mu
    real(rk) :: cohesion = 0.0_rk !< c times the area [N]
    real(rk) :: tension = 0.0_rk !< strength times the area [N]
    logical :: is_bonded = .false. !< no limit of shear
  end type point_limits

  type :: best_forces
    real(rk), allocatable :: force(:, :) !< (3, points) normal, positive pulls, and two tangents [N]
    real(rk), allocatable :: mechanism(:) !< motion driven by the unbalanced loads
    !> Unbalanced part over the loads; 1 where it acts in a direction that no joint resists.
    real(rk) :: left = 0.0_rk
    logical :: has_settled = .false. !< else the projections ended too early for a result
  end type best_forces

  !> Rows of joints below this fraction of the largest (squared) are zero.
  real(rk), parameter :: rank_tolerance = 1.0e-10_rk
  !> Largest fraction of the loads in directions that no joint resists.
  real(rk), parameter :: roundoff = 1.0e-8_rk
  integer, parameter :: most_projections = 20000
  real(rk), parameter :: most_work = 1.0e10_rk !< multiplications: some seconds
  integer, parameter :: check_every = 100
  !> A smaller unbalanced part is equilibrium; smaller progress in `check_every` steps is the end.
  real(rk), parameter :: balanced = 1.0e-3_rk, least_progress = 1.0e-5_rk

contains

  !> Balances `load` as far as the joints allow: G t = load.
  subroutine find_best_forces(rows, limits, load, best)
    real(rk), intent(in), contiguous :: rows(:, :) !< G (motions, rows)
    type(point_limits), intent(in) :: limits(:) !< (points)
    real(rk), intent(in) :: load(:) !< (motions)
    type(best_forces), intent(out) :: best
    type(error_type), allocatable :: error
    real(rk), allocatable :: values(:), modes(:, :), white(:, :), target(:), left(:), t(:)
    integer :: first, k, n
    n = size(load)
    allocate (best%force(num_axes, size(limits)), best%mechanism(n), source=0.0_rk)
    call find_modes(matmul(rows, transpose(rows)), values, modes, error)
    if (allocated(error)) then
      best%left = 1.0_rk ! not settled: no result
      return
    end if
    first = n + 1
    if (n > 0) first = n - count(values > rank_tolerance*max(values(n), tiny(1.0_rk))) + 1
    left = matmul(load, modes(:, :first - 1))
    if (norm2(left) > roundoff*norm2(load)) then
      best%mechanism = matmul(modes(:, :first - 1), left)
      best%left = 1.0_rk
      best%has_settled = .true.
      return
    end if
    white = matmul(transpose(modes(:, first:)), rows)
    target = matmul(load, modes(:, first:))
    do k = 1, size(target)
      white(k, :) = white(k, :)/sqrt(values(first - 1 + k))
      target(k) = target(k)/sqrt(values(first - 1 + k))
    end do
    call project(white, limits, target, t, left, best%has_settled)
    best%force = reshape(t, [3, size(limits)])
    best%left = norm2(left)/max(norm2(target), tiny(1.0_rk))
    best%mechanism = matmul(modes(:, first:), left/sqrt(values(first:)))
  end subroutine find_best_forces

  !> Least |white t - target| over admissible t; the rows of `white` are orthonormal.
  subroutine project(white, limits, target, t, left, has_settled)
    real(rk), intent(in), contiguous :: white(:, :) !< (motions, rows)
    type(point_limits), intent(in) :: limits(:)
    real(rk), intent(in) :: target(:)
    real(rk), allocatable, intent(out) :: t(:) !< (rows) [N]
    real(rk), allocatable, intent(out) :: left(:) !< target - white t
    logical, intent(out) :: has_settled
    real(rk), allocatable :: ahead(:), before(:)
    real(rk) :: momentum, next, last
    integer :: i, most
    allocate (t(size(white, 2)), ahead(size(white, 2)), source=0.0_rk)
    momentum = 1.0_rk
    last = huge(last)
    has_settled = .true.
    most = int(min(real(most_projections, rk), most_work/max(1, 2*size(white))))
    do i = 1, most
      before = t
      t = ahead + matmul(target - matmul(white, ahead), white)
      call admit(limits, t)
      if (dot_product(ahead - t, t - before) > 0.0_rk) momentum = 1.0_rk
      next = 0.5_rk*(1.0_rk + sqrt(1.0_rk + 4.0_rk*momentum**2))
      ahead = t + (momentum - 1.0_rk)/next*(t - before)
      momentum = next
      if (mod(i, check_every) /= 0) cycle
      left = target - matmul(white, t)
      if (norm2(left) <= balanced*norm2(target)) return
      if (norm2(left) > (1.0_rk - least_progress)*last) return
      last = norm2(left)
    end do
    has_settled = .false.
    left = target - matmul(white, t)
  end subroutine project

  !> The nearest admissible forces.
  pure subroutine admit(limits, t)
    type(point_limits), intent(in) :: limits(:)
    real(rk), intent(inout) :: t(:) !< (rows)
    real(rk) :: shear, pull
    integer :: p
    do p = 1, size(limits)
      associate (now => limits(p), f => t(row_of(p, 1):row_of(p, num_axes)))
        if (now%is_bonded) then
          f(1) = min(f(1), now%tension)
          cycle
        end if
        shear = norm2(f(2:3))
        pull = f(1)
        call nearest_in_cone(now, pull, shear)
        f(2:3) = f(2:3)*(shear/max(norm2(f(2:3)), tiny(1.0_rk)))
        f(1) = pull
      end associate
    end do
  end subroutine admit

  !> In the plane of pull and shear: pull <= 0, shear <= c - mu pull.
  pure subroutine nearest_in_cone(limits, pull, shear)
    type(point_limits), intent(in) :: limits
    real(rk), intent(inout) :: pull
    real(rk), intent(inout) :: shear !< >= 0
    real(rk) :: beyond
    associate (mu => limits%friction, c => limits%cohesion)
      if (pull <= 0.0_rk .and. shear <= c - mu*pull) return
      beyond = (shear + mu*pull - c)/(1.0_rk + mu**2)
      if (beyond > 0.0_rk .and. pull - mu*beyond <= 0.0_rk) then
        pull = pull - mu*beyond
        shear = shear - beyond
      else
        pull = 0.0_rk
        shear = min(shear, c)
      end if
    end associate
  end subroutine nearest_in_cone
end module joint_capacity
