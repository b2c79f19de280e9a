!> The motion of a few printed nodes of a reduced model, without a solve in each increment.
module reduced_nodes
  use analysis_state, only: state
  use errors, only: error_type
  use kinds, only: rk
  use node_dofs, only: num_directions, zero_vectors
  use print_kinds, only: prints_of_nodes
  use reduced_basis, only: reduced_model
  use reduced_ports, only: rows_of, solve_parts, static_solvers
  use step_plan, only: print_request, step
  use step_system, only: dam_system
  implicit none
  private
  public :: followed_nodes, find_followed, is_followed

  !> Rows of (7.6) for the displacements of some nodes, three for each.
  type :: followed_nodes
    integer, allocatable :: node(:)
    real(rk), allocatable :: start(:) !< (rows) displacement at the start of the step [m]
    real(rk), allocatable :: mode(:, :) !< (rows, modes) of Phi
    real(rk), allocatable :: port(:, :) !< (rows, columns of P R P^T) of R P^T
  contains
    procedure :: store
  end type followed_nodes

  integer, parameter :: most_nodes = 50 !< of a request: each takes three solves before the step

contains

  !> Whether the nodes of a request are followed: few, and nothing but their motion is printed.
  pure logical function is_followed(request)
    type(print_request), intent(in) :: request
    integer :: i
    is_followed = request%kind == prints_of_nodes .and. size(request%members) <= most_nodes
    do i = 1, size(request%fields)
      is_followed = is_followed .and. any(request%fields(i) == ['U', 'V', 'A'])
    end do
  end function is_followed

  !> Finds the rows of all nodes that are followed.
  subroutine find_followed(plan, system, basis, start, solvers, followed, error)
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    type(reduced_model), intent(in) :: basis
    real(rk), intent(in) :: start(:) !< (num_total) unknowns at the start of the step [m]
    type(static_solvers), intent(inout) :: solvers
    type(followed_nodes), intent(out) :: followed
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: u(:, :), response(:, :), massless(:, :)
    real(rk) :: unit(system%matrix%num_total)
    integer :: k, i, row, n
    n = system%matrix%num_free
    call list_nodes(plan, followed%node)
    associate (num_rows => num_directions*size(followed%node))
      allocate (followed%start(num_rows), response(n, num_rows))
      allocate (followed%mode(num_rows, basis%num_modes))
      allocate (followed%port(num_rows, size(basis%residual, 2)))
    end associate
    u = zero_vectors(system%numbers%num_nodes)
    do k = 1, size(followed%node)
      do i = 1, num_directions
        row = num_directions*(k - 1) + i
        u(i, followed%node(k)) = 1.0_rk
        call system%numbers%reduce(u, unit)
        u(i, followed%node(k)) = 0.0_rk
        followed%start(row) = sum(unit*start)
        followed%mode(row, :) = matmul(unit(:n), basis%mode)
        response(:, row) = unit(:n)
      end do
    end do
    call solve_parts(solvers, response, massless, error)
    if (allocated(error)) return
    associate (port => followed%port, ports => size(basis%path, 1))
      do row = 1, size(followed%start)
        port(row, :ports) = rows_of(system, basis%force, response(:, row)) &
                            - matmul(basis%share, followed%mode(row, :))
        if (.not. allocated(massless)) cycle
        port(row, ports + 1:) = rows_of(system, basis%force, massless(:, row))
        port(row, :ports) = port(row, :ports) - port(row, ports + 1:)
      end do
    end associate
  end subroutine find_followed

  !> The nodes of all requests that are followed.
  subroutine list_nodes(plan, nodes)
    type(step), intent(in) :: plan
    integer, allocatable, intent(out) :: nodes(:)
    integer :: r
    allocate (nodes(0))
    if (.not. allocated(plan%prints)) return
    do r = 1, size(plan%prints)
      if (is_followed(plan%prints(r))) nodes = [nodes, plan%prints(r)%members]
    end do
  end subroutine list_nodes

  !> Stores the motion of the nodes.
  subroutine store(self, now)
    class(followed_nodes), intent(in) :: self
    type(state), intent(inout) :: now
    integer :: shape_of(2)
    if (size(self%node) == 0) return
    shape_of = [num_directions, size(self%node)]
    associate (own => now%motion%modal)
      now%u(:, self%node) = reshape(self%start + matmul(self%mode, own%y) &
                                    + matmul(self%port, own%port), shape_of)
      now%v(:, self%node) = reshape(matmul(self%mode, own%rate) &
                                    + matmul(self%port, own%port_rate), shape_of)
      now%a(:, self%node) = reshape(matmul(self%mode, own%acceleration) &
                                    + matmul(self%port, own%port_acceleration), shape_of)
    end associate
  end subroutine store
end module reduced_nodes
