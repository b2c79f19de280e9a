!> Newton's linear equations on the jumps, (I - D G) z = D r (theory.md, (8.1)), with G in blocks.
!>
!> D = weight*area*(k_ref - tangent); a correction of the jumps is d = r + G z. With one group of
!> points the equations are solved by its factor, with several by flexible GMRES (Saad 1993) with
!> the factors of the groups as preconditioner.
module tangent_equations
  use block_compliance, only: compliance_blocks
  use global_vectors, only: dot, norm
  use joint_rows, only: num_axes
  use kinds, only: rk
  use tangent_factors, only: group_factor, update_factor, solve_group, apply_change
  implicit none
  private
  public :: joint_tangent

  type :: joint_tangent
    real(rk), allocatable :: change(:, :, :) !< (3, 3, points) D [N/m]
    type(group_factor), allocatable :: group(:) !< kept factors
    logical :: is_singular = .false.
    !> No factor has been used since the increment began. The first ones depend on its start alone,
    !> so that a run that is continued takes the same ones.
    logical :: is_first = .true.
    logical :: is_single = .false. !< factors of several groups may be in single precision
  contains
    procedure :: set_tangent, solve
    procedure, private :: precondition, iterate, multiply_roughly
  end type joint_tangent

  !> A Krylov space: A p(k) is a combination of v(1..k+1).
  type :: krylov_space
    real(rk), allocatable :: v(:, :), p(:, :) !< (rows, steps + 1) and (rows, steps)
    real(rk), allocatable :: h(:, :) !< (steps + 1, steps) upper triangle after rotations
    real(rk), allocatable :: cosine(:), sine(:), rest(:)
  end type krylov_space

  integer, parameter :: most_steps = 100
  !> Solutions with a rough G, and at last one with G; residual that ends them, over the wanted one.
  integer, parameter :: most_passes = 4
  real(rk), parameter :: near_target = 1.5_rk
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
    if (.not. allocated(self%group)) allocate (self%group(blocks%groups%num_groups))
    kept = merge(kept_share, 0.0_rk, size(self%group) > 1 .and. .not. self%is_first)
    self%is_first = .false.
    is_single = self%is_single .and. size(self%group) > 1
    !$omp parallel do schedule(dynamic) default(none) if (size(self%group) > 1) &
    !$omp shared(self, blocks, kept, is_single)
    do g = 1, size(self%group)
      call update_factor(blocks, g, self%change, kept, is_single, self%group(g))
    end do
    !$omp end parallel do
    self%is_singular = .not. all(self%group%is_there)
  end subroutine set_tangent

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
    if (blocks%groups%num_groups == 1) then
      call self%precondition(blocks, b)
      call blocks%product(b, correction)
      correction = response + correction
      rest = 0.0_rk
    else
      call self%iterate(blocks, b, max(tolerance*norm(b), smallest), correction, rest)
      correction = response + correction
    end if
  end subroutine solve

  !> Solves with the factors of the groups, in place.
  subroutine precondition(self, blocks, x)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(inout) :: x(:) !< (rows)
    real(rk) :: sorted(size(x))
    integer :: g
    sorted = x(blocks%groups%row)
    !$omp parallel do schedule(dynamic) default(none) shared(self, blocks, sorted) &
    !$omp if (size(self%group) > 1)
    do g = 1, size(self%group)
      call solve_group(self%group(g), sorted(blocks%groups%first_row(g): &
                                             blocks%groups%first_row(g + 1) - 1))
    end do
    !$omp end parallel do
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
    real(rk) :: z(size(b))
    integer :: pass
    product = 0.0_rk
    z = 0.0_rk
    rest = b
    do pass = 1, most_passes
      if (.not. norm(rest) > merge(near_target, 1.0_rk, pass > 1)*target) return
      call add_solution(self, blocks, rest, target, pass < most_passes, z)
      call blocks%product(z, product)
      rest = b + apply_change(self%change, product) - z
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
      space%p(:, k) = space%v(:, k)
      call self%precondition(blocks, space%p(:, k))
      if (is_rough) then
        call self%multiply_roughly(blocks, space%v(:, k), space%p(:, k), space%v(:, k + 1))
      else
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

  !> (I - D G) p for p that the factors have solved for from v.
  subroutine multiply_roughly(self, blocks, v, p, product)
    class(joint_tangent), intent(in) :: self
    type(compliance_blocks), intent(in) :: blocks
    real(rk), intent(in) :: v(:), p(:) !< (rows) [N]
    real(rk), intent(out) :: product(:) !< (rows) [N]
    real(rk) :: moved(size(v))
    integer :: g
    call blocks%couple(self%group%is_exact, p, moved)
    product = v
    do g = 1, size(self%group)
      if (self%group(g)%is_exact) cycle
      associate (row => blocks%groups%row(blocks%groups%first_row(g): &
                                          blocks%groups%first_row(g + 1) - 1))
        product(row) = p(row)
      end associate
    end do
    product = product - apply_change(self%change, moved)
  end subroutine multiply_roughly

  !> The space of one vector.
  subroutine start_space(b, space)
    real(rk), intent(in) :: b(:)
    type(krylov_space), intent(out) :: space
    integer :: n
    n = size(b)
    allocate (space%v(n, most_steps + 1), space%p(n, most_steps))
    allocate (space%h(most_steps + 1, most_steps), space%cosine(most_steps))
    allocate (space%sine(most_steps), space%rest(most_steps + 1))
    space%rest(1) = norm(b)
    space%v(:, 1) = b/space%rest(1)
  end subroutine start_space

  !> Makes v(k+1) orthonormal to the vectors before it and rotates its column of h into a triangle.
  subroutine add_to_space(k, space)
    integer, intent(in) :: k
    type(krylov_space), intent(inout) :: space
    real(rk) :: length, first
    integer :: i
    associate (v => space%v, h => space%h, c => space%cosine, s => space%sine)
      do i = 1, k
        h(i, k) = dot(v(:, i), v(:, k + 1))
        v(:, k + 1) = v(:, k + 1) - h(i, k)*v(:, i)
      end do
      h(k + 1, k) = norm(v(:, k + 1))
      v(:, k + 1) = v(:, k + 1)/max(h(k + 1, k), tiny(1.0_rk))
      do i = 1, k - 1
        first = h(i, k)
        h(i, k) = c(i)*first + s(i)*h(i + 1, k)
        h(i + 1, k) = c(i)*h(i + 1, k) - s(i)*first
      end do
      length = max(hypot(h(k, k), h(k + 1, k)), tiny(1.0_rk))
      c(k) = h(k, k)/length
      s(k) = h(k + 1, k)/length
      h(k, k) = length
      space%rest(k + 1) = -s(k)*space%rest(k)
      space%rest(k) = c(k)*space%rest(k)
    end associate
  end subroutine add_to_space

  !> Coefficients of the smallest residual.
  pure subroutine solve_triangle(k, space, y)
    integer, intent(in) :: k
    type(krylov_space), intent(in) :: space
    real(rk), intent(out) :: y(:)
    integer :: i
    y = 0.0_rk
    do i = k, 1, -1
      y(i) = (space%rest(i) - dot_product(space%h(i, i + 1:k), y(i + 1:k)))/space%h(i, i)
    end do
  end subroutine solve_triangle
end module tangent_equations
