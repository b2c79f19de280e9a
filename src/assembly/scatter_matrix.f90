!> Adds small matrices of physical dofs to the matrices of unknowns: values + T^T k T.
module scatter_matrix
  use kinds, only: rk
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern, add_block
  implicit none
  private
  public :: scatter_nodes

contains

  !> Adds a symmetric matrix on the dofs of some nodes, ordered node by node.
  subroutine scatter_nodes(numbers, nodes, k, matrix, values)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: nodes(:)
    real(rk), intent(in) :: k(:, :) !< (3*nodes, 3*nodes)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer :: dof(3*size(nodes)), unknown(3*size(nodes)), place(3*size(nodes)), a
    logical :: is_plain
    do a = 1, size(nodes)
      dof(3*a - 2:3*a) = 3*nodes(a) + [-2, -1, 0]
    end do
    call find_plain(numbers, dof, unknown, place, is_plain)
    if (is_plain) then
      call add_block(matrix, unknown, k(place, place), values)
    else
      call scatter_general(numbers, dof, k, matrix, values)
    end if
  end subroutine scatter_nodes

  !> The usual case: every dof is an unknown of its own, each once. Sorts them.
  pure subroutine find_plain(numbers, dof, unknown, place, is_plain)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: dof(:)
    integer, intent(out) :: unknown(:) !< ascending
    integer, intent(out) :: place(:) !< position of each among the dofs
    logical, intent(out) :: is_plain
    integer :: i, k, row
    is_plain = .true.
    do i = 1, size(dof)
      row = numbers%row_start(dof(i))
      is_plain = numbers%row_start(dof(i) + 1) == row + 1
      if (is_plain) is_plain = abs(numbers%coefficient(row) - 1.0_rk) < epsilon(1.0_rk)
      if (.not. is_plain) return
      do k = i - 1, 1, -1
        if (unknown(k) <= numbers%unknown(row)) exit
        unknown(k + 1) = unknown(k)
        place(k + 1) = place(k)
      end do
      unknown(k + 1) = numbers%unknown(row)
      place(k + 1) = i
    end do
    is_plain = all(unknown(2:) > unknown(:size(unknown) - 1))
  end subroutine find_plain

  !> With dependent dofs, or nodes that come twice (wedges).
  subroutine scatter_general(numbers, dof, k, matrix, values)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: dof(:)
    real(rk), intent(in) :: k(:, :)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer, allocatable :: unknown(:)
    real(rk), allocatable :: t(:, :)
    call gather_rows(numbers, dof, unknown, t)
    call add_block(matrix, unknown, matmul(transpose(t), matmul(k, t)), values)
  end subroutine scatter_general

  !> The rows of T of these dofs as a dense matrix.
  subroutine gather_rows(numbers, dof, unknown, t)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: dof(:)
    integer, allocatable, intent(out) :: unknown(:) !< ascending
    real(rk), allocatable, intent(out) :: t(:, :) !< (dofs, unknowns)
    integer :: i, k, place
    allocate (unknown(0))
    do i = 1, size(dof)
      do k = numbers%row_start(dof(i)), numbers%row_start(dof(i) + 1) - 1
        if (any(unknown == numbers%unknown(k))) cycle
        place = count(unknown < numbers%unknown(k))
        unknown = [unknown(:place), numbers%unknown(k), unknown(place + 1:)]
      end do
    end do
    allocate (t(size(dof), size(unknown)))
    t = 0.0_rk
    do i = 1, size(dof)
      do k = numbers%row_start(dof(i)), numbers%row_start(dof(i) + 1) - 1
        t(i, count(unknown <= numbers%unknown(k))) = numbers%coefficient(k)
      end do
    end do
  end subroutine gather_rows
end module scatter_matrix
