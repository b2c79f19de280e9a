!> The ports of a reduced model: the jumps at the points of joints, then the paths of the loads.
module reduced_ports
  use errors, only: error_type
  use joint_compliance, only: find_compliance
  use joint_rows, only: num_rows
  use jump_block, only: extract_schur_block, jump_schur_block, schur_compliance
  use kinds, only: rk
  use linear_solver, only: equation_solver
  use run_ledger, only: ledger
  use step_system, only: dam_system
  implicit none
  private
  public :: static_solvers, rows_of, forces_of, find_port_compliance, sample_forces
  public :: solve_blocks, solve_inertial, solve_parts

  !> The factors of a reduced model.
  type :: static_solvers
    class(equation_solver), allocatable :: whole !< of K + s M
    !> Of K + h M with a large h, which holds all that has mass; not allocated where all solids have
    !> mass
    class(equation_solver), allocatable :: held
    type(ledger) :: costs !< a copy that books in the ledger of the run
  end type static_solvers

  integer, parameter :: block_size = 32 !< right-hand sides solved at once

contains

  !> Rows of the ports of a displacement: jumps, then the paths of the loads.
  function rows_of(system, force, x) result(rows)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    real(rk), intent(in) :: x(:) !< (num_free)
    real(rk) :: rows(num_rows(system%operator%num_points) + size(force, 2))
    real(rk) :: full(system%matrix%num_total), jump(3, system%operator%num_points)
    integer :: k
    full = 0.0_rk
    full(:size(x)) = x
    call system%operator%jumps(full, jump)
    rows(:size(jump)) = reshape(jump, [size(jump)])
    do k = 1, size(force, 2)
      rows(size(jump) + k) = dot_product(force(:size(x), k), x)
    end do
  end function rows_of

  !> Some forces of the ports: on joints, or those of the loads without joints.
  pure function sample_forces(system, num_loads, num_samples) result(force)
    type(dam_system), intent(in) :: system
    integer, intent(in) :: num_loads, num_samples
    real(rk), allocatable :: force(:, :) !< (ports, samples)
    integer :: i, k, n
    n = num_rows(system%operator%num_points)
    allocate (force(n + num_loads, num_samples), source=0.0_rk)
    do k = 1, num_samples
      do i = 1, n
        force(i, k) = system%operator%area(1 + (i - 1)/3)*sin(1.7_rk*i*k + k)
      end do
      if (n == 0) force(1 + mod(k - 1, max(1, num_loads - 2)), k) = 1.0_rk
    end do
  end function sample_forces

  !> Forces of the ports on the free unknowns.
  function forces_of(system, loads, rows) result(force)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: loads(:, :) !< (num_total, loads) [N]
    real(rk), intent(in) :: rows(:) !< forces on the joints, then factors of the loads
    real(rk) :: force(system%matrix%num_free)
    real(rk) :: full(system%matrix%num_total), traction(3, system%operator%num_points)
    integer :: n
    n = size(traction)
    traction = reshape(rows(:n), shape(traction))/spread(system%operator%area, 1, 3)
    full = matmul(loads, rows(n + 1:))
    call system%operator%add_forces(traction, full)
    force = full(:size(force))
  end function forces_of

  !> P (K + s M)^-1 P^T, and the responses to the loads.
  subroutine find_port_compliance(system, factor, force, shape, compliance, error)
    type(dam_system), intent(in) :: system
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    real(rk), allocatable, intent(out) :: shape(:, :) !< (num_free, loads) responses [m]
    real(rk), allocatable, intent(out) :: compliance(:, :) !< (ports, ports) [m/N]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: joints(:, :)
    integer :: k, n
    n = num_rows(system%operator%num_points)
    call find_open_compliance(system, factor, joints, error)
    if (allocated(error)) return
    associate (num_loads => size(force, 2))
      allocate (compliance(n + num_loads, n + num_loads))
      compliance(:n, :n) = joints
      shape = force(:system%matrix%num_free, :)
      call solve_blocks(factor, shape, error)
      if (allocated(error)) return
      do k = 1, num_loads
        compliance(:, n + k) = rows_of(system, force, shape(:, k))
        compliance(n + k, :n) = compliance(:n, n + k)
      end do
    end associate
  end subroutine find_port_compliance

  !> B (K + s M)^-1 B^T.
  subroutine find_open_compliance(system, factor, compliance, error)
    type(dam_system), intent(in) :: system
    class(equation_solver), intent(inout) :: factor
    real(rk), allocatable, intent(out) :: compliance(:, :) !< (rows, rows) [m/N]
    type(error_type), allocatable, intent(out) :: error
    type(jump_schur_block) :: jumps
    integer, allocatable :: place(:)
    if (system%operator%num_points == 0) then
      allocate (compliance(0, 0))
      return
    end if
    call extract_schur_block(factor, system%operator, system%matrix, jumps)
    if (jumps%is_there .and. .not. jumps%top%is_there) then
      call schur_compliance(jumps, system%operator, compliance, place)
      compliance = compliance(place, place)
    else
      call find_compliance(factor, system%operator, system%matrix%num_free, compliance, &
                           error)
    end if
  end subroutine find_open_compliance

  !> Responses to forces but for those of massless solids on held ones with mass, in place.
  subroutine solve_inertial(solvers, columns, error)
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(inout) :: columns(:, :) !< (num_free, columns)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: massless(:, :)
    call solve_parts(solvers, columns, massless, error)
    if (allocated(error)) return
    if (allocated(massless)) columns = columns - massless
  end subroutine solve_inertial

  !> Responses to forces, in place, and those of massless solids on held ones with mass.
  subroutine solve_parts(solvers, columns, massless, error)
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(inout) :: columns(:, :) !< (num_free, columns)
    !> (num_free, columns); not allocated where massless solids have no part of their own
    real(rk), allocatable, intent(out) :: massless(:, :)
    type(error_type), allocatable, intent(out) :: error
    if (allocated(solvers%held)) then
      massless = columns
      call solve_blocks(solvers%held, massless, error)
      if (allocated(error)) return
    end if
    call solve_blocks(solvers%whole, columns, error)
  end subroutine solve_parts

  !> Solves for all columns, in place.
  subroutine solve_blocks(factor, columns, error)
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(inout) :: columns(:, :) !< (num_free, columns)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: b(:, :)
    integer :: first, last
    do first = 1, size(columns, 2), block_size
      last = min(first + block_size - 1, size(columns, 2))
      b = columns(:, first:last)
      call factor%solve(b, error)
      if (allocated(error)) return
      columns(:, first:last) = b
    end do
  end subroutine solve_blocks
end module reduced_ports
