!> What the stored blocks of the compliance leave out, learned from exact responses.
!>
!> Each solve with the whole structure for a change of the joint forces shows the jumps that the
!> blocks leave out. Changes of the forces in an increment resemble those of the increments before.
!> The last changes are kept, as columns of unit length of F, with the jumps that are left out of
!> their responses, J = E F. Then E x is about J a, with the a that makes |x - F a|^2 + s |a|^2
!> least (regularisation of A. N. Tikhonov). Changes are nearly dependent. The share s limits a, so
!> that errors of J do not grow from change to change.
module learned_response
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use dense_products, only: times_vector, transposed_times_vector
  use dense_factor, only: factorise_dense, lu_factor, solve_factored
  use global_vectors, only: length
  use kinds, only: rk
  implicit none
  private
  public :: response_memory, most_kept

  integer, parameter :: most_kept = 64 !< changes of the forces
  !> s, the square of the error of J: solves leave 1e-8 of the forces, and the jumps that the blocks
  !> leave out are some 1e-5 of those of stiff springs.
  real(rk), parameter :: share_of_length = 1.0e-6_rk

  type :: response_memory
    integer :: num_kept = 0
    integer, private :: next = 1 !< the place that the next change takes
    real(rk), allocatable, private :: force(:, :) !< (rows, most_kept) F [-]
    real(rk), allocatable, private :: jump(:, :) !< (rows, most_kept) J [m/N]
    real(rk), private :: product(most_kept, most_kept) = 0.0_rk !< F^T F
    type(lu_factor), private :: regular !< of F^T F + s I
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

  !> Takes a change of the forces and the jumps that the blocks leave out of its response, in the
  !> place of the oldest change if all places are taken.
  subroutine learn(self, force, jump)
    class(response_memory), intent(inout) :: self
    real(rk), intent(in) :: force(:) !< (rows) [N]
    real(rk), intent(in) :: jump(:) !< (rows) [m]
    real(rk), allocatable :: regular(:, :)
    real(rk) :: size_of_force
    integer :: k
    size_of_force = length(force)
    if (.not. (size_of_force > 0.0_rk .and. ieee_is_finite(length(jump)))) return
    if (.not. allocated(self%force)) then
      allocate (self%force(size(force), most_kept), source=0.0_rk)
      allocate (self%jump(size(force), most_kept), source=0.0_rk)
    end if
    associate (now => self%next)
      self%force(:, now) = force/size_of_force
      self%jump(:, now) = jump/size_of_force
      self%num_kept = min(self%num_kept + 1, most_kept)
      self%product(:, now) = transposed_times_vector(self%force, self%force(:, now))
      self%product(now, :) = self%product(:, now)
    end associate
    self%next = 1 + modulo(self%next, most_kept)
    associate (n => self%num_kept)
      regular = self%product(:n, :n)
      do k = 1, n
        regular(k, k) = regular(k, k) + share_of_length
      end do
    end associate
    call factorise_dense(regular, self%regular)
  end subroutine learn

  !> y = y + E x.
  subroutine add_to(self, x, y)
    class(response_memory), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(inout) :: y(:) !< (rows) [m]
    real(rk) :: part(self%num_kept, 1)
    if (self%num_kept == 0) return
    associate (force => self%force(:, :self%num_kept), jump => self%jump(:, :self%num_kept))
      part(:, 1) = transposed_times_vector(force, x)
      call solve_factored(self%regular, part)
      y = y + times_vector(jump, part(:, 1))
    end associate
  end subroutine add_to
end module learned_response
