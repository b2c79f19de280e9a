!> The last solution with a factor that has a copy in single precision (theory.md, 8). The next
!> right-hand side differs little from the last one: the copy solves for the difference, so that
!> its rounding is one of the difference too.
!>
!> All vectors are in the order of elimination. Errors of roundings add up over the solutions. Where
!> they would be more than is admissible, the solution is one in double precision.
module last_solution
  use global_vectors, only: norm
  use kinds, only: rk
  use write_text, only: as_text
  implicit none
  private
  public :: known_solution

  type :: known_solution
    logical :: has_copy = .false. !< in single precision, of the factor
    logical :: is_used = .false. !< the present solves are those of differences, by the copy
    real(rk), allocatable :: b(:), y(:) !< (free unknowns) right-hand side and L^-1 b
    real(rk), allocatable :: half(:), x(:) !< (free unknowns) vector and L^-T of it
    !> (free unknowns) the same of the present solution, which the next one differs from; no next_x
    !> while it is not complete
    real(rk), allocatable, private :: next_b(:), next_y(:), next_half(:), next_x(:)
    real(rk), allocatable :: diagonal(:) !< (free unknowns) of the matrix; with a copy only
    real(rk), private :: error = 0.0_rk !< norm of the residual of the known solution, at most [N]
    real(rk), private :: next_error = 0.0_rk !< of the present one [N]
    real(rk), private :: change = huge(1.0_rk) !< what rounding adds in a solve [N]
    integer, private :: num_solutions = 0, num_single = 0 !< all, and those by the copy
  contains
    procedure :: open => open_known, start, take_forward, take_half, keep, leave
    procedure :: describe => describe_solutions
  end type known_solution

  !> Norm of the forces by which a solve in single precision misses the right-hand side, over
  !> norm(diag(A) x). Measured: 0.28 to 0.79 of this in a box of springs (test_active_solve).
  real(rk), parameter :: rounding = 2.0_rk**(-24)

contains

  !> Nothing is known of a new matrix.
  subroutine open_known(self, has_copy)
    class(known_solution), intent(inout) :: self
    logical, intent(in) :: has_copy !< in single precision, of the factor
    call self%leave()
    self%is_used = .false.
    self%has_copy = has_copy
  end subroutine open_known

  !> The present solution becomes the known one. The next one is a difference from it if errors stay
  !> admissible.
  subroutine start(self, admissible)
    class(known_solution), intent(inout) :: self
    real(rk), intent(in) :: admissible !< norm of the residual [N]
    if (.not. self%has_copy) return
    if (allocated(self%next_x)) then
      call move_alloc(self%next_b, self%b)
      call move_alloc(self%next_y, self%y)
      call move_alloc(self%next_half, self%half)
      call move_alloc(self%next_x, self%x)
      self%error = self%next_error
    end if
    self%is_used = allocated(self%x) .and. self%error + self%change <= admissible
  end subroutine start

  !> Keeps the present right-hand side and its forward substitution.
  subroutine take_forward(self, b, y)
    class(known_solution), intent(inout) :: self
    real(rk), intent(in) :: b(:), y(:) !< (free unknowns)
    if (.not. self%has_copy) return
    if (allocated(self%next_x)) deallocate (self%next_x)
    self%next_b = b
    self%next_y = y
  end subroutine take_forward

  !> Keeps the present vector before its backward substitution.
  subroutine take_half(self, half)
    class(known_solution), intent(inout) :: self
    real(rk), intent(in) :: half(:) !< (free unknowns)
    if (.not. self%has_copy) return
    if (allocated(self%next_x)) deallocate (self%next_x)
    self%next_half = half
  end subroutine take_half

  !> Keeps the present solution, which is complete.
  subroutine keep(self, x)
    class(known_solution), intent(inout) :: self
    real(rk), intent(in) :: x(:) !< (free unknowns)
    if (.not. self%has_copy) return
    self%change = huge(1.0_rk)
    if (allocated(self%x)) self%change = rounding*norm(self%diagonal*(x - self%x))
    self%next_error = 0.0_rk
    if (self%is_used) self%next_error = self%error + self%change
    self%next_x = x
    self%num_solutions = self%num_solutions + 1
    if (self%is_used) self%num_single = self%num_single + 1
  end subroutine keep

  !> The next solution is far from the last one.
  subroutine leave(self)
    class(known_solution), intent(inout) :: self
    if (allocated(self%x)) deallocate (self%x)
    if (allocated(self%next_x)) deallocate (self%next_x)
  end subroutine leave

  !> How many solutions the copy has given; '' without a copy.
  function describe_solutions(self) result(text)
    class(known_solution), intent(in) :: self
    character(:), allocatable :: text
    text = ''
    if (.not. self%has_copy) return
    text = as_text(self%num_single)//' of the last '//as_text(self%num_solutions)// &
           ' solutions in single precision (PRECISION=MIXED)'
  end function describe_solutions
end module last_solution
