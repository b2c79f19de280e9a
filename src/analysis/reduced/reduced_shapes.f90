!> The shapes of a reduced model: what loads and inertia move in the structure with open, with
!> sliding and with closed joints, together (theory.md, 7.4). Shapes of open joints alone describe
!> closed joints by static responses without mass, which takes many shapes.
!>
!> For each state of the joints they span the block Krylov space of K^-1 M that starts with the
!> static responses to the loads (Wilson, Yuan & Dickens 1982). They are measured by the stiffness:
!> where rock has no mass, a shape of little mass would be large there, if its mass were one.
module reduced_shapes
  use column_products, only: multiply_columns
  use errors, only: error_type
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use kinds, only: rk
  use problem_definition, only: problem
  use reduced_ports, only: static_solvers
  use shape_modes, only: find_shape_modes
  use shape_orthogonality, only: orthonormalise
  use step_system, only: dam_system
  implicit none
  private
  public :: find_shapes

  !> The largest shift over the smallest one. Between them it is the lowest squared frequency of the
  !> dam with closed joints. The larger the shift, the less round-off is in the responses of blocks
  !> which only joints hold.
  real(rk), parameter :: largest_shift = 1.0e4_rk

contains

  !> Finds the shapes, orthonormal with K and a small shift. The solver `whole` then
  !> holds the factor of K + s M.
  subroutine find_shapes(model, system, loads, num_wanted, solvers, shapes, shift, error)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: loads(:, :) !< (num_free, loads) [N]
    integer, intent(in) :: num_wanted
    type(static_solvers), intent(inout) :: solvers
    real(rk), allocatable, intent(out) :: shapes(:, :) !< (num_free, shapes)
    real(rk), intent(inout) :: shift !< s, on entry the smallest one [1/s2]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: k_ref(:, :), values(:), measure(:)
    real(rk) :: smallest
    integer :: state, num_states, num_shapes
    num_states = merge(3, 1, system%operator%num_points > 0)
    allocate (shapes(system%matrix%num_free, num_wanted))
    num_shapes = 0
    smallest = shift
    measure = system%stiffness + shift*system%mass
    call reference_stiffness(model%joints, system%operator, k_ref)
    do state = num_states, 1, -1
      values = system%stiffness + shift*system%mass
      if (state == 2) k_ref(2:3, :) = 0.0_rk
      if (state > 1) call system%operator%add_stiffness(closed_tangent(k_ref), system%matrix, &
                                                        values)
      call solvers%costs%start('factor', 'structure', 'solver')
      call solvers%whole%factorise(system%matrix, values, error)
      call solvers%costs%stop()
      if (allocated(error)) return
      call solvers%costs%start('solve', 'shapes', 'solver')
      call add_krylov(system, measure, loads, (num_wanted - num_shapes)/state, solvers, shapes, &
                      num_shapes, error)
      call solvers%costs%stop()
      if (allocated(error)) return
      if (state > 1 .and. state == num_states) then
        shift = lowest_frequency(system, values, shapes(:, :num_shapes)) - smallest
        shift = min(max(shift, smallest), largest_shift*smallest)
      end if
    end do
    shapes = shapes(:, :num_shapes)
  end subroutine find_shapes

  !> The lowest squared circular frequency of some shapes.
  real(rk) function lowest_frequency(system, stiffness, shapes) result(lowest)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: stiffness(:) !< values of K
    real(rk), intent(in) :: shapes(:, :) !< (num_free, shapes)
    type(error_type), allocatable :: error
    real(rk), allocatable :: rotation(:, :), frequency(:)
    call find_shape_modes(system, stiffness, shapes, frequency, rotation, error)
    lowest = 0.0_rk
    if (allocated(error)) return
    if (size(frequency) > 0) lowest = frequency(1)
  end function lowest_frequency

  !> Adds shapes of one state of the joints.
  subroutine add_krylov(system, measure, loads, num_new, solvers, shapes, num_shapes, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: measure(:) !< values of the stiffness that measures shapes
    real(rk), intent(in) :: loads(:, :) !< (num_free, loads) [N]
    integer, intent(in) :: num_new
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(inout), contiguous :: shapes(:, :)
    integer, intent(inout) :: num_shapes
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: block(:, :), force(:, :)
    integer :: last, num_taken
    last = num_shapes + num_new
    force = loads
    do while (num_shapes < last .and. size(force, 2) > 0)
      call move_alloc(force, block)
      call solvers%whole%solve(block, error)
      if (allocated(error)) return
      call orthonormalise(system, measure, shapes(:, :num_shapes), block)
      num_taken = min(size(block, 2), last - num_shapes)
      shapes(:, num_shapes + 1:num_shapes + num_taken) = block(:, :num_taken)
      num_shapes = num_shapes + num_taken
      allocate (force(size(block, 1), num_taken))
      call multiply_columns(system%mass_pattern, system%mass_entries, block(:, :num_taken), force)
    end do
  end subroutine add_krylov
end module reduced_shapes
