!> The shapes of a reduced model: what loads and inertia move in the structure with open, with
!> sliding and with closed joints, together (theory.md, 7.4). Shapes of open joints alone describe
!> closed joints by static responses without mass, which takes many shapes.
!>
!> For each state of the joints they span the block Krylov space of K^-1 M that starts with the
!> static responses to the loads (Wilson, Yuan & Dickens 1982).
module reduced_shapes
  use equilibrium, only: equilibrium_solver
  use errors, only: error_type
  use global_vectors, only: multiply
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use kinds, only: rk
  use problem_definition, only: problem
  use step_system, only: dam_system
  implicit none
  private
  public :: find_shapes

  !> A shape whose part beyond the others is less than this of its own size is left out.
  real(rk), parameter :: least_part = 1.0e-5_rk

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
    real(rk), intent(inout) :: shapes(:, :)
    integer, intent(inout) :: num_shapes
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: block(:, :)
    real(rk), dimension(system%matrix%num_total) :: x, product
    integer :: k, last, first
    logical :: is_new
    last = num_shapes + num_new
    block = loads
    x = 0.0_rk
    do while (num_shapes < last .and. size(block, 2) > 0)
      call solver%factor%solve(block, error)
      if (allocated(error)) return
      first = num_shapes + 1
      do k = 1, size(block, 2)
        if (num_shapes == last) exit
        shapes(:, num_shapes + 1) = block(:, k)
        call orthonormalise(system, shapes(:, :num_shapes), shapes(:, num_shapes + 1), is_new)
        if (is_new) num_shapes = num_shapes + 1
      end do
      block = shapes(:, first:num_shapes)
      do k = 1, size(block, 2)
        x(:size(block, 1)) = block(:, k)
        call multiply(system%mass_pattern, system%mass_entries, x, product)
        block(:, k) = product(:size(block, 1))
      end do
    end do
  end subroutine add_krylov

  !> Makes a shape orthogonal to the others with M, twice against round-off, and its size one.
  subroutine orthonormalise(system, others, shape, is_new)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: others(:, :)
    real(rk), intent(inout) :: shape(:)
    logical, intent(out) :: is_new !< it has a part beyond the others
    real(rk), dimension(system%matrix%num_total) :: x, product
    real(rk) :: length, rest
    integer :: pass
    x = 0.0_rk
    call find_length(length)
    is_new = length > 0.0_rk
    if (.not. is_new) return
    shape = shape/length
    product = product/length
    do pass = 1, 2
      shape = shape - matmul(others, matmul(product(:size(shape)), others))
      call find_length(rest)
      if (pass == 1) is_new = rest > least_part
      if (.not. is_new) return
      shape = shape/rest
      product = product/rest
    end do
  contains
    !> The size of the shape with M, and M times the shape.
    subroutine find_length(length)
      real(rk), intent(out) :: length
      x(:size(shape)) = shape
      call multiply(system%mass_pattern, system%mass_entries, x, product)
      length = sqrt(max(0.0_rk, dot_product(shape, product(:size(shape)))))
    end subroutine find_length
  end subroutine orthonormalise
end module reduced_shapes
