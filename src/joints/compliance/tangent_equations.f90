!> Newton's linear equations on the jumps, (I - D G) z = D r (theory.md, (8.1)), with G in blocks.
!>
!> D = weight*area*(k_ref - tangent); a correction of the jumps is d = r + G z. With one group of
!> points, whose block is all of G, the equations are solved by its factor. With several, or where
!> more than the blocks is known of G, they are solved by flexible GMRES (Saad 1993) with the
!> factors of the groups as preconditioner. On several ranks each rank has those of its groups.
module tangent_equations
  use block_compliance, only: compliance_blocks
  use global_vectors, only: length
  use joint_rows, only: num_axes
  use kinds, only: rk
  use krylov_spaces, only: krylov_space, most_steps, start_space, make_room, add_to_space, &
                           solve_triangle
  use ranks, only: add_over_ranks
  use tangent_factors, only: group_factor, update_factor, solve_group, apply_change
  implicit none
  private
  public :: joint_tangent

  type :: joint_tangent
    real(rk), allocatable :: change(:, :, :) !< (3, 3, points) D [N/m]
    type(group_factor), allocatable :: group(:) !< kept factors
    logical, allocatable :: is_second(:) !< (groups) solved for after those of the first half
    logical :: is_singular = .false.
    !> No factor has been used since the increment began. The first ones depend on its start alone,
    !> so that a run that is continued takes the same ones.
    logical :: is_first = .true.
    logical :: is_single = .false. !< factors of several groups may be in single precision
    !> Groups see each other strongly: all are solved for at once. Fixed before the first tangent.
    logical :: is_static = .false.
  contains
    procedure :: set_tangent, solve, estimate
    procedure, private :: precondition, iterate, step_roughly
  end type joint_tangent

  !> Solutions with a rough G, and at last one with G; residual that ends them, over the wanted one.
  integer, parameter :: most_passes = 4
  real(rk), parameter :: near_target = 1.5_rk
  !> A residual over the one before: with less the rough G is worth another solution.
  real(rk), parameter :: gain_of_pass = 0.1_rk
  !> D of a group may differ so much from that of its kept factor.
  real(rk), parameter :: kept_share = 0.1_rk

contains

  !> Takes the tangents of all points and updates the factors of the groups.
  subroutine set_tangent(self, blocks, k_ref, share, tangent)
    class(joint_tangent), intent(inout) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), intent(in) :: share(:) !< (points) weight*area [m2]
    real(rk), intent(in) :: tangent(:, :, :) !< (3, 3, points) [Pa/m]
    real(rk) :: kept
    logical :: is_single
    integer :: p, i, g
    self%change = -tangent
    do p = 1, size(share)
      do i = 1, num_axes
        self%change(i, i, p) = self%change(i, i, p) + k_ref(i, p)
      end do
      self%change(:, :, p) = share(p)*self%change(:, :, p)
    end do
    if (.not. allocated(self%group)) then
      allocate (self%group(blocks%groups%num_groups))
      self%is_second = half_of_groups(blocks) .and. .not. self%is_static
    end if
    kept = merge(kept_share, 0.0_rk, size(self%group) > 1 .and. .not. self%is_first)
    self%is_first = .false.
    is_single = self%is_single .and. size(self%group) > 1
    !$omp parallel do schedule(dynamic) default(none) if (blocks%groups%are_worth_threads()) &
    !$omp shared(self, blocks, kept, is_single)
    do g = 1, size(self%group)
      if (.not. blocks%groups%is_here(g)) cycle
      call update_factor(blocks, g, self%change, kept, is_single, self%group(g))
    end do
    !$omp end parallel do
    if (blocks%groups%is_divided()) call share_outcomes(blocks, self%group)
    self%is_singular = .not. all(self%group%is_there)
  end subroutine set_tangent

  !> Tells all ranks which factors are there, and which are those of the present D.
  subroutine share_outcomes(blocks, group)
    type(compliance_blocks), intent(in) :: blocks
    type(group_factor), intent(inout) :: group(:)
    real(rk) :: outcome(2*size(group)) ! 1 for true
    integer :: g
    outcome = 0.0_rk
    do g = 1, size(group)
      if (.not. blocks%groups%is_here(g)) cycle
      outcome(2*g - 1:2*g) = merge(1.0_rk, 0.0_rk, [group(g)%is_there, group(g)%is_exact])
    end do
    call add_over_ranks(outcome)
    group%is_there = outcome(1::2) > 0.5_rk
    group%is_exact = outcome(2::2) > 0.5_rk
  end subroutine share_outcomes

  !> Groups in two halves; those of the second are solved for with the forces of the first. A group
  !> is in another half than the one before it that it sees most: neighbours alternate.
  pure function half_of_groups(blocks) result(is_second)
    type(compliance_blocks), intent(in) :: blocks
    logical :: is_second(blocks%groups%num_groups)
    integer :: g
    is_second = .false.
    do g = 2, size(is_second)
      is_second(g) = .not. is_second(maxloc(blocks%block(:g - 1, g)%coupling, 1))
    end do
  end function half_of_groups

  !> The correction d of the jumps, and D d - z: what the equations leave.
  subroutine solve(self, blocks, response, tolerance, smallest, correction, rest)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: response(:) !< (rows) r [m]
    real(rk), intent(in) :: tolerance !< of the norm of the residual, over that of D r
    real(rk), intent(in) :: smallest !< norm of the residual that is small enough [N]
    real(rk), intent(out) :: correction(:) !< (rows) d [m]
    real(rk), intent(out) :: rest(:) !< (rows) [N]
    real(rk) :: b(size(response))
    b = apply_change(self%change, response)
    if (blocks%groups%num_groups == 1 .and. .not. blocks%has_more()) then
      call self%precondition(blocks, [.true.], b)
      call blocks%product(b, correction)
      correction = response + correction
      rest = 0.0_rk
    else
      call self%iterate(blocks, b, max(tolerance*length(b), smallest), correction, rest)
      correction = response + correction
    end if
  end subroutine solve

  !> The correction of the jumps to a hundredth or so.
  subroutine estimate(self, blocks, response, tolerance, correction)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: response(:) !< (rows) r [m]
    real(rk), intent(in) :: tolerance !< of the norm of the residual, over that of D r
    real(rk), intent(out) :: correction(:) !< (rows) d [m]
    real(rk), dimension(size(response)) :: b, z
    b = apply_change(self%change, response)
    z = 0.0_rk
    if (length(b) > 0.0_rk) call add_solution(self, blocks, b, tolerance*length(b), .true., z)
    call blocks%couple(spread(spread(.true., 1, size(self%group)), 2, size(self%group)), z, &
                       correction)
    call blocks%learned%add_to(z, correction)
    correction = response + correction
  end subroutine estimate

  !> Solves with the factors of some groups, in place.
  subroutine precondition(self, blocks, takes_part, x)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    logical, intent(in) :: takes_part(:) !< (groups)
    real(rk), intent(inout) :: x(:) !< (rows)
    real(rk) :: sorted(size(x))
    integer :: g
    sorted = x(blocks%groups%row)
    !$omp parallel do schedule(dynamic) default(none) shared(self, blocks, takes_part, sorted) &
    !$omp if (blocks%groups%are_worth_threads())
    do g = 1, size(self%group)
      associate (first => blocks%groups%first_row(g), next => blocks%groups%first_row(g + 1))
        if (.not. blocks%groups%is_here(g)) then
          sorted(first:next - 1) = 0.0_rk
        else if (takes_part(g)) then
          call solve_group(self%group(g), sorted(first:next - 1))
        end if
      end associate
    end do
    !$omp end parallel do
    if (blocks%groups%is_divided()) call add_over_ranks(sorted)
    x(blocks%groups%row) = sorted
  end subroutine precondition

  !> Flexible GMRES from z = 0: G z, and b + D G z - z.
  !>
  !> A factor solves with the own block of its group, so that a step needs no product with this
  !> block, and weak coupling needs few digits. What this leaves follows from one product with G.
  subroutine iterate(self, blocks, b, target, product, rest)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: b(:) !< (rows) [N]
    real(rk), intent(in) :: target !< norm of the residual [N]
    real(rk), intent(out) :: product(:) !< (rows) G z [m]
    real(rk), intent(out) :: rest(:) !< (rows) [N]
    real(rk) :: z(size(b)), left, before
    logical :: is_rough
    integer :: pass
    product = 0.0_rk
    z = 0.0_rk
    rest = b
    left = length(b)
    is_rough = .true.
    do pass = 1, most_passes
      if (.not. left > merge(near_target, 1.0_rk, pass > 1)*target) return
      call add_solution(self, blocks, rest, target, is_rough .and. pass < most_passes, z)
      call blocks%product(z, product)
      rest = b + apply_change(self%change, product) - z
      before = left
      left = length(rest)
      is_rough = left <= gain_of_pass*before
    end do
  end subroutine iterate

  !> Adds the solution of (I - D G) z = b.
  subroutine add_solution(self, blocks, b, target, is_rough, z)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: b(:) !< (rows) [N]
    real(rk), intent(in) :: target !< norm of the residual [N]
    logical, intent(in) :: is_rough !< with a rough G
    real(rk), intent(inout) :: z(:) !< (rows) [N]
    type(krylov_space) :: space
    real(rk) :: y(most_steps)
    integer :: k
    call start_space(b, space)
    do k = 1, most_steps
      call make_room(k, space)
      if (is_rough) then
        call self%step_roughly(blocks, space%v(:, k), space%p(:, k), space%v(:, k + 1))
      else
        space%p(:, k) = space%v(:, k)
        call self%precondition(blocks, spread(.true., 1, size(self%group)), space%p(:, k))
        call blocks%product(space%p(:, k), space%v(:, k + 1))
        space%v(:, k + 1) = space%p(:, k) - apply_change(self%change, space%v(:, k + 1))
      end if
      call add_to_space(k, space)
      if (abs(space%rest(k + 1)) <= target) exit
    end do
    k = min(k, most_steps)
    call solve_triangle(k, space, y)
    z = z + matmul(space%p(:, :k), y(:k))
  end subroutine add_solution

  !> The first half of the groups solves for v, the second half for v and the jumps by the first:
  !> p, and (I - D G) p. Each block between groups is used once, own blocks where a factor is not
  !> that of D.
  subroutine step_roughly(self, blocks, v, p, product)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: v(:) !< (rows) [N]
    real(rk), intent(out) :: p(:), product(:) !< (rows) [N]
    real(rk), dimension(size(v)) :: early, moved ! jumps by forces of the first half, by the others
    logical :: takes_part(size(self%group), size(self%group)) ! jumps of groups, forces of groups
    integer :: g, n
    n = size(self%group)
    takes_part = spread(self%is_second, 2, n) .and. .not. spread(self%is_second, 1, n)
    p = v
    call self%precondition(blocks,.not. self%is_second, p)
    call blocks%couple(takes_part, p, early)
    p = p + apply_change(self%change, early)
    call self%precondition(blocks, self%is_second, p)
    takes_part = .not. takes_part
    do g = 1, size(self%group)
      takes_part(g, g) = .not. self%group(g)%is_exact
    end do
    call blocks%couple(takes_part, p, moved)
    call blocks%learned%add_to(p, moved)
    product = v
    do g = 1, size(self%group)
      if (self%group(g)%is_exact) cycle
      associate (row => blocks%groups%rows(g))
        product(row) = p(row)
        moved(row) = moved(row) + early(row)
      end associate
    end do
    product = product - apply_change(self%change, moved)
  end subroutine step_roughly
end module tangent_equations
