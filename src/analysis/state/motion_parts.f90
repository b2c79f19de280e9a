!> The motion of all ranks, for checkpoints, where vectors are divided. A checkpoint has the
!> unknowns in the order of one process: any number of ranks goes on from it.
module motion_parts
  use analysis_state, only: motion, state
  use constraint_elimination, only: number_step
  use dof_numbering, only: numbering
  use errors, only: error_type
  use kinds, only: rk
  use node_parts, only: find_owners
  use problem_definition, only: problem
  use ranks, only: gather_on_first_rank, is_first_rank, num_ranks, starts_of_ranks, this_rank
  implicit none
  private
  public :: gather_motion, take_own_motion

  !> How the own entries of a vector go to the first rank.
  type :: gathering
    integer, allocatable :: own(:) !< own unknowns of this rank
    integer, allocatable :: first(:) !< (ranks + 1) first entry of each rank, from 0
    integer, allocatable :: place(:) !< (all entries) unknown of one process; on the first rank
  contains
    procedure :: open => open_gathering
    procedure :: gather
  end type gathering

contains

  !> Puts the motion of a step together on the first rank. All ranks call this.
  subroutine gather_motion(model, now, whole)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(motion), intent(out) :: whole !< on the first rank
    type(gathering) :: sent
    type(numbering) :: numbers
    integer, allocatable :: place(:)
    integer :: num_free
    call find_places(model, now%step, numbers, place, num_free)
    call sent%open(model, numbers, place)
    associate (own => now%motion)
      call sent%gather(own%q, whole%q)
      call sent%gather(own%v, whole%v)
      call sent%gather(own%a, whole%a)
      call sent%gather(own%external, whole%external)
      call sent%gather(own%elastic, whole%elastic)
      call sent%gather(own%thermal, whole%thermal)
      call sent%gather(own%internal, whole%internal)
      call sent%gather(own%contact, whole%contact)
      call sent%gather(own%balanced, whole%balanced)
      call sent%gather(own%viscous, whole%viscous)
      call sent%gather(own%viscous_rate, whole%viscous_rate)
      call sent%gather(own%lost_damping, whole%lost_damping)
      call sent%gather(own%correction, whole%correction)
      call sent%gather(own%carried_correction, whole%carried_correction)
      call sent%gather(own%momentum, whole%momentum)
      call sent%gather(own%inertia, whole%inertia)
      call sent%gather(own%residual, whole%residual)
      if (is_first_rank() .and. allocated(own%residual)) then
        whole%residual = whole%residual(:num_free)
      end if
      call sent%gather(own%last_a, whole%last_a)
      call sent%gather(own%slope, whole%slope)
      call sent%gather(own%bend, whole%bend)
      call sent%gather(own%release, whole%release)
      whole%thermal_energy = own%thermal_energy
      whole%acceleration_ratio = own%acceleration_ratio
      whole%last_ratio = own%last_ratio
      if (allocated(own%carried)) whole%carried = own%carried
      if (allocated(own%jump_rate)) whole%jump_rate = own%jump_rate
      whole%modal = own%modal
    end associate
  end subroutine gather_motion

  !> Keeps the unknowns of this rank of the motion that a checkpoint has, with those of all ranks.
  subroutine take_own_motion(model, now)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now !< as loaded
    type(numbering) :: numbers
    integer, allocatable :: place(:)
    integer :: num_free
    if (now%step == 0 .or. .not. allocated(model%mesh%is_node_here)) return
    if (.not. allocated(now%motion%q)) return
    call find_places(model, now%step, numbers, place, num_free)
    ! A motion of another step is left as it is; `reopen_step` refuses it.
    if (size(now%motion%q) < maxval([0, place])) return
    associate (own => now%motion)
      call take(place, own%q)
      call take(place, own%v)
      call take(place, own%a)
      call take(place, own%external)
      call take(place, own%elastic)
      call take(place, own%thermal)
      call take(place, own%internal)
      call take(place, own%contact)
      call take(place, own%balanced)
      call take(place, own%viscous)
      call take(place, own%viscous_rate)
      call take(place, own%lost_damping)
      call take(place, own%correction)
      call take(place, own%carried_correction)
      call take(place, own%momentum)
      call take(place, own%inertia)
      call take(place(:numbers%num_free), own%residual)
      call take(place, own%last_a)
      call take(place, own%slope)
      call take(place, own%bend)
      call take(place, own%release)
    end associate
  end subroutine take_own_motion

  !> The unknowns of this rank in a step, and their places among those of one process.
  subroutine find_places(model, step, numbers, place, num_free)
    type(problem), intent(in) :: model
    integer, intent(in) :: step
    type(numbering), intent(out) :: numbers
    integer, allocatable, intent(out) :: place(:) !< (num_total)
    integer, intent(out) :: num_free !< of one process
    type(numbering) :: all
    type(error_type), allocatable :: ignored ! the step has been numbered before
    associate (mesh => model%mesh, fixities => model%steps(step)%fixities)
      call number_step(mesh, model%joints, model%guests, fixities, numbers, ignored)
      call number_step(mesh, model%joints, model%guests, fixities, all, ignored, &
                       of_all_ranks=.true.)
    end associate
    num_free = all%num_free
    place = numbers%places_in(all)
  end subroutine find_places

  !> Gives the first rank the places of the own unknowns of all ranks.
  subroutine open_gathering(self, model, numbers, place)
    class(gathering), intent(out) :: self
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: place(:) !< (num_total)
    integer :: owner(model%mesh%num_nodes), k
    real(rk), allocatable :: all(:)
    call find_owners(model%mesh, owner)
    self%own = pack([(k, k=1, numbers%num_total)], owner(numbers%node) == this_rank())
    self%first = starts_of_ranks(size(self%own))
    allocate (all(merge(self%first(num_ranks() + 1), 0, is_first_rank())))
    call gather_on_first_rank(real(place(self%own), rk), self%first, all)
    self%place = nint(all)
  end subroutine open_gathering

  !> Puts one vector together on the first rank; not allocated where the ranks do not have it.
  subroutine gather(self, own, whole)
    class(gathering), intent(in) :: self
    real(rk), allocatable, intent(in) :: own(:) !< (num_total, or num_free) of this rank
    real(rk), allocatable, intent(out) :: whole(:)
    real(rk), allocatable :: all(:)
    real(rk) :: sent(size(self%own))
    integer :: k
    if (.not. allocated(own)) return
    sent = 0.0_rk
    do k = 1, size(sent)
      if (self%own(k) <= size(own)) sent(k) = own(self%own(k))
    end do
    allocate (all(size(self%place)), whole(size(self%place)))
    call gather_on_first_rank(sent, self%first, all)
    whole(self%place) = all
  end subroutine gather

  !> Keeps the entries of this rank.
  subroutine take(place, x)
    integer, intent(in) :: place(:)
    real(rk), allocatable, intent(inout) :: x(:) !< of all ranks, then of this one
    if (allocated(x)) x = x(place)
  end subroutine take
end module motion_parts
