!> The reduced model of the linear structure with open joints (theory.md, 7.4): some shapes with
!> mass, and the static response to all loads and joint forces without mass.
!>
!>   u = u_0 + Phi y + R (sum of g_k f_k - B^T (area t))
!>
!> Loads f_k and joints are the ports P: only their rows of Phi and R are kept. Massless solids
!> respond by a part of R of their own.
module reduced_basis
  use, intrinsic :: iso_fortran_env, only: single => real32
  use dense_products, only: times, transposed_times
  use errors, only: error_type
  use global_vectors, only: multiply
  use joint_rows, only: num_rows
  use kinds, only: rk
  use mixed_products, only: rounded
  use reduced_massless, only: find_massless, massless_part
  use reduced_ports, only: find_port_compliance, forces_of, rows_of, sample_forces, solve_blocks, &
                           static_solvers
  use reduced_rest, only: find_rest, rest_compliance, rest_response, separate_shapes, static_rest
  use shape_modes, only: find_shape_modes
  use step_system, only: dam_system
  use symmetric_modes, only: find_modes
  implicit none
  private
  public :: reduced_model, build_basis, keep_modes, residual_response

  !> Port forces, and the sums of stiffness, mass and damping of their responses in the rest.
  type :: rest_sample
    real(rk), allocatable :: force(:, :) !< (ports, samples)
    real(rk) :: stiffness = 0.0_rk, mass = 0.0_rk, damping = 0.0_rk
  end type rest_sample

  type :: reduced_model
    integer :: num_modes = 0
    integer :: num_shapes = 0 !< that the modes come from
    real(rk) :: shift = 0.0_rk !< s of the factor of K + s M; it holds free blocks [1/s2]
    real(rk), allocatable :: lambda(:) !< (modes) squared circular frequency [1/s2]
    real(rk), allocatable :: mode(:, :) !< (num_free, modes) Phi
    !> (ports, modes) P Phi and P R P^T, rounded to single precision: increments read `path_read`
    !> and `residual_read`, the same values. P R P^T has (ports, ports) of the rest with mass,
    !> followed by those of massless solids where there are some.
    real(rk), allocatable :: path(:, :), residual(:, :)
    !> (ports, modes) static response of the modes to the ports, P Phi/(lambda + s), not rounded
    real(rk), allocatable :: share(:, :)
    real(single), allocatable :: path_read(:, :), residual_read(:, :)
    real(rk), allocatable :: damping(:, :) !< (modes, modes) Phi^T C Phi [1/s]
    !> (columns of P R P^T) stiffness, mass and damping of the rest over its stiffness with the
    !> shift [-, s2, s]
    real(rk), allocatable :: rest_stiffness(:), rest_mass(:), rest_damping(:)
    real(rk) :: massless_damping = 0.0_rk !< of massless solids over their stiffness [s]
    real(rk), allocatable :: force(:, :) !< (num_total, loads) f_k [N]
    real(rk), allocatable :: start_traction(:, :) !< (3, points) of the joints at the start [Pa]
    !> The last load but one, forces that are not balanced at the start, is round-off or what an
    !> iteration has left: its direction is accidental and must not shape the modes.
    logical :: starts_balanced = .false.
    !> (num_free, loads) R f_k, of the rest with mass, followed by that of massless solids [m]
    real(rk), allocatable :: load_shape(:, :)
    type(rest_sample) :: sample
    integer, allocatable :: probe(:) !< unknowns with the largest displacement of some modes
  end type reduced_model

  integer, parameter :: num_probes = 30, num_samples = 8
  !> Squared circular frequency of a mode without delay, times that of an increment: a period of a
  !> tenth of an increment.
  real(rk), parameter :: highest = 4.0e3_rk
  !> Least stiffness of the rest without the shift, over that with it.
  real(rk), parameter :: least_share = 0.1_rk

contains

  !> Builds the model from shapes that are orthonormal with M. The solver `whole` holds the factor
  !> of K + s M without joints.
  subroutine build_basis(system, dt, shapes, solvers, basis, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: dt !< increment [s]
    real(rk), allocatable, intent(inout) :: shapes(:, :) !< (num_free, shapes) not allocated after
    type(static_solvers), intent(inout) :: solvers
    type(reduced_model), intent(inout) :: basis !< with its forces
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: compliance(:, :), own(:, :), rotation(:, :), frequency(:)
    type(massless_part) :: massless
    integer :: k
    basis%num_shapes = size(shapes, 2)
    call find_massless(system, basis%shift, basis%force, solvers, shapes, massless, error)
    if (allocated(error)) return
    call leave_out_static(system, basis%shift, highest/dt**2, shapes, frequency, error)
    if (allocated(error)) return
    basis%num_modes = size(shapes, 2)
    call find_port_compliance(system, solvers%whole, basis%force, basis%load_shape, compliance, &
                              error)
    if (allocated(error)) return
    if (massless%is_there) compliance = compliance - massless%compliance
    call make_static(system, frequency, compliance, solvers, basis, shapes, own, error)
    if (allocated(error)) return
    call find_modes(own, basis%lambda, rotation, error)
    if (allocated(error)) return
    basis%mode = times(shapes, rotation)
    deallocate (shapes)
    call spread_modes(system, basis)
    if (massless%is_there) call add_massless(massless, basis)
    call remove_modes(basis)
    basis%lambda = max(0.0_rk, basis%lambda - basis%shift)
    call weigh_rest(basis)
    basis%probe = [(maxloc(abs(basis%mode(:, k)), 1), k=1, min(num_probes, basis%num_modes))]
    call round_ports(basis)
  end subroutine build_basis

  !> Adds the response of massless solids to the model.
  subroutine add_massless(massless, basis)
    type(massless_part), intent(in) :: massless
    type(reduced_model), intent(inout) :: basis
    real(rk), allocatable :: columns(:, :)
    integer :: n
    basis%massless_damping = massless%damping
    n = size(basis%residual, 1)
    allocate (columns(n, 2*n))
    columns(:, :n) = basis%residual
    columns(:, n + 1:) = massless%compliance
    call move_alloc(columns, basis%residual)
    n = size(basis%load_shape, 2)
    allocate (columns(size(basis%load_shape, 1), 2*n))
    columns(:, :n) = basis%load_shape - massless%load_shape
    columns(:, n + 1:) = massless%load_shape
    call move_alloc(columns, basis%load_shape)
  end subroutine add_massless

  !> Makes the shapes their own modes with K + s M, and leaves out those that follow their forces
  !> without delay: the static response has them. What round-off makes of shapes without mass is
  !> among them.
  subroutine leave_out_static(system, shift, most, shapes, frequency, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: shift !< [1/s2]
    real(rk), intent(in) :: most !< frequency that is kept, squared and circular [1/s2]
    real(rk), allocatable, intent(inout) :: shapes(:, :) !< (num_free, shapes)
    real(rk), allocatable, intent(out) :: frequency(:) !< (shapes) squared, circular [1/s2]
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: rotation(:, :)
    integer :: num_kept
    call find_shape_modes(system, system%stiffness + shift*system%mass, shapes, frequency, &
                          rotation, error)
    if (allocated(error)) return
    num_kept = max(min(1, size(frequency)), count(frequency <= most))
    frequency = frequency(:num_kept)
    shapes = times(shapes, rotation(:, :num_kept))
  end subroutine leave_out_static

  !> Rounds the matrices that increments read, which take their time.
  subroutine round_ports(basis)
    type(reduced_model), intent(inout) :: basis
    basis%path_read = real(basis%path, single)
    basis%residual_read = real(basis%residual, single)
    basis%residual = real(basis%residual_read, rk)
  end subroutine round_ports

  !> The same model with its lowest modes alone; the rest responds without mass. Shapes of the modes
  !> are kept at the probes alone.
  subroutine keep_modes(basis, num_modes, fewer)
    type(reduced_model), intent(in) :: basis
    integer, intent(in) :: num_modes
    type(reduced_model), intent(out) :: fewer
    real(rk), allocatable :: path(:, :), probe(:, :)
    real(rk) :: scale
    integer :: k, n, num_ports, num_loads
    fewer%num_modes = num_modes
    fewer%shift = basis%shift
    fewer%lambda = basis%lambda(:num_modes)
    fewer%path = basis%path(:, :num_modes)
    fewer%damping = basis%damping(:num_modes, :num_modes)
    fewer%force = basis%force
    fewer%start_traction = basis%start_traction
    fewer%probe = [(k, k=1, size(basis%probe))]
    fewer%mode = basis%mode(basis%probe, :num_modes)
    fewer%sample = basis%sample
    fewer%massless_damping = basis%massless_damping
    num_ports = size(basis%path, 1)
    num_loads = size(basis%force, 2)
    n = basis%num_modes - num_modes
    allocate (path(num_ports, n), probe(size(basis%probe), n))
    do k = 1, n
      scale = 1.0_rk/sqrt(basis%lambda(num_modes + k) + basis%shift)
      path(:, k) = scale*basis%path(:, num_modes + k)
      probe(:, k) = scale*basis%mode(basis%probe, num_modes + k)
      associate (own => matmul(path(:, k), basis%sample%force), sample => fewer%sample)
        sample%stiffness = sample%stiffness + sum(own**2)
        sample%mass = sample%mass + sum((scale*own)**2)
        sample%damping = sample%damping &
                         + basis%damping(num_modes + k, num_modes + k)*sum((scale*own)**2)
      end associate
    end do
    fewer%residual = basis%residual
    fewer%residual(:, :num_ports) = basis%residual(:, :num_ports) + times(path, transpose(path))
    fewer%load_shape = basis%load_shape(basis%probe, :)
    fewer%load_shape(:, :num_loads) = fewer%load_shape(:, :num_loads) &
                                      + times(probe, transpose(path(num_ports - num_loads + 1:, :)))
    call weigh_rest(fewer)
    call round_ports(fewer)
  end subroutine keep_modes

  !> The static response that the shapes leave out, R, and the shapes orthogonal to it with K + s M.
  !> `own` is their stiffness afterwards.
  subroutine make_static(system, frequency, compliance, solvers, basis, shapes, own, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: frequency(:) !< (modes) squared, of the shapes [1/s2]
    real(rk), intent(in) :: compliance(:, :) !< (ports, ports) [m/N]
    type(static_solvers), intent(inout) :: solvers
    type(reduced_model), intent(inout) :: basis
    real(rk), intent(inout) :: shapes(:, :) !< (num_free, modes) Psi
    real(rk), allocatable, intent(out) :: own(:, :) !< (modes, modes)
    type(error_type), allocatable, intent(out) :: error
    type(static_rest) :: rest
    integer :: k
    allocate (own(size(frequency), size(frequency)), source=0.0_rk)
    do k = 1, size(frequency)
      own(k, k) = frequency(k)
    end do
    if (basis%starts_balanced) rest%left_out = size(compliance, 1) - 1
    call find_rest(system, basis%force, compliance, solvers, shapes, own, rest, error)
    if (allocated(error)) return
    basis%residual = rest_compliance(rest)
    call sample_rest(system, rest, shapes, solvers, basis, error)
    if (allocated(error)) return
    call separate_shapes(system, basis%force, rest, solvers, shapes, own, error)
    own = 0.5_rk*(own + transpose(own))
  end subroutine make_static

  !> Ports and damping of the modes. The frequencies contain the shift.
  subroutine spread_modes(system, basis)
    type(dam_system), intent(in) :: system
    type(reduced_model), intent(inout) :: basis
    real(rk), allocatable :: viscous(:, :)
    integer :: k
    allocate (basis%path(num_rows(system%operator%num_points) + size(basis%force, 2), &
                         basis%num_modes))
    allocate (basis%share, mold=basis%path)
    do k = 1, basis%num_modes
      basis%share(:, k) = rows_of(system, basis%force, basis%mode(:, k))
      basis%path(:, k) = rounded(basis%share(:, k))
      basis%share(:, k) = basis%share(:, k)/basis%lambda(k)
    end do
    allocate (viscous, mold=basis%mode)
    call system%find_damping_forces(basis%mode, viscous)
    basis%damping = transposed_times(basis%mode, viscous)
    basis%damping = 0.5_rk*(basis%damping + transpose(basis%damping))
  end subroutine spread_modes

  !> The part of the responses to loads that the modes leave out. The frequencies contain the shift.
  subroutine remove_modes(basis)
    type(reduced_model), intent(inout) :: basis
    integer :: n
    n = size(basis%force, 2)
    associate (share => basis%share(size(basis%share, 1) - n + 1:, :))
      basis%load_shape(:, :n) = basis%load_shape(:, :n) - times(basis%mode, transpose(share))
    end associate
  end subroutine remove_modes

  !> Responses of the rest to some forces on the joints.
  subroutine sample_rest(system, rest, shapes, solvers, basis, error)
    type(dam_system), intent(in) :: system
    type(static_rest), intent(in) :: rest
    real(rk), intent(in) :: shapes(:, :) !< (num_free, modes) that it was found with
    type(static_solvers), intent(inout) :: solvers
    type(reduced_model), intent(inout) :: basis
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: response(:, :)
    real(rk), dimension(system%matrix%num_total) :: x, product
    integer :: k
    basis%sample%force = sample_forces(system, size(basis%force, 2), num_samples)
    call rest_response(system, basis%force, rest, solvers, shapes, basis%sample%force, response, &
                       error)
    if (allocated(error)) return
    x = 0.0_rk
    do k = 1, num_samples
      associate (force => basis%sample%force(:, k), sample => basis%sample)
        x(:system%matrix%num_free) = response(:, k)
        sample%stiffness = sample%stiffness + sum(force*matmul(basis%residual, force))
        call multiply(system%mass_pattern, system%mass_entries, x, product)
        sample%mass = sample%mass + sum(x*product)
        call system%find_damping_force(x, product)
        sample%damping = sample%damping + sum(x*product)
      end associate
    end do
  end subroutine sample_rest

  !> Stiffness, mass and damping of the rest over its stiffness with the shift.
  subroutine weigh_rest(basis)
    type(reduced_model), intent(inout) :: basis
    integer :: n
    n = size(basis%residual, 2)
    allocate (basis%rest_stiffness(n), source=1.0_rk)
    allocate (basis%rest_mass(n), source=0.0_rk)
    allocate (basis%rest_damping(n), source=basis%massless_damping)
    associate (sample => basis%sample, ports => size(basis%residual, 1))
      basis%rest_damping(:ports) = 0.0_rk
      if (.not. sample%stiffness > 0.0_rk) return
      basis%rest_mass(:ports) = sample%mass/sample%stiffness
      basis%rest_damping(:ports) = sample%damping/sample%stiffness
      basis%rest_stiffness(:ports) = max(least_share, 1.0_rk - basis%shift*basis%rest_mass(:ports))
    end associate
  end subroutine weigh_rest

  !> R P^T w, for each column of w.
  subroutine residual_response(system, solvers, basis, port, x, error)
    type(dam_system), intent(in) :: system
    type(static_solvers), intent(inout) :: solvers
    type(reduced_model), intent(in) :: basis
    real(rk), intent(in) :: port(:, :) !< (columns of P R P^T, columns)
    real(rk), intent(out) :: x(:, :) !< (num_free, columns)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: massless(size(x, 1), size(x, 2))
    integer :: k, n
    n = size(basis%path, 1)
    do k = 1, size(port, 2)
      x(:, k) = forces_of(system, basis%force, port(:n, k))
    end do
    call solve_blocks(solvers%whole, x, error)
    if (allocated(error)) return
    do k = 1, size(port, 2)
      x(:, k) = x(:, k) - matmul(basis%mode, matmul(port(:n, k), basis%share))
    end do
    if (size(port, 1) == n) return
    do k = 1, size(port, 2)
      massless(:, k) = forces_of(system, basis%force, port(n + 1:, k) - port(:n, k))
    end do
    call solve_blocks(solvers%held, massless, error)
    if (.not. allocated(error)) x = x + massless
  end subroutine residual_response
end module reduced_basis
