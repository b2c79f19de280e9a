!> The state of an analysis: everything that changes in time.
!>
!> An analysis holds two states, converged and trial. An increment fills the trial state. Accepting
!> the increment swaps the two; a cut leaves the converged state as it is.
!>
!> state_archive saves and loads the state. A new component gets a line in save and load of its
!> type, there or with the history.
module analysis_state
  use kinds, only: rk
  use guest_history, only: history_slot
  use joint_law, only: joint_state
  use modal_errors, only: modal_error
  use path_errors, only: path_error
  use path_twins, only: twin_points
  use material_points, only: point_state
  use step_control, only: increment_control
  use thermal_strains, only: heat_field
  implicit none
  private
  public :: state, increment_status, last_matrix, motion, modal_motion, energy_balance
  public :: reduction_status, time_accuracy, vibration_mode

  !> Energies since the start of the analysis [J]. `error` is the imbalance over `largest`, the
  !> largest energy so far: the present energies of a dam at rest are no reference.
  type :: energy_balance
    real(rk) :: external = 0.0_rk, kinetic = 0.0_rk, strain = 0.0_rk, damping = 0.0_rk
    real(rk) :: friction = 0.0_rk
    real(rk) :: fracture = 0.0_rk !< dissipated by cracking and crushing, in joints and solids
    real(rk) :: crushing = 0.0_rk !< the part of `fracture` that is crushing
    !> Cracking, crushing and energy created by laws, of solids that have left; their dissipation is
    !> part of `fracture` and `crushing`
    real(rk) :: left_cracking = 0.0_rk, left_crushing = 0.0_rk, left_created = 0.0_rk
    real(rk) :: numerical = 0.0_rk !< dissipated by the time integration, from its own formula
    !> Work of elements that come and go, and of grout: their energy, and the forces that the change
    !> of a stage leaves without balance
    real(rk) :: stages = 0.0_rk
    real(rk) :: temperature = 0.0_rk !< work of the thermal strain: less the stress times its change
    real(rk) :: initial = 0.0_rk !< kinetic and strain energy at the start of the analysis
    real(rk) :: error = 0.0_rk, largest = 0.0_rk
  contains
    procedure :: shows_sliding, shows_impacts
  end type energy_balance

  !> The reduced model of the step, and its error.
  type :: reduction_status
    integer :: num_shapes = 0 !< that it was built from
    integer :: num_modes = 0 !< 0: the step has no reduced model
    real(rk) :: highest = 0.0_rk !< frequency [Hz]
    real(rk) :: estimate = 0.0_rk !< error of the openings, over the largest; negative: not known
    integer :: num_broken = 0 !< points of joints without strength at the start of the step
  end type reduction_status

  !> The error in time of a step whose increments follow it (theory.md, 7.5). Norms are weighted by
  !> the mass.
  type :: time_accuracy
    integer :: num_known = 0 !< increments that the differences of the displacements have seen
    real(rk) :: size = 0.0_rk, size_before = 0.0_rk !< of the last two increments [s]
    real(rk) :: largest = 0.0_rk !< norm of the displacements so far
    real(rk) :: mean_rate = 0.0_rk, held_rate = 0.0_rk !< of the error; its slowly falling maximum
    !> Means of squared norms of velocity, acceleration and third derivative
    real(rk) :: velocity_square = 0.0_rk, acceleration_square = 0.0_rk, third_square = 0.0_rk
    real(rk) :: error = 0.0_rk !< that has added up, less what damping has taken
    real(rk) :: largest_error = 0.0_rk !< so far
    real(rk) :: damped = 0.0_rk !< energy at the start of the step [J]
    real(rk) :: kinetic = 0.0_rk !< integral over time [J s]
  contains
    procedure :: relative
  end type time_accuracy

  !> Time of the analysis, course of the last increment and size of the next increment.
  type :: increment_status
    integer :: step = 0, increment = 0, iterations = 0
    integer :: augmentations = 0 !< of contact without penetration, in this increment
    integer :: cutbacks = 0 !< in this step so far
    integer :: num_unknowns = 0 !< free unknowns of the step's system
    logical :: has_held_switches = .false. !< in this increment, of laws with discontinuous stress
    logical :: has_opened_step = .false. !< the integrator: a loaded state goes on within the step
    logical :: is_last_of_step = .false.
    logical :: is_stop = .false. !< the run stops at this increment, before the end of its step
    real(rk) :: step_time = 0.0_rk, total_time = 0.0_rk, increment_size = 0.0_rk !< [s]
    real(rk) :: step_start = 0.0_rk !< total time at the start of the step [s]
    !> Condition of the scaled matrix with all joints closed, in the 1-norm; 0 without joints
    real(rk) :: joint_condition = 0.0_rk
    real(rk) :: residual = 0.0_rk !< norm of the residual over the reference force
    real(rk) :: largest_force = 0.0_rk !< reference force of the last increment [N]
    type(energy_balance) :: energy
    type(increment_control) :: control
    type(reduction_status) :: reduction
    type(time_accuracy) :: accuracy
    type(modal_error) :: timing !< of the time integration in this step
    type(path_error) :: path !< of the laws of inelastic solids within increments
  end type increment_status

  !> Motion of a reduced model since the start of its step (theory.md, 7.4).
  type :: modal_motion
    real(rk), allocatable :: start(:) !< (num_total) unknowns at the start of the step [m]
    real(rk), allocatable :: start_traction(:, :) !< (3, points) of the joints there [Pa]
    real(rk), allocatable :: start_factor(:) !< (load groups) there
    real(rk), allocatable :: y(:), rate(:), acceleration(:) !< (modes) and their rates
    !> (ports) forces on joints [N], then factors of loads, whose static response the rest has
    real(rk), allocatable :: port(:), port_rate(:), port_acceleration(:)
    real(rk), allocatable :: rest(:), rest_rate(:), rest_acceleration(:) !< (ports) that response
    logical :: is_expanded = .false. !< the motion of all unknowns is that of the modes and ports
  contains
    procedure :: lacks_unknowns
  end type modal_motion

  !> Motion and forces in the unknowns of a step. The integrator allocates what it needs.
  type :: motion
    real(rk), allocatable :: q(:) !< (num_total) unknowns [m]
    real(rk), allocatable :: v(:), a(:) !< (num_total) their rates [m/s], [m/s2]
    real(rk), allocatable :: external(:) !< (num_total) f, forces of the loads [N]
    !> (num_total) force of the undamaged elements: K q, less that of their origins and of their
    !> thermal strain [N]
    real(rk), allocatable :: elastic(:)
    !> (num_total) force of the thermal strain; where a material expands [N]
    real(rk), allocatable :: thermal(:)
    real(rk) :: thermal_energy = 0.0_rk !< of elements whose nodes are held [J]
    real(rk), allocatable :: internal(:) !< (num_total) sum of B^T sigma over the elements [N]
    real(rk), allocatable :: contact(:) !< (num_total) B^T (area t), the joints by their laws [N]
    real(rk), allocatable :: balanced(:) !< (num_total) M a as the balance of forces gives it [N]
    real(rk), allocatable :: viscous(:), viscous_rate(:) !< C v [N], C a [N/s]
    !> (num_total) damping force that cracks have lost, part of `internal` with opposite sign [N];
    !> allocated with *DAMPING, BASE=CURRENT only
    real(rk), allocatable :: lost_damping(:)
    !> (num_total) force of the stress that corrects the work of the increment, and the same as the
    !> end of the increment carries it [N]; of solids with a free energy in dynamic steps only
    real(rk), allocatable :: correction(:), carried_correction(:)
    real(rk), allocatable :: momentum(:), inertia(:) !< M v [N s], M a [N]
    !> (free unknowns) what the last increment has left of the balance of forces, which the next one
    !> makes up for; where solutions are not exact [N]
    real(rk), allocatable :: residual(:)
    real(rk), allocatable :: last_a(:) !< (num_total) a before the last increment [m/s2]
    !> a after the last increment is nearly that before it times the first factor, and that of one
    !> increment earlier times the second one
    real(rk) :: acceleration_ratio = 0.0_rk, last_ratio = 0.0_rk
    !> (num_total) first [m/s] and second [m/s2] divided difference of q over the last increments;
    !> with *CONTROLS, ACCURACY only
    real(rk), allocatable :: slope(:), bend(:)
    !> (num_total) force that balances what the change of a stage, or supports that are gone, have
    !> left without balance, part of `external`; it falls to zero in its static step [N]
    real(rk), allocatable :: release(:)
    real(rk), allocatable :: carried(:, :) !< (3, points) t* of the implicit joint impulse [Pa]
    real(rk), allocatable :: jump_rate(:, :) !< (3, points) in the last increment [m/s]
    type(modal_motion) :: modal !< of a reduced model
  end type motion

  !> The matrix that the last iteration has ended with. The next increment starts with it.
  type :: last_matrix
    integer :: number = 0 !< of its factorisation in this step
    logical :: is_elastic = .true. !< it is K_eff, without the loss of stiffness
    logical :: is_symmetric = .true.
    real(rk) :: increment_size = 0.0_rk !< that K_eff was made for; 0 in static steps [s]
    real(rk), allocatable :: lost(:) !< loss of stiffness [N/m], where it is not elastic
    logical :: has_all_blocks = .false. !< of the compliance of joints, those left out at first, too
  end type last_matrix

  !> One of the two states of an analysis, converged or trial.
  type, extends(increment_status) :: state
    real(rk), allocatable :: u(:, :) !< (3, nodes) displacement relative to the base [m]
    real(rk), allocatable :: v(:, :), a(:, :) !< (3, nodes) [m/s], [m/s2]; dynamic steps only
    real(rk), allocatable :: reaction(:, :) !< (3, nodes) zero where nothing is fixed [N]
    !> (fixities of the step) displacement at the start of the step, where supports start from [m]
    real(rk), allocatable :: support_start(:)
    !> (24, elements) displacement of the nodes at which an element has no stress, since it appeared
    !> there; in models with *MODEL CHANGE only [m]
    real(rk), allocatable :: origin(:, :)
    type(heat_field) :: heat !< temperatures
    type(last_matrix) :: matrix
    type(motion) :: motion !< the same in the unknowns of the step, with the forces
    type(joint_state), allocatable :: joints(:) !< (joints of the problem)
    type(point_state), allocatable :: points(:) !< (inelastic blocks of the problem)
    type(history_slot), allocatable :: guests(:) !< (guests of the problem)
    type(twin_points), allocatable :: twins(:) !< (materials) where errors of laws are estimated
  end type state

  !> A mode of a frequency step.
  type :: vibration_mode
    real(rk) :: hz = 0.0_rk
    real(rk) :: effective_mass(3) = 0.0_rk !< in x, y, z [kg]
    real(rk), allocatable :: shape(:, :) !< (3, nodes), unit modal mass
  end type vibration_mode

  !> Work of friction over the largest energy from which on points slide in earnest. Bending columns
  !> whose feet open slip a little, 2 %, and follow their modes.
  real(rk), parameter :: sliding_share = 0.05_rk
  !> The same of what the scheme dissipates: impacts that an increment does not resolve. Dams in
  !> strong motion have 0 to 0.08, a block that falls on a joint 0.99.
  real(rk), parameter :: impact_share = 0.2_rk

contains

  !> Whether sliding decides the motion.
  pure logical function shows_sliding(self)
    class(energy_balance), intent(in) :: self
    shows_sliding = self%friction > sliding_share*self%largest
  end function shows_sliding

  !> Whether impacts of joints take much of the energy: how a body goes on depends on each of them.
  pure logical function shows_impacts(self)
    class(energy_balance), intent(in) :: self
    shows_impacts = self%numerical > impact_share*self%largest
  end function shows_impacts

  !> Whether the motion of a reduced model is known in its modes and ports alone.
  pure logical function lacks_unknowns(self)
    class(modal_motion), intent(in) :: self
    lacks_unknowns = allocated(self%y) .and. .not. self%is_expanded
  end function lacks_unknowns

  !> The largest error so far over the largest displacement.
  pure real(rk) function relative(self)
    class(time_accuracy), intent(in) :: self
    relative = self%largest_error/max(tiny(1.0_rk), self%largest)
  end function relative
end module analysis_state
