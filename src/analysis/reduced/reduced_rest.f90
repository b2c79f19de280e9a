!> The static responses of the ports that the shapes of a reduced model leave out (theory.md, 7.4),
!>   S = (I - Psi Psi^T M) K^-1 P^T,  K the stiffness with the shift.
!>
!> Where the shapes leave little of the structure, columns of S depend on each other or are
!> round-off. Those that are neither are kept, S_k, by Cholesky's factor of S_k^T K S_k. The
!> compliance of the rest, R = (S_k^T P^T)^T (S_k^T K S_k)^-1 (S_k^T P^T), is then never negative.
module reduced_rest
  use column_products, only: multiply_columns
  use dense_products, only: times, transposed_times
  use errors, only: error_type
  use kinds, only: rk
  use pivoted_cholesky, only: factorise_kept, pivoted_factor, solve_half, solve_rest
  use reduced_ports, only: forces_of, rows_of, solve_blocks, solve_inertial, static_solvers
  use step_system, only: dam_system
  implicit none
  private
  public :: static_rest, find_rest, separate_shapes, rest_compliance, rest_response

  type :: static_rest
    integer :: left_out = 0 !< port whose response is round-off; 0 for none
    type(pivoted_factor) :: factor !< of S_k^T K S_k
    real(rk), allocatable :: seen(:, :) !< (kept, ports) S_k^T P^T [m/N]
    real(rk), allocatable :: coupling(:, :) !< (kept, shapes) S_k^T K Psi
    real(rk), allocatable :: moved(:, :) !< (ports, shapes) P K^-1 M Psi
  end type static_rest

  !> Round-off in a stiffness of S, over the compliance of its port.
  real(rk), parameter :: noise_share = 1.0e-8_rk

contains

  !> Finds S from its products: S^T K Psi = P Psi - (P K^-1 M Psi) own and
  !> S^T K S = P K^-1 P^T - (P K^-1 M Psi) (P Psi)^T - S^T K Psi (P K^-1 M Psi)^T.
  subroutine find_rest(system, force, compliance, solvers, shapes, own, rest, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    real(rk), intent(in) :: compliance(:, :) !< (ports, ports) P K^-1 P^T [m/N]
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(in) :: shapes(:, :) !< (num_free, shapes) Psi
    real(rk), intent(in) :: own(:, :) !< (shapes, shapes) Psi^T K Psi
    type(static_rest), intent(inout) :: rest !< with the port that is left out
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(compliance, 1), size(shapes, 2)) :: path, coupling
    real(rk), allocatable :: work(:, :), stiffness(:, :)
    real(rk) :: noise(size(compliance, 1))
    integer :: k
    allocate (work, mold=shapes)
    allocate (rest%moved, mold=path)
    call multiply_columns(system%mass_pattern, system%mass_entries, shapes, work)
    call solve_blocks(solvers%whole, work, error)
    if (allocated(error)) return
    do k = 1, size(shapes, 2)
      path(:, k) = rows_of(system, force, shapes(:, k))
      rest%moved(:, k) = rows_of(system, force, work(:, k))
    end do
    coupling = path - times(rest%moved, own)
    stiffness = compliance - times(rest%moved, transpose(path)) &
                - times(coupling, transpose(rest%moved))
    noise = [(noise_share*compliance(k, k), k=1, size(noise))]
    if (rest%left_out > 0) noise(rest%left_out) = 0.0_rk
    call factorise_kept(0.5_rk*(stiffness + transpose(stiffness)), noise, rest%factor)
    associate (kept => rest%factor%kept)
      rest%coupling = coupling(kept, :)
      rest%seen = stiffness(kept, :) + times(rest%coupling, transpose(rest%moved))
    end associate
  end subroutine find_rest

  !> R.
  function rest_compliance(rest) result(compliance)
    type(static_rest), intent(in) :: rest
    real(rk), allocatable :: compliance(:, :) !< (ports, ports) [m/N]
    real(rk), allocatable :: half(:, :)
    half = rest%seen
    call solve_half(rest%factor, half)
    compliance = transposed_times(half, half)
  end function rest_compliance

  !> Makes the shapes orthogonal to S with K: Psi - S (S^T K S)^-1 S^T K Psi. `own` is their
  !> stiffness, before and afterwards.
  subroutine separate_shapes(system, force, rest, solvers, shapes, own, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    type(static_rest), intent(in) :: rest
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(inout) :: shapes(:, :) !< (num_free, shapes)
    real(rk), intent(inout) :: own(:, :) !< (shapes, shapes)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: part(:, :), response(:, :)
    part = rest%coupling
    call solve_half(rest%factor, part)
    own = own - transposed_times(part, part)
    call solve_rest(rest%factor, part)
    call respond(system, force, rest, solvers, part, shapes, response, error)
    if (.not. allocated(error)) shapes = shapes - response
  end subroutine separate_shapes

  !> R P^T f for each column f: displacements of the rest. The shapes are those that S was found
  !> with.
  subroutine rest_response(system, force, rest, solvers, shapes, port, x, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    type(static_rest), intent(in) :: rest
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(in) :: shapes(:, :) !< (num_free, shapes)
    real(rk), intent(in) :: port(:, :) !< (ports, columns) f
    real(rk), allocatable, intent(out) :: x(:, :) !< (num_free, columns)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: part(:, :)
    part = times(rest%seen, port)
    call solve_half(rest%factor, part)
    call solve_rest(rest%factor, part)
    call respond(system, force, rest, solvers, part, shapes, x, error)
  end subroutine rest_response

  !> S_k c = K^-1 P^T c - Psi (P K^-1 M Psi)^T c for each column c.
  subroutine respond(system, force, rest, solvers, part, shapes, x, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    type(static_rest), intent(in) :: rest
    type(static_solvers), intent(inout) :: solvers
    real(rk), intent(in) :: part(:, :) !< (kept, columns) c
    real(rk), intent(in) :: shapes(:, :) !< (num_free, shapes)
    real(rk), allocatable, intent(out) :: x(:, :) !< (num_free, columns)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: rows(size(rest%moved, 1), size(part, 2))
    integer :: k
    rows = 0.0_rk
    rows(rest%factor%kept, :) = part
    allocate (x(size(shapes, 1), size(part, 2)))
    do k = 1, size(part, 2)
      x(:, k) = forces_of(system, force, rows(:, k))
    end do
    call solve_inertial(solvers, x, error)
    if (.not. allocated(error)) x = x - times(shapes, transposed_times(rest%moved, rows))
  end subroutine respond
end module reduced_rest
