!> Adds small matrices of physical dofs to the matrices of unknowns: values + T^T k T.
module scatter_matrix
  use kinds, only: rk
  use node_dofs, only: num_directions
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern, add_block, add_triples
  use sorted_lists, only: sorted_unique, place_in
  implicit none
  private
  public :: scatter_nodes, scatter_blocks

contains

  !> Adds a symmetric matrix on the displacements of some nodes, ordered node by node.
  subroutine scatter_nodes(numbers, nodes, k, matrix, values)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: nodes(:)
    real(rk), intent(in) :: k(:, :) !< (directions*nodes, directions*nodes)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer, dimension(num_directions*size(nodes)) :: dof, unknown, place
    integer, dimension(size(nodes)) :: first, order
    logical :: is_independent, has_triples
    call find_triples(numbers, nodes, matrix, first, order, has_triples)
    if (has_triples) then
      call add_triples(matrix, first, order, k, values)
      return
    end if
    dof = numbers%dofs%displacements_of(nodes)
    call find_independent(numbers, dof, unknown, place, is_independent)
    if (is_independent) then
      call add_block(matrix, unknown, k(place, place), values)
    else
      call scatter_general(numbers, dof, k, matrix, values)
    end if
  end subroutine scatter_nodes

  !> Adds a symmetric block for each node. The nodes are not coupled.
  subroutine scatter_blocks(numbers, blocks, matrix, values)
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: blocks(:, :, :) !< (directions, directions, nodes)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer :: node
    do node = 1, size(blocks, 3)
      if (maxval(abs(blocks(:, :, node))) > 0.0_rk) then
        call scatter_nodes(numbers, [node], blocks(:, :, node), matrix, values)
      end if
    end do
  end subroutine scatter_blocks

  !> The usual case: the displacements of each node are three unknowns that follow each other, and
  !> no node repeats. Sorts the nodes by their unknowns.
  pure subroutine find_triples(numbers, nodes, matrix, first, order, has_triples)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: nodes(:)
    type(pattern), intent(in) :: matrix
    integer, intent(out) :: first(:) !< first unknown of each node, ascending
    integer, intent(out) :: order(:) !< position of each node in `nodes`
    logical, intent(out) :: has_triples
    integer :: a, k, row, dof
    has_triples = matrix%is_symmetric .and. allocated(matrix%alike)
    if (.not. has_triples) return
    do a = 1, size(nodes)
      dof = numbers%dofs%dof_of(nodes(a), 1)
      row = numbers%row_start(dof)
      has_triples = all(numbers%row_start(dof + 1:dof + num_directions) - row == [1, 2, 3])
      if (.not. has_triples) return
      has_triples = all(numbers%unknown(row:row + 2) - numbers%unknown(row) == [0, 1, 2]) &
                    .and. all(abs(numbers%coefficient(row:row + 2) - 1.0_rk) < epsilon(1.0_rk))
      if (.not. has_triples) return
      has_triples = matrix%alike(numbers%unknown(row)) >= num_directions
      if (.not. has_triples) return
      do k = a - 1, 1, -1
        if (first(k) <= numbers%unknown(row)) exit
        first(k + 1) = first(k)
        order(k + 1) = order(k)
      end do
      first(k + 1) = numbers%unknown(row)
      order(k + 1) = a
    end do
    has_triples = all(first(2:) > first(:size(first) - 1))
  end subroutine find_triples

  !> Every dof is an independent unknown, each once. Sorts the unknowns.
  pure subroutine find_independent(numbers, dof, unknown, place, is_independent)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: dof(:)
    integer, intent(out) :: unknown(:) !< ascending
    integer, intent(out) :: place(:) !< position of each among the dofs
    logical, intent(out) :: is_independent
    integer :: i, k, row
    is_independent = .true.
    do i = 1, size(dof)
      row = numbers%row_start(dof(i))
      is_independent = numbers%row_start(dof(i) + 1) == row + 1
      if (is_independent) is_independent = abs(numbers%coefficient(row) - 1.0_rk) < epsilon(1.0_rk)
      if (.not. is_independent) return
      do k = i - 1, 1, -1
        if (unknown(k) <= numbers%unknown(row)) exit
        unknown(k + 1) = unknown(k)
        place(k + 1) = place(k)
      end do
      unknown(k + 1) = numbers%unknown(row)
      place(k + 1) = i
    end do
    is_independent = all(unknown(2:) > unknown(:size(unknown) - 1))
  end subroutine find_independent

  !> Adds a matrix with dependent dofs or repeated nodes (wedges).
  subroutine scatter_general(numbers, dof, k, matrix, values)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: dof(:)
    real(rk), intent(in) :: k(:, :)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer, allocatable :: unknown(:), first(:), place(:)
    real(rk), allocatable :: coefficient(:), block(:, :)
    real(rk) :: factor
    integer :: i, j, a, b
    call gather_rows(numbers, dof, unknown, first, place, coefficient)
    allocate (block(size(unknown), size(unknown)), source=0.0_rk)
    do j = 1, size(dof)
      do b = first(j), first(j + 1) - 1
        do i = 1, size(dof)
          factor = coefficient(b)*k(i, j)
          if (.not. abs(factor) > 0.0_rk) cycle
          do a = first(i), first(i + 1) - 1
            block(place(a), place(b)) = block(place(a), place(b)) + factor*coefficient(a)
          end do
        end do
      end do
    end do
    call add_block(matrix, unknown, block, values)
  end subroutine scatter_general

  !> The rows of T of these dofs, over the unknowns in these rows.
  subroutine gather_rows(numbers, dof, unknown, first, place, coefficient)
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: dof(:)
    integer, allocatable, intent(out) :: unknown(:) !< ascending
    integer, allocatable, intent(out) :: first(:) !< (dofs + 1) of each row
    integer, allocatable, intent(out) :: place(:) !< among the unknowns, of each term
    real(rk), allocatable, intent(out) :: coefficient(:) !< of each term
    integer, allocatable :: term(:)
    integer :: i, k, length
    allocate (first(size(dof) + 1))
    first(1) = 1
    do i = 1, size(dof)
      first(i + 1) = first(i) + numbers%row_start(dof(i) + 1) - numbers%row_start(dof(i))
    end do
    allocate (term(first(size(dof) + 1) - 1), coefficient(first(size(dof) + 1) - 1))
    do i = 1, size(dof)
      k = numbers%row_start(dof(i))
      length = first(i + 1) - first(i)
      term(first(i):first(i + 1) - 1) = numbers%unknown(k:k + length - 1)
      coefficient(first(i):first(i + 1) - 1) = numbers%coefficient(k:k + length - 1)
    end do
    unknown = sorted_unique(term)
    allocate (place(size(term)))
    do i = 1, size(term)
      place(i) = place_in(unknown, term(i))
    end do
  end subroutine gather_rows
end module scatter_matrix
