!> Data of job.json, collected during the run.
module run_summaries
  use kinds, only: rk
  use diagnostics, only: diagnostic_list
  use node_dofs, only: num_directions
  use problem_definition, only: problem
  use rank_balance, only: balance_of_ranks
  use analysis_state, only: state, energy_balance, reduction_status, time_accuracy, vibration_mode
  implicit none
  private
  public :: run_summary, step_summary, follows_error

  real(rk), parameter :: same_size = 1.0e-6_rk !< relative difference of increments

  !> One step that has begun.
  type :: step_summary
    integer :: step = 0 !< position in the problem
    real(rk) :: time = 0.0_rk !< step time so far [s]
    integer :: increments = 0, iterations = 0, cutbacks = 0
    integer :: most_iterations = 0 !< in one increment
    integer :: augmentations = 0, most_augmentations = 0 !< of contact: all, in one increment
    real(rk) :: joint_condition = 0.0_rk !< of the system with all joints closed
    real(rk) :: largest_residual = 0.0_rk, largest_error = 0.0_rk !< error of the energy balance
    type(energy_balance) :: energy !< at its end [J]
    type(reduction_status) :: reduction
    type(time_accuracy) :: accuracy !< of increments that follow the estimated error
    real(rk), allocatable :: sizes(:) !< of such increments [s]
    integer, allocatable :: of_size(:) !< (sizes) number of increments
    type(vibration_mode), allocatable :: modes(:) !< without shapes
  end type step_summary

  type :: run_summary
    character(8) :: status = 'running' !< 'finished', 'stopped'
    character(:), allocatable :: message
    character(:), allocatable :: deck_digest
    type(diagnostic_list) :: remarks !< warnings and ignored input of the deck
    integer :: num_unknowns = 0
    type(step_summary), allocatable :: steps(:)
    type(balance_of_ranks) :: balance !< at the end of a run of several ranks
  contains
    procedure :: begin_step
    procedure :: note, note_stop
    procedure :: note_modes
  end type run_summary

contains

  !> A step begins.
  subroutine begin_step(self, model, step)
    class(run_summary), intent(inout) :: self
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(step_summary) :: fresh
    fresh%step = step
    allocate (fresh%modes(0), fresh%sizes(0), fresh%of_size(0))
    self%steps = [self%steps, fresh]
    if (self%num_unknowns == 0) self%num_unknowns = count_unknowns(model, step)
  end subroutine begin_step

  !> Number of displacements that are not prescribed, at nodes of elements.
  integer function count_unknowns(model, step) result(count_free)
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    logical :: is_free(num_directions, model%mesh%num_nodes)
    integer :: e, a, i
    is_free = .false.
    do e = 1, model%mesh%num_elements
      do a = 1, size(model%mesh%nodes, 1)
        if (model%mesh%nodes(a, e) > 0) is_free(:, model%mesh%nodes(a, e)) = .true.
      end do
    end do
    associate (fixities => model%steps(step)%fixities)
      do i = 1, size(fixities)
        is_free(fixities(i)%dof, fixities(i)%node) = .false.
      end do
    end associate
    count_free = count(is_free)
  end function count_unknowns

  !> Records an increment of the present step.
  subroutine note(self, now)
    class(run_summary), intent(inout) :: self
    type(state), intent(in) :: now
    if (now%num_unknowns > 0) self%num_unknowns = now%num_unknowns
    associate (last => self%steps(size(self%steps)))
      last%time = now%step_time
      last%increments = now%increment
      last%iterations = last%iterations + now%iterations
      last%cutbacks = now%cutbacks
      last%energy = now%energy
      last%reduction = now%reduction
      last%accuracy = now%accuracy
      if (now%control%first > 0.0_rk .and. now%increment > 0) then
        call count_size(last, now%increment_size)
      end if
      last%most_iterations = max(last%most_iterations, now%iterations)
      last%augmentations = last%augmentations + now%augmentations
      last%most_augmentations = max(last%most_augmentations, now%augmentations)
      last%joint_condition = max(last%joint_condition, now%joint_condition)
      last%largest_residual = max(last%largest_residual, now%residual)
      last%largest_error = max(last%largest_error, abs(now%energy%error))
    end associate
  end subroutine note

  !> Records that the run stops in the present step, which may have no increment yet, and its
  !> cut-backs.
  subroutine note_stop(self, model, now)
    class(run_summary), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< the last state in equilibrium
    logical :: is_listed
    if (now%step == 0) return
    is_listed = size(self%steps) > 0
    if (is_listed) is_listed = self%steps(size(self%steps))%step == now%step
    if (.not. is_listed) call self%begin_step(model, now%step)
    if (model%steps(now%step)%procedure%finds_modes .or. .not. now%has_opened_step) return
    self%steps(size(self%steps))%cutbacks = now%control%cutbacks
  end subroutine note_stop

  !> Whether the estimated error in time has chosen the increments of a step.
  elemental logical function follows_error(part)
    type(step_summary), intent(in) :: part
    follows_error = .false.
    if (allocated(part%sizes)) follows_error = size(part%sizes) > 0
  end function follows_error

  !> Counts an increment among those of its size.
  subroutine count_size(part, size_now)
    type(step_summary), intent(inout) :: part
    real(rk), intent(in) :: size_now !< [s]
    integer :: i
    do i = 1, size(part%sizes)
      if (abs(part%sizes(i) - size_now) <= same_size*size_now) exit
    end do
    if (i > size(part%sizes)) then
      part%sizes = [part%sizes, size_now]
      part%of_size = [part%of_size, 0]
    end if
    part%of_size(i) = part%of_size(i) + 1
  end subroutine count_size

  !> Records the modes of the present step.
  subroutine note_modes(self, modes)
    class(run_summary), intent(inout) :: self
    type(vibration_mode), intent(in) :: modes(:)
    integer :: i
    associate (last => self%steps(size(self%steps)))
      deallocate (last%modes)
      allocate (last%modes(size(modes)))
      do i = 1, size(modes)
        last%modes(i)%hz = modes(i)%hz
        last%modes(i)%effective_mass = modes(i)%effective_mass
      end do
    end associate
  end subroutine note_modes
end module run_summaries
