!> Solvers of equilibrium for sizes of increments that the step may return to: each keeps its factor
!> and the compliance of the joints. A factor that is kept is the same as one that is made anew.
module kept_solvers
  use kinds, only: rk, long
  use equilibrium, only: equilibrium_solver
  use ranks, only: is_true_everywhere
  implicit none
  private
  public :: solver_shelf

  !> The solver of one size of increments.
  type :: kept_solver
    real(rk) :: size = 0.0_rk !< of the increment [s]; 0: nothing is kept here
    integer :: last_use = 0
    class(equilibrium_solver), allocatable :: solver
  end type kept_solver

  integer, parameter :: most_kept = 8
  !> Memory for work beside a factor that is kept, over that of the factor.
  integer, parameter :: room_share = 3
  real(rk), parameter :: same_size = 1.0e-9_rk !< relative difference of one size

  !> The solvers that are kept.
  type :: solver_shelf
    type(kept_solver), allocatable, private :: items(:)
    integer, private :: num_uses = 0
  contains
    procedure :: put, take
  end type solver_shelf

contains

  !> Keeps a solver, unless there is no room for a factor beside it.
  subroutine put(self, size, solver)
    class(solver_shelf), intent(inout) :: self
    real(rk), intent(in) :: size !< of the increment that its factor belongs to [s]
    class(equilibrium_solver), allocatable, intent(inout) :: solver
    integer :: i
    if (.not. has_room(solver)) return
    if (.not. allocated(self%items)) allocate (self%items(most_kept))
    i = minloc(self%items%last_use, dim=1)
    self%num_uses = self%num_uses + 1
    self%items(i)%size = size
    self%items(i)%last_use = self%num_uses
    call move_alloc(solver, self%items(i)%solver)
  end subroutine put

  !> Takes the solver of a size, if it is here.
  subroutine take(self, size, solver)
    class(solver_shelf), intent(inout) :: self
    real(rk), intent(in) :: size !< [s]
    class(equilibrium_solver), allocatable, intent(inout) :: solver
    integer :: i
    if (.not. allocated(self%items)) return
    do i = 1, most_kept
      if (abs(self%items(i)%size - size) > same_size*size) cycle
      call move_alloc(self%items(i)%solver, solver)
      call solver%repeated%leave()
      self%items(i)%size = 0.0_rk
      self%items(i)%last_use = 0
    end do
  end subroutine take

  !> Whether another factor and its work find memory on all ranks, by allocating and freeing it.
  logical function has_room(solver)
    class(equilibrium_solver), intent(in) :: solver
    real(rk), allocatable, volatile :: room(:) ! volatile: compilers would omit it
    integer(long) :: most
    integer :: status
    most = room_share*(solver%factor%num_entries() &
                       + (3_long*solver%operator%num_points)**2)
    allocate (room(max(1_long, most)), stat=status)
    has_room = status == 0
    if (has_room) room(1) = 0.0_rk
    has_room = is_true_everywhere(has_room)
  end function has_room
end module kept_solvers
