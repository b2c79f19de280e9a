!> The response of massless solids in a reduced model (theory.md, 7.4): to forces of the ports where
!> all that has mass is held, X = (K + h M)^-1 P^T with a large h.
!>
!> Massless solids follow their forces at once, with the damping of their own material. With them in
!> one response with solids that have mass, the mass and the damping of those would delay them.
module reduced_massless
  use column_products, only: multiply_columns
  use errors, only: error_type
  use global_vectors, only: diagonal
  use joint_rows, only: num_rows
  use kinds, only: rk
  use linear_solver, only: equation_solver
  use reduced_ports, only: find_port_compliance, forces_of, sample_forces, solve_blocks, &
                           static_solvers
  use shape_orthogonality, only: orthonormalise_all
  use step_system, only: dam_system
  implicit none
  private
  public :: massless_part, find_massless

  type :: massless_part
    logical :: is_there = .false.
    real(rk), allocatable :: compliance(:, :) !< (ports, ports) P X [m/N]
    real(rk), allocatable :: load_shape(:, :) !< (num_free, loads) of X [m]
    real(rk) :: damping = 0.0_rk !< over the stiffness [s]
  end type massless_part

  !> h over the mean squared frequency of the unknowns, sum of K_ii over sum of M_ii: what is held
  !> moves by 1e-5 of what it would. Larger values leave more round-off where jumps are unknowns.
  real(rk), parameter :: hold_share = 1.0e5_rk
  !> Share of what is held in the stiffness of the response above which no massless solid moves: it
  !> is 1e-5 where massless solids move, and 1 where none do.
  real(rk), parameter :: most_held = 0.5_rk
  integer, parameter :: num_samples = 8
  !> Shapes follow twice: the first time, round-off of large shapes in the rock is left.
  integer, parameter :: num_passes = 2

contains

  !> Finds the response, and makes massless solids follow the others in the shapes: X describes
  !> what they do beyond. The solver `held` holds the factor afterwards; it is dropped where forces
  !> of the ports do not move massless solids.
  subroutine find_massless(system, shift, force, solvers, shapes, massless, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: shift !< s of K + s M [1/s2]
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    type(static_solvers), intent(inout) :: solvers
    real(rk), allocatable, intent(inout) :: shapes(:, :) !< (num_free, shapes)
    type(massless_part), intent(out) :: massless
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: hold
    integer :: pass
    if (.not. allocated(solvers%held)) return
    hold = hold_share*mean_frequency(system)
    call solvers%held%factorise(system%matrix, system%stiffness + hold*system%mass, error)
    if (allocated(error)) return
    call sample_response(system, force, hold, solvers%held, massless, error)
    if (allocated(error)) return
    if (.not. massless%is_there) then
      deallocate (solvers%held)
      return
    end if
    call find_port_compliance(system, solvers%held, force, massless%load_shape, &
                              massless%compliance, error)
    if (allocated(error)) return
    do pass = 1, num_passes
      call let_follow(system, hold, solvers%held, shapes, error)
      if (allocated(error)) return
      call orthonormalise_all(system, shift, shapes)
    end do
  end subroutine find_massless

  !> Makes massless solids follow the others: (K + h M)^-1 h M Psi.
  subroutine let_follow(system, hold, held, shapes, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: hold !< h [1/s2]
    class(equation_solver), intent(inout) :: held
    real(rk), intent(inout) :: shapes(:, :) !< (num_free, shapes)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: inertia(:, :)
    allocate (inertia, mold=shapes)
    call multiply_columns(system%mass_pattern, system%mass_entries, shapes, inertia)
    call solve_blocks(held, inertia, error)
    if (.not. allocated(error)) shapes = hold*inertia
  end subroutine let_follow

  !> Mean squared circular frequency of the unknowns, each alone [1/s2].
  real(rk) function mean_frequency(system) result(mean)
    type(dam_system), intent(in) :: system
    real(rk) :: mass(system%matrix%num_total)
    call diagonal(system%matrix, system%mass, mass)
    associate (n => system%matrix%num_free)
      mean = sum(system%diagonal(:n))/max(tiny(1.0_rk), sum(mass(:n)))
    end associate
  end function mean_frequency

  !> Whether the ports move massless solids, and the damping over the stiffness, from responses to
  !> some forces. Where all that moves has mass, h times the mass is the whole stiffness.
  subroutine sample_response(system, force, hold, held, massless, error)
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: force(:, :) !< (num_total, loads) [N]
    real(rk), intent(in) :: hold !< h [1/s2]
    class(equation_solver), intent(inout) :: held
    type(massless_part), intent(inout) :: massless
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(system%matrix%num_free, num_samples) :: x, product
    real(rk) :: port(num_rows(system%operator%num_points) + size(force, 2), num_samples)
    real(rk) :: stiffness
    integer :: k
    port = sample_forces(system, size(force, 2), num_samples)
    do k = 1, num_samples
      x(:, k) = forces_of(system, force, port(:, k))
    end do
    product = x
    call solve_blocks(held, x, error)
    if (allocated(error)) return
    stiffness = sum(x*product)
    if (.not. stiffness > 0.0_rk) return
    call multiply_columns(system%mass_pattern, system%mass_entries, x, product)
    massless%is_there = hold*sum(x*product) <= most_held*stiffness
    call system%find_damping_forces(x, product)
    massless%damping = sum(x*product)/stiffness
  end subroutine sample_response
end module reduced_massless
