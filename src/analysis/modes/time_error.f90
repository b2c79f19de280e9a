!> Errors of the time integration and of the mesh in the lowest modes of the structure with closed
!> joints (theory.md, 14.3 and 14.5): the exact motion of the modes under the forces of the run,
!> beside the run, and that of modes which are as soft as those of the structure.
module time_error
  use kinds, only: rk
  use analysis_state, only: motion
  use dam_mesh, only: fe_mesh
  use eigen_modes, only: estimate_modes, list_massive, num_massive, points_down
  use equilibrium, only: equilibrium_solver
  use errors, only: error_type
  use global_vectors, only: dot, multiply
  use joint_forces, only: reference_stiffness
  use joint_iteration, only: closed_tangent
  use matrix_pattern, only: pattern
  use modal_errors, only: modal_error
  use node_parts, only: find_largest, vector_at
  use problem_definition, only: problem
  use dof_numbering, only: numbering
  use step_system, only: dam_system
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: error_modes, make_error_modes, start_modal_error, take_modal_error
  public :: displacement_of, drive_modes
  public :: note_largest, note_lost_forces, start_mesh_error

  integer, parameter :: most_modes = 10

  !> Of a squared frequency: a mesh so coarse has no estimate that holds.
  real(rk), parameter :: most_softening = 0.5_rk
  !> Least root of an overdamped mode, over its damping: cosh and sinh/root do not change below.
  real(rk), parameter :: least_root = 1.0e-6_rk

  !> Modes with unit modal mass; none where there is no estimate.
  type :: error_modes
    real(rk), allocatable :: shape(:, :) !< (num_free, modes)
    !> Unknowns with mass: the forces on others are balanced, and M has no rows for them
    integer, allocatable :: massive(:)
    real(rk), allocatable :: own(:, :) !< (massive, modes) the shapes
    real(rk), allocatable :: inertia(:, :) !< (massive, modes) M times the shapes
    real(rk), allocatable :: square(:) !< (modes) squared circular frequencies [1/s2]
    real(rk), allocatable :: damping(:) !< (modes) 2 zeta omega [1/s]
    !> (supports, modes) displacement of a mode relative to that by supports at rest, per
    !> displacement of a support, and force that the support takes from it, per its acceleration
    real(rk), allocatable :: by_support(:, :), support_mass(:, :)
    type(unknown_part) :: part !< of this rank: `massive` and the supports are unknowns that it owns
  end type error_modes

contains

  !> Finds the modes with the factor of the step, which is then lost. Without them (a body that is
  !> free to move) there is no estimate.
  subroutine make_error_modes(model, system, solver, modes)
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    class(equilibrium_solver), intent(inout) :: solver
    type(error_modes), intent(out) :: modes
    type(error_type), allocatable :: failure
    real(rk), allocatable :: closed(:), reference(:, :), mode(:), force(:)
    integer :: k, num_modes
    call reference_stiffness(model%joints, system%operator, reference)
    allocate (closed, source=system%stiffness)
    call system%operator%add_stiffness(closed_tangent(reference), system%matrix, closed)
    call solver%factor%factorise(system%matrix, closed, failure)
    if (allocated(failure)) return
    modes%massive = list_massive(system%matrix, system%mass)
    num_modes = min(most_modes, num_massive(system%matrix, system%mass))
    call estimate_modes(system%matrix, system%mass, solver%factor, num_modes, modes%square, &
                        modes%shape, failure)
    if (allocated(failure)) then
      if (allocated(modes%square)) deallocate (modes%square)
      return
    end if
    modes%part = system%matrix%part
    call point_upwards(modes%part, modes%shape)
    modes%own = modes%shape(modes%massive, :)
    allocate (modes%inertia, mold=modes%own)
    allocate (modes%damping(num_modes))
    allocate (modes%by_support(system%matrix%num_total - system%matrix%num_free, num_modes))
    allocate (modes%support_mass, mold=modes%by_support)
    allocate (mode(system%matrix%num_total), force(system%matrix%num_total))
    mode = 0.0_rk
    associate (n => system%matrix%num_free)
      do k = 1, num_modes
        mode(:n) = modes%shape(:, k)
        call multiply(system%matrix, system%mass, mode, force)
        modes%inertia(:, k) = force(modes%massive)
        modes%support_mass(:, k) = force(n + 1:)
        call multiply(system%matrix, closed, mode, force)
        modes%by_support(:, k) = force(n + 1:)/modes%square(k)
        modes%support_mass(:, k) = modes%support_mass(:, k) - modes%by_support(:, k)
        call system%find_damping_force(mode, force)
        modes%damping(k) = dot(modes%part, mode(:n), force(:n))
      end do
      call keep_own(system%matrix, modes%by_support)
      call keep_own(system%matrix, modes%support_mass)
    end associate
  end subroutine make_error_modes

  !> Gives the largest entry of each mode a positive sign: as a rule a continued run finds the same
  !> modes. Modes of symmetric dams have two such entries (resumed_modes).
  subroutine point_upwards(part, shape)
    type(unknown_part), intent(in) :: part
    real(rk), intent(inout) :: shape(:, :) !< (num_free, modes)
    integer :: k
    do k = 1, size(shape, 2)
      if (points_down(part, shape(:, k))) shape(:, k) = -shape(:, k)
    end do
  end subroutine point_upwards

  !> Leaves out the supports that another rank counts.
  subroutine keep_own(matrix, values)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:, :) !< (supports, modes)
    logical :: is_own(matrix%num_total)
    integer :: k
    is_own = matrix%part%owns(matrix%num_total)
    do k = 1, size(values, 2)
      where (.not. is_own(matrix%num_free + 1:)) values(:, k) = 0.0_rk
    end do
  end subroutine keep_own

  !> The exact motion starts with that of the run, with supports that jump where they stand after
  !> their jump.
  subroutine start_modal_error(modes, moving, placed, own)
    type(error_modes), intent(in) :: modes
    type(motion), intent(in) :: moving !< at the start of the step
    real(rk), intent(in) :: placed(:) !< (num_total) its unknowns after the jump [m]
    type(modal_error), intent(out) :: own
    own%exact = displacement_of(modes, placed)
    allocate (own%rate, own%drive, own%error, mold=own%exact)
    own%error = 0.0_rk
    own%carried = carried_by(modes, placed, modes%support_mass)
    own%carried_rate = carried_by(modes, moving%v, modes%support_mass)
    call drive_modes(modes, moving, displacement_of(modes, moving%q), own%rate, own%drive)
  end subroutine start_modal_error

  !> The motion of the structure, whose modes are softer than those of the mesh, starts in
  !> equilibrium with the same forces.
  subroutine start_mesh_error(modes, stiffening, own)
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: stiffening(:) !< (modes) [1/s2]
    type(modal_error), intent(inout) :: own
    own%stiffening = max(-most_softening, min(most_softening, stiffening/modes%square)) &
                     *modes%square
    own%softer = own%exact*modes%square/(modes%square - own%stiffening)
    own%softer_rate = own%rate
    allocate (own%mesh_at_most(size(stiffening)), source=0.0_rk)
  end subroutine start_mesh_error

  !> Modal displacements relative to those that the supports cause at rest.
  function displacement_of(modes, unknowns) result(q)
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: unknowns(:) !< (num_total) [m]
    real(rk) :: q(size(modes%square))
    q = matmul(unknowns(modes%massive), modes%inertia) &
        + matmul(at_supports(modes, unknowns), modes%by_support)
    call modes%part%add_shares(q)
  end function displacement_of

  !> What moving supports carry in each mode.
  function carried_by(modes, unknowns, shares) result(q)
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: unknowns(:) !< (num_total)
    real(rk), intent(in) :: shares(:, :) !< (supports, modes)
    real(rk) :: q(size(modes%square))
    q = matmul(at_supports(modes, unknowns), shares)
    call modes%part%add_shares(q)
  end function carried_by

  !> The part of a vector in the supports.
  pure function at_supports(modes, vector) result(part)
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: vector(:) !< (num_total)
    real(rk) :: part(size(modes%by_support, 1))
    part = vector(size(modes%shape, 1) + 1:)
  end function at_supports

  !> Modal velocities, and the forces that drive the modes: those of the balance at the end of the
  !> increment, with the elastic and the damping force of the mode added.
  subroutine drive_modes(modes, moving, q, rate, drive)
    type(error_modes), intent(in) :: modes
    type(motion), intent(in) :: moving
    real(rk), intent(in) :: q(:)
    real(rk), contiguous, intent(out) :: rate(:), drive(:)
    real(rk) :: force(size(modes%massive))
    associate (rows => modes%massive)
      rate = matmul(moving%momentum(rows), modes%own) &
             - matmul(at_supports(modes, moving%v), modes%support_mass)
      force = moving%external(rows) - moving%internal(rows) - moving%contact(rows) &
              - moving%viscous(rows)
    end associate
    drive = matmul(force, modes%own)
    call modes%part%add_shares(rate)
    call modes%part%add_shares(drive)
    drive = drive + modes%damping*rate + modes%square*q
  end subroutine drive_modes

  !> The exact motion over an increment in which the forces change linearly.
  subroutine take_modal_error(modes, dt, after, slopes, own, moved)
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: dt !< [s]
    type(motion), intent(in) :: after !< at the end of the increment
    real(rk), intent(in) :: slopes(:) !< (num_total) of the histories of supports then [m/s]
    type(modal_error), intent(inout) :: own
    real(rk), allocatable, intent(out) :: moved(:) !< (modes) displacement of the increment
    real(rk), dimension(size(modes%square)) :: q, rate, drive
    real(rk) :: p(2, size(modes%square))
    integer :: k
    q = displacement_of(modes, after%q)
    moved = q - own%exact - own%error
    call drive_modes(modes, after, q, rate, drive)
    call carry_modes(modes, dt, after%q, slopes, own, p)
    p(1, :) = own%drive - p(1, :)
    p(2, :) = drive - p(2, :)
    do k = 1, size(q)
      call advance_oscillator(modes%square(k), modes%damping(k), dt, p(:, k), &
                              own%exact(k), own%rate(k))
      if (.not. allocated(own%softer)) cycle
      call advance_oscillator(modes%square(k) - own%stiffening(k), modes%damping(k), dt, &
                              p(:, k), own%softer(k), own%softer_rate(k))
    end do
    own%drive = drive
    own%error = q - own%exact
    own%motion = max(own%motion, norm2(q - carried_by(modes, after%q, modes%by_support)))
    own%most = max(own%most, norm2(own%error))
  end subroutine take_modal_error

  !> The inertia of moving supports, per mass: the linear course with the velocity and the
  !> displacement that they gain in the increment.
  subroutine carry_modes(modes, dt, unknowns, slopes, own, force)
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: dt !< [s]
    real(rk), intent(in) :: unknowns(:), slopes(:) !< (num_total) at the end [m], [m/s]
    type(modal_error), intent(inout) :: own
    real(rk), intent(out) :: force(:, :) !< (start and end, modes)
    real(rk), dimension(size(modes%square)) :: place, rate, gain, way
    place = carried_by(modes, unknowns, modes%support_mass)
    rate = carried_by(modes, slopes, modes%support_mass)
    gain = (rate - own%carried_rate)/dt
    way = (place - own%carried - dt*own%carried_rate)/dt**2
    force(1, :) = 6.0_rk*way - 2.0_rk*gain
    force(2, :) = 4.0_rk*gain - 6.0_rk*way
    own%carried = place
    own%carried_rate = rate
  end subroutine carry_modes

  !> Sums of the modal forces that the joints have lost by opening and sliding, and of those that
  !> they would have closed (theory.md, 14.4).
  subroutine note_lost_forces(modes, after, own)
    type(error_modes), intent(in) :: modes
    type(motion), intent(in) :: after
    type(modal_error), intent(inout) :: own
    real(rk), dimension(size(modes%square)) :: lost, q
    lost = matmul(after%external(modes%massive), modes%own)
    call modes%part%add_shares(lost)
    lost = own%drive - lost
    q = own%exact + own%error
    own%lost = own%lost + sum(lost**2/modes%square)
    own%held = own%held + sum(modes%square*q**2)
  end subroutine note_lost_forces

  !> x'' + c x' + w2 x = p0 + (p1 - p0) t/dt from 0 to dt, exactly: a + b t and a free vibration.
  pure subroutine advance_oscillator(w2, c, dt, p, x, v)
    real(rk), intent(in) :: w2, c, dt !< squared circular frequency, 2 zeta omega, increment
    real(rk), intent(in) :: p(2) !< force per mass at the start and at the end
    real(rk), intent(inout) :: x, v
    real(rk) :: a, b, root, decay, cosine, sine, y, w
    b = (p(2) - p(1))/(dt*w2)
    a = (p(1) - c*b)/w2
    decay = exp(-0.5_rk*c*dt)
    root = sqrt(abs(w2 - 0.25_rk*c**2))
    if (w2 > 0.25_rk*c**2) then
      cosine = cos(root*dt)
      sine = sin(root*dt)/root
    else
      root = max(root, least_root*c) ! sinh(0)/0 at critical damping
      cosine = cosh(root*dt)
      sine = sinh(root*dt)/root
    end if
    y = x - a
    w = v - b
    x = a + b*dt + decay*(cosine*y + sine*(w + 0.5_rk*c*y))
    v = b + decay*(cosine*w - sine*(0.5_rk*c*w + w2*y))
  end subroutine advance_oscillator

  !> Keeps the largest displacement so far, and its error: the part along the displacement.
  subroutine note_largest(mesh, numbers, modes, u, own)
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(error_modes), intent(in) :: modes
    real(rk), intent(in) :: u(:, :) !< (3, nodes), on the first rank [m]
    type(modal_error), intent(inout) :: own
    real(rk) :: moved(3), largest
    integer :: node
    call find_largest(u, node, moved)
    largest = norm2(moved)
    if (largest <= own%largest) return
    own%largest = largest
    own%at_largest = error_along(own%error)
    if (allocated(own%softer)) own%mesh_at_largest = error_along(own%softer - own%exact)
  contains
    !> The part of an error of the modes along the displacement [m].
    real(rk) function error_along(of_modes)
      real(rk), intent(in) :: of_modes(:)
      real(rk) :: q(numbers%num_total), error(3, size(u, 2))
      q = 0.0_rk
      q(:size(modes%shape, 1)) = matmul(modes%shape, of_modes)
      call numbers%expand(q, error)
      error_along = dot_product(vector_at(mesh, node, error), moved)/largest
    end function error_along
  end subroutine note_largest
end module time_error
