!> All joints as one operator on the unknowns: jumps v = B q in local axes, three rows per point,
!> and forces B^T (area t). At a point with jump unknowns d the rows of B are those of v = d.
module joint_operator
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use guest_list, only: is_guest_here
  use joint_parts, only: point_is_there
  use joint_points, only: dam_joint
  use node_dofs, only: num_directions
  use joint_rows, only: num_axes, num_rows, row_of
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use joint_stiffness, only: add_joint_stiffness
  implicit none
  private
  public :: jump_operator, build_jump_operator, joint_springs

  !> B by rows, points of all joints one after the other.
  type :: jump_operator
    integer :: num_points = 0
    integer, allocatable :: first_point(:) !< (joints + 1)
    real(rk), allocatable :: area(:) !< (points) [m2]
    logical, allocatable :: is_here(:) !< (points) the matrices of the joint are of this rank
    real(rk), allocatable :: x(:, :) !< (3, points) [m]
    integer, allocatable :: row_start(:) !< (rows + 1) rows as in `joint_rows`
    integer, allocatable :: unknown(:) !< columns of B
    real(rk), allocatable :: coefficient(:) !< values of B
  contains
    procedure :: jumps, add_forces, add_stiffness
  end type jump_operator

contains

  !> Builds B from the points of the joints and T. Points are counted through all nodal
  !> joints, as in the numbering's `first_jump`.
  subroutine build_jump_operator(numbers, mesh, joints, operator)
    type(numbering), intent(in) :: numbers
    type(fe_mesh), intent(in) :: mesh !< a point with an absent element has empty rows
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(out) :: operator
    integer, allocatable :: place(:)
    integer :: j, p, pair, point, last_row
    allocate (operator%first_point(size(joints) + 1))
    operator%first_point(1) = 1
    do j = 1, size(joints)
      operator%first_point(j + 1) = operator%first_point(j) + joints(j)%num_points
    end do
    operator%num_points = operator%first_point(size(joints) + 1) - 1
    last_row = num_rows(operator%num_points)
    allocate (operator%area(operator%num_points), operator%row_start(last_row + 1))
    allocate (operator%x(3, operator%num_points), operator%is_here(operator%num_points))
    allocate (operator%unknown(9*operator%num_points), operator%coefficient(9*operator%num_points))
    allocate (place(merge(numbers%num_total, 0, operator%num_points > 0)), source=0)
    operator%row_start = 1
    pair = 0
    do j = 1, size(joints)
      do p = 1, joints(j)%num_points
        if (joints(j)%is_nodal) pair = pair + 1
        point = operator%first_point(j) + p - 1
        operator%area(point) = joints(j)%area(p)
        operator%is_here(point) = is_guest_here(j)
        operator%x(:, point) = joints(j)%x(:, p)
        if (.not. point_is_there(mesh, joints(j), p)) then
          operator%row_start(row_of(point, 1) + 1:row_of(point, num_axes) + 1) = &
            operator%row_start(row_of(point, 1))
          cycle
        end if
        call add_rows(joints(j), p, merge(pair, 0, joints(j)%is_nodal), numbers, point, place, &
                      operator)
      end do
    end do
    operator%unknown = operator%unknown(:operator%row_start(last_row + 1) - 1)
    operator%coefficient = operator%coefficient(:size(operator%unknown))
  end subroutine build_jump_operator

  !> The three rows of B of one point.
  subroutine add_rows(joint, p, pair, numbers, point, place, operator)
    type(dam_joint), intent(in) :: joint
    integer, intent(in) :: p !< point of the joint
    integer, intent(in) :: pair !< among the points of nodal joints, 0 for none
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: point !< of the operator
    integer, intent(inout) :: place(:) !< (unknowns) work space, all zero
    type(jump_operator), intent(inout) :: operator
    integer :: i, jump, row, next
    jump = 0
    if (pair > 0) jump = numbers%first_jump(pair)
    do i = 1, num_axes
      row = row_of(point, i)
      next = operator%row_start(row)
      if (jump > 0) then
        call add_term(jump + i - 1, 1.0_rk)
      else
        call add_faces(joint%rotation(i, :, p))
      end if
      operator%row_start(row + 1) = next
      place(operator%unknown(operator%row_start(row):next - 1)) = 0
    end do
  contains
    !> Slave minus master along one local axis.
    subroutine add_faces(axis)
      real(rk), intent(in) :: axis(3)
      integer :: k, direction
      do k = joint%first(p), joint%first(p + 1) - 1
        do direction = 1, num_directions
          call add_dof(joint%node(k), direction, axis(direction)*joint%weight(k))
        end do
      end do
    end subroutine add_faces

    !> One physical dof through its unknowns.
    subroutine add_dof(node, direction, factor)
      integer, intent(in) :: node, direction
      real(rk), intent(in) :: factor
      integer :: k, dof
      if (.not. abs(factor) > 0.0_rk) return
      dof = numbers%dofs%dof_of(node, direction)
      do k = numbers%row_start(dof), numbers%row_start(dof + 1) - 1
        call add_term(numbers%unknown(k), factor*numbers%coefficient(k))
      end do
    end subroutine add_dof

    !> Adds to the current row.
    subroutine add_term(column, value)
      integer, intent(in) :: column
      real(rk), intent(in) :: value
      if (place(column) > 0) then
        operator%coefficient(place(column)) = operator%coefficient(place(column)) + value
        return
      end if
      if (next > size(operator%unknown)) then
        operator%unknown = [operator%unknown, spread(0, 1, next)]
        operator%coefficient = [operator%coefficient, spread(0.0_rk, 1, next)]
      end if
      operator%unknown(next) = column
      operator%coefficient(next) = value
      place(column) = next
      next = next + 1
    end subroutine add_term
  end subroutine add_rows

  !> Compliance of the joints' own springs, 1/(weight*area*k_ref).
  pure function joint_springs(operator, k_ref, weight) result(spring)
    type(jump_operator), intent(in) :: operator
    real(rk), intent(in) :: k_ref(:, :) !< (3, points) [Pa/m]
    real(rk), intent(in) :: weight !< of the joint forces
    real(rk) :: spring(num_rows(operator%num_points)) !< (rows) [m/N]
    spring = reshape(1.0_rk/(weight*spread(operator%area, 1, num_axes)*k_ref), shape(spring))
  end function joint_springs

  !> v = B q.
  pure subroutine jumps(self, q, v)
    class(jump_operator), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total)
    real(rk), intent(out) :: v(:, :) !< (3, points) [m]
    integer :: p, i, k, row
    v = 0.0_rk
    row = 0
    do p = 1, self%num_points
      do i = 1, num_axes
        row = row + 1
        do k = self%row_start(row), self%row_start(row + 1) - 1
          v(i, p) = v(i, p) + self%coefficient(k)*q(self%unknown(k))
        end do
      end do
    end do
  end subroutine jumps

  !> f = f + B^T (area t).
  pure subroutine add_forces(self, traction, f)
    class(jump_operator), intent(in) :: self
    real(rk), intent(in) :: traction(:, :) !< (3, points) [Pa]
    real(rk), intent(inout) :: f(:) !< (num_total) [N]
    integer :: p, i, k, row
    row = 0
    do p = 1, self%num_points
      do i = 1, num_axes
        row = row + 1
        do k = self%row_start(row), self%row_start(row + 1) - 1
          f(self%unknown(k)) = f(self%unknown(k)) &
                               + self%coefficient(k)*self%area(p)*traction(i, p)
        end do
      end do
    end do
  end subroutine add_forces

  !> Adds B^T (area D) B to a matrix of the step.
  subroutine add_stiffness(self, tangent, matrix, values)
    class(jump_operator), intent(in) :: self
    real(rk), intent(in) :: tangent(:, :, :) !< (3, 3, points) D [Pa/m]
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    call add_joint_stiffness(self%row_start, self%unknown, self%coefficient, self%area, &
                             self%is_here, tangent, matrix, values)
  end subroutine add_stiffness
end module joint_operator
