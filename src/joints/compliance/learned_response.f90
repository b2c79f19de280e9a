!> What the stored blocks of the compliance leave out, learned from exact responses.
!>
!> Each solve with the whole structure for a change of the joint forces shows the jumps that the
!> blocks leave out. Changes of the forces in an increment resemble those of the increments before.
!> What is left out of G, E, is therefore kept on the space of the last changes, as W Q^T with
!> orthonormal forces Q and their jumps W = E Q.
module learned_response
  use dense_products, only: times_vector, transposed_times_vector
  use global_vectors, only: length
  use kinds, only: rk
  implicit none
  private
  public :: response_memory, most_kept

  integer, parameter :: most_kept = 64 !< changes of the forces
  !> A change is left out if so little of it is new.
  real(rk), parameter :: least_new = 1.0e-3_rk

  type :: response_memory
    integer :: num_kept = 0
    integer, private :: next = 1 !< the place that the next change takes
    real(rk), allocatable, private :: force(:, :) !< (rows, most_kept) Q, orthonormal [-]
    real(rk), allocatable, private :: jump(:, :) !< (rows, most_kept) W = E Q [m/N]
  contains
    procedure :: learn, add_to, forget
  end type response_memory

contains

  !> Forgets all changes: the blocks are others.
  subroutine forget(self)
    class(response_memory), intent(inout) :: self
    self%num_kept = 0
    self%next = 1
    if (allocated(self%force)) deallocate (self%force, self%jump)
  end subroutine forget

  !> Takes a change of the forces and the jumps that the blocks leave out of its response.
  subroutine learn(self, force, jump)
    class(response_memory), intent(inout) :: self
    real(rk), intent(in) :: force(:) !< (rows) [N]
    real(rk), intent(in) :: jump(:) !< (rows) [m]
    real(rk) :: rest(size(force)), part(most_kept), again(most_kept)
    if (.not. length(force) > 0.0_rk) return
    if (.not. allocated(self%force)) then
      allocate (self%force(size(force), most_kept), source=0.0_rk)
      allocate (self%jump(size(force), most_kept), source=0.0_rk)
    end if
    part = transposed_times_vector(self%force, force)
    rest = force - times_vector(self%force, part)
    again = transposed_times_vector(self%force, rest)
    rest = rest - times_vector(self%force, again)
    part = part + again
    if (.not. length(rest) > least_new*length(force)) return
    part(self%next) = 0.0_rk
    rest = force - times_vector(self%force, part)
    call replace_oldest(self, rest/length(rest), &
                        (jump - times_vector(self%jump, part))/length(rest))
  end subroutine learn

  !> Takes the place of the oldest pair, if all places are taken.
  subroutine replace_oldest(self, force, jump)
    class(response_memory), intent(inout) :: self
    real(rk), intent(in) :: force(:), jump(:)
    self%force(:, self%next) = force
    self%jump(:, self%next) = jump
    self%num_kept = min(self%num_kept + 1, most_kept)
    self%next = 1 + modulo(self%next, most_kept)
  end subroutine replace_oldest

  !> y = y + E x.
  subroutine add_to(self, x, y)
    class(response_memory), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(inout) :: y(:) !< (rows) [m]
    if (self%num_kept == 0) return
    associate (n => self%num_kept)
      y = y + times_vector(self%jump(:, :n), transposed_times_vector(self%force(:, :n), x))
    end associate
  end subroutine add_to
end module learned_response
