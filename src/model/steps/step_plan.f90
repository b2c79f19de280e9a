!> The steps of the deck: procedure, loads, supports, requests. Plain data, filled by the keywords,
!> read by the solvers.
module step_plan
  use heat_plan, only: heat_rule
  use kinds, only: rk
  implicit none
  private
  public :: step, step_load, step_fixity, print_request, field_request, step_controls
  public :: step_damping, step_reduction, initial_value, step_procedure, field_name_length
  public :: grouting, output_rhythm, step_before, span_of_step

  integer, parameter :: field_name_length = 8 !< of names of fields that a deck may give

  !> A load that is active in a step. Its factor goes from `start_factor` (end of the last step) to
  !> `end_factor` over a static step, and is `end_factor` at once in a dynamic one; with an
  !> amplitude it is end_factor*amplitude(t). A load that was removed ends at 0.
  type :: step_load
    integer :: load = 0 !< position in the problem's list of loads
    real(rk) :: start_factor = 0.0_rk
    real(rk) :: end_factor = 1.0_rk
    integer :: amplitude = 0 !< position in the problem's list of amplitudes, 0 for none
  end type step_load

  !> One prescribed degree of freedom; the same rule of time as a load. The value at the start of
  !> the step is the displacement reached before.
  type :: step_fixity
    integer :: node = 0 !< position in the mesh
    integer :: dof = 0 !< 1..3
    real(rk) :: value = 0.0_rk !< displacement at the end of the step [m]
    integer :: amplitude = 0 !< 0 for none
  end type step_fixity

  !> How often a request writes, as its card says.
  type :: output_rhythm
    integer :: frequency = 1 !< every so many increments
    integer :: most = 0 !< NUMBER INTERVAL: outputs in a step; 0: not given
    real(rk) :: interval = 0.0_rk !< TIME INTERVAL; 0: not given [s]
  contains
    procedure :: increments_between
  end type output_rhythm

  !> *NODE PRINT, *EL PRINT or *JOINT PRINT.
  type :: print_request
    integer :: kind = 0 !< position in `kinds_of_prints`
    character(:), allocatable :: name !< of the set or joint, upper case; part of the file's name
    integer, allocatable :: members(:) !< positions of nodes, elements or joint
    integer, allocatable :: near_nodes(:) !< *JOINT PRINT, NSET: only the points nearest to them
    character(field_name_length), allocatable :: fields(:) !< 'U', 'V', 'S', ...
    integer :: frequency = 1 !< every so many increments
    type(output_rhythm) :: rhythm !< of the card
  end type print_request

  !> *NODE FILE, *EL FILE, *NODE OUTPUT, *ELEMENT OUTPUT: fields of the VTK series and job.h5.
  type :: field_request
    character(field_name_length), allocatable :: fields(:)
    integer :: frequency = 1
    type(output_rhythm) :: rhythm !< of the card
    logical :: is_of_elements = .false. !< of *EL FILE, else of *NODE FILE
  end type field_request

  !> *CONTROLS; the defaults are documented in the keyword's specification.
  type :: step_controls
    real(rk) :: residual_tolerance = 1.0e-6_rk !< residual over the reference force
    real(rk) :: increment_tolerance = 1.0e-6_rk !< last correction over the increment
    integer :: max_iterations = 15
    !> ACCURACY: error in time that the size of increments follows, over the largest displacement;
    !> 0 where sizes do not follow it
    real(rk) :: accuracy = 0.0_rk
    logical :: estimates_errors = .true. !< ERROR ESTIMATE
    !> 'SINGLE': of the factor, outside of the joints; 'MIXED': the factor has a copy in single
    !> precision; or 'DOUBLE'
    character(6) :: precision = 'DOUBLE'
    character(16) :: joint_solver = 'AUTO' !< 'CONDENSED', 'FULL' or 'AUTO'
    !> Joint forces in time: 'IMPLICIT' (the impulse of a step is dt times the joint force at its
    !> end), 'HHT' (weighted like the bulk) or 'END'. Measured: docs/studies/joint_forces_in_time.
    character(16) :: joint_forces = 'IMPLICIT'
    !> Of inelastic solids: 'CONSISTENT', 'SECANT', 'ELASTIC' or 'AUTO'.
    character(16) :: tangent = 'AUTO'
    !> --save-joint-problems: an increment with more iterations on joints is saved
    integer :: most_unsaved = huge(1)
    character(:), allocatable :: stem_of_problems !< start of the names of these files
    logical :: may_be_dropped = .false. !< of an increment: a signal ends its iteration
  end type step_controls

  !> One component of *INITIAL CONDITIONS.
  type :: initial_value
    logical :: is_velocity = .false. !< else a displacement
    integer :: node = 0, dof = 0
    real(rk) :: value = 0.0_rk
  end type initial_value

  !> What a step does; integrator_catalogue lists them.
  type :: step_procedure
    character(16) :: name = '' !< its keyword: 'STATIC', ..; '' until the deck names one
    character(16) :: scheme = '' !< of the time integration
    logical :: has_inertia = .false. !< inertia acts; loads without amplitude act at once
    logical :: finds_modes = .false. !< takes no time
    !> *DYNAMIC, ALPHA and *CONTROLS, JOINT FORCES weight the forces in time
    logical :: uses_alpha = .false.
  contains
    procedure :: is_static
  end type step_procedure

  !> *GROUT of one joint.
  type :: grouting
    integer :: joint = 0 !< position
    real(rk) :: pressure = 0.0_rk !< of the grout; 0: it hardens at the start of the step [Pa]
  end type grouting

  !> *DAMPING of a step.
  type :: step_damping
    real(rk) :: ratio = 0.0_rk !< of Rayleigh damping; 0 for none
    real(rk) :: f1 = 0.0_rk, f2 = 0.0_rk !< where the ratio holds [Hz]
    logical :: is_current = .false. !< BASE=CURRENT: by the damaged stiffness
    real(rk) :: modal_ratio = 0.0_rk !< of modal damping; 0 for none
    integer :: num_modes = 0 !< with modal damping; 0: all up to `highest`
    real(rk) :: highest = 0.0_rk !< [Hz]
  end type step_damping

  !> *DYNAMIC, REDUCED.
  type :: step_reduction
    real(rk) :: accuracy = 0.02_rk !< of the openings, over the largest
    integer :: num_modes = 0 !< 0: as many as the accuracy needs
  end type step_reduction

  !> One step: what happens from *STEP to *END STEP.
  type :: step
    character(:), allocatable :: name
    type(step_procedure) :: procedure
    integer :: line = 0 !< of the procedure's card, for messages
    real(rk) :: first_increment = 1.0_rk, duration = 1.0_rk !< [s]
    real(rk) :: smallest_increment = 0.0_rk, largest_increment = huge(1.0_rk) !< [s]
    real(rk) :: finest_increment = 0.0_rk !< that *CONTROLS, ACCURACY may choose [s]
    logical :: is_direct = .false. !< increments of fixed size
    integer :: max_increments = 100000 !< *STEP, INC
    real(rk) :: alpha = -0.05_rk !< of a scheme with `uses_alpha`
    integer :: num_modes = 0 !< *FREQUENCY
    type(step_damping) :: damping
    type(step_reduction) :: reduced
    type(step_load), allocatable :: loads(:) !< all active loads, also those of earlier steps
    type(step_fixity), allocatable :: fixities(:) !< all supports, also those of earlier steps
    type(print_request), allocatable :: prints(:)
    type(field_request), allocatable :: outputs(:)
    character(field_name_length), allocatable :: envelope(:) !< fields of *ENVELOPE
    type(step_controls) :: controls
    integer :: checkpoint_frequency = 0 !< *RESTART: every so many increments, 0 for none
    type(grouting), allocatable :: grouts(:) !< *GROUT in this step
    type(heat_rule), allocatable :: heats(:) !< *TEMPERATURE, if any; also those that go on
    !> *TEMPERATURE, OP=NEW: nodes without a rule return to their initial temperature
    logical :: restores_temperature = .false.
    logical :: changes_stage = .false. !< elements come or go, or joints are grouted, at its start
  contains
    procedure :: default_smallest, follows_accuracy, estimates_by_modes
  end type step

  !> The modes of an estimate cost as much as a few dozen increments.
  integer, parameter :: least_increments = 500

  !> Smallest increments unless the deck names one. They do not depend on the duration of a dynamic
  !> step: a record of 60 s may be cut as often as one of 5 s.
  real(rk), parameter :: smallest_of_duration = 1.0e-5_rk !< static, as in Abaqus
  real(rk), parameter :: smallest_of_increment = 1.0e-3_rk !< over the first increment
  real(rk), parameter :: round_off = 1.0e-9_rk !< of a number of increments

contains

  !> The last step before that took time: not one that finds modes. 0: there is none.
  pure integer function step_before(steps, number) result(before)
    type(step), intent(in) :: steps(:)
    integer, intent(in) :: number !< of the step
    do before = number - 1, 1, -1
      if (.not. steps(before)%procedure%finds_modes) exit
    end do
  end function step_before

  !> Start and end of a step on its own clock or on that of the analysis [s].
  pure function span_of_step(steps, number, uses_total_time) result(span)
    type(step), intent(in) :: steps(:)
    integer, intent(in) :: number !< of the step
    logical, intent(in) :: uses_total_time
    real(rk) :: span(2)
    span = 0.0_rk
    associate (before => steps(:number - 1))
      if (uses_total_time) span(1) = sum(before%duration, mask=.not. before%procedure%finds_modes)
    end associate
    span(2) = span(1) + steps(number)%duration
  end function span_of_step

  !> Increments from one output to the next in a step. Where the card gives times, of the first
  !> increment.
  pure integer function increments_between(self, duration, first_increment) result(count)
    class(output_rhythm), intent(in) :: self
    real(rk), intent(in) :: duration, first_increment !< of the step [s]
    count = self%frequency
    if (self%most > 0) then
      count = max(1, ceiling(duration/(first_increment*self%most) - round_off))
    else if (self%interval > 0.0_rk) then
      count = max(1, nint(self%interval/first_increment))
    end if
  end function increments_between

  !> Whether loads ramp over the step, without inertia.
  elemental logical function is_static(self)
    class(step_procedure), intent(in) :: self
    is_static = .not. (self%has_inertia .or. self%finds_modes) .and. self%name /= ''
  end function is_static

  !> Whether the estimated error in time chooses the size of increments.
  pure logical function follows_accuracy(self)
    class(step), intent(in) :: self
    follows_accuracy = self%controls%accuracy > 0.0_rk .and. self%procedure%has_inertia &
                       .and. .not. self%is_direct
  end function follows_accuracy

  !> Whether modes show the errors of linear solids: the step is so long that the estimate takes
  !> less than 5 % of its time.
  pure logical function estimates_by_modes(self)
    class(step), intent(in) :: self
    estimates_by_modes = self%procedure%has_inertia .and. self%controls%estimates_errors &
                         .and. self%duration > least_increments*self%first_increment
  end function estimates_by_modes

  !> The smallest increment where the deck names none. A static step whose first increment is small
  !> can be cut as well.
  pure real(rk) function default_smallest(self) result(smallest)
    class(step), intent(in) :: self
    smallest = smallest_of_increment*self%first_increment
    if (.not. self%procedure%has_inertia) smallest = min(smallest_of_duration*self%duration, &
                                                         smallest)
  end function default_smallest
end module step_plan
