!> What the stored blocks of the compliance leave out, learned from exact responses.
!>
!> Each solve with the whole structure for a change of the joint forces shows the jumps that the
!> blocks leave out. Changes of the forces in an increment resemble those of the increments before.
!> The last changes are kept, as columns of unit length of F, with the jumps that are left out of
!> their responses, J = E F. Then E x is about J a, with the a that makes |x - F a|^2 + s |a|^2
!> least (A. N. Tikhonov). The share s limits a, and thus what errors of J do: without it they would
!> grow from change to change, because the changes are nearly dependent.
module learned_response
  use dense_products, only: times_vector, transposed_times, transposed_times_vector
  use errors, only: error_type
  use global_vectors, only: length
  use kinds, only: rk
  use symmetric_modes, only: find_modes
  implicit none
  private
  public :: response_memory, most_kept

  integer, parameter :: most_kept = 64 !< changes of the forces
  !> s. Solves leave 1e-8 of the forces, of which the blocks leave out some 1e-5 on stiff springs.
  real(rk), parameter :: share_of_length = 1.0e-6_rk

  type :: response_memory
    integer :: num_kept = 0
    integer, private :: next = 1 !< the place that the next change takes
    real(rk), allocatable, private :: force(:, :) !< (rows, most_kept) F [-]
    real(rk), allocatable, private :: jump(:, :) !< (rows, most_kept) J [m/N]
    real(rk), allocatable, private :: inverse(:, :) !< (num_kept, num_kept) (F^T F + s I)^-1
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
    real(rk) :: size_of_force
    size_of_force = length(force)
    if (.not. size_of_force > 0.0_rk) return
    if (.not. allocated(self%force)) then
      allocate (self%force(size(force), most_kept), source=0.0_rk)
      allocate (self%jump(size(force), most_kept), source=0.0_rk)
    end if
    self%force(:, self%next) = force/size_of_force
    self%jump(:, self%next) = jump/size_of_force
    self%num_kept = min(self%num_kept + 1, most_kept)
    self%next = 1 + modulo(self%next, most_kept)
    call invert_products(self)
  end subroutine learn

  !> (F^T F + s I)^-1 by the modes of F^T F.
  subroutine invert_products(self)
    type(response_memory), intent(inout) :: self
    real(rk), allocatable :: values(:), modes(:, :), scaled(:, :)
    type(error_type), allocatable :: error
    integer :: k
    associate (force => self%force(:, :self%num_kept))
      call find_modes(transposed_times(force, force), values, modes, error)
    end associate
    if (allocated(error)) then
      call self%forget()
      return
    end if
    allocate (scaled, source=modes)
    do k = 1, size(values)
      scaled(:, k) = modes(:, k)/(max(values(k), 0.0_rk) + share_of_length)
    end do
    self%inverse = matmul(scaled, transpose(modes))
  end subroutine invert_products

  !> y = y + E x.
  subroutine add_to(self, x, y)
    class(response_memory), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (rows) [N]
    real(rk), intent(inout) :: y(:) !< (rows) [m]
    real(rk) :: part(self%num_kept)
    if (self%num_kept == 0) return
    associate (force => self%force(:, :self%num_kept), jump => self%jump(:, :self%num_kept))
      part = matmul(self%inverse, transposed_times_vector(force, x))
      y = y + times_vector(jump, part)
    end associate
  end subroutine add_to
end module learned_response
