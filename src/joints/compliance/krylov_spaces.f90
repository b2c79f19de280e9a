!> Generalised minimal residuals with any preconditioner (flexible GMRES, Saad 1993): orthonormal
!> vectors v, what the preconditioner makes of them, p, and A p in terms of v.
module krylov_spaces
  use global_vectors, only: dot, length
  use kinds, only: rk
  implicit none
  private
  public :: krylov_space, most_steps, start_space, make_room, add_to_space, solve_triangle

  integer, parameter :: most_steps = 100, few_steps = 6

  !> A Krylov space: A p(k) is a combination of v(1..k+1).
  type :: krylov_space
    real(rk), allocatable :: v(:, :), p(:, :) !< (rows, steps + 1) and (rows, steps)
    real(rk), allocatable :: h(:, :) !< (steps + 1, steps) upper triangle after rotations
    real(rk), allocatable :: cosine(:), sine(:), rest(:)
  end type krylov_space

contains

  !> The space of one vector.
  subroutine start_space(b, space)
    real(rk), intent(in) :: b(:)
    type(krylov_space), intent(out) :: space
    integer :: n
    n = size(b)
    allocate (space%v(n, few_steps + 1), space%p(n, few_steps))
    allocate (space%h(most_steps + 1, most_steps), space%cosine(most_steps))
    allocate (space%sine(most_steps), space%rest(most_steps + 1))
    space%rest(1) = length(b)
    space%v(:, 1) = b/space%rest(1)
  end subroutine start_space

  !> Room for the vectors of step k. Most spaces have few of them.
  subroutine make_room(k, space)
    integer, intent(in) :: k
    type(krylov_space), intent(inout) :: space
    real(rk), allocatable :: v(:, :), p(:, :)
    integer :: n, num_steps
    n = size(space%v, 1)
    num_steps = size(space%p, 2)
    if (k <= num_steps) return
    allocate (v(n, 2*num_steps + 1), p(n, 2*num_steps))
    v(:, :num_steps + 1) = space%v
    p(:, :num_steps) = space%p
    call move_alloc(v, space%v)
    call move_alloc(p, space%p)
  end subroutine make_room

  !> Makes v(k+1) orthonormal to the vectors before it and rotates its column of h into a triangle.
  subroutine add_to_space(k, space)
    integer, intent(in) :: k
    type(krylov_space), intent(inout) :: space
    real(rk) :: radius, first
    integer :: i
    associate (v => space%v, h => space%h, c => space%cosine, s => space%sine)
      do i = 1, k
        h(i, k) = dot(v(:, i), v(:, k + 1))
        v(:, k + 1) = v(:, k + 1) - h(i, k)*v(:, i)
      end do
      h(k + 1, k) = length(v(:, k + 1))
      v(:, k + 1) = v(:, k + 1)/max(h(k + 1, k), tiny(1.0_rk))
      do i = 1, k - 1
        first = h(i, k)
        h(i, k) = c(i)*first + s(i)*h(i + 1, k)
        h(i + 1, k) = c(i)*h(i + 1, k) - s(i)*first
      end do
      radius = max(hypot(h(k, k), h(k + 1, k)), tiny(1.0_rk))
      c(k) = h(k, k)/radius
      s(k) = h(k + 1, k)/radius
      h(k, k) = radius
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
end module krylov_spaces
