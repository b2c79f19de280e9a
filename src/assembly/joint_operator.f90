!> The joints as one operator on the unknowns: jumps v = B q in local axes, three rows per point;
!> reduced forces B^T (area t). With jump unknowns a row of B is a single 1.
module joint_operator
  use kinds, only: rk
  use dof_numbering, only: numbering
  use joint_points, only: joint
  use matrix_pattern, only: pattern, add_block
  implicit none
  private
  public :: jump_operator, build_jump_operator, add_joint_stiffness

  !> B by rows. Points of all joints stand one after the other.
  type :: jump_operator
    integer :: num_points = 0
    integer, allocatable :: first_point(:) !< (joints + 1)
    real(rk), allocatable :: area(:) !< (points) [m2]
    integer, allocatable :: row_start(:) !< (3*points + 1); row 3*(point - 1) + 1: opening
    integer, allocatable :: unknown(:) !< ascending in each row
    real(rk), allocatable :: coefficient(:)
  contains
    procedure :: jumps, add_forces
  end type jump_operator

  real(rk), parameter :: roundoff = 1.0e-13_rk !< shapes and rotations are of the order of 1

contains

  !> Makes B from the points of the joints and T.
  subroutine build_jump_operator(numbers, joints, operator)
    type(numbering), intent(in) :: numbers
    type(joint), intent(in) :: joints(:)
    type(jump_operator), intent(out) :: operator
    integer :: j, p
    allocate (operator%first_point(size(joints) + 1))
    operator%first_point(1) = 1
    do j = 1, size(joints)
      operator%first_point(j + 1) = operator%first_point(j) + joints(j)%num_points
    end do
    operator%num_points = operator%first_point(size(joints) + 1) - 1
    allocate (operator%area(operator%num_points), operator%row_start(3*operator%num_points + 1))
    allocate (operator%unknown(9*operator%num_points), operator%coefficient(9*operator%num_points))
    operator%row_start(1) = 1
    do j = 1, size(joints)
      do p = 1, joints(j)%num_points
        operator%area(operator%first_point(j) + p - 1) = joints(j)%area(p)
        call add_point(numbers, joints(j), p, operator%first_point(j) + p - 1, operator)
      end do
    end do
  end subroutine build_jump_operator

  !> The three rows of one point.
  subroutine add_point(numbers, seam, p, point, operator)
    type(numbering), intent(in) :: numbers
    type(joint), intent(in) :: seam
    integer, intent(in) :: p !< point of the joint
    integer, intent(in) :: point !< point of the operator
    type(jump_operator), intent(inout) :: operator
    integer, allocatable :: unknown(:)
    real(rk), allocatable :: b(:, :)
    integer :: i, k, last
    allocate (unknown(0), b(3, 0))
    do k = 1, size(seam%shape, 1)
      call add_node(numbers, seam%slave(k, p), seam%shape(k, p)*seam%rotation(:, :, p), unknown, b)
      call add_node(numbers, seam%master(k, p), -seam%shape(k, p)*seam%rotation(:, :, p), &
                    unknown, b)
    end do
    do i = 1, 3
      last = operator%row_start(3*point - 3 + i) - 1
      do while (last + size(unknown) > size(operator%unknown))
        operator%unknown = [operator%unknown, operator%unknown]
        operator%coefficient = [operator%coefficient, operator%coefficient]
      end do
      do k = 1, size(unknown)
        if (abs(b(i, k)) < roundoff) cycle
        last = last + 1
        operator%unknown(last) = unknown(k)
        operator%coefficient(last) = b(i, k)
      end do
      operator%row_start(3*point - 2 + i) = last + 1
    end do
  end subroutine add_point

  !> Adds matrix*u(node), u through T, to the columns of b; unknowns stay ascending.
  subroutine add_node(numbers, node, matrix, unknown, b)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: node
    real(rk), intent(in) :: matrix(3, 3)
    integer, allocatable, intent(inout) :: unknown(:)
    real(rk), allocatable, intent(inout) :: b(:, :) !< (3, unknowns)
    integer :: i, k, place
    do i = 1, 3
      do k = numbers%row_start(3*node - 3 + i), numbers%row_start(3*node - 2 + i) - 1
        place = count(unknown < numbers%unknown(k)) + 1
        if (.not. any(unknown == numbers%unknown(k))) then
          unknown = [unknown(:place - 1), numbers%unknown(k), unknown(place:)]
          b = reshape([b(:, :place - 1), spread(0.0_rk, 1, 3), b(:, place:)], [3, size(unknown)])
        end if
        b(:, place) = b(:, place) + matrix(:, i)*numbers%coefficient(k)
      end do
    end do
  end subroutine add_node

  !> v = B q.
  pure subroutine jumps(self, q, v)
    class(jump_operator), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(out) :: v(:, :) !< (3, points) [m]
    integer :: p, i, k
    v = 0.0_rk
    do p = 1, self%num_points
      do i = 1, 3
        do k = self%row_start(3*p - 3 + i), self%row_start(3*p - 2 + i) - 1
          v(i, p) = v(i, p) + self%coefficient(k)*q(self%unknown(k))
        end do
      end do
    end do
  end subroutine jumps

  !> r = r + B^T (area t).
  pure subroutine add_forces(self, traction, r)
    class(jump_operator), intent(in) :: self
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    real(rk), intent(inout) :: r(:) !< (num_total) [N]
    integer :: p, i, k
    do p = 1, self%num_points
      do i = 1, 3
        do k = self%row_start(3*p - 3 + i), self%row_start(3*p - 2 + i) - 1
          r(self%unknown(k)) = r(self%unknown(k)) &
                               + self%coefficient(k)*self%area(p)*traction(i, p)
        end do
      end do
    end do
  end subroutine add_forces

  !> Adds B^T (area D) B. In a symmetric matrix the symmetric part of D counts.
  subroutine add_joint_stiffness(operator, tangent, matrix, values)
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: tangent(:, :, :) !< (3, 3, points) D [Pa/m]
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer, allocatable :: unknown(:)
    real(rk), allocatable :: b(:, :)
    real(rk) :: d(3, 3)
    integer :: p
    do p = 1, operator%num_points
      d = tangent(:, :, p)
      if (matrix%is_symmetric) d = 0.5_rk*(d + transpose(d))
      call gather_point(operator, p, unknown, b)
      call add_block(matrix, unknown, &
                     operator%area(p)*matmul(transpose(b), matmul(d, b)), values)
    end do
  end subroutine add_joint_stiffness

  !> The rows of a point as a dense matrix on the unknowns that it touches.
  subroutine gather_point(operator, p, unknown, b)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: p
    integer, allocatable, intent(out) :: unknown(:) !< ascending
    real(rk), allocatable, intent(out) :: b(:, :) !< (3, unknowns)
    integer :: i, k, smallest
    allocate (unknown(0))
    smallest = 0
    do
      associate (all => operator%unknown(operator%row_start(3*p - 2): &
                                         operator%row_start(3*p + 1) - 1))
        if (.not. any(all > smallest)) exit
        smallest = minval(all, all > smallest)
      end associate
      unknown = [unknown, smallest]
    end do
    allocate (b(3, size(unknown)))
    b = 0.0_rk
    do i = 1, 3
      do k = operator%row_start(3*p - 3 + i), operator%row_start(3*p - 2 + i) - 1
        b(i, count(unknown <= operator%unknown(k))) = operator%coefficient(k)
      end do
    end do
  end subroutine gather_point
end module joint_operator
