!> The shapes of a reduced model: what loads and inertia move in the structure with open, with
!> sliding and with closed joints, together (theory.md, 7.4). Shapes of open joints alone describe
!> closed joints by static responses without mass, which takes many shapes.
!>
!> For each state of the joints they span the block Krylov space of K^-1 M that starts with the
!> static responses to the loads (Wilson, Yuan & Dickens 1982).
module reduced_shapes
  use column_products, only: multiply_columns
  use dense_products, only: subtract_times, transposed_times
  use equilibrium, only: equilibrium_solver
  use errors, only: error_type
  use global_vectors, only: dot
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use kinds, only: rk
  use problem_definition, only: problem
  use step_system, only: dam_system
  implicit none
  private
  public :: find_shapes

  !> A shape whose part beyond the others is less than this of its own size is left out, and one
  !> that loses half of this part when it is made orthogonal again: the part is round-off.
  real(rk), parameter :: least_part = 1.0e-9_rk, least_rest = 0.5_rk

contains

  !> Finds the shapes, orthonormal with M. The solver then holds the factor of K + s M.
  subroutine find_shapes(model, system, shifted, loads, num_wanted, solver, shapes, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: shifted(:) !< values of K + s M
    real(rk), intent(in) :: loads(:, :) !< (num_free, loads) [N]
    integer, intent(in) :: num_wanted
    class(equilibrium_solver), intent(inout) :: solver
    real(rk), allocatable, intent(out) :: shapes(:, :) !< (num_free, shapes)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: k_ref(:, :), values(:)
    integer :: state, num_states, num_shapes
    num_states = merge(3, 1, system%operator%num_points > 0)
    allocate (shapes(system%matrix%num_free, num_wanted))
    num_shapes = 0
    call reference_stiffness(model%joints, system%operator, k_ref)
    do state = num_states, 1, -1
      values = shifted
      if (state == 2) k_ref(2:3, :) = 0.0_rk
      if (state > 1) call system%operator%add_stiffness(closed_tangent(k_ref), system%matrix, &
                                                        values)
      call solver%costs%start('factor', 'structure', 'solver')
      call solver%factor%factorise(system%matrix, values, error)
      call solver%costs%stop()
      if (allocated(error)) return
      call solver%costs%start('solve', 'shapes', 'solver')
      call add_krylov(system, loads, (num_wanted - num_shapes)/state, solver, shapes, num_shapes, &
                      error)
      call solver%costs%stop()
      if (allocated(error)) return
    end do
    shapes = shapes(:, :num_shapes)
  end subroutine find_shapes

  !> Adds shapes of one state of the joints.
  subroutine add_krylov(system, loads, num_new, solver, shapes, num_shapes, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: loads(:, :) !< (num_free, loads) [N]
    integer, intent(in) :: num_new
    class(equilibrium_solver), intent(inout) :: solver
    real(rk), intent(inout), contiguous :: shapes(:, :)
    integer, intent(inout) :: num_shapes
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: block(:, :), product(:, :)
    integer :: last, num_taken
    last = num_shapes + num_new
    block = loads
    do while (num_shapes < last .and. size(block, 2) > 0)
      call solver%factor%solve(block, error)
      if (allocated(error)) return
      call orthonormalise(system, shapes(:, :num_shapes), block, product)
      num_taken = min(size(block, 2), last - num_shapes)
      shapes(:, num_shapes + 1:num_shapes + num_taken) = block(:, :num_taken)
      num_shapes = num_shapes + num_taken
      block = product(:, :num_taken)
    end do
  end subroutine add_krylov

  !> Makes the shapes of a block orthogonal to the others and to each other with M, twice against
  !> round-off, and their size one. Shapes without a part beyond the others are taken out.
  subroutine orthonormalise(system, others, block, product)
    type(dam_system), intent(in) :: system
    real(rk), intent(in), contiguous :: others(:, :) !< (num_free, shapes)
    real(rk), allocatable, intent(inout) :: block(:, :) !< (num_free, shapes)
    real(rk), allocatable, intent(out) :: product(:, :) !< M times the block
    real(rk) :: length(size(block, 2))
    integer :: pass, k
    allocate (product, mold=block)
    call multiply_columns(system%mass_pattern, system%mass_entries, block, product)
    do k = 1, size(length)
      length(k) = sqrt(max(0.0_rk, dot(block(:, k), product(:, k))))
      if (.not. length(k) > 0.0_rk) cycle
      block(:, k) = block(:, k)/length(k)
      product(:, k) = product(:, k)/length(k)
    end do
    do pass = 1, 2
      call subtract_times(others, transposed_times(others, product), block)
      call multiply_columns(system%mass_pattern, system%mass_entries, block, product)
      call separate(merge(least_part, least_rest, pass == 1), block, product)
    end do
  end subroutine orthonormalise

  !> Makes the shapes of a block orthogonal to each other and their size one. Those that are not
  !> longer than `least` then are taken out.
  subroutine separate(least, block, product)
    real(rk), intent(in) :: least
    real(rk), allocatable, intent(inout) :: block(:, :), product(:, :) !< and M times the block
    real(rk) :: length
    integer :: k, j, n
    n = 0
    do k = 1, size(block, 2)
      do j = 1, n
        associate (part => dot(product(:, j), block(:, k)))
          block(:, k) = block(:, k) - part*block(:, j)
          product(:, k) = product(:, k) - part*product(:, j)
        end associate
      end do
      length = sqrt(max(0.0_rk, dot(block(:, k), product(:, k))))
      if (.not. length > least) cycle
      n = n + 1
      block(:, n) = block(:, k)/length
      product(:, n) = product(:, k)/length
    end do
    block = block(:, :n)
    product = product(:, :n)
  end subroutine separate
end module reduced_shapes
