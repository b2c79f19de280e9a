!> The state of an analysis at one time. Two of them exist, converged and trial: accepting an
!> increment is one swap, cutting it back is one copy.
module analysis_state
  use kinds, only: rk
  use joint_law, only: joint_state
  use material_points, only: point_state
  implicit none
  private
  public :: state, energy_balance, vibration_mode

  !> Energies since the start of the analysis [J]. `error` is the imbalance over `largest`, the
  !> largest of them so far: a body that has come to rest holds nothing to compare with.
  type :: energy_balance
    real(rk) :: external = 0.0_rk, kinetic = 0.0_rk, strain = 0.0_rk, damping = 0.0_rk
    real(rk) :: friction = 0.0_rk
    real(rk) :: fracture = 0.0_rk !< dissipated by cracking and crushing, in joints and solids
    real(rk) :: crushing = 0.0_rk !< of it by crushing
    real(rk) :: numerical = 0.0_rk !< taken by the time stepping, from its own formula
    real(rk) :: initial = 0.0_rk !< kinetic and strain energy that the analysis began with
    real(rk) :: error = 0.0_rk, largest = 0.0_rk
  end type energy_balance

  type :: state
    integer :: step = 0, increment = 0, iterations = 0
    integer :: augmentations = 0 !< of contact without penetration, in this increment
    integer :: cutbacks = 0 !< in this step so far
    integer :: num_unknowns = 0 !< free unknowns of the step's system
    logical :: has_held_switches = .false. !< in this increment, of laws whose stress jumps
    logical :: is_last_of_step = .false.
    logical :: is_stop = .false. !< told once more, because the run stops here before its end
    real(rk) :: step_time = 0.0_rk, total_time = 0.0_rk, increment_size = 0.0_rk !< [s]
    !> Of the scaled matrix with all joints closed, 1-norm; 0 without joints
    real(rk) :: joint_condition = 0.0_rk
    real(rk) :: residual = 0.0_rk !< out-of-balance over the reference force
    real(rk) :: largest_force = 0.0_rk !< of the balance so far; kept where solids are inelastic [N]
    real(rk), allocatable :: u(:, :) !< displacement, relative to the base [m]; (3, nodes)
    real(rk), allocatable :: v(:, :), a(:, :) !< (3, nodes) [m/s], [m/s2]
    real(rk), allocatable :: reaction(:, :) !< (3, nodes), zero where nothing is fixed [N]
    type(joint_state), allocatable :: joints(:) !< one for each joint of the problem
    type(point_state), allocatable :: points(:) !< one for each inelastic block of the problem
    type(energy_balance) :: energy
  end type state

  type :: vibration_mode
    real(rk) :: hz = 0.0_rk
    real(rk) :: effective_mass(3) = 0.0_rk !< in x, y, z [kg]
    real(rk), allocatable :: shape(:, :) !< (3, nodes), unit modal mass
  end type vibration_mode
end module analysis_state
